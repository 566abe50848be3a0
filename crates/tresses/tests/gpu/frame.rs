//! The whole motion path on the GPU: bit-identical runs, the same motion at any frame rate, constant lengths, no hair
//! in the head, and teleports.

use crate::{
    common,
    moving::{Character, advance, advance_at},
};

use tresses::{
    Pose,
    glam::{Quat, Vec3},
    low_level::StrandVertex,
};

const HEAD: f32 = 0.09;

fn character() -> Option<Character> {
    common::context()?;
    Some(Character::on_a_ball(300, 0.12, &Default::default()))
}

impl Character {
    /// Returns the vertices and the head's pose after `seconds` of turning at a constant rate, at `fps`.
    fn turned(&self, seconds: f32, fps: f32) -> (Vec<StrandVertex>, Pose) {
        let mut hair = self.hair(&Default::default());
        let pose = |t: f32| Pose::about(Vec3::ZERO, Quat::from_rotation_y(1.5 * t));
        for i in 0..=(seconds * fps).round() as u32 {
            advance_at(&mut hair, pose(i as f32 / fps), i, fps);
        }
        (common::vertices(&hair), pose(seconds))
    }

    /// Returns the largest relative deviation of a strand's length from its rest length.
    fn strain(&self, positions: &[Vec3]) -> f32 {
        let (n, rest) = (self.groom.strands.vertex_count as usize, self.rest().collect::<Vec<_>>());
        let strain =
            |(now, rest): (&[Vec3], &[Vec3])| (common::length(now) / common::length(rest) - 1.0).abs();
        positions.chunks(n).zip(rest.chunks(n)).map(strain).fold(0.0, f32::max)
    }
}

fn largest_difference(a: &[StrandVertex], b: &[StrandVertex]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.position.distance(b.position)).fold(0.0, f32::max)
}

#[test]
fn runs_are_bit_identical() {
    let Some(character) = character() else { return };
    let (first, _) = character.turned(0.5, 60.0);
    let (second, _) = character.turned(0.5, 60.0);
    assert_eq!(bytemuck::cast_slice::<_, u8>(&first), bytemuck::cast_slice::<_, u8>(&second));
    // The hair moved; otherwise equality would show nothing.
    let mut still = character.hair(&Default::default());
    advance(&mut still, Pose::IDENTITY, 0.0);
    assert!(largest_difference(&first, &common::vertices(&still)) > 0.01);
}

#[test]
fn motion_is_the_same_at_any_frame_rate() {
    let Some(character) = character() else { return };
    let (at_60, head) = character.turned(0.5, 60.0);
    for fps in [30.0, 120.0, 144.0] {
        let (other, _) = character.turned(0.5, fps);
        // At 144 frames per second, the last frame lies between two steps.
        let off = largest_difference(&at_60, &other);
        assert!(off < 2e-3, "{fps} fps: {off} m");
    }
    assert!((head.point(Vec3::X) - Vec3::X).length() > 0.5);
}

#[test]
fn moving_strands_keep_their_lengths_and_stay_out_of_the_head() {
    let Some(character) = character() else { return };
    let mut hair = character.hair(&Default::default());
    for i in 0..90 {
        let angle = 0.8 * (std::f32::consts::TAU * i as f32 / 30.0).sin();
        let pose = Pose::about(Vec3::ZERO, Quat::from_rotation_y(angle));
        advance(&mut hair, pose, 1.0 / 60.0);
        if i % 15 != 14 {
            continue;
        }
        let positions = common::positions(&hair);
        assert!(positions.iter().all(|p| p.is_finite()));
        let strain = character.strain(&positions);
        assert!(strain < 0.02, "frame {i}: {strain}");
        // Some strands of this groom rest in the head. A few of them are centimeters deep, where the distance to the
        // skin no longer holds them, so they swing. The others must not be deeper than at rest.
        let (mut worst, mut worst_buried) = (0.0f32, 0.0f32);
        for (p, rest) in positions.iter().zip(character.rest()) {
            let deeper = HEAD.min(rest.length()) - p.length();
            let worst = if rest.length() < HEAD - 5e-3 { &mut worst_buried } else { &mut worst };
            *worst = worst.max(deeper);
        }
        assert!(worst < 1e-3, "frame {i}: {worst} m in the head");
        assert!(worst_buried < 0.02, "frame {i}: what rests in the head is {worst_buried} m deeper");
    }
}

#[test]
fn teleports_and_long_pauses_keep_the_style() {
    let Some(character) = character() else { return };
    let mut hair = character.hair(&Default::default());
    advance(&mut hair, Pose::IDENTITY, 0.0);
    let rest = common::positions(&hair);
    let far = Pose { translation: Vec3::new(40.0, 1.0, -3.0), ..Pose::IDENTITY };
    for dt in [1.0 / 60.0, 100.0, f32::NAN] {
        advance(&mut hair, far, dt);
    }
    let after: Vec<_> = common::positions(&hair).iter().map(|p| *p - far.translation).collect();
    let off = common::apart(&rest, &after);
    assert!(off < 0.01, "{off}");
}
