//! Everything that a person can turn while hair is shown, as one plain value.
//!
//! ```text
//! Settings ─┬─ style ─────────────────────► Growth, Restyle        strands are grown again
//!           ├─ simulation, wind ──────────► SimulationParams       the next frame
//!           ├─ interpolation ─────────────► AvoidOptions           the next frame
//!           ├─ look, lights, shadows ─────► Picture, HairMaterial  the next frame
//!           ├─ edges, shadow_resolution ──► ViewOptions            the view is made again
//!           └─ lod ───────────────────────► LodOptions             the next frame
//! ```
//! The defaults are those of `tresses render`. What depends on the hairstyle or on the colour is an
//! `Option`, `None` being *as it suits them*; [`Settings::resolved`] says what that comes to.
//! Names, units, ranges and hints of all fields stand in one table, [`knobs`].

mod edges;
mod lights;
mod lod;
mod look;
mod style;

pub use edges::{CoverageMode, Edges, Samples};
pub use lights::{Lamp, LightSettings};
pub use lod::{LodChoice, LodSettings};
pub use look::{HairColor, LookSettings};
pub use style::{Curl, Maps, StyleSettings};

use crate::{
    Quality, Styling,
    knobs::{self, Refusal},
};
use tresses::{
    Result,
    avoid::AvoidOptions,
    glam::Vec3,
    groom::styles::Style,
    light::{HairMaterial, ShadingRate, Shadows},
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
};

/// What a change of a parameter costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Nothing: the next frame has it.
    Frame,
    /// The strands are grown or restyled again, and brought to the GPU: a fraction of a second, and the
    /// hair starts from rest.
    Regrow,
    /// Pipelines and the targets that pictures are drawn into are made again.
    Rebuild,
}

/// What has to be done to get from some settings to others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Something takes effect with the next frame.
    pub frame: bool,
    /// Strands have to be grown again.
    pub regrow: bool,
    /// Pipelines and targets have to be made again.
    pub rebuild: bool,
}

impl Changes {
    /// Whether anything differs.
    pub fn any(self) -> bool {
        self.frame || self.regrow || self.rebuild
    }
}

/// Where the wind comes from and how fast, far from the head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindSettings {
    /// Mean speed, m/s; 0 is calm.
    pub speed: f32,
    /// Where it comes from, radians: from the front (0) over the head's left to the back (π).
    pub direction: f32,
}

/// Everything that a person can turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How strands are grown or restyled.
    pub style: StyleSettings,
    /// The physics. `simulation.wind.velocity` is not read: [`wind`](Self::wind) says it.
    pub simulation: SimulationParams,
    /// The wind's speed and direction.
    pub wind: WindSettings,
    /// What drawn strands do where they would enter the head.
    pub interpolation: AvoidOptions,
    /// Colour of the hair and how light on it is computed.
    pub look: LookSettings,
    /// Where light comes from.
    pub lights: LightSettings,
    /// How shadows are made.
    pub shadows: Shadows,
    /// Texels along each edge of a shadow map.
    pub shadow_resolution: u32,
    /// How finely pictures are sampled.
    pub edges: Edges,
    /// How much of the hair is drawn.
    pub lod: LodSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            style: StyleSettings::default(),
            simulation: SimulationParams::default(),
            wind: WindSettings::default(),
            interpolation: AvoidOptions::default(),
            look: LookSettings::default(),
            lights: LightSettings::default(),
            shadows: Shadows::default(),
            shadow_resolution: ViewOptions::default().shadow_resolution,
            edges: Edges::default(),
            lod: LodSettings::default(),
        }
    }
}

