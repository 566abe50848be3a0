//! The stage's state in the targets of one view.

use super::{
    Pipelines,
    buffers::{TileBuffers, TileControl},
    labels::Labels,
    lists::HairLists,
};
use crate::{
    Camera, Context, Result,
    constants::TILE_ROUNDS,
    draw::canvas::{Canvas, TextureKind},
    gpu::{Device, readback::Pending},
    light::{HairView, Sphere},
};
use glam::Vec3;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The tiles of a view: buffers of its size, and lists that grow with its hair.
#[derive(Debug)]
pub(crate) struct Tiles {
    pub buffers: TileBuffers,
    lists: Mutex<Option<HairLists>>,
    capacity: Mutex<ListCapacity>,
}

/// Entries of recent frames, and the rounds of this frame.
#[derive(Debug)]
struct ListCapacity {
    /// The latest frame that was read back.
    known: ListCount,
    /// A readback in flight, and the frame that it reads.
    pending: Option<(Pending, FrameLook)>,
    /// The last recorded frame, and its rounds.
    last: Option<FrameLook>,
    rounds: u32,
    /// Consecutive frames in several rounds.
    several: u32,
}

impl Default for ListCapacity {
    fn default() -> Self {
        Self { known: ListCount::default(), pending: None, last: None, rounds: TILE_ROUNDS, several: 0 }
    }
}

/// The entries of a frame.
#[derive(Clone, Copy, Debug, Default)]
struct ListCount {
    /// 0 if unknown.
    entries: u32,
    look: Option<FrameLook>,
}

/// Number of points, and places of the focus in the image (x and y as fractions of its size, and depth): frames that
/// differ little in these have similar numbers of entries.
#[derive(Clone, Copy, Debug)]
struct FrameLook {
    points: u32,
    focus: [Vec3; 7],
}

impl FrameLook {
    /// Largest motion of the focus in the image since the known frame, as a fraction of its size, and largest ratio of
    /// depths.
    const NEAR: f32 = 0.05;
    const RATIO: f32 = 1.1;

    fn of(camera: &Camera, focus: &Sphere, points: u32) -> Self {
        let Sphere { center, radius } = *focus;
        let clip = camera.projection * camera.view;
        let ends = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let focus = ends.map(|direction| {
            let at = clip * (center + direction * radius).extend(1.0);
            (at.truncate().truncate() * (0.5 / at.w)).extend(at.w)
        });
        Self { points, focus }
    }

    /// Whether the camera has hardly moved since `other`.
    fn resembles(&self, other: &Self) -> bool {
        self.focus.iter().zip(&other.focus).all(|(now, then)| {
            let ratio = now.z / then.z;
            now.truncate().distance(then.truncate()) < Self::NEAR
                && (1.0 / Self::RATIO..Self::RATIO).contains(&ratio)
        })
    }
}

impl ListCapacity {
    /// Factor by which a frame may need more entries than a recent one with almost the same camera. Bodies that
    /// suddenly uncover hair exceed it only in close-ups, because lists always have room for one and a half entries per
    /// point.
    const GROWTH: f32 = 1.15;
    /// Consecutive frames in several rounds after which the lists grow, so that one round suffices.
    const PATIENCE: u32 = 30;

    /// Returns the rounds to record for a frame: enough for [`GROWTH`](Self::GROWTH), or all if the last known frame
    /// was another picture.
    fn rounds(&self, look: &FrameLook, window: u32) -> u32 {
        let Some(then) = self.resembling(look) else { return TILE_ROUNDS };
        let more = (look.points as f32 / then.points.max(1) as f32).max(1.0);
        let entries = self.known.entries as f32 * more * Self::GROWTH;
        ((entries / window as f32).ceil() as u32).clamp(1, TILE_ROUNDS)
    }

    /// Returns the last known frame if it was a similar picture.
    fn resembling(&self, look: &FrameLook) -> Option<FrameLook> {
        self.known.look.filter(|then| self.known.entries > 0 && look.resembles(then))
    }

    /// Chooses the rounds of a frame.
    fn begin(&mut self, look: FrameLook, window: u32) {
        self.rounds = self.rounds(&look, window);
        let several = self.rounds > 1 && self.resembling(&look).is_some();
        self.several = if several { self.several + 1 } else { 0 };
        self.last = Some(look);
    }

    /// Takes the count of the latest frame that has been read back, and begins to read back the last one. Does not
    /// wait.
    fn read(&mut self, context: &Context, control: &wgpu::Buffer) {
        let last = self.last;
        if self.pending.is_none() {
            self.pending = last.map(|look| (Pending::buffer(context, control), look));
        }
        let Some((pending, look)) = &mut self.pending else { return };
        let look = *look;
        if let Some(control) = pending.take() {
            self.pending = None;
            // A lost device is reported by the call that waits for the GPU.
            if let Ok(control) = control {
                self.learn(&control, Some(look));
            }
        }
    }

