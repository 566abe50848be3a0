//! A character and the pictures taken of it.

use crate::{
    args::Size,
    debug::{self, Debug},
    load,
    picture::Picture,
    progress::Preparing,
};
use anyhow::{Result, ensure};
use std::{
    ops::{Deref, DerefMut},
    sync::Arc,
};
use tresses::{Pipelines, gpu::Gpu, present::Background};
use tresses_scene::{Camera, Companions, Preset, Shelf, Stage};

/// A stage, and what is shown over its pictures.
pub struct Scene {
    stage: Stage,
    debug: Option<Debug>,
}

impl Deref for Scene {
    type Target = Stage;

    fn deref(&self) -> &Stage {
        &self.stage
    }
}

impl DerefMut for Scene {
    fn deref_mut(&mut self) -> &mut Stage {
        &mut self.stage
    }
}

impl Scene {
    /// Opens the GPU, reads or grows the character of `preset` and brings it there.
    pub fn open(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(preset, size, false)
    }

    /// The same with fewer samples per pixel where the adapter offers no more.
    pub fn with_samples_at_most(preset: &Preset, size: Size) -> Result<Self> {
        Self::with_samples(preset, size, true)
    }

    fn with_samples(preset: &Preset, size: Size, fewer: bool) -> Result<Self> {
        let settings = &preset.settings;
        settings.check()?;
        let companions = Companions::of(&preset.source, Shelf::default());
        let surroundings = companions.surroundings()?;
        let preparing = Preparing::new("opening the GPU");
        let gpu = pollster::block_on(Gpu::open())?;
        let most = gpu.tier.max_samples;
        let mut quality = settings.quality([size.width, size.height], most)?;
        ensure!(
            quality.samples <= most || fewer,
            "{} samples per pixel were requested, but {} offers at most {most}",
            quality.samples,
            gpu.info.name
        );
        quality.samples = quality.samples.min(most);
        let pipelines = Arc::new(Pipelines::new(&gpu.device));
        let character = load::load(preset, &gpu, &pipelines.simulate, &preparing)?;
        for note in &character.notes {
            preparing.suspend(|| eprintln!("note: {note}"));
        }
        let colliders = companions.colliders()?;
        let physics = settings.physics();
        let stage = Stage::new(gpu, pipelines, character, colliders, &physics, &quality, &preparing);
        let mut stage = pollster::block_on(stage)?;
        stage.apply(settings)?;
        stage.set_surroundings(surroundings.map(Arc::new));
        Ok(Self { stage, debug: None })
    }

    /// From here on pictures show what `args` ask for.
    pub fn show(&mut self, args: &debug::DebugArgs) -> Result<()> {
        self.debug = Debug::new(&mut self.stage, args)?;
        Ok(())
    }

    /// Whether a range of colours is to be found from all frames of a sequence before the first is drawn.
    pub fn seeks_range(&self) -> bool {
        self.debug.as_ref().is_some_and(|debug| debug.seeks_range(&self.stage))
    }

    /// Takes note of what this frame adds to that range. Blocks.
    pub fn observe(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.observe(&self.stage))
    }

    /// Pictures have the range of all frames that were observed from here on.
    pub fn settle_range(&mut self) -> Result<()> {
        self.debug.as_mut().map_or(Ok(()), |debug| debug.settle(&mut self.stage))
    }

    /// The current picture. Blocks.
    pub fn picture(&mut self, camera: &Camera) -> Result<Picture> {
        let stage = &mut self.stage;
        stage.place_colliders();
        if let Some(debug) = &mut self.debug {
            debug.prepare(stage)?;
        }
        let mut encoder = stage.gpu.device.create_command_encoder(&Default::default());
        stage.record_draw(&mut encoder, None, camera)?;
        stage.gpu.queue.submit([encoder.finish()]);
        let rgba = pollster::block_on(stage.targets().read(&stage.gpu.device, &stage.gpu.queue))?;
        let [width, height] = stage.targets().size;
        let mut picture = Picture { width, height, rgba };
        if let (Some(debug), Some(shown)) = (&self.debug, self.stage.shown()) {
            debug.label(&shown, &mut picture);
        }
        Ok(picture)
    }

    /// How many pixels of the picture the hair covers, whatever is before it. Blocks.
    pub fn hair_pixels(&mut self, camera: &Camera) -> Result<f64> {
        let body = self.stage.body.take();
        let background = std::mem::replace(&mut self.stage.look.background, Background::transparent());
        let picture = self.picture(camera);
        (self.stage.body, self.stage.look.background) = (body, background);
        Ok(picture?.rgba.as_chunks::<4>().0.iter().map(|[.., alpha]| f64::from(*alpha) / 255.0).sum())
    }
}
