//! Brushes on moving hair.

use super::*;
use tresses::low_level::{BrushEffect, MotionBrush};

/// A ray to the hair beside the head.
const BESIDE: Ray = Ray { origin: Vec3::new(0.092, -0.08, 1.0), direction: Vec3::NEG_Z };
const BRUSH: MotionBrush =
    MotionBrush { effect: BrushEffect::Comb, radius: 0.04, strength: 1.0, root_tip: 0.0, mirror: None };

impl Setup {
    /// Moves `brush` from `ray` by `way` within `seconds`. Returns the guides before and after.
    fn swept(&self, brush: &MotionBrush, ray: &Ray, way: Vec3, (fps, seconds): (f32, f32)) -> [Vec<Vec3>; 2] {
        let mut hair = self.hair();
        let before = self.guides(&hair);
        let frames = (seconds * fps).round() as u32;
        for i in 0..=frames {
            let origin = ray.origin + way * (i as f32 / frames as f32);
            hair.brush(brush, &Ray { origin, ..*ray }).unwrap();
            self.advance(&mut hair, Pose::IDENTITY, 1.0 / fps);
        }
        [before, self.guides(&hair)]
    }

    /// Returns the mean of `value` before and after, over the free vertices with `is_near` before.
    fn means(
        &self,
        [before, after]: &[Vec<Vec3>; 2],
        is_near: impl Fn(Vec3) -> bool,
        value: impl Fn(Vec3) -> f32,
    ) -> [f32; 2] {
        let free = 2 * self.character.groom.guides.len()..before.len();
        let near: Vec<usize> = free.filter(|i| is_near(before[*i])).collect();
        assert!(near.len() > 5, "{} vertices are near", near.len());
        [before, after].map(|all| near.iter().map(|i| value(all[*i])).sum::<f32>() / near.len() as f32)
    }
}

fn is_under(ray: &Ray, radius: f32) -> impl Fn(Vec3) -> bool + use<> {
    let ray = *ray;
    move |p: Vec3| p.z > 0.0 && (p - ray.origin).reject_from_normalized(ray.direction).length() < radius
}

#[test]
fn comb_drags_the_hair_under_it_and_no_other() {
    let Some(stage) = Setup::new() else { return };
    let way = Vec3::new(-0.05, 0.0, 0.0);
    let swept = stage.swept(&BRUSH, &BESIDE, way, (60.0, 0.25));
    let [before, after] = stage.means(&swept, is_under(&BESIDE, 0.02), |p| p.x);
    println!("the hair moves by {:.1} mm", 1e3 * (after - before));
    assert!((1.1 * way.x..0.3 * way.x).contains(&(after - before)), "{}", after - before);
    let (strain, depth) = (stage.strain(&swept[1]), stage.depth(&swept[1]));
    println!("strain {:.2} %, {:.2} mm deep", 1e2 * strain, 1e3 * depth);
    assert!(strain < 0.01 && depth < 1e-3, "{strain} {depth}");
    let mut control = stage.hair();
    stage.still(&mut control, 16);
    let control = stage.guides(&control);
    let count = stage.character.groom.guides.len();
    for guide in 0..count {
        let vertices = || (0..control.len() / count).map(|j| j * count + guide);
        let is_far = vertices().all(|i| swept[0][i].x < -0.02 || swept[0][i].z < -0.06);
        let moved = vertices().fold(0.0f32, |most, i| most.max(control[i].distance(swept[1][i])));
        assert!(!is_far || moved == 0.0, "guide {guide} moved by {moved}");
    }
}

