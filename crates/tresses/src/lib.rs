//! Real-time hair for everything that runs wgpu: a groom goes in, simulated and shaded hair comes out.
//!
//! The modules stand in the order in which data passes through them; [`frame`] is the frame.
//!
//! ```no_run
//! use tresses::{
//!     Hair, HairRenderer, Pose,
//!     collide::ColliderPoses,
//!     drape,
//!     draw::{Body, DrawOptions, Scene, Targets},
//!     frame::{Frame, Recorder},
//!     gpu::Gpu,
//!     groom::styles::Style,
//!     simulate::SimulationParams,
//! };
//!
//! # async fn example() -> tresses::Result<()> {
//! // Once per device; an engine has one already. Pipelines live as long as it does.
//! let Gpu { device, queue, .. } = Gpu::open().await?;
//! let renderer = HairRenderer::new(&device, &DrawOptions::default());
//!
//! // Once per groom: here a built-in one, else `groom::import` and `groom::bind`.
//! let style = Style::Long(Default::default());
//! let made = drape::character(&device, &queue, &renderer.simulate, &style, None).await?;
//! let mut hair = Hair::new(&device, &queue, &renderer, &made.groom, &Default::default(), Some(&made.field))?;
//! let body = Body::new(&device, &renderer.draw, &made.mesh);
//! let targets = Targets::new(&device, 1280, 720, 4, 1)?;
//!
//! // Once per frame: the hair moves, then it is drawn.
//! let scene = Scene { pose: Pose::IDENTITY, ..Default::default() };
//! let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
//! let frame = Frame { dt: 1.0 / 60.0, head: scene.pose, colliders, simulation };
//! let mut encoder = device.create_command_encoder(&Default::default());
//! let mut recorder = Recorder {
//!     renderer: &renderer,
//!     device: &device,
//!     queue: &queue,
//!     encoder: &mut encoder,
//!     timings: None,
//! };
//! recorder.advance(&mut hair, &frame)?;
//! recorder.draw(&hair, Some(&body), &scene, &targets, targets.picture());
//! queue.submit([encoder.finish()]);
//! # Ok(()) }
//! ```
//!
//! Whole programs are in `examples/`: `minimal` is a window, in a browser a page; `headless` writes one
//! picture; `embed` puts hair into a scene with its own targets, camera and lights ([`draw::embed`]);
//! `portrait` reads a groom and a head from files.

pub use tresses_groom as groom;

pub mod strands;

pub mod volume;

pub mod wind;

pub mod simulate;

pub mod tessellate;

pub mod interpolate;

pub mod avoid;

pub mod light;

pub mod lod;

pub mod draw;

pub mod present;

pub mod collide;

pub mod drape;

pub mod frame;
pub mod hair;
pub mod stage;

pub mod constants;
pub mod error;
pub mod gpu;
pub mod math;
pub mod shaders;

pub use error::{Error, Result};
pub use glam;
pub use groom::{Progress, progress};
pub use hair::{Hair, HairOptions, HairRenderer};
pub use math::pose::Pose;
pub use wgpu;
