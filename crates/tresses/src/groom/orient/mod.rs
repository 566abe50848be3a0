//! Units, up axis, facing and mirroring: what the user says, and a guess with reasons for the rest.

mod choice;
mod placement;

pub use choice::{Axis, Choice, Unit};
pub use placement::Placement;

use super::{
    Strands,
    import::{ImportOptions, mesh::RawMesh},
};

fn plain(choice: &Choice) -> Placement {
    Placement {
        unit: choice.unit.unwrap_or(Unit(1.0)),
        up: choice.up.unwrap_or(Axis::Y),
        front: choice.front.unwrap_or(Axis::Z),
        mirrored: choice.mirror.unwrap_or(false),
        ..Default::default()
    }
}

/// How a groom without a head comes into metres, Y up, face +Z.
pub fn groom(_strands: &Strands, _declared: bool, choice: &Choice) -> Placement {
    plain(choice)
}

/// How a head without a groom comes into metres, Y up, face +Z.
pub fn head(_head: &RawMesh, choice: &Choice) -> Placement {
    plain(choice)
}

/// How a groom and the head it grows on come into metres, Y up, face +Z.
pub fn pair(
    _strands: &Strands,
    _declared: bool,
    _head: &RawMesh,
    options: &ImportOptions,
) -> (Placement, Placement) {
    (plain(&options.orient), plain(&options.orient_head))
}
