//! Tools that change roots.

use super::*;
use crate::curve;

/// Returns a ball's field under hair on its left side alone.
fn half() -> Fixture {
    let strands = falling(400);
    let mut left = Strands::default();
    strands.iter().step_by(2).for_each(|strand| left.push(strand));
    let groom = bind(&left, &BindOptions { guides: GuideCount::OneIn(4), ..Default::default() }).unwrap();
    let document = GroomDocument::new(groom, HeadFiles::None, 0.0).unwrap();
    Fixture { name: "half", document, field: ball_field(), center: Vec3::ZERO }
}

/// Returns the root and the tip of each strand.
fn ends(document: &GroomDocument) -> Vec<[Vec3; 2]> {
    let strands = document.groom().strands;
    let ends = |i: usize| {
        let line: Vec<Vec3> = strands.rest_positions(i).collect();
        [line[0], line[line.len() - 1]]
    };
    (0..strands.len()).map(ends).collect()
}

/// Returns points on the right of the ball, from above down.
fn right_side() -> Vec<StrokeSample> {
    let at = |k: usize| {
        let angle = 0.2 + 0.05 * k as f32;
        Vec3::new(-angle.sin(), angle.cos(), 0.1) * BALL
    };
    (0..20).map(|k| StrokeSample { time: 0.02 * k as f32, ..StrokeSample::point(at(k)) }).collect()
}

fn planting(mirror: bool) -> Brush {
    let base = Brush::of(BrushTool::Plant);
    Brush { spacing: 6e-3, length: 0.08, density: 60.0, radius: 0.02, mirror, ..base }
}

#[test]
fn planted_hair_keeps_its_distances_and_stays_outside() {
    let fixture = half();
    let mut editor = fixture.editor();
    let before = editor.document().clone();
    let after = stroke(&mut editor, &planting(false), &right_side()).unwrap();
    assert!(after.is_version_of(&before) && !after.is_pose_of(&before));
    let (old, all) = (before.guides().len(), after.guides().len());
    assert!(all > old + 50, "{old} {all}");
    let roots: Vec<Vec3> = (0..all).map(|i| after.guide(i)[0]).collect();
    for i in old..all {
        let nearest = roots.iter().enumerate().filter(|(j, _)| *j != i);
        let nearest = nearest.map(|(_, root)| root.distance(roots[i])).fold(f32::MAX, f32::min);
        assert!(nearest >= 6e-3 - 1e-6, "guide {i}: {nearest}");
        assert!(fixture.field.sample(roots[i]).abs() < 2e-4);
        assert!((curve::length(after.guide(i)) - 0.08).abs() < 1e-4);
        let deepest = after.guide(i)[1..].iter().map(|p| fixture.field.sample(*p)).fold(f32::MAX, f32::min);
        assert!(deepest > -2e-4, "guide {i}: {deepest}");
    }
    // The hair that was there stays; new hair is as dense as the brush says.
    let (was, now) = (ends(&before), ends(&after));
    for (i, (was, now)) in was.iter().zip(&now).enumerate() {
        assert!(was[0].distance(now[0]) < 1e-5 && was[1].distance(now[1]) < 1e-5, "strand {i}");
    }
    assert!(after.origins().into_iter().eq(0..now.len() as u32));
    let new = &now[was.len()..];
    let middle = Vec3::new(-0.5f32.sin(), 0.5f32.cos(), 0.1).normalize() * BALL;
    let count = new.iter().filter(|ends| ends[0].distance(middle) < 0.01).count() as f32;
    let density = count / (std::f32::consts::PI * 0.01 * 0.01) / 1e4;
    assert!((40.0..80.0).contains(&density), "{density} strands per cm²");
    assert!(new.iter().all(|ends| fixture.field.sample(ends[0]).abs() < 1.5e-3));
    assert!(new.iter().all(|ends| ends[0].x < 0.02), "hair beside the stroke");
    // Undo is the same version.
    editor.go_to(before.clone()).unwrap();
    assert_eq!(editor.document(), &before);
    assert!(after.unshared_bytes(&before) > 100_000);
    // The same stroke plants nothing where hair is.
    editor.go_to(after.clone()).unwrap();
    let again = stroke(&mut editor, &Brush { spacing: 0.012, ..planting(false) }, &right_side());
    assert!(again.is_none_or(|again| again.guides().len() < all + 8));
}

#[test]
fn planted_hair_is_symmetric() {
    let fixture = half();
    let bare =
        stroke(&mut fixture.editor(), &Brush { radius: 0.02, ..Brush::of(BrushTool::Remove) }, &right_side());
    let mut editor = fixture.editor();
    editor.go_to(bare.unwrap()).unwrap();
    let old = editor.document().guides().len();
    let after = stroke(&mut editor, &planting(true), &right_side()).unwrap();
    let roots: Vec<Vec3> = (old..after.guides().len()).map(|i| after.guide(i)[0]).collect();
    // Hair that was left beside the stroke is on one side alone.
    let is_mirrored =
        |root: &&Vec3| roots.iter().any(|other| other.distance(Vec3::new(-root.x, root.y, root.z)) < 1e-5);
    let mirrored = roots.iter().filter(is_mirrored).count();
    assert!(mirrored as f32 > 0.7 * roots.len() as f32, "{mirrored} of {}", roots.len());
}

