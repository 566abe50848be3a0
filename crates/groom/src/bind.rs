//! Binding of imported strands: chooses guides among them and binds every strand to up to three guides.

#[cfg(feature = "edit")]
pub(crate) mod finder;
mod marked;
mod short;

use crate::{
    BoundStrands, Error, Groom, Guides, MAX_GUIDE_VERTICES, MAX_STRAND_VERTICES, Result, Strands,
    bound::{self, Influence, Strand, strand::pack_color},
    curve, hash,
    near::morton,
};
use glam::Vec3;
use marked::MarkedGuides;
use std::collections::HashMap;

/// Number of strands to simulate as guides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuideCount {
    /// One strand in this many.
    OneIn(u32),
    /// This many strands, or all if there are fewer.
    Count(u32),
    /// Every strand is its own guide.
    All,
}

/// Options for binding strands to guides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BindOptions {
    /// Number of guides.
    pub guides: GuideCount,
    /// Vertices per guide, 3 to 64. `None`: 32, 8 for short hair, or the median vertex count of the strands if all are
    /// guides.
    pub guide_vertex_count: Option<u32>,
    /// Vertices per render strand, 2 to 64. `None`: about 32, chosen so that the input vertices are among them. Short
    /// hair (to 8 input vertices and 5 cm) has 4 to 8, by the error of the curve.
    pub strand_vertex_count: Option<u32>,
    /// Radius at root and tip, meters. `None`: the radii in the file, or a radius that covers a head.
    pub radius: Option<(f32, f32)>,
}

impl GuideCount {
    /// Returns the number of guides among `strands` strands, unless the file marks its guides.
    pub fn among(self, strands: usize) -> usize {
        let count = match self {
            Self::All => strands,
            Self::Count(count) => count as usize,
            Self::OneIn(n) => strands.div_ceil(n.max(1) as usize),
        };
        count.min(strands)
    }
}

impl Default for BindOptions {
    fn default() -> Self {
        Self {
            guides: GuideCount::OneIn(16),
            guide_vertex_count: None,
            strand_vertex_count: None,
            radius: None,
        }
    }
}

/// Default tip radius as a fraction of the root radius.
const TAPER: f32 = 0.4;

/// Chooses guides among `strands` (meters, groom space) and binds all strands to them.
///
/// Guides are spread evenly: strands are sorted along a space-filling curve of their roots and cut into runs of equal
/// size. The strand nearest to the mean shape of each run becomes a guide. A strand is bound to the guides that are
/// nearest at root, middle and tip together, so hair on either side of a parting does not mix.
///
/// With [`GuideCount::OneIn`], guides marked in the file replace this choice, and the file's assignment of strands to
/// guides is kept. If the file also has other strands, its guides are not rendered.
///
/// # Errors
/// [`Error::Unusable`] without strands; [`Error::Parameter`] for counts out of range.
pub fn bind(strands: &Strands, options: &BindOptions) -> Result<Groom> {
    bind_any(strands, options, None)
}

/// The input strands that a new strand is interpolated from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parents {
    /// Indices of input strands. The first provides the curls, the number of vertices and the attributes.
    pub strands: [u32; 3],
    /// Weight of each strand in the path; the sum is 1. A strand of weight 0 is unused.
    pub weights: [f32; 3],
}

impl Parents {
    /// Returns a single parent.
    pub(crate) fn one(strand: u32) -> Self {
        Self { strands: [strand; 3], weights: [1.0, 0.0, 0.0] }
    }

    /// Iterates over the strands with a weight above 0 and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (u32, f32)> {
        self.strands.into_iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

/// Origins of strands that were interpolated between input strands.
pub(crate) struct Origins<'a> {
    /// Number of input strands; they come first.
    pub given: usize,
    /// For each input strand, its index before thinning. [`Parents::strands`] holds these indices.
    pub original: &'a [u32],
    /// Parents of each new strand.
    pub parents: &'a [Parents],
    /// Whether two input strands run together, so that a new strand may follow both.
    pub runs_with: &'a dyn Fn(u32, u32) -> bool,
}

