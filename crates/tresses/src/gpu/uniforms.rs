//! Small values that the CPU writes and shaders read, on shared pages.
//!
//! A write through the queue costs a staging buffer, a barrier and a copy, whatever its size, and a frame has dozens of
//! values. They therefore lie in slots of a few buffers. [`Uniform::write`] changes a copy on the CPU, and
//! `Context::flush_uniforms` uploads the changes before the commands that read them are submitted: when a pass ends, or
//! when merging ends (`Commands::set_merging`).
//!
//! wgpu tracks a buffer as a whole, and inserts a barrier where its use changes. Values in the uniform address space
//! and values in the storage address space thus have pages of their own.

use std::{
    collections::{HashMap, VecDeque},
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// Bytes of a page.
const PAGE: u64 = 1 << 17;
/// Largest slot on a shared page, bytes. A larger one has a page of its own.
const MAX_SHARED: u64 = 1 << 16;
/// Alignment of slots, bytes: the largest that WebGPU may require.
const ALIGN: u64 = 256;
/// Smallest size of a slot, bytes.
const MIN_SIZE: u64 = 16;
/// Number of flushes before a free slot is reused. Commands recorded earlier than that must be submitted.
const REST: u64 = 256;

/// Address space in which shaders declare a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Space {
    Uniform,
    Storage,
}

/// The pages of a device.
#[derive(Debug, Default)]
pub(crate) struct UniformHeap(Mutex<Pages>);

#[derive(Debug, Default)]
struct Pages {
    /// Indices stay the same.
    pages: Vec<Option<Page>>,
    /// Free slots by address space and capacity, the longest free first.
    free: HashMap<(Space, u64), VecDeque<FreeSlot>>,
    /// Number of flushes that uploaded anything.
    flushes: u64,
    is_dirty: bool,
}

#[derive(Debug)]
struct Page {
    buffer: wgpu::Buffer,
    space: Space,
    /// Contents of the buffer after the next flush.
    bytes: Vec<u8>,
    /// Bytes from the start on that slots have taken.
    used: u64,
    /// Range from the first changed byte to the last, empty without changes. Unchanged bytes between cost less than
    /// another upload.
    dirty: Range<u64>,
}

#[derive(Debug)]
struct FreeSlot {
    page: usize,
    offset: u64,
    /// Number of flushes when it became free.
    since: u64,
}

/// A slot of a page, for values that are constant for a dispatch or draw. Clones refer to the same slot. A bind group
/// does not keep it: whoever holds the bind group holds the slot.
#[derive(Clone, Debug)]
pub(crate) struct Uniform(Arc<Slot>);

#[derive(Debug)]
struct Slot {
    heap: Arc<UniformHeap>,
    space: Space,
    buffer: wgpu::Buffer,
    page: usize,
    offset: u64,
    size: u64,
}

impl UniformHeap {
    /// Takes a slot of `size` bytes, at least 16, initially zero.
    pub fn slot(self: &Arc<Self>, device: &wgpu::Device, space: Space, size: usize) -> Uniform {
        let size = (size as u64).max(MIN_SIZE);
        let mut pages = self.pages();
        let (page, offset) = pages.take(device, space, capacity(size));
        let buffer = pages.page(page).buffer.clone();
        Uniform(Arc::new(Slot { heap: self.clone(), space, buffer, page, offset, size }))
    }

    /// Calls `upload` with the buffer, offset and bytes of each changed range since the last call.
    pub fn flush(&self, upload: impl FnMut(&wgpu::Buffer, u64, &[u8])) {
        self.pages().flush(upload);
    }

