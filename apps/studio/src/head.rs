//! Dragging the head: it follows the pointer on a spring and swings back when released.

use tresses::Gesture;
use tresses::{
    Pose,
    glam::{Quat, Vec2, Vec3},
    groom::SdfGrid,
};

/// Natural frequency of the spring while the head is held, rad/s.
const HELD: f32 = 22.0;
/// Natural frequency of the spring after release, rad/s.
const FREE: f32 = 9.0;
/// Damping ratio after release; 1 is critical damping.
const FREE_DAMPING: f32 = 0.45;
/// Largest displacement from the rest position, meters.
const MAX_SHIFT: f32 = 0.3;
/// Largest yaw and pitch, radians.
const MAX_ROTATION: Vec2 = Vec2::new(1.4, 0.7);
/// Thickness of skin and flat hair, added to the head for picking, meters.
const SKIN: f32 = 0.012;

/// Displacement of the head from its animated pose: one spring per degree of freedom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadSpring {
    /// Distance from the eye to the grabbed point, meters, while held.
    held: Option<f32>,
    /// Translation, meters.
    shift: Spring3,
    /// Yaw, pitch, 0; radians.
    rotation: Spring3,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spring3 {
    at: Vec3,
    velocity: Vec3,
    to: Vec3,
}

impl Spring3 {
    /// Semi-implicit Euler with steps of 1/240 s, at most 64 of them.
    fn advance(&mut self, seconds: f32, rate: f32, damping: f32) {
        let steps = (seconds * 240.0).ceil().clamp(1.0, 64.0);
        let h = seconds / steps;
        for _ in 0..steps as u32 {
            self.velocity += h * (rate * rate * (self.to - self.at) - 2.0 * damping * rate * self.velocity);
            self.at += h * self.velocity;
        }
    }

    fn is_still(&self) -> bool {
        (self.at - self.to).length() < 1e-4 && self.velocity.length() < 1e-3
    }
}

impl HeadSpring {
    /// Grabs the head at a point `depth` meters from the eye.
    pub fn take(&mut self, depth: f32) {
        self.held = Some(depth);
    }

    /// Releases the head; it swings back to its rest position.
    pub fn release(&mut self) {
        self.held = None;
        (self.shift.to, self.rotation.to) = (Vec3::ZERO, Vec3::ZERO);
    }

    /// Returns the distance from the eye to the grabbed point, meters, while held.
    pub fn held(&self) -> Option<f32> {
        self.held
    }

    /// Moves the target of a held head by `by`, meters.
    pub fn drag(&mut self, by: Vec3) {
        self.shift.to = (self.shift.to + by).clamp_length_max(MAX_SHIFT);
    }

    /// Turns the target of a held head by `by`: yaw and pitch, radians.
    pub fn rotate(&mut self, by: Vec2) {
        let to = (self.rotation.to.truncate() + by).clamp(-MAX_ROTATION, MAX_ROTATION);
        self.rotation.to = to.extend(0.0);
    }

    /// Whether all springs are at rest.
    pub fn is_still(&self) -> bool {
        self.shift.is_still() && self.rotation.is_still()
    }

    /// Advances the springs by `seconds`.
    pub fn advance(&mut self, seconds: f32) {
        let (rate, damping) = if self.held.is_some() { (HELD, 1.0) } else { (FREE, FREE_DAMPING) };
        for spring in [&mut self.shift, &mut self.rotation] {
            spring.advance(seconds.clamp(0.0, 0.25), rate, damping);
            if self.held.is_none() && spring.is_still() {
                *spring = Spring3::default();
            }
        }
    }

    /// Adds the displacement to `gesture`: shifts the body and turns the head about `pivot` (groom space, meters).
    pub fn apply(&self, mut gesture: Gesture, pivot: Vec3) -> Gesture {
        let [yaw, pitch, _] = self.rotation.at.to_array();
        let rotation = Pose::about(pivot, Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch));
        gesture.head = gesture.head.after(&rotation);
        gesture.body.translation += self.shift.at;
        gesture
    }
}

/// Returns the distance along a ray (`eye`, unit `direction`, world space) to the head at `pose`, meters.
pub fn hit(field: &SdfGrid, pose: &Pose, eye: Vec3, direction: Vec3) -> Option<f32> {
    let back = pose.inverse();
    let (origin, along) = (back.point(eye), back.rotation * direction);
    field.trace(origin, along, SKIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn released_head_swings_back_to_rest() {
        let mut hand = HeadSpring::default();
        hand.take(1.0);
        hand.drag(Vec3::X * 0.1);
        for _ in 0..60 {
            hand.advance(1.0 / 60.0);
        }
        let pivot = Vec3::Y * 1.5;
        assert!((hand.apply(Gesture::default(), pivot).rigid().translation.x - 0.1).abs() < 1e-3);
        hand.release();
        let mut least = 0.0f32;
        for _ in 0..300 {
            hand.advance(1.0 / 60.0);
            least = least.min(hand.apply(Gesture::default(), pivot).rigid().translation.x);
        }
        assert!(least < -0.005, "it swings past its place: {least}");
        assert!(hand.is_still() && hand == HeadSpring::default());
    }

    #[test]
    fn spring_is_stable_for_long_frames() {
        let mut hand = HeadSpring::default();
        hand.take(1.0);
        hand.drag(Vec3::X);
        for _ in 0..20 {
            hand.advance(3.0);
            assert!(hand.apply(Gesture::default(), Vec3::ZERO).rigid().translation.x <= MAX_SHIFT + 1e-3);
        }
    }

    #[test]
    fn ray_hits_the_head_at_its_pose() {
        let field = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - 0.1);
        let pose = Pose { translation: Vec3::X, ..Pose::IDENTITY };
        let t = hit(&field, &pose, Vec3::new(1.0, 0.0, 2.0), Vec3::NEG_Z);
        assert!((t.unwrap() - (1.9 - SKIN)).abs() < 5e-3, "{t:?}");
        assert_eq!(hit(&field, &Pose::IDENTITY, Vec3::new(1.0, 0.0, 2.0), Vec3::NEG_Z), None);
    }
}
