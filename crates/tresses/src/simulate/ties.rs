//! Ties: bands, braids and pins.
//!
//! A [`Tie`] is a place in the groom at rest; the guides that pass through it are held there from then on, together or to
//! the head.
//!
//! **Together** (a band, a ring of a braid): what passes through stays as it lies there at rest, as one rigid piece that
//! goes wherever hair goes. Before each step the rigid motion is found that has the mass, momentum and angular momentum of
//! its vertices, in the pose that is nearest to theirs (shape matching: Müller et al. 2005, "Meshless deformations based
//! on shape matching", eq. 1 and 4; the rotation by Müller et al. 2016, "A robust method to extract the rotational part of
//! deformations", eq. 7, begun at that of the step before, so that a piece whose rotation about its own axis nothing
//! determines keeps it). Each vertex gets the acceleration that brings it into its place and to the piece's velocity within
//! the step, were it free. Nothing is pushed or turned as a whole, and a band adds no mass: hair between scalp and band
//! carries the tail. What hangs on strands gives way less than what is free, so that no step is too long.
//!
//! **To the head** (a pin, a clip, a hair slide): before each step what is held gets a force towards where it rests on the
//! head, linear in its velocity and so stiff that it is there at the step's end. The solve of the strand knows of it, so
//! that a pin carries whatever hangs on it.
//!
//! **Why not rigid to the bit?** Vertices that are replaced by the rigid motion after each step were tried: hairs that reach a
//! band from all sides cannot all keep their lengths while it goes where their mean goes, what restores the one undoes the
//! other, and a ponytail that is shaken bursts. A force with a rate that the solve knows, as a pin has, pulls towards a
//! velocity that must be given, that of the whole band; given from the step before it makes the band as heavy as it is
//! firm. The price is that a band gives way: by `s² a` where hairs in it are pulled apart with an acceleration `a`, 3 mm for
//! their own weight at a step of 1/60 s, a fifth of a millimetre at 1/240 s.
//!
//! **Gathered.** Where a tie draws hair together (`gather`) it is what it holds that rests nearer to its middle. It comes there
//! by half a metre per second, from where the groom has it: so loose hair is tied up.
//!
//! A long tie is divided into rings no longer than they are wide: between them hair bends.
//!
//! ```text
//! rings, members ─► ties (a workgroup per ring), pins ─► forces ─► step
//! current, velocity ─┘
//! ```
//!
//! **Known limits.** The skin under a pin may bend: it goes with the head alone. Guides that are not simulated at a level of
//! detail are not held: they go with those that lead them.

use super::Pipelines;
use crate::{
    Context, Error, Result,
    constants::{TIE_WORKGROUP, VOLUME_WORKGROUP},
    gpu::Binding,
    groom::{Guides, curve, range},
    range::Range,
    strands::{GuideBuffers, buffers::storage},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// Bindings of the kernel that holds hair together, in order.
pub(super) const BINDINGS: [Binding; 7] = [
    Binding::StorageDynamic,
    Binding::Storage,
    Binding::Storage,
    Binding::Storage,
    Binding::Storage,
    Binding::StorageMut,
    Binding::StorageMut,
];

/// Bindings of the kernel that holds hair to the head, in order.
pub(super) const PIN_BINDINGS: [Binding; 4] =
    [Binding::StorageDynamic, Binding::Storage, Binding::Storage, Binding::StorageMut];

/// The most rings of one head.
pub const MAX_RINGS: usize = 4096;

/// What a [`Tie`] holds hair to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Held {
    /// What passes through it is held together and goes where hair goes: a band, a braid.
    #[default]
    Together,
    /// What passes through it is held where it rests on the head: a pin, a clip.
    ToHead,
}

/// A place at which hair is held: all guides that pass within `radius` of the line between two points, groom space at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tie {
    /// An end of the line, metres.
    pub from: Vec3,
    /// The other end; the same for a ball.
    pub to: Vec3,
    /// Metres.
    pub radius: f32,
    /// To what.
    pub held: Held,
    /// How far what is held is drawn together, as a fraction of how far it lies from its middle at rest: 1 leaves it.
    pub gather: f32,
    /// The group of the file that it holds alone ([`Guides::groups`]); all hair where there is none.
    pub group: Option<i32>,
}

