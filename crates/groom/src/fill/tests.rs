//! Tests of filling on grooms with known answers.

use super::*;
use crate::{BindOptions, Followers, GuideCount, bind, bind_filled, curve, mesh::Bvh, scalp::scalp_uv};
use glam::{Vec2, Vec3};

/// Radius of the sphere that the test strands grow on, meters.
const BALL: f32 = 0.09;

/// Evenly spread roots on the upper half of a sphere.
fn roots(count: u32) -> Vec<Vec3> {
    let start = Vec2::new(0.3, 0.6);
    let all = (0..).map(|i| BALL * crate::scalp::spread_direction(i, start));
    all.filter(|p| p.y > 0.2 * BALL).take(count as usize).collect()
}

/// Hair that falls to the left or to the right of the plane x = 0 from the root on.
fn parted(count: u32) -> Strands {
    let mut strands = Strands::default();
    for (i, root) in roots(count).into_iter().enumerate() {
        let side = if root.x > 0.0 { 1.0 } else { -1.0 };
        let length = 0.15 + 0.03 * (i % 7) as f32 / 6.0;
        let line: Vec<Vec3> = (0..16)
            .map(|k| {
                let s = length * k as f32 / 15.0;
                root + 0.02 * s * root.normalize() + Vec3::new(side * s * 0.9, -1.6 * s * s, 0.0)
            })
            .collect();
        strands.push(&line);
    }
    strands
}

/// Curly locks: each a helix around its own straight axis.
fn curly(count: u32, radius: f32, pitch: f32) -> Strands {
    let mut strands = Strands::default();
    for (i, root) in roots(count).into_iter().enumerate() {
        let axis = (root.normalize() + 0.4 * Vec3::Y).normalize();
        let u = axis.any_orthonormal_vector();
        let v = axis.cross(u);
        let phase = (pcg(i as u32) >> 16) as f32 / 1e4;
        let at = |k: usize| {
            let h = 0.12 * k as f32 / 63.0;
            let (sin, cos) = (phase + std::f32::consts::TAU * h / pitch).sin_cos();
            axis * h + radius * (u * cos + v * sin)
        };
        let line: Vec<Vec3> = (0..64).map(|k| root + at(k) - at(0)).collect();
        strands.push(&line);
    }
    strands
}

fn filled(given: &Strands, count: u32) -> FilledStrands {
    fill(given, Head::default(), &Fill { strand_count: count, ..Fill::default() }).unwrap()
}

/// Iterates over the new strands with their parents.
fn new(filled: &FilledStrands) -> impl Iterator<Item = (&[Vec3], &Parents)> {
    filled.strands.iter().skip(filled.given).zip(&filled.parents)
}

#[test]
fn input_strands_stay_bit_identical() {
    let given = parted(300);
    let filled = filled(&given, 4000);
    assert_eq!((filled.strands.len(), filled.given, filled.parents.len()), (4000, 300, 3700));
    let bits = |p: &[Vec3]| p.iter().flat_map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&filled.strands.positions[..given.positions.len()]), bits(&given.positions));
    // Packing keeps them too: rest curves and boxes are the same as without new strands.
    for guides in [GuideCount::All, GuideCount::OneIn(16), GuideCount::Count(40)] {
        let options = BindOptions { guides, ..BindOptions::default() };
        let (alone, among) = (bind(&given, &options).unwrap(), bind_filled(&filled, &options).unwrap());
        let n = alone.strands.rest.len();
        assert_eq!(alone.strands.rest[..], among.strands.rest[..n]);
        for (a, b) in alone.strands.bindings.iter().zip(&among.strands.bindings) {
            assert_eq!((bits(&[a.origin]), a.extent.to_bits()), (bits(&[b.origin]), b.extent.to_bits()));
        }
        for b in &among.strands.bindings {
            let sum = b.weight_b + b.weight_c;
            assert!(
                b.guides.iter().all(|g| (*g as usize) < among.guides.len()) && (0.0..=0.667).contains(&sum)
            );
        }
    }
}

