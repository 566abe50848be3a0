//! Error and cost of splatting many guides with few samples.

use super::{
    push::outward,
    scene::{N, Setup, cube, still, swirl},
};
use crate::{
    Pose,
    simulate::{Simulation, SimulationParams},
    volume::{HairHair, VolumeOptions},
};
use glam::Vec3;

#[test]
fn splatting_every_third_guide_keeps_push() {
    let few = VolumeOptions { max_samples: 24 * 24 * N as u32 / 3, ..Default::default() };
    let params = HairHair { friction: 0.0, ..Default::default() };
    let all = VolumeOptions { max_samples: u32::MAX, ..Default::default() };
    let pushes = [all, few].map(|options| {
        Setup::new(cube(24), &options).map(|mut scene| {
            assert_eq!(scene.volume.base.stride, if options == few { 3 } else { 1 });
            outward(&mut scene, &params, 0.5).0
        })
    });
    let [Some(all), Some(some)] = pushes else { return };
    println!("{all} m/s² with all guides, {some} with a third");
    assert!((some / all - 1.0).abs() < 0.1);
}

/// A thousand guides of [`LONG`] vertices that hang from a ball, with edges of 1 cm.
fn lock() -> Vec<Vec3> {
    let mut seed = 1u32;
    let mut random = || {
        seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    (0..1000)
        .flat_map(|_| {
            let root = 0.1 * Vec3::new(random() - 0.5, random(), random() - 0.5).normalize();
            let side = Vec3::new(random() - 0.5, 0.0, random() - 0.5) * 0.002;
            (0..LONG).map(move |i| root + (Vec3::NEG_Y * 0.01 + side) * i as f32).collect::<Vec<_>>()
        })
        .collect()
}

/// Vertices per guide of [`lock`].
const LONG: usize = 32;

#[test]
fn samples_of_two_vertices_match_single_vertices() {
    let step = still(Pose::IDENTITY);
    // Returns density, momentum and push of all cells, with `together` vertices per sample.
    let grids = |most_splatted: u32, together: u32| {
        let options =
            VolumeOptions { max_samples: most_splatted * LONG.div_ceil(2) as u32, ..Default::default() };
        let mut scene = Setup::with(lock(), Vec::new(), LONG, &options, &Default::default())?;
        let base = &mut scene.volume.base;
        assert_eq!(base.vertices_per_sample, 2);
        (base.vertices_per_sample, base.samples) = (together, (LONG as u32).div_ceil(together));
        // A wavy, compressed lock.
        let place = |p: Vec3| 0.8 * p + 0.02 * Vec3::new((40.0 * p.y).sin(), 0.0, (33.0 * p.y + p.x).cos());
        scene.put(&scene.moved(place), &scene.moved(swirl));
        scene.forces(&HairHair::default(), &step);
        let push = scene.texture(scene.volume.push.texture());
        let hair = scene.texture(scene.volume.hair.texture());
        let values = |pick: fn(&[f32; 4]) -> Vec3, of: &[[f32; 4]]| of.iter().map(pick).collect::<Vec<_>>();
        Some([
            values(|t| Vec3::X * t[3], &hair),
            values(|t| t[3] * Vec3::from_slice(t), &hair),
            values(|t| Vec3::from_slice(t), &push),
        ])
    };
    let Some(all) = grids(1000, 1) else { return };
    let off = |guides, together| {
        let some = grids(guides, together).unwrap();
        [0, 1, 2].map(|i| {
            let square = |v: Vec3| f64::from(v.length_squared());
            let wrong: f64 = all[i].iter().zip(&some[i]).map(|(a, b)| square(*a - *b)).sum();
            (wrong / all[i].iter().map(|a| square(*a)).sum::<f64>()).sqrt()
        })
    };
    let [same, pairs, quarter, both] = [off(1000, 1), off(1000, 2), off(250, 1), off(250, 2)];
    println!(
        "density, momentum, push off by: pairs {pairs:.4?}, a quarter of the guides {quarter:.4?}, both {both:.4?}"
    );
    assert_eq!(same, [0.0; 3]);
    for i in 0..3 {
        assert!(pairs[i] < [0.02, 0.02, 0.05][i], "{i}");
        assert!(both[i] < 1.05 * quarter[i], "{i}");
    }
}

/// Returns the time of the fastest of 40 runs, ms. Each run is waited for.
fn quickest(scene: &mut Setup, mut record: impl FnMut(&mut Setup, &mut crate::gpu::ComputePass<'_>)) -> f64 {
    (0..40)
        .map(|_| {
            let start = std::time::Instant::now();
            scene.submit(&mut record);
            scene.context.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
            start.elapsed().as_secs_f64() * 1e3
        })
        .fold(f64::MAX, f64::min)
}

/// Run with `cargo test -p tresses --lib volume -- --ignored --nocapture cost`.
#[test]
#[ignore = "proof"]
fn cost_of_a_thousand_guides() {
    let n = LONG;
    for resolution in [32, 64] {
        let positions = lock();
        let options = VolumeOptions { resolution, ..Default::default() };
        let Some(mut scene) = Setup::with(positions, Vec::new(), n, &options, &Default::default()) else {
            return;
        };
        let step = still(Pose::IDENTITY);
        scene.forces(&HairHair::default(), &step);
        // Prepare again: now the obstacles are at rest.
        scene.prepare(&HairHair::default(), &step);
        let params = SimulationParams::default();
        let mut solve = Simulation::new(scene.context, &scene.guides);
        solve.prepare(&params, &[step], false).unwrap();
        let nothing = quickest(&mut scene, |_, _| ());
        let solve = quickest(&mut scene, |s, pass| solve.record(pass, &s.colliders, 0));
        let splat = quickest(&mut scene, |s, pass| {
            let workgroups = s.volume.base.splat_workgroups();
            s.volume.pipelines.splat.record(pass, &s.volume.groups.splat, &[0], workgroups);
        });
        for (i, name) in ["sum", "blur_x", "blur_y", "density", "push"].iter().enumerate() {
            let ms = quickest(&mut scene, |s, pass| {
                let (stage, groups) = (&*s.volume.pipelines, &s.volume.groups);
                let (kernel, group, cells) = [
                    (&stage.sum, &groups.sum, [1, 1, 1]),
                    (&stage.blur[0], &groups.blur[0], [4, 1, 1]),
                    (&stage.blur[1], &groups.blur[1], [1, 4, 1]),
                    (&stage.density, &groups.density, [1, 1, 4]),
                    (&stage.push, &groups.push, [1, 1, 1]),
                ][i];
                kernel.record_grid(pass, group, &[0], s.volume.tiles(cells));
            });
            println!("  {name} {:.2} ms", ms - nothing);
        }
        let grid = quickest(&mut scene, |s, pass| s.volume.record(pass, &s.colliders, 0));
        let forces = quickest(&mut scene, |s, pass| s.forces.record(pass, 0));
        println!(
            "{resolution}³, 1,000 guides of 32: solve {:.2} ms; splat {:.2}, whole volume {:.2}, forces {:.2}",
            solve - nothing,
            splat - nothing,
            grid - nothing,
            forces - nothing,
        );
    }
}
