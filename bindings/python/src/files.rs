//! Paths and orientation of files, from keyword arguments.

use crate::raised;
use pyo3::{exceptions::PyTypeError, prelude::*};
use std::path::PathBuf;
use tresses::groom::orient::{Axis, LengthUnit, OrientationOverride};

/// Converts one path or several, each a `str` or an `os.PathLike`.
pub fn paths(of: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    if let Ok(path) = of.extract::<PathBuf>() {
        return Ok(vec![path]);
    }
    let several =
        of.try_iter().map_err(|_| PyTypeError::new_err("files must be a path or a list of paths"))?;
    several.map(|path| path?.extract()).collect()
}

/// Known unit and axes of a file, as text.
#[derive(Default)]
pub struct Orientation {
    /// `cm`, or meters per unit.
    pub unit: Option<String>,
    /// Up axis, such as `y` or `-z`.
    pub up: Option<String>,
    /// Axis that the face looks along, in the same notation.
    pub front: Option<String>,
    /// Whether the file is a mirror image.
    pub mirror: Option<bool>,
}

impl Orientation {
    /// Converts to the library's options.
    pub fn choice(&self) -> PyResult<OrientationOverride> {
        let axis =
            |text: &Option<String>| text.as_deref().map(str::parse::<Axis>).transpose().map_err(raised);
        Ok(OrientationOverride {
            unit: self.unit.as_deref().map(str::parse::<LengthUnit>).transpose().map_err(raised)?,
            up: axis(&self.up)?,
            front: axis(&self.front)?,
            is_mirrored: self.mirror,
        })
    }
}
