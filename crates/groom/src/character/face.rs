//! Face grooms: brows, lashes and a beard besides the hair. Each is a groom of its own with roots on the same skin.

use crate::{
    BindOptions, Groom, GuideCount, Result, Strands, TriMesh, bind,
    mannequin::facial::{self, Beard},
};

/// The built-in character's brows, lashes and beard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceHair {
    /// Whether there are brows.
    pub has_brows: bool,
    /// Whether there are lashes.
    pub has_lashes: bool,
    /// The kind of beard.
    pub beard: Beard,
}

impl Default for FaceHair {
    fn default() -> Self {
        Self { has_brows: true, has_lashes: true, beard: Beard::None }
    }
}

/// A groom on the face.
#[derive(Clone, Debug)]
pub struct FaceGroom {
    /// Guides and strands.
    pub groom: Groom,
    /// Whether it is long enough to collide and to move in the wind, like a full beard. Other face grooms move only
    /// with the skin.
    pub hangs: bool,
}

impl FaceHair {
    /// Grows the grooms on `mesh`, a mesh of the built-in character.
    ///
    /// # Errors
    /// As [`bind()`].
    pub fn grow(&self, mesh: &TriMesh) -> Result<Vec<FaceGroom>> {
        let (mut fine, mut beard) = (Strands::default(), Strands::default());
        if self.has_brows {
            facial::brows(&mut fine);
        }
        if self.has_lashes {
            facial::lashes(&mut fine);
        }
        facial::beard(&mut beard, self.beard, mesh);
        let hangs = self.beard == Beard::Full;
        let all = [(fine, false, 12), (beard, hangs, if hangs { 24 } else { 60 })];
        let bound =
            all.into_iter().filter(|(strands, ..)| !strands.is_empty()).map(|(strands, hangs, of)| {
                let vertices = strands.range(0).len() as u32;
                let options = BindOptions {
                    guides: GuideCount::OneIn(of),
                    guide_vertex_count: Some(vertices.max(8)),
                    strand_vertex_count: Some(vertices),
                    ..Default::default()
                };
                Ok(FaceGroom { groom: bind(&strands, &options)?, hangs })
            });
        bound.collect()
    }
}
