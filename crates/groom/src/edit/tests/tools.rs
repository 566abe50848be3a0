//! Promises of every tool, on every groom.

use super::*;

/// Returns the tools that keep roots.
fn shaping() -> impl Iterator<Item = (BrushTool, &'static str)> {
    BrushTool::ALL.into_iter().filter(|(tool, _)| !tool.acts_on_roots() && !tool.paints())
}

/// Checks lengths (of tools that keep them), depths and untouched guides of `after`, the result of a stroke on
/// `before`.
fn check(what: &str, fixture: &Fixture, before: &GroomDocument, after: &GroomDocument) {
    let keeps_lengths = after.is_pose_of(before);
    let mut touched = 0;
    for i in 0..before.guides().len() {
        let (old, new) = (before.guide(i), after.guide(i));
        assert!(new.iter().all(|p| p.is_finite()), "{what}: guide {i} is not finite");
        assert_eq!(old[0], new[0], "{what}: the root of guide {i}");
        touched += usize::from(old != new);
        let edges = old.windows(2).zip(new.windows(2)).filter(|_| keeps_lengths);
        for (old, new) in edges {
            let (old, new) = (old[0].distance(old[1]), new[0].distance(new[1]));
            assert!((new - old).abs() <= 5e-3 * old + 1e-7, "{what}: an edge of guide {i}: {old} {new}");
        }
        for (old, new) in old.iter().zip(new).filter(|_| keeps_lengths) {
            let (old, new) = (fixture.field.sample(*old).min(1.5e-3), fixture.field.sample(*new));
            assert!(new >= old - 2e-4, "{what}: guide {i} is at {new}, was at {old}");
        }
    }
    assert!(touched > 0 || !keeps_lengths, "{what}: nothing has moved");
}

#[test]
fn every_tool_keeps_lengths_and_stays_outside() {
    for fixture in fixtures() {
        for (tool, name) in shaping() {
            for reach in [BrushRegion::Shell, BrushRegion::Ball, BrushRegion::Through] {
                let what = format!("{name} {reach:?} on {}", fixture.name);
                let mut editor = fixture.editor();
                let brush = Brush { strength: 1.0, region: reach, ..Brush::of(tool) };
                let after = stroke(&mut editor, &brush, &fixture.side_stroke()).expect(&what);
                assert_eq!(after.is_pose_of(&fixture.document), tool.keeps_lengths(), "{what}");
                check(&what, fixture, &fixture.document, &after);
                // A second stroke begins where the first has ended.
                let again = stroke(&mut editor, &brush, &fixture.side_stroke());
                again.iter().for_each(|again| check(&what, fixture, &after, again));
            }
        }
    }
}

#[test]
fn shell_never_reaches_the_far_side() {
    for fixture in fixtures() {
        let far = |document: &GroomDocument, i: usize| {
            document.guide(i).iter().all(|p| p.x < fixture.center.x - 0.04)
        };
        for (tool, name) in shaping() {
            let brush = Brush { strength: 1.0, mirror: false, ..Brush::of(tool) };
            let after = stroke(&mut fixture.editor(), &brush, &fixture.side_stroke()).unwrap();
            let guides = (0..after.guides().len()).filter(|i| far(&fixture.document, *i));
            let mut count = 0;
            for i in guides {
                count += 1;
                assert_eq!(after.guide(i), fixture.document.guide(i), "{name} on {}", fixture.name);
            }
            assert!(count > 5, "{name} on {}: {count} guides are on the far side", fixture.name);
        }
    }
}

#[test]
fn mirrored_brush_acts_alike_on_both_sides() {
    let fixture = on_ball("mirrored", GuideCount::All);
    for (tool, name) in shaping() {
        let brush = Brush { neighbors: 0.0, ..Brush::of(tool) };
        let after = stroke(&mut fixture.editor(), &brush, &fixture.side_stroke()).unwrap();
        let mirrored = |guide: &[Vec3]| guide.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect::<Vec<_>>();
        let mut worst = 0.0f32;
        for i in 0..after.guides().len() {
            let twin = mirrored(fixture.document.guide(i));
            let j = (0..after.guides().len()).find(|j| fixture.document.guide(*j) == twin).unwrap();
            let pairs = mirrored(after.guide(i)).into_iter().zip(after.guide(j));
            worst = pairs.map(|(a, b)| a.distance(*b)).fold(worst, f32::max);
        }
        // A cut is found by bisection of an edge of 9 mm.
        assert!(worst < if tool.keeps_lengths() { 1e-6 } else { 1e-4 }, "{name}: {worst}");
    }
}

