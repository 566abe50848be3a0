//! Invariants of the CPU reference, where thousands of steps are cheap. `tests/gpu/physics` measures closed forms on
//! the GPU.

use super::{
    params::{RootToTip, SimulationParams, StepUniforms},
    reference::{Obstacles, Strand},
    rest::{RestShape, shape},
};
use crate::{
    Pose,
    clock::Mode,
    collide::{Collider, Shape},
    strands::{Guide, GuideRest},
    wind::Wind,
};
use glam::{Quat, Vec3};

/// Parameters with constant bending stiffness and without goal, drag and friction.
pub(crate) fn bare(bending: f32) -> SimulationParams {
    let along = |v| RootToTip { root: v, tip: v, falloff: 1.0 };
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
        ..Guide::default()
    };
    let rest = p.iter().map(|p| GuideRest { position: *p, contact: 0.0 }).collect();
    Strand::at_rest(guide, rest, shape(p, &guide, params, mode))
}

/// A straight strand; its free part, from vertex 1 on, has length `length`.
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

fn strain(s: &Strand) -> f32 {
    s.current
        .windows(2)
        .zip(&s.rest.windows(2).map(|w| w[0].position.distance(w[1].position)).collect::<Vec<_>>())
        .map(|(w, l)| w[0].distance(w[1]) / l - 1.0)
        .fold(f32::MIN, f32::max)
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
    [0.0, 0.5, 20.0].into_iter().for_each(stays_at_rest);
}

fn stays_at_rest(twist: f32) {
    let params = SimulationParams { twist, ..Default::default() };
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
        println!(
            "rest {name}, twist {twist}: drift {:.4} % of {} m",
            worst / s.guide.length * 100.0,
            s.guide.length
        );
        assert!(worst < 1e-3 * s.guide.length, "{name} {worst}");
    }
}

#[test]
fn stiff_curls_stay_calm() {
    for (factor, twist) in [
        (1.0, 0.0),
        (30.0, 0.0),
        (1e4, 0.0),
        (1.0, 0.1),
        (1.0, 0.5),
        (1.0, 1.0),
        (1.0, 3.0),
        (1.0, 30.0),
        (3.0, 0.5),
        (30.0, 0.1),
        (30.0, 0.5),
        (1e4, 1.0),
        (30.0, 30.0),
    ] {
        let mut params = SimulationParams { twist, ..bare(8e-9 * factor) };
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
        println!("curl x{factor}, twist {twist}: speed after 10 s of rest {top} m/s");
        assert!(top < 0.05, "x{factor}, twist {twist}: {top}");
    }
}

#[test]
fn friction_holds_strand_on_capsule() {
    // With friction, a strand across a horizontal cylinder stays on it.
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
        ("loose twist", SimulationParams { twist: 1e-3, ..bare(1e-3) }),
        ("stiff twist", SimulationParams { twist: 100.0, ..bare(1.0) }),
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
