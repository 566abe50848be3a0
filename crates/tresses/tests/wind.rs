//! The wind around a head.

mod common;

use tresses::{
    Pose,
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    glam::Vec3,
    gpu::{Gpu, readback},
    groom::SdfGrid,
    simulate::{Mode, SimulationParams, Step},
    wind::{Air, Fluid, HairGrid, Wind},
};

const STEP: f32 = 1.0 / 60.0;

/// A head of radius 10 cm at the origin, and perhaps hair around it.
struct Tunnel {
    gpu: &'static Gpu,
    fluid: &'static Fluid,
    air: Air,
    colliders: ColliderSet,
    hair: Option<HairGrid>,
    physics: SimulationParams,
    head: Pose,
    fresh: bool,
}

/// The velocity on the lower faces of cells, and what the air can pass.
struct Flow {
    cells: usize,
    faces: Vec<Vec3>,
    give: Vec<Vec3>,
}

impl Flow {
    /// The cells inside the grid: the last ones count as outside.
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

    /// Root of the mean square of what flows out of a cell, over that of the velocity.
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

fn stage() -> Option<(&'static Gpu, &'static Fluid)> {
    static STAGE: std::sync::OnceLock<Option<(Gpu, Fluid)>> = std::sync::OnceLock::new();
    STAGE
        .get_or_init(|| {
            let gpu = common::gpu()?;
            let fluid = Fluid::new(&gpu.device);
            Some((gpu, fluid))
        })
        .as_ref()
        .map(|(gpu, fluid)| (gpu, fluid))
}

/// The texels of a cube in rgba16float.
fn texels(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<Vec3> {
    let n = texture.width();
    let row = n * 8;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(padded * n * n),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: Some(n) };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes: Vec<half::f16> = readback::buffer(&gpu.device, &gpu.queue, &buffer).unwrap();
    bytes
        .chunks(padded as usize / 2)
        .flat_map(|line| line[..row as usize / 2].chunks(4))
        .map(|v| Vec3::new(v[0].to_f32(), v[1].to_f32(), v[2].to_f32()))
        .collect()
}

/// A texture of `n`³ values `(velocity, km/m³)` of a cube of edge `size` around the origin.
fn volume(gpu: &Gpu, n: u32, size: f32, value: impl Fn(Vec3) -> [f32; 4]) -> (wgpu::TextureView, HairGrid) {
    let extent = wgpu::Extent3d { width: n, height: n, depth_or_array_layers: n };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let bytes: Vec<u8> = (0..n * n * n)
        .flat_map(|c| {
            let i = Vec3::new((c % n) as f32, (c / n % n) as f32, (c / (n * n)) as f32);
            value(((i + 0.5) / n as f32 - 0.5) * size).map(half::f16::from_f32)
        })
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(n * 8), rows_per_image: Some(n) };
    gpu.queue.write_texture(texture.as_image_copy(), &bytes, layout, extent);
    (texture.create_view(&Default::default()), HairGrid { bias: Vec3::splat(0.5), scale: 1.0 / size })
}

impl Tunnel {
    fn new(wind: Wind, radius: f32, hair: Option<&dyn Fn(Vec3) -> [f32; 4]>) -> Option<Self> {
        let (gpu, fluid) = stage()?;
        let grid = SdfGrid::from_fn(Vec3::splat(-0.25), Vec3::splat(0.25), 50, |p| p.length() - radius);
        let what = ColliderDescriptor { head: (radius > 0.0).then_some(&grid), ..Default::default() };
        let colliders = ColliderSet::new(&gpu.device, &gpu.queue, &what).unwrap();
        let (view, place) = match hair {
            Some(value) => volume(gpu, 32, 0.6, value),
            None => volume(gpu, 1, 1.0, |_| [0.0; 4]),
        };
        let air = Air::new(&gpu.device, &gpu.queue, fluid, wind.cells, (Vec3::ZERO, 1.0), &view).unwrap();
        Some(Self {
            gpu,
            fluid,
            air,
            colliders,
            hair: hair.map(|_| place),
            physics: SimulationParams { wind, step: STEP, ..Default::default() },
            head: Pose::IDENTITY,
            fresh: true,
        })
    }

    /// One step in which the head comes to `head`.
    fn step(&mut self, head: Pose) {
        let mode = if self.fresh { Mode::Reset } else { Mode::Step };
        let step =
            Step { mode, begin: if self.fresh { head } else { self.head }, end: head, from: 0.0, to: 1.0 };
        self.fresh = false;
        self.head = head;
        let Gpu { device, queue, .. } = self.gpu;
        let steps = [step];
        let moments = Moments { steps: &steps, substeps: 4, step: STEP, head, alpha: 1.0 };
        self.colliders.advance(queue, &ColliderPoses::default(), &moments).unwrap();
        self.air.prepare(queue, &self.physics, &steps, self.hair);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.fluid.record(&mut pass, &self.air, &self.colliders, 0);
        drop(pass);
        queue.submit([encoder.finish()]);
    }

    fn blow(&mut self, seconds: f32) {
        for _ in 0..(seconds / STEP).round() as u32 {
            self.step(self.head);
        }
    }

    fn flow(&self) -> Flow {
        let read = |texture| texels(self.gpu, texture);
        Flow { cells: self.air.cells as usize, faces: read(&self.air.faces), give: read(&self.air.give) }
    }

    /// The middle of a cell, relative to the head's origin, in head radii of 10 cm.
    fn middle(&self, i: [usize; 3]) -> Vec3 {
        let corner = self.air.place(0).corner;
        let i = Vec3::new(i[0] as f32, i[1] as f32, i[2] as f32);
        (corner + (i + 0.5) * self.air.cell - self.head.translation) / 0.1
    }
}

#[test]
fn explore() {
    for (u, turb) in [(3.0f32, 0.0), (10.0, 0.0), (10.0, 0.2), (30.0, 0.3)] {
        let wind = Wind { turbulence: turb, ..Wind::new(Vec3::X * u) };
        let Some(mut t) = Tunnel::new(wind, 0.1, None) else { return };
        for s in 0..60 {
            let start = std::time::Instant::now();
            t.step(t.head);
            t.gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            let ms = start.elapsed().as_secs_f64() * 1e3;
            if s < 3 || s % 12 == 0 || s == 59 {
                let f = t.flow();
                let lee: Vec<f32> = f
                    .cells()
                    .filter(|&i| {
                        let x = t.middle(i);
                        x.x > 1.3 && x.x < 3.0 && x.y.hypot(x.z) < 0.8
                    })
                    .map(|i| f.at(i).x / u)
                    .collect();
                println!(
                    "{u} {turb} step {s}: {ms:.2} ms, div {:.4}, lee {:.3} ({})",
                    f.divergence(),
                    lee.iter().sum::<f32>() / lee.len() as f32,
                    lee.len()
                );
            }
        }
    }
}

fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) * 10.0
}

#[test]
fn cost() {
    let wind = Wind { turbulence: 0.2, ..Wind::new(Vec3::X * 10.0) };
    let Some(mut t) =
        Tunnel::new(wind, 0.1, Some(&|p: Vec3| [0.0, 0.0, 0.0, if p.length() < 0.2 { 5000.0 } else { 0.0 }]))
    else {
        return;
    };
    t.blow(0.1);
    t.flow();
    let a = cpu();
    let w = std::time::Instant::now();
    t.blow(1.0);
    t.flow();
    println!(
        "{:?} cpu {:.2} ms per step, wall {:.2}",
        std::env::var("REP"),
        (cpu() - a) / 60.0,
        w.elapsed().as_secs_f64() * 1e3 / 60.0
    );
}
