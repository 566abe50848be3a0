//! Everything that a person can change while hair is shown, as one plain value.
//!
//! ```text
//! Settings ─┬─ style ─────────────────────► Growth, Restyle        strands are grown again
//!           ├─ simulation, wind ──────────► SimulationParams       the next frame
//!           ├─ avoidance ─────────────────► AvoidOptions           the next frame
//!           ├─ shading, lights, shadows ──► Picture, HairMaterial  the next frame
//!           ├─ edges, shadow_resolution ──► ViewOptions            the view is made again
//!           └─ lod ───────────────────────► LodOptions             the next frame
//! ```
//! Fields are the library's option structs, so that a parameter and its default stand there once; what is
//! here besides is a person's way to say it (a direction of the wind, a colour by name). Paths, units, ranges
//! and hints stand in one table, [`knobs`].
//!
//! What depends on the hairstyle or on the colour is *automatic* until it is given: settings remember which
//! automatic parameters are [given](Settings::gives), and the fields of the others do not count. Fields of
//! automatic parameters are therefore written by [`Settings::set`] alone. [`Settings::resolved`] says what
//! automatic parameters come to.

mod edges;
mod lights;
mod shading;
mod style;

pub use edges::{EdgeSettings, Samples};
pub use lights::{Lamp, LightSettings};
pub use shading::{HairColor, ShadingSettings};
pub(crate) use style::CURLS;
pub use style::{Curl, Maps, StyleSettings};

