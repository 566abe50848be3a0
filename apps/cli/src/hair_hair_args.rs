//! The option that says what hairs do to each other.

use tresses::{
    simulate::SimulationParams,
    volume::{HairHair, HairHairMode},
};

/// What hairs do to each other.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct HairHairArgs {
    /// What hair does where it is denser than at rest
    #[arg(long, value_name = "MODE", value_enum, default_value_t, help_heading = "Simulation")]
    hair_hair: Choice,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, Default)]
enum Choice {
    /// Nothing: hairs pass through each other
    Off,
    /// It is pushed out of dense cells by a fixed amount
    Fixed,
    /// It is pushed along the negative gradient of the density, with friction
    #[default]
    Gradient,
}

impl HairHairArgs {
    /// Puts the choice into `physics`. With `watched`, hair that passes through hair has a grid all the
    /// same, which does nothing: so that its density can be looked at.
    pub fn apply(self, physics: &mut SimulationParams, watched: bool) {
        let mode = match self.hair_hair {
            Choice::Off => HairHairMode::Off,
            Choice::Fixed => HairHairMode::Fixed,
            Choice::Gradient => HairHairMode::Gradient,
        };
        physics.hair_hair = match mode {
            HairHairMode::Off if watched => HairHair { speed: 0.0, friction: 0.0, ..HairHair::default() },
            mode => HairHair { mode, ..HairHair::default() },
        };
    }
}
