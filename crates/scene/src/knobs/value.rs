//! Values, units and ranges of parameters.

use super::Knob;
use crate::{
    picture::encoded,
    settings::{ClassicBlending, Curl, HairColor, RendererKind},
};
use tresses::{
    AvoidMode, HairHairMode, LodMode, MapCoordinates,
    glam::Vec3,
    groom::mannequin::facial::Beard,
    low_level,
    range::Range,
    renderer::{ShadingModel, ShadingRate, ShadowMethod},
};

/// A parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Automatic: follows from the style, the file or the color.
    Auto,
    /// A number in SI units.
    Number(f32),
    /// A count.
    Integer(u32),
    /// On or off.
    Toggle(bool),
    /// The name of one of the choices in [`ValueKind::Choice`].
    Choice(&'static str),
    /// A color in sRGB.
    Color([u8; 3]),
}

macro_rules! from {
    ($($type:ty: $variant:ident),*) => {$(
        impl From<$type> for Value {
            fn from(value: $type) -> Self {
                Self::$variant(value)
            }
        }
    )*};
}
from!(f32: Number, u32: Integer, bool: Toggle, &'static str: Choice, [u8; 3]: Color);

/// A display unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Symbol; empty for a plain number.
    pub symbol: &'static str,
    /// Size in SI units.
    pub si: f64,
}

impl Unit {
    const fn new(symbol: &'static str, si: f64) -> Self {
        Self { symbol, si }
    }

    /// Converts an SI value to this unit, rounded to remove floating-point noise.
    const fn of(self, si: f64) -> f64 {
        (si / self.si * 1e6).round() / 1e6
    }

    /// Converts an SI value to this unit, with the fewest digits that convert back to the same value.
    pub fn shown(self, inner: f32) -> f64 {
        let exact = f64::from(inner) / self.si;
        (0..17)
            .filter_map(|digits| format!("{exact:.digits$e}").parse::<f64>().ok())
            .find(|rounded| (rounded * self.si) as f32 == inner)
            .unwrap_or(exact)
    }

    /// Converts a value in this unit to SI.
    pub fn inner(self, shown: f64) -> f32 {
        (shown * self.si) as f32
    }
}

pub(super) const PLAIN: Unit = Unit::new("", 1.0);
pub(super) const PERCENT: Unit = Unit::new("%", 0.01);
pub(super) const METERS: Unit = Unit::new("m", 1.0);
pub(super) const CENTIMETERS: Unit = Unit::new("cm", 1e-2);
pub(super) const MILLIMETERS: Unit = Unit::new("mm", 1e-3);
pub(super) const MICROMETERS: Unit = Unit::new("µm", 1e-6);
pub(super) const SECONDS: Unit = Unit::new("s", 1.0);
pub(super) const MILLISECONDS: Unit = Unit::new("ms", 1e-3);
pub(super) const METERS_PER_SECOND: Unit = Unit::new("m/s", 1.0);
pub(super) const ACCELERATION: Unit = Unit::new("m/s²", 1.0);
pub(super) const PER_SECOND: Unit = Unit::new("1/s", 1.0);
pub(super) const PER_SECOND_SQUARED: Unit = Unit::new("1/s²", 1.0);
pub(super) const PER_METER: Unit = Unit::new("1/m", 1.0);
pub(super) const LINE_DENSITY: Unit = Unit::new("mg/m", 1e-6);
pub(super) const STIFFNESS: Unit = Unit::new("nN·m²", 1e-9);
pub(super) const DEGREES: Unit = Unit::new("°", std::f64::consts::PI / 180.0);
pub(super) const PIXELS: Unit = Unit::new("px", 1.0);
pub(super) const TEXELS: Unit = Unit::new("texels", 1.0);
pub(super) const TIMES: Unit = Unit::new("×", 1.0);

/// Mapping of a range to a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SliderScale {
    /// Linear.
    Linear,
    /// Logarithmic. In a range that begins at 0, the slider has a separate stop at 0.
    Log,
}

/// A named value of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Name.
    pub name: &'static str,
    /// Effect, in a few words.
    pub hint: &'static str,
}