#[test]
fn same_seed_gives_same_strands() {
    let given = parted(200);
    let grow =
        |seed| fill(&given, Head::default(), &Fill { strand_count: 1500, seed, ..Fill::default() }).unwrap();
    assert_eq!(grow(5).strands, grow(5).strands);
    assert_ne!(grow(5).strands, grow(6).strands);
    // A count below the number of input strands changes nothing.
    assert_eq!(filled(&given, 100).strands, given);
}

/// Counts new strands with parents on both sides, with guides on both sides, and with a vertex behind the plane of the
/// parting.
fn mixed(parting: f32, guides: GuideCount) -> [usize; 3] {
    let given = parted(500);
    let filled =
        fill(&given, Head::default(), &Fill { strand_count: 8000, parting, ..Fill::default() }).unwrap();
    let groom = bind_filled(&filled, &BindOptions { guides, ..BindOptions::default() }).unwrap();
    let both = |sides: &mut dyn Iterator<Item = f32>| {
        let sides: Vec<f32> = sides.collect();
        sides.iter().any(|x| *x > 0.0) && sides.iter().any(|x| *x < 0.0)
    };
    let mut counts = [0; 3];
    for (i, (line, parents)) in new(&filled).enumerate() {
        let roots = parents.iter().map(|(p, _)| given.strand(p as usize)[0].x);
        counts[0] += usize::from(both(&mut roots.into_iter()));
        let b = &groom.strands.bindings[filled.given + i];
        let weights = [1.0 - b.weight_b - b.weight_c, b.weight_b, b.weight_c];
        let followed = b.guides.iter().zip(weights).filter(|(_, w)| *w > 0.0);
        counts[1] += usize::from(both(&mut followed.map(|(g, _)| groom.guides.guide(*g as usize)[0].x)));
        // The whole strand must stay on the side of its lead.
        let side = given.strand(parents.strands[0] as usize)[0].x.signum();
        counts[2] += usize::from(line.iter().any(|p| p.x * side < -0.01));
    }
    counts
}

#[test]
fn no_strand_crosses_a_parting() {
    for guides in [GuideCount::All, GuideCount::OneIn(16), GuideCount::Count(60)] {
        assert_eq!(mixed(Fill::default().parting, guides), [0; 3], "{guides:?}");
    }
    // Without the check, hundreds are mixed.
    let unchecked = mixed(std::f32::consts::PI, GuideCount::All);
    assert!(unchecked[0] > 200 && unchecked[1] > 200, "{unchecked:?}");
}

#[test]
fn lengths_lie_between_parent_lengths() {
    for given in [parted(300), curly(150, 0.004, 0.02)] {
        let filled = filled(&given, 2000);
        let mut outside = 0;
        for (line, parents) in new(&filled) {
            let lengths = parents.iter().map(|(p, _)| given.length(p as usize));
            let (lo, hi) = lengths.fold((f32::INFINITY, 0.0f32), |(lo, hi), l| (lo.min(l), hi.max(l)));
            let length = curve::length(line);
            outside += usize::from(length < 0.999 * lo || length > 1.001 * hi);
        }
        assert_eq!(outside, 0);
    }
}

/// Measures the middle of a curl: root mean square distance from the axis, and advance along the axis per turn.
fn measure(line: &[Vec3]) -> [f32; 2] {
    // First estimate of the axis: the slope of the points by least squares.
    let part = &line[8..line.len() - 8];
    let n = part.len() as f32;
    let middle = part.iter().sum::<Vec3>() / n;
    let slope: Vec3 =
        part.iter().enumerate().map(|(k, p)| (*p - middle) * (k as f32 - (n - 1.0) / 2.0)).sum();
    let mut axis = slope.normalize();
    for _ in 0..20 {
        // Power iteration on the scatter matrix: the longest axis of the points is the axis of the curl.
        axis = part.iter().map(|p| (*p - middle) * (*p - middle).dot(axis)).sum::<Vec3>().normalize();
    }
    let u = axis.any_orthonormal_vector();
    let v = axis.cross(u);
    let flat: Vec<Vec2> =
        part.iter().map(|p| Vec2::new((*p - middle).dot(u), (*p - middle).dot(v))).collect();
    let radius = (flat.iter().map(|p| p.length_squared()).sum::<f32>() / n).sqrt();
    let angle: f32 = flat.windows(2).map(|w| w[0].angle_to(w[1])).sum();
    let along = (part[part.len() - 1] - part[0]).dot(axis);
    [radius, along.abs() / (angle.abs() / std::f32::consts::TAU)]
}

