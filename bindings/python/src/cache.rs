//! Caches: files of strands that move.

use crate::{TressesError, arrays::given_points, raised, strands::Strands};
use pyo3::prelude::*;
use std::{fs::File, io::BufWriter, path::PathBuf};
use tresses::groom::{
    export::{self, CacheOptions, Writer},
    formats::ContentKind,
    orient::LengthUnit,
};

/// A file of moving strands, written frame by frame: Alembic (``.abc``) or USD (``.usda``).
///
/// A ``with`` block ends the file.
///
/// Parameters
/// ----------
/// file : path
///     File to create or replace.
/// strands : Strands
///     Strands at the first frame, with the widths, colors and marks to store.
/// frames : int
///     Number of frames that follow.
/// fps : float
///     Frames per second.
/// unit : str
///     Unit of the file, such as ``"cm"`` for Unreal and Maya.
#[pyclass(unsendable, module = "tresses")]
pub struct Cache {
    writer: Option<Box<dyn export::CacheWriter>>,
    file: PathBuf,
    left: u32,
}

#[pymethods]
impl Cache {
    #[new]
    #[pyo3(signature = (file, strands, frames, fps=24.0, *, unit="m"))]
    fn new(file: PathBuf, strands: &Strands, frames: u32, fps: f64, unit: &str) -> PyResult<Self> {
        if frames == 0 || !(fps.is_finite() && fps > 0.0) {
            return Err(TressesError::new_err("a cache needs frames, and frames per second above 0"));
        }
        let writer = Writer::holding(&file, ContentKind::Frames).map_err(raised)?;
        let options = CacheOptions { unit: unit.parse::<LengthUnit>().map_err(raised)?, rate: fps, frames };
        let named = |error| raised(anyhow::anyhow!("{}: {error}", file.display()));
        let out = Box::new(BufWriter::new(File::create(&file).map_err(named)?));
        let writer = writer.cache(out, &strands.0, options).map_err(named)?;
        Ok(Self { writer: Some(writer), file, left: frames })
    }

    /// Write the next frame: positions of all vertices, meters, array [n, v, 3] or [all, 3].
    fn frame(&mut self, positions: &Bound<'_, PyAny>) -> PyResult<()> {
        let (_, positions) = given_points(positions, "positions")?;
        if self.left == 0 {
            return Err(TressesError::new_err("the cache has all its frames already"));
        }
        let file = self.file.display().to_string();
        let writer = self.writer.as_mut().ok_or_else(|| TressesError::new_err("the cache has ended"))?;
        writer.frame(&positions).map_err(|error| raised(anyhow::anyhow!("{file}: {error}")))?;
        self.left -= 1;
        Ok(())
    }

    /// End the file. Raises TressesError if frames are missing.
    fn close(&mut self) -> PyResult<()> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        if self.left > 0 {
            let why = format!("{}: {} frames of the cache are missing", self.file.display(), self.left);
            return Err(TressesError::new_err(why));
        }
        writer.finish().map_err(|error| raised(anyhow::anyhow!("{}: {error}", self.file.display())))
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (kind=None, _error=None, _trace=None))]
    fn __exit__(
        &mut self,
        kind: Option<&Bound<'_, PyAny>>,
        _error: Option<&Bound<'_, PyAny>>,
        _trace: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if kind.is_some() {
            // The block has failed: its error is the one to tell.
            self.writer = None;
            return Ok(());
        }
        self.close()
    }

    fn __repr__(&self) -> String {
        format!("Cache({}, {} frames to write)", self.file.display(), self.left)
    }
}
