//! Shadows of hair on a host's scene, as a function for its shaders or as a pass over its color.
//!
//! ```text
//! hair's shadow maps ─┬─► tresses_left_by_hair(light, position, normal)     in the scene's own shaders
//!                     └─► a full-screen pass: color × light with / without hair
//! ```
//!
//! **The function** ([`wgsl`]) returns the fraction of a light that hair lets through, independent of bodies. A scene
//! that calls it for each light darkens only that light's contribution. It reads the shadow maps of the current frame,
//! so draw the hair, or record its [light](crate::frame::Recorder::light), first.
//!
//! **The pass** ([`HostFrame::shade`]) needs only the scene's depth. It reconstructs the position and normal of each
//! pixel's surface. It then multiplies the color by the ratio of the light on a matte white surface with and without
//! hair, from the lights that illuminate the hair. It cannot know which part of the color is emitted, reflected, or due
//! to other lights; those are darkened as well. Normals are per triangle.
//!
//! Both are as wide as the light's shadow map. Along the light's direction, the pass ends at a distance
//! ([`HostFrame::shade_range`]): it does not know the geometry in between, and would otherwise also darken the floor of the story
//! below. In the pass each zone casts its own
//! shadow; the function reads only the view's own maps.

use super::{HostFrame, has_samples};
use crate::{
    Context, Result,
    draw::canvas::Canvas,
    gpu::{
        Binding, Device, Uniform,
        bindings::layout,
        pipeline::{PipelineCache, Recipe, blended},
    },
    light, shaders,
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// WGSL for a scene's shaders: `tresses_left_by_hair(light: u32, position: vec3<f32>, normal: vec3<f32>) -> vec3<f32>`
/// returns, per channel, the fraction of a light that hair lets through to a point of a surface. `light` is
/// [`Light::id`](crate::light::Light::id); the result is 1 for lights without shadows or without a shadow map.
/// `position` (meters) and `normal` (unit) are in the space that hair is drawn in.
///
/// Its bindings are in `@group(group)`: bind [`View::light_group`](crate::View::light_group) with
/// [`View::light_layout`](crate::View::light_layout). All other names in the source begin with `package_`, `constants_`
/// or `structs_`.
pub fn wgsl(group: u32) -> String {
    shaders::source("draw::embed::shade::outside").replace("@group(0)", &format!("@group({group})"))
}

/// Uniform of the pass.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct ShadeUniform {
    /// From the scene's clip space, with its own depth, to view space.
    pub to_eye: Mat4,
    /// From view space to the world.
    pub to_world: Mat4,
    /// [`HostFrame::origin`].
    pub origin: [u32; 2],
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// [`HostFrame::shade`].
    pub strength: f32,
    /// [`HostFrame::shade_range`].
    pub range: f32,
    /// Depth of the scene's background, where nothing was drawn.
    pub nothing: f32,
    /// Unused.
    pub _pad: u32,
}

impl ShadeUniform {
    fn new(canvas: &Canvas<'_, '_>, into: &HostFrame<'_>) -> Self {
        let depth = |z: f32| into.projection.project_point3(Vec3::NEG_Z * z).z;
        Self {
            to_eye: into.projection.inverse(),
            to_world: canvas.camera.view.inverse(),
            origin: into.origin,
            size: canvas.target.size,
            strength: into.shade.clamp(0.0, 1.0),
            range: into.shade_range.max(0.0),
            nothing: if depth(2.0) > depth(1.0) { 1.0 } else { 0.0 },
            _pad: 0,
        }
    }
}

/// Pipelines and buffers of the pass.
#[derive(Debug)]
pub(super) struct Caster {
    device: Device,
    light: Arc<light::Pipelines>,
    format: wgpu::TextureFormat,
    /// For depth with one sample, and with several.
    layouts: [wgpu::BindGroupLayout; 2],
    pipelines: PipelineCache<bool, wgpu::RenderPipeline>,
    uniform: Uniform,
}

impl Caster {
    pub fn new(context: &Context, format: wgpu::TextureFormat) -> Self {
        let Context { device, .. } = context;
        let layout = |texture| {
            layout(device, "embed shade", wgpu::ShaderStages::FRAGMENT, &[Binding::Uniform, texture])
        };
        Self {
            device: device.clone(),
            light: context.pipelines(),
            format,
            layouts: [Binding::Depth, Binding::DepthMultisampled].map(layout),
            pipelines: PipelineCache::default(),
            uniform: device.uniform(size_of::<ShadeUniform>()),
        }
    }

    fn pipeline(&self, many: bool) -> Result<wgpu::RenderPipeline> {
        self.pipelines.get(many, || {
            let (module, entry) = match many {
                true => ("draw::embed::shade::shade_many", ["shade_many_vertex", "shade_many_fragment"]),
                false => ("draw::embed::shade::shade", ["shade_vertex", "shade_fragment"]),
            };
            Recipe {
                vertex: (module, entry[0]),
                fragment: Some((module, entry[1])),
                layouts: &[&self.light.frame, &self.layouts[usize::from(many)]],
                targets: &[blended(self.format, wgpu::BlendFactor::Dst, wgpu::BlendFactor::Zero)],
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }

    /// Darkens the scene's color where hair is between it and the lights.
    pub fn record(&self, canvas: &mut Canvas<'_, '_>, into: &HostFrame<'_>) -> Result<()> {
        // `max` turns NaN into 0, which casts no shadow.
        if into.shade.max(0.0) == 0.0 || into.shade_range.max(0.0) == 0.0 {
            return Ok(());
        }
        let many = has_samples(into.depth);
        let pipeline = self.pipeline(many)?;
        let values = ShadeUniform::new(canvas, into);
        self.uniform.write(0, bytemuck::bytes_of(&values));
        let bound = [self.uniform.as_entire_binding(), wgpu::BindingResource::TextureView(into.depth)];
        let own =
            canvas.commands.context().device.group("embed shade", &self.layouts[usize::from(many)], &bound);
        let parts = canvas.parts;
        let mut pass = into.pass(canvas);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(1, &own, &[]);
        for part in parts {
            pass.set_bind_group(0, &part.light.frame, &[]);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }
}
