//! Everything that a person can change while hair is shown, as one plain value.
//!
//! ```text
//! Settings ─┬─ style ─────────────────────► Growth, Restyle        strands are grown again
//!           ├─ simulation, wind_direction ► SimulationParams       the next frame
//!           ├─ avoidance ─────────────────► AvoidOptions           the next frame
//!           ├─ shading, lights, shadows ──► Picture, HairMaterial  the next frame
//!           ├─ view, peeled_layers, ssaa ─► ViewOptions            the view is made again
//!           └─ lod, lod_fraction ─────────► LodOptions             the next frame
//! ```
//! Fields are the library's option structs, so that a parameter and its default stand there once. The other fields are a
//! person's way to set an option (the direction of the wind, a color by name). Paths, units, ranges and hints are rows of
//! one table, [`knobs`](crate::knobs); the library's options follow from settings in [`options`](crate::options).
//!
//! What depends on the hairstyle or on the color is *automatic* until it is given: settings remember which automatic
//! parameters are [given](Settings::gives), and the fields of the others do not count. [`Settings::set`] alone writes
//! fields of automatic parameters. [`Settings::resolved`] returns the values of automatic parameters.

mod lights;
mod shading;
mod style;

pub use lights::{Lamp, LightSettings};
pub(crate) use shading::NATURAL;
pub use shading::{HairColor, ShadingSettings};
pub use style::{Curl, StyleSettings};

use std::collections::BTreeSet;
use tresses::{
    avoid::AvoidOptions,
    draw::Coverage,
    glam::Vec3,
    light::{ShadingRate, Shadows},
    lod::{LodMode, LodOptions},
    simulate::SimulationParams,
    view::ViewOptions,
};

/// Everything that a person can change.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How strands are grown or restyled.
    pub style: StyleSettings,
    /// The physics, in wind from the front, along -Z: [`wind_direction`](Self::wind_direction) turns it.
    pub simulation: SimulationParams,
    /// Where the wind comes from, radians: from the front (0) over the head's left to the back (π).
    pub wind_direction: f32,
    /// What drawn strands do where they would enter the head.
    pub avoidance: AvoidOptions,
    /// Color of the hair and how light on it is computed.
    pub shading: ShadingSettings,
    /// Where light comes from.
    pub lights: LightSettings,
    /// How shadows are made.
    pub shadows: Shadows,
    /// How a view is made. Samples and coverage are automatic: they count where [`gives`](Self::gives) says so.
    pub view: ViewOptions,
    /// Layers that are peeled, whatever number [`view`](Self::view) has; hair behind them is blended by its depth.
    pub peeled_layers: u32,
    /// Pixels drawn per pixel shown, along each axis: 1 or 2.
    pub ssaa: u32,
    /// How much of the hair is drawn; the share of [`LodMode::Fixed`] is [`lod_fraction`](Self::lod_fraction).
    pub lod: LodOptions,
    /// The share of the strands that are drawn where the mode is a share.
    pub lod_fraction: f32,
    /// The automatic parameters that have a value of their own, by their paths.
    pub(crate) given: BTreeSet<&'static str>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            style: StyleSettings::default(),
            simulation: SimulationParams::default(),
            wind_direction: 0.0,
            avoidance: AvoidOptions::default(),
            shading: ShadingSettings::default(),
            lights: LightSettings::default(),
            shadows: Shadows::default(),
            view: ViewOptions::default(),
            peeled_layers: match Coverage::PEELING {
                Coverage::DepthPeeling { layers } => layers,
                _ => 4,
            },
            ssaa: 1,
            lod: LodOptions::default(),
            lod_fraction: 1.0,
            given: BTreeSet::new(),
        }
    }
}

impl Settings {
    /// Whether the automatic parameter at `path` has a value of its own.
    pub fn gives(&self, path: &str) -> bool {
        self.given.contains(path)
    }

    /// Mean speed of the wind far from the head, m/s; 0 is calm.
    pub fn wind_speed(&self) -> f32 {
        // Of no wind 0, not -0.
        0.0 - self.simulation.wind.velocity.z
    }

    /// Gives the wind another speed, m/s.
    pub fn set_wind_speed(&mut self, speed: f32) {
        self.simulation.wind.velocity = Vec3::new(0.0, 0.0, -speed);
    }

    /// The physics, in wind from where it comes.
    pub fn physics(&self) -> SimulationParams {
        let (sin, cos) = self.wind_direction.sin_cos();
        let mut physics = self.simulation;
        let Vec3 { x, y, z } = physics.wind.velocity;
        physics.wind.velocity = Vec3::new(x * cos + z * sin, y, z * cos - x * sin);
        physics
    }

    /// How much of the hair is drawn, with the share of the strands.
    pub fn lod(&self) -> LodOptions {
        let mode = match self.lod.mode {
            LodMode::Fixed(_) => LodMode::Fixed(self.lod_fraction),
            mode => mode,
        };
        LodOptions { mode, ..self.lod }
    }

    /// Where hair is shaded: shadows that are looked up for every pixel take shading for every pixel.
    pub fn shading_rate(&self) -> ShadingRate {
        if self.shadows.per_pixel { ShadingRate::PerPixel } else { self.shading.rate }
    }
}
