//! The stage's state in the targets of one view.

use super::{
    Pipelines,
    buffers::{TileBuffers, TileControl},
    labels::Labels,
    lists::HairLists,
};
use crate::{
    Context, Result, constants::TILE_ROUNDS, draw::record::Canvas, draw::targets::TextureKind,
    gpu::readback::Pending, light::HairView,
};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The tiles of a view: buffers of its size, and lists that grow with its hair.
#[derive(Debug)]
pub(crate) struct Tiles {
    pub buffers: TileBuffers,
    lists: Mutex<Option<HairLists>>,
    capacity: Mutex<ListCapacity>,
}

/// The list length that recent frames needed.
#[derive(Debug, Default)]
struct ListCapacity {
    /// Entries of the latest frame that was read back.
    entries: u32,
    /// A readback in flight.
    pending: Option<Pending>,
}

impl ListCapacity {
    /// Takes the GPU's count. Returns whether all entries were drawn.
    fn learn(&mut self, control: &[u8], window: u32) -> bool {
        let at = std::mem::offset_of!(TileControl, entries);
        let entries: u32 = bytemuck::pod_read_unaligned(&control[at..at + 4]);
        self.entries = entries;
        u64::from(entries) <= u64::from(window) * u64::from(TILE_ROUNDS)
    }
}

impl Tiles {
    /// Allocates for targets of `size` pixels, with textures from `texture`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        size: [u32; 2],
        texture: impl Fn(TextureKind) -> wgpu::Texture,
    ) -> Result<Self> {
        let buffers = TileBuffers::new(device, size, texture)?;
        Ok(Self { buffers, lists: Mutex::default(), capacity: Mutex::default() })
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffers.bytes() + self.hair_bytes()
    }

    /// Bytes of GPU memory that depend on the hair: points, lists, visibility bits.
    pub fn hair_bytes(&self) -> u64 {
        self.lists().as_ref().map_or(0, HairLists::bytes)
    }

    /// Motion, depth and opacity of the hair in the last frame; `None` without hair or unless [`Canvas::geometry`] asked.
    pub fn geometry(&self) -> Option<wgpu::TextureView> {
        let lists = self.lists();
        let geometry = lists.as_ref()?.geometry.as_ref()?;
        geometry.is_asked().then(|| geometry.texture.clone())
    }

    /// Whether [`geometry`](Self::geometry) holds motion.
    pub fn knows_motion(&self) -> bool {
        self.lists()
            .as_ref()
            .and_then(|lists| lists.geometry.as_ref())
            .is_some_and(|known| known.knows_motion)
    }

    /// Strand labels of the last frame, with the grooms that its point numbers belong to; `None` unless [`Canvas::labels`]
    /// asked.
    pub fn labels(&self) -> Option<Labels> {
        self.lists().as_ref()?.labels.clone().filter(|labels| !labels.owners.is_empty())
    }

    /// Forgets last frame's geometry and labels: this frame has no hair.
    pub(super) fn forget(&self) {
        if let Some(lists) = self.lists().as_mut() {
            lists.geometry = None;
            lists.labels = None;
        }
    }

    pub(super) fn lists(&self) -> MutexGuard<'_, Option<HairLists>> {
        // The lists are consistent even after a panic.
        self.lists.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the uniforms of a frame of `hair`, which is not empty, and returns its lists.
    pub(super) fn bind(
        &self,
        kernels: &Pipelines,
        canvas: &Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<MutexGuard<'_, Option<HairLists>>> {
        let mut lists = self.lists();
        let entries = self.learn(canvas, lists.as_ref().map(|lists| lists.grid.window));
        if !lists.as_ref().is_some_and(|lists| lists.fits(canvas, hair, entries)) {
            // The old lists are dropped first, so that both are never in memory at once.
            *lists = None;
            *lists = Some(HairLists::new(kernels, &self.buffers, canvas, hair, next(entries))?);
        }
        if let Some(lists) = lists.as_mut() {
            lists.prepare(canvas.commands.context(), &self.buffers.grid, hair);
        }
        Ok(lists)
    }

    /// Returns the entries of the latest frame whose count has been read back. Does not wait.
    fn learn(&self, canvas: &Canvas<'_, '_>, window: Option<u32>) -> u32 {
        let mut capacity = self.capacity.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(window) = window {
            let pending = capacity
                .pending
                .get_or_insert_with(|| Pending::buffer(canvas.commands.context(), &self.buffers.control));
            if let Some(control) = pending.take() {
                capacity.pending = None;
                // A lost device is reported by the call that waits for the GPU.
                if let Ok(control) = control {
                    capacity.learn(&control, window);
                }
            }
        }
        capacity.entries
    }

    /// Whether the lists held the whole last frame. If not, those of the next frame are long enough.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn is_complete(&self, context: &Context) -> Result<bool> {
        let Some(window) = self.lists().as_ref().map(|lists| lists.grid.window) else { return Ok(true) };
        let control = Pending::buffer(context, &self.buffers.control).wait().await?;
        let mut capacity = self.capacity.lock().unwrap_or_else(PoisonError::into_inner);
        // An earlier readback is older than this one.
        capacity.pending = None;
        Ok(capacity.learn(&control, window))
    }
}

/// The list length to reserve after a frame with so many entries: motion adds a few from frame to frame.
fn next(entries: u32) -> u32 {
    entries.saturating_add(entries / 4)
}
