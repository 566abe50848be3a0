//! Hair in a host application's scene: composited over a linear colour target that is already drawn, occluded
//! by its depth.
//!
//! ```text
//! scene's depth ─► depth, in the library's own terms ─► strips ─► HDR ─► composite ─► scene's colour
//! ```
//!
//! The scene keeps its format, its number of samples and its way of writing depth: depths are
//! carried over from its projection to that of the [`Camera`](crate::Camera), pixel by pixel, before the hair
//! is drawn with as many samples as its view has. What these cover is blended over the scene's colour of one sample, the
//! resolved one of a scene that has several, so that thin hair stays thin. Of several depths in a pixel the farthest
//! counts: the nearest would leave an outline of what is behind the hair around whatever is in front of it. Hair by
//! [`Coverage::Tiles`], whose depth is known, is then only as strong as the share of the samples that it is in front of:
//! edges before it stay smooth.
//! The scene's depth is not written, but a scene that asks is told how far what is seen of hair is
//! in each pixel, how it moved and how opaque it is ([`Surroundings::geometry`]), for fog, depth of field and temporal
//! antialiasing; transparent surfaces drawn later, in front of hair or behind it, blend as if there were no hair.
//!
//! Rejected: drawing strips into the scene's own target, which would need its pipelines built for its
//! format and samples and a coverage of one sample per pixel to be smoothed afterwards.

pub mod shade;

pub use shade::Shade;

use super::{
    Coverage, Targets,
    record::{Canvas, pass},
    targets::HDR_FORMAT,
    tiles::geometry,
};
use crate::light::SceneShadow;
use crate::{
    Context, Error, Result,
    gpu::{
        Binding, Device,
        bindings::{layout, uniform},
        commands::{cleared, colored},
        pipeline::{Recipe, blended},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::Mat4;

/// What the shaders know of the scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct EmbedUniform {
    /// `(a, b, c, d)`: a depth `z` of the scene is `(a z + b) / (c z + d)` of the hair.
    pub depth: [f32; 4],
    /// Samples per pixel of the hair.
    pub samples: u32,
    /// Texels of the hair per pixel, along each axis.
    pub ssaa: u32,
    /// [`Surroundings::origin`].
    pub origin: [u32; 2],
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Unused.
    pub _pad: [u32; 2],
}

impl EmbedUniform {
    fn new(into: &Surroundings<'_>, to: Mat4, targets: &Targets) -> Self {
        let Targets { samples, ssaa, size, .. } = *targets;
        let depth = Self::map(into.projection, to);
        Self { depth, samples, ssaa, origin: into.origin, size, _pad: [0; 2] }
    }

    /// From the depths of the projection `from` to those of `to`.
    fn map(from: Mat4, to: Mat4) -> [f32; 4] {
        // Depth is a fraction of linear functions of the distance along the view, (p z + q) / (r z + s):
        // the inverse of one such map, then another, is one more.
        let rows = |m: Mat4| [m.z_axis.z, m.w_axis.z, m.z_axis.w, m.w_axis.w].map(f64::from);
        let ([p, q, r, s], [t, u, v, w]) = (rows(from), rows(to));
        let map = [t * s - u * r, u * p - t * q, v * s - w * r, w * p - v * q];
        let largest = map.iter().fold(0.0f64, |most, x| most.max(x.abs())).max(f64::MIN_POSITIVE);
        map.map(|x| (x / largest) as f32)
    }
}

/// A scene that is drawn already.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Its linear colour, of the format that [`Embed`] was built for: hair is blended over it.
    pub color: &'a wgpu::TextureView,
    /// Its depth, with `TEXTURE_BINDING`, of any number of samples per pixel.
    pub depth: &'a wgpu::TextureView,
    /// Where the picture begins in both, pixels from their left and upper edge: of a split screen each part is a picture.
    /// They hold all of it.
    pub origin: [u32; 2],
    /// The projection that it was drawn with: of the camera and field of view of
    /// [`Picture::camera`](crate::view::Picture::camera), but with any planes and any direction of depth from 0 to 1.
    pub projection: Mat4,
    /// Where hair is, for passes of the scene that come after: fog, depth of field, temporal antialiasing. A target of
    /// [`Embed::GEOMETRY`], of the size of the picture, each pixel of which gets how far what is seen of hair there has
    /// moved since the view's last picture (x to the right and y down, pixels), its depth in the scene's terms, and
    /// how opaque it is, by which the former are the mean; zeros where there is no hair. Where nothing is known of the
    /// picture before, as after a change of the level of detail, hair counts as standing still before the camera
    /// that moved. Only hair by [`Coverage::Tiles`] knows this.
    pub geometry: Option<&'a wgpu::TextureView>,
    /// Its own shadow maps: what keeps the lights from hair and from the bodies that shade it
    /// ([`crate::light::scene`]). At most 16.
    pub shadows: &'a [SceneShadow<'a>],
    /// The shadow that hair casts on the scene, whose colour is darkened ([`shade`]): for scenes whose own shaders do not
    /// ask hair for it ([`shade::wgsl`]).
    pub shade: Option<Shade>,
    /// Whether [`Recorder::light`](crate::frame::Recorder::light) was recorded for this picture already, after hair had
    /// moved, as by a scene whose own shaders ask for light: it is not lit anew, and `shadows` is empty, for it has taken
    /// those. Without that, hair is in the light of the picture before.
    pub lit: bool,
}

