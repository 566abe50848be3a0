//! The GPU, opened on first use and shared by the whole process.

use crate::work::run;
use anyhow::Result;
use pyo3::{prelude::*, types::PyDict};
use std::sync::{Mutex, PoisonError};
use tresses::Gpu;

static OPENED: Mutex<Option<Gpu>> = Mutex::new(None);

/// Returns the adapter and its context. The mutex serializes concurrent first calls.
pub fn open() -> Result<Gpu> {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(gpu) = &*opened {
        return Ok(gpu.clone());
    }
    Ok(opened.insert(pollster::block_on(Gpu::open())?).clone())
}

/// Return the adapter that simulates and renders hair. Opens the GPU on first use.
///
/// Returns
/// -------
/// dict
///     ``name``, ``driver``, ``backend``, ``software`` (whether it runs on the CPU) and ``max_samples`` (per pixel).
#[pyfunction]
pub fn adapter(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let Gpu { info, context, .. } = run(py, None, async |_| open())?;
    let tier = context.tier();
    let dict = PyDict::new(py);
    dict.set_item("name", info.name)?;
    dict.set_item("driver", info.driver_info)?;
    dict.set_item("backend", info.backend.to_str())?;
    dict.set_item("software", tier.software)?;
    dict.set_item("max_samples", tier.max_samples)?;
    Ok(dict)
}
