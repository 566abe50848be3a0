//! Where hair is, for what Bevy does after it: motion vectors for temporal antialiasing and motion blur, depth for depth of
//! field, and fog.
//!
//! The prepass has written how its meshes have moved, the main pass how deep they are. After hair is drawn, the library
//! tells where it is and how far it has moved in each pixel (`Surroundings::geometry`); where hair hides more than half of
//! what is behind, its motion and its depth take the place of those of the meshes, motion in Bevy's terms: parts of the
//! picture, to the right and down.

use super::fog::{Fog, Fogged};
use bevy::math::Mat4;
use tresses::{
    draw::Embed,
    gpu::{Binding, bindings},
    wgpu::{self, TextureFormat, TextureUsages},
};

/// A triangle over a picture, and what is known at a place of it.
pub(super) const VERTEX: &str = "
@group(0) @binding(0) var known: texture_2d<f32>;

struct Corner { @builtin(position) clip: vec4<f32>, @location(0) place: vec2<f32> }

@vertex fn corner(@builtin(vertex_index) i: u32) -> Corner {
    let place = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Corner(vec4(place * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0), place);
}

fn found(place: vec2<f32>) -> vec4<f32> {
    return textureLoad(known, vec2<i32>(place * vec2<f32>(textureDimensions(known))), 0);
}";

const FRAGMENTS: &str = "
@fragment fn moved(in: Corner) -> @location(0) vec2<f32> {
    let here = found(in.place);
    if here.w < 0.5 { discard; }
    return here.xy / vec2<f32>(textureDimensions(known));
}

@fragment fn deep(in: Corner) -> @builtin(frag_depth) f32 {
    let here = found(in.place);
    if here.w < 0.5 { discard; }
    return here.z;
}";

/// Where it is to be told.
#[derive(Clone, Copy)]
pub(super) struct Targets<'a> {
    /// Motion vectors of one sample per pixel, and their format.
    pub motion: Option<(&'a wgpu::TextureView, TextureFormat)>,
    /// The scene's depth.
    pub depth: Option<(&'a wgpu::TextureView, Depth)>,
    /// The picture that fog goes over, and its format.
    pub fog: Option<(&'a wgpu::TextureView, TextureFormat, Fog)>,
}

/// The kind of a depth target: its format and its samples per pixel.
pub(super) type Depth = (TextureFormat, u32);

impl Targets<'_> {
    /// Whether there is any.
    pub fn any(&self) -> bool {
        self.motion.is_some() || self.depth.is_some() || self.fog.is_some()
    }
}

/// What a camera has for telling where its hair is.
#[derive(Debug)]
pub(super) struct Known {
    /// What the library writes.
    pub view: wgpu::TextureView,
    size: [u32; 2],
    group: wgpu::BindGroup,
    layout: wgpu::PipelineLayout,
    module: wgpu::ShaderModule,
    motion: Option<(TextureFormat, wgpu::RenderPipeline)>,
    depth: Option<(Depth, wgpu::RenderPipeline)>,
    fog: Option<Fogged>,
}

impl Known {
    /// For pictures of `size`.
    fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let label = Some("where hair is");
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label,
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Embed::GEOMETRY,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let bound =
            bindings::layout(device, "where hair is", wgpu::ShaderStages::FRAGMENT, &[Binding::Texels2d]);
        let group =
            bindings::group(device, "where hair is", &bound, &[wgpu::BindingResource::TextureView(&view)]);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&bound)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl([VERTEX, FRAGMENTS].concat().into()),
        });
        Self { view, size, group, layout, module, motion: None, depth: None, fog: None }
    }

    /// That of a camera whose pictures are of `size`, with what these targets need, made where it is not there or another.
    pub fn of<'a>(
        kept: &'a mut Option<Self>,
        device: &wgpu::Device,
        size: [u32; 2],
        targets: &Targets<'_>,
    ) -> &'a Self {
        let known = match kept.take() {
            Some(known) if known.size == size => known,
            _ => Self::new(device, size),
        };
        let known = kept.insert(known);
        if let Some((_, format)) = targets.motion
            && known.motion.as_ref().is_none_or(|(of, _)| *of != format)
        {
            let target = Some(format.into());
            known.motion = Some((format, pipeline(device, known.shader(), "moved", &[target], None)));
        }
        if let Some((_, kind)) = targets.depth
            && known.depth.as_ref().is_none_or(|(of, _)| *of != kind)
        {
            known.depth = Some((kind, pipeline(device, known.shader(), "deep", &[], Some(kind))));
        }
        if let Some((_, format, _)) = targets.fog
            && known.fog.as_ref().is_none_or(|fog| fog.format != format)
        {
            known.fog = Some(Fogged::new(device, &known.view, format));
        }
        known
    }

    fn shader(&self) -> Shader<'_> {
        (&self.layout, &self.module)
    }

    /// Records what is known of what was drawn into targets where the picture, seen with `projection`, begins at `origin`.
    pub fn record(
        &self,
        (queue, encoder): (&wgpu::Queue, &mut wgpu::CommandEncoder),
        targets: &Targets<'_>,
        (origin, projection): ([u32; 2], Mat4),
    ) {
        if let (Some((view, _)), Some((_, pipeline))) = (targets.motion, &self.motion) {
            let mut pass = self.pass(encoder, &[Some(over(view))], None, origin);
            self.draw(&mut pass, pipeline);
        }
        if let (Some((view, _)), Some((_, pipeline))) = (targets.depth, &self.depth) {
            let depth = wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            };
            let mut pass = self.pass(encoder, &[], Some(depth), origin);
            self.draw(&mut pass, pipeline);
        }
        if let (Some((view, _, fog)), Some(fogged)) = (&targets.fog, &self.fog) {
            let mut pass = self.pass(encoder, &[Some(over(view))], None, origin);
            fogged.draw(queue, &mut pass, fog, projection);
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        origin: [u32; 2],
    ) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("where hair is"),
            color_attachments,
            depth_stencil_attachment,
            ..Default::default()
        });
        let [x, y, width, height] = [origin[0], origin[1], self.size[0], self.size[1]].map(|n| n as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass
    }
}

/// What a shader binds, and the shader, which begins with [`VERTEX`].
pub(super) type Shader<'a> = (&'a wgpu::PipelineLayout, &'a wgpu::ShaderModule);

/// The pipeline of an entry that is drawn as a triangle over a picture, into `targets` or as `depth`.
pub(super) fn pipeline(
    device: &wgpu::Device,
    (layout, module): Shader<'_>,
    entry: &str,
    targets: &[Option<wgpu::ColorTargetState>],
    depth: Option<Depth>,
) -> wgpu::RenderPipeline {
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
        depth_stencil: depth.map(|(format, _)| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            // Bevy's depth is 1 at the eye.
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: depth.map_or(1, |(_, samples)| samples),
            ..Default::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A target that is drawn over.
fn over(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
    }
}
