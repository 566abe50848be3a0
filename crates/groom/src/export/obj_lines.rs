//! OBJ polylines: a `v` per vertex, an `l` per strand. Rust prints a float so that it reads back exactly.

use std::fmt::Write;

use super::{Encoded, lost};
use crate::{Strands, import::MARK};

pub(super) fn encode(strands: &Strands, oriented: bool) -> Encoded {
    let mut text = String::from("# Tresses groom\n");
    if oriented {
        text += "# ";
        text += MARK;
        text.push('\n');
    }
    // Writing into a string cannot fail.
    for p in &strands.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for i in 0..strands.len() {
        text.push('l');
        for v in strands.range(i) {
            let _ = write!(text, " {}", v + 1);
        }
        text.push('\n');
    }
    let mut notes = Vec::new();
    lost(&mut notes, !strands.radii.is_empty(), "widths");
    lost(&mut notes, !strands.colors.is_empty(), "colours");
    lost(&mut notes, !strands.root_uvs.is_empty(), "scalp texture coordinates");
    lost(&mut notes, strands.tip_pinned.contains(&true), "the pinned tips");
    lost(&mut notes, strands.has_guides(), "the marks of guides");
    Encoded { bytes: text.into_bytes(), notes }
}
