//! Export of grooms, meshes, characters and caches.
//!
//! Reading a written file returns the same strands, bit-identical except in GLB, which may store positions as 16-bit
//! fractions of a bounding box. [`EncodedFile::notes`] lists data that the format cannot hold. A file in meters, Y up,
//! face +Z says so, and the importer need not guess; only `.data` has no field for it.

pub use crate::formats::writer::{CacheOptions, CacheSink, CacheWriter, EncodedFile, ExportHair, Writer};

use crate::{
    Rig, Strands, TriMesh,
    attribute::StrandAttribute,
    error::{At, Error, Result},
    formats::{self, ContentKind},
    orient::LengthUnit,
};
use std::{io, path::Path};

/// All writers.
fn writers() -> impl Iterator<Item = &'static Writer> {
    formats::FORMATS.iter().flat_map(|format| format.writers)
}

impl Writer {
    /// Returns the writer of grooms for `path`, by its extension.
    ///
    /// # Errors
    /// [`Error::File`] with the extensions of grooms that can be written.
    pub fn of(path: impl AsRef<Path>) -> Result<&'static Self> {
        Self::holding(path, ContentKind::Strands)
    }

    /// Returns the writer for `path` that can hold `content`: a [`Mesh`](ContentKind::Mesh), or the
    /// [`Frames`](ContentKind::Frames) of a cache.
    ///
    /// # Errors
    /// [`Error::File`] with the extensions that can hold it.
    pub fn holding(path: impl AsRef<Path>, content: ContentKind) -> Result<&'static Self> {
        let (path, extension) = (path.as_ref(), formats::extension(path.as_ref()));
        let mut all = writers().filter(|writer| writer.holds(content));
        if let Some(writer) = all.find(|writer| writer.extension == extension) {
            return Ok(writer);
        }
        let what = match content {
            ContentKind::Mesh => "a head",
            ContentKind::Frames => "a cache",
            _ => "a groom",
        };
        let problem = match formats::is_cooked(path) {
            true => "use `tresses convert` to write a cooked groom".into(),
            false => {
                format!("{what} can be written as {}", formats::listed(&formats::written(content), "or"))
            }
        };
        Err(Error::File { path: path.to_path_buf(), at: At::File, problem })
    }

    /// Returns whether the format can hold `content`.
    pub fn holds(&self, content: ContentKind) -> bool {
        self.holds.contains(&content)
    }

    /// Encodes strands in meters, Y up, face +Z as a file in `unit`. `None` means that the unit and axes of the strands
    /// are unknown; the file then does not state them.
    ///
    /// # Errors
    /// [`Error::Unusable`] if there are no strands, if `unit` is not meters and the format has no units, or if the
    /// strands exceed the format's counts, or for a custom attribute of another number of strands or vertices.
    pub fn strands(&self, strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
        if strands.is_empty() {
            return Err(Error::Unusable("a groom without strands cannot be written".into()));
        }
        check_attributes(strands)?;
        if unit.is_some_and(|unit| unit.0 != 1.0) && !self.any_unit {
            let others: Vec<_> = writers().filter(|it| it.any_unit).map(|it| it.extension).collect();
            let others = formats::listed(&others, "and");
            let problem = format!("only {others} files can have a unit other than meters");
            return Err(Error::Unusable(problem));
        }
        let mut encoded = (self.strands)(strands, unit)?;
        let lost = [
            (ContentKind::Units, unit.is_some(), "unit and axes"),
            (ContentKind::Widths, !strands.radii.is_empty(), "widths"),
            (ContentKind::Colors, !strands.colors.is_empty(), "colors"),
            (ContentKind::RootUvs, !strands.root_uvs.is_empty(), "scalp texture coordinates"),
            (ContentKind::PinnedTips, strands.tip_pinned.contains(&true), "pinned tips"),
            (ContentKind::Guides, strands.has_guides(), "guide marks"),
        ];
        let lost = lost.into_iter().filter(|(content, any, _)| *any && !self.holds(*content));
        let notes = lost.map(|(.., what)| format!("{what} are not written: the format cannot store them"));
        let custom =
            (!self.holds(ContentKind::Attributes)).then_some(&strands.attributes).into_iter().flatten();
        let custom = custom.map(|it| format!("“{}” is not written: the format cannot store it", it.name));
        encoded.notes = notes.chain(custom).chain(encoded.notes).collect();
        Ok(encoded)
    }

    /// Encodes a character: a mesh (meters, Y up), its rig, and hair at rest. In USD each strand follows the joints of
    /// the skin at its root, and animations are sampled at 24, 25, 30, 50 or 60 frames per second.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a format without characters, for a rig of another mesh and for hair without strands; in
    /// USD also for a joint whose bind matrix has no inverse, and for animations of more than 100,000 frames.
    pub fn character(
        &self,
        body: Option<(&TriMesh, Option<&Rig>)>,
        hair: &[ExportHair<'_>],
    ) -> Result<Vec<u8>> {
        hair.iter().try_for_each(|hair| check_attributes(hair.strands))?;
        self.character.ok_or_else(|| self.cannot("a character"))?(body, hair)
    }

    /// Encodes a mesh (meters, Y up, face +Z) and, if the format supports it, its rig.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a format without meshes, and the errors of [`Self::character`].
    pub fn mesh(&self, mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
        self.mesh.ok_or_else(|| self.cannot("a mesh"))?(mesh, rig)
    }

    /// Begins a cache of `strands`. [`CacheWriter::frame`] writes the positions of each frame.
    ///
    /// # Errors
    /// The errors of `out`, and [`Unsupported`](io::ErrorKind::Unsupported) for a format without frames.
    pub fn cache<'a>(
        &self,
        out: Box<dyn CacheSink + 'a>,
        strands: &Strands,
        options: CacheOptions,
    ) -> io::Result<Box<dyn CacheWriter + 'a>> {
        let unsupported =
            || io::Error::new(io::ErrorKind::Unsupported, self.cannot("a cache of moving hair"));
        self.cache.ok_or_else(unsupported)?(out, strands, options)
    }

    fn cannot(&self, what: &str) -> Error {
        Error::Unusable(format!("a .{} file cannot hold {what}", self.extension))
    }
}

/// Checks that custom attributes have a value for each strand or vertex.
fn check_attributes(strands: &Strands) -> Result<()> {
    let (count, vertices) = (strands.len(), strands.positions.len());
    match strands.attributes.iter().find(|attribute| !attribute.fits(count, vertices)) {
        None => Ok(()),
        Some(StrandAttribute { name, per_vertex, .. }) => {
            let (of, all) = if *per_vertex { ("vertices", vertices) } else { ("strands", count) };
            let problem =
                format!("attribute “{name}” does not have one to four finite numbers for each of {all} {of}");
            Err(Error::Unusable(problem))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn attributes_that_do_not_fit_are_refused() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::Y]);
        for (width, numbers) in [(0, vec![]), (5, vec![0.0; 5]), (1, vec![]), (2, vec![f32::NAN; 2])] {
            strands.attributes =
                vec![StrandAttribute { name: "odd".into(), width, numbers, ..StrandAttribute::default() }];
            for writer in writers() {
                let refused = writer.strands(&strands, None).unwrap_err().to_string();
                assert!(refused.contains("“odd”"), "{refused}");
            }
        }
    }
}
