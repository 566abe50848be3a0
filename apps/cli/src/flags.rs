//! Flags generated from the tables of parameters and companion files.

use anyhow::Result;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches, error::ErrorKind};
use std::{marker::PhantomData, str::FromStr};
use tresses_scene::{
    Companion, PresetSource, Settings,
    companion_files::{ColorSource, MapSource},
    knobs::{Flag, Knob, SECTIONS, ValueKind, flags::Assignment, light_list, removed, renamed},
    settings::LightEntry,
    source::{COMPANION_FILES, CompanionKind as Companionship},
};

/// Selects the parameters that a command has flags for.
pub trait FlagSet {
    /// Whether the command has this flag.
    fn has(flag: &Flag) -> bool;
}

/// Selects all parameters.
#[derive(Clone, Debug, Default)]
pub struct All;

impl FlagSet for All {
    fn has(_: &Flag) -> bool {
        true
    }
}

/// Parsed flags of parameters.
#[derive(Clone, Debug, Default)]
pub struct RowFlags<R> {
    given: Vec<(&'static str, Assignment)>,
    lights: Vec<LightEntry>,
    rows: PhantomData<R>,
}

impl<R: FlagSet> RowFlags<R> {
    /// Whether this flag is given.
    pub fn gives(&self, name: &str) -> bool {
        let is_light = name == light_list::FLAG.name && !self.lights.is_empty();
        is_light || self.given.iter().any(|(given, _)| *given == name)
    }

    /// Applies the given flags to `settings`. Lights replace those of a preset.
    pub fn apply(&self, settings: &mut Settings) -> Result<()> {
        if !self.lights.is_empty() {
            settings.lights.list.clone_from(&self.lights);
        }
        self.given.iter().for_each(|(_, assigned)| assigned.reset(settings));
        self.given.iter().try_for_each(|(_, assigned)| Ok(assigned.set(settings)?))
    }

