//! Air around a head.

use crate::common;

use tresses::{
    Context, Pose, SimulationParams, Wind,
    clock::{Mode, Step, Steps},
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    glam::Vec3,
    groom::SdfGrid,
    low_level::{Tier, readback::blocking as readback},
    wgpu::{self, util::DeviceExt},
    wind::{Air, HairGrid},
};
use tresses_testing::Pool;

const STEP: f32 = 1.0 / 60.0;

/// Kernels of the pressure: those for software drivers, and those for GPUs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kernels {
    Blocks,
    Levels,
}

impl Kernels {
    const ALL: [Self; 2] = [Self::Blocks, Self::Levels];

    /// Returns the context of the tests with these kernels.
    fn context(self) -> Option<&'static Context> {
        static CONTEXTS: [Pool<Context>; 2] = [Pool::new(), Pool::new()];
        CONTEXTS[self as usize].get(|| {
            let own = common::context()?.clone();
            let tier = Tier { software: self == Self::Blocks, ..own.tier() };
            Some(own.with_tier(tier))
        })
    }
}

/// A head of radius 10 cm at the origin, optionally with hair around it.
struct Tunnel {
    context: &'static Context,
    air: Air,
    colliders: ColliderSet,
    hair: Option<HairGrid>,
    physics: SimulationParams,
    head: Pose,
    fresh: bool,
}

/// Velocities on the lower faces of cells, and how much air each face lets through.
struct Flow {
    cells: usize,
    faces: Vec<Vec3>,
    give: Vec<Vec3>,
}

impl Flow {
    /// Returns the cells inside the grid. The last cell along each axis counts as outside.
    fn cells(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let n = self.cells - 1;
        (0..n * n * n).map(move |c| [c % n, c / n % n, c / (n * n)])
    }

    fn side(&self, values: &[Vec3], axis: usize, mut i: [usize; 3], upper: bool) -> f32 {
        i[axis] += usize::from(upper);
        values[i[0] + self.cells * (i[1] + self.cells * i[2])][axis]
    }

    fn at(&self, i: [usize; 3]) -> Vec3 {
        let mean =
            |axis| 0.5 * (self.side(&self.faces, axis, i, false) + self.side(&self.faces, axis, i, true));
        Vec3::new(mean(0), mean(1), mean(2))
    }

    /// Returns the root mean square of the net outflow of a cell, relative to the velocity.
    fn divergence(&self) -> f32 {
        let (mut out, mut speed, mut count) = (0.0f64, 0.0f64, 0);
        for i in self.cells() {
            let open =
                (0..3).any(|axis| [false, true].iter().any(|up| self.side(&self.give, axis, i, *up) > 0.0));
            if open {
                let net: f32 = (0..3)
                    .map(|axis| {
                        self.side(&self.faces, axis, i, true) - self.side(&self.faces, axis, i, false)
                    })
                    .sum();
                out += f64::from(net * net);
                speed += f64::from(self.at(i).length_squared());
                count += 1;
            }
        }
        assert!(count > 0);
        (out / speed).sqrt() as f32
    }
}

