//! Converts guide polylines to the step's inputs: rest positions, contact clearances and the rest shape, optionally
//! compensated for gravity.
//!
//! A groom is authored as it should look under gravity. If that pose were used as the shape without gravity, hair would
//! sag in the first second. [`RestShape::SagFree`] therefore walks from tip to root: the edge below a vertex must carry
//! the weight of everything below it. The component along the edge changes the edge's rest length. The component across
//! it changes the bend at its upper end, until the bending spring gives exactly that force. The pose is then an
//! equilibrium of the discrete equations that the step solves, not only of the continuous ones.
//!
//! An equilibrium need not be stable. A floppy strand that is authored to stick out needs a rest shape wound up like a
//! watch spring, and collapses at the first touch. Real hair that stands out is stiff or leans on other hair.
//! [`support`] therefore raises the stiffness of such guides, and only of these, until their poses are stable. The
//! compensation of one bend is still limited to [`MAX_COMPENSATION`] of the edge; the remainder shows as sag, reduced
//! by the goal spring. Contact forces at rest are not compensated: hair that rested on the head in its authored pose
//! hovers over it. Untried: the second variation including the torques of bends, which couple the two directions across
//! the strand, and a factor per vertex instead of per guide.

use super::params::SimulationParams;
use crate::{
    Error, Result,
    groom::{SdfGrid, range},
    range::Range,
    strands::{
        Guide, GuideRest, GuideShape, PackedGuide, RestGuides,
        guide::{MAX_GIVE, MAX_SHORTER, TIP_PINNED, rounded_give},
    },
};
use glam::Vec3;

/// Largest compensation of one bend, as a fraction of the edge.
pub const MAX_COMPENSATION: f32 = MAX_GIVE;

/// Largest compensation from which a shaken bend recovers its shape by itself, as a fraction of the edge.
pub const EASY_COMPENSATION: f32 = 0.35;

/// Value of [`RestOptions::support`] at which bends recover up to [`EASY_COMPENSATION`].
pub const DEFAULT_SUPPORT: f32 = 2.0;

/// Largest factor of a guide's stiffness, per unit of [`RestOptions::support`]; see [`support`].
pub const MAX_SUPPORT: f32 = 10.0;

/// Interpretation of the authored pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum RestShape {
    /// The shape without gravity: the hair will sag. For draping.
    Natural,
    /// The shape under gravity with the head upright: the hair keeps it.
    #[default]
    SagFree,
}

/// Per-guide properties besides the vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GuideTraits {
    /// Multiplier of the stiffness parameters.
    pub stiffness: f32,
    /// Number of drawn strands that the guide represents.
    pub strands: f32,
    /// Whether the tip follows the head, like the root.
    pub is_tip_pinned: bool,
}

impl Default for GuideTraits {
    fn default() -> Self {
        Self { stiffness: 1.0, strands: 1.0, is_tip_pinned: false }
    }
}

/// Options for the rest state of guides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestOptions {
    /// Interpretation of the authored pose.
    pub shape: RestShape,
    /// Distance that guides and strands keep from the head, meters. Hair that rests closer keeps that smaller distance.
    pub clearance: f32,
    /// Safety margin of the stiffening of guides that do not hang (`support`), as a multiple of the stiffness at which
    /// they just stay upright. Hairs that lean on each other bend as one beam: together they are as many times stiffer
    /// as there are hairs.
    pub support: f32,
}

impl Default for RestOptions {
    fn default() -> Self {
        Self { shape: RestShape::SagFree, clearance: 1.5e-3, support: 2.0 }
    }
}

impl RestOptions {
    /// The range of [`support`](Self::support).
    pub const SUPPORT: Range = range!("support", 1.0 to 1000.0; usually 1.0 to 50.0);
}