impl Tie {
    /// The range of [`gather`](Self::gather).
    pub const GATHER: Range = range!("gather of a tie", 0.02 to 1.0);
    /// The range of [`radius`](Self::radius).
    pub const RADIUS: Range = range!("radius of a tie", 0.0005 to 1.0, "m"; usually 0.002 to 0.05);

    /// Checks that it is finite and of a size that makes sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<()> {
        let far = self.from.abs().max(self.to.abs()).max_element() + (self.from + self.to).length();
        Error::unless_within("the place of a tie", far, 0.0, 1e3, "finite and within 1 km")?;
        Self::RADIUS.check(self.radius)?;
        Ok(Self::GATHER.check(self.gather)?)
    }

    /// How far along the line, from 0 to 1, `x` is nearest, and how far from it.
    fn nearest(&self, x: Vec3) -> (f32, f32) {
        let line = self.to - self.from;
        let along = ((x - self.from).dot(line) / line.length_squared().max(1e-12)).clamp(0.0, 1.0);
        (along, x.distance(self.from + line * along))
    }

    /// Of a strand at rest, the vertices that it holds, with how far along the line they are. The two of the root go with
    /// the head anyway. Where a strand passes through between two vertices, the nearer one.
    fn holds(&self, strand: &[Vec3]) -> Vec<(usize, f32)> {
        let at = |i: usize| self.nearest(strand[i]);
        let inside = (2..strand.len()).filter(|&i| at(i).1 <= self.radius);
        let found: Vec<_> = inside.map(|i| (i, at(i).0)).collect();
        if !found.is_empty() {
            return found;
        }
        let passes = |i: usize| {
            let point = |k: i32| strand[i - 1].lerp(strand[i], k as f32 / 8.0);
            (1..8).any(|k| self.nearest(point(k)).1 <= self.radius)
        };
        let Some(i) = (2..strand.len()).find(|&i| passes(i)) else { return Vec::new() };
        let nearer = if i > 2 && at(i - 1).1 < at(i).1 { i - 1 } else { i };
        vec![(nearer, at(nearer).0)]
    }

    /// In how many rings it is divided.
    fn rings(&self) -> usize {
        match self.held {
            Held::Together => ((self.from.distance(self.to) / (2.0 * self.radius)).round() as usize).max(1),
            Held::ToHead => 1,
        }
    }
}

/// What ties hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TieReport {
    /// Rigid pieces, of all ties that hold together.
    pub rings: usize,
    /// Guide vertices that these hold.
    pub together: usize,
    /// Guide vertices that are held to the head.
    pub to_head: usize,
}

/// A ring as the kernel reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Ring {
    /// Its first member.
    pub first: u32,
    /// How many members it has.
    pub count: u32,
}

/// A guide vertex that is held.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Member {
    /// Where it rests: from the ring's centre of mass where it is held together, groom space where to the head, metres.
    pub rests: Vec3,
    /// Its share of the ring's mass.
    pub mass: f32,
    /// Its place in the buffers of guides.
    pub vertex: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// What ties hold of a groom, before the GPU.
#[derive(Clone, Debug, Default)]
struct Found {
    rings: Vec<Ring>,
    members: Vec<Member>,
    pins: Vec<Member>,
}

impl Found {
    /// A vertex that several ties would hold is held by the first.
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
            let alone = tie.held == Held::ToHead;
            let several = |members: &Vec<Member>| {
                members.iter().any(|m| m.vertex as usize % count != members[0].vertex as usize % count)
            };
            rings.retain(|members| !members.is_empty() && (alone || several(members)));
            if rings.is_empty() {
                let what = if alone { "no guide passes" } else { "fewer than two guides pass" };
                let of = tie.group.map_or(String::new(), |group| format!(" of group {group}"));
                let sentence = format!(
                    "tie {} holds nothing: {what}{of} within {} mm of {} (groom space, metres)",
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
            let sentence = format!("{} rings of ties are more than {MAX_RINGS}", found.rings.len());
            return Err(Error::unusable(sentence));
        }
        Ok(found)
    }

