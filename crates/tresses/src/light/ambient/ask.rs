//! Evaluates ambient light at arbitrary points: used for measurements by tests and tools.

use crate::{
    Context, Result,
    gpu::Binding,
    light::{State, asked::Asked},
};
use glam::{Vec3, Vec4};

/// What arrives at a point from some directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// The share of the sky that arrives where fibres take none, an eighth, half and all of the light that meets
    /// them; bodies take all.
    pub open: Vec4,
    /// The mean radiance of bodies.
    pub glow: Vec3,
}

/// A set of points at which ambient light is evaluated.
#[derive(Debug)]
pub struct AmbientProbe(Asked<[Vec4; 2]>);

impl AmbientProbe {
    /// Takes `points` to the GPU, to be asked about in the cells of a view's `light`: positions (metres), and the mean vector of
    /// the directions that are asked about (0 for all of them, half a unit vector for a hemisphere).
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold them.
    pub fn new(context: &Context, light: &State, points: &[(Vec3, Vec3)]) -> Result<Self> {
        use Binding::{Comparison, DepthArray, Sampler, Storage, Texture3d, Uniform};
        let entries = [Uniform, DepthArray, Comparison, Storage, Storage, Texture3d, Sampler];
        let frame = entries.into_iter().zip(light.resources());
        let words: Vec<_> =
            points.iter().flat_map(|(at, middle)| [at.extend(0.0), middle.extend(0.0)]).collect();
        Ok(Self(Asked::new(context, "light::ambient::ask", (&words, points.len()), frame)?))
    }

    /// Asks, after [`Recorder::light`](crate::frame::Recorder::light) has been recorded.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel cannot be compiled.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.0.record(encoder)
    }

    /// The answers.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&self) -> Result<Vec<Around>> {
        let answers = self.0.read().await?;
        let around = |[open, glow]: [Vec4; 2]| Around { open, glow: glow.truncate() };
        Ok(answers.into_iter().map(around).collect())
    }
}
