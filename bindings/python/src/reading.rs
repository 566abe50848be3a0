//! Files in, and what was done with them.

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
    formats::{self as endings, Content},
    import,
    orient::Placement,
};

/// What files held, in metres, Y up, face towards +Z.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Import {
    /// The strands.
    pub strands: Py<Strands>,
    /// The head, or None.
    pub head: Option<Py<Mesh>>,
    /// What is odd about the groom, before it was repaired: a list of Finding.
    pub findings: Vec<Py<Finding>>,
    /// What was done on the way, why, and what is in doubt: a list of str.
    pub notes: Vec<String>,
    /// How the groom came into metres, Y up, face +Z: a dict with unit (metres), up, front, mirrored and translation.
    pub placement: Py<PyDict>,
    /// The same of the head, or None.
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

/// Reads one groom from one or more files, which are joined (`formats()` lists their endings), and if it is given the head
/// that it grows on.
///
/// Parameters
/// ----------
/// files : path or list of paths
///     The groom.
/// head : path or list of paths, optional
///     The mesh that it grows on; groom and head orient each other.
/// unit, up, front, mirror, head_unit, head_up, head_front : optional
///     What is known of units (``"cm"``, or metres per unit) and axes (``"z"``, ``"-y"``); the rest is guessed.
/// frame : int, optional
///     Which frame of an animated file is read; the first without it.
/// lenient : bool
///     Whether numbers that are not finite are kept, for `Strands.lint` to find.
/// repair : bool
///     Whether what cannot be used is repaired: strands without length, vertices that repeat.
///
/// Returns
/// -------
/// Import
#[pyfunction]
#[pyo3(signature = (files, head=None, *, unit=None, up=None, front=None, mirror=None, head_unit=None, head_up=None,
    head_front=None, frame=None, lenient=false, repair=true))]
#[allow(clippy::too_many_arguments)] // Keywords.
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
        lenient,
        unrepaired: !repair,
        moment: frame.map_or(import::Moment::First, import::Moment::Frame),
    };
    let (strands, head, report) =
        py.detach(|| import::read_whole(&files, &heads, &options)).map_err(raised)?;
    let placements = || std::iter::once(&report.placement).chain(&report.head_placement);
    let mut notes: Vec<String> = report.files.iter().flat_map(|file| file.notes.clone()).collect();
    notes.extend(placements().flat_map(|placement| placement.reasons.clone()));
    notes.extend(
        placements().flat_map(|placement| &placement.doubts).map(|doubt| format!("in doubt: {doubt}")),
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

/// The endings of files: a dict of ``grooms`` and ``heads`` (read), ``written``, ``meshes_written`` and, of those, ``any_unit``
/// (written in other units than metres, too).
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
    dict.set_item("meshes_written", of(|writer| writer.holds(Content::Mesh)))?;
    dict.set_item("any_unit", of(|writer| writer.any_unit))?;
    Ok(dict)
}

/// For keywords that nobody knows.
pub fn unknown(key: &str, known: impl Iterator<Item = &'static str>) -> PyErr {
    let known: Vec<_> = known.collect();
    TressesError::new_err(format!("there is no file called {key}; there are {}", known.join(", ")))
}
