//! Brushes: what a stroke does, and where.

use crate::{
    Error, Result,
    hash::{self, pcg},
};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Effect of a stroke on the hair under it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BrushTool {
    /// Drags hair along. It slides through the brush.
    #[default]
    Comb,
    /// Holds the hair that is under the brush at the press, and moves it.
    Grab,
    /// Evens out bends, and differences between neighbors.
    Smooth,
    /// Raises hair at the root, away from the skin.
    Puff,
    /// Lays hair down at the root, in the direction of the stroke.
    Lay,
    /// Pulls hair towards the line of the stroke.
    Pinch,
    /// Pushes hair away from the line of the stroke.
    Spread,
    /// Blows hair away from the middle of the brush; inverted, draws it in.
    Blow,
    /// Cuts strands where they enter the brush. Hair with its root under the brush stays.
    Cut,
    /// Cuts strands where they cross the straight line from the press to the release.
    Line,
    /// Cuts strands where they enter the region that the stroke surrounds. Hair with its root in it stays.
    Lasso,
    /// Makes hair longer; inverted, shorter.
    Length,
    /// Plants guides on the skin, and grows strands between them.
    Plant,
    /// Removes strands with their roots under the brush.
    Remove,
    /// Moves roots over the skin, with their hair.
    Slide,
    /// Makes guides of strands, for finer strokes. No hair moves.
    Refine,
    /// Parts hair along the stroke.
    Part,
    /// Makes strands wider; inverted, narrower.
    Width,
    /// Gathers strands into clumps; inverted, frees them.
    Clump,
    /// Curls strands; inverted, straightens them.
    Curl,
    /// Makes strands frizzy; inverted, calms them.
    Frizz,
    /// Makes guides stiffer; inverted, softer.
    Stiffness,
    /// Colors strands; inverted, gives them their color before the first stroke.
    Color,
    /// Holds hair, so that no other tool changes it; inverted, lets it go.
    Hold,
}

impl BrushTool {
    /// All tools with their names.
    pub const ALL: [(Self, &'static str); 24] = [
        (Self::Comb, "comb"),
        (Self::Grab, "grab"),
        (Self::Smooth, "smooth"),
        (Self::Puff, "puff"),
        (Self::Lay, "lay"),
        (Self::Pinch, "pinch"),
        (Self::Spread, "spread"),
        (Self::Blow, "blow"),
        (Self::Cut, "cut"),
        (Self::Line, "line"),
        (Self::Lasso, "lasso"),
        (Self::Length, "length"),
        (Self::Plant, "plant"),
        (Self::Remove, "remove"),
        (Self::Slide, "slide"),
        (Self::Refine, "refine"),
        (Self::Part, "part"),
        (Self::Clump, "clump"),
        (Self::Curl, "curl"),
        (Self::Frizz, "frizz"),
        (Self::Width, "width"),
        (Self::Stiffness, "stiffness"),
        (Self::Color, "color"),
        (Self::Hold, "hold"),
    ];

    /// Returns the name, as in files and commands.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(tool, _)| *tool == self).map_or("", |(_, name)| name)
    }

    /// Whether the tool keeps the lengths of all hair.
    pub fn keeps_lengths(self) -> bool {
        !matches!(self, Self::Cut | Self::Line | Self::Lasso | Self::Length)
    }

    /// Whether the tool is aimed at the skin: it acts on hair whose root is under the brush.
    pub fn acts_on_roots(self) -> bool {
        matches!(self, Self::Plant | Self::Remove | Self::Slide | Self::Refine | Self::Part)
    }

    /// Whether the stroke draws a line or an outline, which the tool then acts on.
    pub fn draws(self) -> bool {
        matches!(self, Self::Line | Self::Lasso)
    }

    /// Whether the tool changes values of strands or guides, and no guide's shape.
    pub fn paints(self) -> bool {
        self.paints_strands() || matches!(self, Self::Stiffness | Self::Hold)
    }

    /// Whether the tool changes values of strands.
    pub(super) fn paints_strands(self) -> bool {
        self.paints_shapes() || matches!(self, Self::Width | Self::Color)
    }

