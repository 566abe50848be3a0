//! Cards: textured ribbons in place of strands.

use crate::{
    TressesError,
    arrays::{array, floats, points},
    raised,
};
use numpy::PyArrayDyn;
use pyo3::{prelude::*, types::PyDict};
use std::path::PathBuf;
use tresses::groom::{
    Rig, TriMesh,
    cards::{self, CardAlpha},
};
use tresses_scene::{cards as files, settings::Settings};

/// A groom as textured cards with levels of detail. Create it with `Groom.cards`.
#[pyclass(frozen, module = "tresses")]
pub struct Cards {
    cards: cards::Cards,
    strands: usize,
    settings: Settings,
    body: Option<(TriMesh, Option<Rig>)>,
}

/// One level of detail of `Cards`.
#[pyclass(frozen, module = "tresses")]
pub struct CardLevel(cards::CardLevel);

impl Cards {
    pub fn new(
        cards: cards::Cards,
        strands: usize,
        settings: Settings,
        body: Option<(TriMesh, Option<Rig>)>,
    ) -> Self {
        Self { cards, strands, settings, body }
    }

    /// Returns the cards of the library.
    pub fn baked(&self) -> &cards::Cards {
        &self.cards
    }
}

#[pymethods]
impl Cards {
    /// Levels, from the finest: a list of CardLevel.
    #[getter]
    fn levels(&self) -> Vec<CardLevel> {
        self.cards.levels.iter().cloned().map(CardLevel).collect()
    }

    /// Textures that all levels share: a dict of uint8 arrays [size, size, channels], rows from the top. ``color``
    /// (sRGB, and coverage), ``surface`` (shade, roughness, 0), ``anisotropy`` (direction across the strands), and
    /// ``data`` (height over the card, position on the strand, random number, coverage).
    #[getter]
    fn textures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let textures = &self.cards.textures;
        let size = textures.size as usize;
        let dict = PyDict::new(py);
        for (name, values) in [("color", &textures.color), ("data", &textures.data)] {
            dict.set_item(name, array(py, &[size, size, 4], values.as_flattened().to_vec())?)?;
        }
        for (name, values) in [("surface", &textures.surface), ("anisotropy", &textures.anisotropy)] {
            dict.set_item(name, array(py, &[size, size, 3], values.as_flattened().to_vec())?)?;
        }
        Ok(dict)
    }

    /// Numbers of the bake: a dict, as ``tresses cards --report`` writes it.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = files::numbers(&self.cards, self.strands).to_string();
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Remarks about the result: a list of str.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.cards.notes.clone()
    }

    /// Write the cards: ``.glb`` with the head or body and all levels, or ``.obj`` with a file for each level and
    /// textures beside. Return the paths.
    ///
    /// Parameters
    /// ----------
    /// file : path
    ///     The file, or the stem of several.
    /// alpha : str
    ///     Drawing of partial coverage: ``"core"`` (an opaque core and a blended fringe), ``"mask"`` or ``"blend"``.
    /// split : bool
    ///     Whether ``.glb`` is a file for each level.
    #[pyo3(signature = (file, *, alpha="core", split=false))]
    fn save(&self, py: Python<'_>, file: PathBuf, alpha: &str, split: bool) -> PyResult<Vec<PathBuf>> {
        let alpha = match alpha {
            "core" => CardAlpha::Core,
            "mask" => CardAlpha::Mask,
            "blend" => CardAlpha::Blend,
            _ => {
                return Err(TressesError::new_err(format!(
                    "alpha is {alpha:?}, but must be core, mask or blend"
                )));
            }
        };
        py.detach(|| {
            let body = self.body.as_ref().map(|(mesh, rig)| (mesh, rig.as_ref()));
            let look = files::look(&self.settings, alpha);
            let format = files::CardFormat::of(&file, split)?;
            let written = format.encoded(&self.cards, body, &look, &file)?;
            for (path, bytes) in &written {
                std::fs::write(path, bytes)
                    .map_err(|error| anyhow::Error::new(error).context(path.display().to_string()))?;
            }
            Ok(written.into_iter().map(|(path, _)| path).collect())
        })
        .map_err(|error: anyhow::Error| raised(error))
    }

    fn __repr__(&self) -> String {
        let counts: Vec<_> = self.cards.levels.iter().map(cards::CardLevel::name).collect();
        format!("Cards({}, textures of {} texels)", counts.join(", "), self.cards.textures.size)
    }
}

#[pymethods]
impl CardLevel {
    /// Number of cards, 0 for a helmet.
    #[getter]
    fn cards(&self) -> u32 {
        self.0.cards
    }

    /// Whether the level is a helmet, an opaque shell.
    #[getter]
    fn helmet(&self) -> bool {
        self.0.helmet
    }

    /// Vertex positions, meters: float32 [n, 3].
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.mesh.positions)
    }

    /// Unit normals: float32 [n, 3].
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.mesh.normals)
    }

    /// Unit vectors across the strands: float32 [n, 3].
    #[getter]
    fn tangents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.mesh.tangents)
    }

    /// Texture coordinates from the top left: float32 [n, 2].
    #[getter]
    fn uvs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        floats(py, &[self.0.mesh.uvs.len(), 2], &self.0.mesh.uvs)
    }

    /// Light from all around that reaches each vertex, 0 to 1: float32 [n].
    #[getter]
    fn light<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        floats(py, &[self.0.mesh.light.len()], &self.0.mesh.light)
    }

    /// Vertex indices: int32 [m, 3].
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let indices = self.0.mesh.triangles.iter().flatten().map(|i| *i as i32).collect();
        array(py, &[self.0.mesh.triangles.len(), 3], indices)
    }

    /// First vertex of each card: int32 [cards].
    #[getter]
    fn starts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let starts = &self.0.mesh.starts;
        array(py, &[starts.len()], starts.iter().map(|i| *i as i32).collect())
    }

    /// Root of the hair at each vertex, meters: float32 [n, 3].
    #[getter]
    fn roots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.mesh.roots)
    }

    /// Strands of each card, as indices of `Groom.strands`: a list of int32 [k].
    #[getter]
    fn locks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArrayDyn<i32>>>> {
        let lock = |lock: &Vec<u32>| array(py, &[lock.len()], lock.iter().map(|i| *i as i32).collect());
        self.0.locks.iter().map(lock).collect()
    }

    fn __repr__(&self) -> String {
        format!("CardLevel({}, {} triangles)", self.0.name(), self.0.mesh.triangles.len())
    }
}
