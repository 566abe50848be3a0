//! Avoidance: drawn strands that enter an obstacle are moved out of it, without further simulation.
//!
//! No guide is inside an obstacle, but what is interpolated between guides on two sides of one may be. Each
//! strand finds its first penetrating vertex; from before it to the tip the strand changes over from the
//! blend of its guides (multi-strand interpolation) to the clump around the nearest one (single-strand
//! interpolation).
//!
//! ```text
//! vertices, rest ─► first_hit (8 vertices) ─► states: hit ─► change_over (per strand) ─► vertices
//! @group(1), obstacles ─┘                     amount, at ◄─┘ samples, bindings, @group(1)
//! ```
//!
//! **The first hit** is an atomic minimum of vertex indices, one integer per strand. A vertex penetrates
//! when it is nearer to an obstacle than the clearance, or than its rest distance where that is smaller, by
//! more than a tolerance: hair that rests in the skin stays there. The difference from the rest distance is
//! a constant of the vertex, eight bits of [`PackedRest`], so that the search reads one distance per
//! vertex. A thread has [`HIT_RUN`](crate::constants::HIT_RUN) vertices in a row: it asks an obstacle for distances only
//! where the box around what is solid in it is near the sphere around them all, and reads where obstacles are once for
//! all of them. Strands of a workgroup have the same place along the hair, so that lanes that run in step want the same
//! obstacle.
//!
//! **The change-over.** Beyond the hit the target of a vertex is where its first guide alone (the one with
//! the largest weight) carries it, with its offset from the guide shortened by the tightness, so that a
//! clump wider than its guide's distance from the obstacle draws together. Over a zone before the hit the
//! blend becomes the clump; the zone is a length of hair in metres, ends at the hit and starts no earlier
//! than the root. The strand is then walked again: the directions of the edges of that curve, with the rest
//! lengths; the sideways drift of the walk is corrected over a third of the zone. A vertex that still
//! penetrates slides along the obstacle: it is moved out along the normal and its edge is restored to its
//! length. Lengths are exact, and a strand without a hit is unchanged bit for bit.
//!
//! **Nothing pops.** The first hit jumps from frame to frame, so each strand stores an amount and a place.
//! The amount rises from 0 to 1 while there are hits and falls when there are none; the place follows the
//! first hit at a bounded speed. Vertices that penetrate in the meantime slide: the slide starts at depth
//! zero and therefore needs no smoothing. Rates of two frames are averaged, since a hit starts somewhere
//! between them: 30 and 60 frames per second differ by less than 2 mm in the middle of a turn. When the
//! head jumps or the hair is reset this state is cleared, and strands that hit have changed over at once.
//!
//! **Measured** (`tests/gpu/avoid_grooms.rs`): vertices deeper in the head than 0.5 mm (or than 0.5 mm below
//! where they rest, if they rest in it) in the worst frame of a turn and of a shake, in percent: without
//! avoidance, with penetrating vertices moved, with the method:
//!
//! | groom | turn | shake |
//! |---|---|---|
//! | long, 166 guides | 1.15, 0.06, 0.00 | 2.14, 0.14, 0.00 |
//! | bob, 200 guides | 0.34, 0.01, 0.00 | 0.40, 0.01, 0.00 |
//! | curly, 240 guides | 1.0, 0.01, 0.01 | 1.5, 0.01, 0.01 |
//! | short, 400 guides | 0.01, 0, 0 | 0.03, 0, 0 |
//! | Sintel, every strand a guide | 0.01, 0.01, 0.01 | 0.01, 0.01, 0.01 |
//! | Sintel, one guide in 16 | 0.05, 0.01, 0.00 | 0.18, 0.02, 0.01 |
//! | Sintel, one guide in 64 | 0.11, 0.01, 0.01 | 0.28, 0.02, 0.01 |
//!
//! In a turn a third as fast, on a coarse groom, avoidance moves no vertex by more than 1.6 mm per frame
//! relative to the head; without smoothing, by up to 15 mm (`tests/gpu/avoid.rs`). The stage costs about as
//! much as [`crate::interpolate`] for the turning long style with 20,000 strands on a CPU driver.
//!
//! **Why not only move the vertices out?** That also puts them outside ([`AvoidMode::PenetratingOnly`] does
//! it), but edges stretch and the rest of the strand stays where it was: tips lie flat on the skin or dip
//! in and out of it. **Why not as in the first publication** (Tariq and Bavoil, SIGGRAPH 2008; Tariq, GDC
//! 2010)? It blends over 60 vertices before the hit, nearly the whole hair, in a single frame; and it
//! shared a hit among ten strands by mistake. **Why not slide every strand while it is interpolated?** An
//! earlier version did. It keeps strands out too, but samples the field inside the longest walk, and hair
//! beyond a contact keeps the direction that led into the obstacle.
//!
//! **Known limits.** A strand with one guide has no other to change over to: it draws together and slides; one that
//! is its own guide only slides.
//! Nothing is tested between two vertices. From deep inside a thin part, such as an ear, the distance
//! field's normal does not lead out. A strand's own rest distance counts for every collider, not only for
//! the head that it grows from.
//!
//! **Untried.** A tightness that depends on the guide's distance from the obstacle.

