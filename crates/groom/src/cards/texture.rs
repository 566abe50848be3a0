//! Textures of cards.

use super::{
    atlas::{Rect, gutter},
    tile::{Texel, Tile, lightness},
};
use crate::{mesh::paint::Texture, srgb};
use glam::Vec3;

/// Square textures, rows from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardTextures {
    /// Edge, texels.
    pub size: u32,
    /// Color (sRGB) and coverage.
    pub color: Vec<[u8; 4]>,
    /// Direction across the strands in the tangent plane (x, y as 0.5 ± 0.5), and 1.
    pub anisotropy: Vec<[u8; 3]>,
    /// Shade among the strands of the card, roughness, and 0.
    pub surface: Vec<[u8; 3]>,
    /// Height over the card (0.5 ± half of [`depth`](Self::depth)), position on the strand, random number of the
    /// strand, and coverage.
    pub data: Vec<[u8; 4]>,
    /// Range of the heights in `data`, meters.
    pub depth: f32,
    /// Whether `color` has the strands' own colors; otherwise it is neutral.
    pub has_colors: bool,
}

/// Roughness of hair along the strands, as glTF has it (the square root of the GGX width).
const ROUGHNESS: f32 = 0.45;

/// Luminance of the primaries of sRGB.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Calls `visit` with the index of each texel of a texture that a tile covers or that is close to one, the tile's texel
/// there, and whether it is in the tile.
fn each(size: usize, rects: &[Rect], tiles: &[Tile], mut visit: impl FnMut(usize, &Texel, bool)) {
    let margin = gutter(size) / 2;
    for (rect, tile) in rects.iter().zip(tiles) {
        for y in rect.y.saturating_sub(margin)..(rect.y + rect.height + margin).min(size) {
            for x in rect.x.saturating_sub(margin)..(rect.x + rect.width + margin).min(size) {
                let i = x.saturating_sub(rect.x).min(rect.width - 1);
                let j = y.saturating_sub(rect.y).min(rect.height - 1);
                let inside = rect.x + i == x && rect.y + j == y;
                visit(y * size + x, &tile.texels[j * tile.width + i], inside);
            }
        }
    }
}

/// Returns the coverage of a texture of `size` texels with `tiles` at `rects`.
pub(super) fn coverage(size: usize, rects: &[Rect], tiles: &[Tile]) -> Vec<f32> {
    let mut coverage = vec![0.0; size * size];
    each(size, rects, tiles, |i, texel, inside| coverage[i] = if inside { texel.coverage } else { 0.0 });
    coverage
}

/// Returns the linear color of a texel of the texture.
fn tinted(texel: &Texel) -> Vec3 {
    texel.color * lightness(texel.seed, texel.along) * (0.6 + 0.4 * texel.shade)
}

/// Returns the brightness of a texture of `size` texels with `tiles` at `rects`.
pub(super) fn tones(size: usize, rects: &[Rect], tiles: &[Tile]) -> Vec<f32> {
    let mut tones = vec![0.0; size * size];
    each(size, rects, tiles, |i, texel, _| tones[i] = tinted(texel).dot(LUMINANCE));
    tones
}

impl CardTextures {
    /// Returns [`color`](Self::color) as an image without hue, and its mean weighted by the coverage, linear.
    pub fn tones(&self) -> (Texture, f32) {
        let table: [f32; 256] = std::array::from_fn(|byte| srgb::linear(byte as f32 / 255.0));
        let (mut sum, mut weight) = (0.0f64, 0.0f64);
        let mut rgba = Vec::with_capacity(4 * self.color.len());
        for [r, g, b, coverage] in &self.color {
            let [r, g, b] = [r, g, b].map(|channel| table[usize::from(*channel)]);
            let tone = Vec3::new(r, g, b).dot(LUMINANCE);
            sum += f64::from(tone) * f64::from(*coverage);
            weight += f64::from(*coverage);
            let gray = byte(srgb::encoded(tone));
            rgba.extend([gray, gray, gray, *coverage]);
        }
        let mean = if weight > 0.0 { (sum / weight) as f32 } else { 1.0 };
        (Texture { width: self.size, height: self.size, rgba }, mean)
    }

    pub(super) fn new(size: usize, rects: &[Rect], tiles: &[Tile], has_colors: bool) -> Self {
        let texels = tiles.iter().flat_map(|tile| &tile.texels);
        let depth = texels.map(|texel| texel.depth.abs()).fold(1e-6, f32::max);
        let count = size * size;
        let mut textures = Self {
            size: size as u32,
            color: vec![[0; 4]; count],
            anisotropy: vec![[255, 128, 255]; count],
            surface: vec![[255, byte(ROUGHNESS), 0]; count],
            data: vec![[128, 0, 0, 0]; count],
            depth: 2.0 * depth,
            has_colors,
        };
        each(size, rects, tiles, |i, texel, inside| {
            let coverage = if inside { byte(texel.coverage) } else { 0 };
            let [r, g, b] = tinted(texel).to_array().map(|c| byte(srgb::encoded(c.clamp(0.0, 1.0))));
            textures.color[i] = [r, g, b, coverage];
            // A quarter turn of the strand's direction in the plane of the card.
            let Vec3 { x, y, .. } = texel.tangent;
            let long = x.hypot(y);
            let [across, along] = if long > 1e-3 { [y / long, -x / long] } else { [1.0, 0.0] };
            textures.anisotropy[i] = [byte(0.5 + 0.5 * across), byte(0.5 + 0.5 * along), 255];
            textures.surface[i][0] = byte(texel.shade);
            let height = 0.5 + 0.5 * texel.depth / depth;
            textures.data[i] = [byte(height), byte(texel.along), byte(texel.seed), coverage];
        });
        textures
    }
}
