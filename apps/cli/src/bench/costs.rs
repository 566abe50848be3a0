//! What the parts of the simulation cost, held against each other in one run: 1,000 guides of 32
//! vertices, chosen among the strands of the built-in long style, in motion.

use super::{report::Adapter, statistics::Summary};
use crate::{
    args::{Guides, Source},
    interrupt,
    load::{self, Character},
    motion::Motion,
};
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use serde::Serialize;
use std::time::Instant;
use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    collide::{Anchor, Collider, ColliderDescriptor, ColliderPoses, Shape},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::{Gpu, Timings},
    groom::mesh::sdf::{self, SdfOptions},
    simulate::SimulationParams,
    volume::{HairHair, VolumeOptions},
};

/// Guides of the measured hair.
const GUIDES: u32 = 1000;
/// Strands that hang on them.
const STRANDS: u32 = 16_000;
/// Frames before the first that counts.
const WARM_UP: u32 = 3;
/// Frames per second: one fixed step each.
const FPS: f64 = 60.0;
/// How many times a distance field is built.
const BUILDS: u32 = 3;
/// What is measured, for the bar of progress.
pub const RUNS: u64 = 5;

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
    gpu: Gpu,
    renderer: HairRenderer,
    character: Character,
    frames: u32,
}

/// The times of the stages in every frame of a run.
struct Rows(Vec<(&'static str, Vec<f64>)>);

impl Rows {
    /// The summed times of the named stages, frame by frame.
    fn sum(&self, names: &[&str]) -> Summary {
        let rows: Vec<_> = self.0.iter().filter(|(name, _)| names.contains(name)).collect();
        let frames = rows.iter().map(|(_, times)| times.len()).min().unwrap_or(0);
        Summary::of((0..frames).map(|i| rows.iter().map(|(_, times)| times[i]).sum()).collect())
    }
}

impl Rig {
    fn new(frames: u32) -> Result<Self> {
        let gpu = pollster::block_on(Gpu::open())?;
        let renderer = HairRenderer::new(&gpu.device, &Default::default());
        let source = Source {
            style: Some("long".into()),
            guides: Some(Guides::Count(GUIDES)),
            strands: Some(STRANDS),
            ..Source::default()
        };
        let character = load::load(&source, &gpu, &renderer.simulate)?;
        Ok(Self { gpu, renderer, character, frames })
    }

    /// The hair among `colliders` while the head turns.
    fn run(
        &self,
        options: &HairOptions,
        physics: &SimulationParams,
        colliders: &[(Collider, Pose)],
    ) -> Result<Rows> {
        let Gpu { device, queue, tier, .. } = &self.gpu;
        let (shapes, poses): (Vec<_>, Vec<_>) = colliders.iter().copied().unzip();
        let descriptor = ColliderDescriptor {
            head: self.character.field.as_ref(),
            colliders: &shapes,
            ..Default::default()
        };
        let groom = &self.character.groom;
        let mut hair = Hair::with_colliders(device, queue, &self.renderer, groom, options, &descriptor)?;
        let mut timings = match tier.timestamps && !tier.software {
            true => Timings::new(device, queue),
            false => Timings::by_the_clock(),
        };
        let motion = Motion::named("turn").context("a built-in motion")?;
        let poses = ColliderPoses { head: None, colliders: poses };
        let mut rows = Rows(Vec::new());
        for frame in 0..WARM_UP + self.frames {
            interrupt::check()?;
            let head = motion.pose(f64::from(frame) / FPS, self.character.neck);
            // Half a step more before the first: rounding never drops a step.
            let dt = if frame == 0 { 1.5 / FPS } else { 1.0 / FPS } as f32;
            let moment = Frame { dt, head, colliders: &poses, simulation: physics };
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut recorder = Recorder {
                renderer: &self.renderer,
                device,
                queue,
                encoder: &mut encoder,
                timings: Some(&mut timings),
            };
            recorder.advance(&mut hair, &moment)?;
            timings.resolve(&mut encoder);
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
            let times = timings.read(device, queue)?;
            if frame < WARM_UP {
                continue;
            }
            for (name, ms) in times {
                match rows.0.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, values)) => values.push(ms),
                    None => rows.0.push((name, vec![ms])),
                }
            }
        }
        Ok(rows)
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
        let build = |_| {
            interrupt::check()?;
            let start = Instant::now();
            sdf::build(head, &options)?;
            Ok(start.elapsed().as_secs_f64() * 1e3)
        };
        Ok(Summary::of((0..BUILDS).map(build).collect::<Result<_>>()?))
    }
}

/// Measures all of it.
pub fn measure(frames: u32, bar: &ProgressBar) -> Result<(Costs, Adapter)> {
    let rig = Rig::new(frames)?;
    let groom = &rig.character.groom;
    let mut costs = Costs {
        guides: groom.guides.len() as u32,
        guide_vertices: groom.guides.vertex_count,
        strands: groom.strands.len() as u32,
        frames,
        ..Costs::default()
    };
    let options = HairOptions::default();
    let physics = SimulationParams { hair_hair: HairHair::OFF, ..Default::default() };
    let step = || bar.inc(u64::from(frames));

    let alone = rig.run(&options, &physics, &[])?;
    step();
    let solve = costs.part("the guides' own solve", alone.sum(&["simulate"]));
    costs.part("interpolation", alone.sum(&["interpolate"]));

    let dense = SimulationParams { hair_hair: HairHair::default(), ..physics };
    for resolution in [32, 64] {
        let volume = VolumeOptions { resolution, ..options.volume };
        let rows = rig.run(&HairOptions { volume, ..options }, &dense, &[])?;
        step();
        let density = costs.part(&format!("density, {resolution}³"), rows.sum(&["volume"]));
        if resolution == 32 {
            costs.limit("density at 32³ / the guides' own solve", density, solve, 1.0);
        }
    }

    let one = rig.run(&options, &physics, &rig.capsules(1))?.sum(&["simulate"]);
    step();
    let many = rig.run(&options, &physics, &rig.capsules(64))?.sum(&["simulate"]);
    step();
    let one = costs.part("solve with 1 capsule", one);
    let many = costs.part("solve with 64 capsules", many);
    costs.limit("solve with 64 capsules / with 1", many, one, 2.0);

    for resolution in [64, 128] {
        let triangles = rig.character.head.as_ref().map_or(0, |head| head.triangles.len());
        let name = format!("distance field of the head ({triangles} triangles), {resolution}³");
        costs.part(&name, rig.field(resolution)?);
    }
    Ok((costs, Adapter::of(&rig.gpu)))
}
