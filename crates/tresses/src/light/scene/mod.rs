//! Imports shadow maps of the host's scene into the shadow maps of hair and meshes.
//!
//! ```text
//! scene's shadow maps ─► a triangle over each of the view's maps, writing depth ─► meshes on top ─► as without a scene
//! ```
//!
//! Hair reads one map per light: the view's own, which covers only the hair. This module copies the host's shadow maps
//! into it, texel by texel, before meshes are drawn. The depth of a host's map may run either way. Shaders that read
//! light do not change, and cost the same. Both maps look along the same light, so a ray of one is a texel of the
//! other. Rays of a point or spot light diverge; at the hair they count as parallel, and the lookup is where a ray
//! passes the middle of the hair.
//!
//! Several maps of one light add up, for example the cascades of a sun: each contributes the region that it covers.
//!
//! Rejected: reading the host's maps where hair is shaded, which would add bindings and lookups to every kernel that
//! reads light, for all users; reprojecting their depth as points, which leaves holes.

use super::{FrameLight, Sphere, map_view::MapView};
use crate::{
    Context, Error, Result,
    gpu::{
        Binding, Device,
        bindings::{constant, layout},
        pipeline::{PipelineCache, Recipe},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

/// Maximum number of scene shadow maps in a frame, of lights that have shadow maps.
pub const MAX_SCENE_SHADOWS: usize = 64;

/// Difference of depth that counts as an edge in a scene's map, meters.
const DISCONTINUITY: f32 = 0.03;

/// A shadow map of the host's scene, for one light.
#[derive(Clone, Copy, Debug)]
pub struct SceneShadow<'a> {
    /// [`Light::id`](super::Light::id). The map is ignored if that light gets no shadow map.
    pub light: u32,
    /// Depth as seen from the light: a two-dimensional view of the first mip level (and of one layer of an array), with
    /// one sample per texel and `TEXTURE_BINDING`.
    pub depth: &'a wgpu::TextureView,
    /// Origin and size in `depth`, texels, if the map is part of an atlas. `None` for all of `depth`.
    pub part: Option<[[u32; 2]; 2]>,
    /// World to clip space, where depth is between 0 and 1 and runs either way. Orthographic for a sun, perspective for
    /// a point or spot light.
    pub projection: Mat4,
    /// Distance by which everything in the map is moved away from the light, meters. A coarse map needs the size of its
    /// texels if hair lies on its casters, such as a head.
    pub bias: f32,
}

impl SceneShadow<'_> {
    /// Returns whether the map covers all of a sphere, or `None` if it covers nothing of it. For an orthographic map
    /// the sphere must lie between the near and the far plane: casters in front of the near plane may have been drawn
    /// at it, behind the sphere.
    pub fn covers(&self, sphere: &Sphere) -> Option<bool> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.projection.row(i));
        let within = |plane: Vec4| {
            plane.dot(sphere.center.extend(1.0)) / plane.truncate().length().max(f32::MIN_POSITIVE)
        };
        let sides = [w - x, w + x, w - y, w + y].into_iter();
        let min_distance = match is_flat(&self.projection) {
            true => sides.chain([z, w - z]).map(within).fold(f32::INFINITY, f32::min),
            false => sides.map(within).fold(f32::INFINITY, f32::min),
        };
        (min_distance > -sphere.radius).then_some(min_distance >= sphere.radius)
    }
}

/// Whether a projection is orthographic.
fn is_flat(projection: &Mat4) -> bool {
    projection.row(3).truncate() == Vec3::ZERO
}

/// Shader data of a [`SceneShadow`] and of the map that it is imported into.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SceneUniform {
    /// Clip space of the view into the hair's map, with linear depth, to clip space of the scene's map.
    pub to_scene: Mat4,
    /// Origin of the scene's map in its texture, texels.
    pub origin: [u32; 2],
    /// Size of the scene's map, texels.
    pub size: [u32; 2],
    /// [`SceneShadow::bias`], in the depth of the view's map.
    pub bias: f32,
    /// Difference that counts as an edge, in the depth of the view's map.
    pub discontinuity: f32,
    /// Depth of empty texels in the scene's map.
    pub nothing: f32,
    /// Unused.
    pub _pad: u32,
    /// Left and upper edge of the view's part of the hair's map, then its width and height, texels.
    pub part: [f32; 4],
    /// Distances of the view's ends from the light; both 1 for parallel rays.
    pub ends: [f32; 2],
    /// Unused.
    pub _pad_2: [u32; 2],
}

impl SceneUniform {
    /// Returns the shader data to import `shadow` into `view`, which is a part of a map of `edge`² texels.
    fn new(shadow: &SceneShadow<'_>, view: &MapView, edge: u32) -> Self {
        let to_scene = shadow.projection * view.local().inverse();
        let range = view.range;
        // If depth rises away from the light, empty texels are at 1.
        let [z, w] = [shadow.projection.row(2), shadow.projection.row(3)];
        let rises = if is_flat(&shadow.projection) {
            (to_scene * Vec4::Z).z > 0.0
        } else {
            // Depth is a + b / w, and w rises away from the light.
            let a = z.truncate().dot(w.truncate()) / w.truncate().length_squared();
            z.w - a * w.w < 0.0
        };
        let full_size = shadow.depth.texture().size();
        let [origin, size] = shadow.part.unwrap_or([[0; 2], [full_size.width, full_size.height]]);
        let depth_fraction = |meters: f32| meters / range.max(1e-6);
        Self {
            to_scene,
            origin,
            size,
            bias: depth_fraction(shadow.bias),
            discontinuity: depth_fraction(DISCONTINUITY),
            nothing: if rises { 1.0 } else { 0.0 },
            _pad: 0,
            part: view.viewport(edge),
            ends: if view.near > 0.0 { [view.near, view.near + view.range] } else { [1.0; 2] },
            _pad_2: [0; 2],
        }
    }
}

