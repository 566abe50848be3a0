//! Levels of detail change without jumps.

use super::stage::{Setup, Shot};
use crate::common;
use tresses::{
    Pose,
    glam::{Quat, Vec3},
    groom::{Groom, SdfGrid, bind},
    low_level::{Detail, Hair, StrandVertex},
};

/// Returns the mean differences in coverage and color between successive images.
fn steps(stage: &Setup, hair: &mut Hair, details: &[Detail]) -> Vec<f32> {
    let shot = Shot::new(6.0, Vec3::new(0.4, 0.1, 1.0));
    let size = shot.size(hair.lod.sphere().1);
    let pictures: Vec<_> =
        details.iter().map(|detail| stage.picture(hair, *detail, &shot, size, 1)).collect();
    let difference = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let pixel = |(a, b): (&[f32; 4], &[f32; 4])| (0..4).map(|i| (a[i] - b[i]).abs()).sum::<f32>();
        a.iter().zip(b).map(pixel).sum::<f32>() / a.len() as f32
    };
    pictures.windows(2).map(|w| difference(&w[0], &w[1])).collect()
}

/// Returns the largest step over the median step.
fn jump(steps: &[f32]) -> f32 {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[sorted.len() - 1] / sorted[sorted.len() / 2].max(1e-9)
}

/// Returns levels at which strands are added an octave at a time. The comparer must detect these jumps.
fn octaves(hair: &Hair, details: &[Detail]) -> Vec<Detail> {
    let start = hair.lod.diameter() / hair.lod.options.strand_width;
    let octave = |d: &Detail| hair.lod.detail(start * (d.pixel / start).log2().floor().exp2(), 100.0);
    details.iter().map(octave).collect()
}

#[test]
fn level_changes_do_not_pop() {
    let Some(stage) = Setup::open() else { return };
    let (groom, _) = Setup::style("long", 2000);
    let mut hair = stage.hair(&groom, None);
    let start = hair.lod.diameter() / hair.lod.options.strand_width;
    // 3 % per frame, across an octave.
    let details: Vec<_> = (0..16).map(|i| hair.lod.detail(1.6 * start * 1.03f32.powi(i), 100.0)).collect();
    let all = steps(&stage, &mut hair, &details);
    let mut octaves = octaves(&hair, &details);
    // Equal levels give equal images.
    octaves.dedup_by_key(|detail| detail.pixel.to_bits());
    let mut coming = steps(&stage, &mut hair, &octaves);
    coming.extend(&all);
    println!("largest step over median {:.2}, with octaves of strands {:.2}", jump(&all), jump(&coming));
    assert!(jump(&all) < 3.5 && jump(&coming) > 5.0, "{all:?} {coming:?}");
}

/// Prints the figures of docs/validation/levels.md.
#[test]
#[ignore = "proof"]
fn many_level_changes_do_not_pop() {
    let Some(stage) = Setup::open() else { return };
    let (groom, _) = Setup::style("long", 5000);
    let mut hair = stage.hair(&groom, None);
    // The camera stays. Only the assumed distance grows, by 3 % per frame, through nine buckets and several numbers of
    // segments.
    let start = hair.lod.diameter() / hair.lod.options.strand_width;
    let details: Vec<_> = (0..72).map(|i| hair.lod.detail(0.8 * start * 1.03f32.powi(i), 100.0)).collect();
    let last = details[details.len() - 1];
    let first = details[0];
    assert!((first.strand_count, first.width, first.segment_count) == (5000, 1.0, 31.0), "{first:?}");
    assert!(last.strand_count < 1100 && last.segment_count < 26.0, "{last:?}");
    // The first frames are at full detail and do not change.
    let all = steps(&stage, &mut hair, &details);
    let moving: Vec<_> = all.iter().copied().skip_while(|step| *step == 0.0).collect();
    println!("{} frames, largest step over median {:.2}", moving.len(), jump(&moving));
    assert!(moving.len() < 66 && jump(&moving) < 3.5, "{moving:?}");
    // Smaller steps make smaller differences, so the differences are not noise.
    let finer: Vec<_> = (0..16).map(|i| hair.lod.detail(1.6 * start * 1.005f32.powi(i), 100.0)).collect();
    let coarser: Vec<_> = (0..8).map(|i| hair.lod.detail(1.6 * start * 1.02f32.powi(i), 100.0)).collect();
    let mean = |steps: &[f32]| steps.iter().sum::<f32>() / steps.len() as f32;
    let ratio = mean(&steps(&stage, &mut hair, &coarser)) / mean(&steps(&stage, &mut hair, &finer));
    println!("four times the step, {ratio:.2} times the difference");
    assert!(ratio > 2.0, "{ratio}");
    // Strands that are added an octave at a time are detected.
    let octaves = octaves(&hair, &details);
    let mut coming = steps(&stage, &mut hair, &octaves);
    coming.retain(|step| *step > 0.0);
    coming.extend(moving);
    println!("with octaves of strands {:.2}", jump(&coming));
    assert!(jump(&coming) > 5.0);
}

