//! The step among colliders and under forces: both tiers agree, runs are bit-identical, edges keep their length. Closed
//! forms: `tests/stages/physics`.

use super::{GuideTraits, RestOptions, Simulation, SimulationParams, rest};
use crate::{
    Context, Pose,
    clock::{Mode, Step},
    collide::{
        Anchor, Collider, ColliderDescriptor, ColliderPoses, ColliderSet, FieldId, FieldSource, Moments,
        Shape, shape,
    },
    gpu::{Tier, for_tests as context, readback::blocking as readback},
    groom::SdfGrid,
    strands::{Force, GuideBuffers, GuideForce, RestGuides},
    wind::Wind,
};
use glam::{Quat, Vec3};

fn random(seed: &mut u32) -> f32 {
    *seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*seed >> ((*seed >> 28) + 4)) ^ *seed).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / u32::MAX as f32
}

/// The guide of [`groom`] that has a segment of zero length.
const DEGENERATE: usize = 4;

/// Hair on a sphere of 9 cm, some of it wavy, plus a few special cases.
fn groom(count: usize, n: usize) -> (Vec<Vec3>, Vec<GuideTraits>) {
    let mut seed = 7;
    let mut positions = Vec::new();
    let mut traits = Vec::new();
    for g in 0..count {
        let a = g as f32 * 2.399_963;
        let z = 0.1 + 0.9 * random(&mut seed);
        let r = (1.0 - z * z).sqrt();
        let normal = Vec3::new(r * a.cos(), z, r * a.sin());
        let length = 0.05 + 0.25 * random(&mut seed);
        let wave = 0.4 * random(&mut seed) * length / (n - 1) as f32;
        let mut at = normal * 0.09;
        let mut dir = normal;
        for i in 0..n {
            positions.push(at + normal.any_orthonormal_vector() * wave * (i as f32).sin());
            dir = (dir + Vec3::NEG_Y * 0.2).normalize();
            at += dir * length / (n - 1) as f32;
        }
        traits.push(GuideTraits { stiffness: 0.5 + random(&mut seed), ..Default::default() });
    }
    traits[0].is_tip_pinned = true;
    traits[1].stiffness = 0.0;
    // An upright hair, one of 2 mm, one with a segment of zero length.
    for i in 0..n {
        positions[2 * n + i] = Vec3::Y * (0.09 + 0.15 * i as f32 / (n - 1) as f32);
        positions[3 * n + i] = Vec3::Y * (0.09 + 0.002 * i as f32 / (n - 1) as f32);
    }
    positions[DEGENERATE * n + n / 2] = positions[DEGENERATE * n + n / 2 - 1];
    (positions, traits)
}

fn sphere() -> SdfGrid {
    SdfGrid::from_fn(Vec3::splat(-0.15), Vec3::splat(0.15), 48, |p| p.length() - 0.09)
}

fn pose(t: f32) -> Pose {
    Pose {
        rotation: Quat::from_rotation_y(0.9 * (4.0 * t).sin()) * Quat::from_rotation_x(0.3 * (5.0 * t).sin()),
        translation: Vec3::new(0.05 * (3.0 * t).sin(), 1.6, 0.0),
    }
}

/// A capsule below the head, an ellipsoid and a box that rotate in front of it, and a box at its side.
fn shapes() -> [Collider; 4] {
    [
        Collider { friction: 0.7, ..Collider::new(Shape::Capsule { half_length: 0.2, radius: 0.06 }) },
        Collider::new(Shape::Ellipsoid { radii: Vec3::new(0.03, 0.06, 0.05) }),
        Collider::new(Shape::Field(FieldId(1))),
        Collider { anchor: Anchor::Head, ..Collider::new(Shape::Field(FieldId(1))) },
    ]
}