    /// These members as a ring, or pinned.
    fn add(&mut self, mut members: Vec<Member>, tie: &Tie) {
        let whole: f32 = members.iter().map(|m| m.mass).sum();
        members.iter_mut().for_each(|m| m.mass /= whole);
        let center: Vec3 = members.iter().map(|m| m.rests * m.mass).sum();
        members.iter_mut().for_each(|m| m.rests = (m.rests - center) * tie.gather);
        if tie.held == Held::ToHead {
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

/// The ties of one head.
#[derive(Debug)]
pub struct Ties {
    pipelines: Arc<Pipelines>,
    /// [`Ring`] and [`Member`]: heads with the same groom share them.
    rings: wgpu::Buffer,
    members: wgpu::Buffer,
    pins: wgpu::Buffer,
    /// How each ring is turned relative to the head, quaternions.
    turns: wgpu::Buffer,
    together: wgpu::BindGroup,
    to_head: wgpu::BindGroup,
    report: TieReport,
}

impl Ties {
    /// Of guides that rest as `rest` says; `step` are the uniforms of a step of its simulation.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tie that makes no sense, [`crate::groom::Error::Unusable`] for one that holds nothing,
    /// and for more than [`MAX_RINGS`]; [`Error::Limit`].
    pub(crate) fn new(
        context: &Context,
        step: &wgpu::BindingResource<'_>,
        guides: &GuideBuffers,
        rest: &Guides,
        ties: &[Tie],
    ) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let found = Found::of(rest, ties)?;
        let rings = storage::<Ring>(device, "rings of ties", found.rings.len().max(1) as u64)?;
        let members =
            storage::<Member>(device, "what ties hold together", found.members.len().max(1) as u64)?;
        let pins = storage::<Member>(device, "what pins hold", found.pins.len().max(1) as u64)?;
        queue.write_buffer(&rings, 0, bytemuck::cast_slice(&found.rings));
        queue.write_buffer(&members, 0, bytemuck::cast_slice(&found.members));
        queue.write_buffer(&pins, 0, bytemuck::cast_slice(&found.pins));
        Self::of(context, step, guides, [rings, members, pins], found.report())
    }

    /// The same ties of another head with the same groom.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn another(
        &self,
        context: &Context,
        step: &wgpu::BindingResource<'_>,
        guides: &GuideBuffers,
    ) -> Result<Self> {
        let shared = [&self.rings, &self.members, &self.pins].map(Clone::clone);
        Self::of(context, step, guides, shared, self.report)
    }

    fn of(
        context: &Context,
        step: &wgpu::BindingResource<'_>,
        guides: &GuideBuffers,
        [rings, members, pins]: [wgpu::Buffer; 3],
        report: TieReport,
    ) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let turns = storage::<[f32; 4]>(device, "turns of ties", report.rings.max(1) as u64)?;
        queue.write_buffer(
            &turns,
            0,
            bytemuck::cast_slice(&vec![[0f32, 0.0, 0.0, 1.0]; report.rings.max(1)]),
        );
        let bind = |kernel: &crate::gpu::Kernel, buffers: &[&wgpu::Buffer]| {
            let mut all = vec![step.clone()];
            all.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            kernel.bind(&all)
        };
        let together = bind(
            &pipelines.ties,
            &[&rings, &members, &guides.current, &guides.velocity, &guides.forces, &turns],
        );
        let to_head = bind(&pipelines.pins, &[&pins, &guides.current, &guides.forces]);
        Ok(Self { pipelines, rings, members, pins, turns, together, to_head, report })
    }

    /// What they hold.
    pub fn report(&self) -> TieReport {
        self.report
    }

    /// Records what acts in the step whose uniforms are at `offset`, after all other forces.
    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, offset: u32) {
        let TieReport { rings, to_head, .. } = self.report;
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

    /// Bytes of GPU memory that heads share.
    pub(crate) fn shared_bytes(&self) -> u64 {
        self.rings.size() + self.members.size() + self.pins.size()
    }

    /// Bytes of GPU memory, shared ones included.
    pub fn bytes(&self) -> u64 {
        self.shared_bytes() + self.turns.size()
    }
}

// Sums are halved.
const _: () = assert!(TIE_WORKGROUP.is_power_of_two());

#[cfg(test)]
#[path = "ties_tests.rs"]
mod tests;
