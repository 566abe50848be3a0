//! How many drawn vertices are in the head while the built-in styles and a real groom move: with no
//! avoidance, with only the penetrating vertices moved, and with strands that change over.

use crate::{common, moving};

use moving::{Character, Keys, SHAKE, TURN, advance, angle, drawn};
use tresses::{
    Context,
    avoid::{AvoidMode, AvoidOptions},
    glam::Vec3,
    groom::{BindOptions, BoundStrands, GuideCount, Strands, bind},
    lod,
    strands::StrandVertex,
};

const MODES: [AvoidMode; 3] = [AvoidMode::Off, AvoidMode::PenetratingOnly, AvoidMode::ChangeOver];
const FPS: f32 = 24.0;

/// Deeper than this below the skin a vertex penetrates; one that rests in the skin, deeper than this
/// below where it rests. Metres.
const DEPTH: f32 = 5e-4;

/// The fraction of `vertices`, in the frame of the head, that penetrates by more than `depth`. With
/// 0: of those that rest outside, the ones that are inside.
fn penetrating(character: &Character, rest: &[f32], vertices: impl Iterator<Item = Vec3>, depth: f32) -> f32 {
    let inside = |(p, rest): &(Vec3, &f32)| match depth {
        0.0 => **rest >= 0.0 && character.field.sample(*p) < 0.0,
        _ => character.field.sample(*p) < rest.min(0.0) - depth,
    };
    vertices.zip(rest).filter(inside).count() as f32 / rest.len() as f32
}

/// The largest fraction over the frames of a motion for each of [`MODES`], of the same frames:
/// deeper than [`DEPTH`], and below the surface at all.
fn worst(context: &Context, character: &Character, keys: Keys) -> [[f32; 3]; 2] {
    let rest = character.rest_distances();
    let mut hair = character.hair(context, AvoidOptions::default());
    let mut worst = [[0.0f32; 3]; 2];
    for i in 0..=(keys[keys.len() - 1].0 * FPS) as u32 {
        let head = character.head(angle(keys, i as f32 / FPS));
        advance(context, &mut hair, head, if i == 0 { 0.0 } else { 1.0 / FPS });
        if i % 4 != 0 {
            continue;
        }
        let back = head.inverse();
        // The present state is that of the change-over: it is read first.
        for m in [2, 0, 1] {
            let vertices = drawn(context, &mut hair, head, MODES[m]);
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

/// Prints and checks one groom. `least` is what the worst frames must have without avoidance for the
/// test to mean something.
fn check(name: &str, context: &Context, character: &Character, motions: &[(&str, Keys)], least: f32) {
    for (motion, keys) in motions {
        let [deep, any] = worst(context, character, keys);
        let percent = |f: [f32; 3]| f.map(|f| format!("{:.3} %", 100.0 * f)).join(", ");
        println!("{name}, {motion}: deeper than 0.5 mm {}; at all {}", percent(deep), percent(any));
        assert!(deep[2] <= 0.001, "{name}, {motion}: {} with the method", deep[2]);
        assert!(deep[0] >= least, "{name}, {motion}: only {} without", deep[0]);
        assert!(deep[2] < 0.2 * deep[0] || deep[0] < 0.001, "{name}, {motion}: {deep:?}");
    }
}

fn style(name: &str) -> Character {
    let built = common::character(name, 1200).expect("there is a GPU");
    let mut groom = built.groom.clone();
    lod::arrange(&mut groom.strands);
    Character { groom, field: built.field.clone(), neck: built.neck }
}

#[test]
fn at_most_a_thousandth_of_the_vertices_is_in_the_head() {
    let Some(context) = common::context() else { return };
    check("long", context, &style("long"), &[("shake", SHAKE)], 0.005);
}

/// The table of docs/physics.md.
#[test]
#[ignore = "proof"]
fn at_most_a_thousandth_of_the_vertices_of_any_style_is_in_the_head() {
    let Some(context) = common::context() else { return };
    for (name, least) in [("long", 0.005), ("bob", 0.002), ("curly", 0.005), ("short", 0.0)] {
        check(name, context, &style(name), &MOTIONS, least);
    }
}

#[test]
fn the_counter_sees_a_strand_in_the_head() {
    if common::context().is_none() {
        return;
    }
    let character = style("short");
    let rest = character.rest_distances();
    let strands = &character.groom.strands;
    let mut points: Vec<Vec3> = (0..strands.len()).flat_map(|i| strands.rest_positions(i)).collect();
    assert_eq!(penetrating(&character, &rest, points.iter().copied(), 1e-6), 0.0);
    for p in &mut points[..strands.vertex_count as usize] {
        *p -= character.field.normal(*p) * (character.field.sample(*p) + 3e-3);
    }
    assert!(penetrating(&character, &rest, points.iter().copied(), DEPTH) > 0.0003);
}

/// The last rows of that table.
#[test]
#[ignore = "proof"]
fn a_real_groom_is_served_too() {
    let Some(context) = common::context() else { return };
    let Some((strands, _, field)) = common::sintel() else { return };
    let crown = strands.iter().map(|strand| strand[0]).reduce(|a, b| if a.y > b.y { a } else { b }).unwrap();
    // The built-in head's joint is as far below its crown.
    let neck = Vec3::new(0.0, crown.y - 0.165, -0.012);
    // One guide to each strand, then fewer and fewer; of what is drawn every fourth strand will do.
    let mut few = Strands::default();
    (0..strands.len()).step_by(16).for_each(|i| few.push(strands.strand(i)));
    let mut own = bind(&few, &BindOptions { guides: GuideCount::All, ..Default::default() }).unwrap();
    lod::arrange(&mut own.strands);
    check(
        "Sintel, all guides",
        context,
        &Character { groom: own, field: field.clone(), neck },
        &MOTIONS,
        0.0,
    );
    for (share, least) in [(16, 0.0), (64, 0.0005)] {
        let guides = GuideCount::OneIn(share);
        let mut groom = bind(strands, &BindOptions { guides, ..Default::default() }).unwrap();
        thin(&mut groom.strands, 4);
        lod::arrange(&mut groom.strands);
        let character = Character { groom, field: field.clone(), neck };
        check(&format!("Sintel, one guide in {share}"), context, &character, &MOTIONS, least);
    }
}

/// Keeps one strand in `n`.
fn thin(strands: &mut BoundStrands, n: usize) {
    let per_strand = strands.vertex_count as usize;
    strands.strands = strands.strands.iter().copied().step_by(n).collect();
    strands.bindings = strands.bindings.iter().copied().step_by(n).collect();
    strands.rest = strands.rest.chunks(per_strand).step_by(n).flatten().copied().collect();
}
