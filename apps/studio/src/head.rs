//! Dragging the head: it follows the pointer on a spring and swings back when released.

use tresses::character::Gesture;
use tresses::{
    Pose,
    glam::{Quat, Vec2, Vec3},
    groom::SdfGrid,
};

/// How fast a held head follows, rad/s.
const HELD: f32 = 22.0;
/// How fast a head that is let go swings back, rad/s.
const FREE: f32 = 9.0;
/// Damping of that swing; 1 does not swing.
const FREE_DAMPING: f32 = 0.45;
/// The farthest from its place, metres.
const REACH: f32 = 0.3;
/// The farthest turns, radians: yaw, pitch.
const TURNS: Vec2 = Vec2::new(1.4, 0.7);
/// Skin and the hair that lies on it, metres.
const SKIN: f32 = 0.012;

/// A spring per degree of freedom: where the head is off its place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hand {
    /// How far from the eye it was taken, metres.
    held: Option<f32>,
    /// Metres.
    shift: Spring3,
    /// Yaw, pitch, 0; radians.
    turn: Spring3,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spring3 {
    at: Vec3,
    velocity: Vec3,
    to: Vec3,
}

impl Spring3 {
    /// Semi-implicit steps, small ones whatever `seconds` is.
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

impl Hand {
    /// Takes the head at a point `depth` metres from the eye.
    pub fn take(&mut self, depth: f32) {
        self.held = Some(depth);
    }

    /// Lets it go: it swings back to its place.
    pub fn release(&mut self) {
        self.held = None;
        (self.shift.to, self.turn.to) = (Vec3::ZERO, Vec3::ZERO);
    }

    /// How far from the eye it was taken, metres, while it is held.
    pub fn held(&self) -> Option<f32> {
        self.held
    }

    /// The held head is to be `by` metres farther.
    pub fn drag(&mut self, by: Vec3) {
        self.shift.to = (self.shift.to + by).clamp_length_max(REACH);
    }

    /// The held head is to be turned by `by` more: yaw and pitch, radians.
    pub fn turn(&mut self, by: Vec2) {
        let to = (self.turn.to.truncate() + by).clamp(-TURNS, TURNS);
        self.turn.to = to.extend(0.0);
    }

    /// Whether nothing moves.
    pub fn is_still(&self) -> bool {
        self.shift.is_still() && self.turn.is_still()
    }

    /// `seconds` go by.
    pub fn advance(&mut self, seconds: f32) {
        let (rate, damping) = if self.held.is_some() { (HELD, 1.0) } else { (FREE, FREE_DAMPING) };
        for spring in [&mut self.shift, &mut self.turn] {
            spring.advance(seconds.clamp(0.0, 0.25), rate, damping);
            if self.held.is_none() && spring.is_still() {
                *spring = Spring3::default();
            }
        }
    }

    /// `gesture`, as the hand has it: it shifts the body, and turns the head about `pivot` (groom space, metres).
    pub fn apply(&self, mut gesture: Gesture, pivot: Vec3) -> Gesture {
        let [yaw, pitch, _] = self.turn.at.to_array();
        let turn = Pose::about(pivot, Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch));
        gesture.head = gesture.head.after(&turn);
        gesture.body.translation += self.shift.at;
        gesture
    }
}

/// How far along a ray (`eye`, unit `direction`, world) the head at `pose` is, metres.
pub fn hit(field: &SdfGrid, pose: &Pose, eye: Vec3, direction: Vec3) -> Option<f32> {
    let back = pose.inverse();
    let (origin, along) = (back.point(eye), back.rotation * direction);
    let mut t = 0.0;
    for _ in 0..200 {
        let distance = field.sample(origin + along * t) - SKIN;
        if distance < 5e-4 {
            return Some(t);
        }
        t += distance;
        if t > 20.0 {
            break;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_follows_swings_and_comes_to_rest_where_it_was() {
        let mut hand = Hand::default();
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
        assert!(hand.is_still() && hand == Hand::default());
    }

    #[test]
    fn long_frames_do_not_blow_it_up() {
        let mut hand = Hand::default();
        hand.take(1.0);
        hand.drag(Vec3::X);
        for _ in 0..20 {
            hand.advance(3.0);
            assert!(hand.apply(Gesture::default(), Vec3::ZERO).rigid().translation.x <= REACH + 1e-3);
        }
    }

    #[test]
    fn rays_meet_a_head_where_it_is() {
        let field = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - 0.1);
        let pose = Pose { translation: Vec3::X, ..Pose::IDENTITY };
        let t = hit(&field, &pose, Vec3::new(1.0, 0.0, 2.0), Vec3::NEG_Z);
        assert!((t.unwrap() - (1.9 - SKIN)).abs() < 5e-3, "{t:?}");
        assert_eq!(hit(&field, &Pose::IDENTITY, Vec3::new(1.0, 0.0, 2.0), Vec3::NEG_Z), None);
    }
}
