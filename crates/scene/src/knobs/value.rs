//! Values, units and ranges.

use super::Knob;
use crate::{
    picture::encoded,
    settings::{Curl, HairColor},
};
use tresses::{
    avoid::AvoidMode,
    draw::Coverage,
    glam::Vec3,
    groom::mannequin::facial::Beard,
    light::{ShadingModel, ShadingRate, ShadowMethod, material},
    lod::LodMode,
    range::Range,
    volume::HairHairMode,
};

/// A parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// As it suits the style, the file or the colour.
    Auto,
    /// In SI units.
    Number(f32),
    /// A count.
    Integer(u32),
    /// On or off.
    Toggle(bool),
    /// The name of one of [`Kind::Choice`].
    Choice(&'static str),
    /// sRGB.
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

/// A unit that people read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its symbol, empty for a plain number.
    pub symbol: &'static str,
    /// How much it is in SI units.
    pub si: f64,
}

impl Unit {
    const fn new(symbol: &'static str, si: f64) -> Self {
        Self { symbol, si }
    }

    /// So many SI units in this one, without the noise of the division.
    const fn of(self, si: f64) -> f64 {
        (si / self.si * 1e6).round() / 1e6
    }
}

pub(super) const PLAIN: Unit = Unit::new("", 1.0);
pub(super) const PERCENT: Unit = Unit::new("%", 0.01);
pub(super) const METRES: Unit = Unit::new("m", 1.0);
pub(super) const CENTIMETRES: Unit = Unit::new("cm", 1e-2);
pub(super) const MILLIMETRES: Unit = Unit::new("mm", 1e-3);
pub(super) const MICROMETRES: Unit = Unit::new("µm", 1e-6);
pub(super) const SECONDS: Unit = Unit::new("s", 1.0);
pub(super) const MILLISECONDS: Unit = Unit::new("ms", 1e-3);
pub(super) const METRES_PER_SECOND: Unit = Unit::new("m/s", 1.0);
pub(super) const ACCELERATION: Unit = Unit::new("m/s²", 1.0);
pub(super) const PER_SECOND: Unit = Unit::new("1/s", 1.0);
pub(super) const PER_SECOND_SQUARED: Unit = Unit::new("1/s²", 1.0);
pub(super) const PER_METRE: Unit = Unit::new("1/m", 1.0);
pub(super) const LINE_DENSITY: Unit = Unit::new("mg/m", 1e-6);
pub(super) const STIFFNESS: Unit = Unit::new("nN·m²", 1e-9);
pub(super) const DEGREES: Unit = Unit::new("°", std::f64::consts::PI / 180.0);
pub(super) const PIXELS: Unit = Unit::new("px", 1.0);
pub(super) const TEXELS: Unit = Unit::new("texels", 1.0);
pub(super) const TIMES: Unit = Unit::new("×", 1.0);

/// How a range is laid out along a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By factors. The range may begin at 0, which then is a point of its own at its end.
    Log,
}

/// One of the values of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a few words.
    pub hint: &'static str,
}

/// What the values of a parameter are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number. Both ends of the range are in `unit` and belong to it.
    Number {
        /// The unit that people read.
        unit: Unit,
        /// The smallest.
        least: f64,
        /// The largest.
        most: f64,
        /// How it is laid out.
        scale: Scale,
    },
    /// A whole number; `least` and `most` belong to the range.
    Integer {
        /// What is counted.
        unit: Unit,
        /// The smallest.
        least: u32,
        /// The largest.
        most: u32,
        /// The distance between values, from 0 on.
        step: u32,
    },
    /// On or off.
    Toggle,
    /// One of these.
    Choice(&'static [Choice]),
    /// A colour in sRGB.
    Color,
}

impl Kind {
    /// Laid out by factors.
    pub(super) const fn log(self) -> Self {
        match self {
            Self::Number { unit, least, most, .. } => Self::Number { unit, least, most, scale: Scale::Log },
            other => other,
        }
    }
}

/// Numbers from `least` to `most`, both in `unit`.
pub(super) const fn number(unit: Unit, least: f64, most: f64) -> Kind {
    Kind::Number { unit, least, most, scale: Scale::Linear }
}

/// What is usual of a range of the library, in `unit`.
pub(super) const fn within(unit: Unit, range: Range) -> Kind {
    let [least, most] = range.usual;
    number(unit, unit.of(least), unit.of(most))
}

pub(super) const fn integer(unit: Unit, least: u32, most: u32, step: u32) -> Kind {
    Kind::Integer { unit, least, most, step }
}

pub(super) const fn choice<T: Named>() -> Kind {
    Kind::Choice(T::CHOICES)
}

/// Why a value is refused, in one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path} is {value}, but must be {range}")]
pub struct Refusal {
    /// The parameter.
    pub path: String,
    /// What was given.
    pub value: String,
    /// What is allowed, in words.
    pub range: String,
}

