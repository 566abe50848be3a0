//! From guide polylines to the step's inputs: rest positions, contact clearances and the rest shape, with
//! or without compensation of gravity.
//!
//! A groom is authored as it should look under gravity. Taken as the shape without gravity, it sags in the
//! first second. [`RestShape::SagFree`] walks from tip to root: the edge below a vertex must carry the
//! weight of everything below it. The component along the edge goes into the edge's rest length, the
//! component across it into the bend at its upper end, whose rest value is moved until the bending spring
//! gives exactly that force. The pose is then an equilibrium of the discrete equations that the step
//! solves, not only of the continuous ones.
//!
//! An equilibrium need not be stable. A floppy strand that is authored to stick out needs a rest shape
//! wound up like a watch spring, and collapses at the first touch. Real hair that stands out is stiff or
//! leans on other hair; [`support`] therefore raises the stiffness of those guides, and of no others, until
//! their poses are stable. The compensation of one bend is still limited to [`MOST_COMPENSATION`] of the
//! edge; the remainder shows as sag, less what the goal spring holds. Contact forces at rest are not
//! compensated: a pose that was supported by the head hovers over it. Untried: the second variation with
//! the torques of bends, which couple the two directions across the strand, and a factor for each vertex
//! instead of one for the guide.

use super::params::SimulationParams;
use crate::{
    Error, Result,
    groom::SdfGrid,
    strands::{
        Guide, GuideRest, GuideShape, PackedGuide, RestGuides,
        guide::{MOST_GIVE, MOST_SHORTER, TIP_PINNED, rounded_give},
    },
};
use glam::Vec3;

/// The largest compensation of one bend, as a fraction of the edge.
pub const MOST_COMPENSATION: f32 = MOST_GIVE;

/// The compensation up to which a bend comes back by itself when hair is shaken.
pub const EASY_COMPENSATION: f32 = 0.35;

/// The margin of [`SimulationParams::support`] for which bends come back by themselves up to [`EASY_COMPENSATION`].
pub const USUAL_SUPPORT: f32 = 2.0;

/// By how much the stiffness of a guide is raised at most, times [`SimulationParams::support`], see [`support`].
pub const MOST_SUPPORT: f32 = 10.0;

/// What the authored pose means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RestShape {
    /// The shape of the hair without gravity: it will sag. For draping.
    Natural,
    /// The shape of the hair under gravity with the head upright: it stays.
    #[default]
    SagFree,
}

/// What is known of one guide besides its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideTraits {
    /// Multiplier of the stiffness parameters.
    pub stiffness: f32,
    /// How many drawn strands it stands for.
    pub strands: f32,
    /// Whether the tip follows the head as the root does.
    pub tip_pinned: bool,
}

impl Default for GuideTraits {
    fn default() -> Self {
        Self { stiffness: 1.0, strands: 1.0, tip_pinned: false }
    }
}

/// How guides rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestOptions {
    /// What the authored pose means.
    pub shape: RestShape,
    /// Distance that hair keeps from the colliders, metres, where it has it at rest.
    pub clearance: f32,
}

impl Default for RestOptions {
    fn default() -> Self {
        Self { shape: RestShape::SagFree, clearance: 1e-3 }
    }
}

/// Guides from `positions` (groom space, metres; guide `g` has `g * n..(g + 1) * n`, root first,
/// equal arc lengths, see [`crate::groom::curve::resample`]). `traits` has one entry per guide, or none
/// for the default. `field` gives the clearance that each vertex has at rest.
///
/// # Errors
/// [`Error::Groom`] when counts do not fit or a position is not finite, and what
/// [`SimulationParams::check`] says.
pub fn guides(
    positions: &[Vec3],
    n: u32,
    traits: &[GuideTraits],
    params: &SimulationParams,
    options: &RestOptions,
    field: Option<&SdfGrid>,
) -> Result<RestGuides> {
    params.check()?;
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
            "{} positions and {} traits do not make guides of {n} vertices",
            positions.len(),
            traits.len()
        )));
    }
    if let Some(at) = positions.iter().position(|p| !(p.is_finite() && p.abs().max_element() < 1e3)) {
        return Err(Error::unusable(format!(
            "vertex {} of guide {} is at {}, which is not within a kilometre of the head",
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
        // All that follows is computed from the pose as the GPU has it: micrometres from the authored one, and at rest.
        let rounded = |(i, p): (usize, &Vec3)| {
            // Rounding to half floats and to texels must not make a contact of the rest pose.
            let has = field.map_or(f32::MAX, |field| field.sample(*p) - 2e-4);
            let rest = GuideRest { position: *p, contact: options.clearance.min(has) };
            let rest = PackedGuide::pack(&rest, Vec3::ZERO, 0.0, 1.0, &info).rest(&info);
            out.rest[i * count + g] = rest;
            rest.position
        };
        let guide = &guide.iter().enumerate().map(rounded).collect::<Vec<_>>()[..];
        info = Guide {
            length: guide.windows(2).map(|w| w[0].distance(w[1])).sum(),
            stiffness: if traits.stiffness.is_finite() { traits.stiffness.clamp(0.0, 1e3) } else { 1.0 },
            strands: traits.strands,
            flags: if traits.tip_pinned { TIP_PINNED } else { 0 },
            ..info
        };
        if options.shape == RestShape::SagFree {
            info.stiffness *= support(guide, &info, params);
        }
        for (i, shape) in shape(guide, &info, params, options.shape).into_iter().enumerate() {
            out.shape[i * count + g] = shape;
        }
        out.info.push(info);
    }
    Ok(out)
}

/// The rest shape of one guide.
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
            let most = edge_of(i).length();
            let limit = MOST_SHORTER * most;
            let s = s.clamp_length_max(MOST_COMPENSATION * most);
            let (give, shorter) = rounded_give(s, shortened.clamp(-limit, limit), most);
            out[i].curvature -= give;
            out[i].length -= shorter;
        });
    }
    out
}

