//! Growth parameters.

use super::{Curls, ScalpPaint};
use crate::MAX_STRAND_VERTICES;
use crate::bound::covering_radius;
use crate::scalp::ScalpMap;
use crate::styles::{Curly, Style};
use crate::{Error, Result, range, range::Range};

/// Kinds of strands to grow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StrandKind {
    /// Strands around single guides.
    Clump,
    /// Strands between three guides.
    Multi,
    /// Both kinds.
    #[default]
    Both,
}

/// Clump and lock parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clumps {
    /// Distance between clump centers on the scalp, meters.
    pub spacing: f32,
    /// Strength of convergence at the tip, 0 to 1.
    pub strength: f32,
    /// Fraction of the length at which convergence begins; below 0 for strands that converge from the root on.
    pub start: f32,
    /// Pull of strands toward their heaviest guide at the tip, 0 to 1 (locks).
    pub lock: f32,
    /// Spread of clump-based strands around their guide at the tip, relative to the root.
    pub tip_spread: f32,
}

impl Clumps {
    /// The range of [`spacing`](Self::spacing).
    pub const SPACING: Range = range!("clump spacing", 0.0 to 1.0, "m"; usually 0.001 to 0.1);
    /// The range of [`strength`](Self::strength).
    pub const STRENGTH: Range = range!("clump strength", 0.0 to 1.0);
    /// The range of [`start`](Self::start).
    pub const START: Range = range!("clump start", -10.0 to 1.0; usually -1.0 to 0.8);
    /// The range of [`lock`](Self::lock).
    pub const LOCK: Range = range!("lock strength", 0.0 to 1.0);

    fn check(&self) -> Result<()> {
        const SPREAD: Range = range!("clump tip spread", 0.0 to 1.0);
        SPREAD.check(self.tip_spread)?;
        Self::SPACING.check(self.spacing)?;
        Self::STRENGTH.check(self.strength)?;
        Self::START.check(self.start)?;
        Self::LOCK.check(self.lock)
    }

    /// Returns the clumps that suit `curls`. Round curls are visible if a lock of about a centimeter, no thicker than
    /// the curl is wide, winds as one from near its root. Waves run continuously and change the clumps little.
    pub fn curled(self, curls: &Curls) -> Self {
        let round = 1.0 - curls.flatness;
        let mix = |a: f32, b: f32| a + (b - a) * round;
        Self {
            spacing: mix(self.spacing.max(0.007), (1.45 * curls.radius).clamp(0.005, 0.016)),
            strength: mix(self.strength.max(0.7), 0.97),
            start: mix(self.start, -0.4),
            lock: mix(self.lock, 0.1),
            tip_spread: mix(self.tip_spread, 0.8),
        }
    }
}

/// Random variation of single strands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandVariation {
    /// Amplitude of the fine waves of every strand, meters.
    pub frizz: f32,
    /// Fraction of strands that stray slightly, at the tip only.
    pub strays: f32,
    /// Deviation of strays, meters.
    pub stray: f32,
    /// Fraction of strands that stray far; these are thin.
    pub flyaways: f32,
    /// Deviation of flyaways, meters.
    pub flyaway: f32,
    /// Maximum shortening of strands relative to their guides, as a fraction.
    pub shorter: f32,
}

impl StrandVariation {
    /// The range of [`frizz`](Self::frizz).
    pub const FRIZZ: Range = range!("frizz", 0.0 to 1.0, "m"; usually 0.0 to 0.02);
    /// The range of [`strays`](Self::strays).
    pub const STRAYS: Range = range!("share of strays", 0.0 to 1.0);
    /// The range of [`stray`](Self::stray).
    pub const STRAY: Range = range!("stray", 0.0 to 1.0, "m"; usually 0.0 to 0.2);
    /// The range of [`flyaways`](Self::flyaways).
    pub const FLYAWAYS: Range = range!("share of flyaways", 0.0 to 1.0);
    /// The range of [`flyaway`](Self::flyaway).
    pub const FLYAWAY: Range = range!("flyaway", 0.0 to 1.0, "m"; usually 0.0 to 0.2);

