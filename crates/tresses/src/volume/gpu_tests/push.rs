//! Forces of the grid on the hair.

use super::scene::{N, Setup, cube, somewhere, still};
use crate::{
    Pose,
    clock::{Mode, Step},
    collide::{Collider, ColliderDescriptor, Shape},
    volume::{HairHair, HairHairMode, VolumeOptions},
};
use glam::Vec3;

#[test]
fn rest_pose_has_no_push_at_any_head_pose() {
    let Some(mut scene) = Setup::new(cube(12), &Default::default()) else { return };
    for pose in [Pose::IDENTITY, somewhere()] {
        scene.put(&scene.moved(|p| pose.point(p)), &scene.moved(|_| Vec3::ZERO));
        let forces = scene.forces(&HairHair::default(), &still(pose));
        assert!(forces.iter().all(|f| f.acceleration == Vec3::ZERO));
        // The grid is active: friction would brake moving hair.
        assert!(forces.iter().any(|f| f.rate > 1.0));
    }
    // A lock that moves as a whole does not expand, although part of it is outside the grid here.
    scene.put(&scene.moved(|p| p + Vec3::X * 0.1), &scene.moved(|_| Vec3::ZERO));
    let forces = scene.forces(&HairHair::default(), &still(Pose::IDENTITY));
    let worst = forces.iter().map(|f| f.acceleration.length()).fold(0.0, f32::max);
    assert!(worst < 0.5, "{worst} m/s²");
}

/// Returns the mean outward and tangential components of the push, over vertices 3 to 7 cm from the center.
pub(super) fn outward(scene: &mut Setup, params: &HairHair, shrink: f32) -> (f32, f32) {
    let current = scene.moved(|p| shrink * p);
    scene.put(&current, &scene.moved(|_| Vec3::ZERO));
    let forces = scene.forces(params, &still(Pose::IDENTITY));
    let judged: Vec<_> = current
        .iter()
        .zip(&forces)
        .filter(|(p, _)| (0.03..0.07).contains(&p.length()))
        .map(|(p, f)| {
            let out = f.acceleration.dot(p.normalize());
            (out, (f.acceleration - out * p.normalize()).length())
        })
        .collect();
    assert!(judged.len() > 50);
    let mean = |pick: fn(&(f32, f32)) -> f32| judged.iter().map(pick).sum::<f32>() / judged.len() as f32;
    (mean(|j| j.0), mean(|j| j.1))
}

#[test]
fn compressed_hair_is_pushed_apart() {
    let Some(mut scene) = Setup::new(cube(16), &Default::default()) else { return };
    let gradient = HairHair { friction: 0.0, ..Default::default() };
    let (out, across) = outward(&mut scene, &gradient, 0.5);
    println!("half the size: {out} m/s² outwards, {across} across");
    assert!(out > 1.0 && across < 0.7 * out);
    let (loose, _) = outward(&mut scene, &gradient, 1.3);
    assert!(loose.abs() < 0.01, "hair that spread is left alone: {loose}");
    let fixed = HairHair { mode: HairHairMode::Fixed, ..Default::default() };
    let (out, _) = outward(&mut scene, &fixed, 0.5);
    println!("fixed magnitude: {out} m/s² outwards of {}", fixed.fixed);
    assert!(out > 0.3 && out <= fixed.fixed);
}

#[test]
fn intruding_obstacle_pushes_hair_away() {
    let ball = [Collider::new(Shape::sphere(0.05))];
    let what = ColliderDescriptor { colliders: &ball, ..Default::default() };
    let (positions, traits) = cube(16);
    let Some(mut scene) = Setup::with(positions, traits, N, &Default::default(), &what) else { return };
    let pose = somewhere();
    let params = HairHair { friction: 0.0, ..Default::default() };
    let center = Vec3::new(0.04, 0.0, -0.03);
    let mut ball_at = |local: Vec3, mode: Mode| {
        scene.places = vec![Pose { translation: pose.point(local), ..Pose::IDENTITY }];
        let current = scene.moved(|p| pose.point(p));
        scene.put(&current, &scene.moved(|_| Vec3::ZERO));
        let forces = scene.forces(&params, &Step { mode, ..still(pose) });
        let rest = scene.moved(|p| p);
        let shell = rest.iter().zip(&forces).filter(|(p, _)| (0.05..0.065).contains(&p.distance(center)));
        let out: Vec<_> =
            shell.map(|(p, f)| f.acceleration.dot(pose.rotation * (*p - center).normalize())).collect();
        assert!(out.len() > 20);
        out.iter().sum::<f32>() / out.len() as f32
    };
    let away = ball_at(Vec3::X, Mode::Step);
    let inside = ball_at(center, Mode::Step);
    println!("{away} m/s² without the ball, {inside} around it");
    assert!(away.abs() < 1e-3 && inside > 0.3);
    // An obstacle that is in the hair at a reset belongs to the rest state.
    ball_at(center, Mode::Reset);
    let rested = ball_at(center, Mode::Step);
    assert!(rested.abs() < 1e-3, "{rested}");
}

#[test]
fn push_is_independent_of_resolution() {
    // A blur of 2.5 cm is wider than the guides' spacing and than the cells.
    let params = HairHair { friction: 0.0, blur: 0.025, ..Default::default() };
    let pushes = [24, 32, 64].map(|resolution| {
        let options = VolumeOptions { resolution, ..Default::default() };
        Setup::new(cube(24), &options).map(|mut scene| outward(&mut scene, &params, 0.6).0)
    });
    let [Some(a), Some(b), Some(c)] = pushes else { return };
    println!("{a}, {b}, {c} m/s² with 24, 32 and 64 cells");
    assert!((a / c - 1.0).abs() < 0.1 && (b / c - 1.0).abs() < 0.05);
}
