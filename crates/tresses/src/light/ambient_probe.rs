//! Evaluates ambient light at arbitrary points, for tests and measurements.

use super::{LightState, point_query::PointQuery};
use crate::{
    Context, Result,
    gpu::{BindBuffer, Kernel},
    shaders::kernels::light::ambient as kernels,
};
use glam::{Vec3, Vec4};

/// Ambient light at a point, averaged over a set of directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct IncidentLight {
    /// Sky visibility for fibers that remove 0, 1/8, 1/2 and all of the light that hits them. Meshes remove all of it.
    pub open: Vec4,
    /// Mean radiance of meshes.
    pub radiance: Vec3,
}

/// A set of points at which ambient light is evaluated.
#[derive(Debug)]
pub struct AmbientProbe(PointQuery<[Vec4; 2]>);

impl AmbientProbe {
    /// Uploads `points`, for evaluation in the ambient light grid of `light`. Each point is a position (meters) and the
    /// mean vector of the directions to average over: 0 for all directions, half a unit vector for a hemisphere.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the points.
    pub fn new(context: &Context, light: &LightState, points: &[(Vec3, Vec3)]) -> Result<Self> {
        let words: Vec<_> = points
            .iter()
            .flat_map(|(at, mean_direction)| [at.extend(0.0), mean_direction.extend(0.0)])
            .collect();
        let (transmittance, ambient) = (light.transmittance(), light.ambient());
        let bind = |kernel: &Kernel, points: &wgpu::Buffer, results: &wgpu::Buffer| {
            kernel.bind(&kernels::Query {
                points: points.entire(),
                transmittance,
                ambient,
                results: results.entire(),
            })
        };
        let query = PointQuery::new::<kernels::Query<'_>>(context, &words, points.len(), bind);
        Ok(Self(query?))
    }

    /// Records the evaluation. Call it after [`Recorder::light`](crate::frame::Recorder::light).
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel cannot be compiled.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        self.0.record(encoder)
    }

    /// Reads the results back, in the order of the points.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&self) -> Result<Vec<IncidentLight>> {
        let results = self.0.read().await?;
        let around = |[open, glow]: [Vec4; 2]| IncidentLight { open, radiance: glow.truncate() };
        Ok(results.into_iter().map(around).collect())
    }
}
