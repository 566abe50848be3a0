//! The list of lights as text: keys of its entries, with units and ranges.
//!
//! [`FIELDS`] is the only list of keys. Presets (`[[lights.list]]`), the flag `--light`, Python and the studio read and
//! show lights by it. [`read`] makes a light of named values and checks it.
//!
//! ```
//! use tresses_scene::knobs::light_list::{one, LightInput, read};
//! let light = one("spot position=0.3,1.8,0.4 target=0,1.6,0 intensity=2 color=#ffaa66").unwrap();
//! let values = [("shape", "point"), ("position", "30cm, 1.6, 0")];
//! let values = values.map(|(key, text)| (key, LightInput::Text(text.into())));
//! assert_eq!(read(&values).unwrap().position.x, light.position.x);
//! assert!(one("spot position=0,1,0").unwrap_err().contains("needs target"));
//! ```

mod help;
mod text;

pub use help::flag_help;
pub(super) use help::markdown;
pub use text::{list, one};

use super::{
    Flag, SliderScale, Unit,
    flags::flag,
    text::{color, in_unit, with_unit},
    value::{DEGREES, METERS, PLAIN},
};
use crate::settings::{LightEntry, LightKind};
use tresses::glam::Vec3;

/// Path of the list of lights.
pub const PATH: &str = "lights.list";

/// Key of the shape in an entry.
pub const SHAPE: &str = "shape";

/// Flag of the command that adds a light.
pub const FLAG: Flag = flag("light", "LIGHT").about("Additional light, of any shape; may be repeated");

/// Field of a light.
#[derive(Debug)]
pub struct LightAccess<T: 'static> {
    /// Borrows the field.
    pub get: fn(&LightEntry) -> &T,
    /// Borrows the field to change it.
    pub get_mut: fn(&mut LightEntry) -> &mut T,
}

/// Type, range and field of a key.
#[derive(Debug)]
pub enum LightFieldKind {
    /// A number in SI units. The range is inclusive, in `unit`.
    Number {
        /// Display unit.
        unit: Unit,
        /// Minimum.
        min: f64,
        /// Maximum. An infinite value means none, if it is the default.
        max: f64,
        /// Mapping to a slider.
        scale: SliderScale,
        /// The field.
        field: LightAccess<f32>,
    },
    /// A point, meters.
    Position(LightAccess<Vec3>),
    /// A color in sRGB.
    Color(LightAccess<[u8; 3]>),
    /// On or off.
    Toggle(LightAccess<bool>),
    /// Any text.
    Text(LightAccess<String>),
}

/// When an entry must have a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyPresence {
    /// Always.
    Required,
    /// Never, but presets always list it.
    Listed,
    /// Never, and presets list it if the value is not the default.
    Optional,
}

/// A key of an entry.
#[derive(Debug)]
pub struct LightField {
    /// Key.
    pub key: &'static str,
    /// Display name.
    pub label: &'static str,
    /// Meaning, one sentence.
    pub hint: &'static str,
    /// Shapes that have it.
    pub shapes: &'static [LightKind],
    /// When an entry must have it.
    pub presence: KeyPresence,
    /// Type, range and field.
    pub kind: LightFieldKind,
}

/// A value of a key, from a file or a program.
#[derive(Clone, Debug, PartialEq)]
pub enum LightInput {
    /// A number in the key's unit.
    Number(f64),
    /// Several numbers: a point in meters.
    Numbers(Vec<f64>),
    /// On or off.
    Toggle(bool),
    /// Any value as text. Numbers may have a unit.
    Text(String),
    /// A value of another type, described in a few words.
    Other(&'static str),
}

/// Why values are not a light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightProblem {
    /// Index of the invalid value, if it is one.
    pub index: Option<usize>,
    /// Description, one clause.
    pub problem: String,
}

/// Largest coordinate, meters.
const FARTHEST: f32 = 1000.0;

