//! Bevy's fog before hair: its shader fogs meshes where it draws them, and hair comes after that.
//!
//! What is behind hair has its own fog. The fog before hair goes over the picture as thick as hair is opaque, by how far the
//! library says that it is: exact where hair hides what is behind, and nearly so where it is thin.

use super::known::{VERTEX, pipeline};
use bevy::math::{Mat4, Vec3, Vec4};
use tresses::{
    gpu::{Binding, bindings},
    wgpu::{self, TextureFormat},
};

/// How light is lost, and fog seen, with the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "pbr"), expect(dead_code))] // Fog is that feature's.
pub(crate) enum Thickness {
    /// From nothing at the first distance to all at the second, metres.
    Linear(f32, f32),
    /// By this power of the distance times what is lost, and what is seen of the fog, per metre.
    Exponential { power: f32, lost: Vec3, seen: Vec3 },
}

/// A camera's fog.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fog {
    /// Linear colour, and how much of all of it there is.
    pub color: Vec4,
    pub thickness: Thickness,
}

impl Fog {
    /// As the shader has it, behind the way from the picture to the eye.
    fn words(&self, from_clip: Mat4) -> [f32; 28] {
        let (mode, a, b) = match self.thickness {
            Thickness::Linear(start, end) => (0.0, Vec3::new(start, end, 0.0), Vec3::ZERO),
            Thickness::Exponential { power, lost, seen } => (power, lost, seen),
        };
        let mut words = [0.0; 28];
        words[..16].copy_from_slice(&from_clip.to_cols_array());
        words[16..20].copy_from_slice(&self.color.to_array());
        words[20..24].copy_from_slice(&a.extend(mode).to_array());
        words[24..].copy_from_slice(&b.extend(0.0).to_array());
        words
    }
}

const FRAGMENT: &str = "
struct Fog { from_clip: mat4x4<f32>, color: vec4<f32>, lost: vec4<f32>, seen: vec4<f32> }
@group(0) @binding(1) var<uniform> fog: Fog;

@fragment fn thick(in: Corner) -> @location(0) vec4<f32> {
    let here = found(in.place);
    if here.w <= 0.0 { discard; }
    let at = fog.from_clip * vec4(in.place * vec2(2.0, -2.0) + vec2(-1.0, 1.0), here.z, 1.0);
    let far = length(at.xyz / at.w);
    let power = fog.lost.w;
    var lost = vec3(clamp((far - fog.lost.x) / (fog.lost.y - fog.lost.x), 0.0, 1.0));
    var seen = lost;
    if power > 0.0 {
        lost = 1.0 - exp(-pow(far * fog.lost.xyz, vec3(power)));
        seen = 1.0 - exp(-pow(far * fog.seen.xyz, vec3(power)));
    }
    let share = fog.color.w * here.w;
    return vec4(fog.color.xyz * seen * share, share * dot(lost, vec3(1.0 / 3.0)));
}";

/// What a camera with fog has for its hair.
#[derive(Debug)]
pub(super) struct Fogged {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    uniform: wgpu::Buffer,
    pub format: TextureFormat,
}

impl Fogged {
    /// For hair that is `known`, over pictures of `format`.
    pub fn new(device: &wgpu::Device, known: &wgpu::TextureView, format: TextureFormat) -> Self {
        let label = Some("fog before hair");
        let entries = [Binding::Texels2d, Binding::Uniform];
        let bound = bindings::layout(device, "fog before hair", wgpu::ShaderStages::FRAGMENT, &entries);
        let uniform = bindings::uniform(device, "fog before hair", 4 * 28);
        let resources = [wgpu::BindingResource::TextureView(known), uniform.as_entire_binding()];
        let group = bindings::group(device, "fog before hair", &bound, &resources);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl([VERTEX, FRAGMENT].concat().into()),
        });
        let over = |src_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
            operation: wgpu::BlendOperation::Add,
        };
        // The picture is as opaque as it was.
        let alpha = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = Some(wgpu::BlendState { color: over(wgpu::BlendFactor::One), alpha });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&bound)],
            immediate_size: 0,
        });
        let target = wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL };
        let pipeline = pipeline(device, (&layout, &module), "thick", &[Some(target)], None);
        Self { pipeline, group, uniform, format }
    }

    /// Draws the fog into a pass over the picture that was seen with `projection`.
    pub fn draw(&self, queue: &wgpu::Queue, pass: &mut wgpu::RenderPass<'_>, fog: &Fog, projection: Mat4) {
        let words = fog.words(projection.inverse());
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        queue.write_buffer(&self.uniform, 0, &bytes);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
