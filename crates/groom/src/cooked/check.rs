//! Validation of cooked grooms. Code downstream relies on these checks and does not repeat them.

use super::CookedGroom;
use crate::{
    Groom, Look, MAX_GUIDE_VERTICES, MAX_STRAND_VERTICES, MAX_VERTICES, Rig, SdfGrid, Strands,
    light::PunctualLight,
    orient::Placement,
    rig::{Animation, MAX_JOINTS, Property, Transform},
};
use glam::Vec3;

/// Maximum nodes of a distance field along one axis: the largest [`SdfOptions::resolution`](crate::mesh::SdfOptions),
/// plus one for rounding.
const MAX_NODES: u32 = 513;
/// Maximum depth of the rig's node tree, as in the glTF reader.
const DEEPEST: usize = 256;

/// Returns `problem`, a clause for the error message, unless `holds`.
fn ensure(holds: bool, problem: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(problem.into()) }
}

/// Returns whether an attribute is absent or has one value per item.
fn all_or_none(values: usize, all: usize) -> bool {
    values == 0 || values == all
}

impl CookedGroom {
    /// Checks that all indices are in range and that all numbers used in computations are finite. Returns the first
    /// problem.
    pub(super) fn check(&self) -> Result<(), String> {
        strands(&self.strands)?;
        let count = self.strands.len();
        let followers = &self.report_text.followers;
        let within =
            followers.iter().filter_map(|f| f.radius).all(|radius| radius.is_finite() && radius >= 0.0);
        ensure(
            all_or_none(followers.len(), count) && within,
            "the child strand settings do not match the strands",
        )?;
        let placements = [Some(&self.report_text.placement), self.report_text.head_placement.as_ref()];
        let placed = |p: &Placement| p.unit.0.is_finite() && p.unit.0 > 0.0 && p.translation.is_finite();
        ensure(placements.into_iter().flatten().all(placed), "the unit or the translation is invalid")?;
        self.report_text.look.as_ref().map_or(Ok(()), Look::check).map_err(|error| error.to_string())?;
        self.report_text.lights.iter().try_for_each(PunctualLight::check)?;
        groom(&self.groom)?;
        // Strands marked as guides are not drawn if the groom has other strands.
        let guides = self.strands.marks.iter().filter(|mark| mark.guide).count();
        let drawn = if guides < count { count - guides } else { count };
        ensure(self.groom.strands.len() == drawn, "the number of bound strands does not match")?;
        let vertices = self.head.as_ref().map_or(0, |head| head.positions.len());
        if let Some(head) = &self.head {
            head.validate().map_err(|error| error.to_string())?;
            let is_complete = head.normals.len() == vertices && !head.triangles.is_empty();
            ensure(is_complete, "the head mesh lacks normals or triangles")?;
        }
        for level in &self.levels {
            let inside = level.triangles.as_flattened().iter().all(|i| (*i as usize) < vertices);
            ensure(
                inside && level.stray.is_finite(),
                "a coarser head mesh refers to missing vertices or is not finite",
            )?;
        }
        self.field.as_ref().map_or(Ok(()), field)?;
        let nodes = self.rig.as_ref().map_or(0, |rig| rig.nodes.len());
        for (node, part) in &self.parts {
            ensure((*node as usize) < nodes, "a body part refers to a missing node")?;
            field(part)?;
        }
        self.rig.as_ref().map_or(Ok(()), |all| rig(all, vertices))
    }
}

fn strands(strands: &Strands) -> Result<(), String> {
    let (count, vertices) = (strands.len(), strands.positions.len());
    let offsets = &strands.offsets;
    let is_complete =
        offsets.first() == Some(&0) && offsets.last().is_some_and(|last| *last as usize == vertices);
    ensure(
        count > 0 && is_complete && vertices as u64 <= MAX_VERTICES,
        "the strand offsets do not match the vertices",
    )?;
    // `checked_sub` rejects offsets that decrease.
    let sized = |w: &[u32]| w[1].checked_sub(w[0]).is_some_and(|n| (2..=MAX_STRAND_VERTICES).contains(&n));
    ensure(offsets.windows(2).all(sized), "a strand has too few or too many vertices")?;
    let per_vertex = [strands.radii.len(), strands.colors.len()];
    let per_strand = [strands.root_uvs.len(), strands.tip_pinned.len(), strands.marks.len()];
    let fits = per_vertex.iter().all(|n| all_or_none(*n, vertices))
        && per_strand.iter().all(|n| all_or_none(*n, count));
    let fits = fits && strands.attributes.iter().all(|attribute| attribute.fits(count, vertices));
    ensure(fits, "the attribute counts do not match the strands")?;
    let finite = strands.positions.iter().chain(&strands.colors).all(|p| p.is_finite())
        && strands.radii.iter().all(|radius| radius.is_finite() && *radius >= 0.0)
        && strands.root_uvs.iter().all(|uv| uv.is_finite())
        && strands.marks.iter().flat_map(|mark| mark.weights).all(f32::is_finite);
    ensure(finite, "strands have numbers that are not finite")?;
    let long = |strand: &[Vec3]| strand.windows(2).all(|w| w[0] != w[1]);
    ensure(strands.iter().all(long), "strands have zero-length segments")
}

