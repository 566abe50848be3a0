//! The light of a frame: its uniforms, and the passes over its hair.

use super::{
    Casters, FrameLight, HairSet, HairView, ImportedShadows, LightState, Lights, SceneShadow, ShadingSubset,
    Shadows, Sphere, lights::LightUniform, shadow,
};
use crate::{
    Result,
    body::Body,
    constants::{LIGHT_GROUP, STRAND_WORKGROUP},
    gpu::{BindBuffer, Commands, Kernel},
    renderer::{Renderer, ShadingRate, ShadowMethod},
    shaders::kernels::light as kernels,
    strands::StrandBuffers,
};

impl LightState {
    /// Uploads the uniforms of a frame, in which at most `max_maps` lights have shadow maps. Two values belong to a material: the fraction of light that a fiber passes on,
    /// and the fraction of that light which hits other hair. For several grooms these are means, weighted by the area
    /// of the strands ([`HairSet::area`](super::HairSet::area)). They color the light that hair transmits to meshes,
    /// and attenuate the light of meshes in the grid. Shading of hair uses the groom's own material.
    pub(crate) fn prepare(
        &self,
        (lights, shadows, focus): (&Lights, &Shadows, &Sphere),
        (renderer, max_maps): (Renderer, u32),
        hair: &[HairView<'_>],
        zone: u32,
    ) -> FrameLight {
        let resolution = self.maps.resolution;
        // Without shadows the maps stay empty. Empty deep opacity maps are the cheapest to read.
        let method = if shadows.is_enabled { renderer.shadows() } else { ShadowMethod::DeepOpacity };
        let max_maps = self.maps.count.min(max_maps);
        let selected = lights.select(focus, max_maps as usize, shadows.computes_ambient());
        let mut uniform = lights.uniform(&selected, (shadows, method), focus, resolution);
        let unmapped: Vec<_> =
            selected.unmapped.iter().map(|(light, share)| LightUniform::new(light, *share)).collect();
        self.ambient.prepare(&self.queue, &unmapped);
        let has_near_lights = !unmapped.is_empty()
            || selected.mapped.len() > LIGHT_GROUP as usize
            || selected.mapped.iter().any(|(light, _)| light.center().is_some());
        self.set_near_lights(has_near_lights);
        if shadows.computes_ambient() {
            uniform.ambient = self.ambient.cells();
        }
        if shadows.is_enabled && method == ShadowMethod::DeepOpacity && shadows.strand_by_strand > 0.0 {
            uniform.strand_map = self.maps.strand_map;
        }
        // Meshes have enough sample points for fine cells. A zone may have coarser ones.
        (uniform.zone, uniform.every) = (zone, if zone > 0 { self.ambient.every() } else { 1 });
        let total_area: f32 = hair.iter().map(|view| view.hair.area).sum();
        for view in hair {
            let (passes, forward) = view.hair.passes(renderer.shading());
            let weight = if total_area > 0.0 { view.hair.area / total_area } else { 1.0 / hair.len() as f32 };
            uniform.passes += weight * passes;
            uniform.forward += weight * forward;
        }
        self.lights.write(0, bytemuck::bytes_of(&uniform));
        self.maps.prepare(&uniform.views[..uniform.view_count as usize]);
        let texel = 2.0 * focus.radius.max(1e-6) / resolution as f32;
        FrameLight {
            casts: shadows.is_enabled,
            method,
            maps: uniform.maps as usize,
            lights: selected.mapped.iter().map(|(light, _)| *light).collect(),
            strands: if uniform.strand_map > 0 { uniform.count as usize } else { 0 },
            across: shadows.hair_texels(method, texel),
            stray: texel.min(shadow::STRAY * shadows.bias),
            ambient: shadows.computes_ambient(),
            has_unmapped: !unmapped.is_empty(),
            every: uniform.every,
            views: uniform.views[..uniform.view_count as usize].to_vec(),
            focus: *focus,
        }
    }

    /// Selects the scene shadows that the maps of `lit` import.
    ///
    /// # Errors
    /// As [`ImportedShadows::new`].
    pub(crate) fn import_shadows(
        &self,
        lit: &FrameLight,
        shadows: &[SceneShadow<'_>],
    ) -> Result<ImportedShadows> {
        ImportedShadows::new(&self.pipelines.scene, self.maps.resolution, lit, shadows)
    }

    /// Records the shadow maps of the lights that are on, and of the sky if its visibility is estimated. They include
    /// the imported scene shadows.
    pub(crate) fn record_shadows(
        &self,
        commands: &mut Commands<'_>,
        lit: &FrameLight,
        casters: &Casters<'_>,
        scene: &ImportedShadows,
    ) -> Result<()> {
        self.maps.record(&self.pipelines, commands, lit, casters, scene, self.has_near_lights())
    }

    /// Returns the bind group of hair of another zone, for drawing it into the maps of this one.
    pub(crate) fn bind_caster(&self, hair: &HairView<'_>) -> wgpu::BindGroup {
        let [hair_maps, hair_blocks] = self.maps.hair_buffers().map(BindBuffer::entire);
        let StrandBuffers { vertices, strands, widening, .. } = &hair.hair.strands;
        self.pipelines.splat[0].bind(&kernels::ShadowMaps {
            lights: self.lights.entire(),
            hair: hair.shaded.uniform.entire(),
            vertices: vertices.entire(),
            strands: strands.entire(),
            hair_maps,
            hair_blocks,
            widening: widening.entire(),
        })
    }

    /// Records ambient light, if it is computed. Call it after the shadow maps.
    pub(crate) fn record_ambient(
        &self,
        commands: &mut Commands<'_>,
        hair: &[HairView<'_>],
        bodies: (&[&Body], u32),
        has_unmapped: bool,
    ) -> Result<()> {
        let hair: Vec<_> = hair.iter().map(|view| (view.hair.drawn, &view.shaded.ambient_splat)).collect();
        self.ambient.record(
            &self.pipelines.ambient,
            commands,
            &hair,
            bodies,
            (self.has_near_lights(), has_unmapped),
        )
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
                    run(self.pipelines.shading_samples(self.has_near_lights()), spans + 1);
                    run(self.pipelines.shade(self.maps.strand_map > 0, self.has_near_lights()), spans);
                }
                ShadingRate::PerPixel => {
                    let near = usize::from(self.has_near_lights());
                    run(&self.pipelines.arrive[near], hair.drawn.vertex_count);
                }
            }
        }
        pass.end()
    }

    /// Records the shading of the selected vertices only.
    pub fn shade_subsets(
        &self,
        commands: &mut Commands<'_>,
        hair: &[(&HairSet, &ShadingSubset)],
    ) -> Result<()> {
        hair.iter().for_each(|(_, subset)| subset.clear(commands));
        let mut pass = commands.compute("shade");
        for (hair, subset) in hair {
            subset.record(&self.pipelines, &mut pass, hair, self.has_near_lights());
        }
        pass.end()
    }
}
