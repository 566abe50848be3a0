//! The motion of the guides.

pub mod collider;
pub mod params;
pub mod rest;

#[cfg(test)]
mod physics;
#[cfg(test)]
mod reference;

pub use collider::{Capsule, ColliderPoses, ColliderSet, SdfCollider};
pub use params::{Along, SimulationParams};
pub use rest::{RestGuides, RestOptions, RestShape};
