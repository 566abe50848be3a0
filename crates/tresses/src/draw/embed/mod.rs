//! Composites hair over a host application's scene: over its linear color target, occluded by its depth.
//!
//! ```text
//! scene's depth ─► depth in the hair's projection ─► hair ─► HDR ─► composite ─► scene's color
//! ```
//!
//! The scene keeps its format, its sample count and its depth convention. Its depth is converted, pixel by pixel, from
//! the scene's projection to the [`Camera`](crate::Camera)'s. The hair is then drawn with the samples of its own view
//! and blended over the scene's color, resolved to one sample, so that thin hair stays thin.
//!
//! If a pixel of the scene has several depths, the hair is tested against the farthest. The nearest would leave an
//! outline of the background around every object in front of the hair. Hair drawn by [`Renderer::Tiles`], whose depth
//! is known, is also weighted by the fraction of the samples that it is in front of, so that edges in front of hair
//! stay smooth.
//!
//! Cards are in the HDR target and composited before the strands. They are not in the output of geometry.
//!
//! The scene's depth is not written. [`HostFrame::geometry`] can output the motion, depth and opacity of the visible
//! hair in each pixel, for fog, depth of field and temporal antialiasing. Transparent surfaces drawn later blend as if
//! there were no hair, whether they are in front of it or behind.
//!
//! Rejected: drawing strips into the scene's own target. Pipelines would depend on its format and sample count, and
//! coverage with one sample per pixel would need smoothing afterwards.

pub mod shade;

use super::{
    canvas::{Canvas, HDR_FORMAT, HdrTarget, pass},
    tiles::{Tiles, geometry},
};
use crate::light::SceneShadow;
use crate::{
    Context, Error, Result,
    gpu::{
        Binding, Device, Uniform,
        bindings::layout,
        commands::{cleared, colored},
        pipeline::{Recipe, blended},
    },
    renderer::Renderer,
};
use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// Uniform of the depth and composite passes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct EmbedUniform {
    /// `(a, b, c, d)`: the scene's depth `z` corresponds to the hair's depth `(a z + b) / (c z + d)`.
    pub depth: [f32; 4],
    /// Samples per pixel of the hair.
    pub samples: u32,
    /// Texels of the hair per pixel, along each axis.
    pub ssaa: u32,
    /// [`HostFrame::origin`].
    pub origin: [u32; 2],
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// Unused.
    pub _pad: [u32; 2],
}

impl EmbedUniform {
    fn new(into: &HostFrame<'_>, to: Mat4, target: &HdrTarget) -> Self {
        let HdrTarget { samples, ssaa, size, .. } = *target;
        let depth = Self::map(into.projection, to);
        Self { depth, samples, ssaa, origin: into.origin, size, _pad: [0; 2] }
    }

    /// Returns the map from depths of the projection `from` to depths of `to`.
    fn map(from: Mat4, to: Mat4) -> [f32; 4] {
        // Depth is a rational function of the view-space distance, (p z + q) / (r z + s). The inverse of one such
        // function composed with another is again of this form.
        let rows = |m: Mat4| [m.z_axis.z, m.w_axis.z, m.z_axis.w, m.w_axis.w].map(f64::from);
        let ([p, q, r, s], [t, u, v, w]) = (rows(from), rows(to));
        let map = [t * s - u * r, u * p - t * q, v * s - w * r, w * p - v * q];
        let largest = map.iter().fold(0.0f64, |max, x| max.max(x.abs())).max(f64::MIN_POSITIVE);
        map.map(|x| (x / largest) as f32)
    }
}

