//! The shadow of hair on a host's scene: as a function for its shaders, or as a pass over its colour.
//!
//! ```text
//! hair's shadow maps ─┬─► tresses_left_by_hair(light, position, normal)     in the scene's own shaders
//!                     └─► a triangle over the picture: colour × with / without
//! ```
//!
//! **The function** ([`wgsl`]) says what hair leaves of a light, whatever bodies leave of it: a scene that asks it for each
//! light darkens what that light gives and nothing else. It needs the maps of this frame, so that hair is drawn, or
//! [lit](crate::frame::Recorder::light), before.
//!
//! **The pass** ([`Surroundings::shade`]) needs nothing of the scene but its depth. It finds where each pixel's surface
//! is and how it is turned, and multiplies its colour by the light that a matt white surface there has with hair over that
//! without, among the lights that light the hair. What it cannot know is which part of the colour is emitted, mirrored, or
//! the light of others: that is darkened alike. Normals are those of triangles.
//!
//! Either reaches as far aside as a light's map is wide. Along the light's way the pass ends at a distance
//! ([`Shade::reach`]): it does not know what is between, and goes through a floor to the one below. A lamp's shadow spreads
//! with distance, this one does not. In the pass each zone casts its own; the function asks one.

use super::{Surroundings, has_samples};
use crate::{
    Context, Result,
    draw::record::Canvas,
    gpu::{
        Binding, Device,
        bindings::{layout, uniform},
        pipeline::{Made, Recipe, blended},
    },
    light::{self, lights::MAX_LIGHTS},
    shaders,
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::sync::Arc;

/// WGSL for a scene's shaders: `tresses_left_by_hair(light: u32, position: vec3<f32>, normal: vec3<f32>) -> vec3<f32>` is
/// the share of a light (of those that are on) that hair leaves at a point of a surface, of each channel; position (metres)
/// and normal (unit) are in the space that hair is drawn in. Bindings are those of `@group(group)`:
/// [`View::light_group`](crate::View::light_group) with [`View::light_layout`](crate::View::light_layout).
/// All other names in it begin with `package_`, `constants_` or `structs_`.
pub fn wgsl(group: u32) -> String {
    shaders::source("draw::embed::shade::outside").replace("@group(0)", &format!("@group({group})"))
}

/// How hair casts its shadow on a scene by a pass over its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shade {
    /// How much of it, 0 to 1.
    pub strength: f32,
    /// How far behind the hair's maps it falls, metres; it ends softly over the last quarter.
    pub reach: f32,
    /// Which of [`Lights::directional`](crate::light::Lights::directional) hair casts a shadow of.
    pub lights: [bool; MAX_LIGHTS],
}

impl Default for Shade {
    /// All of it, of all lights, as far as a floor is from a head.
    fn default() -> Self {
        Self { strength: 1.0, reach: 2.5, lights: [true; MAX_LIGHTS] }
    }
}

/// What the shader knows of the scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ShadeUniform {
    /// From the clip space of the scene, with its own depth, to that of the eye.
    pub to_eye: Mat4,
    /// From the eye to the world.
    pub to_world: Mat4,
    /// [`Surroundings::origin`].
    pub origin: [u32; 2],
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// [`Shade::strength`].
    pub strength: f32,
    /// [`Shade::reach`].
    pub reach: f32,
    /// The scene's depth of where nothing is.
    pub nothing: f32,
    /// A bit for each light that is on, if hair casts its shadow.
    pub lights: u32,
}

impl ShadeUniform {
    fn new(shade: &Shade, canvas: &Canvas<'_, '_>, into: &Surroundings<'_>) -> Self {
        let depth = |z: f32| into.projection.project_point3(Vec3::NEG_Z * z).z;
        let is_on = canvas.lights.directional.iter().zip(shade.lights).filter(|(light, _)| light.is_on());
        let bits = is_on.enumerate().map(|(i, (_, casts))| u32::from(casts) << i);
        Self {
            to_eye: into.projection.inverse(),
            to_world: canvas.camera.view.inverse(),
            origin: into.origin,
            size: canvas.targets.size,
            strength: shade.strength.clamp(0.0, 1.0),
            reach: shade.reach.max(0.0),
            nothing: if depth(2.0) > depth(1.0) { 1.0 } else { 0.0 },
            lights: bits.sum(),
        }
    }
}

/// What casts the shadow.
#[derive(Debug)]
pub(super) struct Caster {
    device: Device,
    light: Arc<light::Pipelines>,
    format: wgpu::TextureFormat,
    /// For depth of one sample, and of several.
    layouts: [wgpu::BindGroupLayout; 2],
    pipelines: Made<bool, wgpu::RenderPipeline>,
    uniform: wgpu::Buffer,
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
            pipelines: Made::default(),
            uniform: uniform(device, "embed shade", size_of::<ShadeUniform>()),
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

    /// Darkens the scene's colour where hair is between it and the lights.
    pub fn record(&self, canvas: &mut Canvas<'_, '_>, into: &Surroundings<'_>) -> Result<()> {
        // What is no number casts none.
        let casts = |shade: &Shade| shade.strength.max(0.0) > 0.0 && shade.reach.max(0.0) > 0.0;
        let Some(shade) = into.shade.filter(casts) else { return Ok(()) };
        let many = has_samples(into.depth);
        let pipeline = self.pipeline(many)?;
        let values = ShadeUniform::new(&shade, canvas, into);
        canvas.commands.context().queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&values));
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
