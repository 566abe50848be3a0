//! Compares the views with synthetic grids of known integrals, directions and positions.

use super::{arrows::ArrowsKernel, guides::GuidesKernel, streams::StreamsKernel, *};
use crate::{
    Context, Pose,
    camera::Camera,
    draw::targets::PICTURE_FORMAT,
    gpu::{for_tests as context, readback::blocking as readback},
    renderer::Renderer,
    strands::{Guide, GuideRest, GuideSample, PackedGuide, guide::pack_velocity},
};
use glam::{Mat4, Quat, UVec3, Vec3, Vec4};
use half::f16;
use wgpu::util::DeviceExt;

/// Creates a texture of `n`³ texels whose value at texture coordinate `c` is `f(c)`.
fn texture(context: &Context, n: u32, f: impl Fn(Vec3) -> Vec4) -> wgpu::TextureView {
    let texels: Vec<[f16; 4]> = (0..n * n * n)
        .map(|i| {
            let place = UVec3::new(i % n, i / n % n, i / (n * n));
            f((place.as_vec3() + 0.5) / n as f32).to_array().map(f16::from_f32)
        })
        .collect();
    let descriptor = wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width: n, height: n, depth_or_array_layers: n },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let bytes: &[u8] = bytemuck::cast_slice(&texels);
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    context
        .device()
        .create_texture_with_data(context.queue(), &descriptor, order, bytes)
        .create_view(&Default::default())
}

/// A box of 20 cm around the origin of `pose`.
fn grid(texture: &wgpu::TextureView, pose: Pose, quantity: Quantity) -> GridView<'_> {
    GridView { texture, pose, scale: Vec3::splat(5.0), bias: Vec3::splat(0.5), quantity, rotates: true }
}

/// An orthographic camera along -Z, 30 cm wide and high. The near plane is at z = 1 m, the far plane at z = -1 m.
fn view() -> Camera {
    let half = 0.15;
    Camera {
        view: Mat4::IDENTITY,
        projection: Mat4::from_cols_array_2d(&[
            [1.0 / half, 0.0, 0.0, 0.0],
            [0.0, 1.0 / half, 0.0, 0.0],
            [0.0, 0.0, 0.5, 0.0],
            [0.0, 0.0, 0.5, 1.0],
        ]),
        size: [128, 128],
    }
}

/// Returns the buffer that `record` has filled.
fn points(context: &Context, record: impl FnOnce(&mut Canvas<'_, '_>) -> wgpu::Buffer) -> Vec<LinePoint> {
    let (device, queue) = (context.device(), context.queue());
    let debug = DebugStage::new(context, PICTURE_FORMAT).unwrap();
    let targets = crate::draw::Targets::new(context, [16, 16], Renderer::masks(1), 1).unwrap();
    let uniform = constant(device, "view", &view().uniform(1, 1));
    let group = context.device.group("view", &debug.view_layout, &[uniform.as_entire_binding()]);
    let mut encoder = device.create_command_encoder(&Default::default());
    let buffer = record(&mut Canvas {
        device: &context.device,
        commands: &mut context.commands(&mut encoder),
        output: targets.picture(),
        depth: targets.picture(),
        camera: &view(),
        view: &group,
        sampler: &debug.sampler,
        encode: true,
    });
    queue.submit([encoder.finish()]);
    readback::buffer(context, &buffer).unwrap()
}

const PLACE: Vec3 = Vec3::new(0.02, -0.03, 0.04);

fn turned() -> Pose {
    Pose { rotation: Quat::from_euler(glam::EulerRot::YXZ, 0.6, 0.4, -0.3), translation: PLACE }
}

const SPIN: f32 = 12.0;

/// A field that rotates about the y axis of the box at 12 rad/s, in m/s.
fn spinning(context: &Context) -> wgpu::TextureView {
    texture(context, 32, |c| ((c - 0.5) / 5.0).cross(Vec3::NEG_Y * SPIN).extend(0.0))
}

