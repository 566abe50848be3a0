//! Nothing depends on the order of workgroups or on the contents of new memory: images and guides are byte-identical
//! with other numbers of workgroups, and with memory that starts with NaN ([`crate::common::order`]).
//!
//! `TRESSES_WORKGROUPS=reversed` (or `permuted`, `filled`) runs all tests of the GPU with such a context.

use crate::common::{self, SkinnedHair, order};

use tresses::{
    Body, Camera, Context, HairHairMode, HairOptions, Picture, Pose, SimulationParams, View, ViewOptions,
    Wind,
    glam::{Quat, Vec3},
    groom::{BindOptions, GuideCount, bind, mesh::shapes},
    light::{Lights, Sphere},
    low_level::{
        BrushEffect, Drawing, GrabTarget, Hair, HairFrame, MotionBrush, Ray, Recorder, StrandBuffers,
        readback::blocking as readback, shaders,
    },
    renderer::{Renderer, ShadingModel},
    wgpu::naga,
};

const SIZE: [u32; 2] = [72, 60];
/// A number that includes all variants.
const ALL: usize = usize::MAX;

/// Images and guide states of a scene.
#[derive(PartialEq)]
struct Output {
    images: Vec<Vec<u8>>,
    guides: Vec<Vec<u32>>,
}

/// A scene, rendered with any context.
type Scene = fn(&Context, &mut Output);

fn run(context: &Context, scene: Scene) -> Output {
    let mut output = Output { images: Vec::new(), guides: Vec::new() };
    scene(context, &mut output);
    assert!(
        !output.images.is_empty()
            && output.images.iter().all(|image| image.iter().any(|byte| *byte != image[0]))
    );
    assert!(output.guides.iter().flatten().any(|word| *word != 0));
    output
}

/// Renders the scenes with the first `count` variants of `context`, and compares the results with `context` itself.
fn compare(context: &Context, count: usize, scenes: &[(&str, Scene)]) {
    let plain: Vec<_> = scenes.iter().map(|(_, scene)| run(context, *scene)).collect();
    for (variant, other) in order::variants(context).take(count) {
        for ((name, scene), plain) in scenes.iter().zip(&plain) {
            let changed = run(&other, *scene);
            let of = |a: &[u8], b: &[u8]| a.iter().zip(b).filter(|(a, b)| a != b).count();
            for (i, (a, b)) in plain.images.iter().zip(&changed.images).enumerate() {
                assert!(a == b, "{name}, {variant}: image {i} differs in {} of {} bytes", of(a, b), a.len());
            }
            for (i, (a, b)) in plain.guides.iter().zip(&changed.guides).enumerate() {
                let (a, b) = (bytemuck::cast_slice(a), bytemuck::cast_slice(b));
                assert!(a == b, "{name}, {variant}: guides {i} differ in {} of {} bytes", of(a, b), a.len());
            }
            assert!(*plain == changed, "{name}, {variant}: the number of results differs");
            println!(
                "{name}, {variant}: {} images and {} states are equal",
                plain.images.len(),
                plain.guides.len()
            );
        }
    }
}

/// Records with `what` on `context` and submits.
fn submit(context: &Context, what: impl FnOnce(&mut Recorder<'_>) -> tresses::Result<()>) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    what(&mut context.recorder(&mut encoder)).expect("it fits");
    context.queue().submit([encoder.finish()]);
}

/// Physics with self-collision, in wind if `wind` is not 0 (m/s).
fn physics(wind: f32) -> SimulationParams {
    let mut physics = SimulationParams::default();
    physics.hair_hair.mode = HairHairMode::Gradient;
    if wind > 0.0 {
        physics.wind = Wind { resolution: 16, gusts: 0.3, ..Wind::new(Vec3::new(wind, 0.0, 0.3 * wind)) };
    }
    physics
}

/// Creates strands that hang from a ball, each fourth its own guide.
fn hair(context: &Context, strands: usize, physics: &SimulationParams) -> Hair {
    let options = BindOptions { guides: GuideCount::OneIn(4), ..Default::default() };
    let groom = bind(&common::hanging(strands, 12, 0.12), &options).unwrap();
    let options = HairOptions { simulation: *physics, ..Default::default() };
    common::hair(context, &groom, &options, Some(&common::ball(0.085, 24))).unwrap()
}

/// The pose of a turning head in frame `i`.
fn turned(i: u32) -> Pose {
    Pose::about(Vec3::ZERO, Quat::from_rotation_y(0.08 * i as f32))
}

fn step<'a>(i: u32, physics: &'a SimulationParams) -> HairFrame<'a> {
    HairFrame { simulation: physics, ..common::frame(turned(i), if i == 0 { 0.0 } else { 1.0 / 60.0 }) }
}

