//! Every pipeline of light, draw and present is valid within baseline limits. No GPU needed.

use tresses::{
    draw::{Body, DrawOptions, DrawStage, HairSet, Scene, Targets},
    groom::TriMesh,
    light::ShadingRate,
    strands::StrandBuffers,
};

/// Builds and records a whole frame with `samples` per pixel; what wgpu objects to.
fn frame(samples: u32, target_samples: u32) -> Option<wgpu::Error> {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let stage = DrawStage::new(&device, &DrawOptions { samples, ..Default::default() });
    let strands = StrandBuffers::new(&device, 5000, 16).expect("small enough");
    let hair = HairSet::new(&device, &stage, &strands).expect("small enough");
    let body = Body::new(&device, &stage, &TriMesh::default());
    let targets = Targets::new(&device, 64, 40, target_samples, 2).expect("a fair size");
    for shading in [ShadingRate::PerPixel, ShadingRate::PerVertex] {
        let scene = Scene { shading, ..Default::default() };
        let mut encoder = device.create_command_encoder(&Default::default());
        stage.prepare(&queue, &scene, &targets, Some(&hair), Some(&body));
        stage.shadow(&mut encoder, None, Some(&hair), Some(&body));
        stage.shade(&mut encoder, None, &hair);
        stage.draw(&mut encoder, None, &scene, &targets, Some(&hair), Some(&body));
        stage.present(&device, &mut encoder, None, &targets, targets.picture());
        queue.submit([encoder.finish()]);
    }
    pollster::block_on(scope.pop())
}

#[test]
fn a_frame_is_valid() {
    for samples in [1, 4] {
        let error = frame(samples, samples);
        assert!(error.is_none(), "{samples} samples: {error:?}");
    }
}

#[test]
fn wrong_targets_are_refused() {
    assert!(frame(4, 1).is_some());
}

#[test]
fn an_empty_or_huge_picture_is_an_error() {
    let (device, _) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    assert!(Targets::new(&device, 0, 10, 1, 1).is_err());
    assert!(Targets::new(&device, 1_000_000, 10, 1, 1).is_err());
}
