//! Curls, clumps, stray hairs and widths for existing grooms: imported ones ([`Restyle`]) and edited ones, where a brush
//! paints how much of each a strand has.
//!
//! Guides do not change. They are chosen and bound in the original hair, and then the rest curves of the render strands
//! change. A curled guide would be simulated as a spring, and the strands of three such guides would be their mean,
//! which is not a curl.
//!
//! ```text
//! bound strands ─► locks ─► gather ─► curl ─► unrest ─► widths ─► bound strands
//! ```
//!
//! *Locks* are strands whose roots lie within the clumps' spacing of a center. Among those centers, each strand takes
//! the one with the most similar direction, so that no lock has hair from both sides of a parting.

use super::{
    Groom,
    bound::BoundStrands,
    curve,
    grow::{Clumps, CurlStrand, Curls, Growth, Twist, Unrest, frames_from, unrest},
    random::{Rng, lerp, smoothstep},
    scalp::ScalpMap,
    skin::MapProjection,
};
use crate::{
    Result,
    bound::{PackedRest, StrandBinding},
    hash::pcg,
    progress::in_parallel,
};
use glam::{IVec3, Vec3};
use std::collections::HashMap;

/// Changes to strands that are bound to guides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restyle {
    /// Curls; each clump is a lock.
    pub curls: Curls,
    /// Factor on the radius of curls, over the scalp.
    pub curl_map: Option<ScalpMap>,
    /// Clumps. `None` keeps the clumps of the file, or sets clumps that suit the curls. `lock` and `tip_spread` have no
    /// effect.
    pub clumps: Option<Clumps>,
    /// Frizz, strays and flyaways; `None` for none. `shorter` has no effect.
    pub unrest: Option<Unrest>,
    /// Median diameter, meters; `None` keeps the diameters.
    pub diameter: Option<f32>,
    /// Standard deviation of the width over the strands, as a fraction.
    pub width_variation: f32,
    /// Width at the tip as a fraction, with a linear taper along the strand; `None` keeps the widths.
    pub tip_width: Option<f32>,
    /// Seed of every random choice.
    pub seed: u32,
}

/// Clumps for options that set none.
const NO_CLUMPS: Clumps = Clumps { spacing: 0.006, strength: 0.0, start: 0.05, lock: 0.0, tip_spread: 1.0 };

impl Restyle {
    /// Returns whether the options change anything.
    pub fn any(&self) -> bool {
        self.curls.any() || *self != Self { curls: self.curls.clone(), seed: self.seed, ..Self::default() }
    }

    /// Returns the clumps to apply.
    fn clumps(&self) -> Clumps {
        match self.clumps {
            Some(clumps) => clumps,
            None if self.curls.any() => NO_CLUMPS.curled(&self.curls),
            None => NO_CLUMPS,
        }
    }

    /// Returns the frizz, strays and flyaways to apply.
    fn unruly(&self) -> Unrest {
        let still = Unrest { frizz: 0.0, strays: 0.0, stray: 0.0, flyaways: 0.0, flyaway: 0.0, shorter: 0.0 };
        self.unrest.unwrap_or(still)
    }

    /// Checks that every value is in the range of the growth parameter.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a value out of range.
    pub fn check(&self) -> Result<()> {
        Growth {
            curls: self.curls.clone(),
            clumps: self.clumps(),
            unrest: self.unruly(),
            diameter: self.diameter,
            width_variation: self.width_variation,
            tip_width: self.tip_width.unwrap_or(1.0),
            ..Growth::default()
        }
        .check()
    }

