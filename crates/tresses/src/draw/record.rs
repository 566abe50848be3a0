//! Records the passes that draw bodies and hair into the targets of a view.

use super::{Pipelines, Targets};
use crate::{
    Camera, Result,
    body::Body,
    gpu::commands::{Commands, colored, deep},
    light::{self, HairView, Part, Sphere},
    renderer::Renderer,
    space::Space,
    stage::Stage,
};

/// Inputs of the draw passes of one view.
pub(crate) struct Canvas<'a, 'c> {
    pub commands: &'a mut Commands<'c>,
    pub targets: &'a Targets,
    /// Bind group 0 of the view.
    pub frame: &'a wgpu::BindGroup,
    /// Camera uniform of the view.
    pub eye: &'a wgpu::Buffer,
    /// Light state of the view.
    pub light: &'a light::LightState,
    /// Grooms and bodies of each light zone; a single part without zones.
    pub parts: &'a [Part<'a>],
    pub camera: &'a Camera,
    /// Lights of the frame.
    pub lights: &'a light::Lights,
    /// Focus of the view. Sets the spacing of the shading points on bodies (`draw::soft`).
    pub focus: &'a Sphere,
    pub renderer: Renderer,
    /// Coefficients of the map from the view's depth to the scene's, if hair geometry is requested. See
    /// [`super::tiles::geometry::GeometryUniform`].
    pub geometry: Option<[f32; 4]>,
    /// Whether per-pixel strand labels are requested.
    pub labels: bool,
    /// Space of all drawn positions.
    pub space: Space,
}

impl Canvas<'_, '_> {
    /// Largest acceptable simplification error of `body`, meters: half a pixel at its nearest point. With a third of a
    /// pixel, 60 to 160 pixels of a portrait, at lips and outlines, change by more than 24 of 255. A software driver
    /// then takes a quarter more time, since it shades blocks of 4×4 pixels and the triangles are smaller.
    pub fn stray(&self, body: &Body) -> f32 {
        const PIXELS: f32 = 0.5;
        PIXELS * body.nearest(self.camera) * self.camera.pixel() / self.targets.ssaa as f32
    }
}

impl Pipelines {
    /// Records the passes that find visible hair before shading. Only tiles have such passes.
    pub(crate) fn record_seen(&self, canvas: &mut Canvas<'_, '_>, hair: &[HairView<'_>]) -> Result<()> {
        match canvas.renderer {
            Renderer::Tiles(_) => self.tiles.record_bins(canvas, hair),
            _ => Ok(()),
        }
    }

    /// Shades only the visible hair, where the renderer knows it. Returns false if the caller must shade all hair.
    pub(crate) fn shade_seen(&self, canvas: &mut Canvas<'_, '_>, hair: &[HairView<'_>]) -> Result<bool> {
        if canvas.renderer.is_tiles() {
            self.tiles.record_shade(canvas, hair)?;
        }
        Ok(canvas.renderer.is_tiles())
    }

    /// Records the hair. `clear` clears the targets first. Tiles and depth peeling draw over bodies and never clear
    /// them.
    pub(crate) fn record_hair(
        &self,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
        clear: bool,
    ) -> Result<()> {
        match canvas.renderer {
            Renderer::Tiles(_) => self.tiles.record_blend(canvas, hair),
            Renderer::Masks(_) => self.masks.record(canvas, hair, clear),
            Renderer::Classic(options) => self.classic.record(options, canvas, hair, clear),
        }
    }

    /// Records bodies. Clears the targets if bodies [come first](Renderer::draws_bodies_first).
    pub(crate) fn record_bodies(&self, canvas: &mut Canvas<'_, '_>, bodies: &[&Body]) -> Result<()> {
        let first = canvas.renderer.draws_bodies_first();
        if bodies.is_empty() && !first {
            return Ok(());
        }
        if bodies.is_empty() {
            pass(canvas, "body", first);
            return Ok(());
        }
        let samples = canvas.targets.samples;
        let any = |painted: bool| bodies.iter().any(|body| body.is_painted() == painted);
        let plain = any(false).then(|| self.body(samples, false)).transpose()?;
        let painted = any(true).then(|| self.body(samples, true)).transpose()?;
        let soft = canvas.targets.soft();
        soft.record(&self.soft, canvas, bodies)?;
        canvas.commands.lap(Stage::Body);
        let strays: Vec<_> = bodies.iter().map(|body| canvas.stray(body)).collect();
        let parts = canvas.parts;
        let mut pass = pass(canvas, "body", first);
        for (pipeline, is_painted) in [(plain, false), (painted, true)] {
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(&pipeline);
            // The other pipeline may have left another zone's light bound.
            if let Some(part) = parts.first() {
                pass.set_bind_group(0, &part.light.frame, &[]);
            }
            pass.set_bind_group(2, &soft.group, &[]);
            canvas_parts(&mut pass, parts, |pass, i| match bodies[i].is_painted() {
                painted if painted != is_painted => {}
                true => bodies[i].record_painted(pass, strays[i]),
                false => bodies[i].record(pass, strays[i]),
            });
        }
        Ok(())
    }
}

/// Calls `record` for each body index, with the light of the body's zone bound as group 0.
pub(super) fn canvas_parts(
    pass: &mut crate::gpu::RenderPass<'_>,
    parts: &[Part<'_>],
    mut record: impl FnMut(&mut crate::gpu::RenderPass<'_>, usize),
) {
    for part in parts {
        if part.number > 0 && !part.bodies.is_empty() {
            pass.set_bind_group(0, &part.light.frame, &[]);
        }
        part.bodies.iter().for_each(|i| record(pass, *i));
    }
}

/// Begins a pass into the HDR target with the view's bind group set.
pub(crate) fn pass<'e>(
    canvas: &'e mut Canvas<'_, '_>,
    name: &'static str,
    clear: bool,
) -> crate::gpu::RenderPass<'e> {
    let color = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    let depth = if clear { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
    let depth = wgpu::Operations { load: depth, store: wgpu::StoreOp::Store };
    let targets = canvas.targets;
    let (color, depth) = (colored(&targets.hdr, color), deep(&targets.depth, Some(depth)));
    let mut pass = canvas.commands.render(name, &[color], depth);
    pass.set_bind_group(0, canvas.frame, &[]);
    pass
}
