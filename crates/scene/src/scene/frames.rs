//! Frames of a scene: the character moves, then it is drawn.

use super::{Asked, Scene};
use crate::camera::{self, Viewpoint};
use anyhow::{Context as _, Result};
use tresses::{
    character::{Drawing, Gesture},
    frame::Shows,
    glam::Vec3,
    gpu::Timings,
};

impl Scene {
    /// Puts the hair to rest on a character that makes a `gesture`.
    pub fn reset(&mut self, gesture: &Gesture) -> Result<()> {
        self.character.reset();
        self.advance(gesture, 0.0)
    }

    /// Moves the character into a `gesture` in `seconds`, and the hair with it.
    pub fn advance(&mut self, gesture: &Gesture, seconds: f32) -> Result<()> {
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, gesture, seconds)?;
        self.submit(encoder)
    }

    /// Places a ball of `radius` metres in the world, metres, from the next frame on; `None` removes it.
    ///
    /// # Errors
    /// When there are too many colliders already.
    pub fn set_ball(&mut self, at: Option<Vec3>, radius: f32) -> Result<()> {
        if self.colliders.set_ball(at, radius) {
            self.make_obstacles();
        }
        Ok(self.character.set_obstacles(self.colliders.ball().as_slice())?)
    }

    /// Moves the mesh of the obstacles to where they are drawn: between a frame's motion and its picture.
    pub fn place_colliders(&mut self) {
        if let Some(obstacles) = self.character.props.first() {
            let poses = self.character.drawn_obstacles();
            if !poses.is_empty() {
                obstacles.move_to(&self.colliders.mesh(&poses));
            }
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

    /// Records the motion of the character into a `gesture` in `seconds`, and of the hair with it.
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
        let time = self.character.time() + f64::from(seconds);
        self.character.place_obstacles(&self.colliders.poses(time))?;
        self.character.gesture.clone_from(gesture);
        let eye = self.watcher.map(|camera| self.eye(&camera));
        let mut frame = self.gpu.context.frame(encoder).timed(timings).seen_by(eye.as_slice());
        Ok(frame.advance(&mut [&mut self.character], seconds)?)
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
        Ok(self.view.is_complete().await?)
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
        let shows = match (&self.shown, &mut self.views) {
            _ if again => Shows::Again,
            (Some(shown), Some(views)) => Shows::Inside(views, shown),
            _ => Shows::Hair,
        };
        let drawing = Drawing { shows, asks: asked.hair, bare: asked.bare, ..Drawing::new(&self.picture) };
        let mut frame = self.gpu.context.frame(encoder).timed(timings);
        Ok(frame.draw_as(&mut self.view, &[&self.character], drawing)?)
    }

    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.context.queue().submit([encoder.finish()]);
        self.gpu.context.device().poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
        Ok(())
    }
}