    pub(crate) fn check(&self) -> Result<()> {
        const SHORTER: Range = range!("shortening", 0.0 to 1.0);
        SHORTER.check(self.shorter)?;
        Self::FRIZZ.check(self.frizz)?;
        Self::STRAYS.check(self.strays)?;
        Self::STRAY.check(self.stray)?;
        Self::FLYAWAYS.check(self.flyaways)?;
        Self::FLYAWAY.check(self.flyaway)
    }
}

/// Parameters for growing strands from guides. The number of strands comes from maps, as in a groom made by hand, or is
/// one exact total.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Kinds of strands to grow.
    pub kind: StrandKind,
    /// Exact number of strands, before [`paint`](Self::paint) thins them out; `None` to use the counts and maps.
    pub strand_count: Option<u32>,
    /// Fraction of clump-based strands if the total is given and both kinds grow.
    pub clump_fraction: f32,
    /// Strands per guide where the map is 1.
    pub clump_count: u32,
    /// Strands per triangle of guides where the map is 1.
    pub multi_count: u32,
    /// Density of clump-based strands over the scalp; `None` for a density that fades at the hairline.
    pub clump_map: Option<ScalpMap>,
    /// Density of multi-strands (the green channel of the map in Tariq and Bavoil 2008); `None` as above.
    pub density_map: Option<ScalpMap>,
    /// Thickness of strands (the red channel of that map), 1 for the full width; `None` for strands that are finer at
    /// the hairline.
    pub thickness_map: Option<ScalpMap>,
    /// Vertices per strand, 2 to 64.
    pub vertex_count: u32,
    /// Diameter of a strand, meters; `None` for 80 µm at 100,000 strands and more for fewer strands, so that they cover
    /// as much.
    pub diameter: Option<f32>,
    /// Standard deviation of the diameter, as a fraction.
    pub width_variation: f32,
    /// Fraction of the length at which strands begin to taper.
    pub taper_start: f32,
    /// Width at the tip, as a fraction of the full width.
    pub tip_width: f32,
    /// Clumps and locks.
    pub clumps: Clumps,
    /// Curls of all strands; each clump is a lock.
    pub curls: Curls,
    /// Maps on top of the above. They only take away: `strand_count` is the number before the painted density.
    pub paint: ScalpPaint,
    /// Random variation of single strands.
    pub variation: StrandVariation,
    /// Minimum distance of strands from the skin, meters.
    pub clearance: f32,
    /// Seed of every random choice.
    pub seed: u32,
}

impl Default for Growth {
    fn default() -> Self {
        Self::for_style(&Style::default())
    }
}

impl Growth {
    /// The range of [`diameter`](Self::diameter).
    pub const DIAMETER: Range = range!("diameter", 0.0 to 1.0, "m"; usually 1e-5 to 0.005);
    /// The range of [`width_variation`](Self::width_variation).
    pub const WIDTH_VARIATION: Range = range!("width variation", 0.0 to 1.0; usually 0.0 to 0.5);
    /// The range of [`tip_width`](Self::tip_width).
    pub const TIP_WIDTH: Range = range!("tip width", 0.0 to 1.0);
    /// Maximum of [`strand_count`](Self::strand_count): more than any adapter holds today, and few enough to be grown
    /// in memory.
    pub const MAX_STRANDS: u32 = 4_000_000;

