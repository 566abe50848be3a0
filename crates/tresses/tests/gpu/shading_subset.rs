//! Shading only the visible vertices is bit-identical to shading all vertices.

use crate::{common, golden};
use tresses::{
    Body, View, ViewOptions,
    low_level::{HairSet, readback::blocking as readback},
    renderer::Renderer,
};

#[test]
fn visible_vertices_are_shaded_as_in_full_shading() {
    let Some(context) = common::context() else { return };
    let options = ViewOptions { shadow_resolution: 256, renderer: Renderer::masks(4), ..Default::default() };
    let view = View::new(context, &options, golden::SIZE, 1).expect("fits");
    let strands = golden::strands(context, 0..golden::COUNT);
    let hair = HairSet::new(context, &strands).expect("fits");
    let body = Body::new(context, &golden::ball());
    common::picture(context, &view, &golden::scene(), &[&hair], &[&body]);
    let colors = view.shaded(&hair).expect("it is drawn");
    let all: Vec<u32> = readback::buffer(context, &colors).expect("read back");

    // The last segment of every third strand, and one segment elsewhere.
    let n = strands.vertex_count as usize;
    let segments: Vec<bool> =
        (0..all.len()).map(|i| (i / n).is_multiple_of(3) && i % n == n - 2 || i == n + 5).collect();
    let mut bits = vec![0u32; segments.len().div_ceil(32)];
    (0..segments.len()).filter(|i| segments[*i]).for_each(|i| bits[i / 32] |= 1 << (i % 32));
    let seen = |i: usize| segments[i] || i > 0 && segments[i - 1];
    let buffer = context.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("seen"),
        size: 4 * bits.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    context.queue().write_buffer(&buffer, 0, bytemuck::cast_slice(&bits));
    context.queue().write_buffer(&colors, 0, &vec![0; 4 * all.len()]);
    let chosen = view.shading_subset(&hair, &buffer).expect("fits");
    // Twice, because each run must clear the lists.
    for _ in 0..2 {
        let mut encoder = context.device().create_command_encoder(&Default::default());
        view.light.shade_subsets(&mut context.commands(&mut encoder), &[(&hair, &chosen)]).unwrap();
        context.queue().submit([encoder.finish()]);
    }
    let some: Vec<u32> = readback::buffer(context, &colors).expect("read back");
    assert!((0..all.len()).all(|i| !seen(i) || all[i] == some[i]));
    let shaded = some.iter().filter(|color| **color != 0).count();
    assert!((golden::COUNT as usize / 3 * 2..golden::COUNT as usize / 3 * 5).contains(&shaded), "{shaded}");
    assert!(some[2 * n..3 * n].iter().all(|color| *color == 0), "nobody sees the third strand");
}
