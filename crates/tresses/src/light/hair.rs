//! Grooms for lighting and drawing: data that all views share, and data per view.

use super::{
    LightState, Pipelines,
    cards::CardBuffers,
    fiber::FiberTables,
    material::{HairMaterial, HairUniform},
    shadow::HairCaster,
};
use crate::{
    Context, Error, Result,
    constants::LIGHT_GROUP,
    gpu::{BindBuffer, Uniform},
    renderer::{ShadingModel, ShadingRate},
    shaders::kernels::light as kernels,
    strands::{DrawCount, StrandBuffers, StrandCapacity, buffers::storage, indices::Chunks},
};
use glam::Vec3;
use std::{
    collections::BTreeMap,
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
};

/// A groom as the light and draw stages need it, shared by all views: strands, material and index lists.
#[derive(Debug)]
pub struct HairSet {
    context: Context,
    /// Appearance of the hair.
    pub material: HairMaterial,
    /// Area of all strands, width times length, m². It weights the groom in values that all grooms of a frame share:
    /// those in the uniform of the lights, which mesh shading and the ambient light grid read.
    pub area: f32,
    /// Strands and vertices that are drawn.
    pub drawn: DrawCount,
    pub(crate) strands: StrandBuffers,
    /// Counts the times that the library has written the vertices; `None` if others write them.
    pub(crate) write_count: Option<u64>,
    /// Stride and number of the segments in the shadow maps.
    pub(crate) splat: [u32; 2],
    /// Vertices between the shading samples (knots) of a strand, and number of the spans between the samples.
    pub(crate) spans: [u32; 2],
    /// Shared with other heads whose fibers are alike.
    fiber: Mutex<Arc<FiberTables>>,
    asset: Arc<SetAsset>,
}

/// Data of a groom for lighting and drawing that all heads share.
#[derive(Debug, Default)]
pub(crate) struct SetAsset {
    /// Index lists by number of vertices, created when a level of detail first needs them.
    strips: Mutex<BTreeMap<u32, Arc<Chunks>>>,
    /// The first head's tables, while a head uses them.
    fiber: Mutex<Weak<FiberTables>>,
    /// Draws the strands as the columns of cards.
    cards: Option<CardBuffers>,
    /// Memory for the shading samples of every view. They are not needed once a groom is shaded.
    scratch: Option<wgpu::Buffer>,
}

impl SetAsset {
    /// Creates the data of a groom that is drawn as `cards`, if any, with its samples in `scratch` if they fit there.
    pub fn new(cards: Option<CardBuffers>, scratch: wgpu::Buffer) -> Self {
        Self { cards, scratch: Some(scratch), ..Self::default() }
    }

    /// Returns the fiber tables that heads start with.
    fn fiber(&self, context: &Context) -> Arc<FiberTables> {
        let mut fiber = self.fiber.lock().unwrap_or_else(PoisonError::into_inner);
        fiber.upgrade().unwrap_or_else(|| {
            let tables = Arc::new(FiberTables::new(context));
            *fiber = Arc::downgrade(&tables);
            tables
        })
    }

    fn strips(&self) -> MutexGuard<'_, BTreeMap<u32, Arc<Chunks>>> {
        self.strips.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes of GPU memory, without the scratch memory.
    pub fn bytes(&self) -> u64 {
        let cards = self.cards.as_ref().map_or(0, CardBuffers::bytes);
        self.strips().values().map(|strips| strips.bytes()).sum::<u64>() + cards
    }
}

/// Area of a strand if the host has not set one, m²: 80 µm by 20 cm.
const STRAND_AREA: f32 = 8e-5 * 0.2;

impl HairSet {
    /// Prepares `strands` for lighting and drawing.
    ///
    /// # Errors
    /// [`Error::Limit`] when there are too many strand vertices.
    pub fn new(context: &Context, strands: &StrandBuffers) -> Result<Self> {
        Self::of(context, &Arc::default(), strands)
    }

    /// [`new`](Self::new) with the data that all heads with the same groom share.
    pub(crate) fn of(context: &Context, asset: &Arc<SetAsset>, strands: &StrandBuffers) -> Result<Self> {
        let vertices = u64::from(strands.count) * u64::from(strands.vertex_count);
        if vertices * 2 > i32::MAX as u64 {
            return Err(Error::Limit {
                what: "strand vertices",
                need: vertices * 32,
                have: i32::MAX as u64 * 16,
                unit: "bytes in one buffer",
            });
        }
        let mut set = Self {
            context: context.clone(),
            material: HairMaterial::default(),
            area: strands.count as f32 * STRAND_AREA,
            drawn: strands.drawn,
            strands: strands.clone(),
            write_count: None,
            splat: [1; 2],
            spans: [1; 2],
            fiber: Mutex::new(asset.fiber(context)),
            asset: asset.clone(),
        };
        set.show(&strands.drawn);
        Ok(set)
    }