/// The poses of [`shapes`] at time `t`.
fn hands(t: f32) -> ColliderPoses {
    let still = pose(0.0).translation;
    let at = |rotation, x, y, z| Pose { rotation, translation: still + Vec3::new(x, y, z) };
    ColliderPoses {
        head: None,
        colliders: vec![
            at(Quat::from_rotation_z(1.57 + 0.1 * t), 0.0, -0.2 + 0.1 * t, 0.01),
            at(Quat::from_rotation_x(9.0 * t), 0.02, 0.0, 0.13 - 0.5 * t),
            at(Quat::from_rotation_y(5.0 * t), -0.05 - 0.3 * t, -0.05, 0.12),
            Pose { rotation: Quat::from_rotation_x(0.5), translation: Vec3::new(0.13, 0.0, 0.01) },
        ],
    }
}

/// A box of 6 cm with rounded edges.
fn dice() -> SdfGrid {
    SdfGrid::from_fn(Vec3::splat(-0.05), Vec3::splat(0.05), 24, |p| {
        let q = p.abs() - 0.025;
        q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - 0.005
    })
}

struct Setup {
    guides: GuideBuffers,
    simulation: Simulation,
    colliders: ColliderSet,
}

/// Returns the rest state of [`groom`].
fn resting(n: usize, params: &SimulationParams, head: Option<&SdfGrid>) -> RestGuides {
    let (positions, traits) = groom(24, n);
    rest::guides(&positions, n as u32, &traits, params, &RestOptions::default(), head).unwrap()
}

impl Setup {
    /// Creates the groom on a head that is a sphere.
    fn new(context: &Context, rest: &RestGuides, head: &SdfGrid) -> Self {
        Self::among(context, rest, &ColliderDescriptor { head: Some(head), ..Default::default() })
    }

    fn among(context: &Context, rest: &RestGuides, what: &ColliderDescriptor<'_>) -> Self {
        let mut guides = GuideBuffers::new(context, rest.info.len() as u32, rest.vertex_count, 2).unwrap();
        guides.add_twist(context).unwrap();
        rest.upload(context, &guides).unwrap();
        let colliders = ColliderSet::new(context, what).unwrap();
        let simulation = Simulation::new(context, &guides);
        Self { guides, simulation, colliders }
    }

    fn run(
        &mut self,
        context: &Context,
        params: &SimulationParams,
        steps: &[Step],
        poses: &ColliderPoses,
        forced: bool,
    ) {
        let (substeps, step) = (params.substep_count, params.step);
        let head = steps.last().unwrap().end;
        let moments = Moments { steps, substeps, step, head, alpha: 1.0 };
        self.colliders.advance(poses, &moments).unwrap();
        let count = self.simulation.prepare(params, steps, forced).unwrap();
        crate::gpu::compute(context, |pass| {
            (0..count).for_each(|i| self.simulation.record(pass, &self.colliders, i));
        });
    }

    /// Runs one step without colliders and forces, in which the head moves as in `step`.
    fn step(&mut self, context: &Context, params: &SimulationParams, step: Step) {
        self.run(context, params, &[step], &ColliderPoses::default(), false);
    }

    fn positions(&self, context: &Context) -> Vec<Vec3> {
        let read: Vec<[f32; 4]> = readback::buffer(context, &self.guides.current).unwrap();
        read.iter().map(|p| Vec3::from_slice(p)).collect()
    }
}

fn at(t: f32, dt: f32) -> Step {
    Step { mode: Mode::Step, begin: pose(t), end: pose(t + dt), from: 0.0, to: 1.0 }
}

fn carry_to_start() -> Step {
    Step { mode: Mode::Reset, begin: pose(0.0), end: pose(0.0), from: 0.0, to: 1.0 }
}

/// Returns forces for every guide, some along the strand only, some with a rate that no explicit step would survive;
/// vertex-major.
fn outer_forces(n: usize, count: usize) -> Vec<GuideForce> {
    (0..n * count)
        .map(|at| {
            let (i, g) = (at / count, at % count);
            let mut seed = g as u32;
            let mut axis = || 2.0 * random(&mut seed) - 1.0;
            let rate = [0.0, 4.0, 300.0][g % 3] * axis().abs();
            let wind = Vec3::new(axis(), axis(), axis()) * (1.0 + i as f32 / n as f32);
            GuideForce::pack(&Force {
                acceleration: wind * (rate + 1.0),
                rate,
                tangent: Vec3::new(axis(), axis(), axis()).normalize(),
                along: 20.0 * axis().abs(),
            })
        })
        .collect()
}

