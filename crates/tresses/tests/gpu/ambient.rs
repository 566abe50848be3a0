//! Ambient light against closed forms.

use crate::common;

use tresses::{
    Body, Context, Picture, View, ViewOptions,
    glam::{Quat, Vec3},
    groom::{TriMesh, hash::pcg},
    light::{Light, Lights, Sky, Sphere},
    low_level::{AmbientProbe, HairSet, IncidentLight},
    renderer::Renderer,
};

/// Half the edge length of the ambient grid, meters.
const HALF: f32 = 0.24;
const WHITE: f32 = 0.8;
/// Length of the mean direction of a hemisphere, weighted by the cosine.
const COSINES: f32 = 2.0 / 3.0;

fn random(i: u32, k: u32) -> f32 {
    (pcg(pcg(i) ^ k) >> 8) as f32 / 16_777_216.0
}

struct Bench<'a> {
    context: &'a Context,
    view: View,
    hair: Option<HairSet>,
    body: Option<Body>,
    scene: Picture,
}

impl<'a> Bench<'a> {
    fn new(context: &'a Context) -> Self {
        Self::with_cells(context, ViewOptions::default().ambient_resolution)
    }

    fn with_cells(context: &'a Context, ambient_cells: u32) -> Self {
        let options = ViewOptions {
            renderer: Renderer::masks(1),
            shadow_resolution: 256,
            ambient_resolution: ambient_cells,
            ..Default::default()
        };
        let mut scene = Picture { focus: Sphere { center: Vec3::ZERO, radius: HALF }, ..Default::default() };
        scene.lights = Lights { list: Vec::new(), sky: Sky::default(), ..Default::default() };
        let view = View::new(context, &options, [16, 16], 1).expect("fits");
        Self { view, context, hair: None, body: None, scene }
    }

    fn body(mut self, mesh: &TriMesh) -> Self {
        let cells = self.view.options().ambient_resolution;
        let mut body = Body::with_levels(self.context, mesh, &[], cells);
        body.material.color = Vec3::splat(WHITE);
        body.material.wrap = 0.0;
        self.body = Some(body);
        self
    }

    /// Sets the hair: straight segments, each given by its two ends.
    fn hair(mut self, pieces: &[[Vec3; 2]], radius: f32) -> Self {
        self.hair = Some(common::segments(self.context, pieces, radius));
        self
    }

    fn light(mut self, direction: Vec3) -> Self {
        self.set_light(direction);
        self
    }

    fn set_light(&mut self, direction: Vec3) {
        let irradiance = Vec3::splat(std::f32::consts::PI);
        self.scene.lights.list = vec![Light::distant(direction.normalize(), irradiance)];
    }

    fn ask(&self, points: &[(Vec3, Vec3)]) -> Vec<IncidentLight> {
        let context = self.context;
        let (device, queue) = (context.device(), context.queue());
        let probe = AmbientProbe::new(context, &self.view.light, points).expect("fits");
        let mut encoder = device.create_command_encoder(&Default::default());
        let (hair, bodies): (Vec<_>, Vec<_>) = (self.hair.iter().collect(), self.body.iter().collect());
        context.recorder(&mut encoder).light(&hair, &bodies, &self.view, &self.scene, &[]).expect("it fits");
        probe.record(&mut encoder).expect("it compiles");
        queue.submit([encoder.finish()]);
        pollster::block_on(probe.read()).expect("answers")
    }
}

/// Returns a square with edges of 2·`half` in the plane z = `z`. Its front faces +z.
fn wall(half: f32, z: f32) -> TriMesh {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    common::rectangle(corners.map(|(x, y)| Vec3::new(x, y, z)))
}

