//! Evaluates the shadow maps at arbitrary points, for tests and measurements.

use super::{LightState, point_query::PointQuery};
use crate::{
    Context, Result,
    constants::MAX_LIGHTS,
    gpu::{BindBuffer, Kernel},
    shaders::kernels::light as kernels,
};
use glam::{Vec3, Vec4};

/// Occluders between a point and a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Shadow {
    /// Mean number of fibers: -ln of the fraction of the light that hits none.
    pub fibers: f32,
    /// Fraction of the light that no mesh blocks.
    pub solid: f32,
}

/// A set of points at which the shadow maps are evaluated.
#[derive(Debug)]
pub struct ShadowProbe(PointQuery<[[f32; 2]; MAX_LIGHTS as usize]>);

impl ShadowProbe {
    /// Uploads `points` (meters, at most four million), for evaluation in the maps of `light`. With `eye`, the unit
    /// vector towards a distant eye, the points count as visible from there. Without it they are arbitrary points of
    /// the hair.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the points.
    pub fn new(context: &Context, light: &LightState, points: &[Vec3], eye: Option<Vec3>) -> Result<Self> {
        let eye = eye.map_or(Vec4::ZERO, |eye| eye.extend(1.0));
        let words: Vec<_> =
            std::iter::once(eye).chain(points.iter().map(|point| point.extend(0.0))).collect();
        let transmittance = light.transmittance();
        let bind = |kernel: &Kernel, points: &wgpu::Buffer, results: &wgpu::Buffer| {
            kernel.bind(&kernels::Probe { points: points.entire(), transmittance, results: results.entire() })
        };
        let query = PointQuery::new::<kernels::Probe<'_>>(context, &words, points.len(), bind);
        Ok(Self(query?))
    }

    /// Records the evaluation. Call it after [`Recorder::light`](crate::frame::Recorder::light).
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel cannot be compiled.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.0.record(encoder)
    }

    /// Reads the results back: for each point one per light with a shadow map, in order.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&self) -> Result<Vec<[Shadow; MAX_LIGHTS as usize]>> {
        let results = self.0.read().await?;
        let shadow = |[fibers, solid]: [f32; 2]| Shadow { fibers, solid };
        Ok(results.into_iter().map(|lights| lights.map(shadow)).collect())
    }
}