use crate::{
    Quality, Styling, Value,
    knobs::{self, Refusal},
};
use std::collections::BTreeSet;
use tresses::{
    Result, Wanted,
    avoid::AvoidOptions,
    glam::Vec3,
    groom::{Look, styles::Style},
    light::{HairMaterial, ShadingRate, Shadows},
    lod::{LodMode, LodOptions},
    simulate::SimulationParams,
    stage::Stage,
    view::{Picture, ViewOptions},
    volume::HairHairMode,
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
    pub avoidance: AvoidOptions,
    /// Colour of the hair and how light on it is computed.
    pub shading: ShadingSettings,
    /// Where light comes from.
    pub lights: LightSettings,
    /// How shadows are made.
    pub shadows: Shadows,
    /// Texels along each edge of a shadow map.
    pub shadow_resolution: u32,
    /// Cells along each edge of the grid of ambient light.
    pub ambient_cells: u32,
    /// [`ViewOptions::strand_map`].
    pub strand_map: u32,
    /// How finely pictures are sampled.
    pub edges: EdgeSettings,
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
            wind: WindSettings::default(),
            avoidance: AvoidOptions::default(),
            shading: ShadingSettings::default(),
            lights: LightSettings::default(),
            shadows: Shadows::default(),
            shadow_resolution: ViewOptions::default().shadow_resolution,
            ambient_cells: ViewOptions::default().ambient_cells,
            strand_map: ViewOptions::default().strand_map,
            edges: EdgeSettings::default(),
            lod: LodOptions::default(),
            lod_fraction: 1.0,
            given: BTreeSet::new(),
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
    /// Gives the parameter at `path` a value.
    ///
    /// # Errors
    /// One sentence for a value out of range or of another kind, and where there is no such parameter.
    pub fn set(&mut self, path: &str, value: impl Into<Value>) -> Result<(), Refusal> {
        match knobs::find(path) {
            Some(knob) => knob.set(self, value.into()),
            None => Err(Refusal {
                path: path.to_owned(),
                value: "no parameter".to_owned(),
                range: "one that `tresses knobs` lists".to_owned(),
            }),
        }
    }

    /// Whether the automatic parameter at `path` has a value of its own.
    pub fn gives(&self, path: &str) -> bool {
        self.given.contains(path)
    }

    /// Automatic parameters among `paths` have values of their own from here on.
    fn take_as_given(&mut self, paths: impl Iterator<Item = &'static str>) {
        self.given.extend(paths.filter(|path| knobs::find(path).is_some_and(|knob| knob.automatic)));
    }

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
        self.avoidance.check()?;
        self.lod().check()?;
        self.check_edges()?;
        self.growth(&Style::default(), &Maps::default())?.check()?;
        if let Some(restyle) = self.restyle(&Maps::default())? {
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
        self.resolve_style(style, &mut resolved);
        self.resolve_look(&mut resolved);
        self.resolve_edges(&mut resolved);
        resolved
    }

    /// The physics, with the wind.
    pub fn physics(&self) -> SimulationParams {
        let (sin, cos) = self.wind.direction.sin_cos();
        let mut physics = self.simulation;
        physics.wind.velocity = -self.wind.speed * Vec3::new(sin, 0.0, cos);
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

    /// The pipelines' options where the adapter offers `most` samples per pixel.
    ///
    /// # Errors
    /// Samples and coverage that do not go together.
    pub fn draw_options(&self, most: u32) -> Result<ViewOptions> {
        let (samples, coverage) = self.sampling(most)?;
        let Self { shadow_resolution, strand_map, ambient_cells, .. } = *self;
        Ok(ViewOptions {
            samples,
            coverage,
            shadow_resolution,
            strand_map,
            ambient_cells,
            ..Default::default()
        })
    }

    /// The pipelines of a picture of hair at rest, for a view with `options`.
    pub fn pipelines(&self, options: ViewOptions) -> Vec<Wanted> {
        let stages = [Stage::Tessellate, Stage::Interpolate, Stage::Avoid];
        let picture = Wanted::Picture(options, self.shading_rate());
        stages.into_iter().map(Wanted::Motion).chain([picture]).collect()
    }

    /// Those that hair in motion needs besides, with guides of `guide_vertices` vertices.
    pub fn pipelines_of_motion(&self, guide_vertices: &[u32]) -> Vec<Wanted> {
        let SimulationParams { wind, hair_hair, twist, .. } = self.physics();
        let wind = wind.blows();
        let volume = wind || hair_hair.mode != HairHairMode::Off;
        let mut wanted = vec![Wanted::Motion(Stage::Simulate)];
        let step = if twist > 0.0 { Wanted::Twist } else { Wanted::Step };
        wanted.extend(guide_vertices.iter().map(|count| step(*count)));
        wanted.extend(volume.then_some(Wanted::Motion(Stage::Volume)));
        wanted.extend(wind.then_some(Wanted::Motion(Stage::Wind)));
        wanted
    }

    /// How pictures of `size` (pixels) are sampled where the adapter offers `most` samples per pixel.
    ///
    /// # Errors
    /// As [`draw_options`](Self::draw_options).
    pub fn quality(&self, size: [u32; 2], most: u32) -> Result<Quality> {
        let ViewOptions { samples, coverage, shadow_resolution, strand_map, ambient_cells, .. } =
            self.draw_options(most)?;
        let (ssaa, lod) = (self.edges.ssaa, self.lod());
        Ok(Quality { size, samples, coverage, ssaa, shadow_resolution, strand_map, ambient_cells, lod })
    }

    /// How strands become what is drawn: on a built-in style, or `None` for a groom from files.
    ///
    /// # Errors
    /// Curls out of range.
    pub fn styling(&self, style: Option<&Style>, maps: &Maps) -> Result<Styling> {
        Ok(Styling {
            growth: style.map(|style| self.growth(style, maps)).transpose()?,
            strands: self.strands(),
            growing: self.growing(),
            guides: self.guides(),
            paint: self.paint(maps),
            restyle: if style.is_none() { self.restyle(maps)? } else { None },
            stiffness: maps.stiffness.clone(),
            levels: maps.levels.clone(),
            ties: maps.ties.clone(),
            face: self.style.face,
        })
    }

    /// Puts hair colour, shading, shadows and exposure into `picture` and `material`; the lights, which may go with
    /// the camera, are [`LightSettings::lights`].
    pub fn apply(&self, picture: &mut Picture, material: &mut HairMaterial, look: Option<&Look>) {
        *material = self.material_of(look);
        picture.shading = self.shading_rate();
        picture.shadows = self.shadows;
        picture.tone.exposure = self.lights.exposure;
    }
}
