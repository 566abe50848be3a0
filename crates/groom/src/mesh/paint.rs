//! Textures of a mesh: images of its materials, and texture coordinates of each vertex.

use super::triangle::mean;
use crate::srgb::linear;
use glam::{Vec2, Vec3};

/// Textures of a mesh's materials.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Paint {
    /// Texture coordinates of each vertex in the images of its coat: from the left and from the top, 1 at the other
    /// edge, repeating.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub uvs: Vec<Vec2>,
    /// Coat of each vertex; [`Paint::NONE`] for a vertex that only has a color.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub of: Vec<u8>,
    /// One coat for each material with images.
    pub coats: Vec<Coat>,
}

/// Textures of one material.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Coat {
    /// Albedo, sRGB-encoded, and coverage in alpha; the material's factors are applied.
    pub base: Texture,
    /// Red and green: surface normal along the image and up it, from -1 to 1. Blue: roughness. One texel if the surface
    /// is uniform.
    pub relief: Texture,
    /// Coverage below which the surface is cut out, as on cards with an image of an eyelash. `None` if nothing is cut
    /// out.
    pub cutout: Option<f32>,
}

/// An RGBA image.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Texture {
    /// Texels per row.
    pub width: u32,
    /// Number of rows, from the top.
    pub height: u32,
    /// Four bytes per texel.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub rgba: Vec<u8>,
}

impl Texture {
    /// Returns a texture of one texel.
    pub fn even(texel: [u8; 4]) -> Self {
        Self { width: 1, height: 1, rgba: texel.to_vec() }
    }

    /// Returns the texel at texture coordinates, which repeat.
    fn texel(&self, uv: Vec2) -> Option<[u8; 4]> {
        let at = |x: f32, n: u32| ((x - x.floor()) * n as f32) as usize % (n as usize).max(1);
        let (x, y) = (at(uv.x, self.width), at(uv.y, self.height));
        self.rgba.as_chunks::<4>().0.get(y * self.width as usize + x).copied()
    }

    /// Returns whether `rgba` has as many texels as width and height require, and at least one.
    pub fn is_valid(&self) -> bool {
        let texels = u64::from(self.width) * u64::from(self.height);
        texels > 0 && self.rgba.len() as u64 == 4 * texels
    }

    /// Returns the texture resized to `size` texels.
    #[cfg(feature = "textures")]
    fn resized(&self, size: [u32; 2]) -> Self {
        use image::{RgbaImage, imageops};
        let [width, height] = size;
        let picture = RgbaImage::from_raw(self.width, self.height, self.rgba.clone());
        let resized =
            picture.map(|all| imageops::resize(&all, width, height, imageops::FilterType::Triangle));
        resized.map_or_else(|| self.clone(), |all| Self { width, height, rgba: all.into_raw() })
    }
}

/// Accessors of the textures of a coat.
#[cfg(feature = "textures")]
const PICTURES: [fn(&mut Coat) -> &mut Texture; 2] = [|coat| &mut coat.base, |coat| &mut coat.relief];

impl Paint {
    /// Value of [`of`](Self::of) for a vertex without images.
    pub const NONE: u8 = u8::MAX;

    /// Returns whether the paint fits a mesh of `vertices` vertices: each has texture coordinates and an existing coat,
    /// and all textures are whole.
    pub fn fits(&self, vertices: usize) -> bool {
        let known = |of: &u8| *of == Self::NONE || usize::from(*of) < self.coats.len();
        self.uvs.len() == vertices
            && self.of.len() == vertices
            && self.of.iter().all(known)
            && self.uvs.iter().all(|place| place.is_finite())
            && self.coats.iter().all(|coat| coat.base.is_valid() && coat.relief.is_valid())
            && self.coats.len() <= usize::from(Self::NONE)
    }

    /// Resizes all base textures to one size, and all reliefs to one size: the largest one, or less, so that all
    /// textures fit into `bytes` bytes.
    #[cfg(feature = "textures")]
    pub fn level(&mut self, bytes: u64) {
        let largest = PICTURES.map(|picture| self.largest(picture));
        let takes = |max_size: u32| {
            let one =
                largest.map(|size| 4 * size.map(|n| u64::from(n.min(max_size))).iter().product::<u64>());
            self.coats.len() as u64 * one.iter().sum::<u64>()
        };
        let mut max_size = 1 << 15;
        while max_size > 1 && takes(max_size) > bytes {
            max_size /= 2;
        }
        for (picture, size) in PICTURES.into_iter().zip(largest) {
            let size = size.map(|n| n.min(max_size));
            for coat in &mut self.coats {
                if [picture(coat).width, picture(coat).height] != size {
                    *picture(coat) = picture(coat).resized(size);
                }
            }
        }
    }

