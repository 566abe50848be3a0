//! Mathematics shared by several stages.

pub mod hash;
pub mod ldl;
pub mod pose;
pub mod rotation;
