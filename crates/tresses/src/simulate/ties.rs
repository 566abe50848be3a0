//! Ties: bands, braids and pins.
//!
//! A [`Tie`] is a region of the groom at rest. It holds the guides that pass through it, either together or to the
//! head.
//!
//! **Together** (a band, a ring of a braid): the vertices inside keep their rest arrangement as one rigid piece that
//! moves freely. Before each step, the kernel finds the rigid motion with the mass, momentum and angular momentum of
//! the vertices and the pose nearest to theirs (shape matching: Müller et al. 2005, "Meshless deformations based on
//! shape matching", eq. 1 and 4; rotation: Müller et al. 2016, "A robust method to extract the rotational part of
//! deformations", eq. 7). The rotation starts from the previous step's, so that a piece keeps its rotation about an
//! axis that its vertices do not determine. Each vertex gets the acceleration that would bring it, if it were free, to
//! its place and to the piece's velocity within the step. The net force and torque are zero and a band adds no mass:
//! the hair between scalp and band carries the tail. A vertex on a strand yields less than a free one, so no step
//! overshoots.
//!
//! **To the head** (a pin, a clip, a hair slide): before each step a held vertex gets a force towards its rest position
//! on the head, linear in its velocity and so stiff that it arrives by the end of the step. The strand's solve includes
//! this force, so a pin carries whatever hangs from it.
//!
//! **Why not exactly rigid?** Replacing the vertices by the rigid motion after each step was tried. Hairs that reach a
//! band from all sides cannot all keep their lengths while the band follows their mean; restoring lengths and restoring
//! rigidity undo each other, and a shaken ponytail bursts. A force with a rate in the solve, as for pins, pulls towards
//! the velocity of the whole band, which must be known in advance; taken from the previous step, it makes the band as
//! heavy as it is firm. The cost of the present method is that a band stretches: hairs that are pulled apart with
//! acceleration `a` separate by `s² a` in steps of length `s`. Under their own weight that is 3 mm at a step of 1/60 s
//! and a fifth of a millimeter at 1/240 s.
//!
//! **Gathered.** `gather` below 1 moves the rest positions of the held vertices towards the tie's center. The hair
//! moves there from its pose in the groom at half a meter per second. This ties up loose hair.
//!
//! A long tie is divided into rings no longer than they are wide; hair bends between them.
//!
//! ```text
//! rings, members ─► ties (a workgroup per ring), pins ─► forces ─► step
//! current, velocity ─┘
//! ```
//!
//! **Known limits.** A pin follows the rigid head, even where the skin under it deforms. Guides that a level of detail
//! does not simulate are not held; they follow their leaders.

use super::Pipelines;
use crate::{
    Context, Error, Result,
    constants::{TIE_WORKGROUP, VOLUME_WORKGROUP},
    gpu::{BindBuffer, BufferBinding, Opaque},
    groom::{
        Guides, curve,
        tie::{Tie, TieTarget},
    },
    shaders::kernels::simulate as kernels,
    strands::{GuideBuffers, buffers::filled},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// Maximum number of rings per head.
pub const MAX_RINGS: usize = 4096;

/// Number of rings and vertices that ties hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TieReport {
    /// Number of rigid pieces, of all ties that hold hair together.
    pub rings: usize,
    /// Number of guide vertices in rings.
    pub together: usize,
    /// Number of guide vertices held to the head.
    pub to_head: usize,
}

/// A ring in the layout of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Ring {
    /// Index of the first member.
    pub first: u32,
    /// Number of members.
    pub count: u32,
}

/// A held guide vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Member {
    /// Rest position, meters: relative to the ring's center of mass, or in groom space for a pin.
    pub rests: Vec3,
    /// Fraction of the ring's mass.
    pub mass: f32,
    /// Index in the guide buffers.
    pub vertex: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Rings and pins of a groom on the CPU.
#[derive(Clone, Debug, Default)]
struct TieVertices {
    rings: Vec<Ring>,
    members: Vec<Member>,
    pins: Vec<Member>,
}

impl TieVertices {
    /// Finds the vertices that `ties` hold. Where ties overlap, the first one holds the vertex.
    fn of(rest: &Guides, ties: &[Tie]) -> Result<Self> {
        let (count, n) = (rest.len(), rest.vertex_count as usize);
        let mut found = Self::default();
        let mut held = vec![false; count * n];
        for (number, tie) in ties.iter().enumerate() {
            tie.check()?;
            let mut rings = vec![Vec::<Member>::new(); tie.rings()];
            let of = |guide: &usize| tie.group.is_none_or(|group| rest.groups.get(*guide) == Some(&group));
            for guide in (0..count).filter(of) {
                let strand = rest.guide(guide);
                let length = curve::length(strand);
                for (i, along) in tie.holds(strand) {
                    let vertex = i * count + guide;
                    if std::mem::replace(&mut held[vertex], true) {
                        continue;
                    }
                    let end = if i + 1 == n { 0.5 } else { 1.0 };
                    let mass = (length * rest.strands[guide] * end).max(1e-6);
                    let ring = ((along * rings.len() as f32) as usize).min(rings.len() - 1);
                    let (rests, vertex) = (strand[i], vertex as u32);
                    rings[ring].push(Member { rests, mass, vertex, ..Member::zeroed() });
                }
            }
            let is_pinned = tie.held == TieTarget::ToHead;
            let several = |members: &Vec<Member>| {
                members.iter().any(|m| m.vertex as usize % count != members[0].vertex as usize % count)
            };
            rings.retain(|members| !members.is_empty() && (is_pinned || several(members)));
            if rings.is_empty() {
                let what = if is_pinned { "no guide passes" } else { "fewer than two guides pass" };
                let of = tie.group.map_or(String::new(), |group| format!(" of group {group}"));
                let sentence = format!(
                    "tie {} holds nothing: {what}{of} within {} mm of {} (groom space, meters)",
                    number + 1,
                    tie.radius * 1e3,
                    tie.from
                );
                return Err(Error::unusable(sentence));
            }
            for members in rings {
                found.add(members, tie);
            }
        }
        if found.rings.len() > MAX_RINGS {
            let sentence =
                format!("the ties have {} rings, more than the maximum of {MAX_RINGS}", found.rings.len());
            return Err(Error::unusable(sentence));
        }
        Ok(found)
    }

