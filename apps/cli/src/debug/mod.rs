//! `--debug`: what the simulation holds, drawn over the picture, with a legend.

mod legend;

use crate::picture::Picture;
use anyhow::{Result, ensure};
use legend::Legend;
use tresses::{
    Hair, Pose,
    draw::{
        Body, DrawStage, Scene, Targets,
        debug::{
            Arrows, DebugStage, Grid, GuideQuantity, Layer, LinePoint, Paint, Peak, Quantity, Slices,
            Streams, outline::Pen,
        },
    },
    glam::{Vec3, Vec4},
    gpu::Gpu,
    groom::SdfGrid,
    simulate::SimulationParams,
    volume::HairHairMode,
};

/// About how far contour lines are apart, metres.
const CONTOURS: f32 = 0.01;
/// Distance from the surface at which hair touches it and contour lines lie, metres.
const CONTACT: f32 = 1.5e-3;
/// The column of slices at the right of a picture: see [`Slices::panels`]. Three of them fill it.
const PANEL: f32 = 0.6;

/// Streamlines along each edge of the face where the wind comes in.
const STREAMS: u32 = 24;
/// Steps of a streamline across the grid.
const STEPS: u16 = 96;

/// What is shown of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Subject {
    /// How dense the hair is: as a volume, and slices through the grid's middle
    Density,
    /// How hair that is denser than at rest is pushed
    Push,
    /// How the air flows: streamlines, and slices of its speed
    Wind,
    /// The surface that the hair collides with, as contour lines 1 cm apart
    Colliders,
    /// The simulated strands, coloured by their speed
    Guides,
}

impl Subject {
    /// Whether the hair would hide what is to be seen.
    fn hides_hair(self) -> bool {
        match self {
            Self::Density | Self::Push | Self::Guides => true,
            Self::Wind | Self::Colliders => false,
        }
    }

    /// What the colours stand for, where they do.
    fn title(self) -> Option<&'static str> {
        match self {
            Self::Density => Some("density, km/m³"),
            Self::Push => Some("push, m/s²"),
            Self::Wind => Some("speed of the air, m/s"),
            Self::Guides => Some("speed, m/s"),
            Self::Colliders => None,
        }
    }
}

/// The options of debug views.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct DebugArgs {
    /// Show what the simulation holds, with a legend
    #[arg(long, value_name = "NAME", value_enum, help_heading = "Simulation")]
    pub debug: Option<Subject>,
    /// The number that --debug draws brightest [default: a round one, from the first picture]
    #[arg(long, value_name = "X", requires = "debug", value_parser = positive, help_heading = "Simulation")]
    pub debug_max: Option<f32>,
}