mod options;
mod pipelines;

pub use options::{AvoidMode, AvoidOptions};
pub(crate) use pipelines::{AvoidGroups, Pipelines};

use crate::{
    Context, Result,
    collide::ColliderSet,
    gpu::bindings,
    groom::{BoundStrands, SdfGrid},
    strands::{GuideBuffers, PackedRest, StrandBuffers, buffers::storage},
};
use bytemuck::{Pod, Zeroable};
use std::sync::Arc;

/// The uniform of the kernels.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct AvoidParams {
    /// How far strands keep from obstacles, metres.
    pub clearance: f32,
    /// [`AvoidOptions::tolerance`].
    pub tolerance: f32,
    /// [`AvoidOptions::zone`].
    pub zone: f32,
    /// [`AvoidOptions::tightness`].
    pub tightness: f32,
    /// Number of strands.
    pub strand_count: u32,
    /// Vertices of a drawn strand, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2.
    pub sample_count: u32,
    /// The first strand that was not drawn in the frame before: what is remembered of it is out of date.
    pub fresh: u32,
    /// 0 to forget what was, else 1.
    pub keep: f32,
    /// By how much a change-over that is needed grows, 0..=2, where 2 is at once.
    pub rise: f32,
    /// By how much one that is not needed shrinks, likewise.
    pub fall: f32,
    /// How far it moves along the strand at most, metres.
    pub shift: f32,
    /// Vertices of a strand's rest curve, at least 2.
    pub rest_count: u32,
    /// See [`crate::strands::Drawn::stride`].
    pub stride: f32,
    /// Unused.
    pub _pad: [u32; 2],
}

/// What is remembered of one strand.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StrandState {
    /// The first vertex that penetrates; [`NO_HIT`] between frames and where none does.
    pub hit: crate::gpu::Atomic,
    /// How far the strand has changed over, 0..=1.
    pub amount: f32,
    /// From where on it is the clump's, metres from its root.
    pub at: f32,
    /// Whether it hit in the last frame.
    pub hit_before: u32,
}

/// [`StrandState::hit`] of a strand that penetrates nothing.
pub const NO_HIT: u32 = u32::MAX;

/// One groom's share of the stage.
#[derive(Debug)]
pub struct Avoidance {
    pipelines: Arc<Pipelines>,
    /// How strands avoid obstacles. [`AvoidOptions::check`] says what is allowed.
    pub options: AvoidOptions,
    clearance: f32,
    params: wgpu::Buffer,
    states: wgpu::Buffer,
    groups: AvoidGroups,
}

