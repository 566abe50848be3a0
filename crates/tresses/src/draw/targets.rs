//! Render targets of a view.

use super::{
    canvas::HdrTarget,
    classic::Layers,
    soft::SoftTargets,
    tiles::{Label, Tiles},
};
use crate::{Context, Error, Result, constants::LIGHT_GROUP, gpu::readback, renderer::Renderer};
use std::sync::OnceLock;

pub use super::canvas::{DEPTH_FORMAT, HDR_FORMAT};
/// Format of the finished image of [`Targets`].
pub const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Render targets of one image size.
#[derive(Debug)]
pub struct Targets {
    context: Context,
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// Samples per pixel of the HDR target.
    pub samples: u32,
    /// Pixels of the HDR target per pixel of the image, along each axis.
    pub ssaa: u32,
    pub(crate) hdr: HdrTarget,
    /// Present for depth peeling.
    pub(crate) layers: Option<Layers>,
    /// Present for tiles.
    pub(crate) tiles: Option<Tiles>,
    /// Created when a body is first drawn: for one group of lights, and for two.
    soft: [OnceLock<SoftTargets>; 2],
    picture: wgpu::Texture,
    pub(crate) picture_view: wgpu::TextureView,
    bytes: u64,
}

impl Targets {
    /// Creates the targets of `renderer` for an image of `size` (width and height, pixels), with `ssaa` (1, 2 or 4)
    /// times supersampling along each axis.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the size is 0 or more than the device allows, and as [`Renderer::check`].
    pub fn new(context: &Context, [width, height]: [u32; 2], renderer: Renderer, ssaa: u32) -> Result<Self> {
        let Context { device, .. } = context;
        renderer.check()?;
        let samples = renderer.samples();
        let ssaa = ssaa.clamp(1, 4);
        let max_size = device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width.max(height) > max_size / ssaa {
            return Err(Error::Parameter {
                name: "size",
                value: format!("{width}x{height} (times {ssaa} for supersampling)"),
                range: "at least 1x1 and at most the largest texture of the adapter",
            });
        }
        let texture = |label, width, height, sample_count, format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let (wide, high) = (width * ssaa, height * ssaa);
        let hdr = texture("hdr", wide, high, samples, HDR_FORMAT, wgpu::TextureUsages::TEXTURE_BINDING);
        let read = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let depth = texture("depth", wide, high, samples, DEPTH_FORMAT, read);
        let picture = texture("picture", width, height, 1, PICTURE_FORMAT, read);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let targets = Self {
            context: context.clone(),
            size: [width, height],
            samples,
            ssaa,
            hdr: HdrTarget {
                device: device.clone(),
                size: [width, height],
                samples,
                ssaa,
                color: view(&hdr),
                depth: view(&depth),
                depth_texture: depth,
            },
            layers: None,
            tiles: None,
            soft: Default::default(),
            picture_view: view(&picture),
            picture,
            bytes: u64::from(wide) * u64::from(high) * u64::from(samples) * 12
                + u64::from(width) * u64::from(height) * 4,
        };
        Ok(match renderer {
            Renderer::Tiles(_) => targets.with_tiles()?,
            _ if renderer.layers().is_some() => targets.with_layers(),
            _ => targets,
        })
    }

    /// Adds the textures of depth peeling.
    fn with_layers(mut self) -> Self {
        let size = self.hdr.depth_texture.size();
        self.layers = Some(Layers::new(&self.context.device, self.hdr.texture()));
        self.bytes += u64::from(size.width) * u64::from(size.height) * Layers::BYTES;
        self
    }

    /// Adds the buffers and textures of tiles.
    fn with_tiles(mut self) -> Result<Self> {
        let size = self.hdr.depth_texture.size();
        self.tiles = Some(Tiles::new(&self.context.device, [size.width, size.height], self.hdr.texture())?);
        Ok(self)
    }

    /// Returns the state of tiles.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the targets of another renderer.
    pub(crate) fn tiles(&self) -> Result<&Tiles> {
        self.tiles.as_ref().ok_or_else(|| Error::Parameter {
            name: "targets",
            value: "without tiles".into(),
            range: "made for tiles",
        })
    }

    /// Returns the shading points of bodies in `max_lights` lights with shadow maps, created at first use.
    pub(crate) fn soft(&self, max_lights: u32) -> &SoftTargets {
        let size = self.hdr.depth_texture.size();
        let groups = max_lights.div_ceil(LIGHT_GROUP).clamp(1, 2);
        let new = || SoftTargets::new(&self.context.device, [size.width, size.height], groups);
        self.soft[groups as usize - 1].get_or_init(new)
    }

    /// Returns the finished image as a view to present into.
    pub fn picture(&self) -> &wgpu::TextureView {
        &self.picture_view
    }

    /// Reads back the finished image: sRGB, RGBA, rows from the top.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device is lost.
    pub async fn read(&self) -> Result<Vec<u8>> {
        readback::texture(&self.context, &self.picture).await
    }

    /// Reads back the geometry of the hair in the last frame. `None` unless it was
    /// [requested](crate::frame::Drawing::writes_labels) and the frame has hair.
    ///
    /// Each texel holds the motion of the visible hair since the view's previous frame (x to the right and y down,
    /// texels), its depth in the camera's projection, and its opacity; see
    /// [`HostFrame::geometry`](super::HostFrame::geometry). There are [`ssaa`](Self::ssaa)² texels per pixel.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device is lost.
    pub async fn geometry(&self) -> Result<Option<Vec<[f32; 4]>>> {
        let Some(known) = self.tiles.as_ref().and_then(Tiles::geometry) else { return Ok(None) };
        let bytes = readback::texture(&self.context, known.texture()).await?;
        Ok(Some(bytemuck::pod_collect_to_vec(&bytes)))
    }

    /// Whether [`geometry`](Self::geometry) includes the motion of the hair itself. This requires that the previous
    /// frame drew the same strands and also requested geometry. Otherwise hair counts as static, and only the camera's
    /// motion is included.
    pub fn knows_motion(&self) -> bool {
        self.tiles.as_ref().is_some_and(Tiles::knows_motion)
    }

    /// Reads back the strand that covers most of each texel; if two cover the same share, the one in front. `None`
    /// unless the last frame requested it and has hair, as for [`geometry`](Self::geometry).
    ///
    /// # Errors
    /// As [`geometry`](Self::geometry).
    pub async fn labels(&self) -> Result<Option<Vec<Option<Label>>>> {
        let Some(labels) = self.tiles.as_ref().and_then(Tiles::labels) else { return Ok(None) };
        let bytes = readback::texture(&self.context, labels.texture.texture()).await?;
        let texels: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(Some(texels.into_iter().map(|texel| Label::read(texel, &labels.owners)).collect()))
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let size = self.hdr.depth_texture.size();
        let soft = self.soft.iter().filter_map(|soft| soft.get()).count() as u64 * SoftTargets::BYTES;
        let tiles = self.tiles.as_ref().map_or(0, Tiles::bytes);
        self.bytes + tiles + soft * u64::from(size.width) * u64::from(size.height)
    }

    /// Bytes of GPU memory, out of [`bytes`](Self::bytes), that depend on the hair of the last frame: points and lists
    /// of tiles.
    pub fn hair_bytes(&self) -> u64 {
        self.tiles.as_ref().map_or(0, Tiles::hair_bytes)
    }
}