    /// Returns the cards that are drawn in place of the strands, if any.
    pub(crate) fn cards(&self) -> Option<&CardBuffers> {
        self.asset.cards.as_ref()
    }

    /// Replaces the strand buffers by others of another capacity.
    pub(crate) fn resize(&mut self, strands: &StrandBuffers) {
        self.strands = strands.clone();
        self.show(&strands.drawn);
    }

    /// Shares the fiber tables of `other` if the fibers of both have the same shape, whatever their pigments. The
    /// tables are then computed and stored once.
    pub(crate) fn reuse_fibers(&self, other: &Self) {
        let key = |set: &Self| (set.material.fiber.shape, set.material.fiber.density_back);
        if key(self) == key(other) {
            let tables = other.fiber().clone();
            *self.fiber() = tables;
        }
    }

    /// Locks the fiber tables.
    pub(crate) fn fiber(&self) -> MutexGuard<'_, Arc<FiberTables>> {
        // The tables are valid even if another thread has panicked.
        self.fiber.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Limits shading, shadow maps and drawing to `drawn`.
    pub(crate) fn show(&mut self, drawn: &DrawCount) {
        self.drawn = *drawn;
        // The texels of the maps are coarse: about eight segments per strand are enough.
        let last = drawn.vertex_count.saturating_sub(1).max(1);
        let stride = (last / 8).max(1);
        self.splat = [stride, last.div_ceil(stride)];
        self.spans = spans(drawn.vertex_count, stands_for(self.strands.count, drawn.count));
        let count = self.strands.count;
        if drawn.count == 0 {
            return;
        }
        self.asset
            .strips()
            .entry(drawn.vertex_count)
            .or_insert_with(|| Arc::new(Chunks::of(&self.context.device, count, drawn.vertex_count)));
    }

    /// Fills the fiber tables, if `model` reads them. Returns the fraction of light that a fiber passes on, and the
    /// fraction of that light which hits other hair.
    pub(crate) fn passes(&self, model: ShadingModel) -> (Vec3, f32) {
        if model == ShadingModel::Fiber {
            let fiber = &self.material.fiber;
            let mut tables = self.fiber();
            if Arc::strong_count(&tables) > 1 && tables.is_stale_for(&fiber.shape, fiber.density_back) {
                *tables = Arc::new(tables.new_empty());
            }
            tables.fill(&fiber.shape, fiber.density_back);
            let absorption = 0.5 * (fiber.root_absorption + fiber.tip_absorption);
            (tables.forward_fraction(absorption), fiber.density_forward.clamp(0.0, 1.0))
        } else {
            (Vec3::splat(1.0 - self.material.opacity.clamp(0.0, 1.0)), 1.0)
        }
    }

    /// Bytes of the fiber tables, if they are shared with other heads or not.
    pub(crate) fn fiber_bytes(&self, shared: bool) -> u64 {
        let fiber = self.fiber();
        if (Arc::strong_count(&fiber) > 1) == shared { fiber.bytes() } else { 0 }
    }

    /// Triangles of the strips or cards.
    pub fn triangles(&self) -> u64 {
        if let Some(cards) = self.cards() {
            return cards.triangles(self.drawn.vertex_count);
        }
        u64::from(self.drawn.count) * 2 * u64::from(self.drawn.vertex_count.saturating_sub(1))
    }
}

/// Returns the number of strands that each drawn strand represents.
fn stands_for(all: u32, drawn: u32) -> u32 {
    all / drawn.max(1)
}

/// Returns the number of vertices between shading samples, and the number of spans, at most [`SPANS`], for strands of
/// `vertex_count` vertices of which each represents `stands_for`.
fn spans(vertex_count: u32, stands_for: u32) -> [u32; 2] {
    // Incoming light changes over an eighth of a strand, or over a few vertices of a fine one. A few strands that
    // represent many must be as bright as those: their samples are as dense as the room for all samples allows.
    let last = vertex_count.saturating_sub(1).max(1);
    let stride = last.div_ceil(8).min(STRIDE) / stands_for.clamp(1, STRIDE);
    let stride = stride.max(last.div_ceil(SPANS)).max(1);
    [stride, last.div_ceil(stride)]
}

