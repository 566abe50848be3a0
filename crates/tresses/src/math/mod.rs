//! Math shared by several stages.

pub mod ldl;
pub(crate) mod map;
pub mod pose;
pub mod ray;
pub mod rotation;

pub use crate::groom::hash;
pub use ray::Ray;
