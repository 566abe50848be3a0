//! Image output: one file, numbered frames, an animation or a video, chosen by the path.
//!
//! Files are written under a temporary name in the same folder and renamed when complete, so no partial file has its
//! final name.

mod film;
pub mod layers;

use crate::files;
use anyhow::{Context, Result, bail, ensure};
pub use film::Film;
use std::path::{Path, PathBuf};
pub use tresses_scene::picture::Image;
use tresses_scene::picture::{AnimationEncoder, AnimationFormat};

/// Reads a PNG file.
pub fn read(path: &Path) -> Result<Image> {
    let read = || decode(std::io::BufReader::new(std::fs::File::open(path)?));
    read().with_context(|| path.display().to_string())
}

/// Decodes a PNG file.
pub fn decode(file: impl std::io::BufRead + std::io::Seek) -> Result<Image> {
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().context("the image is too large")?];
    let info = reader.next_frame(&mut bytes)?;
    let pixel = |p: &[u8]| match p {
        [gray, alpha] => [*gray, *gray, *gray, *alpha],
        _ => [p[0], p[1], p[2], p[3]],
    };
    let rows = bytes[..info.buffer_size()].chunks_exact(info.color_type.samples());
    Ok(Image { width: info.width, height: info.height, rgba: rows.flat_map(pixel).collect() })
}

/// Joins images of equal height from left to right.
pub fn side_by_side(pictures: &[&Image]) -> Image {
    let height = pictures.iter().map(|p| p.height).min().unwrap_or(0);
    let row = |picture: &Image, y: u32| {
        let width = 4 * picture.width as usize;
        let from = y as usize * width;
        picture.rgba[from..from + width].to_vec()
    };
    let rgba = (0..height).flat_map(|y| pictures.iter().flat_map(move |p| row(p, y))).collect();
    Image { width: pictures.iter().map(|p| p.width).sum(), height, rgba }
}

/// Writes a PNG file.
pub fn write(picture: &Image, path: &Path) -> Result<()> {
    files::write(path, &picture.png()?)
}

/// Encoding of single frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// `.png`: the displayed image.
    Png,
    /// `.exr`: linear, with auxiliary channels.
    Exr,
}

/// Kind of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// A file with one image.
    Still(FrameFormat),
    /// A folder of numbered frames, or a path with `#` in place of the numbers.
    Frames(FrameFormat),
    /// `.webp`: small, true color, supported by every browser.
    WebP,
    /// `.gif`: 256 colors per frame.
    Gif,
    /// `.apng`: lossless and large.
    Apng,
    /// `.mp4` or `.webm`, encoded by ffmpeg.
    Film,
}

impl OutputKind {
    /// Returns the kind for the extension of `path`; a path without one is a folder.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let single = |encoded| if numbered(path) { Self::Frames(encoded) } else { Self::Still(encoded) };
        Ok(match extension.as_deref() {
            _ if is_folder(path) => Self::Frames(FrameFormat::Png),
            Some("png") => single(FrameFormat::Png),
            Some("exr") => single(FrameFormat::Exr),
            Some("webp") => Self::WebP,
            Some("gif") => Self::Gif,
            Some("apng") => Self::Apng,
            Some("mp4" | "webm") => Self::Film,
            other => bail!(
                "{}: images cannot be written as .{}; choose .png, .exr, .webp, .gif, .apng, .mp4, .webm, or a \
                 folder",
                path.display(),
                other.unwrap_or_default()
            ),
        })
    }

    /// Whether the output is a looping animation in one file.
    pub fn is_animation(self) -> bool {
        matches!(self, Self::WebP | Self::Gif | Self::Apng)
    }

    /// Whether the output is one image.
    pub fn is_still(self) -> bool {
        matches!(self, Self::Still(_))
    }

    /// Whether the output has auxiliary channels.
    pub fn has_layers(self) -> bool {
        matches!(self, Self::Still(FrameFormat::Exr) | Self::Frames(FrameFormat::Exr))
    }

    /// Whether the output supports an alpha channel.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::Still(_) | Self::Frames(_))
    }

    /// Returns the largest width or height of the format, pixels.
    pub fn max_side(self) -> u32 {
        match self {
            Self::WebP => 16_383,
            Self::Gif => 65_535,
            Self::Still(_) | Self::Frames(_) | Self::Apng | Self::Film => u32::MAX,
        }
    }
}

/// Whether a path is a folder: it exists, ends with a slash, or has no extension.
fn is_folder(path: &Path) -> bool {
    let ends = path.as_os_str().to_string_lossy().ends_with(['/', '\\']);
    ends || path.extension().is_none() || path.is_dir()
}

/// Whether the file name has a place for numbers.
fn numbered(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains('#'))
}

/// Returns the path of a frame: its number replaces the first run of `#`, padded to the length of the run.
fn frame(path: &Path, number: u32) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let Some(from) = name.find('#') else { return path.to_owned() };
    let digits = name[from..].chars().take_while(|c| *c == '#').count();
    path.with_file_name(format!("{}{number:0digits$}{}", &name[..from], &name[from + digits..]))
}