#[test]
fn curls_keep_radius_and_pitch() {
    let (radius, pitch) = (0.005, 0.024);
    let given = curly(300, radius, pitch);
    let [r, p] = measure(given.strand(11));
    assert!((r / radius - 1.0).abs() < 0.02 && (p / pitch - 1.0).abs() < 0.02, "the measure: {r} {p}");
    let filled = filled(&given, 3000);
    let all: Vec<[f32; 2]> = new(&filled).map(|(line, _)| measure(line)).collect();
    let mean = |k: usize| all.iter().map(|m| m[k]).sum::<f32>() / all.len() as f32;
    let (r, p) = (mean(0) / radius, mean(1) / pitch);
    assert!((r - 1.0).abs() < 0.05 && (p - 1.0).abs() < 0.05, "{r} {p}");
    let off = |m: &&[f32; 2]| (m[0] / radius - 1.0).abs() > 0.05 || (m[1] / pitch - 1.0).abs() > 0.05;
    let off = all.iter().filter(off).count() as f32 / all.len() as f32;
    assert!(off < 0.05, "{off} of the strands are more than 5 % off");
    // The mean of three curls is no curl: this measure detects blended vertices.
    let blend = |parents: &Parents| -> Vec<Vec3> {
        (0..64).map(|k| parents.iter().map(|(i, w)| w * given.strand(i as usize)[k]).sum::<Vec3>()).collect()
    };
    let blended =
        new(&filled).map(|(_, parents)| measure(&blend(parents))[0]).sum::<f32>() / all.len() as f32;
    assert!(blended < 0.8 * radius, "{blended}");
}

/// Returns the distance of each point to its nearest neighbor, relative to a triangular grid of the same count.
fn apart(points: &[Vec3], area: f32) -> Vec<f32> {
    let near = crate::near::PointTree::new(points);
    let perfect = (2.0 * area / (3f32.sqrt() * points.len() as f32)).sqrt();
    let mut found = Vec::new();
    let nearest = points.iter().map(|p| {
        near.nearest(*p, 2, 1.0, &mut found);
        found.last().map_or(0.0, |f| f.0.sqrt()) / perfect
    });
    nearest.collect()
}

#[test]
fn roots_are_even_and_on_the_skin() {
    let given = parted(260);
    // A head mesh finer than the spacing of the guides; its triangles sag less than 0.1 mm.
    let mesh = crate::mesh::shapes::sphere(BALL, 160);
    let head = Head { mesh: Some(&mesh), field: None };
    let filled = fill(&given, head, &Fill { strand_count: 6000, ..Fill::default() }).unwrap();
    let bvh = Bvh::new(&mesh);
    let roots: Vec<Vec3> = filled.strands.iter().map(|line| line[0]).collect();
    let far = roots.iter().map(|p| bvh.closest_point(*p).unwrap().distance).fold(0.0, f32::max);
    assert!(far < 1e-3, "{far}");
    // Roots on the flat triangles between guides fail the check.
    let flat = super::tests::filled(&given, 6000);
    let sag =
        flat.strands.iter().map(|line| bvh.closest_point(line[0]).unwrap().distance).fold(0.0, f32::max);
    assert!(sag > 1e-3, "{sag}");

    let surface = Scalp::new(&given, head, 1.0).unwrap().surface;
    let area: f32 = surface.triangles.iter().map(|t| surface::area_of(surface.corners(*t))).sum();
    let spread = |points: &[Vec3]| {
        let all = apart(points, area);
        let least = |part: f32| {
            let mut sorted = all.clone();
            sorted.sort_by(f32::total_cmp);
            sorted[(part * sorted.len() as f32) as usize]
        };
        [all.iter().sum::<f32>() / all.len() as f32, least(0.01)]
    };
    let [mean, least] = spread(&roots[filled.given..]);
    // White noise: the same number of independent random places.
    let thrower = Thrower::new(&surface, None, 3);
    let white: Vec<Vec3> =
        (0..).filter_map(|i| thrower.throw(i)).map(|dart| dart.0.root).take(roots.len() - 260).collect();
    let [white, none] = spread(&white);
    assert!((white - 0.465).abs() < 0.03 && none < 0.1, "white noise: {white} {none}");
    assert!(mean > 0.68 && least > 0.4, "{mean} {least}");
}

