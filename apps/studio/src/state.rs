//! The studio's state, reported for tests that drive it from outside.

use serde::Serialize;
use std::sync::{Mutex, PoisonError};

/// A few facts, written after every frame of the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// Pictures of the hair so far.
    pub frames: u64,
    /// Which of them the window shows.
    pub seen: u64,
    /// How often the window was painted.
    pub painted: u64,
    /// Strands of the groom; 0 while nothing is shown.
    pub strands: u32,
    /// What is shown.
    pub file: String,
    /// What stands beside it: maps, obstacles, surroundings.
    pub companions: Vec<String>,
    /// What is being done, or empty.
    pub step: String,
    /// The last sentence about something that went wrong, or empty.
    pub error: String,
    /// Whether time goes by.
    pub playing: bool,
    /// Seconds of the motion.
    pub time: f64,
    /// Pixels of the picture.
    pub size: [u32; 2],
    /// Pixels drawn per pixel of it, along each axis.
    pub ssaa: u32,
    /// Strands in it.
    pub drawn: u32,
    /// How many parts of a finer one are done, of how many.
    pub parts: [usize; 2],
    /// How far the camera is from what it looks at, metres.
    pub distance: f32,
    /// Milliseconds of the last frame.
    pub milliseconds: f32,
    /// The adapter.
    pub adapter: String,
    /// Whether the device is lost.
    pub lost: bool,
    /// Whether a picture is under way or due.
    pub busy: bool,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

/// Says how things are now; also to the file that `TRESSES_STUDIO_STATE` names, if it does.
pub fn publish(state: State) {
    if let Some(path) = std::env::var_os("TRESSES_STUDIO_STATE")
        && let Ok(text) = serde_json::to_string(&state)
        && let Err(error) = std::fs::write(&path, text)
    {
        eprintln!("{}: {error}", std::path::Path::new(&path).display());
    }
    *STATE.lock().unwrap_or_else(PoisonError::into_inner) = Some(state);
}

/// How things are, as JSON; `{}` before the first frame.
pub fn json() -> String {
    let state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    state.as_ref().and_then(|state| serde_json::to_string(state).ok()).unwrap_or_else(|| "{}".into())
}