    /// Changes the strands of `groom` (meters, groom space); `skull` is the center of the braincase, and the map of curls
    /// lies `on` the hair. Strands on guides with pinned tips keep their shape.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for values out of range.
    /// [`Error::Unusable`](crate::Error::Unusable) if the strands have too few vertices for the curls: bind with
    /// [`BindOptions::strand_vertices`](super::BindOptions) of 64.
    pub fn apply<'a>(&self, groom: &mut Groom, skull: Vec3, on: impl Into<MapProjection<'a>>) -> Result<()> {
        self.check()?;
        let on = on.into();
        let (clumps, unruly) = (self.clumps(), self.unruly());
        let n = groom.strands.vertex_count as usize;
        let lines: Vec<Vec<Vec3>> =
            (0..groom.strands.len()).map(|i| groom.strands.rest_positions(i).collect()).collect();
        let lengths: Vec<f32> = lines.iter().map(|line| curve::length(line)).collect();
        self.curls.fits(median(&lengths), groom.strands.vertex_count)?;
        let usual = median(&groom.strands.strands.iter().map(|s| s.radius).collect::<Vec<_>>()).max(1e-9);
        let shaped = self.curls.any() || self.clumps.is_some() || self.unrest.is_some();
        let ids: Vec<u32> = (0..lines.len() as u32).collect();
        let locks = if shaped { Locks::new(&lines, clumps.spacing, &ids) } else { Locks::default() };
        let shaper = Shaper {
            curls: &self.curls,
            clumps,
            unruly,
            locks: &locks,
            lines: &lines,
            skull,
            seed: self.seed,
            farthest: f32::MAX,
        };
        let old = std::mem::take(&mut groom.strands);
        groom.strands = BoundStrands::new(old.vertex_count);
        for (i, line) in lines.iter().enumerate() {
            let id = pcg(self.seed ^ pcg(i as u32 ^ 0x5717e));
            let mut rng = Rng::new(id, 1);
            let mut strand = old.strands[i];
            let mut binding = old.bindings[i];
            let mut radii = old.vertices(i).1;
            let stray = rng.unit();
            let flyaway = stray < unruly.flyaways;
            let mut line = line.clone();
            let held = groom.guides.tip_pinned.get(binding.guides[0] as usize) == Some(&true);
            if shaped && !held && lengths[i] > 0.0 {
                let painted = |map: &ScalpMap| map.sample(on.at(line[0]));
                let curl = self.curl_map.as_ref().map_or(1.0, painted);
                let lock = locks.of[i];
                let f = shaper.shape((&mut line, lock, lock), (1.0, curl), stray, &mut rng);
                binding.scale = binding.scale.map(|scale| scale * f);
            }
            if let Some(diameter) = self.diameter {
                strand.radius *= 0.5 * diameter / usual;
            }
            let width = 1.0 + self.width_variation * rng.bell().clamp(-2.0, 2.0);
            strand.radius *= width.max(0.2) * if flyaway { 0.65 } else { 1.0 };
            if let Some(tip) = self.tip_width {
                for (k, radius) in radii.iter_mut().enumerate() {
                    *radius = 1.0 + (tip - 1.0) * k as f32 / (n - 1) as f32;
                }
            }
            push(&mut groom.strands, strand, binding, &line, &radii);
        }
        Ok(())
    }
}

/// Shapes the strands of a groom, each by its lock.
struct Shaper<'a> {
    curls: &'a Curls,
    clumps: Clumps,
    unruly: Unrest,
    locks: &'a Locks,
    lines: &'a [Vec<Vec3>],
    skull: Vec3,
    seed: u32,
    /// Largest way to the middle of a lock, meters.
    farthest: f32,
}

impl Shaper<'_> {
    /// Changes the shape of `line`, of a strand in `lock`, whose random numbers come from `name`. The factors are on the
    /// strength of clumps and on the radius of curls. Returns the fraction of its path that the strand covers.
    fn shape(
        &self,
        (line, lock, name): (&mut [Vec3], u32, u32),
        (gathers, curl): (f32, f32),
        stray: f32,
        rng: &mut Rng,
    ) -> f32 {
        let center = &self.lines[self.locks.centers[lock as usize] as usize];
        let flyaway = stray < self.unruly.flyaways;
        let share = if flyaway { 0.3 } else { 1.0 };
        gather(line, center, &self.clumps, (share * gathers, self.farthest), (self.seed, name), rng);
        let mut fraction = 1.0;
        if self.curls.any() {
            let twist = Twist::new(self.curls, self.seed, name, center[0]);
            let own = CurlStrand::new(self.curls, flyaway, rng);
            fraction = wind(line, self.curls, &twist, &own, curl, center[0] - self.skull);
        }
        unrest(&self.unruly, stray, rng, line);
        fraction
    }
}

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
const FARTHEST: f32 = 0.02;
/// Painted frizz.
const FRIZZ: Unrest =
    Unrest { frizz: 0.0018, strays: 0.3, stray: 0.006, flyaways: 0.06, flyaway: 0.015, shorter: 0.0 };
