//! Hair on a moving head, and its vertices with and without strand collision.

use crate::common;
use tresses::{
    AvoidMode, AvoidOptions, HairOptions, Pose,
    glam::{Quat, Vec3},
    groom::{BindOptions, Groom, SdfGrid, bind},
    low_level::{Hair, StrandState, StrandVertex, lod, readback::blocking as readback},
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

/// A groom, with its strands in the order in which `Hair` stores them, and its head.
pub struct Character {
    pub groom: Groom,
    pub field: SdfGrid,
    /// Joint about which the head turns.
    pub neck: Vec3,
}

impl Character {
    pub fn new(mut groom: Groom, field: SdfGrid, neck: Vec3) -> Self {
        lod::arrange(&mut groom.strands);
        Self { groom, field, neck }
    }

    /// Creates strands that hang from a ball of radius 9 cm.
    pub fn on_a_ball(strands: usize, length: f32, options: &BindOptions) -> Self {
        let groom = bind(&common::hanging(strands, 16, length), options).unwrap();
        Self::new(groom, common::ball(0.09, 64), Vec3::new(0.0, 0.0, -0.02))
    }

    /// Creates a built-in style.
    pub fn built_in(style: &str, strands: u32) -> Self {
        let built = common::character(style, strands).expect("there is a GPU");
        Self::new(built.groom.clone(), built.field.clone(), built.neck)
    }

    pub fn hair(&self, options: &HairOptions) -> Hair {
        let context = common::context().expect("there is a GPU");
        common::hair(context, &self.groom, options, Some(&self.field)).unwrap()
    }

    /// Returns hair with these options of strand collision.
    pub fn avoiding(&self, avoid: AvoidOptions) -> Hair {
        self.hair(&HairOptions { avoid, ..Default::default() })
    }

    /// Returns the pose of the head turned by `angle` radians.
    pub fn head(&self, angle: f32) -> Pose {
        Pose::about(self.neck, Quat::from_rotation_y(angle))
    }

    /// Returns the positions of all strand vertices at rest.
    pub fn rest(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.groom.strands.len()).flat_map(|i| self.groom.strands.rest_positions(i))
    }

    /// Returns the distances of all strand vertices from the head at rest, meters.
    pub fn rest_distances(&self) -> Vec<f32> {
        self.rest().map(|p| self.field.sample(p)).collect()
    }
}

/// Advances the hair by `dt` seconds.
pub fn advance(hair: &mut Hair, head: Pose, dt: f32) {
    common::advance(hair, &common::frame(head, dt));
}

/// Advances the hair by the frame `i` at `fps`, with a first frame of no duration.
pub fn advance_at(hair: &mut Hair, head: Pose, i: u32, fps: f32) {
    advance(hair, head, if i == 0 { 0.0 } else { 1.0 / fps });
}

/// Returns the strands of the current guides in `mode`. With [`AvoidMode::ChangeOver`], returns the result of the last
/// [`advance`]. The state of strand collision does not change.
pub fn drawn(hair: &mut Hair, head: Pose, mode: AvoidMode) -> Vec<StrandVertex> {
    if mode != AvoidMode::ChangeOver {
        let before = std::mem::replace(&mut hair.avoidance.options.mode, mode);
        common::submit(|recorder| recorder.follow(hair, &common::frame(head, 0.0)));
        hair.avoidance.options.mode = before;
    }
    common::vertices(hair)
}

/// Runs only the search for first hits.
pub fn search(hair: &Hair) -> Vec<StrandState> {
    let context = common::context().expect("there is a GPU");
    common::compute(context, |pass| hair.avoidance.record_search(pass, &hair.colliders, &hair.strands));
    states(hair)
}

pub fn states(hair: &Hair) -> Vec<StrandState> {
    readback::buffer(common::context().expect("there is a GPU"), hair.avoidance.states()).unwrap()
}
