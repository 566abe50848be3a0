//! Shadow maps of a view, and the passes that draw them: meshes as triangles into depth textures, hair by compute
//! kernels into a buffer.
//!
//! Hair is thinner than a texel, so its rasterization is a walk along lines with atomic operations. This reads each
//! vertex once for all maps, and has no triangle setup (which a software driver does on one thread). It also separates
//! hair, which transmits light, from meshes, which do not.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use super::{FrameLight, ImportedShadows, Pipelines, map_view::MapView, shadows::MIN_DEEP_OPACITY_TEXEL};
use crate::{
    Context, Result,
    body::{Body, BodyState},
    constants::{
        COVER_STRANDS, COVER_STRIDE, DEEP_LAYERS, MAX_LIGHTS, MAX_MAP_VIEWS, SHADOW_BLOCK as BLOCK,
        STRAND_WORKGROUP,
    },
    gpu::{BindBuffer, Commands, Kernel, Uniform, commands::deep, pipeline::DEPTH_FORMAT},
    renderer::ShadowMethod,
    shaders::kernels::light as kernels,
    strands::DrawCount,
};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Maximum texels along an edge: the maps stay within the 128 MiB that every device can bind.
const MAX_RESOLUTION: u32 = 2048;
/// Minimum texels along an edge of a strand map. Coarser maps do not resolve strands.
const MIN_STRAND_RESOLUTION: u32 = 256;
/// Words per texel of a deep opacity map, as in `light::deep`.
const DEEP_WORDS: u32 = DEEP_LAYERS + 2;
/// Limit, in units of the bias, on the deviation of a shadow-casting mesh from the drawn one. A texel is the other
/// limit.
pub(super) const STRAY: f32 = 0.3;
/// See [`LayerUniform::inner_lift`]: twice the depth in the skin at which roots are lit (`transmittance::SKIN`).
const INNER_LIFT: f32 = 0.008;
/// Distance between the matrices of two layers, bytes: the largest offset alignment that WebGPU may require.
const STEP: u64 = 256;

/// A view into a shadow map, as the shader of meshes reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LayerUniform {
    /// [`MapView::raster`].
    pub matrix: Mat4,
    /// Position of a near light, meters.
    pub place: Vec3,
    /// Depth to which nearer vertices are moved: 0 for meshes of other zones, which may lie before the map.
    pub nearest: f32,
    /// Distance by which surfaces that a near light sees from their inner side are moved towards it, meters.
    pub inner_lift: f32,
    /// Unused.
    pub _pad: u32,
    /// Unused.
    pub _pad_2: [u32; 2],
}

/// What casts shadows into the maps of a zone.
#[derive(Debug, Default)]
pub(crate) struct Casters<'a> {
    /// Hair and meshes of the zone.
    pub hair: Vec<HairCaster<'a>>,
    pub bodies: Vec<&'a Body>,
    /// Hair and meshes of other zones, between this one and a light.
    pub other_hair: Vec<HairCaster<'a>>,
    pub other_bodies: Vec<&'a Body>,
}

/// Hair that casts shadows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HairCaster<'a> {
    /// Group of the kernels over its strands.
    pub group: &'a wgpu::BindGroup,
    pub drawn: DrawCount,
    /// Stride and number of the segments in the maps.
    pub splat: [u32; 2],
    /// [`HairSet::write_count`](super::HairSet::write_count).
    pub write_count: Option<u64>,
}

/// State of hair in shadow maps.
#[derive(Clone, Debug, PartialEq)]
struct HairState {
    group: wgpu::BindGroup,
    write_count: u64,
    drawn: DrawCount,
    splat: [u32; 2],
}

/// Everything that the maps of a frame depend on.
#[derive(Clone, Debug, PartialEq)]
struct MapsState {
    views: Vec<MapView>,
    method: ShadowMethod,
    /// Number of maps and of strand maps, width of a texel of the hair maps.
    sizes: [usize; 3],
    casts: bool,
    stray: f32,
    /// Hair of the zone, then of other zones.
    hair: [Vec<HairState>; 2],
    /// The same of meshes.
    bodies: [Vec<BodyState>; 2],
}

