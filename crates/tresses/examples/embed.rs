//! Hair in a renderer that has its own colour and depth, camera, lights, shadow map and shaders: two heads, one behind
//! the other, and a ball. Shadows fall both ways: the ball's on hair, by the scene's own shadow map, and that of hair on
//! everything, by a function that the scene's shader calls.
//!
//! `cargo run --example embed -- picture.png`

use half::f16;
use tresses::{
    Camera, Hair, Pipelines, Pose, View,
    collide::ColliderPoses,
    drape,
    draw::{Embed, Surroundings, embed::shade},
    frame::{Frame, Recorder, Shows, Sight},
    glam::{
        Mat4, Quat, Vec3,
        camera::rh::{
            proj::directx::{orthographic, perspective},
            view::look_at_mat4,
        },
    },
    gpu::{Gpu, readback},
    groom::styles::Style,
    light::{Directional, HairMaterial, Lights, SceneShadow, Sky, Sphere},
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
    wgpu::{self, TextureFormat, TextureUsages},
};

const SIZE: [u32; 2] = [640, 480];
/// Texels along each edge of the renderer's shadow map.
const SHADOW: u32 = 1024;
/// What this renderer draws into: depth runs from 0, near, to 1, far.
const COLOR: TextureFormat = TextureFormat::Rgba16Float;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// Ray-traced, so that the example needs no mesh: two heads, a ball, the floor and a wall, all of them matt.
const SHADER: &str = "
struct Scene { from_clip: mat4x4<f32>, to_clip: mat4x4<f32>, light: vec4<f32>, size: vec4<f32> }
@group(0) @binding(0) var<uniform> scene: Scene;
struct Out { @builtin(frag_depth) depth: f32, @location(0) color: vec4<f32> }
struct Hit { t: f32, normal: vec3<f32>, color: vec3<f32> }
const BALLS = array(vec4(-0.13, 0.128, 0.0, 0.083), vec4(0.16, 0.128, -0.35, 0.083), vec4(-0.31, 0.18, 0.21, 0.04));
const COLORS = array(vec3(0.5, 0.38, 0.31), vec3(0.5, 0.38, 0.31), vec3(0.6, 0.12, 0.08));

@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn plane(hit: Hit, origin: vec3<f32>, way: vec3<f32>, normal: vec3<f32>, at: f32, color: vec3<f32>) -> Hit {
    let t = (at - dot(origin, normal)) / dot(way, normal);
    if t > 1e-3 && t < hit.t { return Hit(t, normal, color); }
    return hit;
}

fn trace(origin: vec3<f32>, way: vec3<f32>) -> Hit {
    var hit = Hit(1e9, vec3(0.0), vec3(0.0));
    for (var i = 0; i < 3; i++) {
        let o = origin - BALLS[i].xyz;
        let half = dot(o, way);
        let inside = half * half - dot(o, o) + BALLS[i].w * BALLS[i].w;
        let t = -half - sqrt(max(inside, 0.0));
        if inside > 0.0 && t > 1e-3 && t < hit.t {
            hit = Hit(t, (o + way * t) / BALLS[i].w, COLORS[i]);
        }
    }
    return hit;
}

@fragment fn look(@builtin(position) at: vec4<f32>) -> Out {
    let uv = at.xy / scene.size.xy * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let a = scene.from_clip * vec4(uv, 0.0, 1.0);
    let b = scene.from_clip * vec4(uv, 0.9, 1.0);
    let origin = a.xyz / a.w;
    let way = normalize(b.xyz / b.w - origin);
    var hit = trace(origin, way);
    hit = plane(hit, origin, way, vec3(0.0, 1.0, 0.0), -0.3, vec3(0.3));
    hit = plane(hit, origin, way, vec3(0.0, 0.0, 1.0), -0.75, vec3(0.35));
    let p = origin + way * hit.t;
    let clip = scene.to_clip * vec4(p, 1.0);
    let light = scene.light.xyz;
    var arrives = vec3(max(dot(hit.normal, light), 0.0) * 5.0 / 3.1416);
    if trace(p + 1e-3 * hit.normal, light).t < 1e8 { arrives = vec3(0.0); }
    // What hair lets through of the first light that is on.
    arrives *= tresses_left_by_hair(0u, p, hit.normal);
    return Out(clip.z / clip.w, vec4(hit.color * (0.3 + arrives), 1.0));
}

