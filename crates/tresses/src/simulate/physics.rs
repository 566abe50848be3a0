//! The twin against closed forms and invariants.

use super::{
    params::{Along, Mode, SimulationParams, StepUniforms},
    reference::{Obstacles, Strand},
    rest::{RestShape, shape},
};
use crate::{
    Pose,
    collide::{Collider, Shape},
    strands::{Guide, GuideRest},
    wind::Wind,
};
use glam::{Quat, Vec3};

/// Without goal, drag and friction, with constant bending stiffness.
pub(crate) fn bare(bending: f32) -> SimulationParams {
    let along = |v| Along { root: v, tip: v, falloff: 1.0 };
    SimulationParams {
        bending: along(bending),
        goal: along(0.0),
        bending_damping: 0.0,
        drag: 0.0,
        friction: 0.0,
        ..Default::default()
    }
}

pub(crate) fn strand(p: &[Vec3], params: &SimulationParams, mode: RestShape) -> Strand {
    let guide = Guide {
        length: p.windows(2).map(|w| w[0].distance(w[1])).sum(),
        stiffness: 1.0,
        strands: 1.0,
        flags: 0,
    };
    let rest = p.iter().map(|p| GuideRest { position: *p, contact: 0.0 }).collect();
    Strand::at_rest(guide, rest, shape(p, &guide, params, mode))
}

/// A straight strand whose free part (from vertex 1 on) has `length`.
fn straight(n: usize, length: f32, dir: Vec3) -> Vec<Vec3> {
    let edge = length / (n - 2) as f32;
    (0..n).map(|i| dir * edge * (i as f32 - 1.0)).collect()
}

fn still(params: &SimulationParams, n: usize) -> StepUniforms {
    moved(params, n, &Pose::IDENTITY, &Pose::IDENTITY)
}

fn moved(params: &SimulationParams, n: usize, begin: &Pose, end: &Pose) -> StepUniforms {
    StepUniforms::new(params, 1, n as u32, Mode::Step, begin, end)
}

/// The mean period between upward zero crossings of `x`.
fn period(samples: &[f32], dt: f32) -> f32 {
    let crossings: Vec<f32> = samples
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < 0.0 && w[1] >= 0.0)
        .map(|(i, w)| (i as f32 + w[0] / (w[0] - w[1])) * dt)
        .collect();
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f32
}

fn strain(s: &Strand) -> f32 {
    s.current
        .windows(2)
        .zip(&s.rest.windows(2).map(|w| w[0].position.distance(w[1].position)).collect::<Vec<_>>())
        .map(|(w, l)| w[0].distance(w[1]) / l - 1.0)
        .fold(f32::MIN, f32::max)
}

#[test]
fn simple_pendulum() {
    let (length, g) = (0.2, 9.81f32);
    let p = straight(3, length, Vec3::NEG_Y);
    for (angle, factor) in [(0.05f32, 1.0f32), (30f32.to_radians(), 1.01741)] {
        let params = bare(0.0);
        let mut s = strand(&p, &params, RestShape::Natural);
        s.current[2] = Quat::from_rotation_z(angle) * s.current[2];
        let samples: Vec<f32> = (0..600)
            .map(|_| {
                s.step(&still(&params, 3), &Obstacles::default());
                s.current[2].x
            })
            .collect();
        let found = period(&samples, params.step);
        let exact = std::f32::consts::TAU * (length / g).sqrt() * factor;
        println!("pendulum {angle}: {found} s, exact {exact}, {:+.2} %", (found / exact - 1.0) * 100.0);
        assert!((found / exact - 1.0).abs() < 0.02);
    }
}

#[test]
fn hanging_chain() {
    let length = 0.3f32;
    for n in [16, 32] {
        let params = bare(0.0);
        let p = straight(n, length, Vec3::NEG_Y);
        let mut s = strand(&p, &params, RestShape::SagFree);
        // The first mode's shape: J0(2 w sqrt(z/g)), z from the tip.
        let omega = 2.404_825_6 / 2.0 * (9.81 / length).sqrt();
        for i in 2..n {
            let z = length + s.current[i].y;
            let x = 2.0 * omega * (z.max(0.0) / 9.81).sqrt();
            let j0 = (0..12).fold((1.0f32, 1.0f32), |(sum, term), k| {
                let term = if k == 0 { 1.0 } else { -term * x * x / (4.0 * (k * k) as f32) };
                (if k == 0 { 1.0 } else { sum + term }, term)
            });
            s.current[i].x = 0.01 * j0.0;
        }
        let samples: Vec<f32> = (0..600)
            .map(|_| {
                s.step(&still(&params, n), &Obstacles::default());
                s.current[n - 1].x
            })
            .collect();
        let found = period(&samples, params.step);
        let exact = 5.225_48 * (length / 9.81).sqrt();
        println!("chain {n}: {found} s, exact {exact}, {:+.2} %", (found / exact - 1.0) * 100.0);
        assert!((found / exact - 1.0).abs() < 0.02);
    }
}

