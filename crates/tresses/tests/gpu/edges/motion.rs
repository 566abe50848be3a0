//! Shimmer: how much more a picture changes from frame to frame than it should while the hair turns
//! slowly.

use super::{
    MASK_1, MASK_4, MASK_4_2X, MASK_8, MASK_16, Mode, PEEL, PEEL_2X, TILES, TILES_1, TILES_2X,
    coverage::scene,
    groom::Groom,
    mode, modes,
    picture::{Studio, write},
};
use crate::common;
use tresses::{Context, draw::Coverage, present::Background, view::Picture};

const SIZE: [u32; 2] = [192, 160];
const FRAMES: u32 = 4;
/// From where the groom is seen, metres: strands are 0.33 and 0.11 pixels wide at the root.
const DISTANCES: [f32; 2] = [0.5, 1.5];
/// Turn per frame: a tenth of a pixel to a third.
const STEP: f32 = 0.003;

/// Four samples of sixteen pixels for each pixel.
const REFERENCE: Mode = mode("4×MSAA, 4× SSAA", 4, Coverage::SampleMask, 4);

type Frames = Vec<Vec<[u8; 4]>>;

/// What the frames look like from each distance.
fn frames(context: &Context, mode: Mode, groom: &Groom, distances: &[f32]) -> Vec<Frames> {
    let studio = Studio::new(context, mode, SIZE);
    let (hair, strands) = studio.hair(groom);
    let turned = |distance: &f32| {
        let scene = Picture { background: Background::default(), ..scene(*distance, SIZE) };
        (0..FRAMES)
            .map(|frame| {
                write(context, &groom.turned(STEP * frame as f32), &strands);
                studio.picture(&scene, &hair)
            })
            .collect()
    };
    distances.iter().map(turned).collect()
}

/// The root of the mean squared change from a frame to the next.
fn change(frames: &[Vec<[u8; 4]>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for pair in frames.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            for c in 0..3 {
                sum += (f64::from(a[c]) - f64::from(b[c])).powi(2);
                count += 1.0;
            }
        }
    }
    (sum / count).sqrt()
}

/// The root of the mean squared difference from what the frames should look like.
fn difference(frames: &[Vec<[u8; 4]>], exact: &[Vec<[u8; 4]>]) -> f64 {
    let pairs: Vec<_> = frames.iter().zip(exact).map(|(a, b)| change(&[a.clone(), b.clone()])).collect();
    (pairs.iter().map(|v| v * v).sum::<f64>() / pairs.len() as f64).sqrt()
}

#[test]
fn nothing_shimmers_in_motion() {
    let Some(context) = common::context() else { return };
    judge(context, &[MASK_4, MASK_1, TILES], &DISTANCES[1..]);
}

/// The table of docs/appearance/edges.md.
#[test]
#[ignore = "proof"]
fn nothing_shimmers_in_any_mode() {
    let Some(context) = common::context() else { return };
    judge(context, &modes(context.tier().max_samples).collect::<Vec<_>>(), &DISTANCES);
}

/// Holds the changes from frame to frame in `modes` against those of many more samples.
fn judge(context: &Context, modes: &[Mode], distances: &[f32]) {
    let groom = Groom::on_a_ball(2500, 2.5e-4);
    let exact = frames(context, REFERENCE, &groom, distances);
    let motion: Vec<_> = exact.iter().map(|frames| change(frames)).collect();
    println!("{distances:?} m: frames change by {motion:.2?} / 255");
    for &mode in modes {
        let drawn = frames(context, mode, &groom, distances);
        let ratios: Vec<_> =
            drawn.iter().zip(&motion).map(|(frames, motion)| change(frames) / motion).collect();
        let off: Vec<_> = drawn.iter().zip(&exact).map(|(drawn, exact)| difference(drawn, exact)).collect();
        println!("{:36} {ratios:.2?} times, {off:.2?} / 255 off", mode.name);
        if [PEEL, PEEL_2X, MASK_4_2X, MASK_4, MASK_8, MASK_16].contains(&mode) {
            assert!(ratios.iter().all(|ratio| *ratio < 1.2), "{}: {ratios:?}", mode.name);
        }
        if [TILES, TILES_1, TILES_2X].contains(&mode) {
            assert!(ratios.iter().all(|ratio| *ratio < 1.0), "{}: {ratios:?}", mode.name);
        }
        // Nor is it quiet because it is washed out: the pixel's own four samples are 5.6 and 2.1 off.
        if mode == MASK_4 {
            let most = |distance: &f32| if *distance == DISTANCES[0] { 4.6 } else { 1.5 };
            assert!(off.iter().zip(distances).all(|(off, distance)| *off < most(distance)), "{off:?}");
        }
        // The comparison sees single samples come and go.
        if mode == MASK_1 {
            assert!(ratios.iter().all(|ratio| *ratio > 1.2), "{}: {ratios:?}", mode.name);
        }
    }
}
