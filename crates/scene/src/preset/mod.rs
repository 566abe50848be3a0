//! Presets: settings as one text file.
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
//! ```
//! Tables and keys are those of the [`knobs`](crate::knobs), numbers are in the knobs' units; missing keys have
//! their defaults. `[source]` says which hair it is for, and may be left out. A file with anything
//! unknown is rejected as a whole, in one sentence with line, key and allowed values, so that nothing is applied
//! partially.

mod read;
mod source;
mod write;

pub use write::Extent;

use crate::{settings::Settings, source::Source};
use std::path::Path;

/// The version of the format that this program writes, and the only one that it reads.
pub const VERSION: u32 = 1;

/// A preset.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preset {
    /// What it is called.
    pub name: Option<String>,
    /// Which hair it is for; file names are relative to the preset.
    pub source: Source,
    /// Everything else.
    pub settings: Settings,
}

/// Why a preset cannot be read, in one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{file}{}: {problem}", .line.map(|line| format!(" at line {line}")).unwrap_or_default())]
pub struct PresetError {
    /// The file.
    pub file: String,
    /// The line in it, counted from 1, where one is to blame.
    pub line: Option<usize>,
    /// One clause.
    pub problem: String,
}

impl Preset {
    /// The preset that `text` holds; `file` is what its errors call it.
    ///
    /// # Errors
    /// The first thing that it does not understand.
    pub fn read(text: &str, file: &str) -> Result<Self, PresetError> {
        read::read(text).map_err(|read::Problem { line, problem }| PresetError {
            file: file.to_owned(),
            line,
            problem,
        })
    }

    /// The preset in the file at `path`. The names of other files in it are made relative to where the
    /// program runs.
    ///
    /// # Errors
    /// As [`read`](Self::read), and when there is no such file.
    pub fn open(path: &Path) -> Result<Self, PresetError> {
        let file = path.display().to_string();
        let problem = |problem: String| PresetError { file: file.clone(), line: None, problem };
        let bytes = std::fs::read(path).map_err(|error| problem(error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|_| problem("it is no text in UTF-8".into()))?;
        let mut preset = Self::read(&text, &file)?;
        preset.source = preset.source.inside(path.parent().unwrap_or(Path::new("")));
        Ok(preset)
    }

    /// Writes it to a file at `path`; the names of other files in it, which are relative to where the
    /// program runs, are written relative to the preset.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save(&self, path: &Path, extent: Extent) -> std::io::Result<()> {
        let text = self.text_at(path, extent)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        std::fs::create_dir_all(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        std::fs::write(path, text)
    }

    /// What [`save`](Self::save) would write to `path`.
    ///
    /// # Errors
    /// When it is not known where the program runs.
    pub fn text_at(&self, path: &Path, extent: Extent) -> std::io::Result<String> {
        let source = self.source.seen_from(path.parent().unwrap_or(Path::new("")))?;
        Ok(Self { source, ..self.clone() }.write(extent))
    }
}

#[cfg(test)]
mod tests;
