//! `.data`; the layout is described in `import/data.rs`.

use super::{Encoded, lost, put};
use crate::{
    Strands,
    error::{Error, Result},
};

pub(super) fn encode(strands: &Strands, oriented: bool) -> Result<Encoded> {
    let count = |n: usize| {
        let many = || Error::Unusable(format!("{n} are more than a .data file can count"));
        i32::try_from(n).map_err(|_| many())
    };
    let mut bytes = count(strands.len())?.to_le_bytes().to_vec();
    for strand in strands.iter() {
        bytes.extend_from_slice(&count(strand.len())?.to_le_bytes());
        strand.iter().for_each(|p| put(&mut bytes, p.to_array()));
    }
    let mut notes = Vec::new();
    lost(&mut notes, oriented, "unit and axes");
    lost(&mut notes, !strands.radii.is_empty(), "widths");
    lost(&mut notes, !strands.colors.is_empty(), "colours");
    lost(&mut notes, !strands.root_uvs.is_empty(), "scalp texture coordinates");
    lost(&mut notes, strands.tip_pinned.contains(&true), "the pinned tips");
    lost(&mut notes, strands.has_guides(), "the marks of guides");
    Ok(Encoded { bytes, notes })
}