    /// Whether the tool paints clumps, curls or frizz.
    pub(super) fn paints_shapes(self) -> bool {
        matches!(self, Self::Clump | Self::Curl | Self::Frizz)
    }

    /// Whether the tool also pushes moving hair.
    pub fn acts_in_motion(self) -> bool {
        use BrushTool::{Blow, Comb, Grab, Lay, Pinch, Puff, Spread};
        matches!(self, Comb | Grab | Puff | Lay | Pinch | Spread | Blow)
    }

    /// Whether the tool also acts while the brush stands still.
    pub fn acts_while_still(self) -> bool {
        use BrushTool::{Blow, Length, Pinch, Puff, Smooth, Spread};
        matches!(self, Smooth | Puff | Pinch | Spread | Blow | Length)
    }
}

impl FromStr for BrushTool {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.iter().find(|(_, name)| *name == text).map(|(tool, _)| *tool).ok_or_else(|| {
            Error::Parameter {
                name: "the tool",
                value: text.into(),
                range: "comb, grab, smooth, puff, lay, pinch, spread, blow, cut, line, lasso, length, plant, remove, slide, refine, part, clump, curl, frizz, width, stiffness, color or hold",
            }
        })
    }
}

/// How the effect falls off from the middle of the brush to its edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Falloff {
    /// `(1 − x²)²`.
    #[default]
    Smooth,
    /// `(1 − x)²`: a narrow peak.
    Sharp,
    /// The same everywhere.
    Flat,
}

impl Falloff {
    /// Returns the factor at `x` radii from the middle.
    pub(super) fn at(self, x: f32) -> f32 {
        if x >= 1.0 {
            return 0.0;
        }
        let side = match self {
            Self::Smooth => 1.0 - x * x,
            Self::Sharp => 1.0 - x,
            Self::Flat => 1.0,
        };
        side * side
    }
}

/// Curls that [`BrushTool::Curl`] paints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum CurlType {
    /// Loose flat waves.
    Waves,
    /// Ringlets as wide as a piece of chalk.
    #[default]
    Ringlets,
    /// Tight coils as wide as a pencil.
    Coils,
}

/// Which hair the brush reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BrushRegion {
    /// The near side: hair in front of the brush and a little behind it, never the far side of the head.
    #[default]
    Shell,
    /// Hair in a ball around the middle of the brush.
    Ball,
    /// All hair under the brush, at any depth.
    Through,
}

/// A brush. Effects are per dab; dabs are a quarter of the radius apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brush {
    /// Effect on the hair.
    #[serde(skip)]
    pub tool: BrushTool,
    /// Radius, meters, 0.001 to 0.15.
    pub radius: f32,
    /// Share of the full effect, 0 to 1; of strands, for a cut.
    pub strength: f32,
    /// Falloff towards the edge.
    pub falloff: Falloff,
    /// Which hair it reaches.
    #[serde(rename = "reach")]
    pub region: BrushRegion,
    /// Where along the hair it acts: 0 everywhere, 1 more towards the tip, -1 more towards the root.
    pub root_tip: f32,
    /// Share of the guides that take part, 0 to 1.
    #[serde(rename = "share")]
    pub guide_fraction: f32,
    /// How far hair keeps its shape beside the brush, 0 to 1.
    pub keep_shape: f32,
    /// Share of its distance from the skin (up to 15 mm) that hair keeps, 0 to 1.
    pub keep_volume: f32,
    /// Share of the neighbors in [`BrushTool::Smooth`] and [`BrushTool::Plant`], 0 to 1.
    pub neighbors: f32,
    /// Distance between guides that are planted or refined, meters, 0.001 to 0.05.
    pub spacing: f32,
    /// Length of planted hair, meters, 0.002 to 1.
    pub length: f32,
    /// Planted strands per square centimeter, 1 to 300.
    pub density: f32,
    /// Color of [`BrushTool::Color`]: sRGB, 0 to 1.
    pub color: [f32; 3],
    /// Curls of [`BrushTool::Curl`].
    pub curls: CurlType,
    /// Group of guides that the brush acts on, and that it plants; `None` for all.
    pub layer: Option<i32>,
    /// Whether it acts on both sides of the head.
    pub mirror: bool,
    /// Whether it acts the other way round: puff and lay, pinch and spread.
    pub inverted: bool,
}

