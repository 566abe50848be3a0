//! Built-in motions and keyframe files.

use crate::{
    TressesError,
    pose::{told, vector},
    raised,
};
use pyo3::{prelude::*, types::PyDict};
use tresses_scene::motion;

/// A motion of the character: ``"still"``, ``"nod"``, ``"turn"``, ``"shake"``, ``"walk"``, ``"dance"``, or a keyframe file
/// (.json).
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

    /// Seconds from the first to the last key.
    #[getter]
    fn duration(&self) -> f64 {
        self.motion.duration()
    }

    /// Whether it starts over after its duration.
    #[getter]
    fn repeats(&self) -> bool {
        self.motion.repeats()
    }

    /// What the character does at a time: a dict of ``head``, ``body`` and ``shapes``, for
    /// ``sim.step(dt, **motion.at(time, sim.pivot))``.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Seconds.
    /// pivot : array [3]
    ///     What the head turns about, metres: `Simulation.pivot`.
    fn at<'py>(&self, py: Python<'py>, time: f64, pivot: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
        if !time.is_finite() {
            return Err(TressesError::new_err(format!("time is {time}, but must be finite")));
        }
        let gesture = self.motion.gesture(time, vector(pivot, "pivot")?);
        let (dict, shapes) = (PyDict::new(py), PyDict::new(py));
        for (name, weight) in &gesture.shapes {
            shapes.set_item(&**name, *weight)?;
        }
        dict.set_item("head", told(&gesture.head))?;
        dict.set_item("body", told(&gesture.body))?;
        dict.set_item("shapes", shapes)?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("Motion({:?}, {} s)", self.name, self.motion.duration())
    }
}
