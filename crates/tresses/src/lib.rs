//! Real-time hair simulation and rendering on wgpu: takes a groom, simulates it and draws shaded hair.
//!
//! The stage modules are declared in the order in which data passes through them. [`frame`] records them.
//!
//! ```no_run
//! use tresses::{Camera, Character, Context, Pose, View, light::Lights, view::{Picture, ViewOptions}};
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
//! Programs that need more control use the layer below: [`Hair`], [`body::Body`], [`frame::Recorder`].
//!
//! Complete programs are in `examples/`: `minimal` opens a window, or a page in a browser; `headless` writes one image;
//! `embed` draws a character in a renderer with its own targets, camera, lights and shadows; `character` follows a mesh
//! that an engine skins; `portrait` reads a groom and a head from files.

// In a browser, wgpu objects belong to one thread, and so does a context.
#![cfg_attr(target_arch = "wasm32", allow(clippy::arc_with_non_send_sync))]

pub use tresses_groom as groom;

pub mod strands;

pub mod skinning;

pub mod roots;

pub mod volume;

pub mod wind;

pub mod simulate;

pub mod tessellate;

pub mod interpolate;

pub mod avoid;

pub mod body;

pub mod light;

pub mod lod;

pub mod draw;

pub mod present;

pub mod collide;

pub mod drape;

pub mod budget;
pub mod camera;
pub mod character;
pub mod clock;
pub mod frame;
pub mod hair;
pub mod prepare;
pub mod renderer;
pub mod space;
pub mod stage;
pub mod view;
pub mod views;

pub mod constants;
pub mod error;
pub mod gpu;
pub mod math;
pub mod shaders;

pub use camera::Camera;
pub use character::{Character, CharacterAsset, Frame};
pub use error::{Error, Result};
pub use glam;
pub use gpu::Context;
pub use groom::{Progress, progress, range};
pub use hair::{Hair, HairAsset, HairDescriptor, HairOptions};
pub use math::pose::Pose;
pub use prepare::PipelineRequest;
pub use space::Space;
pub use view::View;
pub use wgpu;
