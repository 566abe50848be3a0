//! Unit, up axis, facing and mirroring of files: set by the user, or guessed with reasons.
//!
//! A groom without a head is oriented by its roots, which lie on the top and back of a sphere of known size, and by the
//! direction in which hair falls. A head without a groom is oriented by its profile, its symmetry and its vertex
//! density. For a groom with a head, the importer first finds the relation between the two files, by the distance of
//! the roots to the mesh over all plausible units, rotations and reflections. Then it orients both together. A groom
//! made for another head is fitted onto this one, and the placement reports it.

mod choice;
mod evidence;
mod frame;
mod likeness;
mod pair;
mod placement;
mod seat;
mod size;
mod sphere;

pub use choice::{Axis, LengthUnit, OrientationOverride};
pub use pair::pair;
pub use placement::Placement;
pub use seat::seat;
pub use sphere::FittedSphere;

use evidence::{HairFacts, MeshFacts};
use frame::Frame;
use size::{HALF_BREADTH, HEAD_HEIGHT};

use crate::{Strands, TriMesh, mesh::bvh::Bvh};

/// A guess with a smaller lead over the next candidate is doubtful.
const DOUBT: f32 = 0.1;

/// Unit and axes of a file that are known before anything is guessed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnownOrientation {
    /// Given by the user; takes precedence.
    pub given: OrientationOverride,
    /// Stated by the file or its format.
    pub declared: OrientationOverride,
}

impl KnownOrientation {
    /// Returns both combined.
    fn combined(&self) -> OrientationOverride {
        self.given.or(self.declared)
    }
}

/// Returns where a value comes from: the user, the file (`stated`), or else `otherwise`.
fn source<'a, T>(given: Option<T>, declared: Option<T>, stated: &'a str, otherwise: &'a str) -> &'a str {
    match (given, declared) {
        (Some(_), _) => "given",
        (None, Some(_)) => stated,
        (None, None) => otherwise,
    }
}

/// Returns the best frame that a choice allows, its lead over the next, and the next.
fn best_frame(choice: &OrientationOverride, score: impl Fn(Frame) -> f32) -> (Frame, f32, Option<Frame>) {
    let mut ranked: Vec<(f32, Frame)> =
        Frame::all().filter(|f| choice.allows(*f)).map(|f| (score(f), f)).collect();
    // A contradictory choice allows no frame.
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = ranked.first().copied().unwrap_or((0.0, Frame { up: Axis::Y, front: Axis::Z }));
    let next = ranked.get(1).copied();
    (best.1, next.map_or(f32::INFINITY, |n| best.0 - n.0), next.map(|n| n.1))
}

/// Adds the reasons for the axes.
fn explain_axes(placement: &mut Placement, known: &KnownOrientation, why: &str) {
    let (combined, KnownOrientation { given, declared: file }) = (known.combined(), known);
    let (up, front) = (placement.up.name(), placement.front.name());
    let source = |given, file| source(given, file, "stated by the file", why);
    let of_up = source(given.up, file.up.filter(|up| combined.up == Some(*up)));
    let of_front = source(given.front, file.front.filter(|front| combined.front == Some(*front)));
    placement.reasons.push(match of_up == of_front {
        true => format!("up {up}, face {front}: {of_up}"),
        false if of_up == why => format!("face {front}: {of_front}; up {up}: {why}"),
        false => format!("up {up}: {of_up}; face {front}: {of_front}"),
    });
}

fn explain_doubt(placement: &mut Placement, lead: f32, next: Option<Frame>) {
    if let (true, Some(next)) = (lead < DOUBT, next) {
        placement.doubts.push(format!(
            "up {} and face {} is nearly as likely; set both axes to be sure",
            next.up.name(),
            next.front.name()
        ));
    }
}

/// Orients a groom without a head: returns its transform to meters, Y up, face +Z.
pub fn groom(strands: &Strands, known: &KnownOrientation) -> Placement {
    let choice = known.combined();
    let mut placement = Placement { mirrored: choice.is_mirrored.unwrap_or(false), ..Default::default() };
    let Some(facts) = HairFacts::of(strands) else {
        placement.unit = choice.unit.unwrap_or(LengthUnit(1.0));
        placement.up = choice.up.unwrap_or(Axis::Y);
        placement.front = choice.front.unwrap_or(Axis::Z);
        placement.doubts.push("too few roots to guess the orientation; set unit, up and front".into());
        return placement;
    };
    let (frame, lead, next) = best_frame(&choice, |f| facts.score(f) + f.habit());
    (placement.up, placement.front) = (frame.up, frame.front);
    explain_axes(
        &mut placement,
        known,
        "guessed from the roots (top and back of the head) and the falling hair",
    );
    explain_doubt(&mut placement, lead, next);
    unit_of_hair(&mut placement, &facts, known);
    placement
}

