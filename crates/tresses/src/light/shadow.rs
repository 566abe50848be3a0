//! Shadow maps of a view, and the passes that draw them: meshes as triangles into depth textures, hair by compute
//! kernels into a buffer.
//!
//! Hair is thinner than a texel, so its rasterization is a walk along lines with atomic operations. This reads each
//! vertex once for all maps, and has no triangle setup (which a software driver does on one thread). It also separates
//! hair, which transmits light, from meshes, which do not.

use glam::Mat4;

use super::{
    FrameLight, ImportedShadows, Pipelines,
    lights::{LightsUniform, SHADOW_MAPS},
    shadows::MIN_DEEP_OPACITY_TEXEL,
};
use crate::{
    Context, Result,
    body::Body,
    constants::{COVER_STRANDS, COVER_STRIDE, DEEP_LAYERS, MAX_LIGHTS, SHADOW_BLOCK as BLOCK, STRAND_WORKGROUP},
    gpu::{BindBuffer, Commands, Kernel, Uniform, commands::deep, pipeline::DEPTH_FORMAT},
    renderer::ShadowMethod,
    shaders::kernels::light as kernels,
    strands::DrawCount,
};

/// Maximum texels along an edge: the maps stay within the 128 MiB that every device can bind.
const MAX_RESOLUTION: u32 = 2048;
/// Minimum texels along an edge of a strand map. Coarser maps do not resolve strands.
const MIN_STRAND_RESOLUTION: u32 = 256;
/// Words per texel of a deep opacity map, as in `light::deep`.
const DEEP_WORDS: u32 = DEEP_LAYERS + 2;
/// Limit, in units of the bias, on the deviation of a shadow-casting mesh from the drawn one. A texel is the other
/// limit.
pub(super) const STRAY: f32 = 0.3;
/// Distance between the matrices of two layers, bytes: the largest offset alignment that WebGPU may require.
const STEP: u64 = 256;

/// Hair that casts shadows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HairCaster<'a> {
    /// Group of the kernels over its strands.
    pub group: &'a wgpu::BindGroup,
    pub drawn: DrawCount,
    /// Stride and number of the segments in the maps.
    pub splat: [u32; 2],
}

/// A depth map and a hair map for each light.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    /// Texels along each edge.
    pub resolution: u32,
    /// Depth of meshes, all layers.
    view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    matrices: Uniform,
    layer_group: wgpu::BindGroup,
    /// Per map: heights of the hair nearest the light, or a deep opacity map.
    hair: wgpu::Buffer,
    /// Texels along each edge of a strand map; 0 for none.
    pub(super) strand_map: u32,
    /// Per map: amount and height of hair in blocks of texels, or a strand map.
    blocks: wgpu::Buffer,
    comparison: wgpu::Sampler,
}

