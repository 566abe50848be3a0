//! Strands: polylines with widths and colors.

use crate::{
    TressesError,
    arrays::{
        array, floats, given_floats, given_integers, given_numbers_for, given_pairs, given_points,
        given_points_for, given_triples, points,
    },
    attributes,
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
use tresses::groom::{self, MAX_VERTICES, export::Writer, lint, orient::LengthUnit, strands::Mark};

/// Hair strands as polylines, root first.
///
/// Coordinates are meters, right-handed, Y up, face toward +Z.
///
/// Parameters
/// ----------
/// positions : array [n, v, 3] or [all, 3]
///     Vertices, meters. The flat form requires `offsets`.
/// offsets : array of int [n + 1], optional
///     Strand ``i`` has the vertices ``offsets[i]`` to ``offsets[i + 1]``.
/// widths : number, or array [n, v] or [all], optional
///     Diameters, meters.
/// colors : array [3], [n, v, 3] or [all, 3], optional
///     Linear sRGB.
/// root_uvs : array [n, 2], optional
///     Texture coordinates of the roots on the scalp.
/// guides : array of bool [n], optional
///     Strands that are guides, which the others follow. They are simulated.
/// ids : array of int [n], optional
///     Number of each strand, to which `closest` refers. The index by default.
/// groups : array of int [n], optional
///     Group of each strand, 0 by default.
/// closest : array of int [n, k], optional
///     Numbers of up to three guides that each strand follows. A strand without them follows the nearest.
/// weights : array [n, k], optional
///     Share of each guide in `closest`; equal by default.
/// attributes : dict of str to array, optional
///     Custom attributes, which files keep by name: [n] or [n, k] per strand, [all] or [all, k] per vertex, with up to
///     4 numbers a value.
#[pyclass(frozen, module = "tresses")]
pub struct Strands(pub groom::Strands);

#[pymethods]
impl Strands {
    #[new]
    #[pyo3(signature = (positions, offsets=None, widths=None, colors=None, root_uvs=None, *, guides=None, ids=None,
        groups=None, closest=None, weights=None, attributes=None))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn new(
        positions: &Bound<'_, PyAny>,
        offsets: Option<&Bound<'_, PyAny>>,
        widths: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        root_uvs: Option<&Bound<'_, PyAny>>,
        guides: Option<&Bound<'_, PyAny>>,
        ids: Option<&Bound<'_, PyAny>>,
        groups: Option<&Bound<'_, PyAny>>,
        closest: Option<&Bound<'_, PyAny>>,
        weights: Option<&Bound<'_, PyAny>>,
        attributes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (shape, positions) = given_points(positions, "positions")?;
        let count = positions.len();
        if count as u64 > MAX_VERTICES {
            return Err(TressesError::new_err(format!(
                "there are {count} vertices, but at most {MAX_VERTICES} are supported"
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
        if [guides, ids, groups, closest, weights].iter().any(Option::is_some) {
            strands.marks = marks(strands.len(), [guides, ids, groups, closest], weights)?;
        }
        if let Some(attributes) = attributes {
            strands.attributes = attributes::given(attributes, &strands)?;
        }
        Ok(Self(strands))
    }

    /// Create strands from a list of arrays [v, 3]; v may differ.
    #[staticmethod]
    fn of(lines: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut strands = groom::Strands { offsets: vec![0], ..Default::default() };
        for line in lines.try_iter()? {
            let (shape, line) = given_points(&line?, "vertices of a strand")?;
            if shape.len() != 1 {
                return Err(TressesError::new_err("each strand must be an array [v, 3]"));
            }
            if (strands.positions.len() + line.len()) as u64 > MAX_VERTICES {
                return Err(TressesError::new_err(format!(
                    "there are more than {MAX_VERTICES} vertices, which is the limit"
                )));
            }
            strands.push(&line);
        }
        Ok(Self(strands))
    }

    /// Write a file. Its extension selects the format, one of ``formats()["written"]``.
    ///
    /// Parameters
    /// ----------
    /// file : path
    ///     File to create or replace.
    /// unit : str, optional
    ///     Unit of the file, such as ``"cm"`` for Unreal and Maya, for the formats in ``formats()["any_unit"]``.
    /// oriented : bool
    ///     Whether the file declares meters, Y up, face toward +Z. Set it to False for strands with other axes or
    ///     units.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     Data that the format cannot store.
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
                Some(unit) => Some(unit.parse::<LengthUnit>()?),
                None => oriented.then_some(LengthUnit(1.0)),
            };
            let encoded = Writer::of(&file)?.strands(&self.0, unit)?;
            std::fs::write(&file, &encoded.bytes)
                .map_err(|error| anyhow::anyhow!("{}: {error}", file.display()))?;
            Ok(encoded.notes)
        })
        .map_err(raised)
    }

    /// Check the strands and return a list of Finding, the most severe first. `head`, the mesh they grow on, also
    /// enables checks for roots that are off the head.
    #[pyo3(signature = (head=None))]
    fn lint(&self, py: Python<'_>, head: Option<&Mesh>) -> PyResult<Vec<Py<Finding>>> {
        let report = py.detach(|| lint::check(&self.0, head.map(|head| &head.0)));
        Finding::all(py, &report)
    }

    /// Return repaired strands and a dict of counts.
    ///
    /// The repair removes repeated vertices and vertices that are not finite, drops strands without length or with a
    /// single vertex, and resamples strands with more vertices than can be drawn. The counts are ``dropped_strands``,
    /// ``merged_vertices`` (all removed vertices) and ``resampled_strands``.
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

    /// Vertices of all strands, concatenated, meters: float32 [all, 3].
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.positions)
    }

    /// Offsets of the strands in `positions`: strand ``i`` has the vertices ``offsets[i]`` to ``offsets[i + 1]``. int64
    /// [n + 1].
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let offsets: Vec<_> = self.0.offsets.iter().map(|offset| i64::from(*offset)).collect();
        let offsets = if offsets.is_empty() { vec![0] } else { offsets };
        array(py, &[offsets.len()], offsets)
    }

    /// Diameters at the vertices, meters: float32 [all], or None.
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

    /// Texture coordinates of the roots on the scalp: float32 [n, 2], or None.
    #[getter]
    fn root_uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        let uvs = &self.0.root_uvs;
        (!uvs.is_empty()).then(|| floats(py, &[uvs.len(), 2], uvs)).transpose()
    }

    /// Whether each strand is a guide: bool [n], or None.
    #[getter]
    fn guides<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<bool>>>> {
        self.marked(py, &[], |mark| [mark.guide])
    }

    /// Numbers of the strands, to which `closest` refers: int32 [n], or None.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<i32>>>> {
        self.marked(py, &[], |mark| [mark.id])
    }

    /// Groups of the strands: int32 [n], or None.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<i32>>>> {
        self.marked(py, &[], |mark| [mark.group])
    }

    /// Numbers of the guides that each strand follows: int32 [n, 3], or None.
    #[getter]
    fn closest<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<i32>>>> {
        self.marked(py, &[3], |mark| mark.closest)
    }

    /// Share of each guide in `closest`: float32 [n, 3], or None.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        self.marked(py, &[3], |mark| mark.weights)
    }

    /// Custom attributes: a dict of names to arrays, [n] or [n, k] per strand, [all] or [all, k] per vertex.
    #[getter]
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        attributes::dict(py, &self.0.attributes)
    }

    /// Lengths of the polylines, meters: float32 [n].
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        array(py, &[self.0.len()], (0..self.0.len()).map(|i| self.0.length(i)).collect())
    }

    /// Return the vertices as float32 [n, v, 3], meters. Raises TressesError if strands differ in their number of
    /// vertices.
    fn grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let strands = &self.0;
        let each = strands.iter().next().map_or(0, <[_]>::len);
        if strands.iter().any(|strand| strand.len() != each) {
            let why = "strands differ in their number of vertices: use positions and offsets";
            return Err(TressesError::new_err(why));
        }
        floats(py, &[strands.len(), each, 3], &strands.positions)
    }

    /// Return the strands as a list of arrays [v, 3].
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let lines: Vec<_> = self.0.iter().map(|strand| points(py, strand)).collect::<PyResult<_>>()?;
        PyList::new(py, lines)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let count = self.0.len();
        let strand_index = if index < 0 { index.checked_add_unsigned(count) } else { Some(index) };
        let strand_index = strand_index.and_then(|i| usize::try_from(i).ok()).filter(|i| *i < count);
        let strand_index = strand_index.ok_or_else(|| {
            PyIndexError::new_err(format!("index {index} is out of range: there are {count} strands"))
        })?;
        points(py, self.0.strand(strand_index))
    }

    fn __repr__(&self) -> String {
        format!("Strands({} strands, {} vertices)", self.0.len(), self.0.positions.len())
    }
}

