//! Shadows against strands counted one by one, and at rest and in motion.

mod oracle;
mod tangle;

#[path = "../common/mod.rs"]
mod common;

use oracle::{Oracle, Truth};
use tangle::Tangle;
use tresses::{
    draw::{DrawOptions, DrawStage, HairSet, Scene, Targets},
    glam::Vec3,
    gpu::Gpu,
    light::{Directional, Lights, ShadowMethod, ShadowProbe, Shadows},
    math::hash::pcg,
};

const METHODS: [ShadowMethod; 3] =
    [ShadowMethod::Opaque, ShadowMethod::Absorption, ShadowMethod::DeepOpacity];

/// A tangle on the GPU, and points of its strands.
struct Bench {
    gpu: Gpu,
    stage: DrawStage,
    hair: HairSet,
    targets: Targets,
    probe: ShadowProbe,
    scene: Scene,
    points: Vec<(Vec3, u32)>,
}

impl Bench {
    fn new(gpu: Gpu, tangle: &Tangle, resolution: u32, count: u32) -> Self {
        let options = DrawOptions { samples: 1, shadow_resolution: resolution, ..Default::default() };
        let stage = DrawStage::new(&gpu.device, &options);
        let hair = HairSet::new(&gpu.device, &stage, &tangle.upload(&gpu)).expect("fits");
        let points = points(tangle, count);
        let places: Vec<_> = points.iter().map(|(at, _)| *at).collect();
        let probe = ShadowProbe::new(&gpu.device, &gpu.queue, &stage, &places).expect("fits");
        let targets = Targets::new(&gpu.device, 16, 16, 1, 1).expect("fits");
        let scene = Scene { focus: tangle.focus(), ..Default::default() };
        Self { gpu, stage, hair, targets, probe, scene, points }
    }

    /// The fibres before each point in light from `direction`.
    fn fibers(&mut self, direction: Vec3, shadows: Shadows) -> Vec<f32> {
        let irradiance = Vec3::ONE;
        self.scene.lights.directional = [Directional::OFF; 4];
        // Any place will do; what is off is skipped.
        self.scene.lights.directional[2] = Directional { direction, irradiance };
        self.scene.shadows = shadows;
        let Self { gpu: Gpu { device, queue, .. }, stage, hair, targets, probe, scene, .. } = self;
        let mut encoder = device.create_command_encoder(&Default::default());
        stage.prepare(queue, scene, targets, Some(hair), None);
        stage.shadow(&mut encoder, None, scene, Some(hair), None);
        probe.record(&mut encoder);
        queue.submit([encoder.finish()]);
        let answers = probe.read(device, queue).expect("answers");
        answers.iter().map(|lights| lights[0].fibers).collect()
    }
}

/// Points spread over all strands and all along them, and the strands they are on.
fn points(tangle: &Tangle, count: u32) -> Vec<(Vec3, u32)> {
    let n = tangle.vertex_count;
    let random = |i: u32, k: u32| (pcg(pcg(i) ^ k) >> 8) as f32 / 16_777_216.0;
    (0..count)
        .map(|i| {
            let strand = (random(i, 1) * tangle.len() as f32) as usize;
            let along = random(i, 2) * (n - 1) as f32;
            let first = strand * n + along as usize;
            let at = tangle.positions[first].lerp(tangle.positions[first + 1], along.fract());
            (at, strand as u32)
        })
        .collect()
}

/// Mean error of the share of light that meets no fibre.
fn error(fibers: &[f32], truth: &[Truth]) -> f32 {
    let sum: f32 = fibers.iter().zip(truth).map(|(n, truth)| ((-n).exp() - truth.transmittance).abs()).sum();
    sum / truth.len() as f32
}

#[test]
fn every_method_against_strands_counted_one_by_one() {
    let Some(gpu) = common::gpu() else { return };
    let mut gpu = Some(gpu);
    for style in ["long", "curly", "short"] {
        let tangle = Tangle::style(style, 4000);
        let mut bench =
            Bench::new(gpu.take().unwrap_or_else(|| common::gpu().expect("as before")), &tangle, 1024, 1500);
        if let Ok(path) = std::env::var("DUMP") {
            use std::fmt::Write;
            let mut text = format!("{} {}\n", tangle.len(), tangle.vertex_count);
            for (p, r) in tangle.positions.iter().zip(&tangle.radii) {
                writeln!(text, "{} {} {} {}", p.x, p.y, p.z, r).unwrap();
            }
            std::fs::write(format!("{path}/{style}.txt"), text).unwrap();
        }
        for direction in
            [Lights::default().directional[0].direction, Lights::default().directional[1].direction, Vec3::Y]
        {
            let oracle = Oracle::new(&tangle, direction);
            let shadows = Shadows::default();
            let truth: Vec<_> =
                bench.points.iter().map(|(at, own)| oracle.at(*at, *own, shadows.hair_radius, 200)).collect();
            let mean_t = truth.iter().map(|t| t.transmittance).sum::<f32>() / truth.len() as f32;
            let mean_n = truth.iter().map(|t| t.fibers).sum::<f32>() / truth.len() as f32;
            print!("{style} {direction:.2}: T {mean_t:.3} n {mean_n:.2}");
            let ideal: Vec<_> = truth.iter().map(|t| t.fibers).collect();
            print!(" ideal {:.4}", error(&ideal, &truth));
            for method in METHODS {
                let n = bench.fibers(direction, Shadows { method, ..shadows });
                let e = error(&n, &truth);
                let m = n.iter().sum::<f32>() / n.len() as f32;
                let t = n.iter().map(|n| (-n).exp()).sum::<f32>() / n.len() as f32;
                print!("  {method:?}: {e:.4} n {m:.2} T {t:.3}");
            }
            println!();
        }
    }
}