/// Returns the positions after `frames` steps among colliders and under forces, without the guide whose zero segment
/// has the direction of a rounding error. The collider `shifted` is displaced by a millimeter along each axis.
fn moved(
    context: &Context,
    n: usize,
    frames: usize,
    params: &SimulationParams,
    shifted: Option<usize>,
) -> Vec<Vec3> {
    let (sphere, dice, list) = (sphere(), dice(), shapes());
    let rest = resting(n, params, Some(&sphere));
    // An unused field must not matter: it only shifts the tiles.
    let fields = [&sphere, &dice].map(FieldSource::Grid);
    let what =
        ColliderDescriptor { head: Some(&sphere), fields: &fields, colliders: &list, ..Default::default() };
    let mut scene = Setup::among(context, &rest, &what);
    let count = rest.info.len();
    context.queue().write_buffer(&scene.guides.forces, 0, bytemuck::cast_slice(&outer_forces(n, count)));
    for frame in 0..=frames {
        let t = (frame.max(1) - 1) as f32 * params.step;
        let step = if frame == 0 { carry_to_start() } else { at(t, params.step) };
        let mut hands = hands(t + params.step);
        if let Some(i) = shifted {
            hands.colliders[i].translation += Vec3::splat(1e-3);
        }
        scene.run(context, params, &[step], &hands, true);
    }
    let found = scene.positions(context).into_iter().enumerate();
    found.filter(|(i, _)| i % count != DEGENERATE).map(|(_, p)| p).collect()
}

fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert!(a.len() == b.len() && a.iter().all(|p| p.is_finite()));
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Returns contexts with the kernels for software drivers and with those for GPUs.
fn tiers() -> Option<[Context; 2]> {
    let own = context()?;
    Some([true, false].map(|software| own.clone().with_tier(Tier { software, ..own.tier() })))
}

/// Factor of the tolerances on a GPU, whose compiler may contract the two kernels differently. Not measured yet.
const GPU_TOLERANCE: f32 = 10.0;

/// Compares the kernels of both tiers after 4 steps, for each number of vertices with its tolerance on software
/// drivers, meters.
fn agree(twist: f32, cases: &[(usize, f32)]) {
    let Some(tiers) = tiers() else { return };
    let is_software = context().is_some_and(|context| context.tier().software);
    let factor = if is_software { 1.0 } else { GPU_TOLERANCE };
    let params = SimulationParams { twist, ..SimulationParams::default() };
    for (n, tolerance) in cases {
        let [a, b] = tiers.each_ref().map(|context| moved(context, *n, 4, &params, None));
        println!("{n} vertices, twist {twist}: differ by {} m after 4 steps", apart(&a, &b));
        assert!(apart(&a, &b) < factor * tolerance, "{n}: {}", apart(&a, &b));
    }
}

#[test]
fn kernels_of_both_tiers_agree() {
    agree(0.0, &[(5, 2e-6), (12, 5e-5), (16, 5e-5)]);
    agree(0.5, &[(2, 1e-6), (3, 1e-6), (5, 2e-6), (16, 5e-5)]);
}

/// A software driver compiles the kernels of long guides for a minute.
#[test]
#[ignore = "proof"]
fn kernels_of_long_guides_agree() {
    for twist in [0.0, 0.5] {
        agree(twist, &[(24, 1e-4), (32, 3e-4), (64, 4e-3)]);
    }
}

#[test]
fn each_collider_acts_and_runs_are_bit_identical() {
    let params = SimulationParams::default();
    for context in tiers().iter().flatten() {
        let run = |shifted| moved(context, 16, 20, &params, shifted);
        let found = run(None);
        assert_eq!(found, run(None));
        for i in 0..shapes().len() {
            let off = apart(&found, &run(Some(i)));
            println!("collider {i} aside by 1.7 mm: {off} m");
            assert!(off > 1e-4, "collider {i}: {off}");
        }
    }
}

