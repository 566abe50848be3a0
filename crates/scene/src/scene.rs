//! A character on the GPU, ready to be animated and drawn; `frames` alone calls the library's frame.

mod frames;
mod outputs;

pub use outputs::{Asked, Captured};

use crate::{
    aside::Aside,
    camera::{self, Bounds, Viewpoint},
    character::Character,
    colliders::Colliders,
    companions::Surroundings,
    face::Fringe,
    living::{self, Living},
    settings::{LightSettings, Settings},
};
use anyhow::{Context, Result, ensure};
use std::sync::Arc;
use tresses::{
    Hair, HairOptions, Pipelines, Pose, Progress, View,
    body::Body,
    collide::{ColliderDescriptor, FieldBuilder},
    draw::{Coverage, Targets, targets::PICTURE_FORMAT},
    glam::Vec3,
    gpu::Gpu,
    groom::{Look, SdfGrid, TriMesh},
    light::{Lights, Sphere},
    lod::{Detail, LodMode, LodOptions},
    roots::{RootReport, Skin},
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
    views::{DebugViews, Shown},
};

/// The size of a picture and how finely it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel; the adapter must offer them.
    pub samples: u32,
    /// How strands thinner than a pixel cover it.
    pub coverage: Coverage,
    /// Pixels drawn per pixel shown, along each axis: 1 or 2.
    pub ssaa: u32,
    /// Texels along each edge of a shadow map.
    pub shadow_resolution: u32,
    /// Cells along each edge of the grid of ambient light.
    pub ambient_cells: u32,
    /// [`ViewOptions::strand_map`].
    pub strand_map: u32,
    /// The levels of detail for which hair is measured.
    pub lod: LodOptions,
}

impl Quality {
    /// Strands by tiles, bodies with four samples per pixel.
    pub fn new(size: [u32; 2]) -> Self {
        let ViewOptions { shadow_resolution, strand_map, ambient_cells, .. } = ViewOptions::default();
        let (coverage, lod) = (Coverage::Tiles, LodOptions::default());
        Self { size, samples: 4, coverage, ssaa: 1, shadow_resolution, strand_map, ambient_cells, lod }
    }

    /// How a view of it is made.
    pub fn view_options(&self) -> ViewOptions {
        ViewOptions {
            samples: self.samples,
            coverage: self.coverage,
            shadow_resolution: self.shadow_resolution,
            strand_map: self.strand_map,
            ambient_cells: self.ambient_cells,
            ..Default::default()
        }
    }
}

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

/// No root may be farther from a skin that bends, metres: those of a groom that was made for another head may be centimetres
/// off.
const FARTHEST_ROOT: f32 = 0.2;

/// What the light of surroundings depends on: their turn, radians, and strength.
fn turned(lights: &LightSettings) -> [f32; 2] {
    [lights.environment_turn, lights.environment_strength]
}

/// A character on the GPU.
pub struct Scene {
    /// Adapter, device, queue.
    pub gpu: Gpu,
    /// The pipelines.
    pub pipelines: Arc<Pipelines>,
    /// The hair.
    pub hair: Hair,
    /// Brows and lashes, a beard.
    pub face: Vec<Fringe>,
    /// The head, drawn with it.
    pub body: Option<Body>,
    /// What bends the body, where something does.
    pub living: Option<Living>,
    /// The body at rest, until it bends for the first time: fields deform from then on.
    unbent: Option<TriMesh>,
    /// How far roots are from the skin that bends.
    pub roots: Option<RootReport>,
    /// The colliders, drawn with it.
    pub obstacles: Option<Body>,
    /// What is drawn into.
    pub view: View,
    /// What does not depend on the camera; this and the lights are set for each frame.
    pub picture: Picture,
    /// Where the body is, and the head.
    pose: Pose,
    head: Pose,
    /// And its other parts.
    parts: Vec<Pose>,
    /// The middle of what shadow maps hold while everything is at rest, metres.
    middle: Vec3,
    /// The physics.
    pub physics: SimulationParams,
    /// The head's distance field, groom space.
    pub field: Option<SdfGrid>,
    /// From timestamps where there are some that mean something, else by the clock.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) timings: tresses::gpu::Timings,
    /// What else is measured by.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) clock: tresses::gpu::Clock,
    /// What is shown instead of hair as it looks.
    shown: Option<Shown>,
    /// The pipelines for that, once there was something.
    views: Option<DebugViews>,
    /// What lights instead of a photographer, and its light as turned and strengthened when it was asked last.
    surroundings: Option<(Arc<Surroundings>, [f32; 2], Lights)>,
    /// Key, rim, sky and lamps.
    pub lighting: LightSettings,
    colliders: Colliders,
    /// What its file has the hair look like.
    look: Option<Look>,
    /// Seconds since the hair was put to rest.
    time: f64,
    subject: Bounds,
    neck: Vec3,
    /// Who looks, for whom the level of detail is chosen.
    watcher: Option<Viewpoint>,
}