impl Knob {
    /// Whether `value` is of its kind and within its range.
    ///
    /// # Errors
    /// One sentence.
    pub fn check(&self, value: Value) -> Result<(), Refusal> {
        let fits = match (self.kind, value) {
            (_, Value::Auto) => self.automatic,
            (Kind::Number { unit, least, most, .. }, Value::Number(v)) => {
                // As an end that was typed comes out.
                ((least * unit.si) as f32..=(most * unit.si) as f32).contains(&v)
            }
            (Kind::Integer { least, most, step, .. }, Value::Integer(v)) => {
                (least..=most).contains(&v) && v.is_multiple_of(step)
            }
            (Kind::Toggle, Value::Toggle(_)) | (Kind::Color, Value::Color(_)) => true,
            (Kind::Choice(choices), Value::Choice(name)) => choices.iter().any(|choice| choice.name == name),
            _ => false,
        };
        if fits {
            return Ok(());
        }
        Err(Refusal { path: self.path.to_owned(), value: self.text(value), range: self.range() })
    }

    /// A number of SI units in the unit that people read, rounded as far as no digit is lost.
    pub fn shown(&self, inner: f32) -> f64 {
        let Kind::Number { unit, .. } = self.kind else { return f64::from(inner) };
        let exact = f64::from(inner) / unit.si;
        (0..17)
            .filter_map(|digits| format!("{exact:.digits$e}").parse::<f64>().ok())
            .find(|rounded| (rounded * unit.si) as f32 == inner)
            .unwrap_or(exact)
    }

    /// A number of the unit that people read in SI units.
    pub fn inner(&self, shown: f64) -> f32 {
        match self.kind {
            Kind::Number { unit, .. } => (shown * unit.si) as f32,
            _ => shown as f32,
        }
    }
}

/// A field of the settings that a row names. What it is put is of its kind: [`Knob::check`] has seen it.
pub trait Field {
    /// As a value.
    fn value(&self) -> Value;
    /// From a value; one of another kind changes nothing.
    fn put(&mut self, value: Value);
}

macro_rules! plain {
    ($($type:ty: $variant:ident),*) => {$(
        impl Field for $type {
            fn value(&self) -> Value {
                Value::$variant(*self)
            }

            fn put(&mut self, value: Value) {
                if let Value::$variant(v) = value {
                    *self = v;
                }
            }
        }

        /// What the library leaves open.
        impl Field for Option<$type> {
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

/// A linear colour, which people see as sRGB.
impl Field for Vec3 {
    fn value(&self) -> Value {
        Value::Color(self.to_array().map(|v| (255.0 * encoded(v)).round() as u8))
    }

    fn put(&mut self, value: Value) {
        if let Value::Color([r, g, b]) = value {
            *self = material::srgb(u32::from_be_bytes([0, r, g, b]));
        }
    }
}

/// An enum whose variants have names.
pub trait Named: 'static {
    /// The names, with what they mean.
    const CHOICES: &'static [Choice];
}

macro_rules! named {
    ($($type:ident { $($name:literal $variant:ident $hint:literal $(=> $payload:tt $value:expr)?;)* })*) => {$(
        impl Named for $type {
            const CHOICES: &'static [Choice] = &[$(Choice { name: $name, hint: $hint }),*];
        }

        impl Field for $type {
            fn value(&self) -> Value {
                // Exhaustive, so that no variant is without a name.
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
        "stubble" Stubble "some days old, 2 mm";
        "short" Short "trimmed, a centimetre";
        "full" Full "half a year old, 4 cm at the chin";
    }
    HairHairMode {
        "off" Off "hairs pass through each other";
        "fixed" Fixed "a fixed push out of cells that are too dense";
        "gradient" Gradient "pressure along the negative gradient of the density, and friction";
    }
    AvoidMode {
        "off" Off "strands enter obstacles";
        "vertices" PenetratingOnly "only the vertices inside are moved out";
        "strands" ChangeOver "a strand that hits an obstacle follows its nearest guide";
    }
    HairColor {
        "file" File "the colours of the groom file, or brown where it has none";
        "blond" Blond "light blond";
        "brown" Brown "brown";
        "red" Red "copper red";
        "black" Black "black";
        "srgb" Srgb "the sRGB colour";
        "melanin" Melanin "eumelanin and pheomelanin";
    }
    ShadingModel {
        "fiber" Fiber "light refracted and absorbed in fibres and scattered among them";
        "kajiya-kay" KajiyaKay "a diffuse colour and two highlights set by eye; the cheapest";
    }
    ShadingRate {
        "vertex" PerVertex "at each strand vertex, interpolated along the strand";
        "pixel" PerPixel "at each pixel";
    }
    ShadowMethod {
        "opaque" Opaque "hair is solid: soft edges, black behind the first layer";
        "absorption" Absorption "light is lost in proportion to the distance behind the nearest hair";
        "deep" DeepOpacity "deep opacity maps: fibres are counted in layers behind the front of the hair";
        "off" Off "no shadows";
    }
    Coverage {
        "mask" SampleMask "each strand covers its share of the samples of a pixel";
        "alpha" AlphaToCoverage "the adapter turns a strand's share of a pixel into samples";
        "tiles" Tiles "compute shaders blend all strands in order, tile by tile; the finest";
        "peel" DepthPeeling "depth peeling: strands are blended in layers, a pass each" => { .. } Coverage::PEELING;
    }
    LodMode {
        "auto" Auto "by the size of a pixel at the hair";
        "off" Off "full detail at any distance";
        "fraction" Fixed "a fixed share of the strands" => (_) LodMode::Fixed(1.0);
    }
}
