//! Hair in a renderer of your own, with its color, depth, camera, lights, shadow map and shader (`embed.wgsl`). It
//! draws a head, a ring and the ground. Hair is behind and in front of the ring, and shadows fall both ways. The
//! integration follows the comments that begin with "Tresses". `cargo run --release --example embed -- picture.png`

use half::f16;
use tresses::light::{HairMaterial, Lights, SceneShadow};
use tresses::wgpu::{self, FragmentState, TextureUsages as Usage, VertexState, util::DeviceExt};
use tresses::{Camera, Character, Pose, glam::Quat, glam::Vec3, groom::mannequin};
use tresses::{Compositor, HostFrame, low_level::shade};
use tresses::{
    Gpu,
    low_level::{Binding, bindings, readback},
};
use tresses::{Picture, View, ViewOptions};

const SIZE: [u32; 2] = [960, 640];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    pollster::block_on(picture(&std::env::args().nth(1).ok_or("usage: embed image.png")?))
}

async fn picture(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    // The renderer: camera and lights.
    let tresses = Gpu::open().await?.context;
    let (device, queue) = (tresses.device(), tresses.queue());
    let eye = Vec3::new(0.0, 0.255, 1.12);
    let body = Pose::about(Vec3::ZERO, Quat::from_rotation_y(-0.6));
    let lights = Lights::around(0.0);
    let [(to_key, key), (to_rim, rim)] =
        [Lights::KEY, Lights::RIM].map(|light| lights.list[light].irradiance_at(Vec3::ZERO));
    let camera = Camera::look_at(eye, Vec3::Y * 0.035, 0.46, SIZE);
    let lamp = Camera::look_at(4.0 * to_key, Vec3::ZERO, 0.3, [2048; 2]);
    let [to_camera, to_lamp] = [camera, lamp].map(|eye| eye.projection * eye.view);

    // Tresses: a character, a view of it, and the compositing into the renderer's color.
    let mut ann = Character::built_in(&tresses, "curly").await?;
    ann.set_material(HairMaterial::red());
    ann.set_pose(body);
    let options = ViewOptions::default();
    let mut view = View::new(&tresses, &options, SIZE, 1)?;
    let embed = Compositor::new(&tresses, options.renderer, COLOR)?;
    let picture = Picture { camera, lights, ..Default::default() };
    let source = wgpu::ShaderSource::Wgsl((shade::wgsl(1) + include_str!("embed.wgsl")).into());

    // The renderer: targets, buffers, pipelines.
    let texture = |[width, height]: [u32; 2], sample_count, format, usage| {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | Usage::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        texture.create_view(&Default::default())
    };
    let color = texture(SIZE, 1, COLOR, Usage::COPY_SRC);
    let msaa = texture(SIZE, 4, COLOR, Usage::empty());
    let depth = texture(SIZE, 4, DEPTH, Usage::TEXTURE_BINDING);
    let shadow_map = texture(lamp.size, 1, DEPTH, Usage::TEXTURE_BINDING);
    let buffer = |contents, usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let triangles = mannequin::mesh(mannequin::RESOLUTION).triangles;
    let corners = buffer(bytemuck::cast_slice(&triangles), wgpu::BufferUsages::STORAGE);
    let matrices = [to_camera, to_lamp, body.matrix()];
    let vectors = [to_key, key, to_rim, rim, eye].map(|v| v.extend(0.0));
    let scene: Vec<u8> = [bytemuck::cast_slice(&matrices), bytemuck::cast_slice(&vectors)].concat();
    let scene = buffer(&scene, wgpu::BufferUsages::UNIFORM);
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let entries = [Binding::Uniform, Binding::Storage, Binding::Storage, Binding::Depth];
    let own = bindings::layout(device, "scene", wgpu::ShaderStages::VERTEX_FRAGMENT, &entries);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&own), Some(&View::light_layout(&tresses))],
        immediate_size: 0,
    });
    let pipeline = |layout, count, targets: &[_]| {
        let options = wgpu::PipelineCompilationOptions::default;
        let fragment = FragmentState { module, entry_point: None, compilation_options: options(), targets };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout,
            vertex: VertexState { module, entry_point: None, compilation_options: options(), buffers: &[] },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count, ..Default::default() },
            fragment: (!targets.is_empty()).then_some(fragment),
            multiview_mask: None,
            cache: None,
        })
    };
    let shadow_pipeline = pipeline(None, 1, &[]);
    let pipeline = pipeline(Some(&layout), 4, &[Some(COLOR.into())]);
    let resources = [
        scene.as_entire_binding(),
        ann.body().ok_or("the character has no body")?.vertices().as_entire_binding(),
        corners.as_entire_binding(),
        wgpu::BindingResource::TextureView(&shadow_map),
    ];
    let group = bindings::group(device, "scene", &own, &resources);
    let own = &shadow_pipeline.get_bind_group_layout(0);
    let shadow_group = bindings::group(device, "shadow", own, &resources[..3]);
    // Draws the scene seen from the camera (eye 0) into color and depth, or from the light (eye 1) into its shadow map.
    let draw = |encoder: &mut wgpu::CommandEncoder, eye, view, hair: Option<&wgpu::BindGroup>| {
        let (resolve_target, ops, depth_ops) = (Some(&color), Default::default(), Some(Default::default()));
        let out =
            [Some(wgpu::RenderPassColorAttachment { view: &msaa, depth_slice: None, resolve_target, ops })];
        let depth = wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: if eye == 0 { &out } else { &[] },
            depth_stencil_attachment: Some(depth),
            ..Default::default()
        });
        pass.set_pipeline(if eye == 0 { &pipeline } else { &shadow_pipeline });
        pass.set_bind_group(0, if eye == 0 { &group } else { &shadow_group }, &[]);
        pass.set_bind_group(1, hair, &[]);
        pass.draw(0..3 * triangles.len() as u32 + 2 * 6 * 128 * 32, eye..eye + 1);
    };
    let mut encoder = device.create_command_encoder(&Default::default());

    // Tresses: the character moves.
    tresses.frame(&mut encoder).advance(&mut [&mut ann], 1.0 / 60.0)?;
    // The renderer: its shadow map.
    draw(&mut encoder, 1, &shadow_map, None);
    // Tresses: the light. The renderer's shader evaluates the shadow of hair from it.
    let shadow = SceneShadow { light: 0, depth: &shadow_map, part: None, projection: to_lamp, bias: 0.006 };
    tresses.frame(&mut encoder).light(&mut view, &[&ann], &picture, &[shadow])?;
    // The renderer: its image.
    draw(&mut encoder, 0, &depth, Some(view.light_group()));
    // Tresses: the hair over it.
    let into = HostFrame { is_lit: true, ..HostFrame::new(&color, &depth, camera.projection) };
    tresses.frame(&mut encoder).composite(&mut view, &[&ann], &picture, &embed, into)?;
    // The renderer: tone mapping.
    queue.submit([encoder.finish()]);
    let texels: Vec<[f16; 4]> =
        bytemuck::pod_collect_to_vec(&readback::texture(&tresses, color.texture()).await?);
    let tone = |x: f32| (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).powf(1.0 / 2.2);
    let bytes = texels.iter().flat_map(|[rgb @ .., _]| rgb.map(|x| (255.0 * tone(x.to_f32())) as u8));
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&bytes.collect::<Vec<_>>())?;
    Ok(())
}
