//! The reader of USD.
//!
//! ```text
//! layers: bytes, what they refer to ─► openusd: composed stage ─► tree: prims, transforms ─┬─► curves ─► strands
//! value: numbers of any type                                      skel: joints, bindings ──┴─► mesh ─► triangles, a rig
//! ```
//!
//! The crate `openusd` reads layers and composes them; what prims mean is decided here, by the schemas `BasisCurves`,
//! `NurbsCurves`, `Mesh`, above them `Xform`, and `Skeleton`, `SkelAnimation` and `BlendShape` beside them. One moment of what is animated is read ([`Moment`]).

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
    orient::{Axis, Choice, Unit},
};
use layers::Layers;
use tree::{Schema, Tree};

/// Vertices that a file may ask for per byte: objects may be drawn many times, but not a few bytes all memory.
const READS_PER_BYTE: u64 = 16;

/// An open file and what it refers to.
struct Scene<'s, 'a> {
    source: &'s Source<'a>,
    stage: Stage,
    /// How many bytes were read for it.
    bytes: Rc<Cell<u64>>,
    /// How many vertices are taken of it so far.
    taken: Cell<u64>,
}

impl<'s, 'a> Scene<'s, 'a> {
    fn open(source: &'s Source<'a>) -> Result<Self> {
        let layers = Layers::new(source);
        let bytes = layers.bytes();
        let root = layers.root();
        match Stage::builder().resolver(layers).open(&root) {
            Ok(stage) => Ok(Self { source, stage, bytes, taken: Cell::new(0) }),
            Err(error) => Err(problem(source, error)),
        }
    }

    fn problem(&self, problem: impl Into<String>) -> Error {
        self.source.problem(At::File, problem)
    }

    /// The sentence of an error of the crate.
    fn say<T>(&self, result: openusd::Result<T>) -> Result<T> {
        result.map_err(|error| problem(self.source, error))
    }

    /// Takes note of `count` vertices more.
    fn take(&self, count: u64) -> Result<()> {
        let taken = self.taken.get().saturating_add(count);
        self.source.check_vertices(0, taken)?;
        if taken > self.bytes.get().saturating_mul(READS_PER_BYTE) {
            return Err(self.problem("the same is drawn more often than so small a file can mean"));
        }
        self.taken.set(taken);
        Ok(())
    }

    /// A text that is said of the whole scene.
    fn text(&self, field: &str) -> Result<Option<String>> {
        Ok(self.say(self.stage.stage_metadata(field))?.as_ref().and_then(value::text))
    }

    /// Whether Blender wrote it.
    fn of_blender(&self) -> Result<bool> {
        Ok(self.text("documentation")?.is_some_and(|doc| doc.starts_with("Blender")))
    }

    /// Whether we wrote it.
    fn is_ours(&self) -> Result<bool> {
        Ok(self.text("documentation")?.as_deref() == Some(DOC))
    }

    /// What is said of unit and axes.
    fn declared(&self) -> Result<Choice> {
        let up = self.text("upAxis")?.and_then(|axis| match axis.as_str() {
            "X" => Some(Axis::X),
            "Y" => Some(Axis::Y),
            "Z" => Some(Axis::Z),
            _ => None,
        });
        let metres = self.say(self.stage.stage_metadata("metersPerUnit"))?;
        let metres = metres.as_ref().and_then(value::number).map(|metres| metres as f32);
        let unit = metres.filter(|metres| metres.is_finite() && *metres > 0.0).map(Unit);
        let ours = self.is_ours()?;
        // What we write says its unit only where it is upright.
        if ours && up == Some(Axis::Y) && unit.is_some() {
            return Ok(Choice { unit, ..Choice::METRES });
        }
        Ok(Choice { unit, up, ..Choice::default() })
    }

    /// What it refers to and does not find, or what else could not be put together.
    fn missing(&self) -> Option<String> {
        let all = self.stage.composition_errors();
        let first = first_line(&all.first()?.to_string());
        Some(match all.len() {
            1 => first,
            count => format!("{first} (and {} more)", count - 1),
        })
    }
}

/// Whether a file holds curves, as far as it can be read alone.
pub(crate) fn is_groom(path: &Path, bytes: &[u8]) -> bool {
    let source = Source { path, bytes, files: Files::Given(&[]), lenient: true };
    // What cannot be read is left to the reader of grooms, who says why.
    guarded(&source, || {
        let tree = Tree::read(&Scene::open(&source)?)?;
        Ok(tree.objects.is_empty() || tree.objects.iter().any(|object| object.schema != Schema::Mesh))
    })
    .unwrap_or(true)
}

/// Whether a file holds curves and a body that belongs to them: both on a skeleton, or written by us.
pub(crate) fn holds_body(path: &Path, bytes: &[u8]) -> bool {
    // Text is large, and says it as it is.
    let says = |word: &[u8]| bytes.windows(word.len()).any(|window| window == word);
    let text = bytes.starts_with(b"#usda");
    if text && !(says(b"def Mesh") && (says(b"def Skeleton") || says(DOC.as_bytes()))) {
        return false;
    }
    let source = Source { path, bytes, files: Files::Given(&[]), lenient: true };
    guarded(&source, || {
        let scene = Scene::open(&source)?;
        let tree = Tree::read(&scene)?;
        let meshes = tree.objects.iter().filter(|object| object.schema == Schema::Mesh).count();
        let belongs = !tree.skeletons.is_empty() || scene.is_ours()?;
        Ok(meshes > 0 && meshes < tree.objects.len() && belongs)
    })
    .unwrap_or(false)
}

/// Runs what calls the crate: should it panic, that is an error of the file.
fn guarded<T>(source: &Source, read: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        Err(source.problem(At::File, "the reader of USD gave up on it, which is a fault of the reader"))
    })
}

/// The first line of a text, not too long.
fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default().trim_start_matches("error: ").trim();
    match line.char_indices().nth(200) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// An error of the crate as one sentence with its line, where it has one.
fn problem(source: &Source, error: Usd) -> Error {
    let parse = match &error {
        Usd::Parse(error) => Some(&**error),
        Usd::Format(FormatError::Decode(error)) => error.downcast_ref::<ParseError>(),
        _ => None,
    };
    let at = parse.map_or(At::File, |parse| At::Line(parse.line() as u64));
    let mut said = first_line(&error.to_string());
    // The parser has shown the cause already.
    let mut cause = if parse.is_some() { None } else { error.source() };
    while let Some(error) = cause.filter(|_| said.len() < 300) {
        said += &format!(": {}", first_line(&error.to_string()));
        cause = error.source();
    }
    source.problem(at, said)
}
