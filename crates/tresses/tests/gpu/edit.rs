//! Edited grooms: a stroke shows what its document holds, and the hair keeps it.

use crate::common;
use std::{borrow::Cow, fmt::Write, path::PathBuf};
use tresses::{
    AvoidMode, AvoidOptions, CharacterFiles, Context, HairOptions, Pose, RestOptions, Result,
    SimulationParams, Styling, Wind, drape,
    glam::{Quat, Vec3},
    groom::{
        Groom, GuideCount, bind,
        edit::{Brush, BrushTool, GroomDocument, GroomEditor, HeadFiles, StrokeSample},
        grow::Growth,
        import::ImportOptions,
        mannequin::{self, SKULL_CENTER},
        orient::{LengthUnit, OrientationOverride},
        styles::Style,
    },
    low_level::{Hair, HairFrame, lod},
};

/// Returns an editor of a built-in style with `strands` strands.
fn editor(context: &Context, style: &str, strands: u32) -> Result<GroomEditor> {
    let style: Style = style.parse()?;
    pollster::block_on(async {
        let source = drape::style(context, &style, &()).await?;
        let growth = Some(Growth::for_style(&style).with_strands(strands));
        let groom = source.parts(&Styling { growth, ..Styling::default() }, &()).await?.groom;
        let document = source.edit(groom, &CharacterFiles::Given(&[]))?;
        assert!(document.guides().len() >= 94 && *document.head() == HeadFiles::BuiltIn);
        Ok(source.editor(document, &()).await?)
    })
}

/// Combs the left side back, and its mirror image.
fn combed(editor: &mut GroomEditor, tool: BrushTool) -> GroomDocument {
    let eye = SKULL_CENTER + Vec3::new(0.7, 0.0, 0.1);
    let brush = Brush { strength: 1.0, radius: 0.04, ..Brush::of(tool) };
    let sample = |k: i32| {
        let to = SKULL_CENTER + Vec3::new(0.1, 0.03 - 0.002 * k as f32, 0.06 - 0.006 * k as f32);
        StrokeSample { time: k as f32 / 60.0, ..StrokeSample::ray(eye, to - eye) }
    };
    assert!(editor.press(&brush, &sample(0)).unwrap());
    (1..20).for_each(|k| editor.drag(&sample(k)).unwrap());
    editor.release().expect("hair moves")
}

fn hair(context: &Context, groom: &Groom, mode: AvoidMode, editor: Option<&GroomEditor>) -> Hair {
    supported(context, groom, (mode, RestOptions::default()), editor)
}

fn supported(
    context: &Context,
    groom: &Groom,
    (mode, rest): (AvoidMode, RestOptions),
    editor: Option<&GroomEditor>,
) -> Hair {
    let avoid = AvoidOptions { mode, ..AvoidOptions::default() };
    let options = HairOptions { avoid, rest, ..HairOptions::default() };
    common::hair(context, groom, &options, editor.and_then(GroomEditor::field)).unwrap()
}

/// Draws a frame of `dt` seconds. Returns the strands in the order of their groom.
fn drawn(hair: &mut Hair, groom: &Groom, head: Pose, dt: f32) -> Vec<Vec<Vec3>> {
    common::advance(hair, &common::frame(head, dt));
    let n = groom.strands.vertex_count as usize;
    let positions = common::positions(hair);
    let mut strands = vec![Vec::new(); groom.strands.len()];
    for (strand, i) in positions.chunks(n).zip(lod::order(&groom.strands)) {
        strands[i as usize] = strand.to_vec();
    }
    strands
}

/// Returns the distances between the vertices of `drawn` and of `groom` at `pose`, ascending, meters.
fn off(drawn: &[Vec<Vec3>], groom: &Groom, pose: Pose) -> Vec<f32> {
    let rest = |i: usize| groom.strands.rest_positions(i);
    let pairs = (0..drawn.len()).flat_map(|i| drawn[i].iter().zip(rest(i)));
    let mut all: Vec<f32> = pairs.map(|(p, rest)| p.distance(pose.point(rest))).collect();
    all.sort_by(f32::total_cmp);
    all
}

