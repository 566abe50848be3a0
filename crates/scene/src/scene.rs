//! A character on the GPU, ready to be animated and drawn; `frames` alone calls the library's frame.

mod frames;
mod outputs;

pub use outputs::{Asked, Captured};

use crate::{
    camera::Viewpoint,
    colliders::Colliders,
    companions::Surroundings,
    quality::Quality,
    settings::{LightSettings, Settings},
};
use anyhow::{Context as _, Result, ensure};
use std::sync::Arc;
use tresses::{
    Character, HairOptions, Progress, View,
    body::Body,
    character::{Bounds, CharacterOptions, CharacterParts},
    collide::FieldBuilder,
    draw::{Targets, targets::PICTURE_FORMAT},
    gpu::Gpu,
    groom::Look,
    light::Lights,
    lod::{Detail, LodMode, LodOptions},
    simulate::SimulationParams,
    view::Picture,
    views::{DebugViews, Shown},
};

/// Sizes of what is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts {
    /// Simulated strands.
    pub guides: u32,
    /// Drawn strands.
    pub strands: u32,
    /// Vertices of each drawn strand.
    pub vertices_per_strand: u32,
    /// Triangles of the hair.
    pub triangles: u64,
    /// GPU memory of the groom, bytes.
    pub bytes: u64,
}

/// What the light of surroundings depends on: their turn, radians, and strength.
fn turned(lights: &LightSettings) -> [f32; 2] {
    [lights.environment_turn, lights.environment_strength]
}

/// A character on the GPU, with its obstacles, its lighting and a view of it.
pub struct Scene {
    /// The adapter and its context.
    pub gpu: Gpu,
    /// The character. Its first prop is the mesh of the obstacles, where there are some.
    pub character: Character,
    /// The targets and the light of the picture.
    pub view: View,
    /// What does not depend on the camera; this and the lights are set for each frame.
    pub picture: Picture,
    /// From timestamps where there are some that mean something, else by the clock.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) timings: tresses::gpu::Timings,
    /// The clock of other measurements.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) clock: tresses::gpu::Clock,
    /// The active debug view.
    shown: Option<Shown>,
    /// Its pipelines, once there was one.
    views: Option<DebugViews>,
    /// The environment that lights the scene in place of a photographer, and its light as it was turned and strengthened
    /// last.
    surroundings: Option<(Arc<Surroundings>, [f32; 2], Lights)>,
    /// Key, rim, sky and lamps.
    pub lighting: LightSettings,
    colliders: Colliders,
    /// The viewpoint that the level of detail is chosen for.
    watcher: Option<Viewpoint>,
}

impl Scene {
    /// Uploads the character of `parts`, at rest under `physics`, among `colliders`.
    ///
    /// # Errors
    /// When the adapter cannot hold it or the parts make no sense.
    pub async fn new(
        gpu: Gpu,
        mut parts: CharacterParts,
        colliders: Colliders,
        physics: &SimulationParams,
        quality: &Quality,
        progress: &impl Progress,
    ) -> Result<Self> {
        let context = &gpu.context;
        match (&mut parts.anatomy, &parts.head) {
            (Some(anatomy), Some(mesh)) => colliders.arrange(anatomy, mesh).context("colliders")?,
            _ => ensure!(colliders.joints().is_empty(), "colliders of joints need a head whose body bends"),
        }
        let view = View::new(context, &quality.view, quality.size, quality.ssaa)?;
        let builder = FieldBuilder::new(context);
        let fields = colliders.fields(&builder);
        let options = CharacterOptions {
            hair: HairOptions { simulation: *physics, lod: quality.lod, ..Default::default() },
            obstacles: &colliders.list,
            fields: &fields,
            ambient_cells: view.options().ambient_cells,
            ..Default::default()
        };
        let mut character = Character::new(context, parts, &options, progress).await?;
        // Full detail, unless somebody asks for less.
        character.set_lod(LodOptions { mode: LodMode::Off, ..quality.lod });
        #[cfg(not(target_arch = "wasm32"))]
        let timings = match context.tier().timestamps && !context.tier().software {
            true => tresses::gpu::Timings::new(context),
            false => tresses::gpu::Timings::by(tresses::gpu::wall),
        };
        let mut scene = Self {
            character,
            view,
            picture: Picture::default(),
            #[cfg(not(target_arch = "wasm32"))]
            timings,
            #[cfg(not(target_arch = "wasm32"))]
            clock: tresses::gpu::wall,
            shown: None,
            views: None,
            surroundings: None,
            lighting: LightSettings::default(),
            colliders,
            watcher: None,
            gpu,
        };
        scene.make_obstacles();
        Ok(scene)
    }