/// A host's scene that is already drawn.
#[derive(Clone, Copy, Debug)]
pub struct HostFrame<'a> {
    /// Linear color, in the format that [`Compositor`] was built for. Hair is blended over it.
    pub color: &'a wgpu::TextureView,
    /// Depth, with `TEXTURE_BINDING` and any number of samples per pixel.
    pub depth: &'a wgpu::TextureView,
    /// Position of the image in both, pixels from the left and upper edge. With a split screen, each part is an image.
    /// Color and depth must contain the whole image.
    pub origin: [u32; 2],
    /// Projection that the scene was drawn with. It must have the field of view of
    /// [`Picture::camera`](crate::view::Picture::camera); near and far planes may differ, and depth from 0 to 1 may run
    /// either way.
    pub projection: Mat4,
    /// Output for later passes of the scene, such as fog, depth of field and temporal antialiasing: a target of the
    /// format [`Compositor::GEOMETRY`] and of the size of the image. Each pixel receives the motion of the visible hair
    /// since the view's previous frame (x to the right and y down, pixels), its depth in the scene's projection, and
    /// its opacity. Motion and depth are means weighted by opacity; pixels without hair are zero. If nothing is known
    /// of the previous frame, as after a change of the level of detail, hair counts as static and only the camera
    /// moves. Requires [`Renderer::Tiles`].
    pub geometry: Option<&'a wgpu::TextureView>,
    /// The scene's shadow maps, which shade hair and the bodies around it. At most 64.
    pub shadows: &'a [SceneShadow<'a>],
    /// Opacity of the shadow that hair casts on the scene by darkening its color (`shade`), 0 for none to 1. For scenes
    /// whose own shaders do not call [`shade::wgsl`].
    pub shade: f32,
    /// Distance behind the hair's shadow maps at which this shadow ends, meters. It fades out over the last quarter.
    pub shade_range: f32,
    /// Whether the caller has already recorded [`Recorder::light`](crate::frame::Recorder::light) for this frame, after
    /// the hair moved, as scenes do whose shaders evaluate hair shadows. The light is then not recorded again, and
    /// `shadows` must be empty, since `light` took them. If `light` was not recorded, the hair has the previous frame's
    /// light.
    pub is_lit: bool,
}

impl<'a> HostFrame<'a> {
    /// A scene with one image, drawn with `projection`, without geometry output and without shadows in either
    /// direction. Shadows of hair would reach from a head to the floor.
    pub fn new(color: &'a wgpu::TextureView, depth: &'a wgpu::TextureView, projection: Mat4) -> Self {
        Self {
            color,
            depth,
            origin: [0; 2],
            projection,
            geometry: None,
            shadows: &[],
            shade: 0.0,
            shade_range: 2.5,
            is_lit: false,
        }
    }

    /// Begins a pass over the image's part of the scene's color.
    fn pass<'p>(&self, canvas: &'p mut Canvas<'_, '_>) -> crate::gpu::RenderPass<'p> {
        let size = canvas.target.size;
        let color = colored(self.color, wgpu::LoadOp::Load);
        let mut pass = canvas.commands.render("embed", &[color], None);
        let [origin, size] = [self.origin, size].map(|pixels| pixels.map(|n| n as f32));
        pass.set_viewport(origin, size);
        pass
    }
}

/// Pipelines and buffers that composite the hair of one view into a scene. Record it at most once per submission: it
/// has one set of uniforms.
#[derive(Debug)]
pub struct Compositor {
    /// Depth conversion, for depth with one sample and with several.
    depths: [(wgpu::RenderPipeline, wgpu::BindGroupLayout); 2],
    composite: wgpu::RenderPipeline,
    geometry: wgpu::RenderPipeline,
    composite_layout: wgpu::BindGroupLayout,
    /// Replaces `composite` for cards, which are not in the texture of tiles, if their target has several samples.
    cards: Option<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>,
    /// Replaces `composite` for tiles if the scene's depth has several samples.
    edges: Option<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>,
    geometry_layout: wgpu::BindGroupLayout,
    uniform: Uniform,
    shade: shade::Caster,
}

impl Compositor {
    /// The format of [`HostFrame::geometry`].
    pub const GEOMETRY: wgpu::TextureFormat = geometry::FORMAT;

