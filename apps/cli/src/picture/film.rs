//! Films, `.mp4` and `.webm`, by ffmpeg where it is installed: frames go to it as they come.

use super::Picture;
use crate::files::Temporary;
use anyhow::{Context, Result, bail, ensure};
use std::{
    io::{Read, Write},
    path::Path,
    process::{Child, ChildStdin, Command, Stdio},
    thread::JoinHandle,
};

/// The program, unless `TRESSES_FFMPEG` names another.
const PROGRAM: &str = "ffmpeg";

/// The encoders of containers: what plays everywhere, at a quality that keeps single hairs.
const MP4: &[&str] =
    &["-c:v", "libx264", "-crf", "16", "-preset", "medium", "-movflags", "+faststart", "-f", "mp4"];
const WEBM: &[&str] = &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-f", "webm"];

/// A film that is being written. One that is dropped leaves nothing.
pub struct Film {
    child: Child,
    frames: Option<ChildStdin>,
    /// What it says, read as it comes: a program that nobody listens to may wait for ever.
    said: Option<JoinHandle<String>>,
    file: Option<Temporary>,
    program: String,
}

impl Film {
    /// Begins the film of `path`, `.webm` or else `.mp4`.
    pub fn begin(path: &Path, (width, height): (u32, u32), fps: f64) -> Result<Self> {
        let program = program();
        let is_webm = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("webm"));
        let file = Temporary::beside(path)?;
        let mut command = Command::new(&program);
        command
            .args(["-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"])
            .args(["-video_size", &format!("{width}x{height}"), "-framerate", &fps.to_string(), "-i", "-"])
            // Colours are sRGB's; these films halve the resolution of hues, so that sides are even.
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
        let said = child.stderr.take().map(|mut stderr| {
            std::thread::spawn(move || {
                let mut said = String::new();
                // What is no text says nothing.
                let _ = stderr.read_to_string(&mut said);
                said
            })
        });
        Ok(Self { child, frames, said, file: Some(file), program })
    }

    /// Fails when there is no program for the film of `path`.
    pub fn check(path: &Path) -> Result<()> {
        let program = program();
        let mut command = Command::new(&program);
        command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().map(drop).with_context(|| missing(path, &program))
    }

    /// The next frame.
    pub fn add(&mut self, picture: &Picture) -> Result<()> {
        let frames = self.frames.as_mut().context("the film is done")?;
        match frames.write_all(&picture.rgba) {
            Ok(()) => Ok(()),
            Err(_) => {
                // It has ended, and says why.
                self.ended()?;
                bail!("{} ended before the film did", self.program)
            }
        }
    }

    /// Completes the film at `path`; its bytes.
    pub fn finish(mut self, path: &Path) -> Result<u64> {
        self.ended()?;
        let file = self.file.take().context("the film is done")?;
        let size = std::fs::metadata(file.path())?.len();
        ensure!(size > 0, "{} has written nothing", self.program);
        file.complete(&[], path)?;
        Ok(size)
    }

    /// Waits for the program.
    fn ended(&mut self) -> Result<()> {
        drop(self.frames.take());
        let status = self.child.wait()?;
        let said = self.said.take().and_then(|said| said.join().ok()).unwrap_or_default();
        if status.success() {
            return Ok(());
        }
        let why = said.lines().next().unwrap_or("it does not say why");
        bail!("{} failed: {why}", self.program)
    }
}

fn program() -> String {
    std::env::var("TRESSES_FFMPEG").unwrap_or_else(|_| PROGRAM.into())
}

fn missing(path: &Path, program: &str) -> String {
    let path = path.display();
    format!(
        "{path}: films are made by {program}, which cannot be started (.webp, .gif and .apng need no program)"
    )
}

impl Drop for Film {
    fn drop(&mut self) {
        // Of one that has ended this is nothing.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
