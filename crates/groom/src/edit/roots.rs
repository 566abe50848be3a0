//! Strokes that add, remove and rebind roots: the version after them has other guides or strands.
//!
//! Hair is carried to its current shape once, and becomes the hair before the first stroke of the new version.

use super::{GroomDocument, document::Base, ground::Ground, painted_values::PaintedValues, solve::unit};
use crate::{
    BoundStrands, Fill, Groom, Guides, Head, Result, Strands,
    bind::finder::GuideFinder,
    bound::{self, Influence, Strand},
    curve,
    fill::fill,
    grow::Growth,
    hash::pcg,
    near::PointTree,
    progress::in_parallel,
    restyle::painted::StrandShape,
};
use glam::Vec3;
use std::{collections::BTreeSet, sync::Arc};

/// Largest distance of a strand from the skin after its guides have moved, meters.
const OFF_SKIN: f32 = 0.03;
/// Area of a head with hair, m²: strands per area are as wide as on a head that is covered as densely.
const HEAD_AREA: f32 = 0.06;
/// Radius at the tip of a new strand relative to its root.
const TAPER: f32 = 0.4;
/// Smallest distance between roots, relative to the spacing of a triangular grid of the same density.
const CLOSE: f32 = 0.6;
/// Area of a guide where no more fit at random, in squared distances between guides (Feder 1980: discs placed at random
/// cover 0.547 of a plane).
const GUIDE_AREA: f32 = std::f32::consts::FRAC_PI_4 / 0.547;
/// Distance from new guides in which others are neighbors, in distances between guides.
const NEIGHBOR_DISTANCE: f32 = 2.5;

/// A place on a parting.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartingPoint {
    pub at: Vec3,
    /// Direction to one side, unit.
    pub across: Vec3,
}

/// Changes of roots in a stroke.
#[derive(Clone, Debug, Default)]
pub(super) struct RootChanges {
    /// Strands that go, by index.
    pub removed: BTreeSet<usize>,
    /// New guides.
    pub planted: Vec<Vec<Vec3>>,
    /// Distance between new guides, meters.
    pub spacing: f32,
    /// Group of new guides; `None` for the group of their neighbors.
    pub group: Option<i32>,
    /// New strands around new guides, per square meter; 0 for none.
    pub density: f32,
    /// A parting that strands do not follow guides across.
    pub parting: Vec<PartingPoint>,
    /// Distance from the parting in which strands are rebound, meters.
    pub rebind_distance: f32,
}

impl RootChanges {
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty() && self.planted.is_empty() && self.parting.is_empty()
    }

    /// Returns the side of the parting on which `root` is, with its distance from the parting.
    fn side(&self, root: Vec3) -> Option<(bool, f32)> {
        let distances = self.parting.iter().map(|point| (point.at.distance(root), point));
        let (distance, point) =
            distances.reduce(|best, other| if other.0 < best.0 { other } else { best })?;
        Some(((root - point.at).dot(point.across) >= 0.0, distance))
    }
}

impl GroomDocument {
    /// Returns this version with other roots; `None` if no hair would be left.
    ///
    /// # Errors
    /// As [`fill`].
    pub(super) fn with_roots(&self, changes: &RootChanges, ground: &Ground) -> Result<Option<Self>> {
        let (mut groom, stays) = without(self.unshaped_groom(), &changes.removed);
        if groom.strands.is_empty() && changes.planted.is_empty() {
            return Ok(None);
        }
        let old = groom.guides.len();
        plant(&mut groom.guides, &changes.planted, changes.group);
        let finder = (!changes.planted.is_empty() || !changes.parting.is_empty())
            .then(|| GuideFinder::new(&groom.guides));
        if let Some(finder) = &finder {
            rebind(&mut groom, old, changes, finder);
        }
        if changes.density > 0.0 && !changes.planted.is_empty() {
            grow(&mut groom, old, changes, ground)?;
        }
        count_followers(&mut groom);
        // Strands that stay are in their order, and new ones come after them.
        let origins = self.origins();
        let mut fresh = origins.iter().max().map_or(0, |last| last + 1);
        let stays_at = |i: &usize| !changes.removed.contains(i);
        let left = |i: usize| stays_at(&i).then_some(origins[i]);
        let mut origins: Vec<u32> = (0..origins.len()).filter_map(left).collect();
        let PaintedValues { shapes, held, .. } = self.painted_values();
        let mut shapes: Vec<StrandShape> = (0..shapes.len()).filter(stays_at).map(|i| shapes[i]).collect();
        while origins.len() < groom.strands.len() {
            origins.push(fresh);
            fresh += 1;
        }
        let base = Base::new(self.family(), Arc::new(groom), None).with_origins(Some(origins.into()));
        let document = Self::at_base(base);
        if !held.contains(&true) && shapes.is_empty() {
            return Ok(Some(document));
        }
        let mut painted_values = document.painted_values();
        if !shapes.is_empty() {
            shapes.resize(painted_values.strands.len(), StrandShape::default());
            painted_values.shapes = shapes;
        }
        painted_values.held.iter_mut().zip(stays).for_each(|(now, was)| *now = held[was]);
        Ok(Some(document.with_painted_values(painted_values)))
    }

