//! What hair looks like: colours, highlights, how much light gets through.

use super::fiber::{
    FiberShape,
    bsdf::{absorption_of, color_fit, melanin},
};
use crate::strands::Drawn;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

/// Where hair is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShadingRate {
    /// For each pixel: noise finer than the strands' vertices.
    PerPixel,
    /// For each strand vertex, in a compute kernel: the price does not depend on the picture's
    /// size or its samples.
    #[default]
    PerVertex,
}

/// How light on hair is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadingModel {
    /// Kajiya and Kay's fibre with two highlights, set by eye: colours are albedos.
    KajiyaKay,
    /// Light refracted, absorbed and mirrored in fibres, and scattered among them: colours follow from
    /// melanin ([`fiber`](super::fiber)).
    #[default]
    Fiber,
}

/// Hair as [`ShadingModel::Fiber`] sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberMaterial {
    /// Absorption per fibre radius at the root, of red, green and blue light:
    /// [`melanin`] or [`absorption_of`].
    pub root_absorption: Vec3,
    /// Absorption at the tip.
    pub tip_absorption: Vec3,
    /// Roughness, scales and refraction.
    pub shape: FiberShape,
    /// Spread of the melanin over the strands: 0.3 is ±30 %, half of it from lock to lock.
    pub melanin_spread: f32,
    /// Spread of the tilt of the scales over strands and locks, radians: breaks highlights up.
    pub tilt_spread: f32,
    /// The share of the light that one fibre scatters on that meets other hair or the eye, where hair is seen; behind n of
    /// them (1 + n (1/d² - 1))^-½ is left. Zinke's d_f is that of any number.
    pub density_forward: f32,
    /// Zinke's d_b: the share of the light scattered back that does.
    pub density_back: f32,
}

impl FiberMaterial {
    /// Hair of one absorption per radius, each strand like the others.
    pub fn uniform(absorption: Vec3) -> Self {
        Self {
            root_absorption: absorption,
            tip_absorption: absorption,
            shape: FiberShape::default(),
            melanin_spread: 0.0,
            tilt_spread: 0.0,
            density_forward: 0.8,
            density_back: 0.7,
        }
    }

    /// Hair of one absorption per radius, varied as hair is: bleached towards the tips, no two strands
    /// alike.
    pub fn natural(absorption: Vec3) -> Self {
        Self {
            root_absorption: absorption * 1.05,
            tip_absorption: absorption * 0.9,
            melanin_spread: 0.25,
            tilt_spread: 0.03,
            ..Self::uniform(absorption)
        }
    }
}

/// The look of hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairMaterial {
    /// Albedo at the root, linear.
    pub root_color: Vec3,
    /// Albedo at the tip, linear.
    pub tip_color: Vec3,
    /// Use the strands' own colours, where they have them, instead of the two above.
    pub file_colors: bool,
    /// Spread of the lightness over the strands: 0.3 is ±30 %.
    pub lightness_spread: f32,
    /// Spread of the warmth over the strands: 0.1 is ±10 % red against blue.
    pub warmth_spread: f32,
    /// Factor of all light at the very root, where hair stands densest; 1 for none.
    pub root_darkness: f32,
    /// Strength of the diffuse light; 1 is that of a matt fibre of the albedo.
    pub diffuse: f32,
    /// Strength of the first, uncoloured highlight.
    pub primary: f32,
    /// Sharpness of the first highlight (the exponent).
    pub primary_exponent: f32,
    /// Shift of the first highlight towards the tip, as the tangent of an angle.
    pub primary_shift: f32,
    /// Strength of the second, coloured highlight.
    pub secondary: f32,
    /// Sharpness of the second highlight (the exponent).
    pub secondary_exponent: f32,
    /// Shift of the second highlight, towards the root when negative.
    pub secondary_shift: f32,
    /// Colour of the second highlight and of the light that shines through, linear.
    pub secondary_color: Vec3,
    /// Strength of the light that shines through from behind.
    pub transmission: f32,
    /// Sharpness of the light that shines through (the exponent).
    pub transmission_exponent: f32,
    /// Spread of both shifts over the strands.
    pub shift_spread: f32,
    /// Noise of the shifts along a strand and per pixel.
    pub shift_noise: f32,
    /// The share of the light that each fibre on its way takes: hair in shadow gets `exp(-opacity n)`
    /// behind `n` fibres. Less than what one fibre takes in truth, since most of that is passed on.
    pub opacity: f32,
    /// How much more the colours that the hair itself has less of are lost on that way.
    pub saturation: f32,
    /// The least width that is drawn, pixels; thinner hair is drawn this wide and as much sparser.
    pub min_width: f32,
    /// Which model shades it. `file_colors`, `warmth_spread` and `min_width` mean the same for both, the
    /// rest above is [`ShadingModel::KajiyaKay`]'s.
    pub model: ShadingModel,
    /// The look under [`ShadingModel::Fiber`].
    pub fiber: FiberMaterial,
}