#[test]
fn draped_hair_lies_on_the_sphere() {
    let Some(context) = context() else { return };
    let params = SimulationParams::default();
    let n = 16;
    let (positions, traits) = groom(24, n);
    let grid = sphere();
    let start = std::time::Instant::now();
    let options = crate::drape::DrapeOptions { clearance: 0.002, ..Default::default() };
    let settled = pollster::block_on(crate::drape::drape(
        context,
        &positions,
        n as u32,
        &traits,
        &params,
        Some(&grid),
        &options,
    ))
    .unwrap();
    println!("draped in {:?}", start.elapsed());
    assert_eq!(settled.len(), positions.len());
    // The roots start in the skin; vertices from the fifth on must be outside.
    let deepest =
        settled.chunks(n).flat_map(|strand| &strand[4..]).map(|p| p.length() - 0.09).fold(f32::MAX, f32::min);
    println!("deepest {deepest} m");
    assert!(deepest > 5e-4);
    let drop: f32 =
        settled.iter().zip(&positions).map(|(a, b)| b.y - a.y).sum::<f32>() / settled.len() as f32;
    assert!(drop > 0.01, "{drop}");
}

#[test]
fn hair_lies_on_a_collider_of_any_shape() {
    let Some(context) = context() else { return };
    let params = SimulationParams { drag: 6.0, ..Default::default() };
    let rest = resting(16, &params, None);
    let (dice, radii) = (dice(), Vec3::new(0.05, 0.03, 0.04));
    type Distance<'a> = &'a dyn Fn(Vec3) -> f32;
    let cases: [(Shape, Distance<'_>); 3] = [
        (Shape::Capsule { half_length: 0.03, radius: 0.03 }, &|p| shape::capsule(p, 0.03, 0.03).w),
        (Shape::Ellipsoid { radii }, &|p| shape::ellipsoid(p, radii).w),
        (Shape::Field(FieldId(0)), &|p| dice.sample(p)),
    ];
    for (shape, distance) in cases {
        let list = [Collider::new(shape)];
        let what = ColliderDescriptor {
            fields: &[FieldSource::Grid(&dice)],
            colliders: &list,
            ..Default::default()
        };
        let mut scene = Setup::among(context, &rest, &what);
        // Beside the head, so that hair falls onto it.
        let place = Pose { translation: Vec3::new(0.15, 0.03, 0.0), rotation: Quat::from_rotation_z(0.4) };
        let poses = ColliderPoses { head: None, colliders: vec![place] };
        let still = Step { begin: Pose::IDENTITY, end: Pose::IDENTITY, ..at(0.0, 0.0) };
        scene.run(context, &params, &[Step { mode: Mode::Reset, ..still }], &poses, false);
        for _ in 0..20 {
            scene.run(context, &params, &[still; 4], &poses, false);
        }
        let found = scene.positions(context);
        let count = rest.info.len();
        // The roots and their neighbors follow the head.
        let depths: Vec<_> = found[4 * count..].iter().map(|p| distance(place.inverse().point(*p))).collect();
        let near = depths.iter().filter(|d| **d < 4e-3).count();
        let deepest = depths.iter().copied().fold(f32::MAX, f32::min);
        println!("{shape:?}: deepest {deepest} m, {near} vertices on it");
        assert!(deepest > -1e-3 && near > 2, "{shape:?}: {deepest}, {near}");
    }
}

/// Returns the largest strain of an edge over a motion of `frames` steps that starts at rest.
fn worst_strain(context: &Context, n: usize, frames: usize, motion: impl Fn(f32) -> Pose) -> f32 {
    let (params, grid, positions) = (SimulationParams::default(), sphere(), groom(24, n).0);
    let rest = resting(n, &params, Some(&grid));
    let mut scene = Setup::new(context, &rest, &grid);
    let count = rest.info.len();
    scene.step(context, &params, Step { begin: motion(0.0), end: motion(0.0), ..carry_to_start() });
    let mut worst = 0f32;
    for frame in 0..frames {
        let t = frame as f32 * params.step;
        scene.step(context, &params, Step { begin: motion(t), end: motion(t + params.step), ..at(0.0, 0.0) });
        if frame % 4 != 3 {
            continue;
        }
        let found = scene.positions(context);
        // Skip the guide with the pinned tip, which pulls, and the one with a segment of zero length, which has no
        // strain.
        for g in (1..count).filter(|g| *g != DEGENERATE) {
            for i in 0..n - 1 {
                let point = |i: usize| found[i * count + g];
                let length = positions[g * n + i].distance(positions[g * n + i + 1]);
                let off = (point(i).distance(point(i + 1)) - length).abs();
                // Ignore two micrometers: the shortest edges here have 65.
                let strain = (off - 2e-6).max(0.0) / length;
                assert!(off.is_finite());
                worst = worst.max(strain);
            }
        }
    }
    worst
}

#[test]
fn edges_keep_length_in_shake_and_turn() {
    let Some(context) = context() else { return };
    let shake = worst_strain(context, 32, 90, |t| Pose {
        translation: Vec3::X * 0.1 * (std::f32::consts::TAU * 2.0 * t).sin(),
        ..Pose::IDENTITY
    });
    // 90 degrees in half a second and back.
    let turn = worst_strain(context, 32, 90, |t| Pose {
        rotation: Quat::from_rotation_y(0.785 * (1.0 - (std::f32::consts::TAU * t).cos())),
        ..Pose::IDENTITY
    });
    println!("largest strain: {:.2} % shaken, {:.2} % turned", shake * 100.0, turn * 100.0);
    assert!(shake < 0.01 && turn < 0.01);
}

#[test]
fn hair_returns_to_its_shape() {
    let Some(context) = context() else { return };
    let (params, n, grid) = (SimulationParams::default(), 16, sphere());
    let rest = resting(n, &params, Some(&grid));
    let mut scene = Setup::new(context, &rest, &grid);
    // Three seconds of shaking the head, then two of rest.
    let motion = |t: f32| Pose {
        rotation: Quat::from_rotation_y(0.6 * (std::f32::consts::TAU * t.min(3.0)).sin()),
        ..Pose::IDENTITY
    };
    scene.step(context, &params, Step { begin: motion(0.0), end: motion(0.0), ..carry_to_start() });
    let mean = |scene: &Setup| {
        let found = scene.positions(context);
        let count = rest.info.len();
        // Guide 1 has no stiffness, so no shape. This groom stands out from the head by up to 29 cm; `rest::support`
        // makes all but one of the long guides stiff enough to return.
        let off = |g: usize| {
            let i = (n - 1) * count + g;
            found[i].distance(rest.rest[i].position)
        };
        let mut off: Vec<_> = (0..count).filter(|g| ![1, DEGENERATE].contains(g)).map(off).collect();
        off.sort_by(f32::total_cmp);
        off.pop();
        off.iter().sum::<f32>() / off.len() as f32
    };
    let mut shaken = 0f32;
    for frame in 0..300 {
        let t = frame as f32 * params.step;
        scene.step(context, &params, Step { begin: motion(t), end: motion(t + params.step), ..at(0.0, 0.0) });
        if frame % 10 == 0 && frame < 180 {
            shaken = shaken.max(mean(&scene));
        }
    }
    let settled = mean(&scene);
    println!("mean distance of tips from rest: {shaken} m shaken, {settled} m two seconds later");
    assert!(shaken > 0.03 && settled < 3e-3);
}

#[test]
fn absurd_parameters_give_finite_positions() {
    let Some(context) = context() else { return };
    let params = SimulationParams {
        gravity: Vec3::splat(2e3),
        wind: Wind::uniform(Vec3::X * 400.0),
        drag: 1e4,
        step: 0.1,
        substep_count: 1,
        ..Default::default()
    };
    let grid = sphere();
    let mut scene = Setup::new(context, &resting(16, &params, Some(&grid)), &grid);
    for i in 0..40 {
        scene.step(context, &params, at(i as f32 * 1.7, 0.9));
    }
    assert!(scene.positions(context).iter().all(|p| p.is_finite()));
}