/// Why settings make no sense, in one sentence.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// A parameter is out of its range.
    #[error(transparent)]
    Knob(#[from] Refusal),
    /// What the library says.
    #[error(transparent)]
    Library(#[from] tresses::Error),
}

impl Settings {
    /// Whether every parameter is within its range and all of them fit together.
    ///
    /// # Errors
    /// One sentence that names the first that does not.
    pub fn check(&self) -> Result<(), SettingsError> {
        for knob in knobs::all() {
            knob.check(knob.get(self))?;
        }
        Ok(self.check_library()?)
    }

    /// The library's own checks.
    pub(crate) fn check_library(&self) -> Result<()> {
        self.physics().check()?;
        self.interpolation.check()?;
        self.lod.options().check()?;
        self.edges.check()?;
        self.style.growth(&Style::default(), &Maps::default())?.check()?;
        if let Some(restyle) = self.style.restyle(&Maps::default())? {
            restyle.check()?;
        }
        Ok(())
    }

    /// What has to be done to get from `before` to these.
    pub fn changes(&self, before: &Self) -> Changes {
        let mut changes = Changes::default();
        for knob in knobs::all().filter(|knob| knob.get(self) != knob.get(before)) {
            match knob.cost {
                Change::Frame => changes.frame = true,
                Change::Regrow => changes.regrow = true,
                Change::Rebuild => changes.rebuild = true,
            }
        }
        changes
    }

    /// The same with every automatic parameter as it comes out: on a built-in style, or `None` for a
    /// groom from a file, whose strands stay as they are. What an interface shows beside *automatic*.
    /// A parameter for which a file has a value of its own, such as its widths, stays automatic.
    pub fn resolved(&self, style: Option<&Style>) -> Self {
        let mut resolved = self.clone();
        self.style.resolve(style, &mut resolved.style);
        self.look.resolve(&mut resolved.look);
        self.edges.resolve(&mut resolved.edges);
        resolved
    }

    /// The physics, with the wind.
    pub fn physics(&self) -> SimulationParams {
        let (sin, cos) = self.wind.direction.sin_cos();
        let mut physics = self.simulation;
        physics.wind.velocity = -self.wind.speed * Vec3::new(sin, 0.0, cos);
        physics
    }

    /// Where hair is shaded: shadows that are looked up for every pixel take shading for every pixel.
    pub fn shading(&self) -> ShadingRate {
        if self.shadows.per_pixel { ShadingRate::PerPixel } else { self.look.rate }
    }

    /// The pipelines' options where the adapter offers `most` samples per pixel.
    ///
    /// # Errors
    /// Samples and coverage that do not go together.
    pub fn draw_options(&self, most: u32) -> Result<ViewOptions> {
        let (samples, coverage) = self.edges.choose(most)?;
        let shadow_resolution = self.shadow_resolution;
        Ok(ViewOptions { samples, coverage, shadow_resolution, ..Default::default() })
    }

    /// How pictures of `size` (pixels) are sampled where the adapter offers `most` samples per pixel.
    ///
    /// # Errors
    /// As [`draw_options`](Self::draw_options).
    pub fn quality(&self, size: [u32; 2], most: u32) -> Result<Quality> {
        let ViewOptions { samples, coverage, shadow_resolution, ambient_cells, .. } =
            self.draw_options(most)?;
        Ok(Quality { size, samples, coverage, ssaa: self.edges.ssaa, shadow_resolution, ambient_cells })
    }

    /// How strands become what is drawn: on a built-in style, or `None` for a groom from files.
    ///
    /// # Errors
    /// Curls out of range.
    pub fn styling(&self, style: Option<&Style>, maps: &Maps) -> Result<Styling> {
        Ok(Styling {
            growth: style.map(|style| self.style.growth(style, maps)).transpose()?,
            strands: self.style.strands,
            guides: self.style.guides(),
            paint: maps.paint.clone(),
            restyle: if style.is_none() { self.style.restyle(maps)? } else { None },
            stiffness: maps.stiffness.clone(),
            levels: maps.levels.clone(),
        })
    }

    /// Puts hair colour, shading, shadows and exposure into `picture` and `material`; the lights, which may go with
    /// the camera, are [`LightSettings::lights`].
    pub fn apply(&self, picture: &mut Picture, material: &mut HairMaterial) {
        *material = HairMaterial { min_width: self.edges.min_width, ..self.look.material() };
        picture.shading = self.shading();
        picture.shadows = self.shadows;
        picture.tone.exposure = self.lights.exposure;
    }
}