impl MapsState {
    /// Returns the state of the maps of `lit`, or `None` if something may change without notice.
    fn new(lit: &FrameLight, casters: &Casters<'_>, scene: &ImportedShadows) -> Option<Self> {
        let hair = |casters: &[HairCaster<'_>]| {
            let state = |caster: &HairCaster<'_>| {
                let HairCaster { group, drawn, splat, write_count } = *caster;
                Some(HairState { group: group.clone(), write_count: write_count?, drawn, splat })
            };
            casters.iter().map(state).collect::<Option<Vec<_>>>()
        };
        let bodies = |bodies: &[&Body]| bodies.iter().map(|body| body.state()).collect::<Option<Vec<_>>>();
        let state = Self {
            views: lit.views.clone(),
            method: lit.method,
            sizes: [lit.maps, lit.strands, lit.across as usize],
            casts: lit.casts,
            stray: lit.stray,
            hair: [hair(&casters.hair)?, hair(&casters.other_hair)?],
            bodies: [bodies(&casters.bodies)?, bodies(&casters.other_bodies)?],
        };
        scene.is_empty().then_some(state)
    }
}

/// A depth map and a hair map for each light.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    /// Number of lights.
    pub count: u32,
    /// Texels along each edge.
    pub resolution: u32,
    /// Depth of meshes, all layers.
    view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    /// A [`LayerUniform`] of each view, for its own meshes, then for those of other zones.
    layers_uniform: Uniform,
    layer_group: wgpu::BindGroup,
    /// Per map: heights of the hair nearest the light, or a deep opacity map.
    hair: wgpu::Buffer,
    /// Texels along each edge of a strand map; 0 for none.
    pub(super) strand_map: u32,
    /// Per map: amount and height of hair in blocks of texels, or a strand map.
    blocks: wgpu::Buffer,
    comparison: wgpu::Sampler,
    /// State of the maps that were recorded last, if it is known.
    recorded: Mutex<Option<MapsState>>,
}