#[test]
fn drawn_strands_are_those_of_the_document() {
    let Some(context) = common::context() else { return };
    let turn = Quat::from_rotation_y(0.5) * Quat::from_rotation_z(0.2);
    let head = Pose { translation: Vec3::new(0.3, 1.0, -0.2), rotation: turn };
    for style in ["bob", "curly"] {
        let mut editor = editor(context, style, 3600).unwrap();
        let base = editor.document().base();
        let mut hair = hair(context, &base, AvoidMode::Off, None);
        let before = drawn(&mut hair, &base, head, 1.0 / 60.0);
        for tool in [BrushTool::Comb, BrushTool::Puff] {
            let document = combed(&mut editor, tool);
            hair.pose_guides(editor.positions()).unwrap();
            let after = drawn(&mut hair, &base, head, 0.0);
            let moved = common::apart(&after.concat(), &before.concat());
            let off = off(&after, &document.groom(), head);
            let worst = off[off.len() - 1];
            println!(
                "{style}, {tool:?}: moved by {:.0} mm at most, off by {:.1} µm",
                1e3 * moved,
                1e6 * worst
            );
            assert!(moved > 0.02 && worst < 1e-4, "{moved} {worst}");
        }
        // Undo is a pose as well.
        editor.go_to(editor.document().original()).unwrap();
        hair.pose_guides(editor.positions()).unwrap();
        let off = off(&drawn(&mut hair, &base, head, 0.0), &base, head);
        assert!(off[off.len() - 1] < 1e-4, "{}", off[off.len() - 1]);
        assert!(hair.pose_guides(&[Vec3::ZERO]).is_err());
    }
}

/// When a stroke ends, hair is made anew from the document. Nothing jumps, and it does not sag.
#[test]
fn combed_hair_keeps_its_shape() {
    let Some(context) = common::context() else { return };
    for style in ["bob", "long"] {
        let mut editor = editor(context, style, 3600).unwrap();
        let base = editor.document().base();
        let mut posed = hair(context, &base, AvoidMode::ChangeOver, Some(&editor));
        drawn(&mut posed, &base, Pose::IDENTITY, 0.0);
        let groom = combed(&mut editor, BrushTool::Comb).groom();
        posed.pose_guides(editor.positions()).unwrap();
        let shown = drawn(&mut posed, &base, Pose::IDENTITY, 0.0);
        let mut anew = hair(context, &groom, AvoidMode::ChangeOver, Some(&editor));
        let settled = drawn(&mut anew, &groom, Pose::IDENTITY, 0.0);
        let pairs = shown.concat().into_iter().zip(settled.concat());
        let mut jump: Vec<f32> = pairs.map(|(a, b)| a.distance(b)).collect();
        jump.sort_by(f32::total_cmp);
        let mean = jump.iter().sum::<f32>() / jump.len() as f32;
        let most = jump[jump.len() * 95 / 100];
        let mut last = settled;
        for _ in 0..120 {
            last = drawn(&mut anew, &groom, Pose::IDENTITY, 1.0 / 60.0);
        }
        let sag = off(&last, &groom, Pose::IDENTITY);
        let sags = sag[sag.len() * 95 / 100];
        println!(
            "{style}: jump {:.3} mm in the mean, {:.3} mm for 95 %; sag {:.2} mm for 95 %",
            1e3 * mean,
            1e3 * most,
            1e3 * sags
        );
        assert!(mean < 3e-4 && most < 1e-3 && sags < 2e-3, "{style}: {mean} {most} {sags}");
    }
}

/// Hair that the wind has blown keeps that shape.
#[test]
fn blown_hair_keeps_its_shape() {
    let Some(context) = common::context() else { return };
    // Hair in the middle of a swing has sharp bends, which stiffer hair bears.
    for (support, most) in [(2.0, 1e-2), (6.0, 2e-3)] {
        let mut editor = editor(context, "bob", 3600).unwrap();
        let base = editor.document().base();
        let mut blown = hair(context, &base, AvoidMode::ChangeOver, Some(&editor));
        let wind = Wind::new(Vec3::new(2.5, 0.5, -1.0));
        let physics = SimulationParams { wind, ..SimulationParams::default() };
        let frame = HairFrame { dt: 1.0 / 60.0, simulation: &physics, ..Default::default() };
        for _ in 0..90 {
            common::advance(&mut blown, &frame);
        }
        let now: Vec<Vec3> = common::guide_lines(&blown)
            .concat()
            .iter()
            .map(|p| blown.simulation_transform().point(*p))
            .collect();
        let kept = editor.keep(&now).unwrap().expect("the hair has moved");
        let moved = common::apart(&kept.guides().positions(), &base.guides.positions);
        let off = common::apart(&kept.guides().positions(), &now);
        assert!(moved > 0.02 && off < 4e-3, "moved {moved}, kept within {off}");
        assert!(editor.keep(kept.guides().positions().as_slice()).unwrap().is_none(), "nothing new to keep");
        let groom = kept.groom();
        let rest = RestOptions { support, ..RestOptions::default() };
        let mut anew = supported(context, &groom, (AvoidMode::ChangeOver, rest), Some(&editor));
        let mut last = Vec::new();
        for _ in 0..120 {
            last = drawn(&mut anew, &groom, Pose::IDENTITY, 1.0 / 60.0);
        }
        let sag = self::off(&last, &groom, Pose::IDENTITY);
        let sags = sag[sag.len() * 95 / 100];
        let half = sag[sag.len() / 2];
        println!("support {support}: sag {:.2} mm for half, {:.2} mm for 95 %", 1e3 * half, 1e3 * sags);
        assert!(half < 5e-4 && sags < most, "{half} {sags}");
    }
}

