//! Options for a file's unit and axes, flattened into several commands.

use tresses::groom::{
    import::{ImportOptions, Moment},
    orient::{Axis, LengthUnit},
};

/// Heading of these options in help.
const HEADING: &str = "Unit and axes";

/// Unit and axes of the files.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct OrientArgs {
    /// Groom's unit: m, cm, mm, dm, in, ft or meters per unit [default: guessed]
    #[arg(long, value_name = "UNIT", help_heading = HEADING, hide_short_help = true)]
    unit: Option<LengthUnit>,
    /// Groom's axis that points up, such as y, z or -z [default: guessed]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help_heading = HEADING, hide_short_help = true)]
    up: Option<Axis>,
    /// Groom's axis that the face points along [default: guessed]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help_heading = HEADING, hide_short_help = true)]
    front: Option<Axis>,
    /// Whether to swap left and right of the groom [default: guessed, with a head]
    #[arg(
        long, value_name = "BOOL", num_args = 0..=1, require_equals = true,
        default_missing_value = "true",
        help_heading = HEADING, hide_short_help = true
    )]
    mirror: Option<bool>,
    /// Head's unit [default: guessed]
    #[arg(long, value_name = "UNIT", help_heading = HEADING, hide_short_help = true)]
    head_unit: Option<LengthUnit>,
    /// Head's axis that points up [default: guessed]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help_heading = HEADING, hide_short_help = true)]
    head_up: Option<Axis>,
    /// Head's axis that the face points along [default: guessed]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help_heading = HEADING, hide_short_help = true)]
    head_front: Option<Axis>,
}

/// Frame or time of an animated groom.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct MomentArgs {
    /// Frame to read from an animated groom (.abc, .usd), counted from 0 [default: the first]
    #[arg(long, value_name = "N", conflicts_with = "seconds")]
    frame: Option<u32>,
    /// Time to read from an animated groom, seconds; the nearest frame is read
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seconds: Option<f64>,
}

impl MomentArgs {
    /// Returns the moment in the library's form.
    pub fn moment(&self) -> Moment {
        match (self.frame, self.seconds) {
            (Some(frame), _) => Moment::Frame(frame),
            (None, Some(seconds)) => Moment::Seconds(seconds),
            (None, None) => Moment::First,
        }
    }
}

impl OrientArgs {
    /// Applies the given options to `options`.
    pub fn apply(&self, options: &mut ImportOptions) {
        let (groom, head) = (&mut options.orient, &mut options.orient_head);
        groom.unit = self.unit.or(groom.unit);
        groom.up = self.up.or(groom.up);
        groom.front = self.front.or(groom.front);
        groom.is_mirrored = self.mirror.or(groom.is_mirrored);
        head.unit = self.head_unit.or(head.unit);
        head.up = self.head_up.or(head.up);
        head.front = self.head_front.or(head.front);
    }

    /// Returns the import options.
    pub fn options(&self) -> ImportOptions {
        let mut options = ImportOptions::default();
        self.apply(&mut options);
        options
    }
}
