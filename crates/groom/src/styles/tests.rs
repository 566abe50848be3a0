use super::*;
use crate::{mannequin, scalp::GridScalp};
use std::sync::OnceLock;

/// Returns the mannequin that the tests share.
pub(crate) fn head() -> &'static GridScalp {
    static HEAD: OnceLock<GridScalp> = OnceLock::new();
    HEAD.get_or_init(|| GridScalp::mannequin(112))
}

fn styles() -> [Style; 4] {
    Style::NAMES.map(|name| name.parse().unwrap())
}

/// Counts the points in the box in front of the face, from the chin to the brow.
pub(crate) fn in_face(points: &[Vec3]) -> usize {
    let marks = head().landmarks();
    let inside =
        |p: &&Vec3| p.x.abs() < 0.035 && p.z > marks.ear.z + 0.03 && p.y < marks.brow.y && p.y > marks.chin.y;
    points.iter().filter(inside).count()
}

/// Counts the points in the head, except the first of every `every` points.
pub(crate) fn in_head(points: &[Vec3], every: usize) -> usize {
    let inside = |(i, p): &(usize, &Vec3)| i % every != 0 && head().distance(**p) < 0.0;
    points.iter().enumerate().filter(inside).count()
}

#[test]
fn guide_counts_are_exact() {
    for (style, count) in styles().into_iter().zip([166, 200, 240, 400]) {
        let styled = guides(&style, head());
        assert_eq!(styled.guides.len(), count, "{}", style.name());
        assert_eq!((styled.stiffness.len(), styled.guides.root_uvs.len()), (count, count));
        assert!(styled.guides.iter().all(|guide| guide.len() == GUIDE_VERTICES));
    }
    let few = Style::Long(Long { guides: 37, ..Long::default() });
    assert_eq!(guides(&few, head()).guides.len(), 37);
}

#[test]
fn same_seed_gives_same_guides() {
    for style in styles() {
        let once = guides(&style, head()).guides;
        assert_eq!(once, guides(&style, head()).guides);
        assert_ne!(once, guides(&style.with_seed(2), head()).guides);
    }
}

#[test]
fn roots_are_on_the_scalp_and_spread_evenly() {
    for style in styles() {
        let styled = guides(&style, head());
        let roots: Vec<Vec3> = styled.guides.iter().map(|guide| guide[0]).collect();
        for root in &roots {
            assert!(mannequin::distance(*root).abs() < 1e-3, "{root}");
            assert!(styled.hairline.inside(*root) > 0.0, "{root}");
        }
        let nearest = |i: usize| {
            let others = roots.iter().enumerate().filter(|(k, _)| *k != i);
            others.map(|(_, root)| root.distance(roots[i])).fold(f32::INFINITY, f32::min)
        };
        let gaps: Vec<f32> = (0..roots.len()).map(nearest).collect();
        let mean = gaps.iter().sum::<f32>() / gaps.len() as f32;
        let smallest = gaps.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(smallest > 0.3 * mean, "{}: {smallest} against {mean}", style.name());
    }
}

#[test]
fn guides_keep_clear_of_head_and_face() {
    for style in styles() {
        let mut positions = guides(&style, head()).guides.positions;
        assert_eq!(in_head(&positions, GUIDE_VERTICES), 0, "{}", style.name());
        assert_eq!(in_face(&positions), 0, "{}", style.name());
        // The checks detect both.
        positions[5] = head().landmarks().skull;
        positions[6] = mannequin::NOSE_TIP + Vec3::Z * 0.01;
        assert_eq!((in_head(&positions, GUIDE_VERTICES), in_face(&positions)), (1, 1));
    }
}

#[test]
fn guide_lengths_match_the_style() {
    for (style, shortest, longest) in styles()
        .into_iter()
        .zip([(0.12, 0.37), (0.03, 0.32), (0.1, 0.24), (0.02, 0.07)])
        .map(|(s, (a, b))| (s, a, b))
    {
        let guides = guides(&style, head()).guides;
        for i in 0..guides.len() {
            let length = guides.length(i);
            assert!(length > shortest && length < longest, "{}: {length}", style.name());
            let edges: Vec<f32> = guides.strand(i).windows(2).map(|w| w[0].distance(w[1])).collect();
            let even = length / (GUIDE_VERTICES - 1) as f32;
            assert!(edges.iter().all(|e| (e / even - 1.0).abs() < 0.2), "{}: {edges:?}", style.name());
        }
    }
    let long = guides(&Style::default(), head()).guides;
    let mean = (0..long.len()).map(|i| long.length(i)).sum::<f32>() / long.len() as f32;
    assert!(mean > 0.24, "{mean}");
}

#[test]
fn hair_falls_to_its_side_of_the_parting() {
    let styled = guides(&Style::default(), head());
    let parting = styled.parting.as_ref().unwrap();
    for guide in styled.guides.iter() {
        let near = parting.nearest(guide[0]).distance(guide[0]) < 0.02;
        if near && guide[0].z > 0.0 {
            assert_eq!(parting.side(guide[0]), parting.side(guide[GUIDE_VERTICES / 2]), "{}", guide[0]);
        }
    }
}

#[test]
fn fringe_ends_above_the_eyes() {
    let bob = Style::Bob(Bob { fringe: true, ..Bob::default() });
    let styled = guides(&bob, head());
    let marks = head().landmarks();
    let low = |p: &&Vec3| p.x.abs() < 0.03 && p.z > marks.brow.z - 0.01 && p.y < mannequin::EYE.y;
    assert_eq!(styled.guides.positions.iter().filter(low).count(), 0);
    let over = |p: &&Vec3| p.x.abs() < 0.03 && p.z > marks.brow.z - 0.01 && p.y < marks.brow.y + 0.03;
    assert!(styled.guides.positions.iter().filter(over).count() > 5);
    assert!(styled.face.is_none());
}
