//! Hair in the render world.
//!
//! ```text
//! Render       prepare: grooms come to the GPU, on a task each; measure_skies: the light of environment maps
//! RenderGraph  simulate: all hair moves, once per frame
//! Core3d       draw: hair into this camera's colour, by its depth
//! ```

mod draw;
mod fog;
mod known;
mod living;
mod prepare;
mod shadows;
mod simulate;
mod skies;

pub(crate) use draw::{DefaultView, Eyes, draw, read_depth};
pub(crate) use fog::Fog;
#[cfg(feature = "pbr")]
pub(crate) use fog::Thickness;
pub(crate) use prepare::{Wardrobe, prepare};
pub(crate) use simulate::simulate;
pub(crate) use skies::{Skies, measure_skies};

use bevy::log::error;
use std::collections::BTreeSet;

/// Says what went wrong, each thing once: what fails in one frame fails in the next.
#[derive(Debug, Default)]
pub(crate) struct Complaints(BTreeSet<String>);

impl Complaints {
    pub fn say(&mut self, what: String) {
        if !self.0.contains(&what) {
            error!("{what}");
            self.0.insert(what);
        }
    }
}