/// Reads the texels of a cubic texture in rgba16float.
fn texels(context: &Context, texture: &wgpu::Texture) -> Vec<Vec3> {
    let bytes = readback::texture(context, texture).unwrap();
    let texels: Vec<[half::f16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
    texels.iter().map(|v| Vec3::new(v[0].to_f32(), v[1].to_f32(), v[2].to_f32())).collect()
}

/// Creates a texture of `n`³ values `(velocity, km/m³)` in a cube with edge `size` around the origin.
fn volume(
    context: &Context,
    n: u32,
    size: f32,
    value: impl Fn(Vec3) -> [f32; 4],
) -> (wgpu::TextureView, HairGrid) {
    let size_in_texels = wgpu::Extent3d { width: n, height: n, depth_or_array_layers: n };
    let dimension = wgpu::TextureDimension::D3;
    let descriptor = wgpu::TextureDescriptor { size: size_in_texels, dimension, ..common::TEXTURE };
    let bytes: Vec<u8> = (0..n * n * n)
        .flat_map(|c| {
            let i = Vec3::new((c % n) as f32, (c / n % n) as f32, (c / (n * n)) as f32);
            value(((i + 0.5) / n as f32 - 0.5) * size).map(half::f16::from_f32)
        })
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = context.device().create_texture_with_data(context.queue(), &descriptor, order, &bytes);
    (texture.create_view(&Default::default()), HairGrid { bias: Vec3::splat(0.5), scale: 1.0 / size })
}

impl Tunnel {
    fn new(
        kernels: Kernels,
        wind: Wind,
        radius: f32,
        hair: Option<&dyn Fn(Vec3) -> [f32; 4]>,
    ) -> Option<Self> {
        let context = kernels.context()?;
        let grid = SdfGrid::from_fn(Vec3::splat(-0.25), Vec3::splat(0.25), 50, |p| p.length() - radius);
        let what = ColliderDescriptor { head: (radius > 0.0).then_some(&grid), ..Default::default() };
        let colliders = ColliderSet::new(context, &what).unwrap();
        let (view, place) = match hair {
            Some(value) => volume(context, 32, 0.6, value),
            None => volume(context, 1, 1.0, |_| [0.0; 4]),
        };
        let air = Air::new(context, wind.resolution, (Vec3::ZERO, 1.0), &view).unwrap();
        Some(Self {
            context,
            air,
            colliders,
            hair: hair.map(|_| place),
            physics: SimulationParams { wind, step: STEP, ..Default::default() },
            head: Pose::IDENTITY,
            fresh: true,
        })
    }

    /// Runs one step in which the head moves to `head`.
    fn step(&mut self, head: Pose) {
        let mode = if self.fresh { Mode::Reset } else { Mode::Step };
        let step =
            Step { mode, begin: if self.fresh { head } else { self.head }, end: head, from: 0.0, to: 1.0 };
        self.fresh = false;
        self.head = head;
        let context = self.context;
        let steps = [step];
        let moments = Moments { steps: &steps, substeps: 4, step: STEP, head, alpha: 1.0 };
        self.colliders.advance(&ColliderPoses::default(), &moments).unwrap();
        let SimulationParams { wind, diameter, step, substep_count: substeps, .. } = self.physics;
        let due = Steps { steps: &steps, length: step, substeps };
        self.air.prepare(&wind, diameter, &due, self.hair);
        common::compute(context, |pass| self.air.record(pass, &self.colliders, 0));
    }

    fn blow(&mut self, seconds: f32) {
        for _ in 0..(seconds / STEP).round() as u32 {
            self.step(self.head);
        }
    }

    fn flow(&self) -> Flow {
        let read = |texture| texels(self.context, texture);
        Flow { cells: self.air.cells as usize, faces: read(&self.air.faces), give: read(&self.air.give) }
    }

    /// Returns the center of a cell relative to the head's origin, in head radii of 10 cm.
    fn middle(&self, i: [usize; 3]) -> Vec3 {
        let corner = self.air.grid_after(0).corner;
        let i = Vec3::new(i[0] as f32, i[1] as f32, i[2] as f32);
        (corner + (i + 0.5) * self.air.cell - self.head.translation) / 0.1
    }
}

fn rms(values: impl Iterator<Item = Vec3>) -> f32 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v.length_squared(), count + 1));
    assert!(count > 0);
    (sum / count as f32).sqrt()
}

/// A shell of hair of 5,000 km/m³ from the head's surface to 18 cm, as dense as a full head of hair.
fn mop(p: Vec3) -> [f32; 4] {
    [0.0, 0.0, 0.0, if (0.1..0.18).contains(&p.length()) { 5000.0 } else { 0.0 }]
}

#[test]
fn air_is_divergence_free() {
    divergence_at(&[30.0]);
}

#[test]
#[ignore = "proof"]
fn air_of_any_speed_is_divergence_free() {
    divergence_at(&[3.0, 10.0, 30.0]);
}

