//! Light from all sides against closed forms.

mod common;

use tresses::{
    Pipelines, View,
    body::Body,
    frame::Recorder,
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::TriMesh,
    light::{
        Directional, HairSet, Lights, MAX_LIGHTS, Sky, Sphere,
        ambient::{AmbientProbe, Around},
    },
    math::hash::pcg,
    strands::{Strand, StrandBuffers, StrandVertex, vertex::pack_tangent},
    view::{Picture, ViewOptions},
};

/// Half the edge of all cells, metres.
const HALF: f32 = 0.24;
const WHITE: f32 = 0.8;
/// Length of the mean vector of a hemisphere, weighted by the cosine.
const COSINES: f32 = 2.0 / 3.0;

fn random(i: u32, k: u32) -> f32 {
    (pcg(pcg(i) ^ k) >> 8) as f32 / 16_777_216.0
}

struct Bench<'a> {
    gpu: &'a Gpu,
    pipelines: Pipelines,
    view: View,
    hair: Option<HairSet>,
    body: Option<Body>,
    scene: Picture,
}

impl<'a> Bench<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        Self::with_cells(gpu, ViewOptions::default().ambient_cells)
    }

    fn with_cells(gpu: &'a Gpu, ambient_cells: u32) -> Self {
        let options = ViewOptions { samples: 1, shadow_resolution: 256, ambient_cells, ..Default::default() };
        let mut scene = Picture { focus: Sphere { center: Vec3::ZERO, radius: HALF }, ..Default::default() };
        scene.lights =
            Lights { directional: [Directional::OFF; MAX_LIGHTS], sky: Sky::default(), ..Default::default() };
        let pipelines = Pipelines::new(&gpu.device);
        let view = View::new(&gpu.device, &pipelines, &options, [16, 16], 1).expect("fits");
        Self { pipelines, view, gpu, hair: None, body: None, scene }
    }

    fn body(mut self, mesh: &TriMesh) -> Self {
        let cells = self.view.options().ambient_cells;
        let mut body = Body::for_cells(&self.gpu.device, mesh, cells);
        body.material.color = Vec3::splat(WHITE);
        body.material.wrap = 0.0;
        self.body = Some(body);
        self
    }

    /// Straight pieces of hair, each from one point to another.
    fn hair(mut self, pieces: &[[Vec3; 2]], radius: f32) -> Self {
        let Gpu { device, queue, .. } = self.gpu;
        let strands = StrandBuffers::new(device, pieces.len() as u32, 2).expect("fits");
        let vertex =
            |at: Vec3, way: Vec3| StrandVertex { position: at, tangent: pack_tangent(way.normalize(), 1.0) };
        let vertices: Vec<_> =
            pieces.iter().flat_map(|[a, b]| [vertex(*a, *b - *a), vertex(*b, *b - *a)]).collect();
        queue.write_buffer(&strands.vertices, 0, bytemuck::cast_slice(&vertices));
        let info = vec![Strand { radius, seed: 1, root_color: 0, tip_color: 0 }; pieces.len()];
        queue.write_buffer(&strands.strands, 0, bytemuck::cast_slice(&info));
        self.hair = Some(HairSet::new(device, &strands).expect("fits"));
        self
    }

    fn light(mut self, direction: Vec3) -> Self {
        self.scene.lights.directional[0] =
            Directional { direction: direction.normalize(), irradiance: Vec3::splat(std::f32::consts::PI) };
        self
    }

    fn ask(&self, points: &[(Vec3, Vec3)]) -> Vec<Around> {
        let Gpu { device, queue, .. } = self.gpu;
        let probe = AmbientProbe::new(device, queue, &self.view.light, points).expect("fits");
        let mut encoder = device.create_command_encoder(&Default::default());
        let (hair, bodies): (Vec<_>, Vec<_>) = (self.hair.iter().collect(), self.body.iter().collect());
        Recorder { pipelines: &self.pipelines, device, queue, encoder: &mut encoder, timings: None }
            .light(&hair, &bodies, &self.view, &self.scene)
            .expect("it fits");
        probe.record(&mut encoder);
        queue.submit([encoder.finish()]);
        pollster::block_on(probe.read(device, queue)).expect("answers")
    }
}

/// A square across z at `z`, seen from greater z.
fn wall(z: f32) -> TriMesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, z);
    TriMesh {
        positions: vec![corner(-HALF, -HALF), corner(HALF, -HALF), corner(HALF, HALF), corner(-HALF, HALF)],
        normals: vec![Vec3::Z; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Default::default()
    }
}