@fragment fn depth(@builtin(position) at: vec4<f32>) -> @builtin(frag_depth) f32 {
    let uv = at.xy / scene.size.xy * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let a = scene.from_clip * vec4(uv, 0.0, 1.0);
    let b = scene.from_clip * vec4(uv, 1.0, 1.0);
    let p = a.xyz + normalize(b.xyz - a.xyz) * trace(a.xyz, normalize(b.xyz - a.xyz)).t;
    return clamp((scene.to_clip * vec4(p, 1.0)).z, 0.0, 1.0);
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
    // The renderer's own: camera, light, targets, a shadow map.
    let (eye, target) = (Vec3::new(0.12, 0.22, 1.35), Vec3::new(0.0, 0.02, -0.1));
    let world_to_eye = look_at_mat4(eye, target, Vec3::Y);
    let projection = perspective(0.5, SIZE[0] as f32 / SIZE[1] as f32, 0.05, 50.0);
    let light = Vec3::new(-0.5, 0.6, 0.6).normalize();
    let texture = |[width, height]: [u32; 2], format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some("scene"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let color_texture = texture(SIZE, COLOR, TextureUsages::COPY_SRC);
    let color = color_texture.create_view(&Default::default());
    let depth = texture(SIZE, DEPTH, TextureUsages::TEXTURE_BINDING).create_view(&Default::default());
    let shadow_map =
        texture([SHADOW; 2], DEPTH, TextureUsages::TEXTURE_BINDING).create_view(&Default::default());
    let from_light =
        orthographic(-0.9, 0.9, -0.9, 0.9, 0.1, 4.0) * look_at_mat4(2.0 * light, Vec3::ZERO, Vec3::Y);

    // The library's: the same camera and light, a view of the same size, two heads with one groom.
    let pipelines = Pipelines::new(&device);
    let options = ViewOptions { shadow_resolution: 2048, ..Default::default() };
    let view = View::new(&device, &pipelines, &options, SIZE, 1)?;
    let embed = Embed::new(&device, (options.samples, options.coverage), COLOR)?;
    let style = Style::Long(Default::default());
    let made = drape::character(&device, &queue, &pipelines.simulate, &style, Some(8000)).await?;
    let mut near =
        Hair::new(&device, &queue, &pipelines, &made.groom, &Default::default(), Some(&made.field))?;
    let mut far = near.another(&device, &queue, &pipelines, &[])?;
    near.set.material = HairMaterial::blond();
    far.set.material = HairMaterial::red();
    let camera = Camera {
        view: world_to_eye,
        projection: Camera::perspective(0.5, SIZE[0] as f32 / SIZE[1] as f32, 0.01),
        size: SIZE,
    };
    let mut lights =
        Lights { directional: [Directional::OFF; 4], sky: Sky::default(), environment: Default::default() };
    lights.directional[0] = Directional { direction: light, irradiance: Vec3::splat(5.0) };
    lights.sky = Sky { zenith: Vec3::splat(0.3), horizon: Vec3::splat(0.3), ground: Vec3::splat(0.1) };
    let focus = Sphere { center: Vec3::new(0.0, 0.0, -0.15), radius: 0.55 };
    let picture = Picture { camera, lights, focus, ..Default::default() };
    let scene = Scene::new(
        &device,
        &queue,
        &pipelines,
        [(projection * world_to_eye, SIZE), (from_light, [SHADOW; 2])],
        light,
    );

    let mut encoder = device.create_command_encoder(&Default::default());
    // A frame: first the scene's shadow map, then hair moves and its light is made, with what the scene keeps from it.
    scene.draw(&mut encoder, 1, (None, &shadow_map), view.light_group());
    let shadows =
        [SceneShadow { light: 0, depth: &shadow_map, part: None, projection: from_light, bias: 0.005 }];
    let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
    let frame = |x: f32, z: f32, turn: f32| Frame {
        dt: 1.0 / 60.0,
        head: Pose { translation: Vec3::new(x, 0.0, z), rotation: Quat::from_rotation_y(turn) },
        colliders,
        simulation,
        ..Default::default()
    };
    let mut recorder = Recorder {
        pipelines: &pipelines,
        device: &device,
        queue: &queue,
        encoder: &mut encoder,
        timings: None,
    };
    recorder.advance(&mut near, &frame(-0.13, 0.005, 0.4))?;
    recorder.advance(&mut far, &frame(0.16, -0.345, -0.5))?;
    recorder.light(&[&near.set, &far.set], &[], &view, &picture, &shadows)?;
    // Then the scene, whose shader asks hair for its shadow, then hair into it.
    scene.draw(recorder.encoder, 0, (Some(&color), &depth), view.light_group());
    let into = Surroundings { lit: true, ..Surroundings::new(&color, &depth, projection) };
    let sight = Sight { shows: Shows::Over(&embed, into), ..Sight::new(&view, &picture) };
    recorder.draw(&[&near, &far], &[], sight)?;
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

/// What is not hair, seen by the camera and by the light.
struct Scene {
    pipelines: [wgpu::RenderPipeline; 2],
    groups: [wgpu::BindGroup; 2],
}

impl Scene {
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        library: &Pipelines,
        eyes: [(Mat4, [u32; 2]); 2],
        light: Vec3,
    ) -> Self {
        use tresses::gpu::{Binding, bindings};
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("scene"),
            source: wgpu::ShaderSource::Wgsl((shade::wgsl(1) + SHADER).into()),
        });
        let own = bindings::layout(device, "scene", wgpu::ShaderStages::FRAGMENT, &[Binding::Uniform]);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&own), Some(library.light_layout())],
            immediate_size: 0,
        });
        let pipeline = |entry: &str, targets: &[Option<wgpu::ColorTargetState>]| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("scene"),
                layout: Some(&layout),
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
                    depth_compare: Some(wgpu::CompareFunction::Always),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let groups = eyes.map(|(to_clip, [width, height])| {
            let uniform = bindings::uniform(device, "scene", 160);
            let mut values = [to_clip.inverse(), to_clip].map(|m| m.to_cols_array()).concat();
            values.extend(light.extend(0.0).to_array());
            values.extend([width as f32, height as f32, 0.0, 0.0]);
            queue.write_buffer(&uniform, 0, bytemuck::cast_slice(&values));
            bindings::group(device, "scene", &own, &[uniform.as_entire_binding()])
        });
        Self { pipelines: [pipeline("look", &[Some(COLOR.into())]), pipeline("depth", &[])], groups }
    }

    fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        eye: usize,
        (color, depth): (Option<&wgpu::TextureView>, &wgpu::TextureView),
        hair: &wgpu::BindGroup,
    ) {
        let color = color.map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: color.as_slice(),
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
        pass.set_pipeline(&self.pipelines[eye]);
        pass.set_bind_group(0, &self.groups[eye], &[]);
        pass.set_bind_group(1, hair, &[]);
        pass.draw(0..3, 0..1);
    }
}