use LightKind::{Disc, Distant, Point, Rectangle, Sphere, Spot, Tube};

macro_rules! access {
    ($($field:tt)+) => {
        LightAccess { get: |light| &light.$($field)+, get_mut: |light| &mut light.$($field)+ }
    };
}

macro_rules! number {
    ($unit:expr, $min:expr, $max:expr, $scale:ident, $field:ident) => {
        LightFieldKind::Number {
            unit: $unit,
            min: $min,
            max: $max,
            scale: SliderScale::$scale,
            field: access!($field),
        }
    };
}

macro_rules! fields {
    ($($key:literal $label:literal $shapes:expr, $presence:ident, $kind:expr, $hint:literal;)*) => {
        &[$(LightField {
            key: $key,
            label: $label,
            hint: $hint,
            shapes: $shapes,
            presence: KeyPresence::$presence,
            kind: $kind,
        }),*]
    };
}

/// All keys besides the [shape](SHAPE), in display order.
pub const FIELDS: &[LightField] = fields! {
    "name" "Name" &LightKind::ALL, Optional, LightFieldKind::Text(access!(name)),
        "Text that names the light in lists and errors.";
    "on" "On" &LightKind::ALL, Optional, LightFieldKind::Toggle(access!(is_on)),
        "Whether it emits light.";
    "azimuth" "Azimuth" &[Distant], Required, number!(DEGREES, -360.0, 360.0, Linear, azimuth),
        "Direction that the light comes from: front (0), left of the head (90), back (180).";
    "elevation" "Elevation" &[Distant], Required, number!(DEGREES, -90.0, 90.0, Linear, elevation),
        "Angle of the light above the horizon.";
    "position" "Position" &[Point, Spot, Rectangle, Disc, Sphere], Required,
        LightFieldKind::Position(access!(position)),
        "Center: x to the left of the head, y up, z to the front.";
    "target" "Target" &[Spot, Rectangle, Disc], Required, LightFieldKind::Position(access!(target)),
        "Point at which it shines.";
    "from" "From" &[Tube], Required, LightFieldKind::Position(access!(ends[0])),
        "One end of the tube.";
    "to" "To" &[Tube], Required, LightFieldKind::Position(access!(ends[1])),
        "The other end of the tube.";
    "inner" "Inner angle" &[Spot], Optional, number!(DEGREES, 0.0, 89.0, Linear, inner),
        "Angle between the axis and the edge of full light.";
    "outer" "Outer angle" &[Spot], Optional, number!(DEGREES, 0.1, 89.0, Linear, outer),
        "Angle between the axis and the end of the cone.";
    "width" "Width" &[Rectangle], Required, number!(METERS, 0.001, 100.0, Log, width),
        "Length of the horizontal edge.";
    "height" "Height" &[Rectangle], Required, number!(METERS, 0.001, 100.0, Log, height),
        "Length of the other edge.";
    "roll" "Roll" &[Rectangle], Optional, number!(DEGREES, -360.0, 360.0, Linear, roll),
        "Rotation about the axis, counterclockwise as seen from its front.";
    "radius" "Radius" &[Disc, Sphere, Tube], Required, number!(METERS, 0.001, 100.0, Log, radius),
        "Distance of the surface from the center or the axis.";
    "hole" "Hole" &[Disc], Optional, number!(METERS, 0.0, 100.0, Log, hole),
        "Radius of the hole, which makes the disc a ring.";
    "color" "Color" &LightKind::ALL, Optional, LightFieldKind::Color(access!(color)),
        "Color in sRGB.";
    "intensity" "Intensity" &LightKind::ALL, Listed, number!(PLAIN, 0.0, 1e6, Log, intensity),
        "Irradiance of a distant light, irradiance of a point or spot light at 1 m, radiance of the others.";
    "range" "Range" &[Point, Spot, Rectangle, Disc, Sphere, Tube], Optional,
        number!(METERS, 0.01, 1000.0, Log, range),
        "Distance at which the light ends.";
    "casts_shadows" "Shadows" &LightKind::ALL, Optional, LightFieldKind::Toggle(access!(casts_shadows)),
        "Whether its shadows fall on bodies; hair always has them.";
};

