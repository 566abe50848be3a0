//! The poses of the colliders at every moment of a frame.

use super::{Anchor, ColliderPoses};
use crate::{
    Error, Pose, Result,
    clock::{Mode, Step},
    math::map::Map,
    math::rotation::nlerp,
    space::Passage,
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Where a collider is, as the GPU reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Place {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Metres.
    pub translation: Vec3,
    /// Radius of its bounding sphere, metres.
    pub bound: f32,
    /// Centre of its bounding sphere, world, metres.
    pub center: Vec3,
    /// Unused.
    pub _pad: f32,
}

impl Place {
    /// A collider whose bounding sphere has its `center` and radius in the collider's frame, at `pose`.
    pub fn new(pose: &Pose, center: Vec3, bound: f32) -> Self {
        let Pose { rotation, translation } = *pose;
        Self { rotation, translation, bound, center: pose.point(center), _pad: 0.0 }
    }
}

/// The header of the buffer of places; after it come those at drawing, then those of the moments.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PlacesHead {
    /// Time between moments, s.
    pub interval: f32,
    /// The number of the last moment.
    pub moments: u32,
    /// The number of colliders. Not with the shapes, which are a uniform: Mesa's software driver puts uniforms that decide
    /// loops into the program, and where that unrolls a loop of several turns it compiles the program anew, and keeps the
    /// old one, for every dispatch.
    pub count: u32,
    /// Which half of each tile of the [deformations](super::deform) is that of this frame: 0 or 1.
    pub side: u32,
}

/// What the places of a frame depend on.
#[derive(Clone, Copy, Debug)]
pub struct Moments<'a> {
    /// The frame's fixed steps.
    pub steps: &'a [Step],
    /// Substeps of each.
    pub substeps: u32,
    /// Length of a step, s.
    pub step: f32,
    /// Where the head is now, as it is drawn.
    pub head: Pose,
    /// How far what is drawn lies from the state before the last step to the one after it.
    pub alpha: f32,
}

/// A collider that moves farther in one fixed step, metres, has jumped: it pushes nothing on its way.
pub(super) const JUMP: f32 = 0.3;
/// The same for a turn, radians.
pub(super) const JUMP_ANGLE: f32 = 1.0;

/// How what is given in a frame's space gets to where hair is simulated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Journey {
    /// Where the head is now, as it is given.
    pub head: Pose,
    /// From the space of poses to that of the steps.
    pub passage: Passage,
}

/// The motion of a set of colliders from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    anchors: Vec<Anchor>,
    /// Poses relative to their anchors at the end of the last step; none before the first.
    state: Option<Vec<Pose>>,
    /// Poses relative to the head before and after the last step.
    before: Vec<Pose>,
    after: Vec<Pose>,
    /// Poses at drawing.
    pub now: Vec<Pose>,
    /// Poses of all moments, collider fastest.
    pub moments: Vec<Pose>,
}

impl Track {
    /// Other colliders from here on, but those whose places are in both lists go on from where they
    /// are. The first anchor is the head's where the set has its field.
    pub fn replace(&mut self, anchors: Vec<Anchor>) {
        let count = anchors.len();
        for poses in [&mut self.before, &mut self.after, &mut self.now] {
            poses.resize(count, Pose::IDENTITY);
        }
        // Those of the last frame are of other colliders.
        self.moments = vec![Pose::IDENTITY; count];
        if let Some(state) = &mut self.state {
            // An anchor that is another one makes another collider of it.
            let same = self.anchors.iter().zip(&anchors).take_while(|(a, b)| a == b).count();
            state.truncate(same);
        }
        self.anchors = anchors;
    }

    /// Poses are given in another space from here on, to which `map` leads.
    pub fn enter(&mut self, map: &Map) {
        for (pose, anchor) in self.state.iter_mut().flatten().zip(&self.anchors) {
            if *anchor == Anchor::World {
                *pose = map.pose(pose);
            }
        }
    }

