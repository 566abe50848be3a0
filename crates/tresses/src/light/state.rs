//! The light of one view: its shadow maps, its light from all sides, and the uniform that both are made by.

use super::{
    Ambient, Brought, Chosen, HairSet, Lights, Pipelines, SceneShadow, Seen, ShadingRate, ShadowMaps,
    ShadowMethod, Shadows, Sphere,
    lights::{LightsUniform, SHADOW_MAPS},
};
use crate::{
    Context, Result,
    body::Body,
    constants::STRAND_WORKGROUP,
    gpu::{Commands, Kernel, bindings::uniform},
};
use glam::Mat4;
use std::sync::Arc;

/// The light of a view on the GPU.
#[derive(Debug)]
pub struct State {
    pipelines: Arc<Pipelines>,
    pub(super) maps: ShadowMaps,
    pub(super) ambient: Ambient,
    pub(crate) lights: wgpu::Buffer,
    /// `@group(0)` of everything that is drawn in this light.
    pub(crate) frame: wgpu::BindGroup,
}

/// What of it a frame records.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub method: ShadowMethod,
    /// How many shadow maps.
    pub maps: usize,
    /// Texels of a map along the edge of a texel of the hair's.
    pub across: u32,
    /// How many lights have a strand map.
    pub strands: usize,
    /// How far bodies that cast shadows may stray from those that are drawn, metres.
    pub stray: f32,
    /// Whether light from all sides is followed, and made anew.
    pub ambient: bool,
    /// Every so many points of a body's surface stand for all of them.
    pub every: u32,
    /// From the world to the clip space of each map, and the depth of all of them, metres.
    pub matrices: [Mat4; SHADOW_MAPS],
    pub range: f32,
    /// What they cover.
    pub focus: Sphere,
}

impl State {
    /// Maps of `resolution`² texels, and as many cells along each edge of the grid, for what `camera` (a uniform
    /// buffer) sees; strand maps of `strand_map`² texels, unless that is 0.
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

    /// Whether it has maps and cells of these sizes.
    pub(super) fn fits(&self, [resolution, cells]: [u32; 2]) -> bool {
        self.maps.resolution == ShadowMaps::within(resolution)
            && self.ambient.cells() == Ambient::within(cells)
    }

    /// Writes the uniforms of a frame. Two of them, the share of light that a fibre passes on and the share of that
    /// which meets other hair, belong to a material: of several grooms they are the means, weighed by the area of
    /// their strands ([`HairSet::area`](super::HairSet::area)). They colour what hair lets through to bodies, and
    /// what it takes of a body's light in the grid; on hair itself each groom's own material tells.
    pub(crate) fn prepare(
        &self,
        context: &Context,
        (lights, shadows, focus): (&Lights, &Shadows, &Sphere),
        hair: &[Seen<'_>],
        zone: u32,
    ) -> Lit {
        let Context { queue, .. } = context;
        let resolution = self.maps.resolution;
        let mut uniform = lights.uniform(shadows, focus, resolution);
        if shadows.follows_ambient() {
            uniform.ambient = self.ambient.cells();
        }
        if shadows.method == ShadowMethod::DeepOpacity && shadows.strand_by_strand > 0.0 {
            uniform.strand_map = self.maps.strand_map;
        }
        // Bodies have as many points as fine cells ask for; a zone may have coarser ones.
        (uniform.zone, uniform.every) = (zone, if zone > 0 { self.ambient.every() } else { 1 });
        let whole: f32 = hair.iter().map(|seen| seen.hair.area).sum();
        for seen in hair {
            let (passes, forward) = seen.hair.passes();
            let share = if whole > 0.0 { seen.hair.area / whole } else { 1.0 / hair.len() as f32 };
            uniform.passes += share * passes;
            uniform.forward += share * forward;
        }
        queue.write_buffer(&self.lights, 0, bytemuck::bytes_of(&uniform));
        self.maps.prepare(context, &uniform);
        let texel = 2.0 * focus.radius.max(1e-6) / resolution as f32;
        Lit {
            method: shadows.method,
            maps: shadows.maps(lights.active().count()),
            strands: if uniform.strand_map > 0 { uniform.count as usize } else { 0 },
            across: shadows.hair_texels(texel),
            stray: texel.min(super::shadow::STRAY * shadows.bias),
            ambient: shadows.follows_ambient(),
            every: uniform.every,
            matrices: uniform.shadow,
            range: uniform.range,
            focus: *focus,
        }
    }

    /// What its maps take of those of a scene, in the light of `lit`.
    ///
    /// # Errors
    /// As [`Brought::new`].
    pub(crate) fn bring(&self, lights: &Lights, lit: &Lit, shadows: &[SceneShadow<'_>]) -> Result<Brought> {
        Brought::new(&self.pipelines, &self.maps, lights, (&lit.matrices, lit.range, &lit.focus), shadows)
    }

    /// Records the shadow maps, with what was brought of a scene: of the lights that are on, and of the sky where its
    /// openness is guessed.
    pub(crate) fn record_shadows(
        &self,
        commands: &mut Commands<'_>,
        lit: &Lit,
        hair: &[Seen<'_>],
        bodies: (&[&Body], &Brought),
    ) -> Result<()> {
        self.maps.record(&self.pipelines, commands, lit, hair, bodies)
    }

    /// Records light from all sides, where it is followed; after the shadow maps.
    pub(crate) fn record_ambient(
        &self,
        commands: &mut Commands<'_>,
        hair: &[Seen<'_>],
        bodies: (&[&Body], u32),
    ) -> Result<()> {
        self.ambient.record(&self.pipelines.ambient, commands, hair, bodies)
    }

    /// Records the shading of the strand vertices of `hair`, for pictures that shade it at `rate`.
    pub(crate) fn shade(
        &self,
        commands: &mut Commands<'_>,
        hair: &[Seen<'_>],
        rate: ShadingRate,
    ) -> Result<()> {
        let mut pass = commands.compute("shade");
        pass.set_bind_group(1, &self.pipelines.gap, &[]);
        for Seen { hair, shaded, .. } in hair {
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

    /// Records the shading per vertex of nothing but what is chosen.
    pub fn shade_chosen(&self, commands: &mut Commands<'_>, hair: &[(&HairSet, &Chosen)]) -> Result<()> {
        hair.iter().for_each(|(_, chosen)| chosen.clear(commands));
        let mut pass = commands.compute("shade");
        for (hair, chosen) in hair {
            chosen.record(&self.pipelines, &mut pass, hair);
        }
        pass.end()
    }

    /// What it offers to those that ask for light: lights, the body's maps, how they are compared, the hair's maps,
    /// their blocks, light from all sides, how it is read.
    pub(super) fn resources(&self) -> [wgpu::BindingResource<'_>; 7] {
        let [maps, comparison, hair, blocks] = self.maps.resources();
        let [grid, linear] = self.ambient.resources();
        [self.lights.as_entire_binding(), maps, comparison, hair, blocks, grid, linear]
    }

    /// The same behind a camera.
    pub(crate) fn frame_resources<'a>(&'a self, camera: &'a wgpu::Buffer) -> [wgpu::BindingResource<'a>; 8] {
        frame_resources(camera, &self.lights, &self.maps, &self.ambient)
    }

    /// Bytes of GPU memory of maps and cells of these sizes.
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