/// Walks from tip to root and calls `each` with what the bend and the edge at a vertex must give way
/// to carry all that hangs from it, metres.
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
        let whole = (force - dir * tension) / rate.max(1e-9);
        each(i, whole, tension / stretch);
        let s = whole.clamp_length_max(MOST_COMPENSATION * e.length());
        // What a bend and the twist from below give to the edge before, as in the step.
        torque = dir * dir.dot(torque) - rate * (e - s).cross(s);
    }
}

/// The edges from the last to that after vertex 1, by the vertex before them, and the weight that each
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

/// By how much the stiffness of a guide must be raised for its authored pose to be an equilibrium
/// that stays: 1 where the parameters do, [`MOST_SUPPORT`] times [`SimulationParams::support`] at most.
///
/// Hair that stands out or up is stiff, or rests on other hair; a guide alone has neither. Two things
/// are asked of the pose. No bend needs more compensation than [`EASY_COMPENSATION`], or less than that by as much as the
/// margin is above [`USUAL_SUPPORT`] (that it is feasible, or the stiffness must be raised, is the condition of sag-free
/// rods, Hsu and others, 2022 and 2023).
/// And the second variation of the energy, `∫ EI φ'² + (F·t) φ²` with the weight `F` below and the tangent
/// `t`, is positive with [`SimulationParams::support`] as a margin: for an upright hair, Greenhill's condition on its height.
pub fn support(p: &[Vec3], info: &Guide, params: &SimulationParams) -> f32 {
    let n = p.len();
    if n < 3 || info.stiffness <= 0.0 || info.flags & TIP_PINNED != 0 {
        return 1.0;
    }
    let edge = info.length / (n - 1) as f32;
    let most = MOST_SUPPORT * params.support;
    let easy = EASY_COMPENSATION * USUAL_SUPPORT / params.support;
    let mut factor = 1.0f32;
    for _ in 0..8 {
        let raised = Guide { stiffness: info.stiffness * factor, ..*info };
        let mut need = 0f32;
        compensate(p, &raised, params, |i, s, _| {
            let e = p[i].distance(p[i + 1]);
            // The direction of an edge of almost no length means nothing.
            if e > 0.05 * edge {
                need = need.max(s.length() / (easy * e));
            }
        });
        if need <= 1.0 || factor >= most {
            break;
        }
        factor = (factor * need.clamp(1.05, 4.0)).min(most);
    }
    while factor < most && !stands(p, info, params, factor) {
        factor = (factor * 1.1).min(most);
    }
    factor
}

/// Whether the second variation is positive for the guide made `factor` times as stiff.
fn stands(p: &[Vec3], info: &Guide, params: &SimulationParams, factor: f32) -> bool {
    let n = p.len();
    let edge = (info.length / (n - 1) as f32).max(1e-6);
    // A symmetric tridiagonal matrix over the directions of the edges, eliminated from the tip.
    let mut below = 0f32;
    for (i, load) in loads(n, info, params) {
        let (before, e) = (p[i] - p[i - 1], p[i + 1] - p[i]);
        let rate = params.bending_rate(i, info.stiffness * factor / params.support, edge, before, e);
        let bend = rate * e.length_squared();
        let pivot = bend + below + load.dot(e);
        if pivot <= 0.0 {
            return false;
        }
        // What remains of this bend for the edge above.
        below = bend - bend * bend / pivot;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_input_is_refused_in_a_sentence() {
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
    fn upright_hair_is_made_as_stiff_as_greenhill_says() {
        let n = 32;
        let along = |v| super::super::Along { root: v, tip: v, falloff: 1.0 };
        let params = SimulationParams { bending: along(8e-9), goal: along(0.0), ..Default::default() };
        let need = |length: f32, direction: Vec3| {
            let edge = length / (n - 2) as f32;
            let p: Vec<_> = (0..n).map(|i| direction * edge * (i as f32 - 1.0)).collect();
            let info =
                Guide { length: edge * (n - 1) as f32, stiffness: 1.0, strands: 1.0, ..Guide::default() };
            support(&p, &info, &params)
        };
        for length in [0.05f32, 0.15, 0.2] {
            let gamma = params.line_density * 9.81 * length.powi(3) / 8e-9;
            let exact = (params.support * gamma / 7.837_35).max(1.0);
            // The factor is found in steps of a tenth.
            let found = need(length, Vec3::Y);
            assert!(found >= exact * 0.97 && found < exact * 1.13, "{length}: {found}, {exact}");
        }
        assert_eq!(need(0.5, Vec3::NEG_Y), 1.0, "hair that hangs needs no support");
        assert!(need(0.3, Vec3::X) > 1.0);
    }

    #[test]
    fn a_vertex_in_the_skin_keeps_what_it_has() {
        let grid = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 33, |p| p.length() - 0.1);
        let positions = [Vec3::Y * 0.095, Vec3::Y * 0.15];
        let options = RestOptions::default();
        let out = guides(&positions, 2, &[], &SimulationParams::default(), &options, Some(&grid)).unwrap();
        assert!((out.rest[0].contact + 0.0052).abs() < 5e-4);
        // A half float, rounded down.
        let kept = out.rest[1].contact / options.clearance;
        assert!(kept <= 1.0 && kept > 0.999, "{kept}");
    }
}