    /// Returns this version with the strands that follow `guides` rooted in the skin: each is moved there as a
    /// whole.
    pub(super) fn rooted(&self, guides: &BTreeSet<usize>, ground: &Ground) -> Self {
        let mut groom = self.unshaped_groom();
        let strands = &groom.strands;
        let follows = |i: &usize| strands.bindings[*i].weighted().any(|(guide, _)| guides.contains(&guide));
        let of: Vec<usize> = (0..strands.len()).filter(follows).collect();
        let offsets = in_parallel(&of, |i| {
            let root = strands.rest_positions(*i).next()?;
            Some(ground.nearest(root, OFF_SKIN)?.0 - root)
        });
        for (i, offset) in of.into_iter().zip(offsets).filter_map(|(i, offset)| Some((i, offset?))) {
            groom.strands.bindings[i].origin += offset;
        }
        let origins = Some(self.origins().into());
        let base = Base::new(self.family(), Arc::new(groom), None).with_origins(origins);
        Self::at_base(base).with_painted_values(self.painted_values())
    }
}

/// Returns `groom` without the strands in `removed`, and without guides that no strand follows any more; and the guides
/// that stay.
fn without(groom: Groom, removed: &BTreeSet<usize>) -> (Groom, Vec<usize>) {
    if removed.is_empty() {
        let all = (0..groom.guides.len()).collect();
        return (groom, all);
    }
    let (strands, m) = (&groom.strands, groom.strands.vertex_count as usize);
    let mut followed = vec![[false; 2]; groom.guides.len()];
    for (i, binding) in strands.bindings.iter().enumerate() {
        let left = !removed.contains(&i);
        for (guide, _) in binding.weighted() {
            followed[guide][0] = true;
            followed[guide][1] |= left;
        }
    }
    let stays: Vec<usize> = (0..groom.guides.len()).filter(|i| followed[*i][0] == followed[*i][1]).collect();
    let mut new_index = vec![0; groom.guides.len()];
    (0u32..).zip(&stays).for_each(|(now, was)| new_index[*was] = now);
    let mut left = BoundStrands::new(strands.vertex_count);
    for i in (0..strands.len()).filter(|i| !removed.contains(i)) {
        let mut binding = strands.bindings[i];
        binding.guides = binding.guides.map(|guide| new_index[guide as usize]);
        left.strands.push(strands.strands[i]);
        left.bindings.push(binding);
        left.rest.extend(&strands.rest[i * m..(i + 1) * m]);
    }
    let all = &groom.guides;
    let guides = Guides {
        vertex_count: all.vertex_count,
        positions: stays.iter().flat_map(|i| all.guide(*i)).copied().collect(),
        stiffness: stays.iter().map(|i| all.stiffness[*i]).collect(),
        strands: stays.iter().map(|i| all.strands[*i]).collect(),
        tip_pinned: stays.iter().map(|i| all.tip_pinned[*i]).collect(),
        groups: stays.iter().filter_map(|i| all.groups.get(*i)).copied().collect(),
    };
    (Groom { guides, strands: left }, stays)
}

/// Adds guides of a group; without one, of the group of their nearest neighbor.
fn plant(guides: &mut Guides, planted: &[Vec<Vec3>], group: Option<i32>) {
    if group.is_some_and(|group| group != 0) && guides.groups.is_empty() {
        guides.groups = vec![0; guides.len()];
    }
    let roots: Vec<Vec3> = (0..guides.len()).map(|i| guides.guide(i)[0]).collect();
    let (tree, mut found) = (PointTree::new(&roots), Vec::new());
    let old = guides.groups.clone();
    for line in planted {
        guides.push(line, 1.0, false);
        tree.nearest(line[0], 1, f32::MAX, &mut found);
        // Guides have groups all, or none.
        let nearest = found.first().and_then(|(_, i)| old.get(*i as usize)).copied();
        guides.groups.extend(nearest.map(|nearest| group.unwrap_or(nearest)));
    }
}

