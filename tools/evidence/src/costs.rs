//! Cost of the parts of the simulation, measured in one run: 1,000 guides of 32 vertices of the built-in long style, in
//! motion.

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use serde::Serialize;
use tresses::{
    CharacterParts, Context, Gpu, HairHair, HairOptions, Pose, SimulationParams, Timings, Wind,
    collide::{Anchor, Collider, ColliderDescriptor, ColliderPoses, Shape},
    glam::{Quat, Vec3},
    groom::mesh::sdf::{self, SdfOptions},
    low_level::{Clock, Hair, HairAsset, HairDescriptor, HairFrame, VolumeOptions},
};
use tresses_cli::bench::{
    Sitting,
    results::{StageSamples, frame_range},
    statistics::Summary,
    table::{ms, table},
    workload,
};
use tresses_scene::{Motion, words::grouped};

/// Number of guides.
const GUIDES: u32 = 1000;
/// Number of strands interpolated from the guides.
const STRANDS: u32 = 16_000;
/// Warm-up frames.
const WARM_UP: u32 = 3;
/// Frames per second; each frame is one fixed step.
const FPS: f64 = 60.0;
/// Number of times a distance field is built, if that takes no longer than [`LONG`].
const BUILDS: usize = 3;
/// Time limit for building distance fields, milliseconds.
const LONG: f64 = 5000.0;
/// Wind in the variants with wind, m/s: a fresh breeze from the front.
const WIND: Vec3 = Vec3::new(0.0, 0.0, -8.0);
/// Number of variants.
pub const RUNS: u64 = 6;

/// Costs of the parts of the simulation.
#[derive(Debug, Default, Serialize)]
pub struct SimulationCosts {
    /// Number of guides.
    pub guides: u32,
    /// Vertices per guide.
    pub guide_vertices: u32,
    /// Number of drawn strands.
    pub strands: u32,
    /// Number of measured frames.
    pub frames: u32,
    /// Milliseconds per frame with one fixed step.
    pub parts: Vec<CostRow>,
    /// Ratios of the parts and their limits.
    pub limits: Vec<Limit>,
}

/// Time of one part.
#[derive(Debug, Serialize)]
pub struct CostRow {
    /// Name of the part.
    pub name: String,
    /// Milliseconds.
    #[serde(flatten)]
    pub time: Summary,
}

/// A ratio of medians and its limit.
#[derive(Debug, Serialize)]
pub struct Limit {
    /// Description of the ratio.
    pub what: String,
    /// Measured ratio.
    pub ratio: f64,
    /// Largest allowed ratio.
    #[serde(rename = "most")]
    pub max: f64,
}

impl SimulationCosts {
    /// Adds a part and returns its median.
    fn part(&mut self, name: &str, time: Summary) -> f64 {
        self.parts.push(CostRow { name: name.into(), time });
        time.median
    }

    /// Formats the costs of the simulation as tables.
    pub fn text(&self) -> String {
        let mut rows = vec![["", "median", "p95"].map(String::from).to_vec()];
        rows.extend(
            self.parts.iter().map(|part| vec![part.name.clone(), ms(part.time.median), ms(part.time.p95)]),
        );
        let text = format!(
            "\nSimulation costs (style long in motion, {} guides × {} vertices, {} strands, one fixed step, {})\n{}",
            grouped(self.guides.into()),
            self.guide_vertices,
            grouped(self.strands.into()),
            frame_range(std::iter::once(self.frames)),
            table(&rows)
        );
        let mut rows = vec![["ratio of medians", "measured", "at most"].map(String::from).to_vec()];
        rows.extend(
            self.limits
                .iter()
                .map(|l| vec![l.what.clone(), format!("{:.2}", l.ratio), format!("{:.2}", l.max)]),
        );
        text + &table(&rows)
    }

    /// Adds the ratio of `time` to `of`.
    fn limit(&mut self, what: &str, time: f64, of: f64, max: f64) {
        self.limits.push(Limit { what: what.into(), ratio: time / of, max });
    }
}

/// State shared by all runs.
struct Rig {
    context: Context,
    character: CharacterParts,
    frames: u32,
    clock: Clock,
}

/// The same hair with other options.
#[derive(Clone)]
struct Variant {
    options: HairOptions,
    physics: SimulationParams,
    colliders: Vec<(Collider, Pose)>,
}