    /// Everything that `settings` have for the frames from here on; strands, pipelines and targets stay
    /// as they are.
    ///
    /// # Errors
    /// The first parameter that is out of its range.
    pub fn apply(&mut self, settings: &Settings) -> Result<()> {
        settings.check()?;
        self.take(settings);
        Ok(())
    }

    /// [`apply`](Self::apply) for settings that are known to be in their ranges; cheap enough for every frame.
    pub fn take(&mut self, settings: &Settings) {
        self.character.physics = settings.physics();
        self.character.set_avoidance(settings.avoidance);
        self.character.set_lod(settings.lod());
        self.lighting = settings.lights;
        if let Some((surroundings, as_then, lights)) = &mut self.surroundings
            && *as_then != turned(&settings.lights)
        {
            (*as_then, *lights) = (turned(&settings.lights), surroundings.lights(&settings.lights));
        }
        self.dress(settings);
    }

    /// What of `settings` is the look of hair and picture.
    pub fn dress(&mut self, settings: &Settings) {
        let mut material = self.character.hair().set.material;
        settings.apply(&mut self.picture, &mut material, self.character.look());
        self.character.set_material(material);
    }

    /// Makes the mesh of the obstacles that there are now.
    pub(super) fn make_obstacles(&mut self) {
        let cells = self.view.options().ambient_cells;
        let mesh = Some(self.colliders.mesh(&[])).filter(|mesh| !mesh.triangles.is_empty());
        let body = mesh.map(|mesh| Body::with_levels(&self.gpu.context, &mesh, &[], cells));
        self.character.props = body.into_iter().collect();
    }

    /// Pictures are sampled as `quality` says from here on.
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

    /// What lights the scene; `None` for a photographer, as the settings have it.
    pub fn set_surroundings(&mut self, surroundings: Option<Arc<Surroundings>>) {
        let lighting = &self.lighting;
        self.surroundings = surroundings.map(|surroundings| {
            let lights = surroundings.lights(lighting);
            (surroundings, turned(lighting), lights)
        });
    }

    /// What the hair looks like with these settings, where pigments say it.
    pub fn look(&self, settings: &Settings) -> Option<Look> {
        settings.look(self.character.look())
    }

    /// How much of the hair is drawn from here on.
    pub fn set_lod(&mut self, options: LodOptions) -> Result<()> {
        options.check()?;
        self.character.set_lod(options);
        Ok(())
    }

    /// The level of detail of the last frame.
    pub fn detail(&self) -> &Detail {
        self.character.hair().lod.current()
    }

    /// From here on pictures show `shown` instead of hair as it looks.
    ///
    /// # Errors
    /// When the adapter refuses a pipeline for it.
    pub fn show(&mut self, shown: Option<Shown>) -> Result<()> {
        if shown.is_some() && self.views.is_none() {
            let mut views = DebugViews::new(&self.gpu.context, PICTURE_FORMAT)?;
            views.set_head(self.character.field());
            self.views = Some(views);
        }
        self.shown = shown;
        Ok(())
    }

    /// What pictures show instead of hair as it looks.
    pub fn shown(&self) -> Option<Shown> {
        self.shown
    }

    /// From here on `camera` looks: frames are made for it.
    pub fn watch(&mut self, camera: &Viewpoint) {
        self.watcher = Some(*camera);
    }

    /// The box that a portrait shows, metres.
    pub fn subject(&self) -> Bounds {
        self.character.subject()
    }

    /// The textures of the pictures.
    pub fn targets(&self) -> &Targets {
        self.view.targets()
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.targets().samples
    }

    /// On what the pictures are made.
    pub fn adapter_name(&self) -> &str {
        &self.gpu.info.name
    }

    /// Sizes of what is drawn.
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

    /// Pictures of another size from here on.
    ///
    /// # Errors
    /// One sentence, when the adapter has no textures of that size.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<()> {
        self.resample(size, self.targets().ssaa)
    }

    /// The same, each pixel of which is made of `ssaa` × `ssaa` that are drawn.
    ///
    /// # Errors
    /// As [`resize`](Self::resize).
    pub fn resample(&mut self, size: [u32; 2], ssaa: u32) -> Result<()> {
        Ok(self.view.resize(size, ssaa)?)
    }
}
