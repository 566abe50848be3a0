//! Shapes at rest and in steady motion: catenary, heavy cantilever, buckling, wind, falling.

use super::{
    lab::{Experiment, Lab, bare, head_at, straight, strain},
    table::{Row, at_most, judge, near},
};
use tresses::{RestShape, SimulationParams, Wind, glam::Vec3, simulate::GuideTraits};

const G: f32 = 9.81;

fn catenary(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, span) = (32, 0.2f32);
    let cases = [(1.2f32, 0.292_344, 51.954), (1.5, 0.502_633, 67.658), (2.0, 0.796_388, 77.067)];
    // Two straight halves that meet below the middle.
    let strands: Vec<Vec<Vec3>> = cases
        .iter()
        .map(|(ratio, ..)| {
            let half = 0.5 * span * ratio * if fault { 1.03 } else { 1.0 };
            let middle = Vec3::new(0.5 * span, -(half * half - 0.25 * span * span).sqrt(), 0.0);
            let edges = (n - 2) as f32;
            let at = |i: usize| {
                let s = (i as f32 - 1.0) / edges;
                if s <= 0.5 { middle * 2.0 * s } else { middle.lerp(Vec3::X * span, 2.0 * s - 1.0) }
            };
            std::iter::once(Vec3::Y * 2.0 * half / edges).chain((1..n).map(at)).collect()
        })
        .collect();
    let traits = [GuideTraits { is_tip_pinned: true, ..Default::default() }; 3];
    let params = SimulationParams { drag: 4.0, ..bare(0.0) };
    let mut e = Experiment::new(lab, &strands, &traits, params, RestShape::Natural, None);
    e.run_still(600);
    let mut rows = Vec::new();
    for ((ratio, sag, slope), strand) in cases.into_iter().zip(e.positions()) {
        let tan = |i: usize| (strand[i].y - strand[i + 1].y) / (strand[i + 1].x - strand[i].x);
        // Tangents are at the middles of the edges, and change linearly along the strand.
        let end = (1.5 * tan(1) - 0.5 * tan(2)).atan().to_degrees();
        let case = |what| format!("catenary, length {ratio} spans, {what}");
        rows.push(near(case("sag / span"), "", sag, -strand[n / 2].y / span, 0.01));
        rows.push(near(case("slope at its ends"), "°", slope, end, 0.005));
    }
    rows
}

#[test]
pub fn catenaries_match_the_closed_form() {
    judge("catenary", catenary);
}

fn cantilever(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let length = 0.1f32;
    // Drop and reach of the tip over the length for Γ = ρA g L³ / EI, from a boundary value problem solved to 1e-8.
    let cases = [(1.0f32, 0.123_471, 0.991_246), (10.0, 0.700_2, 0.656_354), (50.0, 0.907_917, 0.245_015)];
    let mut params = SimulationParams { drag: 4.0, ..bare(1.0) };
    let gamma = params.line_density * G * length.powi(3);
    params = SimulationParams { drag: 4.0, ..bare(gamma * if fault { 0.5 } else { 1.0 }) };
    let traits = cases.map(|(g, ..)| GuideTraits { stiffness: 1.0 / g, ..Default::default() });
    let mut rows = Vec::new();
    for n in [16, 32] {
        let strands = vec![straight(n, length, Vec3::X); 3];
        let mut e = Experiment::new(lab, &strands, &traits, params, RestShape::Natural, None);
        e.run_still(900);
        for ((g, drop, reach), strand) in cases.into_iter().zip(e.positions()) {
            let case = |what| format!("heavy cantilever, Γ = {g}, {n} vertices, {what} / length");
            let tip = strand[n - 1] / length;
            rows.push(near(case("drop"), "", drop, -tip.y, 0.02));
            if g > 1.0 {
                rows.push(near(case("reach"), "", reach, tip.x, 0.05));
            }
        }
    }
    rows
}

#[test]
pub fn heavy_cantilevers_match_the_exact_solution() {
    judge("cantilever", cantilever);
}

fn buckling(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, length) = (16, 0.1f32);
    let gammas: Vec<f32> = (0..17).map(|i| 7.0 + 0.1 * i as f32).collect();
    let gravity = Vec3::NEG_Y * G * if fault { 1.05 } else { 1.0 };
    let ei = SimulationParams::default().line_density * G * length.powi(3);
    let params = SimulationParams { drag: 30.0, gravity, ..bare(ei) };
    let traits: Vec<_> =
        gammas.iter().map(|g| GuideTraits { stiffness: 1.0 / g, ..Default::default() }).collect();
    let strands = vec![straight(n, length, Vec3::Y); gammas.len()];
    let mut e = Experiment::new(lab, &strands, &traits, params, RestShape::Natural, None);
    let mut start = e.rest_positions();
    for strand in &mut start {
        for p in &mut strand[2..] {
            let s = p.y / length;
            p.x = 1e-3 * s * s * (3.0 - s);
        }
    }
    e.set_positions(&start);
    e.run_still(60);
    let before = e.positions();
    e.run_still(60);
    let after = e.positions();
    // The lean decays below the critical load and grows above it.
    let growth: Vec<f32> = before.iter().zip(&after).map(|(b, a)| (a[n - 1].x / b[n - 1].x).ln()).collect();
    let i = growth.iter().position(|g| *g > 0.0).expect("some fall");
    assert!(i > 0, "none stands");
    let t = growth[i - 1] / (growth[i - 1] - growth[i]);
    let critical = gammas[i - 1] + t * (gammas[i] - gammas[i - 1]);
    vec![near("self-buckling of an upright hair, critical Γ", "", 7.837_35, critical, 0.02)]
}

