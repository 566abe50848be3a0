//! External forces on guide vertices: written by `simulate::forces`, read by `simulate::step`.

use bytemuck::{Pod, Zeroable};
#[cfg(test)]
use glam::{Vec2, Vec3};
#[cfg(test)]
use half::f16;

/// Largest acceleration (m/s²) and rate (1/s) that a [`GuideForce`] can hold.
#[cfg(test)]
pub const MAX_FORCE: f32 = 6e4;

/// A packed [`Force`], linear in the vertex's velocity.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct GuideForce {
    /// x and y of the acceleration, half floats.
    pub xy: u32,
    /// z of the acceleration and the rate, half floats.
    pub z_rate: u32,
    /// The tangent: octahedral, 16 bits per axis.
    pub tangent: u32,
    /// The rate along the tangent, a half float; the upper half is unused.
    pub along: u32,
}

/// The acceleration `acceleration − rate v − along t (t · v)` of a vertex with velocity `v`.
///
/// The step treats it implicitly in `v`, so it is stable for any rate. The writer linearizes other terms, such as drag
/// that grows with the square of the velocity.
#[cfg(test)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Force {
    /// Acceleration, m/s², world axes.
    pub acceleration: Vec3,
    /// Isotropic rate, 1/s; not negative.
    pub rate: f32,
    /// The unit vector `t`.
    pub tangent: Vec3,
    /// Additional rate along the tangent, 1/s; at least `-rate`.
    pub along: f32,
}

#[cfg(test)]
impl GuideForce {
    /// Packs a force, clamped to [`MAX_FORCE`].
    pub fn pack(force: &Force) -> Self {
        let half = |v: f32| u32::from(f16::from_f32(v.clamp(-MAX_FORCE, MAX_FORCE)).to_bits());
        let t = force.tangent;
        let n = t / (t.x.abs() + t.y.abs() + t.z.abs()).max(1e-20);
        let folded = if n.z >= 0.0 {
            Vec2::new(n.x, n.y)
        } else {
            Vec2::new((1.0 - n.y.abs()) * 1f32.copysign(n.x), (1.0 - n.x.abs()) * 1f32.copysign(n.y))
        };
        let axis = |v: f32| ((v.clamp(-1.0, 1.0) * 32_767.0 + 0.5).floor() as i32 as u32) & 0xffff;
        let a = force.acceleration;
        Self {
            xy: half(a.x) | half(a.y) << 16,
            z_rate: half(a.z) | half(force.rate) << 16,
            tangent: axis(folded.x) | axis(folded.y) << 16,
            along: half(force.along),
        }
    }

    /// Unpacks the force.
    pub fn unpack(&self) -> Force {
        let half = |v: u32| f16::from_bits(v as u16).to_f32();
        let axis = |v: u32| (f32::from(v as u16 as i16) / 32_767.0).max(-1.0);
        let (x, y) = (axis(self.tangent), axis(self.tangent >> 16));
        let mut n = Vec3::new(x, y, 1.0 - x.abs() - y.abs());
        let fold = (-n.z).max(0.0);
        n.x -= fold.copysign(n.x);
        n.y -= fold.copysign(n.y);
        Force {
            acceleration: Vec3::new(half(self.xy), half(self.xy >> 16), half(self.z_rate)),
            rate: half(self.z_rate >> 16),
            tangent: n.normalize(),
            along: half(self.along),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_survive_packing() {
        for i in 0..300 {
            let angle = i as f32 * 2.399_963;
            let z = 1.0 - (i as f32 + 0.5) / 150.0;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let force = Force {
                acceleration: Vec3::new(9.81, -0.013, 812.0) * (i as f32 - 150.0) * 0.1,
                rate: 0.37 * i as f32,
                tangent: Vec3::new(r * angle.cos(), r * angle.sin(), z),
                along: -0.2 * i as f32,
            };
            let back = GuideForce::pack(&force).unpack();
            let near = |a: f32, b: f32| (a - b).abs() <= a.abs() * 5e-4 + 1e-7;
            assert!(near(force.rate, back.rate) && near(force.along, back.along), "{force:?} {back:?}");
            for axis in 0..3 {
                assert!(near(force.acceleration[axis], back.acceleration[axis]), "{force:?} {back:?}");
            }
            assert!(force.tangent.cross(back.tangent).length() < 1e-4, "{force:?} {back:?}");
        }
        let none = GuideForce::default().unpack();
        assert_eq!((none.acceleration, none.rate, none.along), (Vec3::ZERO, 0.0, 0.0));
        let most = GuideForce::pack(&Force { acceleration: Vec3::splat(-1e9), ..Default::default() });
        assert!((most.unpack().acceleration + MAX_FORCE).abs().max_element() < 40.0);
    }
}