/// A frame.
pub enum OutputFrame {
    /// The displayed image.
    Shown(Image),
    /// An encoded file, and its size in pixels.
    File(Vec<u8>, [u32; 2]),
}

impl OutputFrame {
    fn size(&self) -> [u32; 2] {
        match self {
            Self::Shown(picture) => [picture.width, picture.height],
            Self::File(_, size) => *size,
        }
    }
}

/// Writes the frames of one output in order.
pub struct FrameWriter {
    path: PathBuf,
    kind: OutputKind,
    /// Whether PNG files have an alpha channel.
    alpha: bool,
    sink: Sink,
}

enum Sink {
    /// The last frame.
    Still(Option<OutputFrame>),
    Frames {
        next: u32,
    },
    Animation(Box<dyn AnimationEncoder>),
    Film(Film),
}

impl FrameWriter {
    /// Prepares to write `frames` frames of `width` × `height` pixels at `fps` frames per second. Creates folders now,
    /// so that an unwritable path fails before the work.
    pub fn create(path: &Path, size: (u32, u32), frames: u32, fps: f64) -> Result<Self> {
        let kind = OutputKind::of(path)?;
        let (width, height) = size;
        ensure!(
            width.max(height) <= kind.max_side(),
            "{}: this format supports at most {} pixels per side",
            path.display(),
            kind.max_side()
        );
        let path = if is_folder(path) { path.join("frame_####.png") } else { path.to_owned() };
        files::prepare(&path)?;
        let sink = match kind {
            OutputKind::Still(_) => Sink::Still(None),
            OutputKind::Frames(_) => Sink::Frames { next: 0 },
            OutputKind::WebP => Sink::Animation(AnimationFormat::WebP.begin([width, height], frames, fps)?),
            OutputKind::Gif => Sink::Animation(AnimationFormat::Gif.begin([width, height], frames, fps)?),
            OutputKind::Apng => Sink::Animation(AnimationFormat::Apng.begin([width, height], frames, fps)?),
            OutputKind::Film => Sink::Film(Film::begin(&path, size, fps)?),
        };
        Ok(Self { path, kind, alpha: false, sink })
    }

    /// Sets whether PNG files have an alpha channel.
    pub fn with_alpha(self, alpha: bool) -> Self {
        Self { alpha, ..self }
    }

    /// Returns the kind of output.
    pub fn kind(&self) -> OutputKind {
        self.kind
    }

    /// Whether only the last frame is written.
    pub fn keeps_only_last(&self) -> bool {
        self.kind.is_still()
    }

    /// Adds a frame.
    pub fn add(&mut self, added: OutputFrame) -> Result<()> {
        match (&mut self.sink, added) {
            (Sink::Still(last), added) => *last = Some(added),
            (Sink::Frames { next }, added) => {
                write_frame(&added, &frame(&self.path, *next), self.alpha)?;
                *next += 1;
            }
            (Sink::Animation(animation), OutputFrame::Shown(picture)) => {
                animation.add(&picture).with_context(|| self.path.display().to_string())?;
            }
            (Sink::Film(film), OutputFrame::Shown(picture)) => {
                film.add(&picture).with_context(|| self.path.display().to_string())?;
            }
            (Sink::Animation(_) | Sink::Film(_), OutputFrame::File(..)) => {
                bail!("{}: animations cannot store layers", self.path.display())
            }
        }
        Ok(())
    }

    /// Completes the output. Returns a description of the files.
    pub fn finish(self) -> Result<String> {
        let shown = self.path.display();
        let megabytes = |bytes: f64| format!("{shown} ({:.1} MB)", bytes * 1e-6);
        match self.sink {
            Sink::Still(Some(last)) => {
                write_frame(&last, &self.path, self.alpha)?;
                let [width, height] = last.size();
                Ok(format!("{shown} ({width} × {height})"))
            }
            Sink::Still(None) => bail!("{shown}: there is no image to write"),
            Sink::Frames { next } => {
                let [first, last] = [0, next.saturating_sub(1)].map(|number| frame(&self.path, number));
                let last = last.file_name().unwrap_or_default().to_string_lossy();
                Ok(format!("{} to {last} ({next} frames)", first.display()))
            }
            Sink::Animation(animation) => {
                let bytes = animation.finish().with_context(|| shown.to_string())?;
                files::write(&self.path, &bytes)?;
                Ok(megabytes(bytes.len() as f64))
            }
            Sink::Film(film) => {
                let bytes = film.finish(&self.path).with_context(|| shown.to_string())?;
                Ok(megabytes(bytes as f64))
            }
        }
    }
}

