//! Encoders of animation files. Each frame is compressed when it is added; `finish` assembles the file.

use super::Image;
use anyhow::{Result, ensure};
#[cfg(not(target_arch = "wasm32"))]
use webp_animation::{EncoderOptions, EncodingConfig, EncodingType, LossyEncodingConfig};

/// Encoder of one animation file.
pub trait AnimationEncoder {
    /// Adds the next frame.
    ///
    /// # Errors
    /// Fails if the frame's size differs from the animation's.
    fn add(&mut self, picture: &Image) -> Result<()>;

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// Fails if there are no frames.
    fn finish(self: Box<Self>) -> Result<Vec<u8>>;
}

/// Format of animation files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// `.webp`: small, in true color, shown by every browser. The encoder is libwebp, a C library that is unavailable
    /// on wasm.
    #[cfg(not(target_arch = "wasm32"))]
    WebP,
    /// `.gif`: 256 colors per frame.
    Gif,
    /// `.apng`: lossless and large.
    Apng,
}

impl AnimationFormat {
    /// Available formats, the most useful first.
    pub const ALL: &[Self] = &[
        #[cfg(not(target_arch = "wasm32"))]
        Self::WebP,
        Self::Gif,
        Self::Apng,
    ];

    /// Returns the file extension.
    pub fn extension(self) -> &'static str {
        match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::WebP => "webp",
            Self::Gif => "gif",
            Self::Apng => "apng",
        }
    }

    /// Starts an animation of `frames` frames of `width` × `height` pixels at `fps` frames per second. The animation
    /// loops forever.
    ///
    /// # Errors
    /// Fails if the format does not support the size or frame rate.
    pub fn begin(
        self,
        [width, height]: [u32; 2],
        frames: u32,
        fps: f64,
    ) -> Result<Box<dyn AnimationEncoder>> {
        Ok(match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::WebP => Box::new(WebP::new(width, height, fps)?),
            Self::Gif => Box::new(Gif::new(width, height, fps)?),
            Self::Apng => Box::new(Apng::new(width, height, frames, fps)?),
        })
    }
}

/// Animated WebP, lossy.
#[cfg(not(target_arch = "wasm32"))]
struct WebP {
    encoder: webp_animation::Encoder,
    frame: u32,
    fps: f64,
}

#[cfg(not(target_arch = "wasm32"))]
impl WebP {
    fn new(width: u32, height: u32, fps: f64) -> Result<Self> {
        let options = EncoderOptions {
            // Regular key frames allow seeking and limit how far a damaged frame spreads.
            kmin: 9,
            kmax: 17,
            encoding_config: Some(EncodingConfig {
                encoding_type: EncodingType::Lossy(LossyEncodingConfig::default()),
                quality: 90.0,
                method: 3,
            }),
            ..Default::default()
        };
        let encoder = webp_animation::Encoder::new_with_options((width, height), options)?;
        Ok(Self { encoder, frame: 0, fps })
    }

    /// Returns the start of the next frame, ms. Rounding absolute times keeps errors from accumulating.
    fn time(&self) -> i32 {
        (f64::from(self.frame) * 1000.0 / self.fps).round() as i32
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl AnimationEncoder for WebP {
    fn add(&mut self, picture: &Image) -> Result<()> {
        self.encoder.add_frame(&picture.rgba, self.time())?;
        self.frame += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        let end = self.time();
        Ok(self.encoder.finalize(end)?.to_vec())
    }
}

/// GIF with a separate palette per frame.
struct Gif {
    encoder: gif::Encoder<Vec<u8>>,
    frame: u32,
    fps: f64,
}

impl Gif {
    fn new(width: u32, height: u32, fps: f64) -> Result<Self> {
        ensure!(
            fps <= 50.0,
            "a .gif has at most 50 frames per second; choose another format or a lower frame rate"
        );
        let mut encoder = gif::Encoder::new(Vec::new(), u16::try_from(width)?, u16::try_from(height)?, &[])?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        Ok(Self { encoder, frame: 0, fps })
    }
}

impl AnimationEncoder for Gif {
    fn add(&mut self, picture: &Image) -> Result<()> {
        // Neural quantization of every tenth pixel: fast, and close to the best palette.
        let mut pixels = picture.rgba.clone();
        let mut frame =
            gif::Frame::from_rgba_speed(picture.width as u16, picture.height as u16, &mut pixels, 10);
        // Hundredths of a second. Rounding absolute times keeps errors from accumulating.
        let time = |frame: u32| (f64::from(frame) * 100.0 / self.fps).round() as u16;
        frame.delay = time(self.frame + 1).wrapping_sub(time(self.frame));
        self.encoder.write_frame(&frame)?;
        self.frame += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        Ok(self.encoder.into_inner()?)
    }
}

/// Animated PNG, lossless.
struct Apng {
    writer: png::Writer<SharedBuffer>,
    bytes: SharedBuffer,
}

impl Apng {
    fn new(width: u32, height: u32, frames: u32, fps: f64) -> Result<Self> {
        let bytes = SharedBuffer::default();
        let mut encoder = png::Encoder::new(bytes.clone(), width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(frames, 0)?;
        if fps <= 65.0 {
            encoder.set_frame_delay(1000, (fps * 1000.0).round() as u16)?;
        } else {
            encoder.set_frame_delay(1, fps.round() as u16)?;
        }
        Ok(Self { writer: encoder.write_header()?, bytes })
    }
}

impl AnimationEncoder for Apng {
    fn add(&mut self, picture: &Image) -> Result<()> {
        self.writer.write_image_data(&picture.rgb())?;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.bytes.take())
    }
}

/// Shared buffer that outlives the PNG writer filling it.
#[derive(Clone, Default)]
struct SharedBuffer(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl SharedBuffer {
    fn take(&self) -> Vec<u8> {
        self.0.take()
    }
}

impl std::io::Write for SharedBuffer {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