/// Pipeline that imports scene shadows.
#[derive(Debug)]
pub(super) struct Pipelines {
    device: Device,
    layout: wgpu::BindGroupLayout,
    transfer: PipelineCache<(), wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let entries = [Binding::Uniform, Binding::Depth];
        let layout = layout(device, "scene shadow", wgpu::ShaderStages::FRAGMENT, &entries);
        Self { device: device.clone(), layout, transfer: PipelineCache::default() }
    }

    fn transfer(&self) -> Result<wgpu::RenderPipeline> {
        self.transfer.get((), || {
            let module = "light::scene::transfer";
            Recipe {
                vertex: (module, "transfer_vertex"),
                fragment: Some((module, "transfer_fragment")),
                layouts: &[&self.layout],
                depth: Some((true, wgpu::CompareFunction::Less)),
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }
}

/// Scene shadows imported in a frame: the index of the view into the hair's maps, and the bind group, of each.
#[derive(Debug, Default)]
pub(crate) struct ImportedShadows {
    pipeline: Option<wgpu::RenderPipeline>,
    groups: Vec<(usize, wgpu::BindGroup)>,
}

impl ImportedShadows {
    /// Selects the `shadows` that apply to the view's maps of `resolution`² texels, which `lit` describes.
    ///
    /// # Errors
    /// [`Error::Parameter`] when there are too many shadows, or when one has several samples, cannot be read by
    /// shaders, has an invalid projection, bias or part.
    pub(super) fn new(
        pipelines: &Pipelines,
        resolution: u32,
        lit: &FrameLight,
        shadows: &[SceneShadow<'_>],
    ) -> Result<Self> {
        if shadows.is_empty() {
            return Ok(Self::default());
        }
        shadows.iter().try_for_each(check)?;
        let FrameLight { lights, views, focus, .. } = lit;
        let has_map = |shadow: &&SceneShadow<'_>| lights.iter().any(|light| light.id == shadow.light);
        let applicable = shadows.iter().filter(has_map).filter(|shadow| shadow.covers(focus).is_some());
        let applicable: Vec<_> = applicable.collect();
        if applicable.len() > MAX_SCENE_SHADOWS {
            let name = "the number of shadow maps of a scene that cover the hair";
            return Err(wrong(name, applicable.len(), "at most 64"));
        }
        let imported = applicable.into_iter().flat_map(|shadow| {
            let map = lights.iter().position(|light| light.id == shadow.light);
            let own = move |view: &MapView| map == Some(view.map as usize);
            views.iter().enumerate().filter(move |(_, view)| own(view)).map(move |(number, view)| {
                let values = SceneUniform::new(shadow, view, resolution);
                let uniform = constant(&pipelines.device, "scene shadow", &values);
                let depth = wgpu::BindingResource::TextureView(shadow.depth);
                let bound = [uniform.as_entire_binding(), depth];
                (number, pipelines.device.group("scene shadow", &pipelines.layout, &bound))
            })
        });
        let groups: Vec<_> = imported.collect();
        let pipeline = if groups.is_empty() { None } else { Some(pipelines.transfer()?) };
        Ok(Self { pipeline, groups })
    }

    /// Whether no scene shadow is imported.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Records the import into view number `view`, in the render pass of its map.
    pub fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, view: usize) {
        let mut groups = self.groups.iter().filter(|(into, _)| *into == view).peekable();
        let Some(pipeline) = self.pipeline.as_ref().filter(|_| groups.peek().is_some()) else { return };
        pass.set_pipeline(pipeline);
        for (_, group) in groups {
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

fn wrong(name: &'static str, value: impl ToString, range: &'static str) -> Error {
    Error::Parameter { name, value: value.to_string(), range }
}

fn check(shadow: &SceneShadow<'_>) -> Result<()> {
    let texture = shadow.depth.texture();
    let samples = texture.sample_count();
    if samples != 1 {
        return Err(wrong(
            "a scene's shadow map",
            format!("a texture of {samples} samples"),
            "a texture of one sample per texel",
        ));
    }
    if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return Err(wrong(
            "a scene's shadow map",
            "a texture without TEXTURE_BINDING",
            "a texture with TEXTURE_BINDING",
        ));
    }
    if !shadow.projection.is_finite() || shadow.projection.determinant() == 0.0 {
        return Err(wrong(
            "the projection of a scene's shadow map",
            "singular or not finite",
            "finite and invertible",
        ));
    }
    if !shadow.bias.is_finite() {
        return Err(wrong("the bias of a scene's shadow map", shadow.bias, "a finite length in meters"));
    }
    let Some([origin, size]) = shadow.part else { return Ok(()) };
    let full_size = texture.size();
    let fits =
        |i: usize, edge: u32| size[i] > 0 && origin[i].checked_add(size[i]).is_some_and(|end| end <= edge);
    if fits(0, full_size.width) && fits(1, full_size.height) {
        return Ok(());
    }
    let value =
        format!("{size:?} texels from {origin:?}, in a map of {} by {}", full_size.width, full_size.height);
    Err(wrong("the part of a scene's shadow map", value, "inside the map"))
}