/// Strength of the clumps of painted curls: nearly all strands of a lock lie in its middle.
const TIGHT: f32 = 1.4;
/// Vertices of strands with painted curls.
const CURLED: u32 = crate::MAX_STRAND_VERTICES;
/// Seed of painted shapes.
const SEED: u32 = 0x9a17;

/// Returns `groom` with the painted `shapes` of its strands. Random numbers come from the seeds of strands, so hair that
/// is planted or removed elsewhere changes none. Curls too small for the vertices of a lock are wider and longer.
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
                true => curls.wide_enough(curve::length(&lines[center]), n as u32),
                false => Curls::default(),
            };
            // A curl needs its lock; hair that is only clumped stays free at the root.
            let clumps = if curl > clump { Clumps { spacing, strength: TIGHT, ..curled } } else { CLUMPS };
            let unruly = Unrest {
                frizz: FRIZZ.frizz * frizz,
                stray: FRIZZ.stray * frizz,
                flyaway: FRIZZ.flyaway * frizz,
                ..FRIZZ
            };
            let shaper = Shaper {
                curls: &own,
                clumps,
                unruly,
                locks: &locks,
                lines: &lines,
                skull: Vec3::ZERO,
                seed: SEED,
                farthest: FARTHEST,
            };
            let mut rng = Rng::new(pcg(SEED ^ pcg(ids[*i])), 1);
            let stray = if frizz > 0.0 { rng.unit() } else { 1.0 };
            let f = shaper.shape((&mut line, lock, ids[center]), (clump.max(curl), curl), stray, &mut rng);
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

fn median(values: &[f32]) -> f32 {
    let mut values = values.to_vec();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Adds a strand with the guides of `binding` and another shape.
fn push(
    out: &mut BoundStrands,
    strand: crate::bound::Strand,
    binding: StrandBinding,
    line: &[Vec3],
    radii: &[f32],
) {
    let mut binding = binding;
    binding.cover(line);
    out.rest.extend(line.iter().zip(radii).map(|(p, radius)| PackedRest::pack(*p, *radius, &binding)));
    out.strands.push(strand);
    out.bindings.push(binding);
}

/// Pulls the strand toward the center of its lock: each vertex toward the center's point at the same distance from the
/// root.
fn gather(
    line: &mut [Vec3],
    center: &[Vec3],
    clumps: &Clumps,
    (share, farthest): (f32, f32),
    (seed, lock): (u32, u32),
    rng: &mut Rng,
) {
    let mut shared = Rng::new(seed ^ 0xbeef, lock);
    let strength = clumps.strength * shared.range(0.45, 1.0).sqrt() * rng.range(0.75, 1.0) * share;
    let strength = strength.min(1.0);
    if strength <= 0.0 {
        return;
    }
    let (own, reach) = (curve::length(line), curve::length(center).max(1e-6));
    let last = (line.len() - 1) as f32;
    let mut walk = Walk::new(center);
    for (k, p) in line.iter_mut().enumerate().skip(1) {
        let t = k as f32 / last;
        let along = own * t;
        // A strand longer than the center continues beside its end.
        let there = 1.0 - smoothstep(0.85 * reach, 1.05 * reach, along);
        let middle = walk.at(along.min(reach));
        let share = strength * smoothstep(clumps.start, 0.85, t) * there;
        *p = p.lerp(middle, share.min(farthest / p.distance(middle).max(1e-9)));
    }
}

/// Winds the strand around its path and returns the fraction of the path that it covers.
fn wind(
    line: &mut [Vec3],
    curls: &Curls,
    twist: &Twist,
    own: &CurlStrand,
    strength: f32,
    outward: Vec3,
) -> f32 {
    let length = curve::length(line);
    let fraction = twist.fraction(curls, strength, length);
    let last = (line.len() - 1) as f32;
    let path: Vec<Vec3> = {
        let mut walk = Walk::new(line);
        (0..line.len()).map(|k| walk.at(k as f32 / last * fraction * length)).collect()
    };
    for (k, (p, [u, v])) in line.iter_mut().zip(frames_from(&path, outward)).enumerate() {
        let arc = k as f32 / last * fraction * length;
        let o = twist.offset(curls, own, arc, length) * strength;
        *p = path[k] + u * o.x + v * o.y + u.cross(v) * o.z;
    }
    fraction
}

/// Cursor for points along a polyline at ascending distances.
struct Walk<'a> {
    line: &'a [Vec3],
    segment: usize,
    passed: f32,
}

