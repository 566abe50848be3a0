//! Curls, clumps, stray hairs and widths for existing grooms: imported ones ([`Restyle`]) and edited ones, where a
//! brush paints how much of each a strand has.
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

#[cfg(feature = "edit")]
pub(crate) mod painted;
#[cfg(test)]
mod tests;

use super::{
    Groom,
    bound::BoundStrands,
    curve,
    grow::{Clumps, CurlStrand, Curls, Growth, StrandVariation, Twist, add_variation, frames_from},
    random::{Rng, smoothstep},
    scalp::ScalpMap,
    skin::MapProjection,
};
use crate::{
    Result,
    bound::{PackedRest, StrandBinding},
    hash::pcg,
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
    pub variation: Option<StrandVariation>,
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
    fn variation(&self) -> StrandVariation {
        let still = StrandVariation {
            frizz: 0.0,
            strays: 0.0,
            stray: 0.0,
            flyaways: 0.0,
            flyaway: 0.0,
            shorter: 0.0,
        };
        self.variation.unwrap_or(still)
    }

    /// Checks that every value is in the range of the growth parameter.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a value out of range.
    pub fn check(&self) -> Result<()> {
        Growth {
            curls: self.curls.clone(),
            clumps: self.clumps(),
            variation: self.variation(),
            diameter: self.diameter,
            width_variation: self.width_variation,
            tip_width: self.tip_width.unwrap_or(1.0),
            ..Growth::default()
        }
        .check()
    }

    /// Changes the strands of `groom` (meters, groom space); `skull` is the center of the braincase, and the map of
    /// curls lies `on` the hair. Strands on guides with pinned tips keep their shape.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for values out of range.
    /// [`Error::Unusable`](crate::Error::Unusable) if the strands have too few vertices for the curls: bind with
    /// [`BindOptions::strand_vertices`](super::BindOptions) of 64.
    pub fn apply<'a>(&self, groom: &mut Groom, skull: Vec3, on: impl Into<MapProjection<'a>>) -> Result<()> {
        self.check()?;
        let on = on.into();
        let (clumps, variation) = (self.clumps(), self.variation());
        let n = groom.strands.vertex_count as usize;
        let lines: Vec<Vec<Vec3>> =
            (0..groom.strands.len()).map(|i| groom.strands.rest_positions(i).collect()).collect();
        let lengths: Vec<f32> = lines.iter().map(|line| curve::length(line)).collect();
        self.curls.fits(median(&lengths), groom.strands.vertex_count)?;
        let median_radius =
            median(&groom.strands.strands.iter().map(|s| s.radius).collect::<Vec<_>>()).max(1e-9);
        let shaped = self.curls.any() || self.clumps.is_some() || self.variation.is_some();
        let ids: Vec<u32> = (0..lines.len() as u32).collect();
        let locks = if shaped { Locks::new(&lines, clumps.spacing, &ids) } else { Locks::default() };
        let shaper = Shaper {
            curls: &self.curls,
            clumps,
            variation,
            locks: &locks,
            lines: &lines,
            skull,
            seed: self.seed,
            clumping: 1.0,
            max_displacement: f32::MAX,
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
            let flyaway = stray < variation.flyaways;
            let mut line = line.clone();
            let held = groom.guides.tip_pinned.get(binding.guides[0] as usize) == Some(&true);
            if shaped && !held && lengths[i] > 0.0 {
                let painted = |map: &ScalpMap| map.sample(on.at(line[0]));
                let curl = self.curl_map.as_ref().map_or(1.0, painted);
                let lock = locks.of[i];
                let f = shaper.shape(&mut line, lock, lock, curl, stray, &mut rng);
                binding.scale = binding.scale.map(|scale| scale * f);
            }
            if let Some(diameter) = self.diameter {
                strand.radius *= 0.5 * diameter / median_radius;
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
    variation: StrandVariation,
    locks: &'a Locks,
    lines: &'a [Vec<Vec3>],
    skull: Vec3,
    seed: u32,
    /// Factor on the strength of clumps.
    clumping: f32,
    /// Largest way to the middle of a lock, meters.
    max_displacement: f32,
}

impl Shaper<'_> {
    /// Changes the shape of `line`, of a strand in `lock`, whose random numbers come from `name`. `curl` is a factor on
    /// the radius of curls. Returns the fraction of its path that the strand covers.
    fn shape(&self, line: &mut [Vec3], lock: u32, name: u32, curl: f32, stray: f32, rng: &mut Rng) -> f32 {
        let center = &self.lines[self.locks.centers[lock as usize] as usize];
        let flyaway = stray < self.variation.flyaways;
        let weight = if flyaway { 0.3 } else { 1.0 };
        self.gather(line, center, weight * self.clumping, name, rng);
        let mut fraction = 1.0;
        if self.curls.any() {
            let twist = Twist::new(self.curls, self.seed, name, center[0]);
            let own = CurlStrand::new(self.curls, flyaway, rng);
            fraction = wind(line, self.curls, &twist, &own, curl, center[0] - self.skull);
        }
        add_variation(&self.variation, stray, rng, line);
        fraction
    }

    /// Pulls the strand toward the center of its lock: each vertex toward the center's point at the same distance from
    /// the root.
    fn gather(&self, line: &mut [Vec3], center: &[Vec3], weight: f32, name: u32, rng: &mut Rng) {
        let mut shared = Rng::new(self.seed ^ 0xbeef, name);
        let strength = self.clumps.strength * shared.range(0.45, 1.0).sqrt() * rng.range(0.75, 1.0) * weight;
        let strength = strength.min(1.0);
        if strength <= 0.0 {
            return;
        }
        let (own, center_length) = (curve::length(line), curve::length(center).max(1e-6));
        let last = (line.len() - 1) as f32;
        let mut walk = Walk::new(center);
        for (k, p) in line.iter_mut().enumerate().skip(1) {
            let t = k as f32 / last;
            let along = own * t;
            // A strand longer than the center continues beside its end.
            let end_fade = 1.0 - smoothstep(0.85 * center_length, 1.05 * center_length, along);
            let center_point = walk.at(along.min(center_length));
            let blend = strength * smoothstep(self.clumps.start, 0.85, t) * end_fade;
            *p = p.lerp(center_point, blend.min(self.max_displacement / p.distance(center_point).max(1e-9)));
        }
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
            let center_cell = cell(p);
            (0..27)
                .filter_map(|k| cells.get(&(center_cell + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1))))
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
