//! The option that says what hairs do to each other.

use tresses::volume::HairHairMode;
use tresses_scene::Settings;

/// What hairs do to each other.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct HairHairArgs {
    /// What hair does where it is denser than at rest [default: gradient]
    #[arg(long, value_name = "MODE", value_enum, help_heading = "Simulation")]
    hair_hair: Option<Choice>,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
enum Choice {
    /// Nothing: hairs pass through each other
    Off,
    /// It is pushed out of dense cells by a fixed amount
    Fixed,
    /// It is pushed along the negative gradient of the density, with friction
    Gradient,
}

impl HairHairArgs {
    /// Puts what is given into `settings`.
    pub fn apply(self, settings: &mut Settings) {
        let Some(choice) = self.hair_hair else { return };
        settings.simulation.hair_hair.mode = match choice {
            Choice::Off => HairHairMode::Off,
            Choice::Fixed => HairHairMode::Fixed,
            Choice::Gradient => HairHairMode::Gradient,
        };
    }
}