/// Maximum number of vertices from one shading sample to the next.
const STRIDE: u32 = 3;

/// Maximum number of spans of a strand. `select_visible` keeps one bit for each, and one for the sample after the last.
const SPANS: u32 = 31;

/// Returns the words that shading stores per vertex.
fn words_for(rate: ShadingRate) -> u64 {
    match rate {
        ShadingRate::PerVertex => 1,
        ShadingRate::PerPixel => 2,
    }
}

/// Bytes of a shading sample.
const SAMPLE_BYTES: u64 = 8;

/// Returns the maximum number of shading samples of `count` strands with `vertex_count` vertices, over all levels of
/// detail that `capacity` allows.
fn max_samples([count, vertex_count]: [u32; 2], capacity: &StrandCapacity) -> u64 {
    let counts = (1..=vertex_count).flat_map(|vertices| {
        (1..=STRIDE).map(move |of| {
            let strands = (count / of).min(capacity.strands).min(capacity.vertices / vertices.max(1));
            u64::from(strands) * u64::from(spans(vertices, of)[1] + 1)
        })
    });
    counts.max().unwrap_or(2).max(2)
}

/// Returns the bytes of the shading samples of `count` strands with `vertex_count` vertices.
pub(crate) fn sample_bytes([count, vertex_count]: [u32; 2]) -> u64 {
    let capacity = StrandCapacity { strands: count, vertices: count.saturating_mul(vertex_count) };
    max_samples([count, vertex_count], &capacity) * SAMPLE_BYTES
}

/// Data of a groom per view: its shaded colors, which depend on camera and lights.
#[derive(Debug)]
pub(crate) struct HairShading {
    pub(crate) uniform: Uniform,
    pub(crate) colors: wgpu::Buffer,
    pub(super) shading_samples: wgpu::Buffer,
    /// Capacity of `knots`.
    pub(super) sample_capacity: u64,
    /// Whether `knots` is scratch memory of the groom.
    lent: bool,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) shade: wgpu::BindGroup,
    pub(super) splat: wgpu::BindGroup,
    pub(super) ambient_splat: wgpu::BindGroup,
}

impl HairShading {
    /// Creates the data for `hair` in the light of `state`, seen by `camera`.
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold the buffers.
    pub(crate) fn new(
        context: &Context,
        state: &LightState,
        camera: &Uniform,
        hair: &HairSet,
        rate: ShadingRate,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let StrandBuffers { count, vertex_count, vertices, strands, widening, capacity, .. } = &hair.strands;
        let words = words_for(rate) * u64::from(capacity.vertices);
        let colors = storage::<u32>(device, "shaded strands", words)?;
        let sample_capacity = max_samples([*count, *vertex_count], capacity);
        // The second group of four lights has samples of its own.
        let groups = u64::from(state.max_lights().div_ceil(LIGHT_GROUP));
        let bytes = groups * sample_capacity * SAMPLE_BYTES;
        let lent = hair.asset.scratch.clone().filter(|scratch| scratch.size() >= bytes);
        let own = || storage::<u8>(device, "knots of strands", bytes);
        let (lent, shading_samples) = (lent.is_some(), lent.map_or_else(own, Ok)?);
        let uniform = device.uniform(size_of::<HairUniform>());
        let own = [
            uniform.as_entire_binding(),
            vertices.as_entire_binding(),
            strands.as_entire_binding(),
            colors.as_entire_binding(),
        ];
        let [hair_maps, hair_blocks] = state.maps.hair_buffers().map(BindBuffer::entire);
        let (lights, cells) = (state.lights.entire(), state.ambient.sums().entire());
        let (set, vertices) = (uniform.entire(), vertices.entire());
        let (strands, widening) = (strands.entire(), widening.entire());
        let splat = pipelines.splat[0].bind(&kernels::ShadowMaps {
            lights,
            hair: set,
            vertices,
            strands,
            hair_maps,
            hair_blocks,
            widening,
        });
        let ambient_splat = kernels::ambient::SplatHair { lights, hair: set, vertices, strands, cells };
        let ambient_splat = pipelines.ambient.splat_hair.bind(&ambient_splat);
        let sample_bindings =
            bind_samples(camera, &uniform, &hair.strands, &colors, &shading_samples, &pipelines.all);
        let shade = pipelines.shade(false, false).bind(&state.shading(sample_bindings));
        Ok(Self {
            group: device.group("hair", &pipelines.hair, &own),
            shade,
            splat,
            ambient_splat,
            uniform,
            colors,
            shading_samples,
            sample_capacity,
            lent,
        })
    }

