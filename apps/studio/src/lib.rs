//! The studio: one interactive viewer of hair, in a window and in the browser.
//!
//! ```text
//! app ──► viewport, panels      user input, frame by frame
//!  │
//!  ├─ job ──► task              long operations: pipelines, grooms; a thread natively, an async task in the browser
//!  └─ stage                     the only file that talks to the renderer: a frame into a texture
//! ```
//!
//! egui owns window, device and queue ([`device`] says what it asks the adapter for); [`stage`] draws
//! into a texture of its own, on the same queue. At most one frame of hair is in flight at any time ([`flight`]):
//! meanwhile the window shows the previous one and stays responsive, as long frames are handed in part by part and
//! the window's own go between. Frame time controls the resolution ([`pace`]). Nothing is drawn unless hair moves or
//! something changed.

pub mod app;
pub mod arrive;
pub mod ball;
pub mod blit;
pub mod device;
pub mod dialog;
pub mod events;
pub mod files;
pub mod flight;
pub mod frame;
pub mod hair;
pub mod head;
pub mod hosted;
pub mod job;
pub mod loss;

#[cfg(not(target_arch = "wasm32"))]
mod native;
pub mod options;
pub mod orbit;
pub mod pace;
pub mod panels;
pub mod picture;
pub mod play;
pub mod record;
pub mod sort;
pub mod stage;
pub mod state;
pub mod task;
pub mod theme;
pub mod tool;
pub mod turn;
pub mod viewport;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use native::run;
pub use options::Options;
