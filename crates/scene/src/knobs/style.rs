//! Parameters of the strands.

use super::{Knob, Section, knob, value::*};
use crate::settings::Curl;

pub(super) const SECTION: Section = Section {
    key: "style",
    title: "Style",
    about: "How strands are grown on a built-in style, or changed on a groom from files.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "style.strands",
        "Strands",
        integer(PLAIN, 1, 4_000_000, 1),
        Regrow,
        "How many strands are drawn, at most; the built-in styles grow exactly as many.",
        style.strands
    )
    .auto(),
    knob!(
        "style.guides",
        "Guides",
        integer(PLAIN, 1, 1_000_000, 1),
        Regrow,
        "How many strands are simulated, the others following them; more where hair moves too much as one.",
        style.guides
    )
    .auto(),
    knob!(
        "style.all_guides",
        "Simulate every strand",
        Kind::Toggle,
        Regrow,
        "No strand follows others; for few strands, or to compare with.",
        style.all_guides
    ),
    knob!(
        "style.curl",
        "Curls",
        choice::<Curl>(),
        Regrow,
        "The kind of curl that the next parameters vary, from straight to tight.",
        style.curl
    )
    .auto(),
    knob!(
        "style.curl_radius",
        "Curl radius",
        number(MILLIMETRES, 0.0, 100.0),
        Regrow,
        "How far curls stand off the way of the strand; wider for big hair, 0 for straight hair.",
        style.curl_radius
    )
    .log()
    .auto(),
    knob!(
        "style.curl_wavelength",
        "Curl wavelength",
        number(MILLIMETRES, 2.0, 1000.0),
        Regrow,
        "Way along the strand for one turn; shorter is tighter, and takes more vertices.",
        style.curl_wavelength
    )
    .log()
    .auto(),
    knob!(
        "style.curl_flatness",
        "Curl flatness",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "From a round spiral (0) to a wave in one plane (100).",
        style.curl_flatness
    )
    .auto(),
    knob!(
        "style.curl_start",
        "Curl start",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "Where along the strand curls begin; later for hair that was curled at its ends.",
        style.curl_start
    )
    .auto(),
    knob!(
        "style.curl_tip",
        "Curl radius at the tip",
        number(TIMES, 0.0, 3.0),
        Regrow,
        "Radius at the tip against that at the root; above 1 for ends that open.",
        style.curl_tip
    )
    .auto(),
    knob!(
        "style.curl_irregularity",
        "Curl irregularity",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "How far curls differ from lock to lock and wander; less looks ironed.",
        style.curl_irregularity
    )
    .auto(),
    knob!(
        "style.curl_coherence",
        "Curl coherence",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "How far the strands of a lock turn together; less is frizzier.",
        style.curl_coherence
    )
    .auto(),
    knob!(
        "style.curl_neighbours",
        "Curl of neighbours",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "How far a lock turns with the locks around it; high for waves that run through the hair.",
        style.curl_neighbours
    )
    .auto(),
    knob!(
        "style.curl_shrink",
        "Curl shrinkage",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "At 100 strands keep their length and the style gets shorter, at 0 it keeps its outline.",
        style.curl_shrink
    )
    .auto(),
    knob!(
        "style.curl_stretch",
        "Stretch the drawn curl",
        Kind::Toggle,
        Regrow,
        "Lay a drawn curl once over the whole strand instead of repeating it.",
        style.curl_stretch
    ),
    knob!(
        "style.clump",
        "Clumping",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "How far strands run together towards their tips; high for wet or greasy hair.",
        style.clump
    )
    .auto(),
    knob!(
        "style.clump_spacing",
        "Clump spacing",
        number(MILLIMETRES, 1.0, 100.0),
        Regrow,
        "Distance between clumps on the scalp: how thick they are.",
        style.clump_spacing
    )
    .log()
    .auto(),
    knob!(
        "style.clump_start",
        "Clump start",
        number(PERCENT, -100.0, 80.0),
        Regrow,
        "Where along the strand clumping begins; below 0 strands leave the scalp together.",
        style.clump_start
    )
    .auto(),
    knob!(
        "style.clump_lock",
        "Locks",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "How far clumps gather around their guides into locks; built-in styles only.",
        style.clump_lock
    )
    .auto(),
    knob!(
        "style.frizz",
        "Frizz",
        number(MILLIMETRES, 0.0, 20.0),
        Regrow,
        "Height of the fine waves that every strand has of its own; roughens the surface.",
        style.frizz
    )
    .log()
    .auto(),
    knob!(
        "style.strays",
        "Strays",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "Share of strands that stray a little towards the tip; breaks up too tidy hair.",
        style.strays
    )
    .auto(),
    knob!(
        "style.stray_reach",
        "Stray reach",
        number(MILLIMETRES, 0.0, 200.0),
        Regrow,
        "How far strays stray.",
        style.stray_reach
    )
    .log()
    .auto(),
    knob!(
        "style.flyaways",
        "Flyaways",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "Share of strands, thin ones, that stray a lot and make the halo against the light.",
        style.flyaways
    )
    .auto(),
    knob!(
        "style.flyaway_reach",
        "Flyaway reach",
        number(MILLIMETRES, 0.0, 200.0),
        Regrow,
        "How far flyaways stray.",
        style.flyaway_reach
    )
    .log()
    .auto(),
    knob!(
        "style.width",
        "Strand width",
        number(MICROMETRES, 10.0, 5000.0),
        Regrow,
        "Usual diameter of a drawn strand; real hair has 50 to 120, fewer strands must be wider to cover.",
        style.width
    )
    .log()
    .auto(),
    knob!(
        "style.width_variation",
        "Width variation",
        number(PERCENT, 0.0, 50.0),
        Regrow,
        "How much widths differ from strand to strand: standard deviation over mean.",
        style.width_variation
    )
    .auto(),
    knob!(
        "style.tip_width",
        "Tip width",
        number(PERCENT, 0.0, 100.0),
        Regrow,
        "Width at the tip against that at the root; small for soft ends, 100 for a blunt cut.",
        style.tip_width
    )
    .auto(),
    knob!(
        "style.seed",
        "Seed",
        integer(PLAIN, 0, 9999, 1),
        Regrow,
        "Another number, other strands of the same kind.",
        style.seed
    )
    .auto(),
];
