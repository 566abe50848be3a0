//! The kernels against the twin, closed forms and invariants.

use super::{
    HairHair, HairHairMode, Volume, VolumeOptions, VolumeStage,
    params::VolumeUniforms,
    reference::{CHANNELS, MAX_SPEED, Splatted, splat},
};
use crate::{
    Pose,
    collide::{Collider, ColliderDescriptor, ColliderPoses, ColliderSet, Moments, Shape},
    gpu::{Gpu, for_tests as gpu, readback::blocking as readback},
    simulate::{
        Forces, GuideTraits, RestGuides, RestOptions, Simulate, Simulation, SimulationParams, Step,
        params::Mode, rest,
    },
    strands::{Force, GuideBuffers, GuideForce},
};
use glam::{Quat, Vec3};
use half::f16;

/// Vertices per guide of [`cube`].
const N: usize = 8;

/// Evenly spread guides that fill a cube of 24 cm, each as many strands as its place in the list
/// modulo 5; vertex `i` of guide `g` at `g * N + i`.
fn cube(across: usize) -> (Vec<Vec3>, Vec<GuideTraits>) {
    let mut positions = Vec::new();
    let mut traits = Vec::new();
    for g in 0..across * across {
        let (x, z) = (g % across, g / across);
        let at = |k: usize| 0.24 * (k as f32 + 0.5) / across as f32 - 0.12;
        for i in 0..N {
            positions.push(Vec3::new(at(x), 0.12 - 0.24 * i as f32 / (N - 1) as f32, at(z)));
        }
        traits.push(GuideTraits { strands: 1.0 + (g % 5) as f32, ..Default::default() });
    }
    (positions, traits)
}

struct Scene {
    gpu: Gpu,
    stage: VolumeStage,
    simulate: Simulate,
    guides: GuideBuffers,
    rest: RestGuides,
    volume: Volume,
    forces: Forces,
    colliders: ColliderSet,
    /// Where the colliders are, in the world.
    places: Vec<Pose>,
}

impl Scene {
    fn new((positions, traits): (Vec<Vec3>, Vec<GuideTraits>), options: &VolumeOptions) -> Option<Self> {
        Self::with(positions, traits, N, options, &Default::default())
    }

    fn with(
        positions: Vec<Vec3>,
        traits: Vec<GuideTraits>,
        n: usize,
        options: &VolumeOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Option<Self> {
        let gpu = gpu()?;
        let params = SimulationParams::default();
        let rest =
            rest::guides(&positions, n as u32, &traits, &params, &RestOptions::default(), None).unwrap();
        let guides = GuideBuffers::new(&gpu.device, rest.info.len() as u32, n as u32, 2).unwrap();
        rest.upload(&gpu.queue, &guides).unwrap();
        let stage = VolumeStage::new(&gpu.device);
        let simulate = Simulate::new(&gpu.device);
        let volume = Volume::new(&gpu.device, &stage, &guides, &rest, options).unwrap();
        let forces = Forces::new(&gpu.device, &simulate, &guides, &volume, None);
        let colliders = ColliderSet::new(&gpu.device, &gpu.queue, colliders).unwrap();
        Some(Self { gpu, stage, simulate, guides, rest, volume, forces, colliders, places: Vec::new() })
    }

    /// Vertex-major, from the rest positions.
    fn moved(&self, place: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        self.rest.rest.iter().map(|r| place(r.position)).collect()
    }

    fn put(&self, current: &[Vec3], velocity: &[Vec3]) {
        let write = |buffer, values: &[Vec3]| {
            let values: Vec<[f32; 4]> = values.iter().map(|v| v.extend(0.0).into()).collect();
            self.gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&values));
        };
        write(&self.guides.current, current);
        write(&self.guides.velocity, velocity);
    }

    fn submit(&mut self, record: impl FnOnce(&mut Self, &mut wgpu::ComputePass<'_>)) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        record(self, &mut encoder.begin_compute_pass(&Default::default()));
        self.gpu.queue.submit([encoder.finish()]);
    }

    fn prepare(&mut self, params: &HairHair, step: &Step) {
        let params = SimulationParams { hair_hair: *params, step: H, ..Default::default() };
        let steps = [*step];
        let moments =
            Moments { steps: &steps, substeps: params.substeps, step: H, head: step.end, alpha: 1.0 };
        let poses = ColliderPoses { head: None, colliders: self.places.clone() };
        self.colliders.advance(&self.gpu.queue, &poses, &moments).unwrap();
        self.volume.prepare(&self.gpu.queue, &params, &steps, &self.colliders);
    }

    /// The integers after `splat` alone; zeroed again.
    fn splatted(&mut self, step: &Step) -> Vec<i32> {
        self.prepare(&HairHair::default(), step);
        self.submit(|scene, pass| {
            let workgroups = (scene.volume.base.splat_count * scene.volume.base.samples).div_ceil(64);
            scene.stage.splat.record(pass, &scene.volume.groups.splat, &[0], workgroups);
        });
        let cells = readback::buffer(&self.gpu.device, &self.gpu.queue, &self.volume.cells).unwrap();
        self.submit(|scene, pass| scene.volume.grids(&scene.stage, pass, 0));
        let clear: Vec<i32> =
            readback::buffer(&self.gpu.device, &self.gpu.queue, &self.volume.cells).unwrap();
        assert!(clear.iter().all(|i| *i == 0), "a step leaves the integers at zero");
        cells
    }

    /// The forces on all vertices when the head moves by `step`.
    fn forces(&mut self, params: &HairHair, step: &Step) -> Vec<Force> {
        self.prepare(params, step);
        self.submit(|scene, pass| {
            scene.volume.record(&scene.stage, pass, &scene.colliders, 0);
            scene.forces.record(&scene.simulate, pass, 0);
        });
        let forces: Vec<GuideForce> =
            readback::buffer(&self.gpu.device, &self.gpu.queue, &self.guides.forces).unwrap();
        forces.iter().map(GuideForce::unpack).collect()
    }

    fn texture(&self, texture: &wgpu::Texture) -> Vec<[f32; 4]> {
        let bytes = readback::texture(&self.gpu.device, &self.gpu.queue, texture).unwrap();
        bytemuck::pod_collect_to_vec::<u8, [f16; 4]>(&bytes).iter().map(|t| t.map(f16::to_f32)).collect()
    }
}

