//! Mathematics shared by several stages.

pub mod ldl;
pub mod pose;
pub mod rotation;

pub use crate::groom::hash;
