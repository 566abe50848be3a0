//! Buffers that debug views fill again in every frame.

use crate::{Result, gpu::Device, strands::buffers::storage};
use std::sync::{Mutex, PoisonError};

/// A buffer that is kept from frame to frame while its size stays the same.
#[derive(Debug, Default)]
pub(super) struct Scratch(Mutex<Option<wgpu::Buffer>>);

impl Scratch {
    /// Returns a buffer for exactly `count` values of `T`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold the buffer.
    pub(super) fn get<T>(&self, device: &Device, what: &'static str, count: u64) -> Result<wgpu::Buffer> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let need = count.saturating_mul(size_of::<T>() as u64).max(16);
        if let Some(buffer) = kept.as_ref().filter(|buffer| buffer.size() == need) {
            return Ok(buffer.clone());
        }
        let buffer = storage::<T>(device, what, count)?;
        *kept = Some(buffer.clone());
        Ok(buffer)
    }
}
