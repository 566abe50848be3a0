//! Scalar maps over the scalp.

use crate::{Error, Result};
use glam::Vec2;

/// An image over the scalp (see [`scalp_uv`](super::scalp_uv)), with values usually from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalpMap {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl ScalpMap {
    /// Creates a map of `width` times `height` values, rows in order of ascending v.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a wrong number of values, or for a value that is negative or not finite.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Result<Self> {
        let good = width > 0 && height > 0 && width.checked_mul(height) == Some(values.len());
        if !good || values.iter().any(|v| !v.is_finite() || *v < 0.0) {
            return Err(Error::Parameter {
                name: "scalp map",
                value: format!("{width} x {height} with {} values", values.len()),
                range: "a rectangle of finite values that are not negative",
            });
        }
        Ok(Self { width, height, values })
    }

    /// Creates a map of `size` times `size` values from a function of the scalp coordinates.
    pub fn from_fn(size: usize, value: impl Fn(Vec2) -> f32) -> Self {
        let size = size.max(1);
        let at = |i: usize| Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) / size as f32;
        Self { width: size, height: size, values: (0..size * size).map(|i| value(at(i)).max(0.0)).collect() }
    }

    /// Returns the map with every value changed by `change`. Negative and non-finite results become 0.
    #[must_use]
    pub fn map(mut self, change: impl Fn(f32) -> f32) -> Self {
        for value in &mut self.values {
            *value = Some(change(*value)).filter(|v| v.is_finite()).unwrap_or(0.0).max(0.0);
        }
        self
    }

    /// Returns the value at `uv`: linear between the centers of the pixels, constant beyond them.
    pub fn sample(&self, uv: Vec2) -> f32 {
        let axis = |v: f32, n: usize| {
            let x = (v * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (x as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), x - i as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (axis(uv.x, self.width), axis(uv.y, self.height));
        let row = |y: usize| {
            let at = |x: usize| self.values[y * self.width + x];
            at(x0) + (at(x1) - at(x0)) * fx
        };
        row(y0) + (row(y1) - row(y0)) * fy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_interpolates_between_pixels() {
        let map = ScalpMap::new(2, 1, vec![0.0, 1.0]).unwrap();
        assert_eq!(map.sample(Vec2::new(0.5, 0.5)), 0.5);
        assert_eq!(map.sample(Vec2::new(-3.0, 0.5)), 0.0);
        assert_eq!(map.sample(Vec2::new(2.0, 9.0)), 1.0);
        assert!(ScalpMap::new(2, 2, vec![0.0]).is_err());
        assert!(ScalpMap::new(1, 1, vec![f32::NAN]).is_err());
        let ramp = ScalpMap::from_fn(16, |uv| uv.x);
        assert!((ramp.sample(Vec2::new(0.4, 0.2)) - 0.4).abs() < 1e-5);
    }
}
