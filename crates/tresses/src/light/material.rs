//! Hair material: colors, highlights, opacity.

use super::fiber::{
    FiberShape,
    bsdf::{absorption_of, color_fit, melanin},
};
use crate::{renderer::ShadingModel, strands::DrawCount};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

/// Material of [`ShadingModel::Fiber`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberMaterial {
    /// Absorption per fiber radius at the root, of red, green and blue light: [`melanin`] or `absorption_of`.
    pub root_absorption: Vec3,
    /// Absorption per fiber radius at the tip.
    pub tip_absorption: Vec3,
    /// Roughness, cuticle angle and index of refraction.
    pub shape: FiberShape,
    /// Spread of the melanin over strands: 0.3 is ±30 %, half of it from lock to lock.
    pub melanin_spread: f32,
    /// Spread of the cuticle angle over strands and locks, radians. It breaks up highlights.
    pub tilt_spread: f32,
    /// Fraction of the light scattered forward by one visible fiber that hits other hair or the eye. Behind n fibers,
    /// (1 + n (1/d² - 1))^-½ remains. Zinke's d_f does not depend on the number of fibers.
    pub density_forward: f32,
    /// Zinke's d_b: the same fraction for light scattered back.
    pub density_back: f32,
}

impl FiberMaterial {
    /// Hair with one absorption per radius, without variation.
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

    /// Hair with one absorption per radius, varied as in natural hair: bleached towards the tips, and different from
    /// strand to strand.
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

/// Material of hair. Both [shading models](ShadingModel) use `uses_file_colors`, `warmth_spread` and `min_width`;
/// [`ShadingModel::Fiber`] uses `fiber`, [`ShadingModel::KajiyaKay`] the other fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairMaterial {
    /// Albedo at the root, linear.
    pub root_color: Vec3,
    /// Albedo at the tip, linear.
    pub tip_color: Vec3,
    /// Whether strands use their own colors, if they have any, instead of the two above.
    pub uses_file_colors: bool,
    /// Spread of the lightness over strands: 0.3 is ±30 %.
    pub lightness_spread: f32,
    /// Spread of the warmth over strands: 0.1 is ±10 % red against blue.
    pub warmth_spread: f32,
    /// Factor on all light at the root, where hair is densest; 1 for none.
    pub root_darkness: f32,
    /// Strength of the diffuse light; 1 for a matte fiber of the albedo.
    pub diffuse: f32,
    /// Strength of the first highlight, which is not colored.
    pub primary: f32,
    /// Exponent of the first highlight.
    pub primary_exponent: f32,
    /// Shift of the first highlight towards the tip, as the tangent of an angle.
    pub primary_shift: f32,
    /// Strength of the second, colored highlight.
    pub secondary: f32,
    /// Exponent of the second highlight.
    pub secondary_exponent: f32,
    /// Shift of the second highlight, as the tangent of an angle; negative is towards the root.
    pub secondary_shift: f32,
    /// Color of the second highlight and of transmitted light, linear.
    pub secondary_color: Vec3,
    /// Strength of light transmitted from behind.
    pub transmission: f32,
    /// Exponent of transmitted light.
    pub transmission_exponent: f32,
    /// Spread of both shifts over strands.
    pub shift_spread: f32,
    /// Noise of the shifts along a strand and per pixel.
    pub shift_noise: f32,
    /// Fraction of the light that each fiber on the way removes: `exp(-opacity n)` arrives behind `n` fibers. It is
    /// lower than for a real fiber, because most of the light that a fiber hits is passed on.
    pub opacity: f32,
    /// Additional loss on that way of the channels in which the hair is darker.
    pub saturation: f32,
    /// Minimum width drawn, pixels. Thinner hair is drawn with this width and proportionally less coverage.
    pub min_width: f32,
    /// Material of [`ShadingModel::Fiber`].
    pub fiber: FiberMaterial,
}

pub use crate::groom::srgb::linear;