/// Type and range of a parameter's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueKind {
    /// A number. The range is inclusive, in `unit`.
    Number {
        /// Display unit.
        unit: Unit,
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
        /// Mapping to a slider.
        scale: SliderScale,
    },
    /// An integer. The range is inclusive.
    Integer {
        /// Display unit.
        unit: Unit,
        /// Minimum.
        min: u32,
        /// Maximum.
        max: u32,
        /// Values are multiples of this.
        step: u32,
    },
    /// On or off.
    Toggle,
    /// One of these values.
    Choice(&'static [Choice]),
    /// A color in sRGB.
    Color,
}

impl ValueKind {
    /// Switches to a logarithmic slider.
    pub(super) const fn log(self) -> Self {
        match self {
            Self::Number { unit, min, max, .. } => Self::Number { unit, min, max, scale: SliderScale::Log },
            other => other,
        }
    }
}

/// Returns a range of numbers from `min` to `max`, both in `unit`.
pub(super) const fn number(unit: Unit, min: f64, max: f64) -> ValueKind {
    ValueKind::Number { unit, min, max, scale: SliderScale::Linear }
}

/// Returns the usual part of a library range, converted to `unit`.
pub(super) const fn within(unit: Unit, range: Range) -> ValueKind {
    let [min, max] = range.typical;
    number(unit, unit.of(min), unit.of(max))
}

pub(super) const fn integer(unit: Unit, min: u32, max: u32, step: u32) -> ValueKind {
    ValueKind::Integer { unit, min, max, step }
}

pub(super) const fn choice<T: NamedEnum>() -> ValueKind {
    ValueKind::Choice(T::CHOICES)
}

/// Rejected value, described in one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path} is {value}, but must be {range}")]
pub struct Refusal {
    /// Path of the parameter.
    pub path: String,
    /// The rejected value.
    pub value: String,
    /// Allowed values, in words.
    pub range: String,
}

impl Knob {
    /// Checks that `value` has the right type and is within the range.
    ///
    /// # Errors
    /// Returns one sentence that states the allowed values.
    pub fn check(&self, value: Value) -> Result<(), Refusal> {
        let fits = match (self.kind, value) {
            (_, Value::Auto) => self.automatic,
            (ValueKind::Number { unit, min, max, .. }, Value::Number(v)) => {
                // Compare with the ends after the same rounding as values that users enter.
                ((min * unit.si) as f32..=(max * unit.si) as f32).contains(&v)
            }
            (ValueKind::Integer { min, max, step, .. }, Value::Integer(v)) => {
                (min..=max).contains(&v) && v.is_multiple_of(step)
            }
            (ValueKind::Toggle, Value::Toggle(_)) | (ValueKind::Color, Value::Color(_)) => true,
            (ValueKind::Choice(choices), Value::Choice(name)) => {
                choices.iter().any(|choice| choice.name == name)
            }
            _ => false,
        };
        if fits {
            return Ok(());
        }
        Err(Refusal { path: self.path.to_owned(), value: self.text(value), range: self.range() })
    }

    /// Converts an SI value to the display unit, with the fewest digits that convert back to the same value.
    pub fn shown(&self, inner: f32) -> f64 {
        let ValueKind::Number { unit, .. } = self.kind else { return f64::from(inner) };
        unit.shown(inner)
    }

    /// Converts a value in the display unit to SI.
    pub fn inner(&self, shown: f64) -> f32 {
        match self.kind {
            ValueKind::Number { unit, .. } => unit.inner(shown),
            _ => shown as f32,
        }
    }
}

/// A settings field of a row. Values passed to [`put`](Self::put) have passed [`Knob::check`].
pub trait SettingsField {
    /// Returns the field as a value.
    fn value(&self) -> Value;
    /// Sets the field from a value; ignores values of the wrong type.
    fn put(&mut self, value: Value);
}

macro_rules! plain {
    ($($type:ty: $variant:ident),*) => {$(
        impl SettingsField for $type {
            fn value(&self) -> Value {
                Value::$variant(*self)
            }

            fn put(&mut self, value: Value) {
                if let Value::$variant(v) = value {
                    *self = v;
                }
            }
        }

        /// An option that defaults to automatic.
        impl SettingsField for Option<$type> {
            fn value(&self) -> Value {
                self.map_or(Value::Auto, Value::$variant)
            }

            fn put(&mut self, value: Value) {
                match value {
                    Value::Auto => *self = None,
                    Value::$variant(v) => *self = Some(v),
                    _ => {}
                }
            }
        }
    )*};
}
plain!(f32: Number, u32: Integer, bool: Toggle, [u8; 3]: Color);

