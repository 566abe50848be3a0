//! Whole grooms: hair at rest stays at rest, and hair returns after a shake.

use super::{
    lab::{Experiment, Lab, lab, length},
    table::{Row, at_most, judge},
};
use crate::{
    common,
    moving::{SHAKE, angle},
};
use tresses::{
    Pose, RestShape, SimulationParams, drape,
    glam::{Quat, Vec3},
    groom::{
        BindOptions, GuideCount, SdfGrid, bind,
        import::{self, ImportOptions},
        mannequin,
        styles::{GUIDE_VERTICES, Style},
    },
    simulate::GuideTraits,
};

/// Guides on a head.
pub struct Subject {
    pub name: String,
    pub strands: Vec<Vec<Vec3>>,
    pub traits: Vec<GuideTraits>,
    pub field: SdfGrid,
    pub neck: Vec3,
}

/// Returns a draped built-in style.
pub fn style(lab: &Lab, name: &str) -> Subject {
    let context = lab.context;
    let style = name.parse::<Style>().unwrap();
    let (styled, scalp) = pollster::block_on(drape::settled(context, &style, &())).unwrap();
    let traits = styled.stiffness.iter().map(|&stiffness| GuideTraits { stiffness, ..Default::default() });
    Subject {
        name: name.into(),
        strands: styled.guides.positions.chunks(GUIDE_VERTICES).map(<[Vec3]>::to_vec).collect(),
        traits: traits.collect(),
        field: scalp.field,
        neck: mannequin::NECK_JOINT,
    }
}

/// Returns one in 16 strands of Sintel's hair, if the files exist.
pub fn sintel() -> Option<Subject> {
    let (strands, _, field) = common::sintel()?;
    let options =
        BindOptions { guides: GuideCount::OneIn(16), guide_vertex_count: Some(16), ..Default::default() };
    let groom = bind(strands, &options).unwrap();
    let guides = &groom.guides;
    Some(Subject {
        name: "Sintel".into(),
        strands: (0..guides.len()).map(|i| guides.guide(i).to_vec()).collect(),
        traits: (0..guides.len())
            .map(|i| GuideTraits { stiffness: guides.stiffness[i], ..Default::default() })
            .collect(),
        field: field.clone(),
        neck: Vec3::ZERO,
    })
}

impl Subject {
    pub fn experiment(&self, lab: &'static Lab) -> Experiment {
        let params = SimulationParams::default();
        Experiment::new(lab, &self.strands, &self.traits, params, RestShape::SagFree, Some(&self.field))
    }
}

/// Returns the distance of each tip from its rest position, relative to the length of its strand, in ascending order.
fn away(e: &Experiment, head: &Pose) -> Vec<f32> {
    let mut away: Vec<f32> = e
        .positions()
        .iter()
        .zip(&e.rest_positions())
        .map(|(now, rest)| {
            now[e.vertex_count - 1].distance(head.point(rest[e.vertex_count - 1])) / length(rest)
        })
        .collect();
    away.sort_by(f32::total_cmp);
    away
}

fn report(what: &str, away: &[f32]) {
    let n = away.len();
    let at = |q: f32| away[((n - 1) as f32 * q) as usize] * 100.0;
    let over = |x: f32| away.iter().filter(|a| **a > x).count();
    println!(
        "{what}: mean {:.2} % median {:.2} p90 {:.2} p99 {:.2} max {:.2}; over 1 %: {} over 5 %: {} of {n}",
        away.iter().sum::<f32>() / n as f32 * 100.0,
        at(0.5),
        at(0.9),
        at(0.99),
        at(1.0),
        over(0.01),
        over(0.05)
    );
}

fn rest(lab: &'static Lab, subjects: impl IntoIterator<Item = Subject>, fault: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    for s in subjects {
        let mut e = s.experiment(lab);
        if fault {
            // Twice the gravity for which the rest shape was computed.
            e.params.gravity *= 2.0;
        }
        e.run_still(if fault { 60 } else { 600 });
        let drift = away(&e, &Pose::IDENTITY);
        let case = format!("{}, at rest for 10 s, largest drift of a tip", s.name);
        rows.push(at_most(case, UNIT, 1.0, drift[drift.len() - 1] * 100.0));
    }
    rows
}

#[test]
#[ignore = "proof"]
fn print_drift_after_a_shake() {
    let Some(lab) = lab() else { return };
    for s in Style::NAMES.map(|name| Some(style(lab, name))).into_iter().chain([sintel()]).flatten() {
        let mut e = s.experiment(lab);
        let factor = |g: usize| e.rest.info[g].stiffness / s.traits[g].stiffness;
        let raised: Vec<f32> = (0..s.strands.len()).map(factor).filter(|f| *f > 1.0).collect();
        let most = raised.iter().copied().fold(1.0, f32::max);
        println!(
            "{}: {} of {} guides made stiffer, {most:.2} times at most",
            s.name,
            raised.len(),
            s.strands.len()
        );
        e.run_motion(3.3, |t| Pose::about(s.neck, Quat::from_rotation_y(angle(SHAKE, t))));
        report(&format!("{}, 2 s after it was shaken", s.name), &away(&e, &Pose::IDENTITY));
    }
}

#[test]
#[ignore = "proof"]
fn print_drift_of_other_grooms() {
    let Some(lab) = lab() else { return };
    for file in ["cyhair_straight/straight.hair", "tressfx4_ratboy/Ratboy_mohawk.tfx"] {
        let Some(path) = common::asset(file) else { continue };
        let (strands, _) = import::read(&[path], &ImportOptions::default()).unwrap();
        let options = BindOptions {
            guides: GuideCount::Count(600),
            guide_vertex_count: Some(16),
            ..Default::default()
        };
        let groom = bind(&strands, &options).unwrap();
        let strands: Vec<_> = (0..groom.guides.len()).map(|i| groom.guides.guide(i).to_vec()).collect();
        let params = SimulationParams::default();
        let mut e = Experiment::new(lab, &strands, &[], params, RestShape::SagFree, None);
        e.run_still(600);
        report(&format!("{file}, at rest for 10 s"), &away(&e, &Pose::IDENTITY));
    }
}

const UNIT: &str = "% of its length";

#[test]
#[ignore = "proof"]
fn all_grooms_at_rest_do_not_drift() {
    judge("rest", |lab, fault| match fault {
        true => rest(lab, [style(lab, "bob")], true),
        false => rest(lab, Style::NAMES.map(|name| style(lab, name)).into_iter().chain(sintel()), false),
    });
}