/// Builds guides from `positions` (groom space, meters). Guide `g` has the vertices `g * n..(g + 1) * n`, root first,
/// at equal arc lengths (see [`crate::groom::curve::resample`]). `traits` has one entry per guide, or none for the
/// default. `field` gives the clearance of each vertex at rest.
///
/// # Errors
/// [`Error::Groom`] if counts do not match or a position is not finite, and the errors of [`SimulationParams::check`].
pub fn guides(
    positions: &[Vec3],
    n: u32,
    traits: &[GuideTraits],
    params: &SimulationParams,
    options: &RestOptions,
    field: Option<&SdfGrid>,
) -> Result<RestGuides> {
    guides_at(positions, n, traits, params, options, &distances(positions, field))
}

/// [`guides`] with the [`distances`] of the vertices from what they rest on.
pub(crate) fn guides_at(
    positions: &[Vec3],
    n: u32,
    traits: &[GuideTraits],
    params: &SimulationParams,
    options: &RestOptions,
    distances: &[f32],
) -> Result<RestGuides> {
    params.check()?;
    RestOptions::SUPPORT.check(options.support)?;
    if !(2..=crate::constants::MAX_GUIDE_VERTICES).contains(&n) {
        return Err(Error::Parameter {
            name: "vertices per guide",
            value: n.to_string(),
            range: "from 2 to 64",
        });
    }
    let n = n as usize;
    let count = positions.len() / n;
    if count * n != positions.len() || !(traits.is_empty() || traits.len() == count) {
        return Err(Error::unusable(format!(
            "{} positions and {} traits do not match guides of {n} vertices",
            positions.len(),
            traits.len()
        )));
    }
    if let Some(at) = positions.iter().position(|p| !(p.is_finite() && p.abs().max_element() < 1e3)) {
        return Err(Error::unusable(format!(
            "vertex {} of guide {} is at {}, which is not within a kilometer of the head",
            at % n,
            at / n,
            positions[at]
        )));
    }
    let mut out = RestGuides {
        vertex_count: n as u32,
        info: Vec::with_capacity(count),
        rest: vec![GuideRest::default(); positions.len()],
        shape: vec![GuideShape::default(); positions.len()],
    };
    for (g, guide) in positions.chunks_exact(n).enumerate() {
        let traits = traits.get(g).copied().unwrap_or_default();
        let (low, high) =
            guide.iter().fold((guide[0], guide[0]), |(low, high), p| (low.min(*p), high.max(*p)));
        let mut info = Guide { origin: low, extent: (high - low).max_element(), ..Guide::default() };
        // The rest is computed from the pose as the GPU rounds it, micrometers from the authored one, so that this pose
        // is at rest.
        let rounded = |(i, p): (usize, &Vec3)| {
            let contact =
                distances.get(g * n + i).map_or(options.clearance, |has| has.min(options.clearance));
            let rest = GuideRest { position: *p, contact };
            let rest = PackedGuide::pack(&rest, Vec3::ZERO, 0.0, 1.0, &info).rest(&info);
            out.rest[i * count + g] = rest;
            rest.position
        };
        let guide = &guide.iter().enumerate().map(rounded).collect::<Vec<_>>()[..];
        info = Guide {
            length: guide.windows(2).map(|w| w[0].distance(w[1])).sum(),
            stiffness: if traits.stiffness.is_finite() { traits.stiffness.clamp(0.0, 1e3) } else { 1.0 },
            strands: traits.strands,
            flags: if traits.is_tip_pinned { TIP_PINNED } else { 0 },
            ..info
        };
        if options.shape == RestShape::SagFree {
            info.stiffness *= support(guide, &info, params, options.support);
        }
        for (i, shape) in shape(guide, &info, params, options.shape).into_iter().enumerate() {
            out.shape[i * count + g] = shape;
        }
        out.info.push(info);
    }
    Ok(out)
}

/// Returns the distances of `positions` from the surface of `field`, meters; none without a field.
pub(crate) fn distances(positions: &[Vec3], field: Option<&SdfGrid>) -> Vec<f32> {
    // Rounding to half floats and texels must not create contacts in the rest pose.
    field.map_or_else(Vec::new, |field| positions.iter().map(|p| field.sample(*p) - 2e-4).collect())
}