impl ShadowMaps {
    /// Creates maps for `count` lights, of `resolution`² texels, and, unless `strand_map` is 0, a strand map of
    /// `strand_map`² texels per light.
    pub(super) fn new(
        context: &Context,
        pipelines: &Pipelines,
        count: u32,
        [resolution, strand_map]: [u32; 2],
    ) -> Self {
        let Context { device, .. } = context;
        let (count, resolution) = (Self::count_within(count), Self::within(resolution));
        let layer_count = count + 1;
        let strand_map =
            if strand_map > 0 { strand_map.clamp(MIN_STRAND_RESOLUTION, MAX_RESOLUTION) } else { 0 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: layer_count,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let layers = (0..layer_count)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let layers_uniform = device.uniform(2 * STEP as usize * MAX_MAP_VIEWS as usize);
        let layer_group = device.group(
            "shadow layer",
            &pipelines.layer,
            &[layers_uniform.part::<LayerUniform>(0, Some(size_of::<LayerUniform>() as u64)).into()],
        );
        let buffer = |label, words| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: 4 * words,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let hair = buffer(
            "hair in shadow maps",
            u64::from(layer_count) * map_words(ShadowMethod::DeepOpacity, resolution, MIN_DEEP_OPACITY_TEXEL),
        );
        let blocks = buffer(
            "hair blocks",
            block_words(resolution, count).max(strand_words(count as usize, strand_map)),
        );
        let comparison = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let view = texture.create_view(&Default::default());
        Self {
            count,
            resolution,
            strand_map,
            view,
            layers,
            layers_uniform,
            layer_group,
            hair,
            blocks,
            comparison,
            recorded: Mutex::default(),
        }
    }

    /// Clamps a number of lights to the supported range.
    pub(super) fn count_within(count: u32) -> u32 {
        count.clamp(1, MAX_LIGHTS)
    }

    /// Clamps a resolution to the supported range.
    pub(super) fn within(resolution: u32) -> u32 {
        resolution.clamp(BLOCK, MAX_RESOLUTION)
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        let depth = 4 * u64::from(self.count + 1) * u64::from(self.resolution).pow(2);
        depth + self.hair.size() + self.blocks.size() + self.layers_uniform.size()
    }

    /// Returns the bytes of GPU memory of maps of `resolution`² texels for `count` lights.
    pub(super) fn bytes_of(resolution: u32, count: u32) -> u64 {
        let (count, resolution) = (Self::count_within(count), Self::within(resolution));
        let words = u64::from(resolution).pow(2)
            + map_words(ShadowMethod::DeepOpacity, resolution, MIN_DEEP_OPACITY_TEXEL);
        let matrices = 2 * STEP * u64::from(MAX_MAP_VIEWS);
        u64::from(count + 1) * 4 * words + matrices + 4 * block_words(resolution, count)
    }

    /// Buffers of the hair maps, and of their blocks of texels.
    pub(super) fn hair_buffers(&self) -> [&wgpu::Buffer; 2] {
        [&self.hair, &self.blocks]
    }

    /// Bindings of kernels that read the maps of `lights`.
    pub(super) fn transmittance<'a>(&'a self, lights: &'a Uniform) -> kernels::Transmittance<'a> {
        kernels::Transmittance {
            lights: lights.entire(),
            body_maps: &self.view,
            comparison: &self.comparison,
            hair_maps: self.hair.entire(),
            hair_blocks: self.blocks.entire(),
        }
    }

    pub(super) fn prepare(&self, views: &[MapView]) {
        let mut slots = vec![[0; STEP as usize]; 2 * views.len()];
        for (i, slot) in slots.iter_mut().enumerate() {
            let is_other = i >= views.len();
            let nearest = if is_other { 0.0 } else { f32::MIN };
            let view = &views[i % views.len()];
            let place = view.place();
            let layer = LayerUniform {
                matrix: view.raster(),
                place: place.unwrap_or_default(),
                nearest,
                inner_lift: if place.is_some() { INNER_LIFT } else { 0.0 },
                _pad: 0,
                _pad_2: [0; 2],
            };
            slot[..size_of_val(&layer)].copy_from_slice(bytemuck::bytes_of(&layer));
        }
        self.layers_uniform.write(0, slots.as_flattened());
    }

    /// Records the maps described by `lit`.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        commands: &mut Commands<'_>,
        lit: &FrameLight,
        casters: &Casters<'_>,
        scene: &ImportedShadows,
        near_lights: bool,
    ) -> Result<()> {
        let near = usize::from(near_lights);
        let FrameLight { casts, method, maps, across, stray, strands, .. } = *lit;
        let nothing = Casters::default();
        let Casters { hair, bodies, other_hair, other_bodies } = if casts { casters } else { &nothing };
        if maps == 0 {
            return Ok(());
        }
        let state = MapsState::new(lit, casters, scene);
        if state.is_some() && *self.recorded() == state {
            return Ok(());
        }
        *self.recorded() = None;
        let body = (!bodies.is_empty()).then(|| pipelines.shadow_body(near_lights)).transpose()?;
        let other_body = (!other_bodies.is_empty()).then(|| pipelines.shadow_body(true)).transpose()?;
        for (i, layer) in self.layers[..maps].iter().enumerate() {
            let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
            let mut pass = commands.render("shadow", &[], deep(layer, Some(depth)));
            for (number, view) in lit.views.iter().enumerate().filter(|(_, view)| view.map == i as u32) {
                let [left, top, width, height] = view.viewport(self.resolution);
                pass.set_viewport([left, top], [width, height]);
                if casts {
                    scene.record(&mut pass, number);
                }
                let own = (&body, bodies, number);
                for (pipeline, bodies, slot) in [own, (&other_body, other_bodies, lit.views.len() + number)] {
                    let Some(pipeline) = pipeline else { continue };
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, &self.layer_group, &[(STEP * slot as u64) as u32]);
                    bodies.iter().for_each(|body| body.record(&mut pass, stray));
                }
            }
        }
        let words = maps as u64 * map_words(method, self.resolution, across);
        commands.clear(&self.hair, Some(4 * words));
        let Some(first) = hair.first().or(other_hair.first()) else {
            commands.clear(&self.blocks, None);
            *self.recorded() = state;
            return Ok(());
        };
        if strands > 0 {
            commands.clear(&self.blocks, Some(4 * strand_words(strands, self.strand_map)));
        }
        let mut pass = commands.compute("shadow");
        let mut run = |kernel: &Kernel, of: &HairCaster<'_>, threads: u64| {
            let workgroups = threads.div_ceil(u64::from(STRAND_WORKGROUP)) as u32;
            kernel.record(&mut pass, of.group, &[], workgroups);
        };
        // Hair of other zones comes last.
        for (casters, kernel) in [(hair, near), (other_hair, 2 + near)] {
            for caster in casters {
                let segments = u64::from(caster.drawn.count) * u64::from(caster.splat[1]);
                run(&pipelines.splat[kernel], caster, segments);
            }
        }
        // Kernels over texels do the same with the bindings of any groom.
        match method {
            ShadowMethod::DeepOpacity => {
                let texels = words / u64::from(DEEP_WORDS);
                let [front, stack] = &pipelines.deep;
                run(front, first, texels);
                for (casters, kernel) in [(hair, near), (other_hair, 2 + near)] {
                    for caster in casters {
                        let DrawCount { count, vertex_count, .. } = caster.drawn;
                        let strands = count.div_ceil(count.div_ceil(COVER_STRANDS).max(1));
                        let stride = caster.splat[0].min(COVER_STRIDE);
                        let steps = vertex_count.saturating_sub(1).div_ceil(stride);
                        run(&pipelines.cover[kernel], caster, u64::from(strands) * u64::from(steps));
                    }
                }
                run(stack, first, texels);
                for caster in hair.iter().filter(|_| strands > 0) {
                    let DrawCount { count, vertex_count, .. } = caster.drawn;
                    let segments = u64::from(vertex_count.saturating_sub(1));
                    run(&pipelines.strand_map[near], caster, u64::from(count) * segments);
                }
            }
            ShadowMethod::Opaque | ShadowMethod::Absorption => {
                let blocks = maps as u64 * u64::from(self.resolution.div_ceil(across * BLOCK)).pow(2);
                run(&pipelines.summary, first, blocks);
            }
        }
        pass.end()?;
        *self.recorded() = state;
        Ok(())
    }

    /// Locks the state of the maps that were recorded last.
    fn recorded(&self) -> MutexGuard<'_, Option<MapsState>> {
        // The value is valid even if another thread has panicked.
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the words of the blocks of all maps for `count` lights.
fn block_words(resolution: u32, count: u32) -> u64 {
    u64::from(count + 1) * u64::from(resolution.div_ceil(BLOCK)).pow(2)
}

/// Returns the words of the strand maps of `lights` lights.
fn strand_words(lights: usize, texels: u32) -> u64 {
    lights as u64 * u64::from(texels).pow(2)
}

/// Returns the words of the hair in one map of `resolution`² texels. A texel of the hair is `across` texels of the map
/// wide.
fn map_words(method: ShadowMethod, resolution: u32, across: u32) -> u64 {
    let words = match method {
        ShadowMethod::Opaque | ShadowMethod::Absorption => 1,
        ShadowMethod::DeepOpacity => u64::from(DEEP_WORDS),
    };
    u64::from(resolution.div_ceil(across)).pow(2) * words
}
