//! Versions, `.groom` files and scripts.

use super::*;
use crate::orient::{Axis, LengthUnit, OrientationOverride};
use proptest::prelude::*;
use std::path::Path;

/// Returns a script with every tool on `fixture`, from several sides.
fn every_tool(fixture: &Fixture) -> StrokeScript {
    let reaches = [BrushRegion::Shell, BrushRegion::Ball, BrushRegion::Through];
    let step = |(i, (tool, _)): (usize, (BrushTool, &str))| ScriptStep::Stroke {
        brush: Brush { region: reaches[i % 3], mirror: i % 2 == 0, guide_fraction: 0.9, ..Brush::of(tool) },
        samples: fixture.side_stroke(),
    };
    let mut steps: Vec<_> = BrushTool::ALL.into_iter().enumerate().map(step).collect();
    steps.insert(3, ScriptStep::Undo);
    StrokeScript { steps }
}

/// Returns the version after the script.
fn replayed(fixture: &Fixture, script: &StrokeScript) -> GroomDocument {
    script.apply(&mut fixture.editor()).unwrap().pop().unwrap()
}

#[test]
fn script_survives_its_file_to_the_bit() {
    for fixture in fixtures() {
        let script = every_tool(fixture);
        let text = script.write();
        let back = StrokeScript::read(&text, Path::new("strokes.jsonl")).unwrap();
        assert_eq!(back, script, "{text}");
        let (a, b) = (replayed(fixture, &script), replayed(fixture, &back));
        assert_eq!(a.hash(), b.hash(), "{}", fixture.name);
        assert_ne!(a.hash(), fixture.document.hash());
    }
}

#[test]
fn invalid_scripts_name_the_line() {
    for (text, said) in [
        ("{\"tool\":\"comb\",\"path\":[[0,0,0]]}", "s.jsonl at line 1: strokes begin with the line"),
        ("{\"version\":2}", "at line 1"),
        ("{\"version\":1}\n\n{\"tool\":\"rake\",\"path\":[[0,0,0]]}", "at line 3: unknown variant `rake`"),
        ("{\"version\":1}\n{\"tool\":\"comb\"}", "at line 2: a stroke has either samples or a path"),
        (
            "{\"version\":1}\n{\"tool\":\"comb\",\"set\":{\"radius\":2},\"path\":[[0,0,0]]}",
            "brush.radius is 2",
        ),
        (
            "{\"version\":1}\n{\"tool\":\"comb\",\"set\":{\"raduis\":1},\"path\":[[0,0,0]]}",
            "unknown field `raduis`",
        ),
        ("{\"version\":1}\n{\"do\":\"cut\"}", "nothing to do named cut"),
        ("{\"version\":1}\n{\"tool\":\"comb\",", "at line 2: EOF"),
    ] {
        let found = StrokeScript::read(text, Path::new("s.jsonl")).unwrap_err().to_string();
        assert!(found.contains(said), "{found}");
    }
    assert!(StrokeScript::read("", Path::new("s.jsonl")).unwrap().steps.is_empty());
    let undo = StrokeScript { steps: vec![ScriptStep::Undo] };
    assert!(undo.apply(&mut fixtures()[2].editor()).is_err());
}

#[test]
fn versions_share_what_a_stroke_does_not_touch() {
    let fixture = &fixtures()[3];
    let mut editor = fixture.editor();
    let brush = Brush { strength: 1.0, mirror: false, ..Brush::default() };
    let after = stroke(&mut editor, &brush, &fixture.side_stroke()).unwrap();
    let all = 400 * after.vertex_count() * size_of::<Vec3>();
    let own = after.unshared_bytes(&fixture.document);
    assert!(own > 0 && own < all / 2, "{own} of {all} bytes");
    assert_eq!(after.original(), fixture.document);
    editor.go_to(fixture.document.clone()).unwrap();
    assert_eq!(editor.positions(), fixture.document.guides().positions());
    editor.go_to(after.clone()).unwrap();
    assert_eq!(editor.positions(), after.guides().positions());
}

#[test]
fn file_keeps_everything() {
    for (fixture, head) in fixtures().iter().zip(0..) {
        let orientation = OrientationOverride {
            unit: Some(LengthUnit(0.01)),
            up: Some(Axis::Z),
            front: None,
            is_mirrored: Some(false),
        };
        let files =
            vec![("head.obj".into(), Arc::from(&b"v 0 0 0"[..])), ("a.mtl".into(), Arc::from(&b""[..]))];
        let head = match head {
            0 => HeadFiles::Files { files, orientation },
            1 => HeadFiles::BuiltIn,
            _ => HeadFiles::None,
        };
        let document = GroomDocument::new((*fixture.document.base()).clone(), head, 0.25).unwrap();
        let editor = &mut GroomEditor::new(document.clone(), Some(fixture.field.clone()));
        let after = stroke(editor, &Brush::default(), &fixture.side_stroke()).unwrap();
        let bytes = after.write();
        let back = GroomDocument::read(Path::new("a.groom"), &bytes).unwrap();
        assert_eq!((back.hash(), back.mirror_x(), back.head()), (after.hash(), 0.25, after.head()));
        assert_eq!(back.base(), after.base());
        assert_eq!(back.groom(), after.groom());
        assert_eq!(back.original().hash(), document.hash());
        assert_eq!(back.write(), bytes);
    }
}

#[test]
fn damaged_files_are_errors() {
    let path = Path::new("a.groom");
    let bytes = fixtures()[2].document.write();
    let read = |bytes: &[u8]| GroomDocument::read(path, bytes);
    assert!(read(&bytes).is_ok());
    for length in (0..bytes.len()).step_by(97).chain(bytes.len() - 3..bytes.len()) {
        assert!(read(&bytes[..length]).is_err(), "{length} bytes");
    }
    for at in (0..bytes.len()).step_by(211).chain(0..160) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        // The name of a chunk is not part of its checksum: an unknown one is skipped, and then it is missing.
        let said = read(&damaged).map(|_| ()).unwrap_err().to_string();
        assert!(said.starts_with("a.groom"), "byte {at}: {said}");
    }
    assert!(read(b"\x89GROOM\r\n\x07\0\0\0").unwrap_err().to_string().contains("version 7"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn undo_and_redo_return_the_same_versions(moves in prop::collection::vec((0usize..400, 0u8..4), 1..60)) {
        let first = fixtures()[3].document.clone();
        let (mut past, mut future, mut now) = (Vec::new(), Vec::new(), first);
        let mut known: Vec<(GroomDocument, u64)> = Vec::new();
        for (guide, act) in moves {
            match act {
                0 => if let Some(before) = past.pop() { future.push(std::mem::replace(&mut now, before)) },
                1 => if let Some(after) = future.pop() { past.push(std::mem::replace(&mut now, after)) },
                _ => {
                    let moved: Vec<_> = now.guide(guide).iter().map(|p| *p + Vec3::X * 1e-3).collect();
                    let after = now.with([(guide, &moved[..])]);
                    prop_assert!(after != now && after.guide(guide) == moved);
                    past.push(std::mem::replace(&mut now, after));
                    future.clear();
                    known.push((now.clone(), now.hash()));
                }
            }
            for (version, hash) in &known {
                prop_assert_eq!(version.hash(), *hash);
            }
        }
    }
}