    /// Creates the pipelines for hair drawn by `renderer`, and for scenes with linear color of `format`, which must be
    /// blendable.
    ///
    /// # Errors
    /// [`Error::Parameter`] for depth peeling, whose layers only `present` can composite. [`Error::Gpu`] if wgpu
    /// rejects the format.
    pub fn new(context: &Context, renderer: Renderer, format: wgpu::TextureFormat) -> Result<Self> {
        let Context { device, .. } = context;
        if renderer.layers().is_some() {
            return Err(Error::Parameter {
                name: "the renderer of hair in a scene",
                value: "depth peeling".into(),
                range: "tiles, sample mask or alpha to coverage",
            });
        }
        let samples = renderer.samples();
        use wgpu::{BlendFactor::*, ShaderStages as Stages};
        let bound = |label, entries: &[Binding]| layout(device, label, Stages::FRAGMENT, entries);
        let layout = |label, texture| bound(label, &[Binding::Uniform, texture]);
        // Tiles leave hair in their own texture with one sample per pixel.
        let many = samples > 1 && !renderer.is_tiles();
        let hdr = if many { Binding::TextureMultisampled } else { Binding::Texture2d };
        let composite_layout = layout("embed", hdr);
        let geometry_layout = layout("embed geometry", Binding::Texels2d);
        let module = "draw::embed::geometry";
        let geometry = Recipe {
            vertex: (module, "geometry_vertex"),
            fragment: Some((module, "geometry_fragment")),
            layouts: &[&geometry_layout],
            targets: &[Some(Self::GEOMETRY.into())],
            ..Recipe::PLAIN
        };
        let depth = |module, [vertex, fragment]: [&'static str; 2], texture| {
            let layout = layout("embed depth", texture);
            let recipe = Recipe {
                vertex: (module, vertex),
                fragment: Some((module, fragment)),
                layouts: &[&layout],
                targets: &[Some(HDR_FORMAT.into())],
                depth: Some((true, wgpu::CompareFunction::Always)),
                samples,
                ..Recipe::PLAIN
            };
            Ok::<_, Error>((recipe.build(device)?, layout))
        };
        let depths = [
            depth("draw::embed::depth", ["depth_vertex", "depth_fragment"], Binding::Depth)?,
            depth(
                "draw::embed::depth_many",
                ["depth_many_vertex", "depth_many_fragment"],
                Binding::DepthMultisampled,
            )?,
        ];
        let over = &[blended(format, One, OneMinusSrcAlpha)];
        let blend = |many, layout: &wgpu::BindGroupLayout| {
            let (module, entry) = match many {
                true => ("draw::embed::many", ["many_vertex", "many_fragment"]),
                false => ("draw::embed::one", ["one_vertex", "one_fragment"]),
            };
            Recipe {
                vertex: (module, entry[0]),
                fragment: Some((module, entry[1])),
                layouts: &[layout],
                targets: over,
                ..Recipe::PLAIN
            }
            .build(device)
        };
        let cards = || {
            let layout = layout("embed cards", Binding::TextureMultisampled);
            Ok::<_, Error>((blend(true, &layout)?, layout))
        };
        let cards = (renderer.is_tiles() && samples > 1).then(cards).transpose()?;
        let edges = || {
            use Binding::{DepthMultisampled, Texels2d, Texture2d, Uniform};
            let layout = bound("embed edges", &[Uniform, Texture2d, Texels2d, DepthMultisampled]);
            let module = "draw::embed::edges";
            let recipe = Recipe {
                vertex: (module, "edges_vertex"),
                fragment: Some((module, "edges_fragment")),
                layouts: &[&layout],
                targets: over,
                ..Recipe::PLAIN
            };
            Ok::<_, Error>((recipe.build(device)?, layout))
        };
        let edges = renderer.is_tiles().then(edges).transpose()?;
        Ok(Self {
            depths,
            edges,
            cards,
            composite: blend(many, &composite_layout)?,
            geometry: geometry.build(device)?,
            composite_layout,
            geometry_layout,
            uniform: device.uniform(size_of::<EmbedUniform>()),
            shade: shade::Caster::new(context, format),
        })
    }

    fn bind(
        &self,
        device: &Device,
        layout: &wgpu::BindGroupLayout,
        view: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let texture = wgpu::BindingResource::TextureView(view);
        device.group("embed", layout, &[self.uniform.as_entire_binding(), texture])
    }

    /// Returns the identity depth map if geometry is requested from a frame without a scene.
    ///
    /// # Errors
    /// [`Error::Parameter`] if hair is not drawn by tiles.
    pub(crate) fn identity_depth_map(renderer: Renderer, is_requested: bool) -> Result<Option<[f32; 4]>> {
        if is_requested && !renderer.is_tiles() {
            return Err(unknown("hair with a geometry output", renderer));
        }
        Ok(is_requested.then_some([1.0, 0.0, 0.0, 1.0]))
    }

    /// Returns the map from the hair's depth to the scene's, if the scene needs the hair's geometry.
    ///
    /// # Errors
    /// [`Error::Parameter`] if geometry is requested and hair is not drawn by tiles, or if `is_lit` is set and
    /// `shadows` is not empty.
    pub(crate) fn geometry_depth_map(
        renderer: Renderer,
        of: Mat4,
        into: &HostFrame<'_>,
    ) -> Result<Option<[f32; 4]>> {
        if into.geometry.is_some() && !renderer.is_tiles() {
            return Err(unknown("hair with a geometry output in a scene", renderer));
        }
        if into.is_lit && !into.shadows.is_empty() {
            return Err(Error::Parameter {
                name: "the number of scene shadow maps",
                value: into.shadows.len().to_string(),
                range: "0 if the light was already recorded; pass the maps there",
            });
        }
        // The depth of the hair is also needed to compare it with each sample of the scene.
        let needs_geometry = into.geometry.is_some() || (renderer.is_tiles() && has_samples(into.depth));
        Ok(needs_geometry.then(|| EmbedUniform::map(of, into.projection)))
    }

