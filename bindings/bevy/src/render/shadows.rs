//! Shadow maps that Bevy has drawn for its meshes, for use by the library.
//!
//! Each is a view in the render world with one layer of a texture: a cascade of a directional light for one camera, a
//! spot light, or one of the six faces of a point light.

use bevy::{ecs::system::SystemParam, prelude::*};
use tresses::{
    light::{Light, SceneShadow, Sphere},
    low_level::MAX_SCENE_SHADOWS,
};

#[cfg(feature = "pbr")]
use bevy::{
    pbr::{LightEntity, ShadowView},
    render::{texture::DepthStencilViews, view::ExtractedView},
};

/// The shadow maps of all lights.
#[derive(SystemParam)]
pub(crate) struct LightShadows<'w, 's> {
    #[cfg(feature = "pbr")]
    views: Query<'w, 's, (&'static ShadowView, &'static ExtractedView, &'static LightEntity)>,
    #[cfg(not(feature = "pbr"))]
    views: Query<'w, 's, ()>,
}

impl std::fmt::Debug for LightShadows<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "LightShadows({} maps)", self.views.iter().count())
    }
}

/// Constant depth bias, meters: hair this close to a caster gets no shadow from it.
#[cfg(feature = "pbr")]
const CLOSE: f32 = 0.005;
/// Depth bias in texels of the shadow map.
#[cfg(feature = "pbr")]
const TEXELS: f32 = 1.5;

impl LightShadows<'_, '_> {
    /// Returns the shadow maps of `lights` that a `camera` needs for `heads`. Omits a cascade if a finer one contains
    /// each head completely.
    #[cfg(feature = "pbr")]
    pub fn of(&self, lights: &[Light], camera: Entity, heads: &[Sphere]) -> Vec<SceneShadow<'_>> {
        let mut found: Vec<_> = self
            .views
            .iter()
            .filter_map(|(map, view, of)| {
                let key = &view.retained_view_entity;
                let light = crate::lights::id(key.main_entity.entity());
                let is_for_camera = key.auxiliary_entity.is_none_or(|viewer| viewer.entity() == camera);
                let is_used = is_for_camera && lights.iter().any(|used| used.id == light);
                let cascade = matches!(of, LightEntity::Directional { .. });
                is_used.then_some(((light, key.subview_index), cascade, map, view))
            })
            .collect();
        found.sort_by_key(|(key, ..)| *key);
        let mut shadows: Vec<SceneShadow<'_>> = Vec::new();
        let mut done: Vec<(u32, usize)> = Vec::new();
        for ((light, _), cascade, map, view) in found {
            let DepthStencilViews::DepthOnly { depth_view } = &map.depth_attachment.depth_stencil_views
            else {
                continue;
            };
            let projection = projection(view);
            let part = Some([[0; 2], [view.viewport.z, view.viewport.w]]);
            let shadow = SceneShadow { light, depth: depth_view, part, projection, bias: 0.0 };
            let covered: Vec<_> = (0..heads.len())
                .filter(|head| !done.contains(&(light, *head)))
                .filter_map(|head| Some((head, shadow.covers(&heads[head])?)))
                .collect();
            let texels =
                covered.iter().map(|(head, _)| texel(&projection, heads[*head].center, view.viewport.z));
            let Some(coarsest) = texels.reduce(f32::max) else { continue };
            // A face of a point light may contain only part of a head; the other faces have the rest.
            done.extend(
                covered
                    .iter()
                    .filter(|(_, is_contained)| cascade && *is_contained)
                    .map(|(head, _)| (light, *head)),
            );
            shadows.push(SceneShadow { bias: CLOSE + TEXELS * coarsest, ..shadow });
        }
        if shadows.len() > MAX_SCENE_SHADOWS {
            warn_once!("hair receives {MAX_SCENE_SHADOWS} of {} shadow maps around it", shadows.len());
            shadows.truncate(MAX_SCENE_SHADOWS);
        }
        shadows
    }

    /// Returns none: without Bevy's PBR renderer there are no shadow maps.
    #[cfg(not(feature = "pbr"))]
    pub fn of(&self, _: &[Light], _: Entity, _: &[Sphere]) -> Vec<SceneShadow<'_>> {
        let _ = MAX_SCENE_SHADOWS;
        Vec::new()
    }
}

/// Returns the matrix from the world to the clip space of a shadow map.
#[cfg(feature = "pbr")]
fn projection(view: &ExtractedView) -> Mat4 {
    view.clip_from_world.unwrap_or_else(|| view.clip_from_view * view.world_from_view.to_matrix().inverse())
}

/// Returns the size of a texel at `at`, meters, for a shadow map of `size`² texels.
#[cfg(feature = "pbr")]
fn texel(projection: &Mat4, at: Vec3, size: u32) -> f32 {
    let w = (*projection * at.extend(1.0)).w;
    2.0 * w / (projection.row(0).truncate().length() * size.max(1) as f32)
}

#[cfg(all(test, feature = "pbr"))]
mod tests {
    use super::*;
    use tresses::glam::camera::rh::proj::directx;

    #[test]
    fn texel_size_grows_with_distance_in_perspective() {
        let flat = directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.0, 10.0);
        let lamp = directx::perspective_infinite_reverse(std::f32::consts::FRAC_PI_2, 1.0, 0.1);
        for (projection, edge) in [(flat, 1.0), (lamp, 5.0)] {
            let found = texel(&projection, Vec3::NEG_Z * 5.0, 100);
            assert!((found - 0.02 * edge).abs() < 1e-5, "{found}");
        }
    }
}
