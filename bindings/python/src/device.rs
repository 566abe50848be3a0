//! The GPU, opened once for the whole process when it is first needed.

use crate::work::run;
use anyhow::Result;
use pyo3::{prelude::*, types::PyDict};
use std::sync::{Arc, Mutex, PoisonError};
use tresses::{Pipelines, gpu::Gpu};

/// A device with its pipelines.
#[derive(Clone)]
pub struct Device {
    /// Adapter, device, queue.
    pub gpu: Gpu,
    /// The pipelines.
    pub pipelines: Arc<Pipelines>,
}

static OPENED: Mutex<Option<Device>> = Mutex::new(None);

impl Device {
    /// The process's. Two that ask at a time wait for one another.
    pub fn open() -> Result<Self> {
        let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(device) = &*opened {
            return Ok(device.clone());
        }
        let gpu = pollster::block_on(Gpu::open())?;
        let pipelines = Arc::new(Pipelines::new(&gpu.device));
        Ok(opened.insert(Self { gpu, pipelines }).clone())
    }
}

/// What hair is simulated and drawn on.
///
/// Returns a dict with ``name``, ``driver``, ``backend``, ``software`` (whether it runs on the processor) and
/// ``max_samples`` (per pixel). Opens the GPU if nothing has done so before.
#[pyfunction]
pub fn adapter(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let Gpu { info, tier, .. } = run(py, None, async |_| Ok(Device::open()?.gpu))?;
    let dict = PyDict::new(py);
    dict.set_item("name", info.name)?;
    dict.set_item("driver", info.driver_info)?;
    dict.set_item("backend", info.backend.to_str())?;
    dict.set_item("software", tier.software)?;
    dict.set_item("max_samples", tier.max_samples)?;
    Ok(dict)
}
