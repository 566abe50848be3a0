//! Dry friction: hair on an incline, and around a cylinder.

use super::{
    lab::{Experiment, Lab, bare, head_at, straight},
    table::{Row, at_most, judge, near},
};
use std::f32::consts::PI;
use tresses::{
    Pose, RestShape, SimulationParams,
    collide::{Collider, ColliderDescriptor, FieldId, FieldSource, Shape},
    glam::Vec3,
    groom::SdfGrid,
};

const G: f32 = 9.81;
/// Coulomb friction coefficient in all cases.
const MU: f32 = 0.4;

/// Creates hairs without stiffness, each on its own horizontal plane with its own friction coefficient. They lie across
/// the direction in which the planes will be tilted.
fn on_planes(lab: &'static Lab, n: usize, frictions: &[f32]) -> Experiment {
    let plane = SdfGrid::from_fn(Vec3::splat(-0.3), Vec3::splat(0.3), 31, |p| p.y);
    let middle = |i: usize| Vec3::X * 0.7 * (i as f32 - 0.5 * (frictions.len() - 1) as f32);
    let lying =
        |i: usize| straight(n, 0.2, Vec3::Z).into_iter().map(|p| p + middle(i) + Vec3::Y * 1.5e-3).collect();
    let strands: Vec<Vec<_>> = (0..frictions.len()).map(lying).collect();
    let params = SimulationParams { friction: 1.0, ..bare(0.0) };
    let plane_of =
        |friction: &f32| Collider { friction: *friction, ..Collider::new(Shape::Field(FieldId(0))) };
    let planes: Vec<_> = frictions.iter().map(plane_of).collect();
    let what =
        ColliderDescriptor { fields: &[FieldSource::Grid(&plane)], colliders: &planes, ..Default::default() };
    let at = (0..frictions.len()).map(|i| Pose { translation: middle(i), ..Pose::IDENTITY }).collect();
    let mut e =
        Experiment::new(lab, &strands, &[], params, RestShape::Natural, None).with_colliders(&what, at);
    e.run_still(20);
    e
}

/// Returns gravity relative to planes that are tilted by the angle with this tangent.
fn tilted(tangent: f32) -> Vec3 {
    Vec3::new(tangent, -1.0, 0.0).normalize() * G
}

