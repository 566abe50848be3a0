use super::*;
use crate::mannequin;
use crate::scalp::ScalpMap;
use crate::styles::tests::{head, in_face, in_head};
use crate::styles::{GUIDE_VERTICES, Style, guides};

fn styles() -> [Style; 4] {
    Style::NAMES.map(|name| name.parse().unwrap())
}

/// Growth of `style` with `count` strands.
fn some(style: &Style, count: u32) -> Growth {
    Growth::for_style(style).with_strands(count)
}

#[test]
fn totals_are_exact() {
    let styled = guides(&Style::default(), head());
    for kind in [StrandKind::Clump, StrandKind::Multi, StrandKind::Both] {
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
        kind: StrandKind::Clump,
        clump_count: 3,
        clump_map: Some(full.clone()),
        ..Growth::default()
    };
    assert_eq!(grow(&styled, &growth, head()).unwrap().strands.len(), 166 * 3);
    let multi = Growth { kind: StrandKind::Multi, multi_count: 2, density_map: Some(full), ..growth };
    let triangles = grow(&styled, &multi, head()).unwrap().strands.len() / 2;
    assert!((200..330).contains(&triangles), "{triangles}");
    // Nothing grows where the map is black, and a map that is black everywhere is an error.
    let left = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.0 });
    let half = Growth {
        density_map: Some(left),
        strand_count: Some(300),
        kind: StrandKind::Multi,
        ..Growth::default()
    };
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
fn bindings_are_valid() {
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
fn same_seed_grows_same_strands() {
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
        grown.positions[5] = mannequin::SKULL_CENTER;
        assert_eq!(in_head(&grown.positions, grown.vertex_count), 1);
    }
}