fn divergence_at(speeds: &[f32]) {
    for (kernels, &speed) in Kernels::ALL.into_iter().flat_map(|k| speeds.iter().map(move |speed| (k, speed)))
    {
        let wind = Wind::new(Vec3::new(0.8, 0.0, 0.6) * speed);
        let Some(tunnel) = divergence_free(kernels, wind, 30) else { return };
        // Faces that are 2 % wrong are detected.
        let mut flow = tunnel.flow();
        for (i, face) in flow.faces.iter_mut().enumerate() {
            *face *= if i % 2 == 0 { 1.02 } else { 0.98 };
        }
        assert!(flow.divergence() > 0.01);
    }
}

/// Checks the relative divergence in `steps` steps in which the head moves at up to 1 m/s.
fn divergence_free(kernels: Kernels, wind: Wind, steps: u32) -> Option<Tunnel> {
    let mut tunnel = Tunnel::new(kernels, wind, 0.1, Some(&mop))?;
    let (mut first, mut worst) = (0.0, 0f32);
    for i in 0..steps {
        let t = i as f32 * STEP;
        tunnel.step(Pose { translation: Vec3::X * 0.1 * (10.0 * t).sin(), ..Pose::IDENTITY });
        let divergence = tunnel.flow().divergence();
        assert!(divergence < 0.01, "{kernels:?}, {wind:?}, step {i}: {divergence}");
        if i == 0 {
            first = divergence;
        } else {
            worst = worst.max(divergence);
        }
    }
    let (speed, cells) = (wind.velocity.length(), wind.resolution);
    println!(
        "{kernels:?}, {speed} m/s, {cells} cells: divergence {first} in the first step, then up to {worst}"
    );
    Some(tunnel)
}

/// Checks the divergence in wind of 10 m/s on a grid of `cells` cells along an axis.
fn divergence_on(kernels: &[Kernels], cells: u32, steps: u32) {
    for kernels in kernels {
        let wind = Wind { resolution: cells, ..Wind::new(Vec3::new(8.0, 0.0, 6.0)) };
        divergence_free(*kernels, wind, steps);
    }
}

#[test]
fn air_on_a_finer_grid_is_divergence_free() {
    divergence_on(&Kernels::ALL, 64, 6);
}

/// Levels that tiles and workgroups do not fill.
#[test]
fn air_on_any_grid_is_divergence_free() {
    for cells in [8, 16, 24, 40] {
        divergence_on(&[Kernels::Levels], cells, 4);
    }
}

#[test]
#[ignore = "proof"]
fn air_on_the_finest_grids_is_divergence_free() {
    divergence_on(&Kernels::ALL, 64, 20);
    divergence_on(&Kernels::ALL, 96, 20);
    divergence_on(&[Kernels::Levels], 72, 20);
    divergence_on(&[Kernels::Levels], 88, 20);
}

#[test]
fn wind_costs_few_dispatches_on_a_gpu() {
    for (cells, most) in [(8, 6), (16, 6), (32, 6), (40, 8), (64, 8), (72, 10), (96, 10)] {
        let wind = Wind { resolution: cells, ..Wind::new(Vec3::X) };
        let Some(tunnel) = Tunnel::new(Kernels::Levels, wind, 0.1, None) else { return };
        let count = |first, fresh| tunnel.air.dispatches(first, fresh).count();
        println!("{cells} cells: {} dispatches, {} of a fresh start", count(true, false), count(true, true));
        assert_eq!([count(true, false), count(false, false)], [most, most - 1], "{cells} cells");
        assert_eq!(count(true, true), 3 * most - 8, "{cells} cells");
        let Some(tunnel) = Tunnel::new(Kernels::Blocks, wind, 0.1, None) else { return };
        assert!(tunnel.air.dispatches(true, false).count() > most, "{cells} cells");
    }
}

/// Both solve the same equations, and leave different errors.
#[test]
fn air_of_both_kernels_agrees() {
    let wind = Wind { gusts: 0.0, ..Wind::new(Vec3::new(8.0, 0.0, 6.0)) };
    let run = |kernels: Kernels| {
        let mut tunnel = Tunnel::new(kernels, wind, 0.1, Some(&mop))?;
        tunnel.blow(0.1);
        Some((tunnel.flow(), texels(tunnel.context, tunnel.air.among.texture())))
    };
    let [Some((blocks, among_blocks)), Some((levels, among_levels))] = Kernels::ALL.map(run) else { return };
    let off = rms(blocks.cells().map(|i| blocks.at(i) - levels.at(i))) / wind.velocity.length();
    let changed = rms(blocks.cells().map(|i| blocks.at(i) - wind.velocity)) / wind.velocity.length();
    println!("the air of both kernels differs by {off} of the wind, of which the head changes {changed}");
    assert!(off < 0.03 && changed > 0.1, "{off} {changed}");
    let among = among_blocks.iter().zip(&among_levels);
    let off = rms(among.map(|(a, b)| *a - *b)) / rms(among_blocks.iter().copied());
    println!("the air among hair differs by {off}");
    assert!(off < 0.05, "{off}");
}