/// [`bind`] for strands of which some were interpolated between the others.
pub(crate) fn bind_any(
    strands: &Strands,
    options: &BindOptions,
    origins: Option<&Origins<'_>>,
) -> Result<Groom> {
    if strands.is_empty() {
        return Err(Error::Unusable("the groom has no strands".into()));
    }
    if let Some(i) = (0..strands.len()).find(|i| strands.range(*i).len() < 2) {
        return Err(Error::Unusable(format!("strand {i} has fewer than two vertices")));
    }
    let given = origins.map_or(strands.len(), |origins| origins.given);
    let typical = typical_vertices(&strands.offsets[..=given]);
    let short = short::drawn_vertices(strands, given, typical);
    let guide_vertices = options.guide_vertex_count.unwrap_or(match (options.guides, short) {
        (GuideCount::All, _) => typical.clamp(8, MAX_GUIDE_VERTICES),
        (_, Some(_)) => short::GUIDE,
        _ => 32,
    });
    let strand_vertices = options.strand_vertex_count.or(short).unwrap_or_else(|| drawn_vertices(typical));
    in_range("guide_vertices", guide_vertices, 3, MAX_GUIDE_VERTICES, "3 to 64")?;
    in_range("strand_vertices", strand_vertices, 2, MAX_STRAND_VERTICES, "2 to 64")?;

    let shapes = Shapes::new(strands, given);
    match options.guides {
        GuideCount::All => {}
        GuideCount::Count(count) => in_range("guides", count, 1, u32::MAX, "at least 1")?,
        GuideCount::OneIn(n) => in_range("strands per guide", n, 1, u32::MAX, "at least 1")?,
    }
    let count = options.guides.among(strands.len());
    let marked = MarkedGuides::of(strands, given, options);
    let all =
        marked.is_none() && (options.guides == GuideCount::All || (origins.is_some() && count >= given));
    let guide_strands: Vec<u32> = match &marked {
        Some(marked) => marked.guides.clone(),
        None if all => (0..given as u32).collect(),
        None => shapes.select_guides(count),
    };
    let mut guides = Guides::new(guide_vertices);
    for &i in &guide_strands {
        guides.push(strands.strand(i as usize), 1.0, shapes.pinned[i as usize]);
    }
    if !strands.marks.is_empty() {
        guides.groups = guide_strands.iter().map(|i| strands.marks[*i as usize].group).collect();
    }
    let lengths: Vec<f32> = (0..guides.len()).map(|i| curve::length(guides.guide(i)).max(1e-9)).collect();

    let mut bound = BoundStrands::new(strand_vertices);
    let finder = Finder::new(&shapes, &guide_strands);
    let mut lineage = origins.map(|origins| Lineage::new(origins, &guide_strands));
    for i in 0..strands.len() {
        let influences = if all && i < given {
            vec![Influence { guide: i as u32, weight: 1.0, scale: 1.0 }]
        } else {
            let own = strands.length(i);
            let shape = |i: usize| Shapes::of(strands.strand(i));
            let mut found = match &lineage {
                Some(lineage) if i >= given => {
                    let pinned = strands.tip_pinned.get(i) == Some(&true);
                    lineage.follow(i, pinned, &finder, &shapes, shape)
                }
                _ if let Some(found) = marked.as_ref().and_then(|marked| marked.follow(strands, i)) => found,
                _ => finder.nearest(&shapes, &shapes.points[i], shapes.pinned[i], |_| true),
            };
            for influence in &mut found {
                influence.scale = own / lengths[influence.guide as usize];
            }
            found
        };
        if let Some(lineage) = lineage.as_mut().filter(|_| i < given) {
            lineage.follows.push(influences.clone());
        }
        // If the file has other strands, marked guides are not rendered.
        if marked.as_ref().is_some_and(|marked| marked.others && strands.marks[i].guide) {
            continue;
        }
        for influence in &influences {
            guides.strands[influence.guide as usize] += influence.weight;
        }
        let rest = curve::subdivide(strands.strand(i), strand_vertices as usize);
        let (strand, radii) = appearance(strands, i, strand_vertices, options);
        bound.push(strand, &rest, &radii, &influences);
    }
    for count in &mut guides.strands {
        // Each guide starts with a count of 1 for itself, which is removed here.
        *count = (*count - 1.0).max(1.0);
    }
    Ok(Groom { guides, strands: bound })
}

/// Assigns to new strands the guides of their parents.
struct Lineage<'a> {
    origins: &'a Origins<'a>,
    guide_strands: &'a [u32],
    /// Current index of each remaining input strand, by its index before thinning.
    now: HashMap<u32, u32>,
    /// Influences of each input strand.
    follows: Vec<Vec<Influence>>,
}

impl<'a> Lineage<'a> {
    fn new(origins: &'a Origins<'a>, guide_strands: &'a [u32]) -> Self {
        let now = (0u32..).zip(origins.original).map(|(i, was)| (*was, i)).collect();
        Self { origins, guide_strands, now, follows: Vec::with_capacity(origins.given) }
    }

