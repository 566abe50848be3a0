//! Strand collision: the first hit is the first penetrating vertex along a strand, strands without a hit stay
//! bit-identical, lengths are kept, nothing pops, and teleports complete all transitions.

use crate::{common, moving};

use moving::{Character, SHAKE, TURN, advance, advance_at, angle, drawn, search, states};
use tresses::{
    AvoidMode, AvoidOptions, Pose,
    glam::Vec3,
    low_level::{Hair, NO_HIT, StrandVertex},
};

const CLEARANCE: f32 = 1.5e-3;

/// Creates a ball with so few guides that strands between them enter it.
fn character() -> Option<Character> {
    common::context()?;
    Some(Character::on_a_ball(600, 0.16, &Default::default()))
}

impl Character {
    /// Returns hair shaken until strands are in the head, and the head's pose at that time.
    fn shaken(&self, avoid: AvoidOptions) -> (Hair, Pose) {
        let mut hair = self.avoiding(avoid);
        for i in 0..36 {
            advance_at(&mut hair, self.head(angle(SHAKE, i as f32 / 60.0)), i, 60.0);
        }
        (hair, self.head(angle(SHAKE, 35.0 / 60.0)))
    }

    /// Returns for each strand the first vertex that is closer to the head than allowed by `tolerance` plus `margin`,
    /// meters.
    fn first_hits(&self, vertices: &[StrandVertex], head: Pose, tolerance: f32, margin: f32) -> Vec<u32> {
        let back = head.inverse();
        let distance = |v: &StrandVertex| self.field.sample(back.point(v.position));
        let strands = &self.groom.strands;
        vertices
            .chunks(strands.vertex_count as usize)
            .enumerate()
            .map(|(i, strand)| {
                let rest = strands.rest_positions(i).map(|p| self.field.sample(p));
                let enters =
                    |(v, rest): (&StrandVertex, f32)| distance(v) < CLEARANCE.min(rest) - tolerance - margin;
                let hit = strand.iter().zip(rest).skip(1).position(enters);
                hit.map_or(NO_HIT, |j| j as u32 + 1)
            })
            .collect()
    }
}

#[test]
fn first_hit_matches_sequential_search() {
    let Some(character) = character() else { return };
    let options = AvoidOptions { mode: AvoidMode::Off, ..Default::default() };
    let (mut hair, head) = character.shaken(options);
    let vertices = drawn(&mut hair, head, AvoidMode::Off);
    let found: Vec<u32> = search(&hair).iter().map(|state| state.hit).collect();
    // Texture filtering and quantized distances make the kernel up to an eighth of a millimeter less precise than this
    // search.
    let early = character.first_hits(&vertices, head, options.tolerance, -0.02e-3);
    let late = character.first_hits(&vertices, head, options.tolerance, 0.16e-3);
    let wrong = |found: &[u32]| {
        found.iter().zip(early.iter().zip(&late)).filter(|(f, (e, l))| *f < *e || *f > *l).count()
    };
    assert_eq!(wrong(&found), 0);
    // The search is unambiguous for nearly all strands, with hits and without.
    let sure = early.iter().zip(&late).filter(|(early, late)| early == late);
    let (hits, misses): (Vec<_>, Vec<_>) = sure.partition(|(early, _)| **early != NO_HIT);
    println!("{} of 600 strands hit for sure, {} do not", hits.len(), misses.len());
    assert!(hits.len() + misses.len() > 570 && hits.len() > 30);
    let sure = (0..600).find(|&i| found[i] != NO_HIT && early[i] == late[i]).unwrap();
    for other in [found[sure] - 1, found[sure] + 1, NO_HIT] {
        let mut perturbed = found.clone();
        perturbed[sure] = other;
        assert_eq!(wrong(&perturbed), 1);
    }
}

