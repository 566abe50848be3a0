//! What a scene tells besides moving pictures: its strands and guides as they are now, and of a picture linear radiance,
//! where hair is, and which strands it shows.

use super::Scene;
use crate::camera::Viewpoint;
use anyhow::Result;
use tresses::{
    camera::ToneMap,
    draw::tiles::Label,
    glam::{Mat4, Vec3},
    gpu::readback,
    groom::Strands,
    light::material::linear,
    strands::{GuideBuffers, Strand, StrandBuffers, StrandVertex, vertex::unpack_tangent},
};

/// What is asked of a picture besides its colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Radiance.
    pub linear: bool,
    /// Where hair is and which strands it shows; only hair by tiles knows.
    pub hair: bool,
    /// That it shows hair alone, without bodies and their shadows.
    pub bare: bool,
}

/// A picture and what it was asked for. All rows are from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Captured {
    /// sRGB and alpha, a byte each, of each pixel.
    pub color: Vec<u8>,
    /// Linear radiance before exposure and tone mapping, premultiplied by alpha; empty if nobody asked.
    pub linear: Vec<[f32; 4]>,
    /// [`Targets::geometry`](tresses::draw::Targets::geometry), zeros without hair; empty if nobody asked.
    pub geometry: Vec<[f32; 4]>,
    /// Whether that has the motion of hair.
    pub knows_motion: bool,
    /// [`Targets::labels`](tresses::draw::Targets::labels), likewise.
    pub labels: Vec<Option<Label>>,
}

impl Captured {
    /// What is seen of the hair in each pixel, metres along the view; infinite without hair. `projection` is the camera's.
    pub fn depths(&self, projection: &Mat4) -> Vec<f32> {
        let back = projection.inverse();
        let depth = |texel: &[f32; 4]| match *texel {
            [.., opacity] if opacity <= 0.0 => f32::INFINITY,
            [.., depth, _] => -back.project_point3(Vec3::new(0.0, 0.0, depth)).z,
        };
        self.geometry.iter().map(depth).collect()
    }

    /// How far the hair of each pixel has moved since the picture before, pixels to the right and down; no numbers where
    /// that is not known.
    pub fn motions(&self) -> Vec<[f32; 2]> {
        let moved = |[x, y, ..]: &[f32; 4]| if self.knows_motion { [*x, *y] } else { [f32::NAN; 2] };
        self.geometry.iter().map(moved).collect()
    }

    /// How opaque the hair of each pixel is.
    pub fn coverages(&self) -> Vec<f32> {
        self.geometry.iter().map(|texel| texel[3]).collect()
    }
}

/// A tone that leaves radiance as it is but for this factor: what half floats can hold is not bright enough to be bent.
const DIM: f32 = 1.0 / 131_072.0;

impl Scene {
    /// Draws what `camera` sees, all of it, and reads it back.
    ///
    /// # Errors
    /// When the adapter cannot hold what a view needs or is lost, and where hair that is not drawn by tiles is asked
    /// where it is.
    pub async fn capture(&mut self, camera: &Viewpoint, asked: Asked) -> Result<Captured> {
        self.place_colliders();
        self.look_from(camera);
        loop {
            let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
            self.record_picture(&mut encoder, None, false, asked)?;
            self.gpu.context.queue().submit([encoder.finish()]);
            if self.is_complete().await? {
                break;
            }
        }
        let targets = self.targets();
        let mut captured = Captured { color: targets.read().await?, ..Default::default() };
        if asked.linear {
            captured.linear = self.linear().await?;
        }
        if asked.hair {
            let texels = targets.size.map(|side| (side * targets.ssaa) as usize).iter().product();
            let known = targets.geometry().await?;
            captured.geometry = known.unwrap_or_else(|| vec![[0.0; 4]; texels]);
            captured.labels = targets.labels().await?.unwrap_or_else(|| vec![None; texels]);
            captured.knows_motion = targets.knows_motion();
        }
        Ok(captured)
    }

    /// The radiance of the last picture.
    async fn linear(&self) -> Result<Vec<[f32; 4]>> {
        let (device, queue) = (self.gpu.context.device(), self.gpu.context.queue());
        let [width, height] = self.targets().size;
        let format = wgpu::TextureFormat::Rgba32Float;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("radiance"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let output = texture.create_view(&Default::default());
        let tone = ToneMap { exposure: DIM, shoulder: 0.99, desaturation: 0.0 };
        let mut encoder = device.create_command_encoder(&Default::default());
        self.view.present_into(&mut encoder, (&output, format), (&self.picture.background, &tone))?;
        queue.submit([encoder.finish()]);
        let bytes = readback::texture(&self.gpu.context, &texture).await?;
        let mut texels: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        for texel in &mut texels {
            texel[..3].iter_mut().for_each(|v| *v = linear(*v) / DIM);
        }
        Ok(texels)
    }

    /// The strands of `all` as they are drawn now, with their widths; metres.
    ///
    /// # Errors
    /// When the GPU is lost.
    pub async fn drawn<'a>(&self, all: impl IntoIterator<Item = &'a StrandBuffers>) -> Result<Strands> {
        let mut drawn = Strands::default();
        for buffers in all {
            let vertices: Vec<StrandVertex> = readback::buffer(&self.gpu.context, &buffers.vertices).await?;
            let strands: Vec<Strand> = readback::buffer(&self.gpu.context, &buffers.strands).await?;
            let (count, each) = (buffers.drawn.count as usize, buffers.drawn.vertex_count as usize);
            for (strand, vertices) in strands.iter().zip(vertices.chunks(each)).take(count) {
                drawn.push(&vertices.iter().map(|vertex| vertex.position).collect::<Vec<_>>());
                drawn.radii.extend(vertices.iter().map(|v| strand.radius * unpack_tangent(v.tangent).1));
            }
        }
        Ok(drawn)
    }

    /// The vertices of the hair's guides after the last fixed step, guide after guide, root first; metres.
    ///
    /// # Errors
    /// When the GPU is lost.
    pub async fn guides(&self) -> Result<Vec<Vec3>> {
        let hair = self.character.hair();
        let GuideBuffers { count, vertex_count, current, .. } = &hair.guides;
        let points: Vec<[f32; 4]> = readback::buffer(&self.gpu.context, current).await?;
        let (count, place) = (*count as usize, hair.place());
        let at = |guide: usize, vertex: usize| {
            let [x, y, z, _] = points[vertex * count + guide];
            place.point(Vec3::new(x, y, z))
        };
        Ok((0..count)
            .flat_map(|g| (0..*vertex_count as usize).map(move |v| (g, v)))
            .map(|(g, v)| at(g, v))
            .collect())
    }
}
