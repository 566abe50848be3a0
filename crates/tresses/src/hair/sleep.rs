//! Hair that nobody needs to simulate: it has come to rest, or is out of view.
//!
//! **At rest.** Where the head, what it collides with and the physics stay as they are, and no wind blows, a swing dies out
//! at half the rate of the drag. Once one of 5 cm would be smaller than a tenth of a pixel, hair is left as it is: no
//! dispatch, not even of drawn strands, until anything changes. The time is counted, the hair is not asked: reading it
//! back would let two runs sleep in different frames. Hair without drag never sleeps, nor in a space that moves.
//!
//! **Out of view.** Hair whose sphere, a third larger, is out of view is neither simulated nor drawn. When it comes back it
//! has gone with the head, and goes on from there at the speed that it had; where the [space](crate::space) of its poses has
//! moved meanwhile, it is at rest.

use super::HairFrame;
use crate::{Camera, Pose, collide::ColliderPoses, simulate::SimulationParams, space::Space};
use glam::Vec3;

/// A swing that is supposed of hair when everything else comes to rest, metres.
const SWING: f32 = 0.05;
/// What is left of it when hair falls asleep, pixels.
const LEFT: f32 = 0.1;
/// How much larger than the hair at rest the sphere is that must be out of view.
const ROOM: f32 = 1.3;

/// What is known of a head's rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Sleep {
    /// What the frame before was made for.
    last: Option<(Pose, ColliderPoses, SimulationParams, [Space; 2])>,
    /// For how long that has not changed, s.
    still: f32,
    /// Whether hair is at rest and left so.
    pub asleep: bool,
    /// Whether it is out of view.
    pub unseen: bool,
    /// Where the head was when it was seen last, while it is out of view.
    left_at: Option<(Pose, Space)>,
    /// Whether strands were drawn as they are now.
    pub drawn: bool,
}

impl Sleep {
    /// Takes note of a frame of hair that is seen where a pixel is so large, metres: whether it is to be left as it is.
    pub fn rests(&mut self, frame: &HairFrame<'_>, pixel: f32) -> bool {
        let spaces = [frame.space, frame.seen()];
        let same = self.last.as_ref().is_some_and(|(head, colliders, physics, before)| {
            let still = *head == frame.head && *before == spaces;
            still && colliders == frame.colliders && physics == frame.simulation
        });
        if same {
            self.still += frame.dt.max(0.0);
        } else {
            self.still = 0.0;
            self.last = Some((frame.head, frame.colliders.clone(), *frame.simulation, spaces));
        }
        self.asleep = self.still > settled(frame.simulation.drag, pixel);
        self.drawn &= self.asleep;
        self.asleep
    }

    /// Hair is awake.
    pub fn wake(&mut self) {
        *self = Self { unseen: self.unseen, left_at: self.left_at, ..Self::default() };
    }

    /// Takes note of where an unseen head is, and tells how hair that is seen again comes back.
    pub fn carried(&mut self, frame: &HairFrame<'_>) -> Back {
        if self.unseen {
            self.left_at.get_or_insert((frame.head, frame.space));
            return Back::Here;
        }
        match self.left_at.take() {
            Some((_, space)) if !space.is_where(&frame.space) => Back::Elsewhere,
            Some((head, _)) if head != frame.head => Back::Moved,
            _ => Back::Here,
        }
    }
}

/// How hair that was out of view comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Back {
    /// Where it was, or it was not away.
    Here,
    /// With its head, which has moved.
    Moved,
    /// In a space that has moved: at rest.
    Elsewhere,
}

/// After how long nothing of a swing is seen, s.
fn settled(drag: f32, pixel: f32) -> f32 {
    let least = LEFT * pixel.max(1e-4);
    if drag < 0.05 { f32::INFINITY } else { 2.0 / drag * (SWING / least).max(3.0).ln() }
}

/// Whether `camera` sees anything of a sphere around hair, metres.
pub(super) fn sees(camera: &Camera, (middle, radius): (Vec3, f32)) -> bool {
    let clip = camera.projection * camera.view;
    let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
    [w + x, w - x, w + y, w - y, w]
        .iter()
        .all(|plane| plane.dot(middle.extend(1.0)) >= -ROOM * radius * plane.truncate().length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_seen_from_where_it_is() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, std::f32::consts::FRAC_PI_6, [160, 90]);
        let seen = |at: Vec3| sees(&camera, (at, 0.2));
        // At 10 m half the picture is 2.68 m high and 4.76 m wide.
        for (at, there) in [
            (Vec3::new(0.0, 0.0, -10.0), true),
            (Vec3::new(4.9, 0.0, -10.0), true),
            (Vec3::new(5.3, 0.0, -10.0), false),
            (Vec3::new(0.0, 3.2, -10.0), false),
            (Vec3::new(0.0, -2.9, -10.0), true),
            (Vec3::new(0.0, 0.0, 10.0), false),
            (Vec3::new(0.0, 0.0, 0.1), true),
        ] {
            assert_eq!(seen(at), there, "{at}");
        }
    }

    #[test]
    fn hair_sleeps_once_a_swing_cannot_be_seen() {
        let colliders = ColliderPoses::default();
        let physics = SimulationParams::default();
        let frame = |x: f32| HairFrame {
            dt: 0.1,
            head: Pose { translation: Vec3::X * x, ..Pose::IDENTITY },
            colliders: &colliders,
            simulation: &physics,
            ..HairFrame::default()
        };
        let mut sleep = Sleep::default();
        // 2 / 3 ln(500) = 4.1 s.
        let frames = (0..).find(|_| sleep.rests(&frame(0.0), 1e-3)).unwrap();
        assert!((41..=44).contains(&frames), "{frames}");
        assert!(!sleep.rests(&frame(0.1), 1e-3), "a head that moves wakes it");
        assert!(settled(0.0, 1e-3).is_infinite() && settled(3.0, 1e-2) < settled(3.0, 1e-3));
    }
}
