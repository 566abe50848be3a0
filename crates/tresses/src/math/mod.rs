//! Small mathematics that several stages share.

pub mod ldl;
pub mod pose;
pub mod rotation;

pub use crate::groom::hash;