#[test]
fn degenerate_strokes_change_nothing_or_stay_finite() {
    for fixture in fixtures() {
        for (tool, name) in BrushTool::ALL {
            let what = format!("{name} on {}", fixture.name);
            let samples = fixture.side_stroke();
            // No strength, no motion.
            let weak = Brush { strength: 0.0, ..Brush::of(tool) };
            let still = vec![samples[0]; 5];
            for (brush, samples) in [(weak, &samples), (Brush { strength: 0.0, ..weak }, &still)] {
                let after = stroke(&mut fixture.editor(), &brush, samples);
                assert!(after.is_none_or(|after| apart(&after, &fixture.document) < 1e-6), "{what}");
            }
            // Along a guide, within a guide's vertex, through the head.
            let guide = fixture.document.guide(3);
            let along = StrokeSample::ray(guide[0] + (guide[0] - guide[1]) * 20.0, guide[1] - guide[0]);
            let through = StrokeSample::point(fixture.center);
            for first in [along, StrokeSample::point(guide[2]), through] {
                let brush =
                    Brush { radius: 1e-3, region: BrushRegion::Ball, strength: 1.0, ..Brush::of(tool) };
                let samples = [first, first, StrokeSample { time: 1.0, ..first }];
                if let Some(after) = stroke(&mut fixture.editor(), &brush, &samples) {
                    check(&what, fixture, &fixture.document, &after);
                }
            }
        }
    }
}

#[test]
fn invalid_strokes_are_errors() {
    let mut editor = fixtures()[2].editor();
    let sample = StrokeSample::point(Vec3::NAN);
    assert!(editor.press(&Brush::default(), &sample).is_err());
    let brush = Brush { radius: 0.0, ..Brush::default() };
    let said = editor.press(&brush, &StrokeSample::point(Vec3::ZERO)).unwrap_err().to_string();
    assert!(said.contains("brush.radius is 0"), "{said}");
    // Beside hair and head there is nothing to comb.
    let beside = StrokeSample::ray(Vec3::new(3.0, 0.0, 1.0), Vec3::NEG_Z);
    assert!(!editor.press(&Brush::default(), &beside).unwrap() && editor.release().is_none());
    let other = on_ball("other", GuideCount::All).document;
    assert!(editor.go_to(other).is_err());
}

#[test]
fn speed_of_the_pointer_does_not_matter() {
    for fixture in fixtures() {
        let fine = fixture.side_stroke();
        let coarse: Vec<_> = fine.iter().copied().step_by(5).collect();
        for tool in [BrushTool::Comb, BrushTool::Grab, BrushTool::Lay] {
            let brush = Brush { strength: 1.0, ..Brush::of(tool) };
            let [fine, coarse] =
                [&fine, &coarse].map(|samples| stroke(&mut fixture.editor(), &brush, samples).unwrap());
            let moved = apart(&fine, &fixture.document);
            let off = apart(&fine, &coarse);
            assert!(moved > 5e-3 && off < 5e-4, "{tool:?} on {}: {off} of {moved}", fixture.name);
        }
    }
}

#[test]
fn canceled_stroke_leaves_no_trace() {
    let fixture = &fixtures()[1];
    let mut editor = fixture.editor();
    let samples = fixture.side_stroke();
    editor.press(&Brush::default(), &samples[0]).unwrap();
    samples.iter().for_each(|sample| editor.drag(sample).unwrap());
    assert!(editor.take_changed() && editor.positions() != fixture.document.guides().positions());
    editor.cancel();
    assert!(editor.take_changed() && editor.positions() == fixture.document.guides().positions());
    assert_eq!(editor.document(), &fixture.document);
}