/// Length of a step.
const H: f32 = 1.0 / 60.0;

fn still(pose: Pose) -> Step {
    Step { mode: Mode::Step, begin: pose, end: pose, from: 0.0, to: 1.0 }
}

fn somewhere() -> Pose {
    Pose {
        rotation: Quat::from_rotation_y(0.7) * Quat::from_rotation_x(-0.4),
        translation: Vec3::new(3.0, 1.5, -2.0),
    }
}

fn swirl(p: Vec3) -> Vec3 {
    Vec3::new(2.0 * p.z - 0.3, (20.0 * p.x).sin(), 5.0 * p.y)
}

#[test]
fn the_splat_conserves_hair_and_momentum_and_is_its_twin() {
    let Some(mut scene) = Scene::new(cube(12), &Default::default()) else { return };
    let pose = somewhere();
    let current = scene.moved(|p| pose.point(0.9 * p + Vec3::new(0.01, 0.0, 0.02)));
    let velocity = scene.moved(swirl);
    scene.put(&current, &velocity);
    let found = scene.splatted(&still(pose));

    let g = scene.volume.base;
    let mass = |i: usize| {
        let (v, info) = (i / 144, &scene.rest.info[i % 144]);
        let end = if v == 0 || v + 1 == N { 0.5 } else { 1.0 };
        info.strands * info.length / (N - 1) as f32 * end
    };
    let total = |channel: usize| found.chunks(CHANNELS).map(|c| f64::from(c[channel])).sum::<f64>();
    let metres: f64 = (0..144 * N).map(|i| f64::from(mass(i))).sum();
    let hair = total(3) / f64::from(g.units);
    println!("{metres} m of hair, {hair} m in the grid");
    assert!((hair / metres - 1.0).abs() < 1e-5);
    for axis in 0..3 {
        let exact: f64 = velocity.iter().enumerate().map(|(i, v)| f64::from(mass(i) * v[axis])).sum();
        let momentum = total(axis) * f64::from(MAX_SPEED) / f64::from(g.units);
        println!("momentum {axis}: {exact} m²/s, {momentum} in the grid");
        assert!((momentum - exact).abs() < 2e-6 * metres, "{axis}");
    }

    let compare = |disturb: f32| {
        let uniforms =
            VolumeUniforms { head: pose.rotation.into(), head_at: pose.translation, ..scene.volume.base };
        let mut velocity = velocity.clone();
        velocity[100].y += disturb;
        let hair = Splatted {
            info: &scene.rest.info,
            current: &current,
            velocity: &velocity,
            rested: &vec![0.0; current.len()],
        };
        let twin = splat(&uniforms, &hair);
        // Weights differ by the rounding of places: 1e-6 m in 1e-2 m.
        found.iter().zip(&twin).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
            / (f64::from(g.units) * metres)
    };
    println!("kernel and twin differ by {:e} of all hair", compare(0.0));
    assert!(compare(0.0) < 1e-6);
    assert!(compare(1.0) > 1e-6, "the comparison sees one vertex that is 1 m/s faster");
}

