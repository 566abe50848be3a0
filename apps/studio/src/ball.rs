//! A ball that falls on the head and rolls off through the hair. The coupling is one-way: the ball pushes hair and
//! bounces off the head, but hair does not affect its path.

use tresses::Bounds;
use tresses::{Pose, glam::Vec3, groom::SdfGrid};

/// Radius, meters.
pub const RADIUS: f32 = 0.035;
/// Initial gap between ball and hair, meters.
const ABOVE: f32 = 0.12;
/// Initial horizontal offset from the center, meters, so that the ball rolls off.
const CENTER_OFFSET: f32 = 0.03;
/// The ball is removed this far below the subject, meters.
const BELOW: f32 = 0.12;
/// Gravity, m/s².
const GRAVITY: f32 = 9.81;
/// Coefficient of restitution.
const BOUNCE: f32 = 0.3;
/// Tangential damping while in contact, 1/s.
const ROLLING: f32 = 0.6;
/// Longest time step, seconds. At 6 m/s the ball moves a third of its radius per step.
const STEP: f32 = 1.0 / 500.0;

/// A falling or rolling ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Center, world space, meters.
    pub at: Vec3,
    /// Velocity, m/s.
    velocity: Vec3,
    /// Height below which the ball is removed, meters.
    floor: f32,
}

impl Ball {
    /// Returns ball `number` above `subject`. Each number starts in a different direction from the center.
    pub fn dropped(subject: Bounds, number: u32) -> Self {
        let (lo, hi) = subject;
        // Multiples of the golden angle never repeat.
        let (sin, cos) = (number as f32 * 2.399_963 + 0.6).sin_cos();
        let top = Vec3::new(0.5 * (lo.x + hi.x), hi.y + ABOVE + RADIUS, 0.5 * (lo.z + hi.z));
        let at = top + CENTER_OFFSET * Vec3::new(sin, 0.0, cos);
        Self { at, velocity: Vec3::ZERO, floor: lo.y - BELOW }
    }

    /// Returns the ball `seconds` later, or `None` once it has fallen below the subject. `solids` are the distance
    /// fields (meters) that it collides with, and their poses.
    pub fn advanced(mut self, seconds: f32, solids: &[(&SdfGrid, Pose)]) -> Option<Self> {
        let steps = (seconds / STEP).ceil().max(1.0);
        let h = seconds / steps;
        for _ in 0..steps as u32 {
            self.velocity.y -= GRAVITY * h;
            self.at += self.velocity * h;
            for (field, pose) in solids {
                self.touch(field, pose, h);
            }
        }
        (self.at.y > self.floor).then_some(self)
    }

    fn touch(&mut self, field: &SdfGrid, pose: &Pose, h: f32) {
        let local = pose.inverse().point(self.at);
        let gap = field.sample(local) - RADIUS;
        if gap > 0.0 {
            return;
        }
        let normal = pose.rotation * field.normal(local);
        self.at -= normal * gap;
        let into = self.velocity.dot(normal);
        if into < 0.0 {
            let along = self.velocity - normal * into;
            self.velocity = along * (1.0 - ROLLING * h) - normal * into * BOUNCE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBJECT: Bounds = (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1));

    #[test]
    fn ball_falls_with_gravity() {
        let ball = Ball::dropped(SUBJECT, 0);
        let later = ball.advanced(0.2, &[]).unwrap();
        let fallen = ball.at.y - later.at.y;
        assert!((fallen - 0.5 * GRAVITY * 0.04).abs() < 0.003, "{fallen}");
        assert_eq!(ball.advanced(1.0, &[]), None, "it leaves the picture");
    }

    #[test]
    fn ball_leaves_the_mannequin_within_two_seconds() {
        use tresses::groom::mannequin;
        let field = SdfGrid::from_fn(Vec3::splat(-0.4), Vec3::splat(0.4), 96, mannequin::distance);
        let subject = (Vec3::new(-0.13, -0.2, -0.15), Vec3::new(0.13, 0.25, 0.13));
        for number in 0..12 {
            let mut ball = Some(Ball::dropped(subject, number));
            let mut frames = 0;
            while let Some(now) = ball {
                ball = now.advanced(1.0 / 60.0, &[(&field, Pose::IDENTITY)]);
                frames += 1;
            }
            println!("{number}: {frames}");
            assert!(frames < 120, "{number}: {frames} frames of 1/60 s");
        }
    }

    #[test]
    fn ball_rolls_off_without_entering_the_head() {
        let middle = Vec3::new(0.0, 1.55, 0.0);
        let field = SdfGrid::from_fn(Vec3::new(-0.3, 1.2, -0.3), Vec3::new(0.3, 1.9, 0.3), 64, |p| {
            p.distance(middle) - 0.12
        });
        let pose = Pose::IDENTITY;
        for number in 0..5 {
            let mut ball = Some(Ball::dropped(SUBJECT, number));
            let mut frames = 0;
            while let Some(now) = ball {
                assert!(now.at.distance(middle) > 0.12 + RADIUS - 2e-3, "{number}: {now:?}");
                ball = now.advanced(1.0 / 60.0, &[(&field, pose)]);
                frames += 1;
                assert!(frames < 600, "it comes off: {now:?}");
            }
            assert!(frames > 15);
        }
    }
}
