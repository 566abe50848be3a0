//! Videos, `.mp4` and `.webm`: frames are piped to ffmpeg, if it is installed.

use super::Image;
use crate::files::Temporary;
use anyhow::{Context, Result, bail, ensure};
use std::{
    io::{Read, Write},
    path::Path,
    process::{Child, ChildStdin, Command, Stdio},
    thread::JoinHandle,
};

/// The encoder program, unless `TRESSES_FFMPEG` names another.
const PROGRAM: &str = "ffmpeg";

/// Encoder options: widely supported codecs, at a quality that preserves single hairs.
const MP4: &[&str] =
    &["-c:v", "libx264", "-crf", "16", "-preset", "medium", "-movflags", "+faststart", "-f", "mp4"];
const WEBM: &[&str] = &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-f", "webm"];

/// A video being written. Dropping it deletes the file.
pub struct Film {
    child: Child,
    frames: Option<ChildStdin>,
    /// Error output of the program, read as it arrives so that a full pipe does not block the program.
    error_output: Option<JoinHandle<String>>,
    file: Option<Temporary>,
    program: String,
}

impl Film {
    /// Starts the video at `path`: WebM for `.webm`, else MP4.
    pub fn begin(path: &Path, (width, height): (u32, u32), fps: f64) -> Result<Self> {
        let program = program();
        let is_webm = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("webm"));
        let file = Temporary::in_folder_of(path)?;
        let mut command = Command::new(&program);
        command
            .args(["-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"])
            .args(["-video_size", &format!("{width}x{height}"), "-framerate", &fps.to_string(), "-i", "-"])
            // Input colors are sRGB. The videos halve the chroma resolution, so pad both sides to even lengths.
            .args([
                "-vf",
                "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
            ])
            .args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1"])
            .args(if is_webm { WEBM } else { MP4 })
            .arg(file.path());
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().with_context(|| missing(path, &program))?;
        let frames = child.stdin.take();
        let error_output = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut text = String::new();
                // Ignore output that is not UTF-8.
                let _ = stderr.read_to_string(&mut text);
                text
            })
        });
        Ok(Self { child, frames, error_output, file: Some(file), program })
    }

    /// Fails if the encoder for the video at `path` is missing.
    pub fn check(path: &Path) -> Result<()> {
        let program = program();
        let mut command = Command::new(&program);
        command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().map(drop).with_context(|| missing(path, &program))
    }

    /// Adds a frame.
    pub fn add(&mut self, picture: &Image) -> Result<()> {
        let frames = self.frames.as_mut().context("the video is complete")?;
        match frames.write_all(&picture.rgba) {
            Ok(()) => Ok(()),
            Err(_) => {
                // The program has exited; report its error.
                self.ended()?;
                bail!("{} exited before the end of the video", self.program)
            }
        }
    }

    /// Completes the video at `path`. Returns its size, bytes.
    pub fn finish(mut self, path: &Path) -> Result<u64> {
        self.ended()?;
        let file = self.file.take().context("the video is complete")?;
        let size = std::fs::metadata(file.path())?.len();
        ensure!(size > 0, "{} wrote nothing", self.program);
        file.complete(&[], path)?;
        Ok(size)
    }

    /// Closes the pipe and waits for the program.
    fn ended(&mut self) -> Result<()> {
        drop(self.frames.take());
        let status = self.child.wait()?;
        let error_output = self.error_output.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        if status.success() {
            return Ok(());
        }
        let why = error_output.lines().next().unwrap_or("no error message");
        bail!("{} failed: {why}", self.program)
    }
}

fn program() -> String {
    std::env::var("TRESSES_FFMPEG").unwrap_or_else(|_| PROGRAM.into())
}

fn missing(path: &Path, program: &str) -> String {
    let path = path.display();
    format!(
        "{path}: videos need {program}, which cannot be started; install it, or choose .webp, .gif or .apng"
    )
}

impl Drop for Film {
    fn drop(&mut self) {
        // Does nothing if the program has exited.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
