//! Wind.

pub mod air;
pub mod gusts;
pub mod params;
mod stage;

pub use air::{Air, AirPlace, HairGrid};
pub use params::Wind;
pub use stage::Fluid;
