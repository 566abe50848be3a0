//! The frame: one call per stage, in order.

use crate::{
    Hair, HairRenderer, Pose, Result,
    collide::ColliderPoses,
    draw::{
        Body, Embed, HairSet, Scene, Surroundings, Targets,
        debug::{DebugViews, Shown},
    },
    gpu::Timings,
    simulate::SimulationParams,
    stage::Stage,
};
use web_time::Instant;

/// What a frame depends on besides the hair itself.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Time since the last frame, seconds.
    pub dt: f32,
    /// Where the head is now. Roots follow it rigidly.
    pub head: Pose,
    /// Where the colliders are now.
    pub colliders: &'a ColliderPoses,
    /// The physics.
    pub simulation: &'a SimulationParams,
}

/// What a frame is recorded with. Record each groom once per submission: a frame's uniforms are
/// written through the queue and are those of the last frame recorded.
#[derive(Debug)]
pub struct Recorder<'a> {
    /// The pipelines.
    pub renderer: &'a HairRenderer,
    /// The device of the pipelines and of everything that is recorded.
    pub device: &'a wgpu::Device,
    /// Its queue.
    pub queue: &'a wgpu::Queue,
    /// Takes the commands.
    pub encoder: &'a mut wgpu::CommandEncoder,
    /// Takes the stages' times, where the device has timestamps.
    pub timings: Option<&'a mut Timings>,
}

impl Recorder<'_> {
    /// Moves the hair by a frame: [`simulate`](Self::simulate), then [`follow`](Self::follow).
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] when a parameter of the physics is out of its range,
    /// [`crate::Error::Colliders`] when there are not as many poses as colliders.
    pub fn advance(&mut self, hair: &mut Hair, frame: &Frame<'_>) -> Result<()> {
        self.simulate(hair, frame)?;
        self.follow(hair, frame);
        Ok(())
    }

    /// Guides move: as many fixed steps as have become due.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub fn simulate(&mut self, hair: &mut Hair, frame: &Frame<'_>) -> Result<()> {
        let (renderer, device) = (self.renderer, self.device);
        for step in 0..hair.begin(device, self.queue, renderer, frame)? {
            if hair.uses_volume() {
                self.stage(Stage::Volume, |pass| hair.record_volume(pass, &renderer.volume, step));
            }
            if hair.uses_wind() {
                self.stage(Stage::Wind, |pass| hair.record_wind(pass, &renderer.wind, step));
            }
            self.stage(Stage::Simulate, |pass| hair.record_simulate(pass, device, &renderer.simulate, step));
        }
        Ok(())
    }

    /// The drawn strands follow the guides: [`tessellate`](Self::tessellate),
    /// [`interpolate`](Self::interpolate), [`avoid`](Self::avoid).
    pub fn follow(&mut self, hair: &mut Hair, frame: &Frame<'_>) {
        self.tessellate(hair, frame);
        self.interpolate(hair);
        self.avoid(hair);
    }

    /// The guides' smooth curves for the head's pose now.
    pub fn tessellate(&mut self, hair: &mut Hair, frame: &Frame<'_>) {
        hair.prepare(self.queue, &frame.head, frame.dt);
        let renderer = self.renderer;
        self.stage(Stage::Tessellate, |pass| hair.record_tessellate(pass, &renderer.tessellate));
    }

    /// The strands' vertices between those curves, some of them in obstacles.
    pub fn interpolate(&mut self, hair: &Hair) {
        let renderer = self.renderer;
        self.stage(Stage::Interpolate, |pass| {
            hair.record_interpolate(pass, &renderer.interpolate, &renderer.widths)
        });
    }

    /// Strands that entered an obstacle leave it. Once after each [`interpolate`](Self::interpolate):
    /// what it remembers moves on by the frame's time.
    pub fn avoid(&mut self, hair: &Hair) {
        let renderer = self.renderer;
        self.stage(Stage::Avoid, |pass| hair.record_avoid(pass, &renderer.avoid));
    }

    /// Draws hair and body as they are now: shadow maps, shading, the HDR picture, the finished one
    /// into `output` (of the size of `targets`, in the format that the renderer was made for).
    pub fn draw(
        &mut self,
        hair: &Hair,
        body: Option<&Body>,
        scene: &Scene,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) {
        let (stage, set) = (&self.renderer.draw, &hair.set);
        stage.prepare(self.queue, scene, targets, Some(set), body);
        stage.shadow(self.encoder, self.timings.as_deref_mut(), scene, Some(set), body);
        stage.shade(self.encoder, self.timings.as_deref_mut(), set);
        self.picture(set, body, scene, targets, output);
    }

    /// Draws what the last [`draw`](Self::draw) has lit once more, into `targets` of another size or with more
    /// samples: a picture that stands still becomes finer without being lit anew. Hair, body and `scene` must be
    /// the same; what is lit per strand vertex stays as it is.
    pub fn redraw(
        &mut self,
        hair: &Hair,
        body: Option<&Body>,
        scene: &Scene,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) {
        self.renderer.draw.prepare(self.queue, scene, targets, Some(&hair.set), body);
        self.picture(&hair.set, body, scene, targets, output);
    }

    /// Draws hair as it is now over a scene that is drawn already, hidden by what is in front of it:
    /// see [`draw::embed`](crate::draw::embed). `body`'s shadow falls on it.
    pub fn draw_into(
        &mut self,
        hair: &Hair,
        body: Option<&Body>,
        scene: &Scene,
        targets: &Targets,
        embed: &Embed,
        into: &Surroundings<'_>,
    ) {
        let (stage, timings) = (&self.renderer.draw, self.timings.as_deref_mut());
        let (device, queue) = (self.device, self.queue);
        embed.record(device, queue, self.encoder, timings, stage, scene, targets, &hair.set, body, into);
    }

    /// As [`draw`](Self::draw), but the picture shows what `shown` asks for. Nothing is read back.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the device cannot hold what the view needs.
    #[allow(clippy::too_many_arguments)]
    pub fn draw_view(
        &mut self,
        views: &mut DebugViews,
        shown: &Shown,
        hair: &Hair,
        body: Option<&Body>,
        scene: &Scene,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) -> Result<()> {
        let draw = &self.renderer.draw;
        let timings = self.timings.as_deref_mut();
        views.record(
            draw,
            self.device,
            self.queue,
            self.encoder,
            timings,
            shown,
            hair,
            body,
            scene,
            targets,
            output,
        )
    }

    /// The HDR picture, and the finished one.
    fn picture(
        &mut self,
        hair: &HairSet,
        body: Option<&Body>,
        scene: &Scene,
        targets: &Targets,
        output: &wgpu::TextureView,
    ) {
        let stage = &self.renderer.draw;
        stage.draw(self.encoder, self.timings.as_deref_mut(), scene, targets, Some(hair), body);
        stage.present(self.device, self.encoder, self.timings.as_deref_mut(), targets, output);
    }

    /// A compute pass under the name of a stage.
    fn stage<R>(&mut self, stage: Stage, record: impl FnOnce(&mut wgpu::ComputePass<'_>) -> R) -> R {
        let start = self.timings.as_ref().filter(|timings| timings.is_by_the_clock()).map(|_| Instant::now());
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(stage.name()),
            timestamp_writes: self.timings.as_deref_mut().and_then(|timings| timings.compute(stage.name())),
        });
        let result = record(&mut pass);
        drop(pass);
        if let (Some(timings), Some(start)) = (&mut self.timings, start) {
            timings.finish(self.device, self.queue, self.encoder, stage.name(), start);
        }
        result
    }
}