/// Returns randomly oriented hair segments in a horizontal layer, `thick` meters thick and centered at y = `middle`. A
/// vertical ray hits `fibers` of them on average.
fn layer(middle: f32, thick: f32, fibers: f32, radius: f32) -> Vec<[Vec3; 2]> {
    let length = 0.01;
    // The mean projected length of a randomly oriented segment is π/4 of its length.
    let each = 0.25 * std::f32::consts::PI * 2.0 * radius * length;
    let count = (fibers * (2.0 * HALF).powi(2) / each) as u32;
    (0..count)
        .map(|i| {
            let at = Vec3::new(
                (2.0 * random(i, 1) - 1.0) * HALF,
                middle + (random(i, 2) - 0.5) * thick,
                (2.0 * random(i, 3) - 1.0) * HALF,
            );
            let y = 2.0 * random(i, 4) - 1.0;
            let (sin, cos) = (std::f32::consts::TAU * random(i, 5)).sin_cos();
            let flat = (1.0 - y * y).sqrt();
            let way = Vec3::new(flat * cos, y, flat * sin) * (0.5 * length);
            [at - way, at + way]
        })
        .collect()
}

#[test]
fn empty_space_sees_the_whole_sky() {
    let Some(context) = common::context() else { return };
    let points: Vec<_> = (0..200)
        .map(|i| {
            let at = |k| (2.4 * random(i, k) - 1.2) * HALF;
            (Vec3::new(at(1), at(2), at(3)), Vec3::new(at(4), at(5), at(6)).normalize_or_zero() * 0.6)
        })
        .collect();
    let open = |found: &IncidentLight| (found.open - 1.0).abs().max_element() < 2e-3;
    let dark = |found: &IncidentLight| found.radiance == Vec3::ZERO;
    for found in Bench::new(context).light(Vec3::Y).ask(&points) {
        assert!(open(&found) && dark(&found), "{found:?}");
    }
    // A few hairs are detected, and so is a lit wall a few centimeters wide.
    let hairs = Bench::new(context).hair(&layer(0.0, 0.06, 0.02, 1e-3), 1e-3).ask(&points);
    assert!(!hairs.iter().all(open));
    let lit = Bench::new(context).body(&wall(0.03, 0.0)).light(Vec3::Z).ask(&points);
    assert!(!lit.iter().all(open) && !lit.iter().all(dark));
}

/// Returns the transmittance of a layer of n fibers, averaged over the directions of a hemisphere: the exponential
/// integral E₂(n).
fn mean_behind(n: f64) -> f64 {
    let steps = 4000;
    (0..steps).map(|i| (-n / ((f64::from(i) + 0.5) / f64::from(steps))).exp() / f64::from(steps)).sum()
}

/// Returns the same average over the directions that the ambient grid traces.
fn mean_followed(n: f64) -> f64 {
    (4.0 * (-n / 0.868_890_3).exp() + 8.0 * (-n / 0.350_021_2).exp()) / 12.0
}

#[test]
fn hair_layers_attenuate_the_sky() {
    let Some(context) = common::context() else { return };
    for fibers in [0.25_f32, 0.5, 1.0, 2.0] {
        let bench = Bench::new(context).hair(&layer(0.06, 0.06, fibers, 1e-3), 1e-3);
        let below: Vec<_> = (0..40)
            .map(|i| {
                (Vec3::new(random(i, 8) - 0.5, 0.0, random(i, 9) - 0.5) * 0.1 + Vec3::Y * 0.01, Vec3::ZERO)
            })
            .collect();
        let found = bench.ask(&below);
        // Opacities 1, 1/2 and 1/8 per fiber. The lower half of all directions is free.
        for (share, k) in [(1.0, 3), (0.5, 2), (0.125, 1)] {
            let mean = found.iter().map(|around| f64::from(around.open[k])).sum::<f64>() / 40.0;
            let n = share * f64::from(fibers);
            let [exact, followed] = [mean_behind(n), mean_followed(n)].map(|m| 0.5 + 0.5 * m);
            println!("{fibers} fibers, share {share}: {mean:.4}, followed {followed:.4}, exact {exact:.4}");
            assert!((mean - followed).abs() < 0.035 && (mean - exact).abs() < 0.06, "{fibers} {share}");
        }
        let at = Vec3::Y * 0.01;
        let up = bench.ask(&[(at, Vec3::Y * COSINES), (at, Vec3::NEG_Y * COSINES)]);
        assert!(up[0].open.w < up[1].open.w && up[1].open.w > 0.93, "{up:?}");
    }
}

