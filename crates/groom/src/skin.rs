//! The skin under the roots of hair: its color, and texture coordinates for maps.

use crate::{
    Strands, TriMesh,
    mesh::{Bvh, bvh::Closest, triangle::mean},
    near::PointTree,
    scalp::scalp_uv,
};
use glam::{Vec2, Vec3};

/// Colors of a mesh's surface.
#[derive(Debug)]
pub struct SkinColors<'a> {
    mesh: &'a TriMesh,
    bvh: Bvh,
}

impl<'a> SkinColors<'a> {
    /// Returns the colors of `mesh`, or `None` if it has neither textures nor vertex colors.
    pub fn new(mesh: &'a TriMesh) -> Option<Self> {
        let is_colored = mesh.paint.is_some() || mesh.colors.len() == mesh.positions.len();
        (is_colored && !mesh.triangles.is_empty()).then(|| Self { mesh, bvh: Bvh::new(mesh) })
    }

    /// Returns the linear albedo of the skin nearest to `p`: of its texture, else of its vertices.
    pub fn at(&self, p: Vec3) -> Option<Vec3> {
        let Closest { triangle, barycentric, .. } = self.bvh.closest_point(p)?;
        let corners = self.mesh.triangles[triangle as usize];
        let texture = self.mesh.paint.as_ref().and_then(|paint| paint.color_at(corners, barycentric));
        texture.or_else(|| {
            let [a, b, c] = corners.map(|i| self.mesh.colors.get(i as usize).copied());
            Some(mean([a?, b?, c?], barycentric))
        })
    }
}

/// Texture coordinates at roots: u from the left and v from the bottom of an image.
#[derive(Debug)]
pub struct TextureCoordinates(CoordinateSource);

#[derive(Debug)]
enum CoordinateSource {
    /// Texture coordinates of given roots.
    Roots { tree: PointTree<'static>, uvs: Vec<Vec2> },
    /// Texture coordinates of the corners of triangles.
    Skin { bvh: Bvh, corners: Vec<Option<[Vec2; 3]>> },
}

impl TextureCoordinates {
    /// Returns the root UVs of `strands`, or `None` if they have none.
    pub fn of_roots(strands: &Strands) -> Option<Self> {
        if strands.is_empty() || strands.root_uvs.len() != strands.len() {
            return None;
        }
        let roots: Vec<Vec3> = strands.iter().map(|line| line.first().copied().unwrap_or_default()).collect();
        let uvs = strands.root_uvs.clone();
        Some(Self(CoordinateSource::Roots { tree: PointTree::new(roots), uvs }))
    }

    /// Returns the texture coordinates of the textured triangles of `mesh`, or `None` if there are none.
    pub fn of_skin(mesh: &TriMesh) -> Option<Self> {
        let paint = mesh.paint.as_ref()?;
        let upward = |uvs: [Vec2; 3]| uvs.map(|uv| Vec2::new(uv.x, 1.0 - uv.y));
        let corners = mesh.triangles.iter().map(|triangle| paint.corners(*triangle).map(upward));
        let corners: Vec<_> = corners.collect();
        corners
            .iter()
            .any(Option::is_some)
            .then(|| Self(CoordinateSource::Skin { bvh: Bvh::new(mesh), corners }))
    }

    /// Returns the texture coordinates of the given root or place of the skin that is nearest to `root`. Coordinates
    /// outside 0 to 1 repeat.
    pub fn at(&self, root: Vec3) -> Vec2 {
        let uv = match &self.0 {
            CoordinateSource::Roots { tree, uvs } => tree.closest(root).map(|i| uvs[i]),
            CoordinateSource::Skin { bvh, corners } => bvh
                .closest_point(root)
                .and_then(|closest| Some(mean(corners[closest.triangle as usize]?, closest.barycentric))),
        };
        uv.unwrap_or_default().map(|x| if (0.0..=1.0).contains(&x) { x } else { x.rem_euclid(1.0) })
    }
}

/// How maps lie on the hair.
#[derive(Clone, Copy, Debug)]
pub enum MapProjection<'a> {
    /// Seen from the center of the braincase (groom space, meters), by [`scalp_uv`].
    Scalp(Vec3),
    /// By texture coordinates of the roots.
    Texture(&'a TextureCoordinates),
}

impl MapProjection<'_> {
    /// Returns the coordinates of `root` on a map.
    pub fn at(self, root: Vec3) -> Vec2 {
        match self {
            Self::Scalp(skull) => scalp_uv(root - skull),
            Self::Texture(coordinates) => coordinates.at(root),
        }
    }
}

impl From<Vec3> for MapProjection<'_> {
    fn from(skull: Vec3) -> Self {
        Self::Scalp(skull)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::paint::{Coat, Paint, Texture};
    use std::sync::Arc;

    /// A square of 2 m in the plane y = 0. Its texture is red at negative z (the top row) and blue below.
    fn square() -> TriMesh {
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let places = positions.iter().map(|p| Vec2::new(0.5 + 0.49 * p.x, 0.5 + 0.49 * p.z)).collect();
        let rgba = [[255, 0, 0, 255], [255, 0, 0, 255], [0, 0, 255, 255], [0, 0, 255, 255]].concat();
        let base = Texture { width: 2, height: 2, rgba };
        let coat = Coat { base, relief: Texture::even([128, 128, 255, 255]), cutout: None };
        TriMesh {
            positions,
            triangles: vec![[0, 2, 1], [0, 3, 2]],
            paint: Some(Arc::new(Paint { uvs: places, of: vec![0; 4], coats: vec![coat] })),
            ..TriMesh::default()
        }
    }

    #[test]
    fn skin_has_color_of_its_texture_or_vertices() {
        let mut mesh = square();
        let colors = SkinColors::new(&mesh).unwrap();
        assert_eq!(colors.at(Vec3::new(0.3, 0.1, -0.5)), Some(Vec3::X));
        assert_eq!(colors.at(Vec3::new(-0.3, 0.0, 0.5)), Some(Vec3::Z));
        mesh.paint = None;
        assert!(SkinColors::new(&mesh).is_none());
        mesh.colors = vec![Vec3::Y, Vec3::ZERO, Vec3::ZERO, Vec3::Y];
        let green = SkinColors::new(&mesh).unwrap().at(Vec3::new(0.0, 0.0, 0.2)).unwrap();
        assert!((green - 0.5 * Vec3::Y).length() < 1e-6, "{green}");
    }

    #[test]
    fn texture_coordinates_are_those_of_roots_or_skin() {
        let skin = TextureCoordinates::of_skin(&square()).unwrap();
        // v is from the bottom of the image, which is at positive z.
        let uv = skin.at(Vec3::new(0.5, 0.2, -0.5));
        assert!((uv - Vec2::new(0.745, 0.745)).length() < 1e-6, "{uv}");
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::Y]);
        strands.push(&[Vec3::X, Vec3::ONE]);
        assert!(TextureCoordinates::of_roots(&strands).is_none());
        strands.root_uvs = vec![Vec2::new(0.25, 1.0), Vec2::new(1.75, -0.5)];
        let roots = TextureCoordinates::of_roots(&strands).unwrap();
        let at = |x: f32| MapProjection::Texture(&roots).at(Vec3::X * x);
        assert_eq!((at(0.4), at(0.6)), (Vec2::new(0.25, 1.0), Vec2::new(0.75, 0.5)));
    }
}
