//! Strands that are lit and drawn: what all views share of a groom, and what each view has of it.

use super::{
    Pipelines, State,
    fiber::FiberTables,
    material::{HairMaterial, HairUniform, ShadingModel, ShadingRate},
};
use crate::{
    Context, Error, Result,
    gpu::bindings,
    strands::{Drawn, Room, StrandBuffers, buffers::storage, indices::Chunks},
};
use glam::Vec3;
use std::{
    collections::BTreeMap,
    ops::Range,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// A groom as light and draw need it, whoever looks at it: its strands, their look, its index lists.
#[derive(Debug)]
pub struct HairSet {
    context: Context,
    /// What the hair looks like.
    pub material: HairMaterial,
    /// The area of all strands, width times length, m²: what a groom weighs in values that the grooms of a picture
    /// share: those of the lights' uniform, which bodies and the grid of ambient light read.
    pub area: f32,
    /// What of the strands is drawn.
    pub drawn: Drawn,
    pub(crate) strands: StrandBuffers,
    /// By their number of vertices, made when a level of detail first asks for it.
    strips: Arc<Mutex<BTreeMap<u32, Arc<Chunks>>>>,
    /// Stride and number of the segments in the shadow maps.
    pub(crate) splat: [u32; 2],
    /// Vertices between the knots that shading has along a strand, and number of the spans between them.
    pub(crate) spans: [u32; 2],
    /// Those of other heads too, as long as their fibres are alike.
    fiber: Mutex<Arc<FiberTables>>,
    /// Memory in which the knots of every view may lie, since nobody needs them once a groom is shaded.
    scratch: Option<wgpu::Buffer>,
}

/// What is supposed of a strand whose size nobody has said: 80 µm by 20 cm.
const STRAND_AREA: f32 = 8e-5 * 0.2;

impl HairSet {
    /// Prepares `strands` to be lit and drawn.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn new(context: &Context, strands: &StrandBuffers) -> Result<Self> {
        let vertices = u64::from(strands.count) * u64::from(strands.vertex_count);
        if vertices * 2 > i32::MAX as u64 {
            return Err(Error::Limit {
                what: "strand vertices",
                need: vertices * 32,
                have: i32::MAX as u64 * 16,
            });
        }
        let mut set = Self {
            context: context.clone(),
            material: HairMaterial::default(),
            area: strands.count as f32 * STRAND_AREA,
            drawn: strands.drawn,
            strands: strands.clone(),
            strips: Arc::default(),
            splat: [1; 2],
            spans: [1; 2],
            fiber: Mutex::new(Arc::new(FiberTables::new(context))),
            scratch: None,
        };
        set.show(&strands.drawn);
        Ok(set)
    }

    /// The same, whose knots lie in `scratch` while it is shaded, where there is room for them.
    pub(crate) fn within(self, scratch: &wgpu::Buffer) -> Self {
        Self { scratch: Some(scratch.clone()), ..self }
    }

    /// Of another head with the same groom, whose own strands are `strands`: what depends on the groom and on its fibres
    /// alone is shared.
    pub(crate) fn another(&self, strands: &StrandBuffers) -> Self {
        let mut set = Self {
            strands: strands.clone(),
            strips: self.strips.clone(),
            fiber: Mutex::new(self.fiber().clone()),
            scratch: self.scratch.clone(),
            context: self.context.clone(),
            ..*self
        };
        set.show(&strands.drawn);
        set
    }

    /// From here on its strands are in `strands`: others of the same groom, or with other room.
    pub(crate) fn move_into(&mut self, strands: &StrandBuffers) {
        self.strands = strands.clone();
        self.show(&strands.drawn);
    }

    /// From here on its fibres' tables are those of `other`, as long as both have fibres of one shape, whatever their
    /// pigments: they are computed once, and kept once.
    pub fn share_fibers(&self, other: &Self) {
        let key = |set: &Self| (set.material.fiber.shape, set.material.fiber.density_back);
        if key(self) == key(other) {
            let theirs = other.fiber().clone();
            *self.fiber() = theirs;
        }
    }

    /// The tables of its fibres.
    pub(crate) fn fiber(&self) -> MutexGuard<'_, Arc<FiberTables>> {
        // What a panic leaves behind is whole.
        self.fiber.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn strips(&self) -> MutexGuard<'_, BTreeMap<u32, Arc<Chunks>>> {
        self.strips.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From here on only what `drawn` says of the strands it was made for is shaded, splatted and drawn.
    pub(crate) fn show(&mut self, drawn: &Drawn) {
        self.drawn = *drawn;
        // The maps' texels are coarse: about eight segments per strand are enough.
        let last = drawn.vertex_count.saturating_sub(1).max(1);
        let stride = (last / 8).max(1);
        self.splat = [stride, last.div_ceil(stride)];
        self.spans = spans(drawn.vertex_count, stands_for(self.strands.count, drawn.count));
        let count = self.strands.count;
        self.strips()
            .entry(drawn.vertex_count)
            .or_insert_with(|| Arc::new(Chunks::of(&self.context.device, count, drawn.vertex_count)));
    }

    /// Fills the tables of its fibres, and says which share of the light that meets one it passes on, and which
    /// share of that meets other hair.
    pub(crate) fn passes(&self) -> (Vec3, f32) {
        if self.material.model == ShadingModel::Fiber {
            let fiber = &self.material.fiber;
            let mut tables = self.fiber();
            if Arc::strong_count(&tables) > 1 && tables.holds_others(&fiber.shape, fiber.density_back) {
                *tables = Arc::new(tables.empty());
            }
            tables.fill(&fiber.shape, fiber.density_back);
            let absorption = 0.5 * (fiber.root_absorption + fiber.tip_absorption);
            (tables.passes(absorption), fiber.density_forward.clamp(0.0, 1.0))
        } else {
            (Vec3::splat(1.0 - self.material.opacity.clamp(0.0, 1.0)), 1.0)
        }
    }

    /// Bytes of GPU memory, without the strands' own buffers.
    pub fn bytes(&self) -> u64 {
        self.fiber().bytes() + self.strips().values().map(|strips| strips.bytes()).sum::<u64>()
    }

    /// Bytes of GPU memory that it shares with other heads.
    pub(crate) fn shared_bytes(&self) -> u64 {
        let fiber = self.fiber();
        let fiber = if Arc::strong_count(&fiber) > 1 { fiber.bytes() } else { 0 };
        fiber + self.strips().values().map(|strips| strips.bytes()).sum::<u64>()
    }

    /// Triangles of the strips.
    pub fn triangles(&self) -> u64 {
        u64::from(self.drawn.count) * 2 * u64::from(self.drawn.vertex_count.saturating_sub(1))
    }
}

