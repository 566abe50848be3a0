//! The cost of the parts of the simulation, compared in one run: 1,000 guides of 32 vertices, chosen among the
//! strands of the built-in long style, in motion.

use super::{sitting::Sitting, statistics::Summary, workload};
use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use serde::Serialize;
use tresses::{
    Context, Hair, HairOptions, Pose,
    character::CharacterParts,
    collide::{Anchor, Collider, ColliderDescriptor, ColliderPoses, Shape},
    glam::{Quat, Vec3},
    gpu::{Clock, Gpu, Timings},
    groom::mesh::sdf::{self, SdfOptions},
    hair::HairFrame,
    simulate::SimulationParams,
    volume::{HairHair, VolumeOptions},
    wind::Wind,
};
use tresses_scene::Motion;

/// Guides of the measured hair.
const GUIDES: u32 = 1000;
/// Strands that hang on them.
const STRANDS: u32 = 16_000;
/// Frames before the first that counts.
const WARM_UP: u32 = 3;
/// Frames per second: one fixed step each.
const FPS: f64 = 60.0;
/// How many times a distance field is built, if that takes no longer than [`LONG`].
const BUILDS: usize = 3;
/// Milliseconds.
const LONG: f64 = 5000.0;
/// The wind that blows where one does, m/s: a fresh breeze from the front.
const WIND: Vec3 = Vec3::new(0.0, 0.0, -8.0);
/// Variants that are measured.
pub const RUNS: u64 = 6;

/// How the parts of the simulation compare.
#[derive(Debug, Default, Serialize)]
pub struct Costs {
    /// Simulated strands.
    pub guides: u32,
    /// Vertices of each.
    pub guide_vertices: u32,
    /// Drawn strands that follow.
    pub strands: u32,
    /// How many were measured.
    pub frames: u32,
    /// Milliseconds of a frame with one fixed step.
    pub parts: Vec<Part>,
    /// What the parts are held against.
    pub limits: Vec<Limit>,
}

/// The time of one part.
#[derive(Debug, Serialize)]
pub struct Part {
    /// What it is.
    pub name: String,
    /// Milliseconds.
    #[serde(flatten)]
    pub time: Summary,
}

/// A ratio of medians and what it may be at most.
#[derive(Debug, Serialize)]
pub struct Limit {
    /// What is compared with what.
    pub what: String,
    /// As measured.
    pub ratio: f64,
    /// At most.
    pub most: f64,
}

impl Costs {
    /// Adds a part, and returns its median.
    fn part(&mut self, name: &str, time: Summary) -> f64 {
        self.parts.push(Part { name: name.into(), time });
        time.median
    }

    /// Adds a comparison of `time` with `of`.
    fn limit(&mut self, what: &str, time: f64, of: f64, most: f64) {
        self.limits.push(Limit { what: what.into(), ratio: time / of, most });
    }
}

/// What all runs share.
struct Rig {
    context: Context,
    character: CharacterParts,
    frames: u32,
    clock: Clock,
}

