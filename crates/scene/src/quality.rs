//! The quality of pictures: their size and how finely they are sampled.

use tresses::{lod::LodOptions, view::ViewOptions};

/// The size of a picture and how finely it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How the view is made; the adapter must offer its samples.
    pub view: ViewOptions,
    /// Pixels drawn per pixel shown, along each axis: 1 or 2.
    pub ssaa: u32,
    /// The levels of detail for which hair is measured.
    pub lod: LodOptions,
}

impl Quality {
    /// A picture of `size` (pixels) with the library's defaults.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, view: ViewOptions::default(), ssaa: 1, lod: LodOptions::default() }
    }
}
