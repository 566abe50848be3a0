//! Pixels are averaged in linear light, and the average is tone mapped.

use crate::{common, golden};

use tresses::{
    Background, Body, BodyMaterial, Context, Picture, ToneMap, View, ViewOptions,
    glam::Vec3,
    groom::srgb::linear,
    light::{HairMaterial, Lights, Shadows, Sky},
    low_level::{Drawing, HairSet, readback},
    renderer::{Renderer, ShadingModel},
    wgpu::{
        self,
        TextureFormat::{self, Rgba8Unorm, Rgba8UnormSrgb, Rgba16Float},
    },
};

/// Radiance of a background far above the shoulder, and of one below it.
const BRIGHT: f32 = 4.0;
const DIM: f32 = 0.9;

/// Returns the tone-mapped value of a gray, as in `tonemap.wesl`.
fn mapped(tone: &ToneMap, radiance: f32) -> f32 {
    let room = 1.0 - tone.shoulder;
    if radiance <= tone.shoulder { radiance } else { 1.0 - room * room / (radiance + room - tone.shoulder) }
}

/// Black hair and a black ball in front of gray. An image with a dim background gives the transmittance of each pixel.
#[test]
fn pixels_are_tone_mapped_once() {
    let Some(context) = common::context() else { return };
    let mut hair =
        HairSet::new(context, &golden::strands(context, (0..golden::COUNT).step_by(40))).expect("fits");
    hair.material = HairMaterial::brown();
    let mut body = Body::new(context, &golden::ball());
    body.material = BodyMaterial { color: Vec3::ZERO, ..Default::default() };
    let sky = Sky { zenith: Vec3::ZERO, horizon: Vec3::ZERO, ground: Vec3::ZERO };
    let unlit = Picture {
        lights: Lights { list: Vec::new(), sky, ..Default::default() },
        shadows: Shadows { has_ambient: false, is_enabled: false, ..Default::default() },
        ..golden::scene()
    };
    for renderer in [Renderer::tiles(4), Renderer::masks(4)] {
        let renderer = renderer.with_shading(ShadingModel::KajiyaKay);
        let options = ViewOptions { renderer, ..common::coarse() };
        let view = View::new(context, &options, golden::SIZE, 1).expect("fits");
        let shown = |radiance: f32, tone: ToneMap| -> Vec<f32> {
            let scene =
                Picture { background: Background::flat(Vec3::splat(radiance)), tone, ..unlit.clone() };
            let bytes = common::picture(context, &view, &scene, &[&hair], &[&body]);
            bytes.as_chunks::<4>().0.iter().map(|rgba| linear(f32::from(rgba[1]) / 255.0)).collect()
        };
        let tone = ToneMap::default();
        let open = shown(DIM, ToneMap { shoulder: 0.99, ..tone });
        let bright = shown(BRIGHT, tone);
        let worst = |expected: &dyn Fn(f32) -> f32| {
            let off = open.iter().zip(&bright).map(|(dim, seen)| (expected(dim / DIM) - seen).abs());
            off.fold(0.0, f32::max)
        };
        let once = worst(&|open| mapped(&tone, BRIGHT * open));
        let each = worst(&|open| open * mapped(&tone, BRIGHT));
        println!("{renderer:?}: {once:.3} off, {each:.3} were samples and strands mapped each");
        assert!(once < 0.03, "{renderer:?}: {once}");
        assert!(each > 0.3, "{renderer:?}: the comparison sees no difference: {each}");
    }
}

/// Creates a texture of the size of `view`'s image that can be rendered and copied, with additional view formats.
fn output_of(
    context: &Context,
    view: &View,
    format: TextureFormat,
    others: &[TextureFormat],
) -> wgpu::Texture {
    context.device().create_texture(&wgpu::TextureDescriptor {
        size: view.targets().picture().texture().size(),
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: others,
        ..common::TEXTURE
    })
}

/// The bytes of an image are the same whether the shader or the format of the output applies the sRGB curve.
#[test]
fn srgb_formats_give_the_same_image() {
    let Some(context) = common::context() else { return };
    let body = Body::new(context, &golden::ball());
    let bytes = |renderer, ssaa, made_for, output: TextureFormat| {
        let options = ViewOptions { renderer, output: made_for, ..common::coarse() };
        let view = View::new(context, &options, golden::SIZE, ssaa).expect("fits");
        let texture = output_of(context, &view, Rgba8Unorm, &[Rgba8UnormSrgb]);
        let into = texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(output),
            usage: Some(wgpu::TextureUsages::RENDER_ATTACHMENT),
            ..Default::default()
        });
        let scene = golden::scene();
        common::submit(|recorder| {
            let sight = Drawing { output: Some(&into), ..Drawing::new(&scene) };
            recorder.draw(&[], &[&body], &view, sight)
        });
        pollster::block_on(readback::texture(context, &texture)).expect("it is there")
    };
    let most = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max();
    for (renderer, ssaa) in [(Renderer::tiles(4), 1), (Renderer::tiles(4), 2), (Renderer::masks(4), 1)] {
        let plain = bytes(renderer, ssaa, Rgba8Unorm, Rgba8Unorm);
        let curved = bytes(renderer, ssaa, Rgba8UnormSrgb, Rgba8UnormSrgb);
        assert!(plain.iter().max() > Some(&100), "there is a ball");
        assert!(most(&plain, &curved) <= Some(1), "{renderer:?}: {:?}", most(&plain, &curved));
        // A curve that is applied once too often is detected.
        let swapped = curved.iter().map(|byte| (255.0 * linear(f32::from(*byte) / 255.0)) as u8);
        assert!(most(&plain, &swapped.collect::<Vec<_>>()) > Some(20));
    }
}

/// Only formats with steps are dithered. An almost black value is equal in all pixels of floats, but differs between
/// pixels of eight bits.
#[test]
fn floats_are_not_dithered() {
    let Some(context) = common::context() else { return };
    let radiance = 1e-4;
    let scene = Picture { background: Background::flat(Vec3::splat(radiance)), ..golden::scene() };
    for renderer in [Renderer::tiles(1), Renderer::masks(1), Renderer::peeling(2)] {
        let seen = |output| {
            let options = ViewOptions { renderer, output, ..common::coarse() };
            let view = View::new(context, &options, golden::SIZE, 1).expect("fits");
            let texture = output_of(context, &view, output, &[]);
            let into = texture.create_view(&Default::default());
            common::submit(|recorder| {
                recorder.draw(&[], &[], &view, Drawing { output: Some(&into), ..Drawing::new(&scene) })
            });
            pollster::block_on(readback::texture(context, &texture)).expect("it is there")
        };
        let halves: Vec<half::f16> = bytemuck::pod_collect_to_vec(&seen(Rgba16Float));
        let expected = 12.92 * radiance;
        for [r, g, b, _] in halves.as_chunks::<4>().0 {
            for channel in [r, g, b] {
                assert!(
                    (channel.to_f32() - expected).abs() < 1e-3 * expected,
                    "{renderer:?}: {channel} instead of {expected}"
                );
            }
        }
        let bytes = seen(Rgba8Unorm);
        let bright = bytes.as_chunks::<4>().0.iter().filter(|rgba| rgba[0] > 0).count();
        assert!(bright > 0, "{renderer:?}: a third of a step is a step in some pixels");
    }
}
