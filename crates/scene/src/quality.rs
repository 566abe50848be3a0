//! Image quality: size and sampling.

use tresses::{LodOptions, ViewOptions};

/// Size and sampling of images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// View options. The adapter must support the sample count.
    pub view: ViewOptions,
    /// Supersampling factor along each axis, 1 or 2.
    pub ssaa: u32,
    /// Level of detail options for which the hair is measured at upload.
    pub lod: LodOptions,
}

impl Quality {
    /// Returns a quality of `size` (pixels) with the library's defaults.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, view: ViewOptions::default(), ssaa: 1, lod: LodOptions::default() }
    }
}
