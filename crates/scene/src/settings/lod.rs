//! How much of the hair is drawn.

use tresses::lod::{LodMode, LodOptions};

/// How the level of detail is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LodChoice {
    /// By the size of a pixel at the hair.
    #[default]
    Auto,
    /// Full detail at any distance.
    Off,
    /// A share of the strands at any distance.
    Fixed,
}

/// Level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodSettings {
    /// How it is chosen.
    pub mode: LodChoice,
    /// The share of the strands of [`LodChoice::Fixed`], above 0 and at most 1.
    pub fraction: f32,
    /// 1 draws as if the hair were twice as far away.
    pub bias: f32,
    /// Strands are left out until the others are this wide, pixels.
    pub strand_width: f32,
    /// How far strands may stray from their full shape, pixels.
    pub curve_error: f32,
    /// The largest factor on the length of a fixed step.
    pub slowest: f32,
    /// The size of a pixel from which on steps grow, metres.
    pub slow_pixel: f32,
}

impl Default for LodSettings {
    fn default() -> Self {
        let LodOptions { mode: _, bias, strand_width, curve_error, slowest, slow_pixel } =
            LodOptions::default();
        Self {
            mode: LodChoice::default(),
            fraction: 1.0,
            bias,
            strand_width,
            curve_error,
            slowest,
            slow_pixel,
        }
    }
}

impl LodSettings {
    /// As the library has them.
    pub fn options(&self) -> LodOptions {
        let Self { bias, strand_width, curve_error, slowest, slow_pixel, .. } = *self;
        let mode = match self.mode {
            LodChoice::Auto => LodMode::Auto,
            LodChoice::Off => LodMode::Off,
            LodChoice::Fixed => LodMode::Fixed(self.fraction),
        };
        LodOptions { mode, bias, strand_width, curve_error, slowest, slow_pixel }
    }
}
