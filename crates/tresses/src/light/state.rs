//! Light of one view: its shadow maps, its ambient light, and the uniform of both.

use super::{
    Ambient, HairSet, HairView, ImportedShadows, Lights, Pipelines, SceneShadow, ShadingSubset, ShadowMaps,
    Shadows, Sphere,
    lights::{LightsUniform, SHADOW_MAPS},
};
use crate::{
    Context, Result,
    body::Body,
    constants::STRAND_WORKGROUP,
    gpu::{Commands, Kernel, bindings::uniform},
    renderer::{Renderer, ShadingRate, ShadowMethod},
};
use glam::Mat4;
use std::sync::Arc;

/// Light of a view on the GPU.
#[derive(Debug)]
pub struct LightState {
    pipelines: Arc<Pipelines>,
    pub(super) maps: ShadowMaps,
    pub(super) ambient: Ambient,
    pub(crate) lights: wgpu::Buffer,
    /// `@group(0)` of everything that is drawn in this light.
    pub(crate) frame: wgpu::BindGroup,
}

/// Parameters of the light passes of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameLight {
    /// Whether lights cast shadows.
    pub casts: bool,
    pub method: ShadowMethod,
    /// Number of shadow maps.
    pub maps: usize,
    /// Edge of a texel of the hair maps, in texels of a depth map.
    pub across: u32,
    /// Number of lights with a strand map.
    pub strands: usize,
    /// Limit on the deviation of shadow-casting meshes from the drawn ones, meters.
    pub stray: f32,
    /// Whether the frame computes ambient light.
    pub ambient: bool,
    /// Stride through the sample points of mesh surfaces.
    pub every: u32,
    /// World to clip space of each map.
    pub matrices: [Mat4; SHADOW_MAPS],
    /// Depth of the maps, meters.
    pub range: f32,
    /// Region that the maps cover.
    pub focus: Sphere,
}

