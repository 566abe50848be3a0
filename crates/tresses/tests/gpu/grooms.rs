//! Several grooms and several views in one submission.

use crate::{
    common::{self, frame, submit},
    golden::{self, SIZE, difference},
};
use tresses::{
    Background, Body, Camera, Context, HairOptions, Picture, Pose, View, ViewOptions,
    glam::{Quat, Vec3},
    groom::{BindOptions, bind, hash::pcg},
    light::{HairMaterial, Lights, Sphere},
    low_level::{Drawing, Hair, HairSet, readback::blocking as readback},
    renderer::Renderer,
};

const MODES: [Renderer; 7] = [
    Renderer::masks(4),
    Renderer::masks(1),
    Renderer::alpha_to_coverage(4),
    Renderer::peeling(4),
    Renderer::peeling(1),
    Renderer::tiles(1),
    Renderer::tiles(4),
];

fn view(context: &Context, renderer: Renderer, size: [u32; 2]) -> View {
    let options = ViewOptions { renderer, shadow_resolution: 256, ..common::coarse() };
    View::new(context, &options, size, 1).expect("fits")
}

/// Splitting the groom of the golden image in two at random does not change the image: occlusion, shadows and thickness
/// do not depend on which groom a strand belongs to. Strands are numbered consecutively over both grooms.
#[test]
fn splitting_a_groom_does_not_change_the_image() {
    let Some(context) = common::context() else { return };
    let set = |numbers: &[u32]| {
        HairSet::new(context, &golden::strands(context, numbers.iter().copied())).expect("fits")
    };
    let (first, second): (Vec<u32>, Vec<u32>) = (0..golden::COUNT).partition(|i| pcg(*i) % 5 < 2);
    let whole = set(&[first.as_slice(), &second].concat());
    let [one, other] = [set(&first), set(&second)];
    let body = Body::new(context, &golden::ball());
    for mode in MODES {
        let view = view(context, mode, SIZE);
        let picture = |hair: &[&HairSet]| common::picture(context, &view, &golden::scene(), hair, &[&body]);
        let exact = picture(&[&whole]);
        let (mean, high) = difference(&exact, &picture(&[&one, &other]));
        println!("{mode:?}: mean {mean:.4} of 255, 99th percentile {high}");
        assert!(mean < 0.01 && high == 0, "{mode:?}: {mean} {high}");
        if matches!(mode, Renderer::Tiles(_)) || [Renderer::peeling(4), Renderer::peeling(1)].contains(&mode)
        {
            // The order of the grooms has no effect. Masks are left out, because they round by the number of a strand.
            let (mean, high) = difference(&exact, &picture(&[&other, &one]));
            assert!(mean < 0.01 && high == 0, "{mode:?}, the other way round: {mean} {high}");
        }
        // A missing part is detected, and each part shadows the other.
        let (mean, _) = difference(&exact, &picture(&[&other]));
        assert!(mean > 1.0, "{mode:?}: {mean}");
        let shaded =
            |of: &HairSet| -> Vec<u8> { readback::buffer(context, &view.shaded(of).unwrap()).unwrap() };
        let alone = shaded(&other);
        picture(&[&one, &other]);
        assert!(alone != shaded(&other), "{mode:?}: the grooms shade each other");
    }
}

/// Creates a hanging groom.
fn hair(context: &Context) -> Hair {
    let groom = bind(&common::hanging(300, 16, 0.15), &BindOptions::default()).unwrap();
    let field = common::ball(0.085, 32);
    let options = HairOptions::default();
    common::hair(context, &groom, &options, Some(&field)).unwrap()
}

fn eye(azimuth: f32) -> Picture {
    let way = Quat::from_rotation_y(azimuth) * Vec3::new(0.0, 0.05, 0.8);
    Picture {
        camera: Camera::look_at(way, Vec3::ZERO, 0.45, [96, 80]),
        focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
        lights: Lights::around(azimuth),
        ..Default::default()
    }
}

#[test]
fn views_in_one_submission_match_separate_submissions() {
    let Some(context) = common::context() else { return };
    let mut hair = hair(context);
    submit(|recorder| recorder.advance(&mut hair, &frame(Pose::IDENTITY, 0.0)));
    let pictures = [eye(0.2), eye(1.7)];
    let modes = [Renderer::tiles(4), Renderer::masks(4)];
    let read = |view: &View| pollster::block_on(view.targets().read()).unwrap();
    let views = || modes.map(|mode| view(context, mode, [96, 80]));
    let apart = views();
    let apart = [0, 1].map(|i| common::drawn(&apart[i], &pictures[i], &[&hair], &[]));
    let together = views();
    submit(|recorder| {
        let drawn = together.iter().zip(&pictures).map(|(view, picture)| (view, Drawing::new(picture)));
        recorder.record(&mut [(&mut hair, frame(Pose::IDENTITY, 0.0))], &[], drawn.collect())
    });
    assert!(apart == together.each_ref().map(read));
    assert!(difference(&apart[0], &apart[1]).0 > 1.0, "they see different things");
}

#[test]
fn grooms_in_one_submission_match_separate_submissions() {
    let Some(context) = common::context() else { return };
    let place =
        |side: f32, turn: f32| Pose { rotation: Quat::from_rotation_y(turn), translation: Vec3::X * side };
    let poses = |i: u32| [place(-0.25, 0.1 * i as f32), place(0.25, -0.05 * i as f32)];
    let [mut apart, mut together] = [(); 2].map(|()| [hair(context), hair(context)]);
    for hair in [&mut apart, &mut together] {
        hair[1].set.material = HairMaterial::blond();
    }
    let scene = Picture {
        camera: Camera::look_at(Vec3::Z * 1.4, Vec3::ZERO, 0.5, SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.6 },
        background: Background::transparent(),
        ..Default::default()
    };
    let both = view(context, MODES[0], SIZE);
    for i in 0..12 {
        let dt = if i == 0 { 0.0 } else { 1.0 / 60.0 };
        for (hair, pose) in apart.iter_mut().zip(poses(i)) {
            submit(|recorder| recorder.advance(hair, &frame(pose, dt)));
        }
        submit(|recorder| {
            let [left, right] = &mut together;
            let [a, b] = poses(i).map(|pose| frame(pose, dt));
            recorder.record(&mut [(left, a), (right, b)], &[], vec![(&both, Drawing::new(&scene))])
        });
    }
    for (apart, together) in apart.iter().zip(&together) {
        assert!(
            common::vertices(apart) == common::vertices(together),
            "what is recorded beside it does not matter"
        );
    }
    assert!(common::vertices(&apart[0]) != common::vertices(&apart[1]));
    // Each groom is at its place and has its own color.
    let seen = pollster::block_on(both.targets().read()).unwrap();
    let half = |left: bool| -> f64 {
        let pixels = seen.as_chunks::<4>().0.iter().enumerate();
        let own = pixels.filter(|(i, _)| (*i as u32 % SIZE[0] < SIZE[0] / 2) == left);
        own.map(|(_, [r, ..])| f64::from(*r)).sum()
    };
    assert!(half(false) > 1.2 * half(true), "blond hair is lighter: {} {}", half(true), half(false));
    assert!(difference(&seen, &common::drawn(&both, &scene, &[&together[0]], &[])).0 > 1.0);
}
