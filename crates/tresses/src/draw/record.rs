//! Records the passes that draw bodies and hair into the targets of a view.

use super::{
    Pipelines, Targets,
    canvas::{Canvas, pass, record_parts},
};
use crate::{Result, body::Body, light::HairView, renderer::Renderer, stage::Stage};

impl Pipelines {
    /// Records the passes that find visible hair before shading. Only tiles have such passes.
    pub(crate) fn record_visibility(
        &self,
        targets: &Targets,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<()> {
        match canvas.renderer {
            Renderer::Tiles(_) => self.tiles.record_bins(targets.tiles()?, canvas, hair),
            _ => Ok(()),
        }
    }

    /// Shades only the visible hair, where the renderer knows it. Returns false if the caller must shade all hair.
    pub(crate) fn shade_visible(
        &self,
        targets: &Targets,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<bool> {
        if canvas.renderer.is_tiles() {
            self.tiles.record_shade(targets.tiles()?, canvas, hair)?;
        }
        Ok(canvas.renderer.is_tiles())
    }

    /// Records the hair. `clear` clears the targets first. Tiles and depth peeling draw over bodies and never clear
    /// them.
    pub(crate) fn record_hair(
        &self,
        targets: &Targets,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
        clear: bool,
    ) -> Result<()> {
        match canvas.renderer {
            Renderer::Tiles(_) => self.tiles.record_blend(targets.tiles()?, canvas, hair),
            Renderer::Masks(_) => self.masks.record(canvas, hair, clear),
            Renderer::Classic(options) => {
                self.classic.record(options, targets.layers.as_ref(), canvas, hair, clear)
            }
        }
    }

    /// Records bodies. Clears the targets if bodies [come first](Renderer::draws_bodies_first).
    pub(crate) fn record_bodies(
        &self,
        targets: &Targets,
        canvas: &mut Canvas<'_, '_>,
        bodies: &[&Body],
    ) -> Result<()> {
        let first = canvas.renderer.draws_bodies_first();
        if bodies.is_empty() && !first {
            return Ok(());
        }
        if bodies.is_empty() {
            pass(canvas, "body", first);
            return Ok(());
        }
        let samples = canvas.target.samples;
        let any = |painted: bool| bodies.iter().any(|body| body.is_painted() == painted);
        let near = canvas.parts.iter().any(|part| part.light.has_near_lights());
        let plain = any(false).then(|| self.body(samples, false, near)).transpose()?;
        let painted = any(true).then(|| self.body(samples, true, near)).transpose()?;
        let soft = targets.soft(canvas.light.max_lights());
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
            record_parts(&mut pass, parts, |pass, i| match bodies[i].is_painted() {
                painted if painted != is_painted => {}
                true => bodies[i].record_painted(pass, strays[i]),
                false => bodies[i].record(pass, strays[i]),
            });
        }
        Ok(())
    }
}