fn incline(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let wrong = if fault { 1.05 } else { 1.0 };
    // The planes are tilted by the angle for `MU`. Their friction coefficients rise in steps of one hundredth.
    let ratios: Vec<f32> = (0..13).map(|i| 0.94 + 0.01 * i as f32).collect();
    let mut e = on_planes(lab, 3, &ratios.iter().map(|of| of * MU * wrong).collect::<Vec<_>>());
    let start = e.positions();
    e.params.gravity = tilted(MU);
    e.run_still(240);
    let slipped: Vec<f32> = start.iter().zip(e.positions()).map(|(a, b)| a[2].distance(b[2])).collect();
    let first = slipped.iter().position(|way| *way < 1e-3).expect("some stick");
    // Hair with more friction than hair that sticks does not slip.
    assert!(slipped[first..].iter().all(|way| *way < 1e-3));
    let least = if first == 0 { ratios[0] } else { 0.5 * (ratios[first - 1] + ratios[first]) };
    let mut rows = vec![near(
        "incline, coefficient by which hair just sticks, of the tangent",
        "",
        1.0,
        if fault && first == 0 { 0.9 } else { least },
        0.02,
    )];
    // Pushed along the plane, the tip slows down like a brick. The edge keeps it at its distance from the root.
    let mut e = on_planes(lab, 3, &[MU * wrong]);
    e.set_velocities(&[vec![Vec3::ZERO, Vec3::ZERO, Vec3::X]]);
    let steps = 3;
    e.run_still(steps);
    let lost = 1.0 - e.velocities()[0][2].length();
    let braked = lost / (steps as f32 * e.params.step);
    rows.push(near("sliding at 1 m/s on a plane, deceleration", "m/s²", f64::from(MU * G), braked, 0.03));
    let mut e = on_planes(lab, 16, &[MU]);
    e.params.gravity = tilted(MU * if fault { 1.2 } else { 0.95 });
    e.run_still(60);
    let before = e.positions();
    e.run_still(300);
    let after = e.positions();
    let moved = before[0].iter().zip(&after[0]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    rows.push(at_most("incline of 0.95 of that tangent, creep in 5 s", "mm", 0.02, moved * 1e3));
    rows
}

#[test]
pub fn hair_sticks_until_the_incline_is_too_steep() {
    judge("incline", incline);
}

/// Returns a hair that comes up from its root on the left, passes over a cylinder along z around the origin, and hangs
/// down on the right.
fn over(n: usize, a: f32, left: f32, right: f32) -> Vec<Vec3> {
    let length = left + PI * a + right;
    let at = |s: f32| {
        if s < left {
            return Vec3::new(-a, s - left, 0.0);
        }
        let phi = ((s - left) / a).min(PI);
        Vec3::new(-a * phi.cos(), a * phi.sin() - (s - left - PI * a).max(0.0), 0.0)
    };
    (0..n).map(|i| at(length * i as f32 / (n - 1) as f32)).collect()
}

fn capstan(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, radius, left, right) = (64, 0.02f32, 0.04f32, 0.35f32);
    let a = radius + 1.5e-3;
    let friction = MU * if fault { 1.1 } else { 1.0 };
    let (shape, pose) = Shape::capsule(Vec3::Z * -0.1, Vec3::Z * 0.1, radius);
    let mut rows = Vec::new();
    for (case, speed, mu) in [("pulled over", -0.01f32, MU), ("let down over", 0.01, -MU)] {
        let params = SimulationParams { friction, drag: 1.0, ..bare(0.0) };
        let strand = over(n, a, left, right);
        let mut e = Experiment::new(lab, &[strand], &[], params, RestShape::Natural, None).with_colliders(
            &ColliderDescriptor { colliders: &[Collider::new(shape)], ..Default::default() },
            vec![pose],
        );
        e.run_still(30);
        let steps = |from: usize, to: usize| -> Vec<_> {
            let at = |i: usize| head_at(Vec3::Y * speed * params.step * i as f32);
            (from..to).map(|i| super::lab::step(at(i), at(i + 1))).collect()
        };
        e.run_steps(&steps(0, 60));
        // Pull of the first edge over weight per length, averaged over the time in which several vertices move onto the
        // cylinder.
        let edge = e.rest.info[0].length / (n - 1) as f32;
        let rate = e.params.stretch_rate(e.rest.info[0].length, edge);
        let (mut pulls, mut exact, mut count) = (0.0, 0.0, 0);
        for i in 60..120 {
            e.run_steps(&steps(i, i + 1));
            let p = &e.positions()[0];
            let pull = rate * (p[1].distance(p[2]) - e.rest.shape[1].length) * edge / G;
            // Hanging lengths: on the right all hair below the axis, on the left the hair from the middle of the edge.
            let over = p.iter().rposition(|p| p.y > 0.0).unwrap();
            let hangs = p[over + 1..].windows(2).map(|w| w[0].distance(w[1])).sum::<f32>() - p[over + 1].y;
            let weight = (2.0 * mu * a) / (1.0 + mu * mu);
            let top = (hangs + weight) * (mu * PI).exp() + weight;
            pulls += pull;
            exact += top + 0.5 * (p[1].y + p[2].y);
            count += 1;
        }
        let (pulls, exact) = (pulls / count as f32, exact / count as f32);
        let case = format!("hair {case} a cylinder, half a turn, pull as length of hair");
        rows.push(near(case, "cm", f64::from(exact * 1e2), pulls * 1e2, 0.05));
    }
    rows
}

/// A software driver compiles the kernel of guides with 64 vertices for half a minute.
#[test]
#[ignore = "proof"]
fn hair_around_a_cylinder_follows_the_capstan_equation() {
    judge("capstan", capstan);
}
