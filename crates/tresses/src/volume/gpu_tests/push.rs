//! The effect of the grid on the hair.

use super::scene::{N, Setup, cube, somewhere, still};
use crate::{
    Pose,
    clock::{Mode, Step},
    collide::{Collider, ColliderDescriptor, Shape},
    volume::{HairHair, HairHairMode, VolumeOptions},
};
use glam::Vec3;

#[test]
fn at_rest_nothing_pushes_wherever_the_head_is() {
    let Some(mut scene) = Setup::new(cube(12), &Default::default()) else { return };
    for pose in [Pose::IDENTITY, somewhere()] {
        scene.put(&scene.moved(|p| pose.point(p)), &scene.moved(|_| Vec3::ZERO));
        let forces = scene.forces(&HairHair::default(), &still(pose));
        assert!(forces.iter().all(|f| f.acceleration == Vec3::ZERO));
        // It is there: friction would hold whatever moves.
        assert!(forces.iter().any(|f| f.rate > 1.0));
    }
    // And a lock that moves as a whole is not blown up: this much of it leaves the grid.
    scene.put(&scene.moved(|p| p + Vec3::X * 0.1), &scene.moved(|_| Vec3::ZERO));
    let forces = scene.forces(&HairHair::default(), &still(Pose::IDENTITY));
    let worst = forces.iter().map(|f| f.acceleration.length()).fold(0.0, f32::max);
    assert!(worst < 0.5, "{worst} m/s²");
}

/// The outward part of the push, mean over vertices 3 to 7 cm from the middle, and the part across.
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
fn hair_that_is_pressed_together_is_pushed_apart() {
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
fn an_obstacle_that_comes_into_hair_presses_it_away() {
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
    // Where it is when the hair is put to rest, it belongs to the rest.
    ball_at(center, Mode::Reset);
    let rested = ball_at(center, Mode::Step);
    assert!(rested.abs() < 1e-3, "{rested}");
}

#[test]
fn the_push_does_not_depend_on_the_resolution() {
    // The blur of 2 cm is wider than the guides' spacing and than the cells.
    let params = HairHair { friction: 0.0, blur: 0.025, ..Default::default() };
    let pushes = [24, 32, 64].map(|resolution| {
        let options = VolumeOptions { resolution, ..Default::default() };
        Setup::new(cube(24), &options).map(|mut scene| outward(&mut scene, &params, 0.6).0)
    });
    let [Some(a), Some(b), Some(c)] = pushes else { return };
    println!("{a}, {b}, {c} m/s² with 24, 32 and 64 cells");
    assert!((a / c - 1.0).abs() < 0.1 && (b / c - 1.0).abs() < 0.05);
}
