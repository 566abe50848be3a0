//! Compiled part of the Python package `tresses`. The Python part and the type stubs are in `python/tresses`.
//!
//! It wraps `tresses_scene`, like the command line and the studio: arrays become strands and meshes, keyword arguments
//! become settings, and results become arrays. Long operations release the GIL ([`work`]); mutexes protect state that
//! callers must not see half updated.

mod arrays;
mod attributes;
mod body;
mod cache;
mod cards;
mod device;
mod files;
mod given;
mod groom;
mod lights;
mod mesh;
mod motion;
mod picture;
mod pose;
mod reading;
mod retargeting;
mod rig;
mod settings;
mod simulation;
mod strands;
mod work;

use pyo3::{
    create_exception,
    exceptions::{PyException, PyFileNotFoundError},
    prelude::*,
    sync::PyOnceLock,
    types::{PyDict, PyType},
};
use std::io;

create_exception!(tresses, TressesError, PyException, "Error of tresses. The message is one sentence.");

/// Converts `error` to a Python exception.
fn raised(error: impl Into<anyhow::Error>) -> PyErr {
    let error = error.into();
    let message = tresses_scene::words::sentence(&error);
    let is_missing = |cause: &io::Error| cause.kind() == io::ErrorKind::NotFound;
    if !error.chain().any(|cause| cause.downcast_ref().is_some_and(is_missing)) {
        return TressesError::new_err(message);
    }
    Python::attach(|py| match missing_file_error(py) {
        Ok(class) => PyErr::from_type(class.clone(), message),
        Err(error) => error,
    })
}

/// Returns `MissingFileError`, which is a `TressesError` and a `FileNotFoundError`.
fn missing_file_error(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = CLASS.get_or_try_init(py, || {
        let bases = (py.get_type::<TressesError>(), py.get_type::<PyFileNotFoundError>());
        let members = PyDict::new(py);
        members.set_item("__module__", "tresses")?;
        members.set_item("__doc__", "A file that does not exist.")?;
        let class = py.get_type::<PyType>().call1(("MissingFileError", bases, members))?;
        PyResult::Ok(class.cast_into::<PyType>()?.unbind())
    })?;
    Ok(class.bind(py))
}

/// Compiled part of the `tresses` package.
#[pymodule]
mod _tresses {
    #[pymodule_export]
    use crate::TressesError;
    #[pymodule_export]
    use crate::cache::Cache;
    #[pymodule_export]
    use crate::cards::{CardLevel, Cards};
    #[pymodule_export]
    use crate::device::adapter;
    #[pymodule_export]
    use crate::groom::Groom;
    #[pymodule_export]
    use crate::mesh::Mesh;
    #[pymodule_export]
    use crate::motion::Motion;
    #[pymodule_export]
    use crate::reading::{Import, formats, read};
    #[pymodule_export]
    use crate::retargeting::retarget;
    #[pymodule_export]
    use crate::rig::Rig;
    #[pymodule_export]
    use crate::settings::{Parameter, Settings, parameters};
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::strands::{Finding, Strands};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("MissingFileError", crate::missing_file_error(module.py())?)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
