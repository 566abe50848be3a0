//! Shadows of a host's scene: its shadow maps are brought into those that light hair and bodies.
//!
//! ```text
//! the scene's shadow maps ─► a triangle over each of the view's maps, depth by depth ─► bodies on top ─► as ever
//! ```
//!
//! Hair asks one map for each light, the view's own, around the hair alone. What a host has drawn into shadow maps of
//! its own, whichever way their depth runs, is carried over into it before bodies are drawn, texel by texel: nothing that
//! asks for light knows of it or pays for it. Both maps look along the same light, so that a ray of one is a texel of the
//! other. The light of a lamp spreads: at the hair it counts as parallel, and the ray is looked up where it passes the
//! middle of the hair.
//!
//! Several maps of one light add up, the cascades of a sun for example: each brings what it covers.
//!
//! Rejected: asking the host's maps where hair is shaded, which takes bindings and lookups of every kernel that asks for
//! light, of all users; reprojecting its depth as points, which leaves holes.

use super::{Lights, ShadowMaps, Sphere, lights::SHADOW_MAPS};
use crate::{
    Context, Error, Result,
    gpu::{
        Binding, Device,
        bindings::layout,
        pipeline::{Made, Recipe},
    },
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

/// The most shadow maps of a scene that a picture takes.
pub const MOST_SCENE_SHADOWS: usize = 16;

/// What is farther apart than this is an edge in a scene's map, metres.
const APART: f32 = 0.03;

/// A shadow map of a host's scene: what of it keeps one light from hair.
#[derive(Clone, Copy, Debug)]
pub struct SceneShadow<'a> {
    /// Which of [`Lights::directional`] it belongs to. Of one that is off nothing is taken.
    pub light: usize,
    /// Its depth, seen from the light: one sample per texel, a plain two-dimensional view (of an array one layer) of the
    /// first mip level, with `TEXTURE_BINDING`.
    pub depth: &'a wgpu::TextureView,
    /// Where it begins in `depth` and how large it is, texels: of an atlas a part. `None` for all of it.
    pub part: Option<[[u32; 2]; 2]>,
    /// From the world to its clip space, where depth is between 0 and 1 and runs either way: of a sun orthographic, of a
    /// lamp a perspective.
    pub projection: Mat4,
    /// How much farther from the light everything in it is taken to be, metres. A coarse map whose casters hair lies on,
    /// as a head, needs as much as its texels are large.
    pub bias: f32,
}

impl SceneShadow<'_> {
    /// Whether it sees all of a sphere; `None` where it sees nothing of it. Of orthographic maps that has to lie between
    /// their planes: what is before the nearer one may have been drawn at it, behind the sphere.
    pub fn sees(&self, sphere: &Sphere) -> Option<bool> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.projection.row(i));
        let within = |plane: Vec4| {
            plane.dot(sphere.center.extend(1.0)) / plane.truncate().length().max(f32::MIN_POSITIVE)
        };
        let sides = [w - x, w + x, w - y, w + y].into_iter();
        let least = match is_flat(&self.projection) {
            true => sides.chain([z, w - z]).map(within).fold(f32::INFINITY, f32::min),
            false => sides.map(within).fold(f32::INFINITY, f32::min),
        };
        (least > -sphere.radius).then_some(least >= sphere.radius)
    }
}

/// Whether a projection is orthographic.
fn is_flat(projection: &Mat4) -> bool {
    projection.row(3).truncate() == Vec3::ZERO
}

/// What the shader knows of one of them and of the map that it goes into.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SceneUniform {
    /// From the clip space of the view's map to that of the scene's.
    pub to_scene: Mat4,
    /// Where the scene's map begins in its texture, texels.
    pub origin: [u32; 2],
    /// How large it is, texels.
    pub size: [u32; 2],
    /// [`SceneShadow::bias`], of the depth of the view's map.
    pub bias: f32,
    /// What is farther apart is an edge, of the depth of the view's map.
    pub apart: f32,
    /// The depth in the scene's map of where nothing is.
    pub nothing: f32,
    /// Texels along each edge of the view's map.
    pub edge: f32,
}

impl SceneUniform {
    /// Of `shadow` in a map of `edge`² texels, to whose clip space `map` leads and whose depth is `range` metres.
    fn new(shadow: &SceneShadow<'_>, map: Mat4, (range, edge): (f32, u32)) -> Self {
        let to_scene = shadow.projection * map.inverse();
        // Where depth rises from the light on, what is cleared is at 1.
        let [z, w] = [shadow.projection.row(2), shadow.projection.row(3)];
        let rises = if is_flat(&shadow.projection) {
            (to_scene * Vec4::Z).z > 0.0
        } else {
            // It is a + b / w, and w grows from the light on.
            let a = z.truncate().dot(w.truncate()) / w.truncate().length_squared();
            z.w - a * w.w < 0.0
        };
        let whole = shadow.depth.texture().size();
        let [origin, size] = shadow.part.unwrap_or([[0; 2], [whole.width, whole.height]]);
        let share = |metres: f32| metres / range.max(1e-6);
        Self {
            to_scene,
            origin,
            size,
            bias: share(shadow.bias),
            apart: share(APART),
            nothing: if rises { 1.0 } else { 0.0 },
            edge: edge as f32,
        }
    }
}