    /// Moves to where `poses` says the colliders are at the end of the frame.
    ///
    /// # Errors
    /// [`Error::Colliders`] when there are not as many poses as colliders, or one is not finite.
    pub fn advance(
        &mut self,
        has_head: bool,
        poses: &ColliderPoses,
        frame: &Moments<'_>,
        journey: &Journey,
    ) -> Result<()> {
        let own: Vec<_> = has_head
            .then(|| poses.head.unwrap_or(Pose::IDENTITY))
            .into_iter()
            .chain(poses.colliders.iter().copied())
            .collect();
        if own.len() != self.anchors.len() {
            let need = self.anchors.len() - usize::from(has_head);
            return Err(Error::Colliders(format!(
                "{} poses do not place {need} colliders",
                poses.colliders.len()
            )));
        }
        if let Some(i) = own.iter().position(|p| !(p.translation.is_finite() && p.rotation.is_normalized())) {
            return Err(Error::Colliders(format!(
                "the pose of collider {i} is no finite position and rotation"
            )));
        }
        if let Some(state) = &mut self.state {
            // What is new has been where it is now.
            for (i, pose) in own.iter().enumerate().skip(state.len()) {
                state.push(*pose);
                let relative = match self.anchors[i] {
                    Anchor::Head => *pose,
                    Anchor::World => journey.head.inverse().after(pose),
                };
                (self.before[i], self.after[i]) = (relative, relative);
            }
        }
        let jump = frame.steps.iter().any(|s| s.mode != Mode::Step);
        let steps = frame.steps.len().max(1) as f32;
        let start: Vec<_> = match &self.state {
            Some(state) if !jump => {
                let jumps = |a: &Pose, b: &Pose| {
                    a.translation.distance(b.translation) > JUMP * steps
                        || a.rotation.angle_between(b.rotation) > JUMP_ANGLE * steps
                };
                state.iter().zip(&own).map(|(a, b)| if jumps(a, b) { *b } else { *a }).collect()
            }
            _ => own.clone(),
        };
        if let (Some(first), Some(last)) = (frame.steps.first(), frame.steps.last()) {
            let at = |i: usize, f: f32, head: &Pose| {
                let own = if f >= 1.0 { own[i] } else { start[i].lerp(&own[i], f) };
                if self.anchors[i] == Anchor::Head {
                    head.after(&own)
                } else {
                    journey.passage.at(f).pose(&own)
                }
            };
            let all = 0..own.len();
            self.moments.clear();
            self.moments.extend(all.clone().map(|i| at(i, first.from, &first.begin)));
            for step in frame.steps {
                for sub in 1..=frame.substeps {
                    let t = sub as f32 / frame.substeps as f32;
                    let head = Pose {
                        rotation: nlerp(step.begin.rotation, step.end.rotation, t),
                        translation: step.begin.translation.lerp(step.end.translation, t),
                    };
                    let (f, head) =
                        if jump { (1.0, step.end) } else { (step.from + (step.to - step.from) * t, head) };
                    self.moments.extend(all.clone().map(|i| at(i, f, &head)));
                }
            }
            if jump {
                self.moments
                    .splice(..own.len(), all.clone().map(|i| at(i, 1.0, &last.end)).collect::<Vec<_>>());
            }
            let relative = |f: f32, head: &Pose| -> Vec<Pose> {
                let to_head = head.inverse();
                let one = |i: usize| {
                    let own = if f >= 1.0 { own[i] } else { start[i].lerp(&own[i], f) };
                    if self.anchors[i] == Anchor::Head {
                        own
                    } else {
                        to_head.after(&journey.passage.at(f).pose(&own))
                    }
                };
                all.clone().map(one).collect()
            };
            self.before = if jump { relative(1.0, &last.end) } else { relative(last.from, &last.begin) };
            self.after = relative(if jump { 1.0 } else { last.to }, &last.end);
            self.state =
                Some(all.map(|i| if jump { own[i] } else { start[i].lerp(&own[i], last.to) }).collect());
        }
        let drawn = self.before.iter().zip(&self.after);
        self.now = drawn.map(|(a, b)| frame.head.after(&a.lerp(b, frame.alpha))).collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Clock;

    impl Track {
        /// Moves on in a space that is the world.
        fn go(&mut self, has_head: bool, poses: &ColliderPoses, frame: &Moments<'_>) -> Result<()> {
            self.advance(has_head, poses, frame, &Journey { head: frame.head, passage: Passage::default() })
        }
    }

    /// Drives a track with a clock at `fps`; calls `see` after each frame.
    fn drive(fps: f32, seconds: f32, mut see: impl FnMut(&Track, &[Step], f32, Pose)) {
        let mut clock = Clock::default();
        let mut track = Track::default();
        track.replace(vec![Anchor::Head, Anchor::World]);
        let pose = |t: f32| Pose { rotation: Quat::from_rotation_y(t), translation: Vec3::X * 0.3 * t };
        for i in 0..=(seconds * fps) as u32 {
            let t = i as f32 / fps;
            let head = pose(t);
            let ticks = clock.tick(1.0 / fps, 1.0 / 60.0, &head);
            let frame =
                Moments { steps: &ticks.steps, substeps: 4, step: 1.0 / 60.0, head, alpha: ticks.alpha };
            let hand = Pose { rotation: Quat::from_rotation_z(t), translation: Vec3::Z * t };
            track.go(true, &ColliderPoses { head: None, colliders: vec![hand] }, &frame).unwrap();
            see(&track, &ticks.steps, t, head);
        }
    }

    #[test]
    fn moments_follow_each_other_without_gaps_at_any_frame_rate() {
        for fps in [24.0, 60.0, 90.0, 144.0] {
            let mut end: Option<Pose> = None;
            drive(fps, 1.0, |track, steps, t, head| {
                if t > 0.0 && !steps.is_empty() {
                    assert_eq!(track.moments.len(), 2 * (1 + 4 * steps.len()));
                    let hands: Vec<_> = track.moments.iter().skip(1).step_by(2).collect();
                    if let Some(end) = end {
                        assert!(hands[0].translation.distance(end.translation) < 1e-6);
                    }
                    for pair in hands.windows(2) {
                        let way = pair[1].translation.z - pair[0].translation.z;
                        assert!((way - 1.0 / 240.0).abs() < 2e-5, "{fps}: {way}");
                    }
                    end = hands.last().map(|p| **p);
                }
                // What follows the head is drawn at the head, what does not one step behind it.
                assert!(track.now[0].translation.distance(head.translation) < 1e-6);
                if t > 0.2 {
                    let then = t - 1.0 / 60.0;
                    let relative =
                        Pose { rotation: Quat::from_rotation_y(then), translation: Vec3::X * 0.3 * then };
                    let hand = Pose { rotation: Quat::from_rotation_z(then), translation: Vec3::Z * then };
                    let expected = head.after(&relative.inverse().after(&hand));
                    let off = track.now[1].translation.distance(expected.translation);
                    assert!(off < 2e-4, "{fps} fps, {t} s: {off}");
                    // A hand drawn where it is now would be seen.
                    assert!(Vec3::Z.distance(Vec3::ZERO) * (t - then) > 0.01);
                }
            });
        }
    }

    #[test]
    fn jumps_have_no_speed_and_wrong_counts_are_refused() {
        let mut track = Track::default();
        track.replace(vec![Anchor::World]);
        let still = Pose::IDENTITY;
        let step = Step { mode: Mode::Step, begin: still, end: still, from: 0.0, to: 1.0 };
        let frame = Moments { steps: &[step], substeps: 2, step: 1.0 / 60.0, head: still, alpha: 1.0 };
        let at = |x: f32| ColliderPoses {
            head: None,
            colliders: vec![Pose { translation: Vec3::X * x, ..still }],
        };
        track.go(false, &at(0.0), &frame).unwrap();
        track.go(false, &at(0.1), &frame).unwrap();
        assert!((track.moments[1].translation.x - 0.05).abs() < 1e-6);
        track.go(false, &at(5.0), &frame).unwrap();
        assert!(track.moments.iter().all(|p| p.translation.x == 5.0));
        let error = track.go(false, &ColliderPoses::default(), &frame).unwrap_err().to_string();
        assert!(error.contains("0 poses do not place 1"), "{error}");
        assert!(track.go(false, &at(f32::NAN), &frame).is_err());
    }

    #[test]
    fn colliders_come_and_go() {
        let mut track = Track::default();
        track.replace(vec![Anchor::World]);
        let still = Pose::IDENTITY;
        let steps = [Step { mode: Mode::Step, begin: still, end: still, from: 0.0, to: 1.0 }];
        let frame = |steps| Moments { steps, substeps: 1, step: 1.0 / 60.0, head: still, alpha: 0.5 };
        let at = |places: &[f32]| ColliderPoses {
            head: None,
            colliders: places.iter().map(|x| Pose { translation: Vec3::X * *x, ..still }).collect(),
        };
        track.go(false, &at(&[0.0]), &frame(&steps)).unwrap();
        track.replace(vec![Anchor::World; 2]);
        // In a frame without steps it is drawn where it is.
        track.go(false, &at(&[0.1, 7.0]), &frame(&[])).unwrap();
        assert_eq!(track.now[1].translation.x, 7.0);
        track.go(false, &at(&[0.1, 7.1]), &frame(&steps)).unwrap();
        let x: Vec<_> = track.moments.iter().map(|p| p.translation.x).collect();
        assert_eq!(x, [0.0, 7.0, 0.1, 7.1]);
        track.replace(vec![Anchor::World]);
        track.go(false, &at(&[0.2]), &frame(&steps)).unwrap();
        assert_eq!(track.moments.iter().map(|p| p.translation.x).collect::<Vec<_>>(), [0.1, 0.2]);
    }
}
