//! Strand collision (avoidance): drawn strands that enter an obstacle are moved out of it, without further simulation.
//!
//! Guides stay outside obstacles, but strands interpolated between guides on two sides of an obstacle may not. Each
//! strand finds its first penetrating vertex. From there to the tip, and over a zone before it, the strand changes over
//! from the blend of its guides (multi-strand interpolation) to the clump around the nearest one (single-strand
//! interpolation).
//!
//! ```text
//! vertices, rest ─► first_hit (8 vertices) ─► states: hit ─► change_over (per strand) ─► vertices
//! @group(1), obstacles ─┘                     amount, at ◄─┘ samples, bindings, @group(1)
//! ```
//!
//! **First hit.** An atomic minimum of vertex indices, one integer per strand. A vertex penetrates if it is closer to
//! an obstacle than its allowed distance by more than a tolerance. The allowed distance is the clearance, or the rest
//! distance if that is smaller, so hair that rests in the skin stays there. The difference from the rest distance is a
//! constant of the vertex, eight bits of [`PackedRest`], so the search evaluates one distance per vertex. A thread
//! processes [`HIT_RUN`](crate::constants::HIT_RUN) consecutive vertices. It evaluates only obstacles whose solid box
//! is near the sphere around these vertices, and reads each obstacle's pose once for all of them. Strands of a
//! workgroup have the same position along the hair, so lanes that run in step tend to need the same obstacle.
//!
//! **Change-over.** Beyond the hit, a vertex's target is its position on its first guide alone (the one with the
//! largest weight). The tightness shortens its offset from the guide, so that a clump contracts if it is wider than its
//! guide's distance from the obstacle. Over a zone before the hit the blend becomes the clump. The zone is a length of
//! hair in meters, ends at the hit and starts no earlier than the root. The strand is then walked again along the edge
//! directions of that curve, with the rest lengths; the sideways drift of the walk is corrected over a third of the
//! zone. A vertex that still penetrates slides along the obstacle: it is moved out along the normal and its edge is
//! restored to its length. Lengths are exact, and a strand without a hit is bit-identical.
//!
//! **Temporal smoothing.** The first hit jumps from frame to frame, so each strand stores an amount and a position. The
//! amount rises from 0 to 1 while there are hits and falls when there are none; the position follows the first hit at a
//! bounded speed. Vertices that penetrate in the meantime slide; the slide starts at depth zero and needs no smoothing.
//! Rates of two frames are averaged, since a hit starts somewhere between them: 30 and 60 frames per second differ by
//! less than 2 mm in the middle of a turn. When the head jumps or the hair is reset, this state is cleared, and strands
//! with a hit change over at once.
//!
//! **Measured** (`tests/gpu/avoid_grooms.rs`): percentage of vertices deeper in the head than 0.5 mm (or than 0.5 mm
//! below their rest position, if that is in the head), in the worst frame of a turn and of a shake. The three numbers
//! are: without avoidance, with penetrating vertices moved, and with this method.
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
//! In a turn a third as fast, on a coarse groom, avoidance moves no vertex by more than 1.6 mm per frame relative to
//! the head; without smoothing, by up to 15 mm (`tests/gpu/avoid.rs`). For the turning long style with 20,000 strands
//! on a CPU driver, the stage costs about as much as [`crate::interpolate`].
//!
//! **Why not only move the vertices out?** [`AvoidMode::PenetratingOnly`] does so. The vertices are then outside, but
//! edges stretch and the rest of the strand stays in place: tips lie flat on the skin or dip in and out of it. **Why
//! not as in the first publication** (Tariq and Bavoil, SIGGRAPH 2008; Tariq, GDC 2010)? It blends over 60 vertices
//! before the hit, nearly the whole hair, in a single frame, and it shared a hit among ten strands by mistake. **Why
//! not slide every strand during interpolation?** An earlier version did. It also keeps strands out, but samples the
//! field inside the longest walk, and hair beyond a contact keeps the direction that led into the obstacle.
//!
//! **Known limits.** A strand with one guide has no other to change over to: it contracts towards its guide and slides.
//! A strand that is its own guide only slides. Nothing is tested between two vertices. From deep inside a thin part,
//! such as an ear, the distance field's normal does not lead out. A strand's own rest distance applies to every
//! collider, not only to the head that it grows from.
//!
//! **Untried.** A tightness that depends on the guide's distance from the obstacle.

mod options;
mod pipelines;

pub use options::{AvoidMode, AvoidOptions};
pub(crate) use pipelines::{AvoidGroups, Pipelines};