/// The pipeline that brings them.
#[derive(Debug)]
pub(super) struct Pipelines {
    device: Device,
    layout: wgpu::BindGroupLayout,
    bring: Made<(), wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let entries = [Binding::Uniform, Binding::Depth];
        let layout = layout(device, "scene shadow", wgpu::ShaderStages::FRAGMENT, &entries);
        Self { device: device.clone(), layout, bring: Made::default() }
    }

    fn bring(&self) -> Result<wgpu::RenderPipeline> {
        self.bring.get((), || {
            let module = "light::scene::bring";
            Recipe {
                vertex: (module, "bring_vertex"),
                fragment: Some((module, "bring_fragment")),
                layouts: &[&self.layout],
                depth: Some((true, wgpu::CompareFunction::Less)),
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }
}

/// What a picture takes of a scene's shadow maps: a group for each, by the map of the view that it goes into.
#[derive(Debug, Default)]
pub(crate) struct Brought {
    pipeline: Option<wgpu::RenderPipeline>,
    groups: Vec<(usize, wgpu::BindGroup)>,
}

impl Brought {
    /// Of `shadows` what `lights` and the view's `maps` take, which lead from the world to `matrices`, whose depth is
    /// `range` metres, and which are around `focus`.
    ///
    /// # Errors
    /// [`Error::Parameter`] when there are too many, when one has several samples or cannot be read, or when its part is
    /// not in it.
    pub fn new(
        pipelines: &super::Pipelines,
        maps: &ShadowMaps,
        lights: &Lights,
        (matrices, range, focus): (&[Mat4; SHADOW_MAPS], f32, &Sphere),
        shadows: &[SceneShadow<'_>],
    ) -> Result<Self> {
        if shadows.is_empty() {
            return Ok(Self::default());
        }
        let pipelines = &pipelines.scene;
        shadows.iter().try_for_each(check)?;
        if shadows.len() > MOST_SCENE_SHADOWS {
            return Err(wrong("the number of shadow maps of a scene", shadows.len(), "at most 16"));
        }
        let on = |light: &usize| lights.directional.get(*light).is_some_and(|light| light.is_on());
        let taken = shadows.iter().filter(|shadow| on(&shadow.light) && shadow.sees(focus).is_some());
        let brought = taken.map(|shadow| {
            let map = lights.directional[..shadow.light].iter().filter(|light| light.is_on()).count();
            let values = SceneUniform::new(shadow, matrices[map], (range, maps.resolution));
            use wgpu::util::DeviceExt;
            let uniform = pipelines.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("scene shadow"),
                contents: bytemuck::bytes_of(&values),
                usage: wgpu::BufferUsages::UNIFORM,
            });
            let depth = wgpu::BindingResource::TextureView(shadow.depth);
            let bound = [uniform.as_entire_binding(), depth];
            (map, pipelines.device.group("scene shadow", &pipelines.layout, &bound))
        });
        let groups: Vec<_> = brought.collect();
        let pipeline = if groups.is_empty() { None } else { Some(pipelines.bring()?) };
        Ok(Self { pipeline, groups })
    }

    /// Records what goes into the map number `map`, whose pass this is.
    pub fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, map: usize) {
        let mut groups = self.groups.iter().filter(|(into, _)| *into == map).peekable();
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
            format!("of {samples} samples"),
            "of one sample per texel",
        ));
    }
    if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return Err(wrong("a scene's shadow map", "one that shaders cannot read", "with TEXTURE_BINDING"));
    }
    if !shadow.projection.is_finite() || shadow.projection.determinant() == 0.0 {
        return Err(wrong(
            "the projection of a scene's shadow map",
            "flat, or no numbers",
            "one of all of space",
        ));
    }
    if !shadow.bias.is_finite() {
        return Err(wrong("the bias of a scene's shadow map", shadow.bias, "a length, metres"));
    }
    let Some([origin, size]) = shadow.part else { return Ok(()) };
    let whole = texture.size();
    let fits =
        |i: usize, edge: u32| size[i] > 0 && origin[i].checked_add(size[i]).is_some_and(|end| end <= edge);
    if fits(0, whole.width) && fits(1, whole.height) {
        return Ok(());
    }
    let value = format!("{size:?} texels from {origin:?} on, of {} by {}", whole.width, whole.height);
    Err(wrong("the part of a scene's shadow map", value, "in it"))
}
