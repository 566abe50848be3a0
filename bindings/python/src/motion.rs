//! Built-in motions and keyframe files.

use crate::{
    TressesError,
    pose::{pose_to_tuple, vector},
    raised,
};
use pyo3::{prelude::*, types::PyDict};
use tresses_scene::motion;

/// A motion of the character.
///
/// Parameters
/// ----------
/// name : str
///     ``"still"``, ``"nod"``, ``"turn"``, ``"shake"``, ``"walk"`` or ``"dance"``, or the path of a keyframe file
///     (.json).
#[pyclass(frozen, module = "tresses")]
pub struct Motion {
    name: String,
    motion: motion::Motion,
}

#[pymethods]
impl Motion {
    #[new]
    fn new(name: String) -> PyResult<Self> {
        Ok(Self { motion: motion::Motion::open(&name).map_err(raised)?, name })
    }

    /// Time from the first to the last key, seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.motion.duration()
    }

    /// Whether the motion loops.
    #[getter]
    fn repeats(&self) -> bool {
        self.motion.repeats()
    }

    /// Return the pose of the character at a time: a dict of ``head``, ``body`` and ``shapes``, as arguments of
    /// `Simulation.step`: ``sim.step(dt, **motion.at(time, sim.pivot))``.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Time, seconds.
    /// pivot : array [3]
    ///     Joint that the head turns about, meters: `Simulation.pivot`.
    fn at<'py>(&self, py: Python<'py>, time: f64, pivot: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
        if !time.is_finite() {
            return Err(TressesError::new_err(format!("time is {time}, but must be finite")));
        }
        let gesture = self.motion.gesture(time, vector(pivot, "pivot")?);
        let (dict, shapes) = (PyDict::new(py), PyDict::new(py));
        for (name, weight) in &gesture.shapes {
            shapes.set_item(&**name, *weight)?;
        }
        dict.set_item("head", pose_to_tuple(&gesture.head))?;
        dict.set_item("body", pose_to_tuple(&gesture.body))?;
        dict.set_item("shapes", shapes)?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("Motion({:?}, {} s)", self.name, self.motion.duration())
    }
}
