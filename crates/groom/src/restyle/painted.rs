//! Clumps, curls and frizz that a brush paints on strands.

use super::{Locks, Shaper, push};
use crate::{
    Groom,
    bound::BoundStrands,
    curve,
    grow::{Clumps, Curls, StrandVariation},
    hash::pcg,
    progress::in_parallel,
    random::{Rng, lerp},
};
use glam::Vec3;

/// How much of clumps, curls and frizz a brush has painted on a strand: 0 for none, 255 for all.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct StrandShape {
    pub clump: u8,
    pub curl: u8,
    pub frizz: u8,
    /// Index into [`Curls::NAMES`].
    pub curls: u8,
}

impl StrandShape {
    /// Whether the strand has its own shape.
    pub fn any(self) -> bool {
        self.clump > 0 || self.curl > 0 || self.frizz > 0
    }
}

/// Painted clumps.
const CLUMPS: Clumps = Clumps { spacing: 0.008, strength: 0.95, start: 0.0, lock: 0.0, tip_spread: 1.0 };
/// Largest way to the middle of a painted clump, meters.
const MAX_DISPLACEMENT: f32 = 0.02;
/// Painted frizz.
const FRIZZ: StrandVariation = StrandVariation {
    frizz: 0.0018,
    strays: 0.3,
    stray: 0.006,
    flyaways: 0.06,
    flyaway: 0.015,
    shorter: 0.0,
};
/// Strength of the clumps of painted curls: nearly all strands of a lock lie in its middle.
const TIGHT: f32 = 1.4;
/// Vertices of strands with painted curls.
const CURLED: u32 = crate::MAX_STRAND_VERTICES;
/// Number of vertices per turn from which curls look round.
const ROUND: f32 = 5.0;
/// Seed of painted shapes.
const SEED: u32 = 0x9a17;

/// Returns `groom` with the painted `shapes` of its strands. Random numbers come from the seeds of strands, so hair
/// that is planted or removed elsewhere changes none. Curls too small for the vertices of a lock are wider and longer.
pub(crate) fn shaped(groom: &Groom, shapes: &[StrandShape]) -> Groom {
    let mut groom = groom.clone();
    let is_curled = |strand: &StrandShape| strand.curl > 0;
    if shapes.iter().any(is_curled) {
        refine(&mut groom);
    }
    let ids: Vec<u32> = groom.strands.strands.iter().map(|strand| strand.seed).collect();
    let n = groom.strands.vertex_count as usize;
    let all: Vec<usize> = (0..groom.strands.len()).collect();
    let lines = in_parallel(&all, |i| groom.strands.rest_positions(*i).collect::<Vec<_>>());
    for (kind, name) in (0u8..).zip(Curls::NAMES) {
        let curls = Curls::named(name).unwrap_or_default();
        // Strands without curls are shaped with the first kind.
        let is_of = |shape: &StrandShape| match shape.curl {
            0 => kind == 0,
            _ => shape.curls == kind,
        };
        let of: Vec<usize> = (0..shapes.len()).filter(|i| shapes[*i].any() && is_of(&shapes[*i])).collect();
        if of.is_empty() {
            continue;
        }
        let has_curls = of.iter().any(|i| is_curled(&shapes[*i]));
        let curled = CLUMPS.curled(&curls);
        let spacing = if has_curls { curled.spacing } else { CLUMPS.spacing };
        let locks = Locks::new(&lines, spacing, &ids);
        // A lock curls as one.
        let mut sums = vec![(0.0, 0.0f32); locks.centers.len()];
        for i in &of {
            let sum = &mut sums[locks.of[*i] as usize];
            *sum = (sum.0 + f32::from(shapes[*i].curl), sum.1 + 255.0);
        }
        let pinned = |i: usize| groom.guides.tip_pinned[groom.strands.bindings[i].guides[0] as usize];
        let changed = in_parallel(&of, |i| {
            let (shape, mut line) = (shapes[*i], lines[*i].clone());
            if pinned(*i) || curve::length(&line) <= 0.0 {
                return (line, 1.0);
            }
            let [clump, curl, frizz] = [shape.clump, shape.curl, shape.frizz].map(|x| f32::from(x) / 255.0);
            let lock = locks.of[*i];
            let curl = if curl > 0.0 { sums[lock as usize].0 / sums[lock as usize].1 } else { 0.0 };
            let center = locks.centers[lock as usize] as usize;
            let own = match curl > 0.0 {
                true => wide_enough(&curls, curve::length(&lines[center]), n as u32),
                false => Curls::default(),
            };
            // A curl needs its lock; hair that is only clumped stays free at the root.
            let clumps = if curl > clump { Clumps { spacing, strength: TIGHT, ..curled } } else { CLUMPS };
            let variation = StrandVariation {
                frizz: FRIZZ.frizz * frizz,
                stray: FRIZZ.stray * frizz,
                flyaway: FRIZZ.flyaway * frizz,
                ..FRIZZ
            };
            let shaper = Shaper {
                curls: &own,
                clumps,
                variation,
                locks: &locks,
                lines: &lines,
                skull: Vec3::ZERO,
                seed: SEED,
                clumping: clump.max(curl),
                max_displacement: MAX_DISPLACEMENT,
            };
            let mut rng = Rng::new(pcg(SEED ^ pcg(ids[*i])), 1);
            let stray = if frizz > 0.0 { rng.unit() } else { 1.0 };
            let f = shaper.shape(&mut line, lock, ids[center], curl, stray, &mut rng);
            (line, f)
        });
        for (i, (line, f)) in of.into_iter().zip(changed) {
            let radii = groom.strands.vertices(i).1;
            let binding = &mut groom.strands.bindings[i];
            binding.scale = binding.scale.map(|scale| scale * f);
            groom.strands.reshape(i, &line, &radii);
        }
    }
    groom
}

/// Returns `curls`, wide and long enough that `vertices` vertices over `length` meters represent them.
fn wide_enough(curls: &Curls, length: f32, vertices: u32) -> Curls {
    let factor = (ROUND / curls.vertices_per_turn(length, vertices).max(1e-6)).max(1.0);
    Curls { radius: curls.radius * factor, wavelength: curls.wavelength * factor, ..curls.clone() }
}

/// Gives all strands [`CURLED`] vertices.
fn refine(groom: &mut Groom) {
    let old = std::mem::replace(&mut groom.strands, BoundStrands::new(CURLED));
    let n = old.vertex_count as usize;
    let all: Vec<usize> = (0..old.len()).collect();
    let fine = in_parallel(&all, |i| {
        let (line, radii) = old.vertices(*i);
        let at = |k: u32| k as f32 / (CURLED - 1) as f32 * (n - 1) as f32;
        let radius = |x: f32| {
            let k = (x as usize).min(n - 2);
            lerp(radii[k], radii[k + 1], x - k as f32)
        };
        (curve::subdivide(&line, CURLED as usize), (0..CURLED).map(|k| radius(at(k))).collect::<Vec<f32>>())
    });
    for (i, (line, radii)) in fine.iter().enumerate() {
        push(&mut groom.strands, old.strands[i], old.bindings[i], line, radii);
    }
}
