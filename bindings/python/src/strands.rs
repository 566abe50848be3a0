//! Strands: lines of any number of vertices, with widths and colours.

use crate::{
    TressesError,
    arrays::{
        array, floats, given_integers, given_numbers_for, given_pairs, given_points, given_points_for, points,
    },
    mesh::Mesh,
    raised,
};
use numpy::PyArrayDyn;
use pyo3::{
    exceptions::PyIndexError,
    prelude::*,
    types::{PyDict, PyList},
};
use std::path::PathBuf;
use tresses::groom::{self, MAX_VERTICES, export::Writer, lint, orient::Unit};

/// Strands of hair: lines, root first.
///
/// Metres, right-handed, Y up, the face towards +Z.
///
/// Parameters
/// ----------
/// positions : array [n, v, 3] or [all, 3]
///     Vertices, metres; flat ones take offsets.
/// offsets : array of int [n + 1], optional
///     Strand ``i`` has the vertices ``offsets[i]`` to ``offsets[i + 1]``.
/// widths : number, or array [n, v] or [all], optional
///     Diameters, metres.
/// colors : array [3], [n, v, 3] or [all, 3], optional
///     Linear sRGB.
/// root_uvs : array [n, 2], optional
///     Where each grows, in texture coordinates of the scalp.
#[pyclass(frozen, module = "tresses")]
pub struct Strands(pub groom::Strands);

#[pymethods]
impl Strands {
    #[new]
    #[pyo3(signature = (positions, offsets=None, widths=None, colors=None, root_uvs=None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        offsets: Option<&Bound<'_, PyAny>>,
        widths: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        root_uvs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (shape, positions) = given_points(positions, "positions")?;
        let count = positions.len();
        if count as u64 > MAX_VERTICES {
            return Err(TressesError::new_err(format!(
                "there are {count} vertices, but at most {MAX_VERTICES} fit"
            )));
        }
        let offsets = match (offsets, &shape[..]) {
            (None, [strands, each]) => (0..=*strands).map(|i| (i * each) as u32).collect(),
            (None, _) => {
                let shape = "positions must be [n, v, 3], or [all, 3] with offsets";
                return Err(TressesError::new_err(shape));
            }
            (Some(offsets), _) => checked(given_integers(offsets, "offsets")?.1, count)?,
        };
        let mut strands = groom::Strands { offsets, positions, ..Default::default() };
        if let Some(widths) = widths {
            let widths = given_numbers_for(widths, "widths", count)?;
            strands.radii = widths.into_iter().map(|width| 0.5 * width).collect();
        }
        if let Some(colors) = colors {
            strands.colors = given_points_for(colors, "colors", count)?;
        }
        if let Some(uvs) = root_uvs {
            strands.root_uvs = given_pairs(uvs, "root_uvs", strands.len())?;
        }
        Ok(Self(strands))
    }

    /// Strands of a list of arrays [v, 3], which may differ in v.
    #[staticmethod]
    fn of(lines: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut strands = groom::Strands { offsets: vec![0], ..Default::default() };
        for line in lines.try_iter()? {
            let (shape, line) = given_points(&line?, "vertices of a strand")?;
            if shape.len() != 1 {
                return Err(TressesError::new_err("each strand must be an array [v, 3]"));
            }
            if (strands.positions.len() + line.len()) as u64 > MAX_VERTICES {
                return Err(TressesError::new_err(format!("there are more than {MAX_VERTICES} vertices")));
            }
            strands.push(&line);
        }
        Ok(Self(strands))
    }

    /// Writes a file, whose ending says the format (`formats()["written"]`).
    ///
    /// Parameters
    /// ----------
    /// file : path
    ///     Replaced if there is one.
    /// unit : str, optional
    ///     The unit of the file, for formats that can be in any (``formats()["any_unit"]``): ``"cm"`` for Unreal and Maya.
    /// oriented : bool
    ///     Whether the file says that it is in metres, Y up, face towards +Z; False for strands that are not.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     What the format has no place for.
    #[pyo3(signature = (file, *, unit=None, oriented=true))]
    fn write(
        &self,
        py: Python<'_>,
        file: PathBuf,
        unit: Option<String>,
        oriented: bool,
    ) -> PyResult<Vec<String>> {
        py.detach(|| -> anyhow::Result<Vec<String>> {
            let unit = match unit {
                Some(unit) => Some(unit.parse::<Unit>()?),
                None => oriented.then_some(Unit(1.0)),
            };
            let encoded = Writer::of(&file)?.strands(&self.0, unit)?;
            std::fs::write(&file, &encoded.bytes)
                .map_err(|error| anyhow::anyhow!("{}: {error}", file.display()))?;
            Ok(encoded.notes)
        })
        .map_err(raised)
    }

    /// What is odd about them, the worst first: a list of Finding. With the head they grow on also roots that are not on it.
    #[pyo3(signature = (head=None))]
    fn lint(&self, py: Python<'_>, head: Option<&Mesh>) -> PyResult<Vec<Py<Finding>>> {
        let report = py.detach(|| lint::check(&self.0, head.map(|head| &head.0)));
        Finding::all(py, &report)
    }

    /// The same without what cannot be used: strands without length or of one vertex, numbers that are not finite, vertices
    /// that repeat, more vertices than can be drawn. Returns the strands and a dict of what was done.
    fn repaired<'py>(&self, py: Python<'py>) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let (strands, done) = py.detach(|| {
            let mut strands = self.0.clone();
            let done = lint::repair(&mut strands);
            (strands, done)
        });
        let dict = PyDict::new(py);
        dict.set_item("dropped_strands", done.dropped_strands)?;
        dict.set_item("merged_vertices", done.merged_vertices)?;
        dict.set_item("resampled_strands", done.resampled_strands)?;
        Ok((Self(strands), dict))
    }

    /// Vertices of all strands, one after the other, metres: float32 [all, 3].
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.positions)
    }

    /// Strand ``i`` has the vertices ``offsets[i]`` to ``offsets[i + 1]``: int64 [n + 1].
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let offsets: Vec<_> = self.0.offsets.iter().map(|offset| i64::from(*offset)).collect();
        let offsets = if offsets.is_empty() { vec![0] } else { offsets };
        array(py, &[offsets.len()], offsets)
    }

    /// Diameters at the vertices, metres: float32 [all], or None.
    #[getter]
    fn widths<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        let widths: Vec<f32> = self.0.radii.iter().map(|radius| 2.0 * radius).collect();
        (!widths.is_empty()).then(|| array(py, &[widths.len()], widths)).transpose()
    }

    /// Linear sRGB at the vertices: float32 [all, 3], or None.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        (!self.0.colors.is_empty()).then(|| points(py, &self.0.colors)).transpose()
    }

    /// Where each grows, in texture coordinates of the scalp: float32 [n, 2], or None.
    #[getter]
    fn root_uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        let uvs = &self.0.root_uvs;
        (!uvs.is_empty()).then(|| floats(py, &[uvs.len(), 2], uvs)).transpose()
    }

    /// Lengths along the segments, metres: float32 [n].
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        array(py, &[self.0.len()], (0..self.0.len()).map(|i| self.0.length(i)).collect())
    }

    /// Vertices of strands that all have as many, metres: float32 [n, v, 3]. TressesError where they have not.
    fn grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let strands = &self.0;
        let each = strands.iter().next().map_or(0, <[_]>::len);
        if strands.iter().any(|strand| strand.len() != each) {
            let why = "the strands differ in their numbers of vertices: use positions and offsets";
            return Err(TressesError::new_err(why));
        }
        floats(py, &[strands.len(), each, 3], &strands.positions)
    }

    /// A list of arrays [v, 3].
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let lines: Vec<_> = self.0.iter().map(|strand| points(py, strand)).collect::<PyResult<_>>()?;
        PyList::new(py, lines)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let count = self.0.len();
        let place = if index < 0 { index.checked_add_unsigned(count) } else { Some(index) };
        let place = place.and_then(|i| usize::try_from(i).ok()).filter(|i| *i < count);
        let place =
            place.ok_or_else(|| PyIndexError::new_err(format!("there are {count} strands, no {index}")))?;
        points(py, self.0.strand(place))
    }

    fn __repr__(&self) -> String {
        format!("Strands({} strands, {} vertices)", self.0.len(), self.0.positions.len())
    }
}

