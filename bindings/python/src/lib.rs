//! The compiled half of the Python package `tresses`; the other half, with its types, is in `python/tresses`.
//!
//! It wraps `tresses_scene`, as the command and the studio do, and adds nothing of its own: arrays become strands and
//! meshes, keyword arguments become settings, and results become arrays. Long work is done without the interpreter's lock
//! ([`work`]), and what a caller must not see half done is in a mutex.

mod arrays;
mod device;
mod files;
mod groom;
mod mesh;
mod motion;
mod picture;
mod pose;
mod reading;
mod settings;
mod simulation;
mod strands;
mod work;

use pyo3::{create_exception, exceptions::PyException, prelude::*};

create_exception!(tresses, TressesError, PyException, "What tresses refuses or cannot do, in one sentence.");

/// The exception that tells `error`.
fn raised(error: impl Into<anyhow::Error>) -> PyErr {
    TressesError::new_err(format!("{:#}", error.into()))
}

/// The compiled half of the package.
#[pymodule]
mod _tresses {
    #[pymodule_export]
    use crate::TressesError;
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
    use crate::settings::{Parameter, Settings, parameters};
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::strands::{Finding, Strands};
}