/// How many strands one of those that are drawn stands for.
fn stands_for(all: u32, drawn: u32) -> u32 {
    all / drawn.max(1)
}

/// How the knots are spread over a strand of so many vertices that stands for so many: from one to the next, and how
/// many spans that makes, at most [`SPANS`].
fn spans(vertex_count: u32, stands_for: u32) -> [u32; 2] {
    // What arrives of the light changes over an eighth of a strand, or a few vertices of a fine one. Few strands that
    // stand for many are to be as bright as those: knots as dense as the room for the knots of all of them allows.
    let last = vertex_count.saturating_sub(1).max(1);
    let stride = last.div_ceil(8).min(STRIDE) / stands_for.clamp(1, STRIDE);
    let stride = stride.max(last.div_ceil(SPANS)).max(1);
    [stride, last.div_ceil(stride)]
}

/// The most vertices from a knot to the next.
const STRIDE: u32 = 3;

/// The most spans of a strand: `choose` keeps a bit for each and for the knot behind the last.
const SPANS: u32 = 31;

/// Words that shading leaves at a vertex.
fn words_for(rate: ShadingRate) -> u64 {
    match rate {
        ShadingRate::PerVertex => 1,
        ShadingRate::PerPixel => 2,
    }
}

/// Bytes of a knot.
const KNOT: u64 = 8;

/// The most knots of `count` strands of so many vertices, at any level of detail that there is `room` for.
fn most_knots([count, vertex_count]: [u32; 2], room: &Room) -> u64 {
    let most = (1..=vertex_count).flat_map(|vertices| {
        (1..=STRIDE).map(move |of| {
            let strands = (count / of).min(room.strands).min(room.vertices / vertices.max(1));
            u64::from(strands) * u64::from(spans(vertices, of)[1] + 1)
        })
    });
    most.max().unwrap_or(2).max(2)
}

/// Bytes of the knots of `count` strands of so many vertices.
pub(crate) fn knot_bytes([count, vertex_count]: [u32; 2]) -> u64 {
    let room = Room { strands: count, vertices: count.saturating_mul(vertex_count) };
    most_knots([count, vertex_count], &room) * KNOT
}

/// A groom as one view sees it: its shaded colours, which depend on eye and lights.
#[derive(Debug)]
pub struct Shaded {
    pub(crate) uniform: wgpu::Buffer,
    pub(crate) colors: wgpu::Buffer,
    pub(super) knots: wgpu::Buffer,
    /// For how many knots there is room.
    pub(super) most_knots: u64,
    /// Whether they lie in memory of the groom.
    lent: bool,
    pub(crate) group: wgpu::BindGroup,
    pub(super) shade: wgpu::BindGroup,
    pub(super) splat: wgpu::BindGroup,
    pub(super) lay: wgpu::BindGroup,
}

