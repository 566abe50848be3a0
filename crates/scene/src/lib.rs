//! What the command and the studio share: a character from files or built in, its settings, how its
//! head moves and who looks at it. The library `tresses` knows nothing of it.

pub mod history;
pub mod knobs;
pub mod preset;
pub mod settings;

pub use history::History;
pub use knobs::{Knob, Value};
pub use preset::Preset;
pub use settings::{Change, Changes, Settings};