impl LightState {
    /// Creates maps of `resolution`² texels, a grid of `cells` cells per edge and, unless `strand_map` is 0, strand
    /// maps of `strand_map`² texels. `camera` is the uniform buffer of the camera.
    pub fn new(
        context: &Context,
        [resolution, cells]: [u32; 2],
        strand_map: u32,
        camera: &wgpu::Buffer,
    ) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let lights = uniform(device, "lights", size_of::<LightsUniform>());
        let maps = ShadowMaps::new(context, &pipelines, [resolution, strand_map]);
        let ambient = Ambient::new(context, &pipelines.ambient, cells, &lights, maps.resources());
        let frame = frame_resources(camera, &lights, &maps, &ambient);
        Self { frame: device.group("frame", &pipelines.frame, &frame), pipelines, maps, ambient, lights }
    }

    /// Whether maps and grid have these sizes.
    pub(super) fn fits(&self, [resolution, cells]: [u32; 2]) -> bool {
        self.maps.resolution == ShadowMaps::within(resolution)
            && self.ambient.cells() == Ambient::within(cells)
    }

    /// Uploads the uniforms of a frame. Two values belong to a material: the fraction of light that a fiber passes on,
    /// and the fraction of that light which hits other hair. For several grooms these are means, weighted by the area
    /// of the strands ([`HairSet::area`](super::HairSet::area)). They color the light that hair transmits to meshes,
    /// and attenuate the light of meshes in the grid. Shading of hair uses the groom's own material.
    pub(crate) fn prepare(
        &self,
        context: &Context,
        (lights, shadows, focus): (&Lights, &Shadows, &Sphere),
        renderer: Renderer,
        hair: &[HairView<'_>],
        zone: u32,
    ) -> FrameLight {
        let Context { queue, .. } = context;
        let resolution = self.maps.resolution;
        // Without shadows the maps stay empty. Empty deep opacity maps are the cheapest to read.
        let method = if shadows.enabled { renderer.shadows() } else { ShadowMethod::DeepOpacity };
        let mut uniform = lights.uniform((shadows, method), focus, resolution);
        if shadows.follows_ambient() {
            uniform.ambient = self.ambient.cells();
        }
        if shadows.enabled && method == ShadowMethod::DeepOpacity && shadows.strand_by_strand > 0.0 {
            uniform.strand_map = self.maps.strand_map;
        }
        // Meshes have enough sample points for fine cells. A zone may have coarser ones.
        (uniform.zone, uniform.every) = (zone, if zone > 0 { self.ambient.every() } else { 1 });
        let whole: f32 = hair.iter().map(|seen| seen.hair.area).sum();
        for seen in hair {
            let (passes, forward) = seen.hair.passes(renderer.shading());
            let share = if whole > 0.0 { seen.hair.area / whole } else { 1.0 / hair.len() as f32 };
            uniform.passes += share * passes;
            uniform.forward += share * forward;
        }
        queue.write_buffer(&self.lights, 0, bytemuck::bytes_of(&uniform));
        self.maps.prepare(context, &uniform);
        let texel = 2.0 * focus.radius.max(1e-6) / resolution as f32;
        FrameLight {
            casts: shadows.enabled,
            method,
            maps: shadows.maps(lights.active().count()),
            strands: if uniform.strand_map > 0 { uniform.count as usize } else { 0 },
            across: shadows.hair_texels(method, texel),
            stray: texel.min(super::shadow::STRAY * shadows.bias),
            ambient: shadows.follows_ambient(),
            every: uniform.every,
            matrices: uniform.shadow,
            range: uniform.range,
            focus: *focus,
        }
    }

    /// Selects the scene shadows that the maps of `lit` import.
    ///
    /// # Errors
    /// As [`ImportedShadows::new`].
    pub(crate) fn bring(
        &self,
        lights: &Lights,
        lit: &FrameLight,
        shadows: &[SceneShadow<'_>],
    ) -> Result<ImportedShadows> {
        ImportedShadows::new(
            &self.pipelines,
            &self.maps,
            lights,
            (&lit.matrices, lit.range, &lit.focus),
            shadows,
        )
    }

    /// Records the shadow maps of the lights that are on, and of the sky if its visibility is estimated. They include
    /// the imported scene shadows.
    pub(crate) fn record_shadows(
        &self,
        commands: &mut Commands<'_>,
        lit: &FrameLight,
        hair: &[HairView<'_>],
        bodies: (&[&Body], &ImportedShadows),
    ) -> Result<()> {
        self.maps.record(&self.pipelines, commands, lit, hair, bodies)
    }

    /// Records ambient light, if it is computed. Call it after the shadow maps.
    pub(crate) fn record_ambient(
        &self,
        commands: &mut Commands<'_>,
        hair: &[HairView<'_>],
        bodies: (&[&Body], u32),
    ) -> Result<()> {
        self.ambient.record(&self.pipelines.ambient, commands, hair, bodies)
    }

    /// Records the shading of the strand vertices of `hair`, for images that shade it at `rate`.
    pub(crate) fn shade(
        &self,
        commands: &mut Commands<'_>,
        hair: &[HairView<'_>],
        rate: ShadingRate,
    ) -> Result<()> {
        let mut pass = commands.compute("shade");
        pass.set_bind_group(1, &self.pipelines.gap, &[]);
        for HairView { hair, shaded, .. } in hair {
            let [count, spans] = [hair.drawn.count, hair.spans[1]];
            pass.set_bind_group(2, &hair.fiber().group, &[]);
            let mut run = |kernel: &Kernel, each: u32| {
                kernel.record(&mut pass, &shaded.shade, &[], (count * each).div_ceil(STRAND_WORKGROUP));
            };
            match rate {
                ShadingRate::PerVertex => {
                    run(&self.pipelines.knots, spans + 1);
                    run(self.pipelines.shade(self.maps.strand_map > 0), spans);
                }
                ShadingRate::PerPixel => run(&self.pipelines.arrive, hair.drawn.vertex_count),
            }
        }
        pass.end()
    }

    /// Records the shading of the selected vertices only.
    pub fn shade_chosen(
        &self,
        commands: &mut Commands<'_>,
        hair: &[(&HairSet, &ShadingSubset)],
    ) -> Result<()> {
        hair.iter().for_each(|(_, chosen)| chosen.clear(commands));
        let mut pass = commands.compute("shade");
        for (hair, chosen) in hair {
            chosen.record(&self.pipelines, &mut pass, hair);
        }
        pass.end()
    }

    /// Bindings of shaders that read light: lights, depth maps of meshes, their comparison sampler, hair maps, blocks
    /// of the hair maps, ambient light, its sampler.
    pub(super) fn resources(&self) -> [wgpu::BindingResource<'_>; 7] {
        let [maps, comparison, hair, blocks] = self.maps.resources();
        let [grid, linear] = self.ambient.resources();
        [self.lights.as_entire_binding(), maps, comparison, hair, blocks, grid, linear]
    }

    /// The camera, followed by [`resources`](Self::resources).
    pub(crate) fn frame_resources<'a>(&'a self, camera: &'a wgpu::Buffer) -> [wgpu::BindingResource<'a>; 8] {
        frame_resources(camera, &self.lights, &self.maps, &self.ambient)
    }

    /// Returns the bytes of GPU memory of maps and cells of these sizes.
    pub(super) fn bytes_of([resolution, cells]: [u32; 2]) -> u64 {
        ShadowMaps::bytes_of(resolution) + Ambient::bytes_of(cells)
    }

    /// Bytes of GPU memory of the shadow maps.
    pub fn shadow_bytes(&self) -> u64 {
        self.maps.bytes()
    }

    /// Bytes of GPU memory of ambient light.
    pub fn ambient_bytes(&self) -> u64 {
        self.ambient.bytes()
    }
}

fn frame_resources<'a>(
    camera: &'a wgpu::Buffer,
    lights: &'a wgpu::Buffer,
    maps: &'a ShadowMaps,
    ambient: &'a Ambient,
) -> [wgpu::BindingResource<'a>; 8] {
    let [body, comparison, hair, blocks] = maps.resources();
    let [grid, linear] = ambient.resources();
    [camera.as_entire_binding(), lights.as_entire_binding(), body, comparison, hair, blocks, grid, linear]
}