/// Returns the rest shape of one guide.
pub(crate) fn shape(p: &[Vec3], info: &Guide, params: &SimulationParams, mode: RestShape) -> Vec<GuideShape> {
    let n = p.len();
    let edge_of = |i: usize| p[i + 1] - p[i];
    let mut out: Vec<_> = (0..n)
        .map(|i| GuideShape {
            curvature: if i > 0 && i + 1 < n { edge_of(i) - edge_of(i - 1) } else { Vec3::ZERO },
            length: if i + 1 < n { edge_of(i).length() } else { 0.0 },
        })
        .collect();
    if mode == RestShape::SagFree {
        compensate(p, info, params, |i, s, shortened| {
            let length = edge_of(i).length();
            let limit = MAX_SHORTER * length;
            let s = s.clamp_length_max(MAX_COMPENSATION * length);
            let (give, shorter) = rounded_give(s, shortened.clamp(-limit, limit), length);
            out[i].curvature -= give;
            out[i].length -= shorter;
        });
    }
    out
}

/// Walks from tip to root and calls `each` with the deflections, in meters, of the bend and of the edge at a vertex
/// that carry the load below it.
fn compensate(p: &[Vec3], info: &Guide, params: &SimulationParams, mut each: impl FnMut(usize, Vec3, f32)) {
    let n = p.len();
    if n < 3 {
        return;
    }
    let edge = (info.length / (n - 1) as f32).max(1e-6);
    let stretch = params.stretch_rate(info.length, edge);
    let mut torque = Vec3::ZERO;
    for (i, load) in loads(n, info, params) {
        let (before, e) = (p[i] - p[i - 1], p[i + 1] - p[i]);
        let dir = e.normalize_or_zero();
        let force = load - torque.cross(e) / e.length_squared().max(1e-18);
        let tension = force.dot(dir);
        let rate = params.bending_rate(i, info.stiffness, edge, before, e);
        let deflection = (force - dir * tension) / rate.max(1e-9);
        each(i, deflection, tension / stretch);
        let s = deflection.clamp_length_max(MAX_COMPENSATION * e.length());
        // Torque that a bend and the twist from below exert on the edge before, as in the step.
        torque = dir * dir.dot(torque) - rate * (e - s).cross(s);
    }
}

/// Iterates over the edges from the last to the one after vertex 1, each as its first vertex and the weight that it
/// carries, m/s² per unit of vertex weight.
fn loads(n: usize, info: &Guide, params: &SimulationParams) -> impl Iterator<Item = (usize, Vec3)> {
    // A pinned tip takes half the weight: of the many equilibria, the symmetric one.
    let pinned = info.flags & TIP_PINNED != 0;
    let gravity = params.gravity;
    let mut load = if pinned { -gravity * (n - 3) as f32 * 0.5 } else { Vec3::ZERO };
    (1..n - 1).rev().map(move |i| {
        if !(pinned && i + 2 == n) {
            load += gravity * if i + 2 == n { 0.5 } else { 1.0 };
        }
        (i, load)
    })
}

/// Returns the factor by which a guide's stiffness must be raised to make its authored pose a stable equilibrium: 1 if
/// it is stable already, at most [`MAX_SUPPORT`] times `margin` ([`RestOptions::support`]).
///
/// Hair that stands out or up is stiff, or rests on other hair; a single guide has neither. The pose must meet two
/// conditions. First, no bend needs more compensation than [`EASY_COMPENSATION`], scaled by [`DEFAULT_SUPPORT`] over
/// `margin`. Raising the stiffness until the compensation is feasible is the condition of
/// sag-free rods (Hsu and others, 2022 and 2023). Second, the second variation of the energy, `∫ EI φ'² + (F·t) φ²`
/// with the weight `F` below and the tangent `t`, is positive with that margin; for an upright hair this is Greenhill's
/// condition on its height.
pub fn support(p: &[Vec3], info: &Guide, params: &SimulationParams, margin: f32) -> f32 {
    let n = p.len();
    if n < 3 || info.stiffness <= 0.0 || info.flags & TIP_PINNED != 0 {
        return 1.0;
    }
    let edge = info.length / (n - 1) as f32;
    let max_factor = MAX_SUPPORT * margin;
    let easy = EASY_COMPENSATION * DEFAULT_SUPPORT / margin;
    let mut factor = 1.0f32;
    for _ in 0..8 {
        let raised = Guide { stiffness: info.stiffness * factor, ..*info };
        let mut need = 0f32;
        compensate(p, &raised, params, |i, s, _| {
            let e = p[i].distance(p[i + 1]);
            // The direction of an edge of almost no length is meaningless.
            if e > 0.05 * edge {
                need = need.max(s.length() / (easy * e));
            }
        });
        if need <= 1.0 || factor >= max_factor {
            break;
        }
        factor = (factor * need.clamp(1.05, 4.0)).min(max_factor);
    }
    while factor < max_factor && !stands(p, info, params, factor / margin) {
        factor = (factor * 1.1).min(max_factor);
    }
    factor
}