#[test]
fn density_follows_input_roots_or_map() {
    // Twice as dense in front.
    let mut given = Strands::default();
    let mut rng = Rng::new(9, 1);
    for root in roots(1200) {
        if root.z > 0.0 || rng.unit() < 0.5 {
            given.push(&[root, root * 1.3, root * 1.7]);
        }
    }
    let front = |strands: &Strands, from: usize| {
        // Count away from the border between the halves and from the edges.
        let there = |z: f32| {
            strands.iter().skip(from).filter(|s| s[0].y > 0.4 * BALL && s[0].z * z > 0.01).count() as f32
        };
        there(1.0) / there(-1.0)
    };
    let all = filled(&given, 9000);
    let (old, new) = (front(&given, 0), front(&all.strands, all.given));
    assert!((old - 2.0).abs() < 0.25 && (new / old - 1.0).abs() < 0.12, "{old} {new}");
    let map = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.25 });
    let painted = fill(
        &parted(400),
        Head::default(),
        &Fill { strand_count: 8000, density: Some(map.clone()), ..Fill::default() },
    )
    .unwrap();
    let count = |side: f32| painted.strands.iter().skip(400).filter(|s| s[0].x * side > 0.012).count() as f32;
    assert!((count(-1.0) / count(1.0) - 0.25).abs() < 0.04, "{}", count(-1.0) / count(1.0));
    assert!((painted.strands.len() as f32 / 8000.0 - 0.64).abs() < 0.06, "{}", painted.strands.len());
    let black = Fill { strand_count: 500, density: Some(ScalpMap::from_fn(2, |_| 0.0)), ..Fill::default() };
    let bald = fill(&parted(40), Head::default(), &black).unwrap();
    assert_eq!(bald.strands.len(), 40);
    let paint = ScalpPaint { density: Some(map), ..ScalpPaint::default() };
    let thinned = painted.painted(&paint, Vec3::ZERO, 1).unwrap();
    assert!(thinned.given < 300 && thinned.strands.len() - thinned.given == thinned.parents.len());
    assert!(bind_filled(&thinned, &BindOptions::default()).is_ok());
    assert!(thinned.original.iter().zip(thinned.strands.iter()).all(|(was, s)| {
        let root = parted(400).strand(*was as usize)[0];
        root == s[0] && (scalp_uv(root).x > 0.4 || paint.density.is_some())
    }));
}

