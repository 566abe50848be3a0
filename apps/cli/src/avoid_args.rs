//! The option for what is done about drawn strands that enter the head.

use tresses::avoid::AvoidMode;

/// What drawn strands do where they would enter the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Avoid {
    /// They enter it.
    Off,
    /// Only the vertices inside are moved out.
    Vertices,
    /// The strand follows its nearest guide from before there on.
    Strands,
}

impl From<Avoid> for AvoidMode {
    fn from(avoid: Avoid) -> Self {
        match avoid {
            Avoid::Off => Self::Off,
            Avoid::Vertices => Self::PenetratingOnly,
            Avoid::Strands => Self::ChangeOver,
        }
    }
}
