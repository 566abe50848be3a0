//! Values, units and ranges.

use std::mem::discriminant;
use tresses::{
    avoid::AvoidMode,
    light::{ShadingModel, ShadingRate, ShadowMethod},
    volume::HairHairMode,
};

use super::Knob;
use crate::settings::{CoverageMode, Curl, HairColor, LodChoice, Samples};

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
    /// One of the names of [`Kind::Choice`].
    Choice(&'static str),
    /// sRGB.
    Color([u8; 3]),
}

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

/// How a range is best laid out under a finger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By factors. The range may begin at 0, which then is a point of its own at its end.
    Log,
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
    Choice(&'static [&'static str]),
    /// A colour in sRGB.
    Color,
}

pub(super) const fn number(unit: Unit, least: f64, most: f64) -> Kind {
    Kind::Number { unit, least, most, scale: Scale::Linear }
}

pub(super) const fn integer(unit: Unit, least: u32, most: u32, step: u32) -> Kind {
    Kind::Integer { unit, least, most, step }
}

pub(super) const fn choice<T: Named>() -> Kind {
    Kind::Choice(T::NAMES)
}

/// Why a value is refused, in one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path} is {value}, but must be {range}")]
pub struct Refusal {
    /// The parameter.
    pub path: &'static str,
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
            (Kind::Choice(names), Value::Choice(name)) => names.contains(&name),
            _ => false,
        };
        if fits {
            return Ok(());
        }
        Err(Refusal { path: self.path, value: self.text(value), range: self.range() })
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

/// A field of the settings that a knob turns. What it is put is of its kind: [`Knob::check`] has seen it.
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
    )*};
}
plain!(f32: Number, u32: Integer, bool: Toggle, [u8; 3]: Color);

impl<T: Field + Clone + Blank> Field for Option<T> {
    fn value(&self) -> Value {
        self.as_ref().map_or(Value::Auto, Field::value)
    }

    fn put(&mut self, value: Value) {
        let mut other = self.clone().unwrap_or(T::BLANK);
        other.put(value);
        match value {
            Value::Auto => *self = None,
            // Of another kind.
            _ if discriminant(&other.value()) != discriminant(&value) => {}
            _ => *self = Some(other),
        }
    }
}

/// Any value, to be overwritten.
pub trait Blank {
    /// It.
    const BLANK: Self;
}

impl Blank for f32 {
    const BLANK: Self = 0.0;
}
impl Blank for u32 {
    const BLANK: Self = 0;
}
impl Blank for [u8; 3] {
    const BLANK: Self = [0; 3];
}

/// A choice whose variants have names.
pub trait Named: Copy + PartialEq + Sized + 'static {
    /// The names, in the order of `VARIANTS`.
    const NAMES: &'static [&'static str];
    /// The variants.
    const VARIANTS: &'static [Self];
}

macro_rules! named {
    ($($type:ident { $($name:literal => $variant:ident),* })*) => {$(
        impl Named for $type {
            const NAMES: &'static [&'static str] = &[$($name),*];
            const VARIANTS: &'static [Self] = &[$(Self::$variant),*];
        }

        impl Blank for $type {
            const BLANK: Self = Self::VARIANTS[0];
        }

        impl Field for $type {
            fn value(&self) -> Value {
                // Exhaustive, so that no variant is without a name.
                Value::Choice(match self { $(Self::$variant => $name),* })
            }

            fn put(&mut self, value: Value) {
                let place = Self::NAMES.iter().position(|name| value == Value::Choice(name));
                *self = place.map_or(*self, |place| Self::VARIANTS[place]);
            }
        }
    )*};
}
named! {
    Curl { "none" => None, "waves" => Waves, "ringlets" => Ringlets, "coils" => Coils }
    HairHairMode { "off" => Off, "fixed" => Fixed, "gradient" => Gradient }
    AvoidMode { "off" => Off, "vertices" => PenetratingOnly, "strands" => ChangeOver }
    HairColor {
        "file" => File, "blond" => Blond, "brown" => Brown, "red" => Red, "black" => Black,
        "srgb" => Srgb, "melanin" => Melanin
    }
    ShadingModel { "fiber" => Fiber, "kajiya-kay" => KajiyaKay }
    ShadingRate { "vertex" => PerVertex, "pixel" => PerPixel }
    ShadowMethod { "opaque" => Opaque, "absorption" => Absorption, "deep" => DeepOpacity, "off" => Off }
    Samples { "1" => One, "4" => Four, "8" => Eight, "16" => Sixteen }
    CoverageMode { "mask" => Mask, "alpha" => Alpha, "peel" => Peel }
    LodChoice { "auto" => Auto, "off" => Off, "fraction" => Fixed }
}
