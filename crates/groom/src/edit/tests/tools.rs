//! What every tool promises, on every groom.

use super::*;

/// Checks lengths, depths and untouched guides of `after`, the result of a stroke on `before`.
fn check(what: &str, fixture: &Fixture, before: &GroomDocument, after: &GroomDocument) {
    let mut touched = 0;
    for i in 0..before.guides().len() {
        let (old, new) = (before.guide(i), after.guide(i));
        assert!(new.iter().all(|p| p.is_finite()), "{what}: guide {i} is not finite");
        assert_eq!(old[0], new[0], "{what}: the root of guide {i}");
        touched += usize::from(old != new);
        for (old, new) in old.windows(2).zip(new.windows(2)) {
            let (old, new) = (old[0].distance(old[1]), new[0].distance(new[1]));
            assert!((new - old).abs() <= 5e-3 * old + 1e-7, "{what}: an edge of guide {i}: {old} {new}");
        }
        for (old, new) in old.iter().zip(new) {
            let (old, new) = (fixture.field.sample(*old).min(1.5e-3), fixture.field.sample(*new));
            assert!(new >= old - 2e-4, "{what}: guide {i} is at {new}, was at {old}");
        }
    }
    assert!(touched > 0, "{what}: nothing has moved");
}

#[test]
fn every_tool_keeps_lengths_and_stays_outside() {
    for fixture in fixtures() {
        for (tool, name) in BrushTool::ALL {
            for reach in [Reach::Shell, Reach::Ball, Reach::Through] {
                let what = format!("{name} {reach:?} on {}", fixture.name);
                let mut editor = fixture.editor();
                let brush = Brush { strength: 1.0, reach, ..Brush::of(tool) };
                let after = stroke(&mut editor, &brush, &fixture.side_stroke()).expect(&what);
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
        for (tool, name) in BrushTool::ALL {
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
    for (tool, name) in BrushTool::ALL {
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
        assert!(worst < 1e-6, "{name}: {worst}");
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
                let brush = Brush { radius: 1e-3, reach: Reach::Ball, strength: 1.0, ..Brush::of(tool) };
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
    assert!(editor.take_moved() && editor.positions() != fixture.document.guides().positions());
    editor.cancel();
    assert!(editor.take_moved() && editor.positions() == fixture.document.guides().positions());
    assert_eq!(editor.document(), &fixture.document);
}
