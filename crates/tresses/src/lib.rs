//! Real-time hair simulation and rendering on wgpu: takes a groom, simulates it and draws shaded hair.
//!
//! ```no_run
//! use tresses::{Camera, Character, Context, Picture, Pose, View, ViewOptions, light::Lights};
//!
//! # async fn example(
//! #     device: &wgpu::Device, queue: &wgpu::Queue, target: &wgpu::TextureView, format: wgpu::TextureFormat,
//! # ) -> tresses::Result<()> {
//! // Once: wrap the engine's device and queue, load a character, create a view.
//! let tresses = Context::new(device, queue);
//! let mut ann = Character::load(&tresses, ["ann.glb"]).await?;
//! let mut view = View::new(&tresses, &ViewOptions::for_target(format), [1280, 720], 1)?;
//! let picture = Picture { camera: Camera::default(), lights: Lights::default(), ..Default::default() };
//!
//! // Each frame: pose the character, advance its hair, draw it.
//! ann.set_pose(Pose::IDENTITY);
//! let mut encoder = device.create_command_encoder(&Default::default());
//! let mut frame = tresses.frame(&mut encoder);
//! frame.advance(&mut [&mut ann], 1.0 / 60.0)?;
//! frame.draw(&mut view, &[&ann], &picture, target)?;
//! queue.submit([encoder.finish()]);
//! # Ok(()) }
//! ```
//!
//! [`Character::built_in`] needs no file. [`Frame::composite`] draws hair into a scene that the engine has drawn.
//!
//! **Two layers.** Everything outside [`low_level`] is for hosts: characters, views, frames and their options.
//! [`low_level`] is for tools and for hosts that replace [`Character`]: single grooms, the recorder of the stages, GPU
//! buffers, debug views and measurements.
//!
//! Complete programs are in `examples/`: `minimal` opens a window, or a page in a browser; `headless` writes one image;
//! `embed` draws a character in a renderer with its own targets, camera, lights and shadows; `character` follows a mesh
//! that an engine skins; `portrait` reads a groom and a head from files.

// In a browser, wgpu objects belong to one thread, and so does a context.
#![cfg_attr(target_arch = "wasm32", allow(clippy::arc_with_non_send_sync))]

pub use tresses_groom as groom;

// The stages, in the order in which data passes through them. `frame` records them.
mod strands;

mod skinning;

mod roots;

mod volume;

mod wind;

mod simulate;

mod tessellate;

mod interpolate;

mod avoid;

mod body;

pub mod light;

mod lod;

mod draw;

mod present;

pub mod collide;

pub mod drape;

mod budget;
mod camera;
mod character;
mod clock;
mod frame;
mod hair;
pub mod low_level;
mod prepare;
pub mod renderer;
mod space;
mod stage;
mod view;
#[cfg(feature = "debug-views")]
mod views;
#[cfg(not(feature = "debug-views"))]
#[path = "views/none.rs"]
mod views;

mod constants;
mod error;
mod gpu;
mod math;
mod shaders;

pub use avoid::{AvoidMode, AvoidOptions};
pub use body::{Body, BodyMaterial};
pub use budget::Budget;
pub use camera::{Bounds, Camera, ToneMap};
pub use character::{
    BodyPose, Character, CharacterAsset, CharacterOptions, CrowdBudget, Frame, Gesture, Obstacle, RiggedBody,
};
pub use draw::{Compositor, HostFrame};
pub use error::{Error, Result};
pub use glam;
pub use gpu::{Context, Gpu, Timings};
pub use groom::{
    Progress,
    character::{
        CharacterFiles, CharacterParts, CharacterSource, FaceGroom, FaceHair, FillOptions, LodLevel,
        MapCoordinates, Styling,
    },
    progress, range,
    tie::{Tie, TieTarget},
};
pub use hair::HairOptions;
pub use lod::{LodMode, LodOptions};
pub use math::pose::Pose;
pub use prepare::PipelineRequest;
pub use present::Background;
pub use simulate::{RestOptions, RestShape, RootToTip, SimulationParams};
pub use space::{Space, Velocity};
pub use view::{Picture, View, ViewOptions};
pub use volume::{HairHair, HairHairMode};
pub use wgpu;
pub use wind::Wind;

// Tests of single stages. The crate contains them because they use private types.
#[cfg(test)]
extern crate self as tresses;
#[cfg(test)]
#[allow(dead_code, unused_imports)] // `tests/gpu` uses the rest.
#[path = "../tests/gpu/common/mod.rs"]
mod common;
#[cfg(test)]
#[allow(dead_code)] // `tests/gpu` uses the rest.
#[path = "../tests/gpu/moving.rs"]
mod moving;
#[cfg(test)]
#[path = "../tests/stages/mod.rs"]
mod stages;