#[test]
fn cut_hair_lies_where_it_was_and_ends_at_the_cut() {
    for fixture in fixtures() {
        // A horizontal line below the middle of the head, seen from the front.
        let eye = fixture.center + Vec3::new(0.0, 0.0, 1.0);
        let level = fixture.center.y - 0.03;
        let to = |x: f32| Vec3::new(x, level, fixture.center.z) - eye;
        let samples = [-0.3, 0.3].map(|x| StrokeSample::ray(eye, to(x)));
        let brush = Brush { region: BrushRegion::Through, mirror: false, ..Brush::of(BrushTool::Line) };
        let after = stroke(&mut fixture.editor(), &brush, &samples).expect(fixture.name);
        let (old, new) = (fixture.document.groom().strands, after.groom().strands);
        // The eye is at another height than the cut: further back, the plane is lower.
        let height = |p: Vec3| p.y - (eye.y + (level - eye.y) * (eye.z - p.z) / (eye.z - fixture.center.z));
        let (mut cut, mut whole) = (0, 0);
        for i in 0..old.len() {
            let [before, after]: [Vec<Vec3>; 2] =
                [&old, &new].map(|strands| strands.rest_positions(i).collect());
            let crosses = before.windows(2).any(|edge| height(edge[0]) > 0.0 && height(edge[1]) < 0.0);
            let begins_below = height(before[0]) < 2e-3;
            if crosses && !begins_below {
                cut += 1;
                let tip = after[after.len() - 1];
                assert!(
                    height(tip).abs() < 1e-3,
                    "{}: strand {i} ends {} from the cut",
                    fixture.name,
                    height(tip)
                );
                // Every point is on the strand before the cut.
                let near = |p: &Vec3| {
                    let edges = before.windows(2).map(|edge| {
                        let t = ((*p - edge[0]).dot(edge[1] - edge[0])
                            / (edge[1] - edge[0]).length_squared().max(1e-12))
                        .clamp(0.0, 1.0);
                        p.distance(edge[0].lerp(edge[1], t))
                    });
                    edges.fold(f32::MAX, f32::min)
                };
                assert!(after.iter().all(|p| near(p) < 2e-4), "{}: strand {i}", fixture.name);
            } else if !begins_below {
                whole += 1;
                assert!(
                    before.iter().zip(&after).all(|(a, b)| a.distance(*b) < 2e-5),
                    "{}: {i}",
                    fixture.name
                );
            }
        }
        println!("{}: {cut} cut, {whole} whole", fixture.name);
        assert!(cut > 50, "{}: {cut}", fixture.name);
        // Guides are not much longer than their hair.
        let longest = |document: &GroomDocument| {
            let guides = 0..document.guides().len();
            guides.map(|i| crate::curve::length(document.guide(i))).fold(0.0, f32::max)
        };
        assert!(longest(&after) < longest(&fixture.document), "{}", fixture.name);
    }
}

#[test]
fn hair_grows_and_shrinks_by_the_same_factor() {
    for fixture in fixtures() {
        let brush = Brush { strength: 1.0, radius: 0.06, mirror: false, ..Brush::of(BrushTool::Length) };
        let at = fixture.side_stroke()[8];
        let held = [at, StrokeSample { time: 0.5, ..at }];
        let mut editor = fixture.editor();
        let longer = stroke(&mut editor, &brush, &held).unwrap();
        let ratio = |document: &GroomDocument, strands: bool| {
            let length = |document: &GroomDocument, i: usize| match strands {
                true => crate::curve::length(&document.groom().strands.rest_positions(i).collect::<Vec<_>>()),
                false => crate::curve::length(document.guide(i)),
            };
            let count = if strands { 40 } else { document.guides().len() };
            let ratios = (0..count).map(|i| length(document, i) / length(&fixture.document, i));
            ratios.fold(0.0, f32::max)
        };
        // Eleven dabs of 3 % where the weight is 1.
        let grown = ratio(&longer, false);
        assert!((1.15..1.39).contains(&grown), "{}: {grown}", fixture.name);
        assert!(ratio(&longer, true) < 1.39, "{}", fixture.name);
        let shorter = stroke(&mut editor, &Brush { inverted: true, ..brush }, &held).unwrap();
        assert!(ratio(&shorter, false) < grown, "{}", fixture.name);
    }
}