impl<'a> Walk<'a> {
    fn new(line: &'a [Vec3]) -> Self {
        Self { line, segment: 0, passed: 0.0 }
    }

    fn at(&mut self, along: f32) -> Vec3 {
        loop {
            let (a, b) = (self.line[self.segment], self.line[(self.segment + 1).min(self.line.len() - 1)]);
            let step = a.distance(b);
            if along <= self.passed + step || self.segment + 2 >= self.line.len() {
                return a.lerp(b, ((along - self.passed) / step.max(1e-12)).clamp(0.0, 1.0));
            }
            self.passed += step;
            self.segment += 1;
        }
    }
}

/// Assignment of strands to locks.
#[derive(Default)]
struct Locks {
    /// Center strand of each lock.
    centers: Vec<u32>,
    /// Lock of each strand.
    of: Vec<u32>,
}

impl Locks {
    /// Assigns strands to locks. `ids` give the order in which strands become centers.
    fn new(lines: &[Vec<Vec3>], spacing: f32, ids: &[u32]) -> Self {
        let spacing = spacing.max(5e-4);
        let cell = |p: Vec3| (p / spacing).floor().as_ivec3();
        let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
        let mut centers: Vec<u32> = Vec::new();
        let around = |cells: &HashMap<IVec3, Vec<u32>>, p: Vec3| -> Vec<u32> {
            let middle = cell(p);
            (0..27)
                .filter_map(|k| cells.get(&(middle + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1))))
                .flatten()
                .copied()
                .collect()
        };
        // In random order, every strand that is far enough from all centers becomes one. Centers are thus spread
        // evenly, and every strand has one within the spacing.
        let mut order: Vec<u32> = (0..lines.len() as u32).collect();
        order.sort_by_key(|&i| (pcg(ids[i as usize] ^ 0x10c5), i));
        for i in order {
            let root = lines[i as usize][0];
            let near = |k: &u32| lines[centers[*k as usize] as usize][0].distance(root) < spacing;
            if !around(&cells, root).iter().any(near) {
                cells.entry(cell(root)).or_default().push(centers.len() as u32);
                centers.push(i);
            }
        }
        let shape = |i: usize| {
            let line = &lines[i];
            [line[0], line[line.len() / 2], line[line.len() - 1]]
        };
        let of = (0..lines.len())
            .map(|i| {
                let own = shape(i);
                let cost = |k: u32| {
                    let it = shape(centers[k as usize] as usize);
                    own[0].distance_squared(it[0])
                        + 0.5 * own[1].distance_squared(it[1])
                        + 0.25 * own[2].distance_squared(it[2])
                };
                let nearby = around(&cells, own[0]);
                nearby.into_iter().min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0)
            })
            .collect();
        Self { centers, of }
    }
}

#[cfg(test)]
#[path = "restyle_tests.rs"]
mod tests;
