//! Pictures of materials: base colour, normals and roughness.
//!
//! A picture that cannot be read is none: a body is of use without. It is said ([`Painter::notes`]). Occlusion and
//! emission are left out, and metal is painted as if it were not.

use std::collections::HashMap;

use glam::{Mat2, Vec2};
use gltf::{Material, Primitive, Semantic, image::Source as Place, material::AlphaMode, texture::Info};
use image::{ImageReader, Limits, RgbaImage, imageops};

use super::file::{File, embedded, unescape};
use crate::{
    error::Result,
    mesh::paint::{Coat, Paint, Texture, linear},
};

/// The most texels along an edge of a picture that are kept, and that are read.
const MOST: u32 = 2048;
const LARGEST: u32 = 16_384;
/// The most bytes that all pictures of a file may take.
const ROOM: usize = 512 << 20;

/// Reads materials, each once.
#[derive(Default)]
pub(super) struct Painter {
    paint: Paint,
    /// The coat of each material that was met.
    coats: HashMap<usize, Option<u8>>,
    /// The pictures that were read, or could not be.
    pictures: HashMap<usize, Option<RgbaImage>>,
    bytes: usize,
    notes: Vec<String>,
}

impl Painter {
    /// Notes where the `count` vertices of a primitive are, which follow those of `base`. Whether they have a coat.
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
        let Some(places) = primitive.get(&Semantic::TexCoords(guide.tex_coord())) else { return Ok(false) };
        let known = self.coats.get(&index).copied();
        let coat = known.unwrap_or_else(|| self.coat(file, &material));
        self.coats.insert(index, coat);
        let Some(coat) = coat else { return Ok(false) };
        let places = file.numbers(&places, 2)?;
        let places = places.as_chunks::<2>().0;
        if places.len() != count {
            return Err(file.problem(format!("{} texture coordinates of {count} vertices", places.len())));
        }
        let (turn, shift) = transform(&guide);
        self.fill(base);
        self.paint.places.extend(places.iter().map(|place| turn * Vec2::from(*place) + shift));
        self.paint.of.resize(base + count, coat);
        Ok(true)
    }

    /// The paint of a mesh of so many vertices, if any of it has some, and what could not be read.
    pub fn finish(mut self, vertices: usize) -> (Option<Paint>, Vec<String>) {
        self.fill(vertices);
        let any = !self.paint.coats.is_empty();
        self.paint.level(MOST);
        (any.then_some(self.paint), self.notes)
    }

    /// Vertices up to here that nothing was said of have no coat.
    fn fill(&mut self, vertices: usize) {
        self.paint.places.resize(vertices, Vec2::ZERO);
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
        let base = tinted(base, pbr.base_color_factor());
        let relief = relief(normal, scale, rough, pbr.roughness_factor());
        self.paint.coats.push(Coat { base, relief, cutout });
        Some(number)
    }

    /// A picture, or nothing, which is noted once.
    fn picture(&mut self, file: &File, texture: &gltf::Texture) -> Option<RgbaImage> {
        let image = texture.source();
        if let Some(known) = self.pictures.get(&image.index()) {
            return known.clone();
        }
        let read = decode(file, &image).and_then(|picture| {
            self.bytes = self.bytes.saturating_add(picture.as_raw().len());
            if self.bytes > ROOM { Err("the file has too many".to_owned()) } else { Ok(picture) }
        });
        let picture = match read {
            Ok(picture) => Some(picture),
            Err(why) => {
                self.notes.push(format!("picture {} of its materials is left out: {why}", image.index()));
                None
            }
        };
        self.pictures.insert(image.index(), picture.clone());
        picture
    }
}

/// The texture whose coordinates a material's pictures are placed by: that of its colour, else another.
fn first<'a>(material: &Material<'a>) -> Option<Info<'a>> {
    let pbr = material.pbr_metallic_roughness();
    // The crate has a type of its own for that of normals, which is placed as the others are.
    pbr.base_color_texture().or_else(|| pbr.metallic_roughness_texture())
}

/// `KHR_texture_transform`: its matrix, and its offset.
fn transform(info: &Info) -> (Mat2, Vec2) {
    let Some(transform) = info.texture_transform() else { return (Mat2::IDENTITY, Vec2::ZERO) };
    let scale = Vec2::from(transform.scale());
    // The extension turns against the clock, in coordinates that go down.
    let turn = Mat2::from_angle(-transform.rotation()) * Mat2::from_diagonal(scale);
    (turn, Vec2::from(transform.offset()))
}

/// The picture of an image.
fn decode(file: &File, image: &gltf::Image) -> std::result::Result<RgbaImage, String> {
    let bytes = match image.source() {
        Place::View { view, .. } => {
            let buffer = file.buffers.get(view.buffer().index()).ok_or("its buffer does not exist")?;
            let end = view.offset().checked_add(view.length());
            let bytes = end.and_then(|end| buffer.get(view.offset()..end));
            std::borrow::Cow::Borrowed(bytes.ok_or("it does not fit its buffer")?)
        }
        Place::Uri { uri, .. } if !uri.contains(':') => {
            file.companion(&unescape(uri)).map_err(|error| error.to_string())?
        }
        Place::Uri { uri, .. } => std::borrow::Cow::Owned(embedded(uri)?),
    };
    let mut reader = ImageReader::new(std::io::Cursor::new(&*bytes));
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LARGEST), Some(LARGEST));
    reader.limits(limits);
    let reader = reader.with_guessed_format().map_err(|error| error.to_string())?;
    let picture = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
    let (width, height) = picture.dimensions();
    if width == 0 || height == 0 {
        return Err("it has no texels".into());
    }
    let most = width.max(height);
    if most <= MOST {
        return Ok(picture);
    }
    let smaller = |n: u32| (u64::from(n) * u64::from(MOST) / u64::from(most)).max(1) as u32;
    Ok(imageops::resize(&picture, smaller(width), smaller(height), imageops::FilterType::Triangle))
}

fn texture(picture: RgbaImage) -> Texture {
    let (width, height) = picture.dimensions();
    Texture { width, height, rgba: picture.into_raw() }
}

/// The base picture times a material's factor.
fn tinted(picture: Option<RgbaImage>, [r, g, b, a]: [f32; 4]) -> Texture {
    let mut texture = picture.map_or_else(|| Texture::even([255; 4]), texture);
    if [r, g, b, a] != [1.0; 4] {
        let table = |factor: f32, is_color: bool| -> Vec<u8> {
            let one = |byte: u8| match is_color {
                true => encoded(linear(byte) * factor),
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

/// Linear light as a byte by sRGB's curve; the inverse of [`linear`].
fn encoded(light: f32) -> u8 {
    let v = light.clamp(0.0, 1.0);
    let v = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (255.0 * v + 0.5) as u8
}

/// Normals and roughness in one picture, as [`Coat::relief`] has them.
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
        let share = rough.as_ref().map_or(1.0, |all| f32::from(all.get_pixel(x, y)[1]) / 255.0);
        let blue = (255.0 * (share * roughness).clamp(0.0, 1.0)) as u8;
        texel.0 = [side(0), side(1), blue, 255];
    }
    texture(all)
}
