//! Simulates hair, once per frame.

use super::{HairContext, Wardrobe, characters::HairModel};
use crate::{
    error_log::ErrorLog,
    extract::{Scene, SceneHair},
};
use bevy::{
    prelude::*,
    render::{camera::ExtractedCamera, renderer::RenderContext, sync_world::MainEntity, view::ExtractedView},
};
use tresses::{Camera, Character, Frame, Result, wgpu};

/// Converts a camera. Bevy's depth also runs from 1 to 0.
pub(crate) fn camera(view: &ExtractedView) -> Camera {
    Camera {
        view: view.world_from_view.to_matrix().inverse(),
        projection: view.clip_from_view,
        size: [view.viewport.z, view.viewport.w],
    }
}

/// Simulates all hair for a frame, each at the level of detail for the camera in which it is largest.
pub(crate) fn simulate(
    scene: Res<Scene>,
    mut wardrobe: ResMut<Wardrobe>,
    tresses: Res<HairContext>,
    views: Query<(MainEntity, &ExtractedView), With<ExtractedCamera>>,
    mut errors: Local<ErrorLog>,
    mut context: RenderContext,
) {
    for hair in &scene.hair {
        if let Some(model) = wardrobe.get_mut(hair.entity) {
            model.is_shown = model.set_pose(hair) && hair.visible;
            if !model.is_shown {
                // Hidden hair is at rest when it is shown again.
                model.character.reset();
            }
        }
    }
    Character::collide_nearby(&mut wardrobe.colliding(&scene));
    for hair in &scene.hair {
        let Some(model) = wardrobe.get_mut(hair.entity).filter(|model| model.is_shown) else { continue };
        let max_colliders = model.max_colliders();
        if max_colliders < scene.colliders.len() {
            errors.report(format!(
                "hair supports {max_colliders} colliders besides those of its body: the last ones are ignored"
            ));
        }
        let is_visible_to = |entity: Entity| {
            scene.cameras.get(&entity).is_some_and(|camera| camera.layers.intersects(&hair.layers))
        };
        let cameras: Vec<_> = views
            .iter()
            .filter(|(entity, _)| is_visible_to(entity.entity()))
            .map(|(_, view)| camera(view))
            .collect();
        let label = Some("hair");
        let mut encoder = tresses.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let result = model.advance(tresses.frame(&mut encoder).with_cameras(&cameras), hair, &scene);
        // Submit even after an error: the skin may be posed already, and it is posed only once.
        context.add_command_buffer(encoder.finish());
        model.is_shown = result.is_ok();
        if let Err(error) = result {
            errors.report(format!("cannot simulate hair of entity {}: {error}", hair.entity));
        }
    }
}

impl HairModel {
    fn advance(&mut self, mut frame: Frame<'_>, hair: &SceneHair, scene: &Scene) -> Result<()> {
        hair.detail.check()?;
        let obstacles = self.obstacles(scene);
        let character = &mut self.character;
        character.set_obstacles(&obstacles)?;
        character.set_material(hair.material);
        character.set_lod(hair.detail);
        character.physics = hair.physics;
        frame.advance(&mut [character], scene.dt)
    }
}
