//! Orients a groom and the head it grows on, which may have different units and axes.

use glam::Vec3;

use super::{
    Axis, DOUBT, KnownOrientation, LengthUnit, OrientationOverride, Placement,
    evidence::{HairFacts, MeshFacts},
    explain_axes, explain_unit,
    frame::Frame,
    groom, head, seat, source, unit_of_head,
};
use crate::{Strands, TriMesh, mesh::bvh::Bvh};

/// Maximum median distance between roots and the mesh that they belong to, in radii of their sphere.
const BELONGS: f32 = 0.04;
/// Maximum distance, in radii, of a root that lies exactly on the mesh. The mirror image of a head fits nearly, but
/// not exactly.
const EXACT: f32 = 1e-4;
/// Scales between files of common units, equal units first.
const SCALES: [f32; 9] = [1.0, 0.01, 100.0, 0.1, 10.0, 0.001, 1000.0, 0.0254, 39.370_08];

/// Returns the transforms of a groom and of its head, in this order, to meters, Y up, face +Z.
pub fn pair(
    strands: &Strands,
    of_groom: &KnownOrientation,
    mesh: &TriMesh,
    of_head: &KnownOrientation,
) -> (Placement, Placement) {
    let (choice, choice_head) = (of_groom.combined(), of_head.combined());
    let bvh = Bvh::new(mesh);
    let separately = || (groom(strands, of_groom), head(mesh, of_head));
    let Some(facts) = HairFacts::of(strands) else { return separately() };
    let relations = relations(&facts, &bvh, &choice, &choice_head);
    let surface = MeshFacts::of(mesh, &bvh);
    // Choose the relation and the head's frame together: the relation must move the roots to the skin, the frame must
    // make the result upright, and the user must allow both.
    let mut ranked = Vec::new();
    for (relation, cost) in relations.iter().filter(|r| r.1 < BELONGS) {
        let exact = exact(&facts, relation, &bvh);
        for frame in Frame::all().filter(|f| choice_head.allows(*f)) {
            let mirrored = choice_head.is_mirrored.unwrap_or(false);
            let upright = Placement { up: frame.up, front: frame.front, mirrored, ..Default::default() };
            let composed = compose(&upright, relation);
            let own = Frame { up: composed.up, front: composed.front };
            if choice.allows(own) && choice.is_mirrored.is_none_or(|m| m == composed.mirrored) {
                let score = facts.score(own) + surface.score(frame) + frame.habit() - 10.0 * cost
                    + 0.5 * exact
                    + habit(relation);
                ranked.push((score, relation, upright));
            }
        }
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let Some((score, relation, mut upright)) = ranked.first().cloned() else {
        let (own, head) = separately();
        let own = seat(strands, own, mesh, &head);
        return (own, head);
    };
    let why = "guessed from the head's profile and symmetry, the roots and the falling hair";
    explain_axes(&mut upright, of_head, why);
    // A unit given for one of the two files determines the other's.
    let given = choice_head.unit.or(choice.unit.map(|u| LengthUnit(u.0 / relation.unit.0)));
    let side = relation.axes().transpose() * upright.up.vector().cross(upright.front.vector());
    let breadth = facts.half_breadth(side) * relation.unit.0;
    let sized = OrientationOverride { unit: given, ..choice_head };
    unit_of_head(
        &mut upright,
        mesh,
        Some((breadth, facts.body().map(|length| length * relation.unit.0))),
        &sized,
        source(of_head.given.unit, of_head.declared.unit, "stated by the format", "from the groom"),
    );
    let mut own = compose(&upright, relation);
    explain_relation(&mut own, relation, of_groom);
    if let Some(next) = ranked.iter().find(|n| n.2.up != upright.up || n.2.front != upright.front)
        && score - next.0 < DOUBT
    {
        let (up, front) = (next.2.up.name(), next.2.front.name());
        own.doubts.push(format!(
            "up {up} and face {front} of the head is nearly as likely; set both axes to be sure"
        ));
    }
    (own, upright)
}

fn explain_relation(own: &mut Placement, relation: &Placement, known: &KnownOrientation) {
    let mut how = Vec::new();
    if relation.unit.0 != 1.0 {
        how.push(format!("scaled by {}", relation.unit.0));
    }
    if relation.axes() != glam::Mat3::IDENTITY {
        let what = if relation.mirrored { "mirrored" } else { "turned" };
        let axis = |v: Vec3| Axis::nearest(relation.axes() * v).name();
        how.push(format!(
            "{what} (its x, y, z are the head's {}, {}, {})",
            axis(Vec3::X),
            axis(Vec3::Y),
            axis(Vec3::Z)
        ));
    }
    let how = if how.is_empty() { "with the head's axes and unit".into() } else { how.join(" and ") };
    own.reasons.insert(0, format!("the groom, {how}, has its roots on the mesh"));
    let unit = own.unit;
    let source = source(known.given.unit, known.declared.unit, "stated by the file", "from the head");
    explain_unit(own, LengthUnit::KNOWN.iter().any(|k| k.1 == unit.0) || unit.0 == 1.0, source);
}

/// Returns a penalty for unusual relations between a groom and its head.
fn habit(relation: &Placement) -> f32 {
    let is_rotated = relation.axes() != glam::Mat3::IDENTITY;
    let mut score = 0.0;
    score -= if relation.unit.0 != 1.0 { 0.1 } else { 0.0 };
    score -= if is_rotated { 0.1 } else { 0.0 };
    score - if relation.mirrored { 0.02 } else { 0.0 }
}

/// Returns every rotation, reflection and scale from the groom's file to the head's, with the median distance of the
/// roots to the mesh, in radii of their sphere.
fn relations(
    facts: &HairFacts,
    bvh: &Bvh,
    groom: &OrientationOverride,
    head: &OrientationOverride,
) -> Vec<(Placement, f32)> {
    let given = match (groom.unit, head.unit) {
        (Some(g), Some(h)) => Some(g.0 / h.0),
        _ => None,
    };
    let step = (facts.roots.len() / 96).max(1);
    let sample: Vec<Vec3> = facts.roots.iter().copied().step_by(step).collect();
    let mut found: Vec<(Placement, f32)> = Vec::new();
    for scale in given.map_or(SCALES.to_vec(), |g| vec![g]) {
        for frame in Frame::all() {
            for mirrored in [false, true] {
                let unit = LengthUnit(scale);
                let relation =
                    Placement { unit, up: frame.up, front: frame.front, mirrored, ..Default::default() };
                let cost = cost(&sample, &relation, bvh) / (facts.sphere.radius * scale);
                found.push((relation, cost));
            }
        }
        // A groom and its head mostly share a unit: stop at the first scale that fits.
        if found.iter().any(|f| f.1 < BELONGS) {
            break;
        }
    }
    found
}

fn cost(roots: &[Vec3], relation: &Placement, bvh: &Bvh) -> f32 {
    let mut distances: Vec<f32> = roots
        .iter()
        .map(|p| bvh.closest_point(relation.point(*p)).map_or(f32::MAX, |c| c.distance))
        .collect();
    let median = distances.len() / 2;
    *distances.select_nth_unstable_by(median, f32::total_cmp).1
}

/// Returns the fraction of roots that lie exactly on the mesh.
fn exact(facts: &HairFacts, relation: &Placement, bvh: &Bvh) -> f32 {
    let near = EXACT * facts.sphere.radius * relation.unit.0;
    let on = |p: &&Vec3| bvh.closest_point_within(relation.point(**p), near).is_some();
    facts.roots.iter().filter(on).count() as f32 / facts.roots.len() as f32
}

/// Returns the placement that applies `inner`, then `outer`.
fn compose(outer: &Placement, inner: &Placement) -> Placement {
    let axes = outer.axes() * inner.axes();
    Placement {
        unit: LengthUnit(outer.unit.0 * inner.unit.0),
        up: Axis::nearest(axes.row(1)),
        front: Axis::nearest(axes.row(2)),
        mirrored: axes.determinant() < 0.0,
        translation: outer.point(inner.translation),
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compose_applies_inner_then_outer() {
        let inner = Placement {
            unit: LengthUnit(0.1),
            up: Axis::Z,
            front: Axis::NegX,
            mirrored: true,
            translation: Vec3::new(1.0, 2.0, 3.0),
            ..Default::default()
        };
        let outer = Placement { unit: LengthUnit(2.0), up: Axis::NegY, front: Axis::X, ..Default::default() };
        let p = Vec3::new(0.3, -0.7, 5.0);
        let whole = compose(&outer, &inner);
        assert!(whole.point(p).distance(outer.point(inner.point(p))) < 1e-5);
    }
}
