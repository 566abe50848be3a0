//! The object tree of a file.

use std::collections::HashSet;

use glam::DMat4;

use super::{
    Archive,
    ogawa::{Group, Reader},
    property::{Compound, entry},
    xform,
};
use crate::error::{At, Result};

/// Maximum depth of the object tree.
const DEEPEST: usize = 200;

/// Schema of an object with geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Schema {
    Curves,
    Mesh,
}

/// An object with geometry.
pub(super) struct Object<'a> {
    /// Names of the object and of its parent.
    pub names: [String; 2],
    pub schema: Schema,
    /// Properties of the geometry.
    pub shape: Compound<'a>,
    /// Index of the nearest transform above the object.
    parent: Option<usize>,
}

/// All objects with geometry, and the transforms above them.
#[derive(Default)]
pub(super) struct Tree<'a> {
    pub objects: Vec<Object<'a>>,
    transforms: Vec<(Compound<'a>, Option<usize>)>,
}

/// Position of the traversal in the tree.
#[derive(Clone, Default)]
struct ObjectCursor {
    depth: usize,
    transform: Option<usize>,
    name: String,
}

impl<'a> Tree<'a> {
    pub fn read(archive: &Archive<'_, 'a>) -> Result<Self> {
        let mut tree = Self::default();
        let mut visited = HashSet::new();
        let mut rest = vec![(archive.top, ObjectCursor::default())];
        while let Some((group, cursor)) = rest.pop() {
            let before = rest.len();
            tree.children(archive, group, &cursor, &mut visited, &mut rest)?;
            // Keep the order of the file.
            rest[before..].reverse();
        }
        Ok(tree)
    }

    /// Visits the children of one object.
    fn children(
        &mut self,
        archive: &Archive<'_, 'a>,
        group: Group<'a>,
        cursor: &ObjectCursor,
        visited: &mut HashSet<u64>,
        rest: &mut Vec<(Group<'a>, ObjectCursor)>,
    ) -> Result<()> {
        let source = archive.source;
        if group.len() == 0 {
            return Ok(());
        }
        if cursor.depth > DEEPEST || !visited.insert(group.at) {
            return Err(
                source.problem(At::Byte(group.at), "objects contain each other or are nested too deeply")
            );
        }
        let mut data = group.data(source, group.len() - 1, "the list of child objects")?;
        // Two digests of 16 bytes follow the list.
        data.bytes = &data.bytes[..data.bytes.len().saturating_sub(32)];
        let mut reader = Reader::new(source, data, "the child objects");
        let mut child = 0;
        while !reader.done() {
            let length = reader.number(4)?;
            let name = reader.text(length)?.to_owned();
            let meta = match reader.number(1)? as usize {
                0xff => {
                    let length = reader.number(4)?;
                    reader.text(length)?.to_owned()
                }
                index => archive.meta(&reader, index)?,
            };
            child += 1;
            let group = group.group(source, child, "an object")?;
            let mut inner =
                ObjectCursor { depth: cursor.depth + 1, transform: cursor.transform, name: name.clone() };
            self.object(archive, group, &meta, [name, cursor.name.clone()], &mut inner)?;
            rest.push((group, inner));
        }
        Ok(())
    }

    /// Stores an object if its schema is supported.
    fn object(
        &mut self,
        archive: &Archive<'_, 'a>,
        group: Group<'a>,
        meta: &str,
        names: [String; 2],
        cursor: &mut ObjectCursor,
    ) -> Result<()> {
        let schema = entry(meta, "schema").unwrap_or_default();
        let (kind, holder) = match schema {
            _ if schema.starts_with("AbcGeom_Curve_") => (Some(Schema::Curves), ".geom"),
            _ if schema.starts_with("AbcGeom_PolyMesh_") => (Some(Schema::Mesh), ".geom"),
            _ if schema.starts_with("AbcGeom_Xform_") => (None, ".xform"),
            _ => return Ok(()),
        };
        if group.len() == 0 {
            return Ok(());
        }
        let properties = Compound::read(archive, group.group(archive.source, 0, "an object's properties")?)?;
        let Some(shape) = properties.compound(archive, holder)? else { return Ok(()) };
        match kind {
            Some(schema) => {
                self.objects.push(Object { names, schema, shape, parent: cursor.transform });
            }
            None => {
                self.transforms.push((shape, cursor.transform));
                cursor.transform = Some(self.transforms.len() - 1);
            }
        }
        Ok(())
    }

    /// Returns the matrices from each transform's space to the file's, at `time`.
    pub fn matrices(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<DMat4>> {
        let mut all: Vec<DMat4> = Vec::with_capacity(self.transforms.len());
        for (transform, parent) in &self.transforms {
            let (own, inherits) = xform::matrix(archive, transform, time)?;
            // Parents precede their children.
            let above = parent.filter(|_| inherits).map_or(DMat4::IDENTITY, |parent| all[parent]);
            all.push(above * own);
        }
        Ok(all)
    }

    /// Returns the nearest transform above an object.
    pub fn above(&self, object: &Object) -> Option<&Compound<'a>> {
        object.parent.map(|parent| &self.transforms[parent].0)
    }

    /// Returns an object's matrix, of those that [`Self::matrices`] returned.
    pub fn of(object: &Object, matrices: &[DMat4]) -> DMat4 {
        object.parent.map_or(DMat4::IDENTITY, |parent| matrices[parent])
    }
}
