//! Textures of materials: base color, normals and roughness.
//!
//! An image that cannot be read is skipped with a note ([`Painter::notes`]): a mesh is usable without it. Occlusion,
//! emission and metalness are ignored. All images of a material use the texture coordinates of its base color or, if it
//! has none, of its roughness, and repeat.
//!
//! A small file may contain large images, or use one image in many materials. The reader counts the memory before it
//! decodes or copies an image.

use std::collections::HashMap;

use glam::{Mat2, Vec2};
use gltf::{Accessor, Material, Primitive, Semantic, material::AlphaMode, texture::Info};
use image::{ImageReader, Limits, RgbaImage, imageops};

use super::file::{File, embedded, unescape};
use crate::{
    error::Result,
    mesh::paint::{Coat, Paint, Texture},
    srgb::{encoded, linear},
};

/// Maximum width and height of an image, texels.
const MAX_IMAGE_SIZE: u32 = 16_384;
/// Maximum bytes of a file's images: kept at the end, and decoded in total.
const MAX_STORED_BYTES: u64 = 1 << 30;
const MAX_DECODED_BYTES: u64 = 8 << 30;
/// Maximum notes per file.
const MAX_NOTES: usize = 8;

/// Returns the maximum width and height of stored images, texels, for a file with this many materials.
fn max_stored_size(materials: usize) -> u32 {
    match materials {
        0..=8 => 2048,
        9..=32 => 1024,
        _ => 512,
    }
}

/// Reads the materials of a file, each once.
#[derive(Default)]
pub(super) struct Painter {
    paint: Paint,
    /// Coat of each visited material; `None` for a material without images.
    coats: HashMap<usize, Option<u8>>,
    /// Decoded images by index; `None` for an image that could not be read.
    pictures: HashMap<usize, Option<RgbaImage>>,
    /// Bytes of stored images, and of decoded images.
    kept: u64,
    decoded: u64,
    notes: Vec<String>,
}

impl Painter {
    /// Adds the texture coordinates of a primitive whose `count` vertices start at `base`. Returns whether it has a
    /// coat.
    pub fn primitive(
        &mut self,
        file: &File,
        primitive: &Primitive,
        base: usize,
        count: usize,
    ) -> Result<bool> {
        let material = primitive.material();
        let Some(index) = material.index() else { return Ok(false) };
        let Some(guide) = first(&material) else { return Ok(false) };
        let Some(accessor) = primitive.get(&Semantic::TexCoords(guide.tex_coord())) else { return Ok(false) };
        let known = self.coats.get(&index).copied();
        let coat = known.unwrap_or_else(|| self.coat(file, &material));
        self.coats.insert(index, coat);
        let Some(coat) = coat else { return Ok(false) };
        match read_uvs(file, &accessor, &guide, count) {
            Ok(uvs) => {
                self.fill(base);
                self.paint.uvs.extend(uvs);
                self.paint.of.resize(base + count, coat);
                Ok(true)
            }
            Err(why) => {
                self.note(format!("a part of the mesh has no textures: {why}"));
                Ok(false)
            }
        }
    }

    fn note(&mut self, note: String) {
        match self.notes.len() {
            0..MAX_NOTES => self.notes.push(note),
            MAX_NOTES => self.notes.push("more of its images are skipped".into()),
            _ => {}
        }
    }

    /// Returns the paint of a mesh, if any of its vertices has a coat, and the notes on skipped images.
    pub fn finish(mut self, vertices: usize) -> (Option<Paint>, Vec<String>) {
        self.fill(vertices);
        let any = self.paint.of.iter().any(|of| *of != Paint::NONE);
        // Resize all images to the size of the largest, or less to fit the limit.
        self.paint.level(MAX_STORED_BYTES);
        (any.then_some(self.paint), self.notes)
    }

    /// Marks all vertices up to `vertices` that are not set yet as having no coat.
    fn fill(&mut self, vertices: usize) {
        self.paint.uvs.resize(vertices, Vec2::ZERO);
        self.paint.of.resize(vertices, Paint::NONE);
    }

