//! A kernel that fails to compile is an error where it is recorded, and nowhere else. Needs no GPU.

use crate::common;
use tresses::{
    Body, Context, Error, HairOptions, Picture, Pose, Result, SimulationParams, View, ViewOptions, Wind,
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, FieldId, FieldSource},
    drape::{DrapeOptions, drape},
    glam::{Mat3, Mat4, Vec3},
    groom::{
        TriMesh, bind,
        mesh::shapes,
        rig::{Bind, Joint, Node, Rig, RigPose},
    },
    low_level::{
        AmbientProbe, CubeMap, CubeProbe, DebugDisplay, DebugView, DebugViews, DeformTarget, DeformingField,
        Detail, Drawing, FieldBuilder, GridView, HairFrame, HairSet, Peak, ShadowProbe, Skin, StrandBuffers,
        ViewContent,
    },
    renderer::Renderer,
    simulate::GuideTraits,
    skinning::Skinning,
    views::Quantity,
    wgpu,
};

type Operation = fn(&Context) -> Result<()>;

/// One module of each folder that records kernels, an operation that records it, and one that does not.
const CASES: [(&str, Operation, Operation); 23] = [
    ("skinning::skin", bend, draw),
    ("roots::strands", advance, draw),
    ("collide::deform::gather", advance, draw),
    ("collide::build::flood", build_field, draw),
    ("volume::density", advance, draw),
    ("wind::predict", advance, draw),
    ("simulate::step::32", advance, draw),
    ("simulate::step::8", let_fall, advance),
    ("simulate::grab::pick", advance, draw),
    ("tessellate::spline", advance, draw),
    ("interpolate::blend", advance, draw),
    ("lod::widths", advance, draw),
    ("avoid::first_hit", advance, draw),
    ("light::splat::0", draw, advance),
    ("light::ambient::settle", draw, advance),
    ("light::select_visible", draw, advance),
    ("light::probe", ask_shadows, draw),
    ("light::ambient::query", ask_ambient, draw),
    ("light::cube", measure_cube, draw),
    ("draw::soft::list", draw, advance),
    ("draw::tiles::sort", draw, advance),
    ("views::strands", debug_view, draw),
    ("views::peak", measure_peak, draw),
];

#[test]
fn invalid_kernel_fails_where_it_is_recorded() {
    for (module, operation, unrelated) in CASES {
        let context = common::noop().with_broken(module);
        match operation(&context) {
            Err(Error::Gpu { stage, .. }) => assert_eq!(stage, module),
            other => panic!("{module}: {other:?}"),
        }
        unrelated(&context).unwrap_or_else(|error| panic!("{module}: {error}"));
    }
}

#[test]
fn valid_kernels_do_not_fail() {
    let context = &common::noop();
    let mut all: Vec<Operation> = Vec::new();
    for (_, operation, _) in CASES {
        if !all.iter().any(|other| std::ptr::fn_addr_eq(*other, operation)) {
            all.push(operation);
        }
    }
    all.into_iter().try_for_each(|operation| operation(context)).unwrap();
}

fn encoder(context: &Context) -> wgpu::CommandEncoder {
    context.device().create_command_encoder(&Default::default())
}

/// Returns a ball with normals.
fn ball() -> TriMesh {
    let mut mesh = shapes::sphere(0.085, 12);
    mesh.compute_normals();
    mesh
}

/// Advances hair on skin, in wind, held by a grab.
fn advance(context: &Context) -> Result<()> {
    let groom = bind(&common::hanging(50, 16, 0.12), &Default::default())?;
    let (field, mesh) = (common::ball(0.085, 16), ball());
    let what = ColliderDescriptor {
        rest: Some(&field),
        fields: &[FieldSource::Grid(&field)],
        colliders: &[tresses::collide::Collider::new(tresses::collide::Shape::Field(FieldId(0)))],
        ..Default::default()
    };
    let mut hair = common::hair_among(context, &groom, &HairOptions::default(), &what)?;
    let body = Body::with_levels(context, &mesh, &[], 4);
    let skin = Skin::from(&body);
    hair.attach(&mesh, &skin, 0.1)?;
    let deforming = DeformingField { which: DeformTarget::Field(FieldId(0)), triangles: &mesh.triangles };
    hair.colliders.deform(&mesh, &skin, &[deforming])?;
    hair.set_detail(Detail { strand_count: 20, ..*hair.lod.current() });
    let physics = SimulationParams { wind: Wind::new(Vec3::X), ..Default::default() };
    let colliders = ColliderPoses { head: None, colliders: vec![Pose::IDENTITY] };
    let frame =
        HairFrame { dt: 1.0 / 60.0, colliders: &colliders, simulation: &physics, ..Default::default() };
    let mut encoder = encoder(context);
    let mut recorder = context.recorder(&mut encoder);
    recorder.advance(&mut hair, &frame)?;
    hair.grab(&Picture::default().camera.ray(20.0, 30.0), 0.02)?;
    recorder.advance(&mut hair, &frame)?;
    context.queue().submit([encoder.finish()]);
    Ok(())
}