#[test]
fn strand_lengths_match_their_guides() {
    for style in styles().into_iter().filter(|style| !Growth::for_style(style).curls.any()) {
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
fn unstructured_strands_blend_their_guides() {
    let style = Style::default();
    let styled = guides(&style, head());
    let mut growth = Growth { kind: StrandKind::Multi, clearance: 0.0, ..some(&style, 400) };
    growth.clumps = Clumps { strength: 0.0, lock: 0.0, ..growth.clumps };
    growth.variation = StrandVariation { frizz: 0.0, strays: 0.0, flyaways: 0.0, ..growth.variation };
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
    // The remaining error comes from roots outside of all triangles and from strands that the head pushes away.
    assert!(off[200] < 0.003, "{}", off[200]);
}

#[test]
fn clumps_converge_toward_tips() {
    let style = Style::default();
    let styled = guides(&style, head());
    let spread = |strength: f32| {
        let mut growth = Growth { kind: StrandKind::Multi, ..some(&style, 3000) };
        growth.clumps.strength = strength;
        growth.variation =
            StrandVariation { frizz: 0.0, strays: 0.0, flyaways: 0.0, shorter: 0.0, ..growth.variation };
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
fn strand_count_sets_exact_triangle_count() {
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
        Growth { vertex_count: 1, ..Growth::default() },
        Growth { strand_count: Some(u32::MAX), ..Growth::default() },
        Growth { vertex_count: 65, ..Growth::default() },
        Growth { clump_fraction: 1.5, ..Growth::default() },
        Growth { clearance: f32::NAN, ..Growth::default() },
    ];
    for growth in bad {
        assert!(grow(&styled, &growth, head()).is_err());
    }
}

/// Multi-strands that differ from the blend of their guides only by curls.
fn smooth_growth(style: &Style, count: u32, curls: Curls) -> Growth {
    let mut growth =
        Growth { kind: StrandKind::Multi, clearance: 0.0, ..some(style, count) }.with_curls(curls);
    growth.vertex_count = 64;
    growth.clumps = Clumps { strength: 0.0, lock: 0.0, spacing: 0.03, ..growth.clumps };
    growth.variation = StrandVariation {
        frizz: 0.0,
        strays: 0.0,
        stray: 0.0,
        flyaways: 0.0,
        shorter: 0.0,
        ..growth.variation
    };
    growth
}

fn regular() -> Curls {
    Curls { irregularity: 0.0, coherence: 1.0, neighbors: 0.0, ..Curls::ringlets() }
}

/// Returns the length of each strand without curls, and the offset of each of its vertices when it is curled.
fn offsets(style: &Style, count: u32, curls: &Curls) -> (Vec<f32>, Vec<Vec<Vec3>>) {
    let styled = guides(style, head());
    let straight = grow(&styled, &smooth_growth(style, count, Curls::default()), head()).unwrap();
    let curled = grow(&styled, &smooth_growth(style, count, curls.clone()), head()).unwrap();
    let length = |i: usize| straight.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum();
    let off = |i: usize| curled.strand(i).iter().zip(straight.strand(i)).map(|(a, b)| *a - *b).collect();
    ((0..count as usize).map(length).collect(), (0..count as usize).map(off).collect())
}

#[test]
fn grown_curls_have_requested_radius_and_wavelength() {
    let (lengths, off) = offsets(&Style::default(), 400, &regular());
    let mut radii: Vec<f32> = off.iter().flat_map(|o| o[24..].iter().map(|o| o.length())).collect();
    radii.sort_by(f32::total_cmp);
    // Median and 90th percentile, where the head does not push the strands.
    let (middle, high) = (radii[radii.len() / 2], radii[radii.len() * 9 / 10]);
    assert!((middle / 0.009 - 1.0).abs() < 0.02 && (high / 0.009 - 1.0).abs() < 0.05, "{middle} {high}");
    // Length per turn of the offsets over the lower half, which is the wavelength.
    let mut waves: Vec<f32> = off
        .iter()
        .zip(&lengths)
        .map(|(o, length)| {
            let turned: f32 = o[32..].windows(2).map(|w| w[0].angle_between(w[1])).sum();
            length * 31.0 / 63.0 / (turned / std::f32::consts::TAU)
        })
        .filter(|wave| wave.is_finite())
        .collect();
    waves.sort_by(f32::total_cmp);
    let wave = waves[waves.len() / 2];
    assert!((wave / 0.034 - 1.0).abs() < 0.06, "{wave}");
}

#[test]
fn strands_of_a_lock_curl_in_phase() {
    let style = Style::default();
    let likeness = |coherence: f32| {
        let (_, off) = offsets(&style, 1500, &Curls { coherence, ..regular() });
        let styled = guides(&style, head());
        let grown = grow(&styled, &smooth_growth(&style, 1500, Curls::default()), head()).unwrap();
        let mut sum = (0.0, 0);
        for i in (0..1500).step_by(5) {
            let root = grown.strand(i)[0];
            let near = (0..1500).filter(|k| *k != i).min_by(|a, b| {
                grown.strand(*a)[0].distance(root).total_cmp(&grown.strand(*b)[0].distance(root))
            });
            let (a, b) = (off[i][40], off[near.unwrap()][40]);
            sum = (sum.0 + a.normalize_or_zero().dot(b.normalize_or_zero()), sum.1 + 1);
        }
        sum.0 / sum.1 as f32
    };
    // Some neighbors belong to different locks.
    let (together, apart) = (likeness(1.0), likeness(0.0));
    assert!(together > 0.6 && apart.abs() < 0.2, "{together} {apart}");
}

#[test]
fn shrinking_curls_keep_strand_lengths() {
    let style = Style::default();
    let styled = guides(&style, head());
    let mean = |curls: Curls| {
        let grown = grow(&styled, &smooth_growth(&style, 300, curls), head()).unwrap();
        let length = |i: usize| grown.strand(i).windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
        let reach = grown.strands.iter().map(|s| s.scale[0]).sum::<f32>() / 300.0;
        ((0..300).map(length).sum::<f32>() / 300.0, reach)
    };
    let straight = mean(Curls::default());
    let shrunken = mean(Curls { shrink: 1.0, ..regular() });
    let kept = mean(regular());
    assert!((shrunken.0 / straight.0 - 1.0).abs() < 0.06, "{shrunken:?} {straight:?}");
    assert!(shrunken.1 < 0.65 * straight.1 && kept.1 == straight.1 && kept.0 > 1.5 * straight.0, "{kept:?}");
}

#[test]
fn painted_maps_remove_hair_only_where_painted() {
    let style = Style::default();
    let styled = guides(&style, head());
    let map = |low: f32| Some(ScalpMap::from_fn(64, move |uv| if uv.x > 0.5 { 1.0 } else { low }));
    let plain = grow(&styled, &some(&style, 2000), head()).unwrap();
    let painted = |paint: ScalpPaint| grow(&styled, &Growth { paint, ..some(&style, 2000) }, head()).unwrap();
    // Returns the mean over strands rooted well to the left of the head and well to the right, and their numbers.
    let sides = |grown: &GrownStrands, value: &dyn Fn(usize) -> f32| {
        [true, false].map(|left| {
            let there: Vec<f32> = (0..grown.strands.len())
                .filter(|i| (grown.strands[*i].root_uv.x - 0.5).abs() > 0.03)
                .filter(|i| (grown.strands[*i].root_uv.x > 0.5) == left)
                .map(value)
                .collect();
            (there.iter().sum::<f32>() / there.len().max(1) as f32, there.len() as f32)
        })
    };
    let usual = sides(&plain, &|i| plain.strands[i].radius);
    let thin = painted(ScalpPaint { density: map(0.3), ..ScalpPaint::default() });
    let now = sides(&thin, &|i| thin.strands[i].radius);
    let good = |l: f32, r: f32| l == 1.0 && (r - 0.3).abs() < 0.06;
    let kept = [0, 1].map(|k| now[k].1 / usual[k].1);
    assert!(good(kept[0], kept[1]) && !good(kept[1], kept[0]), "{kept:?}");
    // Thinning out does not make the other strands thicker.
    assert!((now[0].0 / usual[0].0 - 1.0).abs() < 1e-4);

    let fine = painted(ScalpPaint { thickness: map(0.5), ..ScalpPaint::default() });
    let now = sides(&fine, &|i| fine.strands[i].radius);
    assert!((now[0].0 / usual[0].0 - 1.0).abs() < 1e-4 && (now[1].0 / usual[1].0 - 0.5).abs() < 1e-4);

    let cut = painted(ScalpPaint { length: map(0.4), ..ScalpPaint::default() });
    let [was, now] = [&plain, &cut].map(|grown| sides(grown, &|i| grown.strands[i].scale[0]));
    assert!(now[0].0 == was[0].0 && (now[1].0 / was[1].0 - 0.4).abs() < 1e-4, "{was:?} {now:?}");

    let gray = ScalpMap::from_fn(2, |_| 0.1);
    let color = ColorMap { channels: [map(0.0).unwrap(), gray.clone(), gray] };
    let red = painted(ScalpPaint { color: Some(color), ..ScalpPaint::default() });
    let roots = sides(&red, &|i| (red.strands[i].colors[0] & 255) as f32);
    assert!((roots[0].0 - 0.8f32.sqrt() * 255.0).abs() < 1.0 && roots[1].0 == 0.0, "{roots:?}");
    assert!(plain.strands.iter().all(|s| s.colors == [0; 2]));

    let black = Some(ScalpMap::from_fn(4, |_| 0.0));
    let growth = Growth { paint: ScalpPaint { density: black, ..ScalpPaint::default() }, ..some(&style, 50) };
    assert!(grow(&styled, &growth, head()).is_err());
}

#[test]
fn random_curls_grow_finite_strands() {
    let styled = guides(&Style::default(), head());
    let mut rng = crate::random::Rng::new(5, 5);
    for _ in 0..12 {
        let curls = Curls {
            radius: rng.range(0.0, 0.05),
            wavelength: rng.range(0.016, 0.2),
            flatness: rng.unit(),
            start: rng.unit(),
            tip: rng.range(0.0, 3.0),
            irregularity: rng.unit(),
            coherence: rng.unit(),
            neighbors: rng.unit(),
            shrink: rng.unit(),
            curve: None,
        };
        let growth = some(&Style::default(), 60).with_curls(curls.clone());
        let grown = grow(&styled, &growth, head()).unwrap();
        assert!(grown.positions.iter().all(|p| p.is_finite() && p.length() < 5.0), "{curls:?}");
        assert!(grown.strands.iter().all(|s| s.scale[0] > 0.0 && s.scale[0] <= 1.0), "{curls:?}");
    }
}