use crate::{
    Context, Result,
    collide::ColliderSet,
    gpu::Uniform,
    groom::{BoundStrands, SdfGrid},
    strands::{GuideBuffers, PackedRest, StrandBuffers, buffers::storage},
};
use bytemuck::{Pod, Zeroable};
use std::sync::Arc;

/// Uniform of the kernels.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct AvoidParams {
    /// Distance that strands keep from obstacles, meters.
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
    /// First strand that was not drawn in the previous frame; the state from it on is out of date.
    pub fresh: u32,
    /// Factor of the previous state: 0 to discard it, else 1.
    pub keep: f32,
    /// Rise of the amount per frame, 0..=2, where 2 is immediate.
    pub rise: f32,
    /// Fall of the amount per frame, 0..=2, where 2 is immediate.
    pub fall: f32,
    /// Largest motion of the change-over along the strand per frame, meters.
    pub shift: f32,
    /// Vertices of a strand's rest curve, at least 2.
    pub rest_count: u32,
    /// See [`crate::strands::DrawCount::stride`].
    pub stride: f32,
    /// Unused.
    pub _pad: [u32; 2],
}

/// State of one strand between frames.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StrandState {
    /// First vertex that penetrates; [`NO_HIT`] between frames and for a strand that does not penetrate.
    pub hit: crate::gpu::Atomic,
    /// Amount of the change-over, 0..=1.
    pub amount: f32,
    /// Arc length from the root beyond which the strand follows the clump, meters.
    pub at: f32,
    /// 1 if the strand had a hit in the last frame, else 0.
    pub hit_before: u32,
}

/// [`StrandState::hit`] of a strand that does not penetrate.
pub const NO_HIT: u32 = u32::MAX;

/// Strand collision of one groom.
#[derive(Debug)]
pub struct Avoidance {
    pipelines: Arc<Pipelines>,
    /// Options; [`AvoidOptions::check`] has the valid ranges.
    pub options: AvoidOptions,
    clearance: f32,
    params: Uniform,
    states: wgpu::Buffer,
    groups: AvoidGroups,
}

impl Avoidance {
    /// Creates the stage for strands that keep `clearance` meters from obstacles.
    ///
    /// # Errors
    /// The errors of [`AvoidOptions::check`], and [`crate::Error::Limit`].
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
        let params = device.uniform(size_of::<AvoidParams>());
        let states = states(context, strands)?;
        let groups = pipelines.bind(&params, &states, guides, strands);
        Ok(Self { pipelines, options, clearance, params, states, groups })
    }

    /// Rebinds to `strands`, which have another capacity. Strands that fit into both keep their state.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub(crate) fn resize(
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

    /// Writes the uniform of a frame of `dt` seconds. `forget` discards the state of all strands; strands from `fresh`
    /// on always start anew.
    pub(crate) fn prepare(
        &self,
        (guides, strands): (&GuideBuffers, &StrandBuffers),
        dt: f32,
        forget: bool,
        fresh: u32,
    ) {
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
        self.params.write(0, bytemuck::bytes_of(&params));
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

    /// Records only the search, after which [`StrandState::hit`] is the first hit of each strand.
    pub fn record_search(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        self.pipelines.record_first_hit(pass, &self.groups, colliders, strands);
    }

    /// Returns the buffer of [`StrandState`], one per strand.
    pub fn states(&self) -> &wgpu::Buffer {
        &self.states
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.params.size() + self.states.size()
    }
}

/// Creates the initial states, as many as the strand buffers can hold.
fn states(context: &Context, strands: &StrandBuffers) -> Result<wgpu::Buffer> {
    let Context { device, queue, .. } = context;
    let states = storage::<StrandState>(device, "avoidance", strands.capacity.strands.into())?;
    let none = StrandState { hit: NO_HIT, amount: 0.0, at: 0.0, hit_before: 0 };
    queue.write_buffer(&states, 0, bytemuck::cast_slice(&vec![none; strands.capacity.strands as usize]));
    Ok(states)
}

/// Returns the rest vertices of `strands`, each with the difference by which it rests closer to the surface of a
/// `field` than `clearance`.
pub fn with_penetration(strands: &BoundStrands, field: &SdfGrid, clearance: f32) -> Vec<PackedRest> {
    let n = strands.vertex_count.max(1) as usize;
    let vertex = |(i, rest): (usize, &PackedRest)| {
        let (p, _) = rest.unpack(&strands.bindings[i / n]);
        rest.with_penetration(clearance - field.sample(p))
    };
    strands.rest.iter().enumerate().map(vertex).collect()
}