    /// Adds the members as a ring, or as pins.
    fn add(&mut self, mut members: Vec<Member>, tie: &Tie) {
        let total_mass: f32 = members.iter().map(|m| m.mass).sum();
        members.iter_mut().for_each(|m| m.mass /= total_mass);
        let center: Vec3 = members.iter().map(|m| m.rests * m.mass).sum();
        members.iter_mut().for_each(|m| m.rests = (m.rests - center) * tie.gather);
        if tie.held == TieTarget::ToHead {
            members.iter_mut().for_each(|m| m.rests += center);
            self.pins.extend(members);
            return;
        }
        self.rings.push(Ring { first: self.members.len() as u32, count: members.len() as u32 });
        self.members.extend(members);
    }

    fn report(&self) -> TieReport {
        TieReport { rings: self.rings.len(), together: self.members.len(), to_head: self.pins.len() }
    }
}

/// Ties of a groom on the GPU.
#[derive(Clone, Debug)]
pub(crate) struct TieAsset {
    /// [`Ring`]s and [`Member`]s.
    rings: wgpu::Buffer,
    members: wgpu::Buffer,
    pins: wgpu::Buffer,
    report: TieReport,
}

impl TieAsset {
    /// Finds what `ties` hold of guides with the rest poses `rest`; `None` without ties.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tie with invalid values, [`crate::groom::Error::Unusable`] for a tie that holds
    /// nothing and for more than [`MAX_RINGS`] rings; [`Error::Limit`].
    pub fn new(context: &Context, rest: &Guides, ties: &[Tie]) -> Result<Option<Self>> {
        if ties.is_empty() {
            return Ok(None);
        }
        let found = TieVertices::of(rest, ties)?;
        // A bound buffer has at least one element.
        fn upload<T: Pod>(context: &Context, what: &'static str, list: &[T]) -> Result<wgpu::Buffer> {
            let none = [T::zeroed()];
            filled(context, what, bytemuck::cast_slice(if list.is_empty() { &none } else { list }))
        }
        Ok(Some(Self {
            rings: upload(context, "rings of ties", &found.rings)?,
            members: upload(context, "what ties hold together", &found.members)?,
            pins: upload(context, "what pins hold", &found.pins)?,
            report: found.report(),
        }))
    }

    /// Returns the number of rings and held vertices.
    pub fn report(&self) -> TieReport {
        self.report
    }

    pub fn bytes(&self) -> u64 {
        self.rings.size() + self.members.size() + self.pins.size()
    }
}

/// The ties of one head on the GPU.
#[derive(Debug)]
pub(crate) struct Ties {
    pipelines: Arc<Pipelines>,
    pub(crate) asset: TieAsset,
    /// Rotation of each ring relative to the head, quaternions.
    rotations: wgpu::Buffer,
    together: wgpu::BindGroup,
    to_head: wgpu::BindGroup,
}

impl Ties {
    /// Binds the ties to the guides of one head. `u` are the uniforms of a step of their simulation.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn new(
        context: &Context,
        u: BufferBinding<'_, Opaque>,
        guides: &GuideBuffers,
        asset: &TieAsset,
    ) -> Result<Self> {
        let pipelines: Arc<Pipelines> = context.pipelines();
        let TieAsset { rings, members, pins, report } = asset;
        let still = vec![[0f32, 0.0, 0.0, 1.0]; report.rings.max(1)];
        let turns = filled(context, "turns of ties", bytemuck::cast_slice(&still))?;
        let (current, velocity) = (guides.current.entire(), guides.velocity.entire());
        let forces = guides.forces.entire();
        let together = pipelines.ties.bind(&kernels::Ties {
            u,
            rings: rings.entire(),
            members: members.entire(),
            current,
            velocity,
            forces,
            rotations: turns.entire(),
        });
        let to_head = pipelines.pins.bind(&kernels::Pins { u, pinned: pins.entire(), current, forces });
        Ok(Self { pipelines, asset: asset.clone(), rotations: turns, together, to_head })
    }

    /// Returns the number of rings and held vertices.
    #[cfg(test)]
    pub fn report(&self) -> TieReport {
        self.asset.report
    }

    /// Records the forces for the step whose uniforms are at `offset`, after all other forces.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, offset: u32) {
        let TieReport { rings, to_head, .. } = self.asset.report;
        if rings > 0 {
            self.pipelines.ties.record(pass, &self.together, &[offset], rings as u32);
        }
        if to_head > 0 {
            self.pipelines.pins.record(
                pass,
                &self.to_head,
                &[offset],
                (to_head as u32).div_ceil(VOLUME_WORKGROUP),
            );
        }
    }

    /// Bytes of GPU memory of this head alone.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.rotations.size()
    }
}

// The kernel halves its range of partial sums.
const _: () = assert!(TIE_WORKGROUP.is_power_of_two());

#[cfg(test)]
#[path = "ties_tests.rs"]
mod tests;
