//! Math shared by several stages.

pub(crate) mod map;
pub mod pose;
pub mod ray;

pub use crate::groom::{hash, rotation};
pub use ray::Ray;
