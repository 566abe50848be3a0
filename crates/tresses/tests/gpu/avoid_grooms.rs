//! Share of strand vertices in the head while the built-in styles and a real groom move, in all modes of strand
//! collision: off, moving only the penetrating vertices, and changing over to the clump.

use crate::{common, moving};

use moving::{Character, Keys, SHAKE, TURN, advance_at, angle, drawn};
use tresses::{
    AvoidMode, AvoidOptions,
    glam::Vec3,
    groom::{BindOptions, BoundStrands, GuideCount, Strands, bind},
    low_level::StrandVertex,
};

const MODES: [AvoidMode; 3] = [AvoidMode::Off, AvoidMode::PenetratingOnly, AvoidMode::ChangeOver];
const FPS: f32 = 24.0;

/// Depth below the skin from which a vertex counts as penetrating, meters. For a vertex that rests in the skin, depth
/// below its rest position.
const DEPTH: f32 = 5e-4;

/// Returns the fraction of `vertices`, in head space, that penetrate by more than `depth`. A `depth` of 0 counts
/// vertices that rest outside and are now inside.
fn penetrating(character: &Character, rest: &[f32], vertices: impl Iterator<Item = Vec3>, depth: f32) -> f32 {
    let inside = |(p, rest): &(Vec3, &f32)| match depth {
        0.0 => **rest >= 0.0 && character.field.sample(*p) < 0.0,
        _ => character.field.sample(*p) < rest.min(0.0) - depth,
    };
    vertices.zip(rest).filter(inside).count() as f32 / rest.len() as f32
}

/// Returns for each of [`MODES`] the largest fraction in any frame of a motion: deeper than [`DEPTH`], and below the
/// surface at all. All modes see the same frames.
fn worst(character: &Character, keys: Keys) -> [[f32; 3]; 2] {
    let rest = character.rest_distances();
    let mut hair = character.avoiding(AvoidOptions::default());
    let mut worst = [[0.0f32; 3]; 2];
    for i in 0..=(keys[keys.len() - 1].0 * FPS) as u32 {
        let head = character.head(angle(keys, i as f32 / FPS));
        advance_at(&mut hair, head, i, FPS);
        if i % 4 != 0 {
            continue;
        }
        let back = head.inverse();
        // The buffers hold the result of `ChangeOver`, so read that mode first.
        for m in [2, 0, 1] {
            let vertices = drawn(&mut hair, head, MODES[m]);
            assert!(vertices.iter().all(|v| v.position.is_finite()));
            for (worst, depth) in worst.iter_mut().zip([DEPTH, 0.0]) {
                let points = vertices.iter().map(|v: &StrandVertex| back.point(v.position));
                worst[m] = worst[m].max(penetrating(character, &rest, points, depth));
            }
        }
    }
    worst
}

const MOTIONS: [(&str, Keys); 2] = [("turn", TURN), ("shake", SHAKE)];

/// Prints and checks one groom. `least` is the fraction that the worst frame must reach without strand collision;
/// otherwise the test shows nothing.
fn check(name: &str, character: &Character, motions: &[(&str, Keys)], least: f32) {
    for (motion, keys) in motions {
        let [deep, any] = worst(character, keys);
        let percent = |f: [f32; 3]| f.map(|f| format!("{:.3} %", 100.0 * f)).join(", ");
        println!("{name}, {motion}: deeper than 0.5 mm {}; at all {}", percent(deep), percent(any));
        assert!(deep[2] <= 0.001, "{name}, {motion}: {} with the method", deep[2]);
        assert!(deep[0] >= least, "{name}, {motion}: only {} without", deep[0]);
        assert!(deep[2] < 0.2 * deep[0] || deep[0] < 0.001, "{name}, {motion}: {deep:?}");
    }
}

#[test]
fn penetrating_vertices_stay_below_a_thousandth() {
    if common::context().is_some() {
        check("long", &Character::built_in("long", 1200), &[("shake", SHAKE)], 0.005);
    }
}

/// Prints the table of docs/validation/motion.md.
#[test]
#[ignore = "proof"]
fn penetrating_vertices_stay_below_a_thousandth_in_all_styles() {
    if common::context().is_none() {
        return;
    }
    for (name, least) in [("long", 0.005), ("bob", 0.002), ("curly", 0.005), ("short", 0.0)] {
        check(name, &Character::built_in(name, 1200), &MOTIONS, least);
    }
}

#[test]
fn counter_detects_a_strand_in_the_head() {
    if common::context().is_none() {
        return;
    }
    let character = Character::built_in("short", 1200);
    let rest = character.rest_distances();
    let strands = &character.groom.strands;
    let mut points: Vec<Vec3> = character.rest().collect();
    assert_eq!(penetrating(&character, &rest, points.iter().copied(), 1e-6), 0.0);
    for p in &mut points[..strands.vertex_count as usize] {
        *p -= character.field.normal(*p) * (character.field.sample(*p) + 3e-3);
    }
    assert!(penetrating(&character, &rest, points.iter().copied(), DEPTH) > 0.0003);
}

/// Prints the last rows of that table.
#[test]
#[ignore = "proof"]
fn penetrating_vertices_stay_below_a_thousandth_in_a_real_groom() {
    let Some((strands, _, field)) = common::sintel().filter(|_| common::context().is_some()) else { return };
    let crown = strands.iter().map(|strand| strand[0]).reduce(|a, b| if a.y > b.y { a } else { b }).unwrap();
    // As far below the crown as in the built-in head.
    let neck = Vec3::new(0.0, crown.y - 0.165, -0.012);
    // First one guide per strand, then fewer. A fourth of the strands is enough.
    let mut few = Strands::default();
    (0..strands.len()).step_by(16).for_each(|i| few.push(strands.strand(i)));
    let own = bind(&few, &BindOptions { guides: GuideCount::All, ..Default::default() }).unwrap();
    check("Sintel, all guides", &Character::new(own, field.clone(), neck), &MOTIONS, 0.0);
    for (share, least) in [(16, 0.0), (64, 0.0005)] {
        let guides = GuideCount::OneIn(share);
        let mut groom = bind(strands, &BindOptions { guides, ..Default::default() }).unwrap();
        thin(&mut groom.strands, 4);
        let character = Character::new(groom, field.clone(), neck);
        check(&format!("Sintel, one guide in {share}"), &character, &MOTIONS, least);
    }
}

/// Keeps one strand in `n`.
fn thin(strands: &mut BoundStrands, n: usize) {
    let per_strand = strands.vertex_count as usize;
    strands.strands = strands.strands.iter().copied().step_by(n).collect();
    strands.bindings = strands.bindings.iter().copied().step_by(n).collect();
    strands.rest = strands.rest.chunks(per_strand).step_by(n).flatten().copied().collect();
}
