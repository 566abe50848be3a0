//! Where the skin carries the root of a guide: written by `roots::guides` and `simulate::step`, read by those that
//! follow guides. There is one per guide where roots are on a [living surface](crate::roots), else one that nobody
//! reads.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// How the skin has carried a root beside what the head did, at four moments: from groom space to groom space, the
/// identity where the skin goes with the head. Rotations are unit quaternions, places metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct RootMotion {
    /// When the last step began.
    pub begin_rotation: Quat,
    /// When the last step ended, which is when the next begins.
    pub end_rotation: Quat,
    /// When the last step of the frames before ended.
    pub before_rotation: Quat,
    /// In this frame.
    pub now_rotation: Quat,
    /// See `begin_rotation`.
    pub begin_at: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// See `end_rotation`.
    pub end_at: Vec3,
    /// Unused.
    pub _pad_b: u32,
    /// See `before_rotation`.
    pub before_at: Vec3,
    /// Unused.
    pub _pad_c: u32,
    /// See `now_rotation`.
    pub now_at: Vec3,
    /// Unused.
    pub _pad_d: u32,
}
