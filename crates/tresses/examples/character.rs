//! Hair on a character that an engine skins by itself: its compute shader writes vertices in the engine's own format,
//! and roots of the hair follow them. Nothing is read back.
//!
//! `cargo run --example character -- picture.png`

use tresses::{
    Camera, Hair, Pipelines, Pose, View,
    body::Body,
    collide::{Collider, ColliderDescriptor, ColliderPoses, FieldId, FieldSource, Shape},
    drape,
    frame::{Frame, Recorder, Sight},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::{TriMesh, mannequin::rig, styles::Style},
    light::Sphere,
    roots::{Skin, Words},
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
    wgpu::{self, util::DeviceExt},
};

/// Words of one of the engine's vertices: position, normal, two texture coordinates.
const WORDS: u32 = 8;

/// The engine's skinning. The head turns on a neck that follows it more and more from the shoulders up. What bends is
/// drawn by Tresses here, so that its vertices are written too; an engine that draws its bodies itself leaves that out.
const SKINNING: &str = "
@group(0) @binding(0) var<storage, read> rest: array<f32>;
@group(0) @binding(1) var<storage, read_write> skinned: array<f32>;
@group(0) @binding(2) var<storage, read_write> drawn: array<f32>;
@group(0) @binding(3) var<uniform> head: mat4x4<f32>;

@compute @workgroup_size(64) fn skin(@builtin(global_invocation_id) id: vec3<u32>) {
    let first = 8u * id.x;
    if first >= arrayLength(&rest) { return; }
    let p = vec3(rest[first], rest[first + 1u], rest[first + 2u]);
    let n = vec3(rest[first + 3u], rest[first + 4u], rest[first + 5u]);
    let share = smoothstep(-0.09, 0.03, p.y);
    let at = mix(p, (head * vec4(p, 1.0)).xyz, share);
    let up = normalize(mix(n, (head * vec4(n, 0.0)).xyz, share));
    let vertex = array(at.x, at.y, at.z, up.x, up.y, up.z);
    for (var i = 0u; i < 6u; i++) {
        skinned[first + i] = vertex[i];
        drawn[7u * id.x + i] = vertex[i];
    }
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("where shall the picture go?")?;
    pollster::block_on(picture(&path))
}

/// The engine's skinned mesh on the GPU.
struct Engine {
    vertices: wgpu::Buffer,
    joint: wgpu::Buffer,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    count: u32,
}

impl Engine {
    fn new(device: &wgpu::Device, mesh: &TriMesh, body: &Body) -> Self {
        let vertex = |(p, n): (&Vec3, &Vec3)| [p.x, p.y, p.z, n.x, n.y, n.z, 0.0, 0.0];
        let rest: Vec<[f32; WORDS as usize]> = mesh.positions.iter().zip(&mesh.normals).map(vertex).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX;
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let contents: &[u8] = bytemuck::cast_slice(&rest);
        let (at_rest, vertices) = (buffer(contents, usage), buffer(contents, usage));
        let joint = buffer(&[0; 64], wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(SKINNING.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let buffers = [&at_rest, &vertices, body.vertices(), &joint];
        let entries = std::array::from_fn::<_, 4, _>(|i| wgpu::BindGroupEntry {
            binding: i as u32,
            resource: buffers[i].as_entire_binding(),
        });
        let layout = &pipeline.get_bind_group_layout(0);
        let group =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        Self { vertices, joint, pipeline, group, count: rest.len() as u32 }
    }

    fn skin(&self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder, head: &Pose) {
        queue.write_buffer(&self.joint, 0, bytemuck::bytes_of(&head.matrix()));
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
    }
}

async fn picture(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    let Gpu { device, queue, .. } = Gpu::open().await?;
    let pipelines = Pipelines::new(&device);
    let style = Style::Bob(Default::default());
    let made = drape::character(&device, &queue, &pipelines.simulate, &style, Some(8000)).await?;
    // What the joints carry is what hair collides with: the head's own field, and the shoulders, which stay.
    let [torso, _, own] = rig::parts(&made.field);
    let what = ColliderDescriptor {
        head: Some(&own),
        rest: Some(&made.field),
        fields: &[FieldSource::Grid(&torso)],
        colliders: &[Collider::new(Shape::Field(FieldId(0)))],
    };
    let (options, groom) = (Default::default(), &made.groom);
    let mut hair = Hair::with_colliders(&device, &queue, &pipelines, groom, &options, &what)?;
    let mut body = Body::new(&device, &made.mesh);
    let engine = Engine::new(&device, &made.mesh, &body);

    // Once: roots belong to the skin as the engine has it, none more than a centimetre away.
    let at = |first| (&engine.vertices, Words { first, stride: WORDS });
    let skin = Skin { positions: at(0), normals: at(3) };
    let report = hair.attach(&device, &queue, &pipelines, groom, &made.mesh, &skin, 0.01)?;
    println!("roots are {:.2} mm from the skin in the mean", 1e3 * report.mean);

    let size = [480, 600];
    let view = View::new(&device, &pipelines, &ViewOptions::default(), size, 1)?;
    let camera = Camera::look_at(Vec3::new(0.25, 0.1, 0.9), Vec3::new(0.0, 0.02, 0.0), 0.55, size);
    let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
    let picture = Picture { camera, focus, ..Default::default() };
    let simulation = &SimulationParams::default();
    for i in 0..20 {
        // The joint that the hair goes with, and where the character is: a step to the left.
        let head = Pose::about(made.neck, Quat::from_rotation_y(0.04 * i as f32));
        let stands = Pose { translation: Vec3::X * 0.002 * i as f32, ..Pose::IDENTITY };
        let mut encoder = device.create_command_encoder(&Default::default());
        engine.skin(&queue, &mut encoder, &head);
        body.pose = stands;
        let colliders = &ColliderPoses { colliders: vec![stands], ..Default::default() };
        if let Some(roots) = &mut hair.roots {
            roots.pose = stands;
        }
        let (pipelines, device, queue) = (&pipelines, &device, &queue);
        let mut recorder = Recorder { pipelines, device, queue, encoder: &mut encoder, timings: None };
        let head = stands.after(&head);
        let frame = Frame { dt: 1.0 / 60.0, head, colliders, simulation, ..Default::default() };
        let sights = if i == 19 { vec![Sight::new(&view, &picture)] } else { Vec::new() };
        recorder.record(&mut [(&mut hair, frame)], &[&body], sights)?;
        queue.submit([encoder.finish()]);
    }
    let [width, height] = size;
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&view.targets().read(&device, &queue).await?)?;
    Ok(())
}