#[test]
fn removed_hair_is_gone_and_the_rest_stays() {
    for fixture in fixtures() {
        let samples = fixture.side_stroke();
        let brush = Brush { mirror: false, ..Brush::of(BrushTool::Remove) };
        let after = stroke(&mut fixture.editor(), &brush, &samples).expect(fixture.name);
        let (was, now) = (ends(&fixture.document), ends(&after));
        assert!(now.len() < was.len() && now.len() > was.len() / 4, "{}", fixture.name);
        let mut left = now.iter().peekable();
        for ends in &was {
            if left.peek().is_some_and(|next| next[0] == ends[0] && next[1] == ends[1]) {
                left.next();
            } else {
                assert!(ends[0].x > fixture.center.x, "{}: a strand at {}", fixture.name, ends[0]);
            }
        }
        assert!(left.next().is_none(), "{}: the rest is in the same order", fixture.name);
        let origins = after.origins();
        assert!(origins.len() == now.len() && origins.is_sorted());
        assert!(origins.iter().zip(&now).all(|(origin, ends)| was[*origin as usize] == *ends));
        // All strands follow a guide that is there; no guide is without a strand that had one.
        let groom = after.groom();
        let guides = groom.guides.len() as u32;
        assert!(groom.strands.bindings.iter().all(|it| it.guides.iter().all(|guide| *guide < guides)));
        // A stroke that would remove all hair does nothing.
        let all = Brush { radius: 0.15, region: BrushRegion::Through, ..brush };
        let everywhere: Vec<_> = [-0.1, 0.0, 0.1]
            .map(|y| StrokeSample::point(fixture.center + Vec3::new(0.0, y, 0.0)))
            .into_iter()
            .collect();
        let mut editor = fixture.editor();
        assert!(stroke(&mut editor, &all, &everywhere).is_none(), "{}", fixture.name);
        assert_eq!(editor.document(), &fixture.document);
    }
}

#[test]
fn refined_hair_has_more_guides_and_does_not_move() {
    for fixture in &fixtures()[..3] {
        let brush = Brush { spacing: 4e-3, mirror: false, ..Brush::of(BrushTool::Refine) };
        let after = stroke(&mut fixture.editor(), &brush, &fixture.side_stroke()).expect(fixture.name);
        let (was, now) = (ends(&fixture.document), ends(&after));
        assert!(after.guides().len() > fixture.document.guides().len() + 5, "{}", fixture.name);
        assert_eq!(was.len(), now.len());
        assert!(was.iter().zip(&now).all(|(was, now)| was == now), "{}: no hair moves", fixture.name);
        // Strands at the new guides follow them.
        let groom = after.groom();
        for guide in fixture.document.guides().len()..after.guides().len() {
            let root = after.guide(guide)[0];
            let at = (0..groom.strands.len()).find(|i| now[*i][0].distance(root) < 1e-5).unwrap();
            assert_eq!(groom.strands.bindings[at].guides[0] as usize, guide, "{}", fixture.name);
        }
    }
}

#[test]
fn parted_hair_goes_to_both_sides_and_follows_its_own() {
    for guides in [GuideCount::All, GuideCount::OneIn(2)] {
        let fixture = on_ball("parted", guides);
        // From the front over the top to the back, beside the middle.
        let at = |k: usize| {
            let angle = 0.8 - 0.08 * k as f32;
            let side = Vec3::new(0.3, angle.cos(), angle.sin()).normalize() * BALL;
            StrokeSample { time: 0.02 * k as f32, ..StrokeSample::point(side) }
        };
        let samples: Vec<_> = (0..20).map(at).collect();
        let brush = Brush { strength: 1.0, mirror: false, ..Brush::of(BrushTool::Part) };
        let after = stroke(&mut fixture.editor(), &brush, &samples).unwrap();
        let way = |document: &GroomDocument, i: usize| document.guide(i)[3] - document.guide(i)[0];
        let near = |root: Vec3| (root.normalize().x - 0.3).abs() < 0.2 && root.y > 0.06;
        let (mut turned, mut count) = (0, 0);
        for i in 0..after.guides().len() {
            let root = after.guide(i)[0];
            if near(root) {
                let side = (root.normalize().x - 0.3).signum();
                count += 1;
                let [was, now] =
                    [&fixture.document, &after].map(|document| side * way(document, i).normalize().x);
                turned += usize::from(now > was + 0.02 || now > 0.5);
            }
            let (old, new) = (fixture.document.guide(i), after.guide(i));
            assert!((curve::length(old) - curve::length(new)).abs() < 1e-4);
            assert!(new.iter().all(|p| fixture.field.sample(*p) > -3e-4));
        }
        assert!(count > 5 && turned * 10 >= count * 8, "{turned} of {count}");
        let groom = after.groom();
        let strands = ends(&after);
        for (binding, [root, _]) in
            groom.strands.bindings.iter().zip(&strands).filter(|(_, ends)| near(ends[0]))
        {
            let side = |p: Vec3| p.normalize().x > 0.3;
            let own = side(*root);
            // A few roots lie on the line itself.
            let off = (root.normalize().x - 0.3).abs() > 0.03;
            let crosses = |(guide, _): (usize, f32)| {
                let p = after.guide(guide)[0];
                side(p) != own && (p.normalize().x - 0.3).abs() > 0.03
            };
            assert!(!off || !binding.weighted().any(crosses), "a strand follows hair across the parting");
        }
    }
}
