//! Real-time hair for everything that runs wgpu: a groom goes in, simulated and shaded hair comes out.
//!
//! The modules stand in the order in which data passes through them; [`frame`] is the frame.

pub mod groom;

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

pub mod frame;
pub mod hair;
pub mod stage;

pub mod constants;
pub mod error;
pub mod gpu;
pub mod math;
pub mod progress;
pub mod shaders;

pub use error::{Error, Result};
pub use glam;
pub use hair::{Hair, HairOptions, HairRenderer};
pub use math::pose::Pose;
pub use progress::Progress;
pub use wgpu;