#[test]
fn cantilever() {
    // EI so that Γ = ρA g L³ / EI = 10; exact drop 0.700200 L, reach 0.656354 L.
    for (gamma, drop) in [(1.0f32, 0.123_471f32), (10.0, 0.700_200), (50.0, 0.907_917)] {
        for n in [16, 32] {
            let length = 0.1f32;
            let mut params = bare(6.6e-6 * 9.81 * length.powi(3) / gamma);
            params.drag = 4.0;
            let mut s = strand(&straight(n, length, Vec3::X), &params, RestShape::Natural);
            for _ in 0..600 {
                s.step(&still(&params, n), &Obstacles::default());
            }
            let found = -s.current[n - 1].y / length;
            println!(
                "cantilever Γ {gamma} n {n}: drop {found}, exact {drop}, {:+.2} %",
                (found / drop - 1.0) * 100.0
            );
            assert!((found / drop - 1.0).abs() < 0.02);
        }
    }
}

#[test]
fn shaken_root_keeps_lengths() {
    for n in [16, 32] {
        let params = bare(0.0);
        let mut s = strand(&straight(n, 0.3, Vec3::NEG_Y), &params, RestShape::Natural);
        let pose = |t: f32| Pose {
            translation: Vec3::X * 0.1 * (std::f32::consts::TAU * 2.0 * t).sin(),
            ..Pose::IDENTITY
        };
        let (mut worst, mut raw) = (0f32, 0f32);
        for i in 0..600 {
            let t = i as f32 * params.step;
            s.step(&moved(&params, n, &pose(t), &pose(t + params.step)), &Obstacles::default());
            worst = worst.max(strain(&s));
            raw = raw.max(s.velocity.iter().map(|v| v.length()).fold(0.0, f32::max));
        }
        println!("shaken chain {n}: strain {:.3} %, top speed {raw} m/s", worst * 100.0);
        assert!(worst < 0.01);
    }
}

fn helix(n: usize, radius: f32, pitch: f32, turns: f32) -> Vec<Vec3> {
    (0..n)
        .map(|i| {
            let t = i as f32 / (n - 1) as f32;
            let a = t * turns * std::f32::consts::TAU;
            Vec3::new(radius * a.sin(), -pitch * turns * t, radius * (1.0 - a.cos()))
        })
        .collect()
}

fn wave(n: usize) -> Vec<Vec3> {
    (0..n)
        .map(|i| {
            let t = i as f32 / (n - 1) as f32;
            Vec3::new(0.12 * (2.0 * t).sin(), 0.05 * (3.0 * t).sin() - 0.2 * t * t, 0.02 * (14.0 * t).sin())
        })
        .collect()
}

#[test]
fn rest_stays_at_rest() {
    let params = SimulationParams::default();
    for (name, p) in [
        ("hanging", straight(32, 0.3, Vec3::NEG_Y)),
        ("oblique", straight(16, 0.05, Vec3::new(1.0, -1.0, 0.0).normalize())),
        ("wave", (0..32).map(|i| Vec3::new(0.01 * (0.5 * i as f32).sin(), -0.008 * i as f32, 0.0)).collect()),
        ("helix", helix(48, 0.01, 0.02, 5.0)),
        ("short", straight(16, 0.005, Vec3::X)),
    ] {
        let mut s = strand(&p, &params, RestShape::SagFree);
        let n = p.len();
        let mut worst = 0f32;
        for _ in 0..600 {
            s.step(&still(&params, n), &Obstacles::default());
            worst = worst.max((0..n).map(|i| s.current[i].distance(p[i])).fold(0.0, f32::max));
        }
        println!("rest {name}: drift {:.4} % of {} m", worst / s.guide.length * 100.0, s.guide.length);
        assert!(worst < 1e-3 * s.guide.length, "{name} {worst}");
    }
}

fn energy(s: &Strand, params: &SimulationParams) -> f32 {
    // Per line density and edge: kinetic, potential and stretch; bending by its own rule.
    let n = s.current.len();
    let edge = s.guide.length / (n - 1) as f32;
    let mut sum = 0.0;
    for i in 2..n {
        let w = if i == n - 1 { 0.5 } else { 1.0 };
        sum += w * (0.5 * s.velocity[i].length_squared() - params.gravity.dot(s.current[i]));
    }
    let stretch = params.stretch_rate(s.guide.length, edge);
    for i in 1..n - 1 {
        let over = s.current[i].distance(s.current[i + 1]) - s.shape[i].length;
        sum += 0.5 * stretch * over * over;
    }
    sum
}

