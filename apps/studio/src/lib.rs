//! The studio: an interactive hair viewer for the desktop and the browser.
//!
//! ```text
//! app ──► panels, viewport            user input, frame by frame; each borrows the parts it needs
//!  ├──► document ──► job ──► task      settings, hair, history; jobs on a thread natively, async tasks in the browser
//!  ├──► light_handles                  lights of the list in the viewport
//!  ├──► record, picture, hosted        a loop or an image as a file; the host page
//!  │      ├──► strokes ──► groomer     the brush in the viewport; groomed hair
//!  │      └──► renderer ──► stage      schedule and quality of frames; only `stage` talks to the renderer
//!  │             ├──► cards            baked cards, and the level that is shown
//!  │             └──► playback         transport, hand and ball
//!  └──► dialog, loss, messages
//! ```
//!
//! egui owns the window, the device and the queue ([`device`] configures them). [`stage`] draws into its own texture on
//! the same queue. At most one frame of hair is in flight ([`flight`]); meanwhile the window shows the previous one and
//! stays responsive, because long frames are submitted in parts and the window's own frames run in between. The frame
//! time controls the resolution ([`pace`]). Nothing is drawn unless hair moves or something has changed.

pub mod answer;
pub mod app;
pub mod ball;
pub mod blit;
pub mod cards;
pub mod device;
pub mod dialog;
pub mod document;
pub mod events;
pub mod files;
pub mod flight;
pub mod groomer;
pub mod hair;
pub mod head;
pub mod hosted;
pub mod job;
pub mod journal;
pub mod light_handles;
pub mod light_placement;
pub mod loss;
pub mod messages;

#[cfg(not(target_arch = "wasm32"))]
mod native;
pub mod options;
pub mod orbit;
pub mod pace;
#[cfg(target_arch = "wasm32")]
mod page;
pub mod panels;
#[cfg(target_arch = "wasm32")]
mod pen;
pub mod picture;
pub mod play;
pub mod playback;
pub mod record;
pub mod renderer;
pub mod sort;
pub mod stage;
pub mod state;
pub mod strokes;
pub mod task;
pub mod theme;
pub mod tool;
pub mod viewport;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use native::run;
pub use options::Options;
