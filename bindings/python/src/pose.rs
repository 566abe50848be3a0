//! Rigid poses: 4 × 4 matrices, or translation and quaternion.

use crate::{TressesError, arrays::given_floats};
use pyo3::prelude::*;
use tresses::{
    Pose,
    glam::{Mat3, Mat4, Quat, Vec3},
};

/// Tolerance for rotation matrices, and for the length of quaternions.
const TOLERANCE: f32 = 1e-3;

/// A pose in Python: translation (meters) and quaternion (x, y, z, w). The numbers are exact.
pub type PoseTuple = ([f32; 3], [f32; 4]);

/// Converts a pose to Python.
pub fn pose_to_tuple(pose: &Pose) -> PoseTuple {
    (pose.translation.to_array(), pose.rotation.to_array())
}

/// Converts a pose from Python. Errors call the argument `what`.
pub fn pose(of: &Bound<'_, PyAny>, what: &str) -> PyResult<Pose> {
    let refuse = |why: &str| TressesError::new_err(format!("{what} {why}"));
    let pair = of.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>();
    let pose = match pair {
        Ok((translation, rotation)) => {
            let (shape, numbers) = given_floats(&rotation, what)?;
            let rotation = Quat::from_array(<[f32; 4]>::try_from(numbers).unwrap_or([f32::NAN; 4]));
            if shape != [4] || !rotation.is_finite() || (rotation.length() - 1.0).abs() > TOLERANCE {
                return Err(refuse("must have a quaternion (x, y, z, w) of length 1"));
            }
            let unit = rotation.normalize();
            // Keep unit quaternions unchanged, so that poses from `pose_to_tuple` round-trip bit-identically.
            let rotation = if (rotation.length_squared() - 1.0).abs() < 1e-6 { rotation } else { unit };
            Pose { rotation, translation: vector(&translation, what)? }
        }
        Err(_) => {
            let (shape, values) = given_floats(of, what)?;
            let rows = <[f32; 16]>::try_from(values).ok().filter(|_| shape == [4, 4]);
            let rows = rows.ok_or_else(|| {
                refuse("must be a matrix [4, 4], or a translation of 3 and a quaternion of 4 numbers (x, y, z, w)")
            })?;
            let matrix = Mat4::from_cols_array(&rows).transpose();
            let rotation = Mat3::from_mat4(matrix);
            let square = rotation * rotation.transpose() - Mat3::IDENTITY;
            let off = square.to_cols_array().iter().fold(0.0, |max: f32, v| max.max(v.abs()));
            let last = (matrix.row(3) - tresses::glam::Vec4::W).abs().max_element();
            let is_rigid = off < TOLERANCE && last < TOLERANCE && rotation.determinant() > 0.0;
            if !is_rigid {
                return Err(refuse("must be a rigid matrix, with rotation and translation only"));
            }
            Pose { rotation: Quat::from_mat3(&rotation).normalize(), translation: matrix.w_axis.truncate() }
        }
    };
    if pose.translation.is_finite() { Ok(pose) } else { Err(refuse("must have a finite translation")) }
}

/// Converts a point or direction from Python. Errors call the argument `what`.
pub fn vector(of: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec3> {
    let (shape, values) = given_floats(of, what)?;
    let vector = Vec3::from_array(<[f32; 3]>::try_from(values).unwrap_or([f32::NAN; 3]));
    if shape == [3] && vector.is_finite() {
        return Ok(vector);
    }
    Err(TressesError::new_err(format!("{what} must be 3 finite numbers")))
}
