//! Parameters of the strands.

use super::{
    Knob, Section, Value, ValueKind,
    flags::{FlagValue, OmittedValue, Slot, flag, slot, value, word},
    rows,
    value::*,
};
use crate::settings::Curl;
use tresses::MapCoordinates;
use tresses::groom::{
    grow::{Clumps, Curls, Growth, StrandVariation},
    mannequin::facial::Beard,
};

pub(super) const SECTION: Section = Section {
    key: "style",
    title: "Style",
    about: "Growth of strands for built-in styles, and changes to the strands of groom files.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "style";
    "length" "Length" [style.length] number(PERCENT, 5.0, 100.0),
        regrow, flag(flag("length", "SHARE").common()),
        also("trim hair curves; hair clip length; length scale"),
        "Cuts strands to this fraction of their length.";
    "curl" "Curls" [style.curl] choice::<Curl>(),
        auto, regrow, flag(flag("curl", "NAME").common().first(CURL)
            .about("Curl type, which --set style.curl_radius=8mm and other parameters vary")),
        also("kink; kink type; coil"),
        "Type of curl, from straight to tight coils; the parameters below vary it.";
    "curl_radius" "Curl radius" [style.growth.curls.radius] within(MILLIMETERS, Curls::RADIUS).log(), auto, regrow,
        also("kink amplitude; coil radius"),
        "Radius of the curl around the path of the strand; larger for voluminous hair, 0 for straight hair.";
    "curl_wavelength" "Curl wavelength" [style.growth.curls.wavelength] within(MILLIMETERS, Curls::WAVELENGTH).log(),
        auto, regrow,
        also("kink frequency; curl frequency"),
        "Length of one turn along the strand; shorter is tighter and needs more vertices.";
    "strands" "Strands" [style.growth.strand_count] integer(PLAIN, 1, Growth::MAX_STRANDS, 1),
        auto, regrow, flag(flag("strands", "N").common()),
        also("strand count; hair count; number of strands; curve decimation"),
        "Maximum number of strands drawn; built-in styles grow exactly this many.";
    "grow" "Fill to" [style.grow] integer(PLAIN, 0, Growth::MAX_STRANDS, 1),
        auto, regrow, flag(flag("grow", "N").common()),
        also("interpolate hair curves; children; child strands; render amount; follow hairs; hair generate; hair density"),
        "Number of strands that a groom file is filled to by interpolation; 0 draws only its own strands.";
    "width" "Strand width" [style.growth.diameter] within(MICROMETERS, Growth::DIAMETER).log(),
        auto, regrow, flag(flag("width", "LENGTH").common()),
        also("hair width; diameter root; radius scale; hair radius; fiber radius; hair thickness"),
        "Typical diameter of a drawn strand. Real hair has 50 to 120 µm; fewer strands must be wider.";
    "clump" "Clumping" [style.growth.clumps.strength] within(PERCENT, Clumps::STRENGTH),
        auto, regrow, flag(flag("clump", "STRENGTH")),
        also("clump factor; clump tightness"),
        "Convergence of neighboring strands toward their tips; high for wet or greasy hair.";
    "frizz" "Frizz" [style.growth.variation.frizz] within(MILLIMETERS, StrandVariation::FRIZZ).log(),
        auto, regrow, flag(flag("frizz", "LENGTH")),
        also("roughness uniform; frizz hair curves; hair curves noise; noise magnitude"),
        "Amplitude of fine waves on each strand; roughens the surface.";
    "flyaways" "Flyaways" [style.growth.variation.flyaways] within(PERCENT, StrandVariation::FLYAWAYS),
        auto, regrow, flag(flag("flyaways", "SHARE[,LENGTH]").then(FLYAWAYS)),
        also("fly away; fly-aways"),
        "Fraction of thin strands that stand off far and form a halo in backlight.";
    "tip_width" "Tip width" [style.growth.tip_width] within(PERCENT, Growth::TIP_WIDTH),
        auto, regrow, flag(flag("tip-width", "SHARE")),
        also("hair tip scale; taper; thin tip; tip radius"),
        "Width at the tip relative to the root; low for soft ends, 100 % for a blunt cut.";
    "maps" "Map coordinates" [style.maps] choice::<MapCoordinates>(), advanced, regrow,
        also("uv map; texture coordinates"),
        "Coordinates of maps on the hair of a groom file: the view from above the head, or UVs.";
    "beard" "Beard" [style.face.beard] choice::<Beard>(), regrow, flag(flag("beard", "KIND").common()),
        "Beard on chin and cheeks of the built-in character.";
    "brows" "Brows" [style.face.has_brows] ValueKind::Toggle, regrow,
        "Whether the built-in character has brows.";
    "lashes" "Lashes" [style.face.has_lashes] ValueKind::Toggle, regrow,
        "Whether the built-in character has lashes.";
    "grow_parting" "Parting angle" [style.grow_parting] number(DEGREES, 0.0, 180.0), advanced, regrow,
        also("child parting"),
        "Strands of a file that diverge by more than this are not interpolated: the hair parts there.";
    "guides" "Guides" [style.guides] integer(PLAIN, 1, 1_000_000, 1),
        auto, advanced, regrow, flag(flag("guides", "N|all").common().first(GUIDES)
            .about("Number of simulated strands, which the others follow, or `all`")),
        also("guide count; generated guide density; hair to guide density"),
        "Number of simulated strands, which the others follow; raise it if hair moves too uniformly.";
    "all_guides" "Simulate every strand" [style.all_guides] ValueKind::Toggle, advanced, regrow,
        also("simulate all strands"),
        "Simulates all strands instead of guides; for few strands, or for comparison.";
    "curl_flatness" "Curl flatness" [style.growth.curls.flatness] within(PERCENT, Curls::FLATNESS),
        auto, advanced, regrow,
        "Shape of the curl, from a round helix (0 %) to a wave in one plane (100 %).";
    "curl_start" "Curl start" [style.growth.curls.start] within(PERCENT, Curls::START), auto, advanced, regrow,
        "Position along the strand where curls begin; high for hair that is curled at its ends.";
    "curl_tip" "Curl radius at the tip" [style.growth.curls.tip] within(TIMES, Curls::TIP), auto, advanced, regrow,
        also("factor end"),
        "Radius at the tip relative to the root; above 1 for ends that open.";
    "curl_irregularity" "Curl irregularity" [style.growth.curls.irregularity] within(PERCENT, Curls::IRREGULARITY),
        auto, advanced, regrow,
        "Variation of curls between locks and along the strand; low values look ironed.";
    "curl_coherence" "Curl coherence" [style.growth.curls.coherence] within(PERCENT, Curls::COHERENCE),
        auto, advanced, regrow,
        "Alignment of the curls within a lock; lower is frizzier.";
    "curl_neighbors" "Curl of neighbors" [style.growth.curls.neighbors] within(PERCENT, Curls::NEIGHBORS),
        auto, advanced, regrow,
        "Alignment of the curls of adjacent locks; high for waves that run through the hair.";
    "curl_shrink" "Curl shrinkage" [style.growth.curls.shrink] within(PERCENT, Curls::SHRINK),
        auto, advanced, regrow,
        "At 100 %, strands keep their length and the style gets shorter; at 0 %, the style keeps its outline.";
    "curl_stretch" "Stretch the drawn curl" [style.curl_stretch] ValueKind::Toggle, advanced, regrow,
        "Fits a drawn curl once to the whole strand instead of repeating it.";
    "clump_spacing" "Clump spacing" [style.growth.clumps.spacing] within(MILLIMETERS, Clumps::SPACING).log(),
        auto, advanced, regrow,
        also("clump size; guide distance"),
        "Distance between clumps on the scalp, and so their thickness.";
    "clump_start" "Clump start" [style.growth.clumps.start] within(PERCENT, Clumps::START), auto, advanced, regrow,
        "Position along the strand where clumping begins; below 0, strands leave the scalp together.";
    "clump_lock" "Locks" [style.growth.clumps.lock] within(PERCENT, Clumps::LOCK), auto, advanced, regrow,
        "Convergence of clumps toward their guides, which forms locks; built-in styles only.";
    "strays" "Strays" [style.growth.variation.strays] within(PERCENT, StrandVariation::STRAYS),
        auto, advanced, regrow, flag(flag("strays", "SHARE[,LENGTH]").then(STRAYS)),
        also("stray hairs"),
        "Fraction of strands that stand off slightly near the tip; makes hair less tidy.";
    "stray_distance" "Stray distance" [style.growth.variation.stray] within(MILLIMETERS, StrandVariation::STRAY).log(),
        auto, advanced, regrow,
        also("roughness endpoint; tip spread"),
        "Distance by which strays stand off.";
    "flyaway_distance" "Flyaway distance" [style.growth.variation.flyaway] within(MILLIMETERS, StrandVariation::FLYAWAY).log(),
        auto, advanced, regrow,
        "Distance by which flyaways stand off.";
    "width_variation" "Width variation" [style.growth.width_variation] within(PERCENT, Growth::WIDTH_VARIATION),
        auto, advanced, regrow, flag(flag("width-variation", "SHARE")),
        also("random width"),
        "Variation of width between strands: standard deviation over mean.";
    "seed" "Seed" [style.growth.seed] integer(PLAIN, 0, 9999, 1), auto, advanced, regrow,
        also("random seed"),
        "Random seed; another value gives different strands of the same style.";
};

/// Curl parameters that modify the preset [`Curl`].
pub(crate) const CURLS: [&str; 9] = [
    "style.curl_radius",
    "style.curl_wavelength",
    "style.curl_flatness",
    "style.curl_start",
    "style.curl_tip",
    "style.curl_irregularity",
    "style.curl_coherence",
    "style.curl_neighbors",
    "style.curl_shrink",
];
/// A new curl type resets the parameters that modified the previous one.
const CURL: &[FlagValue] = &[value("style.curl").resets(&CURLS)];

const STRAYS: &[Slot] = &[slot(value("style.stray_distance"), OmittedValue::Kept)];
const FLYAWAYS: &[Slot] = &[slot(value("style.flyaway_distance"), OmittedValue::Kept)];

const GUIDES: &[FlagValue] = &[
    word("all", &[("style.all_guides", Value::Toggle(true))]),
    value("style.guides").sets(&[("style.all_guides", Value::Toggle(false))]),
];
