//! Math shared by several stages.

#[cfg(test)]
pub(crate) mod ldl;
pub(crate) mod map;
pub mod pose;
pub mod ray;

pub use crate::groom::{hash, rotation};
pub use ray::Ray;
