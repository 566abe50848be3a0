//! A scene and the images rendered of it.

use crate::{
    args::Size,
    debug::{self, Debug},
    picture::{Image, OutputFrame, OutputKind, layers},
    progress::TaskProgress,
};
use anyhow::{Result, ensure};
use std::{
    ops::{Deref, DerefMut},
    sync::Arc,
};
use tresses::{Background, Gpu, PipelineRequest, groom::cards::CardOptions};
use tresses_scene::{CompanionFiles, Preset, Scene, Shelf, Viewpoint, cards, scene::OutputRequest};

/// A scene, and the debug view shown in its images.
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

/// How a scene is opened.
#[derive(Clone, Copy)]
struct Opening {
    /// Whether fewer samples per pixel are used if the adapter does not offer as many as requested.
    fewer: bool,
    /// Whether the hair moves.
    moves: bool,
    /// Number of cards to draw instead of strands.
    cards: Option<u32>,
}

impl Default for Opening {
    fn default() -> Self {
        Self { fewer: false, moves: true, cards: None }
    }
}

impl Photographer {
    /// Opens the GPU and loads or grows the character of `preset`.
    pub fn open(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(None, preset, size, Opening::default())
    }

    /// Opens a scene whose hair is drawn as this number of cards, or as strands. Hair at rest needs fewer pipelines.
    pub fn open_as(preset: &Preset, size: Size, moves: bool, cards: Option<u32>) -> Result<Self> {
        Self::with_samples(None, preset, size, Opening { moves, cards, ..Opening::default() })
    }

    /// Opens a scene, with fewer samples per pixel if the adapter does not offer more, whose hair is drawn as this
    /// number of cards, or as strands.
    pub fn with_clamped_samples(preset: &Preset, size: Size, cards: Option<u32>) -> Result<Self> {
        Self::with_samples(None, preset, size, Opening { fewer: true, cards, ..Opening::default() })
    }

    /// Takes pictures of `scene`.
    pub fn of(scene: Scene) -> Self {
        Self { scene, debug: None }
    }

    /// Opens a scene on an existing GPU.
    pub fn on(gpu: Gpu, preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(Some(gpu), preset, size, Opening { fewer: true, ..Opening::default() })
    }

    fn with_samples(
        gpu: Option<Gpu>,
        preset: &Preset,
        size: Size,
        Opening { fewer, moves, cards }: Opening,
    ) -> Result<Self> {
        let settings = &preset.settings;
        settings.check()?;
        let companion_files = CompanionFiles::of(&preset.source, Shelf::default());
        let surroundings = companion_files.surroundings()?;
        let preparing = TaskProgress::new("opening the GPU");
        let gpu = gpu.map_or_else(|| pollster::block_on(Gpu::open()), Ok)?;
        let max_samples = gpu.context.tier().max_samples;
        let mut quality = settings.quality([size.width, size.height], max_samples)?;
        ensure!(
            quality.view.renderer.samples() <= max_samples || fewer,
            "{} samples per pixel were requested, but {} supports at most {max_samples}",
            quality.view.renderer.samples(),
            gpu.info.name
        );
        quality.view.renderer = quality.view.renderer.with_max_samples(max_samples);
        let context = gpu.context.clone();
        let compile = |requests: Vec<PipelineRequest>| pollster::block_on(context.prepare(&requests, &()));
        // Compile shaders while the character is built.
        let mut scene = std::thread::scope(|scope| -> Result<Scene> {
            let at_rest = settings.pipelines(quality.view);
            let at_rest = scope.spawn(move || compile(at_rest));
            let mut character = pollster::block_on(preset.character(&context, &preparing))?;
            if let Some(cards) = cards {
                let options = CardOptions { levels: vec![cards], ..Default::default() };
                // The columns of the cards have the strands' own colors.
                let baked = cards::of_parts(&character, &options, false, &preparing);
                let baked = pollster::block_on(baked)?;
                character = character.with_cards(&baked, 0)?;
            }
            for note in &character.notes {
                preparing.suspend(|| eprintln!("note: {note}"));
            }
            let colliders = companion_files.colliders()?;
            let in_motion = settings.pipelines_of_motion(&character.guide_vertices());
            let in_motion = moves.then(|| scope.spawn(move || compile(in_motion)));
            let scene = Scene::new(gpu, character, colliders, settings, &quality, &preparing);
            let scene = pollster::block_on(scene)?;
            for compiling in [Some(at_rest), in_motion].into_iter().flatten() {
                compiling.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            }
            Ok(scene)
        })?;
        if let Some(roots) = scene.character.roots().filter(|roots| roots.max_distance > 0.01) {
            let [mean, max_distance] = [roots.mean_distance, roots.max_distance].map(|meters| 1e3 * meters);
            eprintln!("note: roots are {mean:.1} mm from the body on average, {max_distance:.0} mm at most");
        }
        scene.apply(settings)?;
        scene.set_surroundings(surroundings.map(Arc::new));
        Ok(Self::of(scene))
    }

    /// Shows the debug view of `args` from now on.
    pub fn show(&mut self, args: &debug::DebugArgs) -> Result<()> {
        self.debug = Debug::new(&mut self.scene, args)?;
        Ok(())
    }

    /// Whether the color range depends on all frames of a sequence.
    pub fn seeks_range(&self) -> bool {
        self.debug.as_ref().is_some_and(|debug| debug.seeks_range(&self.scene))
    }

    /// Includes the current frame in that range. Blocks.
    pub fn observe(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.observe(&self.scene))
    }

    /// Sets the color range from all observed frames.
    pub fn settle_range(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.settle(&mut self.scene))
    }

    /// Renders the current frame. Blocks.
    pub fn picture(&mut self, camera: &Viewpoint) -> Result<Image> {
        let scene = &mut self.scene;
        scene.move_colliders();
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
        let mut picture = Image { width, height, rgba };
        if let (Some(debug), Some(shown)) = (&self.debug, self.scene.shown()) {
            debug.label(&shown, &mut picture);
        }
        Ok(picture)
    }

    /// Renders the current frame for an output of `kind`. Blocks.
    pub fn frame(&mut self, camera: &Viewpoint, kind: OutputKind) -> Result<OutputFrame> {
        if !kind.has_layers() {
            return Ok(OutputFrame::Shown(self.picture(camera)?));
        }
        let request = OutputRequest { linear: true, hair: true, ..Default::default() };
        let captured = pollster::block_on(self.scene.capture(*camera, request))?;
        let (size, projection) = (self.scene.targets().size, self.scene.picture.camera.projection);
        Ok(OutputFrame::File(layers::encode(&captured, size, &projection)?, size))
    }

    /// Returns the number of pixels that hair covers, including occluded hair. Blocks.
    pub fn hair_pixels(&mut self, camera: &Viewpoint) -> Result<f64> {
        let request = OutputRequest { hair_only: true, ..OutputRequest::default() };
        let background = std::mem::replace(&mut self.scene.picture.background, Background::transparent());
        let captured = pollster::block_on(self.scene.capture(*camera, request));
        self.scene.picture.background = background;
        Ok(captured?.color.as_chunks::<4>().0.iter().map(|[.., alpha]| f64::from(*alpha) / 255.0).sum())
    }
}
