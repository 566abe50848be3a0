//! The studio's state, published for host pages and tests.

use crate::groomer::Groomer;
use eframe::egui::Pos2;
use serde::Serialize;
use std::sync::{Mutex, PoisonError};
use tresses_scene::settings::LightEntry;

/// State after a frame of the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// Frames of the hair so far.
    pub frames: u64,
    /// Index of the displayed frame.
    #[serde(rename = "seen")]
    pub displayed_frame: u64,
    /// Number of times the window was painted.
    pub painted: u64,
    /// Strands of the groom; 0 while nothing is shown.
    pub strands: u32,
    /// Name of the hair.
    pub file: String,
    /// Companion files: maps, obstacles, environment.
    #[serde(rename = "companions")]
    pub companion_files: Vec<String>,
    /// Name of the level of cards on the screen, or `strands`; empty before a bake.
    pub cards: String,
    /// The hair under the brush; none unless a brush is active.
    pub groom: Option<GroomState>,
    /// The list of lights.
    pub lights: Vec<LightEntryState>,
    /// Whether brushes push moving hair.
    pub live: bool,
    /// Whether groomed hair that an earlier studio has left is offered.
    pub recovers: bool,
    /// Current step of the running job, or empty.
    pub step: String,
    /// The last error, or empty.
    pub error: String,
    /// Whether the motion plays.
    pub playing: bool,
    /// Time of the motion, seconds.
    pub time: f64,
    /// Size of the displayed frame, pixels.
    pub size: [u32; 2],
    /// Supersampling factor per axis of the displayed frame.
    pub ssaa: u32,
    /// Number of drawn strands.
    pub drawn: u32,
    /// Progress of a refinement: finished parts, and all parts.
    pub parts: [usize; 2],
    /// Position of the pointer in the last frame of the window, points; none outside the window.
    pub pointer: Option<[f32; 2]>,
    /// Distance from the camera to its target, meters.
    pub distance: f32,
    /// Duration of the last frame, milliseconds.
    pub milliseconds: f32,
    /// Name of the adapter.
    pub adapter: String,
    /// Whether the device is lost.
    pub lost: bool,
    /// Whether a frame is in flight or due.
    #[serde(rename = "busy")]
    pub pending: bool,
}

/// State of a light of the list.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LightEntryState {
    /// Shape.
    pub shape: &'static str,
    /// Center, meters; none for a distant light.
    pub center: Option<[f32; 3]>,
    /// Azimuth and elevation, degrees; only for a distant light.
    pub direction: Option<[f32; 2]>,
    /// Place of its handle in the window, points; none behind the camera, and while handles are hidden.
    pub handle: Option<[f32; 2]>,
}

impl LightEntryState {
    /// Returns the states of `list`, whose handles are at `places`.
    pub fn list(list: &[LightEntry], places: &[Option<Pos2>]) -> Vec<Self> {
        let state = |(i, light): (usize, &LightEntry)| Self {
            shape: light.kind.name(),
            center: light.center().map(Into::into),
            direction: match light.center() {
                None => Some([light.azimuth.to_degrees(), light.elevation.to_degrees()]),
                Some(_) => None,
            },
            handle: places.get(i).copied().flatten().map(Into::into),
        };
        list.iter().enumerate().map(state).collect()
    }
}

/// State of grooming.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GroomState {
    /// Guides of the hair.
    pub guides: usize,
    /// Strokes that lead to the current version.
    pub strokes: usize,
    /// Hash of the guides.
    pub hash: String,
    /// Duration of the last frame's dabs, milliseconds.
    pub dab_ms: f32,
    /// Whether a stroke is under way.
    pub active: bool,
}

impl GroomState {
    /// Returns the state of `groomer`.
    pub fn of(groomer: &Groomer) -> Self {
        Self {
            guides: groomer.document().guides().len(),
            strokes: groomer.stroke_count(),
            hash: format!("{:016x}", groomer.hash()),
            dab_ms: groomer.milliseconds,
            active: groomer.editor().is_active(),
        }
    }
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

/// Publishes the state. Also writes it to the file named by `TRESSES_STUDIO_STATE`, if set.
pub fn publish(state: State) {
    if let Some(path) = std::env::var_os("TRESSES_STUDIO_STATE")
        && let Ok(text) = serde_json::to_string(&state)
        && let Err(error) = std::fs::write(&path, text)
    {
        eprintln!("{}: {error}", std::path::Path::new(&path).display());
    }
    *STATE.lock().unwrap_or_else(PoisonError::into_inner) = Some(state);
}

/// Returns the state as JSON; `{}` before the first frame.
pub fn json() -> String {
    let state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    state.as_ref().and_then(|state| serde_json::to_string(state).ok()).unwrap_or_else(|| "{}".into())
}