#[test]
fn strands_without_hit_are_unchanged_and_lengths_are_kept() {
    let Some(character) = character() else { return };
    let (mut hair, head) = character.shaken(AvoidOptions::default());
    let after = drawn(&mut hair, head, AvoidMode::ChangeOver);
    let remembered = states(&hair);
    let before = drawn(&mut hair, head, AvoidMode::Off);
    let strands = &character.groom.strands;
    let n = strands.vertex_count as usize;
    let (mut kept, mut changed) = (0, 0);
    for (i, state) in remembered.iter().enumerate() {
        assert_eq!(state.hit, NO_HIT, "the search starts anew in every frame");
        let (a, b) = (&before[i * n..(i + 1) * n], &after[i * n..(i + 1) * n]);
        let same = bytemuck::cast_slice::<_, u8>(a) == bytemuck::cast_slice::<_, u8>(b);
        if state.amount == 0.0 {
            assert!(same, "strand {i}");
            kept += 1;
        } else {
            changed += usize::from(!same);
        }
        let rest: Vec<_> = strands.rest_positions(i).collect();
        for (now, rest) in b.windows(2).zip(rest.windows(2)) {
            let (now, rest) = (now[0].position.distance(now[1].position), rest[0].distance(rest[1]));
            assert!((now / rest - 1.0).abs() < 1e-3, "strand {i}: {now} for {rest}");
        }
    }
    assert!(kept > 50 && changed > 20, "{kept} kept, {changed} changed");
    // For comparison: moving single vertices stretches their edges.
    let alone = drawn(&mut hair, head, AvoidMode::PenetratingOnly);
    let rest: Vec<_> = character.rest().collect();
    let ratio = |j: usize| alone[j].position.distance(alone[j + 1].position) / rest[j].distance(rest[j + 1]);
    let longest = (0..alone.len()).filter(|j| (j + 1) % n > 0).map(ratio).fold(0.0, f32::max);
    assert!(longest > 1.01, "{longest}");
}

/// Returns the largest displacement per frame that strand collision alone adds to a vertex, relative to the head,
/// meters: the change from frame to frame of the offset from its position without strand collision.
fn largest_pop(character: &Character, options: AvoidOptions) -> f32 {
    let mut hair = character.avoiding(options);
    let mut last: Option<Vec<Vec3>> = None;
    let mut largest = 0.0f32;
    for i in 0..90 {
        // A third of the speed of the command's `turn`.
        let head = character.head(angle(TURN, i as f32 / 180.0));
        advance_at(&mut hair, head, i, 60.0);
        let with = drawn(&mut hair, head, AvoidMode::ChangeOver);
        let without = drawn(&mut hair, head, AvoidMode::Off);
        let back = head.inverse().rotation;
        let way: Vec<Vec3> =
            with.iter().zip(&without).map(|(a, b)| back * (a.position - b.position)).collect();
        if let Some(last) = &last {
            largest = way.iter().zip(last).map(|(a, b)| a.distance(*b)).fold(largest, f32::max);
        }
        last = Some(way);
    }
    largest
}

#[test]
fn strand_collision_does_not_pop() {
    let Some(character) = character() else { return };
    let smooth = largest_pop(&character, AvoidOptions::default());
    let sudden = AvoidOptions { fade_in: 0.0, fade_out: 0.0, speed: f32::INFINITY, ..Default::default() };
    let sudden = largest_pop(&character, sudden);
    println!("largest change per frame: {smooth} m, without smoothing {sudden} m");
    // The bound is 15 cm/s; swinging hair is several times faster.
    assert!(smooth < 0.15 / 60.0, "{smooth}");
    assert!(sudden > 3.0 * 0.15 / 60.0, "the bound can be missed: {sudden}");
}

#[test]
fn jumps_and_resets_end_transitions() {
    let Some(character) = character() else { return };
    let (mut hair, head) = character.shaken(AvoidOptions::default());
    let midway = |hair: &Hair| states(hair).iter().filter(|s| s.amount > 0.0 && s.amount < 1.0).count();
    assert!(midway(&hair) > 5, "{}", midway(&hair));
    let far = Pose { translation: head.translation + Vec3::X * 30.0, ..head };
    advance(&mut hair, far, 1.0 / 60.0);
    assert_eq!(midway(&hair), 0);
    let changed = states(&hair).iter().filter(|s| s.amount == 1.0).count();
    assert!(changed > 20, "what is in the head leaves it at once: {changed}");
    hair.reset();
    advance(&mut hair, far, 1.0 / 60.0);
    assert!(states(&hair).iter().all(|s| s.amount == 0.0));
}
