//! Renders hair at a level of detail.

use crate::common::{self, DrapedCharacter};
use tresses::{
    Background, Camera, Context, HairOptions, LodOptions, Picture, Pose, ToneMap, View, ViewOptions,
    glam::Vec3,
    groom::{Groom, SdfGrid, grow::Growth, srgb::linear, styles::Style},
    light::{Lights, Sphere},
    low_level::{Detail, Hair},
    renderer::Renderer,
};

/// Radians per pixel of a portrait lens (30 degrees) in an image 720 pixels high.
const PIXEL_ANGLE: f32 = 0.000_744_3;

/// Exposure at which nothing is clipped and dark values still span many steps.
const EXPOSURE: f32 = 1.0;

pub struct Setup {
    pub context: &'static Context,
}

impl Setup {
    pub fn open() -> Option<Self> {
        Some(Self { context: common::context()? })
    }

    pub fn style(name: &str, strands: u32) -> (Groom, SdfGrid) {
        let built = common::character(name, strands).expect("there is a GPU");
        (built.groom.clone(), built.field.clone())
    }

    /// Creates hair in any style, with options for its levels of detail.
    pub fn grown(&self, style: &Style, strands: u32, lod: LodOptions) -> Hair {
        let growth = Growth::for_style(style).with_strands(strands);
        self.measured(&DrapedCharacter::new(self.context, style, growth).groom, None, lod)
    }

    pub fn hair(&self, groom: &Groom, field: Option<&SdfGrid>) -> Hair {
        self.measured(groom, field, LodOptions::default())
    }

    fn measured(&self, groom: &Groom, field: Option<&SdfGrid>, lod: LodOptions) -> Hair {
        let context = self.context;
        let options = HairOptions { lod, ..Default::default() };
        let mut hair = common::hair(context, groom, &options, field).unwrap();
        self.advance(&mut hair, Pose::IDENTITY, 0.0);
        hair
    }

    pub fn advance(&self, hair: &mut Hair, head: Pose, dt: f32) {
        common::advance(hair, &common::frame(head, dt));
    }

    /// Renders the hair at `detail` into a square image of `size` pixels that it fills: linear, premultiplied.
    pub fn picture(
        &self,
        hair: &mut Hair,
        detail: Detail,
        shot: &Shot,
        size: u32,
        ssaa: u32,
    ) -> Vec<[f32; 4]> {
        let context = self.context;
        let (middle, radius) = hair.lod.sphere();
        hair.set_detail(detail);
        self.advance(hair, Pose::IDENTITY, 0.0);
        // As in the command.
        let options = ViewOptions { renderer: Renderer::tiles(1), ..Default::default() };
        let mut view = View::new(context, &options, [size; 2], ssaa).unwrap();
        let eye = middle + shot.direction.normalize() * shot.distance;
        let scene = Picture {
            camera: Camera::look_at(eye, middle, shot.fov(radius), [size; 2]),
            lights: shot.lights.clone(),
            focus: Sphere { center: middle, radius: 1.05 * radius },
            background: Background::transparent(),
            // Linear, without clipping.
            tone: ToneMap { exposure: EXPOSURE, shoulder: 1.0, desaturation: 0.0 },
            ..Default::default()
        };
        if shot.fits {
            view.fit_light((&scene, 0.0), [1, 0]);
        }
        let linear = |byte: u8| linear(f32::from(byte) / 255.0);
        let bytes = common::drawn(&view, &scene, &[&*hair], &[]);
        let pixel = |p: &[u8; 4]| [linear(p[0]), linear(p[1]), linear(p[2]), f32::from(p[3]) / 255.0];
        bytes.as_chunks::<4>().0.iter().map(pixel).collect()
    }
}

/// A viewpoint with its lights.
pub struct Shot {
    pub distance: f32,
    pub direction: Vec3,
    pub lights: Lights,
    /// Whether the resolution of the light fits the image ([`View::fit_light`]).
    pub fits: bool,
}

impl Shot {
    pub fn new(distance: f32, direction: Vec3) -> Self {
        Self { distance, direction, lights: Lights::default(), fits: true }
    }

    /// Returns the field of view that the hair fills, radians.
    pub fn fov(&self, radius: f32) -> f32 {
        2.0 * (1.1 * radius / self.distance).asin().min(1.2)
    }

    /// Returns the size of the hair in an image 720 pixels high, pixels.
    pub fn size(&self, radius: f32) -> u32 {
        (2.0 * (0.5 * self.fov(radius)).tan() / PIXEL_ANGLE).ceil().max(4.0) as u32
    }

    /// Returns the level of detail for this viewpoint.
    pub fn detail(&self, hair: &Hair) -> Detail {
        let radius = hair.lod.sphere().1;
        let pixel = PIXEL_ANGLE * (self.distance - radius).max(0.01);
        hair.lod.detail(pixel, 2.0 * radius / (PIXEL_ANGLE * self.distance))
    }
}