    /// Converts the scene's depth to the projection `to` and writes it into the targets, before the hair.
    pub(crate) fn record_depth(&self, canvas: &mut Canvas<'_, '_>, to: Mat4, into: &HostFrame<'_>) {
        let values = EmbedUniform::new(into, to, canvas.target);
        self.uniform.write(0, bytemuck::bytes_of(&values));
        let (pipeline, layout) = &self.depths[usize::from(has_samples(into.depth))];
        let group = self.bind(&canvas.commands.context().device, layout, into.depth);
        let mut pass = pass(canvas, "embed", true);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Records the shadow of hair over the scene's color, before the hair is composited.
    pub(crate) fn record_shade(&self, canvas: &mut Canvas<'_, '_>, into: &HostFrame<'_>) -> Result<()> {
        self.shade.record(canvas, into)
    }

    /// Blends the hair in the targets over the scene's color, among it cards if there are any.
    pub(crate) fn record(
        &self,
        tiles: Option<&Tiles>,
        canvas: &mut Canvas<'_, '_>,
        into: &HostFrame<'_>,
        has_cards: bool,
    ) {
        let cards = tiles.filter(|_| has_cards).map(|_| {
            let own = self.cards.as_ref().map(|(pipeline, layout)| (pipeline, layout));
            let (pipeline, layout) = own.unwrap_or((&self.composite, &self.composite_layout));
            (pipeline, self.bind(&canvas.commands.context().device, layout, &canvas.target.color))
        });
        let hair = tiles.map_or(&canvas.target.color, |tiles| &tiles.buffers.hair);
        let known = tiles.filter(|_| has_samples(into.depth)).and_then(|tiles| tiles.geometry());
        let (pipeline, group) = match (&self.edges, known) {
            (Some((pipeline, layout)), Some(known)) => {
                let [hair, known, depth] = [hair, &known, into.depth].map(wgpu::BindingResource::TextureView);
                let entries = [self.uniform.as_entire_binding(), hair, known, depth];
                (pipeline, canvas.commands.context().device.group("embed edges", layout, &entries))
            }
            _ => {
                (&self.composite, self.bind(&canvas.commands.context().device, &self.composite_layout, hair))
            }
        };
        let mut pass = into.pass(canvas);
        for (pipeline, group) in cards.into_iter().chain([(pipeline, group)]) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        if let Some(target) = into.geometry {
            self.record_geometry(tiles, canvas, target);
        }
    }

    /// Records the geometry output.
    fn record_geometry(
        &self,
        tiles: Option<&Tiles>,
        canvas: &mut Canvas<'_, '_>,
        target: &wgpu::TextureView,
    ) {
        let known = tiles.and_then(|tiles| tiles.geometry());
        let group =
            known.map(|known| self.bind(&canvas.commands.context().device, &self.geometry_layout, &known));
        let mut pass = canvas.commands.render("embed", &[cleared(target)], None);
        if let Some(group) = group {
            pass.set_pipeline(&self.geometry);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Whether a scene's depth has several samples.
fn has_samples(depth: &wgpu::TextureView) -> bool {
    depth.texture().sample_count() > 1
}

/// Error for outputs that only tiles have.
fn unknown(name: &'static str, renderer: Renderer) -> Error {
    Error::Parameter { name, value: format!("drawn with {renderer:?}"), range: "drawn with tiles" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Camera;
    use glam::Vec3;

    #[test]
    fn depth_maps_between_projections() {
        let ours = Camera::perspective(0.5, 1.5, 0.01);
        let usual = glam::camera::rh::proj::directx::perspective(0.5, 1.5, 0.1, 100.0);
        let flat = glam::camera::rh::proj::directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 100.0);
        let depth = |m: Mat4, z: f32| m.project_point3(Vec3::new(0.0, 0.0, -z)).z;
        for from in [ours, usual, flat] {
            let [a, b, c, d] = EmbedUniform::map(from, ours);
            for z in [0.2, 0.5, 1.0, 3.0, 20.0] {
                let theirs = depth(from, z);
                let found = (a * theirs + b) / (c * theirs + d);
                assert!((found / depth(ours, z) - 1.0).abs() < 1e-3, "{z}: {found} {}", depth(ours, z));
            }
        }
    }
}
