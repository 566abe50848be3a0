//! Periods of oscillation: pendulum, hanging chain, cantilever.

use super::{
    lab::{Experiment, Lab, bare, straight},
    table::{Row, judge, near},
};
use std::f32::consts::TAU;
use tresses::{
    RestShape, SimulationParams,
    glam::{Quat, Vec3},
};

const G: f32 = 9.81;

/// Returns the mean time between upward zero crossings of `samples`.
pub fn period(samples: &[f32], dt: f32) -> f32 {
    let crossings: Vec<f32> = samples
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < 0.0 && w[1] >= 0.0)
        .map(|(i, w)| (i as f32 + w[0] / (w[0] - w[1])) * dt)
        .collect();
    assert!(crossings.len() > 1, "no oscillation");
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f32
}

/// Runs `count` steps and calls `measure` after each.
fn record<T>(e: &mut Experiment, count: usize, measure: impl Fn(&[Vec<Vec3>]) -> T) -> Vec<T> {
    (0..count)
        .map(|_| {
            e.run_still(1);
            measure(&e.positions())
        })
        .collect()
}

fn pendulum(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let length = 0.2;
    let factors = [(5f32, 1.000_476), (30.0, 1.017_41), (90.0, 1.180_34)];
    let gravity = Vec3::NEG_Y * G * if fault { 1.05 } else { 1.0 };
    let exact = TAU * (length / G).sqrt();
    let run = |params: SimulationParams, steps| {
        let strand = straight(3, length, Vec3::NEG_Y);
        let mut e = Experiment::new(lab, &vec![strand; 3], &[], params, RestShape::Natural, None);
        let mut start = e.rest_positions();
        for (strand, (angle, _)) in start.iter_mut().zip(factors) {
            strand[2] = Quat::from_rotation_z(angle.to_radians()) * strand[2];
        }
        e.set_positions(&start);
        let samples = record(&mut e, steps, |p| [p[0][2].x, p[1][2].x, p[2][2].x]);
        [0, 1, 2].map(|k| period(&samples.iter().map(|s| s[k]).collect::<Vec<_>>(), params.step))
    };
    let mut rows = Vec::new();
    // Two swings with a fine step, because the implicit Euler method loses energy.
    let fine = SimulationParams { step: 1.0 / 240.0, substep_count: 16, gravity, ..bare(0.0) };
    for (found, (angle, factor)) in run(fine, 520).into_iter().zip(factors) {
        let case = format!("pendulum, 20 cm, {angle}°, period");
        rows.push(near(case, "s", f64::from(exact * factor), found, 0.01));
    }
    let usual = run(SimulationParams { gravity, ..bare(0.0) }, 300)[0];
    let case = "pendulum, 5°, usual step (1/60 s in 4), period";
    rows.push(near(case, "s", f64::from(exact * factors[0].1), usual, 0.01));
    rows
}

#[test]
pub fn pendulum_periods_match_the_closed_form() {
    judge("pendulum", pendulum);
}

/// Returns the Bessel function of the first kind of order zero.
fn j0(x: f32) -> f32 {
    let q = -f64::from(x * x) / 4.0;
    let mut term = 1.0f64;
    let mut sum = 1.0;
    for k in 1..40 {
        term *= q / f64::from(k * k);
        sum += term;
    }
    sum as f32
}

/// Follows a chain of `n - 2` straight edges that swings with `omega` from its tip, which a force keeps 1 m to the
/// side, to its root. The force is per mass of 1 m of hair. Returns the position of the root, meters, and how often the
/// chain crosses the vertical.
pub fn root_of_chain(n: usize, length: f64, omega: f64, force: f64) -> (f64, usize) {
    let edge = length / (n - 2) as f64;
    let (mut x, mut below, mut count) = (1.0f64, force, 0);
    for k in 0..n - 2 {
        // The last mass is half as heavy.
        let mass = if k == 0 { 0.5 } else { 1.0 };
        let tension = f64::from(G) * (k as f64 + 0.5) / edge;
        let up = x - (mass * omega * omega * x + below) / tension;
        // Force of this edge on the next mass.
        below = tension * (x - up);
        count += usize::from(up.signum() != x.signum());
        x = up;
    }
    (x, count)
}

