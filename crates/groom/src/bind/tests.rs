use super::*;
use crate::strands::Mark;

/// Strands on a sphere of 9 cm radius that hang 10 cm.
fn groom(count: usize) -> Strands {
    let mut strands = Strands::default();
    for i in 0..count {
        let y = 1.0 - i as f32 / count as f32;
        let angle = i as f32 * 2.399_963;
        let out = Vec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
        let curve: Vec<_> = (0..16)
            .map(|j| {
                let s = j as f32 / 15.0;
                out * (0.09 + 0.03 * s.sqrt()) - Vec3::Y * 0.1 * s * s
            })
            .collect();
        strands.push(&curve);
    }
    strands
}

#[test]
fn guide_counts_match_options_and_weights_sum_to_one() {
    let strands = groom(3000);
    for (guides, expected) in
        [(GuideCount::OneIn(16), 188), (GuideCount::Count(100), 100), (GuideCount::All, 3000)]
    {
        let groom = bind(&strands, &BindOptions { guides, ..Default::default() }).unwrap();
        assert_eq!(groom.guides.len(), expected);
        assert_eq!(groom.strands.len(), 3000);
        assert_eq!(groom.strands.vertex_count, 31);
        for b in &groom.strands.bindings {
            assert!(b.weight_b >= 0.0 && b.weight_c >= 0.0 && b.weight_b + b.weight_c <= 0.667);
            assert!(b.guides.iter().all(|g| (*g as usize) < expected));
        }
        let stood_for: f32 = groom.guides.strands.iter().sum();
        assert!((stood_for - 3000.0).abs() < 5.0, "{stood_for}");
    }
}

#[test]
fn guides_are_spread_evenly() {
    let strands = groom(4000);
    let groom =
        bind(&strands, &BindOptions { guides: GuideCount::Count(250), ..Default::default() }).unwrap();
    let reach = |p: Vec3| {
        (0..groom.guides.len()).map(|g| groom.guides.guide(g)[0].distance(p)).fold(f32::INFINITY, f32::min)
    };
    let farthest = strands.iter().map(|s| reach(s[0])).fold(0.0, f32::max);
    // In a perfect triangular grid of 250 points on this half sphere, no root is farther than 9 mm from a point.
    assert!(farthest < 0.02, "{farthest}");
}

#[test]
fn rest_positions_are_exact_to_10_micrometers() {
    let strands = groom(500);
    let groom = bind(&strands, &BindOptions::default()).unwrap();
    for (i, strand) in strands.iter().enumerate() {
        let rest: Vec<_> = groom.strands.rest_positions(i).collect();
        for (j, p) in strand.iter().enumerate() {
            assert!(rest[2 * j].distance(*p) < 1e-5);
        }
    }
}

#[test]
fn strands_with_pinned_tips_follow_pinned_guides() {
    let mut strands = groom(1000);
    strands.tip_pinned = (0..1000).map(|i| i % 5 == 0).collect();
    let groom = bind(&strands, &BindOptions::default()).unwrap();
    for (i, b) in groom.strands.bindings.iter().enumerate() {
        assert_eq!(groom.guides.tip_pinned[b.guides[0] as usize], i % 5 == 0);
    }
}

#[test]
fn marked_guides_of_a_file_are_used() {
    let mut strands = groom(200);
    // Every tenth strand is a guide. The others, except the first, follow guides 5 and 15 in the ratio 3:1, near or
    // far.
    strands.marks = (0..200)
        .map(|i| Mark {
            guide: i % 10 == 0,
            id: 1000 - i,
            group: i / 100,
            closest: [1000 - 50, 1000 - 150, 0],
            weights: if i == 1 { [0.0; 3] } else { [3.0, 1.0, 0.0] },
        })
        .collect();
    let made = bind(&strands, &BindOptions::default()).unwrap();
    assert_eq!((made.guides.len(), made.strands.len()), (20, 180));
    assert_eq!(made.guides.groups, (0..20).map(|g| g / 10).collect::<Vec<_>>());
    let bindings = &made.strands.bindings;
    for b in &bindings[1..] {
        assert_eq!((b.guides[0], b.guides[1], b.weight_b, b.weight_c), (5, 15, 0.25, 0.0));
    }
    assert_ne!((bindings[0].guides[0], bindings[0].weight_b), (5, 0.25), "one that says nothing");
    let first = |g: usize| made.guides.guide(g)[0].distance(strands.strand(10 * g)[0]);
    assert!((0..20).all(|g| first(g) < 1e-6));
    // An explicit guide count overrides the marks. An unknown guide id falls back to the nearest guides.
    let own = BindOptions { guides: GuideCount::Count(7), ..Default::default() };
    let other = bind(&strands, &own).unwrap();
    assert_eq!((other.guides.len(), other.strands.len()), (7, 200));
    strands.marks.iter_mut().for_each(|mark| mark.closest[1] = 7);
    let lost = bind(&strands, &BindOptions::default()).unwrap();
    assert!(lost.strands.bindings.iter().any(|b| b.guides[0] != 5));
    // If every strand is a guide, the guides are rendered.
    strands.marks.iter_mut().for_each(|mark| mark.guide = true);
    let alone = bind(&strands, &BindOptions::default()).unwrap();
    assert_eq!((alone.guides.len(), alone.strands.len()), (200, 200));
}

#[test]
fn invalid_input_is_rejected() {
    assert!(bind(&Strands::default(), &BindOptions::default()).is_err());
    let options = BindOptions { guide_vertex_count: Some(1000), ..Default::default() };
    assert!(bind(&groom(10), &options).unwrap_err().to_string().contains("guide_vertices is 1000"));
}

#[test]
fn fur_is_drawn_with_as_many_vertices_as_its_curve_needs() {
    // Arcs of 3 cm that bend by `angle`, of four vertices.
    let fur = |angle: f32, length: f32| {
        let mut strands = Strands::default();
        for i in 0..500 {
            let root = Vec3::new(0.002 * (i % 25) as f32, 0.0, 0.002 * (i / 25) as f32);
            let at = |k: usize| {
                let s = k as f32 / 3.0;
                let (radius, turn) = (length / angle, angle * s);
                root + radius * Vec3::new(1.0 - turn.cos(), turn.sin(), 0.0)
            };
            strands.push(&[0, 1, 2, 3].map(at));
        }
        strands
    };
    let count = |strands: &Strands| {
        let groom = bind(strands, &BindOptions::default()).unwrap();
        (groom.strands.vertex_count, groom.guides.vertex_count)
    };
    assert_eq!(count(&fur(0.2, 0.03)), (4, 8));
    let bent = count(&fur(1.8, 0.03));
    assert!((5..=8).contains(&bent.0), "{bent:?}");
    // Long hair.
    assert_eq!(count(&fur(0.2, 0.3)), (31, 32));
    // Options override both counts.
    let options =
        BindOptions { strand_vertex_count: Some(20), guide_vertex_count: Some(12), ..Default::default() };
    let groom = bind(&fur(0.2, 0.03), &options).unwrap();
    assert_eq!((groom.strands.vertex_count, groom.guides.vertex_count), (20, 12));
}
