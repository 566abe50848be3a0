//! Renders strands to images.

use super::Mode;
use crate::common;
use tresses::{
    Body, Context, Picture, Timings, View, ViewOptions,
    groom::bound::Strand,
    low_level::{Drawing, HairSet, StrandBuffers, StrandVertex, pack_tangent, wall},
    renderer::ShadingModel,
};

use super::groom::Groom;

/// A view that renders grooms in one [`Mode`].
pub struct Studio<'a> {
    context: &'a Context,
    view: View,
}

impl<'a> Studio<'a> {
    pub fn new(context: &'a Context, mode: Mode, size: [u32; 2]) -> Self {
        let options = ViewOptions {
            // The shading model of the classic renderer, which is the reference for the other renderers.
            renderer: mode.renderer.with_shading(ShadingModel::KajiyaKay),
            shadow_resolution: 256,
            ..common::coarse()
        };
        let view = View::new(context, &options, size, mode.ssaa).expect("fits");
        Self { context, view }
    }

    /// Changes the size of the following images.
    pub fn resize(&mut self, size: [u32; 2]) {
        let ssaa = self.view.targets().ssaa;
        self.view.resize(size, ssaa).expect("fits");
    }

    /// Returns the colors of the strands of `hair` in the last image.
    pub fn shaded(&self, hair: &HairSet) -> tresses::wgpu::Buffer {
        self.view.shaded(hair).expect("drawn")
    }

    /// Uploads `groom`. Returns the set to draw and its buffers.
    pub fn hair(&self, groom: &Groom) -> (HairSet, StrandBuffers) {
        let strand = |i: u32| Strand {
            radius: groom.root_radius,
            seed: (i + 1).wrapping_mul(0x9e37_79b9),
            root_color: 0,
            tip_color: 0,
        };
        let strands: Vec<_> = (0..groom.count() as u32).map(strand).collect();
        let strands = common::upload(self.context, groom.vertices, &vertices(groom), &strands);
        (HairSet::new(self.context, &strands).expect("fits"), strands)
    }

    /// Renders `hair` alone: RGBA, rows from the top.
    pub fn picture(&self, scene: &Picture, hair: &HairSet) -> Vec<[u8; 4]> {
        self.picture_with_bodies(scene, hair, &[])
    }

    /// Renders `hair` alone. Returns the image and the number of dispatches that find visible segments.
    pub fn picture_and_dispatch_count(&self, scene: &Picture, hair: &HairSet) -> (Vec<[u8; 4]>, u32) {
        let mut timings = Timings::by(wall);
        let mut encoder = self.context.device().create_command_encoder(&Default::default());
        let mut recorder = self.context.recorder(&mut encoder).with_timings(Some(&mut timings));
        recorder.draw_strands(&[hair], &[], &self.view, Drawing::new(scene)).expect("it fits");
        self.context.queue().submit([encoder.finish()]);
        let bytes = pollster::block_on(self.view.targets().read()).expect("a picture");
        let visibility =
            timings.counts().iter().find(|(name, _)| *name == "see").expect("a row of that name");
        (bytes.as_chunks().0.to_vec(), visibility.1.dispatches)
    }

    /// Whether the last image is complete: all tile lists fitted into memory.
    pub fn is_complete(&self) -> bool {
        pollster::block_on(self.view.is_complete()).expect("a device")
    }

    /// Renders `hair` and `bodies`: RGBA, rows from the top.
    pub fn picture_with_bodies(&self, scene: &Picture, hair: &HairSet, bodies: &[&Body]) -> Vec<[u8; 4]> {
        let bytes = common::picture(self.context, &self.view, scene, &[hair], bodies);
        bytes.as_chunks().0.to_vec()
    }
}

/// Returns the vertices of `groom` as the GPU reads them.
fn vertices(groom: &Groom) -> Vec<StrandVertex> {
    let vertex = |i: usize| StrandVertex {
        position: groom.points[i],
        tangent: pack_tangent(groom.tangent(i), groom.radius(i) / groom.root_radius),
    };
    (0..groom.points.len()).map(vertex).collect()
}

/// Writes the vertices of `groom` into `buffers`.
pub fn write(context: &Context, groom: &Groom, buffers: &StrandBuffers) {
    context.queue().write_buffer(&buffers.vertices, 0, bytemuck::cast_slice(&vertices(groom)));
}

/// Returns the covered area, pixels: the sum of alpha, 1 per opaque pixel.
pub fn total(picture: &[[u8; 4]]) -> f64 {
    picture.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum()
}