    /// Returns the guides of new strand `i`, or the guides nearest in shape if its parents provide none.
    fn follow(
        &self,
        i: usize,
        pinned: bool,
        finder: &Finder,
        shapes: &Shapes,
        shape: impl Fn(usize) -> [Vec3; 3],
    ) -> Vec<Influence> {
        let parents = &self.origins.parents[i - self.origins.given];
        let lead = parents.strands[0];
        let together = |guide: u32| {
            let strand = self.origins.original[self.guide_strands[guide as usize] as usize];
            (self.origins.runs_with)(lead, strand)
        };
        let mut found: Vec<Influence> = Vec::new();
        for (parent, parent_weight) in parents.iter() {
            let Some(&now) = self.now.get(&parent) else { continue };
            for influence in &self.follows[now as usize] {
                let weight = parent_weight * influence.weight;
                match found.iter_mut().find(|f| f.guide == influence.guide) {
                    Some(known) => known.weight += weight,
                    None => found.push(Influence { weight, ..*influence }),
                }
            }
        }
        found.retain(|influence| together(influence.guide));
        if found.is_empty() {
            return finder.nearest(shapes, &shape(i), pinned, together);
        }
        found.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.guide.cmp(&b.guide)));
        found.truncate(3);
        let sum: f32 = found.iter().map(|f| f.weight).sum();
        found.iter_mut().for_each(|f| f.weight /= sum);
        found
    }
}

fn in_range(name: &'static str, value: u32, lo: u32, hi: u32, range: &'static str) -> Result<()> {
    if (lo..=hi).contains(&value) {
        Ok(())
    } else {
        Err(Error::Parameter { name, value: value.to_string(), range })
    }
}

/// Returns the median number of vertices per strand.
fn typical_vertices(offsets: &[u32]) -> u32 {
    let mut counts: Vec<_> = offsets.windows(2).map(|w| w[1] - w[0]).collect();
    let median = counts.len() / 2;
    *counts.select_nth_unstable(median).1
}

/// Returns a vertex count near 32 whose segments are a multiple of a typical strand's segments.
fn drawn_vertices(typical: u32) -> u32 {
    let segments = typical.max(2) - 1;
    let per_segment = (31.0 / segments as f32).round().max(1.0) as u32;
    (segments * per_segment + 1).min(MAX_STRAND_VERTICES)
}

/// Returns the radius and colors of strand `i`, and the radius fraction at each render vertex.
fn appearance(strands: &Strands, i: usize, vertices: u32, options: &BindOptions) -> (Strand, Vec<f32>) {
    let range = strands.range(i);
    let along = |j: u32| j as f32 / (vertices - 1) as f32;
    let (radius, fractions) = if let (None, Some(radii)) = (options.radius, strands.radii.get(range.clone()))
    {
        let largest = radii.iter().copied().fold(0.0, f32::max).max(1e-9);
        let at = |s: f32| {
            let x = s * (radii.len() - 1) as f32;
            let k = (x as usize).min(radii.len() - 2);
            let t = x - k as f32;
            (radii[k] * (1.0 - t) + radii[k + 1] * t) / largest
        };
        (largest, (0..vertices).map(|j| at(along(j))).collect())
    } else {
        let covering = bound::covering_radius(strands.len());
        let (root, tip) = options.radius.unwrap_or((covering, TAPER * covering));
        let largest = root.max(tip).max(1e-9);
        (largest, (0..vertices).map(|j| (root + (tip - root) * along(j)) / largest).collect())
    };
    let colors = strands.colors.get(range).filter(|colors| !colors.is_empty());
    let color = |pick: fn(&[Vec3]) -> Option<&Vec3>| colors.and_then(pick).map_or(0, |c| pack_color(*c));
    let strand = Strand {
        radius,
        seed: hash::pcg(i as u32),
        root_color: color(<[Vec3]>::first),
        tip_color: color(<[Vec3]>::last),
    };
    (strand, fractions)
}

/// Coarse shape of each strand: points at root, middle and tip.
struct Shapes {
    points: Vec<[Vec3; 3]>,
    pinned: Vec<bool>,
}

impl Shapes {
    /// Samples the first `count` strands.
    fn new(strands: &Strands, count: usize) -> Self {
        let points = strands.iter().take(count).map(Self::of).collect();
        let pinned = (0..count).map(|i| strands.tip_pinned.get(i).copied().unwrap_or(false)).collect();
        Self { points, pinned }
    }

    fn of(strand: &[Vec3]) -> [Vec3; 3] {
        let even = curve::resample(strand, 3);
        [even[0], even[1], even[2]]
    }

    /// Returns the squared distance of two shapes; roots count most.
    fn distance(a: &[Vec3; 3], b: &[Vec3; 3]) -> f32 {
        a[0].distance_squared(b[0]) + 0.5 * a[1].distance_squared(b[1]) + 0.25 * a[2].distance_squared(b[2])
    }

