//! A 3-D texture with a place in the world: what density, push and air have in common.

use crate::Pose;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Which number of a texel is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A channel, 0 to 3.
    Channel(u32),
    /// The length of the vector in the first three channels.
    Length,
}

/// A 3-D texture in the world, in a filterable format.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// The texture.
    pub texture: &'a wgpu::TextureView,
    /// The frame of the grid; a point `x` of it has the texture coordinate `x * scale + bias`.
    pub pose: Pose,
    /// Texture coordinates per metre.
    pub scale: Vec3,
    /// Texture coordinate of the frame's origin.
    pub bias: Vec3,
    /// What is shown of a texel.
    pub quantity: Quantity,
    /// Whether vectors are along the grid's axes, to be turned with its pose, or the world's.
    pub turns: bool,
}

impl Grid<'_> {
    /// A texture coordinate in the world.
    pub fn world(&self, coordinate: Vec3) -> Vec3 {
        self.pose.point((coordinate - self.bias) / self.scale)
    }

    /// The lengths of the box's edges, metres.
    pub fn extent(&self) -> Vec3 {
        1.0 / self.scale
    }

    pub(super) fn uniform(&self) -> GridUniform {
        GridUniform {
            rotation: self.pose.rotation,
            translation: self.pose.translation,
            quantity: match self.quantity {
                Quantity::Channel(channel) => channel.min(3),
                Quantity::Length => 4,
            },
            scale: self.scale,
            turns: u32::from(self.turns),
            bias: self.bias,
            _pad: 0,
        }
    }
}

/// What the shaders know of a [`Grid`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GridUniform {
    /// Unit quaternion: the grid's frame to the world.
    pub rotation: Quat,
    /// Metres.
    pub translation: Vec3,
    /// A channel, or 4 for the length of the first three.
    pub quantity: u32,
    /// [`Grid::scale`].
    pub scale: Vec3,
    /// [`Grid::turns`].
    pub turns: u32,
    /// [`Grid::bias`].
    pub bias: Vec3,
    /// Unused.
    pub _pad: u32,
}
