//! Light probes: measuring a cube map recovers the environment that it was made from.

use crate::common;
use half::f16;
use tresses::{
    Context,
    glam::{Mat3, Quat, Vec3},
    light::Environment,
    low_level::{CubeMap, CubeProbe},
    wgpu,
};

/// Returns the direction of a texel in WebGPU's layout of faces. `x` and `y` go from 0 to 1, from the upper left
/// corner.
fn direction(face: usize, x: f32, y: f32) -> Vec3 {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let along = match face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    };
    along.normalize()
}

/// Creates a cube map with texels of `light`, with mip levels if `levels`.
fn map(context: &Context, size: u32, levels: bool, light: impl Fn(Vec3) -> Vec3) -> wgpu::TextureView {
    let count = if levels { size.ilog2() + 1 } else { 1 };
    let texture = context.device().create_texture(&wgpu::TextureDescriptor {
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 6 },
        mip_level_count: count,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        ..common::TEXTURE
    });
    for face in 0..6 {
        let at = |i: usize, size: usize| (i as f32 + 0.5) / size as f32;
        let n = size as usize;
        let mut texels: Vec<Vec3> =
            (0..n * n).map(|i| light(direction(face, at(i % n, n), at(i / n, n)))).collect();
        for level in 0..count {
            let n = n >> level;
            if level > 0 {
                let quarter = |i: usize| {
                    let first = 2 * (i / n) * 2 * n + 2 * (i % n);
                    [0, 1, 2 * n, 2 * n + 1].map(|step| texels[first + step]).iter().sum::<Vec3>() * 0.25
                };
                texels = (0..n * n).map(quarter).collect();
            }
            let halves: Vec<[f16; 4]> =
                texels.iter().map(|t| [t.x, t.y, t.z, 1.0].map(f16::from_f32)).collect();
            context.queue().write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &texture,
                    mip_level: level,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: face as u32 },
                    aspect: wgpu::TextureAspect::All,
                },
                bytemuck::cast_slice(&halves),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(8 * n as u32),
                    rows_per_image: Some(n as u32),
                },
                wgpu::Extent3d { width: n as u32, height: n as u32, depth_or_array_layers: 1 },
            );
        }
    }
    let dimension = Some(wgpu::TextureViewDimension::Cube);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

/// Returns an environment with positive radiance in all directions.
fn surroundings() -> Environment {
    let mut coefficients = [Vec3::ZERO; 9];
    coefficients[0] = Vec3::new(3.0, 2.5, 2.0);
    for (i, sum) in coefficients.iter_mut().enumerate().skip(1) {
        *sum = 0.15 * Vec3::new((i as f32).sin(), (2.0 * i as f32).cos(), (3.0 * i as f32).sin());
    }
    Environment { coefficients }
}

fn off(a: &Environment, b: &Environment) -> f32 {
    let all = a.coefficients.iter().zip(b.coefficients);
    all.map(|(a, b)| (*a - b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn cube_probe_recovers_the_environment() {
    let Some(context) = common::context() else { return };
    let probe = CubeProbe::new(context);
    let measure = |map: &wgpu::TextureView, of, to_map| {
        let light = probe.measure(map, of, to_map).unwrap();
        pollster::block_on(light.wait()).unwrap()
    };
    let truth = surroundings();
    let diffuse = map(context, 32, false, |d| truth.around(d));
    let found = measure(&diffuse, CubeMap::Irradiance, Mat3::IDENTITY);
    assert!(off(&found, &truth) < 0.01, "{}", off(&found, &truth));
    let as_radiance = measure(&diffuse, CubeMap::Radiance, Mat3::IDENTITY);
    assert!(off(&as_radiance, &truth) > 0.04, "the comparer sees no difference");

    // Rotated and mirrored: a left-handed map of a rotated environment.
    let turn = Quat::from_euler(tresses::glam::EulerRot::XYZ, 0.4, 1.2, -0.8);
    let mirror = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));
    let to_map = mirror * Mat3::from_quat(turn.inverse());
    let mirrored = map(context, 32, false, |d| truth.around(mirror * d));
    let found = measure(&mirrored, CubeMap::Irradiance, to_map);
    assert!(off(&found, &truth.rotated(turn)) < 0.01, "{}", off(&found, &truth.rotated(turn)));
    assert!(off(&found, &truth) > 0.04, "a turn is seen");

    // A small sun in a fine map is not missed if the map has mip levels. The expected value is the integral of the sky.
    let sun = Vec3::new(0.3, 0.8, -0.5).normalize();
    let sky = |d: Vec3| Vec3::splat(if d.dot(sun) > 0.9995 { 800.0 } else { 0.2 });
    let found = measure(&map(context, 512, true, sky), CubeMap::Radiance, Mat3::IDENTITY);
    let angle = std::f32::consts::TAU * (1.0 - 0.9995);
    let straight = 0.282_095 * (0.2 * 4.0 * std::f32::consts::PI + 800.0 * angle);
    let share = found.coefficients[0].x / straight;
    assert!((share - 1.0).abs() < 0.03, "{share}");
    assert!(found.around(sun).x > 2.0 * found.around(-sun).x);
    // Infinite texels count as black.
    let broken = map(context, 8, false, |_| Vec3::splat(f32::INFINITY));
    let found = measure(&broken, CubeMap::Radiance, Mat3::IDENTITY);
    assert_eq!(found, Environment::default());
}