#[test]
fn the_order_of_guides_does_not_change_a_bit() {
    let (positions, traits) = cube(12);
    let Some(mut scene) = Scene::new((positions.clone(), traits.clone()), &Default::default()) else {
        return;
    };
    let backwards = positions.chunks(N).rev().flatten().copied().collect();
    let mut other = Scene::new((backwards, traits.into_iter().rev().collect()), &Default::default()).unwrap();
    for scene in [&mut scene, &mut other] {
        scene.put(&scene.moved(|p| 0.8 * p), &scene.moved(swirl));
    }
    let step = still(Pose::IDENTITY);
    let first = scene.splatted(&step);
    assert_eq!(first, other.splatted(&step));
    assert_eq!(first, scene.splatted(&step));
    scene.put(&scene.moved(|p| 0.8 * p + Vec3::X * 1e-4), &scene.moved(swirl));
    assert_ne!(first, scene.splatted(&step));
}

#[test]
fn at_rest_nothing_pushes_wherever_the_head_is() {
    let Some(mut scene) = Scene::new(cube(12), &Default::default()) else { return };
    for pose in [Pose::IDENTITY, somewhere()] {
        scene.put(&scene.moved(|p| pose.point(p)), &scene.moved(|_| Vec3::ZERO));
        let forces = scene.forces(&HairHair::default(), &still(pose));
        assert!(forces.iter().all(|f| f.acceleration == Vec3::ZERO));
        // It is there: friction would hold whatever moves.
        assert!(forces.iter().any(|f| f.rate > 1.0));
    }
    // And a lock that moves as a whole is not blown up: this much of it leaves the grid.
    scene.put(&scene.moved(|p| p + Vec3::X * 0.1), &scene.moved(|_| Vec3::ZERO));
    let forces = scene.forces(&HairHair::default(), &still(Pose::IDENTITY));
    let worst = forces.iter().map(|f| f.acceleration.length()).fold(0.0, f32::max);
    assert!(worst < 0.5, "{worst} m/s²");
}

/// The outward part of the push, mean over vertices 3 to 7 cm from the middle, and the part across.
fn outward(scene: &mut Scene, params: &HairHair, shrink: f32) -> (f32, f32) {
    let current = scene.moved(|p| shrink * p);
    scene.put(&current, &scene.moved(|_| Vec3::ZERO));
    let forces = scene.forces(params, &still(Pose::IDENTITY));
    let judged: Vec<_> = current
        .iter()
        .zip(&forces)
        .filter(|(p, _)| (0.03..0.07).contains(&p.length()))
        .map(|(p, f)| {
            let out = f.acceleration.dot(p.normalize());
            (out, (f.acceleration - out * p.normalize()).length())
        })
        .collect();
    assert!(judged.len() > 50);
    let mean = |pick: fn(&(f32, f32)) -> f32| judged.iter().map(pick).sum::<f32>() / judged.len() as f32;
    (mean(|j| j.0), mean(|j| j.1))
}

#[test]
fn hair_that_is_pressed_together_is_pushed_apart() {
    let Some(mut scene) = Scene::new(cube(16), &Default::default()) else { return };
    let gradient = HairHair { friction: 0.0, ..Default::default() };
    let (out, across) = outward(&mut scene, &gradient, 0.5);
    println!("half the size: {out} m/s² outwards, {across} across");
    assert!(out > 1.0 && across < 0.7 * out);
    let (loose, _) = outward(&mut scene, &gradient, 1.3);
    assert!(loose.abs() < 0.01, "hair that spread is left alone: {loose}");
    let fixed = HairHair { mode: HairHairMode::Fixed, ..Default::default() };
    let (out, _) = outward(&mut scene, &fixed, 0.5);
    println!("fixed magnitude: {out} m/s² outwards of {}", fixed.fixed);
    assert!(out > 0.3 && out <= fixed.fixed);
}

