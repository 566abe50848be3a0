//! `--debug`: what the simulation holds, drawn over the picture, with a legend.

mod legend;

use crate::picture::Picture;
use anyhow::Result;
use legend::Legend;
use tresses::{
    Hair, Pose,
    draw::{
        Body, DrawStage, Scene, Targets,
        debug::{DebugStage, GuideQuantity, Layer, LinePoint, Paint, outline::Pen},
    },
    gpu::Gpu,
    groom::SdfGrid,
};

/// About how far contour lines are apart, metres.
const CONTOURS: f32 = 0.01;
/// Distance from the surface at which hair touches it and contour lines lie, metres.
const CONTACT: f32 = 1.5e-3;

/// What is shown of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Subject {
    /// The simulated strands, coloured by their speed
    Guides,
    /// The surface that the hair collides with, as contour lines 1 cm apart
    Colliders,
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
    /// The head's contours, groom space.
    contours: Vec<LinePoint>,
}

impl Debug {
    /// The views that `args` ask for, over pictures that `draw` makes of hair that collides with
    /// `field`.
    pub fn new(gpu: &Gpu, draw: &DrawStage, args: &DebugArgs, field: Option<&SdfGrid>) -> Option<Self> {
        let subject = args.debug?;
        let mut contours = Vec::new();
        if let Some(field) = field.filter(|_| subject == Subject::Colliders) {
            let every = (CONTOURS / field.cell).round().max(1.0) as u32;
            for (axis, value) in [(1, 0.75), (0, 0.35)] {
                Pen { value, width: 1.2 }.contours(
                    &mut contours,
                    field,
                    &Pose::IDENTITY,
                    CONTACT,
                    axis,
                    every,
                );
            }
        }
        let stage = DebugStage::new(&gpu.device, draw, tresses::draw::targets::PICTURE_FORMAT);
        Some(Self { subject, max: args.debug_max, stage, contours })
    }

    /// Whether the hair would hide what is to be seen.
    pub fn hides_hair(&self) -> bool {
        match self.subject {
            Subject::Guides => true,
            Subject::Colliders => false,
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
        let moved: Vec<_>;
        match self.subject {
            Subject::Guides => layers.push(Layer::Guides(&hair.guides, paint(1.0), GuideQuantity::Speed)),
            Subject::Colliders => {
                // The head's field comes first; it follows the head.
                let pose = hair.colliders.drawn().first().copied().unwrap_or(scene.pose);
                let place = |p: &LinePoint| LinePoint { position: pose.point(p.position), ..*p };
                moved = self.contours.iter().map(place).collect();
                layers.push(Layer::Lines(&moved, Paint { low: 0.0, high: 1.0, opacity: 1.0 }));
            }
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
            Subject::Guides => 1.0,
            Subject::Colliders => 1.0,
        })
    }

    /// Adds the legend to a picture.
    pub fn label(&self, picture: &mut Picture) {
        let title = match self.subject {
            Subject::Guides => "speed of the guides, m/s",
            Subject::Colliders => return,
        };
        Legend { title: title.into(), max: self.max.unwrap_or(1.0) }.draw(picture);
    }
}
