//! Every pipeline is built on wgpu's noop backend: shaders and bindings are valid. No GPU needed.

#[test]
fn simulate() {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    let simulate = tresses::simulate::Simulate::new(&device);
    for vertex_count in [2, 8, 16, 24, 32, 48, 64] {
        simulate.pipeline(&device, vertex_count);
    }
    let guides = tresses::strands::GuideBuffers::new(&device, 4, 16, 2).unwrap();
    let colliders = tresses::simulate::ColliderSet::new(&device, &queue, None, 2).unwrap();
    tresses::simulate::Simulation::new(&device, &simulate, &guides, colliders);
}