    /// Number of free slots.
    #[cfg(test)]
    pub fn free_slots(&self) -> usize {
        self.pages().free.values().map(VecDeque::len).sum()
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        // A panic cannot leave a half-written value.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Bytes that a slot of `size` bytes takes.
fn capacity(size: u64) -> u64 {
    size.next_multiple_of(ALIGN)
}

impl Pages {
    fn page(&mut self, index: usize) -> &mut Page {
        self.pages[index].as_mut().expect("pages with slots stay")
    }

    /// Returns the page and the offset of a slot of zeros.
    fn take(&mut self, device: &wgpu::Device, space: Space, capacity: u64) -> (usize, u64) {
        let rested = |slot: &mut FreeSlot| self.flushes >= slot.since + REST;
        let known = self.free.get_mut(&(space, capacity)).and_then(|slots| slots.pop_front_if(rested));
        if let Some(FreeSlot { page, offset, .. }) = known {
            self.write(page, offset, &vec![0; capacity as usize]);
            return (page, offset);
        }
        let fits = |page: &Page| page.space == space && page.used + capacity <= page.bytes.len() as u64;
        let known = self.pages.iter().position(|page| page.as_ref().is_some_and(fits));
        let index = match known.filter(|_| capacity <= MAX_SHARED) {
            Some(index) => index,
            None if capacity <= MAX_SHARED => self.add(Page::new(device, space, PAGE)),
            None => self.add(Page::new(device, space, capacity)),
        };
        let page = self.page(index);
        let offset = page.used;
        page.used += capacity;
        (index, offset)
    }

    /// Adds a page and returns its index.
    fn add(&mut self, page: Page) -> usize {
        self.is_dirty = true;
        let index = self.pages.iter().position(Option::is_none).unwrap_or_else(|| {
            self.pages.push(None);
            self.pages.len() - 1
        });
        self.pages[index] = Some(page);
        index
    }

    /// Frees a slot. A bind group keeps the buffer of a page that is gone.
    fn free(&mut self, slot: &Slot) {
        let Slot { page, offset, space, size, .. } = *slot;
        let capacity = capacity(size);
        if capacity > MAX_SHARED {
            self.pages[page] = None;
            return;
        }
        let free = FreeSlot { page, offset, since: self.flushes };
        self.free.entry((space, capacity)).or_default().push_back(free);
    }

    fn write(&mut self, page: usize, offset: u64, bytes: &[u8]) {
        let page = self.page(page);
        let range = offset..offset + bytes.len() as u64;
        let known = &mut page.bytes[range.start as usize..range.end as usize];
        if known == bytes {
            return;
        }
        known.copy_from_slice(bytes);
        page.dirty = match page.dirty.is_empty() {
            true => range,
            false => page.dirty.start.min(range.start)..page.dirty.end.max(range.end),
        };
        self.is_dirty = true;
    }

    fn flush(&mut self, mut upload: impl FnMut(&wgpu::Buffer, u64, &[u8])) {
        if !std::mem::take(&mut self.is_dirty) {
            return;
        }
        self.flushes += 1;
        for page in self.pages.iter_mut().flatten() {
            let Range { start, end } = std::mem::take(&mut page.dirty);
            if start < end {
                upload(&page.buffer, start, &page.bytes[start as usize..end as usize]);
            }
        }
    }
}

impl Page {
    /// Creates a page of zeros.
    fn new(device: &wgpu::Device, space: Space, size: u64) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("uniforms"),
            size,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        // The first upload writes the whole page, so that wgpu need not clear it in parts.
        Self { buffer, space, bytes: vec![0; size as usize], used: 0, dirty: 0..size }
    }
}

impl Uniform {
    /// Replaces the bytes from byte `offset` on, for commands that are submitted after the next flush. Offset and
    /// length are multiples of 4.
    pub fn write(&self, offset: u64, bytes: &[u8]) {
        let slot = &*self.0;
        let end = offset + bytes.len() as u64;
        assert!(end <= slot.size, "{end} bytes do not fit into a slot of {}", slot.size);
        slot.heap.pages().write(slot.page, slot.offset + offset, bytes);
    }

    /// Size in bytes.
    pub fn size(&self) -> u64 {
        self.0.size
    }

    /// Returns the buffer of the slot, and `size` bytes from byte `offset` of the slot on, or the rest without `size`.
    pub fn range(&self, offset: u64, size: Option<u64>) -> (&wgpu::Buffer, Range<u64>) {
        let slot = &*self.0;
        let start = slot.offset + offset;
        (&slot.buffer, start..start + size.unwrap_or(slot.size - offset))
    }

    /// Binds the whole slot.
    pub fn as_entire_binding(&self) -> wgpu::BindingResource<'_> {
        let (buffer, Range { start, end }) = self.range(0, None);
        let size = wgpu::BufferSize::new(end - start);
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: start, size })
    }
}

impl PartialEq for Uniform {
    /// Whether both are the same slot.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.heap.pages().free(self);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{BindBuffer, Context, Opaque, noop, probe::Probe};
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Counts uploads.
    #[derive(Debug, Default)]
    struct Uploads(AtomicU32);

    impl Probe for Uploads {
        fn shader(&self, _: &wgpu::Device, _: &str, _: &str) -> wgpu::ShaderModule {
            unreachable!("no shader is compiled")
        }
        fn layout(&self, _: &wgpu::Device) -> wgpu::BindGroupLayout {
            unreachable!("no pipeline is compiled")
        }
        fn bound(&self, _: &wgpu::BindGroup, _: Vec<u64>) {}
        fn work(&self, _: Option<&'static str>, _: &[Option<wgpu::BindGroup>]) -> (wgpu::BindGroup, u32) {
            unreachable!("nothing is dispatched")
        }
        fn uploaded(&self) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
        fn read_back(&self) {}
        fn lap(&self, _: &'static str) {}
    }