/// Offsets of strands among `count` vertices.
fn checked(offsets: Vec<i64>, count: usize) -> PyResult<Vec<u32>> {
    let fit = offsets.first() == Some(&0)
        && offsets.last().is_some_and(|last| usize::try_from(*last).is_ok_and(|last| last == count))
        && offsets.windows(2).all(|pair| pair[0] <= pair[1]);
    if !fit {
        let why =
            format!("offsets must begin with 0, never fall, and end with {count}, the number of vertices");
        return Err(TressesError::new_err(why));
    }
    Ok(offsets.into_iter().map(|offset| offset as u32).collect())
}

/// One thing that is odd about a groom.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Finding {
    /// What, in words.
    pub kind: &'static str,
    /// ``"note"``, ``"warning"`` or ``"error"``.
    pub severity: &'static str,
    /// How often.
    pub count: usize,
    /// The first strand it is about, where it is about strands.
    pub first_strand: Option<usize>,
    /// What it means here.
    pub detail: String,
    /// What is done about it.
    pub action: String,
}

#[pymethods]
impl Finding {
    fn __repr__(&self) -> String {
        format!("Finding({}: {} {}: {})", self.severity, self.count, self.kind, self.detail)
    }
}

impl Finding {
    /// Those of a report.
    pub fn all(py: Python<'_>, report: &lint::Report) -> PyResult<Vec<Py<Self>>> {
        let one = |finding: &lint::Finding| {
            let lint::Finding { kind, severity, count, first_strand, detail, action } = finding;
            let (detail, action) = (detail.clone(), action.clone());
            let (kind, severity) = (kind.name(), severity.name());
            Py::new(py, Self { kind, severity, count: *count, first_strand: *first_strand, detail, action })
        };
        report.findings.iter().map(one).collect()
    }
}
