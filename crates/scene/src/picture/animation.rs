//! The animation files: every frame is compressed as it comes, the file is assembled at the end.

use super::Picture;
use anyhow::{Result, ensure};
#[cfg(not(target_arch = "wasm32"))]
use webp_animation::{EncoderOptions, EncodingConfig, EncodingType, LossyEncodingConfig};

/// Turns frames into one file.
pub trait Animation {
    /// The next frame.
    ///
    /// # Errors
    /// When it is not of the animation's size.
    fn add(&mut self, picture: &Picture) -> Result<()>;

    /// The bytes of the file.
    ///
    /// # Errors
    /// When there are no frames.
    fn finish(self: Box<Self>) -> Result<Vec<u8>>;
}

/// A kind of animation file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `.webp`: small, in true colour, shown by every browser. Its encoder is libwebp, which is C and not
    /// there in a browser.
    #[cfg(not(target_arch = "wasm32"))]
    WebP,
    /// `.gif`: 256 colours per frame.
    Gif,
    /// `.apng`: lossless and large.
    Apng,
}

impl Format {
    /// What there is, the best for most first.
    pub const ALL: &[Self] = &[
        #[cfg(not(target_arch = "wasm32"))]
        Self::WebP,
        Self::Gif,
        Self::Apng,
    ];

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::WebP => "webp",
            Self::Gif => "gif",
            Self::Apng => "apng",
        }
    }

    /// Begins a file of `frames` frames of `width` × `height` pixels at `fps` frames per second, which
    /// repeats for ever.
    ///
    /// # Errors
    /// One sentence, for what the format cannot hold.
    pub fn begin(self, [width, height]: [u32; 2], frames: u32, fps: f64) -> Result<Box<dyn Animation>> {
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
            // A key frame now and then lets a viewer seek and bounds what one bad frame can spoil.
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

    /// When the next frame begins, milliseconds; rounded from real time, so that errors do not add up.
    fn time(&self) -> i32 {
        (f64::from(self.frame) * 1000.0 / self.fps).round() as i32
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl Animation for WebP {
    fn add(&mut self, picture: &Picture) -> Result<()> {
        self.encoder.add_frame(&picture.rgba, self.time())?;
        self.frame += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        let end = self.time();
        Ok(self.encoder.finalize(end)?.to_vec())
    }
}

/// GIF with a palette of its own for every frame.
struct Gif {
    encoder: gif::Encoder<Vec<u8>>,
    frame: u32,
    fps: f64,
}

impl Gif {
    fn new(width: u32, height: u32, fps: f64) -> Result<Self> {
        ensure!(
            fps <= 50.0,
            "a .gif shows at most 50 frames per second; choose another kind of file or fewer"
        );
        let mut encoder = gif::Encoder::new(Vec::new(), u16::try_from(width)?, u16::try_from(height)?, &[])?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        Ok(Self { encoder, frame: 0, fps })
    }
}

impl Animation for Gif {
    fn add(&mut self, picture: &Picture) -> Result<()> {
        // Neural quantisation over every tenth pixel: close to the best palette, and quick.
        let mut pixels = picture.rgba.clone();
        let mut frame =
            gif::Frame::from_rgba_speed(picture.width as u16, picture.height as u16, &mut pixels, 10);
        // Hundredths of a second; rounded from real time, so that errors do not add up.
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
    writer: png::Writer<Shared>,
    bytes: Shared,
}

impl Apng {
    fn new(width: u32, height: u32, frames: u32, fps: f64) -> Result<Self> {
        let bytes = Shared::default();
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

impl Animation for Apng {
    fn add(&mut self, picture: &Picture) -> Result<()> {
        self.writer.write_image_data(&picture.rgb())?;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.bytes.take())
    }
}

/// Bytes that the PNG writer fills and that are still there when it has finished with them.
#[derive(Clone, Default)]
struct Shared(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl Shared {
    fn take(&self) -> Vec<u8> {
        self.0.take()
    }
}

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
