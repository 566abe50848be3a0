//! The light of a frame: its uniforms, and the passes over its hair.

use super::{
    FrameLight, HairSet, HairView, ImportedShadows, LightState, Lights, SceneShadow, ShadingSubset, Shadows,
    Sphere, shadow,
};
use crate::{
    Result,
    body::Body,
    constants::STRAND_WORKGROUP,
    gpu::{Commands, Kernel},
    renderer::{Renderer, ShadingRate, ShadowMethod},
};

impl LightState {
    /// Uploads the uniforms of a frame. Two values belong to a material: the fraction of light that a fiber passes on,
    /// and the fraction of that light which hits other hair. For several grooms these are means, weighted by the area
    /// of the strands ([`HairSet::area`](super::HairSet::area)). They color the light that hair transmits to meshes,
    /// and attenuate the light of meshes in the grid. Shading of hair uses the groom's own material.
    pub(crate) fn prepare(
        &self,
        (lights, shadows, focus): (&Lights, &Shadows, &Sphere),
        renderer: Renderer,
        hair: &[HairView<'_>],
        zone: u32,
    ) -> FrameLight {
        let resolution = self.maps.resolution;
        // Without shadows the maps stay empty. Empty deep opacity maps are the cheapest to read.
        let method = if shadows.is_enabled { renderer.shadows() } else { ShadowMethod::DeepOpacity };
        let chosen = lights.chosen(focus);
        let mut uniform = lights.uniform(&chosen, (shadows, method), focus, resolution);
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
        self.maps.prepare(&uniform);
        let texel = 2.0 * focus.radius.max(1e-6) / resolution as f32;
        FrameLight {
            casts: shadows.is_enabled,
            method,
            maps: shadows.map_count(chosen.len()),
            ids: chosen.iter().map(|light| light.id).collect(),
            strands: if uniform.strand_map > 0 { uniform.count as usize } else { 0 },
            across: shadows.hair_texels(method, texel),
            stray: texel.min(shadow::STRAY * shadows.bias),
            ambient: shadows.computes_ambient(),
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
        hair: &[HairView<'_>],
        bodies: (&[&Body], &ImportedShadows),
    ) -> Result<()> {
        let hair: Vec<_> = hair.iter().map(|view| view.caster()).collect();
        self.maps.record(&self.pipelines, commands, lit, &hair, bodies)
    }

    /// Records ambient light, if it is computed. Call it after the shadow maps.
    pub(crate) fn record_ambient(
        &self,
        commands: &mut Commands<'_>,
        hair: &[HairView<'_>],
        bodies: (&[&Body], u32),
    ) -> Result<()> {
        let hair: Vec<_> = hair.iter().map(|view| (view.hair.drawn, &view.shaded.ambient_splat)).collect();
        self.ambient.record(&self.pipelines.ambient, commands, &hair, bodies)
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
                    run(&self.pipelines.shading_samples, spans + 1);
                    run(self.pipelines.shade(self.maps.strand_map > 0), spans);
                }
                ShadingRate::PerPixel => run(&self.pipelines.arrive, hair.drawn.vertex_count),
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
            subset.record(&self.pipelines, &mut pass, hair);
        }
        pass.end()
    }
}