#[test]
fn effects_move_hair_as_they_say() {
    let Some(stage) = Setup::new() else { return };
    let near = |ray: &Ray| is_under(ray, 0.025);
    let change = |effect, ray: &Ray, value: &dyn Fn(Vec3) -> f32| {
        let brush = MotionBrush { effect, ..BRUSH };
        let swept = stage.swept(&brush, ray, Vec3::ZERO, (60.0, 0.3));
        let (strain, depth) = (stage.strain(&swept[1]), stage.depth(&swept[1]));
        assert!(strain < 0.01 && depth < 1e-3, "{effect:?}: {strain} {depth}");
        let [before, after] = stage.means(&swept, near(ray), value);
        println!("{effect:?}: {:+.1} mm", 1e3 * (after - before));
        after - before
    };
    let height = |p: Vec3| p.length();
    let aside = |p: Vec3| (p - BESIDE.origin).reject_from_normalized(BESIDE.direction).length();
    let depth = |p: Vec3| p.z;
    assert!(change(BrushEffect::Puff, &FRONT, &height) > 3e-3);
    assert!(change(BrushEffect::Lay, &FRONT, &height) < 1e-3);
    assert!(change(BrushEffect::Pinch, &BESIDE, &aside) < -1e-3);
    assert!(change(BrushEffect::Spread, &BESIDE, &aside) > 1e-3);
    assert!(change(BrushEffect::Blow, &BESIDE, &depth) < -5e-3);
    assert!(change(BrushEffect::Draw, &BESIDE, &depth) > 5e-3);
}

#[test]
fn mirrored_brush_acts_on_both_sides() {
    let Some(stage) = Setup::new() else { return };
    let brush = MotionBrush { mirror: Some((Vec3::ZERO, Vec3::X)), ..BRUSH };
    let other = Ray { origin: BESIDE.origin * Vec3::new(-1.0, 1.0, 1.0), ..BESIDE };
    let way = Vec3::NEG_X * 0.03;
    let swept = stage.swept(&brush, &BESIDE, way, (60.0, 0.2));
    let sides = [&BESIDE, &other].map(|ray| {
        let [before, after] = stage.means(&swept, is_under(ray, 0.02), |p| p.x.abs());
        after - before
    });
    println!("{sides:?}");
    assert!(sides.iter().all(|by| *by < -8e-3), "{sides:?}");
    let alone = stage.swept(&BRUSH, &BESIDE, way, (60.0, 0.2));
    let [before, after] = stage.means(&alone, is_under(&other, 0.02), |p| p.x.abs());
    assert!((after - before).abs() < 1e-3, "the other side moves by {}", after - before);
}

#[test]
fn stroke_is_the_same_at_any_frame_rate() {
    let Some(stage) = Setup::new() else { return };
    let pushed = |fps| stage.swept(&BRUSH, &BESIDE, Vec3::new(-0.03, 0.02, 0.0), (fps, 0.5))[1].clone();
    let reference = pushed(60.0);
    assert!(pushed(60.0) == reference, "not the same twice");
    for fps in [30.0, 120.0] {
        let other = pushed(fps);
        let mean =
            other.iter().zip(&reference).map(|(a, b)| a.distance(*b)).sum::<f32>() / other.len() as f32;
        println!("{fps} and 60 frames per second part by {:.3} mm in the mean", 1e3 * mean);
        assert!(mean < 1e-3, "{fps}: {mean}");
    }
}

#[test]
fn brush_beside_the_hair_changes_nothing() {
    let Some(stage) = Setup::new() else { return };
    let mut control = stage.hair();
    stage.still(&mut control, 13);
    let control = stage.guides(&control);
    let miss = Ray { origin: Vec3::new(0.5, 0.0, 1.0), direction: Vec3::NEG_Z };
    assert!(stage.swept(&BRUSH, &miss, Vec3::Y * 0.05, (60.0, 0.2))[1] == control);
    let weak = MotionBrush { strength: 0.0, ..BRUSH };
    assert!(stage.swept(&weak, &FRONT, Vec3::Y * 0.05, (60.0, 0.2))[1] == control);
    let mut hair = stage.hair();
    for brush in [
        MotionBrush { radius: 0.0, ..BRUSH },
        MotionBrush { strength: 1.5, ..BRUSH },
        MotionBrush { root_tip: f32::NAN, ..BRUSH },
        MotionBrush { mirror: Some((Vec3::ZERO, Vec3::ONE)), ..BRUSH },
    ] {
        assert!(hair.brush(&brush, &FRONT).is_err(), "{brush:?}");
    }
    assert!(!hair.grabbed().is_active());
}