impl<'a> Surroundings<'a> {
    /// A scene of one picture, seen with `projection`, that does not ask where hair is and has no shadows to give or take.
    pub fn new(color: &'a wgpu::TextureView, depth: &'a wgpu::TextureView, projection: Mat4) -> Self {
        Self {
            color,
            depth,
            origin: [0; 2],
            projection,
            geometry: None,
            shadows: &[],
            shade: None,
            lit: false,
        }
    }

    /// A pass over the picture's part of its colour.
    fn pass<'p>(&self, canvas: &'p mut Canvas<'_, '_>) -> crate::gpu::RenderPass<'p> {
        let size = canvas.targets.size;
        let color = colored(self.color, wgpu::LoadOp::Load);
        let mut pass = canvas.commands.render("embed", &[color], None);
        let [origin, size] = [self.origin, size].map(|pixels| pixels.map(|n| n as f32));
        pass.set_viewport(origin, size);
        pass
    }
}

/// What puts the hair of one view into a scene.
#[derive(Debug)]
pub struct Embed {
    /// For depth of one sample and of several.
    depths: [(wgpu::RenderPipeline, wgpu::BindGroupLayout); 2],
    composite: wgpu::RenderPipeline,
    geometry: wgpu::RenderPipeline,
    composite_layout: wgpu::BindGroupLayout,
    /// In place of `composite` for hair by tiles, where depth has several samples.
    edges: Option<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>,
    geometry_layout: wgpu::BindGroupLayout,
    uniform: wgpu::Buffer,
    shade: shade::Caster,
}

impl Embed {
    /// The format of [`Surroundings::geometry`].
    pub const GEOMETRY: wgpu::TextureFormat = geometry::FORMAT;

