//! Passes that write hair's motion vectors, depth and fog into a camera's targets.
//!
//! The prepass has written the motion of meshes, the main pass their depth. While drawing hair, the library writes the
//! hair's motion, depth and opacity into a texture ([`HostFrame::geometry`](tresses::HostFrame::geometry)). Where
//! hair covers more than half of the background, the passes write the hair's motion and depth over the scene's. Motion
//! is in Bevy's unit: fractions of the frame, to the right and down.
//!
//! Bevy's shaders apply fog to meshes while drawing them. The background of hair is thus already fogged. The fog in
//! front of hair is blended over the frame in proportion to the hair's opacity. That is exact for opaque hair and
//! approximate for thin hair.

use crate::extract::SceneFog;
use bevy::{
    math::{Mat4, Vec4},
    platform::collections::HashMap,
};
use tresses::{
    Compositor, Context,
    low_level::{Binding, bindings},
    wgpu::{self, TextureFormat, TextureUsages},
};

const SHADER: &str = "
struct Fog { from_clip: mat4x4<f32>, color: vec4<f32>, extinction: vec4<f32>, inscattering: vec4<f32> }
@group(0) @binding(0) var geometry: texture_2d<f32>;
@group(0) @binding(1) var<uniform> fog: Fog;

struct Corner { @builtin(position) clip: vec4<f32>, @location(0) uv: vec2<f32> }

@vertex fn corner(@builtin(vertex_index) i: u32) -> Corner {
    let uv = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Corner(vec4(uv * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0), uv);
}

fn found(uv: vec2<f32>) -> vec4<f32> {
    return textureLoad(geometry, vec2<i32>(uv * vec2<f32>(textureDimensions(geometry))), 0);
}

@fragment fn motion(in: Corner) -> @location(0) vec2<f32> {
    let texel = found(in.uv);
    if texel.w < 0.5 { discard; }
    return texel.xy / vec2<f32>(textureDimensions(geometry));
}

@fragment fn depth(in: Corner) -> @builtin(frag_depth) f32 {
    let texel = found(in.uv);
    if texel.w < 0.5 { discard; }
    return texel.z;
}

@fragment fn fogged(in: Corner) -> @location(0) vec4<f32> {
    let texel = found(in.uv);
    if texel.w <= 0.0 { discard; }
    let at = fog.from_clip * vec4(in.uv * vec2(2.0, -2.0) + vec2(-1.0, 1.0), texel.z, 1.0);
    let far = length(at.xyz / at.w);
    let power = fog.extinction.w;
    var attenuation = vec3(clamp((far - fog.extinction.x) / (fog.extinction.y - fog.extinction.x), 0.0, 1.0));
    var inscattered = attenuation;
    if power > 0.0 {
        attenuation = 1.0 - exp(-pow(far * fog.extinction.xyz, vec3(power)));
        inscattered = 1.0 - exp(-pow(far * fog.inscattering.xyz, vec3(power)));
    }
    let opacity = fog.color.w * texel.w;
    return vec4(fog.color.xyz * inscattered * opacity, opacity * dot(attenuation, vec3(1.0 / 3.0)));
}";

/// A pass of a camera, named after its fragment shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Overlay {
    Motion,
    Depth,
    Fog,
}

/// A target: view, format and samples per pixel.
pub(super) type OverlayTarget<'a> = (&'a wgpu::TextureView, TextureFormat, u32);

/// Targets of a camera that hair is written into.
#[derive(Clone, Copy)]
pub(super) struct OverlayTargets<'a> {
    /// Motion vectors, single-sampled.
    pub motion: Option<OverlayTarget<'a>>,
    /// The scene's depth.
    pub depth: Option<OverlayTarget<'a>>,
    /// The color target for fog.
    pub fog: Option<(OverlayTarget<'a>, SceneFog)>,
}

impl OverlayTargets<'_> {
    /// Whether there are any targets.
    pub fn any(&self) -> bool {
        self.motion.is_some() || self.depth.is_some() || self.fog.is_some()
    }
}

