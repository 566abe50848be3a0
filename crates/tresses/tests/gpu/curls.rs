//! Curls in motion: the curls of the rest shape must neither collapse nor unwind while the head turns.

use crate::{
    common::{self, DrapedCharacter},
    moving,
};

use moving::{Character, TURN, advance_at, angle, drawn};
use tresses::{
    AvoidMode, AvoidOptions,
    glam::Vec3,
    groom::{
        grow::{Curls, Growth},
        styles::Style,
    },
};

const STRANDS: u32 = 400;

/// Returns a strand's curl radius (mean distance of its vertices from the mean of the surrounding turn), meters, and
/// the total angle between its successive edges, radians.
fn curl(line: &[Vec3], turn: usize) -> [f32; 2] {
    let half = turn / 2;
    let inner = half..line.len() - half;
    let n = inner.len() as f32;
    let radius = inner.map(|k| {
        let around = &line[k - half..=k + half];
        // The two ends of the window are at the same phase of the turn and count half.
        let sum = around.iter().sum::<Vec3>() - 0.5 * (around[0] + around[2 * half]);
        line[k].distance(sum / (2 * half) as f32)
    });
    let edges: Vec<Vec3> = line.windows(2).map(|w| w[1] - w[0]).collect();
    [radius.sum::<f32>() / n, edges.windows(2).map(|w| w[0].angle_between(w[1])).sum()]
}

/// Returns the 5th, 50th and 95th percentiles over the strands of current over rest value, for radius and total angle.
fn ratios(rest: &[[f32; 2]], now: &[[f32; 2]]) -> [[f32; 3]; 2] {
    [0, 1].map(|what| {
        let mut all: Vec<f32> = rest.iter().zip(now).map(|(rest, now)| now[what] / rest[what]).collect();
        all.sort_by(f32::total_cmp);
        [0.05, 0.5, 0.95].map(|share| all[(share * (all.len() - 1) as f32) as usize])
    })
}

/// Whether curls keep their shape: within 5 % in the median and within 25 % for nine in ten strands.
fn kept(ratios: [[f32; 3]; 2]) -> bool {
    ratios.iter().all(|[low, middle, high]| *low > 0.75 && (middle - 1.0).abs() < 0.05 && *high < 1.25)
}

#[test]
fn curls_keep_their_shape_while_the_head_turns() {
    let Some(context) = common::context() else { return };
    let style = Style::default();
    let curls = Curls { wavelength: 0.045, ..Curls::ringlets() };
    let growth = Growth::for_style(&style).with_strands(STRANDS).with_curls(curls);
    let built = DrapedCharacter::new(context, &style, growth);
    let character = Character::new(built.groom, built.field, built.neck);
    let mut hair = character.avoiding(AvoidOptions::default());
    let n = character.groom.strands.vertex_count as usize;
    // Vertices per turn of a strand of usual length.
    let turn = (0.045 / 0.28 * (n - 1) as f32) as usize;
    let mut measured: Option<Vec<[f32; 2]>> = None;
    let mut worst = [[1.0f32; 3]; 2];
    for i in 0..=56u32 {
        let head = character.head(angle(TURN, i as f32 / 24.0));
        advance_at(&mut hair, head, i, 24.0);
        if i % 7 != 0 {
            continue;
        }
        let vertices = drawn(&mut hair, head, AvoidMode::Off);
        let now: Vec<[f32; 2]> = vertices
            .chunks_exact(n)
            .map(|strand| curl(&strand.iter().map(|v| v.position).collect::<Vec<_>>(), turn))
            .collect();
        let Some(rest) = &measured else {
            measured = Some(now);
            continue;
        };
        let found = ratios(rest, &now);
        assert!(kept(found), "frame {i}: {found:?}");
        for (worst, found) in worst.iter_mut().zip(found) {
            *worst = [
                worst[0].min(found[0]),
                if (found[1] - 1.0).abs() > (worst[1] - 1.0).abs() { found[1] } else { worst[1] },
                worst[2].max(found[2]),
            ];
        }
        // Curls that have lost a tenth of their radius are detected.
        let limp: Vec<[f32; 2]> = now.iter().map(|[radius, turned]| [0.9 * radius, *turned]).collect();
        assert!(!kept(ratios(rest, &limp)));
    }
    println!("radius {:?}, turning {:?} of what they are at rest (5, 50, 95 %)", worst[0], worst[1]);
}
