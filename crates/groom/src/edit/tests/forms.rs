//! Closed forms of the tools, and of carried strands.

use super::*;
use crate::Guides;
use glam::Quat;

/// Returns a document with these guides, each followed by one strand, without a head.
fn free(guides: &[Vec<Vec3>]) -> GroomDocument {
    let mut strands = Strands::default();
    guides.iter().for_each(|guide| strands.push(guide));
    let count = Some(guides[0].len() as u32);
    let options = BindOptions {
        guides: GuideCount::All,
        guide_vertex_count: count,
        strand_vertex_count: count,
        ..Default::default()
    };
    GroomDocument::new(bind(&strands, &options).unwrap(), HeadFiles::None, 0.0).unwrap()
}

fn straight(from: Vec3, way: Vec3, n: usize) -> Vec<Vec3> {
    (0..n).map(|i| from + way * (i as f32 / (n - 1) as f32)).collect()
}

#[test]
fn comb_moves_the_middle_by_its_weight() {
    // A hair that hangs; the brush passes across its lower half, perpendicular to it.
    let document = free(&[straight(Vec3::ZERO, Vec3::NEG_Y * 0.2, 21)]);
    let mut editor = GroomEditor::new(document.clone(), None);
    let brush = Brush { strength: 1.0, radius: 0.04, keep_shape: 0.0, mirror: false, ..Brush::default() };
    // One dab of a quarter of the radius, with its middle at the tip.
    let samples = [Vec3::new(-0.01, -0.2, 0.0), Vec3::new(0.0, -0.2, 0.0)].map(StrokeSample::point);
    let after = stroke(&mut editor, &brush, &samples).unwrap();
    // The way of the dab passes the tip itself, where the weight is 1: a triangle of height 1 cm over each edge.
    let (before, after) = (document.guide(0), after.guide(0));
    let weight = |i: usize| (1.0 - ((0.2 + before[i].y) / 0.04).powi(2)).max(0.0).powi(2);
    let mut p = before[0];
    for i in 1..21 {
        let target = before[i] + Vec3::X * 0.01 * weight(i);
        p = if weight(i) > 0.0 { p + (target - p).normalize() * 0.01 } else { before[i] };
        assert!(p.distance(after[i]) < 1e-5, "{i}: {p} {}", after[i]);
    }
    assert!(after[20].x > 0.003, "{}", after[20]);
}

#[test]
fn grabbed_tip_goes_where_the_hand_is() {
    let document = free(&[straight(Vec3::ZERO, Vec3::NEG_Y * 0.2, 21)]);
    let brush = Brush { radius: 0.01, mirror: false, keep_shape: 0.0, ..Brush::of(BrushTool::Grab) };
    let hand = Vec3::new(0.05, -0.17, 0.02);
    let samples = [Vec3::new(0.0, -0.2, 0.0), hand].map(StrokeSample::point);
    let after = stroke(&mut GroomEditor::new(document.clone(), None), &brush, &samples).unwrap();
    let off = after.guide(0)[20].distance(hand);
    assert!(off < 2e-3, "{off}");
    // Farther than the hair is long: it is taut.
    let samples = [samples[0], StrokeSample::point(Vec3::new(0.4, 0.0, 0.0))];
    let after = stroke(&mut GroomEditor::new(document, None), &brush, &samples).unwrap();
    let tip = after.guide(0)[20];
    assert!(tip.distance(Vec3::new(0.2, 0.0, 0.0)) < 0.01, "{tip}");
}

#[test]
fn puff_turns_the_root_to_the_normal_and_keeps_the_shape() {
    // On a wall, whose normal is X.
    let wall = SdfGrid::from_fn(Vec3::splat(-0.3), Vec3::splat(0.3), 33, |p| p.x);
    let wave = |i: usize| Vec3::new(2e-3 + 0.002 * (i as f32).sin().abs(), -0.01 * i as f32, 0.0);
    let document = free(&[(0..21).map(wave).collect()]);
    let brush = Brush { strength: 1.0, mirror: false, falloff: Falloff::Flat, ..Brush::of(BrushTool::Puff) };
    let mut editor = GroomEditor::new(document.clone(), Some(Arc::new(wall)));
    let at = document.guide(0)[0];
    editor.press(&brush, &StrokeSample::point(at)).unwrap();
    editor.drag(&StrokeSample { time: 4.0, ..StrokeSample::point(at) }).unwrap();
    let after = editor.release().unwrap();
    let angle = |guide: &[Vec3], i: usize| (guide[i + 1] - guide[i]).angle_between(Vec3::X).to_degrees();
    assert!(angle(after.guide(0), 0) < 5.0, "{}", angle(after.guide(0), 0));
    // The upper part keeps its directions.
    for i in 9..20 {
        let (old, new) = (angle(document.guide(0), i), angle(after.guide(0), i));
        assert!((old - new).abs() < 1.0, "{i}: {old} {new}");
    }
}

