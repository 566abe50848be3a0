//! Hair follows its entity, collides, blows in the wind, and writes motion vectors and depth for Bevy.

use crate::common::{Picture, SIZE, after, app, camera, groom, inside, light, middle, settled, wait};
use bevy::{
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        RenderApp,
        renderer::{RenderDevice, RenderQueue},
        view::ViewDepthStencilTexture,
    },
};
use bevy_tresses::{
    GlobalHairWind, Hair3d, HairCollider, HairDepth, HairGroom, HairHairCollision, HairMaterial3d, tri_mesh,
};
use tresses::{
    Context, Wind,
    light::HairMaterial,
    low_level::{Binding, bindings, readback},
    wgpu,
};

/// Returns the pixels of hair.
fn seen(app: &mut App, frames: usize, image: &Handle<Image>, bare: &Picture) -> Vec<[u32; 2]> {
    after(app, frames, image).changed(bare)
}

#[test]
fn hair_follows_joints_and_collides() {
    let mut app = app("assets");
    let light = light(&mut app);
    let (_, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    // Hair is a child of a joint that turns the head.
    let joint = app.world_mut().spawn((Transform::default(), Visibility::default())).id();
    let hair = app.world_mut().spawn((Hair3d(groom), ChildOf(joint))).id();
    wait(&mut app);
    let rest = seen(&mut app, 4, &image, &bare);
    assert!(rest.len() > 400, "{} pixels of hair", rest.len());

    // A rod along the viewing direction rises from below and lifts the hair.
    let at = |y: f32| {
        Transform::from_xyz(0.13, y, 0.0).with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2))
    };
    let rod = HairCollider::from(Capsule3d::new(0.03, 0.4));
    let rod = app.world_mut().spawn((rod, at(-0.2))).id();
    for step in 0..24 {
        app.world_mut().entity_mut(rod).insert(at(-0.2 + 0.008 * step as f32));
        app.update();
    }
    let lifted = seen(&mut app, 1, &image, &bare);
    assert!(
        middle(&rest).y - middle(&lifted).y > 2.0,
        "lifted from {} to {}",
        middle(&rest),
        middle(&lifted)
    );
    app.world_mut().despawn(rod);
    let fallen = seen(&mut app, 60, &image, &bare);
    assert!((middle(&rest) - middle(&fallen)).length() < 2.0, "{} {}", middle(&rest), middle(&fallen));

    // A box lifts it too. Its distance field rebuilds the hair.
    let beam: Mesh = Cuboid::new(0.06, 0.06, 0.5).into();
    let beam = HairCollider::mesh(&tri_mesh(&beam).expect("a box has triangles")).expect("a box is closed");
    let beam = app.world_mut().spawn((beam, Transform::from_xyz(0.13, -0.2, 0.0))).id();
    app.update();
    wait(&mut app);
    for step in 0..24 {
        app.world_mut().entity_mut(beam).insert(Transform::from_xyz(0.13, -0.2 + 0.008 * step as f32, 0.0));
        app.update();
    }
    let lifted = seen(&mut app, 1, &image, &bare);
    assert!(
        middle(&rest).y - middle(&lifted).y > 2.0,
        "lifted from {} to {}",
        middle(&rest),
        middle(&lifted)
    );
    app.world_mut().despawn(beam);
    app.update();
    wait(&mut app);
    let again = seen(&mut app, 4, &image, &bare);
    assert!((middle(&rest) - middle(&again)).length() < 1.0, "{} {}", middle(&rest), middle(&again));

    // Wind from the right blows hair back and up.
    app.world_mut().resource_mut::<GlobalHairWind>().0 = Wind::new(Vec3::new(-12.0, 6.0, 0.0));
    let blown = seen(&mut app, 25, &image, &bare);
    assert!((middle(&rest) - middle(&blown)).length() > 2.0, "{} {}", middle(&rest), middle(&blown));
    app.world_mut().resource_mut::<GlobalHairWind>().0 = Wind::default();

    // The joint turns by 180° in a second: the hair moves from right to left, then hangs as before.
    for step in 1..=60 {
        let turn = Quat::from_rotation_y(std::f32::consts::PI * step as f32 / 60.0);
        app.world_mut().entity_mut(joint).insert(Transform::from_rotation(turn));
        app.update();
    }
    let turned = seen(&mut app, 60, &image, &bare);
    let mirrored = Vec2::new(127.0 - middle(&rest).x, middle(&rest).y);
    assert!((middle(&turned) - mirrored).length() < 3.0, "{} {mirrored}", middle(&turned));
    assert!((middle(&rest) - mirrored).length() > 20.0, "the comparer sees no difference");

    // Hair responds to the scene's lights and to its material.
    let brightness = |app: &mut App| after(app, 2, &image).brightness(&turned);
    let brown = brightness(&mut app);
    app.world_mut().entity_mut(hair).insert(HairMaterial3d(HairMaterial::blond()));
    let blond = brightness(&mut app);
    app.world_mut().entity_mut(light).insert(Visibility::Hidden);
    let dark = brightness(&mut app);
    app.world_mut().spawn((
        PointLight { intensity: 200_000.0, ..Default::default() },
        Transform::from_xyz(0.0, 0.5, 1.0),
    ));
    let lamp = brightness(&mut app);
    assert!(blond > 1.5 * brown && dark < 0.5 * blond && lamp > 2.0 * dark, "{brown} {blond} {dark} {lamp}");
}