/// Sets the unit from the breadth of the rooted area.
fn unit_of_hair(placement: &mut Placement, facts: &HairFacts, known: &KnownOrientation) {
    let KnownOrientation { given, declared } = known;
    if let Some(unit) = given.unit.or(declared.unit) {
        placement.unit = unit;
        let source = source(given.unit, declared.unit, "stated by the file", "");
        placement.reasons.push(format!("1 unit is {} m: {source}", unit.0));
        return;
    }
    let breadth = facts.half_breadth(placement.up.vector().cross(placement.front.vector()));
    // A strip or a single tuft has no breadth; use its sphere.
    let breadth = if breadth > 0.1 * facts.sphere.radius { breadth } else { facts.sphere.radius };
    let (unit, known) = size::unit(breadth, HALF_BREADTH);
    if !known && explain_body(placement, facts.body()) {
        return;
    }
    placement.unit = unit;
    let measurement = format!(
        "the area with roots is {:.3} units wide; on a head it is {} cm",
        2.0 * breadth,
        200.0 * HALF_BREADTH
    );
    explain_unit(placement, known, &measurement);
}

/// Sets the unit of a `body` of this length, if hair lies around one. Returns whether a known unit fits.
fn explain_body(placement: &mut Placement, body: Option<f32>) -> bool {
    let Some((length, unit)) = body.and_then(|length| Some((length, size::unit_of_body(length)?))) else {
        return false;
    };
    placement.unit = unit;
    placement.reasons.push(format!(
        "1 unit is 1 {}: the roots lie all around a body, which is then {:.2} m long",
        unit.name(),
        length * unit.0
    ));
    placement.doubts.push("the size is a guess; set the unit to be sure".into());
    true
}

fn explain_unit(placement: &mut Placement, known: bool, measurement: &str) {
    let unit = placement.unit;
    placement.reasons.push(if known {
        format!("1 unit is 1 {}: {measurement}", unit.name())
    } else {
        format!("1 unit is {:.3} mm, not a common unit, but the size of a head: {measurement}", 1e3 * unit.0)
    });
    if !known {
        placement
            .doubts
            .push(format!("the size is a guess; set the unit (about {:.5} m) to be sure", unit.0));
    }
}

/// Orients a head without a groom: returns its transform to meters, Y up, face +Z.
pub fn head(mesh: &TriMesh, known: &KnownOrientation) -> Placement {
    let choice = known.combined();
    let mut placement = Placement { mirrored: choice.is_mirrored.unwrap_or(false), ..Default::default() };
    let facts = MeshFacts::of(mesh, &Bvh::new(mesh));
    // Common frames get a larger bonus: a mesh has less evidence than hair.
    let (frame, lead, next) = best_frame(&choice, |f| facts.score(f) + 2.0 * f.habit());
    (placement.up, placement.front) = (frame.up, frame.front);
    let why = "guessed from the head's profile, symmetry and vertex density";
    explain_axes(&mut placement, known, why);
    explain_doubt(&mut placement, lead, next);
    let source = source(known.given.unit, known.declared.unit, "stated by the format", "");
    unit_of_head(&mut placement, mesh, None, &choice, source);
    placement
}

/// Sets the unit from crown and chin, from the breadth of the rooted area, or from both. `hair` is half that breadth,
/// and the length of the body if it is no head.
fn unit_of_head(
    placement: &mut Placement,
    mesh: &TriMesh,
    hair: Option<(f32, Option<f32>)>,
    choice: &OrientationOverride,
    source: &str,
) {
    if let Some(unit) = choice.unit {
        placement.unit = unit;
        placement.reasons.push(format!("1 unit is {} m: {source}", unit.0));
        return;
    }
    if hair.is_some_and(|(_, body)| explain_body(placement, body)) {
        return;
    }
    let half_breadth = hair.map(|(breadth, _)| breadth);
    let found = size::head(mesh, placement.axes(), half_breadth);
    let found = found.filter(|h| half_breadth.is_none_or(|b| (2.0..3.6).contains(&(h.height / b))));
    let (known, measurement) = match (found, half_breadth) {
        (Some(head), Some(breadth)) => {
            // Heads may be long or broad, so use both measures.
            let (unit, known) =
                size::unit((head.height * breadth).sqrt(), (HEAD_HEIGHT * HALF_BREADTH).sqrt());
            placement.unit = unit;
            let measurement = format!(
                "crown to chin is {:.3} units and the area with roots {:.3} wide; on a head they are {} and {} cm",
                head.height,
                2.0 * breadth,
                100.0 * HEAD_HEIGHT,
                200.0 * HALF_BREADTH
            );
            (known, measurement)
        }
        (Some(head), None) => {
            let (unit, known) = size::unit(head.height, HEAD_HEIGHT);
            placement.unit = unit;
            (
                known,
                format!(
                    "crown to chin is {:.3} units; on a head it is {} cm",
                    head.height,
                    100.0 * HEAD_HEIGHT
                ),
            )
        }
        (None, Some(breadth)) => {
            let (unit, known) = size::unit(breadth, HALF_BREADTH);
            placement.unit = unit;
            (
                known,
                format!(
                    "the area with roots is {:.3} units wide; on a head it is {} cm",
                    2.0 * breadth,
                    200.0 * HALF_BREADTH
                ),
            )
        }
        (None, None) => {
            placement
                .doubts
                .push("no crown and chin found, so the unit is assumed to be a meter; if that is wrong, set the unit".into());
            (true, "assumed".into())
        }
    };
    explain_unit(placement, known, &measurement);
}

#[cfg(test)]
mod tests;
