//! Data read back from a scene: strands and guides in their current state, linear radiance, hair geometry and strand
//! labels.

use super::{
    Scene,
    surface::{self, SurfaceSample},
};
use crate::camera::CaptureCamera;
use anyhow::{Result, ensure};
use tresses::{
    ToneMap,
    glam::{Mat4, Vec3},
    groom::{Strands, bound::Strand, srgb::linear},
    low_level::{GuideBuffers, Label, StrandBuffers, StrandVertex, readback, unpack_tangent},
};

/// Outputs of a capture besides color.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputRequest {
    /// Linear radiance.
    pub linear: bool,
    /// Hair geometry and strand labels. Requires tiled hair ([`Renderer::Tiles`](tresses::renderer::Renderer::Tiles)).
    pub hair: bool,
    /// Depth and normals of the bodies.
    pub body: bool,
    /// Draws only the hair, without bodies and their shadows.
    pub hair_only: bool,
    /// Bodies hide hair behind them, but are not drawn.
    pub holdout: bool,
}

/// A captured frame. Rows run from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capture {
    /// sRGB and alpha, one byte per channel.
    pub color: Vec<u8>,
    /// Linear radiance before exposure and tone mapping, premultiplied by alpha. Empty unless requested.
    pub linear: Vec<[f32; 4]>,
    /// [`Targets::geometry`](tresses::low_level::Targets::geometry), zero without hair. Empty unless requested.
    pub geometry: Vec<[f32; 4]>,
    /// Whether `geometry` contains hair motion.
    pub knows_motion: bool,
    /// [`Targets::labels`](tresses::low_level::Targets::labels). Empty unless requested.
    pub labels: Vec<Option<Label>>,
    /// Bodies behind the hair. Empty unless requested.
    pub surface: Vec<SurfaceSample>,
}

impl Capture {
    /// Returns the view-space depth of the visible hair per pixel, meters; infinite without hair. `projection` is the
    /// camera's projection matrix.
    pub fn depths(&self, projection: &Mat4) -> Vec<f32> {
        let back = projection.inverse();
        let depth = |texel: &[f32; 4]| match *texel {
            [.., opacity] if opacity <= 0.0 => f32::INFINITY,
            [.., depth, _] => -back.project_point3(Vec3::new(0.0, 0.0, depth)).z,
        };
        self.geometry.iter().map(depth).collect()
    }

    /// Returns the hair motion per pixel since the previous frame, pixels to the right and down; NaN if unknown.
    pub fn motions(&self) -> Vec<[f32; 2]> {
        let motion = |[x, y, ..]: &[f32; 4]| if self.knows_motion { [*x, *y] } else { [f32::NAN; 2] };
        self.geometry.iter().map(motion).collect()
    }

    /// Returns the hair opacity per pixel.
    pub fn coverages(&self) -> Vec<f32> {
        self.geometry.iter().map(|texel| texel[3]).collect()
    }
}

/// Exposure at which the tone curve is linear: even the largest half float stays below the shoulder.
const DIM: f32 = 1.0 / 131_072.0;

impl Scene {
    /// Draws the complete frame from `camera` and reads it back.
    ///
    /// # Errors
    /// Fails if the adapter cannot allocate what the view needs, if the GPU is lost, or if [`OutputRequest::hair`] is
    /// set and the hair is not tiled, or drawn as cards.
    pub async fn capture(
        &mut self,
        camera: impl Into<CaptureCamera>,
        request: OutputRequest,
    ) -> Result<Capture> {
        ensure!(
            !request.hair || !self.character.hair().is_cards(),
            "depth, coverage, motion and strands of the hair are known for strands, not for cards"
        );
        self.move_colliders();
        self.look_from(camera);
        self.hold_out(request.holdout);
        let drawn = self.draw_until_complete(request).await;
        self.hold_out(false);
        drawn?;
        let targets = self.targets();
        let mut captured = Capture { color: targets.read().await?, ..Default::default() };
        if request.linear {
            captured.linear = self.linear().await?;
        }
        if request.body {
            captured.surface = self.surface(request.hair_only).await?;
        }
        if request.hair {
            let texels = targets.size.map(|side| (side * targets.ssaa) as usize).iter().product();
            let known = targets.geometry().await?;
            captured.geometry = known.unwrap_or_else(|| vec![[0.0; 4]; texels]);
            captured.labels = targets.labels().await?.unwrap_or_else(|| vec![None; texels]);
            captured.knows_motion = targets.knows_motion();
        }
        Ok(captured)
    }

    /// Draws until the frame is complete.
    async fn draw_until_complete(&mut self, request: OutputRequest) -> Result<()> {
        loop {
            let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
            self.record_picture(&mut encoder, None, false, request)?;
            self.gpu.context.queue().submit([encoder.finish()]);
            if self.is_complete().await? {
                return Ok(());
            }
        }
    }

    fn hold_out(&mut self, holdout: bool) {
        let character = &mut self.character;
        character.props.iter_mut().for_each(|prop| prop.material.is_holdout = holdout);
        if let Some(body) = character.body_mut() {
            body.material.is_holdout = holdout;
        }
    }

    /// Returns the bodies in the last frame; none if it is `hair_only`.
    async fn surface(&self, hair_only: bool) -> Result<Vec<SurfaceSample>> {
        let mut meshes = Vec::new();
        let bodies = self.character.body().into_iter().chain(&self.character.props);
        for body in bodies.filter(|_| !hair_only) {
            meshes.push(body.read().await?);
        }
        let camera = &self.picture.camera;
        Ok(surface::rasterized(&meshes, [camera.view, camera.projection], self.targets().size))
    }

    /// Reads back the radiance of the last frame.
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

    /// Reads back the render strands of `all` in their current state, with radii; meters.
    ///
    /// # Errors
    /// Fails if the GPU is lost.
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

    /// Reads back the colors of drawn strands: one per vertex of [`drawn`](Self::drawn), linear. Empty if the settings
    /// or the groom do not color each strand.
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn drawn_colors(&self, buffers: &StrandBuffers) -> Result<Vec<Vec3>> {
        if !self.character.hair().set.material.uses_file_colors {
            return Ok(Vec::new());
        }
        let strands: Vec<Strand> = readback::buffer(&self.gpu.context, &buffers.strands).await?;
        let (count, each) = (buffers.drawn.count as usize, buffers.drawn.vertex_count as usize);
        let mut colors = Vec::new();
        for strand in strands.iter().take(count) {
            match strand.colors(each) {
                Some(strand) => colors.extend(strand),
                None => return Ok(Vec::new()),
            }
        }
        Ok(colors)
    }

    /// Reads back the guide vertices after the last fixed step, in meters: guide by guide, root first.
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn guides(&self) -> Result<Vec<Vec3>> {
        let hair = self.character.hair();
        let GuideBuffers { count, vertex_count, current, .. } = &hair.guides;
        let points: Vec<[f32; 4]> = readback::buffer(&self.gpu.context, current).await?;
        let (count, transform) = (*count as usize, hair.simulation_transform());
        let at = |guide: usize, vertex: usize| {
            let [x, y, z, _] = points[vertex * count + guide];
            transform.point(Vec3::new(x, y, z))
        };
        Ok((0..count)
            .flat_map(|g| (0..*vertex_count as usize).map(move |v| (g, v)))
            .map(|(g, v)| at(g, v))
            .collect())
    }
}