#[test]
fn arrows_point_along_the_field() {
    let Some(context) = context() else { return };
    let texture = spinning(context);
    for turns in [true, false] {
        let pose = turned();
        let grid = GridView { rotates: turns, ..grid(&texture, pose, Quantity::Length) };
        let arrows = Arrows::over(&grid, Some((1, 0.25)), 8, 1.0);
        let kernel = ArrowsKernel::new(context);
        let points = points(context, |canvas| kernel.record(canvas, &grid, &arrows).unwrap());
        assert_eq!(points.len(), 4 * 64);
        let mut shown = 0;
        for arrow in points.as_chunks::<4>().0 {
            let middle = 0.5 * (arrow[0].position + arrow[3].position);
            let inner = pose.inverse().point(middle);
            assert!((inner.y + 0.05).abs() < 1e-5, "on the plane");
            let local = inner.cross(Vec3::NEG_Y * SPIN) * Vec3::new(1.0, 0.0, 1.0);
            let vector = if turns { pose.rotation * local } else { local };
            if arrow[0].alpha < 0.0 {
                assert!(vector.length() < 0.03);
                continue;
            }
            shown += 1;
            let way = arrow[3].position - arrow[0].position;
            let expected = (vector * arrows.seconds).clamp_length_max(arrows.longest);
            assert!((way - expected).length() < 1e-2 * arrows.longest, "{way} for {expected}");
            assert!((way - pose.rotation.conjugate() * expected).length() > 1e-2 * arrows.longest);
            assert!((arrow[0].value - vector.length()).abs() < 2e-3 * vector.length().max(0.1));
            assert!(arrow[2].width > arrow[1].width && arrow[3].width == 0.0);
        }
        assert_eq!(shown, 64);
    }
}

#[test]
fn streamlines_follow_circles() {
    let Some(context) = context() else { return };
    let texture = spinning(context);
    let grid = grid(&texture, turned(), Quantity::Length);
    let radii = [0.03, 0.05, 0.07];
    let seeds: Vec<_> = radii.iter().map(|r| grid.pose.point(Vec3::new(*r, 0.02, 0.0))).collect();
    let kernel = StreamsKernel::new(context);
    let drift = |step: f32, least: f32| {
        let streams = Streams { seeds: &seeds, points: 64, step, min_speed: least };
        let points = points(context, |canvas| kernel.record(canvas, &grid, &streams).unwrap().unwrap());
        let mut worst = 0.0f32;
        for (line, radius) in points.chunks(64).zip(radii) {
            for (k, point) in line.iter().enumerate().filter(|(_, p)| p.alpha >= 0.0) {
                let p = grid.pose.inverse().point(point.position);
                assert!((p.y - 0.02).abs() < 1e-4);
                worst = worst.max((p.x.hypot(p.z) / radius - 1.0).abs());
                assert!((point.value - SPIN * radius).abs() < 0.02 * SPIN * radius || step > 0.01);
                if k == 10 {
                    // Distance traveled and sense of rotation: about +Y.
                    assert!(
                        ((-p.z).atan2(p.x) - k as f32 * step / radius).abs() < 0.02 || step > 0.01,
                        "{p}"
                    );
                }
            }
        }
        let shown = points.chunks(64).map(|line| line.iter().filter(|p| p.alpha >= 0.0).count());
        (worst, shown.collect::<Vec<_>>())
    };
    let (worst, shown) = drift(0.004, 0.0);
    println!("streamlines drift by {:.2} %", 100.0 * worst);
    assert!(worst < 0.01 && shown == [64; 3], "{worst} {shown:?}");
    // Coarse steps leave the circles, which shows that the test is sensitive.
    assert!(drift(0.05, 0.0).0 > 0.05);
    // There are no lines where the field is slower than the minimum.
    assert_eq!(drift(0.004, 0.5).1, [0, 64, 64]);
}

