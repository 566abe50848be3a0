//! All parameters that users can change while hair is shown, as one plain value.
//!
//! ```text
//! Settings ─┬─ style ─────────────────────► Growth, Restyle        rebuilds the strands
//!           ├─ simulation, wind_direction ► SimulationParams       next frame
//!           ├─ avoidance ─────────────────► AvoidOptions           next frame
//!           ├─ shading, lights, shadows ──► Picture, HairMaterial  next frame
//!           ├─ view, renderer, ssaa ──────► ViewOptions            recreates the view
//!           └─ lod, lod_fraction ─────────► LodOptions             next frame
//! ```
//! Most fields are the library's option structs, so each parameter and its default are defined once. The other fields
//! offer simpler controls, such as the wind's direction or a color name. Paths, units, ranges and hints are rows of the
//! table [`knobs`](crate::knobs). [`options`](crate::options) derives the library's options from settings.
//!
//! Parameters that depend on the hairstyle or the color are *automatic* until they are set. Settings store which
//! automatic parameters are [set explicitly](Settings::gives) and ignore the fields of the others. Only
//! [`Settings::set`] writes fields of automatic parameters. [`Settings::resolved`] returns the values of automatic
//! parameters.

mod light_entry;
mod lights;
mod renderer;
mod shading;
mod style;

pub use light_entry::{LightEntry, LightKind};
pub use lights::LightSettings;
pub use renderer::{ClassicBlending, RendererKind, RendererSettings};
pub(crate) use shading::NATURAL;
pub use shading::{HairColor, ShadingSettings};
pub use style::{Curl, StyleSettings};

use std::collections::BTreeSet;
use tresses::{
    AvoidOptions, LodMode, LodOptions, RestOptions, SimulationParams, ViewOptions, glam::Vec3, light::Shadows,
};

/// All parameters that users can change.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Growth and restyling of strands.
    pub style: StyleSettings,
    /// Physics, with wind from the front along -Z. [`wind_direction`](Self::wind_direction) rotates it.
    pub simulation: SimulationParams,
    /// Rest state of the guides.
    pub rest: RestOptions,
    /// Direction the wind comes from, radians: front (0), the head's left (π/2), back (π).
    pub wind_direction: f32,
    /// Collision of render strands with head and colliders.
    pub avoidance: AvoidOptions,
    /// Hair color and shading.
    pub shading: ShadingSettings,
    /// Lights.
    pub lights: LightSettings,
    /// Shadows.
    pub shadows: Shadows,
    /// View options. [`renderer`](Self::renderer) overrides the renderer.
    pub view: ViewOptions,
    /// How hair is drawn.
    pub renderer: RendererSettings,
    /// Supersampling factor along each axis, 1 or 2.
    pub ssaa: u32,
    /// Level of detail. The share of [`LodMode::Fixed`] is [`lod_fraction`](Self::lod_fraction).
    pub lod: LodOptions,
    /// Share of strands drawn in [`LodMode::Fixed`].
    pub lod_fraction: f32,
    /// Paths of the automatic parameters that are set explicitly.
    pub(crate) given: BTreeSet<&'static str>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            style: StyleSettings::default(),
            simulation: SimulationParams::default(),
            rest: RestOptions::default(),
            wind_direction: 0.0,
            avoidance: AvoidOptions::default(),
            shading: ShadingSettings::default(),
            lights: LightSettings::default(),
            shadows: Shadows::default(),
            view: ViewOptions::default(),
            renderer: RendererSettings::default(),
            ssaa: 1,
            lod: LodOptions::default(),
            lod_fraction: 1.0,
            given: BTreeSet::new(),
        }
    }
}

impl Settings {
    /// Returns whether the automatic parameter at `path` is set explicitly.
    pub fn gives(&self, path: &str) -> bool {
        self.given.contains(path)
    }

    /// Returns these settings for hair whose strands already have its style: without growth and restyling.
    #[must_use]
    pub fn without_style(&self) -> Self {
        let style = StyleSettings { face: self.style.face, ..StyleSettings::default() };
        let mut given = self.given.clone();
        given.retain(|path| !path.starts_with("style."));
        Self { style, given, ..self.clone() }
    }

    /// Returns the mean wind speed far from the head, m/s; 0 is calm.
    pub fn wind_speed(&self) -> f32 {
        // Subtract from 0 to avoid returning -0.
        0.0 - self.simulation.wind.velocity.z
    }

    /// Sets the wind speed, m/s.
    pub fn set_wind_speed(&mut self, speed: f32) {
        self.simulation.wind.velocity = Vec3::new(0.0, 0.0, -speed);
    }

    /// Returns the physics with the wind rotated to its direction.
    pub fn physics(&self) -> SimulationParams {
        let (sin, cos) = self.wind_direction.sin_cos();
        let mut physics = self.simulation;
        let Vec3 { x, y, z } = physics.wind.velocity;
        physics.wind.velocity = Vec3::new(x * cos + z * sin, y, z * cos - x * sin);
        physics
    }

    /// Returns the level of detail options, including the share of strands.
    pub fn lod(&self) -> LodOptions {
        let mode = match self.lod.mode {
            LodMode::Fixed(_) => LodMode::Fixed(self.lod_fraction),
            mode => mode,
        };
        LodOptions { mode, ..self.lod }
    }
}