#[test]
fn an_obstacle_that_comes_into_hair_presses_it_away() {
    let ball = [Collider::new(Shape::sphere(0.05))];
    let what = ColliderDescriptor { colliders: &ball, ..Default::default() };
    let (positions, traits) = cube(16);
    let Some(mut scene) = Scene::with(positions, traits, N, &Default::default(), &what) else { return };
    let pose = somewhere();
    let params = HairHair { friction: 0.0, ..Default::default() };
    let center = Vec3::new(0.04, 0.0, -0.03);
    let mut ball_at = |local: Vec3, mode: Mode| {
        scene.places = vec![Pose { translation: pose.point(local), ..Pose::IDENTITY }];
        let current = scene.moved(|p| pose.point(p));
        scene.put(&current, &scene.moved(|_| Vec3::ZERO));
        let forces = scene.forces(&params, &Step { mode, ..still(pose) });
        let rest = scene.moved(|p| p);
        let shell = rest.iter().zip(&forces).filter(|(p, _)| (0.05..0.065).contains(&p.distance(center)));
        let out: Vec<_> =
            shell.map(|(p, f)| f.acceleration.dot(pose.rotation * (*p - center).normalize())).collect();
        assert!(out.len() > 20);
        out.iter().sum::<f32>() / out.len() as f32
    };
    let away = ball_at(Vec3::X, Mode::Step);
    let inside = ball_at(center, Mode::Step);
    println!("{away} m/s² without the ball, {inside} around it");
    assert!(away.abs() < 1e-3 && inside > 0.3);
    // Where it is when the hair is put to rest, it belongs to the rest.
    ball_at(center, Mode::Reset);
    let rested = ball_at(center, Mode::Step);
    assert!(rested.abs() < 1e-3, "{rested}");
}

#[test]
fn the_push_does_not_depend_on_the_resolution() {
    // The blur of 2 cm is wider than the guides' spacing and than the cells.
    let params = HairHair { friction: 0.0, blur: 0.025, ..Default::default() };
    let pushes = [24, 32, 64].map(|resolution| {
        let options = VolumeOptions { resolution, ..Default::default() };
        Scene::new(cube(24), &options).map(|mut scene| outward(&mut scene, &params, 0.6).0)
    });
    let [Some(a), Some(b), Some(c)] = pushes else { return };
    println!("{a}, {b}, {c} m/s² with 24, 32 and 64 cells");
    assert!((a / c - 1.0).abs() < 0.1 && (b / c - 1.0).abs() < 0.05);
}

#[test]
fn the_velocity_of_a_cell_is_that_of_its_hair() {
    let Some(mut scene) = Scene::new(cube(16), &Default::default()) else { return };
    // A head that moves as fast as a car does not reach the limit of what is splatted.
    let way = Vec3::new(50.0, 0.0, 1.0);
    let (begin, end) = (Pose::IDENTITY, Pose { translation: way * H, ..Pose::IDENTITY });
    let own = |p: Vec3| way + 3.0 * Vec3::new(p.y, -p.x, 0.0);
    scene.put(&scene.moved(|p| p), &scene.moved(own));
    let params = HairHair { friction: 10.0, ..Default::default() };
    scene.forces(&params, &Step { mode: Mode::Step, begin, end, from: 0.0, to: 1.0 });
    let grid = scene.volume.grid;
    let texels = scene.texture(&scene.volume.hair_texture);
    let n = grid.resolution as usize;
    let (mut worst, mut metres, mut count) = (0f32, 0.0, 0);
    for (i, texel) in texels.iter().enumerate() {
        let c = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) + 0.5;
        let p = grid.origin + c * grid.cell;
        metres += texel[3] * grid.cell.powi(3) * 1e3;
        if p.abs().max_element() < 0.08 {
            worst = worst.max(Vec3::from_slice(texel).distance(own(p)));
            count += 1;
        }
    }
    println!("{count} cells, {worst} m/s off at most; {metres} m of hair");
    // Guides 1.5 cm apart of different weights in a flow that changes by 3 m/s per m: 45 mm/s.
    assert!(count > 500 && worst < 0.08);
    let exact: f32 = scene.rest.info.iter().map(|i| i.strands * i.length).sum();
    // The blur's tail beyond the grid is lost: here the hair fills it to its margins.
    assert!((metres / exact - 1.0).abs() < 0.02, "{metres} of {exact}");
}