    /// Chooses `count` strands spread evenly over the roots. Strands with pinned tips get guides of their own.
    fn select_guides(&self, count: usize) -> Vec<u32> {
        let (lo, hi) = self
            .points
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p[0]), hi.max(p[0])));
        let scale = 1023.0 / (hi - lo).max_element().max(1e-9);
        let mut order: Vec<u32> = (0..self.points.len() as u32).collect();
        order.sort_by_cached_key(|&i| {
            let cell = ((self.points[i as usize][0] - lo) * scale).as_uvec3();
            (self.pinned[i as usize], morton(cell), i)
        });
        let count = count.clamp(1, order.len());
        let first_pinned = order.partition_point(|&i| !self.pinned[i as usize]);
        let pinned_fraction = (order.len() - first_pinned) as f32 / order.len() as f32;
        let mut pinned_runs = (count as f32 * pinned_fraction).round() as usize;
        if first_pinned < order.len() {
            pinned_runs = pinned_runs.max(1);
        }
        if first_pinned > 0 {
            pinned_runs = pinned_runs.min(count.saturating_sub(1));
        }
        let mut selected = Vec::with_capacity(count);
        for (part, runs) in
            [(&order[..first_pinned], count - pinned_runs), (&order[first_pinned..], pinned_runs)]
        {
            for run in 0..runs {
                let members = &part[run * part.len() / runs..(run + 1) * part.len() / runs];
                selected.extend(self.medoid(members));
            }
        }
        selected
    }

    /// Returns the strand nearest to the mean of `members`.
    fn medoid(&self, members: &[u32]) -> Option<u32> {
        let mut mean = [Vec3::ZERO; 3];
        for &i in members {
            for (sum, p) in mean.iter_mut().zip(&self.points[i as usize]) {
                *sum += *p / members.len() as f32;
            }
        }
        let key = |i: u32| Self::distance(&self.points[i as usize], &mean);
        members.iter().copied().min_by(|a, b| key(*a).total_cmp(&key(*b)))
    }
}

/// Hash grid over the roots of the guides.
struct Finder {
    cell: f32,
    cells: HashMap<glam::IVec3, Vec<u32>>,
    /// Strand index of each guide.
    guide_strands: Vec<u32>,
}

impl Finder {
    fn new(shapes: &Shapes, guide_strands: &[u32]) -> Self {
        let (lo, hi) = guide_strands.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &i| {
            let root = shapes.points[i as usize][0];
            (lo.min(root), hi.max(root))
        });
        // Roots lie on a surface: cells of this size hold about two each.
        let cell = ((hi - lo).length() / (guide_strands.len() as f32).sqrt()).max(1e-6);
        let mut cells: HashMap<_, Vec<u32>> = HashMap::new();
        for (guide, &i) in guide_strands.iter().enumerate() {
            let key = (shapes.points[i as usize][0] / cell).floor().as_ivec3();
            cells.entry(key).or_default().push(guide as u32);
        }
        Self { cell, cells, guide_strands: guide_strands.to_vec() }
    }

    /// Returns the guides within `radius` cells of `root`.
    fn around(&self, root: Vec3, radius: i32) -> Vec<u32> {
        let center = (root / self.cell).floor().as_ivec3();
        let mut found = Vec::new();
        for z in -radius..=radius {
            for y in -radius..=radius {
                for x in -radius..=radius {
                    if let Some(guides) = self.cells.get(&(center + glam::IVec3::new(x, y, z))) {
                        found.extend_from_slice(guides);
                    }
                }
            }
        }
        found
    }

    /// Returns up to three guides for a strand, weighted by inverse squared distance of shapes. A guide that `suits`
    /// rejects is used only if `suits` rejects all candidates.
    fn nearest(
        &self,
        shapes: &Shapes,
        own: &[Vec3; 3],
        pinned: bool,
        suits: impl Fn(u32) -> bool,
    ) -> Vec<Influence> {
        let mut candidates = Vec::new();
        for radius in [1, 2, 4] {
            candidates = self.around(own[0], radius);
            candidates.retain(|g| shapes.pinned[self.guide_strands[*g as usize] as usize] == pinned);
            if candidates.len() >= 3 {
                break;
            }
        }
        if candidates.is_empty() {
            // The strand is far from every guide of its kind: consider all guides.
            candidates = (0..self.guide_strands.len() as u32).collect();
        }
        if candidates.iter().any(|g| suits(*g)) {
            candidates.retain(|g| suits(*g));
        }
        let mut ranked: Vec<(f32, u32)> = candidates
            .into_iter()
            .map(|g| (Shapes::distance(own, &shapes.points[self.guide_strands[g as usize] as usize]), g))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ranked.truncate(3);
        // A guide more than twice as far as the nearest pulls the wrong way, so its weight fades to 0.
        let nearest = ranked[0].0.max(1e-8);
        let weight = |d: f32| (nearest / d.max(1e-8) - 0.2).max(0.0);
        let total: f32 = ranked.iter().map(|r| weight(r.0)).sum();
        ranked
            .iter()
            .map(|&(d, guide)| Influence { guide, weight: weight(d) / total, scale: 1.0 })
            .filter(|influence| influence.weight > 0.0)
            .collect()
    }
}

#[cfg(test)]
mod tests;