    /// Returns the parameters that have flags, with the titles of their sections.
    fn rows() -> impl Iterator<Item = (&'static str, &'static Knob, Flag)> {
        let rows = SECTIONS.iter().flat_map(|section| section.knobs.iter().map(|row| (section.title, row)));
        rows.filter_map(|(title, row)| Some((title, row, row.flag.filter(|flag| R::has(flag))?)))
    }
}

impl<R: FlagSet> Args for RowFlags<R> {
    fn augment_args(command: Command) -> Command {
        let command =
            Self::rows().fold(command, |command, (title, row, flag)| command.arg(argument(title, row, flag)));
        let command = if R::has(&light_list::FLAG) { command.arg(light_argument()) } else { command };
        // Hidden; an error names the successor.
        removed::FLAGS.iter().fold(command, |command, (name, _)| {
            command.arg(Arg::new(*name).long(*name).hide(true).action(ArgAction::SetTrue))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<R: FlagSet> FromArgMatches for RowFlags<R> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut given = Vec::new();
        let refuse = |kind, sentence: String| Error::raw(kind, sentence + "\n");
        if let Some((name, successor)) = removed::FLAGS.iter().find(|(name, _)| matches.get_flag(name)) {
            return Err(refuse(ErrorKind::UnknownArgument, format!("there is no --{name}; use {successor}")));
        }
        for (_, row, flag) in Self::rows() {
            let texts: Vec<&str> = match flag.value {
                "" => matches.get_flag(flag.name).then_some("on").into_iter().collect(),
                _ => {
                    matches.get_many::<String>(flag.name).into_iter().flatten().map(String::as_str).collect()
                }
            };
            for text in texts {
                let assigned = row.read_flag(text);
                given.push((flag.name, assigned.map_err(|clause| refuse(ErrorKind::InvalidValue, clause))?));
            }
        }
        let lights = match R::has(&light_list::FLAG) {
            true => matches.get_many::<LightEntry>(light_list::FLAG.name),
            false => None,
        };
        let lights = lights.into_iter().flatten().cloned().collect();
        Ok(Self { given, lights, rows: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Creates the flag of a parameter, with help from the parameter's hint, range and default.
fn argument(title: &'static str, row: &'static Knob, flag: Flag) -> Arg {
    let about = if flag.about.is_empty() { row.hint } else { flag.about };
    let about = about.trim_end_matches('.');
    let mut long = format!("{about}.\n{}", row.flag_help());
    if let ValueKind::Choice(choices) = row.kind {
        for choice in choices {
            long += &format!("\n- {}: {}", choice.name, choice.hint);
        }
    }
    let arg = Arg::new(flag.name)
        .long(flag.name)
        .aliases(renamed::FLAGS.iter().filter(|(_, name)| *name == flag.name).map(|(former, _)| *former))
        .help_heading(title)
        .help(about.to_owned())
        .long_help(long.trim_end().to_owned())
        .hide_short_help(!flag.common);
    match flag.value {
        "" => arg.action(ArgAction::SetTrue),
        value => arg
            .value_name(value)
            .allow_negative_numbers(true)
            .value_parser(move |text: &str| row.read_flag(text).map(|_| text.to_owned())),
    }
}

/// Creates the flag of the list of lights.
fn light_argument() -> Arg {
    let Flag { name, value, about, common, .. } = light_list::FLAG;
    let title = SECTIONS.iter().find(|section| section.knobs.iter().any(|row| row.path == "lights.key"));
    Arg::new(name)
        .long(name)
        .value_name(value)
        .help_heading(title.map(|section| section.title))
        .help(about)
        .long_help(format!("{about}.\n{}", light_list::flag_help()))
        .hide_short_help(!common)
        .action(ArgAction::Append)
        // A direction may begin with a negative number, which is not a flag.
        .allow_hyphen_values(true)
        .value_parser(light_list::one)
}

/// Parsed flags of companion files: maps, curls, obstacles, environments.
#[derive(Clone, Debug, Default)]
pub struct CompanionFlags {
    given: Vec<(&'static Companion, String)>,
}

impl CompanionFlags {
    /// Whether the file with this key is given.
    pub fn gives(&self, key: &str) -> bool {
        self.given.iter().any(|(companion, _)| companion.key == key)
    }

    /// Applies the given files to `source`.
    pub fn apply(&self, source: &mut PresetSource) {
        self.given.iter().for_each(|(companion, name)| companion.set(source, Some(name.clone())));
    }
}

/// Help text of scalp maps.
const SCALP: &str = "\nA .png of the scalp from above: the top is the front, the right is the head's left. Append :r, \
    :g or :b for one channel. Or a built-in map: front, crown, sides, nape, hairline, noise, or an inverse such as \
    not-front.";

impl Args for CompanionFlags {
    fn augment_args(command: Command) -> Command {
        COMPANION_FILES.iter().fold(command, |command, companion| {
            let (heading, value) = match companion.kind {
                Companionship::Map => ("Maps on the scalp", "IMAGE[:C]|NAME"),
                Companionship::Colors => ("Maps on the scalp", "IMAGE"),
                _ => ("Files", "FILE"),
            };
            let mut long = format!("{}.", companion.hint);
            if companion.kind == Companionship::Map {
                long += if companion.key == COMPANION_FILES[0].key {
                    SCALP
                } else {
                    "\nAn image or a name, as for --density-map."
                };
            }
            let kind = companion.kind;
            let arg = Arg::new(companion.key)
                .long(companion.flag)
                .value_name(value)
                .help_heading(heading)
                .help(companion.hint)
                .long_help(long)
                .hide_short_help(companion.key != "environment")
                .value_parser(move |text: &str| name(kind, text));
            command.arg(arg)
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for CompanionFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let name = |key| matches.get_one::<String>(key).cloned();
        Ok(Self { given: COMPANION_FILES.iter().filter_map(|c| Some((c, name(c.key)?))).collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns the name of a file of this kind, in the form that presets store.
fn name(kind: Companionship, text: &str) -> Result<String, String> {
    Ok(match kind {
        Companionship::Map => MapSource::from_str(text).map_err(|error| error.to_string())?.to_string(),
        Companionship::Colors => ColorSource::from_str(text).map_err(|error| error.to_string())?.to_string(),
        _ => text.to_owned(),
    })
}