/// Returns the share of all directions that a square wall with edges of 2·`half` covers, seen from `height` above its
/// center: solid angle over 4π.
fn form_factor(half: f32, height: f32) -> f64 {
    let (side, h) = (f64::from(half).powi(2), f64::from(height).powi(2));
    (side / (side + h)).asin() / std::f64::consts::PI
}

/// Returns, for each of `heights` above the center of a lit wall 6 cm below the origin, the light that the wall
/// reflects and the sky that it occludes, both as shares of all directions. Averages over rotations of the scene,
/// because the grid has cells and traces only 24 directions: in a single orientation the share is off by up to 1/24 at
/// the wall's edges.
fn seen_of_wall(context: &Context, half: f32, heights: &[f32]) -> Vec<[f64; 2]> {
    let turns = 12;
    let mut sums = vec![[0.0; 2]; heights.len()];
    for i in 0..turns {
        let axis = Vec3::new(random(i, 1) - 0.5, random(i, 2) - 0.5, random(i, 3) - 0.5).normalize();
        let turn = Quat::from_axis_angle(axis, std::f32::consts::TAU * random(i, 4));
        // A closed box, so that its inside is defined.
        let mut mesh = common::cube(1.0);
        mesh.positions.iter_mut().for_each(|p| *p = *p * Vec3::new(half, half, 0.02) - Vec3::Z * 0.08);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
        let points: Vec<_> = heights.iter().map(|h| (turn * (Vec3::Z * (h - 0.06)), Vec3::ZERO)).collect();
        // With an irradiance of π, the wall's radiance is its albedo.
        let found = Bench::new(context).body(&mesh).light(turn * Vec3::Z).ask(&points);
        for (sum, found) in sums.iter_mut().zip(found) {
            sum[0] += f64::from(found.radiance.x / WHITE) / f64::from(turns);
            sum[1] += (1.0 - f64::from(found.open.x)) / f64::from(turns);
        }
    }
    sums
}

#[test]
fn wall_reflects_and_occludes_by_its_form_factor() {
    let Some(context) = common::context() else { return };
    let heights = [0.04_f32, 0.08, 0.12, 0.2];
    let off = |half: f32| -> Vec<[f64; 2]> {
        let exact = |height| form_factor(0.12, height);
        let seen = seen_of_wall(context, half, &heights);
        seen.iter().zip(heights).map(|(seen, height)| seen.map(|share| share / exact(height) - 1.0)).collect()
    };
    let errors = off(0.12);
    for (height, [thrown, hidden]) in heights.iter().zip(&errors) {
        let exact = form_factor(0.12, *height);
        println!("{height} m: {exact:.4} of all sides, thrown {thrown:+.3}, hidden {hidden:+.3} of that");
    }
    // A fifth of a stop; cameras and lights are set in steps of a third or more. The cells of 2 cm blur the wall's edge
    // by as much.
    let good = |errors: &[[f64; 2]]| errors.iter().flatten().all(|error| (1.0 + error).log2().abs() < 0.2);
    assert!(good(&errors), "{errors:?}");
    // A wall that is 1 cm wider on every side fails.
    assert!(!good(&off(0.13)));
    let bench = Bench::new(context).body(&wall(HALF, -0.1)).light(Vec3::Z);
    let close = Vec3::new(0.0, 0.0, -0.08);
    let found = bench.ask(&[(close, Vec3::NEG_Z * COSINES), (close, Vec3::Z * COSINES)]);
    assert!((found[0].radiance.x / WHITE - 1.0).abs() < 0.12 && found[0].open.x < 0.12, "{found:?}");
    assert!(found[1].radiance.x < 0.05 && (found[1].open.x - 1.0).abs() < 0.12, "{found:?}");
    // A wall lit from behind reflects nothing.
    let dark = Bench::new(context).body(&wall(HALF, -0.1)).light(Vec3::NEG_Z).ask(&[(close, Vec3::ZERO)])[0];
    assert!(dark.radiance.x < 1e-3, "{dark:?}");
}