impl Scene {
    /// Brings `character` to the GPU, at rest under `physics`, among `colliders`.
    ///
    /// # Errors
    /// One sentence, when the adapter cannot hold it or the character makes no sense.
    pub async fn new(
        gpu: Gpu,
        pipelines: Arc<Pipelines>,
        mut character: Character,
        mut colliders: Colliders,
        physics: &SimulationParams,
        quality: &Quality,
        progress: &impl Progress,
    ) -> Result<Self> {
        let hair_bounds = character.groom.bounds().context("the groom is empty")?;
        let head_bounds = character.head.as_ref().and_then(|head| head.bounds());
        let (device, queue) = (&gpu.device, &gpu.queue);
        // Collapsing edges takes as long as everything else of a small character.
        let known = character.levels_of_head.take();
        let levels =
            character.head.clone().map(|head| Aside::start(move || known.unwrap_or_else(|| head.levels())));
        let options = HairOptions { simulation: *physics, lod: quality.lod, ..Default::default() };
        match (&mut character.anatomy, &character.head) {
            (Some(anatomy), Some(mesh)) => {
                living::arrange(anatomy, colliders.joints(), mesh).context("colliders")?;
                if gpu.tier.software && !cfg!(target_arch = "wasm32") {
                    // A software driver takes many times as long for fields as the threads that it runs on.
                    anatomy.measure();
                }
                colliders.add_parts(anatomy.solids());
            }
            _ => ensure!(colliders.joints().is_empty(), "colliders of joints need a head whose body bends"),
        }
        let builder = FieldBuilder::new(device);
        let fields = colliders.fields(&builder);
        let (head, list) = (character.field.as_ref(), colliders.list.as_slice());
        let rest = character.rest.as_ref();
        let what = ColliderDescriptor { head, rest, fields: &fields, colliders: list };
        let groom = &character.groom;
        let hair = Hair::with_progress(device, queue, &pipelines, groom, &options, &what, progress);
        let mut hair = hair.await?;
        // Full detail, unless somebody asks for less.
        hair.lod.options.mode = LodMode::Off;
        if !character.levels.is_empty() {
            hair.paint_levels(queue, &character.groom, &character.levels, character.skull())?;
        }
        let view = View::new(device, &pipelines, &quality.view_options(), quality.size, quality.ssaa)?;
        #[cfg(not(target_arch = "wasm32"))]
        let timings = match gpu.tier.timestamps && !gpu.tier.software {
            true => tresses::gpu::Timings::new(device, queue),
            false => tresses::gpu::Timings::by(tresses::gpu::wall),
        };
        let subject = camera::subject(hair_bounds, head_bounds);
        let mut focus = Sphere::around(subject.0, subject.1);
        // Hair that swings must not leave the shadow maps.
        focus.radius *= 1.15;
        let picture = Picture { focus, ..Default::default() };
        let cells = view.options().ambient_cells;
        let levels = levels.map(Aside::get).unwrap_or_default();
        let mut body = character.head.as_ref().map(|head| Body::with_levels(device, head, &levels, cells));
        if let (Some(body), Some(head)) = (&mut body, &character.head)
            && let Some(paint) = &head.paint
        {
            body.paint(device, queue, paint)?;
        }
        let (mut living, mut roots) = (None, None);
        let mut face = Vec::new();
        if let (Some(body), Some(head)) = (&body, &character.head) {
            for groom in &character.face {
                let on = (body, head);
                face.push(Fringe::new((&gpu, &pipelines), groom, physics, &what, on, progress).await?);
            }
        }
        if let (Some(anatomy), Some(body), Some(head)) = (character.anatomy, &body, &character.head) {
            if !anatomy.is_rigid {
                let skin = Skin::from(body);
                roots = Some(hair.attach(device, queue, &pipelines, groom, head, &skin, FARTHEST_ROOT)?);
            }
            living = Some(Living::new(&gpu, &pipelines, anatomy, body)?);
        }
        hair.tie(device, queue, &pipelines, groom, &character.ties).context("ties")?;
        let mut stage = Self {
            pipelines,
            hair,
            face,
            body,
            unbent: living.as_ref().and(character.head),
            living,
            roots,
            obstacles: None,
            view,
            pose: Pose::IDENTITY,
            head: Pose::IDENTITY,
            parts: Vec::new(),
            middle: focus.center,
            #[cfg(not(target_arch = "wasm32"))]
            timings,
            #[cfg(not(target_arch = "wasm32"))]
            clock: tresses::gpu::wall,
            shown: None,
            views: None,
            picture,
            surroundings: None,
            lighting: LightSettings::default(),
            physics: options.simulation,
            colliders,
            time: 0.0,
            subject,
            neck: character.neck,
            look: character.look,
            field: character.field,
            watcher: None,
            gpu,
        };
        stage.make_obstacles();
        Ok(stage)
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
        self.physics = settings.physics();
        self.hair.avoidance.options = settings.avoidance;
        self.hair.lod.options = settings.lod();
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
        settings.apply(&mut self.picture, &mut self.hair.set.material, self.look.as_ref());
    }

