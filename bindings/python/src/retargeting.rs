//! Grooms on other heads.

use crate::{arrays::given_points, mesh::Mesh, raised, strands::Strands};
use pyo3::{prelude::*, types::PyDict};
use tresses::groom::retarget::{Landmark, retarget as fitted};

/// Fit strands that were made on one head to another.
///
/// Each strand keeps its shape and its lengths, turns with the skin at its root, and is pushed out of the other head.
/// Heads with the same triangles correspond by their vertices; others are matched.
///
/// Parameters
/// ----------
/// strands : Strands
///     Strands on `head`.
/// head, other : Mesh
///     Head that the strands were made on, and head that they are for.
/// landmarks : (array [n, 3], array [n, 3]), optional
///     Points of both heads that correspond, meters.
///
/// Returns
/// -------
/// Strands
///     In the order of `strands`, with their widths, colors and marks.
/// dict
///     ``same_topology``; ``skin_error``, the mean distance of the matched skins (meters); ``inside``, the share of vertices
///     deeper than 1 mm, and ``inside_before`` they were pushed out; ``bend``, the mean change of the angles between
///     segments (radians); ``apart``, the mean change of distances between neighbors (meters).
#[pyfunction]
#[pyo3(signature = (strands, head, other, landmarks=None))]
pub fn retarget<'py>(
    py: Python<'py>,
    strands: &Strands,
    head: &Mesh,
    other: &Mesh,
    landmarks: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
) -> PyResult<(Strands, Bound<'py, PyDict>)> {
    let landmarks = match landmarks {
        Some((from, to)) => {
            let (_, from) = given_points(&from, "landmarks of the head")?;
            let (_, to) = given_points(&to, "landmarks of the other head")?;
            if from.len() != to.len() {
                let why =
                    format!("there are {} landmarks of the head, but {} of the other", from.len(), to.len());
                return Err(crate::TressesError::new_err(why));
            }
            from.into_iter().zip(to).map(|(from, to)| Landmark { from, to }).collect()
        }
        None => Vec::new(),
    };
    let (retargeted, report) =
        py.detach(|| fitted(&strands.0, &head.0, &other.0, &landmarks)).map_err(raised)?;
    let dict = PyDict::new(py);
    dict.set_item("same_topology", report.has_same_topology)?;
    dict.set_item("skin_error", report.skin_error)?;
    dict.set_item("inside", report.inside[1])?;
    dict.set_item("inside_before", report.inside[0])?;
    dict.set_item("bend", report.bend)?;
    dict.set_item("apart", report.spacing_change)?;
    Ok((Strands(retargeted), dict))
}
