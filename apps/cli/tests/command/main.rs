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

use std::{
    path::Path,
    process::{Command, Output},
};

/// Returns the command in `folder` without backtraces and without messages from a Mesa layer.
fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tresses"));
    command.current_dir(folder).args(args).envs([("RUST_BACKTRACE", "0"), ("NODEVICE_SELECT", "1")]);
    command
}

/// Runs the command.
fn output(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("the binary runs")
}

/// Returns the messages of the command.
fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("messages are UTF-8")
}

/// Runs the command. Returns whether it succeeded, and its output.
fn tresses(folder: &Path, args: &[&str]) -> (bool, String) {
    said(&output(folder, args))
}

/// Returns whether the command succeeded, and its output.
fn said(output: &Output) -> (bool, String) {
    let text = [&output.stdout[..], &output.stderr].concat();
    (output.status.success(), String::from_utf8_lossy(&text).into_owned())
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