#[test]
fn smoothing_keeps_a_line_and_straightens_a_zigzag() {
    let zigzag = (0..21).map(|i| Vec3::new(0.004 * (i % 2) as f32, -0.01 * i as f32, 0.0)).collect();
    let line = straight(Vec3::new(0.01, 0.0, 0.0), Vec3::NEG_Y * 0.2, 21);
    let document = free(&[zigzag, line]);
    let brush = Brush {
        strength: 1.0,
        radius: 0.15,
        neighbors: 0.0,
        falloff: Falloff::Flat,
        mirror: false,
        ..Brush::of(BrushTool::Smooth)
    };
    let mut editor = GroomEditor::new(document.clone(), None);
    let at = Vec3::new(0.0, -0.1, 0.0);
    editor.press(&brush, &StrokeSample::point(at)).unwrap();
    editor.drag(&StrokeSample { time: 1.0, ..StrokeSample::point(at) }).unwrap();
    let after = editor.release().unwrap();
    let length = |guide: &[Vec3]| guide[0].distance(guide[20]) / crate::curve::length(guide);
    assert!(length(document.guide(0)) < 0.94 && length(after.guide(0)) > 0.99, "{}", length(after.guide(0)));
    let off = document.guide(1).iter().zip(after.guide(1)).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(off < 1e-5, "{off}");
}

#[test]
fn pinch_and_spread_move_hair_across_the_stroke() {
    let line = |x: f32| straight(Vec3::new(x, 0.0, 0.0), Vec3::NEG_Y * 0.2, 21);
    let document = free(&[line(-0.01), line(0.012)]);
    let width = |document: &GroomDocument| document.guide(1)[12].x - document.guide(0)[12].x;
    let path = [-0.05, -0.19].map(|y| StrokeSample::point(Vec3::new(0.0, y, 0.0)));
    let after = |tool| {
        let brush = Brush { strength: 1.0, mirror: false, ..Brush::of(tool) };
        stroke(&mut GroomEditor::new(document.clone(), None), &brush, &path).unwrap()
    };
    let (pinched, spread) = (after(BrushTool::Pinch), after(BrushTool::Spread));
    assert!(width(&pinched) < 0.6 * width(&document), "{}", width(&pinched));
    assert!(width(&spread) > 1.4 * width(&document), "{}", width(&spread));
    let inverted = Brush { strength: 1.0, mirror: false, inverted: true, ..Brush::of(BrushTool::Pinch) };
    let inverted = stroke(&mut GroomEditor::new(document.clone(), None), &inverted, &path).unwrap();
    assert_eq!(inverted.guides().positions(), spread.guides().positions());
}

#[test]
fn root_tip_and_share_limit_the_brush() {
    let fixture = &fixtures()[3];
    let samples = fixture.side_stroke();
    let moved = |brush: &Brush| {
        let after = stroke(&mut fixture.editor(), brush, &samples).unwrap();
        let guides = 0..after.guides().len();
        guides.filter(|i| after.guide(*i) != fixture.document.guide(*i)).count()
    };
    let all = moved(&Brush { strength: 1.0, ..Brush::default() });
    let half = moved(&Brush { strength: 1.0, guide_fraction: 0.5, ..Brush::default() });
    assert!((0.3..0.7).contains(&(half as f32 / all as f32)), "{half} of {all}");
    let tip = Brush { root_tip: 1.0, ..Brush::default() };
    assert_eq!([tip.along(0.0), tip.along(0.25), tip.along(0.75)], [0.0, 0.5, 1.0]);
    let root = Brush { root_tip: -0.5, ..Brush::default() };
    assert_eq!([root.along(0.0), root.along(0.5), root.along(1.0)], [1.0, 1.0, 0.5]);
}

#[test]
fn carried_strands_are_exact_at_rest_and_rigid_in_rotation() {
    for fixture in fixtures() {
        let document = &fixture.document;
        let back = document.with([(0, document.guide(0))]);
        assert_eq!(back.groom(), *document.base(), "{}", fixture.name);
        let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.4);
        let turned: Vec<Vec<Vec3>> = (0..document.guides().len())
            .map(|i| document.guide(i).iter().map(|p| turn * *p).collect())
            .collect();
        let after = document.with(turned.iter().map(|guide| &guide[..]).enumerate()).groom();
        // Every guide turns about its own root edge alike; the twist about it is free.
        let (n, strands) = (after.strands.len(), &after.strands);
        let edges = |strands: &crate::BoundStrands, i: usize| {
            let line: Vec<_> = strands.rest_positions(i).collect();
            line.windows(2).map(|edge| edge[0].distance(edge[1])).collect::<Vec<_>>()
        };
        for i in 0..n {
            for (old, new) in edges(&document.base().strands, i).into_iter().zip(edges(strands, i)) {
                assert!((old - new).abs() < 2e-5, "{}: {old} {new}", fixture.name);
            }
        }
        assert_eq!(after.guides, Guides { positions: turned.concat(), ..document.base().guides.clone() });
    }
}
