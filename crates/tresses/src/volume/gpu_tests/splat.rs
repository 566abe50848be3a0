//! Splatted hair in the grid.

use super::scene::{H, N, Setup, cube, somewhere, still, swirl};
use crate::{
    Pose,
    clock::{Mode, Step},
    gpu::for_tests as context,
    strands::RestGuides,
    volume::{HairHair, VolumeAsset, VolumeOptions},
};
use glam::{DVec3, Vec3};

/// Same value as in the shaders, m/s.
const MAX_SPEED: f32 = 32.0;
/// Same value as in the shaders.
const CHANNELS: usize = 8;

#[test]
fn splat_conserves_hair_and_momentum_and_their_moments() {
    let Some(mut scene) = Setup::new(cube(12), &Default::default()) else { return };
    let pose = somewhere();
    let current = scene.moved(|p| pose.point(0.9 * p + Vec3::new(0.01, 0.0, 0.02)));
    let velocity = scene.moved(swirl);
    scene.put(&current, &velocity);
    let found = scene.splatted(&still(pose));

    let g = scene.volume.base;
    let mass = |i: usize| {
        let (v, info) = (i / 144, &scene.rest.info[i % 144]);
        let end = if v == 0 || v + 1 == N { 0.5 } else { 1.0 };
        info.strands * info.length / (N - 1) as f32 * end
    };
    let total = |channel: usize| found.chunks(CHANNELS).map(|c| f64::from(c[channel])).sum::<f64>();
    let meters: f64 = (0..144 * N).map(|i| f64::from(mass(i))).sum();
    let hair = total(3) / f64::from(g.units);
    println!("{meters} m of hair, {hair} m in the grid");
    assert!((hair / meters - 1.0).abs() < 1e-5);
    for axis in 0..3 {
        let exact: f64 = velocity.iter().enumerate().map(|(i, v)| f64::from(mass(i) * v[axis])).sum();
        let momentum = total(axis) * f64::from(MAX_SPEED) / f64::from(g.units);
        println!("momentum {axis}: {exact} m²/s, {momentum} in the grid");
        assert!((momentum - exact).abs() < 2e-6 * meters, "{axis}");
    }

    // The position of each vertex in cells. Weights that are linear between two cells keep the first moment, and add
    // f (1 − f) to the second.
    let n = g.resolution as usize;
    let index = |i: usize| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64);
    let back = pose.inverse();
    let at = |i: usize| ((back.point(current[i]) * g.scale + g.bias) * n as f32 - 0.5).as_dvec3();
    // Returns the largest error of a moment, relative to all hair, if one vertex were faster by `disturb` m/s.
    let off = |disturb: f32| {
        let mut first = [DVec3::ZERO; 4];
        let mut second = DVec3::ZERO;
        for (i, cell) in found.chunks(CHANNELS).enumerate() {
            let speeds = [MAX_SPEED, MAX_SPEED, MAX_SPEED, 1.0];
            let shares = [0, 1, 2, 3].map(|k| f64::from(cell[k]) * f64::from(speeds[k] / g.units) / meters);
            (0..4).for_each(|k| first[k] += shares[k] * index(i));
            second += shares[3] * index(i) * index(i);
        }
        for (i, velocity) in velocity.iter().enumerate() {
            let (share, x) = (f64::from(mass(i)) / meters, at(i));
            let speed = *velocity + Vec3::Y * if i == 100 { disturb } else { 0.0 };
            (0..4).for_each(|k| first[k] -= share * f64::from(speed.extend(1.0)[k]) * x);
            let f = x - x.floor();
            second -= share * (x * x + f * (1.0 - f));
        }
        // Positions are rounded to some hundred-thousandths of a cell, which counts more in squares.
        first
            .iter()
            .map(|moment| moment.abs().max_element())
            .fold(0.05 * second.abs().max_element(), f64::max)
    };
    println!("moments are off by {:e}", off(0.0));
    assert!(off(0.0) < 1e-4, "{}", off(0.0));
    assert!(off(1.0) > 1e-3, "the comparison sees one vertex that is 1 m/s faster");
}

