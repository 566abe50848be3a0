//! Bodies that the caller deforms.

use crate::arrays::{given_matrices, given_points};
use pyo3::prelude::*;
use tresses::{
    glam::{Mat4, Vec3},
    groom::rig::Transform,
};

/// Vertices or joints that deform the body, as passed by the caller.
#[derive(Clone, Default)]
pub struct BodyInput {
    pub skin: Option<Vec<Vec3>>,
    pub joints: Option<Vec<Mat4>>,
}

impl BodyInput {
    /// Converts `skin` and `joints`; `None` without either. Both describe one pose, so a missing one does not keep its last
    /// value.
    pub fn new(skin: Option<&Bound<'_, PyAny>>, joints: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Self>> {
        let skin = skin.map(|skin| given_points(skin, "skin")).transpose()?.map(|(_, points)| points);
        let joints = joints.map(|joints| given_matrices(joints, "joints")).transpose()?;
        Ok((skin.is_some() || joints.is_some()).then_some(Self { skin, joints }))
    }

    /// Returns the input between this one and `other`.
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        let skin = between(self.skin.as_deref(), other.skin.as_deref(), |a, b| a.lerp(*b, t));
        let joints = between(self.joints.as_deref(), other.joints.as_deref(), |a, b| {
            let [a, b] = [a, b].map(|matrix| Transform::from_matrix(*matrix));
            let translation = a.translation.lerp(b.translation, t);
            let (rotation, scale) = (a.rotation.slerp(b.rotation, t), a.scale.lerp(b.scale, t));
            Transform { translation, rotation, scale }.matrix()
        });
        Self { skin, joints }
    }
}

/// Returns `of` for each pair of `from` and `to`; `to` itself without `from`.
fn between<T: Copy>(from: Option<&[T]>, to: Option<&[T]>, of: impl Fn(&T, &T) -> T) -> Option<Vec<T>> {
    let to = to?;
    Some(match from {
        Some(from) => from.iter().zip(to).map(|(a, b)| of(a, b)).collect(),
        None => to.to_vec(),
    })
}
