//! Writing grooms, bodies and caches.
//!
//! Reading a written file back gives the same strands, bit-identical except in GLB, whose positions may be fractions of
//! a box in 16 bits. [`Encoded::notes`] lists what a format cannot hold. A groom in metres, Y up, face +Z is marked as
//! such in the file, so that nothing needs to be guessed later; only `.data` has no place for that.

pub use crate::formats::writer::{Cache, CacheOptions, Encoded, Hair, Output, Writer};

use crate::{
    Rig, Strands, TriMesh,
    error::{At, Error, Result},
    formats::{self, Content},
    orient::Unit,
};
use std::{io, path::Path};

/// All writers.
fn writers() -> impl Iterator<Item = &'static Writer> {
    formats::FORMATS.iter().flat_map(|format| format.writers)
}

impl Writer {
    /// The writer of grooms for files with this name, by its extension.
    ///
    /// # Errors
    /// [`Error::File`] with the extensions of grooms that are written.
    pub fn of(path: impl AsRef<Path>) -> Result<&'static Self> {
        Self::holding(path, Content::Strands)
    }

    /// The writer for files with this name that can hold `content`: a [`Mesh`](Content::Mesh), or the
    /// [`Frames`](Content::Frames) of a cache.
    ///
    /// # Errors
    /// [`Error::File`] with the extensions that can.
    pub fn holding(path: impl AsRef<Path>, content: Content) -> Result<&'static Self> {
        let (path, extension) = (path.as_ref(), formats::extension(path.as_ref()));
        let mut all = writers().filter(|writer| writer.holds(content));
        if let Some(writer) = all.find(|writer| writer.extension == extension) {
            return Ok(writer);
        }
        let what = match content {
            Content::Mesh => "a head",
            Content::Frames => "a cache",
            _ => "a groom",
        };
        let problem = match formats::is_cooked(path) {
            true => "a cooked groom is made of files, by `tresses convert`".into(),
            false => format!("{what} is written as {}", formats::listed(&formats::written(content), "or")),
        };
        Err(Error::File { path: path.to_path_buf(), at: At::File, problem })
    }

    /// Whether such files hold `content`.
    pub fn holds(&self, content: Content) -> bool {
        self.holds.contains(&content)
    }

    /// Encodes strands as a file in `unit`; they are in metres, Y up, face +Z. With `None` they are in an unknown unit and
    /// unknown axes, of which the file then says nothing.
    ///
    /// # Errors
    /// [`Error::Unusable`] without strands, for a unit other than metres in a format without units, and where the strands
    /// exceed what the format can count.
    pub fn strands(&self, strands: &Strands, unit: Option<Unit>) -> Result<Encoded> {
        if strands.is_empty() {
            return Err(Error::Unusable("a groom without strands is not written".into()));
        }
        if unit.is_some_and(|unit| unit.0 != 1.0) && !self.any_unit {
            let others: Vec<_> = writers().filter(|it| it.any_unit).map(|it| it.extension).collect();
            let others = formats::listed(&others, "and");
            let problem = format!("only {others} files are written in other units than metres");
            return Err(Error::Unusable(problem));
        }
        let mut encoded = (self.strands)(strands, unit)?;
        let lost = [
            (Content::Units, unit.is_some(), "unit and axes"),
            (Content::Widths, !strands.radii.is_empty(), "widths"),
            (Content::Colors, !strands.colors.is_empty(), "colors"),
            (Content::RootUvs, !strands.root_uvs.is_empty(), "scalp texture coordinates"),
            (Content::PinnedTips, strands.tip_pinned.contains(&true), "the pinned tips"),
            (Content::Guides, strands.has_guides(), "the marks of guides"),
        ];
        let lost = lost.into_iter().filter(|(content, any, _)| *any && !self.holds(*content));
        let notes = lost.map(|(.., what)| format!("the format has no place for {what}, so it is left out"));
        encoded.notes = notes.chain(encoded.notes).collect();
        Ok(encoded)
    }

    /// Encodes a character: a body (metres, Y up), the rig that bends it, and hair at rest. In USD hair then follows the
    /// joints that the skin at its roots follows, and animations are sampled at 24, 25, 30, 50 or 60 frames a second.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a format that holds no characters, for a rig of another mesh and for hair without strands;
    /// in USD also for a joint that flattens what it holds, and for animations of more than 100,000 frames.
    pub fn character(&self, body: Option<(&TriMesh, Option<&Rig>)>, hair: &[Hair<'_>]) -> Result<Vec<u8>> {
        self.character.ok_or_else(|| self.cannot("a body with hair"))?(body, hair)
    }

    /// Encodes a mesh (metres, Y up, face +Z) and, where the format holds it, the rig that bends it.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a format that holds no meshes, and as [`Self::character`].
    pub fn mesh(&self, mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
        self.mesh.ok_or_else(|| self.cannot("a mesh"))?(mesh, rig)
    }

    /// Begins a cache of `strands`, whose positions come [frame by frame](Cache::frame).
    ///
    /// # Errors
    /// Those of `out`, and [`Unsupported`](io::ErrorKind::Unsupported) for a format that holds no frames.
    pub fn cache<'a>(
        &self,
        out: Box<dyn Output + 'a>,
        strands: &Strands,
        options: CacheOptions,
    ) -> io::Result<Box<dyn Cache + 'a>> {
        let unsupported = || io::Error::new(io::ErrorKind::Unsupported, self.cannot("moving hair"));
        self.cache.ok_or_else(unsupported)?(out, strands, options)
    }

    fn cannot(&self, what: &str) -> Error {
        Error::Unusable(format!("a .{} file cannot hold {what}", self.extension))
    }
}
