//! Contents of one file as its reader returns them, in the file's own unit and axes.

use crate::{
    Followers, Look, Rig, Strands, TriMesh,
    orient::{Choice, Unit},
    strands::Mark,
};
use std::collections::BTreeMap;

/// The text by which a file of ours says its unit and axes: such files need no guess.
pub(super) const MARK: &str = "metres, Y up, face +Z";
/// The same for files in centimetres.
pub(super) const CENTIMETRES: &str = "centimetres, Y up, face +Z";

/// Which moment of an animated file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Moment {
    /// Its first frame.
    #[default]
    First,
    /// A frame by its number, from 0 on.
    Frame(u32),
    /// The frame nearest to this time, seconds.
    Seconds(f64),
}

/// One file as it is, in its own unit and axes.
pub(crate) struct Raw {
    pub strands: Strands,
    pub format: &'static str,
    pub notes: Vec<String>,
    /// What the file itself says of its unit and axes.
    pub declared: Choice,
    /// The followers of each strand, in the file's unit; empty for none.
    pub followers: Vec<Followers>,
    /// The names of groups, by number.
    pub group_names: BTreeMap<i32, String>,
    /// What its hair looks like.
    pub look: Option<Look>,
}

/// Unit and axes as a text in a file has them: [`MARK`], [`CENTIMETRES`] or nothing.
pub(super) fn declared(text: &str) -> Choice {
    match text {
        _ if text.contains(CENTIMETRES) => Choice { unit: Some(Unit(0.01)), ..Choice::METRES },
        _ if text.contains(MARK) => Choice::METRES,
        _ => Choice::default(),
    }
}

impl Raw {
    pub fn new(format: &'static str) -> Self {
        Self {
            strands: Strands::default(),
            format,
            look: None,
            notes: Vec::new(),
            declared: Choice::default(),
            followers: Vec::new(),
            group_names: BTreeMap::new(),
        }
    }

    /// Gives every strand `count` followers within `radius`, as the header has them.
    pub fn follow(&mut self, count: u64, radius: Option<f32>) {
        if count == 0 {
            return;
        }
        // Nothing is within a radius of 0: whoever wrote it did not say.
        let radius = radius.filter(|radius| *radius > 0.0);
        let within = radius.map_or(String::new(), |radius| format!(" within {radius} of its unit"));
        self.notes.push(format!("asks for {count} followers of each strand{within}"));
        let followers = Followers { count: u32::try_from(count).unwrap_or(u32::MAX), radius };
        self.followers = vec![followers; self.strands.len()];
    }

    /// Adds `more`. An attribute lives on only where both have it; pinned tips and followers are joined in any case.
    pub fn append(&mut self, more: Self) -> Vec<String> {
        let mut notes = Vec::new();
        self.look = self.look.or(more.look);
        let (a, b) = (&mut self.strands, more.strands);
        let (before, added) = (a.len(), b.len());
        let base = a.positions.len() as u32;
        a.positions.extend(b.positions);
        a.offsets.extend(b.offsets.iter().skip(1).map(|o| o.saturating_add(base)));
        join(&mut a.radii, b.radii, "thickness", &mut notes);
        join(&mut a.colors, b.colors, "colour", &mut notes);
        join(&mut a.root_uvs, b.root_uvs, "texture coordinates", &mut notes);
        if !a.tip_pinned.is_empty() || !b.tip_pinned.is_empty() {
            a.tip_pinned.resize(before, false);
            a.tip_pinned.extend(b.tip_pinned);
            a.tip_pinned.resize(before + added, false);
        }
        if !self.followers.is_empty() || !more.followers.is_empty() {
            self.followers.resize(before, Default::default());
            self.followers.extend(more.followers);
            self.followers.resize(before + added, Default::default());
        }
        if !a.marks.is_empty() || !b.marks.is_empty() {
            // Each file counts its strands for itself.
            let free = a.marks.iter().map(|mark| mark.id).max().map_or(0, |most| most.saturating_add(1));
            a.marks.resize(before, Mark::default());
            a.marks.extend(b.marks.into_iter().map(|mark| Mark {
                id: mark.id.saturating_add(free),
                closest: mark.closest.map(|id| id.saturating_add(free)),
                ..mark
            }));
            a.marks.resize(before + added, Mark::default());
        }
        for (group, name) in more.group_names {
            self.group_names.entry(group).or_insert(name);
        }
        self.declared = self.declared.shared(more.declared);
        notes
    }
}

/// A mesh as its file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// In the file's own unit and axes. Skins and shapes are at rest.
    pub mesh: TriMesh,
    /// What the file or its format says of unit and axes.
    pub declared: Choice,
    /// What bends the mesh, with the same vertices in the same order: where a file has a skin, shapes to
    /// blend or an animation.
    pub rig: Option<Rig>,
    /// What of the file was left out.
    pub notes: Vec<String>,
}

fn join<T>(a: &mut Vec<T>, b: Vec<T>, what: &str, notes: &mut Vec<String>) {
    if a.is_empty() != b.is_empty() {
        notes.push(format!("not every file has {what}, so none is used"));
        a.clear();
    } else {
        a.extend(b);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn attributes_of_one_file_only_are_dropped_and_pins_kept() {
        let mut one = Raw::new("one");
        one.strands.push(&[Vec3::ZERO, Vec3::X]);
        one.strands.radii = vec![1.0; 2];
        let mut two = Raw::new("two");
        two.strands.push(&[Vec3::Y, Vec3::Z]);
        two.strands.tip_pinned = vec![true];
        let notes = one.append(two);
        assert_eq!(notes.len(), 1);
        let expected = Strands {
            offsets: vec![0, 2, 4],
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            tip_pinned: vec![false, true],
            ..Default::default()
        };
        assert_eq!(one.strands, expected);
    }
}
