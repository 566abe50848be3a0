//! Paths and orientation of files, as keyword arguments have them.

use crate::raised;
use pyo3::{exceptions::PyTypeError, prelude::*};
use std::path::PathBuf;
use tresses::groom::orient::{Axis, Choice, Unit};

/// A path, or several: each a `str` or an `os.PathLike`.
pub fn paths(of: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    if let Ok(path) = of.extract::<PathBuf>() {
        return Ok(vec![path]);
    }
    let several = of.try_iter().map_err(|_| PyTypeError::new_err("files are a path or a list of paths"))?;
    several.map(|path| path?.extract()).collect()
}

/// What is known of a file's unit and axes, in words.
#[derive(Default)]
pub struct Orientation {
    /// `cm`, or metres per unit.
    pub unit: Option<String>,
    /// `y`, `-z`.
    pub up: Option<String>,
    /// Likewise.
    pub front: Option<String>,
    /// Whether the file is a mirror image.
    pub mirror: Option<bool>,
}

impl Orientation {
    /// As the library has it.
    pub fn choice(&self) -> PyResult<Choice> {
        let axis =
            |text: &Option<String>| text.as_deref().map(str::parse::<Axis>).transpose().map_err(raised);
        Ok(Choice {
            unit: self.unit.as_deref().map(str::parse::<Unit>).transpose().map_err(raised)?,
            up: axis(&self.up)?,
            front: axis(&self.front)?,
            mirror: self.mirror,
        })
    }
}
