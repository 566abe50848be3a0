//! Curl of one lock, and the offsets of a strand within it.

use super::Curls;
use crate::random::{Rng, lerp, noise, smoothstep};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Size of the scalp regions whose hair waves together, meters.
const TOGETHER: f32 = 0.05;

/// Maximum length over which a curl grows to its full radius, meters.
const RAMP: f32 = 0.04;

/// Curl parameters that the strands of a lock share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twist {
    /// Radius, meters.
    radius: f32,
    /// Wavelength, meters.
    wavelength: f32,
    /// Handedness, 1 or -1.
    hand: f32,
    /// Phase, radians.
    phase: f32,
    /// Direction of a wave across the path, radians from the sideways axis of the frame.
    plane: f32,
    /// Position where the handedness changes, in turns from the start.
    back: Option<f32>,
    seed: u32,
}

/// Curl variation of one strand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strand {
    /// Phase relative to the lock, radians.
    phase: f32,
    /// Factor on the radius.
    wide: f32,
}

impl Strand {
    /// A strand in phase with its lock.
    pub(crate) const STRICT: Self = Self { phase: 0.0, wide: 1.0 };

    /// Creates a random strand; a `loose` one has a phase independent of its lock.
    pub(crate) fn new(curls: &Curls, loose: bool, rng: &mut Rng) -> Self {
        let phase_spread = if loose { 1.0 } else { 1.0 - curls.coherence };
        Self {
            phase: phase_spread * rng.range(-PI, PI),
            wide: (1.0 + 0.2 * curls.irregularity * rng.bell()).max(0.2),
        }
    }
}

impl Twist {
    /// Chooses the curl of the lock with number `lock`, rooted at `root` (meters).
    pub(crate) fn new(curls: &Curls, seed: u32, lock: u32, root: Vec3) -> Self {
        let mut rng = Rng::new(seed ^ 0xcafe, lock);
        let independence = 1.0 - curls.neighbors;
        let vary = 0.5 * curls.irregularity;
        // Continuous waves need nearly equal wavelengths.
        let radius = curls.radius * rng.range(1.0 - vary, 1.0 + vary);
        let wavelength = curls.wavelength * (1.0 + vary * independence * rng.range(-0.8, 1.0));
        let hand = if rng.unit() < 0.5 * independence { -1.0 } else { 1.0 };
        let field = PI * curls.irregularity * noise(root / TOGETHER, seed ^ 0x77aa);
        Self {
            radius,
            wavelength: wavelength.max(1e-4),
            hand,
            phase: curls.neighbors * field + independence * rng.range(-PI, PI),
            plane: (independence + 0.2 * vary) * rng.range(-0.5 * PI, 0.5 * PI),
            back: (rng.unit() < 0.4 * curls.irregularity * independence).then(|| rng.range(1.0, 5.0)),
            seed: rng.bits(),
        }
    }

    /// Returns the offset of a strand at `arc` meters along a path of `length` meters: x and y in the two directions
    /// across the path, z along it.
    pub(crate) fn offset(&self, curls: &Curls, strand: &Strand, arc: f32, length: f32) -> Vec3 {
        let begin = curls.start * length;
        let distance = arc - begin;
        if distance <= 0.0 || self.radius <= 0.0 {
            return Vec3::ZERO;
        }
        let ramp = self.wavelength.min(RAMP).min(0.5 * length);
        let wander = |feature: f32, salt: u32| {
            let at = distance / (feature * self.wavelength);
            curls.irregularity * noise(Vec3::new(at, 0.37, 0.81), self.seed ^ salt)
        };
        let radius = self.radius
            * strand.wide
            * smoothstep(0.0, ramp, distance)
            * lerp(1.0, curls.tip, (arc / length).min(1.0))
            * (1.0 + 0.5 * wander(1.7, 0x11));
        let mut turns = distance / self.wavelength + 0.3 * wander(2.3, 0x22);
        if let Some(back) = self.back {
            // Where the handedness changes, the curl is straight for a short distance.
            turns = (turns - back).hypot(0.25);
        }
        let angle = TAU * turns + self.phase + strand.phase;
        let (across, along) = match &curls.curve {
            Some(curve) => {
                let (s, span) = match curve.stretched {
                    true => (distance / (length - begin).max(1e-6), length - begin),
                    false => (angle / TAU, self.wavelength),
                };
                let o = curve.at(s);
                (Vec2::new(o.x, self.hand * o.y), o.z * span * radius / (self.radius * curve.length_for(1.0)))
            }
            None => (Vec2::new(angle.cos(), self.hand * (1.0 - curls.flatness) * angle.sin()), 0.0),
        };
        (Vec2::from_angle(self.plane).rotate(across) * radius).extend(along)
    }

    /// Returns the fraction of a path of `length` meters at which a strand of that length ends when it curls along the
    /// path, scaled by [`Curls::shrink`].
    pub(crate) fn fraction(&self, curls: &Curls, strength: f32, length: f32) -> f32 {
        if curls.shrink <= 0.0 || length <= 0.0 {
            return 1.0;
        }
        // Arc length of the curl over a straight path, in steps of a twentieth of a turn.
        let steps = ((20.0 * length / self.wavelength) as usize).clamp(64, 4000);
        let at = |k: usize| {
            let arc = length * k as f32 / steps as f32;
            let o = self.offset(curls, &Strand::STRICT, arc, length) * strength;
            Vec3::new(o.x, o.y, arc + o.z)
        };
        let mut passed = 0.0;
        let mut before = at(0);
        for k in 1..=steps {
            let p = at(k);
            let step = p.distance(before);
            if passed + step >= length {
                let f = (k as f32 - 1.0 + (length - passed) / step) / steps as f32;
                return lerp(1.0, f.min(1.0), curls.shrink);
            }
            passed += step;
            before = p;
        }
        1.0
    }
}