/// Advances `hair` by `frames` frames after the one that resets it.
fn advance(context: &Context, hair: &mut Hair, physics: &SimulationParams, frames: u32) {
    for i in 0..=frames {
        submit(context, |recorder| recorder.advance(hair, &step(i, physics)));
    }
}

fn state(context: &Context, hair: &Hair) -> Vec<u32> {
    readback::buffer(context, &hair.guides.current).unwrap()
}

fn picture() -> Picture {
    Picture {
        camera: Camera::look_at(Vec3::new(0.15, 0.08, 0.7), Vec3::new(0.0, -0.03, 0.0), 0.45, SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.25 },
        lights: Lights::around(0.3),
        ..Default::default()
    }
}

fn view(context: &Context, renderer: Renderer) -> View {
    let options =
        ViewOptions { shadow_resolution: 128, ambient_resolution: 16, renderer, ..Default::default() };
    View::new(context, &options, SIZE, 1).unwrap()
}

fn draw(context: &Context, view: &View, hair: &[&Hair], bodies: &[&Body]) -> Vec<u8> {
    let picture = picture();
    submit(context, |recorder| recorder.draw(hair, bodies, view, Drawing::new(&picture)));
    pollster::block_on(view.targets().read()).unwrap()
}

/// Two frames of hair in wind, drawn with tiles in ambient light.
fn in_wind(context: &Context, output: &mut Output) {
    let physics = physics(6.0);
    let mut hair = hair(context, 240, &physics);
    let (view, body) = (view(context, Renderer::tiles(4)), Body::new(context, &shapes::sphere(0.085, 16)));
    for i in 0..=2 {
        submit(context, |recorder| recorder.advance(&mut hair, &step(i, &physics)));
        output.images.push(draw(context, &view, &[&hair], &[&body]));
        output.guides.push(state(context, &hair));
    }
}

/// Each renderer.
fn renderers(context: &Context, output: &mut Output) {
    let physics = physics(0.0);
    let mut hair = hair(context, 400, &physics);
    advance(context, &mut hair, &physics, 3);
    output.guides.push(state(context, &hair));
    let body = Body::new(context, &shapes::sphere(0.085, 16));
    let kajiya = ShadingModel::KajiyaKay;
    for renderer in [
        Renderer::tiles(1),
        Renderer::tiles(4).with_shading(kajiya),
        Renderer::masks(4),
        Renderer::masks(1).with_shading(kajiya),
        Renderer::peeling(4),
        Renderer::alpha_to_coverage(4),
    ] {
        let view = view(context, renderer);
        // The second frame starts from what the first one left.
        for _ in 0..2 {
            output.images.push(draw(context, &view, &[&hair], &[&body]));
        }
    }
}