/// Returns the keys of a shape.
pub fn fields(kind: LightKind) -> impl Iterator<Item = &'static LightField> {
    FIELDS.iter().filter(move |field| field.shapes.contains(&kind))
}

/// Returns the shape with this name.
fn kind(name: &str) -> Option<LightKind> {
    LightKind::ALL.into_iter().find(|kind| kind.name() == name)
}

fn shapes() -> String {
    format!("one of {}", LightKind::ALL.map(LightKind::name).join(", "))
}

impl LightField {
    /// Describes the allowed values.
    pub fn range(&self) -> String {
        match self.kind {
            LightFieldKind::Number { unit, min, max, .. } => {
                with_unit(&format!("from {min} to {max}"), unit.symbol)
            }
            LightFieldKind::Position(_) => "three numbers, meters".into(),
            LightFieldKind::Color(_) => "a color such as #ffaa66".into(),
            LightFieldKind::Toggle(_) => "true or false".into(),
            LightFieldKind::Text(_) => "a text".into(),
        }
    }

    /// Returns the symbol of the unit; empty for a plain number and other values.
    pub fn unit(&self) -> &'static str {
        match self.kind {
            LightFieldKind::Number { unit, .. } => unit.symbol,
            LightFieldKind::Position(_) => METERS.symbol,
            _ => "",
        }
    }

    /// Returns the value in `light` in the key's unit; `None` for no range.
    pub fn get(&self, light: &LightEntry) -> Option<LightInput> {
        Some(match &self.kind {
            LightFieldKind::Number { unit, field, .. } => {
                let value = *(field.get)(light);
                LightInput::Number(value.is_finite().then(|| unit.shown(value))?)
            }
            LightFieldKind::Position(field) => {
                let numbers = (field.get)(light).to_array();
                LightInput::Numbers(numbers.map(|v| METERS.shown(v)).into())
            }
            LightFieldKind::Color(field) => {
                let [r, g, b] = (field.get)(light);
                LightInput::Text(format!("#{r:02x}{g:02x}{b:02x}"))
            }
            LightFieldKind::Toggle(field) => LightInput::Toggle(*(field.get)(light)),
            LightFieldKind::Text(field) => LightInput::Text((field.get)(light).clone()),
        })
    }

    /// Describes the default value.
    fn default(&self) -> String {
        let of = |kind: LightKind| match self.get(&LightEntry::new(kind)) {
            None => "none".to_owned(),
            Some(LightInput::Text(text)) => text,
            Some(value) => value.show(),
        };
        match *self.shapes == LightKind::ALL && of(Distant) != of(Sphere) {
            true => format!("{} distant, {} point and spot, {} others", of(Distant), of(Point), of(Sphere)),
            false => of(self.shapes[0]),
        }
    }

    /// Sets the value in `light`, unless it has the wrong type or is out of range.
    fn set(&self, light: &mut LightEntry, input: &LightInput) -> Option<()> {
        match &self.kind {
            LightFieldKind::Number { unit, field, .. } => {
                let shown = match input {
                    LightInput::Number(number) => *number,
                    LightInput::Text(text) => in_unit(text.trim(), *unit)?,
                    _ => return None,
                };
                let value = unit.inner(shown);
                self.holds(value).then(|| *(field.get_mut)(light) = value)?;
            }
            LightFieldKind::Position(field) => {
                let numbers = match input {
                    LightInput::Numbers(numbers) => numbers.clone(),
                    LightInput::Text(text) => {
                        text.split(',').map(|part| in_unit(part.trim(), METERS)).collect::<Option<_>>()?
                    }
                    _ => return None,
                };
                let numbers: [f64; 3] = numbers.try_into().ok()?;
                let point = Vec3::from(numbers.map(|v| METERS.inner(v)));
                is_near(point).then(|| *(field.get_mut)(light) = point)?;
            }
            LightFieldKind::Color(field) => {
                let LightInput::Text(text) = input else { return None };
                *(field.get_mut)(light) = color(text.trim())?;
            }
            LightFieldKind::Toggle(field) => {
                *(field.get_mut)(light) = match input {
                    LightInput::Toggle(on) => *on,
                    LightInput::Text(text) => match text.trim() {
                        "on" | "true" | "yes" => true,
                        "off" | "false" | "no" => false,
                        _ => return None,
                    },
                    _ => return None,
                };
            }
            LightFieldKind::Text(field) => {
                let LightInput::Text(text) = input else { return None };
                *(field.get_mut)(light) = text.split_whitespace().collect::<Vec<_>>().join(" ");
            }
        }
        Some(())
    }

    /// Whether a number in SI units is in range.
    fn holds(&self, value: f32) -> bool {
        let LightFieldKind::Number { unit, min, max, .. } = self.kind else { return false };
        (unit.inner(min)..=unit.inner(max)).contains(&value)
    }

    /// Checks the value in `light`.
    fn is_valid(&self, light: &LightEntry) -> bool {
        match &self.kind {
            LightFieldKind::Number { field, .. } => {
                let (value, default) = (*(field.get)(light), *(field.get)(&LightEntry::new(light.kind)));
                self.holds(value) || (value == f32::INFINITY && default == value)
            }
            LightFieldKind::Position(field) => is_near(*(field.get)(light)),
            LightFieldKind::Color(_) | LightFieldKind::Toggle(_) | LightFieldKind::Text(_) => true,
        }
    }
}