#[test]
fn seeds_lie_upwind_inside_the_box() {
    let Some(context) = context() else { return };
    let texture = texture(context, 2, |_| Vec4::ZERO);
    let grid = grid(&texture, Pose { translation: PLACE, ..Pose::IDENTITY }, Quantity::Length);
    let seeds = Streams::upwind(&grid, Vec3::X, 5);
    assert_eq!(seeds.len(), 25);
    for seed in &seeds {
        let local = *seed - PLACE;
        assert!((local.x + 0.098).abs() < 1e-4 && local.abs().max_element() < 0.1, "{local}");
    }
    let spread = seeds.iter().map(|s| (s.y - PLACE.y).abs()).fold(0.0, f32::max);
    assert!(spread > 0.07);
}

#[test]
fn guides_show_speed_strain_and_index() {
    let Some(context) = context() else { return };
    let (count, vertices, samples) = (3, 4, 7);
    let guides = GuideBuffers::new(context, count, vertices, samples).unwrap();
    let n = (count * vertices) as usize;
    // Vertex-major: guide g moves at g + v m/s; its edges are stretched by 0.1 g.
    let at = |i: usize| ((i % count as usize) as f32, (i / count as usize) as f32);
    let velocity: Vec<_> = (0..n).map(|i| pack_velocity(Vec3::new(0.0, at(i).0 + at(i).1, 0.0))).collect();
    let current: Vec<_> =
        (0..n).map(|i| [at(i).0, -0.01 * at(i).1 * (1.0 + 0.1 * at(i).0), 0.0, 0.0]).collect();
    // At rest, 1 cm apart, downwards.
    let info = vec![Guide { extent: 0.03, ..Guide::default() }; count as usize];
    let place = |i| GuideRest { position: Vec3::new(0.0, 0.03 - 0.01 * at(i).1, 0.0), contact: 0.0 };
    let rest: Vec<_> =
        (0..n).map(|i| PackedGuide::pack(&place(i), Vec3::ZERO, 0.0, 0.01, &info[0])).collect();
    let sampled: Vec<_> = (0..count * samples).map(|i| GuideSample::at_rest(Vec3::splat(i as f32))).collect();
    let write = |buffer: &wgpu::Buffer, bytes: &[u8]| context.queue().write_buffer(buffer, 0, bytes);
    write(&guides.velocity, bytemuck::cast_slice(&velocity));
    write(&guides.current, bytemuck::cast_slice(&current));
    write(&guides.info, bytemuck::cast_slice(&info));
    write(&guides.rest, bytemuck::cast_slice(&rest));
    write(&guides.samples, bytemuck::cast_slice(&sampled));
    let kernel = GuidesKernel::new(context);
    for quantity in [GuideQuantity::Speed, GuideQuantity::Strain, GuideQuantity::Guide] {
        let points =
            points(context, |canvas| kernel.record(canvas, &guides, &Pose::IDENTITY, quantity).unwrap());
        assert_eq!(points.len(), 21);
        for (i, point) in points.iter().enumerate() {
            let (guide, sample) = ((i / 7) as f32, (i % 7) as f32);
            let expected = match quantity {
                GuideQuantity::Speed => guide + 0.5 * sample,
                GuideQuantity::Strain => 0.1 * guide,
                GuideQuantity::Guide => 0.0,
            };
            let tint = if quantity == GuideQuantity::Guide { 1 + i as u32 / 7 } else { 0 };
            assert_eq!(point.tint, tint);
            assert!((point.value - expected).abs() < 1e-4, "{quantity:?} {i}: {}", point.value);
            assert_eq!(point.position, Vec3::splat(i as f32));
        }
    }
}

#[test]
fn peak_finds_the_largest_value() {
    let Some(context) = context() else { return };
    let texture = texture(context, 20, |c| {
        let here = (c - Vec3::new(0.975, 0.525, 0.925)).length() < 1e-3;
        Vec4::new(0.5, 0.0, 0.0, if here { 7.0 } else { -1.0 })
    });
    let peak = Peak::new(context);
    let measure = |q| pollster::block_on(peak.measure(&grid(&texture, Pose::IDENTITY, q))).unwrap();
    assert_eq!(measure(Quantity::Channel(3)), 7.0);
    assert_eq!(measure(Quantity::Length), 0.5);
    assert_eq!(measure(Quantity::Channel(1)), 0.0);
}