pub use crate::groom::srgb::linear;

/// An sRGB colour from the usual six hexadecimal digits, made linear.
pub fn srgb(rgb: u32) -> Vec3 {
    let channel = |shift: u32| linear((rgb >> shift & 0xff) as f32 / 255.0);
    Vec3::new(channel(16), channel(8), channel(0))
}

impl HairMaterial {
    /// The names [`named`](Self::named) knows.
    pub const NAMES: [&str; 4] = ["blond", "brown", "red", "black"];

    /// A preset by name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "blond" => Some(Self::blond()),
            "brown" => Some(Self::brown()),
            "red" => Some(Self::red()),
            "black" => Some(Self::black()),
            _ => None,
        }
    }

    /// Light blond.
    pub fn blond() -> Self {
        Self {
            lightness_spread: 0.25,
            diffuse: 0.42,
            primary: 1.0,
            secondary: 1.4,
            transmission: 1.7,
            opacity: 0.3,
            secondary_color: Vec3::new(0.80, 0.60, 0.33),
            fiber: FiberMaterial::natural(melanin(0.25, 0.05)),
            ..Self::colored(Vec3::new(0.36, 0.23, 0.105))
        }
    }

    /// Brown.
    pub fn brown() -> Self {
        Self {
            secondary_color: Vec3::new(0.33, 0.18, 0.075),
            fiber: FiberMaterial::natural(melanin(1.3, 0.2)),
            ..Self::colored(Vec3::new(0.07, 0.038, 0.021))
        }
    }

    /// Copper red.
    pub fn red() -> Self {
        Self {
            primary: 0.8,
            secondary: 1.0,
            opacity: 0.4,
            secondary_color: Vec3::new(0.55, 0.27, 0.05),
            fiber: FiberMaterial::natural(melanin(0.12, 1.5)),
            ..Self::colored(Vec3::new(0.19, 0.078, 0.026))
        }
    }

    /// Black, with clear highlights.
    pub fn black() -> Self {
        Self {
            primary: 1.1,
            secondary: 0.5,
            transmission: 0.2,
            opacity: 0.7,
            fiber: FiberMaterial::natural(melanin(6.0, 0.3)),
            ..Self::colored(Vec3::new(0.012, 0.010, 0.009))
        }
    }

    /// Hair of any albedo (linear): the rest follows from how light the colour is.
    pub fn colored(albedo: Vec3) -> Self {
        let peak = albedo.max_element().max(1e-4);
        let lightness = peak.sqrt().min(1.0);
        Self {
            root_color: albedo * 0.8,
            tip_color: (albedo * 1.25).min(Vec3::ONE),
            file_colors: true,
            lightness_spread: 0.35,
            warmth_spread: 0.08,
            root_darkness: 0.7,
            diffuse: 0.26 + 0.45 * lightness,
            primary: 1.0,
            primary_exponent: 40.0,
            primary_shift: 0.10,
            secondary: 0.9,
            secondary_exponent: 10.0,
            secondary_shift: -0.14,
            secondary_color: (albedo / peak).powf(1.2) * (0.25 + 0.75 * lightness),
            transmission: 0.95 + 0.25 * lightness,
            transmission_exponent: 40.0,
            shift_spread: 0.12,
            shift_noise: 0.05,
            opacity: 0.52 - 0.3 * lightness,
            saturation: 1.0,
            min_width: 1.0,
            model: ShadingModel::default(),
            fiber: FiberMaterial::natural(absorption_of(albedo, FiberShape::default().azimuthal)),
        }
    }

    pub(crate) fn uniform(
        &self,
        drawn: &Drawn,
        rest_count: u32,
        [splat, spans]: [[u32; 2]; 2],
        first: u32,
    ) -> HairUniform {
        let fiber = &self.fiber;
        let shape = fiber.shape.clamped();
        let four = |values: [f64; 4]| Vec4::from_array(values.map(|v| v as f32));
        let turns = four(shape.turns());
        HairUniform {
            root_color: self.root_color,
            lightness_spread: self.lightness_spread,
            tip_color: self.tip_color,
            warmth_spread: self.warmth_spread,
            secondary_color: self.secondary_color,
            root_darkness: self.root_darkness,
            diffuse: self.diffuse,
            primary: self.primary,
            primary_exponent: self.primary_exponent.max(1.0),
            primary_shift: self.primary_shift,
            secondary: self.secondary,
            secondary_exponent: self.secondary_exponent.max(1.0),
            secondary_shift: self.secondary_shift,
            transmission: self.transmission,
            transmission_exponent: self.transmission_exponent.max(1.0),
            shift_spread: self.shift_spread,
            shift_noise: self.shift_noise,
            opacity: self.opacity.max(0.0),
            saturation: self.saturation,
            min_width: self.min_width.max(0.0),
            file_colors: u32::from(self.file_colors),
            count: drawn.count,
            vertex_count: drawn.vertex_count,
            knot_stride: spans[0],
            splat_stride: splat[0],
            splat_segments: splat[1],
            variances: four(shape.variances()),
            turn_sin: turns.map(f32::sin),
            turn_cos: turns.map(f32::cos),
            root_absorption: fiber.root_absorption.max(Vec3::ZERO),
            model: u32::from(self.model == ShadingModel::Fiber),
            tip_absorption: fiber.tip_absorption.max(Vec3::ZERO),
            melanin_spread: fiber.melanin_spread,
            tilt_spread: fiber.tilt_spread,
            density_forward: fiber.density_forward.clamp(0.0, 1.0),
            density_back: fiber.density_back.clamp(0.0, 1.0),
            color_fit: color_fit(shape.azimuthal).powi(-2),
            rest_count,
            stride: drawn.stride,
            deeper: drawn.deeper.into(),
            area: drawn.area,
            first,
            spans: spans[1],
            single: drawn.single,
            dense: drawn.dense,
            sunk: drawn.sunk,
            packed: drawn.packed,
            _pad: 0,
        }
    }
}