#[test]
fn hair_of_two_heads_collides() {
    let mut app = app("assets");
    light(&mut app);
    let (_, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    let left = app.world_mut().spawn(Hair3d(groom.clone())).id();
    // The second fan overlaps the first.
    let turned = Transform::from_rotation(Quat::from_rotation_y(std::f32::consts::PI));
    let facing = app.world_mut().spawn((Hair3d(groom), turned.with_translation(Vec3::X * 0.26))).id();
    wait(&mut app);
    let through = seen(&mut app, 40, &image, &bare);
    app.world_mut().entity_mut(left).insert(HairHairCollision);
    let alone = seen(&mut app, 40, &image, &bare);
    app.world_mut().entity_mut(facing).insert(HairHairCollision);
    let beside = seen(&mut app, 40, &image, &bare);
    let differ = |a: &[[u32; 2]], b: &[[u32; 2]]| a.iter().filter(|p| !b.contains(p)).count();
    assert!(differ(&alone, &through) < 10, "there is nobody to meet: {}", differ(&alone, &through));
    assert!(differ(&beside, &through) > 60, "{} pixels of {}", differ(&beside, &through), through.len());
}

/// Reads a texture that cannot be copied, through `binding`, pixel by pixel.
fn texels(app: &App, view: &wgpu::TextureView, binding: Binding) -> Vec<Vec2> {
    let world = app.sub_app(RenderApp).world();
    let device = world.resource::<RenderDevice>().wgpu_device();
    let queue = world.resource::<RenderQueue>();
    let [width, height] = SIZE;
    let (kind, load) = match binding {
        Binding::Depth => ("texture_depth_2d", "vec2(textureLoad(map, at, 0))"),
        Binding::DepthMultisampled => ("texture_depth_multisampled_2d", "vec2(textureLoad(map, at, 3))"),
        _ => ("texture_2d<f32>", "textureLoad(map, at, 0).xy"),
    };
    let shader = format!(
        "@group(0) @binding(0) var map: {kind};
        @group(0) @binding(1) var<storage, read_write> out: array<vec2<f32>>;
        @compute @workgroup_size(1) fn read(@builtin(global_invocation_id) id: vec3<u32>) {{
            let at = vec2<i32>(id.xy);
            out[id.y * {width}u + id.x] = {load};
        }}"
    );
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(shader.into()),
    });
    let entries = [binding, Binding::StorageMut];
    let layout = bindings::layout(device, "texels", wgpu::ShaderStages::COMPUTE, &entries);
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        })),
        module: &module,
        entry_point: Some("read"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 8 * u64::from(width * height),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let bound = [wgpu::BindingResource::TextureView(view), buffer.as_entire_binding()];
    let group = bindings::group(device, "texels", &layout, &bound);
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(width, height, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    let found = readback::blocking::buffer::<[f32; 2]>(&Context::new(device, queue), &buffer)
        .expect("the device is there");
    found.into_iter().map(Vec2::from_array).collect()
}

/// Returns the motion vectors of a camera after the last frame.
fn vectors(app: &mut App) -> Vec<Vec2> {
    let world = app.sub_app_mut(RenderApp).world_mut();
    let found = world.query::<&ViewPrepassTextures>().iter(world).next().expect("there is a prepass");
    let motion = found.motion_vectors.as_ref().expect("that has motion").texture.default_view.clone();
    texels(app, &motion, Binding::Texels2d)
}

/// Returns the depth of a camera after the last frame: 1 at the near plane.
fn depths(app: &mut App) -> Vec<f32> {
    let world = app.sub_app_mut(RenderApp).world_mut();
    let found = world.query::<&ViewDepthStencilTexture>().iter(world).next().expect("there is a camera");
    let many = found.texture().sample_count() > 1;
    let view = found.attachment.texture.default_view.clone();
    let binding = if many { Binding::DepthMultisampled } else { Binding::Depth };
    texels(app, &view, binding).into_iter().map(|depth| depth.x).collect()
}

#[test]
fn hair_depth_writes_depth() {
    let mut app = app("assets");
    light(&mut app);
    let (eye, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    app.world_mut().spawn(Hair3d(groom));
    wait(&mut app);
    let hair = inside(&seen(&mut app, 4, &image, &bare));
    assert!(hair.len() > 200, "{} pixels of hair", hair.len());
    for msaa in [Msaa::Off, Msaa::Sample4] {
        app.world_mut().entity_mut(eye).insert(msaa);
        app.world_mut().entity_mut(eye).remove::<HairDepth>();
        let before = after(&mut app, 4, &image);
        assert!(depths(&mut app).iter().all(|depth| *depth == 0.0), "{msaa:?}: there is nothing but hair");
        app.world_mut().entity_mut(eye).insert(HairDepth);
        assert!(after(&mut app, 4, &image).is(&before), "{msaa:?}: the picture is the same");
        // The near plane is at 10 cm, hair half a meter away, give or take the fan's thickness of 4 cm.
        let found = depths(&mut app);
        let depth = |[x, y]: &[u32; 2]| found[(y * 128 + x) as usize];
        let right = hair.iter().filter(|at| (depth(at) - 0.2).abs() < 0.025).count();
        let none = hair.iter().filter(|at| depth(at) == 0.0).count();
        assert!(right * 20 > 19 * hair.len(), "{msaa:?}: {right} of {} pixels are as deep", hair.len());
        assert_eq!(right + none, hair.len(), "{msaa:?}: what is thin writes nothing");
        assert!((0..96).all(|y| found[y * 128 + 4] == 0.0), "{msaa:?}: and nothing beside it");
    }
}

#[test]
fn hair_writes_motion_vectors() {
    let mut app = app("assets");
    light(&mut app);
    let (eye, image) = camera(&mut app);
    app.world_mut().entity_mut(eye).insert(bevy::core_pipeline::prepass::MotionVectorPrepass);
    let bare = settled(&mut app, &image);
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    app.world_mut().spawn(Hair3d(groom));
    wait(&mut app);
    let still = seen(&mut app, 30, &image, &bare);
    assert!(still.len() > 400, "{} pixels of hair", still.len());
    let at = |[x, y]: &[u32; 2], vectors: &[Vec2]| vectors[(y * 128 + x) as usize];
    let found = vectors(&mut app);
    let moved = inside(&still).iter().filter(|place| at(place, &found).length() > 2e-3).count();
    assert!(moved * 20 < still.len(), "{moved} of {} pixels of hair that stands still move", still.len());
    // The camera moves right by 4 mm per frame, so hair half a meter away moves left in the image.
    let way = 0.004;
    for step in 1..6 {
        let place = Transform::from_xyz(way * step as f32, 0.0, 0.5);
        app.world_mut().entity_mut(eye).insert(place);
        app.update();
    }
    let hair = inside(&seen(&mut app, 0, &image, &bare));
    let found = vectors(&mut app);
    let expected = -way / (2.0 * 0.5 * 0.4_f32.tan() * 128.0 / 96.0);
    let (mut right, mut sum) = (0, 0.0);
    for place in &hair {
        let moved = at(place, &found);
        sum += moved.x / hair.len() as f32;
        right += usize::from((moved.x / expected - 1.0).abs() < 0.15 && moved.y.abs() < 2e-3);
    }
    println!(
        "hair moves by {sum} of the picture's width, expected {expected}; {right} of {} pixels",
        hair.len()
    );
    assert!(right * 10 > 9 * hair.len() && hair.len() > 200);
    // Next to hair, the motion of the prepass stays: zero.
    let beside = (0..96).map(|y| at(&[4, y], &found).length()).fold(0.0, f32::max);
    assert_eq!(beside, 0.0);
}
