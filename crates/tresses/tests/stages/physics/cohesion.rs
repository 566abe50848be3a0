//! Hair that supports and holds hair: an afro and a ponytail keep their volume when they are shaken.

use super::table::{Row, at_most, judge, near};
use crate::common;

use std::collections::HashSet;
use tresses::{
    Context, HairHair, HairOptions, Pose, RestOptions, SimulationParams,
    glam::{IVec3, Quat, Vec3},
    groom::{BindOptions, Groom, GuideCount, SdfGrid, Strands, bind},
    low_level::HairFrame,
};

/// Edge of the voxels in which guides are counted, meters.
const VOXEL: f32 = 0.02;
/// Joint about which the head turns.
const NECK: Vec3 = Vec3::new(0.0, -0.12, -0.02);
/// Radius of the head, meters.
const HEAD: f32 = 0.09;

/// Returns the `i`th of `count` evenly spread directions.
fn direction(i: usize, count: usize) -> Vec3 {
    let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
    let (sine, cosine) = (i as f32 * 2.399_963).sin_cos();
    let r = (1.0 - y * y).sqrt();
    Vec3::new(r * cosine, y, r * sine)
}

/// Returns hair that stands out in all directions from the head, except from face and neck.
fn afro(length: f32) -> Groom {
    let mut strands = Strands::default();
    for i in 0..800 {
        let out = direction(i, 800);
        if out.y > -0.45 && out.z < 0.6 {
            let line: Vec<_> = (0..16).map(|j| out * (HEAD + length * j as f32 / 15.0)).collect();
            strands.push(&line);
        }
    }
    bound(&strands)
}

/// Returns hair that comes out of a band at the back of the head.
fn ponytail() -> Groom {
    let mut strands = Strands::default();
    for i in 0..150 {
        let (sine, cosine) = (i as f32 * 2.399_963).sin_cos();
        let r = ((i as f32 + 0.5) / 150.0).sqrt();
        let across = Vec3::new(cosine, sine, 0.0) * r;
        let line: Vec<_> = (0..24)
            .map(|j| {
                let s = 0.4 * j as f32 / 23.0;
                // Out and down in an arc of radius 6 cm, and wider than the band.
                let angle = (s / 0.06).min(1.3);
                let arc = Vec3::new(0.0, 0.06 * (angle.cos() - 1.0), -0.06 * angle.sin());
                let straight = Vec3::new(0.0, -angle.sin(), -angle.cos()) * (s - 0.06 * angle).max(0.0);
                let wide = 0.012 + 0.02 * (s / 0.1).min(1.0);
                let turned = Quat::from_rotation_x(-angle) * across;
                Vec3::new(0.0, 0.03, -HEAD) + arc + straight + turned * wide
            })
            .collect();
        strands.push(&line);
    }
    bound(&strands)
}

fn bound(strands: &Strands) -> Groom {
    let guides = GuideCount::Count(strands.len() as u32);
    bind(strands, &BindOptions { guides, ..Default::default() }).unwrap()
}

/// Returns the number of voxels that guides pass through, in head space.
fn voxels(positions: &[Vec3], count: usize, head: &Pose) -> f32 {
    let back = head.inverse();
    let mut voxels = HashSet::<IVec3>::new();
    for at in 0..positions.len() - count {
        let (a, b) = (back.point(positions[at]), back.point(positions[at + count]));
        voxels.extend((0..8).map(|k| (a.lerp(b, k as f32 / 8.0) / VOXEL).floor().as_ivec3()));
    }
    voxels.len() as f32
}

/// Results of a shake.
#[derive(Debug)]
struct Shaken {
    /// Volume relative to rest: in the last second of the shake, and in the second that begins one second after it.
    volume: [f32; 2],
    /// Percentage of tips that are farther from their rest position than a quarter of the hair's length, two seconds
    /// after the shake.
    fallen: f32,
}

fn shake(context: &Context, groom: &Groom, simulation: SimulationParams, support: f32) -> Shaken {
    let rest = RestOptions { support, ..Default::default() };
    let options = HairOptions { simulation, rest, ..Default::default() };
    let head = SdfGrid::from_fn(Vec3::splat(-0.15), Vec3::splat(0.15), 48, |p| p.length() - HEAD);
    let mut hair = common::hair(context, groom, &options, Some(&head)).unwrap();
    let count = hair.guides.count as usize;
    let mut advance = |dt: f32, head: Pose| -> Vec<Vec3> {
        common::simulate(&mut hair, &HairFrame { simulation: &simulation, ..common::frame(head, dt) });
        common::guides(&hair)
    };
    let rest = advance(0.0, common::shaken(0.0, NECK));
    let full = voxels(&rest, count, &common::shaken(0.0, NECK));
    let mut sums = [(0.0, 0); 2];
    let mut now = rest.clone();
    for i in 1..=300 {
        let t = i as f32 / 60.0;
        now = advance(1.0 / 60.0, common::shaken(t, NECK));
        let when = if t > common::SHAKE - 1.0 && t <= common::SHAKE { 0 } else { 1 };
        if t > common::SHAKE - 1.0 && !(common::SHAKE..common::SHAKE + 1.0).contains(&t) && i % 6 == 0 {
            sums[when].0 += voxels(&now, count, &common::shaken(t, NECK)) / full;
            sums[when].1 += 1;
        }
    }
    let length: f32 =
        (count..rest.len()).map(|at| rest[at].distance(rest[at - count])).sum::<f32>() / count as f32;
    let tips = rest.len() - count..rest.len();
    let fallen = tips.filter(|&at| now[at].distance(rest[at]) > 0.25 * length).count();
    Shaken {
        volume: sums.map(|(sum, count)| sum / count as f32),
        fallen: fallen as f32 / count as f32 * 100.0,
    }
}

fn held(context: &Context, fault: bool) -> Vec<Row> {
    let usual = SimulationParams::default();
    let usual_support = RestOptions::default().support;
    let support = if fault { usual_support } else { 20.0 };
    let stands = shake(context, &afro(0.2), usual, support);
    let cohesion = if fault { 0.0 } else { 1000.0 };
    let hair_hair = HairHair { cohesion, ..usual.hair_hair };
    let tied = shake(context, &ponytail(), SimulationParams { hair_hair, ..usual }, usual_support);
    vec![
        near(
            "afro of 20 cm, support of 20, volume while it is shaken, of that at rest",
            "",
            1.0,
            stands.volume[0],
            0.1,
        ),
        near("the same, a second later", "", 1.0, stands.volume[1], 0.1),
        at_most("the same, hair that has toppled", "%", 1.0, stands.fallen),
        near(
            "ponytail of 40 cm, cohesion of 1,000 1/s², volume while it is shaken",
            "",
            1.0,
            tied.volume[0],
            0.1,
        ),
    ]
}

#[test]
#[ignore = "proof"]
fn support_and_cohesion_keep_the_volume() {
    judge("hold", |lab, fault| held(lab.context, fault));
}
