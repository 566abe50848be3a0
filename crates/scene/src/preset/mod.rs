//! Presets: settings as one TOML file.
//!
//! ```toml
//! version = 1
//! name = "storm"
//!
//! [source]
//! style = "long"
//!
//! [simulation]
//! drag = 5 # 1/s
//!
//! [wind]
//! speed = 14 # m/s
//!
//! [[lights.list]]
//! shape = "point"
//! position = [0.3, 1.6, 0.4] # m
//! intensity = 2
//! ```
//! Tables and keys are the sections and keys of [`knobs`](crate::knobs), and the keys of the [list of
//! lights](crate::knobs::light_list). Numbers use the units of the knobs; missing
//! keys take their defaults. The optional `[source]` table names the hair. A file with an unknown key or an invalid
//! value is rejected as a whole, so nothing is applied partially; the error names the line, the key and the allowed
//! values.

mod lights;
mod read;
mod source;
mod values;
mod write;

pub use write::Extent;

use crate::{settings::Settings, source::PresetSource};
use std::path::Path;

/// Format version that this crate writes, and the only one it reads.
pub const VERSION: u32 = 1;

/// Settings with an optional name and the hair they belong to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preset {
    /// Display name.
    pub name: Option<String>,
    /// Files or built-in style of the hair. File names in a preset file are relative to that file.
    pub source: PresetSource,
    /// All parameters.
    pub settings: Settings,
}

/// Error from reading a preset, formatted as one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{file}{}: {problem}", .line.map(|line| format!(" at line {line}")).unwrap_or_default())]
pub struct PresetError {
    /// Name of the file.
    pub file: String,
    /// Line number, counted from 1, if the error has one.
    pub line: Option<usize>,
    /// Description, one clause.
    pub problem: String,
    /// Why the file cannot be read, if that is the problem.
    pub source: Option<std::io::Error>,
}

impl Preset {
    /// Parses a preset from `text`. Errors use `file` as the file name.
    ///
    /// # Errors
    /// Returns the first problem found.
    pub fn read(text: &str, file: &str) -> Result<Self, PresetError> {
        read::read(text).map_err(|read::Problem { line, problem }| PresetError {
            file: file.to_owned(),
            line,
            problem,
            source: None,
        })
    }

    /// Reads the preset at `path`. File names in it become relative to the current directory.
    ///
    /// # Errors
    /// As [`read`](Self::read); also fails if the file cannot be read.
    pub fn open(path: &Path) -> Result<Self, PresetError> {
        let file = path.display().to_string();
        let failed =
            |problem: String, source| PresetError { file: file.clone(), line: None, problem, source };
        let bytes = std::fs::read(path).map_err(|error| failed(error.to_string(), Some(error)))?;
        let text = String::from_utf8(bytes).map_err(|_| failed("the file is not UTF-8 text".into(), None))?;
        let mut preset = Self::read(&text, &file)?;
        preset.source = preset.source.inside(path.parent().unwrap_or(Path::new("")));
        Ok(preset)
    }

    /// Writes the preset to `path`. File names, which are relative to the current directory, are written relative to
    /// the preset's folder.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn save(&self, path: &Path, extent: Extent) -> std::io::Result<()> {
        let text = self.text_at(path, extent)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        std::fs::create_dir_all(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        std::fs::write(path, text)
    }

    /// Returns the text that [`save`](Self::save) writes to `path`.
    ///
    /// # Errors
    /// Fails if the current directory is unknown.
    pub fn text_at(&self, path: &Path, extent: Extent) -> std::io::Result<String> {
        let source = self.source.relative_to(path.parent().unwrap_or(Path::new("")))?;
        Ok(Self { source, ..self.clone() }.write(extent))
    }
}

#[cfg(test)]
mod tests;
