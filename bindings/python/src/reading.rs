//! Reading files, with a report of the import.

use crate::{
    TressesError,
    files::{Orientation, paths},
    mesh::Mesh,
    raised,
    strands::{Finding, Strands},
};
use pyo3::{prelude::*, types::PyDict};
use tresses::groom::{
    export::Writer,
    formats::{self as endings, ContentKind},
    import,
    orient::Placement,
};

/// Contents of imported files, in meters, Y up, face toward +Z.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Import {
    /// Imported strands.
    pub strands: Py<Strands>,
    /// Head mesh, or None.
    pub head: Option<Py<Mesh>>,
    /// Problems of the groom before its repair: a list of Finding.
    pub findings: Vec<Py<Finding>>,
    /// Steps of the import with their reasons, and doubts: a list of str.
    pub notes: Vec<String>,
    /// Transform of the groom to meters, Y up, face +Z: a dict with unit (meters), up, front, mirrored and translation.
    pub placement: Py<PyDict>,
    /// The same for the head, or None.
    pub head_placement: Option<Py<PyDict>>,
}

fn placed(py: Python<'_>, placement: &Placement) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("unit", placement.unit.0)?;
    dict.set_item("up", placement.up.name())?;
    dict.set_item("front", placement.front.name())?;
    dict.set_item("mirrored", placement.mirrored)?;
    dict.set_item("translation", placement.translation.to_array())?;
    Ok(dict.unbind())
}

/// Read a groom from one or more files, which are joined, and optionally the head it grows on.
///
/// ``formats()`` lists the file extensions.
///
/// Parameters
/// ----------
/// files : path or list of paths
///     Files of the groom.
/// head : path or list of paths, optional
///     Mesh that the hair grows on. The importer uses groom and head to orient each other.
/// unit, up, front, mirror, head_unit, head_up, head_front : optional
///     Known units (``"cm"``, or meters per unit) and axes (``"z"``, ``"-y"``); the importer guesses the others.
/// frame : int, optional
///     Frame of an animated file; the first by default.
/// lenient : bool
///     Whether to keep numbers that are not finite, so that `Strands.lint` finds them.
/// repair : bool
///     Whether to repair invalid data, such as strands without length and repeated vertices.
///
/// Returns
/// -------
/// Import
#[pyfunction]
#[pyo3(signature = (files, head=None, *, unit=None, up=None, front=None, mirror=None, head_unit=None, head_up=None,
    head_front=None, frame=None, lenient=false, repair=true))]
#[allow(clippy::too_many_arguments)] // Python keyword arguments.
pub fn read(
    py: Python<'_>,
    files: &Bound<'_, PyAny>,
    head: Option<&Bound<'_, PyAny>>,
    unit: Option<String>,
    up: Option<String>,
    front: Option<String>,
    mirror: Option<bool>,
    head_unit: Option<String>,
    head_up: Option<String>,
    head_front: Option<String>,
    frame: Option<u32>,
    lenient: bool,
    repair: bool,
) -> PyResult<Import> {
    let (files, heads) = (paths(files)?, head.map(paths).transpose()?.unwrap_or_default());
    let options = import::ImportOptions {
        orient: Orientation { unit, up, front, mirror }.choice()?,
        orient_head: Orientation { unit: head_unit, up: head_up, front: head_front, mirror: None }
            .choice()?,
        allows_non_finite: lenient,
        skips_repair: !repair,
        moment: frame.map_or(import::Moment::First, import::Moment::Frame),
    };
    let (strands, head, report) =
        py.detach(|| import::read_complete(&files, &heads, &options)).map_err(raised)?;
    let placements = || std::iter::once(&report.placement).chain(&report.head_placement);
    let mut notes: Vec<String> = report.files.iter().flat_map(|file| file.notes.clone()).collect();
    notes.extend(placements().flat_map(|placement| placement.reasons.clone()));
    notes.extend(
        placements().flat_map(|placement| &placement.doubts).map(|doubt| format!("uncertain: {doubt}")),
    );
    Ok(Import {
        strands: Py::new(py, Strands(strands))?,
        head: head.map(|head| Py::new(py, Mesh(head))).transpose()?,
        findings: Finding::all(py, &report.lint)?,
        notes,
        placement: placed(py, &report.placement)?,
        head_placement: report.head_placement.as_ref().map(|placement| placed(py, placement)).transpose()?,
    })
}

/// Return the supported file extensions.
///
/// Returns
/// -------
/// dict
///     Lists of str: ``grooms`` and ``heads`` (read), ``written`` (strands), ``meshes_written`` (meshes), and
///     ``any_unit`` (written in any unit, not only meters).
#[pyfunction]
pub fn formats(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("grooms", endings::GROOMS)?;
    dict.set_item("written", endings::WRITTEN)?;
    dict.set_item("heads", endings::MESHES)?;
    let all = endings::FORMATS.iter().flat_map(|format| format.writers);
    let of = |kept: fn(&Writer) -> bool| {
        all.clone().filter(|it| kept(it)).map(|it| it.extension).collect::<Vec<_>>()
    };
    dict.set_item("meshes_written", of(|writer| writer.holds(ContentKind::Mesh)))?;
    dict.set_item("any_unit", of(|writer| writer.any_unit))?;
    Ok(dict)
}

/// Returns the error for an unknown keyword argument.
pub fn unknown(key: &str, known: impl Iterator<Item = &'static str>) -> PyErr {
    let known: Vec<_> = known.collect();
    TressesError::new_err(format!("there is no companion file {key}; choose {}", known.join(", ")))
}
