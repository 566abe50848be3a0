//! A character on the GPU, ready to be animated and drawn. Only `frames` calls the library's frame functions.

mod frames;
mod outputs;
mod surface;

pub use outputs::{Capture, OutputRequest};
pub use surface::SurfaceSample;

use crate::{
    camera::Viewpoint,
    colliders::Colliders,
    companion_files::EnvironmentMap,
    quality::Quality,
    settings::{LightSettings, Settings},
};
use anyhow::{Context as _, Result, ensure};
use std::sync::Arc;
use tresses::{
    Body, Bounds, Character, CharacterAsset, CharacterOptions, CharacterParts, Gpu, HairOptions, LodMode,
    LodOptions, Picture, Progress, RestOptions, View,
    groom::Look,
    light::Lights,
    low_level::{DebugDisplay, DebugViews, Detail, FieldBuilder, PICTURE_FORMAT, Targets},
};

/// Size statistics of the hair.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts {
    /// Number of guides.
    pub guides: u32,
    /// Number of render strands.
    pub strands: u32,
    /// Vertices per render strand.
    pub vertices_per_strand: u32,
    /// Number of hair triangles.
    pub triangles: u64,
    /// GPU memory of the hair, bytes.
    pub bytes: u64,
}

/// Returns the settings that the light of an environment map depends on: rotation, radians, and strength.
fn environment_parameters(lights: &LightSettings) -> [f32; 2] {
    [lights.environment_rotation, lights.environment_strength]
}

/// A character on the GPU, with its colliders, lighting and a view.
pub struct Scene {
    /// Adapter and context.
    pub gpu: Gpu,
    /// The character. Its first prop is the collider mesh, if there are colliders.
    pub character: Character,
    /// Targets and light of the view.
    pub view: View,
    /// Camera-independent render options. Camera and lights are set for each frame.
    pub picture: Picture,
    /// GPU timestamps where the adapter supports reliable ones, otherwise clock times.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) timings: tresses::Timings,
    /// Clock of the other measurements.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) clock: tresses::low_level::Clock,
    /// The active debug view.
    shown: Option<DebugDisplay>,
    /// Pipelines of the debug views, created on first use.
    views: Option<DebugViews>,
    /// Environment map that replaces key, rim and sky light, the rotation and strength for which its light was
    /// computed, and that light.
    surroundings: Option<(Arc<EnvironmentMap>, [f32; 2], Lights)>,
    /// Key, rim and sky light, and the list of additional lights.
    pub lighting: LightSettings,
    colliders: Colliders,
    /// Viewpoint that the level of detail is chosen for.
    watcher: Option<Viewpoint>,
    rest: RestKey,
}

/// The settings that the rest shape is computed for, besides gravity and stiffness, which hair must show: options, and
/// whether hair twists.
type RestKey = (RestOptions, bool);

fn rest_key(settings: &Settings) -> RestKey {
    (settings.rest, settings.simulation.twist > 0.0)
}

/// Uploads the character of `parts`, at rest under the physics of `settings`, with `colliders`.
///
/// # Errors
/// As [`Scene::new`].
pub(crate) async fn uploaded(
    context: &tresses::Context,
    mut parts: CharacterParts,
    (colliders, settings, quality): (&Colliders, &Settings, &Quality),
    progress: &impl Progress,
) -> Result<Character> {
    match (&mut parts.anatomy, &parts.head) {
        (Some(anatomy), Some(mesh)) => colliders.arrange(anatomy, mesh).context("colliders")?,
        _ => ensure!(colliders.joints().is_empty(), "joint colliders need a head mesh with a skeleton"),
    }
    let builder = FieldBuilder::new(context);
    let fields = colliders.fields(&builder);
    let options = CharacterOptions {
        hair: HairOptions {
            simulation: settings.physics(),
            rest: settings.rest,
            lod: quality.lod,
            ..Default::default()
        },
        obstacles: &colliders.list,
        fields: &fields,
        ambient_resolution: quality.view.ambient_resolution,
        ..Default::default()
    };
    let mut character = Character::new(&CharacterAsset::new(context, parts, &options, progress).await?)?;
    // Draw full detail until the caller requests less.
    character.set_lod(LodOptions { mode: LodMode::Off, ..quality.lod });
    Ok(character)
}

impl Scene {
    /// Uploads the character of `parts`, at rest under the physics of `settings`, with `colliders`.
    /// [`apply`](Self::apply) sets the others.
    ///
    /// # Errors
    /// Fails if the adapter cannot allocate the character or `parts` are invalid.
    pub async fn new(
        gpu: Gpu,
        parts: CharacterParts,
        colliders: Colliders,
        settings: &Settings,
        quality: &Quality,
        progress: &impl Progress,
    ) -> Result<Self> {
        let context = &gpu.context;
        let view = View::new(context, &quality.view, quality.size, quality.ssaa)?;
        let character = uploaded(context, parts, (&colliders, settings, quality), progress).await?;
        #[cfg(not(target_arch = "wasm32"))]
        let timings = match context.tier().timestamps && !context.tier().software {
            true => tresses::Timings::new(context),
            false => tresses::Timings::by(tresses::low_level::wall),
        };
        let mut scene = Self {
            character,
            view,
            picture: Picture::default(),
            #[cfg(not(target_arch = "wasm32"))]
            timings,
            #[cfg(not(target_arch = "wasm32"))]
            clock: tresses::low_level::wall,
            shown: None,
            views: None,
            surroundings: None,
            lighting: LightSettings::default(),
            colliders,
            watcher: None,
            rest: rest_key(settings),
            gpu,
        };
        scene.make_obstacles();
        Ok(scene)
    }

