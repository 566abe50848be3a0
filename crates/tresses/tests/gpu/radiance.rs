//! Packed radiance: `unpack_radiance` reads the words that `pack_color` of `light/radiance.wesl` writes.

use crate::common;
use half::f16;
use tresses::{
    glam::{Vec3, Vec4},
    low_level::{readback::blocking as readback, unpack_radiance},
    wgpu::{self, util::DeviceExt},
};

const PACK: &str = "
@group(0) @binding(0) var<storage, read> colors: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> words: array<u32>;

@compute @workgroup_size(64)
fn pack(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&colors) {
        words[id.x] = pack_color(colors[id.x].xyz);
    }
}
";

/// Tests every brightness of a half float in each channel. The other channels are as bright, half as bright and black.
#[test]
fn packed_radiance_keeps_half_floats() {
    let Some(context) = common::context() else { return };
    let all = (0..f16::INFINITY.to_bits()).map(|bits| f16::from_bits(bits).to_f32());
    let colors: Vec<Vec4> = all
        .flat_map(|most| [[most, 0.5 * most, 0.0], [0.0, most, most], [0.5 * most, 0.0, most]])
        .map(|[r, g, b]| Vec4::new(r, g, b, 1.0))
        .collect();
    let [given, words] = [bytemuck::cast_slice(&colors), &vec![0; 4 * colors.len()][..]].map(|contents| {
        context.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("test"),
            contents,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        })
    });
    let source = [include_str!("../../src/light/radiance.wesl"), PACK].concat();
    let module = context.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = context.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("test"),
        layout: None,
        module: &module,
        entry_point: Some("pack"),
        compilation_options: Default::default(),
        cache: None,
    });
    let entries = [&given, &words].map(wgpu::Buffer::as_entire_binding);
    let group = context.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("test"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[0, 1]
            .map(|binding| wgpu::BindGroupEntry { binding, resource: entries[binding as usize].clone() }),
    });
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups((colors.len() as u32).div_ceil(64), 1, 1);
    drop(pass);
    context.queue().submit([encoder.finish()]);
    let words: Vec<u32> = readback::buffer(context, &words).unwrap();
    // Values below the smallest step become black. Values above the largest one, by nine bits and the exponent, are
    // clamped.
    let (least, most) = (2f32.powi(-16), 65408.0);
    let off = |color: &Vec4, word: u32| {
        let color = color.truncate().min(Vec3::splat(most));
        (unpack_radiance(word) - color).abs().max_element() / color.max_element().max(least)
    };
    let worst = colors.iter().zip(&words).map(|(color, word)| off(color, *word)).fold(0.0, f32::max);
    assert!(worst <= 0.002, "{worst}");
    // One step of a channel is detected.
    assert!(off(&colors[3 * 0x3c00], words[3 * 0x3c00] + (1 << 9)) > 0.002);
}
