//! The device of a part, and its loss.

use anyhow::Result;
use pollster::block_on;
use std::sync::{Mutex, PoisonError};
use tresses::Gpu;

/// The driver's message when a device was lost.
static LOSS: Mutex<Option<String>> = Mutex::new(None);

/// Opens the default adapter. [`take_loss`] returns the loss of its device.
pub fn open() -> Result<Gpu> {
    Ok(watched(block_on(Gpu::open())?))
}

/// Returns `gpu`, whose loss is recorded from now on.
pub fn watched(gpu: Gpu) -> Gpu {
    gpu.context.device().set_device_lost_callback(|reason, message| {
        // `Device::destroy` also reports a loss.
        if reason != wgpu::DeviceLostReason::Destroyed {
            *LOSS.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
        }
    });
    gpu
}

/// Returns the message if a device was lost since the last call.
pub fn take_loss() -> Option<String> {
    LOSS.lock().unwrap_or_else(PoisonError::into_inner).take()
}
