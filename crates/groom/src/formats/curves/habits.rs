//! What exporters do, said once each.

use crate::formats::raw::Raw;

/// What was met on the way, to be said once.
#[derive(Default)]
pub(in crate::formats) struct Habits {
    pub moved: usize,
    /// Objects that a skeleton carries.
    pub bound: usize,
    pub curved: Vec<&'static str>,
    pub closed: usize,
    pub rational: usize,
    pub straightened: usize,
    pub clamped: usize,
    pub guides: usize,
    pub guides_said: bool,
    pub widths: Vec<&'static str>,
    pub without_width: usize,
    pub groups: bool,
    /// Whether the file says anything of its strands.
    pub marked: bool,
    pub misfits: Vec<String>,
}

impl Habits {
    /// Says all of it, and leaves out what only a part of the strands has.
    pub fn tell(self, raw: &mut Raw, objects: usize, how: &str) {
        let mut say = |any: bool, note: String| raw.notes.extend(any.then_some(note));
        say(objects > 1, format!("{objects} objects of curves"));
        say(self.moved > 0, format!("the transforms above {} of them are applied", self.moved));
        let of = if self.bound == 1 { String::new() } else { format!(" of {} objects", self.bound) };
        say(self.bound > 0, format!("curves{of} go with the joints of a skeleton"));
        say(
            !self.curved.is_empty(),
            format!("{} curves are cut into straight pieces", self.curved.join(" and ")),
        );
        say(self.closed > 0, format!("{} objects have closed curves, which are taken as open", self.closed));
        say(
            self.clamped > 0,
            format!(
                "{} objects have curves without knots, which begin and end at their outermost points",
                self.clamped
            ),
        );
        say(self.rational > 0, "weights of rational curves are not used".into());
        say(
            self.straightened > 0,
            format!(
                "{} objects have no knots for their curves: straight from point to point",
                self.straightened
            ),
        );
        let how = if self.guides_said { "groom_guide" } else { how };
        say(self.guides > 0, format!("{} strands are marked as guides ({how})", self.guides));
        say(!self.widths.is_empty(), format!("widths are those of “{}”", self.widths.join("” and “")));
        say(self.without_width > 0 && self.widths.is_empty(), "no widths (Unreal would take 1 cm)".into());
        for misfit in self.misfits {
            say(true, misfit);
        }
        if !self.groups && objects == 1 {
            raw.group_names.clear();
        }
        let strands = &mut raw.strands;
        if !self.marked && objects == 1 {
            strands.marks.clear();
        }
        // What only some objects have is of no use.
        let (curves, vertices) = (strands.len(), strands.positions.len());
        for (what, left_out) in [
            ("colours", cleared(&mut strands.colors, vertices)),
            ("widths", cleared(&mut strands.radii, vertices)),
            ("scalp texture coordinates", cleared(&mut strands.root_uvs, curves)),
        ] {
            if left_out {
                raw.notes.push(format!("not all objects have {what}, so none are used"));
            }
        }
    }
}

/// Clears what has some entries, but not all; whether it did.
fn cleared<T>(some: &mut Vec<T>, all: usize) -> bool {
    let partial = !some.is_empty() && some.len() != all;
    if partial {
        some.clear();
    }
    partial
}
