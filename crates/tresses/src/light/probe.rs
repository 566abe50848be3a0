//! Evaluates the shadow maps at arbitrary points: used for measurements by tests and tools.

use super::{MAX_LIGHTS, State, asked::Asked};
use crate::{Context, Result, gpu::Binding};
use glam::{Vec3, Vec4};

/// What is between a point and a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shadow {
    /// The mean number of fibres: -ln of the share of the light that meets none.
    pub fibers: f32,
    /// The share of the light that no body keeps away.
    pub solid: f32,
}

/// A set of points that the shadow maps are asked about.
#[derive(Debug)]
pub struct ShadowProbe(Asked<[[f32; 2]; MAX_LIGHTS]>);

impl ShadowProbe {
    /// Takes `points` (metres, at most four million) to the GPU, to be asked about in the maps of a view's `light`: as
    /// points visible from a distant eye in the direction `eye` (unit), or, without it, as arbitrary points of the hair.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold them.
    pub fn new(context: &Context, light: &State, points: &[Vec3], eye: Option<Vec3>) -> Result<Self> {
        use Binding::{Comparison, DepthArray, Storage, Uniform};
        let entries = [Uniform, DepthArray, Comparison, Storage, Storage];
        let frame = entries.into_iter().zip(light.resources());
        let eye = eye.map_or(Vec4::ZERO, |eye| eye.extend(1.0));
        let words: Vec<_> =
            std::iter::once(eye).chain(points.iter().map(|point| point.extend(0.0))).collect();
        Ok(Self(Asked::new(context, "light::probe", (&words, points.len()), frame)?))
    }

    /// Asks, after [`Recorder::light`](crate::frame::Recorder::light) has been recorded.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel cannot be compiled.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.0.record(encoder)
    }

    /// The answers, for each point those of the lights that are on, in their order.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&self) -> Result<Vec<[Shadow; MAX_LIGHTS]>> {
        let answers = self.0.read().await?;
        let shadow = |[fibers, solid]: [f32; 2]| Shadow { fibers, solid };
        Ok(answers.into_iter().map(|lights| lights.map(shadow)).collect())
    }
}
