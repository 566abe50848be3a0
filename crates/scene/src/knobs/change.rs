//! What a change of settings costs.

use super::{Refusal, Value, all, find};
use crate::settings::Settings;

/// What a change of a parameter costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Nothing: the next frame has it.
    Frame,
    /// The strands are grown or restyled again, and brought to the GPU: a fraction of a second, and the
    /// hair starts from rest.
    Regrow,
    /// Pipelines and the targets that pictures are drawn into are made again.
    Rebuild,
}

/// What has to be done to get from some settings to others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Something takes effect with the next frame.
    pub frame: bool,
    /// Strands have to be grown again.
    pub regrow: bool,
    /// Pipelines and targets have to be made again.
    pub rebuild: bool,
}

impl Changes {
    /// Whether anything differs.
    pub fn any(self) -> bool {
        self.frame || self.regrow || self.rebuild
    }
}

impl Settings {
    /// Gives the parameter at `path` a value.
    ///
    /// # Errors
    /// One sentence for a value out of range or of another kind, and where there is no such parameter.
    pub fn set(&mut self, path: &str, value: impl Into<Value>) -> Result<(), Refusal> {
        match find(path) {
            Some(knob) => knob.set(self, value.into()),
            None => Err(Refusal {
                path: path.to_owned(),
                value: "no parameter".to_owned(),
                range: "one that `tresses knobs` lists".to_owned(),
            }),
        }
    }

    /// Automatic parameters among `paths` have values of their own from here on.
    pub(crate) fn take_as_given(&mut self, paths: impl Iterator<Item = &'static str>) {
        self.given.extend(paths.filter(|path| find(path).is_some_and(|knob| knob.automatic)));
    }

    /// What has to be done to get from `before` to these.
    pub fn changes(&self, before: &Self) -> Changes {
        let mut changes = Changes::default();
        for knob in all().filter(|knob| knob.get(self) != knob.get(before)) {
            match knob.cost {
                Change::Frame => changes.frame = true,
                Change::Regrow => changes.regrow = true,
                Change::Rebuild => changes.rebuild = true,
            }
        }
        changes
    }
}