#[test]
fn every_strand_may_be_a_guide() {
    let Some(context) = common::context() else { return };
    let options = tresses::groom::BindOptions { guides: GuideCount::All, ..Default::default() };
    let groom = bind(&common::hanging(300, 16, 0.2), &options).unwrap();
    let document = GroomDocument::new(groom.clone(), HeadFiles::None, 0.0).unwrap();
    let bent = |i: usize| -> Vec<Vec3> {
        let way = Vec3::new(0.3, 0.5, 0.1 * (i % 7) as f32);
        document.guide(i).iter().enumerate().map(|(k, p)| *p + way * (k * k) as f32 * 2e-4).collect()
    };
    let guides: Vec<Vec<Vec3>> = (0..300).map(bent).collect();
    let after = document.with(guides.iter().map(|guide| &guide[..]).enumerate());
    let mut hair = hair(context, &groom, AvoidMode::Off, None);
    drawn(&mut hair, &groom, Pose::IDENTITY, 0.0);
    hair.pose_guides(&guides.concat()).unwrap();
    let off = off(&drawn(&mut hair, &groom, Pose::IDENTITY, 0.0), &after.groom(), Pose::IDENTITY);
    assert!(off[off.len() - 1] < 2e-5, "{}", off[off.len() - 1]);
}

#[test]
fn built_in_style_grows_on_the_head_of_a_file() {
    let Some(context) = common::context() else { return };
    // The built-in head elsewhere, larger and without its name.
    let (scale, offset) = (1.2, Vec3::new(0.05, 1.5, 0.1));
    let mut text = String::new();
    let mesh = mannequin::mesh(64);
    for p in &mesh.positions {
        let p = *p * scale + offset;
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    let files = [(PathBuf::from("head.obj"), Cow::Owned(text.into_bytes()))];
    let files = CharacterFiles::Given(&files);
    let orient_head = OrientationOverride { unit: Some(LengthUnit(1.0)), ..OrientationOverride::default() };
    let options = ImportOptions { orient_head, ..ImportOptions::default() };
    let style: Style = "bob".parse().unwrap();
    let run = async {
        let source = drape::style_on(context, &style, &files, &options, &()).await?;
        assert!(source.style() == Some(&style) && !source.is_mannequin());
        let growth = Some(Growth::for_style(&style).with_strands(400));
        let styling = Styling { growth, ..Styling::default() };
        let groom = source.parts(&styling, &()).await?.groom;
        let document = source.edit(groom.clone(), &files)?;
        assert!(matches!(document.head(), HeadFiles::Files { files, .. } if files.len() == 1));
        let built_in = drape::style(context, &style, &()).await?.parts(&styling, &()).await?;
        Ok::<_, tresses::Error>((groom, source.editor(document, &()).await?, built_in.groom))
    };
    let (groom, editor, built_in) = pollster::block_on(run).unwrap();
    let field = editor.field().unwrap();
    assert_eq!(groom.strands.len(), 400);
    for i in 0..groom.strands.len() {
        let line: Vec<Vec3> = groom.strands.rest_positions(i).collect();
        let root = field.sample(line[0]);
        let deepest = line.iter().map(|p| field.sample(*p)).fold(0.0, f32::min);
        assert!(root.abs() < 3e-3 && deepest > -3e-3, "strand {i}: root {root}, deepest {deepest}");
    }
    // As on the built-in head, in proportion: hem, sides and top.
    let (is, should) = (groom.bounds().unwrap(), built_in.bounds().unwrap());
    for (is, should) in [(is.0, should.0), (is.1, should.1)] {
        let is = (is - offset) / scale;
        assert!(is.distance(should) < 0.025, "{is} {should}");
    }
}
