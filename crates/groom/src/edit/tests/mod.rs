//! Tools on four grooms, closed forms, versions, and files.

mod files;
mod forms;
mod paint;
mod roots;
mod tools;

use super::*;
use crate::{
    BindOptions, Groom, GuideCount, SdfGrid, Strands, bind, grow,
    random::Rng,
    styles::{self, Style, tests::head},
};
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Radius of the synthetic head around the origin, meters.
const BALL: f32 = 0.1;

/// A groom with the head that it grows on.
struct Fixture {
    name: &'static str,
    document: GroomDocument,
    field: Arc<SdfGrid>,
    /// Center of the head, meters.
    center: Vec3,
}

impl Fixture {
    fn editor(&self) -> GroomEditor {
        GroomEditor::new(self.document.clone(), Some(self.field.clone()))
    }

    /// Returns a stroke over the left side of the head, seen from there.
    fn side_stroke(&self) -> Vec<StrokeSample> {
        let eye = self.center + Vec3::new(0.6, 0.05, 0.1);
        let to = |k: f32| self.center + Vec3::new(0.1, 0.06 - 0.1 * k, 0.03 - 0.03 * k) - eye;
        let sample =
            |k: usize| StrokeSample { time: k as f32 / 60.0, ..StrokeSample::ray(eye, to(k as f32 / 20.0)) };
        (0..=20).map(sample).collect()
    }
}

fn ball_field() -> Arc<SdfGrid> {
    static FIELD: OnceLock<Arc<SdfGrid>> = OnceLock::new();
    let build = || SdfGrid::from_fn(Vec3::splat(-0.25), Vec3::splat(0.25), 64, |p| p.length() - BALL);
    FIELD.get_or_init(|| Arc::new(build())).clone()
}

/// Hair that leaves the upper half of the ball and falls along it, with its mirror image.
fn falling(count: usize) -> Strands {
    let mut rng = Rng::new(3, 0);
    let mut strands = Strands::default();
    for _ in 0..count / 2 {
        let (y, x) = (rng.range(0.1, 0.9), rng.range(0.05, 0.9));
        let z = (1.0 - y * y).sqrt() * rng.range(-0.9, 0.9);
        let mut p = BALL * Vec3::new(x, y, z).normalize();
        let mut way = p.normalize();
        let mut points = vec![p];
        for _ in 0..20 {
            way = (way + 0.45 * Vec3::NEG_Y + 0.02 * rng.bell3()).normalize();
            p += 0.009 * way;
            p *= (BALL + 4e-3).max(p.length()) / p.length();
            points.push(p);
        }
        strands.push(&points);
        let mirrored: Vec<_> = points.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
        strands.push(&mirrored);
    }
    strands
}

fn on_ball(name: &'static str, guides: GuideCount) -> Fixture {
    let groom = bind(&falling(400), &BindOptions { guides, ..Default::default() }).unwrap();
    let document = GroomDocument::new(groom, HeadFiles::None, 0.0).unwrap();
    Fixture { name, document, field: ball_field(), center: Vec3::ZERO }
}

fn styled(name: &'static str) -> Fixture {
    let (style, scalp) = (name.parse::<Style>().unwrap(), head());
    let styled = styles::guides(&style, scalp);
    let growth = grow::Growth::for_style(&style).with_strands(600);
    let groom: Groom = grow::grow(&styled, &growth, scalp).unwrap().bind(&styled);
    let document = GroomDocument::new(groom, HeadFiles::BuiltIn, 0.0).unwrap();
    let field = Arc::new(scalp.field.clone());
    Fixture { name, document, field, center: crate::mannequin::SKULL_CENTER }
}

/// The four grooms.
fn fixtures() -> &'static [Fixture] {
    static ALL: OnceLock<Vec<Fixture>> = OnceLock::new();
    ALL.get_or_init(|| {
        let few = GuideCount::OneIn(8);
        vec![
            styled("long"),
            styled("bob"),
            on_ball("few guides", few),
            on_ball("all guides", GuideCount::All),
        ]
    })
}

/// Applies one stroke. Returns the version after it, if it changes anything.
fn stroke(editor: &mut GroomEditor, brush: &Brush, samples: &[StrokeSample]) -> Option<GroomDocument> {
    let (first, others) = samples.split_first()?;
    if editor.press(brush, first).unwrap() {
        others.iter().for_each(|sample| editor.drag(sample).unwrap());
    }
    editor.release()
}

/// Returns the largest distance between corresponding vertices, meters.
fn apart(a: &GroomDocument, b: &GroomDocument) -> f32 {
    let pairs = a.guides().positions().into_iter().zip(b.guides().positions());
    pairs.map(|(a, b)| a.distance(b)).fold(0.0, f32::max)
}
