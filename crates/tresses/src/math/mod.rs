//! Small mathematics that several stages share.

pub mod hash;
pub mod ldl;
pub mod pose;
pub mod rotation;
