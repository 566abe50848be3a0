//! Frames of a scene: the character moves, then it is drawn.

use super::{Asked, Scene};
use crate::{
    camera::{self, Viewpoint},
    face::colliding,
    motion::Gesture,
};
use anyhow::{Context, Result};
use tresses::{
    Pose,
    collide::{Collider, ColliderPoses},
    frame::{Frame, Recorder, Shows, Sight},
    glam::Vec3,
    gpu::{Gpu, Timings},
    lod::LodMode,
};

impl Scene {
    /// The hair at rest on a character that makes a `gesture`.
    pub fn reset(&mut self, gesture: &Gesture) -> Result<()> {
        self.rewind();
        self.advance(gesture, 0.0)
    }

    /// From the next frame on the hair is at rest, and obstacles are where their motions begin.
    pub fn rewind(&mut self) {
        self.hair.reset();
        self.face.iter_mut().for_each(|face| face.hair.reset());
        self.time = 0.0;
    }

    /// Seconds since the hair was put to rest: where an animation of the body is.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// In the next frame animations of the body, and obstacles, are where they are at `time`, s. Hair is not put to rest.
    pub fn seek(&mut self, time: f64) {
        self.time = time;
    }

    /// The character makes a `gesture` in `seconds`, and the hair goes with it.
    pub fn advance(&mut self, gesture: &Gesture, seconds: f32) -> Result<()> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, gesture, seconds)?;
        self.submit(encoder)
    }

    /// From the next frame on a ball of `radius` metres is at a place of the world, metres, or there is none.
    ///
    /// # Errors
    /// When there are too many colliders already.
    pub fn set_ball(&mut self, at: Option<Vec3>, radius: f32) -> Result<()> {
        if !self.colliders.set_ball(at, radius) {
            return Ok(());
        }
        let Gpu { device, queue, .. } = &self.gpu;
        self.hair.set_colliders(device, queue, &self.colliders.list)?;
        for face in self.face.iter_mut().filter(|face| face.hangs()) {
            face.hair.set_colliders(device, queue, &self.colliders.list)?;
        }
        self.make_obstacles();
        Ok(())
    }

    /// Moves the body's colliders to where they are drawn: between a frame's motion and its picture.
    pub fn place_colliders(&mut self) {
        let count = self.colliders.list.len();
        let drawn = self.hair.colliders.drawn();
        // The first is the head's field, where there is one. A collider that has just come has no place
        // before the next frame's motion.
        let Some(own) = drawn.len().checked_sub(count).map(|first| &drawn[first..]) else { return };
        if count == 0 {
            return;
        }
        let to_head = self.pose.inverse();
        let poses: Vec<_> = own.iter().map(|pose| to_head.after(pose)).collect();
        if let Some(obstacles) = &self.obstacles {
            obstacles.move_to(&self.gpu.queue, &self.colliders.mesh(&poses));
        }
    }

    /// `camera` as the library has it.
    pub(crate) fn eye(&self, camera: &Viewpoint) -> tresses::Camera {
        let size = self.targets().size;
        tresses::Camera::look_at(camera.eye, camera.target, camera::VERTICAL_FOV, size)
    }

    /// Camera and lights: these go with it, as a photographer's do, unless there are others.
    pub(crate) fn look_from(&mut self, camera: &Viewpoint) {
        self.picture.camera = self.eye(camera);
        let back = camera.eye - camera.target;
        let surroundings = self.surroundings.as_ref().map(|(.., lights)| lights);
        self.picture.lights = self.lighting.lights(back.x.atan2(back.z), surroundings);
    }

    /// The body is as it rests, whatever it did before.
    ///
    /// # Errors
    /// When the body is another's.
    pub(crate) fn stand_still(&mut self) -> Result<()> {
        if let (Some(living), Some(body)) = (&mut self.living, &mut self.body) {
            living.set_animation(None)?;
            living.pose(&self.gpu, 0.0, &Gesture::default(), body)?;
            let Gpu { device, queue, .. } = &self.gpu;
            let mut encoder = device.create_command_encoder(&Default::default());
            let pipelines = &self.pipelines;
            let mut recorder = Recorder { pipelines, device, queue, encoder: &mut encoder, timings: None };
            recorder.bend(&[living.skinning()])?;
            queue.submit([encoder.finish()]);
        }
        Ok(())
    }

    /// What hair collides with besides the head.
    pub(crate) fn colliders(&self) -> &[Collider] {
        &self.colliders.list
    }

    /// Where that is on a character that is one piece, whose body is at `pose`.
    pub(crate) fn carried(&self, pose: Pose) -> ColliderPoses {
        self.colliders.carried(pose)
    }

    /// Records what has the character make a `gesture` in `seconds`, and the hair go with it.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn record_advance(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        gesture: &Gesture,
        seconds: f32,
    ) -> Result<()> {
        self.time += f64::from(seconds);
        self.parts.clear();
        (self.pose, self.head) = (gesture.rigid(), gesture.rigid());
        if let (Some(living), Some(body)) = (&mut self.living, &mut self.body) {
            let stance = living.pose(&self.gpu, self.time, gesture, body)?;
            self.pose = gesture.body;
            self.head = self.pose.after(&stance.head);
            self.parts.extend(stance.parts.iter().map(|part| self.pose.after(part)));
            if let Some(mesh) = self.unbent.take_if(|_| stance.is_bent) {
                let (gpu, fields) = ((&self.gpu, &*self.pipelines), self.colliders.part_fields());
                let hair = colliding(&mut self.hair, &mut self.face);
                living.deform(gpu, (body, &mesh), self.field.is_some(), fields, hair)?;
            }
            for hair in colliding(&mut self.hair, &mut self.face) {
                if let Some(deformation) = &mut hair.colliders.deformation {
                    deformation.poses.clear();
                    deformation.poses.extend(living.deforming(&stance));
                }
            }
            // Shadows and light go with a body that walks.
            self.picture.focus.center = self.head.point(self.middle);
        }
        if let Some(roots) = &mut self.hair.roots {
            roots.pose = self.pose;
        }
        let head = self.head;
        if let Some(camera) = &self.watcher {
            let eye = self.eye(camera);
            let all = std::iter::once(&mut self.hair).chain(self.face.iter_mut().map(|face| &mut face.hair));
            all.for_each(|hair| hair.look_from(&self.gpu.device, &self.gpu.queue, &eye, &head));
        }
        let poses = self.colliders.poses(self.time, &self.parts);
        let frame =
            Frame { dt: seconds, head, colliders: &poses, simulation: &self.physics, ..Default::default() };
        let Gpu { device, queue, .. } = &self.gpu;
        let mut recorder = Recorder { pipelines: &self.pipelines, device, queue, encoder, timings };
        if let Some(living) = &self.living {
            recorder.bend(&[living.skinning()])?;
        }
        recorder.advance(&mut self.hair, &frame)?;
        let (hair, pose) = (&self.hair, self.pose);
        self.face.iter_mut().try_for_each(|face| face.advance(&mut recorder, &frame, hair, pose))
    }

    /// Records the picture that `camera` sees.
    ///
    /// # Errors
    /// When the adapter cannot hold what a view needs.
    pub fn record_draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        camera: &Viewpoint,
    ) -> Result<()> {
        self.look_from(camera);
        self.record_picture(encoder, timings, false, Asked::default())
    }

    /// Whether the picture that has been submitted holds all of the hair, or is to be drawn again
    /// ([`tresses::View::is_complete`]).
    ///
    /// # Errors
    /// When the GPU is lost.
    pub async fn is_complete(&self) -> Result<bool> {
        Ok(self.view.is_complete(&self.gpu.device, &self.gpu.queue).await?)
    }

    /// Records the picture of the last [`record_draw`](Self::record_draw) once more, after the targets have become
    /// others: hair, camera, and what is shown are the same, and it is hair as it looks.
    ///
    /// # Errors
    /// As there.
    pub fn record_redraw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
    ) -> Result<()> {
        self.record_picture(encoder, timings, true, Asked::default())
    }

    /// The picture, `again` as it is lit already.
    pub(super) fn record_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        again: bool,
        asked: Asked,
    ) -> Result<()> {
        let Self { gpu: Gpu { device, queue, .. }, pipelines, hair, face, .. } = self;
        let Self { body, obstacles, view, picture, .. } = self;
        face.iter_mut().for_each(|face| face.dress(&hair.set.material));
        let hairs: Vec<_> = std::iter::once(&*hair).chain(face.iter().map(|face| &face.hair)).collect();
        let mut bodies = Vec::new();
        for body in body.iter_mut().chain(obstacles).filter(|_| !asked.bare) {
            body.pose = self.pose;
            bodies.push(&*body);
        }
        let shows = match (&mut self.shown, &mut self.views) {
            _ if again => Shows::Again,
            (Some(shown), Some(views)) => {
                shown.wind = self.physics.wind.velocity;
                Shows::Inside(views, shown)
            }
            _ => Shows::Hair,
        };
        // What is drawn again is lit already.
        if !again {
            let lod = &hair.lod.options;
            let counts = [hairs.len(), bodies.len()];
            match lod.mode {
                LodMode::Auto => view.fit_light(device, pipelines, (picture, lod.bias), counts),
                LodMode::Off | LodMode::Fixed(_) => view.set_zones(device, pipelines, &[]),
            }
        }
        let sight = Sight { shows, asks: asked.hair, ..Sight::new(view, picture) };
        let mut recorder = Recorder { pipelines, device, queue, encoder, timings };
        Ok(recorder.draw(&hairs, &bodies, sight)?)
    }

    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
        Ok(())
    }
}
