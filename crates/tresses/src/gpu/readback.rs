//! Copies from the GPU to the CPU, for images, measurements, tests, and the length of tile lists
//! ([`crate::draw::tiles`]). A frame never waits for one.
//!
//! [`buffer`] and [`texture`] wait: in a browser for the event loop, elsewhere by polling the device, so that they are
//! usually ready when first polled. If another thread polls the same device, the result may arrive on that thread, a
//! little later. [`blocking`] needs no executor. [`Pending`] does not wait: a program that polls its device anyway, as
//! each `submit` does, checks from time to time whether the copy has arrived.

use super::Context;
use crate::{Error, Result};
use std::{
    future::poll_fn,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    task::{Poll, Waker},
};

/// Reads back `buffer` from byte 0. It must have `COPY_SRC`.
///
/// # Errors
/// [`Error::Gpu`] when the device is lost.
pub async fn buffer<T: bytemuck::Pod>(context: &Context, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
    let bytes = Pending::buffer(context, buffer).wait().await?;
    Ok(bytemuck::pod_collect_to_vec(&bytes[..bytes.len() / size_of::<T>() * size_of::<T>()]))
}

/// Reads back the first mip level of a texture with `COPY_SRC`: all layers or slices, rows without padding.
///
/// # Errors
/// [`Error::Gpu`] when the device is lost, or for a format without a single size per texel.
pub async fn texture(context: &Context, texture: &wgpu::Texture) -> Result<Vec<u8>> {
    Pending::texture(context, texture)?.wait().await
}

/// Blocking versions for programs without an executor, such as tests. Not available in a browser, where nothing can
/// block.
#[cfg(not(target_arch = "wasm32"))]
pub mod blocking {
    use crate::{Context, Result};
    use pollster::block_on;

    /// As [`buffer`](super::buffer).
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
    pub fn buffer<T: bytemuck::Pod>(context: &Context, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
        block_on(super::buffer(context, buffer))
    }

    /// As [`texture`](super::texture).
    ///
    /// # Errors
    /// As [`texture`](super::texture).
    pub fn texture(context: &Context, texture: &wgpu::Texture) -> Result<Vec<u8>> {
        block_on(super::texture(context, texture))
    }
}

/// A copy to the CPU that is in progress.
#[derive(Debug)]
pub struct Pending {
    device: wgpu::Device,
    target: wgpu::Buffer,
    size: u64,
    /// Bytes per row with padding and without.
    rows: Option<[usize; 2]>,
    mapping: Arc<Mutex<Mapping>>,
}

/// Result of the mapping's callback.
#[derive(Debug, Default)]
struct Mapping {
    result: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

impl Pending {
    /// Begins to copy `buffer` from byte 0, after all work submitted so far. It must have `COPY_SRC`.
    pub fn buffer(context: &Context, buffer: &wgpu::Buffer) -> Self {
        Self::part(context, buffer, buffer.size())
    }

    /// As [`buffer`](Self::buffer), for its first `size` bytes.
    pub(crate) fn part(context: &Context, buffer: &wgpu::Buffer, size: u64) -> Self {
        Self::new(context, size, None, |encoder, target| {
            encoder.copy_buffer_to_buffer(buffer, 0, target, 0, size);
        })
    }

    /// Begins to copy the first mip level of a texture with `COPY_SRC`: all layers or slices, rows without padding.
    ///
    /// # Errors
    /// [`Error::Gpu`] for a format without a single size per texel.
    pub fn texture(context: &Context, texture: &wgpu::Texture) -> Result<Self> {
        let texel = texture.format().block_copy_size(None).ok_or_else(|| Error::Gpu {
            stage: "read-back",
            problem: format!("the format {:?} has no fixed size per texel", texture.format()),
        })?;
        let (width, height, depth) = (texture.width(), texture.height(), texture.depth_or_array_layers());
        let row = width * texel;
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let size = u64::from(padded) * u64::from(height) * u64::from(depth);
        let rows = Some([padded as usize, row as usize]);
        Ok(Self::new(context, size, rows, |encoder, target| {
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: target,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(padded),
                        rows_per_image: Some(height),
                    },
                },
                wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            );
        }))
    }

    fn new(
        context: &Context,
        size: u64,
        rows: Option<[usize; 2]>,
        record: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
    ) -> Self {
        let Context { device, queue, .. } = context;
        let target = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: size.next_multiple_of(4).max(4),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read-back") });
        record(&mut encoder, &target);
        queue.submit([encoder.finish()]);
        if let Some(probe) = &device.probe {
            probe.read_back();
        }
        let mapping = Arc::new(Mutex::new(Mapping::default()));
        let callback_mapping = Arc::clone(&mapping);
        target.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            let waker = {
                let mut mapping = lock(&callback_mapping);
                mapping.result = Some(result);
                mapping.waker.take()
            };
            if let Some(waker) = waker {
                waker.wake();
            }
        });
        Self { device: context.device().clone(), target, size, rows, mapping }
    }

    /// Returns the bytes, once, if they have arrived.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device is lost.
    pub fn take(&mut self) -> Option<Result<Vec<u8>>> {
        let result = lock(&self.mapping).result.take()?;
        Some(result.map_err(|error| lost(error.to_string())).and_then(|()| self.bytes()))
    }

    /// Waits for the bytes.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device is lost.
    pub async fn wait(mut self) -> Result<Vec<u8>> {
        // In a browser `poll` returns immediately, and the event loop runs the callback.
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
        poll_fn(|context| {
            if let Some(result) = self.take() {
                return Poll::Ready(result);
            }
            let mut mapping = lock(&self.mapping);
            mapping.waker = Some(context.waker().clone());
            // The callback may have run in the meantime.
            if mapping.result.is_some() {
                context.waker().wake_by_ref();
            }
            Poll::Pending
        })
        .await
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        let view = self.target.slice(..self.size).get_mapped_range();
        let view = view.map_err(|error| lost(error.to_string()))?;
        Ok(match self.rows {
            Some([padded, row]) => view.chunks(padded).flat_map(|line| &line[..row]).copied().collect(),
            None => view.to_vec(),
        })
    }
}

fn lost(problem: String) -> Error {
    Error::Gpu { stage: "read-back", problem }
}

fn lock(mapping: &Mutex<Mapping>) -> MutexGuard<'_, Mapping> {
    // A panic cannot leave a half-written mapping.
    mapping.lock().unwrap_or_else(PoisonError::into_inner)
}
