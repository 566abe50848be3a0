//! Every pipeline of light, draw and present is valid within baseline limits. Needs no GPU.

use crate::{common, renderers};
use tresses::{
    Body, Camera, Compositor, HostFrame, Picture, View, ViewOptions,
    glam::Mat4,
    groom::TriMesh,
    light::SceneShadow,
    low_level::{Drawing, HairSet, StrandBuffers, Targets, ViewContent},
    renderer::{ClassicCoverage, Renderer},
};

/// Builds and records a whole frame by `renderer`. Returns the validation error of wgpu, if any.
fn frame(renderer: Renderer) -> Option<wgpu::Error> {
    let context = &common::noop();
    let scope = context.device().push_error_scope(wgpu::ErrorFilter::Validation);
    let options = ViewOptions { renderer, ..Default::default() };
    let view = View::new(context, &options, [64, 40], 2).expect("a fair size");
    let strands = StrandBuffers::new(context, 5000, 16).expect("small enough");
    let hair = [(); 2].map(|()| HairSet::new(context, &strands).expect("small enough"));
    let body = Body::new(context, &TriMesh::default());
    let picture = Picture::default();
    let mut encoder = context.device().create_command_encoder(&Default::default());
    context
        .recorder(&mut encoder)
        .draw_strands(&hair.each_ref(), &[&body, &body], &view, Drawing::new(&picture))
        .expect("every pipeline is made");
    context.queue().submit([encoder.finish()]);
    pollster::block_on(scope.pop())
}

#[test]
fn frame_is_valid_with_every_renderer() {
    let counts = [
        Renderer::masks(1),
        Renderer::tiles(1),
        Renderer::peeling(1),
        Renderer::peeling(ClassicCoverage::MAX_LAYERS),
    ];
    for renderer in renderers::all().into_iter().chain(counts) {
        let error = frame(renderer);
        assert!(error.is_none(), "{renderer:?}: {error:?}");
    }
}

#[test]
fn unsupported_counts_are_errors() {
    let context = &common::noop();
    let options = ViewOptions { renderer: Renderer::alpha_to_coverage(1), ..Default::default() };
    let error = View::new(context, &options, [64, 40], 1).unwrap_err().to_string();
    assert!(error.contains("samples"), "{error}");
    // A view keeps its options if the new ones are invalid.
    let mut view = View::new(context, &ViewOptions::default(), [64, 40], 1).unwrap();
    assert!(view.set_options(&options).is_err());
    assert_eq!(*view.options(), ViewOptions::default());
    let fits = ViewOptions { renderer: Renderer::peeling(4), ..options };
    view.set_options(&fits).unwrap();
    assert_eq!((view.options(), view.targets().samples), (&fits, 1));
}

/// Records hair over a scene: a pipeline for `format`, and a target of the format `color`. Returns the validation error
/// of wgpu, if any.
fn embedded(samples: u32, format: wgpu::TextureFormat, color: wgpu::TextureFormat) -> Option<wgpu::Error> {
    let context = &common::noop();
    let scope = context.device().push_error_scope(wgpu::ErrorFilter::Validation);
    let options = ViewOptions { renderer: Renderer::tiles(samples), ..Default::default() };
    let view = View::new(context, &options, [64, 40], 2).expect("a fair size");
    let embed = Compositor::new(context, options.renderer, format).expect("masks");
    let strands = StrandBuffers::new(context, 5000, 16).expect("small enough");
    let hair = HairSet::new(context, &strands).expect("small enough");
    let texture = |format, usage| {
        let size = wgpu::Extent3d { width: 64, height: 40, depth_or_array_layers: 1 };
        let descriptor = wgpu::TextureDescriptor { size, format, usage, ..common::TEXTURE };
        context.device().create_texture(&descriptor).create_view(&Default::default())
    };
    let geometry = matches!(options.renderer, Renderer::Tiles(_))
        .then(|| texture(Compositor::GEOMETRY, wgpu::TextureUsages::RENDER_ATTACHMENT));
    let map = texture(wgpu::TextureFormat::Depth24Plus, wgpu::TextureUsages::TEXTURE_BINDING);
    let into = HostFrame {
        color: &texture(color, wgpu::TextureUsages::RENDER_ATTACHMENT),
        depth: &texture(wgpu::TextureFormat::Depth24Plus, wgpu::TextureUsages::TEXTURE_BINDING),
        origin: [0; 2],
        projection: Camera::perspective(0.5, 1.6, 0.01),
        geometry: geometry.as_ref(),
        shadows: &[SceneShadow { light: 0, depth: &map, part: None, projection: Mat4::IDENTITY, bias: 0.01 }],
        shade: 1.0,
        shade_range: 2.5,
        is_lit: false,
    };
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let picture = Picture::default();
    let sight = Drawing { shows: ViewContent::Over(&embed, into), ..Drawing::new(&picture) };
    context.recorder(&mut encoder).draw_strands(&[&hair], &[], &view, sight).expect("every pipeline is made");
    context.queue().submit([encoder.finish()]);
    pollster::block_on(scope.pop())
}

#[test]
fn embedded_hair_is_valid() {
    use wgpu::TextureFormat::{Rgba8UnormSrgb, Rgba16Float};
    for (samples, format) in [(1, Rgba16Float), (4, Rgba16Float), (4, Rgba8UnormSrgb)] {
        let error = embedded(samples, format, format);
        assert!(error.is_none(), "{samples} samples, {format:?}: {error:?}");
    }
    assert!(embedded(4, Rgba16Float, Rgba8UnormSrgb).is_some());
}

#[test]
fn empty_and_huge_images_are_errors() {
    let context = &common::noop();
    assert!(Targets::new(context, [0, 10], Renderer::masks(1), 1).is_err());
    assert!(Targets::new(context, [1_000_000, 10], Renderer::masks(1), 1).is_err());
}
