//! Measures the light of environment maps and reflection probes.
//!
//! Bevy keeps the cube maps on the GPU, some of them only there, so they are measured there ([`CubeProbe`]). The
//! results arrive some frames later. Maps that Bevy generates may change without notice, so all maps are measured again
//! periodically.

use super::HairContext;
use crate::{
    error_log::ErrorLog,
    extract::{Scene, SceneCamera, SceneSky},
};
use bevy::{
    asset::AssetId,
    platform::collections::HashMap,
    prelude::*,
    render::{render_asset::RenderAssets, texture::GpuImage},
};
use tresses::{
    light::Environment,
    low_level::{CubeLight, CubeMap, CubeProbe},
    wgpu,
};

/// Frames between two measurements of a map.
const AGAIN: u32 = 60;

/// Bevy samples cube maps with the Z axis flipped.
const MIRROR: Mat3 = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));

/// Light of a cube map.
#[derive(Debug, Default)]
struct MapLight {
    /// For an intensity of 1, without rotation.
    environment: Environment,
    pending: Option<CubeLight>,
    /// Frames since the last measurement started.
    age: u32,
}

/// Light of all cube maps.
#[derive(Resource, Debug, Default)]
pub(crate) struct Skies {
    probe: Option<CubeProbe>,
    known: HashMap<AssetId<Image>, MapLight>,
    errors: ErrorLog,
}

/// Measures the maps of the scene.
pub(crate) fn measure_skies(
    scene: Res<Scene>,
    images: Res<RenderAssets<GpuImage>>,
    mut skies: ResMut<Skies>,
    context: Res<HairContext>,
) {
    let Skies { probe, known, errors } = &mut *skies;
    if scene.hair.is_empty() {
        known.clear();
        return;
    }
    let of_cameras = scene.cameras.values().filter_map(|camera| camera.sky.as_ref());
    let mut maps: Vec<_> = of_cameras.chain(&scene.probes).map(|sky| sky.map).collect();
    maps.sort();
    maps.dedup();
    known.retain(|map, _| maps.contains(map));
    for map in maps {
        let Some(image) = images.get(map) else { continue };
        let sky = known.entry(map).or_insert_with(|| MapLight { age: AGAIN, ..Default::default() });
        sky.age = sky.age.saturating_add(1);
        match sky.pending.as_mut().and_then(CubeLight::take) {
            Some(Ok(environment)) => (sky.environment, sky.pending) = (environment, None),
            Some(Err(error)) => {
                errors.report(format!("cannot light hair with an environment map: {error}"));
                sky.pending = None;
            }
            None => {}
        }
        if sky.pending.is_some() || sky.age < AGAIN {
            continue;
        }
        sky.age = 0;
        let measurement = usable(context.device(), image).and_then(|view| {
            let probe = probe.get_or_insert_with(|| CubeProbe::new(&context));
            let measurement = probe.measure(&view, CubeMap::Irradiance, MIRROR);
            measurement.map_err(|error| error.to_string())
        });
        match measurement {
            Ok(light) => sky.pending = Some(light),
            Err(problem) => {
                errors.report(format!("cannot light hair with an environment map: {problem}"));
            }
        }
    }
}

/// Returns a cube view of all six faces, or why there is none.
fn usable(device: &wgpu::Device, image: &GpuImage) -> Result<wgpu::TextureView, String> {
    let (format, layers) = (image.texture.format(), image.texture.depth_or_array_layers());
    let flat = image.texture.dimension() == wgpu::TextureDimension::D2;
    if layers < 6 || !flat || image.texture.width() != image.texture.height() {
        return Err(format!("it has {layers} layers, but a cube map has 6 square layers"));
    }
    let filtered = format.sample_type(None, Some(device.features()));
    if filtered != Some(wgpu::TextureSampleType::Float { filterable: true }) {
        return Err(format!("this device cannot filter {format:?}"));
    }
    Ok((*image.texture).create_view(&wgpu::TextureViewDescriptor {
        label: Some("environment map"),
        dimension: Some(wgpu::TextureViewDimension::Cube),
        array_layer_count: Some(6),
        ..Default::default()
    }))
}

impl Skies {
    /// Returns the environment at `position`: the probes there, and the camera's map for the remaining weight.
    pub fn at(&self, position: Vec3, camera: &SceneCamera, probes: &[SceneSky]) -> Environment {
        let around: Vec<_> = probes.iter().map(|sky| (sky, sky.weight(position))).collect();
        let sum: f32 = around.iter().map(|(_, weight)| weight).sum();
        // As in Bevy's shader: the camera's map gets the weight that probes leave. Without a camera map, or if no
        // weight is left, normalize the probes.
        let left = if camera.sky.is_some() { (1.0 - sum).max(0.0) } else { 0.0 };
        let total = if left > 0.0 || sum <= 0.0 { 1.0 } else { sum };
        let skies = around.into_iter().chain(camera.sky.as_ref().map(|sky| (sky, left)));
        let lit = skies.filter_map(|(sky, weight)| {
            let rotated = self.known.get(&sky.map)?.environment.rotated(sky.rotation);
            Some((rotated, weight / total * sky.intensity))
        });
        lit.fold(Environment::default(), |light, (sky, weight)| light.blended(1.0, &sky, weight))
    }
}
