//! Light of one view: its shadow maps, its ambient light, and the uniform of both.

use super::{Ambient, Pipelines, ShadowMaps, lights::LightsUniform};
use crate::{
    Context,
    gpu::{Queue, Uniform},
    shaders::kernels::light as kernels,
};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// Light of a view on the GPU.
#[derive(Debug)]
pub struct LightState {
    pub(super) pipelines: Arc<Pipelines>,
    pub(super) queue: Queue,
    pub(super) maps: ShadowMaps,
    pub(super) ambient: Ambient,
    /// Whether lights of the frame are not distant or have no shadow map, or are more than four.
    pub(super) has_near_lights: AtomicBool,
    pub(crate) lights: Uniform,
    /// `@group(0)` of everything that is drawn in this light.
    pub(crate) frame: wgpu::BindGroup,
}

impl LightState {
    /// Creates maps for `map_count` lights, of `resolution`² texels, a grid of `cells` cells per edge and, unless
    /// `strand_map` is 0, strand maps of `strand_map`² texels. `camera` is the uniform of the camera.
    pub(crate) fn new(
        context: &Context,
        [resolution, cells]: [u32; 2],
        [map_count, strand_map]: [u32; 2],
        camera: &Uniform,
    ) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let lights = device.uniform(size_of::<LightsUniform>());
        let maps = ShadowMaps::new(context, &pipelines, map_count, [resolution, strand_map]);
        let ambient = Ambient::new(context, &pipelines.ambient, cells, maps.transmittance(&lights));
        let frame = frame_resources(camera, &lights, &maps, &ambient);
        let frame = device.group("frame", &pipelines.frame, &frame);
        let queue = context.queue.clone();
        Self { frame, pipelines, queue, maps, ambient, has_near_lights: AtomicBool::default(), lights }
    }

    /// Maximum number of lights with shadow maps.
    pub(crate) fn max_lights(&self) -> u32 {
        self.maps.count
    }

    /// Whether lights of the frame are not distant or have no shadow map, or are more than four. Their shaders have more code.
    pub(crate) fn has_near_lights(&self) -> bool {
        self.has_near_lights.load(Ordering::Relaxed)
    }

    /// Sets [`has_near_lights`](Self::has_near_lights).
    pub(crate) fn set_near_lights(&self, has: bool) {
        self.has_near_lights.store(has, Ordering::Relaxed);
    }

    /// Whether maps and grid have these sizes, for `map_count` lights.
    pub(super) fn fits(&self, [resolution, cells]: [u32; 2], map_count: u32) -> bool {
        self.maps.count == ShadowMaps::count_within(map_count)
            && self.maps.resolution == ShadowMaps::within(resolution)
            && self.ambient.cells() == Ambient::within(cells)
    }

    /// Bindings of kernels that read lights and shadow maps.
    pub(crate) fn transmittance(&self) -> kernels::Transmittance<'_> {
        self.maps.transmittance(&self.lights)
    }

    /// Bindings of the kernels that shade the hair of `shading_sample`.
    pub(super) fn shading<'a>(&'a self, shading_sample: kernels::ShadingSample<'a>) -> kernels::Shading<'a> {
        let unmapped_grid = self.ambient.unmapped_grid();
        kernels::Shading {
            shading_sample,
            transmittance: self.transmittance(),
            ambient: self.ambient(),
            unmapped_grid,
        }
    }

    /// Grid of the light without shadow maps.
    pub(crate) fn unmapped_grid(&self) -> &wgpu::TextureView {
        self.ambient.unmapped_grid()
    }

    /// Bindings of kernels that read ambient light.
    pub(crate) fn ambient(&self) -> kernels::ambient::Ambient<'_> {
        self.ambient.bindings()
    }

    /// Returns the bytes of GPU memory of maps and cells of these sizes, for `map_count` lights.
    pub(super) fn bytes_of([resolution, cells]: [u32; 2], map_count: u32) -> u64 {
        ShadowMaps::bytes_of(resolution, map_count) + Ambient::bytes_of(cells)
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

/// Returns what everything binds that is drawn in light, in the order of [`super::frame::FRAME`].
fn frame_resources<'a>(
    camera: &'a Uniform,
    lights: &'a Uniform,
    maps: &'a ShadowMaps,
    ambient: &'a Ambient,
) -> [wgpu::BindingResource<'a>; 9] {
    use wgpu::BindingResource::{Sampler, TextureView};
    let kernels::Transmittance { lights, body_maps, comparison, hair_maps, hair_blocks } =
        maps.transmittance(lights);
    let kernels::ambient::Ambient { ambient_grid, ambient_linear } = ambient.bindings();
    [
        camera.as_entire_binding(),
        lights.into(),
        TextureView(body_maps),
        Sampler(comparison),
        hair_maps.into(),
        hair_blocks.into(),
        TextureView(ambient_grid),
        Sampler(ambient_linear),
        TextureView(ambient.unmapped_grid()),
    ]
}