    fn coat(&mut self, file: &File, material: &Material) -> Option<u8> {
        let number = u8::try_from(self.paint.coats.len()).ok().filter(|number| *number < Paint::NONE)?;
        let pbr = material.pbr_metallic_roughness();
        let base = pbr.base_color_texture().and_then(|info| self.picture(file, &info.texture()));
        let normal = material.normal_texture();
        let scale = normal.as_ref().map_or(1.0, |normal| normal.scale());
        let normal = normal.and_then(|normal| self.picture(file, &normal.texture()));
        let rough = pbr.metallic_roughness_texture().and_then(|info| self.picture(file, &info.texture()));
        if base.is_none() && normal.is_none() && rough.is_none() {
            return None;
        }
        let cutout = match material.alpha_mode() {
            AlphaMode::Opaque => None,
            AlphaMode::Mask => Some(material.alpha_cutoff().unwrap_or(0.5)),
            AlphaMode::Blend => Some(0.5),
        };
        let size = |picture: &Option<RgbaImage>| picture.as_ref().map_or(4, |all| all.as_raw().len() as u64);
        self.kept = self.kept.saturating_add(size(&base) + size(&normal).max(size(&rough)));
        if self.kept > MAX_STORED_BYTES {
            self.note("its images take too much memory".into());
            return None;
        }
        let base = tinted(base, pbr.base_color_factor());
        let relief = relief(normal, scale, rough, pbr.roughness_factor());
        self.paint.coats.push(Coat { base, relief, cutout });
        Some(number)
    }

    /// Returns an image. If it cannot be read, adds a note once and returns `None`.
    fn picture(&mut self, file: &File, texture: &gltf::Texture) -> Option<RgbaImage> {
        let index = texture.source().index();
        if let Some(known) = self.pictures.get(&index) {
            return known.clone();
        }
        let picture = match self.decode(file, index) {
            Ok(picture) => Some(picture),
            Err(why) => {
                self.note(format!("image {index} of its materials is skipped: {why}"));
                None
            }
        };
        self.pictures.insert(index, picture.clone());
        picture
    }

    /// Decodes an image and reduces it to the maximum size.
    fn decode(&mut self, file: &File, index: usize) -> std::result::Result<RgbaImage, String> {
        let bytes = bytes(file, index)?;
        let reader = || {
            let reader = ImageReader::new(std::io::Cursor::new(&*bytes)).with_guessed_format();
            reader.map_err(|error| error.to_string())
        };
        let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
        if width.min(height) == 0 || width.max(height) > MAX_IMAGE_SIZE {
            return Err(format!(
                "it has {width} × {height} pixels, but each side must have 1 to {MAX_IMAGE_SIZE}"
            ));
        }
        let max_size = max_stored_size(file.document.materials().len());
        let scale = |n: u32| {
            (u64::from(n) * u64::from(max_size) / u64::from(width.max(height).max(max_size))).max(1) as u32
        };
        let (small, low) = (scale(width), scale(height));
        // Before the conversion to 8 bits, channels have at most 16.
        self.decoded = self.decoded.saturating_add(8 * u64::from(width) * u64::from(height));
        self.kept = self.kept.saturating_add(4 * u64::from(small) * u64::from(low));
        if self.decoded > MAX_DECODED_BYTES || self.kept > MAX_STORED_BYTES {
            return Err("the file's images take too much memory".into());
        }
        let mut reader = reader()?;
        reader.limits(Limits::default());
        let picture = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
        match picture.dimensions() == (small, low) {
            true => Ok(picture),
            false => Ok(imageops::resize(&picture, small, low, imageops::FilterType::Triangle)),
        }
    }
}

/// Returns the texture whose coordinates a material's images use: base color, else roughness.
fn first<'a>(material: &Material<'a>) -> Option<Info<'a>> {
    let pbr = material.pbr_metallic_roughness();
    // The normal texture has another type in the `gltf` crate. It uses the same coordinates.
    pbr.base_color_texture().or_else(|| pbr.metallic_roughness_texture())
}

/// Returns the matrix and the offset of `KHR_texture_transform`.
fn transform(info: &Info) -> (Mat2, Vec2) {
    let Some(transform) = info.texture_transform() else { return (Mat2::IDENTITY, Vec2::ZERO) };
    let scale = Vec2::from(transform.scale());
    // The extension rotates counterclockwise, in coordinates whose V axis points down.
    let matrix = Mat2::from_angle(-transform.rotation()) * Mat2::from_diagonal(scale);
    (matrix, Vec2::from(transform.offset()))
}