impl DebugArgs {
    /// Refuses to show what `physics` leaves out.
    pub fn check(&self, physics: &SimulationParams) -> Result<()> {
        ensure!(
            !matches!(self.debug, Some(Subject::Density | Subject::Push))
                || physics.hair_hair.mode != HairHairMode::Off,
            "--debug has nothing to show: --hair-hair is off"
        );
        ensure!(
            self.debug != Some(Subject::Wind) || physics.wind.blows(),
            "--debug has nothing to show: it is calm; give --wind a speed"
        );
        Ok(())
    }
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
    peak: Peak,
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
                let pen = Pen { value, width: 1.2 };
                pen.contours(&mut contours, field, &Pose::IDENTITY, CONTACT, axis, every);
            }
        }
        let stage = DebugStage::new(&gpu.device, draw, tresses::draw::targets::PICTURE_FORMAT);
        Some(Self { subject, max: args.debug_max, stage, peak: Peak::new(&gpu.device), contours })
    }

    /// Whether the hair would hide what is to be seen.
    pub fn hides_hair(&self) -> bool {
        self.subject.hides_hair()
    }

    /// Draws over the finished picture of `targets`; the mean `wind` is in m/s.
    #[allow(clippy::too_many_arguments)]
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        targets: &Targets,
        hair: &Hair,
        body: Option<&Body>,
        wind: Vec3,
    ) -> Result<()> {
        let grid = self.grid(scene, hair);
        let max = match (self.max, &grid) {
            (Some(max), _) => max,
            (None, Some(grid)) => {
                legend::rounded_up(pollster::block_on(self.peak.measure(&gpu.device, &gpu.queue, grid))?)
            }
            // The speed of hair on a head that is shaken.
            (None, None) => 1.0,
        };
        self.max = Some(max);
        let paint = |opacity| Paint { low: 0.0, high: max, opacity };
        let mut lines = Vec::new();
        if let Some(grid) = &grid {
            Pen { value: 0.3 * max, width: 1.0 }.cuboid(&mut lines, grid);
        }
        let cells = hair.volume.grid.resolution;
        let seeds = match (self.subject, &grid) {
            (Subject::Wind, Some(grid)) => Streams::upwind(grid, wind, STREAMS),
            _ => Vec::new(),
        };
        let mut layers = Vec::new();
        match (self.subject, grid) {
            (Subject::Density, Some(grid)) => layers.extend([
                Layer::Lines(&lines, paint(0.7)),
                Layer::Volume(grid, paint(60.0)),
                Layer::Slices(grid, paint(1.0), panels(targets.size)),
            ]),
            (Subject::Push, Some(grid)) => layers.extend([
                Layer::Lines(&lines, paint(0.7)),
                Layer::Volume(grid, paint(30.0)),
                Layer::Arrows(grid, paint(1.0), Arrows::over(&grid, None, cells, max)),
                Layer::Slices(grid, paint(1.0), panels(targets.size)),
            ]),
            (Subject::Wind, Some(grid)) => {
                let step = grid.extent().max_element() / f32::from(STEPS);
                let points = 3 * u32::from(STEPS) / 2;
                let streams = Streams { seeds: &seeds, points, step, least: 0.02 * max };
                layers.extend([
                    Layer::Lines(&lines, paint(0.7)),
                    Layer::Streams(grid, paint(0.8), streams),
                    Layer::Slices(grid, paint(1.0), panels(targets.size)),
                ]);
            }
            (Subject::Guides, _) => {
                layers.push(Layer::Guides(&hair.guides, paint(1.0), GuideQuantity::Speed));
            }
            (Subject::Colliders, _) => {
                // The head's field comes first; it follows the head.
                let pose = hair.colliders.drawn().first().copied().unwrap_or(scene.pose);
                let place = |p: &LinePoint| LinePoint { position: pose.point(p.position), ..*p };
                lines.extend(self.contours.iter().map(place));
                layers.push(Layer::Lines(&lines, paint(1.0)));
            }
            (Subject::Density | Subject::Push | Subject::Wind, None) => {}
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let output = targets.picture();
        self.stage.record(&gpu.device, &mut encoder, None, scene, targets, body, output, &layers)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The grid that is looked at.
    fn grid<'a>(&self, scene: &Scene, hair: &'a Hair) -> Option<Grid<'a>> {
        let volume = &hair.volume;
        let (texture, quantity, turns) = match self.subject {
            Subject::Density => (&volume.hair, Quantity::Channel(3), false),
            Subject::Push => (&volume.push, Quantity::Length, true),
            Subject::Wind => {
                let air = hair.air.as_ref()?;
                let place = air.now();
                return Some(Grid {
                    texture: &air.view,
                    pose: Pose { translation: place.corner, ..Pose::IDENTITY },
                    scale: Vec3::splat(place.scale),
                    bias: Vec3::ZERO,
                    quantity: Quantity::Length,
                    turns: false,
                });
            }
            Subject::Colliders | Subject::Guides => return None,
        };
        let (scale, bias) = (Vec3::splat(volume.grid.scale), volume.grid.bias);
        Some(Grid { texture, pose: scene.pose, scale, bias, quantity, turns })
    }

    /// Adds the legend to a picture.
    pub fn label(&self, picture: &mut Picture) {
        if let Some(title) = self.subject.title() {
            Legend { title: title.into(), max: self.max.unwrap_or(1.0) }.draw(picture);
        }
        if matches!(self.subject, Subject::Density | Subject::Push | Subject::Wind) {
            let size = [picture.width as f32, picture.height as f32];
            let panel = panels([picture.width, picture.height]).panels.unwrap_or_default();
            for (i, caption) in ["from the left", "from above", "from the front"].into_iter().enumerate() {
                let corner = [panel.x, panel.y + panel.z - i as f32 * panel.w];
                let at = [0.5 + 0.5 * corner[0], 0.5 - 0.5 * corner[1]];
                legend::caption(picture, caption, [at[0] * size[0], at[1] * size[1]].map(|x| x as i32));
            }
        }
    }
}

/// The mid planes as a column at the right of a picture.
fn panels([width, height]: [u32; 2]) -> Slices {
    let wide = PANEL * height as f32 / width as f32;
    let gap = (2.0 - 3.0 * PANEL) / 4.0;
    let margin = gap * height as f32 / width as f32;
    let first = Vec4::new(1.0 - wide - margin, 1.0 - PANEL - gap, PANEL, PANEL + gap);
    Slices { at: Vec3::splat(0.5), panels: Some(first) }
}
