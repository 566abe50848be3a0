//! The shadows of Bevy's meshes: the maps that its lights have drawn, for the library to take over.
//!
//! All of them are views of their own in the render world, each with one layer of a texture: the cascades of directional
//! lights, which are a camera's, spot lights, and the six faces of point lights.

use bevy::{ecs::system::SystemParam, prelude::*};
use tresses::light::{SceneShadow, Sphere, lights::MAX_LIGHTS, scene::MOST_SCENE_SHADOWS};

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

/// Bevy keeps what is nearer than this to the surface of its own casters out of their shadow, metres, and hair too.
#[cfg(feature = "pbr")]
const CLOSE: f32 = 0.005;
/// And what is nearer than so many texels.
#[cfg(feature = "pbr")]
const TEXELS: f32 = 1.5;

impl LightShadows<'_, '_> {
    /// Those of `lights`, the places of which are those among the library's, that a `camera` sees `heads` with: of the
    /// cascades of a light those that a head is not wholly in a finer one of.
    #[cfg(feature = "pbr")]
    pub fn of(
        &self,
        lights: &[Option<Entity>; MAX_LIGHTS],
        camera: Entity,
        heads: &[Sphere],
    ) -> Vec<SceneShadow<'_>> {
        let mut found: Vec<_> = self
            .views
            .iter()
            .filter_map(|(map, view, of)| {
                let id = &view.retained_view_entity;
                let light = lights.iter().position(|light| *light == Some(id.main_entity.entity()))?;
                let is_seen = id.auxiliary_entity.is_none_or(|seen_by| seen_by.entity() == camera);
                let cascade = matches!(of, LightEntity::Directional { .. });
                is_seen.then_some(((light, id.subview_index), cascade, map, view))
            })
            .collect();
        found.sort_by_key(|(place, ..)| *place);
        let mut shadows: Vec<SceneShadow<'_>> = Vec::new();
        let mut done: Vec<(usize, usize)> = Vec::new();
        for ((light, _), cascade, map, view) in found {
            let DepthStencilViews::DepthOnly { depth_view } = &map.depth_attachment.depth_stencil_views
            else {
                continue;
            };
            let projection = projection(view);
            let part = Some([[0; 2], [view.viewport.z, view.viewport.w]]);
            let shadow = SceneShadow { light, depth: depth_view, part, projection, bias: 0.0 };
            let seen: Vec<_> = (0..heads.len())
                .filter(|head| !done.contains(&(light, *head)))
                .filter_map(|head| Some((head, shadow.sees(&heads[head])?)))
                .collect();
            let texels =
                seen.iter().map(|(head, _)| texel(&projection, heads[*head].center, view.viewport.z));
            let Some(coarsest) = texels.reduce(f32::max) else { continue };
            // The other faces of a point light have the rest of a head.
            done.extend(seen.iter().filter(|(_, whole)| cascade && *whole).map(|(head, _)| (light, *head)));
            shadows.push(SceneShadow { bias: CLOSE + TEXELS * coarsest, ..shadow });
        }
        shadows.truncate(MOST_SCENE_SHADOWS);
        shadows
    }

    /// None: without Bevy's own renderer there are none.
    #[cfg(not(feature = "pbr"))]
    pub fn of(&self, _: &[Option<Entity>; MAX_LIGHTS], _: Entity, _: &[Sphere]) -> Vec<SceneShadow<'_>> {
        let _ = MOST_SCENE_SHADOWS;
        Vec::new()
    }
}

/// From the world to the clip space of a map.
#[cfg(feature = "pbr")]
fn projection(view: &ExtractedView) -> Mat4 {
    view.clip_from_world.unwrap_or_else(|| view.clip_from_view * view.world_from_view.to_matrix().inverse())
}

/// How large a texel of a map of `size`² is at a place, metres.
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
    fn texels_grow_with_the_distance_of_lamps() {
        let flat = directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.0, 10.0);
        let lamp = directx::perspective_infinite_reverse(std::f32::consts::FRAC_PI_2, 1.0, 0.1);
        for (projection, edge) in [(flat, 1.0), (lamp, 5.0)] {
            let found = texel(&projection, Vec3::NEG_Z * 5.0, 100);
            assert!((found - 0.02 * edge).abs() < 1e-5, "{found}");
        }
    }
}