    /// The colliders' body, for as many as there are now.
    fn make_obstacles(&mut self) {
        let (device, cells) = (&self.gpu.device, self.view.options().ambient_cells);
        let poses = vec![Pose::IDENTITY; self.colliders.list.len()];
        // Parts of a body are seen already.
        let seen = Some(self.colliders.mesh(&poses)).filter(|mesh| !mesh.triangles.is_empty());
        self.obstacles = seen.map(|mesh| Body::with_levels(device, &mesh, &[], cells));
    }

    /// Pictures are sampled as `quality` says from here on.
    ///
    /// # Errors
    /// As [`View::set_options`].
    pub fn set_quality(&mut self, quality: &Quality) -> Result<()> {
        self.view.set_options(&self.gpu.device, &self.pipelines, &quality.view_options())?;
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
        settings.look(self.look.as_ref())
    }

    /// How much of the hair is drawn from here on.
    pub fn set_lod(&mut self, options: LodOptions) -> Result<()> {
        options.check()?;
        self.hair.lod.options = options;
        Ok(())
    }

    /// The level of detail of the last frame.
    pub fn detail(&self) -> &Detail {
        self.hair.lod.current()
    }

    /// From here on pictures show `shown` instead of hair as it looks.
    ///
    /// # Errors
    /// When the adapter refuses a pipeline for it.
    pub fn show(&mut self, shown: Option<Shown>) -> Result<()> {
        if shown.is_some() && self.views.is_none() {
            let mut views = DebugViews::new(&self.gpu.device, PICTURE_FORMAT)?;
            views.set_head(self.field.as_ref());
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

    /// What a portrait must show, metres.
    pub fn subject(&self) -> Bounds {
        self.subject
    }

    /// The fields of the head and of parts of the body that are known here, with where they are: what a ball rolls off.
    pub fn solids(&self) -> Vec<(&SdfGrid, Pose)> {
        let head = self.field.as_ref().map(|field| (field, self.head));
        let parts = self.colliders.parts().zip(&self.parts).filter_map(|(part, pose)| Some((part?, *pose)));
        head.into_iter().chain(parts).collect()
    }

    /// Where the head is, relative to where it rests.
    pub fn head(&self) -> Pose {
        self.head
    }

    /// The joint that the head turns about, metres.
    pub fn pivot(&self) -> Vec3 {
        self.neck
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
        Facts {
            guides: self.hair.guides.count,
            strands: self.hair.strands.count,
            vertices_per_strand: self.hair.strands.vertex_count,
            triangles: self.hair.set.triangles(),
            bytes: self.hair.bytes()
                + self.face.iter().map(|face| face.hair.bytes()).sum::<u64>()
                + self.view.shaded_bytes(),
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
        Ok(self.view.resize(&self.gpu.device, size, ssaa)?)
    }
}
