//! Tools that paint values, and groups.

use super::*;
use crate::bound::strand::unpack_color;

/// Returns what a stroke over the left side paints, with the x of each root relative to the middle.
fn painted(fixture: &Fixture, brush: &Brush) -> (GroomDocument, Vec<f32>) {
    let after = stroke(&mut fixture.editor(), brush, &fixture.side_stroke()).expect(fixture.name);
    let strands = &fixture.document.base().strands;
    let root = |i: usize| strands.rest_positions(i).next().map_or(0.0, |root| root.x - fixture.center.x);
    (after, (0..strands.len()).map(root).collect())
}

#[test]
fn painted_hair_keeps_its_shape() {
    for fixture in fixtures() {
        for tool in [BrushTool::Width, BrushTool::Stiffness, BrushTool::Color] {
            let brush = Brush { strength: 1.0, ..Brush::of(tool) };
            let (after, _) = painted(fixture, &brush);
            let (old, new) = (fixture.document.groom(), after.groom());
            assert!(after.is_version_of(&fixture.document) && !after.is_pose_of(&fixture.document));
            assert_eq!(old.guides.positions, new.guides.positions);
            assert_eq!(old.strands.rest, new.strands.rest);
            assert_ne!(after.hash(), fixture.document.hash());
            assert!(old != new, "{tool:?} on {}", fixture.name);
            // A version costs its values, not its strands.
            let bytes = after.unshared_bytes(&fixture.document);
            assert!(bytes < 20 * old.strands.len() + 8 * old.guides.len(), "{bytes} bytes");
            // Combing keeps painted values.
            let mut editor = fixture.editor();
            editor.go_to(after.clone()).unwrap();
            let combed = stroke(&mut editor, &Brush::default(), &fixture.side_stroke()).unwrap().groom();
            assert_eq!(
                (combed.strands.strands, combed.guides.stiffness),
                (new.strands.strands, new.guides.stiffness)
            );
            // As a file.
            let file = GroomDocument::read(std::path::Path::new("a.groom"), &after.write()).unwrap();
            assert_eq!(file.groom().strands.strands, after.groom().strands.strands);
            assert_eq!(file.groom().guides.stiffness, after.groom().guides.stiffness);
        }
    }
}

#[test]
fn width_and_stiffness_change_both_ways_within_limits() {
    let fixture = &fixtures()[1];
    for tool in [BrushTool::Width, BrushTool::Stiffness] {
        let values = |document: &GroomDocument| -> Vec<f32> {
            let groom = document.groom();
            match tool {
                BrushTool::Width => groom.strands.strands.iter().map(|strand| strand.radius).collect(),
                _ => groom.guides.stiffness,
            }
        };
        let mut editor = fixture.editor();
        let more = Brush { strength: 1.0, mirror: false, ..Brush::of(tool) };
        for (brush, wanted) in [(more, 5.0f32), (Brush { inverted: true, ..more }, 0.2)] {
            for _ in 0..40 {
                stroke(&mut editor, &brush, &fixture.side_stroke());
            }
            let pairs = values(editor.document()).into_iter().zip(values(&fixture.document));
            let ratios: Vec<f32> = pairs.map(|(now, first)| now / first).collect();
            let end = ratios.iter().copied().fold(1.0, if wanted > 1.0 { f32::max } else { f32::min });
            assert!((end / wanted - 1.0).abs() < 1e-3, "{tool:?}: {end}");
            assert!(ratios.contains(&1.0), "the other side stays");
        }
    }
}

#[test]
fn color_reaches_strands_under_the_brush_and_goes_again() {
    let fixture = &fixtures()[0];
    let brush = Brush { strength: 1.0, mirror: false, color: [1.0, 0.0, 0.0], ..Brush::of(BrushTool::Color) };
    let (after, roots) = painted(fixture, &brush);
    let strands = after.groom().strands.strands;
    let colored = |i: usize| unpack_color(strands[i].root_color).is_some();
    let count = (0..strands.len()).filter(|i| colored(*i)).count();
    assert!(count > 20 && count < strands.len() / 2, "{count} of {}", strands.len());
    assert!((0..strands.len()).all(|i| !colored(i) || roots[i] > -0.01), "the far side stays");
    let red = |packed: u32| unpack_color(packed).is_none_or(|color| color.x > 0.9 && color.y < 0.1);
    assert!(strands.iter().all(|strand| red(strand.root_color) && red(strand.tip_color)));
    // Only tips.
    let (tips, _) = painted(fixture, &Brush { root_tip: 1.0, ..brush });
    let strands = tips.groom().strands.strands;
    assert!(
        strands.iter().any(|strand| strand.tip_color != 0)
            && strands.iter().all(|strand| strand.root_color == 0)
    );
    let mut editor = fixture.editor();
    editor.go_to(after).unwrap();
    let wide = Brush { radius: 0.15, region: BrushRegion::Through, inverted: true, ..brush };
    let gone = stroke(&mut editor, &wide, &fixture.side_stroke()).unwrap();
    assert_eq!(gone.groom(), fixture.document.groom());
}

