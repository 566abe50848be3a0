use super::*;
use crate::{BindOptions, GuideCount, Strands, bind, scalp::spread_direction};
use glam::Vec2;

/// Straight strands of 20 cm on a head of 9 cm radius, bound with 64 vertices.
fn ball(count: u32) -> Groom {
    let mut strands = Strands::default();
    for i in 0..count {
        let dir = spread_direction(i, Vec2::new(0.1, 0.4));
        let line: Vec<Vec3> = (0..9).map(|k| dir * (0.09 + 0.025 * k as f32)).collect();
        strands.push(&line);
    }
    let options =
        BindOptions { guides: GuideCount::OneIn(8), strand_vertex_count: Some(64), ..Default::default() };
    bind(&strands, &options).unwrap()
}

fn line(groom: &Groom, i: usize) -> Vec<Vec3> {
    groom.strands.rest_positions(i).collect()
}

fn regular() -> Curls {
    Curls { irregularity: 0.0, coherence: 1.0, neighbors: 1.0, ..Curls::ringlets() }
}

/// Without clumping, strands keep their own paths.
const LOOSE: Clumps = Clumps { strength: 0.0, ..NO_CLUMPS };

#[test]
fn imported_strands_curl_and_guides_stay() {
    let before = ball(800);
    let mut after = before.clone();
    let restyle = Restyle { curls: regular(), clumps: Some(LOOSE), ..Restyle::default() };
    restyle.apply(&mut after, Vec3::ZERO, Vec3::ZERO).unwrap();
    assert_eq!(after.guides, before.guides);
    let curled = |groom: &Groom, radius: f32| {
        (0..800).step_by(7).all(|i| {
            let (old, new) = (line(&before, i), line(groom, i));
            assert!(old[0].distance(new[0]) < 1e-5);
            // Beyond the ramp, on a straight path, the radius is the same everywhere.
            (15..64).all(|k| (old[k].distance(new[k]) / radius - 1.0).abs() < 0.01)
        })
    };
    assert!(curled(&after, 0.009) && !curled(&after, 0.0095) && !curled(&before, 0.009));
    for (a, b) in after.strands.bindings.iter().zip(&before.strands.bindings) {
        assert_eq!((a.guides, a.weight_b, a.weight_c, a.scale), (b.guides, b.weight_b, b.weight_c, b.scale));
    }
}

#[test]
fn shrunken_strands_keep_length_and_end_higher_on_guides() {
    let before = ball(300);
    let mut after = before.clone();
    let curls = Curls { shrink: 1.0, ..regular() };
    Restyle { curls, clumps: Some(LOOSE), ..Restyle::default() }
        .apply(&mut after, Vec3::ZERO, Vec3::ZERO)
        .unwrap();
    for i in 0..300 {
        let [old, new] = [&before, &after].map(|groom| curve::length(&line(groom, i)));
        // Chords cut the corners, at six vertices per turn.
        assert!((new / old - 1.0).abs() < 0.04, "{new} {old}");
        let ratio = after.strands.bindings[i].scale[0] / before.strands.bindings[i].scale[0];
        assert!((0.4..0.7).contains(&ratio), "{ratio}");
    }
}

#[test]
fn curl_map_affects_only_painted_side() {
    let before = ball(800);
    let map = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.0 });
    let flipped = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 0.0 } else { 1.0 });
    let moved = |map: ScalpMap| {
        let mut after = before.clone();
        let restyle =
            Restyle { curls: regular(), clumps: Some(LOOSE), curl_map: Some(map), ..Restyle::default() };
        restyle.apply(&mut after, Vec3::ZERO, Vec3::ZERO).unwrap();
        [1.0, -1.0].map(|side| {
            let there = (0..800).filter(|i| line(&before, *i)[0].x * side > 0.02);
            there.map(|i| line(&before, i)[40].distance(line(&after, i)[40])).fold(0.0, f32::max)
        })
    };
    let good = |[left, right]: [f32; 2]| (left - 0.009).abs() < 2e-4 && right < 2e-5;
    assert!(good(moved(map)) && !good(moved(flipped)));
}

#[test]
fn strands_gather_to_locks() {
    let before = ball(3000);
    let nearest = |groom: &Groom| {
        let tips: Vec<Vec3> = (0..3000).map(|i| line(groom, i)[58]).collect();
        let near = |i: usize| {
            (0..3000).filter(|k| *k != i).map(|k| tips[k].distance(tips[i])).fold(f32::INFINITY, f32::min)
        };
        (0..3000).step_by(20).map(near).sum::<f32>() / 150.0
    };
    let mut after = before.clone();
    let clumps = Clumps { strength: 0.9, spacing: 0.02, ..NO_CLUMPS };
    Restyle { clumps: Some(clumps), ..Restyle::default() }.apply(&mut after, Vec3::ZERO, Vec3::ZERO).unwrap();
    assert!(nearest(&after) < 0.6 * nearest(&before), "{} {}", nearest(&after), nearest(&before));
}

#[test]
fn widths_vary_and_narrow() {
    let before = ball(2000);
    let mut after = before.clone();
    let restyle =
        Restyle { diameter: Some(1e-4), width_variation: 0.2, tip_width: Some(0.3), ..Restyle::default() };
    assert!(restyle.any() && !Restyle::default().any());
    restyle.apply(&mut after, Vec3::ZERO, Vec3::ZERO).unwrap();
    let radii: Vec<f32> = after.strands.strands.iter().map(|s| s.radius).collect();
    let mean = radii.iter().sum::<f32>() / 2000.0;
    let spread = (radii.iter().map(|r| (r - mean).powi(2)).sum::<f32>() / 2000.0).sqrt() / mean;
    assert!((mean / 5e-5 - 1.0).abs() < 0.02 && (0.15..0.21).contains(&spread), "{mean} {spread}");
    let tip = after.strands.rest[63].unpack(&after.strands.bindings[0]).1;
    assert!((tip - 0.3).abs() < 0.003, "{tip}");
    // Shapes stay the same within the precision of the packing.
    assert!((0..2000).step_by(50).all(|i| line(&before, i)[30].distance(line(&after, i)[30]) < 1e-5));
}

#[test]
fn invalid_options_leave_groom_unchanged() {
    let mut strands = Strands::default();
    strands.push(&[Vec3::ZERO, Vec3::Y * 0.3]);
    let mut groom =
        bind(&strands, &BindOptions { strand_vertex_count: Some(16), ..Default::default() }).unwrap();
    let kept = groom.clone();
    let curls = Restyle { curls: regular(), ..Restyle::default() };
    let error = curls.apply(&mut groom, Vec3::ZERO, Vec3::ZERO).unwrap_err().to_string();
    assert!(error.contains("16 vertices"), "{error}");
    assert!(
        Restyle { width_variation: -1.0, ..Restyle::default() }
            .apply(&mut groom, Vec3::ZERO, Vec3::ZERO)
            .is_err()
    );
    assert_eq!(groom, kept);
}