    /// Flushes and returns the number of uploads.
    fn uploads(context: &mut Context) -> u32 {
        let probe = Arc::new(Uploads::default());
        context.queue.probe = Some(probe.clone());
        context.flush_uniforms();
        probe.0.load(Ordering::Relaxed)
    }

    fn position(uniform: &Uniform) -> (usize, u64) {
        (uniform.0.page, uniform.0.offset)
    }

    fn contents(uniform: &Uniform) -> Vec<u8> {
        let Slot { heap, page, offset, size, .. } = &*uniform.0;
        heap.pages().page(*page).bytes[*offset as usize..][..*size as usize].to_vec()
    }

    #[test]
    fn slots_do_not_overlap_and_keep_their_size() {
        let context = noop();
        let sizes = [4, 16, 20, 255, 256, 257, 5000, 40_000, 40_000, 65_536, 70_000, 30_000];
        let slots: Vec<_> = sizes.iter().map(|size| context.device.uniform(*size)).collect();
        for (slot, size) in slots.iter().zip(sizes) {
            assert_eq!(slot.size(), size.max(16) as u64);
            let binding = wgpu::BindingResource::from(slot.entire::<Opaque>());
            let wgpu::BindingResource::Buffer(wgpu::BufferBinding { offset, size, .. }) = binding else {
                unreachable!("it is a buffer")
            };
            assert_eq!((offset % ALIGN, size.map(u64::from)), (0, Some(slot.size())));
        }
        for (i, slot) in slots.iter().enumerate() {
            slot.write(0, &vec![i as u8 + 1; slot.size() as usize]);
        }
        for (i, slot) in slots.iter().enumerate() {
            assert!(contents(slot).iter().all(|byte| *byte == i as u8 + 1), "slot {i}");
        }
        let stored = context.device.storage_uniform(16);
        assert!(slots.iter().all(|slot| slot.0.page != stored.0.page), "each space has pages of its own");
    }

    #[test]
    fn parts_are_relative_to_their_slot() {
        let context = noop();
        let [_first, second] = [(); 2].map(|()| context.device.uniform(1024));
        let binding = wgpu::BindingResource::from(second.part::<Opaque>(256, Some(48)));
        let wgpu::BindingResource::Buffer(wgpu::BufferBinding { offset, size, .. }) = binding else {
            unreachable!("it is a buffer")
        };
        assert_eq!((offset, size.map(u64::from)), (1024 + 256, Some(48)));
    }

    #[test]
    fn a_flush_writes_each_changed_page_once() {
        let context = &mut noop();
        let slots: Vec<_> = (0..40).map(|_| context.device.uniform(48)).collect();
        let stored = context.device.storage_uniform(48);
        assert_eq!(uploads(context), 2, "the zeros of both pages");
        assert_eq!(uploads(context), 0);
        for (i, slot) in slots.iter().enumerate() {
            slot.write(16, &[i as u8 + 1; 32]);
        }
        assert_eq!(uploads(context), 1);
        stored.write(0, &[1; 48]);
        slots[0].write(16, &[1; 32]);
        assert_eq!(uploads(context), 1, "the same value again is not a change");
    }

    #[test]
    fn free_slots_are_reused_after_many_flushes_and_start_at_zero() {
        let context = &mut noop();
        let kept = context.device.uniform(100);
        let freed = context.device.uniform(100);
        let free = position(&freed);
        freed.write(0, &[7; 100]);
        drop(freed);
        for turn in 0..REST {
            let next = context.device.uniform(100);
            assert_ne!(position(&next), free, "reused after {turn} flushes");
            kept.write(0, &(turn as u32 + 1).to_le_bytes());
            uploads(context);
            // Slots of these turns stay taken.
            std::mem::forget(next);
        }
        assert_ne!(position(&context.device.uniform(300)), free, "another capacity");
        assert_ne!(position(&context.device.storage_uniform(100)), free, "another address space");
        let again = context.device.uniform(100);
        assert_eq!(position(&again), free);
        assert_eq!(contents(&again), [0; 100]);
        assert_eq!(uploads(context), 2, "the zeros of the slot, and a page of storage");
    }

    #[test]
    fn large_slots_have_pages_that_go_with_them() {
        let context = &noop();
        let count = || context.device.uniforms.pages().pages.iter().flatten().count();
        let large = context.device.storage_uniform(MAX_SHARED as usize + 4);
        assert_eq!((large.size(), count()), (MAX_SHARED + 4, 1));
        drop(large);
        assert_eq!(count(), 0);
    }
}