fn is_near(point: Vec3) -> bool {
    point.is_finite() && point.abs().max_element() <= FARTHEST
}

impl LightInput {
    fn show(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Numbers(numbers) => {
                format!("[{}]", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
            }
            Self::Toggle(on) => on.to_string(),
            Self::Text(text) if text.chars().count() <= 40 => format!("\"{}\"", text.escape_debug()),
            Self::Text(_) => "a long text".into(),
            Self::Other(what) => (*what).into(),
        }
    }
}

impl LightEntry {
    /// Checks the values that its shape has.
    ///
    /// # Errors
    /// Returns the key of the first invalid value, and a clause that names it.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        if let Some(field) = fields(self.kind).find(|field| !field.is_valid(self)) {
            let value = field.get(self).map_or("not finite".into(), |value| value.show());
            return Err((field.key, format!("{} is {value}, but must be {}", field.key, field.range())));
        }
        let wrong = |key: &'static str, clause: &str| Err((key, format!("{key} {clause}")));
        match self.kind {
            Spot if self.inner > self.outer => wrong("inner", "must not be wider than outer"),
            Disc if self.hole >= self.radius => wrong("hole", "must be smaller than radius"),
            kind if kind.is_aimed() && self.position.distance(self.target) < 1e-4 => {
                wrong("target", "must differ from position")
            }
            Tube if self.ends[0].distance(self.ends[1]) < 1e-4 => wrong("to", "must differ from from"),
            _ => Ok(()),
        }
    }
}