impl Avoidance {
    /// For strands that keep `clearance` metres from obstacles.
    ///
    /// # Errors
    /// What [`AvoidOptions::check`] says, and [`crate::Error::Limit`].
    pub fn new(
        context: &Context,
        options: AvoidOptions,
        clearance: f32,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        options.check()?;
        let params = bindings::uniform(device, "avoid", size_of::<AvoidParams>());
        let states = states(context, strands)?;
        let groups = pipelines.bind(&params, &states, guides, strands);
        Ok(Self { pipelines, options, clearance, params, states, groups })
    }

    /// Of another head with the same groom, which nothing has touched yet.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn another(
        &self,
        context: &Context,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> Result<Self> {
        let Self { options, clearance, .. } = *self;
        Self::new(context, options, clearance, guides, strands)
    }

    /// From here on its strands are in `strands`, with other room: those that there is room for in both go on as they
    /// are.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn move_into(
        &mut self,
        context: &Context,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> Result<()> {
        let Context { device, queue, .. } = context;
        let states = states(context, strands)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.states, 0, &states, 0, states.size().min(self.states.size()));
        queue.submit([encoder.finish()]);
        self.groups = self.pipelines.bind(&self.params, &states, guides, strands);
        self.states = states;
        Ok(())
    }

    /// Writes the uniform of a frame of `dt` seconds; `forget` starts anew, as strands from `fresh` on do.
    pub(crate) fn prepare(
        &self,
        context: &Context,
        (guides, strands): (&GuideBuffers, &StrandBuffers),
        dt: f32,
        forget: bool,
        fresh: u32,
    ) {
        let Context { queue, .. } = context;
        let [rise, fall, shift] = if forget { [2.0, 2.0, f32::MAX] } else { self.options.per_frame(dt) };
        let params = AvoidParams {
            clearance: self.clearance,
            tolerance: self.options.tolerance,
            zone: self.options.zone,
            tightness: self.options.tightness,
            strand_count: strands.drawn.count,
            vertex_count: strands.drawn.vertex_count,
            sample_count: guides.sample_count,
            fresh,
            keep: if forget { 0.0 } else { 1.0 },
            rise,
            fall,
            shift,
            rest_count: strands.vertex_count,
            stride: strands.drawn.stride,
            _pad: [0; 2],
        };
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
    }

    /// Records the stage.
    pub(crate) fn record(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        if !colliders.is_empty() {
            self.pipelines.record(pass, &self.groups, colliders, strands, self.options.mode);
        }
    }

    /// Records only the search: [`StrandState::hit`] is then the first hit of each strand.
    pub fn record_search(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        self.pipelines.record_first_hit(pass, &self.groups, colliders, strands);
    }

    /// [`StrandState`], one per strand.
    pub fn states(&self) -> &wgpu::Buffer {
        &self.states
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.params.size() + self.states.size()
    }
}

/// Of strands that nothing has touched yet, as many as there is room for.
fn states(context: &Context, strands: &StrandBuffers) -> Result<wgpu::Buffer> {
    let Context { device, queue, .. } = context;
    let states = storage::<StrandState>(device, "avoidance", strands.room.strands.into())?;
    let none = StrandState { hit: NO_HIT, amount: 0.0, at: 0.0, hit_before: 0 };
    queue.write_buffer(&states, 0, bytemuck::cast_slice(&vec![none; strands.room.strands as usize]));
    Ok(states)
}

/// The rest vertices of `strands`, each with what it rests nearer to the surface of a `field` than `clearance`.
pub fn sunk(strands: &BoundStrands, field: &SdfGrid, clearance: f32) -> Vec<PackedRest> {
    let n = strands.vertex_count.max(1) as usize;
    let vertex = |(i, rest): (usize, &PackedRest)| {
        let (p, _) = rest.unpack(&strands.bindings[i / n]);
        rest.sink(clearance - field.sample(p))
    };
    strands.rest.iter().enumerate().map(vertex).collect()
}
