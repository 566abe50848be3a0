//! Files of bands, braids and pins.
//!
//! ```json
//! {"ties": [
//!   {"at": [0, 1.62, -0.11], "radius": 0.02},
//!   {"from": [0, 1.5, -0.16], "to": [0, 1.3, -0.16], "radius": 0.025},
//!   {"at": [0.07, 1.66, 0.02], "radius": 0.012, "held": "to-head"},
//!   {"at": [0, 1.55, -0.13], "radius": 0.08, "gather": 0.25, "group": 2}
//! ]}
//! ```
//! Units are meters, in groom space with the hair at rest. The example lists a band at a point, a braid along a line, a
//! pin that holds hair to the head, and a band that gathers the loose hair of the file's group 2 to a quarter.
//! [`tresses::Tie`] describes their effect.

use crate::shelf::Shelf;
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::path::Path;
use tresses::{Tie, TieTarget};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    ties: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    at: Option<[f32; 3]>,
    from: Option<[f32; 3]>,
    to: Option<[f32; 3]>,
    radius: f32,
    #[serde(default)]
    held: TieForm,
    #[serde(default = "all")]
    gather: f32,
    group: Option<i32>,
}

fn all() -> f32 {
    1.0
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum TieForm {
    #[default]
    Together,
    ToHead,
}

impl Entry {
    fn tie(&self) -> Result<Tie> {
        let (from, to) = match (self.at, self.from, self.to) {
            (Some(at), None, None) => (at, at),
            (None, Some(from), Some(to)) => (from, to),
            _ => anyhow::bail!("a tie must have either \"at\", or \"from\" and \"to\""),
        };
        let held = match self.held {
            TieForm::Together => TieTarget::Together,
            TieForm::ToHead => TieTarget::ToHead,
        };
        let Self { radius, gather, group, .. } = *self;
        let tie = Tie { from: from.into(), to: to.into(), radius, held, gather, group };
        tie.check()?;
        Ok(tie)
    }
}

/// Reads the ties from the .json file at `path`.
///
/// # Errors
/// Fails if the file cannot be read or a tie is invalid. The message names the file.
pub fn ties(path: &Path, files: &Shelf) -> Result<Vec<Tie>> {
    let text = files.load(path)?;
    let read = || -> Result<Vec<Tie>> {
        let file: File = serde_json::from_slice(&text)?;
        ensure!(!file.ties.is_empty(), "the list of ties is empty");
        file.ties.iter().map(Entry::tie).collect()
    };
    read().with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Vec3;

    fn read(text: &str) -> Result<Vec<Tie>> {
        let mut files = Shelf::default();
        files.put("ties.json".into(), text.as_bytes());
        ties(Path::new("ties.json"), &files)
    }

    #[test]
    fn ties_parse() {
        let found = read(
            r#"{"ties": [{"at": [0, 1, 2], "radius": 0.02}, {"from": [0, 1, 0], "to": [0, 2, 0], "radius": 0.01},
                {"at": [1, 1, 1], "radius": 0.01, "held": "to-head", "gather": 0.3, "group": 4}]}"#,
        )
        .unwrap();
        let at = Vec3::new(0.0, 1.0, 2.0);
        assert_eq!(
            found[0],
            Tie { from: at, to: at, radius: 0.02, held: TieTarget::Together, gather: 1.0, group: None }
        );
        assert_eq!((found[2].gather, found[2].group), (0.3, Some(4)));
        assert_eq!((found[1].from.y, found[1].to.y, found[2].held), (1.0, 2.0, TieTarget::ToHead));
    }

    #[test]
    fn invalid_ties_fail_with_a_reason() {
        for (text, clause) in [
            (r#"{"ties": []}"#, "empty"),
            (r#"{"ties": [{"radius": 0.02}]}"#, "either"),
            (r#"{"ties": [{"at": [0, 1, 2], "to": [0, 0, 0], "radius": 0.02}]}"#, "either"),
            (r#"{"ties": [{"at": [0, 1, 2], "radius": -1}]}"#, "tie radius"),
            (r#"{"ties": [{"at": [0, 1, 2], "radius": 0.1, "held": "up"}]}"#, "to-head"),
            (r#"{"ties": [{"at": [0, 1], "radius": 0.1}]}"#, "length 2"),
            (r#"{"ties": [{"at": [0, 1, 2], "radius": 0.1, "gather": 0}]}"#, "tie gather"),
            ("{", "EOF"),
        ] {
            let error = format!("{:#}", read(text).unwrap_err());
            assert!(error.contains("ties.json") && error.contains(clause), "{text}: {error}");
        }
    }
}