fn write_frame(frame: &OutputFrame, path: &Path, alpha: bool) -> Result<()> {
    match frame {
        OutputFrame::Shown(picture) if alpha => files::write(path, &picture.png_with_alpha()?),
        OutputFrame::Shown(picture) => write(picture, path),
        OutputFrame::File(bytes, _) => files::write(path, bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(shift: u8) -> Image {
        let (width, height) = (48, 32);
        let rgba = (0..height)
            .flat_map(|y| (0..width).flat_map(move |x| [(x * 5) as u8 ^ shift, (y * 7) as u8, 90, 255]))
            .collect();
        Image { width, height, rgba }
    }

    /// Returns the mean absolute difference of the channels, 0 to 255.
    fn difference(a: &[u8], b: &[u8]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
    }

    fn write(name: &str, frames: &[Image]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new").join(name);
        let mut output = FrameWriter::create(&path, (48, 32), frames.len() as u32, 25.0).unwrap();
        for frame in frames {
            output.add(OutputFrame::Shown(frame.clone())).unwrap();
        }
        output.finish().unwrap();
        (folder, path)
    }

    fn read_png(path: &Path) -> (png::OutputInfo, Vec<u8>) {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        (info, bytes)
    }

    #[test]
    fn path_selects_the_kind() {
        for (path, kind) in [
            ("a.png", OutputKind::Still(FrameFormat::Png)),
            ("a.PNG", OutputKind::Still(FrameFormat::Png)),
            ("a.exr", OutputKind::Still(FrameFormat::Exr)),
            ("out/frames", OutputKind::Frames(FrameFormat::Png)),
            ("out/v1.2/", OutputKind::Frames(FrameFormat::Png)),
            ("out/a.####.exr", OutputKind::Frames(FrameFormat::Exr)),
            ("out/#.png", OutputKind::Frames(FrameFormat::Png)),
            ("out/take#1/", OutputKind::Frames(FrameFormat::Png)),
            ("out/take#1", OutputKind::Frames(FrameFormat::Png)),
            ("a.mp4", OutputKind::Film),
            ("a.WebM", OutputKind::Film),
            ("a.webp", OutputKind::WebP),
            ("a.gif", OutputKind::Gif),
            ("a.apng", OutputKind::Apng),
        ] {
            assert_eq!(OutputKind::of(Path::new(path)).unwrap(), kind, "{path}");
        }
        assert!(OutputKind::of(Path::new("a.avi")).unwrap_err().to_string().contains(".webp"));
        let path = |name: &str, number| frame(Path::new(name), number).display().to_string();
        assert_eq!([path("a/b.##.exr", 7), path("a/b.##.exr", 123)], ["a/b.07.exr", "a/b.123.exr"]);
    }

    #[test]
    fn a_still_is_the_last_frame_and_lossless() {
        let (_folder, path) = write("a.png", &[gradient(0), gradient(64)]);
        let (info, bytes) = read_png(&path);
        assert_eq!((info.width, info.height), (48, 32));
        assert_eq!(bytes, gradient(64).rgb());
        assert_ne!(bytes, gradient(0).rgb());
    }

    #[test]
    fn a_folder_holds_numbered_frames() {
        let (_folder, path) = write("frames", &[gradient(0), gradient(64)]);
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 2);
        assert_eq!(read_png(&path.join("frame_0001.png")).1, gradient(64).rgb());
    }

    #[test]
    fn folder_names_may_contain_number_signs() {
        for name in ["take#1", "take#1/"] {
            let (_folder, path) = write(name, &[gradient(0)]);
            assert_eq!(read_png(&path.join("frame_0000.png")).1, gradient(0).rgb(), "{name}");
        }
    }

    #[test]
    fn webp_decodes() {
        let (_folder, path) = write("a.webp", &[gradient(0), gradient(64), gradient(128)]);
        let bytes = std::fs::read(path).unwrap();
        let decoder = webp_animation::Decoder::new(&bytes).unwrap();
        let frames: Vec<_> = decoder.into_iter().collect();
        assert_eq!(frames.iter().map(webp_animation::Frame::timestamp).collect::<Vec<_>>(), [40, 80, 120]);
        let close = difference(frames[1].data(), &gradient(64).rgba);
        let far = difference(frames[1].data(), &gradient(0).rgba);
        assert!(close < 6.0 && far > 2.0 * close, "{close} {far}");
    }

    #[test]
    fn gif_decodes() {
        let (_folder, path) = write("a.gif", &[gradient(0), gradient(64)]);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(std::fs::File::open(path).unwrap()).unwrap();
        let first = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!(first.delay, 4);
        let close = difference(&first.buffer, &gradient(0).rgba);
        assert!(close < 6.0 && difference(&first.buffer, &gradient(64).rgba) > 2.0 * close, "{close}");
        assert!(decoder.read_next_frame().unwrap().is_some() && decoder.read_next_frame().unwrap().is_none());
    }

    #[test]
    fn apng_decodes() {
        let (_folder, path) = write("a.apng", &[gradient(0), gradient(64)]);
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 2);
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        for shift in [0, 64] {
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes, gradient(shift).rgb());
        }
    }

    #[test]
    fn dropped_output_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.webp", "a.gif", "a.apng"] {
            let mut output = FrameWriter::create(&folder.path().join(name), (48, 32), 2, 25.0).unwrap();
            output.add(OutputFrame::Shown(gradient(0))).unwrap();
            drop(output);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn unwritable_paths_fail_on_create() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "x").unwrap();
        assert!(FrameWriter::create(&file.join("a.png"), (48, 32), 1, 25.0).is_err());
        assert!(FrameWriter::create(&folder.path().join("a.webp"), (20_000, 32), 1, 25.0).is_err());
    }
}