impl Strands {
    /// Returns a mark of each strand, with further axes `each`; `None` without marks.
    fn marked<'py, T: numpy::Element, const N: usize>(
        &self,
        py: Python<'py>,
        each: &[usize],
        of: impl Fn(&Mark) -> [T; N],
    ) -> PyResult<Option<Bound<'py, PyArrayDyn<T>>>> {
        let marks = &self.0.marks;
        let shape = [&[marks.len()], each].concat();
        (!marks.is_empty()).then(|| array(py, &shape, marks.iter().flat_map(of).collect())).transpose()
    }
}

/// Converts marks of `count` strands: guides, ids, groups and closest guides, and the weights of these.
fn marks(
    count: usize,
    [guides, ids, groups, closest]: [Option<&Bound<'_, PyAny>>; 4],
    weights: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Mark>> {
    let number = |number: i64, what: &str| {
        i32::try_from(number)
            .map_err(|_| TressesError::new_err(format!("{what} has the number {number}, which is too large")))
    };
    let given = |of: &Bound<'_, PyAny>, what: &str| -> PyResult<Vec<i32>> {
        let (shape, values) = given_integers(of, what)?;
        if shape != [count] {
            let why = format!("{what} have the shape {shape:?}, but must have [{count}]");
            return Err(TressesError::new_err(why));
        }
        values.into_iter().map(|value| number(value, what)).collect()
    };
    let mut marks: Vec<Mark> = (0..count as i32).map(|id| Mark { id, ..Mark::default() }).collect();
    if let Some(guides) = guides {
        marks.iter_mut().zip(given(guides, "guides")?).for_each(|(mark, guide)| mark.guide = guide != 0);
    }
    if let Some(ids) = ids {
        marks.iter_mut().zip(given(ids, "ids")?).for_each(|(mark, id)| mark.id = id);
    }
    if let Some(groups) = groups {
        marks.iter_mut().zip(given(groups, "groups")?).for_each(|(mark, group)| mark.group = group);
    }
    match (closest, weights) {
        (Some(closest), weights) => {
            let (shape, numbers) = given_integers(closest, "closest")?;
            let each = shape.get(1).copied().unwrap_or(1);
            let numbers =
                numbers.into_iter().map(|value| number(value, "closest")).collect::<PyResult<Vec<_>>>()?;
            let default_weight = 1.0 / each.max(1) as f32;
            let weights = match weights {
                Some(weights) => given_floats(weights, "weights")?,
                None => (shape.clone(), vec![default_weight; numbers.len()]),
            };
            let closest = given_triples((shape, numbers), "closest", count, 0)?;
            let weights = given_triples(weights, "weights", count, 0.0)?;
            for ((mark, mut closest), weights) in marks.iter_mut().zip(closest).zip(weights) {
                // Unused places repeat the first guide: 0 could be the number of another.
                (each..3).for_each(|slot| closest[slot] = closest[0]);
                (mark.closest, mark.weights) = (closest, weights);
            }
        }
        (None, Some(_)) => return Err(TressesError::new_err("weights need the guides in closest")),
        (None, None) => {}
    }
    Ok(marks)
}

/// Checks the offsets of strands among `count` vertices.
fn checked(offsets: Vec<i64>, count: usize) -> PyResult<Vec<u32>> {
    let fit = offsets.first() == Some(&0)
        && offsets.last().is_some_and(|last| usize::try_from(*last).is_ok_and(|last| last == count))
        && offsets.windows(2).all(|pair| pair[0] <= pair[1]);
    if !fit {
        let why = format!(
            "offsets must begin with 0, never decrease, and end with {count}, the number of vertices"
        );
        return Err(TressesError::new_err(why));
    }
    Ok(offsets.into_iter().map(|offset| offset as u32).collect())
}

/// A problem that `Strands.lint` or `read` found in a groom.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Finding {
    /// Kind of problem, in words.
    pub kind: &'static str,
    /// ``"note"``, ``"warning"`` or ``"error"``.
    pub severity: &'static str,
    /// Number of occurrences.
    pub count: usize,
    /// Index of the first affected strand, or None.
    pub first_strand: Option<usize>,
    /// Meaning of the problem in this groom.
    pub detail: String,
    /// How the importer handles it.
    pub action: String,
}

#[pymethods]
impl Finding {
    fn __repr__(&self) -> String {
        format!("Finding({}: {} {}: {})", self.severity, self.count, self.kind, self.detail)
    }
}

impl Finding {
    /// Converts the findings of a report.
    pub fn all(py: Python<'_>, report: &lint::LintReport) -> PyResult<Vec<Py<Self>>> {
        let one = |finding: &lint::Finding| {
            let lint::Finding { kind, severity, count, first_strand, detail, action } = finding;
            let (detail, action) = (detail.clone(), action.clone());
            let (kind, severity) = (kind.name(), severity.name());
            Py::new(py, Self { kind, severity, count: *count, first_strand: *first_strand, detail, action })
        };
        report.findings.iter().map(one).collect()
    }
}
