use super::super::styles().into_iter().filter(|style| !Growth::for_style(style).curls.any())s::tests::{head, in_face, in_head};
use super::super::styles::{GUIDE_VERTICES, Style, guides};
use super::*;
use crate::groom::mannequin;

fn styles() -> [Style; 4] {
    Style::NAMES.map(|name| name.parse().unwrap())
}

/// Growth of few strands.
fn some(style: &Style, count: u32) -> Growth {
    Growth::for_style(style).with_strands(count)
}

#[test]
fn totals_are_exact() {
    let styled = guides(&Style::default(), head());
    for kind in [Kind::Clump, Kind::Multi, Kind::Both] {
        for count in [0, 1, 7, 1234] {
            let growth = Growth { kind, ..some(&Style::default(), count) };
            let grown = grow(&styled, &growth, head()).unwrap();
            assert_eq!(grown.strands.len(), count as usize);
            assert_eq!(grown.positions.len(), count as usize * 32);
            assert_eq!(grown.radii.len(), grown.positions.len());
        }
    }
}

#[test]
fn counts_follow_the_maps() {
    let styled = guides(&Style::default(), head());
    let full = ScalpMap::from_fn(4, |_| 1.0);
    let growth = Growth {
        strand_count: None,
        kind: Kind::Clump,
        clump_count: 3,
        clump_map: Some(full.clone()),
        ..Growth::default()
    };
    assert_eq!(grow(&styled, &growth, head()).unwrap().strands.len(), 166 * 3);
    let multi = Growth { kind: Kind::Multi, multi_count: 2, density_map: Some(full), ..growth };
    let triangles = grow(&styled, &multi, head()).unwrap().strands.len() / 2;
    assert!((200..330).contains(&triangles), "{triangles}");
    // Nothing grows where the map is black, and a map that is black everywhere is an error.
    let left = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.0 });
    let half =
        Growth { density_map: Some(left), strand_count: Some(300), kind: Kind::Multi, ..Growth::default() };
    let grown = grow(&styled, &half, head()).unwrap();
    assert!(grown.strands.iter().all(|strand| strand.root_uv.x > 0.49));
    let none = Growth { density_map: Some(ScalpMap::from_fn(4, |_| 0.0)), strand_count: Some(9), ..half };
    assert!(grow(&styled, &none, head()).is_err());
}

#[test]
fn thickness_follows_the_map() {
    let styled = guides(&Style::default(), head());
    let grown = |value: f32| {
        let map = ScalpMap::from_fn(4, |_| value);
        let growth = Growth { thickness_map: Some(map), ..some(&Style::default(), 400) };
        let strands = grow(&styled, &growth, head()).unwrap().strands;
        strands.iter().map(|strand| strand.radius).sum::<f32>() / 400.0
    };
    assert!((grown(0.6) / grown(1.2) - 0.5).abs() < 1e-3);
}