impl Default for Brush {
    fn default() -> Self {
        Self {
            tool: BrushTool::Comb,
            radius: 0.03,
            strength: 0.5,
            falloff: Falloff::Smooth,
            region: BrushRegion::Shell,
            root_tip: 0.0,
            guide_fraction: 1.0,
            keep_shape: 0.3,
            keep_volume: 0.5,
            neighbors: 0.5,
            spacing: 8e-3,
            length: 0.1,
            density: 40.0,
            color: [0.75, 0.3, 0.2],
            curls: CurlType::Ringlets,
            layer: None,
            mirror: true,
            inverted: false,
        }
    }
}

impl Brush {
    /// Returns the brush with `tool` and the values that suit it.
    pub fn of(tool: BrushTool) -> Self {
        let base = Self { tool, ..Self::default() };
        match tool {
            BrushTool::Lay => Self { keep_volume: 0.0, ..base },
            BrushTool::Plant => Self { neighbors: 0.0, ..base },
            BrushTool::Refine => Self { spacing: 3e-3, ..base },
            BrushTool::Comb => Self { strength: 0.8, ..base },
            BrushTool::Grab | BrushTool::Cut | BrushTool::Remove | BrushTool::Slide => {
                Self { strength: 1.0, ..base }
            }
            tool if tool.draws() || tool.paints_shapes() => Self { strength: 1.0, ..base },
            _ => base,
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<()> {
        Error::unless_within("brush.radius", self.radius, 1e-3, 0.15, "from 0.001 to 0.15 m")?;
        Error::unless_within("brush.root_tip", self.root_tip, -1.0, 1.0, "from -1 to 1")?;
        Error::unless_within("brush.spacing", self.spacing, 1e-3, 0.05, "from 0.001 to 0.05 m")?;
        Error::unless_within("brush.length", self.length, 2e-3, 1.0, "from 0.002 to 1 m")?;
        Error::unless_within("brush.density", self.density, 1.0, 300.0, "from 1 to 300 per cm²")?;
        for channel in self.color {
            Error::unless_within("brush.color", channel, 0.0, 1.0, "from 0 to 1 per channel")?;
        }
        let fractions = [
            ("brush.strength", self.strength),
            ("brush.share", self.guide_fraction),
            ("brush.keep_shape", self.keep_shape),
            ("brush.keep_volume", self.keep_volume),
            ("brush.neighbors", self.neighbors),
        ];
        fractions
            .into_iter()
            .try_for_each(|(name, value)| Error::unless_within(name, value, 0.0, 1.0, "from 0 to 1"))
    }

    /// Returns the factor at the fraction `s` of a guide, from its root.
    pub(super) fn along(&self, s: f32) -> f32 {
        let (b, end) = (self.root_tip.abs(), if self.root_tip > 0.0 { s } else { 1.0 - s });
        (1.0 - b + b * 2.0 * end).clamp(0.0, 1.0)
    }

    /// Whether a tool that takes a share of the strands takes strand `i` in the stroke with `seed`.
    pub(super) fn takes(&self, seed: u32, i: u32) -> bool {
        self.strength >= 1.0 || chance(seed, i) < self.strength
    }

    /// Returns the tool that acts, after [`inverted`](Self::inverted).
    pub fn acts(&self) -> BrushTool {
        match (self.inverted, self.tool) {
            (true, BrushTool::Puff) => BrushTool::Lay,
            (true, BrushTool::Lay) => BrushTool::Puff,
            (true, BrushTool::Pinch) => BrushTool::Spread,
            (true, BrushTool::Spread) => BrushTool::Pinch,
            (_, tool) => tool,
        }
    }
}

/// Returns a random number of a guide or strand, 0 to 1, that stays the same during the stroke with `seed`.
pub(super) fn chance(seed: u32, i: u32) -> f32 {
    hash::unit(pcg(i ^ seed))
}
