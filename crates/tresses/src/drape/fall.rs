//! Settling: simulation steps with a resting head.

use crate::simulate::{
    RestOptions, RestShape, Simulation, SimulationParams,
    rest::{self, GuideTraits},
};
use crate::{
    Context, Pose, Result,
    clock::{MAX_STEPS, Mode, Step},
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    gpu::readback,
    groom::SdfGrid,
    strands::GuideBuffers,
};
use glam::Vec3;

/// Options for draping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrapeOptions {
    /// Simulated time, s.
    pub seconds: f32,
    /// Drag during the fall, 1/s: high, so that the hair comes to rest within `seconds`.
    pub drag: f32,
    /// Distance to keep from the head, meters.
    pub clearance: f32,
}

impl Default for DrapeOptions {
    fn default() -> Self {
        Self { seconds: 1.5, drag: 6.0, clearance: 1.5e-3 }
    }
}

/// Simulates guides until they settle and returns their positions. `positions` is the shape without gravity:
/// guide-major, `n` per guide, groom space, meters. The result is in the same order.
///
/// # Errors
/// As [`rest::guides`], [`crate::Error::Limit`] for buffers that are too large, and [`crate::Error::Gpu`] when the
/// device is lost.
pub async fn drape(
    context: &Context,
    positions: &[Vec3],
    n: u32,
    traits: &[GuideTraits],
    params: &SimulationParams,
    field: Option<&SdfGrid>,
    options: &DrapeOptions,
) -> Result<Vec<Vec3>> {
    let Context { device, queue, .. } = context;
    let rest_options =
        RestOptions { shape: RestShape::Natural, clearance: options.clearance, ..Default::default() };
    let params = SimulationParams { drag: options.drag, ..*params };
    let rest = rest::guides(positions, n, traits, &params, &rest_options, field)?;
    let count = rest.info.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let guides = GuideBuffers::new(context, count as u32, n, 2)?;
    rest.upload(context, &guides)?;
    let obstacles = ColliderDescriptor { head: field, ..Default::default() };
    let mut colliders = ColliderSet::new(context, &obstacles)?;
    let mut simulation = Simulation::new(context, &guides);
    // With static friction, hair would stick where it first touches.
    simulation.slide();
    let still = Pose::IDENTITY;
    let step = Step { mode: Mode::Step, begin: still, end: still, from: 0.0, to: 1.0 };
    let mut left = (options.seconds.clamp(0.0, 60.0) / params.step).ceil() as u32;
    while left > 0 {
        let now = left.min(MAX_STEPS);
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("drape") });
        let mut commands = context.commands(&mut encoder);
        let mut pass = commands.compute("drape");
        let steps = vec![step; now as usize];
        let (substeps, length) = (params.substep_count, params.step);
        let moments = Moments { steps: &steps, substeps, step: length, head: still, alpha: 1.0 };
        colliders.advance(&ColliderPoses::default(), &moments)?;
        simulation.run(&mut pass, &params, &steps, &colliders)?;
        pass.end()?;
        queue.submit([encoder.finish()]);
        left -= now;
    }
    let settled: Vec<[f32; 4]> = readback::buffer(context, &guides.current).await?;
    let n = n as usize;
    Ok((0..count * n).map(|i| Vec3::from_slice(&settled[i % n * count + i / n][..3])).collect())
}