#[test]
fn bindings_are_sound() {
    for style in styles() {
        let styled = guides(&style, head());
        let grown = grow(&styled, &some(&style, 1500), head()).unwrap();
        let sound = |strand: &GrownStrand| {
            (strand.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5
                && strand.weights.windows(2).all(|w| w[0] >= w[1] && w[1] >= 0.0)
                && strand.guides.iter().all(|&g| (g as usize) < styled.guides.len())
                && strand.scale.iter().all(|s| *s > 0.0 && *s <= 1.0)
                && strand.radius > 0.0
        };
        assert!(grown.strands.iter().all(sound), "{}", style.name());
        assert!(grown.radii.iter().all(|r| *r > 0.0 && *r <= 1.0));
        let wrong = GrownStrand { weights: [0.5, 0.4, 0.2], ..grown.strands[0] };
        assert!(!sound(&wrong));
        assert!(!sound(&GrownStrand { weights: [0.3, 0.4, 0.3], ..wrong }));
    }
}

#[test]
fn a_seed_makes_growth_reproducible() {
    let style = Style::default();
    let styled = guides(&style, head());
    let growth = some(&style, 500);
    let once = grow(&styled, &growth, head()).unwrap();
    assert_eq!(once, grow(&styled, &growth, head()).unwrap());
    assert_ne!(once, grow(&styled, &Growth { seed: 77, ..growth }, head()).unwrap());
}

#[test]
fn strands_start_on_the_scalp_and_keep_clear() {
    for style in styles() {
        let styled = guides(&style, head());
        let mut grown = grow(&styled, &some(&style, 1500), head()).unwrap();
        for i in 0..grown.strands.len() {
            let root = grown.strand(i)[0];
            assert!(mannequin::distance(root).abs() < 1e-3, "{root}");
            assert!(styled.hairline.inside(root) >= 0.0, "{root}");
        }
        assert_eq!(in_head(&grown.positions, grown.vertex_count), 0, "{}", style.name());
        assert_eq!(in_face(&grown.positions), 0, "{}", style.name());
        grown.positions[5] = mannequin::SKULL_CENTRE;
        assert_eq!(in_head(&grown.positions, grown.vertex_count), 1);
    }
}

#[test]
fn strands_are_as_long_as_their_guides_say() {
    for style in styles().into_iter().filter(|style| style.recipe().curl.radius == 0.0) {
        let styled = guides(&style, head());
        let grown = grow(&styled, &some(&style, 1500), head()).unwrap();
        let ratio = |i: usize, stretch: f32| {
            let strand = grown.strands[i];
            let blend: f32 =
                (0..3).map(|k| strand.weights[k] * styled.guides.length(strand.guides[k] as usize)).sum();
            let length: f32 = grown.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum();
            stretch * length / (blend * strand.scale[0])
        };
        let mut ratios: Vec<f32> = (0..1500).map(|i| ratio(i, 1.0)).collect();
        ratios.sort_by(f32::total_cmp);
        let good = |low: f32, high: f32| low > 0.7 && high < 1.35;
        assert!(good(ratios[15], ratios[1484]), "{}: {} {}", style.name(), ratios[15], ratios[1484]);
        assert!(!good(1.6 * ratios[15], 1.6 * ratios[1484]));
    }
}

#[test]
fn without_structure_a_strand_is_the_blend_of_its_guides() {
    let style = Style::default();
    let styled = guides(&style, head());
    let mut growth = Growth { kind: Kind::Multi, clearance: 0.0, ..some(&style, 400) };
    growth.clumps = Clumps { strength: 0.0, lock: 0.0, ..growth.clumps };
    growth.unrest = Unrest { frizz: 0.0, strays: 0.0, flyaways: 0.0, ..growth.unrest };
    let grown = grow(&styled, &growth, head()).unwrap();
    let mut off: Vec<f32> = (0..400)
        .map(|i| {
            let strand = &grown.strands[i];
            let x = strand.scale[0] * (GUIDE_VERTICES - 1) as f32;
            let at = (x as usize).min(GUIDE_VERTICES - 2);
            let tip: Vec3 = (0..3)
                .map(|k| {
                    let guide = styled.guides.strand(strand.guides[k] as usize);
                    guide[at].lerp(guide[at + 1], x - at as f32) * strand.weights[k]
                })
                .sum();
            tip.distance(grown.strand(i)[31])
        })
        .collect();
    off.sort_by(f32::total_cmp);
    // What is left is the offset of roots outside of all triangles, and what the head pushes away.
    assert!(off[200] < 0.003, "{}", off[200]);
}

#[test]
fn clumps_meet_towards_the_tips() {
    let style = Style::default();
    let styled = guides(&style, head());
    let spread = |strength: f32| {
        let mut growth = Growth { kind: Kind::Multi, ..some(&style, 3000) };
        growth.clumps.strength = strength;
        growth.unrest = Unrest { frizz: 0.0, strays: 0.0, flyaways: 0.0, shorter: 0.0, ..growth.unrest };
        let grown = grow(&styled, &growth, head()).unwrap();
        let tips: Vec<Vec3> = (0..3000).map(|i| grown.strand(i)[30]).collect();
        let nearest = |i: usize| {
            (0..3000).filter(|k| *k != i).map(|k| tips[k].distance(tips[i])).fold(f32::INFINITY, f32::min)
        };
        (0..3000).step_by(10).map(nearest).sum::<f32>() / 300.0
    };
    let (loose, tight) = (spread(0.0), spread(0.9));
    assert!(tight < 0.75 * loose, "{tight} {loose}");
}

#[test]
fn the_scenes_of_the_seed_can_be_asked_for() {
    let styled = guides(&Style::default(), head());
    for (triangles, count) in [(0.99e6, 15_968), (2.1e6, 33_871)] {
        let grown = grow(&styled, &some(&Style::default(), count), head()).unwrap();
        let drawn = (grown.strands.len() * (grown.vertex_count - 1) * 2) as f64;
        assert!((drawn / triangles - 1.0).abs() < 1e-4, "{drawn}");
    }
}

#[test]
fn parameters_are_checked() {
    let styled = guides(&Style::default(), head());
    let bad = [
        Growth { vertices: 1, ..Growth::default() },
        Growth { strand_count: Some(u32::MAX), ..Growth::default() },
        Growth { vertices: 65, ..Growth::default() },
        Growth { clump_share: 1.5, ..Growth::default() },
        Growth { clearance: f32::NAN, ..Growth::default() },
    ];
    for growth in bad {
        assert!(grow(&styled, &growth, head()).is_err());
    }
}