/// Creates strands that are not simulated, and a view with tiles.
fn still(context: &Context) -> Result<(HairSet, View)> {
    let options = ViewOptions { renderer: Renderer::tiles(1), ..Default::default() };
    let strands = StrandBuffers::new(context, 50, 16)?;
    Ok((HairSet::new(context, &strands)?, View::new(context, &options, [64, 40], 1)?))
}

fn draw(context: &Context) -> Result<()> {
    let (hair, view) = still(context)?;
    let body = Body::with_levels(context, &ball(), &[], 4);
    let mut encoder = encoder(context);
    let picture = Picture::default();
    context.recorder(&mut encoder).draw_strands(&[&hair], &[&body], &view, Drawing::new(&picture))?;
    context.queue().submit([encoder.finish()]);
    Ok(())
}

fn bend(context: &Context) -> Result<()> {
    let mesh = ball();
    let mut body = Body::with_levels(context, &mesh, &[], 4);
    let first = |(position, normal): (&Vec3, &Vec3)| {
        let weights = std::array::from_fn(|k| f32::from(u8::from(k == 0)));
        Bind { position: *position, normal: *normal, joints: [0; 8], weights }
    };
    let rig = Rig {
        nodes: vec![Node::default()],
        joints: vec![Joint { node: 0, inverse_bind: Mat4::IDENTITY }],
        vertices: mesh.positions.iter().zip(&mesh.normals).map(first).collect(),
        ..Default::default()
    };
    let mut skinning = Skinning::new(context, &rig, &body)?;
    let pose = RigPose { palette: vec![Mat4::from_translation(Vec3::X)], ..Default::default() };
    skinning.pose(&pose, &mut body)?;
    context.recorder(&mut encoder(context)).bend(&[&skinning])
}

fn build_field(context: &Context) -> Result<()> {
    let (builder, mesh) = (FieldBuilder::new(context), ball());
    let fields = [FieldSource::Mesh { builder: &builder, mesh: &mesh, options: &Default::default() }];
    let what = ColliderDescriptor { fields: &fields, ..Default::default() };
    ColliderSet::new(context, &what).map(|_| ())
}

fn let_fall(context: &Context) -> Result<()> {
    let positions: Vec<_> = (0..8).map(|i| Vec3::Y * 0.01 * i as f32).collect();
    let options = DrapeOptions { seconds: 0.1, ..Default::default() };
    let (traits, params) = ([GuideTraits::default()], SimulationParams::default());
    pollster::block_on(drape(context, &positions, 8, &traits, &params, None, &options)).map(|_| ())
}

fn ask_shadows(context: &Context) -> Result<()> {
    let (_, view) = still(context)?;
    ShadowProbe::new(context, &view.light, &[Vec3::ZERO], None)?.record(&mut encoder(context))
}

fn ask_ambient(context: &Context) -> Result<()> {
    let (_, view) = still(context)?;
    AmbientProbe::new(context, &view.light, &[(Vec3::ZERO, Vec3::ZERO)])?.record(&mut encoder(context))
}

/// Creates a texture with one texel per layer.
fn texture(context: &Context, dimension: wgpu::TextureDimension, layers: u32) -> wgpu::Texture {
    let size = wgpu::Extent3d { depth_or_array_layers: layers, ..common::TEXTURE.size };
    context.device().create_texture(&wgpu::TextureDescriptor { size, dimension, ..common::TEXTURE })
}

fn measure_cube(context: &Context) -> Result<()> {
    let view = texture(context, wgpu::TextureDimension::D2, 6).create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    });
    CubeProbe::new(context).measure(&view, CubeMap::Radiance, Mat3::IDENTITY).map(|_| ())
}

fn debug_view(context: &Context) -> Result<()> {
    let groom = bind(&common::hanging(50, 16, 0.12), &Default::default())?;
    let mut hair = common::hair(context, &groom, &HairOptions::default(), None)?;
    context.recorder(&mut encoder(context)).advance(&mut hair, &HairFrame::default())?;
    let (_, view) = still(context)?;
    let mut views = DebugViews::new(context, tresses::low_level::PICTURE_FORMAT)?;
    let (shown, picture) = (DebugDisplay::new(DebugView::Locks), Picture::default());
    let sight = Drawing { shows: ViewContent::Inside(&mut views, &shown), ..Drawing::new(&picture) };
    context.recorder(&mut encoder(context)).draw(&[&hair], &[], &view, sight)
}

fn measure_peak(context: &Context) -> Result<()> {
    let texture = texture(context, wgpu::TextureDimension::D3, 1).create_view(&Default::default());
    let grid = GridView {
        texture: &texture,
        pose: Pose::IDENTITY,
        scale: Vec3::ONE,
        bias: Vec3::ZERO,
        quantity: Quantity::Length,
        rotates: false,
    };
    pollster::block_on(Peak::new(context).measure(&grid)).map(|_| ())
}
