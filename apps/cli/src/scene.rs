//! A character that is photographed.

use crate::{
    args::{Size, Source},
    debug::{self, Debug},
    edge_args::EdgeArgs,
    load,
    picture::Picture,
    shading_args::material,
};
use anyhow::{Result, ensure};
use std::{
    ops::{Deref, DerefMut},
    sync::Arc,
};
use tresses::{
    draw::{Background, DrawOptions},
    gpu::Gpu,
};
use tresses_scene::{Camera, Colliders, Stage};

/// The size of a picture and how finely it is sampled, as the options say.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Pixels.
    pub size: Size,
    /// Samples and the rest of antialiasing.
    pub edges: EdgeArgs,
    /// Whether fewer samples will do where the adapter offers no more.
    pub at_most: bool,
    /// Texels along each edge of a shadow map.
    pub shadow_resolution: u32,
}

impl Quality {
    /// Exactly as many samples as asked for.
    pub fn new(size: Size, edges: EdgeArgs) -> Self {
        let shadow_resolution = DrawOptions::default().shadow_resolution;
        Self { size, edges, at_most: false, shadow_resolution }
    }

    /// What it comes to on `gpu`; refuses what that does not offer.
    fn on(&self, gpu: &Gpu) -> Result<tresses_scene::Quality> {
        let most = gpu.tier.max_samples;
        let (samples, coverage) = self.edges.choose(most)?;
        ensure!(
            samples <= most || self.at_most,
            "--samples is {samples}, but {} offers at most {most} per pixel",
            gpu.info.name
        );
        Ok(tresses_scene::Quality {
            size: [self.size.width, self.size.height],
            samples: samples.min(most),
            coverage,
            ssaa: self.edges.ssaa,
            shadow_resolution: self.shadow_resolution,
        })
    }
}

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
    /// Opens the GPU, reads or grows the character and brings it there.
    pub fn open(source: &Source, quality: Quality) -> Result<Self> {
        ensure!(
            source.color.is_none() || source.shape.color_map.is_none(),
            "--color gives all hair one colour and --color-map many; give one of them"
        );
        let gpu = pollster::block_on(Gpu::open())?;
        let quality = quality.on(&gpu)?;
        let renderer = Arc::new(quality.renderer(&gpu.device));
        let character = load::load(source, &gpu, &renderer.simulate)?;
        for note in &character.notes {
            eprintln!("note: {note}");
        }
        let colliders = match &source.colliders {
            Some(path) => Colliders::read(path)?,
            None => Colliders::default(),
        };
        let mut stage = pollster::block_on(Stage::new(gpu, renderer, character, colliders, &quality, &()))?;
        stage.look.hair = material(source.color.as_ref());
        source.shape.apply_to_material(&mut stage.look.hair);
        Ok(Self { stage, debug: None })
    }

    /// From here on pictures show what `args` ask for.
    pub fn show(&mut self, args: &debug::DebugArgs) {
        self.debug = Debug::new(&mut self.stage, args);
    }

    /// The picture as it is now. Blocks.
    pub fn picture(&mut self, camera: &Camera) -> Result<Picture> {
        let stage = &mut self.stage;
        stage.place_colliders();
        if let Some(debug) = &mut self.debug {
            debug.prepare(stage)?;
        }
        let mut encoder = stage.gpu.device.create_command_encoder(&Default::default());
        stage.record_draw(&mut encoder, None, camera)?;
        stage.gpu.queue.submit([encoder.finish()]);
        let rgba = pollster::block_on(stage.targets.read(&stage.gpu.device, &stage.gpu.queue))?;
        let [width, height] = stage.targets.size;
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