#[test]
fn lee_of_the_head_is_calm() {
    for kernels in Kernels::ALL {
        let Some(mut tunnel) = Tunnel::new(kernels, Wind::new(Vec3::X * 8.0), 0.1, None) else { return };
        tunnel.blow(0.5);
        // Behind the head, from its surface (and half a cell) to two radii, within 0.8 radii of the axis.
        let lee = |x: Vec3| (1.15..2.0).contains(&x.x) && x.y.hypot(x.z) < 0.8;
        let (mut behind, mut before, mut count) = (0.0, 0.0, 0.0);
        for _ in 0..20 {
            tunnel.blow(0.05);
            let flow = tunnel.flow();
            let mean = |at: &dyn Fn(Vec3) -> bool| {
                let cells: Vec<_> = flow.cells().filter(|i| at(tunnel.middle(*i))).collect();
                assert!(cells.len() > 20);
                cells.iter().map(|i| flow.at(*i).length()).sum::<f32>() / cells.len() as f32
            };
            behind += mean(&lee);
            before += mean(&|x: Vec3| x.x < -4.0);
            count += 1.0;
        }
        let [inflow, calm] = [before / count, behind / count];
        println!("{kernels:?}: inflow {inflow} m/s, lee {calm} m/s: {}", behind / before);
        assert!((inflow / 8.0 - 1.0).abs() < 0.25);
        assert!(behind / before < 0.4);
    }
}

#[test]
fn porous_hair_slows_the_air_inside_it() {
    for kernels in Kernels::ALL {
        slowed_by(kernels, &[0.0, 500.0, 5000.0]);
    }
}

#[test]
#[ignore = "proof"]
fn hair_of_any_density_slows_the_air_inside_it() {
    for kernels in Kernels::ALL {
        slowed_by(kernels, &[0.0, 50.0, 500.0, 5000.0]);
    }
}

fn slowed_by(kernels: Kernels, densities: &[f32]) {
    let calm = Wind { gusts: 0.0, ..Wind::new(Vec3::X * 8.0) };
    let inside = |x: Vec3| (1.3..1.7).contains(&x.length());
    let mut speeds = Vec::new();
    for &density in densities {
        let hair = move |p: Vec3| {
            let v = mop(p);
            [v[0], v[1], v[2], v[3] / 5000.0 * density]
        };
        let Some(mut tunnel) = Tunnel::new(kernels, calm, 0.1, Some(&hair)) else { return };
        tunnel.blow(1.0);
        let flow = tunnel.flow();
        let cells: Vec<_> = flow.cells().filter(|i| inside(tunnel.middle(*i))).collect();
        speeds.push(cells.iter().map(|i| flow.at(*i).length()).sum::<f32>() / cells.len() as f32);
    }
    println!("{kernels:?}: mean speed in hair of {densities:?} km/m³ in 8 m/s: {speeds:?} m/s");
    assert!(speeds.windows(2).all(|w| w[1] < w[0]), "{speeds:?}");
    assert!(speeds[speeds.len() - 1] < 0.15 * speeds[0], "{speeds:?}");
}

#[test]
fn undisturbed_wind_stays_uniform_while_the_grid_moves() {
    for kernels in Kernels::ALL {
        let wind = Wind { gusts: 0.0, ..Wind::new(Vec3::new(5.0, -1.0, 3.0)) };
        let Some(mut tunnel) = Tunnel::new(kernels, wind, 0.0, None) else { return };
        for i in 0..40 {
            tunnel.step(Pose { translation: Vec3::new(0.05, -0.02, 0.033) * i as f32, ..Pose::IDENTITY });
        }
        let flow = tunnel.flow();
        let error = flow.cells().map(|i| flow.at(i).distance(wind.velocity)).fold(0.0, f32::max);
        println!("{kernels:?}: largest error of uniform wind: {error} m/s");
        assert!(error < 0.005 * wind.velocity.length(), "{error}");
        assert!(
            (tunnel.air.grid_after(0).corner + 0.5 - tunnel.head.translation).abs().max_element()
                < tunnel.air.cell
        );
    }
}