    /// For hair that is drawn with `samples` per pixel, covered by `coverage`, into scenes whose linear colour is of
    /// `format`, which must be one that can be blended.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a coverage that peels: its layers are put together by `present` alone. [`Error::Gpu`]
    /// when wgpu refuses the format.
    pub fn new(
        context: &Context,
        (samples, coverage): (u32, Coverage),
        format: wgpu::TextureFormat,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        if matches!(coverage, Coverage::DepthPeeling { .. }) {
            return Err(Error::Parameter {
                name: "the coverage of hair in a scene",
                value: "depth peeling".into(),
                range: "tiles, a mask of samples or alpha to coverage",
            });
        }
        use wgpu::{BlendFactor::*, ShaderStages as Stages};
        let bound = |label, entries: &[Binding]| layout(device, label, Stages::FRAGMENT, entries);
        let layout = |label, texture| bound(label, &[Binding::Uniform, texture]);
        // Tiles leave hair in a texture of its own, one sample per pixel.
        let many = samples > 1 && !coverage.is_tiled();
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
                "draw::embed::farthest",
                ["farthest_vertex", "farthest_fragment"],
                Binding::DepthMultisampled,
            )?,
        ];
        let (module, entry) = match many {
            true => ("draw::embed::many", ["many_vertex", "many_fragment"]),
            false => ("draw::embed::one", ["one_vertex", "one_fragment"]),
        };
        let composite = Recipe {
            vertex: (module, entry[0]),
            fragment: Some((module, entry[1])),
            layouts: &[&composite_layout],
            targets: &[blended(format, One, OneMinusSrcAlpha)],
            ..Recipe::PLAIN
        };
        let edges = || {
            use Binding::{DepthMultisampled, Texels2d, Texture2d, Uniform};
            let layout = bound("embed edges", &[Uniform, Texture2d, Texels2d, DepthMultisampled]);
            let module = "draw::embed::edges";
            let recipe = Recipe {
                vertex: (module, "edges_vertex"),
                fragment: Some((module, "edges_fragment")),
                layouts: &[&layout],
                ..composite
            };
            Ok::<_, Error>((recipe.build(device)?, layout))
        };
        let edges = coverage.is_tiled().then(edges).transpose()?;
        Ok(Self {
            depths,
            edges,
            composite: composite.build(device)?,
            geometry: geometry.build(device)?,
            composite_layout,
            geometry_layout,
            uniform: uniform(device, "embed", size_of::<EmbedUniform>()),
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

    /// The map of depths to themselves, if a picture without a scene is asked where hair is.
    ///
    /// # Errors
    /// [`Error::Parameter`] where hair is not drawn by tiles.
    pub(crate) fn known(coverage: Coverage, asks: bool) -> Result<Option<[f32; 4]>> {
        if asks && !coverage.is_tiled() {
            return Err(unknown("the geometry of hair", coverage));
        }
        Ok(asks.then_some([1.0, 0.0, 0.0, 1.0]))
    }

    /// The map of depths to those of the scene, if that asks where hair is.
    ///
    /// # Errors
    /// [`Error::Parameter`] where hair is not drawn by tiles.
    pub(crate) fn asked(coverage: Coverage, of: Mat4, into: &Surroundings<'_>) -> Result<Option<[f32; 4]>> {
        if into.geometry.is_some() && !coverage.is_tiled() {
            return Err(unknown("the geometry of hair in a scene", coverage));
        }
        if into.lit && !into.shadows.is_empty() {
            return Err(Error::Parameter {
                name: "the number of a scene's shadow maps",
                value: into.shadows.len().to_string(),
                range: "none where its light was recorded before: that takes them",
            });
        }
        // Where hair is says also which samples of the scene it is in front of.
        let asks = into.geometry.is_some() || (coverage.is_tiled() && has_samples(into.depth));
        Ok(asks.then(|| EmbedUniform::map(of, into.projection)))
    }

    /// Records the scene's depth into the targets, seen with the projection `to`: before the hair.
    pub(crate) fn record_depth(&self, canvas: &mut Canvas<'_, '_>, to: Mat4, into: &Surroundings<'_>) {
        let values = EmbedUniform::new(into, to, canvas.targets);
        canvas.commands.context().queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&values));
        let (pipeline, layout) = &self.depths[usize::from(has_samples(into.depth))];
        let group = self.bind(&canvas.commands.context().device, layout, into.depth);
        let mut pass = pass(canvas, "embed", true);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Records the shadow of hair over the scene's colour, before the hair.
    pub(crate) fn record_shade(&self, canvas: &mut Canvas<'_, '_>, into: &Surroundings<'_>) -> Result<()> {
        self.shade.record(canvas, into)
    }

    /// Records what the targets have of hair over the scene's colour.
    pub(crate) fn record(&self, canvas: &mut Canvas<'_, '_>, into: &Surroundings<'_>) {
        let tiles = canvas.targets.tiles.as_ref();
        let hair = tiles.map_or(&canvas.targets.hdr, |tiles| &tiles.hair);
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
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        if let Some(target) = into.geometry {
            self.record_geometry(canvas, target);
        }
    }

    /// Records where the hair is.
    fn record_geometry(&self, canvas: &mut Canvas<'_, '_>, target: &wgpu::TextureView) {
        let known = canvas.targets.tiles.as_ref().and_then(|tiles| tiles.geometry());
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

/// What only tiles know.
fn unknown(name: &'static str, coverage: Coverage) -> Error {
    Error::Parameter { name, value: format!("with {coverage:?}"), range: "with tiles" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Camera;
    use glam::Vec3;

    #[test]
    fn depths_are_carried_over_whatever_their_direction() {
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
