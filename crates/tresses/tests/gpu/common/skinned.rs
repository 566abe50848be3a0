//! Hair on a mesh whose skin moves.

use tresses::{
    Body, Context,
    glam::Vec3,
    groom::TriMesh,
    low_level::{Hair, HairFrame},
};

/// Returns `mesh` with its vertices moved by `place`.
pub fn moved(mesh: &TriMesh, place: impl Fn(Vec3) -> Vec3) -> TriMesh {
    let mut moved = mesh.clone();
    moved.positions.iter_mut().for_each(|p| *p = place(*p));
    moved.compute_normals();
    moved
}

/// Hair and a skin, which a test ties to each other.
pub struct SkinnedHair {
    pub hair: Hair,
    pub body: Body,
    pub rest: TriMesh,
}

impl SkinnedHair {
    pub fn new(context: &Context, hair: Hair, mesh: &TriMesh) -> Self {
        let rest = moved(mesh, |p| p);
        Self { hair, body: Body::with_levels(context, &rest, &[], 4), rest }
    }

    /// Advances by a frame. `place` moves the skin's rest positions.
    pub fn advance(&mut self, frame: &HairFrame<'_>, place: impl Fn(Vec3) -> Vec3) {
        self.body.move_to(&moved(&self.rest, place));
        super::advance(&mut self.hair, frame);
    }
}
