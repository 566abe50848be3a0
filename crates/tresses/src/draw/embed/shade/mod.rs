//! The shadow of hair on a host's scene: as a function for its shaders, or as a pass over its colour.
//!
//! ```text
//! hair's shadow maps ─┬─► tresses_left_by_hair(light, position, normal)     in the scene's own shaders
//!                     └─► a triangle over the picture: colour × with / without
//! ```
//!
//! **The function** ([`wgsl`]) is exact: a scene that asks it for each light darkens what that light gives and nothing
//! else. It needs the maps of this frame, so that hair is drawn, or [lit](crate::frame::Recorder::light), before.
//!
//! **The pass** ([`Surroundings::shade`]) needs nothing of the scene but its depth. It finds where each pixel's surface
//! is and how it is turned, and multiplies its colour by the light that a matt white surface there has with hair over that
//! without, among the lights that light the hair. What it cannot know is which part of the colour is emitted, mirrored, or
//! the light of others: that is darkened alike. Normals are those of triangles.
//!
//! Either reaches as far as a light's map is wide, along the light's way as far as there is something: from the hair to
//! the floor. A lamp's shadow spreads with distance, this one does not. Each zone casts its own.

use super::{Surroundings, has_samples};
use crate::{
    Result,
    draw::record::Canvas,
    gpu::{
        Binding,
        bindings::{group, layout, uniform},
        pipeline::{Made, Recipe, blended},
    },
    light, shaders,
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4};

/// WGSL for a scene's shaders: `tresses_left_by_hair(light: u32, position: vec3<f32>, normal: vec3<f32>) -> vec3<f32>` is
/// the share of a light (of those that are on) that hair leaves at a point of a surface, of each channel; position (metres)
/// and normal (unit) are in the space that hair is drawn in. Bindings are those of `@group(group)`:
/// [`View::light_group`](crate::View::light_group) with [`Pipelines::light_layout`](crate::Pipelines::light_layout).
/// All other names in it begin with `package_`, or are those of its bindings.
pub fn wgsl(group: u32) -> String {
    shaders::source("draw::embed::shade::outside").replace("@group(0)", &format!("@group({group})"))
}

/// What the shader knows of the scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ShadeUniform {
    /// From the clip space of the scene, with its own depth, to the world.
    pub to_world: Mat4,
    /// Where the eye is (1), or the direction towards it where it is infinitely far (0).
    pub eye: Vec4,
    /// [`Surroundings::origin`].
    pub origin: [u32; 2],
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// [`Surroundings::shade`].
    pub strength: f32,
    /// Unused.
    pub _pad_a: u32,
    /// Unused.
    pub _pad_b: u32,
    /// Unused.
    pub _pad_c: u32,
}

impl ShadeUniform {
    fn new(canvas: &Canvas<'_>, into: &Surroundings<'_>) -> Self {
        let view = canvas.camera.view;
        let from_eye = view.inverse();
        // Of an orthographic projection w is 1 everywhere.
        let eye = if into.projection.w_axis.w == 0.0 { from_eye.w_axis } else { from_eye.z_axis };
        Self {
            to_world: (into.projection * view).inverse(),
            eye,
            origin: into.origin,
            size: canvas.targets.size,
            strength: into.shade.clamp(0.0, 1.0),
            _pad_a: 0,
            _pad_b: 0,
            _pad_c: 0,
        }
    }
}

/// What casts the shadow.
#[derive(Debug)]
pub(super) struct Shade {
    format: wgpu::TextureFormat,
    /// For depth of one sample, and of several.
    layouts: [wgpu::BindGroupLayout; 2],
    pipelines: Made<bool, wgpu::RenderPipeline>,
    uniform: wgpu::Buffer,
}

impl Shade {
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = |texture| {
            layout(device, "embed shade", wgpu::ShaderStages::FRAGMENT, &[Binding::Uniform, texture])
        };
        Self {
            format,
            layouts: [Binding::Depth, Binding::DepthMultisampled].map(layout),
            pipelines: Made::default(),
            uniform: uniform(device, "embed shade", size_of::<ShadeUniform>()),
        }
    }

    fn pipeline(
        &self,
        device: &wgpu::Device,
        light: &light::Pipelines,
        many: bool,
    ) -> Result<wgpu::RenderPipeline> {
        self.pipelines.get(many, || {
            let (module, entry) = match many {
                true => ("draw::embed::shade::shade_many", ["shade_many_vertex", "shade_many_fragment"]),
                false => ("draw::embed::shade::shade", ["shade_vertex", "shade_fragment"]),
            };
            Recipe {
                vertex: (module, entry[0]),
                fragment: Some((module, entry[1])),
                layouts: &[&light.frame, &self.layouts[usize::from(many)]],
                targets: &[blended(self.format, wgpu::BlendFactor::Dst, wgpu::BlendFactor::Zero)],
                ..Recipe::PLAIN
            }
            .build(device)
        })
    }

    /// Darkens the scene's colour where hair is between it and the lights.
    pub fn record(
        &self,
        canvas: &mut Canvas<'_>,
        light: &light::Pipelines,
        into: &Surroundings<'_>,
    ) -> Result<()> {
        // What is no number casts none.
        if into.shade.max(0.0) == 0.0 {
            return Ok(());
        }
        let many = has_samples(into.depth);
        let pipeline = self.pipeline(canvas.device, light, many)?;
        let values = ShadeUniform::new(canvas, into);
        canvas.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&values));
        let bound = [self.uniform.as_entire_binding(), wgpu::BindingResource::TextureView(into.depth)];
        let own = group(canvas.device, "embed shade", &self.layouts[usize::from(many)], &bound);
        let parts = canvas.parts;
        let mut pass = into.pass(canvas, "embed shade");
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(1, &own, &[]);
        for part in parts {
            pass.set_bind_group(0, &part.light.frame, &[]);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }
}