/// Coarse grids represent the same surface with fewer points of the body.
#[test]
fn coarse_grids_represent_the_same_body() {
    let Some(context) = common::context() else { return };
    let at = Vec3::new(0.01, 0.02, 0.02);
    let seen = |cells, z| {
        let bench = Bench::with_cells(context, cells).body(&wall(HALF, z)).light(Vec3::Z);
        bench.ask(&[(at, Vec3::ZERO), (at, Vec3::NEG_Z * COSINES)])
    };
    let fine = seen(24, -0.1);
    let same = |coarse: &[IncidentLight]| {
        coarse.iter().zip(&fine).all(|(coarse, fine)| {
            (coarse.open - fine.open).abs().max_element() < 0.04
                && (coarse.radiance - fine.radiance).abs().max_element() < 0.04 * WHITE
        })
    };
    for cells in [12, 16] {
        let coarse = seen(cells, -0.1);
        println!("{cells} cells: {coarse:?}, 24: {fine:?}");
        assert!(same(&coarse), "{coarse:?} {fine:?}");
        // A wall that is displaced by one cell fails.
        assert!(!same(&seen(cells, -0.1 - 2.0 * HALF / cells as f32)));
    }
}

/// Returns a sphere centered at the origin.
fn ball(radius: f32) -> TriMesh {
    let (rings, steps) = (48, 96);
    let mut mesh = TriMesh::default();
    for i in 0..=rings {
        let (sin, cos) = (std::f32::consts::PI * i as f32 / rings as f32).sin_cos();
        for j in 0..=steps {
            let (z, x) = (std::f32::consts::TAU * j as f32 / steps as f32).sin_cos();
            mesh.normals.push(Vec3::new(sin * x, cos, sin * z));
            mesh.positions.push(radius * Vec3::new(sin * x, cos, sin * z));
        }
    }
    let row = steps + 1;
    for a in (0..rings).flat_map(|i| (0..steps).map(move |j| i * row + j)) {
        mesh.triangles.extend([[a, a + 1, a + row], [a + 1, a + row + 1, a + row]]);
    }
    mesh
}

/// A sphere occludes the sky by its solid angle, and its surface does not occlude the hemisphere above itself.
#[test]
fn sphere_occludes_its_solid_angle() {
    let Some(context) = common::context() else { return };
    let radius = 0.1;
    let mesh = ball(radius);
    let outside = mesh.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).dot(a) >= -1e-9
    });
    assert!(outside, "corners go round counter-clockwise");
    let bench = Bench::new(context).body(&mesh);
    let cell = 2.0 * HALF / 24.0;
    let sides: Vec<_> = (0..64)
        .map(|i| {
            let y = 2.0 * random(i, 1) - 1.0;
            let (sin, cos) = (std::f32::consts::TAU * random(i, 2)).sin_cos();
            Vec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin)
        })
        .collect();
    let seen = |height: f32| {
        let ask = |n: &Vec3| [Vec3::ZERO, COSINES * *n].map(|middle| (*n * (radius + height), middle));
        let found = bench.ask(&sides.iter().flat_map(ask).collect::<Vec<_>>());
        let of = |k: usize| found.iter().skip(k).step_by(2).map(|a| a.open.x);
        let exact = |radius: f32, height: f32| {
            let sin = radius / (radius + height);
            0.5 + 0.5 * (1.0 - sin * sin).sqrt()
        };
        // The sky visibility lies between the exact value and that for a sphere whose radius is one cell larger.
        let larger = exact(radius + cell, (height - cell).max(0.0));
        let mean = of(0).sum::<f32>() / sides.len() as f32;
        let (exact, least) = (exact(radius, height), of(1).fold(f32::MAX, f32::min));
        println!(
            "{height}: {mean:.3} of {exact:.3}, of a larger one {larger:.3}; upwards at least {least:.3}"
        );
        (mean <= exact + 0.01 && mean >= larger - 0.01, least)
    };
    for height in [cell, 1.5 * cell, 0.05, 0.1] {
        let (hides, upwards) = seen(height);
        assert!(hides && upwards > 0.99, "{height}");
    }
    // In the surface itself, the hemisphere above is partly occluded, which the test detects.
    assert!(seen(0.0).1 < 0.9);
}