    /// Returns the growth that suits `style`.
    pub fn for_style(style: &Style) -> Self {
        let base = Self {
            kind: StrandKind::Both,
            strand_count: Some(20_000),
            clump_fraction: 0.3,
            clump_count: 80,
            multi_count: 45,
            clump_map: None,
            density_map: None,
            thickness_map: None,
            vertex_count: 32,
            diameter: None,
            width_variation: 0.13,
            taper_start: 0.45,
            tip_width: 0.25,
            clumps: Clumps { spacing: 0.0055, strength: 0.8, start: 0.05, lock: 0.35, tip_spread: 0.45 },
            variation: StrandVariation {
                frizz: 0.0003,
                strays: 0.25,
                stray: 0.004,
                flyaways: 0.035,
                flyaway: 0.016,
                shorter: 0.11,
            },
            curls: Curls::default(),
            paint: ScalpPaint::default(),
            clearance: 0.001,
            seed: style.recipe().seed,
        };
        match style {
            Style::Long(_) => base,
            Style::Bob(_) => Self {
                clumps: Clumps { spacing: 0.005, strength: 0.55, start: 0.1, lock: 0.15, tip_spread: 0.7 },
                variation: StrandVariation {
                    frizz: 0.0003,
                    stray: 0.0025,
                    flyaway: 0.01,
                    shorter: 0.06,
                    ..base.variation
                },
                ..base
            },
            Style::Curly(Curly { diameter, .. }) => Self {
                vertex_count: 64,
                curls: Curls { radius: 0.5 * diameter, ..Curls::ringlets() },
                clump_fraction: 0.2,
                clumps: Clumps { spacing: 0.013, strength: 0.97, start: -0.4, lock: 0.1, tip_spread: 0.8 },
                variation: StrandVariation {
                    frizz: 0.0005,
                    flyaways: 0.05,
                    flyaway: 0.014,
                    shorter: 0.2,
                    ..base.variation
                },
                ..base
            },
            Style::Short(_) => Self {
                strand_count: Some(30_000),
                vertex_count: 16,
                clump_fraction: 0.25,
                clumps: Clumps { spacing: 0.0065, strength: 0.6, start: 0.1, lock: 0.2, tip_spread: 0.6 },
                variation: StrandVariation {
                    frizz: 0.0004,
                    stray: 0.003,
                    flyaway: 0.006,
                    shorter: 0.22,
                    ..base.variation
                },
                ..base
            },
        }
    }

    /// Returns this growth with curls, with clumps that suit them (locks that hold together from near the root on), and
    /// with the maximum number of vertices.
    pub fn with_curls(mut self, curls: Curls) -> Self {
        if curls.any() {
            self.vertex_count = MAX_STRAND_VERTICES;
            self.clumps = self.clumps.curled(&curls);
        }
        self.curls = curls;
        self
    }

    /// Returns this growth with exactly `count` strands.
    pub fn with_strands(mut self, count: u32) -> Self {
        self.strand_count = Some(count);
        self
    }

    /// Returns the diameter of each of `count` strands, meters.
    pub fn diameter_for(&self, count: usize) -> f32 {
        self.diameter.unwrap_or_else(|| 2.0 * covering_radius(count))
    }

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value out of range.
    pub fn check(&self) -> Result<()> {
        if !(2..=64).contains(&self.vertex_count) {
            let value = self.vertex_count.to_string();
            return Err(Error::Parameter { name: "vertices of each strand", value, range: "from 2 to 64" });
        }
        if let Some(count) = self.strand_count.filter(|count| *count > Self::MAX_STRANDS) {
            let value = count.to_string();
            return Err(Error::Parameter { name: "number of strands", value, range: "at most 4,000,000" });
        }
        const CLUMP_FRACTION: Range = range!("clump share", 0.0 to 1.0);
        const TAPER: Range = range!("taper start", 0.0 to 1.0);
        const CLEARANCE: Range = range!("clearance", 0.0 to 1.0, "m");
        CLUMP_FRACTION.check(self.clump_fraction)?;
        TAPER.check(self.taper_start)?;
        CLEARANCE.check(self.clearance)?;
        Self::TIP_WIDTH.check(self.tip_width)?;
        Self::WIDTH_VARIATION.check(self.width_variation)?;
        Self::DIAMETER.check(self.diameter.unwrap_or(0.0))?;
        self.curls.check()?;
        self.clumps.check()?;
        self.variation.check()
    }
}