    /// Uploads the uniform of `hair` for the current frame. The earlier grooms of the frame have `first` strands in
    /// total.
    pub(crate) fn prepare(&self, hair: &HairSet, model: ShadingModel, first: u32) {
        let spans = [hair.splat, hair.spans];
        let uniform = hair.material.uniform(model, &hair.drawn, hair.strands.vertex_count, spans, first);
        self.uniform.write(0, bytemuck::bytes_of(&uniform));
    }

    /// Bindings of the kernels that shade the samples of `hair` whose indices are in `selected`.
    pub(super) fn sample_bindings<'a>(
        &'a self,
        camera: &'a Uniform,
        hair: &'a HairSet,
        selected: &'a wgpu::Buffer,
    ) -> kernels::ShadingSample<'a> {
        bind_samples(camera, &self.uniform, &hair.strands, &self.colors, &self.shading_samples, selected)
    }

    /// Whether the buffers have room for shading the strands at `rate`.
    pub(crate) fn holds(&self, hair: &HairSet, rate: ShadingRate) -> bool {
        self.colors.size() >= 4 * words_for(rate) * u64::from(hair.strands.capacity.vertices)
    }

    /// Bytes of GPU memory, without memory of the groom.
    pub fn bytes(&self) -> u64 {
        self.uniform.size() + self.colors.size() + if self.lent { 0 } else { self.shading_samples.size() }
    }
}

fn bind_samples<'a>(
    camera: &'a Uniform,
    uniform: &'a Uniform,
    strands: &'a StrandBuffers,
    colors: &'a wgpu::Buffer,
    shading_samples: &'a wgpu::Buffer,
    selected: &'a wgpu::Buffer,
) -> kernels::ShadingSample<'a> {
    kernels::ShadingSample {
        view: camera.entire(),
        hair: uniform.entire(),
        vertices: strands.vertices.entire(),
        strands: strands.strands.entire(),
        shaded: colors.entire(),
        shading_samples: shading_samples.entire(),
        selected: selected.entire(),
    }
}

/// A groom in one view, as the light, draw and debug stages read it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HairView<'a> {
    pub hair: &'a HairSet,
    pub shaded: &'a HairShading,
    /// Light of the view, or of the zone that the groom is in.
    pub light: &'a LightState,
    /// Whether `light` belongs to a zone.
    pub zoned: bool,
}

impl HairView<'_> {
    /// Returns the hair as the shadow maps of its own zone read it.
    pub(crate) fn caster(&self) -> HairCaster<'_> {
        self.caster_bound(&self.shaded.splat)
    }

    /// Returns the hair as shadow maps read it that are bound with `group`.
    pub(crate) fn caster_bound<'g>(&self, group: &'g wgpu::BindGroup) -> HairCaster<'g> {
        let HairSet { drawn, splat, write_count, .. } = *self.hair;
        HairCaster { group, drawn, splat, write_count }
    }

    /// Records all cards. The caller has set the pipeline and bound the group of the frame.
    pub(crate) fn record_cards(&self, pass: &mut crate::gpu::RenderPass<'_>) {
        let Some(cards) = self.hair.cards() else { return };
        if self.zoned {
            pass.set_bind_group(0, &self.light.frame, &[]);
        }
        pass.set_bind_group(1, &self.shaded.group, &[]);
        cards.record(pass, self.hair.drawn.vertex_count);
    }

    /// Records all strips. The caller has set the pipeline and bound the group of the frame.
    pub(crate) fn record_strips(&self, pass: &mut crate::gpu::RenderPass<'_>) {
        self.record_strips_of(pass, 0..self.hair.drawn.count);
    }

    /// Records the strips of a range of strands.
    pub(crate) fn record_strips_of(&self, pass: &mut crate::gpu::RenderPass<'_>, strands: Range<u32>) {
        if self.zoned {
            pass.set_bind_group(0, &self.light.frame, &[]);
        }
        pass.set_bind_group(1, &self.shaded.group, &[]);
        pass.set_bind_group(2, &self.hair.fiber().group, &[]);
        if let Some(strips) = self.hair.asset.strips().get(&self.hair.drawn.vertex_count) {
            strips.record(pass, strands);
        }
    }
}
