//! A 3-D texture placed in the world, for density, push and air.

use crate::Pose;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// Value of a texel that a view shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// A channel, 0 to 3.
    Channel(u32),
    /// The length of the vector in the first three channels.
    Length,
}

/// A 3-D texture placed in the world, in a filterable format.
#[derive(Clone, Copy, Debug)]
pub struct GridView<'a> {
    /// The texture.
    pub(crate) texture: &'a wgpu::TextureView,
    /// Frame of the grid. A point `x` in it has the texture coordinate `x * scale + bias`.
    pub(crate) pose: Pose,
    /// Texture coordinates per meter.
    pub(crate) scale: Vec3,
    /// Texture coordinate of the frame's origin.
    pub(crate) bias: Vec3,
    /// Value of a texel that is shown.
    pub(crate) quantity: Quantity,
    /// Whether vectors are in the grid's frame and turn with its pose. Otherwise they are in world axes.
    pub(crate) rotates: bool,
}

impl GridView<'_> {
    /// Returns the world position of a texture coordinate, meters.
    pub fn world(&self, coordinate: Vec3) -> Vec3 {
        self.pose.point((coordinate - self.bias) / self.scale)
    }

    /// Lengths of the box's edges, meters.
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
            rotates: u32::from(self.rotates),
            bias: self.bias,
            _pad: 0,
        }
    }
}

/// Shader data of a [`GridView`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GridUniform {
    /// Rotation from the grid's frame to the world, a unit quaternion.
    pub rotation: Quat,
    /// Translation from the grid's frame to the world, meters.
    pub translation: Vec3,
    /// Channel, or 4 for the length of the first three.
    pub quantity: u32,
    /// [`GridView::scale`].
    pub scale: Vec3,
    /// [`GridView::rotates`].
    pub rotates: u32,
    /// [`GridView::bias`].
    pub bias: Vec3,
    /// Unused.
    pub _pad: u32,
}