    /// Exchanges the character for `other`, which continues its motion; its hair begins at rest.
    pub fn exchange(&mut self, other: &mut Character) {
        other.continue_from(&self.character);
        std::mem::swap(&mut self.character.props, &mut other.props);
        std::mem::swap(&mut self.character, other);
        self.character.reset();
    }

    /// Applies the settings that take effect in the next frame. Strands, pipelines and targets do not change.
    ///
    /// # Errors
    /// Returns the first parameter that is out of range.
    pub fn apply(&mut self, settings: &Settings) -> Result<()> {
        settings.check()?;
        self.take(settings)
    }

    /// As [`apply`](Self::apply), for settings that are already validated. Cheap enough to call every frame.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub fn take(&mut self, settings: &Settings) -> Result<()> {
        self.character.physics = settings.physics();
        if self.rest != rest_key(settings) {
            self.character.set_rest(&settings.physics(), &settings.rest)?;
            self.rest = rest_key(settings);
        }
        self.character.set_avoidance(settings.avoidance);
        self.character.set_lod(settings.lod());
        self.lighting.clone_from(&settings.lights);
        if let Some((surroundings, as_then, lights)) = &mut self.surroundings
            && *as_then != environment_parameters(&settings.lights)
        {
            (*as_then, *lights) =
                (environment_parameters(&settings.lights), surroundings.lights(&settings.lights));
        }
        self.set_appearance(settings);
        Ok(())
    }

    /// Applies the settings of the hair's and the frame's appearance.
    pub fn set_appearance(&mut self, settings: &Settings) {
        let mut material = self.character.hair().set.material;
        settings.apply(&mut self.picture, &mut material, self.character.look());
        self.character.set_material(material);
    }

    /// Rebuilds the mesh of the colliders.
    pub(super) fn make_obstacles(&mut self) {
        let cells = self.view.options().ambient_resolution;
        let mesh = Some(self.colliders.mesh(&[])).filter(|mesh| !mesh.triangles.is_empty());
        let body = mesh.map(|mesh| Body::with_levels(&self.gpu.context, &mesh, &[], cells));
        self.character.props = body.into_iter().collect();
    }

    /// Sets size, sampling and view options of the frames that follow.
    ///
    /// # Errors
    /// As [`View::set_options`].
    pub fn set_quality(&mut self, quality: &Quality) -> Result<()> {
        self.view.set_options(&quality.view)?;
        match self.targets().size == quality.size && self.targets().ssaa == quality.ssaa {
            true => Ok(()),
            false => self.resample(quality.size, quality.ssaa),
        }
    }

    /// Sets the environment map that lights the scene. `None` selects the key, rim and sky light of the settings.
    pub fn set_surroundings(&mut self, surroundings: Option<Arc<EnvironmentMap>>) {
        let lighting = &self.lighting;
        self.surroundings = surroundings.map(|surroundings| {
            let lights = surroundings.lights(lighting);
            (surroundings, environment_parameters(lighting), lights)
        });
    }

    /// Returns pigments and fiber shape of the hair with these settings, or `None` if they do not define pigments.
    pub fn look(&self, settings: &Settings) -> Option<Look> {
        settings.look(self.character.look())
    }

    /// Sets the level of detail.
    pub fn set_lod(&mut self, options: LodOptions) -> Result<()> {
        options.check()?;
        self.character.set_lod(options);
        Ok(())
    }

    /// Returns the level of detail of the last frame.
    pub fn detail(&self) -> &Detail {
        self.character.hair().lod.current()
    }

    /// Selects the debug view for the frames that follow; `None` draws hair normally.
    ///
    /// # Errors
    /// Fails if the adapter rejects the debug pipeline.
    pub fn show(&mut self, shown: Option<DebugDisplay>) -> Result<()> {
        if shown.is_some() && self.views.is_none() {
            let mut views = DebugViews::new(&self.gpu.context, PICTURE_FORMAT)?;
            views.set_head(self.character.field());
            self.views = Some(views);
        }
        self.shown = shown;
        Ok(())
    }

    /// Returns the active debug view.
    pub fn shown(&self) -> Option<DebugDisplay> {
        self.shown
    }

    /// Sets the viewpoint that the level of detail is chosen for.
    pub fn watch(&mut self, camera: &Viewpoint) {
        self.watcher = Some(*camera);
    }

    /// Returns the bounds that a portrait camera frames, meters.
    pub fn subject(&self) -> Bounds {
        self.character.subject()
    }

    /// Returns the render targets.
    pub fn targets(&self) -> &Targets {
        self.view.targets()
    }

    /// Returns the number of samples per pixel.
    pub fn samples(&self) -> u32 {
        self.targets().samples
    }

    /// Returns the name of the adapter.
    pub fn adapter_name(&self) -> &str {
        &self.gpu.info.name
    }

    /// Returns size statistics of the hair.
    pub fn facts(&self) -> Facts {
        let hair = self.character.hair();
        Facts {
            guides: hair.guides.count,
            strands: hair.strands.count,
            vertices_per_strand: hair.strands.vertex_count,
            triangles: hair.set.triangles(),
            bytes: self.character.hair_bytes() + self.view.shaded_bytes(),
        }
    }

    /// Resizes the render targets.
    ///
    /// # Errors
    /// Fails if the adapter does not support textures of that size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.resample(size, self.targets().ssaa)
    }

    /// Resizes the render targets, with `ssaa` × `ssaa` supersampling.
    ///
    /// # Errors
    /// As [`resize`](Self::resize).
    pub fn resample(&mut self, size: [u32; 2], ssaa: u32) -> Result<()> {
        Ok(self.view.resize(size, ssaa)?)
    }
}
