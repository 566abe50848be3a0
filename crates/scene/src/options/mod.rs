//! Converts [settings](Settings) to the library's options: growth, material, view, pipelines.

mod renderer;
mod shading;
mod style;

use crate::settings::HairColor;
use crate::{
    companion_files::Maps,
    knobs::{self, Refusal, light_list},
    quality::Quality,
    settings::Settings,
};
use tresses::{
    HairHairMode, Picture, PipelineRequest, Result, SimulationParams, Styling, ViewOptions,
    groom::{Look, styles::Style},
    light::HairMaterial,
};

/// Invalid settings, described in one sentence.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// A parameter is out of its range.
    #[error(transparent)]
    Knob(#[from] Refusal),
    /// A light of the list is invalid.
    #[error("{label}: {problem}")]
    Light {
        /// The light, such as `light 2 (Window) of lights.list`.
        label: String,
        /// Description, one clause.
        problem: String,
    },
    /// An error from the library's own checks.
    #[error(transparent)]
    Library(#[from] tresses::Error),
}

impl Settings {
    /// Checks that every parameter is within its range and that the parameters are consistent.
    ///
    /// # Errors
    /// Returns the first violation.
    pub fn check(&self) -> Result<(), SettingsError> {
        for knob in knobs::all() {
            knob.check(knob.get(self))?;
        }
        for (i, light) in self.lights.list.iter().enumerate() {
            light.check().map_err(|(_, problem)| SettingsError::Light {
                label: light_list::label(i, &light.name),
                problem,
            })?;
        }
        Ok(self.check_library()?)
    }

    /// Runs the library's own checks.
    pub(crate) fn check_library(&self) -> Result<()> {
        self.physics().check()?;
        self.avoidance.check()?;
        self.lod().check()?;
        self.check_renderer()?;
        self.growth(&Style::default(), &Maps::default())?.check()?;
        if let Some(restyle) = self.restyle(&Maps::default())? {
            restyle.check()?;
        }
        Ok(())
    }

    /// Returns a copy in which automatic parameters have their resolved values, which interfaces show next to
    /// *automatic*. `style` is the built-in style, or `None` for a groom from a file, whose strands are not restyled.
    /// Parameters that the file defines, such as strand width, remain automatic.
    pub fn resolved(&self, style: Option<&Style>) -> Self {
        let mut resolved = self.clone();
        self.resolve_style(style, &mut resolved);
        self.resolve_look(&mut resolved);
        self.resolve_renderer(&mut resolved);
        resolved
    }

    /// Returns the view's options for an adapter that supports up to `max_samples` samples per pixel.
    ///
    /// # Errors
    /// As [`renderer`](Self::renderer).
    pub fn view_options(&self, max_samples: u32) -> Result<ViewOptions> {
        Ok(ViewOptions { renderer: self.renderer(max_samples)?, ..self.view })
    }

    /// Returns the pipelines that render hair at rest in a view with `options`.
    pub fn pipelines(&self, options: ViewOptions) -> Vec<PipelineRequest> {
        use PipelineRequest::{Avoid, Strands, View};
        vec![Strands, Avoid, View(options)]
    }

    /// Returns the additional pipelines for moving hair, with guides of `guide_vertices` vertices.
    pub fn pipelines_of_motion(&self, guide_vertices: &[u32]) -> Vec<PipelineRequest> {
        let SimulationParams { wind, hair_hair, twist, .. } = self.physics();
        let wind = wind.blows();
        let volume = wind || hair_hair.mode != HairHairMode::Off;
        let mut requests = vec![PipelineRequest::Forces];
        let step = if twist > 0.0 { PipelineRequest::TwistStep } else { PipelineRequest::Step };
        requests.extend(guide_vertices.iter().map(|count| step(*count)));
        requests.extend(volume.then_some(PipelineRequest::Volume));
        requests.extend(wind.then_some(PipelineRequest::Wind));
        requests
    }

    /// Returns the image quality for `size` (pixels) on an adapter that supports up to `max_samples` samples per pixel.
    ///
    /// # Errors
    /// As [`view_options`](Self::view_options).
    pub fn quality(&self, size: [u32; 2], max_samples: u32) -> Result<Quality> {
        Ok(Quality { size, view: self.view_options(max_samples)?, ssaa: self.ssaa, lod: self.lod() })
    }

    /// Returns the styling options for a built-in style, or for a groom from files if `style` is `None`.
    ///
    /// # Errors
    /// Fails if curl parameters are out of range.
    pub fn styling(&self, style: Option<&Style>, maps: &Maps) -> Result<Styling> {
        Ok(Styling {
            growth: style.map(|style| self.growth(style, maps)).transpose()?,
            max_strands: self.strands(),
            fill: self.growing(),
            guides: self.guides(),
            paint: self.paint(maps),
            coordinates: self.style.maps,
            uses_skin_color: self.shading.color == HairColor::Skin,
            restyle: if style.is_none() { self.restyle(maps)? } else { None },
            stiffness: maps.stiffness.clone(),
            levels: maps.levels.clone(),
            ties: maps.ties.clone(),
            face: self.style.face,
        })
    }

    /// Writes hair color, shading, shadows and exposure to `picture` and `material`. The lights, which may depend on
    /// the camera, come from [`LightSettings::lights`](crate::settings::LightSettings::lights).
    pub fn apply(&self, picture: &mut Picture, material: &mut HairMaterial, look: Option<&Look>) {
        *material = self.material_of(look);
        picture.shadows = self.shadows;
        picture.tone.exposure = self.lights.exposure;
    }
}
