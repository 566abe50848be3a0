//! Total coverage of a groom, near and far.

use super::{
    MASK_1, MASK_2X, MASK_4_2X, Mode, PEEL_2X, TILES_2X,
    groom::Groom,
    modes, oracle,
    picture::{Studio, total},
};
use crate::common;
use tresses::{Background, Camera, Context, Picture, glam::Vec3, light::Sphere};

const SIZE: [u32; 2] = [384, 320];

/// Camera distances, meters. Strands are 0.65, 0.33 and 0.16 pixels wide at the root.
const DISTANCES: [f32; 3] = [0.5, 1.0, 2.0];

/// Returns a lit scene of the groom from `distance`, with a transparent background.
pub fn scene(distance: f32, size: [u32; 2]) -> Picture {
    let eye = Vec3::new(0.38, 0.24, 0.89).normalize() * distance;
    Picture {
        camera: Camera::look_at(eye, Vec3::new(0.0, -0.01, 0.0), 0.48, size),
        focus: Sphere { center: Vec3::ZERO, radius: 0.15 },
        background: Background::transparent(),
        ..Default::default()
    }
}

/// Returns the relative error of the covered area at each of [`DISTANCES`].
fn errors(context: &Context, mode: Mode, groom: &Groom, exact: &[f64]) -> Vec<f64> {
    let studio = Studio::new(context, mode, SIZE);
    let (hair, _strands) = studio.hair(groom);
    let drawn = DISTANCES.map(|distance| {
        let Picture { camera, focus, .. } = scene(distance, SIZE);
        total(&studio.picture(&Picture { camera, focus, ..common::dark() }, &hair))
    });
    drawn.iter().zip(exact).map(|(drawn, exact)| drawn / exact - 1.0).collect()
}

fn say(name: &str, errors: &[f64]) {
    let cells: Vec<_> = errors.iter().map(|e| format!("{:+6.2} %", 100.0 * e)).collect();
    println!("{name:36} {}", cells.join("  "));
}

/// Whether the errors are within 1 %, or as close as the mode allows. The modes assume that strands in a pixel overlap
/// at random. Where a dense head ends within a pixel they do not, and the smaller the head, the larger the share of its
/// edge. At the last distance the head is 65 pixels high.
fn good(mode: Mode, errors: &[f64]) -> bool {
    let limits = match mode {
        // A strand covers a sample or not, so 6000 strands have a statistical error.
        MASK_1 | MASK_2X => [0.015, 0.02, 0.03],
        MASK_4_2X | PEEL_2X | TILES_2X => [0.01; 3],
        _ => [0.01, 0.01, 0.025],
    };
    errors.iter().zip(limits).all(|(error, limit)| error.abs() < limit)
}

#[test]
fn total_coverage_is_exact() {
    let Some(context) = common::context() else { return };
    judge(context, &[super::MASK_4, super::TILES, super::ALPHA_4], &[super::TILES]);
}

/// Prints the table of docs/validation/coverage.md.
#[test]
#[ignore = "proof"]
fn total_coverage_is_exact_in_any_mode() {
    let Some(context) = common::context() else { return };
    let all: Vec<_> = modes(context.tier().max_samples).collect();
    judge(context, &all, &[super::MASK_4, super::PEEL]);
}

/// Compares `modes` with the exact area. In the modes `perturbed`, strands that are too wide must fail.
fn judge(context: &Context, modes: &[Mode], perturbed: &[Mode]) {
    let groom = Groom::on_a_ball(6000, 2.5e-4);
    let exact = DISTANCES.map(|distance| oracle::covered(&groom, &scene(distance, SIZE).camera));
    println!("exact: {exact:.1?} pixels");
    for &mode in modes {
        let errors = errors(context, mode, &groom, &exact);
        say(mode.name, &errors);
        if mode.is_alpha() {
            // Equal alpha selects equal samples, so strands hide each other. The test detects that.
            assert!(!good(mode, &errors));
        } else {
            assert!(good(mode, &errors), "{mode:?}: {errors:?}");
        }
    }
    // Strands that are 3 % too wide are detected.
    let wide =
        Groom { root_radius: 1.03 * groom.root_radius, tip_radius: 1.03 * groom.tip_radius, ..groom.clone() };
    for &mode in perturbed {
        assert!(!good(mode, &errors(context, mode, &wide, &exact)));
    }
}