#[test]
fn energy_does_not_grow() {
    // Floppy strands, whose energy is all in what `energy` counts, thrown and left alone.
    let params = bare(0.0);
    for (name, p) in [("straight", straight(24, 0.25, Vec3::X)), ("wave", wave(32))] {
        let mut s = strand(&p, &params, RestShape::Natural);
        let n = p.len();
        let mut last = energy(&s, &params);
        let start = last;
        let mut grown = 0f32;
        for _ in 0..600 {
            s.step(&still(&params, n), &Obstacles::default());
            let now = energy(&s, &params);
            grown = grown.max(now - last);
            last = now;
        }
        println!("energy {name}: {start} to {last}, largest rise in a step {grown}");
        assert!(grown < 0.01 * (start - last), "{name}");
        assert!(last < start);
    }
}

#[test]
fn stiff_curls_stay_calm() {
    for factor in [1.0, 30.0, 1e4] {
        let mut params = bare(8e-9 * factor);
        params.drag = 1.0;
        let p = helix(48, 0.01, 0.015, 5.0);
        let mut s = strand(&p, &params, RestShape::Natural);
        let pose = |t: f32| Pose::about(Vec3::Y * -0.1, Quat::from_rotation_y(0.8 * (6.0 * t).sin()));
        let mut top = 0f32;
        for i in 0..900 {
            let t = (i as f32 * params.step).min(5.0);
            let t1 = ((i + 1) as f32 * params.step).min(5.0);
            s.step(&moved(&params, 48, &pose(t), &pose(t1)), &Obstacles::default());
            let speed = s.velocity.iter().map(|v| v.length()).fold(0.0, f32::max);
            top = if i > 840 { top.max(speed) } else { 0.0 };
        }
        println!("curl x{factor}: speed after 10 s of rest {top} m/s");
        assert!(top < 0.05, "x{factor}: {top}");
    }
}

#[test]
fn results_do_not_depend_on_substeps() {
    let ends: Vec<Vec3> = [(60.0, 2), (60.0, 4), (120.0, 4), (60.0, 16)]
        .map(|(rate, substeps)| {
            let params = SimulationParams { step: 1.0 / rate, substeps, ..Default::default() };
            let mut s = strand(&straight(16, 0.2, Vec3::X), &params, RestShape::Natural);
            for _ in 0..(rate * 0.3) as usize {
                s.step(&still(&params, 16), &Obstacles::default());
            }
            s.current[15]
        })
        .to_vec();
    println!("tip after 0.3 s: {ends:?}");
    for end in &ends {
        assert!(end.distance(ends[3]) < 0.02, "{ends:?}");
    }
}

#[test]
fn capsule_with_friction() {
    // A strand across a horizontal cylinder: it lies on it, and with friction it stays.
    let ends = [-1.0, 1.0].map(|z| Vec3::new(0.1, -0.05, z));
    let (shape, pose) = Shape::capsule(ends[0], ends[1], 0.04);
    let params = SimulationParams::default();
    let mut s = strand(&straight(32, 0.25, Vec3::X), &params, RestShape::Natural);
    let (colliders, places) = ([Collider::new(shape)], [pose; 5]);
    let obstacles = Obstacles { colliders: &colliders, places: &places, ..Default::default() };
    let mut deepest = 0f32;
    for _ in 0..300 {
        s.step(&still(&params, 32), &obstacles);
        for p in &s.current {
            let d = (*p - Vec3::new(0.1, -0.05, 0.0)).length() - 0.04;
            deepest = deepest.max(-d);
        }
    }
    let speed = s.velocity.iter().map(|v| v.length()).fold(0.0, f32::max);
    println!("capsule: deepest {deepest} m, speed at the end {speed}");
    assert!(deepest < 1e-3 && speed < 0.02);
}

#[test]
fn absurd_input_gives_finite_output() {
    for (name, params) in [
        ("huge gravity", SimulationParams { gravity: Vec3::splat(5e3), ..Default::default() }),
        ("huge bending", bare(1.0)),
        ("huge step", SimulationParams { step: 0.1, substeps: 1, ..Default::default() }),
        ("storm", SimulationParams { wind: Wind::uniform(Vec3::X * 400.0), drag: 1e4, ..Default::default() }),
    ] {
        let mut s = strand(&wave(24), &params, RestShape::SagFree);
        for i in 0..120 {
            let jump = |i: i32| Pose {
                translation: Vec3::X * if i % 7 == 0 { 3.0 } else { 0.0 },
                rotation: Quat::from_rotation_x(i as f32 * 2.9),
            };
            s.step(&moved(&params, 24, &jump(i), &jump(i + 1)), &Obstacles::default());
        }
        assert!(s.current.iter().chain(&s.velocity).all(|v| v.is_finite()), "{name}");
        assert!(strain(&s) < 0.2, "{name} {}", strain(&s));
    }
    let params = SimulationParams::default();
    let mut s = strand(&wave(24), &params, RestShape::SagFree);
    s.velocity[5] = Vec3::NAN;
    s.step(&still(&params, 24), &Obstacles::default());
    assert_eq!(s.current[23], s.rest[23].position, "a strand with NaN returns to rest");
}