#[test]
fn longer_steps_keep_the_motion() {
    let Some(stage) = Setup::open() else { return };
    let groom = bind(&common::hanging(120, 16, 0.25), &Default::default()).unwrap();
    slower_steps(&stage, &groom, &common::ball(0.09, 48), 30.0);
}

/// Prints the figures of docs/validation/levels.md.
#[test]
#[ignore = "proof"]
fn longer_steps_keep_the_motion_of_a_style() {
    let Some(stage) = Setup::open() else { return };
    let (groom, field) = Setup::style("long", 600);
    slower_steps(&stage, &groom, &field, 60.0);
}

fn slower_steps(stage: &Setup, groom: &Groom, field: &SdfGrid, degrees: f32) {
    // A turn and back within a second, then a second to come to rest.
    let pose = |t: f32| {
        let s = (std::f32::consts::PI * t.min(1.0)).sin();
        Pose::about(Vec3::new(0.0, 1.5, 0.0), Quat::from_rotation_y(s * s * degrees.to_radians()))
    };
    let run = |slow: &dyn Fn(f32) -> f32| {
        let mut hair = stage.hair(groom, Some(field));
        let full = *hair.lod.current();
        (1..=120)
            .map(|i| {
                let t = i as f32 / 60.0;
                hair.set_detail(Detail { step_scale: slow(t), ..full });
                stage.advance(&mut hair, pose(t), 1.0 / 60.0);
                common::vertices(&hair)
            })
            .collect::<Vec<_>>()
    };
    let distance = |a: &[StrandVertex], b: &[StrandVertex]| {
        a.iter().zip(b).map(|(a, b)| a.position.distance(b.position)).sum::<f32>() / a.len() as f32
    };
    let worst = |a: &[Vec<StrandVertex>], b: &[Vec<StrandVertex>]| {
        a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f32::max)
    };
    let quick = run(&|_| 1.0);
    let slow = run(&|_| 2.0);
    // Between both while the head moves. The step grows by 2 % per frame.
    let change = run(&|t| (1.0 + (t - 0.2)).clamp(1.0, 2.0));
    let travel = worst(&quick, &vec![quick[0].clone(); 120]);
    println!(
        "mean difference in the worst frame: {:.2} mm at half the rate, {:.2} mm while it changes, of {:.0} mm traveled; {:.2} mm in the last frame",
        1e3 * worst(&quick, &slow),
        1e3 * worst(&quick, &change),
        1e3 * travel,
        1e3 * distance(&quick[119], &slow[119])
    );
    // Less than a pixel at the distances at which steps are that long.
    assert!(worst(&quick, &slow) < 6e-3 && worst(&quick, &change) < 6e-3 && travel > 20e-3);
    // Nothing jumps while the step length changes: no frame moves farther than with the short step.
    let ways =
        |frames: &[Vec<StrandVertex>]| frames.windows(2).map(|w| distance(&w[0], &w[1])).fold(0.0, f32::max);
    println!(
        "largest way in a frame: {:.2} mm, {:.2} mm while the rate changes",
        1e3 * ways(&quick),
        1e3 * ways(&change)
    );
    assert!(ways(&change) < 1.15 * ways(&quick));
    // Another motion is detected.
    assert!(worst(&quick, &quick.iter().skip(4).chain(&quick[..4]).cloned().collect::<Vec<_>>()) > 6e-3);
}