/// Makes a light of the values of its keys, one of which is its [shape](SHAPE).
///
/// # Errors
/// Fails if a key is unknown, missing, given twice or of another shape, or a value is invalid.
pub fn read<K: AsRef<str>>(values: &[(K, LightInput)]) -> Result<LightEntry, LightProblem> {
    let fail = |index: Option<usize>, problem: String| Err(LightProblem { index, problem });
    let find = |key: &str| values.iter().position(|(other, _)| other.as_ref() == key);
    let Some(index) = find(SHAPE) else { return fail(None, format!("shape is missing; it is {}", shapes())) };
    let shape = &values[index].1;
    let named = match shape {
        LightInput::Text(name) => kind(name),
        _ => None,
    };
    let Some(kind) = named else {
        return fail(Some(index), format!("shape is {}, but must be {}", shape.show(), shapes()));
    };
    let mut light = LightEntry::new(kind);
    for (i, (key, value)) in values.iter().enumerate() {
        let key = key.as_ref();
        if find(key) != Some(i) {
            return fail(Some(i), format!("{key} is given twice"));
        }
        if key == SHAPE {
            continue;
        }
        let Some(field) = fields(kind).find(|field| field.key == key) else {
            return fail(Some(i), unknown(kind, key));
        };
        if field.set(&mut light, value).is_none() {
            return fail(Some(i), format!("{key} is {}, but must be {}", value.show(), field.range()));
        }
    }
    let required = fields(kind).filter(|field| field.presence == KeyPresence::Required);
    let missing: Vec<_> = required.filter(|field| find(field.key).is_none()).map(|field| field.key).collect();
    if !missing.is_empty() {
        return fail(None, format!("a {} light needs {}", kind.name(), missing.join(", ")));
    }
    light.check().map_err(|(key, problem)| LightProblem { index: find(key), problem })?;
    Ok(light)
}

/// Describes a key that the shape does not have.
fn unknown(kind: LightKind, key: &str) -> String {
    let keys: Vec<_> = fields(kind).map(|field| field.key).collect();
    if FIELDS.iter().any(|field| field.key == key) {
        return format!("a {} light has no {key}; it has {}", kind.name(), keys.join(", "));
    }
    let nearest = keys.iter().min_by_key(|known| strsim::damerau_levenshtein(key, known));
    format!("there is no {key}; the nearest is {}", nearest.unwrap_or(&SHAPE))
}

/// Names an entry in errors, such as `light 2 (Window) of lights.list`. `index` counts from 0.
pub fn label(index: usize, name: &str) -> String {
    match name {
        "" => format!("light {} of {PATH}", index + 1),
        name => format!("light {} ({name}) of {PATH}", index + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unique_and_read_back() {
        let mut seen = std::collections::HashSet::new();
        for field in FIELDS {
            assert!(seen.insert(field.key) && field.key != SHAPE, "{} twice", field.key);
            assert!(!field.label.is_empty() && field.hint.ends_with('.') && !field.hint.contains('|'));
        }
        for kind in LightKind::ALL {
            assert_eq!(super::kind(kind.name()), Some(kind));
            let mut light = LightEntry::new(kind);
            (light.position, light.ends[1]) = (Vec3::new(0.1, -2.0, 3.0), Vec3::X);
            let mut values = vec![(SHAPE, LightInput::Text(kind.name().into()))];
            values.extend(fields(kind).filter_map(|field| Some((field.key, field.get(&light)?))));
            let back = read(&values).unwrap();
            assert!(fields(kind).all(|field| field.get(&back) == field.get(&light)), "{back:?}");
        }
    }

    #[test]
    fn check_finds_values_that_bypass_the_keys() {
        let usual = LightEntry { position: Vec3::Y, ..LightEntry::new(Spot) };
        assert_eq!(usual.check(), Ok(()));
        for (light, key) in [
            (LightEntry { intensity: -1.0, ..usual.clone() }, "intensity"),
            (LightEntry { intensity: f32::INFINITY, ..usual.clone() }, "intensity"),
            (LightEntry { range: f32::NAN, ..usual.clone() }, "range"),
            (LightEntry { position: Vec3::NAN, ..usual.clone() }, "position"),
            (LightEntry { target: usual.position, ..usual.clone() }, "target"),
        ] {
            let (found, clause) = light.check().unwrap_err();
            assert!(found == key && clause.starts_with(key), "{key}: {clause}");
        }
    }
}