#[test]
fn clumps_stay_clumps() {
    // About twelve roots converge at the tip of each clump. Tips are as far apart as the centers of the clumps.
    let centers: Vec<Vec3> = roots(60);
    let mut given = Strands::default();
    for root in roots(720) {
        let middle = centers.iter().min_by(|a, b| a.distance(root).total_cmp(&b.distance(root))).unwrap();
        let line: Vec<Vec3> = (0..16)
            .map(|k| {
                let s = k as f32 / 15.0;
                root.lerp(*middle, 0.95 * s) + 0.1 * s * root.lerp(*middle, s).normalize()
            })
            .collect();
        given.push(&line);
    }
    let tips: Vec<Vec3> = centers.iter().map(|c| *c + 0.1 * c.normalize()).collect();
    let off = |strands: &Strands, from: usize| {
        let far = strands
            .iter()
            .skip(from)
            .map(|s| tips.iter().map(|t| t.distance(s[s.len() - 1])).fold(f32::INFINITY, f32::min));
        let mut far: Vec<f32> = far.collect();
        far.sort_by(f32::total_cmp);
        [far[far.len() / 2], far[far.len() * 95 / 100]]
    };
    let grow = |options: Fill| {
        let filled = fill(&given, Head::default(), &Fill { strand_count: 6000, ..options }).unwrap();
        off(&filled.strands, filled.given)
    };
    let calm = StrandVariation { frizz: 0.0, stray: 0.0, flyaway: 0.0, ..Fill::default().variation };
    let (old, new) = (off(&given, 0), grow(Fill { tufts: 0.0, variation: calm, ..Fill::default() }));
    // Tips of clumps are about 25 mm apart: hair between two would be at least 8 mm from both.
    assert!(new[0] < old[0] + 5e-4 && new[1] < old[1] + 2e-3, "{old:?} {new:?}");
    // Stray hairs deviate by 3 mm.
    let strays = grow(Fill::default());
    assert!(strays[0] < new[0] + 1e-3 && strays[1] < new[1] + 3e-3, "{new:?} {strays:?}");
    // Means of all surrounding strands lie between clumps.
    let surface = Scalp::new(&given, Head::default(), 1.0).unwrap().surface;
    let thrower = Thrower::new(&surface, None, 3);
    let mut means = Strands::default();
    for (place, ..) in (0..6000).filter_map(|i| thrower.throw(i)) {
        let at = |site: u32, k: usize| given.strand(surface.strands(site)[0] as usize)[k];
        let mean = |k| (0..3).map(|c| place.weights[c] * at(place.sites[c], k)).sum::<Vec3>();
        means.push(&(0..16).map(mean).collect::<Vec<_>>());
    }
    let means = off(&means, 0);
    assert!(means[1] > new[1] + 5e-3, "{means:?}");
}

#[test]
fn child_strands_stay_near_their_guide() {
    let given = parted(100);
    let follow = |followers: &[Followers], most| {
        crate::progress::at_once(follow_with(&given, Head::default(), followers, most, 1, &()))
    };
    let four = Followers { count: 4, radius: Some(0.002) };
    let all = follow(&[four], u32::MAX).unwrap();
    assert_eq!(all.strands.len(), 500);
    for (line, parents) in new(&all) {
        let guide = given.strand(parents.strands[0] as usize);
        let away: Vec<f32> = line.iter().zip(guide).map(|(a, b)| a.distance(*b)).collect();
        // The children are as long as their guide, so they drift where it bends.
        assert!(away[0] <= 0.00201 && away.iter().all(|d| (2e-4..=0.0025).contains(d)), "{away:?}");
    }
    // A map thins them out like their guides.
    let density = Some(ScalpMap::from_fn(4, |_| 0.5));
    let half = all.painted(&ScalpPaint { density, ..ScalpPaint::default() }, Vec3::ZERO, 1).unwrap();
    assert!((150..350).contains(&half.strands.len()) && bind_filled(&half, &BindOptions::default()).is_ok());
    assert_eq!(follow(&[four], 150).unwrap().strands.len(), 150);
    assert_eq!(follow(&[four], 50).unwrap().strands.len(), 100);
    let mut some = vec![Followers::default(); 100];
    some[3] = Followers { count: 7, radius: None };
    assert_eq!(follow(&some, u32::MAX).unwrap().strands.len(), 107);
    let sentence = |followers| follow(&[followers], u32::MAX).unwrap_err().to_string();
    assert!(sentence(Followers { count: u32::MAX, radius: None }).contains("429496729600 strands"));
    for radius in [f32::NAN, -1.0, f32::INFINITY, 50.0] {
        assert!(sentence(Followers { count: 1, radius: Some(radius) }).contains("child strand radius"));
    }
    assert!(follow(&[four, four], 9).is_err());
}

