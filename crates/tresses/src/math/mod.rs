//! Small mathematics that several stages share.

pub mod pose;