/// Returns the share of the strength of small gusts, of about nine cells, that is left where they leave the grid.
fn kept_gusts(plain: bool) -> Option<f32> {
    let wind = Wind { gusts: 0.06, gust_length: 0.06, ..Wind::new(Vec3::new(4.0, 0.7, 0.4)) };
    let mut tunnel = Tunnel::new(Kernels::Blocks, wind, 0.0, None)?;
    tunnel.air.plain = plain;
    let (mut left, mut first) = (0.0, 0.0);
    for _ in 0..6 {
        tunnel.blow(0.15);
        let flow = tunnel.flow();
        let part = |near: std::ops::Range<usize>| {
            let cells = flow.cells().filter(|i| near.contains(&i[0]) && (6..26).contains(&i[1]));
            rms(cells.map(|i| flow.at(i) - wind.velocity))
        };
        first += part(0..2);
        left += part(26..30);
    }
    Some(left / first)
}

#[test]
fn maccormack_keeps_gusts_that_plain_advection_blurs() {
    let (Some(plain), Some(better)) = (kept_gusts(true), kept_gusts(false)) else { return };
    println!("gusts left after crossing the grid: plain {plain}, MacCormack {better}");
    assert!(better > 1.1 * plain && better < 1.1, "{better} {plain}");
}

#[test]
fn moving_head_pushes_air() {
    for kernels in Kernels::ALL {
        let wind = Wind { gusts: 0.0, ..Wind::new(Vec3::Z * 0.2) };
        let Some(mut tunnel) = Tunnel::new(kernels, wind, 0.1, None) else { return };
        for i in 0..30 {
            tunnel.step(Pose { translation: Vec3::X * i as f32 * STEP, ..Pose::IDENTITY });
        }
        let flow = tunnel.flow();
        let before = |i: &[usize; 3]| {
            let x = tunnel.middle(*i);
            (1.1..1.5).contains(&x.x) && x.y.hypot(x.z) < 0.5
        };
        let cells: Vec<_> = flow.cells().filter(before).collect();
        let mean = |values: &mut dyn Iterator<Item = f32>| values.sum::<f32>() / cells.len() as f32;
        let speed = mean(&mut cells.iter().map(|i| flow.at(*i).x));
        // Potential flow around a sphere that moves along x at 1 m/s (Lamb, Hydrodynamics, art. 92), in radii.
        let potential = |p: Vec3| (3.0 * p.x * p.x / p.length_squared() - 1.0) / (2.0 * p.length().powi(3));
        let sphere = mean(&mut cells.iter().map(|i| potential(tunnel.middle(*i))));
        // The grid resolves the surface to half a cell.
        let larger = sphere * (1.0 + 0.5 * tunnel.air.cell / 0.1).powi(3);
        println!(
            "{kernels:?}: air before a head that moves at 1 m/s: {speed} m/s, potential flow {sphere} to {larger} m/s"
        );
        assert!((sphere..larger).contains(&speed), "{speed} {sphere} {larger}");
    }
}

#[test]
fn runs_are_bit_identical() {
    for kernels in Kernels::ALL {
        let run = |seed| {
            let wind = Wind { seed, ..Wind::new(Vec3::new(8.0, 0.0, 2.0)) };
            let mut tunnel = Tunnel::new(kernels, wind, 0.1, Some(&mop))?;
            tunnel.blow(0.4);
            Some(tunnel.flow().faces.iter().flat_map(|v| v.to_array()).map(f32::to_bits).collect::<Vec<_>>())
        };
        let (Some(a), Some(b), Some(c)) = (run(1), run(1), run(2)) else { return };
        assert_eq!(a, b);
        assert_ne!(a, c);
    }
}