impl ShadowMaps {
    /// Creates maps of `resolution`² texels and, unless `strand_map` is 0, a strand map of `strand_map`² texels per
    /// light.
    pub(super) fn new(context: &Context, pipelines: &Pipelines, [resolution, strand_map]: [u32; 2]) -> Self {
        let Context { device, .. } = context;
        let resolution = Self::within(resolution);
        let strand_map =
            if strand_map > 0 { strand_map.clamp(MIN_STRAND_RESOLUTION, MAX_RESOLUTION) } else { 0 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: SHADOW_MAPS as u32,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let layers = (0..SHADOW_MAPS as u32)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let matrices = device.uniform(STEP as usize * SHADOW_MAPS);
        let layer_group = device.group(
            "shadow layer",
            &pipelines.layer,
            &[matrices.part::<Mat4>(0, Some(size_of::<Mat4>() as u64)).into()],
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
            SHADOW_MAPS as u64 * map_words(ShadowMethod::DeepOpacity, resolution, MIN_DEEP_OPACITY_TEXEL),
        );
        let blocks = buffer("hair blocks", block_words(resolution).max(strand_words(MAX_LIGHTS as usize, strand_map)));
        let comparison = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let view = texture.create_view(&Default::default());
        Self { resolution, strand_map, view, layers, matrices, layer_group, hair, blocks, comparison }
    }

    /// Clamps a resolution to the supported range.
    pub(super) fn within(resolution: u32) -> u32 {
        resolution.clamp(BLOCK, MAX_RESOLUTION)
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        let depth = 4 * SHADOW_MAPS as u64 * u64::from(self.resolution).pow(2);
        depth + self.hair.size() + self.blocks.size() + self.matrices.size()
    }

    /// Returns the bytes of GPU memory of maps of `resolution`² texels.
    pub(super) fn bytes_of(resolution: u32) -> u64 {
        let resolution = Self::within(resolution);
        let words = u64::from(resolution).pow(2)
            + map_words(ShadowMethod::DeepOpacity, resolution, MIN_DEEP_OPACITY_TEXEL);
        SHADOW_MAPS as u64 * (4 * words + STEP) + 4 * block_words(resolution)
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

    pub(super) fn prepare(&self, lights: &LightsUniform) {
        let mut slots = [[0; STEP as usize]; SHADOW_MAPS];
        for (slot, matrix) in slots.iter_mut().zip(&lights.shadow) {
            slot[..size_of_val(matrix)].copy_from_slice(bytemuck::bytes_of(matrix));
        }
        self.matrices.write(0, slots.as_flattened());
    }

    /// Records the maps described by `lit`.
    pub(super) fn record(
        &self,
        pipelines: &Pipelines,
        commands: &mut Commands<'_>,
        lit: &FrameLight,
        hair: &[HairCaster<'_>],
        (bodies, scene): (&[&Body], &ImportedShadows),
    ) -> Result<()> {
        let FrameLight { casts, method, maps, across, stray, strands, .. } = *lit;
        let (hair, bodies) = if casts { (hair, bodies) } else { (&[][..], &[][..]) };
        if maps == 0 {
            return Ok(());
        }
        let body = if bodies.is_empty() { None } else { Some(pipelines.shadow_body()?) };
        for (i, layer) in self.layers[..maps].iter().enumerate() {
            let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
            let mut pass = commands.render("shadow", &[], deep(layer, Some(depth)));
            if casts {
                scene.record(&mut pass, i);
            }
            pass.set_bind_group(0, &self.layer_group, &[(STEP * i as u64) as u32]);
            if let Some(body) = &body {
                pass.set_pipeline(body);
                bodies.iter().for_each(|body| body.record(&mut pass, stray));
            }
        }
        let words = maps as u64 * map_words(method, self.resolution, across);
        commands.clear(&self.hair, Some(4 * words));
        let Some(first) = hair.first() else {
            commands.clear(&self.blocks, None);
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
        for caster in hair {
            run(&pipelines.splat, caster, u64::from(caster.drawn.count) * u64::from(caster.splat[1]));
        }
        // Kernels over texels do the same with the bindings of any groom.
        match method {
            ShadowMethod::DeepOpacity => {
                let texels = words / u64::from(DEEP_WORDS);
                let [front, cover, stack] = &pipelines.deep;
                run(front, first, texels);
                for caster in hair {
                    let DrawCount { count, vertex_count, .. } = caster.drawn;
                    let strands = count.div_ceil(count.div_ceil(COVER_STRANDS).max(1));
                    let stride = caster.splat[0].min(COVER_STRIDE);
                    let steps = vertex_count.saturating_sub(1).div_ceil(stride);
                    run(cover, caster, u64::from(strands) * u64::from(steps));
                }
                run(stack, first, texels);
                for caster in hair.iter().filter(|_| strands > 0) {
                    let DrawCount { count, vertex_count, .. } = caster.drawn;
                    let segments = u64::from(vertex_count.saturating_sub(1));
                    run(&pipelines.strand_map, caster, u64::from(count) * segments);
                }
            }
            ShadowMethod::Opaque | ShadowMethod::Absorption => {
                let blocks = maps as u64 * u64::from(self.resolution.div_ceil(across * BLOCK)).pow(2);
                run(&pipelines.summary, first, blocks);
            }
        }
        pass.end()
    }
}

/// Returns the words of the blocks of all maps.
fn block_words(resolution: u32) -> u64 {
    SHADOW_MAPS as u64 * u64::from(resolution.div_ceil(BLOCK)).pow(2)
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
