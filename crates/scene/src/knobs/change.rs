//! Cost of changing settings.

use super::{Refusal, Value, all, find};
use crate::settings::{HairColor, Settings};

/// Cost of changing a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Free. The change takes effect in the next frame.
    Frame,
    /// Rebuilds the strands and uploads them. This takes a fraction of a second, and the hair starts from rest.
    Regrow,
    /// Recreates pipelines and render targets.
    Rebuild,
}

/// Work required to apply a change of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Some changes take effect in the next frame.
    pub frame: bool,
    /// The strands must be rebuilt.
    pub regrow: bool,
    /// Pipelines and targets must be recreated.
    pub rebuild: bool,
}

impl Changes {
    /// Returns whether anything changed.
    pub fn any(self) -> bool {
        self.frame || self.regrow || self.rebuild
    }
}

impl Settings {
    /// Sets the parameter at `path`.
    ///
    /// # Errors
    /// Fails if the value is out of range or of the wrong type, or if there is no such parameter.
    pub fn set(&mut self, path: &str, value: impl Into<Value>) -> Result<(), Refusal> {
        match find(path) {
            Some(knob) => knob.set(self, value.into()),
            None => Err(Refusal {
                path: path.to_owned(),
                value: "unknown".to_owned(),
                range: "a parameter that `tresses knobs` lists".to_owned(),
            }),
        }
    }

    /// Marks the automatic parameters among `paths` as explicitly set.
    pub(crate) fn take_as_given(&mut self, paths: impl Iterator<Item = &'static str>) {
        self.given.extend(paths.filter(|path| find(path).is_some_and(|knob| knob.automatic)));
    }

    /// Returns the work required to change from `before` to these settings.
    pub fn changes(&self, before: &Self) -> Changes {
        let mut changes = Changes::default();
        for knob in all().filter(|knob| knob.get(self) != knob.get(before)) {
            match knob.cost {
                Change::Frame => changes.frame = true,
                Change::Regrow => changes.regrow = true,
                Change::Rebuild => changes.rebuild = true,
            }
        }
        changes.frame |= self.lights.list != before.lights.list;
        // The color of the skin is part of the strands.
        let of_skin = |settings: &Self| settings.shading.color == HairColor::Skin;
        changes.regrow |= of_skin(self) != of_skin(before);
        changes
    }
}