#[test]
fn hair_outside_of_the_grid_and_what_is_no_number_harm_nothing() {
    let Some(mut scene) = Scene::new(cube(12), &Default::default()) else { return };
    let mut current = scene.moved(|p| 0.6 * p);
    let velocity = scene.moved(|_| Vec3::ZERO);
    let step = still(Pose::IDENTITY);
    let wrong = [Vec3::X * 1e3, Vec3::splat(-1e30), Vec3::Y * f32::INFINITY, Vec3::NAN];
    // Once far away but harmless, once as bad as can be: all others feel the same.
    let forces = [[Vec3::X * 2.0; 4], wrong].map(|bad| {
        current[..4].copy_from_slice(&bad);
        scene.put(&current, &velocity);
        let forces = scene.forces(&HairHair::default(), &step);
        assert!(forces[..4].iter().all(|f| f.acceleration == Vec3::ZERO && f.rate == 0.0), "{bad:?}");
        forces
    });
    assert_eq!(forces[0], forces[1]);
    assert!(forces[0].iter().any(|f| f.acceleration.length() > 1.0));
}

#[test]
fn every_other_guide_stands_for_two() {
    let few = VolumeOptions { most_splatted: 24 * 24 * N as u32 / 3, ..Default::default() };
    let params = HairHair { friction: 0.0, ..Default::default() };
    let all = VolumeOptions { most_splatted: u32::MAX, ..Default::default() };
    let pushes = [all, few].map(|options| {
        Scene::new(cube(24), &options).map(|mut scene| {
            assert_eq!(scene.volume.base.stride, if options == few { 3 } else { 1 });
            outward(&mut scene, &params, 0.5).0
        })
    });
    let [Some(all), Some(some)] = pushes else { return };
    println!("{all} m/s² with all guides, {some} with a third");
    assert!((some / all - 1.0).abs() < 0.1);
}

#[test]
fn resolutions_out_of_range_are_refused() {
    let Some(gpu) = gpu() else { return };
    let stage = VolumeStage::new(&gpu.device);
    let guides = GuideBuffers::new(&gpu.device, 1, 2, 2).unwrap();
    for resolution in [0, 7, 97, u32::MAX] {
        let options = VolumeOptions { resolution, ..Default::default() };
        let error = Volume::new(&gpu.device, &stage, &guides, &RestGuides::default(), &options).unwrap_err();
        assert!(error.to_string().contains("grid resolution"));
    }
}

