//! Real-time hair for everything that runs wgpu: a groom goes in, simulated and shaded hair comes out.
//!
//! The modules stand in the order in which data passes through them; [`frame`] is the frame.
//!
//! ```no_run
//! use tresses::{
//!     Camera, Hair, Pipelines, Pose,
//!     body::Body,
//!     collide::ColliderPoses,
//!     drape,
//!     frame::{Frame, Recorder, Sight},
//!     gpu::Gpu,
//!     groom::styles::Style,
//!     simulate::SimulationParams,
//!     view::{Picture, View, ViewOptions},
//! };
//!
//! # async fn example() -> tresses::Result<()> {
//! // Once per device; an engine has one already. Pipelines live as long as it does.
//! let Gpu { device, queue, .. } = Gpu::open().await?;
//! let pipelines = Pipelines::new(&device);
//!
//! // Once per groom: here a built-in one, else `groom::import` and `groom::bind`.
//! let style = Style::Long(Default::default());
//! let made = drape::character(&device, &queue, &pipelines.simulate, &style, None).await?;
//! let mut hair = Hair::new(&device, &queue, &pipelines, &made.groom, &Default::default(), Some(&made.field))?;
//! let body = Body::new(&device, &made.mesh);
//! // Once per picture that is to be seen at a time.
//! let view = View::new(&device, &pipelines, &ViewOptions::default(), [1280, 720], 1)?;
//!
//! // Once per frame: the hair moves, then it is drawn.
//! let picture = Picture { camera: Camera::default(), ..Default::default() };
//! let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
//! let frame = Frame { dt: 1.0 / 60.0, head: Pose::IDENTITY, colliders, simulation, ..Default::default() };
//! let mut encoder = device.create_command_encoder(&Default::default());
//! let mut recorder = Recorder {
//!     pipelines: &pipelines,
//!     device: &device,
//!     queue: &queue,
//!     encoder: &mut encoder,
//!     timings: None,
//! };
//! recorder.record(&mut [(&mut hair, frame)], &[&body], vec![Sight::new(&view, &picture)])?;
//! queue.submit([encoder.finish()]);
//! # Ok(()) }
//! ```
//!
//! Whole programs are in `examples/`: `minimal` is a window, in a browser a page; `headless` writes one
//! picture; `embed` puts hair into a scene with its own targets, camera and lights ([`draw::embed`]);
//! `portrait` reads a groom and a head from files.

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

pub mod camera;
pub mod clock;
pub mod frame;
pub mod hair;
pub mod pipelines;
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
pub use error::{Error, Result};
pub use glam;
pub use groom::{Progress, progress, range};
pub use hair::{Hair, HairOptions};
pub use math::pose::Pose;
pub use pipelines::{Pipelines, Wanted};
pub use space::Space;
pub use view::View;
pub use wgpu;