/// Returns a linear color from six hexadecimal digits of sRGB.
pub fn srgb(rgb: u32) -> Vec3 {
    let channel = |shift: u32| linear((rgb >> shift & 0xff) as f32 / 255.0);
    Vec3::new(channel(16), channel(8), channel(0))
}

impl HairMaterial {
    /// Names that [`named`](Self::named) accepts.
    pub const NAMES: [&str; 4] = ["blond", "brown", "red", "black"];

    /// Returns a preset by name.
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

    /// Hair of any albedo (linear). The other parameters follow from the lightness of the color.
    pub fn colored(albedo: Vec3) -> Self {
        let peak = albedo.max_element().max(1e-4);
        let lightness = peak.sqrt().min(1.0);
        Self {
            root_color: albedo * 0.8,
            tip_color: (albedo * 1.25).min(Vec3::ONE),
            uses_file_colors: true,
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
            fiber: FiberMaterial::natural(absorption_of(albedo, FiberShape::default().azimuthal)),
        }
    }

    pub(crate) fn uniform(
        &self,
        model: ShadingModel,
        drawn: &DrawCount,
        rest_count: u32,
        [splat, spans]: [[u32; 2]; 2],
        first: u32,
    ) -> HairUniform {
        let fiber = &self.fiber;
        let shape = fiber.shape.clamped();
        let four = |values: [f64; 4]| Vec4::from_array(values.map(|v| v as f32));
        let shifts = four(shape.shifts());
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
            file_colors: u32::from(self.uses_file_colors),
            count: drawn.count,
            vertex_count: drawn.vertex_count,
            sample_stride: spans[0],
            splat_stride: splat[0],
            splat_segments: splat[1],
            variances: four(shape.variances()),
            shift_sin: shifts.map(f32::sin),
            shift_cos: shifts.map(f32::cos),
            root_absorption: fiber.root_absorption.max(Vec3::ZERO),
            model: u32::from(model == ShadingModel::Fiber),
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
            depth_offset: drawn.depth_offset,
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

/// Shader data of a [`HairMaterial`] and its groom.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)] // The fields of `HairMaterial` under the same names.
pub(crate) struct HairUniform {
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
    /// Vertices of each drawn strand.
    pub vertex_count: u32,
    /// Vertices from one shading sample of a strand to the next (`light::shading_sample`).
    pub sample_stride: u32,
    /// Vertex stride of the strands in the shadow maps.
    pub splat_stride: u32,
    /// Segments per strand in the shadow maps.
    pub splat_segments: u32,
    /// [`FiberShape::variances`].
    pub variances: Vec4,
    /// Sines of [`FiberShape::shifts`].
    pub shift_sin: Vec4,
    /// Cosines of [`FiberShape::shifts`].
    pub shift_cos: Vec4,
    pub root_absorption: Vec3,
    /// [`ShadingModel`]: 0 Kajiya and Kay, 1 fiber.
    pub model: u32,
    pub tip_absorption: Vec3,
    pub melanin_spread: f32,
    pub tilt_spread: f32,
    pub density_forward: f32,
    pub density_back: f32,
    /// Factor from the squared logarithm of a color to its absorption.
    pub color_fit: f32,
    /// Vertices of a strand's rest curve. They set the cells of noise along strands at any level of detail.
    pub rest_count: u32,
    /// See [`crate::strands::DrawCount::stride`].
    pub stride: f32,
    /// See [`crate::strands::DrawCount::deeper`].
    pub deeper: Vec2,
    /// See [`crate::strands::DrawCount::area`].
    pub area: f32,
    /// Number of strands in the earlier grooms of the frame. Added to a strand's index, it seeds the rounding of the
    /// strand's coverage.
    pub first: u32,
    /// Spans between the shading samples of a strand.
    pub spans: u32,
    /// See [`crate::strands::DrawCount::single`].
    pub single: f32,
    /// See [`crate::strands::DrawCount::dense`].
    pub dense: f32,
    /// See [`crate::strands::DrawCount::depth_offset`].
    pub depth_offset: f32,
    /// See [`crate::strands::DrawCount::packed`].
    pub packed: f32,
    /// Unused.
    pub _pad: u32,
}
