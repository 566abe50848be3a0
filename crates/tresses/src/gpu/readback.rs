//! Copies from the GPU back to the CPU, for tests, pictures and `tresses bench`; never in a frame.

use crate::{Error, Result};

/// The contents of `buffer` from byte 0, which must have `COPY_SRC`. Blocks.
///
/// # Errors
/// [`Error::Gpu`] when the device is lost.
pub fn buffer<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
) -> Result<Vec<T>> {
    let bytes = copy(device, queue, buffer.size(), |encoder, target| {
        encoder.copy_buffer_to_buffer(buffer, 0, target, 0, buffer.size());
    })?;
    Ok(bytemuck::pod_collect_to_vec(&bytes[..bytes.len() / size_of::<T>() * size_of::<T>()]))
}

/// The first mip level of a texture with `COPY_SRC`, all its layers or slices, rows without padding. Blocks.
///
/// # Errors
/// [`Error::Gpu`] when the device is lost.
pub fn texture(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Result<Vec<u8>> {
    let texel = texture.format().block_copy_size(None).ok_or_else(|| Error::Gpu {
        stage: "read-back",
        problem: format!("{:?} has no single size per texel", texture.format()),
    })?;
    let (width, height, depth) = (texture.width(), texture.height(), texture.depth_or_array_layers());
    let row = width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes =
        copy(device, queue, u64::from(padded) * u64::from(height) * u64::from(depth), |encoder, target| {
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: target,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(padded),
                        rows_per_image: Some(height),
                    },
                },
                wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            );
        })?;
    Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

fn copy(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    size: u64,
    record: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
) -> Result<Vec<u8>> {
    let lost = |problem: String| Error::Gpu { stage: "read-back", problem };
    let target = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: size.next_multiple_of(4).max(4),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read-back") });
    record(&mut encoder, &target);
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    target.slice(..).map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is alive until the poll below has returned.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
    receiver
        .recv()
        .map_err(|_| lost("the mapping was dropped".into()))?
        .map_err(|error| lost(error.to_string()))?;
    let view = target.slice(..size).get_mapped_range().map_err(|error| lost(error.to_string()))?;
    Ok(view.to_vec())
}