/// A linear color, shown as sRGB.
impl SettingsField for Vec3 {
    fn value(&self) -> Value {
        Value::Color(self.to_array().map(|v| (255.0 * encoded(v)).round() as u8))
    }

    fn put(&mut self, value: Value) {
        if let Value::Color([r, g, b]) = value {
            *self = low_level::srgb(u32::from_be_bytes([0, r, g, b]));
        }
    }
}

/// An enum with named variants.
pub trait NamedEnum: 'static {
    /// Names and descriptions of the variants.
    const CHOICES: &'static [Choice];
}

macro_rules! named {
    ($($type:ident { $($name:literal $variant:ident $hint:literal $(=> $payload:tt $value:expr)?;)* })*) => {$(
        impl NamedEnum for $type {
            const CHOICES: &'static [Choice] = &[$(Choice { name: $name, hint: $hint }),*];
        }

        impl SettingsField for $type {
            fn value(&self) -> Value {
                // The exhaustive match ensures that every variant has a name.
                Value::Choice(match self { $(Self::$variant $($payload)? => $name),* })
            }

            fn put(&mut self, value: Value) {
                match value {
                    $(Value::Choice($name) => *self = named!(@ $($value,)? Self::$variant),)*
                    _ => {}
                }
            }
        }
    )*};
    (@ $value:expr, $variant:expr) => { $value };
    (@ $variant:expr) => { $variant };
}
named! {
    Curl {
        "none" None "straight";
        "waves" Waves "loose flat waves that run through the hair";
        "ringlets" Ringlets "round ringlets as wide as a piece of chalk";
        "coils" Coils "tight coils as wide as a pencil; for short hair";
    }
    Beard {
        "none" None "shaved";
        "stubble" Stubble "a few days old, 2 mm";
        "short" Short "trimmed, 1 cm";
        "full" Full "half a year old, 4 cm at the chin";
    }
    MapCoordinates {
        "scalp" Scalp "the view from above and behind the head";
        "uv" Uv "root UVs of the groom, or texture coordinates of the body";
    }
    HairHairMode {
        "off" Off "strands pass through each other";
        "fixed" Fixed "a fixed acceleration out of cells that are too dense";
        "gradient" Gradient "pressure along the negative gradient of the density, and friction";
    }
    AvoidMode {
        "off" Off "strands penetrate colliders";
        "vertices" PenetratingOnly "only penetrating vertices are moved out";
        "strands" ChangeOver "a strand that hits a collider follows its nearest guide";
    }
    HairColor {
        "file" File "the colors of the groom file, or brown if it has none";
        "skin" Skin "the color of the body at the root of each strand";
        "blond" Blond "light blond";
        "brown" Brown "brown";
        "red" Red "copper red";
        "black" Black "black";
        "srgb" Srgb "the sRGB color";
        "melanin" Melanin "eumelanin and pheomelanin";
    }
    ShadingModel {
        "fiber" Fiber "refraction and absorption in fibers, and scattering between them";
        "kajiya-kay" KajiyaKay "a diffuse color and two highlights that are set by hand; the cheapest";
    }
    ShadingRate {
        "vertex" PerVertex "at each strand vertex, interpolated along the strand";
        "pixel" PerPixel "at each pixel";
    }
    ShadowMethod {
        "opaque" Opaque "opaque hair: soft edges, black behind the first layer";
        "absorption" Absorption "absorption that grows with the distance behind the nearest hair";
        "deep" DeepOpacity "deep opacity maps: fibers are counted in layers behind the first depth layer";
    }
    RendererKind {
        "tiles" Tiles "compute shaders blend all strands in order, per tile; the best quality";
        "masks" Masks "sample masks: each strand covers its fraction of a pixel's samples; the fastest";
        "classic" Classic "the renderer of 2008: Kajiya-Kay shading, alpha to coverage or depth peeling";
    }
    ClassicBlending {
        "peel" Peel "depth peeling: strands are blended in layers, one pass each";
        "alpha" Alpha "alpha to coverage: the adapter turns a strand's opacity into samples";
    }
    LodMode {
        "auto" Auto "by the pixel size at the hair";
        "off" Off "full detail at any distance";
        "fraction" Fixed "a fixed fraction of the strands" => (_) LodMode::Fixed(1.0);
    }
}
