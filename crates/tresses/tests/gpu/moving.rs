//! Hair on a moving head, and its vertices with and without strand collision.
#![allow(dead_code)]

use crate::common;
use tresses::{
    AvoidMode, AvoidOptions, Context, HairOptions, Pose,
    glam::{Quat, Vec3},
    groom::{Groom, SdfGrid},
    low_level::{Hair, HairFrame, Recorder, StrandState, StrandVertex, readback::blocking as readback},
};

/// Times in seconds and yaw in degrees, as in the command's motions.
pub type Keys = &'static [(f32, f32)];
/// To one side, to the other, and back.
pub const TURN: Keys =
    &[(0.0, 0.0), (0.30, 45.0), (0.80, 45.0), (1.30, -45.0), (1.90, -45.0), (2.20, 0.0), (3.0, 0.0)];
/// Twice to either side.
pub const SHAKE: Keys =
    &[(0.0, 0.0), (0.20, 30.0), (0.50, -30.0), (0.80, 30.0), (1.10, -30.0), (1.30, 0.0), (2.0, 0.0)];

/// Returns the yaw at time `t`, radians.
pub fn angle(keys: Keys, t: f32) -> f32 {
    let k = keys.partition_point(|key| key.0 <= t).clamp(1, keys.len() - 1);
    let (a, b) = (keys[k - 1], keys[k]);
    let s = ((t - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
    (a.1 + (b.1 - a.1) * s * s * s * (10.0 + s * (6.0 * s - 15.0))).to_radians()
}

/// A groom and its head.
pub struct Character {
    pub groom: Groom,
    pub field: SdfGrid,
    /// Joint about which the head turns.
    pub neck: Vec3,
}

impl Character {
    pub fn hair(&self, context: &Context, avoid: AvoidOptions) -> Hair {
        let options = HairOptions { avoid, ..Default::default() };
        common::hair(context, &self.groom, &options, Some(&self.field)).unwrap()
    }

    /// Returns the pose of the head turned by `angle` radians.
    pub fn head(&self, angle: f32) -> Pose {
        Pose::about(self.neck, Quat::from_rotation_y(angle))
    }

    /// Returns the distances of all strand vertices from the head at rest, meters.
    pub fn rest_distances(&self) -> Vec<f32> {
        let strands = &self.groom.strands;
        let rest = (0..strands.len()).flat_map(|i| strands.rest_positions(i));
        rest.map(|p| self.field.sample(p)).collect()
    }
}

/// Advances the hair by `dt` seconds.
pub fn advance(context: &Context, hair: &mut Hair, head: Pose, dt: f32) {
    record(context, head, dt, |recorder, frame| recorder.advance(hair, frame).unwrap());
}

/// Returns the strands of the current guides in `mode`. With [`AvoidMode::ChangeOver`], returns the result of the last
/// [`advance`]. The state of strand collision does not change.
pub fn drawn(context: &Context, hair: &mut Hair, head: Pose, mode: AvoidMode) -> Vec<StrandVertex> {
    if mode != AvoidMode::ChangeOver {
        let before = std::mem::replace(&mut hair.avoidance.options.mode, mode);
        record(context, head, 0.0, |recorder, frame| recorder.follow(hair, frame).unwrap());
        hair.avoidance.options.mode = before;
    }
    readback::buffer(context, &hair.strands.vertices).unwrap()
}

/// Runs only the search for first hits.
pub fn search(context: &Context, hair: &Hair) -> Vec<StrandState> {
    common::compute(context, |pass| hair.avoidance.record_search(pass, &hair.colliders, &hair.strands));
    states(context, hair)
}

pub fn states(context: &Context, hair: &Hair) -> Vec<StrandState> {
    readback::buffer(context, hair.avoidance.states()).unwrap()
}

fn record(context: &Context, head: Pose, dt: f32, what: impl FnOnce(&mut Recorder<'_>, &HairFrame<'_>)) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut recorder = context.recorder(&mut encoder);
    what(&mut recorder, &common::frame(head, dt));
    context.queue().submit([encoder.finish()]);
}
