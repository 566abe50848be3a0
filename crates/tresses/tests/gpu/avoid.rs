//! Strand collision: the first hit is the first penetrating vertex along a strand, strands without a hit stay
//! bit-identical, lengths are kept, nothing pops, and teleports complete all transitions.

use crate::{common, moving};

use moving::{Character, SHAKE, TURN, advance, angle, drawn, search, states};
use tresses::{
    AvoidMode, AvoidOptions, Context, Pose,
    glam::Vec3,
    groom::{BindOptions, bind},
    low_level::{Hair, NO_HIT, StrandVertex},
};

const HEAD: f32 = 0.09;
const CLEARANCE: f32 = 1.5e-3;

/// Groom and device of all tests. A software driver takes long to build pipelines.
struct Setup {
    context: &'static Context,
    character: Character,
}

impl Setup {
    fn open() -> Option<&'static Self> {
        static SETUPS: tresses_testing::Pool<Setup> = tresses_testing::Pool::new();
        SETUPS.get(Self::new)
    }

    /// Creates a ball with so few guides that strands between them enter it.
    fn new() -> Option<Self> {
        let context = common::context()?;
        let mut groom = bind(&common::hanging(600, 16, 0.16), &BindOptions::default()).unwrap();
        // `Hair` stores the strands in this order.
        tresses::low_level::lod::arrange(&mut groom.strands);
        Some(Self {
            character: Character { groom, field: common::ball(HEAD, 64), neck: Vec3::new(0.0, 0.0, -0.02) },
            context,
        })
    }

    fn hair(&self, avoid: AvoidOptions) -> Hair {
        self.character.hair(self.context, avoid)
    }

    /// Returns hair shaken until strands are in the head, and the head's pose at that time.
    fn shaken(&self, avoid: AvoidOptions) -> (Hair, Pose) {
        let mut hair = self.hair(avoid);
        for i in 0..36 {
            let head = self.character.head(angle(SHAKE, i as f32 / 60.0));
            advance(self.context, &mut hair, head, if i == 0 { 0.0 } else { 1.0 / 60.0 });
        }
        (hair, self.character.head(angle(SHAKE, 35.0 / 60.0)))
    }

    fn drawn(&self, hair: &mut Hair, head: Pose, mode: AvoidMode) -> Vec<StrandVertex> {
        drawn(self.context, hair, head, mode)
    }

    /// Returns for each strand the first vertex that is closer to the head than allowed by `tolerance` plus `margin`,
    /// meters.
    fn first_hits(&self, vertices: &[StrandVertex], head: Pose, tolerance: f32, margin: f32) -> Vec<u32> {
        let back = head.inverse();
        let distance = |v: &StrandVertex| self.character.field.sample(back.point(v.position));
        let strands = &self.character.groom.strands;
        vertices
            .chunks(strands.vertex_count as usize)
            .enumerate()
            .map(|(i, strand)| {
                let rest = strands.rest_positions(i).map(|p| self.character.field.sample(p));
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
    let Some(stage) = Setup::open() else { return };
    let options = AvoidOptions { mode: AvoidMode::Off, ..Default::default() };
    let (mut hair, head) = stage.shaken(options);
    let vertices = stage.drawn(&mut hair, head, AvoidMode::Off);
    let found: Vec<u32> = search(stage.context, &hair).iter().map(|state| state.hit).collect();
    // Texture filtering and quantized distances make the kernel up to an eighth of a millimeter less precise than this
    // search.
    let early = stage.first_hits(&vertices, head, options.tolerance, -0.02e-3);
    let late = stage.first_hits(&vertices, head, options.tolerance, 0.16e-3);
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
    let Some(stage) = Setup::open() else { return };
    let (mut hair, head) = stage.shaken(AvoidOptions::default());
    let after = stage.drawn(&mut hair, head, AvoidMode::ChangeOver);
    let remembered = states(stage.context, &hair);
    let before = stage.drawn(&mut hair, head, AvoidMode::Off);
    let strands = &stage.character.groom.strands;
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
    let alone = stage.drawn(&mut hair, head, AvoidMode::PenetratingOnly);
    let longest = alone
        .chunks(n)
        .enumerate()
        .flat_map(|(i, strand)| {
            let rest: Vec<_> = strands.rest_positions(i).collect();
            let ratio = |j: usize| {
                strand[j].position.distance(strand[j + 1].position) / rest[j].distance(rest[j + 1])
            };
            (0..n - 1).map(ratio).collect::<Vec<_>>()
        })
        .fold(0.0, f32::max);
    assert!(longest > 1.01, "{longest}");
}

/// Returns the largest displacement per frame that strand collision alone adds to a vertex, relative to the head,
/// meters: the change from frame to frame of the offset from its position without strand collision.
fn largest_pop(stage: &Setup, options: AvoidOptions) -> f32 {
    let mut hair = stage.hair(options);
    let mut last: Option<Vec<Vec3>> = None;
    let mut largest = 0.0f32;
    for i in 0..90 {
        // A third of the speed of the command's `turn`.
        let head = stage.character.head(angle(TURN, i as f32 / 180.0));
        advance(stage.context, &mut hair, head, if i == 0 { 0.0 } else { 1.0 / 60.0 });
        let with = stage.drawn(&mut hair, head, AvoidMode::ChangeOver);
        let without = stage.drawn(&mut hair, head, AvoidMode::Off);
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
    let Some(stage) = Setup::open() else { return };
    let smooth = largest_pop(stage, AvoidOptions::default());
    let sudden = AvoidOptions { fade_in: 0.0, fade_out: 0.0, speed: f32::INFINITY, ..Default::default() };
    let sudden = largest_pop(stage, sudden);
    println!("largest change per frame: {smooth} m, without smoothing {sudden} m");
    // The bound is 15 cm/s; swinging hair is several times faster.
    assert!(smooth < 0.15 / 60.0, "{smooth}");
    assert!(sudden > 3.0 * 0.15 / 60.0, "the bound can be missed: {sudden}");
}

#[test]
fn jumps_and_resets_end_transitions() {
    let Some(stage) = Setup::open() else { return };
    let (mut hair, head) = stage.shaken(AvoidOptions::default());
    let midway =
        |hair: &Hair| states(stage.context, hair).iter().filter(|s| s.amount > 0.0 && s.amount < 1.0).count();
    assert!(midway(&hair) > 5, "{}", midway(&hair));
    let far = Pose { translation: head.translation + Vec3::X * 30.0, ..head };
    advance(stage.context, &mut hair, far, 1.0 / 60.0);
    assert_eq!(midway(&hair), 0);
    let changed = states(stage.context, &hair).iter().filter(|s| s.amount == 1.0).count();
    assert!(changed > 20, "what is in the head leaves it at once: {changed}");
    hair.reset();
    advance(stage.context, &mut hair, far, 1.0 / 60.0);
    assert!(states(stage.context, &hair).iter().all(|s| s.amount == 0.0));
}
