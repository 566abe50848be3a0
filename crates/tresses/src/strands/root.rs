//! Motion of a guide's root with the skin: written by `roots::guides` and `simulate::step`, read by the stages that
//! follow guides. There is one per guide if roots are on a [deforming surface](crate::roots), else a single unused one.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Motion of a root with the skin relative to the head, at four moments. Each is a transform from groom space to groom
/// space, the identity where the skin moves with the head. Rotations are unit quaternions, translations in meters.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct RootMotion {
    /// Rotation at the start of the last step.
    pub begin_rotation: Quat,
    /// Rotation at the end of the last step, where the next begins.
    pub end_rotation: Quat,
    /// Rotation at the end of the last step of the previous frames.
    pub before_rotation: Quat,
    /// Rotation in this frame.
    pub now_rotation: Quat,
    /// Translation at the start of the last step.
    pub begin_at: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// Translation at the end of the last step.
    pub end_at: Vec3,
    /// Unused.
    pub _pad_b: u32,
    /// Translation at the end of the last step of the previous frames.
    pub before_at: Vec3,
    /// Unused.
    pub _pad_c: u32,
    /// Translation in this frame.
    pub now_at: Vec3,
    /// Unused.
    pub _pad_d: u32,
}