impl Shaded {
    /// Of `hair` in the light of `state`, seen by `camera`.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn new(
        context: &Context,
        state: &State,
        camera: &wgpu::Buffer,
        hair: &HairSet,
        rate: ShadingRate,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let StrandBuffers { count, vertex_count, vertices, strands, widening, room, .. } = &hair.strands;
        let words = words_for(rate) * u64::from(room.vertices);
        let colors = storage::<u32>(device, "shaded strands", words)?;
        let most_knots = most_knots([*count, *vertex_count], room);
        let lent = hair.scratch.clone().filter(|scratch| scratch.size() >= most_knots * KNOT);
        let own = || storage::<u8>(device, "knots of strands", most_knots * KNOT);
        let (lent, knots) = (lent.is_some(), lent.map_or_else(own, Ok)?);
        let uniform = bindings::uniform(device, "hair", size_of::<HairUniform>());
        let own = [&uniform, vertices, strands, &colors].map(wgpu::Buffer::as_entire_binding);
        let maps = state.maps.hair_buffers();
        let splat = [&state.lights, &uniform, vertices, strands, maps[0], maps[1], widening];
        let lay = [&state.lights, &uniform, vertices, strands, state.ambient.sums()];
        let shade = shade_resources(state.frame_resources(camera), &own, &knots, &pipelines.all);
        Ok(Self {
            group: device.group("hair", &pipelines.hair, &own),
            shade: pipelines.shade(false).bind(&shade),
            splat: pipelines.splat.bind(&splat.map(wgpu::Buffer::as_entire_binding)),
            lay: pipelines.ambient.lay.bind(&lay.map(wgpu::Buffer::as_entire_binding)),
            uniform,
            colors,
            knots,
            most_knots,
            lent,
        })
    }

    /// Writes what the shaders know of `hair`, for the frame that is recorded; the grooms before it have `first`
    /// strands.
    pub(crate) fn prepare(&self, context: &Context, hair: &HairSet, first: u32) {
        let Context { queue, .. } = context;
        let uniform =
            hair.material.uniform(&hair.drawn, hair.strands.vertex_count, [hair.splat, hair.spans], first);
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Whether it has room for what is left of strands at `rate`.
    pub(crate) fn holds(&self, hair: &HairSet, rate: ShadingRate) -> bool {
        self.colors.size() >= 4 * words_for(rate) * u64::from(hair.strands.room.vertices)
    }

    /// Bytes of GPU memory, without what is the groom's.
    pub fn bytes(&self) -> u64 {
        self.uniform.size() + self.colors.size() + if self.lent { 0 } else { self.knots.size() }
    }
}

/// In the order of `shade_bindings`: of the frame, of the groom, its knots, and which of them are asked for.
pub(super) fn shade_resources<'a>(
    frame: [wgpu::BindingResource<'a>; 8],
    own: &[wgpu::BindingResource<'a>],
    knots: &'a wgpu::Buffer,
    chosen: &'a wgpu::Buffer,
) -> Vec<wgpu::BindingResource<'a>> {
    let last = [knots, chosen].map(wgpu::Buffer::as_entire_binding);
    frame.into_iter().chain(own.iter().cloned()).chain(last).collect()
}

/// A groom as light, draw and the views inside read it: in the eyes of one view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<'a> {
    pub hair: &'a HairSet,
    pub shaded: &'a Shaded,
    /// The light that it is in: of the view, or of a zone.
    pub light: &'a State,
    /// Whether that is a zone's.
    pub zoned: bool,
}

impl Seen<'_> {
    /// Records its strips; the pipeline is set, and the frame's group is bound.
    pub fn record_strips(&self, pass: &mut crate::gpu::RenderPass<'_>) {
        self.record_strips_of(pass, 0..self.hair.drawn.count);
    }

    /// Records those of some of its strands.
    pub fn record_strips_of(&self, pass: &mut crate::gpu::RenderPass<'_>, strands: Range<u32>) {
        if self.zoned {
            pass.set_bind_group(0, &self.light.frame, &[]);
        }
        pass.set_bind_group(1, &self.shaded.group, &[]);
        pass.set_bind_group(2, &self.hair.fiber().group, &[]);
        if let Some(strips) = self.hair.strips().get(&self.hair.drawn.vertex_count) {
            strips.record(pass, strands);
        }
    }
}
