//! The command as a process.

mod alembic;
mod bodies;
mod cooked;
mod export;
mod info_convert;
#[cfg(target_os = "linux")]
mod memory;
mod options;
mod pictures;
mod truth;

use std::{path::Path, process::Command};

/// Runs the command. Returns whether it succeeded, and its output.
fn tresses(folder: &Path, args: &[&str]) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_tresses")).current_dir(folder).args(args).output().unwrap();
    (out.status.success(), String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned())
}

/// Runs a command that needs a GPU. Returns `None` if there is none and none is required.
fn drawn(folder: &Path, args: &[&str]) -> Option<(bool, String)> {
    let (done, said) = tresses(folder, args);
    (!tresses_testing::lacks_gpu(&said)).then_some((done, said))
}

/// Reads a PNG file: its kind of pixels, and their values.
fn pixels(path: &Path) -> (png::ColorType, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.color_type, pixels)
}
