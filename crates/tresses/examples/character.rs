//! Hair on a mesh that an engine skins itself. The engine's compute shader writes vertices in its own format, and the
//! hair's roots follow them. Nothing is read back.
//!
//! `cargo run --example character -- picture.png`

use tresses::{
    Body, Camera, Character, CharacterAsset, CharacterOptions, Gpu, Picture, Pose, Styling, View,
    collide::{Collider, FieldId, FieldSource, Shape},
    drape,
    glam::{Quat, Vec3},
    groom::{TriMesh, mannequin::rig},
    low_level::{Drawing, Skin, Words},
    wgpu::{self, util::DeviceExt},
};

/// Words per vertex of the engine: position, normal, two texture coordinates.
const WORDS: u32 = 8;

/// The engine's skinning. The head turns on a neck that follows it increasingly from the shoulders up. Tresses draws
/// the mesh here, so the shader also writes the vertices of its body; an engine that draws its own meshes omits that.
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
    pollster::block_on(render(&std::env::args().nth(1).ok_or("usage: character image.png")?))
}

async fn render(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    let tresses = Gpu::open().await?.context;
    let (device, queue) = (tresses.device(), tresses.queue());
    let source = drape::style(&tresses, &"bob".parse()?, &()).await?;
    let mut parts = source.parts(&Styling::default(), &()).await?;
    // The engine replaces the built-in rig. Hair collides with the head, and with the shoulders, which do not bend.
    parts.anatomy = None;
    let [torso, ..] = rig::parts(parts.body_field().ok_or("the character has no distance field")?);
    let fields = [FieldSource::Grid(&torso)];
    let obstacles = [Collider::new(Shape::Field(FieldId(0)))];
    let options = CharacterOptions::default().with_obstacles(&obstacles, &fields);
    let mesh = parts.head.clone().ok_or("the character has no mesh")?;
    let mut ann = Character::new(&CharacterAsset::new(&tresses, parts, &options, &()).await?)?;

    // Once: attach the roots to the engine's skin, none more than a centimeter away.
    let engine = Engine::new(device, &mesh, ann.body().ok_or("the character has no body")?);
    let at = |first| (&engine.vertices, Words { first, stride: WORDS });
    let report = ann.skinned_by(&mesh, &Skin { positions: at(0), normals: at(3) }, 0.01)?;
    println!("mean distance of the roots from the mesh: {:.2} mm", 1e3 * report.mean_distance);

    let size = [480, 600];
    let mut view = View::new(&tresses, &Default::default(), size, 1)?;
    let camera = Camera::look_at(Vec3::new(0.25, 0.1, 0.9), Vec3::Y * 0.02, 0.55, size);
    let picture = Picture { camera, ..Default::default() };
    while ann.time() < 0.3 || !view.is_complete().await? {
        // The character takes a step to the left, and its head turns on the neck.
        let seconds = ann.time() as f32;
        let body = Pose { translation: Vec3::X * 0.12 * seconds, ..Pose::IDENTITY };
        let head = Pose::about(ann.neck(), Quat::from_rotation_y(2.4 * seconds));
        ann.set_pose(body);
        ann.gesture.head = head;
        ann.set_obstacle_poses(&[body])?;
        let mut encoder = device.create_command_encoder(&Default::default());
        engine.skin(queue, &mut encoder, &head);
        let mut frame = tresses.frame(&mut encoder);
        frame.advance(&mut [&mut ann], 1.0 / 60.0)?;
        if ann.time() >= 0.3 {
            frame.draw_as(&mut view, &[&ann], Drawing::new(&picture))?;
        }
        queue.submit([encoder.finish()]);
    }
    let mut png = png::Encoder::new(std::fs::File::create(path)?, size[0], size[1]);
    png.set_color(png::ColorType::Rgba);
    Ok(png.write_header()?.write_image_data(&view.targets().read().await?)?)
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