/// Pieces of hair, turned any way, in a layer across y, `thick` metres about `middle`, of which a ray
/// down meets `fibers` on average.
fn layer(middle: f32, thick: f32, fibers: f32, radius: f32) -> Vec<[Vec3; 2]> {
    let length = 0.01;
    // Of a piece of any direction a ray sees π/4 of its length on average.
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
    let Some(gpu) = common::gpu() else { return };
    let points: Vec<_> = (0..200)
        .map(|i| {
            let at = |k| (2.4 * random(i, k) - 1.2) * HALF;
            (Vec3::new(at(1), at(2), at(3)), Vec3::new(at(4), at(5), at(6)).normalize_or_zero() * 0.6)
        })
        .collect();
    for found in Bench::new(&gpu).light(Vec3::Y).ask(&points) {
        assert!((found.open - 1.0).abs().max_element() < 2e-3 && found.glow == Vec3::ZERO, "{found:?}");
    }
}

/// What is left behind a layer of n fibres of the light of a hemisphere, as a mean over its directions: the
/// exponential integral E₂.
fn mean_behind(n: f64) -> f64 {
    let steps = 4000;
    (0..steps).map(|i| (-n / ((f64::from(i) + 0.5) / f64::from(steps))).exp() / f64::from(steps)).sum()
}

/// The same as a mean over the directions that are followed.
fn mean_followed(n: f64) -> f64 {
    (4.0 * (-n / 0.868_890_3).exp() + 8.0 * (-n / 0.350_021_2).exp()) / 12.0
}

#[test]
fn hair_takes_what_it_should() {
    let Some(gpu) = common::gpu() else { return };
    for fibers in [0.25_f32, 0.5, 1.0, 2.0] {
        let bench = Bench::new(&gpu).hair(&layer(0.06, 0.06, fibers, 1e-3), 1e-3);
        let below: Vec<_> = (0..40)
            .map(|i| {
                (Vec3::new(random(i, 8) - 0.5, 0.0, random(i, 9) - 0.5) * 0.1 + Vec3::Y * 0.01, Vec3::ZERO)
            })
            .collect();
        let found = bench.ask(&below);
        // Fibres that take all, half and an eighth: the lower half of all directions is free.
        for (share, k) in [(1.0, 3), (0.5, 2), (0.125, 1)] {
            let mean = found.iter().map(|around| f64::from(around.open[k])).sum::<f64>() / 40.0;
            let n = share * f64::from(fibers);
            let [exact, followed] = [mean_behind(n), mean_followed(n)].map(|m| 0.5 + 0.5 * m);
            println!("{fibers} fibres, share {share}: {mean:.4}, followed {followed:.4}, exact {exact:.4}");
            assert!((mean - followed).abs() < 0.035 && (mean - exact).abs() < 0.06, "{fibers} {share}");
        }
        let at = Vec3::Y * 0.01;
        let up = bench.ask(&[(at, Vec3::Y * COSINES), (at, Vec3::NEG_Y * COSINES)]);
        assert!(up[0].open.w < up[1].open.w && up[1].open.w > 0.93, "{up:?}");
    }
}

#[test]
fn a_wall_throws_its_form_factor() {
    let Some(gpu) = common::gpu() else { return };
    // Above the middle of the wall; a unit of irradiance times pi makes its radiance the albedo.
    let bench = Bench::new(&gpu).body(&wall(-0.1)).light(Vec3::Z);
    for height in [0.03_f32, 0.06, 0.12, 0.2] {
        let found = bench.ask(&[(Vec3::new(0.0, 0.0, height - 0.1), Vec3::ZERO)])[0];
        // The solid angle of a square from above its middle, over that of the sphere.
        let side = f64::from(HALF);
        let h = f64::from(height);
        let solid = 4.0 * (side * side / (side * side + h * h)).asin();
        let exact = solid / (4.0 * std::f64::consts::PI);
        let share = f64::from(found.glow.x / WHITE);
        println!("{height} m: {share:.4}, exact {exact:.4}, open {:.4}", found.open.x);
        assert!((share - exact).abs() < 0.05, "{height}: {share} {exact}");
        assert!((f64::from(found.open.x) - (1.0 - exact)).abs() < 0.05, "{height}: {found:?}");
    }
    let close = Vec3::new(0.0, 0.0, -0.08);
    let found = bench.ask(&[(close, Vec3::NEG_Z * COSINES), (close, Vec3::Z * COSINES)]);
    assert!((found[0].glow.x / WHITE - 1.0).abs() < 0.12 && found[0].open.x < 0.12, "{found:?}");
    assert!(found[1].glow.x < 0.05 && (found[1].open.x - 1.0).abs() < 0.12, "{found:?}");
    // In its shade, or without light, it throws none.
    let dark = Bench::new(&gpu).body(&wall(-0.1)).light(Vec3::NEG_Z).ask(&[(close, Vec3::ZERO)])[0];
    assert!(dark.glow.x < 1e-3, "{dark:?}");
}