    /// Takes the GPU's count of the frame `look`.
    fn learn(&mut self, control: &[u8], look: Option<FrameLook>) {
        let at = std::mem::offset_of!(TileControl, entries);
        self.known = ListCount { entries: bytemuck::pod_read_unaligned(&control[at..at + 4]), look };
    }
}

impl Tiles {
    /// Allocates for targets of `size` pixels, with textures from `texture`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &Device,
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

    /// Motion, depth and opacity of the hair in the last frame; `None` without hair or unless [`Canvas::geometry`]
    /// asked.
    pub fn geometry(&self) -> Option<wgpu::TextureView> {
        let lists = self.lists();
        let geometry = lists.as_ref()?.geometry.as_ref()?;
        geometry.is_requested().then(|| geometry.texture.clone())
    }

    /// Whether [`geometry`](Self::geometry) holds motion.
    pub fn knows_motion(&self) -> bool {
        self.lists()
            .as_ref()
            .and_then(|lists| lists.geometry.as_ref())
            .is_some_and(|known| known.knows_motion)
    }

    /// Strand labels of the last frame, with the grooms that its point numbers belong to; `None` unless
    /// [`Canvas::labels`] asked.
    pub fn labels(&self) -> Option<Labels> {
        self.lists().as_ref()?.labels.clone().filter(|labels| !labels.owners.is_empty())
    }

    /// Forgets last frame's geometry, labels and entries: this frame has no hair.
    pub(super) fn forget(&self) {
        *self.capacity.lock().unwrap_or_else(PoisonError::into_inner) = ListCapacity::default();
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
        let mut capacity = self.capacity.lock().unwrap_or_else(PoisonError::into_inner);
        if lists.is_some() {
            capacity.read(canvas.commands.context(), &self.buffers.control);
        }
        let entries = capacity.known.entries;
        let min_entries = if capacity.several < ListCapacity::PATIENCE { entries } else { next(entries) };
        if !lists.as_ref().is_some_and(|lists| lists.fits(canvas, hair, min_entries)) {
            // The old lists are dropped first, so that both are never in memory at once.
            *lists = None;
            *lists = Some(HairLists::new(kernels, &self.buffers, canvas, hair, next(entries))?);
        }
        if let Some(lists) = lists.as_mut() {
            lists.prepare(&self.buffers.grid, hair);
            let look = FrameLook::of(canvas.camera, canvas.focus, lists.grid.points);
            capacity.begin(look, lists.grid.window);
        }
        Ok(lists)
    }

    /// Returns the number of rounds of the frame that is being recorded.
    pub(super) fn rounds(&self) -> u32 {
        self.capacity.lock().unwrap_or_else(PoisonError::into_inner).rounds
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
        let last = capacity.last;
        capacity.learn(&control, last);
        Ok(u64::from(capacity.known.entries) <= u64::from(window) * u64::from(capacity.rounds))
    }
}

/// The list length to reserve after a frame with so many entries.
fn next(entries: u32) -> u32 {
    entries.saturating_add(entries / 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(camera: Camera, points: u32) -> FrameLook {
        FrameLook::of(&camera, &Sphere { center: Vec3::ZERO, radius: 0.2 }, points)
    }

    #[test]
    fn all_rounds_are_recorded_unless_the_last_count_is_of_a_similar_picture() {
        let from = |eye: Vec3| Camera::look_at(eye, Vec3::ZERO, 0.4, [200, 100]);
        let then = look(from(Vec3::Z), 1000);
        let known = |entries| ListCapacity {
            known: ListCount { entries, look: Some(then) },
            ..ListCapacity::default()
        };
        let same = then;
        assert_eq!([0, 1, 1100, 1300, 2500, 9000].map(|n| known(n).rounds(&same, 1500)), [4, 1, 1, 1, 2, 4]);
        assert_eq!(ListCapacity::default().rounds(&same, 1500), 4, "nothing is known");
        let one = |camera, points| known(900).rounds(&look(camera, points), 1500);
        assert_eq!(one(from(Vec3::new(0.03, 0.0, 1.0)), 1000), 1, "a slow camera");
        assert_eq!(one(from(Vec3::new(0.3, 0.0, 1.0)), 1000), 4, "a fast one");
        assert_eq!(one(from(Vec3::Z * 0.85), 1000), 4, "closer");
        assert_eq!(one(from(Vec3::Z * 0.1), 1000), 4, "in the hair");
        assert_eq!(one(from(Vec3::Z), 2000), 2, "twice as many strands");
        assert_eq!(one(Camera { size: [0, 0], projection: glam::Mat4::ZERO, ..from(Vec3::Z) }, 1000), 4);
    }
}
