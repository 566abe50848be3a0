//! Hair that twists: springs and bows, whose wire twists as they yield.

use super::{
    lab::{Experiment, Lab, bare, lab},
    table::{Row, judge, judge_some, near},
};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use tresses::{
    Pose, RestShape, SimulationParams,
    glam::{Quat, Vec3},
};

/// Bending stiffness, N·m².
const BENDING: f32 = 8e-9;

/// Returns a helix of radius 1 cm about a line that hangs down, with three turns of 8 mm pitch.
fn helix(n: usize) -> Vec<Vec3> {
    let at = |i: usize| {
        let t = i as f32 / (n - 1) as f32;
        let a = 3.0 * TAU * t;
        Vec3::new(0.01 * a.sin(), -0.024 * t, 0.01 * (1.0 - a.cos()))
    };
    (0..n).map(at).collect()
}

/// Returns how far the tip of a spring sinks along gravity, by Castigliano's theorem: the moments of the weights below
/// each vertex, times the moments of a unit load at the tip, over the stiffness.
fn sinks(p: &[Vec3], params: &SimulationParams, twist: f32) -> f32 {
    let n = p.len();
    let edge = p.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>() / (n - 1) as f32;
    let down = params.gravity.normalize();
    let weight = |i: usize| params.gravity * params.line_density * edge * if i == n - 1 { 0.5 } else { 1.0 };
    let mut sum = 0.0;
    for j in 1..n - 1 {
        let tangent = (p[j + 1] - p[j - 1]).normalize();
        let moment: Vec3 = (j + 1..n).map(|i| (p[i] - p[j]).cross(weight(i))).sum();
        let unit = (p[n - 1] - p[j]).cross(down);
        let about = [moment.dot(tangent), unit.dot(tangent)];
        let across = (moment - tangent * about[0]).dot(unit - tangent * about[1]);
        // Half of the bend at the root lies in the skin.
        let length = p[j].distance(p[j + 1]) * if j == 1 { 0.5 } else { 1.0 };
        sum += length * (across + about[0] * about[1] / twist) / BENDING;
    }
    sum
}

fn springs(lab: &'static Lab, cases: &[(usize, f32)], fault: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    for &(n, twist) in cases {
        let gravity = Vec3::NEG_Y * 0.25 * if fault { 1.05 } else { 1.0 };
        let params = SimulationParams { twist, gravity, bending_damping: 0.01, drag: 2.0, ..bare(BENDING) };
        let p = helix(n);
        let mut e = Experiment::new(lab, std::slice::from_ref(&p), &[], params, RestShape::Natural, None);
        e.run_still(1200);
        let sunk = p[n - 1].y - e.positions()[0][n - 1].y;
        let wanted = SimulationParams { gravity: Vec3::NEG_Y * 0.25, ..params };
        let exact = f64::from(sinks(&p, &wanted, twist));
        let case = format!("helical spring, twist {twist}, {} vertices a turn, sinks by", n / 3);
        rows.push(near(case, "mm", exact * 1e3, sunk * 1e3, 0.02));
    }
    rows
}

#[test]
pub fn helical_springs_match_castiglianos_theorem() {
    judge_some("springs", |lab, fault| springs(lab, &[(24, 0.5), (24, 3.0)], fault));
}

#[test]
#[ignore = "proof"]
fn all_helical_springs_match_castiglianos_theorem() {
    judge("springs", |lab, fault| springs(lab, &[(24, 0.5), (24, 3.0), (32, 0.5), (32, 1.0)], fault));
}

fn bows(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, radius) = (24, 0.05f32);
    let mut rows = Vec::new();
    for twist in [0.25f32, 0.5, 2.0] {
        // A horizontal quarter of a circle, clamped at one end, under its own weight.
        let per = FRAC_PI_2 / (n - 2) as f32;
        let p: Vec<_> = (0..n)
            .map(|i| {
                let a = (i as f32 - 1.0) * per;
                Vec3::new(radius * a.sin(), 0.0, radius * (1.0 - a.cos()))
            })
            .collect();
        let gravity = Vec3::NEG_Y * 0.2;
        let stiff = if fault { 1.2 * twist } else { twist };
        let params = SimulationParams { twist: stiff, gravity, drag: 4.0, ..bare(BENDING) };
        let mut e = Experiment::new(lab, &[p], &[], params, RestShape::Natural, None);
        e.run_still(900);
        let exact = params.line_density * 0.2 * radius.powi(4) / BENDING
            * (0.5 + (PI * PI / 8.0 - FRAC_PI_2 + 0.5) / twist);
        let case = format!("quarter of a circle, flat, clamped, twist {twist}, sinks by");
        rows.push(near(case, "mm", f64::from(exact) * 1e3, -e.positions()[0][n - 1].y * 1e3, 0.02));
    }
    rows
}

#[test]
pub fn bows_sink_by_the_closed_form() {
    judge("bows", bows);
}

/// A curl on a head that turns to and fro, then rests. It swings, returns, and has the same shape afterwards.
#[test]
fn curls_spring_back() {
    let Some(lab) = lab() else { return };
    let p = helix(24);
    let extent = |twist: f32| {
        let params = SimulationParams { twist, ..SimulationParams::default() };
        let mut e = Experiment::new(lab, std::slice::from_ref(&p), &[], params, RestShape::SagFree, None);
        let mut longest = 0f32;
        let turn = |t: f32| Pose {
            translation: Vec3::Y * 0.04 * (TAU * 2.0 * t).sin(),
            rotation: Quat::from_rotation_y(0.5 * (TAU * t).sin()),
        };
        let mut begin = turn(0.0);
        for i in 1..=60 {
            let end = turn(i as f32 / 60.0);
            e.run_steps(&[super::lab::step(begin, end)]);
            begin = end;
            let now = &e.positions()[0];
            longest = longest.max((now[23] - now[0]).dot(end.rotation * Vec3::NEG_Y));
        }
        e.run_motion(6.0, |_| begin);
        let off =
            e.positions()[0].iter().zip(&p).map(|(a, b)| a.distance(begin.point(*b))).fold(0.0, f32::max);
        (longest, off)
    };
    let ((rigid, _), (soft, off)) = (extent(0.0), extent(0.5));
    println!("a curl of 24 mm is up to {:.1} mm long without twist, {:.1} with", rigid * 1e3, soft * 1e3);
    println!("and {:.4} mm from its rest six seconds later", off * 1e3);
    assert!(soft > rigid + 1e-3, "it gives way: {soft} {rigid}");
    assert!(off < 2e-4, "{off}");
}
