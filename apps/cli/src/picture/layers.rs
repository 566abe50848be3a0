//! Images with auxiliary channels, `.exr`: linear radiance and alpha, and for hair the depth, coverage, motion, and id
//! of the dominant strand per pixel.

use anyhow::{Context, Result};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, WritableImage,
    f16,
};
use std::io::Cursor;
use tresses::glam::Mat4;
use tresses_scene::scene::Capture;

/// Strand and groom id of pixels without hair.
const NONE: u32 = u32::MAX;

/// Encodes `captured`, an image of `width` × `height` pixels. `projection` is the camera's projection matrix.
pub fn encode(captured: &Capture, [width, height]: [u32; 2], projection: &Mat4) -> Result<Vec<u8>> {
    let half = |values: &mut dyn Iterator<Item = f32>| FlatSamples::F16(values.map(f16::from_f32).collect());
    let light = |c: usize| half(&mut captured.linear.iter().map(|texel| texel[c]));
    let (motions, labels) = (captured.motions(), &captured.labels);
    let motion_channel = |axis: usize| FlatSamples::F32(motions.iter().map(|motion| motion[axis]).collect());
    let label = |of: fn(&tresses::low_level::Label) -> u32| {
        FlatSamples::U32(labels.iter().map(|label| label.as_ref().map_or(NONE, of)).collect())
    };
    let channels = [
        ("R", light(0)),
        ("G", light(1)),
        ("B", light(2)),
        ("A", light(3)),
        ("hair.A", half(&mut captured.coverages().into_iter())),
        ("hair.Z", FlatSamples::F32(captured.depths(projection))),
        ("hair.motion.X", motion_channel(0)),
        ("hair.motion.Y", motion_channel(1)),
        ("hair.strand", label(|label| label.strand)),
        ("hair.groom", label(|label| label.groom)),
    ];
    let channels: SmallVec<[_; 4]> =
        channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let attributes = LayerAttributes {
        software_name: Some(concat!("Tresses ", env!("CARGO_PKG_VERSION")).into()),
        ..Default::default()
    };
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).context("cannot encode the image")?;
    Ok(bytes.into_inner())
}