/// Returns the period of a mode (from 0) of `n - 2` masses on a chain of this length, s. The last mass is half as
/// heavy. This is the exact solution for a chain of straight edges.
fn lumped(n: usize, length: f32, mode: usize) -> f32 {
    // The number of crossings is the number of slower modes.
    let slower = |omega: f64| root_of_chain(n, f64::from(length), omega, 0.0).1;
    let (mut lo, mut hi) = (0.1f64, 1000.0);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if slower(middle) > mode { hi = middle } else { lo = middle }
    }
    (std::f64::consts::TAU / lo) as f32
}

fn chain(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let length = 0.3f32;
    let gravity = Vec3::NEG_Y * G * if fault { 0.9 } else { 1.0 };
    let params = SimulationParams { step: 1.0 / 240.0, substep_count: 4, gravity, ..bare(0.0) };
    let zeros = [2.404_826f32, 5.520_078, 8.653_728];
    let mut rows = Vec::new();
    for n in [16, 32] {
        let strand = straight(n, length, Vec3::NEG_Y);
        let mut e = Experiment::new(lab, &vec![strand; 3], &[], params, RestShape::SagFree, None);
        // A mode has the shape J0(j sqrt(z / L)), with z from the tip.
        let shape = |k: usize, y: f32| j0(zeros[k] * ((length + y).max(0.0) / length).sqrt());
        let mut start = e.rest_positions();
        for (k, strand) in start.iter_mut().enumerate() {
            for p in &mut strand[2..] {
                p.x = 1e-3 * shape(k, p.y);
            }
        }
        e.set_positions(&start);
        let samples =
            record(&mut e, 600, |p| [0, 1, 2].map(|k| p[k].iter().map(|p| p.x * shape(k, p.y)).sum::<f32>()));
        for (k, zero) in zeros.iter().enumerate() {
            let found = period(&samples.iter().map(|s| s[k]).collect::<Vec<_>>(), params.step);
            let case = format!("hanging chain, 30 cm, {n} vertices, mode {}, period", k + 1);
            if n == 32 {
                let exact = 2.0 * TAU / zero * (length / G).sqrt();
                rows.push(near(case.clone(), "s", f64::from(exact), found, [0.01, 0.01, 0.025][k]));
            }
            let exact = lumped(n, length, k);
            rows.push(near(format!("{case} (chain of edges)"), "s", f64::from(exact), found, 0.01));
        }
    }
    rows
}

#[test]
pub fn hanging_chain_periods_match_the_closed_form() {
    judge("chain", chain);
}

fn vibration(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (length, ei) = (0.1f32, 8e-9f32);
    let params = SimulationParams {
        step: 1.0 / 240.0,
        substep_count: 4,
        gravity: Vec3::ZERO,
        ..bare(ei * if fault { 1.05 } else { 1.0 })
    };
    let exact = (params.line_density * length.powi(4) / ei).sqrt() / 0.559_591;
    [16, 32]
        .into_iter()
        .map(|n| {
            let strand = straight(n, length, Vec3::X);
            let mut e = Experiment::new(lab, &[strand], &[], params, RestShape::Natural, None);
            // Starts close to the first mode, and measures the projection onto it.
            let shape = |s: f32| s * s * (3.0 - s);
            let mut start = e.rest_positions();
            for p in &mut start[0][2..] {
                p.y = 1e-3 * shape(p.x / length);
            }
            e.set_positions(&start);
            let samples =
                record(&mut e, 480, |p| p[0].iter().map(|p| p.y * shape(p.x / length)).sum::<f32>());
            let found = period(&samples, params.step);
            near(format!("cantilever, 10 cm, {n} vertices, first period"), "s", f64::from(exact), found, 0.01)
        })
        .collect()
}

#[test]
pub fn cantilever_periods_match_the_closed_form() {
    judge("vibration", vibration);
}
