//! Systems of the render world.
//!
//! ```text
//! Render       prepare: grooms become characters, on a task each; measure_skies: light of environment maps
//! RenderGraph  simulate: all hair, once per frame
//! Core3d       draw: hair into this camera's color, tested against its depth
//! ```

mod characters;
mod draw;
mod overlays;
mod shadows;
mod simulate;
mod skies;

pub(crate) use characters::{Wardrobe, prepare};
pub(crate) use draw::{CameraViews, DefaultView, draw, read_depth};
pub(crate) use simulate::simulate;
pub(crate) use skies::{Skies, measure_skies};

use bevy::{
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
};
use tresses::Context;

/// The library's context on Bevy's device.
#[derive(Resource, Debug, Deref)]
pub(crate) struct HairContext(Context);

impl FromWorld for HairContext {
    fn from_world(world: &mut World) -> Self {
        let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
        Self(Context::new(device.wgpu_device(), queue))
    }
}