/// Lets strands near new guides follow these, and strands at a parting only guides on their side. Their shapes stay.
fn rebind(groom: &mut Groom, old: usize, changes: &RootChanges, finder: &GuideFinder) {
    let roots: Vec<Vec3> = (old..groom.guides.len()).map(|i| groom.guides.guide(i)[0]).collect();
    let (tree, mut found) = (PointTree::new(&roots), Vec::new());
    let sides: Vec<Option<(bool, f32)>> = match changes.parting.is_empty() {
        true => Vec::new(),
        false => (0..groom.guides.len()).map(|i| changes.side(groom.guides.guide(i)[0])).collect(),
    };
    for i in 0..groom.strands.len() {
        let line: Vec<Vec3> = groom.strands.rest_positions(i).collect();
        let binding = &groom.strands.bindings[i];
        tree.nearest(line[0], 1, changes.spacing, &mut found);
        let side = changes.side(line[0]).filter(|(_, distance)| *distance <= changes.rebind_distance);
        let crosses = side.is_some_and(|(side, _)| {
            binding.weighted().any(|(guide, _)| sides[guide].is_some_and(|other| other.0 != side))
        });
        if found.is_empty() && !crosses {
            continue;
        }
        let pinned = groom.guides.tip_pinned[binding.guides[0] as usize];
        let suits = |guide: u32| {
            side.is_none_or(|(side, _)| sides[guide as usize].is_none_or(|other| other.0 == side))
        };
        let influences = finder.nearest(&line, pinned, suits);
        groom.strands.bindings[i].follow(&influences);
    }
}

/// Grows strands around the guides from `old` on, where there are none.
fn grow(groom: &mut Groom, old: usize, changes: &RootChanges, ground: &Ground) -> Result<()> {
    let (guides, spacing) = (&groom.guides, changes.spacing);
    let planted: Vec<Vec3> = (old..guides.len()).map(|i| guides.guide(i)[0]).collect();
    let (tree, mut found) = (PointTree::new(&planted), Vec::new());
    let mut of: Vec<usize> = (old..guides.len()).collect();
    for i in 0..old {
        tree.nearest(guides.guide(i)[0], 1, NEIGHBOR_DISTANCE * spacing, &mut found);
        if !found.is_empty() {
            of.push(i);
        }
    }
    let mut given = Strands::default();
    of.iter().for_each(|i| given.push(guides.guide(*i)));
    let each = changes.density * spacing * spacing * GUIDE_AREA;
    let strands = (given.len() as f32 * each.max(1.0)) as u32;
    let seed = planted.iter().fold(1, |seed, p| pcg(seed ^ p.x.to_bits() ^ p.y.to_bits()));
    let options = Fill { strand_count: strands.min(Growth::MAX_STRANDS), seed, ..Fill::default() };
    let head = Head { mesh: ground.mesh.as_ref().map(|mesh| &mesh.0), field: ground.field.as_deref() };
    let filled = fill(&given, head, &options)?;

    let m = groom.strands.vertex_count as usize;
    let occupied: Vec<Vec3> =
        (0..groom.strands.len()).filter_map(|i| groom.strands.rest_positions(i).next()).collect();
    let occupied = PointTree::new(&occupied);
    let min_distance = CLOSE * (2.0 / (3f32.sqrt() * changes.density)).sqrt();
    let radii: Vec<f32> = (0..m).map(|k| 1.0 - (1.0 - TAPER) * k as f32 / (m - 1) as f32).collect();
    let radius = bound::covering_radius((changes.density * HEAD_AREA) as usize);
    let mut new: Vec<(Vec<Vec3>, Vec<Influence>)> = Vec::new();
    for (k, guide) in (old..guides.len()).enumerate() {
        let own = Influence { guide: guide as u32, weight: 1.0, scale: 1.0 };
        new.push((given.strand(k).to_vec(), vec![own]));
    }
    for (k, parents) in filled.parents.iter().enumerate() {
        // Hair between older guides is there already.
        if !parents.iter().any(|(parent, _)| (parent as usize) < planted.len()) {
            continue;
        }
        let line = filled.strands.strand(filled.given + k);
        let length = curve::length(line);
        let influence = |(parent, weight): (u32, f32)| {
            let guide = of[parent as usize];
            let scale = length / curve::length(guides.guide(guide)).max(1e-9);
            Influence { guide: guide as u32, weight, scale }
        };
        new.push((line.to_vec(), parents.iter().map(influence).collect()));
    }
    for (line, influences) in new {
        occupied.nearest(line[0], 1, min_distance, &mut found);
        if !found.is_empty() {
            continue;
        }
        let seed = line[0].to_array().into_iter().fold(seed, |seed, x| pcg(seed ^ x.to_bits()));
        let strand = Strand { radius, seed, root_color: 0, tip_color: 0 };
        groom.strands.push(strand, &curve::subdivide(&line, m), &radii, &influences);
    }
    Ok(())
}

fn count_followers(groom: &mut Groom) {
    let mut counts = vec![0.0f32; groom.guides.len()];
    for binding in &groom.strands.bindings {
        binding.weighted().for_each(|(guide, weight)| counts[guide] += weight);
    }
    groom.guides.strands = counts.into_iter().map(|count| count.max(1.0)).collect();
}

/// Returns the direction across a parting that runs along `motion` on skin with this normal.
pub(super) fn across(normal: Vec3, motion: Vec3) -> Vec3 {
    unit(normal.cross(motion), Vec3::ZERO)
}
