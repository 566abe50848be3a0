//! Motion does not depend on the numbers of vertices, frames, steps and substeps.

use super::{
    grooms::{Subject, style},
    lab::{Experiment, Lab, length},
    table::{Row, at_most, judge, judge_some},
};
use crate::moving::{Keys, angle};
use tresses::{
    Pose, RestShape, SimulationParams,
    glam::{Quat, Vec3},
    groom::curve,
};

/// The settings of one run.
#[derive(Clone, Copy)]
struct Variant {
    vertices: usize,
    fps: u32,
    params: SimulationParams,
}

/// Yaw of a head that looks left, right and straight ahead.
const TURN: Keys = &[(0.0, 0.0), (0.3, 45.0), (0.7, 45.0), (1.2, -45.0), (1.6, -45.0), (2.0, 0.0)];

/// Returns the middle and the tip of each guide when the head has stopped, and two seconds later.
fn run(lab: &'static Lab, subject: &Subject, variant: Variant) -> [Vec<[Vec3; 2]>; 2] {
    let Variant { vertices, fps, params } = variant;
    let strands: Vec<_> = subject.strands.iter().map(|s| curve::resample(s, vertices)).collect();
    let mut e =
        Experiment::new(lab, &strands, &subject.traits, params, RestShape::SagFree, Some(&subject.field));
    let pose = |i: u32| Pose::about(subject.neck, Quat::from_rotation_y(angle(TURN, i as f32 / fps as f32)));
    e.frame(0.0, pose(0));
    let mut until = |from: u32, to: u32| -> Vec<[Vec3; 2]> {
        for i in from * fps + 1..=to * fps {
            e.frame(1.0 / fps as f32, pose(i));
        }
        let ends = e.positions();
        ends.iter().map(|s| [curve::resample(s, 3)[1], s[vertices - 1]]).collect()
    };
    [until(0, 2), until(2, 4)]
}

/// Returns the distances between middles and between tips, in percent of the strands' lengths, in ascending order.
fn apart(subject: &Subject, a: &[[Vec3; 2]], b: &[[Vec3; 2]]) -> Vec<f32> {
    let mut apart: Vec<f32> = (0..a.len())
        .flat_map(|g| [0, 1].map(|k| a[g][k].distance(b[g][k]) / length(&subject.strands[g]) * 100.0))
        .collect();
    apart.sort_by(f32::total_cmp);
    apart
}

/// Compares the variants in `names`, or all, with the usual run.
fn independence(lab: &'static Lab, names: &[&str], fault: bool) -> Vec<Row> {
    let subject = style(lab, "long");
    let base = SimulationParams::default();
    let usual = Variant { vertices: 32, fps: 60, params: base };
    let halved = SimulationParams { step: 1.0 / 120.0, substep_count: 2, ..base };
    let mut rows = Vec::new();
    let reference = run(lab, &subject, usual);
    for (name, mut variant, most) in [
        ("16 vertices", Variant { vertices: 16, ..usual }, 2.0),
        ("64 vertices", Variant { vertices: 64, ..usual }, 2.0),
        ("30 frames per second", Variant { fps: 30, ..usual }, 0.5),
        ("144 frames per second", Variant { fps: 144, ..usual }, 0.5),
        ("steps of 1/120 s in 2", Variant { params: halved, ..usual }, 0.5),
        ("8 substeps", Variant { params: SimulationParams { substep_count: 8, ..base }, ..usual }, 1.0),
    ] {
        if !names.is_empty() && !names.contains(&name) {
            continue;
        }
        if fault {
            // Tilt the gravity.
            variant.params.gravity.x = 5.0;
        }
        let found = run(lab, &subject, variant);
        for (when, (a, b)) in ["when it stops", "2 s later"].iter().zip(reference.iter().zip(&found)) {
            let apart = apart(&subject, a, b);
            let mean = apart.iter().sum::<f32>() / apart.len() as f32;
            let at = |percent: usize| apart[apart.len() * percent / 100];
            println!(
                "{name}, {when}: median {:.2} %, 95 of 100 below {:.2} %, 99 below {:.2} %",
                at(50),
                at(95),
                at(99)
            );
            let case =
                format!("long, head turned, {when}: {name} against 32, 60, 1/60 s in 4; mean distance");
            rows.push(at_most(case, "% of its length", most, mean));
        }
    }
    rows
}

#[test]
fn motion_is_independent_of_the_frame_rate() {
    judge_some("independence", |lab, fault| independence(lab, &["30 frames per second"], fault));
}

#[test]
#[ignore = "proof"]
fn motion_is_independent_of_the_discretization() {
    let quick = ["16 vertices", "30 frames per second", "steps of 1/120 s in 2", "8 substeps"];
    judge("independence", |lab, fault| independence(lab, if fault { &quick } else { &[] }, fault));
}