impl Default for HairMaterial {
    fn default() -> Self {
        Self::brown()
    }
}

/// What the shaders know of a [`HairMaterial`] and of the groom it is on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)] // The fields of `HairMaterial` under the same names.
pub struct HairUniform {
    pub root_color: Vec3,
    pub lightness_spread: f32,
    pub tip_color: Vec3,
    pub warmth_spread: f32,
    pub secondary_color: Vec3,
    pub root_darkness: f32,
    pub diffuse: f32,
    pub primary: f32,
    pub primary_exponent: f32,
    pub primary_shift: f32,
    pub secondary: f32,
    pub secondary_exponent: f32,
    pub secondary_shift: f32,
    pub transmission: f32,
    pub transmission_exponent: f32,
    pub shift_spread: f32,
    pub shift_noise: f32,
    pub opacity: f32,
    pub saturation: f32,
    pub min_width: f32,
    pub file_colors: u32,
    /// Number of drawn strands.
    pub count: u32,
    /// Vertices of each.
    pub vertex_count: u32,
    /// Vertices from one knot of a strand to the next (`light::knot`).
    pub knot_stride: u32,
    /// Vertex stride of the strands in the shadow maps.
    pub splat_stride: u32,
    /// Segments per strand in the shadow maps.
    pub splat_segments: u32,
    /// [`FiberShape::variances`].
    pub variances: Vec4,
    /// Sines of [`FiberShape::turns`].
    pub turn_sin: Vec4,
    /// Their cosines.
    pub turn_cos: Vec4,
    pub root_absorption: Vec3,
    /// [`ShadingModel`]: 0 Kajiya and Kay, 1 fibre.
    pub model: u32,
    pub tip_absorption: Vec3,
    pub melanin_spread: f32,
    pub tilt_spread: f32,
    pub density_forward: f32,
    pub density_back: f32,
    /// The square of a colour's logarithm times this is its absorption.
    pub color_fit: f32,
    /// Vertices of a strand's rest curve: how finely noise along strands is cut, at any level of detail.
    pub rest_count: u32,
    /// See [`crate::strands::Drawn::stride`].
    pub stride: f32,
    /// See [`crate::strands::Drawn::deeper`].
    pub deeper: Vec2,
    /// See [`crate::strands::Drawn::area`].
    pub area: f32,
    /// How many strands the grooms before it have in the picture: strands round their coverage by their number.
    pub first: u32,
    /// Spans between the knots of a strand.
    pub spans: u32,
    /// See [`crate::strands::Drawn::single`].
    pub single: f32,
    /// See [`crate::strands::Drawn::dense`].
    pub dense: f32,
    /// See [`crate::strands::Drawn::sunk`].
    pub sunk: f32,
    /// See [`crate::strands::Drawn::packed`].
    pub packed: f32,
    /// Unused.
    pub _pad: u32,
}