#[test]
fn splat_is_bit_identical_for_any_guide_order() {
    let (positions, traits) = cube(12);
    let Some(mut scene) = Setup::new((positions.clone(), traits.clone()), &Default::default()) else {
        return;
    };
    let backwards = positions.chunks(N).rev().flatten().copied().collect();
    let mut other = Setup::new((backwards, traits.into_iter().rev().collect()), &Default::default()).unwrap();
    for scene in [&mut scene, &mut other] {
        scene.put(&scene.moved(|p| 0.8 * p), &scene.moved(swirl));
    }
    let step = still(Pose::IDENTITY);
    let first = scene.splatted(&step);
    assert_eq!(first, other.splatted(&step));
    assert_eq!(first, scene.splatted(&step));
    scene.put(&scene.moved(|p| 0.8 * p + Vec3::X * 1e-4), &scene.moved(swirl));
    assert_ne!(first, scene.splatted(&step));
}

#[test]
fn cell_velocity_matches_its_hair() {
    let Some(mut scene) = Setup::new(cube(16), &Default::default()) else { return };
    // A head that moves as fast as a car does not reach the limit of splatted velocities.
    let way = Vec3::new(50.0, 0.0, 1.0);
    let (begin, end) = (Pose::IDENTITY, Pose { translation: way * H, ..Pose::IDENTITY });
    let own = |p: Vec3| way + 3.0 * Vec3::new(p.y, -p.x, 0.0);
    scene.put(&scene.moved(|p| p), &scene.moved(own));
    let params = HairHair { friction: 10.0, ..Default::default() };
    scene.forces(&params, &Step { mode: Mode::Step, begin, end, from: 0.0, to: 1.0 });
    let grid = scene.volume.grid;
    let texels = scene.texture(scene.volume.hair.texture());
    let n = grid.resolution as usize;
    let (mut worst, mut meters, mut count) = (0f32, 0.0, 0);
    for (i, texel) in texels.iter().enumerate() {
        let c = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) + 0.5;
        let p = grid.origin + c * grid.cell;
        meters += texel[3] * grid.cell.powi(3) * 1e3;
        if p.abs().max_element() < 0.08 {
            worst = worst.max(Vec3::from_slice(texel).distance(own(p)));
            count += 1;
        }
    }
    println!("{count} cells, {worst} m/s off at most; {meters} m of hair");
    // Guides of different weights are 1.5 cm apart in a flow that changes by 3 m/s per m: 45 mm/s.
    assert!(count > 500 && worst < 0.08);
    let exact: f32 = scene.rest.info.iter().map(|i| i.strands * i.length).sum();
    // The blur's tail beyond the grid is lost; here the hair fills the grid to its margins.
    assert!((meters / exact - 1.0).abs() < 0.02, "{meters} of {exact}");
}

#[test]
fn outliers_and_nan_do_not_affect_other_hair() {
    let Some(mut scene) = Setup::new(cube(12), &Default::default()) else { return };
    let mut current = scene.moved(|p| 0.6 * p);
    let velocity = scene.moved(|_| Vec3::ZERO);
    let step = still(Pose::IDENTITY);
    let wrong = [Vec3::X * 1e3, Vec3::splat(-1e30), Vec3::Y * f32::INFINITY, Vec3::NAN];
    // Replace four vertices by harmless outliers, then by invalid values: the other forces stay equal.
    let forces = [[Vec3::X * 2.0; 4], wrong].map(|bad| {
        current[..4].copy_from_slice(&bad);
        scene.put(&current, &velocity);
        let forces = scene.forces(&HairHair::default(), &step);
        assert!(forces[..4].iter().all(|f| f.acceleration == Vec3::ZERO && f.rate == 0.0), "{bad:?}");
        forces
    });
    assert_eq!(forces[0], forces[1]);
    assert!(forces[0].iter().any(|f| f.acceleration.length() > 1.0));
}

#[test]
fn invalid_resolutions_return_errors() {
    let Some(context) = context() else { return };
    for resolution in [0, 7, 97, u32::MAX] {
        let options = VolumeOptions { resolution, ..Default::default() };
        let error = VolumeAsset::new(context, &RestGuides::default(), &options, None).unwrap_err();
        assert!(error.to_string().contains("grid resolution"));
    }
}
