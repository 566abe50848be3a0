//! The passes that put bodies and hair into the targets of a view.

use super::{Coverage, Pipelines, Targets, strips};
use crate::{
    Camera, Result,
    body::Body,
    gpu::commands::{Commands, colored, deep},
    light::{self, Part, Seen, ShadingRate, Sphere},
    space::Space,
    stage::Stage,
};

/// What the passes of a picture are recorded with.
pub(crate) struct Canvas<'a, 'c> {
    pub commands: &'a mut Commands<'c>,
    pub targets: &'a Targets,
    /// The view's `@group(0)`.
    pub frame: &'a wgpu::BindGroup,
    /// The camera's uniform that it has.
    pub eye: &'a wgpu::Buffer,
    /// The light that it has.
    pub light: &'a light::State,
    /// What is lit by which maps: one part without zones.
    pub parts: &'a [Part<'a>],
    pub camera: &'a Camera,
    /// The lights of the picture.
    pub lights: &'a light::Lights,
    /// Where pixels are small enough for what is smooth.
    pub focus: &'a Sphere,
    pub coverage: Coverage,
    pub rate: ShadingRate,
    /// Where a scene asks where hair is: the map of depths to its own, see [`super::tiles::geometry::GeometryUniform`].
    pub geometry: Option<[f32; 4]>,
    /// Whether somebody asks which strand each pixel shows.
    pub labels: bool,
    /// The space that everything is drawn in.
    pub space: Space,
}

impl Canvas<'_, '_> {
    /// How far the triangles of `body` may stray, metres: not so far that it is seen. From half a pixel to a third,
    /// 60 to 160 pixels of a portrait at the edges of lips and outlines change by more than 24 of 255, and triangles of
    /// fewer pixels take a software driver, which shades blocks of four by four, a quarter more time.
    pub fn stray(&self, body: &Body) -> f32 {
        const PIXELS: f32 = 0.5;
        PIXELS * body.nearest(self.camera) * self.camera.pixel() / self.targets.ssaa as f32
    }
}

impl Pipelines {
    /// Whether bodies are to be drawn before the hair.
    pub(crate) fn body_first(&self, coverage: Coverage) -> bool {
        coverage.is_tiled() || strips::body_first(coverage)
    }

    /// Records what is to be known of the hair before it is shaded: nothing but where it is drawn by tiles.
    pub(crate) fn record_seen(&self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) -> Result<()> {
        if !canvas.coverage.is_tiled() {
            return Ok(());
        }
        self.tiles.record_bins(canvas, hair)
    }

    /// Records the shading of what is seen, if that is known; else all is to be shaded.
    pub(crate) fn shade_seen(&self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) -> Result<bool> {
        if canvas.coverage.is_tiled() {
            self.tiles.record_shade(canvas, hair)?;
        }
        Ok(canvas.coverage.is_tiled())
    }

    /// Records hair; clears the targets unless bodies [come first](Self::body_first) or something is to stay.
    pub(crate) fn record_hair(
        &self,
        canvas: &mut Canvas<'_, '_>,
        hair: &[Seen<'_>],
        clear: bool,
    ) -> Result<()> {
        if canvas.coverage.is_tiled() {
            return self.tiles.record_blend(canvas, hair);
        }
        let strips = self.strips(canvas.coverage, canvas.targets.samples, canvas.rate)?;
        strips::record(&strips, canvas, hair, clear)
    }

    /// Records bodies; clears the targets when they [come first](Self::body_first).
    pub(crate) fn record_bodies(&self, canvas: &mut Canvas<'_, '_>, bodies: &[&Body]) -> Result<()> {
        let first = self.body_first(canvas.coverage);
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
            // Parts of the picture have changed it.
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

/// Records all bodies, each with the light of its part bound.
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

/// A pass into the HDR target with the view's group bound.
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
