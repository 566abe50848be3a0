//! CPU reference of `splat.wesl`: the same operations in one thread.

use super::params::VolumeUniforms;
use crate::strands::Guide;
use glam::{IVec3, Quat, Vec3};

/// Same value as in the shaders, m/s.
pub(super) const MAX_SPEED: f32 = 32.0;
/// Same value as in the shaders.
pub(super) const MAX_DENSITY: f32 = 16.0;
/// Same value as in the shaders.
pub(super) const CHANNELS: usize = 8;

/// Guides in the kernel's order, vertex-major.
pub(super) struct SplatInput<'a> {
    pub info: &'a [Guide],
    pub current: &'a [Vec3],
    pub velocity: &'a [Vec3],
    pub rested: &'a [f32],
}

/// Returns the integers of all cells.
pub(super) fn splat(g: &VolumeUniforms, hair: &SplatInput<'_>) -> Vec<i32> {
    let n = g.resolution as usize;
    let mut cells = vec![0; n * n * n * CHANNELS];
    let back = Quat::from_array(g.head).conjugate();
    for thread in 0..g.splat_count * g.samples {
        let (sample, guide) = (thread / g.splat_count, (thread % g.splat_count) * g.stride);
        let first = sample * g.vertices_per_sample;
        let (mut x, mut v, mut density, mut edges) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
        for vertex in first..(first + g.vertices_per_sample).min(g.vertex_count) {
            let at = (vertex * g.guide_count + guide) as usize;
            let share = if vertex == 0 || vertex + 1 == g.vertex_count { 0.5 } else { 1.0 };
            let speed = hair.velocity[at] - g.drift;
            let most = MAX_DENSITY * g.reference;
            edges += share;
            x += share * (back * (hair.current[at] - g.head_at));
            v += share * speed.clamp(Vec3::splat(-MAX_SPEED), Vec3::splat(MAX_SPEED));
            density += share * hair.rested[at].min(most) / most;
        }
        (x, v, density) = (x / edges, v / edges, density / edges);
        let info = &hair.info[guide as usize];
        let weight = info.strands * info.length / (g.vertex_count - 1) as f32 * edges * g.units;
        let c = (x * g.scale + g.bias) * n as f32 - 0.5;
        if !(c.min_element() > -1.0 && c.max_element() < n as f32 && weight > 0.0) {
            continue;
        }
        let (base, f) = (c.floor().as_ivec3(), c - c.floor());
        for corner in 0..8 {
            let side = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let place = base + side;
            if place.min_element() < 0 || place.max_element() >= n as i32 {
                continue;
            }
            let near = |axis: usize| if side[axis] == 1 { f[axis] } else { 1.0 - f[axis] };
            let part = (weight * near(0) * near(1) * near(2)).round_ties_even();
            let momentum = v * (part / MAX_SPEED);
            let cell = (place.x as usize + n * (place.y as usize + n * place.z as usize)) * CHANNELS;
            for axis in 0..3 {
                cells[cell + axis] += momentum[axis].round_ties_even() as i32;
            }
            cells[cell + 3] += part as i32;
            cells[cell + 4] += (part * density).round_ties_even() as i32;
        }
    }
    cells
}
