//! Buffers that views fill anew for every picture.

use crate::{Result, strands::buffers::storage};
use std::sync::{Mutex, PoisonError};

/// A buffer that is kept from picture to picture for as long as its size stays.
#[derive(Debug, Default)]
pub(super) struct Scratch(Mutex<Option<wgpu::Buffer>>);

impl Scratch {
    /// A buffer for exactly `count` values of `T`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(super) fn get<T>(
        &self,
        device: &wgpu::Device,
        what: &'static str,
        count: u64,
    ) -> Result<wgpu::Buffer> {
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
