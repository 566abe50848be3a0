use super::{state::Part, texels::Texels};
use crate::{
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Kernel, for_tests, pass},
};
use half::f16;
use wgpu::util::DeviceExt;

/// What a texel of colours says.
fn unpacked(word: u32) -> [f32; 3] {
    let unit = (((word >> 27) as f32) - 24.0).exp2();
    [0, 9, 18].map(|shift| ((word >> shift) & 511) as f32 * unit)
}

/// Every brightness that light can have, in each channel, beside others as bright, half as bright and black.
#[test]
fn colours_keep_what_half_floats_hold() {
    let Some(gpu) = for_tests() else { return };
    let (device, queue) = (&gpu.device, &gpu.queue);
    let all = (0..f16::INFINITY.to_bits()).map(f16::from_bits);
    let colors: Vec<[f16; 3]> = all
        .flat_map(|most| {
            let half = f16::from_f32(0.5 * most.to_f32());
            [[most, half, f16::ZERO], [f16::ZERO, most, most], [half, f16::ZERO, most]]
        })
        .collect();
    let shaded: Vec<[f16; 4]> = colors.iter().map(|[r, g, b]| [*r, *g, *b, f16::ONE]).collect();
    let bits: Vec<u16> = shaded.as_flattened().iter().map(|half| half.to_bits()).collect();
    let count = colors.len() as u32;
    let buffer = |contents: &[u8]| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("test"),
            contents,
            usage: wgpu::BufferUsages::STORAGE,
        })
    };
    let part = buffer(bytemuck::bytes_of(&Part { first: 0, count, vertex_count: 1, room: 0 }));
    let shaded = buffer(bytemuck::cast_slice(&bits));
    let seen = buffer(bytemuck::cast_slice(&vec![u32::MAX; count.div_ceil(32) as usize]));
    let texels = Texels::new(device, "test", count.into(), wgpu::TextureFormat::R32Uint).unwrap();
    use Binding::{Storage, WriteWords2d};
    let kernel = Kernel::new(device, "draw::tiles::tint", &[Storage, Storage, Storage, WriteWords2d]);
    let [part, shaded, seen] = [&part, &shaded, &seen].map(wgpu::Buffer::as_entire_binding);
    let group = kernel.bind(device, &[part, shaded, seen, texels.resource()]);
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = pass::compute_pass(&mut encoder, &Default::default());
    kernel.record(&mut pass, &group, &[], count.div_ceil(STRAND_WORKGROUP));
    drop(pass);
    queue.submit([encoder.finish()]);
    let bytes = pollster::block_on(texels.read(device, queue)).unwrap();
    let words: Vec<u32> = bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    // Black below, and not beyond the brightest that nine bits and the exponent reach.
    let (least, most) = (2f32.powi(-16), 65408.0);
    for (color, word) in colors.iter().zip(&words) {
        let color = color.map(|channel| channel.to_f32().min(most));
        let largest = color.iter().copied().fold(least, f32::max);
        for (was, is) in color.iter().zip(unpacked(*word)) {
            assert!((is - was).abs() <= 0.002 * largest, "{color:?} became {:?}", unpacked(*word));
        }
    }
}