#[test]
fn light_does_not_leak_through_closed_meshes() {
    let Some(context) = common::context() else { return };
    // A closed cube, lit from above and rotated so that no face is parallel to the cells.
    let mut cube = common::cube(0.1);
    let turn = Quat::from_rotation_x(0.4) * Quat::from_rotation_y(0.6);
    cube.positions.iter_mut().for_each(|p| *p = turn * *p);
    let bench = Bench::new(context).body(&cube).light(Vec3::Y);
    let found = bench.ask(&[
        (Vec3::ZERO, Vec3::ZERO),
        (Vec3::NEG_Y * 0.21, Vec3::Y * 0.5),
        (Vec3::Y * 0.2, Vec3::NEG_Y * 0.5),
    ]);
    assert!(found[0].open.x < 0.02 && found[0].radiance.x < 0.02, "inside {:?}", found[0]);
    assert!(found[1].radiance.x < 0.1 * found[2].radiance.x, "below {:?}, above {:?}", found[1], found[2]);
}

/// Still scenes are bit-identical. Slow rotations of light and head change the light slowly.
#[test]
fn slow_motion_changes_ambient_light_slowly() {
    let Some(context) = common::context() else { return };
    let mut cube = common::cube(0.08);
    let turn = Quat::from_rotation_x(0.4);
    cube.positions.iter_mut().for_each(|p| *p = turn * *p);
    let pieces = layer(0.15, 0.06, 1.0, 1e-3);
    let mut bench = Bench::new(context).body(&cube).hair(&pieces, 1e-3).light(Vec3::new(0.3, 0.2, 1.0));
    let points: Vec<_> = (0..100)
        .map(|i| {
            let at = Vec3::new(random(i, 1) - 0.5, random(i, 2) - 0.5, random(i, 3) - 0.5).normalize();
            (at * (0.15 + 0.05 * random(i, 4)), Vec3::ZERO)
        })
        .collect();
    assert!(bench.ask(&points) == bench.ask(&points), "a still scene is the same to the bit");
    let frames: Vec<Vec<IncidentLight>> = (0..6)
        .map(|i| {
            let angle = 0.25_f32.to_radians() * i as f32;
            bench.body.as_mut().unwrap().pose.rotation = Quat::from_rotation_y(angle);
            bench.set_light(Quat::from_rotation_y(-angle) * Vec3::new(0.3, 0.2, 1.0));
            bench.ask(&points)
        })
        .collect();
    let mut worst = [0.0_f32; 2];
    for pair in frames.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            worst[0] = worst[0].max((a.open - b.open).abs().max_element());
            worst[1] = worst[1].max((a.radiance - b.radiance).abs().max_element());
        }
    }
    println!("from frame to frame at most {:.4} of the sky, {:.4} of the radiance", worst[0], worst[1]);
    assert!(worst[0] < 0.02 && worst[1] < 0.02 * WHITE, "{worst:?}");
    let apart = frames[0].iter().zip(&frames[5]).any(|(a, b)| a != b);
    assert!(apart, "what moves is seen");
}