/// Returns whether the second variation is positive for the guide made `factor` times as stiff.
fn stands(p: &[Vec3], info: &Guide, params: &SimulationParams, factor: f32) -> bool {
    let n = p.len();
    let edge = (info.length / (n - 1) as f32).max(1e-6);
    // A symmetric tridiagonal matrix over the edge directions, eliminated from the tip.
    let mut below = 0f32;
    for (i, load) in loads(n, info, params) {
        let (before, e) = (p[i] - p[i - 1], p[i + 1] - p[i]);
        let rate = params.bending_rate(i, info.stiffness * factor, edge, before, e);
        let bend = rate * e.length_squared();
        let pivot = bend + below + load.dot(e);
        if pivot <= 0.0 {
            return false;
        }
        // The part of this bend that remains for the edge above.
        below = bend - bend * bend / pivot;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_input_returns_errors() {
        let params = SimulationParams::default();
        let go = |positions: &[Vec3], n| {
            guides(positions, n, &[], &params, &RestOptions::default(), None).map_err(|e| e.to_string())
        };
        assert!(go(&[Vec3::ZERO; 5], 2).unwrap_err().contains("5 positions"));
        assert!(go(&[Vec3::ZERO; 130], 65).unwrap_err().contains("from 2 to 64"));
        assert!(go(&[Vec3::ZERO, Vec3::NAN], 2).unwrap_err().contains("vertex 1 of guide 0"));
        assert!(go(&[], 8).is_ok());
    }

    #[test]
    fn support_of_upright_hair_matches_greenhill() {
        let n = 32;
        let along = |v| super::super::RootToTip { root: v, tip: v, falloff: 1.0 };
        let margin = RestOptions::default().support;
        let params = SimulationParams { bending: along(8e-9), goal: along(0.0), ..Default::default() };
        let need = |length: f32, direction: Vec3| {
            let edge = length / (n - 2) as f32;
            let p: Vec<_> = (0..n).map(|i| direction * edge * (i as f32 - 1.0)).collect();
            let info =
                Guide { length: edge * (n - 1) as f32, stiffness: 1.0, strands: 1.0, ..Guide::default() };
            support(&p, &info, &params, margin)
        };
        for length in [0.05f32, 0.15, 0.2] {
            let gamma = params.line_density * 9.81 * length.powi(3) / 8e-9;
            let exact = (margin * gamma / 7.837_35).max(1.0);
            // The factor is found in steps of a tenth.
            let found = need(length, Vec3::Y);
            assert!(found >= exact * 0.97 && found < exact * 1.13, "{length}: {found}, {exact}");
        }
        assert_eq!(need(0.5, Vec3::NEG_Y), 1.0, "hair that hangs needs no support");
        assert!(need(0.3, Vec3::X) > 1.0);
    }

    #[test]
    fn vertex_in_skin_keeps_its_depth() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - 0.1);
        let positions = [Vec3::Y * 0.095, Vec3::Y * 0.15];
        let options = RestOptions::default();
        let out = guides(&positions, 2, &[], &SimulationParams::default(), &options, Some(&grid)).unwrap();
        assert!((out.rest[0].contact + 0.0052).abs() < 5e-4);
        // Rounded down to a half float.
        let kept = out.rest[1].contact / options.clearance;
        assert!(kept <= 1.0 && kept > 0.999, "{kept}");
    }
}