impl Rig {
    fn new(frames: u32, clock: Clock) -> Result<Self> {
        let context = pollster::block_on(Gpu::open())?.context;
        let mut preset = workload::style(Some(STRANDS), Default::default());
        preset.settings.set("style.guides", GUIDES)?;
        let character = pollster::block_on(preset.character(&context, &()))?;
        Ok(Self { context, character, frames, clock })
    }

    /// Measures each variant while the head turns. The frames of the variants alternate, so that other programs on the
    /// machine slow all of them equally.
    fn run(&self, variants: &[Variant], bar: &ProgressBar) -> Result<Vec<StageSamples>> {
        let (context, tier) = (&self.context, self.context.tier());
        let mut timings = match tier.timestamps && !tier.software {
            true => Timings::new(context),
            false => Timings::by(self.clock),
        };
        let mut hairs = variants.iter().map(|v| self.hair(v)).collect::<Result<Vec<_>>>()?;
        let mut rows: Vec<StageSamples> = variants.iter().map(|_| StageSamples::default()).collect();
        let motion = Motion::named("turn").context("a built-in motion")?;
        for frame in 0..WARM_UP + self.frames {
            let head = motion.pose(f64::from(frame) / FPS, self.character.neck);
            // Half a step more in the first frame, so that rounding never drops a step.
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
        let colliders = ColliderDescriptor {
            head: self.character.body_field(),
            colliders: &colliders,
            ..Default::default()
        };
        let what = HairDescriptor { options: variant.options, colliders, ..Default::default() };
        Ok(Hair::new(&HairAsset::new(&self.context, self.character.groom.clone(), &what)?)?)
    }

    /// Returns `count` finger-sized capsules around the neck and shoulders, where the hair hangs.
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

    /// Measures the time to build the distance field of the character's head, milliseconds.
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

/// Measures all parts.
pub fn measure(Sitting { frames, clock, bar }: Sitting<'_>) -> Result<SimulationCosts> {
    let rig = Rig::new(frames, clock)?;
    let groom = &rig.character.groom;
    let mut costs = SimulationCosts {
        guides: groom.guides.len() as u32,
        guide_vertices: groom.guides.vertex_count,
        strands: groom.strands.len() as u32,
        frames,
        ..SimulationCosts::default()
    };
    let base = Variant {
        options: HairOptions::default(),
        physics: SimulationParams { hair_hair: HairHair::OFF, ..Default::default() },
        colliders: Vec::new(),
    };
    let mut variants = [(); RUNS as usize].map(|()| base.clone());
    let [_, dense, denser, windy, one, many] = &mut variants;
    for (variant, resolution) in [(dense, 32), (denser, 64)] {
        variant.options.volume = VolumeOptions { resolution, ..variant.options.volume };
        variant.physics.hair_hair = HairHair::default();
    }
    // As in a render, the wind is measured with the density, which it needs.
    windy.physics.hair_hair = HairHair::default();
    windy.physics.wind = Wind { resolution: 32, ..Wind::new(WIND) };
    for (variant, count) in [(one, 1), (many, 64)] {
        variant.colliders = rig.capsules(count);
    }
    let rows = rig.run(&variants, bar)?;
    let [base, dense, denser, windy, one, many] = &rows[..] else { unreachable!("a row per variant") };
    let simulate = ["simulate"];
    let solve = costs.part("guide solve", base.sum(&simulate));
    costs.part("density, 32³", dense.sum(&["volume"]));
    costs.part("density, 64³", denser.sum(&["volume"]));
    costs.part("wind, 32³", windy.sum(&["wind"]));
    let air = costs.part("density and wind, 32³", windy.sum(&["volume", "wind"]));
    costs.limit("density and wind at 32³ / guide solve", air, solve, 1.0);
    costs.part("solve with the forces of density and wind", windy.sum(&simulate));
    let interpolate = costs.part("interpolation", base.sum(&["interpolate"]));
    let avoid = costs.part("avoidance", base.sum(&["avoid"]));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_show_medians_and_ratios() {
        let costs = SimulationCosts {
            guides: 1000,
            parts: vec![CostRow { name: "solve".into(), time: Summary { median: 4.0, p95: 6.0 } }],
            limits: vec![Limit { what: "density / solve".into(), ratio: 0.25, max: 1.0 }],
            ..SimulationCosts::default()
        };
        let text = costs.text();
        let line = |name: &str| text.lines().find(|line| line.trim_start().starts_with(name)).unwrap();
        assert!(line("solve").contains("4.00") && line("density / solve").contains("0.25"), "{text}");
        assert_eq!(serde_json::to_value(costs).unwrap()["parts"][0]["median"], 4.0);
    }
}
