//! Hair drawn as cards that follow guides.

use crate::common;
use tresses::{
    Background, Camera, Character, CharacterAsset, CharacterOptions, CharacterParts, Context, FaceHair,
    Gesture, LodMode, LodOptions, Picture, Pose, Styling, View, ViewOptions, drape,
    glam::{Quat, Vec3},
    groom::{
        cards::{CardOptions, bake},
        grow::Growth,
        mannequin::facial::Beard,
        styles::Style,
    },
    renderer::Renderer,
};

/// The built-in character with a bob of 2,000 strands, and with cards instead.
fn strands_and_cards(context: &Context) -> [CharacterParts; 2] {
    let style: Style = "bob".parse().unwrap();
    let source = pollster::block_on(drape::style(context, &style, &())).unwrap();
    let growth = Growth::for_style(&style).with_strands(2000);
    let face = FaceHair { has_brows: false, has_lashes: false, beard: Beard::None };
    let styling = Styling { growth: Some(growth), face, ..Styling::default() };
    let parts = pollster::block_on(source.parts(&styling, &())).unwrap();
    let options = CardOptions { levels: vec![120], texture_size: 512, ..CardOptions::default() };
    let baked = bake(&parts.groom.strands.unbound(), parts.head.as_ref(), &options).unwrap();
    [parts.clone(), parts.with_cards(&baked, 0).unwrap()]
}

fn made(context: &Context, parts: &CharacterParts) -> Character {
    let options = CharacterOptions::default();
    let asset = pollster::block_on(CharacterAsset::new(context, parts.clone(), &options, &())).unwrap();
    let mut character = Character::new(&asset).unwrap();
    character.set_lod(LodOptions { mode: LodMode::Off, ..LodOptions::default() });
    character
}

const SIZE: [u32; 2] = [128, 128];

fn camera(distance: f32) -> Camera {
    let at = Vec3::new(0.0, 0.0, 0.0);
    Camera::look_at(at + Vec3::new(0.4, 0.05, 1.0).normalize() * distance, at, 0.55 / distance, SIZE)
}

/// Draws a character without its body before nothing. Returns premultiplied colors, sRGB.
fn drawn(context: &Context, character: &Character, renderer: Renderer) -> Vec<[u8; 4]> {
    let options = ViewOptions { renderer, ..common::coarse() };
    let mut view = View::new(context, &options, SIZE, 1).unwrap();
    let picture =
        Picture { camera: camera(1.4), background: Background::transparent(), ..Picture::default() };
    common::draw_characters(&mut view, &[character], &picture).as_chunks::<4>().0.to_vec()
}

/// Mean of `of` over the pixels.
fn mean(picture: &[[u8; 4]], of: impl Fn(&[u8; 4]) -> f32) -> f32 {
    picture.iter().map(of).sum::<f32>() / picture.len() as f32
}

fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> f32 {
    let sum: u32 = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
    sum as f32 / (4 * a.len()) as f32
}

#[test]
fn cards_look_like_the_strands_that_they_replace() {
    let Some(context) = common::context() else { return };
    let [strands, cards] = strands_and_cards(context).map(|mut parts| {
        // The hair alone.
        parts.head = None;
        parts.anatomy = None;
        parts
    });
    let [mut strands, mut cards] = [strands, cards].map(|parts| made(context, &parts));
    for character in [&mut strands, &mut cards] {
        common::advance_characters(&mut [character], 0.0);
    }
    let light = |p: &[u8; 4]| (f32::from(p[0]) + f32::from(p[1]) + f32::from(p[2])) / 3.0;
    for renderer in [Renderer::tiles(4), Renderer::masks(4)] {
        let [expected, found] = [&strands, &cards].map(|character| drawn(context, character, renderer));
        let off = difference(&expected, &found);
        let [bright, got] = [&expected, &found].map(|picture| mean(picture, light));
        let [alpha, seen] = [&expected, &found].map(|picture| mean(picture, |p| f32::from(p[3])));
        assert!((seen / alpha - 1.0).abs() < 0.08, "{renderer:?}: coverage {seen} instead of {alpha}");
        assert!((got / bright - 1.0).abs() < 0.12, "{renderer:?}: brightness {got} instead of {bright}");
        assert!(off < 3.0, "{renderer:?}: {off}");
        // The comparison notices missing hair.
        assert!(difference(&expected, &vec![[0; 4]; found.len()]) > 9.0);
    }
}

#[test]
fn cards_swing_with_the_guides_and_instances_share_them() {
    let Some(context) = common::context() else { return };
    let [strands, cards] = strands_and_cards(context).map(|parts| made(context, &parts));
    let mut moved = cards.instance().unwrap();
    let nod = |degrees: f32| {
        let rotation = Quat::from_rotation_y(degrees.to_radians());
        Gesture { head: Pose { rotation, ..Pose::IDENTITY }, ..Gesture::default() }
    };
    let mut all = [strands, cards];
    for character in all.iter_mut().chain([&mut moved]) {
        common::advance_characters(&mut [character], 0.0);
    }
    assert!(all[1].hair().set.triangles() < all[0].hair().set.triangles() / 10);
    let rest = all.each_ref().map(|character| drawn(context, character, Renderer::tiles(4)));
    for step in 1..6 {
        for character in all.iter_mut().chain([&mut moved]) {
            character.gesture = nod(9.0 * step as f32);
            common::advance_characters(&mut [character], 1.0 / 60.0);
        }
    }
    let [strands, cards] = all.each_ref().map(|character| drawn(context, character, Renderer::tiles(4)));
    assert!(difference(&rest[1], &cards) > 4.0, "cards move");
    let [apart, moves] = [difference(&strands, &cards), difference(&rest[0], &strands)];
    assert!(apart < 0.8 * moves, "cards are {apart} from strands, which changed by {moves}");
    assert_eq!(drawn(context, &moved, Renderer::tiles(4)), cards);
}

#[test]
fn the_level_of_detail_leaves_cards_whole() {
    let Some(context) = common::context() else { return };
    let [_, parts] = strands_and_cards(context);
    let mut cards = made(context, &parts);
    cards.set_lod(LodOptions { mode: LodMode::Auto, ..LodOptions::CROWD });
    let drawn = [1.0, 60.0].map(|distance| {
        let mut encoder = context.device().create_command_encoder(&Default::default());
        let eye = [camera(distance)];
        context.frame(&mut encoder).with_cameras(&eye).advance(&mut [&mut cards], 1.0 / 60.0).unwrap();
        context.queue().submit([encoder.finish()]);
        (cards.hair().set.drawn.count, cards.hair().set.drawn.vertex_count)
    });
    assert_eq!(drawn[0], drawn[1]);
    assert_eq!(drawn[0].0, cards.hair().strands.count);
    // The motion still has levels of detail.
    assert!(cards.hair().lod.current().step_scale > 1.0);
}
