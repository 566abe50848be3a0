//! The frame: one call per stage, in order.

use crate::{
    Hair, HairRenderer, Pose, Result,
    draw::{Body, Scene, Targets},
    gpu::Timings,
    simulate::{ColliderPoses, SimulationParams},
    stage::Stage,
};

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

/// Moves the hair by a frame: [`simulate`], then [`follow`]. Record once per submission.
///
/// # Errors
/// [`crate::Error::Parameter`] when a parameter of the physics is out of its range.
pub fn advance(
    renderer: &HairRenderer,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    timings: &mut Option<&mut Timings>,
    hair: &mut Hair,
    frame: &Frame<'_>,
) -> Result<()> {
    simulate(renderer, device, queue, encoder, timings, hair, frame)?;
    follow(renderer, queue, encoder, timings, hair, frame);
    Ok(())
}

/// Guides move: as many fixed steps as have become due.
///
/// # Errors
/// As [`advance`].
pub fn simulate(
    renderer: &HairRenderer,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    timings: &mut Option<&mut Timings>,
    hair: &mut Hair,
    frame: &Frame<'_>,
) -> Result<()> {
    frame.simulation.check()?;
    let steps = hair.tick(frame.dt, frame.simulation.step, &frame.head);
    stage(encoder, timings, Stage::Simulate, |pass| {
        hair.simulation.record(
            &renderer.simulate,
            device,
            queue,
            pass,
            frame.simulation,
            &steps,
            frame.colliders,
        )
    })
}

/// The drawn strands follow the guides: their vertices for the head's pose now.
pub fn follow(
    renderer: &HairRenderer,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    timings: &mut Option<&mut Timings>,
    hair: &Hair,
    frame: &Frame<'_>,
) {
    let field = frame.colliders.field.map_or(frame.head, |own| frame.head.after(&own));
    hair.prepare(queue, &frame.head, &field);
    stage(encoder, timings, Stage::Tessellate, |pass| hair.record_tessellate(pass, &renderer.tessellate));
    stage(encoder, timings, Stage::Interpolate, |pass| hair.record_interpolate(pass, &renderer.interpolate));
}

/// Draws hair and body as they are now: shadow maps, shading, the HDR picture, the finished one
/// into `output` (of the size of `targets`, in the format that the renderer was made for).
#[allow(clippy::too_many_arguments)]
pub fn draw(
    renderer: &HairRenderer,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    encoder: &mut wgpu::CommandEncoder,
    timings: &mut Option<&mut Timings>,
    hair: &Hair,
    body: Option<&Body>,
    scene: &Scene,
    targets: &Targets,
    output: &wgpu::TextureView,
) {
    let (stage, hair) = (&renderer.draw, Some(&hair.set));
    stage.prepare(queue, scene, targets, hair, body);
    stage.shadow(encoder, timings.as_deref_mut(), hair, body);
    if let Some(hair) = hair {
        stage.shade(encoder, timings.as_deref_mut(), hair);
    }
    stage.draw(encoder, timings.as_deref_mut(), scene, targets, hair, body);
    stage.present(device, encoder, timings.as_deref_mut(), targets, output);
}

/// A compute pass under the name of a stage.
fn stage<R>(
    encoder: &mut wgpu::CommandEncoder,
    timings: &mut Option<&mut Timings>,
    stage: Stage,
    record: impl FnOnce(&mut wgpu::ComputePass<'_>) -> R,
) -> R {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(stage.name()),
        timestamp_writes: timings.as_deref_mut().and_then(|timings| timings.compute(stage.name())),
    });
    record(&mut pass)
}
