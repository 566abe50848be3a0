//! What hair-hair forces do to a shaken style: the volume that its strands fill.
//!
//! `cargo test -p tresses --test volume -- --nocapture` prints the table of `docs/physics.md`.

mod common;

use std::collections::HashMap;
use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    collide::ColliderPoses,
    frame::{Frame, Recorder},
    glam::{IVec3, Quat, Vec3},
    gpu::{Gpu, readback},
    groom::styles::{self, Character, Style},
    simulate::SimulationParams,
    strands::StrandVertex,
    volume::{HairHair, HairHairMode},
};

/// Edge of the voxels in which strands are counted, metres.
const VOXEL: f32 = 0.01;

/// Seconds that the head shakes.
const SHAKE: f32 = 3.0;

/// The head's pose in a shake of 30 degrees to both sides, as in `tresses render --motion shake` but
/// without its rests.
fn shaken(t: f32, neck: Vec3) -> Pose {
    // Extremes 0.3 s apart, the first and the last way half as far.
    let t = (t * 3.1 / SHAKE).min(3.1);
    let smooth = |s: f32| s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let yaw = if t < 0.2 {
        smooth(t / 0.2)
    } else if t < 2.9 {
        let s = (t - 0.2) / 0.3;
        let side = if s as u32 % 2 == 0 { 1.0 } else { -1.0 };
        side * (1.0 - 2.0 * smooth(s.fract()))
    } else {
        smooth((t - 2.9) / 0.2) - 1.0
    };
    Pose::about(neck, Quat::from_rotation_y(30f32.to_radians() * yaw))
}

struct Stage {
    gpu: Gpu,
    renderer: HairRenderer,
    character: Character,
}

impl Stage {
    fn new(style: &str) -> Option<Self> {
        let gpu = common::gpu()?;
        let renderer = HairRenderer::new(&gpu.device, &Default::default());
        let style: Style = style.parse().unwrap();
        let character =
            styles::character(&gpu.device, &gpu.queue, &renderer.simulate, &style, Some(3000)).unwrap();
        Some(Self { gpu, renderer, character })
    }

    fn hair(&self, options: &HairOptions) -> Hair {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let Character { groom, field, .. } = &self.character;
        Hair::new(device, queue, &self.renderer, groom, options, Some(field)).unwrap()
    }

    fn advance(&self, hair: &mut Hair, simulation: &SimulationParams, head: Pose, dt: f32) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut encoder = device.create_command_encoder(&Default::default());
        let frame = Frame { dt, head, colliders: &ColliderPoses::default(), simulation };
        let renderer = &self.renderer;
        Recorder { renderer, device, queue, encoder: &mut encoder, timings: None }
            .advance(hair, &frame)
            .unwrap();
        queue.submit([encoder.finish()]);
    }

    /// Metres of drawn hair in every voxel, in the head's axes.
    fn voxels(&self, hair: &Hair, head: &Pose) -> HashMap<IVec3, f32> {
        let vertices: Vec<StrandVertex> =
            readback::buffer(&self.gpu.device, &self.gpu.queue, &hair.strands.vertices).unwrap();
        let back = head.inverse();
        let mut voxels = HashMap::new();
        for strand in vertices.chunks(hair.strands.vertex_count as usize) {
            for pair in strand.windows(2) {
                let (a, b) = (back.point(pair[0].position), back.point(pair[1].position));
                let length = a.distance(b);
                let parts = (length / 0.002).ceil().max(1.0);
                for i in 0..parts as u32 {
                    let p = a.lerp(b, (i as f32 + 0.5) / parts);
                    *voxels.entry((p / VOXEL).floor().as_ivec3()).or_default() += length / parts;
                }
            }
        }
        voxels
    }
}

#[test]
#[ignore]
fn explore() {
    let style = std::env::var("STYLE").unwrap_or("long".into());
    let Some(stage) = Stage::new(&style) else { return };
    let env = |name: &str, or: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(or);
    let d = HairHair::default();
    let gradient = HairHair {
        speed: env("SPEED", d.speed),
        tolerance: env("TOL", d.tolerance),
        blur: env("BLUR", d.blur),
        friction: env("FRICTION", d.friction),
        fixed: env("FIXED", d.fixed),
        ..d
    };
    let fixed = HairHair { mode: HairHairMode::Fixed, ..gradient };
    let all = [("off", HairHair::OFF), ("fixed", fixed), ("gradient", gradient)];
    for (name, hair_hair) in all {
        if std::env::var("MODES").is_ok_and(|m| !m.contains(name)) {
            continue;
        }
        let simulation = SimulationParams { hair_hair, ..Default::default() };
        let mut options = HairOptions::default();
        options.volume.resolution = env("RES", 32.0) as u32;
        let mut hair = stage.hair(&options);
        let dt = 1.0 / 60.0;
        let pose = |t: f32| shaken(t, stage.character.neck);
        stage.advance(&mut hair, &simulation, pose(0.0), 0.0);
        let thresholds = [0.0, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0];
        let rest = stage.voxels(&hair, &pose(0.0));
        let total: f32 = rest.values().sum();
        let mean = total / rest.len() as f32;
        let volumes = |v: &HashMap<IVec3, f32>| {
            thresholds.map(|t| v.values().filter(|l| **l > t * mean).count() as f32)
        };
        // Effective volume: (sum m)² / sum m².
        let effective = |v: &HashMap<IVec3, f32>| total * total / v.values().map(|m| m * m).sum::<f32>();
        let start = volumes(&rest);
        let eff0 = effective(&rest);
        println!(
            "{style} {name}: at rest {start:?} voxels, effective {eff0:.0}, mean {mean} m per voxel, cell {} ref {}",
            hair.volume.grid.cell,
            hair.volume.reference()
        );
        let mut sums = [[0f32; 8]; 6];
        let mut counts = [0; 6];
        for i in 1..=(5.0 / dt) as u32 {
            let t = i as f32 * dt;
            stage.advance(&mut hair, &simulation, pose(t), dt);
            let bin = match t {
                t if t < 2.0 => continue,
                t if t < SHAKE => 0,
                t if t < 3.3 => 1,
                t if t < 3.6 => 2,
                t if t < 4.0 => 3,
                t if t < 4.5 => 4,
                _ => 5,
            };
            if i % 3 != 0 {
                continue;
            }
            let v = stage.voxels(&hair, &pose(t));
            let now = volumes(&v);
            for k in 0..7 {
                sums[bin][k] += now[k] / start[k];
            }
            sums[bin][7] += effective(&v) / eff0;
            counts[bin] += 1;
        }
        for (bin, label) in ["2-3", "3-3.3", "3.3-3.6", "3.6-4", "4-4.5", "4.5-5"].iter().enumerate() {
            let row: Vec<_> =
                sums[bin].iter().map(|s| format!("{:6.1}", 100.0 * s / counts[bin] as f32)).collect();
            println!("{name:9} {label:8} {}", row.join(" "));
        }
        let v: Vec<[f32; 4]> =
            readback::buffer(&stage.gpu.device, &stage.gpu.queue, &hair.guides.velocity).unwrap();
        let speed = v.iter().map(|v| Vec3::from_slice(v).length());
        println!(
            "{name} speed at the end: max {} mean {}",
            speed.clone().fold(0.0, f32::max),
            speed.sum::<f32>() / v.len() as f32
        );
    }
}
