//! Animation curves: keys and the interpolation between them.

use glam::{Quat, Vec4};

/// A motion of several nodes.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Animation {
    /// Name, empty if it has none.
    pub name: String,
    /// Time of the last key, seconds. The animation loops over it.
    pub length: f32,
    /// Animated properties. If two channels move the same property, the later one counts.
    pub channels: Vec<Channel>,
}

/// One property of one node over time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Channel {
    /// Index of the node.
    pub node: u32,
    /// Animated property of the node.
    pub property: Property,
    /// Values over time.
    pub curve: Curve,
}

/// Animated property of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum Property {
    /// Translation: three numbers.
    Translation,
    /// Rotation: a quaternion, x, y, z, w.
    Rotation,
    /// Scale: three numbers.
    Scale,
    /// Weights of these targets of the rig: one number each.
    Weights(Vec<u32>),
}

/// Interpolation between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum Interpolation {
    /// Holds the previous key.
    Step,
    /// Linear; rotations along the shorter arc.
    #[default]
    Linear,
    /// Cubic Hermite spline, with an in-tangent and an out-tangent at each key.
    CubicSpline,
}

/// Keys of one property.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Curve {
    /// Interpolation between keys.
    pub interpolation: Interpolation,
    /// Times of the keys, seconds, ascending.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub times: Vec<f32>,
    /// Numbers of each key, one after another. In a cubic spline, a key has three times as many: the in-tangent, the
    /// values, the out-tangent. Tangents are per second.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub values: Vec<f32>,
}

impl Animation {
    /// Wraps a time into the animation, which loops. Returns 0 for a time that is not finite.
    pub fn wrap(&self, time: f32) -> f32 {
        let wrapped = time.rem_euclid(self.length);
        if wrapped.is_finite() { wrapped } else { 0.0 }
    }
}

impl Curve {
    /// Writes the values at `time` (seconds) to `out`, which is as long as a key has numbers. Before the first key and
    /// after the last one, that key holds. `is_rotation` marks the numbers as a quaternion. Without keys, or with too
    /// few numbers for them, nothing is written.
    pub fn sample(&self, time: f32, is_rotation: bool, out: &mut [f32]) {
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if self.values.len() < self.times.len() * out.len() * parts {
            return;
        }
        let next = self.times.partition_point(|t| *t <= time);
        let (Some(from), Some(last)) = (next.checked_sub(1).or(Some(0)), self.times.len().checked_sub(1))
        else {
            return;
        };
        let to = next.min(last);
        let (start, end) = (self.times[from], self.times[to]);
        let length = end - start;
        let fraction = if length > 0.0 { (time - start) / length } else { 0.0 };
        match self.interpolation {
            _ if from == to || length <= 0.0 => out.copy_from_slice(self.key(from, out.len())),
            Interpolation::Step => out.copy_from_slice(self.key(from, out.len())),
            Interpolation::Linear => self.linear(from, to, fraction, is_rotation, out),
            Interpolation::CubicSpline => self.hermite([from, to], fraction, length, out),
        }
        if is_rotation && let Some(q) = quaternion(out) {
            out.copy_from_slice(&q.normalize().to_array());
        }
    }

    /// Returns the values of a key, without tangents.
    fn key(&self, key: usize, width: usize) -> &[f32] {
        match self.interpolation {
            Interpolation::CubicSpline => self.part(key, 1, width),
            _ => &self.values[key * width..][..width],
        }
    }

    /// Returns the in-tangent (0), the values (1) or the out-tangent (2) of a spline's key.
    fn part(&self, key: usize, part: usize, width: usize) -> &[f32] {
        &self.values[(3 * key + part) * width..][..width]
    }

    fn linear(&self, from: usize, to: usize, fraction: f32, is_rotation: bool, out: &mut [f32]) {
        let (a, b) = (self.key(from, out.len()), self.key(to, out.len()));
        if is_rotation && let (Some(a), Some(b)) = (quaternion(a), quaternion(b)) {
            out.copy_from_slice(&a.slerp(b, fraction).to_array());
            return;
        }
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = a + (b - a) * fraction;
        }
    }

    fn hermite(&self, [from, to]: [usize; 2], t: f32, length: f32, out: &mut [f32]) {
        let width = out.len();
        let (t2, t3) = (t * t, t * t * t);
        let weights = Vec4::new(
            2.0 * t3 - 3.0 * t2 + 1.0,
            length * (t3 - 2.0 * t2 + t),
            3.0 * t2 - 2.0 * t3,
            length * (t3 - t2),
        );
        let parts = [(from, 1), (from, 2), (to, 1), (to, 0)].map(|(key, part)| self.part(key, part, width));
        for (i, out) in out.iter_mut().enumerate() {
            *out = weights.dot(Vec4::from(parts.map(|p| p[i])));
        }
    }
}

/// Returns four numbers as a quaternion, or `None` if they have no direction.
fn quaternion(values: &[f32]) -> Option<Quat> {
    let q = Quat::from_slice(values.get(..4)?);
    (q.length_squared() > 1e-12 && q.is_finite()).then_some(q)
}