#[test]
pub fn upright_hair_buckles_at_the_critical_load() {
    judge("buckling", buckling);
}

fn wind(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, length, drag) = (16, 0.2f32, 4.0);
    let mut rows = Vec::new();
    for tangent in [0.25f32, 1.0, 2.0] {
        let wind = Vec3::X * tangent * G / drag;
        let params = SimulationParams {
            drag,
            wind: Wind::uniform(wind * if fault { 1.05 } else { 1.0 }),
            ..bare(0.0)
        };
        let strand = straight(n, length, Vec3::NEG_Y);
        let mut e = Experiment::new(lab, &[strand], &[], params, RestShape::Natural, None);
        e.run_still(900);
        let tip = e.positions()[0][n - 1];
        let found = (tip.x / -tip.y).atan().to_degrees();
        let case = format!("floppy strand in wind of {:.2} m/s, drag {drag} 1/s, angle", wind.x);
        rows.push(near(case, "°", f64::from(tangent.atan().to_degrees()), found, 0.005));
    }
    // At terminal velocity drag carries the weight, so nothing pulls a strand out of the horizontal.
    let terminal = G / 30.0;
    let params = SimulationParams {
        drag: 30.0,
        gravity: Vec3::NEG_Y * G * if fault { 1.05 } else { 1.0 },
        ..bare(0.0)
    };
    let strand = straight(n, length, Vec3::X);
    let mut e = Experiment::new(lab, &[strand], &[], params, RestShape::Natural, None);
    e.set_velocities(&[vec![Vec3::NEG_Y * terminal; n]]);
    let way = |t: f32| head_at(Vec3::NEG_Y * terminal * t);
    e.run_motion(2.0, way);
    let sag = (e.positions()[0][n - 1] - way(2.0).translation).y / length;
    rows.push(at_most(
        "horizontal floppy strand sinking at g / drag, tip after 2 s",
        "% of its length",
        0.5,
        sag * 100.0,
    ));
    rows
}

#[test]
fn wind_tilts_strands_by_its_drag() {
    judge("wind", wind);
}

fn free_fall(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (n, length) = (16, 0.2f32);
    let arc = (0..n).map(|i| {
        let a = 2.0 * (i as f32 - 1.0) / (n - 1) as f32;
        Vec3::new(0.1 * a.sin(), 0.1 * (1.0 - a.cos()), 0.02 * a)
    });
    let strands = [straight(n, length, Vec3::X), straight(n, length, Vec3::Y), arc.collect()];
    let params = SimulationParams { step: 1.0 / 240.0, substep_count: 1, ..bare(8e-9) };
    let mut e = Experiment::new(lab, &strands, &[], params, RestShape::Natural, None);
    // The head's mean velocity over a step is its velocity in the middle of the step.
    e.set_velocities(&vec![vec![Vec3::Y * G * 0.5 * params.step; n]; 3]);
    let g = G * if fault { 0.95 } else { 1.0 };
    // From a meter above the origin to a meter below, because positions are rounded in world coordinates.
    let way = |t: f32| head_at(Vec3::Y * (1.0 - 0.5 * g * t * t));
    let seconds = 0.625;
    let start = e.rest_positions();
    e.set_positions(
        &start.iter().map(|s| s.iter().map(|p| way(0.0).point(*p)).collect()).collect::<Vec<_>>(),
    );
    e.run_motion(seconds, way);
    let (now, rest) = (e.positions(), e.rest_positions());
    let head = way(seconds).translation;
    let shape =
        now.iter().zip(&rest).flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| (*a - head).distance(*b));
    let off = shape.fold(0.0, f32::max) / length;
    // The weight of a strand that hangs from its root would stretch it by this much.
    let tension = strain(&now[1..2], &rest[1..2]) / params.stretch;
    vec![
        at_most(
            "hair on a head in free fall, change of shape after 2 m",
            "% of its length",
            1.0,
            off * 100.0,
        ),
        at_most("the same, tension against that of a hair that hangs", "%", 3.0, tension * 100.0),
    ]
}

#[test]
fn hair_on_a_falling_head_has_no_weight() {
    judge("free fall", free_fall);
}
