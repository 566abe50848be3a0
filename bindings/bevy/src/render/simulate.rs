//! Hair moves, once per frame.

use super::{Complaints, Wardrobe, living::Living, prepare::Worn};
use crate::extract::{Eye, Scene, SceneHair};
use bevy::{
    prelude::*,
    render::{
        camera::ExtractedCamera,
        renderer::{RenderContext, RenderDevice, RenderQueue},
        sync_world::MainEntity,
        view::ExtractedView,
    },
};
use tresses::{
    Camera, Hair, Pose, Result,
    collide::{Collider, ColliderPoses},
    frame::{Frame, Recorder},
    wgpu,
};

/// A camera of Bevy's: its depth runs from 1 to 0 as well.
pub(crate) fn camera(view: &ExtractedView) -> Camera {
    Camera {
        view: view.world_from_view.to_matrix().inverse(),
        projection: view.clip_from_view,
        size: [view.viewport.z, view.viewport.w],
    }
}

/// Moves all hair by a frame, and so finely as the nearest camera sees it.
pub(crate) fn simulate(
    mut scene: ResMut<Scene>,
    mut wardrobe: ResMut<Wardrobe>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    views: Query<(MainEntity, &ExtractedView), With<ExtractedCamera>>,
    mut complaints: Local<Complaints>,
    mut context: RenderContext,
) {
    let Some(pipelines) = wardrobe.pipelines() else { return };
    // From here on hair on a skin is where what it goes with has it.
    for hair in &mut scene.hair {
        if let Some(worn) = wardrobe.worn_mut(hair.entity)
            && let Some(living) = &mut worn.living
        {
            // A body of which nothing is known yet is not seen.
            match living.head(&hair.skin) {
                Some(head) => hair.pose = head,
                None => hair.visible = false,
            }
        }
    }
    let scene = scene.into_inner();
    let eyes: Vec<_> = views
        .iter()
        .filter_map(|(entity, view)| Some((camera(view), scene.cameras.get(&entity.entity())?)))
        .collect();
    let device = device.wgpu_device();
    let meeting = scene.hair.iter().filter(|hair| hair.meets && hair.visible);
    let meeting: Vec<_> = meeting.map(|hair| hair.entity).collect();
    Hair::meet_each_other(device, &pipelines, &mut wardrobe.meeting(&meeting));
    for hair in &scene.hair {
        let Some(worn) = wardrobe.worn_mut(hair.entity) else { continue };
        if !hair.visible {
            // It is at rest when it is shown again, wherever that is.
            worn.hair.reset();
            worn.moves = false;
            continue;
        }
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("hair") });
        let recorder =
            Recorder { pipelines: &pipelines, device, queue: &queue, encoder: &mut encoder, timings: None };
        if worn.room() < scene.colliders.len() {
            let room = worn.room();
            complaints
                .say(format!("hair has room for {room} colliders besides its body's: the last are left out"));
        }
        match worn.advance(recorder, hair, scene, &eyes) {
            Ok(()) => {
                worn.moves = true;
                context.add_command_buffer(encoder.finish());
            }
            Err(error) => {
                worn.moves = false;
                // A body that was bent on the way stays so: the same pose is not recorded twice.
                context.add_command_buffer(encoder.finish());
                complaints.say(format!("hair of entity {} cannot move: {error}", hair.entity));
            }
        }
    }
}

impl Worn {
    fn advance(
        &mut self,
        mut recorder: Recorder<'_>,
        hair: &SceneHair,
        scene: &Scene,
        eyes: &[(Camera, &Eye)],
    ) -> Result<()> {
        let Recorder { device, queue, .. } = recorder;
        let pushing = self.pushed_by(scene);
        self.push_against(device, queue, &pushing)?;
        hair.detail.check()?;
        self.hair.set.material = hair.material;
        self.hair.lod.options = hair.detail;
        if let Some(body) = &mut self.body {
            body.pose = hair.pose;
        }
        let seen = eyes.iter().filter(|(_, eye)| eye.layers.intersects(&hair.layers));
        let large = seen.map(|(camera, _)| (self.hair.lod.seen(camera, &hair.pose).size, camera));
        if let Some((_, camera)) = large.max_by(|(a, _), (b, _)| a.total_cmp(b)) {
            self.hair.look_from(device, queue, camera, &hair.pose);
        }
        let mut poses = Vec::new();
        if let (Some(living), Some(body)) = (&mut self.living, &mut self.body) {
            living.pose((queue, body, &mut self.hair), &hair.pose, &mut poses)?;
            recorder.bend(&[living.skinning()])?;
        }
        poses.extend(pushing.iter().map(|(_, _, pose)| *pose));
        let colliders = ColliderPoses { head: None, colliders: poses };
        let frame = Frame {
            dt: scene.dt,
            head: hair.pose,
            colliders: &colliders,
            simulation: &hair.physics,
            ..Default::default()
        };
        recorder.advance(&mut self.hair, &frame)
    }

    /// Makes these its colliders.
    fn push_against(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pushing: &[(Entity, Collider, Pose)],
    ) -> Result<()> {
        let now = |(entity, collider, _): &(Entity, Collider, _)| (*entity, *collider);
        let wanted: Vec<_> = pushing.iter().map(now).collect();
        if wanted == self.colliders {
            return Ok(());
        }
        // Who keeps its place goes on from where it is. Others are not to fly over from the place of one that is gone.
        let own = self.living.as_ref().map_or(&[][..], Living::colliders);
        let kept = wanted.iter().zip(&self.colliders).take_while(|(new, old)| new.0 == old.0).count();
        let kept = own.len() + kept;
        let all: Vec<_> = own.iter().copied().chain(wanted.iter().map(|(_, collider)| *collider)).collect();
        self.hair.set_colliders(device, queue, &all[..kept])?;
        self.hair.set_colliders(device, queue, &all)?;
        self.colliders = wanted;
        Ok(())
    }
}