fn groom(groom: &Groom) -> Result<(), String> {
    let (guides, strands) = (&groom.guides, &groom.strands);
    let sized = (3..=MAX_GUIDE_VERTICES).contains(&guides.vertex_count)
        && (2..=MAX_STRAND_VERTICES).contains(&strands.vertex_count);
    let (count, bound) = (guides.len(), strands.len());
    let fits = sized
        && count > 0
        && guides.positions.len() as u64 == count as u64 * u64::from(guides.vertex_count)
        && strands.rest.len() as u64 == bound as u64 * u64::from(strands.vertex_count)
        && guides.strands.len() == count
        && guides.tip_pinned.len() == count
        && all_or_none(guides.groups.len(), count)
        && strands.bindings.len() == bound;
    ensure(fits, "the guide and strand arrays have the wrong lengths")?;
    let follows = |guide: u32| (guide as usize) < count;
    ensure(
        strands.bindings.iter().all(|binding| binding.guides.into_iter().all(follows)),
        "a strand refers to a missing guide",
    )?;
    let mut numbers = strands.bindings.iter().flat_map(|b| {
        b.origin.to_array().into_iter().chain(b.scale).chain([b.extent, b.weight_b, b.weight_c])
    });
    let finite = guides.positions.iter().all(|p| p.is_finite())
        && guides.stiffness.iter().chain(&guides.strands).all(|v| v.is_finite())
        && strands.strands.iter().all(|strand| strand.radius.is_finite())
        && numbers.all(f32::is_finite);
    ensure(finite, "guides have numbers that are not finite")
}

fn field(field: &SdfGrid) -> Result<(), String> {
    let nodes = field.size.to_array().into_iter().map(u64::from).try_fold(1u64, u64::checked_mul);
    let sized = field.size.min_element() >= 2 && field.size.max_element() <= MAX_NODES;
    let fits = sized && nodes == Some(field.distances.len() as u64);
    let placed = field.origin.is_finite() && field.cell.is_finite() && field.cell > 0.0;
    ensure(fits && placed, "the distance field has an invalid size or position")?;
    ensure(
        field.distances.iter().all(|d| d.is_finite()),
        "the distance field has numbers that are not finite",
    )
}

fn rig(rig: &Rig, vertices: usize) -> Result<(), String> {
    ensure(rig.vertices.len() == vertices, "the rig and the head have different numbers of vertices")?;
    let (nodes, joints, targets) = (rig.nodes.len(), rig.joints.len(), rig.targets.len());
    let mut depths: Vec<usize> = Vec::with_capacity(nodes);
    for node in &rig.nodes {
        let depth = node.parent.map(|parent| depths.get(parent as usize).map(|depth| depth + 1));
        ensure(depth != Some(None), "a joint refers to a missing parent")?;
        depths.push(depth.flatten().unwrap_or(0));
        let Transform { translation, rotation, scale } = node.rest;
        let placed = translation.is_finite() && rotation.is_finite() && scale.is_finite();
        let weighed = node.weights.iter().all(|(_, weight)| weight.is_finite());
        ensure(
            placed && weighed && node.matrix.is_none_or(|m| m.is_finite()),
            "a joint has numbers that are not finite",
        )?;
    }
    ensure(depths.iter().all(|depth| *depth <= DEEPEST), "joints are nested too deeply")?;
    let known = joints <= MAX_JOINTS
        && rig.joints.iter().all(|joint| (joint.node as usize) < nodes && joint.inverse_bind.is_finite())
        && rig.nodes.iter().flat_map(|node| &node.weights).all(|(target, _)| (*target as usize) < targets);
    ensure(
        known && rig.to_groom.is_finite(),
        "a joint refers to a missing node or blend shape, or is not finite",
    )?;
    for bind in &rig.vertices {
        let follows = bind.joints.iter().all(|joint| usize::from(*joint) < joints);
        let has_valid_weights = bind.weights.iter().all(|weight| weight.is_finite() && *weight >= 0.0);
        let placed = bind.position.is_finite() && bind.normal.is_finite();
        ensure(
            follows && has_valid_weights && placed,
            "a vertex refers to a missing joint or has invalid numbers",
        )?;
    }
    for target in &rig.targets {
        let ascends = target.deltas.windows(2).all(|w| w[0].vertex < w[1].vertex);
        let inside = target.deltas.last().is_none_or(|delta| (delta.vertex as usize) < vertices);
        let finite = target.deltas.iter().all(|delta| delta.position.is_finite() && delta.normal.is_finite());
        ensure(
            ascends && inside && finite,
            "a blend shape refers to missing vertices or has invalid numbers",
        )?;
    }
    rig.animations.iter().try_for_each(|motion| animation(motion, nodes, targets))
}

fn animation(animation: &Animation, nodes: usize, targets: usize) -> Result<(), String> {
    ensure(animation.length.is_finite() && animation.length >= 0.0, "an animation has an invalid length")?;
    for channel in &animation.channels {
        let of_targets = match &channel.property {
            Property::Weights(all) => all.iter().all(|target| (*target as usize) < targets),
            Property::Translation | Property::Rotation | Property::Scale => true,
        };
        ensure(
            of_targets && (channel.node as usize) < nodes,
            "an animation refers to a missing node or blend shape",
        )?;
        let (times, values) = (&channel.curve.times, &channel.curve.values);
        let finite = times.iter().chain(values).all(|v| v.is_finite());
        ensure(finite && times.is_sorted(), "the keys of an animation are out of order or not finite")?;
    }
    Ok(())
}
