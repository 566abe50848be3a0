//! Strands to pictures.

use super::Mode;
use crate::common::{self, Lease};
use tresses::{
    draw::{DrawOptions, DrawStage, HairSet, Scene, Targets},
    gpu::Gpu,
    strands::{Strand, StrandBuffers, StrandVertex, vertex::pack_tangent},
};

use super::groom::Groom;

/// A stage of one mode, and targets of one size.
pub struct Studio<'a> {
    gpu: &'a Gpu,
    stage: Lease<DrawStage>,
    targets: Targets,
}

impl<'a> Studio<'a> {
    pub fn new(gpu: &'a Gpu, mode: Mode, size: [u32; 2]) -> Self {
        let options = DrawOptions {
            samples: mode.samples,
            coverage: mode.coverage,
            shadow_resolution: 256,
            ..Default::default()
        };
        let stage = common::stage(gpu, &options);
        let targets = stage.targets(&gpu.device, size[0], size[1], mode.ssaa).expect("fits");
        Self { gpu, stage, targets }
    }

    /// Pictures of another size from here on.
    pub fn resize(&mut self, size: [u32; 2]) {
        let ssaa = self.targets.ssaa;
        self.targets = self.stage.targets(&self.gpu.device, size[0], size[1], ssaa).expect("fits");
    }

    /// Brings `groom` to the GPU.
    pub fn hair(&self, groom: &Groom) -> (HairSet, StrandBuffers) {
        let strands = upload(self.gpu, groom);
        (HairSet::new(&self.gpu.device, &self.stage, &strands).expect("fits"), strands)
    }

    /// RGBA of `hair` alone, rows from the top.
    pub fn picture(&self, scene: &Scene, hair: &HairSet) -> Vec<[u8; 4]> {
        let bytes = common::picture(self.gpu, &self.stage, scene, hair, None, &self.targets);
        bytes.as_chunks().0.to_vec()
    }
}

fn upload(gpu: &Gpu, groom: &Groom) -> StrandBuffers {
    let n = groom.vertices;
    let buffers = StrandBuffers::new(&gpu.device, groom.count() as u32, n as u32).expect("fits");
    write(gpu, groom, &buffers);
    buffers
}

/// Replaces the vertices of `buffers` by those of `groom`.
pub fn write(gpu: &Gpu, groom: &Groom, buffers: &StrandBuffers) {
    let n = groom.vertices;
    let vertices: Vec<_> = (0..groom.points.len())
        .map(|i| StrandVertex {
            position: groom.points[i],
            tangent: pack_tangent(groom.tangent(i), groom.radius(i) / groom.root_radius),
        })
        .collect();
    let infos: Vec<_> = (0..groom.count() as u32)
        .map(|i| Strand {
            radius: groom.root_radius,
            seed: (i + 1).wrapping_mul(0x9e37_79b9),
            root_color: 0,
            tip_color: 0,
        })
        .collect();
    assert_eq!(vertices.len(), infos.len() * n);
    gpu.queue.write_buffer(&buffers.vertices, 0, bytemuck::cast_slice(&vertices));
    gpu.queue.write_buffer(&buffers.strands, 0, bytemuck::cast_slice(&infos));
}

/// The sum of alpha, pixels.
pub fn total(picture: &[[u8; 4]]) -> f64 {
    picture.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum()
}