/// Returns the bytes of an image. It reads the JSON because the `gltf` crate unwraps fields that a file may lack.
fn bytes<'a>(file: &'a File<'_>, index: usize) -> std::result::Result<std::borrow::Cow<'a, [u8]>, String> {
    let image = file.document.as_json().images.get(index).ok_or("it does not exist")?;
    if let Some(uri) = &image.uri {
        return match uri.contains(':') {
            true => embedded(uri).map(std::borrow::Cow::Owned),
            false => file.resource(&unescape(uri)).map_err(|error| error.to_string()),
        };
    }
    let view = image.buffer_view.as_ref().and_then(|view| file.document.views().nth(view.value()));
    let view = view.ok_or("it is neither in the file nor in a file of its own")?;
    let buffer = file.buffers.get(view.buffer().index()).ok_or("its buffer does not exist")?;
    let end = view.offset().checked_add(view.length());
    let bytes = end.and_then(|end| buffer.get(view.offset()..end));
    Ok(std::borrow::Cow::Borrowed(bytes.ok_or("it lies outside its buffer")?))
}

/// Returns the texture coordinates of `count` vertices.
fn read_uvs(
    file: &File,
    accessor: &Accessor,
    guide: &Info,
    count: usize,
) -> std::result::Result<Vec<Vec2>, String> {
    let uvs = file.vectors(accessor).map_err(|error| error.to_string())?;
    if uvs.len() != count {
        return Err(format!("it has {} texture coordinates for {count} vertices", uvs.len()));
    }
    let (matrix, shift) = transform(guide);
    let transformed: Vec<_> = uvs.into_iter().map(|uv| matrix * Vec2::from_array(uv) + shift).collect();
    match transformed.iter().all(|spot| spot.is_finite()) {
        true => Ok(transformed),
        false => Err("its texture coordinates are not finite".into()),
    }
}

fn texture(picture: RgbaImage) -> Texture {
    let (width, height) = picture.dimensions();
    Texture { width, height, rgba: picture.into_raw() }
}

/// Multiplies the base color image by the material's factor.
fn tinted(picture: Option<RgbaImage>, [r, g, b, a]: [f32; 4]) -> Texture {
    let mut texture = picture.map_or_else(|| Texture::even([255; 4]), texture);
    if [r, g, b, a] != [1.0; 4] {
        let table = |factor: f32, is_color: bool| -> Vec<u8> {
            let one = |byte: u8| match is_color {
                true => {
                    let light = linear(f32::from(byte) / 255.0) * factor;
                    (255.0 * encoded(light.clamp(0.0, 1.0)) + 0.5) as u8
                }
                false => (f32::from(byte) * factor).clamp(0.0, 255.0) as u8,
            };
            (0..=255).map(one).collect()
        };
        let tables = [table(r, true), table(g, true), table(b, true), table(a, false)];
        for (i, byte) in texture.rgba.iter_mut().enumerate() {
            *byte = tables[i % 4][usize::from(*byte)];
        }
    }
    texture
}

/// Combines normals and roughness in one image, as documented at [`Coat::relief`].
fn relief(normal: Option<RgbaImage>, scale: f32, rough: Option<RgbaImage>, roughness: f32) -> Texture {
    let sizes = [&normal, &rough].map(|picture| picture.as_ref().map_or((1, 1), RgbaImage::dimensions));
    let (width, height) = (sizes[0].0.max(sizes[1].0), sizes[0].1.max(sizes[1].1));
    let fit = |picture: Option<RgbaImage>| {
        picture.map(|all| match all.dimensions() == (width, height) {
            true => all,
            false => imageops::resize(&all, width, height, imageops::FilterType::Triangle),
        })
    };
    let (normal, rough) = (fit(normal), fit(rough));
    let mut all = RgbaImage::new(width, height);
    for (x, y, texel) in all.enumerate_pixels_mut() {
        let along = |k: usize| normal.as_ref().map_or(127.5, |all| f32::from(all.get_pixel(x, y)[k]));
        let side = |k: usize| (127.5 + (along(k) - 127.5) * scale).clamp(0.0, 255.0) as u8;
        let texel_roughness = rough.as_ref().map_or(1.0, |all| f32::from(all.get_pixel(x, y)[1]) / 255.0);
        let blue = (255.0 * (texel_roughness * roughness).clamp(0.0, 1.0)) as u8;
        texel.0 = [side(0), side(1), blue, 255];
    }
    texture(all)
}
