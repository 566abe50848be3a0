//! Guides to drawn strands on the GPU: rest reproduced, rigid motion exact, lengths kept.

use crate::common;

use tresses::{
    Pose,
    glam::{Quat, Vec3},
    gpu::{Gpu, readback::blocking as readback},
    groom::{BindOptions, Groom, GuideCount, bind},
    interpolate::{self, Interpolation},
    strands::{GuideBuffers, GuideSample, StrandBuffers, StrandVertex, vertex::unpack_tangent},
    tessellate::{self, TessellateParams, Tessellation, rest_samples},
    wgpu,
};

/// The drawn vertices when the guides are at `previous` and `current` (world, guide-major).
fn draw(
    gpu: &Gpu,
    groom: &Groom,
    previous: &[Vec3],
    current: &[Vec3],
    blend: f32,
    now: Pose,
) -> Vec<StrandVertex> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let n = groom.guides.vertex_count as usize;
    let samples = groom.strands.vertex_count.max(groom.guides.vertex_count);
    let guides = GuideBuffers::new(device, groom.guides.len() as u32, n as u32, samples).unwrap();
    let strands = StrandBuffers::new(device, groom.strands.len() as u32, groom.strands.vertex_count).unwrap();
    let state = |positions: &[Vec3]| {
        let moved = Groom {
            guides: tresses::groom::Guides { positions: positions.to_vec(), ..groom.guides.clone() },
            ..Default::default()
        };
        common::vertex_major(&moved)
    };
    let write = |buffer: &wgpu::Buffer, bytes: &[u8]| queue.write_buffer(buffer, 0, bytes);
    write(&guides.previous, bytemuck::cast_slice(&state(previous)));
    write(&guides.current, bytemuck::cast_slice(&state(current)));
    write(&guides.rest, bytemuck::cast_slice(&state(&groom.guides.positions)));
    let resting: Vec<_> = (0..groom.guides.len())
        .flat_map(|g| rest_samples(groom.guides.guide(g), samples))
        .map(GuideSample::at_rest)
        .collect();
    write(&guides.samples, bytemuck::cast_slice(&resting));
    write(&strands.bindings, bytemuck::cast_slice(&groom.strands.bindings));
    write(&strands.rest, bytemuck::cast_slice(&groom.strands.rest));

    let (tessellate, interpolate) = (tessellate::Pipelines::new(device), interpolate::Pipelines::new(device));
    let tessellation = Tessellation::new(device, &tessellate, &guides);
    let interpolation = Interpolation::new(device, &interpolate, &guides, &strands);
    tessellation.prepare(queue, &TessellateParams::new(&guides, &now, &now, &now, blend));
    interpolation.prepare(queue, &guides, &strands);
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = tresses::gpu::compute_pass(&mut encoder, &Default::default());
        tessellation.record(&tessellate, &mut pass, &guides);
        interpolation.record(&interpolate, &mut pass, &strands);
    }
    queue.submit([encoder.finish()]);
    readback::buffer(device, queue, &strands.vertices).unwrap()
}

/// The largest distance between drawn vertices and rest positions moved by `pose`.
fn error(groom: &Groom, drawn: &[StrandVertex], pose: Pose) -> f32 {
    let rest = (0..groom.strands.len()).flat_map(|i| groom.strands.rest_positions(i));
    drawn.iter().zip(rest).map(|(v, p)| v.position.distance(pose.point(p))).fold(0.0, f32::max)
}

#[test]
fn strands_at_rest_come_back_within_a_tenth_of_a_millimetre() {
    let Some(gpu) = common::gpu() else { return };
    for guides in [GuideCount::OneIn(16), GuideCount::All] {
        let groom =
            bind(&common::hanging(400, 16, 0.2), &BindOptions { guides, ..Default::default() }).unwrap();
        let rest = groom.guides.positions.clone();
        let drawn = draw(gpu, &groom, &rest, &rest, 0.3, Pose::IDENTITY);
        let off = error(&groom, &drawn, Pose::IDENTITY);
        assert!(off < 1e-4, "{off}");
        // The comparer notices a guide that is not at rest.
        let mut bent = rest.clone();
        bent[40] += Vec3::X * 0.01;
        assert!(error(&groom, &draw(gpu, &groom, &bent, &bent, 1.0, Pose::IDENTITY), Pose::IDENTITY) > 1e-4);
    }
}

#[test]
fn a_rigid_motion_of_the_guides_is_a_rigid_motion_of_the_strands() {
    let Some(gpu) = common::gpu() else { return };
    let groom = bind(&common::hanging(300, 16, 0.2), &BindOptions::default()).unwrap();
    let pose = Pose {
        rotation: Quat::from_rotation_y(2.0) * Quat::from_rotation_x(0.5),
        translation: Vec3::new(0.3, 1.0, -0.2),
    };
    let moved: Vec<_> = groom.guides.positions.iter().map(|p| pose.point(*p)).collect();
    let off = error(&groom, &draw(gpu, &groom, &moved, &moved, 0.5, pose), pose);
    assert!(off < 1e-4, "{off}");
}

#[test]
fn lengths_are_kept_and_tangents_follow_when_guides_bend_apart() {
    let Some(gpu) = common::gpu() else { return };
    let groom = bind(&common::hanging(400, 16, 0.25), &BindOptions::default()).unwrap();
    let n = groom.guides.vertex_count as usize;
    // Every guide swings by its own angle about its root.
    let swung: Vec<_> = (0..groom.guides.len())
        .flat_map(|g| {
            let turn =
                Quat::from_rotation_x((g as f32 * 1.7).sin()) * Quat::from_rotation_z((g as f32).cos());
            let root = groom.guides.guide(g)[0];
            groom.guides.guide(g).iter().map(move |p| root + turn * (*p - root)).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(swung.len(), groom.guides.len() * n);
    let drawn = draw(gpu, &groom, &swung, &swung, 1.0, Pose::IDENTITY);
    let m = groom.strands.vertex_count as usize;
    let mut moved = 0.0f32;
    for (i, strand) in drawn.chunks(m).enumerate() {
        let rest: Vec<_> = groom.strands.rest_positions(i).collect();
        let length: f32 = rest.windows(2).map(|w| w[0].distance(w[1])).sum();
        let now: f32 = strand.windows(2).map(|w| w[0].position.distance(w[1].position)).sum();
        assert!((now / length - 1.0).abs() < 0.001, "strand {i}: {now} for {length}");
        moved = moved.max(strand[m - 1].position.distance(rest[m - 1]));
        for w in strand.windows(3) {
            let (tangent, _) = unpack_tangent(w[1].tangent);
            let edge = |k: usize| (w[k + 1].position - w[k].position).normalize();
            assert!(tangent.dot((edge(0) + edge(1)).normalize()) > 0.999);
        }
    }
    assert!(moved > 0.05, "the guides did swing");
}
