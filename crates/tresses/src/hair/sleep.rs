//! Skips simulation for hair that has come to rest or is out of view.
//!
//! **At rest.** While head, colliders and physics do not change and there is no wind, a swing decays at half the rate
//! of the drag. Once a swing of initially 5 cm would be smaller than a tenth of a pixel, the hair sleeps: nothing is
//! dispatched, not even for drawn strands, until an input changes. The decision counts time and reads nothing back,
//! since read-back would let two runs fall asleep in different frames. Hair without drag never sleeps, nor does hair in
//! a moving space.
//!
//! **Out of view.** Hair whose bounding sphere, enlarged by 30 %, is out of view is neither simulated nor drawn. When
//! it comes back it has been carried with the head and continues at its last velocity. If the [space](crate::space) of
//! its poses has moved meanwhile, it starts at rest.

use super::HairFrame;
use crate::{Camera, Pose, collide::ColliderPoses, simulate::SimulationParams, space::Space};
use glam::Vec3;

/// Amplitude of the swing assumed when all inputs come to rest, meters.
const SWING: f32 = 0.05;
/// Amplitude at which hair falls asleep, pixels.
const LEFT: f32 = 0.1;
/// Factor on the bounding sphere that must be out of view.
const BOUNDS_SCALE: f32 = 1.3;

/// Sleep state of one groom.
#[derive(Clone, Debug, Default)]
pub(super) struct Sleep {
    /// Inputs of the last frame.
    last: Option<(Pose, ColliderPoses, SimulationParams, [Space; 2])>,
    /// Time since the inputs last changed, s.
    still: f32,
    /// Whether the hair is asleep.
    pub asleep: bool,
    /// Whether the hair is out of view.
    pub out_of_view: bool,
    /// Pose of the head and its space when the hair left the view; `None` while it is in view.
    left_at: Option<(Pose, Space)>,
    /// Whether the drawn strands are up to date.
    pub drawn: bool,
}

impl Sleep {
    /// Updates the state from a frame and returns whether the hair sleeps. `pixel` is the height of a pixel at the
    /// hair, meters.
    pub fn rests(&mut self, frame: &HairFrame<'_>, pixel: f32) -> bool {
        let spaces = [frame.space, frame.drawn_space()];
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

    /// Wakes the hair.
    pub fn wake(&mut self) {
        *self = Self { out_of_view: self.out_of_view, left_at: self.left_at, ..Self::default() };
    }

    /// Records the head's pose while the hair is out of view. Returns how the hair comes back.
    pub fn reentry(&mut self, frame: &HairFrame<'_>) -> Reentry {
        if self.out_of_view {
            self.left_at.get_or_insert((frame.head, frame.space));
            return Reentry::InPlace;
        }
        match self.left_at.take() {
            Some((_, space)) if !space.is_where(&frame.space) => Reentry::AtRest,
            Some((head, _)) if head != frame.head => Reentry::WithHead,
            _ => Reentry::InPlace,
        }
    }
}

/// How hair that was out of view comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reentry {
    /// Continues in place, or was never out of view.
    InPlace,
    /// Carried with its head, which has moved.
    WithHead,
    /// At rest, because its space has moved.
    AtRest,
}

/// Returns the time after which a swing is invisible, s.
fn settled(drag: f32, pixel: f32) -> f32 {
    let min_amplitude = LEFT * pixel.max(1e-4);
    if drag < 0.05 { f32::INFINITY } else { 2.0 / drag * (SWING / min_amplitude).max(3.0).ln() }
}

/// Whether any part of a sphere (center and radius, meters), enlarged by [`BOUNDS_SCALE`], is in view of `camera`.
pub(super) fn is_sphere_in_view(camera: &Camera, (center, radius): (Vec3, f32)) -> bool {
    let clip = camera.projection * camera.view;
    let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
    [w + x, w - x, w + y, w - y, w]
        .iter()
        .all(|plane| plane.dot(center.extend(1.0)) >= -BOUNDS_SCALE * radius * plane.truncate().length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sphere_visibility_matches_frustum() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, std::f32::consts::FRAC_PI_6, [160, 90]);
        let seen = |at: Vec3| is_sphere_in_view(&camera, (at, 0.2));
        // At 10 m half the image is 2.68 m high and 4.76 m wide.
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
    fn hair_sleeps_once_swing_is_invisible() {
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
