//! Poses of the colliders at every moment of a frame.

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

/// Pose and bounding sphere of a collider, in GPU layout.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PoseData {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Translation, meters.
    pub translation: Vec3,
    /// Radius of the bounding sphere, meters.
    pub bound: f32,
    /// Center of the bounding sphere, world space, meters.
    pub center: Vec3,
    /// Unused.
    pub _pad: f32,
}

impl PoseData {
    /// Returns the data of a collider at `pose`, whose bounding sphere has this `center` and radius in the collider's
    /// frame.
    pub fn new(pose: &Pose, center: Vec3, bound: f32) -> Self {
        let Pose { rotation, translation } = *pose;
        Self { rotation, translation, bound, center: pose.point(center), _pad: 0.0 }
    }
}

/// Header of the buffer of poses. The poses at drawing time follow, then the poses at each moment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PoseHead {
    /// Time between moments, s.
    pub interval: f32,
    /// Index of the last moment.
    pub moments: u32,
    /// Number of colliders. It is here and not with the shapes, which are a uniform: Mesa's software driver compiles
    /// uniforms that decide loops into the program. Where it unrolls such a loop, it compiles a new program for every
    /// dispatch and keeps the old ones.
    pub count: u32,
    /// Half of each tile of the [deformations](super::deform) that belongs to this frame: 0 or 1.
    pub side: u32,
}

/// Parameters of a frame's collider motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<'a> {
    /// The frame's fixed steps.
    pub steps: &'a [Step],
    /// Substeps per step.
    pub substeps: u32,
    /// Length of a step, s.
    pub step: f32,
    /// Current pose of the head, as it is drawn.
    pub head: Pose,
    /// Interpolation factor of the drawn state between the states before and after the last step.
    pub alpha: f32,
}

/// Motion per fixed step, meters, above which a collider teleports and pushes nothing on its way.
pub(super) const JUMP: f32 = 0.3;
/// Rotation per fixed step, radians, above which a collider teleports.
pub(super) const JUMP_ANGLE: f32 = 1.0;

/// Transforms from a frame's space to the space of the simulation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Journey {
    /// Current pose of the head, in the frame's space.
    pub head: Pose,
    /// From the space of the poses to the space of the steps.
    pub passage: Passage,
}

/// Motion of a set of colliders from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    anchors: Vec<Anchor>,
    /// Poses relative to their anchors at the end of the last step; `None` before the first.
    state: Option<Vec<Pose>>,
    /// Poses relative to the head before and after the last step.
    before: Vec<Pose>,
    after: Vec<Pose>,
    /// Poses at drawing time.
    pub now: Vec<Pose>,
    /// Poses of all moments, collider fastest.
    pub moments: Vec<Pose>,
}

impl Track {
    /// Replaces the colliders. Those at the same index in both lists continue from their current poses. If the set has
    /// the head's field, the first anchor is that field's.
    pub fn replace(&mut self, anchors: Vec<Anchor>) {
        let count = anchors.len();
        for poses in [&mut self.before, &mut self.after, &mut self.now] {
            poses.resize(count, Pose::IDENTITY);
        }
        // The last frame's moments belong to other colliders.
        self.moments = vec![Pose::IDENTITY; count];
        if let Some(state) = &mut self.state {
            // A collider with another anchor counts as new.
            let same = self.anchors.iter().zip(&anchors).take_while(|(a, b)| a == b).count();
            state.truncate(same);
        }
        self.anchors = anchors;
    }

    /// Converts the state to another space, in which poses are given from here on.
    pub fn enter(&mut self, map: &Map) {
        for (pose, anchor) in self.state.iter_mut().flatten().zip(&self.anchors) {
            if *anchor == Anchor::World {
                *pose = map.pose(pose);
            }
        }
    }

    /// Moves the colliders by one frame, to `poses` at its end.
    ///
    /// # Errors
    /// [`Error::Colliders`] if the number of poses does not match the colliders, or a pose is not finite.
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
                "{} poses were given for {need} colliders",
                poses.colliders.len()
            )));
        }
        if let Some(i) = own.iter().position(|p| !(p.translation.is_finite() && p.rotation.is_normalized())) {
            return Err(Error::Colliders(format!(
                "the pose of collider {i} is not a finite position and a unit rotation"
            )));
        }
        if let Some(state) = &mut self.state {
            // A new collider starts at its current pose.
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
    use crate::clock::StepClock;

    impl Track {
        /// Advances in a space that is the world.
        fn go(&mut self, has_head: bool, poses: &ColliderPoses, frame: &Moments<'_>) -> Result<()> {
            self.advance(has_head, poses, frame, &Journey { head: frame.head, passage: Passage::default() })
        }
    }

    /// Drives a track with a clock at `fps` and calls `see` after each frame.
    fn drive(fps: f32, seconds: f32, mut see: impl FnMut(&Track, &[Step], f32, Pose)) {
        let mut clock = StepClock::default();
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
    fn moments_are_continuous_at_any_frame_rate() {
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
                // Colliders on the head are drawn at the head, others one step behind it.
                assert!(track.now[0].translation.distance(head.translation) < 1e-6);
                if t > 0.2 {
                    let then = t - 1.0 / 60.0;
                    let relative =
                        Pose { rotation: Quat::from_rotation_y(then), translation: Vec3::X * 0.3 * then };
                    let hand = Pose { rotation: Quat::from_rotation_z(then), translation: Vec3::Z * then };
                    let expected = head.after(&relative.inverse().after(&hand));
                    let off = track.now[1].translation.distance(expected.translation);
                    assert!(off < 2e-4, "{fps} fps, {t} s: {off}");
                    // The test would detect a hand drawn at its current pose.
                    assert!(Vec3::Z.distance(Vec3::ZERO) * (t - then) > 0.01);
                }
            });
        }
    }

    #[test]
    fn jumps_have_no_velocity_and_wrong_counts_return_errors() {
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
        assert!(error.contains("0 poses were given for 1"), "{error}");
        assert!(track.go(false, &at(f32::NAN), &frame).is_err());
    }

    #[test]
    fn colliders_can_be_added_and_removed() {
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
        // In a frame without steps, a new collider is drawn at its given pose.
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
