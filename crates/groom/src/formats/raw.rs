//! Contents of one file as its reader returns them, in the file's own unit and axes.

use crate::{
    Followers, Look, Rig, Strands, TriMesh,
    attribute::StrandAttribute,
    light::PunctualLight,
    orient::{LengthUnit, OrientationOverride},
    strands::Mark,
};
use std::collections::BTreeMap;

/// States unit and axes in the files that this crate writes.
pub(super) const MARK: &str = "meters, Y up, face +Z";
/// [`MARK`] for files in centimeters.
pub(super) const CENTIMETERS: &str = "centimeters, Y up, face +Z";

/// Moment of an animated file to read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Moment {
    /// The first frame.
    #[default]
    First,
    /// A frame by its number, counted from 0.
    Frame(u32),
    /// The frame nearest to this time, seconds.
    Seconds(f64),
}

/// Contents of a groom file, in its own unit and axes.
pub(crate) struct Raw {
    pub strands: Strands,
    pub format: &'static str,
    pub notes: Vec<String>,
    /// Unit and axes that the file states.
    pub declared: OrientationOverride,
    /// Child strands around each strand, in the file's unit; may be empty.
    pub followers: Vec<Followers>,
    /// Group names by group id.
    pub group_names: BTreeMap<i32, String>,
    /// Hair material.
    pub look: Option<Look>,
    /// Lights of the scene.
    pub lights: RawLights,
}

/// Lights of a file, in its own unit and axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RawLights {
    pub lights: Vec<PunctualLight>,
    /// Notes on invalid lights.
    pub notes: Vec<String>,
}

/// Parses unit and axes from a text that may contain [`MARK`] or [`CENTIMETERS`].
pub(super) fn declared(text: &str) -> OrientationOverride {
    match text {
        _ if text.contains(CENTIMETERS) => {
            OrientationOverride { unit: Some(LengthUnit(0.01)), ..OrientationOverride::METERS }
        }
        _ if text.contains(MARK) => OrientationOverride::METERS,
        _ => OrientationOverride::default(),
    }
}

impl Raw {
    pub fn new(format: &'static str) -> Self {
        Self {
            strands: Strands::default(),
            format,
            look: None,
            lights: RawLights::default(),
            notes: Vec::new(),
            declared: OrientationOverride::default(),
            followers: Vec::new(),
            group_names: BTreeMap::new(),
        }
    }

    /// Sets the child strands of every strand: `count` within `radius`, as the file's header states.
    pub fn follow(&mut self, count: u64, radius: Option<f32>) {
        if count == 0 {
            return;
        }
        // A radius of 0 means that the exporter did not set it.
        let radius = radius.filter(|radius| *radius > 0.0);
        let within = radius.map_or(String::new(), |radius| format!(" within {radius} file units"));
        self.notes.push(format!("requests {count} child strands for each strand{within}"));
        let followers = Followers { count: u32::try_from(count).unwrap_or(u32::MAX), radius };
        self.followers = vec![followers; self.strands.len()];
    }

    /// Appends `more` and returns notes on dropped attributes. An attribute is kept only if both have it; pinned tips,
    /// child strands and marks are always kept.
    pub fn append(&mut self, more: Self) -> Vec<String> {
        let mut notes = Vec::new();
        self.look = self.look.or(more.look);
        self.lights.lights.extend(more.lights.lights);
        self.lights.notes.extend(more.lights.notes);
        let (a, b) = (&mut self.strands, more.strands);
        let (before, added) = (a.len(), b.len());
        let base = a.positions.len() as u32;
        a.positions.extend(b.positions);
        a.offsets.extend(b.offsets.iter().skip(1).map(|o| o.saturating_add(base)));
        join(&mut a.radii, b.radii, "widths", &mut notes);
        join(&mut a.colors, b.colors, "colors", &mut notes);
        join(&mut a.root_uvs, b.root_uvs, "texture coordinates", &mut notes);
        let shared = |of: &StrandAttribute, others: &[StrandAttribute]| others.iter().any(|it| it.joins(of));
        for (of, others) in [(&a.attributes, &b.attributes), (&b.attributes, &a.attributes)] {
            let unmatched = of.iter().filter(|attribute| !shared(attribute, others));
            notes.extend(unmatched.map(|it| format!("“{}” is ignored: not every file has it", it.name)));
        }
        a.attributes.retain(|attribute| shared(attribute, &b.attributes));
        for attribute in &mut a.attributes {
            if let Some(more) = b.attributes.iter().find(|more| more.joins(attribute)) {
                attribute.append(more);
            }
        }
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
            // Each file numbers its strands from its own start.
            let free = a.marks.iter().map(|mark| mark.id).max().map_or(0, |max| max.saturating_add(1));
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

/// Contents of a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// The mesh at rest, in the file's own unit and axes.
    pub mesh: TriMesh,
    /// Unit and axes that the file or its format states.
    pub declared: OrientationOverride,
    /// Rig of the mesh, with the same vertices in the same order, if the file has a skin, morph targets or an
    /// animation.
    pub rig: Option<Rig>,
    /// Lights of the scene.
    pub lights: Vec<PunctualLight>,
    /// Notes on skipped data.
    pub notes: Vec<String>,
}

fn join<T>(a: &mut Vec<T>, b: Vec<T>, what: &str, notes: &mut Vec<String>) {
    if a.is_empty() != b.is_empty() {
        notes.push(format!("{what} are ignored: not every file has them"));
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
    fn append_drops_unshared_attributes_but_keeps_pins() {
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
