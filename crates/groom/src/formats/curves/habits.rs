//! Notes on the curves of a file, one per observation.

use crate::formats::raw::Raw;

/// Observations while a file is read, for one note each.
#[derive(Default)]
pub(in crate::formats) struct CurveWarnings {
    pub transformed: usize,
    /// Objects bound to a skeleton.
    pub bound: usize,
    pub curved: Vec<&'static str>,
    pub closed: usize,
    pub rational: usize,
    pub straightened: usize,
    pub clamped: usize,
    pub guides: usize,
    pub has_guide_attribute: bool,
    pub widths: Vec<&'static str>,
    pub without_width: usize,
    pub groups: bool,
    /// Whether any object has guides, ids, groups or closest guides.
    pub marked: bool,
    pub misfits: Vec<String>,
}

impl CurveWarnings {
    /// Adds the notes to `raw` and drops attributes that only some strands have. `how` says by what the reader
    /// recognized guides.
    pub fn tell(self, raw: &mut Raw, objects: usize, how: &str) {
        let mut say = |any: bool, note: String| raw.notes.extend(any.then_some(note));
        say(objects > 1, format!("{objects} curve objects"));
        say(self.transformed > 0, format!("the transforms of {} objects are applied", self.transformed));
        let of = if self.bound == 1 { String::new() } else { format!(" of {} objects", self.bound) };
        say(self.bound > 0, format!("curves{of} follow the joints of a skeleton"));
        say(
            !self.curved.is_empty(),
            format!("{} curves are converted to polylines", self.curved.join(" and ")),
        );
        say(self.closed > 0, format!("closed curves in {} objects are read as open curves", self.closed));
        say(
            self.clamped > 0,
            format!("curves without knots in {} objects are read as clamped at both ends", self.clamped),
        );
        say(self.rational > 0, "weights of rational curves are ignored".into());
        say(
            self.straightened > 0,
            format!("curves without knots in {} objects are read as polylines", self.straightened),
        );
        let how = if self.has_guide_attribute { "groom_guide" } else { how };
        say(self.guides > 0, format!("{} strands are marked as guides ({how})", self.guides));
        say(!self.widths.is_empty(), format!("widths are read from “{}”", self.widths.join("” and “")));
        say(self.without_width > 0 && self.widths.is_empty(), "no widths (Unreal would use 1 cm)".into());
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
        // Drop attributes that only some objects have.
        let (curves, vertices) = (strands.len(), strands.positions.len());
        for (what, left_out) in [
            ("colors", cleared(&mut strands.colors, vertices)),
            ("widths", cleared(&mut strands.radii, vertices)),
            ("scalp texture coordinates", cleared(&mut strands.root_uvs, curves)),
        ] {
            if left_out {
                raw.notes.push(format!("{what} are ignored: not all objects have them"));
            }
        }
        strands.attributes.retain(|attribute| {
            let is_complete = attribute.fits(curves, vertices);
            let name = &attribute.name;
            raw.notes.extend((!is_complete).then(|| format!("“{name}” is ignored: not all objects have it")));
            is_complete
        });
    }
}

/// Clears a list that has entries, but fewer than `all`. Returns whether it did.
fn cleared<T>(some: &mut Vec<T>, all: usize) -> bool {
    let partial = !some.is_empty() && some.len() != all;
    if partial {
        some.clear();
    }
    partial
}
