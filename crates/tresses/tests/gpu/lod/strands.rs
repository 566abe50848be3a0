//! Strands at a level of detail.

use super::stage::Setup;
use crate::common;
use tresses::{
    LodLevel, LodMode, Pose,
    glam::{Quat, Vec3},
    groom::{Groom, bind, scalp::ScalpMap},
    low_level::{Detail, Hair, HairAsset, HairDescriptor, lod::arrange, readback::blocking as readback},
};

/// Creates hanging strands in the order in which `Hair` stores them.
fn arranged(count: usize, length: f32) -> Groom {
    let mut groom = bind(&common::hanging(count, 16, length), &Default::default()).unwrap();
    arrange(&mut groom.strands);
    groom
}

#[test]
fn strands_with_fewer_vertices_keep_their_shape() {
    let Some(stage) = Setup::open() else { return };
    let groom = arranged(400, 0.2);
    let mut hair = stage.hair(&groom, None);
    let full = *hair.lod.current();
    for segments in [15.0, 14.5, 7.4, 3.0, 1.0] {
        hair.set_detail(Detail { segment_count: segments, strand_count: 300, ..full });
        stage.advance(&mut hair, Pose::IDENTITY, 0.0);
        let drawn = hair.strands.drawn;
        assert_eq!((drawn.count, drawn.vertex_count), (300, segments.ceil() as u32 + 1));
        let vertices = common::vertices(&hair);
        for (i, strand) in vertices.chunks(drawn.vertex_count as usize).take(300).enumerate() {
            let rest: Vec<_> = groom.strands.rest_positions(i).collect();
            let expected = tresses::low_level::lod::resample(&rest, segments);
            for (v, p) in strand.iter().zip(&expected) {
                assert!(v.position.distance(*p) < 2e-4, "{segments} {i}: {} {p}", v.position);
            }
            // A strand with another number of segments is elsewhere.
            let other = tresses::low_level::lod::resample(&rest, 0.9 * segments);
            let off = strand.iter().zip(&other).map(|(v, p)| v.position.distance(*p)).fold(0.0, f32::max);
            assert!(segments == 1.0 || off > 2e-4);
        }
    }
}

#[test]
fn strands_that_return_start_without_a_hit() {
    let Some(stage) = Setup::open() else { return };
    let groom = arranged(600, 0.16);
    let field = common::ball(0.09, 64);
    let mut hair = stage.hair(&groom, Some(&field));
    let context = stage.context;
    let turn = |t: f32| Pose::about(Vec3::new(0.0, 0.0, -0.02), Quat::from_rotation_y((10.0 * t).sin()));
    for i in 1..40 {
        stage.advance(&mut hair, turn(i as f32 / 60.0), 1.0 / 60.0);
    }
    let amounts = |hair: &Hair| -> Vec<f32> {
        let states: Vec<[f32; 4]> = readback::buffer(context, hair.avoidance.states()).unwrap();
        states.iter().map(|state| state[1]).collect()
    };
    let most = |amounts: &[f32]| amounts.iter().copied().fold(0.0, f32::max);
    let before = amounts(&hair);
    assert!(most(&before[300..]) > 0.9, "{}", most(&before[300..]));
    let full = *hair.lod.current();
    hair.set_detail(Detail { strand_count: 300, ..full });
    stage.advance(&mut hair, turn(40.0 / 60.0), 1.0 / 60.0);
    assert!(most(&amounts(&hair)[300..]) > 0.9, "what is not drawn is left alone");
    hair.set_detail(full);
    stage.advance(&mut hair, turn(41.0 / 60.0), 1.0 / 60.0);
    let after = amounts(&hair);
    println!(
        "largest amount {} of those that come back, {} of others",
        most(&after[300..]),
        most(&after[..300])
    );
    assert!(most(&after[300..]) < 0.5 && most(&after[..300]) > 0.9);
}

#[test]
fn painted_levels_act_where_they_are_painted() {
    let Some(stage) = Setup::open() else { return };
    let groom = arranged(400, 0.2);
    let context = stage.context;
    let side =
        |left: f32, right: f32| Some(ScalpMap::from_fn(64, move |uv| if uv.x > 0.5 { left } else { right }));
    let levels = [
        LodLevel { size: 400.0, ..Default::default() },
        LodLevel { size: 100.0, density: side(0.0, 1.0), thickness: side(1.0, 2.0) },
    ];
    let what = HairDescriptor { levels: &levels, ..Default::default() };
    let mut hair = Hair::new(&HairAsset::new(context, groom.clone(), &what).unwrap()).unwrap();
    hair.lod.options.mode = LodMode::Off;
    let mut scales = |size: f32| -> Vec<(f32, f32)> {
        let detail = hair.lod.detail(1e-3, size);
        hair.set_detail(detail);
        stage.advance(&mut hair, Pose::IDENTITY, 0.0);
        let widening: Vec<f32> = readback::buffer(context, &hair.strands.widening).unwrap();
        let root = |i: usize| groom.strands.rest_positions(i).next().unwrap().x;
        // Away from the blend between the two sides.
        (0..400).filter(|i| root(*i).abs() > 0.03).map(|i| (root(i), 1.0 + widening[i])).collect()
    };
    assert!(scales(500.0).iter().all(|(_, scale)| (scale - 1.0).abs() < 1e-3));
    assert!(scales(50.0).iter().all(|(x, scale)| (scale - if *x > 0.0 { 0.0 } else { 2.0 }).abs() < 0.02));
    let half = scales(200.0);
    // Half of the strands on the left are drawn, and the strands on the right are one and a half times as wide.
    let left: Vec<_> = half.iter().filter(|(x, _)| *x > 0.0).map(|(_, scale)| *scale).collect();
    let mean = left.iter().sum::<f32>() / left.len() as f32;
    assert!((mean - 0.5).abs() < 0.08, "{mean}");
    assert!(half.iter().filter(|(x, _)| *x < 0.0).all(|(_, scale)| (scale - 1.5).abs() < 0.02));
}
