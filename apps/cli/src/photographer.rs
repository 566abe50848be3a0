//! A character and the pictures taken of it.

use crate::{
    args::Size,
    debug::{self, Debug},
    picture::{Frame, Kind, Picture, layers},
    progress::Preparing,
};
use anyhow::{Result, ensure};
use std::{
    ops::{Deref, DerefMut},
    sync::Arc,
};
use tresses::{PipelineRequest, gpu::Gpu, present::Background};
use tresses_scene::{Companions, Preset, Scene, Shelf, Viewpoint, scene::Asked};

/// A scene, and what is shown over its pictures.
pub struct Photographer {
    scene: Scene,
    debug: Option<Debug>,
}

impl Deref for Photographer {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl DerefMut for Photographer {
    fn deref_mut(&mut self) -> &mut Scene {
        &mut self.scene
    }
}

impl Photographer {
    /// Opens the GPU, reads or grows the character of `preset` and brings it there.
    pub fn open(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(None, preset, size, (false, true))
    }

    /// The same for pictures of hair at rest, which need fewer pipelines.
    pub fn open_still(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(None, preset, size, (false, false))
    }

    /// The same with fewer samples per pixel where the adapter offers no more.
    pub fn with_samples_at_most(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(None, preset, size, (true, true))
    }

    /// The same on a GPU that is open already.
    pub fn on(gpu: Gpu, preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(Some(gpu), preset, size, (true, true))
    }

    fn with_samples(
        gpu: Option<Gpu>,
        preset: &Preset,
        size: Size,
        (fewer, moves): (bool, bool),
    ) -> Result<Self> {
        let settings = &preset.settings;
        settings.check()?;
        let companions = Companions::of(&preset.source, Shelf::default());
        let surroundings = companions.surroundings()?;
        let preparing = Preparing::new("opening the GPU");
        let gpu = gpu.map_or_else(|| pollster::block_on(Gpu::open()), Ok)?;
        let most = gpu.context.tier().max_samples;
        let mut quality = settings.quality([size.width, size.height], most)?;
        ensure!(
            quality.view.samples <= most || fewer,
            "{} samples per pixel were requested, but {} offers at most {most}",
            quality.view.samples,
            gpu.info.name
        );
        quality.view.samples = quality.view.samples.min(most);
        let context = gpu.context.clone();
        let compile = |requests: Vec<PipelineRequest>| pollster::block_on(context.prepare(&requests, &()));
        // Shaders are compiled while the character is made.
        let mut scene = std::thread::scope(|scope| -> Result<Scene> {
            let at_rest = settings.pipelines(quality.view);
            let at_rest = scope.spawn(move || compile(at_rest));
            let character = pollster::block_on(preset.character(&context, &preparing))?;
            for note in &character.notes {
                preparing.suspend(|| eprintln!("note: {note}"));
            }
            let colliders = companions.colliders()?;
            let physics = settings.physics();
            let in_motion = settings.pipelines_of_motion(&character.guide_vertices());
            let in_motion = moves.then(|| scope.spawn(move || compile(in_motion)));
            let scene = Scene::new(gpu, character, colliders, &physics, &quality, &preparing);
            let scene = pollster::block_on(scene)?;
            for compiling in [Some(at_rest), in_motion].into_iter().flatten() {
                compiling.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            }
            Ok(scene)
        })?;
        if let Some(roots) = scene.character.roots().filter(|roots| roots.farthest > 0.01) {
            let [mean, farthest] = [roots.mean, roots.farthest].map(|metres| 1e3 * metres);
            eprintln!("note: roots are {mean:.1} mm from the body in the mean, {farthest:.0} mm at most");
        }
        scene.apply(settings)?;
        scene.set_surroundings(surroundings.map(Arc::new));
        Ok(Self { scene, debug: None })
    }

    /// From here on pictures show what `args` ask for.
    pub fn show(&mut self, args: &debug::DebugArgs) -> Result<()> {
        self.debug = Debug::new(&mut self.scene, args)?;
        Ok(())
    }

    /// Whether a range of colours is to be found from all frames of a sequence before the first is drawn.
    pub fn seeks_range(&self) -> bool {
        self.debug.as_ref().is_some_and(|debug| debug.seeks_range(&self.scene))
    }

    /// Takes note of what this frame adds to that range. Blocks.
    pub fn observe(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.observe(&self.scene))
    }

    /// Pictures have the range of all frames that were observed from here on.
    pub fn settle_range(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.settle(&mut self.scene))
    }

    /// The current picture. Blocks.
    pub fn picture(&mut self, camera: &Viewpoint) -> Result<Picture> {
        let scene = &mut self.scene;
        scene.place_colliders();
        if let Some(debug) = &mut self.debug {
            debug.prepare(scene)?;
        }
        loop {
            let mut encoder = scene.gpu.context.device().create_command_encoder(&Default::default());
            scene.record_draw(&mut encoder, None, camera)?;
            scene.gpu.context.queue().submit([encoder.finish()]);
            if pollster::block_on(scene.is_complete())? {
                break;
            }
        }
        let rgba = pollster::block_on(scene.targets().read())?;
        let [width, height] = scene.targets().size;
        let mut picture = Picture { width, height, rgba };
        if let (Some(debug), Some(shown)) = (&self.debug, self.scene.shown()) {
            debug.label(&shown, &mut picture);
        }
        Ok(picture)
    }

    /// The frame that `kind` takes. Blocks.
    pub fn frame(&mut self, camera: &Viewpoint, kind: Kind) -> Result<Frame> {
        if !kind.has_layers() {
            return Ok(Frame::Shown(self.picture(camera)?));
        }
        let asked = Asked { linear: true, hair: true, bare: false };
        let captured = pollster::block_on(self.scene.capture(camera, asked))?;
        let (size, projection) = (self.scene.targets().size, self.scene.picture.camera.projection);
        Ok(Frame::File(layers::encode(&captured, size, &projection)?, size))
    }

    /// How many pixels of the picture the hair covers, whatever is before it. Blocks.
    pub fn hair_pixels(&mut self, camera: &Viewpoint) -> Result<f64> {
        let asked = Asked { bare: true, ..Asked::default() };
        let background = std::mem::replace(&mut self.scene.picture.background, Background::transparent());
        let captured = pollster::block_on(self.scene.capture(camera, asked));
        self.scene.picture.background = background;
        Ok(captured?.color.as_chunks::<4>().0.iter().map(|[.., alpha]| f64::from(*alpha) / 255.0).sum())
    }
}
