//! Small mathematics that several stages share.

pub mod hash;
pub mod pose;
pub mod rotation;
