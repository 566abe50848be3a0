//! Hair in a renderer that has its own colour and depth, camera, lights and shaders: one sphere of its own
//! wears the hair, another hides some of it.
//!
//! `cargo run --example embed -- picture.png`

use half::f16;
use std::borrow::Cow;
use tresses::{
    Camera, Hair, Pipelines, Pose, View,
    collide::ColliderPoses,
    drape,
    draw::{Embed, Surroundings},
    frame::{Frame, Recorder, Shows, Sight},
    glam::{Mat4, Vec3, camera::rh::proj::directx::perspective},
    gpu::{Gpu, readback},
    groom::styles::Style,
    light::{Directional, Lights, Sky, Sphere},
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
    wgpu::{self, TextureFormat, TextureUsages},
};

const SIZE: [u32; 2] = [480, 480];
/// What this renderer draws into: depth runs from 0, near, to 1, far.
const COLOR: TextureFormat = TextureFormat::Rgba16Float;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// Ray-traced, so that the example needs no mesh: a head, and a ball in front of the hair.
const SHADER: &str = "
struct Camera { from_clip: mat4x4<f32>, to_clip: mat4x4<f32>, light: vec4<f32> }
@group(0) @binding(0) var<uniform> camera: Camera;
struct Out { @builtin(frag_depth) depth: f32, @location(0) color: vec4<f32> }
const BALLS = array(vec4(0.0, 0.128, -0.005, 0.078), vec4(0.1, -0.02, 0.12, 0.06));
const COLORS = array(vec3(0.5, 0.42, 0.36), vec3(0.9, 0.3, 0.2));

@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment fn ball(@builtin(position) at: vec4<f32>) -> Out {
    let uv = vec2(at.x / 480.0 * 2.0 - 1.0, 1.0 - at.y / 480.0 * 2.0);
    let a = camera.from_clip * vec4(uv, 0.0, 1.0);
    let b = camera.from_clip * vec4(uv, 0.9, 1.0);
    let origin = a.xyz / a.w;
    let way = normalize(b.xyz / b.w - origin);
    var nearest = 1e9;
    var out = Out(1.0, vec4(0.05, 0.06, 0.08, 1.0));
    for (var i = 0; i < 2; i++) {
        let ball = BALLS[i];
        let o = origin - ball.xyz;
        let half = dot(o, way);
        let inside = half * half - dot(o, o) + ball.w * ball.w;
        let t = -half - sqrt(max(inside, 0.0));
        if inside < 0.0 || t > nearest { continue; }
        nearest = t;
        let p = origin + way * t;
        let clip = camera.to_clip * vec4(p, 1.0);
        let lit = 0.1 + 0.3 * max(dot((p - ball.xyz) / ball.w, camera.light.xyz), 0.0);
        out = Out(clip.z / clip.w, vec4(lit * COLORS[i], 1.0));
    }
    return out;
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("where shall the picture go?")?;
    let pixels = pollster::block_on(picture())?;
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}

async fn picture() -> tresses::Result<Vec<u8>> {
    let Gpu { device, queue, .. } = Gpu::open().await?;
    // The renderer's own: camera, light, targets, a pipeline.
    let (eye, target, up) = (Vec3::new(0.2, 0.1, 0.95), Vec3::new(0.0, 0.02, 0.0), Vec3::Y);
    let world_to_eye = tresses::glam::camera::rh::view::look_at_mat4(eye, target, up);
    let projection = perspective(0.5, SIZE[0] as f32 / SIZE[1] as f32, 0.05, 50.0);
    let light = Vec3::new(-0.5, 0.6, 0.6).normalize();
    let texture = |format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("scene"),
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let color_texture = texture(COLOR, TextureUsages::COPY_SRC);
    let color = color_texture.create_view(&Default::default());
    let depth = texture(DEPTH, TextureUsages::TEXTURE_BINDING).create_view(&Default::default());
    let ball = Ball::new(&device, &queue, projection * world_to_eye, light);

    // The library's: the same camera and light, a view of the same size.
    let pipelines = Pipelines::new(&device);
    let options = ViewOptions::default();
    let view = View::new(&device, &pipelines, &options, SIZE, 1)?;
    let embed = Embed::new(&device, (options.samples, options.coverage), COLOR)?;
    let style = Style::Long(Default::default());
    let made = drape::character(&device, &queue, &pipelines.simulate, &style, Some(8000)).await?;
    let mut hair =
        Hair::new(&device, &queue, &pipelines, &made.groom, &Default::default(), Some(&made.field))?;
    let camera = Camera { view: world_to_eye, projection: Camera::perspective(0.5, 1.0, 0.01), size: SIZE };
    let mut lights =
        Lights { directional: [Directional::OFF; 4], sky: Sky::default(), environment: Default::default() };
    lights.directional[0] = Directional { direction: light, irradiance: Vec3::splat(5.0) };
    lights.sky.zenith = Vec3::splat(0.3);
    let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
    let picture = Picture { camera, lights, focus, ..Default::default() };

    // A frame: the scene first, then hair into it.
    let mut encoder = device.create_command_encoder(&Default::default());
    ball.draw(&mut encoder, &color, &depth);
    let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
    let mut recorder = Recorder {
        pipelines: &pipelines,
        device: &device,
        queue: &queue,
        encoder: &mut encoder,
        timings: None,
    };
    let frame = Frame { dt: 1.0 / 60.0, head: Pose::IDENTITY, colliders, simulation, ..Default::default() };
    let into = Surroundings { color: &color, depth: &depth, origin: [0; 2], projection, geometry: None };
    let sight = Sight { shows: Shows::Over(&embed, into), ..Sight::new(&view, &picture) };
    recorder.record(&mut [(&mut hair, frame)], &[], vec![sight])?;
    queue.submit([encoder.finish()]);

    // The renderer's own tone mapping, here a mere sRGB curve on the CPU.
    let texels: Vec<f16> =
        bytemuck::pod_collect_to_vec(&readback::texture(&device, &queue, &color_texture).await?);
    let byte = |(i, x): (usize, &f16)| match i % 4 {
        3 => 255,
        _ => (255.0 * x.to_f32().clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8,
    };
    Ok(texels.iter().enumerate().map(byte).collect())
}

/// The rest of the scene.
struct Ball {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl Ball {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, to_clip: Mat4, light: Vec3) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("ball"),
            source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(SHADER)),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("ball"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("ball"),
                compilation_options: Default::default(),
                targets: &[Some(COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let camera = tresses::gpu::bindings::uniform(device, "camera", 144);
        let light =
            Mat4::from_cols(light.extend(0.0), Default::default(), Default::default(), Default::default());
        let values = [to_clip.inverse(), to_clip, light].map(|m| m.to_cols_array());
        queue.write_buffer(&camera, 0, &bytemuck::cast_slice(values.as_flattened())[..144]);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
        });
        Self { pipeline, group }
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, color: &wgpu::TextureView, depth: &wgpu::TextureView) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ball"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