/// A thousand guides of [`LONG`] vertices that hang from a ball, their edges 1 cm.
fn lock() -> Vec<Vec3> {
    let mut seed = 1u32;
    let mut random = || {
        seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    (0..1000)
        .flat_map(|_| {
            let root = 0.1 * Vec3::new(random() - 0.5, random(), random() - 0.5).normalize();
            let side = Vec3::new(random() - 0.5, 0.0, random() - 0.5) * 0.002;
            (0..LONG).map(move |i| root + (Vec3::NEG_Y * 0.01 + side) * i as f32).collect::<Vec<_>>()
        })
        .collect()
}

/// Vertices of the guides of [`lock`].
const LONG: usize = 32;

#[test]
fn samples_of_two_vertices_are_as_good_as_all_of_them() {
    let step = still(Pose::IDENTITY);
    // What is left out with respect to all vertices: of density, momentum and push, root of mean square.
    let grids = |most_splatted: u32, together: u32| {
        let options =
            VolumeOptions { most_splatted: most_splatted * LONG.div_ceil(2) as u32, ..Default::default() };
        let mut scene = Scene::with(lock(), Vec::new(), LONG, &options, &Default::default())?;
        let base = &mut scene.volume.base;
        assert_eq!(base.vertices_per_sample, 2);
        (base.vertices_per_sample, base.samples) = (together, (LONG as u32).div_ceil(together));
        // Waves, pressed together.
        let place = |p: Vec3| 0.8 * p + 0.02 * Vec3::new((40.0 * p.y).sin(), 0.0, (33.0 * p.y + p.x).cos());
        scene.put(&scene.moved(place), &scene.moved(swirl));
        scene.forces(&HairHair::default(), &step);
        let push = scene.texture(&scene.volume.push_texture);
        let hair = scene.texture(&scene.volume.hair_texture);
        let values = |pick: fn(&[f32; 4]) -> Vec3, of: &[[f32; 4]]| of.iter().map(pick).collect::<Vec<_>>();
        Some([
            values(|t| Vec3::X * t[3], &hair),
            values(|t| t[3] * Vec3::from_slice(t), &hair),
            values(|t| Vec3::from_slice(t), &push),
        ])
    };
    let Some(all) = grids(1000, 1) else { return };
    let off = |guides, together| {
        let some = grids(guides, together).unwrap();
        [0, 1, 2].map(|i| {
            let square = |v: Vec3| f64::from(v.length_squared());
            let wrong: f64 = all[i].iter().zip(&some[i]).map(|(a, b)| square(*a - *b)).sum();
            (wrong / all[i].iter().map(|a| square(*a)).sum::<f64>()).sqrt()
        })
    };
    let [same, pairs, quarter, both] = [off(1000, 1), off(1000, 2), off(250, 1), off(250, 2)];
    println!(
        "density, momentum, push off by: pairs {pairs:.4?}, a quarter of the guides {quarter:.4?}, both {both:.4?}"
    );
    assert_eq!(same, [0.0; 3]);
    for i in 0..3 {
        assert!(pairs[i] < [0.02, 0.02, 0.05][i], "{i}");
        assert!(both[i] < 1.05 * quarter[i], "{i}");
    }
}

/// Milliseconds of the quickest of 40 runs, each waited for.
fn quickest(scene: &mut Scene, mut record: impl FnMut(&mut Scene, &mut wgpu::ComputePass<'_>)) -> f64 {
    (0..40)
        .map(|_| {
            let start = std::time::Instant::now();
            scene.submit(&mut record);
            scene.gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            start.elapsed().as_secs_f64() * 1e3
        })
        .fold(f64::MAX, f64::min)
}

/// `cargo test -p tresses --lib volume -- --ignored --nocapture cost`
#[test]
#[ignore = "a measurement"]
fn cost_of_a_thousand_guides() {
    let n = LONG;
    for resolution in [32, 64] {
        let positions = lock();
        let options = VolumeOptions { resolution, ..Default::default() };
        let Some(mut scene) = Scene::with(positions, Vec::new(), n, &options, &Default::default()) else {
            return;
        };
        let step = still(Pose::IDENTITY);
        scene.forces(&HairHair::default(), &step);
        // Again: now the obstacles rest.
        scene.prepare(&HairHair::default(), &step);
        let params = SimulationParams::default();
        let mut solve = Simulation::new(&scene.gpu.device, &scene.simulate, &scene.guides);
        solve.prepare(&scene.gpu.queue, &params, &[step], false).unwrap();
        let device = scene.gpu.device.clone();
        let nothing = quickest(&mut scene, |_, _| ());
        let solve =
            quickest(&mut scene, |s, pass| solve.record_step(&s.simulate, &device, pass, &s.colliders, 0));
        let splat = quickest(&mut scene, |s, pass| {
            let workgroups = (s.volume.base.splat_count * s.volume.base.samples).div_ceil(64);
            s.stage.splat.record(pass, &s.volume.groups.splat, &[0], workgroups);
        });
        for (i, name) in ["sum", "blur_x", "blur_y", "density", "push"].iter().enumerate() {
            let ms = quickest(&mut scene, |s, pass| {
                let (stage, groups) = (&s.stage, &s.volume.groups);
                let (kernel, group, cells) = [
                    (&stage.sum, &groups.sum, [1, 1, 1]),
                    (&stage.blur[0], &groups.blur[0], [4, 1, 1]),
                    (&stage.blur[1], &groups.blur[1], [1, 4, 1]),
                    (&stage.density, &groups.density, [1, 1, 4]),
                    (&stage.push, &groups.push, [1, 1, 1]),
                ][i];
                kernel.record_grid(pass, group, &[0], s.volume.tiles(cells));
            });
            println!("  {name} {:.2} ms", ms - nothing);
        }
        let grid = quickest(&mut scene, |s, pass| s.volume.record(&s.stage, pass, &s.colliders, 0));
        let forces = quickest(&mut scene, |s, pass| s.forces.record(&s.simulate, pass, 0));
        println!(
            "{resolution}³, 1,000 guides of 32: solve {:.2} ms; splat {:.2}, whole volume {:.2}, forces {:.2}",
            solve - nothing,
            splat - nothing,
            grid - nothing,
            forces - nothing,
        );
    }
}
