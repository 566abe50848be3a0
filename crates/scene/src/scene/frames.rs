//! Frames of a scene: advance the character, then draw it.

use super::{OutputRequest, Scene};
use crate::camera::{CaptureCamera, Viewpoint};
use anyhow::{Context as _, Result};
use tresses::{
    Gesture, Timings,
    glam::Vec3,
    low_level::{Drawing, ViewContent},
};

impl Scene {
    /// Puts the hair at rest on a character posed by `gesture`.
    pub fn reset(&mut self, gesture: &Gesture) -> Result<()> {
        self.character.reset();
        self.advance(gesture, 0.0)
    }

    /// Advances time by `seconds` and moves the character to `gesture`, together with its hair.
    pub fn advance(&mut self, gesture: &Gesture, seconds: f32) -> Result<()> {
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, gesture, seconds)?;
        self.submit(encoder)
    }

    /// Places a ball of `radius` (meters) at `at` in the world from the next frame on; `None` removes it.
    ///
    /// # Errors
    /// Fails if there are too many colliders already.
    pub fn set_ball(&mut self, at: Option<Vec3>, radius: f32) -> Result<()> {
        if self.colliders.set_ball(at, radius) {
            self.make_obstacles();
        }
        Ok(self.character.set_obstacles(self.colliders.ball().as_slice())?)
    }

    /// Moves the collider mesh to the poses that are drawn. Call it after advancing a frame and before drawing it.
    pub fn move_colliders(&mut self) {
        if let Some(obstacles) = self.character.props.first() {
            let poses = self.character.drawn_obstacles();
            if !poses.is_empty() {
                obstacles.move_to(&self.colliders.mesh(&poses));
            }
        }
    }

    /// Returns the library's camera for `camera`.
    pub(crate) fn eye(&self, camera: &Viewpoint) -> tresses::Camera {
        CaptureCamera::from(*camera).camera(self.targets().size)
    }

    /// Sets camera and lights. Key and rim light follow the camera unless the settings fix them or an environment map
    /// lights the scene.
    pub(crate) fn look_from(&mut self, camera: impl Into<CaptureCamera>) {
        let camera = camera.into();
        self.picture.camera = camera.camera(self.targets().size);
        let back = camera.back();
        let surroundings = self.surroundings.as_ref().map(|(.., lights)| lights);
        self.picture.lights =
            self.lighting.lights(back.x.atan2(back.z), surroundings, self.character.asset().lights());
    }

    /// Records the motion of character and hair to `gesture` over `seconds`.
    ///
    /// # Errors
    /// Fails if a parameter is out of range.
    pub fn record_advance(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        gesture: &Gesture,
        seconds: f32,
    ) -> Result<()> {
        let time = self.character.time() + f64::from(seconds);
        self.character.set_obstacle_poses(&self.colliders.poses(time))?;
        self.character.gesture.clone_from(gesture);
        let eye = self.watcher.map(|camera| self.eye(&camera));
        let mut frame = self.gpu.context.frame(encoder).timed(timings).with_cameras(eye.as_slice());
        Ok(frame.advance(&mut [&mut self.character], seconds)?)
    }

    /// Records the frame as seen from `camera`.
    ///
    /// # Errors
    /// Fails if the adapter cannot allocate what the view needs.
    pub fn record_draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        camera: &Viewpoint,
    ) -> Result<()> {
        self.look_from(*camera);
        self.record_picture(encoder, timings, false, OutputRequest::default())
    }

    /// Returns whether the submitted frame contains all of the hair. If not, draw it again
    /// ([`tresses::View::is_complete`]).
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn is_complete(&self) -> Result<bool> {
        Ok(self.view.is_complete().await?)
    }

    /// Records the frame of the last [`record_draw`](Self::record_draw) again after the targets were replaced. Hair,
    /// camera and lighting must be unchanged. It always draws the hair itself, never a debug view.
    ///
    /// # Errors
    /// As [`record_draw`](Self::record_draw).
    pub fn record_redraw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
    ) -> Result<()> {
        self.record_picture(encoder, timings, true, OutputRequest::default())
    }

    /// Records the frame. `again` skips the lighting, which is still valid.
    pub(super) fn record_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        again: bool,
        request: OutputRequest,
    ) -> Result<()> {
        let shows = match (&self.shown, &mut self.views) {
            _ if again => ViewContent::Again,
            (Some(shown), Some(views)) => ViewContent::Inside(views, shown),
            _ => ViewContent::Hair,
        };
        let drawing = Drawing {
            shows,
            writes_labels: request.hair,
            hides_bodies: request.hair_only,
            ..Drawing::new(&self.picture)
        };
        let mut frame = self.gpu.context.frame(encoder).timed(timings);
        Ok(frame.draw_as(&mut self.view, &[&self.character], drawing)?)
    }

    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.context.queue().submit([encoder.finish()]);
        self.gpu.context.device().poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
        Ok(())
    }
}
