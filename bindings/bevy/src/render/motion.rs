//! How hair moves, for what Bevy does with motion vectors: temporal antialiasing, motion blur.
//!
//! The prepass has written how its meshes have moved. After hair is drawn, the library tells where it is and how far it
//! has moved in each pixel (`Surroundings::geometry`); where hair hides more than half of what is behind, its motion takes
//! the place of that of the meshes, in Bevy's terms: parts of the picture, to the right and down.

use tresses::{
    draw::Embed,
    gpu::{Binding, bindings},
    wgpu::{self, TextureFormat, TextureUsages},
};

const SHADER: &str = "
@group(0) @binding(0) var known: texture_2d<f32>;

struct Corner { @builtin(position) clip: vec4<f32>, @location(0) place: vec2<f32> }

@vertex fn corner(@builtin(vertex_index) i: u32) -> Corner {
    let place = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Corner(vec4(place * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0), place);
}

@fragment fn moved(in: Corner) -> @location(0) vec2<f32> {
    let size = vec2<f32>(textureDimensions(known));
    let found = textureLoad(known, vec2<i32>(in.place * size), 0);
    if found.w < 0.5 { discard; }
    return found.xy / size;
}";

/// What a camera with motion vectors has for its hair.
#[derive(Debug)]
pub(super) struct Motion {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    /// What the library writes.
    pub known: wgpu::TextureView,
    size: [u32; 2],
    format: TextureFormat,
}

impl Motion {
    /// For pictures of `size`, into motion vectors of `format`.
    fn new(device: &wgpu::Device, size: [u32; 2], format: TextureFormat) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("where hair is"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: Embed::GEOMETRY,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let known = texture.create_view(&Default::default());
        let layout =
            bindings::layout(device, "motion of hair", wgpu::ShaderStages::FRAGMENT, &[Binding::Texels2d]);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("motion of hair"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("motion of hair"),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("motion of hair"),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("moved"),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let resources = [wgpu::BindingResource::TextureView(&known)];
        let group = bindings::group(device, "motion of hair", &layout, &resources);
        Self { pipeline, group, known, size, format }
    }

    /// That of a camera whose pictures are of `size`, made where it is not there or another.
    pub fn of<'a>(
        kept: &'a mut Option<Self>,
        device: &wgpu::Device,
        size: [u32; 2],
        format: TextureFormat,
    ) -> &'a Self {
        let fits = kept.as_ref().is_some_and(|motion| (motion.size, motion.format) == (size, format));
        if !fits {
            *kept = Some(Self::new(device, size, format));
        }
        kept.as_ref().expect("it has just been made")
    }

    /// Records the motion of what was drawn into `vectors`, where the picture begins at `origin`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, vectors: &wgpu::TextureView, origin: [u32; 2]) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("motion of hair"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: vectors,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        let [x, y, width, height] = [origin[0], origin[1], self.size[0], self.size[1]].map(|n| n as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