    #[cfg(feature = "textures")]
    fn largest(&mut self, picture: fn(&mut Coat) -> &mut Texture) -> [u32; 2] {
        let sizes = self.coats.iter_mut().map(|coat| [picture(coat).width, picture(coat).height]);
        sizes.fold([1; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    }

    /// Returns the linear albedo of a vertex, if its coat has one.
    pub fn color(&self, vertex: usize) -> Option<Vec3> {
        self.color_at([vertex as u32; 3], Vec3::X)
    }

    /// Returns the linear albedo of the point with barycentric weights in the triangle of three vertices, if its coat
    /// has one.
    pub fn color_at(&self, triangle: [u32; 3], barycentric: Vec3) -> Option<Vec3> {
        let uv = mean(self.corners(triangle)?, barycentric);
        let coat = &self.coats[usize::from(self.of[triangle[0] as usize])];
        let [r, g, b, _] = coat.base.texel(uv)?;
        Some(Vec3::from([r, g, b].map(|byte| linear(f32::from(byte) / 255.0))))
    }

    /// Returns the texture coordinates of the corners of a triangle, if it has an image.
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> Option<[Vec2; 3]> {
        let of = *self.of.get(triangle[0] as usize)?;
        let is_painted = usize::from(of) < self.coats.len();
        let [a, b, c] = triangle.map(|i| self.uvs.get(i as usize).copied().filter(|_| is_painted));
        Some([a?, b?, c?])
    }

    /// Joins the paint of two meshes with `vertices` and `more` vertices.
    pub(crate) fn join(
        own: Option<&Self>,
        vertices: usize,
        other: Option<&Self>,
        more: usize,
    ) -> Option<Self> {
        if own.is_none() && other.is_none() {
            return None;
        }
        let mut all = own.cloned().unwrap_or_default();
        all.uvs.resize(vertices, Vec2::ZERO);
        all.of.resize(vertices, Self::NONE);
        if let Some(other) = other {
            let first = all.coats.len();
            // Vertices of coats beyond the largest index keep only their color.
            let remapped = |of: &u8| u8::try_from(first + usize::from(*of)).unwrap_or(Self::NONE);
            all.of.extend(other.of.iter().map(|of| if *of == Self::NONE { *of } else { remapped(of) }));
            all.uvs.extend(&other.uvs);
            all.coats.extend(other.coats.iter().cloned());
            all.coats.truncate(usize::from(Self::NONE));
        }
        all.uvs.resize(vertices + more, Vec2::ZERO);
        all.of.resize(vertices + more, Self::NONE);
        Some(all)
    }
}

/// Serde adapter for paint that several meshes share.
#[cfg(feature = "cooked")]
pub(super) mod shared {
    use super::Paint;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::Arc;

    pub fn serialize<S: Serializer>(paint: &Option<Arc<Paint>>, to: S) -> Result<S::Ok, S::Error> {
        paint.as_deref().serialize(to)
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Option<Arc<Paint>>, D::Error> {
        Ok(Option::<Paint>::deserialize(from)?.map(Arc::new))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "textures")]
    #[test]
    fn textures_are_resized_to_one_size() {
        let coat = |n: u32| Coat {
            base: Texture { width: n, height: n, rgba: [n as u8, 0, 0, 255].repeat((n * n) as usize) },
            relief: Texture::even([1, 2, 3, 4]),
            cutout: None,
        };
        let mut paint = Paint { coats: vec![coat(2), coat(8), coat(64)], ..Default::default() };
        paint.level(3 * (4 * 16 * 16 + 4));
        for (coat, was) in paint.coats.iter().zip([2, 8, 64]) {
            assert!(coat.base.is_valid() && [coat.base.width, coat.base.height] == [16; 2]);
            assert!(coat.base.rgba.chunks(4).all(|t| t == [was, 0, 0, 255]));
            assert_eq!(coat.relief, Texture::even([1, 2, 3, 4]));
        }
    }

    #[test]
    fn texture_coordinates_repeat() {
        let [white, black] = [[255; 4], [0, 0, 0, 255]];
        let picture = Texture { width: 2, height: 2, rgba: [white, black, black, white].concat() };
        let at = |x, y| picture.texel(Vec2::new(x, y)).unwrap()[0];
        assert_eq!([at(0.25, 0.25), at(0.75, 0.25), at(1.75, -0.75), at(-3.75, 0.3)], [255, 0, 0, 255]);
    }

    #[test]
    fn joined_meshes_keep_their_coats() {
        let coat =
            |r| Coat { base: Texture::even([r, 0, 0, 255]), relief: Texture::even([0; 4]), cutout: None };
        let one = Paint { uvs: vec![Vec2::ZERO; 2], of: vec![0, Paint::NONE], coats: vec![coat(255)] };
        let all = Paint::join(Some(&one), 2, Some(&one), 2).unwrap();
        assert_eq!(all.of, [0, Paint::NONE, 1, Paint::NONE]);
        assert!(all.fits(4) && !all.fits(3));
        let late = Paint::join(None, 3, Some(&one), 2).unwrap();
        assert_eq!(late.of, [Paint::NONE, Paint::NONE, Paint::NONE, 0, Paint::NONE]);
        assert_eq!((late.color(3), late.color(0)), (Some(Vec3::X), None));
        assert_eq!(Paint::join(None, 1, None, 1), None);
    }
}
