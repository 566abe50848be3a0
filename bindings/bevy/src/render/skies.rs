//! Environment maps and reflection probes: what their cube maps hold, as hair is lit by it.
//!
//! Bevy has them on the GPU, some of them only there, so they are measured there ([`CubeProbe`]); the sums come some frames
//! later. Maps that Bevy filters itself change without a word: all are measured again from time to time.

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
    light::{CubeLight, CubeMap, CubeProbe, Environment},
    wgpu,
};

/// Frames from one measurement of a map to the next.
const AGAIN: u32 = 60;

/// Bevy asks its cube maps by directions whose third axis is the other way.
const MIRROR: Mat3 = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));

/// The light of a cube map.
#[derive(Debug, Default)]
struct MapLight {
    /// Of an intensity of 1, not turned.
    environment: Environment,
    pending: Option<CubeLight>,
    /// Frames since the last measurement began.
    age: u32,
}

/// The light of all cube maps.
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
    let mut wanted: Vec<_> = of_cameras.chain(&scene.probes).map(|sky| sky.map).collect();
    wanted.sort();
    wanted.dedup();
    known.retain(|map, _| wanted.contains(map));
    for map in wanted {
        let Some(image) = images.get(map) else { continue };
        let sky = known.entry(map).or_insert_with(|| MapLight { age: AGAIN, ..Default::default() });
        sky.age = sky.age.saturating_add(1);
        match sky.pending.as_mut().and_then(CubeLight::take) {
            Some(Ok(environment)) => (sky.environment, sky.pending) = (environment, None),
            Some(Err(error)) => {
                errors.report(format!("an environment map cannot light hair: {error}"));
                sky.pending = None;
            }
            None => {}
        }
        if sky.pending.is_some() || sky.age < AGAIN {
            continue;
        }
        sky.age = 0;
        let begun = usable(context.device(), image).and_then(|view| {
            let probe = probe.get_or_insert_with(|| CubeProbe::new(&context));
            let begun = probe.measure(&view, CubeMap::Irradiance, MIRROR);
            begun.map_err(|error| error.to_string())
        });
        match begun {
            Ok(light) => sky.pending = Some(light),
            Err(problem) => {
                errors.report(format!("an environment map cannot light hair: {problem}"));
            }
        }
    }
}

/// A view of all six faces, or why there is none.
fn usable(device: &wgpu::Device, image: &GpuImage) -> Result<wgpu::TextureView, String> {
    let (format, layers) = (image.texture.format(), image.texture.depth_or_array_layers());
    let flat = image.texture.dimension() == wgpu::TextureDimension::D2;
    if layers < 6 || !flat || image.texture.width() != image.texture.height() {
        return Err(format!("it has {layers} layers, a cube has six, which are squares"));
    }
    let filtered = format.sample_type(None, Some(device.features()));
    if filtered != Some(wgpu::TextureSampleType::Float { filterable: true }) {
        return Err(format!("this device does not filter {format:?}"));
    }
    Ok((*image.texture).create_view(&wgpu::TextureViewDescriptor {
        label: Some("environment map"),
        dimension: Some(wgpu::TextureViewDimension::Cube),
        array_layer_count: Some(6),
        ..Default::default()
    }))
}

impl Skies {
    /// What lights hair at `place`: that of the probes around it, as far as they go that of its camera.
    pub fn at(&self, place: Vec3, camera: &SceneCamera, probes: &[SceneSky]) -> Environment {
        let around: Vec<_> = probes.iter().map(|sky| (sky, sky.share(place))).collect();
        let sum: f32 = around.iter().map(|(_, share)| share).sum();
        // As Bevy's shader: what probes leave is the camera's; where it has none, or they leave none, their mean counts.
        let left = if camera.sky.is_some() { (1.0 - sum).max(0.0) } else { 0.0 };
        let whole = if left > 0.0 || sum <= 0.0 { 1.0 } else { sum };
        let skies = around.into_iter().chain(camera.sky.as_ref().map(|sky| (sky, left)));
        let lit = skies.filter_map(|(sky, share)| {
            let turned = self.known.get(&sky.map)?.environment.turned(sky.rotation);
            Some((turned, share / whole * sky.intensity))
        });
        lit.fold(Environment::default(), |light, (sky, share)| light.blended(1.0, &sky, share))
    }
}