/// Coarse cells take fewer points of a body for the same surface.
#[test]
fn coarse_cells_hold_the_same_body() {
    let Some(gpu) = common::gpu() else { return };
    let at = Vec3::new(0.01, 0.02, 0.02);
    let seen = |cells| {
        let bench = Bench::with_cells(&gpu, cells).body(&wall(-0.1)).light(Vec3::Z);
        bench.ask(&[(at, Vec3::ZERO), (at, Vec3::NEG_Z * COSINES)])
    };
    let fine = seen(24);
    for cells in [12, 16] {
        for (coarse, fine) in seen(cells).iter().zip(&fine) {
            println!("{cells} cells: {coarse:?}, 24: {fine:?}");
            assert!((coarse.open - fine.open).abs().max_element() < 0.04, "{coarse:?} {fine:?}");
            assert!((coarse.glow - fine.glow).abs().max_element() < 0.04 * WHITE, "{coarse:?} {fine:?}");
        }
    }
}

#[test]
fn nothing_gets_through_a_head() {
    let Some(gpu) = common::gpu() else { return };
    // A closed cube, turned so that none of its faces lies along the cells, lit from above.
    let mut cube = common::cube(0.1);
    let turn = Quat::from_rotation_x(0.4) * Quat::from_rotation_y(0.6);
    cube.positions.iter_mut().for_each(|p| *p = turn * *p);
    let bench = Bench::new(&gpu).body(&cube).light(Vec3::Y);
    let found = bench.ask(&[
        (Vec3::ZERO, Vec3::ZERO),
        (Vec3::NEG_Y * 0.21, Vec3::Y * 0.5),
        (Vec3::Y * 0.2, Vec3::NEG_Y * 0.5),
    ]);
    assert!(found[0].open.x < 0.02 && found[0].glow.x < 0.02, "inside {:?}", found[0]);
    assert!(found[1].glow.x < 0.1 * found[2].glow.x, "below {:?}, above {:?}", found[1], found[2]);
}

/// Still scenes are the same to the bit; a slow turn of light or head is answered by slow changes.
#[test]
fn slow_motion_changes_slowly() {
    let Some(gpu) = common::gpu() else { return };
    let mut cube = common::cube(0.08);
    let turn = Quat::from_rotation_x(0.4);
    cube.positions.iter_mut().for_each(|p| *p = turn * *p);
    let pieces = layer(0.15, 0.06, 1.0, 1e-3);
    let mut bench = Bench::new(&gpu).body(&cube).hair(&pieces, 1e-3).light(Vec3::new(0.3, 0.2, 1.0));
    let points: Vec<_> = (0..100)
        .map(|i| {
            let at = Vec3::new(random(i, 1) - 0.5, random(i, 2) - 0.5, random(i, 3) - 0.5).normalize();
            (at * (0.15 + 0.05 * random(i, 4)), Vec3::ZERO)
        })
        .collect();
    assert!(bench.ask(&points) == bench.ask(&points), "a still scene is the same to the bit");
    let frames: Vec<Vec<Around>> = (0..6)
        .map(|i| {
            let angle = 0.25_f32.to_radians() * i as f32;
            bench.body.as_mut().unwrap().pose.rotation = Quat::from_rotation_y(angle);
            bench.scene.lights.directional[0].direction =
                Quat::from_rotation_y(-angle) * Vec3::new(0.3, 0.2, 1.0).normalize();
            bench.ask(&points)
        })
        .collect();
    let mut worst = [0.0_f32; 2];
    for pair in frames.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            worst[0] = worst[0].max((a.open - b.open).abs().max_element());
            worst[1] = worst[1].max((a.glow - b.glow).abs().max_element());
        }
    }
    println!("from frame to frame at most {:.4} of the sky, {:.4} of the radiance", worst[0], worst[1]);
    assert!(worst[0] < 0.02 && worst[1] < 0.02 * WHITE, "{worst:?}");
    let apart = frames[0].iter().zip(&frames[5]).any(|(a, b)| a != b);
    assert!(apart, "what moves is seen");
}