#[test]
fn brush_of_a_layer_leaves_others_alone() {
    let fixture = &fixtures()[1];
    let mut editor = fixture.editor();
    let samples = fixture.side_stroke();
    let brush = Brush { layer: Some(1), length: 0.03, ..Brush::of(BrushTool::Plant) };
    let planted = stroke(&mut editor, &Brush { spacing: 3e-3, density: 200.0, ..brush }, &samples).unwrap();
    let groom = planted.groom();
    let old = fixture.document.guides().len();
    assert_eq!(groom.guides.groups.len(), groom.guides.len());
    assert!(groom.guides.groups[..old].iter().all(|group| *group == 0));
    assert!(groom.guides.groups[old..].iter().all(|group| *group == 1));
    let combed =
        stroke(&mut editor, &Brush { tool: BrushTool::Comb, strength: 1.0, ..brush }, &samples).unwrap();
    let moved = |i: &usize| combed.guide(*i) != planted.guide(*i);
    assert!((0..old).filter(moved).count() == 0 && (old..groom.guides.len()).filter(moved).count() > 3);
    let removed =
        stroke(&mut editor, &Brush { tool: BrushTool::Remove, strength: 1.0, ..brush }, &samples).unwrap();
    assert!(removed.groom().strands.len() >= fixture.document.groom().strands.len());
    // Groups are kept in files and for exports.
    let file = GroomDocument::read(std::path::Path::new("a.groom"), &combed.write()).unwrap();
    assert_eq!(file.base().guides.groups, groom.guides.groups);
    let (strands, _, report) =
        crate::import::edited_complete(std::path::Path::new("a.groom"), &file).unwrap();
    assert_eq!(strands.marks.len(), strands.len());
    assert_eq!(report.groups.iter().map(|group| group.id).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn held_hair_stays_whatever_the_tool() {
    for fixture in fixtures() {
        let samples = fixture.side_stroke();
        let hold = Brush { radius: 0.04, mirror: false, ..Brush::of(BrushTool::Hold) };
        let mut editor = fixture.editor();
        let held = stroke(&mut editor, &hold, &samples).expect(fixture.name);
        let is_held: Vec<bool> = editor.held().map(|(.., held)| held).collect();
        let count = is_held.iter().filter(|held| **held).count();
        assert!(count > 2 && count < is_held.len(), "{}: {count} of {}", fixture.name, is_held.len());
        assert!(stroke(&mut editor, &hold, &samples).is_none(), "it is held already");
        let was = held.groom();
        for (tool, name) in BrushTool::ALL {
            if tool == BrushTool::Hold || tool == BrushTool::Plant {
                continue;
            }
            editor.go_to(held.clone()).unwrap();
            let brush = Brush { strength: 1.0, radius: 0.05, mirror: false, ..Brush::of(tool) };
            let Some(after) = stroke(&mut editor, &brush, &samples) else { continue };
            let now = after.groom();
            // A guide ends where the longest strand does that follows it, which may follow others more.
            let cuts = matches!(tool, BrushTool::Cut | BrushTool::Line | BrushTool::Lasso);
            if now.guides.len() == was.guides.len() && !cuts {
                for i in (0..is_held.len()).filter(|i| is_held[*i]) {
                    assert_eq!(after.guide(i), held.guide(i), "{name} on {}", fixture.name);
                    assert_eq!(
                        now.guides.stiffness[i], was.guides.stiffness[i],
                        "{name} on {}",
                        fixture.name
                    );
                }
            }
            let strands = |groom: &Groom, held: &dyn Fn(usize) -> bool| {
                let leads = groom.strands.bindings.iter().map(|binding| binding.guides[0] as usize);
                leads.filter(|guide| held(*guide)).count()
            };
            let now_held: Vec<bool> = editor.held().map(|(.., held)| held).collect();
            assert_eq!(now_held.iter().filter(|held| **held).count(), count, "{name} on {}", fixture.name);
            if tool == BrushTool::Remove {
                assert_eq!(
                    strands(&was, &|i| is_held[i]),
                    strands(&now, &|i| now_held[i]),
                    "{}",
                    fixture.name
                );
            }
        }
        // Planting keeps it, and files do.
        editor.go_to(held.clone()).unwrap();
        let plant = Brush { spacing: 2e-3, length: 0.02, ..Brush::of(BrushTool::Plant) };
        if stroke(&mut editor, &plant, &samples).is_some() {
            assert_eq!(editor.held().filter(|(.., held)| *held).count(), count);
        }
        let file = GroomDocument::read(std::path::Path::new("a.groom"), &held.write()).unwrap();
        let read = GroomEditor::new(file, Some(fixture.field.clone()));
        assert!(read.held().map(|(.., held)| held).eq(is_held.iter().copied()));
        editor.go_to(held).unwrap();
        let free = stroke(&mut editor, &Brush { inverted: true, radius: 0.06, ..hold }, &samples).unwrap();
        assert!(editor.held().all(|(.., held)| !held) && free.groom() == fixture.document.groom());
    }
}

#[test]
fn clumps_curls_and_frizz_are_painted_and_taken_back() {
    for fixture in fixtures() {
        for tool in [BrushTool::Clump, BrushTool::Curl, BrushTool::Frizz] {
            let brush = Brush { strength: 1.0, mirror: false, radius: 0.06, ..Brush::of(tool) };
            let (after, roots) = painted(fixture, &brush);
            let (old, new) = (fixture.document.groom(), after.groom());
            assert_eq!(old.guides, new.guides);
            let mut moved = 0;
            for (i, x) in roots.iter().enumerate() {
                let [from, to]: [Vec<Vec3>; 2] =
                    [&old, &new].map(|groom| groom.strands.rest_positions(i).collect());
                // Curled strands have more vertices.
                let step = (to.len() - 1) as f32 / (from.len() - 1) as f32;
                let same = |k: usize| {
                    let (x, last) = (k as f32 * step, to.len() - 1);
                    let at = (x as usize).min(last - 1);
                    to[at].lerp(to[at + 1], x - at as f32)
                };
                let most = (0..from.len()).map(|k| from[k].distance(same(k))).fold(0.0, f32::max);
                assert!(most < 0.04 && to.iter().all(|p| p.is_finite()), "{tool:?} moves by {most}");
                assert!(from[0].distance(to[0]) < 1e-3, "roots stay");
                assert!(*x > -0.01 || most < 5e-4, "{tool:?} moves the other side by {most}");
                moved += usize::from(most > 5e-4);
            }
            assert!(moved > 20, "{tool:?} moves {moved} strands of {}", fixture.name);
            // As a file, and combed after that.
            let file = GroomDocument::read(std::path::Path::new("a.groom"), &after.write()).unwrap();
            assert_eq!(file.groom(), new, "{tool:?}");
            assert_eq!(file.hash(), after.hash());
            let mut editor = fixture.editor();
            editor.go_to(after.clone()).unwrap();
            let comb = Brush { mirror: false, ..Brush::default() };
            let combed = stroke(&mut editor, &comb, &fixture.side_stroke()).unwrap();
            assert_eq!(combed.shapes(), after.shapes());
            // Removing hair elsewhere changes no other strand.
            editor.go_to(after.clone()).unwrap();
            let flip = |v: Vec3, middle: f32| Vec3::new(2.0 * middle - v.x, v.y, v.z);
            let other = |it: &StrokeSample| StrokeSample {
                origin: flip(it.origin, fixture.center.x),
                direction: flip(it.direction, 0.0),
                ..*it
            };
            let other: Vec<StrokeSample> = fixture.side_stroke().iter().map(other).collect();
            let remove = Brush { mirror: false, radius: 0.01, ..Brush::of(BrushTool::Remove) };
            if let Some(thinner) = stroke(&mut editor, &remove, &other) {
                let (kept, origins) = (thinner.groom(), thinner.origins());
                assert!(kept.strands.len() < new.strands.len());
                let same = |(k, was): (usize, &u32)| {
                    let [a, b] = [(&kept, k), (&new, *was as usize)]
                        .map(|(groom, i)| groom.strands.rest_positions(i).collect::<Vec<_>>());
                    a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-4)
                };
                let count = origins.iter().enumerate().filter(|it| same(*it)).count();
                assert!(count > origins.len() * 95 / 100, "{tool:?}: {count} of {}", origins.len());
            }
            // Inverted strokes make the hair bit-identical again.
            editor.go_to(after).unwrap();
            let back = Brush { inverted: true, ..brush };
            for _ in 0..60 {
                stroke(&mut editor, &back, &fixture.side_stroke());
            }
            assert_eq!(editor.document().groom(), old, "{tool:?} on {}", fixture.name);
        }
    }
}