/// Three heads with one groom at changing levels of detail, in one image.
fn levels_of_detail(context: &Context, output: &mut Output) {
    let physics = physics(0.0);
    let first = hair(context, 960, &physics);
    let [second, third] = [(); 2].map(|()| Hair::new(first.asset()).unwrap());
    let mut heads = [first, second, third];
    let view = view(context, Renderer::tiles(4));
    for i in 0..6u32 {
        for (number, head) in (0u32..).zip(&mut heads) {
            let pixel = [0.0, 6e-3, 2e-3][((i + number) % 3) as usize];
            let detail = head.lod.detail(pixel, 100.0);
            head.set_detail(detail);
            let aside = Pose { translation: Vec3::X * 0.1 * number as f32, ..turned(i + number) };
            let frame = HairFrame { head: aside, ..step(i, &physics) };
            submit(context, |recorder| recorder.advance(head, &frame));
        }
        output.images.push(draw(context, &view, &[&heads[0], &heads[1], &heads[2]], &[]));
        output.guides.extend(heads.iter().map(|head| state(context, head)));
    }
}

/// Hair on a skinned ball that swells.
fn skin(context: &Context, output: &mut Output) {
    let physics = physics(0.0);
    let mesh = shapes::sphere(0.09, 24);
    let mut skinned = SkinnedHair::new(context, hair(context, 240, &physics), &mesh);
    let SkinnedHair { hair, body, rest } = &mut skinned;
    hair.attach(rest, &(&*body).into(), 0.02).unwrap();
    let view = view(context, Renderer::tiles(4));
    for i in 0..=4 {
        body.move_to(&common::moved(rest, |p| p * (1.0 + 0.01 * i as f32)));
        submit(context, |recorder| recorder.advance(hair, &step(i, &physics)));
        output.images.push(draw(context, &view, &[hair], &[body]));
        output.guides.push(state(context, hair));
    }
}

/// A lock that is grabbed, then a brush.
fn hands(context: &Context, output: &mut Output) {
    let physics = physics(0.0);
    let mut hair = hair(context, 300, &physics);
    let view = view(context, Renderer::masks(4));
    let ray = Ray { origin: Vec3::new(0.02, -0.03, 1.0), direction: Vec3::NEG_Z };
    let brush =
        MotionBrush { effect: BrushEffect::Comb, radius: 0.04, strength: 1.0, root_tip: 0.0, mirror: None };
    for i in 0..=9u32 {
        match i {
            2 => hair.grab(&ray, 0.015).unwrap(),
            3..5 => hair.drag_to(&GrabTarget::Point(Vec3::new(0.01 * i as f32, 0.0, 0.1))).unwrap(),
            5 => hair.release(),
            6.. => {
                let origin = ray.origin - Vec3::X * 0.01 * i as f32;
                hair.brush(&brush, &Ray { origin, ..ray }).unwrap();
            }
            _ => {}
        }
        submit(context, |recorder| recorder.advance(&mut hair, &step(i, &physics)));
        output.guides.push(state(context, &hair));
    }
    output.images.push(draw(context, &view, &[&hair], &[]));
}

/// Every debug view.
#[cfg(feature = "debug-views")]
fn debug_views(context: &Context, output: &mut Output) {
    use tresses::low_level::{DebugDisplay, DebugView, DebugViews, ViewContent};
    let physics = physics(6.0);
    let mut hair = hair(context, 240, &physics);
    let mut views = DebugViews::new(context, tresses::low_level::PICTURE_FORMAT).unwrap();
    views.set_head(Some(&common::ball(0.085, 24)));
    advance(context, &mut hair, &physics, 3);
    output.guides.push(state(context, &hair));
    let body = Body::new(context, &common::cube(0.05));
    let (view, picture) = (view(context, Renderer::masks(4)), picture());
    for debug in DebugView::ALL {
        let shown = DebugDisplay::new(debug);
        let drawing = Drawing { shows: ViewContent::Inside(&mut views, &shown), ..Drawing::new(&picture) };
        submit(context, |recorder| recorder.draw(&[&hair], &[&body], &view, drawing));
        output.images.push(pollster::block_on(view.targets().read()).unwrap());
    }
}

#[test]
fn order_of_workgroups_and_contents_of_memory_do_not_change_an_image() {
    let Some(context) = common::context() else { return };
    compare(context, 1, &[("hair in wind", in_wind)]);
}