/// The times of the stages in every frame of a run.
struct Rows(Vec<(&'static str, Vec<f64>)>);

/// The same hair in another way.
#[derive(Clone)]
struct Variant {
    options: HairOptions,
    physics: SimulationParams,
    colliders: Vec<(Collider, Pose)>,
}

impl Rows {
    /// A frame more.
    fn add(&mut self, times: Vec<(&'static str, f64)>) {
        for (name, ms) in times {
            match self.0.iter_mut().find(|(known, _)| *known == name) {
                Some((_, values)) => values.push(ms),
                None => self.0.push((name, vec![ms])),
            }
        }
    }

    /// The summed times of the named stages, frame by frame.
    fn sum(&self, names: &[&str]) -> Summary {
        let rows: Vec<_> = self.0.iter().filter(|(name, _)| names.contains(name)).collect();
        let frames = rows.iter().map(|(_, times)| times.len()).min().unwrap_or(0);
        Summary::of((0..frames).map(|i| rows.iter().map(|(_, times)| times[i]).sum()).collect())
    }
}

impl Rig {
    fn new(frames: u32, clock: Clock) -> Result<Self> {
        let context = pollster::block_on(Gpu::open())?.context;
        let mut preset = workload::style(Some(STRANDS), Default::default());
        preset.settings.set("style.guides", GUIDES)?;
        let character = pollster::block_on(preset.character(&context, &()))?;
        Ok(Self { context, character, frames, clock })
    }

    /// The times of each variant while the head turns. A frame of one, a frame of the next, and so
    /// on: whatever else the machine does, it does to all of them.
    fn run(&self, variants: &[Variant], bar: &ProgressBar) -> Result<Vec<Rows>> {
        let (context, tier) = (&self.context, self.context.tier());
        let mut timings = match tier.timestamps && !tier.software {
            true => Timings::new(context),
            false => Timings::by(self.clock),
        };
        let mut hairs = variants.iter().map(|v| self.hair(v)).collect::<Result<Vec<_>>>()?;
        let mut rows: Vec<Rows> = variants.iter().map(|_| Rows(Vec::new())).collect();
        let motion = Motion::named("turn").context("a built-in motion")?;
        for frame in 0..WARM_UP + self.frames {
            let head = motion.pose(f64::from(frame) / FPS, self.character.neck);
            // Half a step more before the first: rounding never drops a step.
            let dt = if frame == 0 { 1.5 / FPS } else { 1.0 / FPS } as f32;
            for ((variant, hair), rows) in variants.iter().zip(&mut hairs).zip(&mut rows) {
                let poses = variant.colliders.iter().map(|(_, pose)| *pose).collect();
                let colliders = &ColliderPoses { head: None, colliders: poses };
                let moment =
                    HairFrame { dt, head, colliders, simulation: &variant.physics, ..Default::default() };
                let mut encoder = context.device().create_command_encoder(&Default::default());
                let mut recorder = context.recorder(&mut encoder).with_timings(Some(&mut timings));
                recorder.advance(hair, &moment)?;
                timings.resolve(&mut encoder);
                context.queue().submit([encoder.finish()]);
                context.device().poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
                let times = pollster::block_on(timings.read(context))?;
                if frame >= WARM_UP {
                    rows.add(times);
                    bar.inc(1);
                }
            }
        }
        Ok(rows)
    }

    fn hair(&self, variant: &Variant) -> Result<Hair> {
        let colliders: Vec<_> = variant.colliders.iter().map(|(collider, _)| *collider).collect();
        let descriptor =
            ColliderDescriptor { head: self.character.whole(), colliders: &colliders, ..Default::default() };
        let groom = &self.character.groom;
        Ok(Hair::with_colliders(&self.context, groom, &variant.options, &descriptor)?)
    }

    /// `count` capsules the size of fingers around the neck and the shoulders, where the hair hangs.
    fn capsules(&self, count: u32) -> Vec<(Collider, Pose)> {
        let shape = Shape::Capsule { half_length: 0.03, radius: 0.01 };
        let capsule = |i: u32| {
            let angle = i as f32 * 2.399_963;
            let height = (i as f32 + 0.5) / count as f32;
            let at = Vec3::new(0.13 * angle.cos(), 0.15 - 0.3 * height, 0.13 * angle.sin());
            let collider = Collider { anchor: Anchor::Head, ..Collider::new(shape) };
            let pose = Pose { rotation: Quat::from_rotation_x(angle), translation: self.character.neck + at };
            (collider, pose)
        };
        (0..count).map(capsule).collect()
    }

    /// Milliseconds to build the distance field of the character's head.
    fn field(&self, resolution: u32) -> Result<Summary> {
        let head = self.character.head.as_ref().context("the character has a head")?;
        let options = SdfOptions { resolution, ..Default::default() };
        let mut times = Vec::new();
        while times.is_empty() || (times.len() < BUILDS && times.iter().sum::<f64>() < LONG) {
            let start = (self.clock)();
            sdf::build(head, &options)?;
            times.push((self.clock)().saturating_sub(start).as_secs_f64() * 1e3);
        }
        Ok(Summary::of(times))
    }
}

/// Measures all of it.
pub fn measure(Sitting { frames, clock, bar }: Sitting<'_>) -> Result<Costs> {
    let rig = Rig::new(frames, clock)?;
    let groom = &rig.character.groom;
    let mut costs = Costs {
        guides: groom.guides.len() as u32,
        guide_vertices: groom.guides.vertex_count,
        strands: groom.strands.len() as u32,
        frames,
        ..Costs::default()
    };
    let alone = Variant {
        options: HairOptions::default(),
        physics: SimulationParams { hair_hair: HairHair::OFF, ..Default::default() },
        colliders: Vec::new(),
    };
    let mut variants = [(); RUNS as usize].map(|()| alone.clone());
    let [_, dense, denser, windy, one, many] = &mut variants;
    for (variant, resolution) in [(dense, 32), (denser, 64)] {
        variant.options.volume = VolumeOptions { resolution, ..variant.options.volume };
        variant.physics.hair_hair = HairHair::default();
    }
    // The air needs to know where hair is: with the density, as in a picture.
    windy.physics.hair_hair = HairHair::default();
    windy.physics.wind = Wind { cells: 32, ..Wind::new(WIND) };
    for (variant, count) in [(one, 1), (many, 64)] {
        variant.colliders = rig.capsules(count);
    }
    let rows = rig.run(&variants, bar)?;
    let [alone, dense, denser, windy, one, many] = &rows[..] else { unreachable!("a row per variant") };
    let simulate = ["simulate"];
    let solve = costs.part("the guides' own solve", alone.sum(&simulate));
    costs.part("density, 32³", dense.sum(&["volume"]));
    costs.part("density, 64³", denser.sum(&["volume"]));
    costs.part("wind, 32³", windy.sum(&["wind"]));
    let air = costs.part("density and wind, 32³", windy.sum(&["volume", "wind"]));
    costs.limit("density and wind at 32³ / the guides' own solve", air, solve, 1.0);
    costs.part("solve with the forces of density and wind", windy.sum(&simulate));
    let interpolate = costs.part("interpolation", alone.sum(&["interpolate"]));
    let avoid = costs.part("avoidance", alone.sum(&["avoid"]));
    costs.limit("avoidance / interpolation", avoid, interpolate, 1.0);
    let one = costs.part("solve with 1 capsule", one.sum(&simulate));
    let many = costs.part("solve with 64 capsules", many.sum(&simulate));
    costs.limit("solve with 64 capsules / with 1", many, one, 2.0);

    for resolution in [64, 128] {
        let triangles = rig.character.head.as_ref().map_or(0, |head| head.triangles.len());
        let name = format!("distance field of the head ({triangles} triangles), {resolution}³");
        costs.part(&name, rig.field(resolution)?);
    }
    Ok(costs)
}