/// Resources of a camera's passes.
#[derive(Debug)]
pub(super) struct Overlays {
    /// Texture into which the library writes motion, depth and opacity.
    pub geometry: wgpu::TextureView,
    /// Size of the texture.
    pub size: [u32; 2],
    fog: wgpu::Buffer,
    group: wgpu::BindGroup,
    layout: wgpu::PipelineLayout,
    module: wgpu::ShaderModule,
    pipelines: HashMap<(Overlay, TextureFormat, u32), wgpu::RenderPipeline>,
}

impl Overlays {
    /// Creates the resources for frames of `size`.
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        const LABEL: &str = "hair geometry";
        let label = Some(LABEL);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label,
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Compositor::GEOMETRY,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let geometry = texture.create_view(&Default::default());
        let fog = bindings::uniform_buffer(device, LABEL, size_of::<[Vec4; 7]>());
        let entries = [Binding::Texels2d, Binding::Uniform];
        let bound = bindings::layout(device, LABEL, wgpu::ShaderStages::FRAGMENT, &entries);
        let resources = [wgpu::BindingResource::TextureView(&geometry), fog.as_entire_binding()];
        let group = bindings::group(device, LABEL, &bound, &resources);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&bound)],
            immediate_size: 0,
        });
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
        Self { geometry, size, fog, group, layout, module, pipelines: HashMap::default() }
    }

    /// Records all passes. `origin` is the frame's corner in the targets.
    pub fn record(
        &mut self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        targets: &OverlayTargets<'_>,
        (origin, projection): ([u32; 2], Mat4),
    ) {
        if let Some(target) = targets.motion {
            self.pass(context, encoder, (Overlay::Motion, target), origin);
        }
        if let Some(target) = targets.depth {
            self.pass(context, encoder, (Overlay::Depth, target), origin);
        }
        if let Some((target, SceneFog { color, extinction, inscattering })) = targets.fog {
            let from_clip = projection.inverse();
            let words = [
                from_clip.x_axis,
                from_clip.y_axis,
                from_clip.z_axis,
                from_clip.w_axis,
                color,
                extinction,
                inscattering,
            ];
            let bytes: Vec<u8> = words.iter().flat_map(Vec4::to_array).flat_map(f32::to_le_bytes).collect();
            context.queue().write_buffer(&self.fog, 0, &bytes);
            self.pass(context, encoder, (Overlay::Fog, target), origin);
        }
    }

    fn pass(
        &mut self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        (overlay, (view, format, samples)): (Overlay, OverlayTarget<'_>),
        origin: [u32; 2],
    ) {
        let Self { size, group, layout, module, pipelines, .. } = self;
        let pipeline = pipelines
            .entry((overlay, format, samples))
            .or_insert_with(|| pipeline(context.device(), layout, module, overlay, format, samples));
        let ops = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
        let color = wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops };
        let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store });
        let depth = wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None };
        let (color, depth) = match overlay {
            Overlay::Depth => (None, Some(depth)),
            _ => (Some(color), None),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("hair geometry"),
            color_attachments: if color.is_some() { std::slice::from_ref(&color) } else { &[] },
            depth_stencil_attachment: depth,
            ..Default::default()
        });
        let [x, y, width, height] = [origin[0], origin[1], size[0], size[1]].map(|n| n as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &*group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Creates the pipeline of a pass for a target format and sample count.
fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    overlay: Overlay,
    format: TextureFormat,
    count: u32,
) -> wgpu::RenderPipeline {
    let entry = match overlay {
        Overlay::Motion => "motion",
        Overlay::Depth => "depth",
        Overlay::Fog => "fogged",
    };
    let component = |src_factor, dst_factor| wgpu::BlendComponent {
        src_factor,
        dst_factor,
        operation: wgpu::BlendOperation::Add,
    };
    let over = wgpu::BlendState {
        color: component(wgpu::BlendFactor::One, wgpu::BlendFactor::OneMinusSrcAlpha),
        // Keep the alpha of the frame.
        alpha: component(wgpu::BlendFactor::Zero, wgpu::BlendFactor::One),
    };
    let blend = (overlay == Overlay::Fog).then_some(over);
    let color = Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL });
    let is_depth = overlay == Overlay::Depth;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(entry),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: is_depth.then(|| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            // Bevy uses reversed depth: 1 at the near plane.
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets: if is_depth { &[] } else { std::slice::from_ref(&color) },
        }),
        multiview_mask: None,
        cache: None,
    })
}
