//! Every pipeline can be built on wgpu's noop backend: shaders and bindings are valid. Needs no GPU.

use crate::common;

use tresses::{PipelineRequest, glam};

#[test]
fn simulation_pipelines_are_valid() {
    let context = &common::noop();
    let steps = [2, 8, 16, 24, 32, 48, 64].map(PipelineRequest::Step);
    pollster::block_on(context.prepare(&steps, &())).unwrap();
    let guides = tresses::low_level::GuideBuffers::new(context, 4, 16, 2).unwrap();
    tresses::simulate::Simulation::new(context, &guides);
}

/// Records all of the library within the default limits of WebGPU and without any optional feature.
#[test]
fn frame_records_on_baseline_webgpu() {
    use tresses::{
        Body, HairOptions, Picture, Pose, SimulationParams, View,
        collide::{Anchor, Collider, ColliderDescriptor, ColliderPoses, FieldId, FieldSource, Shape},
        groom::{BindOptions, TriMesh, bind},
        low_level::{DebugDisplay, DebugView, DebugViews, Drawing, FieldBuilder, HairFrame, ViewContent},
    };
    let context = &common::noop();
    assert_eq!(context.device().limits().max_storage_buffers_per_shader_stage, 8);
    let groom = bind(&common::hanging(50, 16, 0.1), &BindOptions::default()).unwrap();
    let field = common::ball(0.09, 16);
    let options = HairOptions::default();
    // The maximum number of colliders.
    let shapes = [
        Shape::sphere(0.1),
        Shape::Ellipsoid { radii: glam::Vec3::new(0.1, 0.2, 0.3) },
        Shape::Field(FieldId(0)),
        Shape::Field(FieldId(1)),
    ];
    let list: Vec<_> = (0..127)
        .map(|i| Collider { anchor: [Anchor::World, Anchor::Head][i % 2], ..Collider::new(shapes[i % 4]) })
        .collect();
    let builder = FieldBuilder::new(context);
    let cube = common::cube(0.1);
    let made = FieldSource::Mesh { builder: &builder, mesh: &cube, options: &Default::default() };
    let fields = [FieldSource::Grid(&field), made];
    let colliders =
        ColliderDescriptor { head: Some(&field), fields: &fields, colliders: &list, ..Default::default() };
    let mut hair = common::hair_among(context, &groom, &options, &colliders).unwrap();
    let more = [list.as_slice(), &list[..1]].concat();
    let error = |colliders: &ColliderDescriptor<'_>| {
        common::hair_among(context, &groom, &options, colliders).unwrap_err().to_string()
    };
    assert!(
        error(&ColliderDescriptor { colliders: &more, ..colliders })
            .contains("129 exceed the maximum of 128")
    );
    assert!(
        error(&ColliderDescriptor { fields: &fields[..1], ..colliders }).contains("field 1 does not exist")
    );
    let triangle = TriMesh {
        positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
        normals: vec![glam::Vec3::Z; 3],
        triangles: vec![[0, 1, 2]],
        ..Default::default()
    };
    let body = Body::new(context, &triangle);
    let view = View::new(context, &Default::default(), [64, 64], 1).unwrap();
    let input = HairFrame {
        dt: 1.0 / 60.0,
        head: Pose::IDENTITY,
        colliders: &ColliderPoses { head: None, colliders: vec![Pose::IDENTITY; 127] },
        simulation: &SimulationParams { wind: tresses::Wind::new(glam::Vec3::X), ..Default::default() },
        ..Default::default()
    };
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut recorder = context.recorder(&mut encoder);
    recorder.advance(&mut hair, &input).unwrap();
    let picture = Picture::default();
    recorder.draw(&[&hair], &[&body], &view, Drawing::new(&picture)).unwrap();
    // A grab, and every debug view.
    hair.grab(&picture.camera.ray(20.0, 30.0), 0.02).unwrap();
    recorder.advance(&mut hair, &input).unwrap();
    hair.drag_to(&tresses::low_level::GrabTarget::Ray(picture.camera.ray(30.0, 30.0))).unwrap();
    recorder.advance(&mut hair, &input).unwrap();
    assert!(hair.grabbed().is_active() && hair.grabbed().state().is_some());
    let mut views = DebugViews::new(context, tresses::low_level::PICTURE_FORMAT).unwrap();
    views.set_head(Some(&field));
    for what in DebugView::ALL {
        let shown = DebugDisplay::new(what);
        let sight = Drawing { shows: ViewContent::Inside(&mut views, &shown), ..Drawing::new(&picture) };
        recorder.draw(&[&hair], &[&body], &view, sight).unwrap();
    }
    context.queue().submit([encoder.finish()]);
    assert!(hair.bytes() > 50 * 31 * 16);
}