#[test]
fn hair_stays_out_of_the_head() {
    // Hair that falls along the surface of the sphere; a straight line between two strands passes through it.
    let field = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 65, |p| p.length() - BALL);
    let mut given = Strands::default();
    for root in roots(80) {
        let down = root.cross(Vec3::Y).cross(root).normalize_or(Vec3::X) * -1.0;
        let line: Vec<Vec3> = (0..20)
            .map(|k| {
                let (sin, cos) = (0.1 * k as f32).sin_cos();
                (root.normalize() * cos + down * sin) * (BALL + 0.002)
            })
            .collect();
        given.push(&line);
    }
    let deepest = |head| {
        let filled = fill(&given, head, &Fill { strand_count: 4000, ..Fill::default() }).unwrap();
        let all = &filled.strands.positions[given.positions.len()..];
        let mut depths: Vec<f32> = all.iter().map(|p| p.length() - BALL).collect();
        depths.sort_by(f32::total_cmp);
        [depths[0], depths[depths.len() / 100]]
    };
    let mesh = crate::mesh::shapes::sphere(BALL, 160);
    let [least, most] = deepest(Head { mesh: Some(&mesh), field: Some(&field) });
    assert!(least > -1.5e-3 && most > -5e-4, "{least} {most}");
    // Without a head, hair passes through the sphere.
    let [least, most] = deepest(Head::default());
    assert!(least < -4e-3 && most < -2e-3, "{least} {most}");
}

#[test]
fn degenerate_grooms_are_filled_or_rejected() {
    let line = |root: Vec3| [root, root + 0.05 * Vec3::Y, root + 0.1 * Vec3::Y];
    let grow = |roots: &[Vec3], count: u32| {
        let mut strands = Strands::default();
        roots.iter().for_each(|root| strands.push(&line(*root)));
        let filled = filled(&strands, count);
        assert_eq!(filled.strands.len(), count as usize, "{roots:?}");
        assert!(filled.strands.positions.iter().all(|p| p.is_finite()));
        let reach = filled
            .strands
            .iter()
            .map(|s| roots.iter().map(|r| r.distance(s[0])).fold(f32::INFINITY, f32::min));
        assert!(bind_filled(&filled, &BindOptions::default()).is_ok());
        reach.fold(0.0, f32::max)
    };
    // One root, two, many coincident ones, a row: a tuft grows around each.
    assert!(grow(&[Vec3::ZERO], 500) < 0.01);
    assert!(grow(&[Vec3::ZERO, Vec3::X * 0.5], 500) < 0.01);
    assert!(grow(&[Vec3::ONE; 30], 500) < 0.01);
    assert!(grow(&[Vec3::ZERO, Vec3::X * 0.01, Vec3::X * 0.02], 400) < 0.01);
    // Three distant roots form a triangle.
    assert!(grow(&[Vec3::ZERO, Vec3::X * 0.02, Vec3::Z * 0.02], 400) < 0.02);
    let refused = |strands: &Strands, options: Fill| fill(strands, Head::default(), &options).unwrap_err();
    assert!(refused(&Strands::default(), Fill::default()).to_string().contains("no strands"));
    let mut short = Strands::default();
    short.push(&[Vec3::X]);
    assert!(refused(&short, Fill::default()).to_string().contains("strand 0"));
    // Strands with more vertices than render strands have, as in a groom that was not repaired.
    let field = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - BALL);
    let mut long = Strands::default();
    let line = |root: Vec3| (0..150).map(move |k| root * (1.0 - 0.001 * k as f32)).collect::<Vec<_>>();
    roots(12).into_iter().for_each(|root| long.push(&line(root)));
    let head = Head { mesh: None, field: Some(&field) };
    assert_eq!(fill(&long, head, &Fill { strand_count: 90, ..Fill::default() }).unwrap().strands.len(), 90);
    let given = parted(10);
    let many = Fill { strand_count: u32::MAX, ..Fill::default() };
    assert!(refused(&given, many).to_string().contains("4294967295"));
    for parting in [f32::NAN, -1.0, 9.0] {
        assert!(fill(&given, Head::default(), &Fill { parting, ..Fill::default() }).is_err());
    }
}
