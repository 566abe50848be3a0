//! USD reader.
//!
//! ```text
//! layers: bytes, referenced layers ──► openusd: composed stage ─► tree: prims, transforms ─┬─► curves ─► strands
//! value: numbers of any type                                      skel: joints, bindings ──┴─► mesh ─► triangles, rig
//! ```
//!
//! The crate `openusd` reads layers and composes them. This module interprets prims by their schemas: `BasisCurves`,
//! `NurbsCurves`, `Mesh`, above them `Xform`, and beside them `Skeleton`, `SkelAnimation` and `BlendShape`. Of animated
//! values it reads one moment ([`Moment`]).

mod curves;
mod layers;
mod mesh;
mod param;
mod skel;
#[cfg(test)]
mod tests;
mod tree;
mod value;

pub(crate) use curves::read;
pub(crate) use mesh::read as read_mesh;

use std::{
    cell::Cell,
    error::Error as _,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    rc::Rc,
};

use openusd::{Error as Usd, sdf::FormatError, usd::Stage, usda::ParseError};

use crate::{
    error::{At, Error, Result},
    formats::{
        raw::Moment,
        source::{Files, Source, excerpt},
        usd::DOC,
    },
    orient::{Axis, LengthUnit, OrientationOverride},
};
use layers::Layers;
use tree::{Object, Purpose, Schema, Tree, when};

/// Maximum vertices to read per byte of the file. Objects may be instanced, but a few bytes must not fill the memory.
const READS_PER_BYTE: u64 = 16;

/// An open file with the files that it refers to.
struct Scene<'s, 'a> {
    source: &'s Source<'a>,
    stage: Stage,
    /// Bytes read so far.
    bytes: Rc<Cell<u64>>,
    /// Vertices read so far.
    vertices_read: Cell<u64>,
}

impl<'s, 'a> Scene<'s, 'a> {
    fn open(source: &'s Source<'a>) -> Result<Self> {
        let layers = Layers::new(source);
        let bytes = layers.bytes();
        let root = layers.root();
        match Stage::builder().resolver(layers).open(&root) {
            Ok(stage) => Ok(Self { source, stage, bytes, vertices_read: Cell::new(0) }),
            Err(error) => Err(problem(source, error)),
        }
    }

    fn problem(&self, problem: impl Into<String>) -> Error {
        self.source.problem(At::File, problem)
    }

    /// Converts an error of the `openusd` crate.
    fn say<T>(&self, result: openusd::Result<T>) -> Result<T> {
        result.map_err(|error| problem(self.source, error))
    }

    /// Adds `count` vertices to those read, within the limit.
    fn take(&self, count: u64) -> Result<()> {
        let total = self.vertices_read.get().saturating_add(count);
        self.source.check_vertices(0, total)?;
        if total > self.bytes.get().saturating_mul(READS_PER_BYTE) {
            return Err(self.problem("the file refers to the same data too often for its size"));
        }
        self.vertices_read.set(total);
        Ok(())
    }

    /// Returns a text of the scene's metadata.
    fn text(&self, field: &str) -> Result<Option<String>> {
        Ok(self.say(self.stage.stage_metadata(field))?.as_ref().and_then(value::text))
    }

    /// Returns whether Blender wrote the file.
    fn of_blender(&self) -> Result<bool> {
        Ok(self.text("documentation")?.is_some_and(|doc| doc.starts_with("Blender")))
    }

    /// Returns whether this crate wrote the file.
    fn is_written_by_tresses(&self) -> Result<bool> {
        Ok(self.text("documentation")?.as_deref() == Some(DOC))
    }

    /// Returns the unit and axes that the file states.
    fn declared(&self) -> Result<OrientationOverride> {
        let up = self.text("upAxis")?.and_then(|axis| match axis.as_str() {
            "X" => Some(Axis::X),
            "Y" => Some(Axis::Y),
            "Z" => Some(Axis::Z),
            _ => None,
        });
        let meters = self.say(self.stage.stage_metadata("metersPerUnit"))?;
        let meters = meters.as_ref().and_then(value::number).map(|meters| meters as f32);
        let unit = meters.filter(|meters| meters.is_finite() && *meters > 0.0).map(LengthUnit);
        let written_by_tresses = self.is_written_by_tresses()?;
        // This crate writes a unit only to files with Y up and face +Z.
        if written_by_tresses && up == Some(Axis::Y) && unit.is_some() {
            return Ok(OrientationOverride { unit, ..OrientationOverride::METERS });
        }
        Ok(OrientationOverride { unit, up, ..OrientationOverride::default() })
    }

    /// Returns the first composition error, such as a missing file, and the number of further ones.
    fn missing(&self) -> Option<String> {
        let all = self.stage.composition_errors();
        let first = first_line(&all.first()?.to_string());
        Some(match all.len() {
            1 => first,
            count => format!("{first} (and {} more)", count - 1),
        })
    }
}

/// Returns whether a file has curves, as far as it can be read without the files that it refers to.
pub(crate) fn is_groom(path: &Path, bytes: &[u8]) -> bool {
    let source = Source { path, bytes, files: Files::Given(&[]), lenient: true };
    // If the file cannot be read, the groom reader reports why.
    guarded(&source, || {
        let tree = Tree::read(&Scene::open(&source)?)?;
        Ok(tree.objects.is_empty() || tree.objects.iter().any(|object| object.schema != Schema::Mesh))
    })
    .unwrap_or(true)
}

/// Returns whether a file has curves, and a visible mesh that they grow on.
pub(crate) fn holds_body(path: &Path, bytes: &[u8]) -> bool {
    // Text files are large; searching for keywords avoids parsing most of them.
    let says = |word: &[u8]| bytes.windows(word.len()).any(|window| window == word);
    if bytes.starts_with(b"#usda") && !says(b"Mesh ") {
        return false;
    }
    let source = Source { path, bytes, files: Files::Given(&[]), lenient: true };
    guarded(&source, || {
        let scene = Scene::open(&source)?;
        let tree = Tree::read(&scene)?;
        let meshes: Vec<_> = tree.objects.iter().filter(|object| object.schema == Schema::Mesh).collect();
        let (time, _) = when(&scene, &tree.times(&scene, &meshes)?, Moment::First)?;
        let transforms = tree.transforms(&scene, time)?;
        let is_shown = |mesh: &&Object| mesh.purpose == Purpose::Shown && Tree::of(mesh, &transforms).1;
        Ok(meshes.iter().any(is_shown) && meshes.len() < tree.objects.len())
    })
    .unwrap_or(false)
}

/// Calls code that uses the `openusd` crate. A panic becomes an error of the file.
fn guarded<T>(source: &Source, read: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        Err(source.problem(At::File, "the USD reader failed; this is a bug in the reader"))
    })
}

/// Returns the first line of a text, at most 200 characters.
fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default().trim_start_matches("error: ").trim();
    match line.char_indices().nth(200) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// Converts an error of the crate to one sentence, with the line if it is known.
fn problem(source: &Source, error: Usd) -> Error {
    let parse = match &error {
        Usd::Parse(error) => Some(&**error),
        Usd::Format(FormatError::Decode(error)) => error.downcast_ref::<ParseError>(),
        _ => None,
    };
    let at = parse.map_or(At::File, |parse| At::Line(parse.line() as u64));
    let mut message = first_line(&error.to_string());
    // The message of a parse error includes its cause.
    let mut cause = if parse.is_some() { None } else { error.source() };
    while let Some(error) = cause.filter(|_| message.len() < 300) {
        message += &format!(": {}", first_line(&error.to_string()));
        cause = error.source();
    }
    source.problem(at, message)
}
