//! Parameters of antialiasing.

use super::{Knob, Section, knob, value::*};
use crate::settings::{CoverageMode, Samples};

pub(super) const SECTION: Section = Section {
    key: "edges",
    title: "Edges",
    about: "How finely pictures are sampled, and how strands thinner than a pixel cover it.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "edges.samples",
        "Samples per pixel",
        choice::<Samples>(),
        Rebuild,
        "More for smoother edges with mask and alpha; not every adapter has more than 4.",
        edges.samples
    )
    .auto(),
    knob!(
        "edges.coverage",
        "Coverage",
        choice::<CoverageMode>(),
        Rebuild,
        "Sorted layers (peel, finest), a mask of samples (fastest), or alpha to coverage.",
        edges.coverage
    )
    .auto(),
    knob!(
        "edges.layers",
        "Peeled layers",
        integer(PLAIN, 1, 16, 1),
        Rebuild,
        "Layers of hair in order, a pass each (peel only); more for light, thin hair.",
        edges.layers
    ),
    knob!(
        "edges.ssaa",
        "Supersampling",
        integer(TIMES, 1, 2, 1),
        Rebuild,
        "Pixels drawn per pixel shown, along each axis; 2 costs four times as much.",
        edges.ssaa
    ),
    knob!(
        "edges.min_width",
        "Least width",
        number(PIXELS, 0.0, 10.0),
        Frame,
        "Thinner strands are drawn this wide and as much sparser (mask only).",
        edges.min_width
    ),
];
