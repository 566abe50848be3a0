//! `--debug`: what the simulation holds, drawn over the picture, with a legend.

mod legend;

use crate::picture::Picture;
use anyhow::Result;
use legend::Legend;
use tresses::{
    Hair,
    draw::{
        Body, DrawStage, Scene, Targets,
        debug::{DebugStage, GuideQuantity, Layer, Paint},
    },
    gpu::Gpu,
};

/// What is shown of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Subject {
    /// The simulated strands, coloured by their speed
    Guides,
}

/// The options of debug views.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct DebugArgs {
    /// Show what the simulation holds
    #[arg(long, value_name = "NAME", value_enum)]
    pub debug: Option<Subject>,
    /// The number that --debug draws brightest [default: a round one, from the first picture]
    #[arg(long, value_name = "X", requires = "debug", value_parser = positive)]
    pub debug_max: Option<f32>,
}

fn positive(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(x) if (1e-9..=1e9).contains(&x) => Ok(x),
        _ => Err("give a number above 0".into()),
    }
}

/// Draws a subject over pictures.
pub struct Debug {
    subject: Subject,
    /// The number that is drawn brightest, once it is known.
    max: Option<f32>,
    stage: DebugStage,
}

impl Debug {
    /// The views that `args` ask for, over pictures that `draw` makes.
    pub fn new(gpu: &Gpu, draw: &DrawStage, args: &DebugArgs) -> Option<Self> {
        let subject = args.debug?;
        let stage = DebugStage::new(&gpu.device, draw, tresses::draw::targets::PICTURE_FORMAT);
        Some(Self { subject, max: args.debug_max, stage })
    }

    /// Whether the hair would hide what is to be seen.
    pub fn hides_hair(&self) -> bool {
        match self.subject {
            Subject::Guides => true,
        }
    }

    /// Draws over the finished picture of `targets`.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        targets: &Targets,
        hair: &Hair,
        body: Option<&Body>,
    ) -> Result<()> {
        let max = match self.max {
            Some(max) => max,
            None => legend::rounded_up(self.measure(gpu, hair)?),
        };
        self.max = Some(max);
        let paint = |opacity| Paint { low: 0.0, high: max, opacity };
        let mut layers = Vec::new();
        match self.subject {
            Subject::Guides => layers.push(Layer::Guides(&hair.guides, paint(1.0), GuideQuantity::Speed)),
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let output = targets.picture();
        self.stage.record(&gpu.device, &mut encoder, None, scene, targets, body, output, &layers)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The largest number there is now.
    fn measure(&self, _gpu: &Gpu, _hair: &Hair) -> Result<f32> {
        Ok(match self.subject {
            // What a head that is shaken reaches.
            Subject::Guides => 2.0,
        })
    }

    /// Adds the legend to a picture.
    pub fn label(&self, picture: &mut Picture) {
        let title = match self.subject {
            Subject::Guides => "speed of the guides, m/s",
        };
        Legend { title: title.into(), max: self.max.unwrap_or(1.0) }.draw(picture);
    }
}