#[test]
fn lasso_cuts_hair_that_enters_the_outline() {
    for fixture in fixtures() {
        let eye = fixture.center + Vec3::new(0.0, 0.0, 1.0);
        let to = |[x, y]: [f32; 2]| StrokeSample::ray(eye, fixture.center + Vec3::new(x, y, 0.0) - eye);
        let cut = |tool, corners: &[[f32; 2]]| {
            let samples: Vec<StrokeSample> = corners.iter().copied().map(to).collect();
            let brush = Brush { region: BrushRegion::Through, mirror: false, ..Brush::of(tool) };
            stroke(&mut fixture.editor(), &brush, &samples)
        };
        let level = -0.03;
        let line = cut(BrushTool::Line, &[[-0.3, level], [0.3, level]]).expect(fixture.name);
        let all = cut(BrushTool::Lasso, &[[-0.3, level], [0.3, level], [0.3, -0.6], [-0.3, -0.6]]).unwrap();
        let (line, all) = (line.groom(), all.groom());
        let old = fixture.document.groom();
        let lengths = |groom: &Groom, i: usize| {
            crate::curve::length(&groom.strands.rest_positions(i).collect::<Vec<_>>())
        };
        let (mut same, mut within) = (0, 0);
        for i in 0..old.strands.len() {
            let root = old.strands.rest_positions(i).next().unwrap();
            // As seen from the eye.
            let y = eye.y + (root.y - eye.y) / (eye.z - root.z) - fixture.center.y;
            if y < level {
                within += 1;
                assert!((lengths(&all, i) - lengths(&old, i)).abs() < 2e-4, "roots within: {i}");
            } else {
                same += usize::from((lengths(&all, i) - lengths(&line, i)).abs() < 1e-3);
            }
        }
        let outside = old.strands.len() - within;
        assert!(same > outside * 97 / 100, "{}: {same} of {outside}", fixture.name);
        // A part of the hem.
        let left = cut(BrushTool::Lasso, &[[0.02, level], [0.3, level], [0.3, -0.6], [0.02, -0.6]]).unwrap();
        let left = left.groom();
        let shorter: Vec<usize> =
            (0..old.strands.len()).filter(|i| lengths(&left, *i) < lengths(&old, *i) - 2e-3).collect();
        assert!(shorter.len() > 20, "{}: {}", fixture.name, shorter.len());
        let right = |i: &&usize| old.strands.rest_positions(**i).all(|p| p.x < fixture.center.x);
        assert_eq!(shorter.iter().filter(right).count(), 0, "{}", fixture.name);
        // Two points are no outline.
        assert!(cut(BrushTool::Lasso, &[[-0.3, level], [0.3, level]]).is_none());
    }
}

#[test]
fn slid_roots_stay_on_the_skin_and_take_their_hair_along() {
    for fixture in fixtures() {
        let brush = Brush { mirror: false, ..Brush::of(BrushTool::Slide) };
        let before = &fixture.document;
        let after = stroke(&mut fixture.editor(), &brush, &fixture.side_stroke()).expect(fixture.name);
        let mut moved = 0;
        for i in 0..before.guides().len() {
            let (old, new) = (before.guide(i), after.guide(i));
            let off = (fixture.field.sample(new[0]) - fixture.field.sample(old[0])).abs();
            assert!(off < 1e-3, "{}: root {i} is off the skin by {off}", fixture.name);
            moved += usize::from(old[0].distance(new[0]) > 2e-3);
            let lengths = [old, new].map(crate::curve::length);
            assert!((lengths[1] / lengths[0] - 1.0).abs() < 5e-3, "{}: {lengths:?}", fixture.name);
        }
        assert!(moved > 1 && moved < before.guides().len(), "{}: {moved}", fixture.name);
        // Strands come along.
        let [old, new] = [before, &after].map(|document| document.groom().strands);
        let mut worst = 0.0f32;
        for i in 0..old.len() {
            let [a, b] = [&old, &new].map(|strands| strands.rest_positions(i).next().unwrap());
            worst = worst.max((fixture.field.sample(b) - fixture.field.sample(a)).abs());
        }
        println!("{}: {moved} roots moved, strands are off by {:.2} mm", fixture.name, 1e3 * worst);
        assert!(worst < 1e-3, "{}: {worst}", fixture.name);
    }
}