#[test]
#[ignore = "proof"]
fn order_of_workgroups_and_contents_of_memory_change_nothing() {
    let Some(context) = common::context() else { return };
    let scenes: &[(&str, Scene)] = &[
        ("hair in wind", in_wind),
        ("renderers", renderers),
        ("levels of detail", levels_of_detail),
        ("skin", skin),
        ("hands", hands),
        #[cfg(feature = "debug-views")]
        ("debug views", debug_views),
    ];
    compare(context, ALL, scenes);
    // The kernels of GPUs keep the state of guides in workgroup memory.
    let mut tier = context.tier();
    tier.software = !tier.software;
    compare(
        &context.clone().with_tier(tier),
        ALL,
        &[("hair in wind", in_wind), ("levels of detail", levels_of_detail)],
    );
}

#[test]
fn new_memory_of_filled_contexts_is_nan() {
    let Some(context) = common::context() else { return };
    let (_, filled) = order::variants(context).next().unwrap();
    let words = |context: &Context| -> Vec<u32> {
        readback::buffer(context, &StrandBuffers::new(context, 3, 4).unwrap().vertices).unwrap()
    };
    assert!(words(&filled).iter().all(|word| *word == 0x7fff_7fff && f32::from_bits(*word).is_nan()));
    if std::env::var_os(order::VARIABLE).is_none() {
        assert!(words(context).iter().all(|word| *word == 0));
    }
}

/// Parses and validates a shader.
fn parsed(name: &str, wgsl: &str) -> naga::Module {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let module = naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|error| {
        panic!("{name}: {}", error.emit_to_string(wgsl));
    });
    let capabilities = Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let valid = Validator::new(ValidationFlags::all(), capabilities).validate(&module);
    valid.unwrap_or_else(|error| panic!("{name}: {error:?}"));
    module
}

#[test]
fn all_compute_shaders_are_rewritten() {
    let (mut mapped, mut filled) = (0, 0);
    for (name, wgsl) in shaders::all() {
        let before = parsed(name, wgsl);
        let uses = |entry: &naga::EntryPoint, builtins: &[naga::BuiltIn]| {
            let has = |argument: &naga::FunctionArgument| match argument.binding {
                Some(naga::Binding::BuiltIn(own)) => builtins.contains(&own),
                _ => false,
            };
            entry.function.arguments.iter().any(has)
        };
        use naga::BuiltIn::{GlobalInvocationId, NumWorkGroups, WorkGroupId};
        let positions =
            before.entry_points.iter().filter(|entry| uses(entry, &[WorkGroupId, GlobalInvocationId]));
        let positions = positions.count();
        for variant in ["reversed", "permuted"] {
            let text = order::rewritten(variant, wgsl);
            let after = parsed(name, &text);
            let both =
                |entry: &&naga::EntryPoint| uses(entry, &[WorkGroupId]) && uses(entry, &[NumWorkGroups]);
            assert_eq!(after.entry_points.iter().filter(both).count(), positions, "{name}");
            assert_eq!(text.matches("= order_map(").count(), positions, "{name}");
        }
        let text = order::rewritten("filled", wgsl);
        parsed(name, &text);
        mapped += positions;
        let stored = text.matches("order_word").count() > 0;
        assert_eq!(stored, wgsl.contains("var<workgroup>"), "{name}");
        filled += usize::from(stored);
    }
    println!("{mapped} entry points are mapped, {filled} shaders have workgroup memory");
    assert!(mapped > 60 && filled > 5, "{mapped} {filled}");
}

#[test]
fn permutations_reach_each_workgroup_once() {
    for count in (1u32..300).chain([4096, 65_535]) {
        let mut reached = vec![false; count as usize];
        for id in 0..count {
            // As `order_map` computes it, without overflow.
            let to =
                id.checked_mul(211_747 % count).and_then(|to| to.checked_add(count / 2)).unwrap() % count;
            assert!(!std::mem::replace(&mut reached[to as usize], true), "{count}");
        }
    }
}
