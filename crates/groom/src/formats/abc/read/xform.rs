//! Transforms: a stack of operations, the outermost first.

use glam::{DMat4, DQuat, DVec3};

use super::{Archive, property::Compound};
use crate::error::Result;

/// Returns the matrix of a transform at `time`, and whether the parent's matrix applies too.
pub(super) fn matrix<'a>(
    archive: &Archive<'_, 'a>,
    xform: &Compound<'a>,
    time: f64,
) -> Result<(DMat4, bool)> {
    let number = |name: &str| match xform.property(archive, name)? {
        Some(property) => property.doubles(archive, time),
        None => Ok(Vec::new()),
    };
    let inherits = number(".inherits")?.first().is_none_or(|flag| *flag != 0.0);
    let (operations, values) = (number(".ops")?, number(".vals")?);
    let mut values = values.into_iter();
    let mut matrix = DMat4::IDENTITY;
    for operation in operations {
        // The upper four bits are the operation, the lower four a hint at its purpose.
        let kind = operation as u8 >> 4;
        let mut take = |default: f64| values.next().unwrap_or(default);
        let mut three = |default: f64| DVec3::new(take(default), take(default), take(default));
        matrix *= match kind {
            0 => DMat4::from_scale(three(1.0)),
            1 => DMat4::from_translation(three(0.0)),
            2 => {
                let axis = three(0.0);
                let angle = values.next().unwrap_or(0.0).to_radians();
                axis.try_normalize()
                    .map_or(DMat4::IDENTITY, |axis| DMat4::from_quat(DQuat::from_axis_angle(axis, angle)))
            }
            // The file's matrices multiply row vectors: their rows are the columns of `DMat4`.
            3 => DMat4::from_cols_array(&std::array::from_fn(|i| take(if i % 5 == 0 { 1.0 } else { 0.0 }))),
            4 => DMat4::from_rotation_x(take(0.0).to_radians()),
            5 => DMat4::from_rotation_y(take(0.0).to_radians()),
            6 => DMat4::from_rotation_z(take(0.0).to_radians()),
            _ => DMat4::IDENTITY,
        };
    }
    Ok((matrix, inherits))
}
