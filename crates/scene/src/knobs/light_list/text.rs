//! Lights as texts of one line.

use super::{LightInput, LightProblem, SHAPE, label, read};
use crate::settings::LightEntry;

/// Irradiance of the short form of a distant light, if it has none.
const DISTANT_IRRADIANCE: &str = "2";

/// Reads a light from one text: a shape and values, as in `point position=0.3,1.6,0.4 intensity=2`, or the short form
/// of a distant light, `AZIMUTH,ELEVATION[,IRRADIANCE]`.
///
/// # Errors
/// As [`read`], as one clause.
pub fn one(text: &str) -> Result<LightEntry, String> {
    let form = "expected a shape and values, as in point position=0.3,1.6,0.4";
    let short = text.trim().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let mut values: Vec<(String, LightInput)> = Vec::new();
    if short {
        let parts: Vec<_> = text.split(',').collect();
        let (azimuth, elevation, irradiance) = match parts[..] {
            [azimuth, elevation] => (azimuth, elevation, DISTANT_IRRADIANCE),
            [azimuth, elevation, irradiance] => (azimuth, elevation, irradiance),
            _ => return Err(format!("{form}, or AZIMUTH,ELEVATION[,IRRADIANCE]")),
        };
        let pairs =
            [(SHAPE, "distant"), ("azimuth", azimuth), ("elevation", elevation), ("intensity", irradiance)];
        values.extend(pairs.map(|(key, text)| (key.into(), LightInput::Text(text.into()))));
    } else {
        let mut words = text.split_whitespace();
        let shape = words.next().ok_or(form)?;
        let shape = shape.strip_prefix("shape=").unwrap_or(shape);
        values.push((SHAPE.into(), LightInput::Text(shape.into())));
        for word in words {
            match (word.split_once('='), values.last_mut()) {
                (Some((key, value)), _) => values.push((key.into(), LightInput::Text(value.into()))),
                // A value with spaces continues.
                (None, Some((key, LightInput::Text(value)))) if key != SHAPE => {
                    *value += " ";
                    *value += word;
                }
                _ => return Err(format!("{word}: {form}")),
            }
        }
    }
    read(&values).map_err(|LightProblem { problem, .. }| problem)
}

/// Reads a list of lights from one text, separated by semicolons.
///
/// # Errors
/// As [`one`]; the clause names the light.
pub fn list(text: &str) -> Result<Vec<LightEntry>, String> {
    let texts = text.split(';').map(str::trim).filter(|text| !text.is_empty());
    texts.enumerate().map(|(i, text)| one(text).map_err(|e| format!("{}: {e}", label(i, "")))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::LightKind::Point;
    use tresses::glam::Vec3;

    #[test]
    fn texts_make_lights_of_every_shape() {
        let point = one("point position=0.3,1.6,0.4").unwrap();
        assert_eq!((point.kind, point.position), (Point, Vec3::new(0.3, 1.6, 0.4)));
        assert_eq!((point.intensity, point.color, point.range), (1.0, [255; 3], f32::INFINITY));
        let spot =
            one("spot position=0.3, 1.6, 0.4 target=0,1.5,0 inner=10 outer=25° color=#ffaa66").unwrap();
        assert_eq!((spot.inner, spot.outer), (10f32.to_radians(), 25f32.to_radians()));
        assert_eq!(spot.color, [0xff, 0xaa, 0x66]);
        let rectangle = "shape=rectangle position=0,1,1 target=0,1,0 width=60cm height=0.4 roll=-30";
        assert_eq!(one(rectangle).unwrap().width, 0.6);
        let ring = one("disc position=0,1,1 target=0,1,0 radius=0.2 hole=15cm name=Ring light").unwrap();
        assert_eq!((ring.hole, ring.name.as_str()), (0.15, "Ring light"));
        assert_eq!(one("sphere position=0,1,1 radius=5mm intensity=1000").unwrap().radius, 0.005);
        let tube = one("tube from=-1,1,0 to=1,1,0 radius=0.01 on=off casts_shadows=no range=3").unwrap();
        assert_eq!((tube.ends, tube.range), ([Vec3::new(-1.0, 1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)], 3.0));
        assert!(!tube.is_on && !tube.casts_shadows);
        let distant = one("distant azimuth=-10 elevation=20").unwrap();
        assert_eq!(distant, one("-10,20").unwrap());
        assert_eq!(one("-10,20,3").unwrap(), LightEntry { intensity: 3.0, ..distant });
        assert_eq!(list(" -10,20 ; point position=0,0,1;").unwrap().len(), 2);
    }

    #[test]
    fn invalid_texts_name_the_key() {
        for (text, clause) in [
            ("", "expected a shape"),
            ("10", "AZIMUTH,ELEVATION[,IRRADIANCE]"),
            ("1,2,3,4", "AZIMUTH,ELEVATION[,IRRADIANCE]"),
            ("10,100", "elevation is \"100\", but must be from -90 to 90°"),
            ("400,0", "azimuth is"),
            ("1,2,-1", "intensity is \"-1\", but must be from 0 to 1000000"),
            ("ring position=0,1,1", "must be one of distant, point, spot, rectangle, disc, sphere, tube"),
            ("point", "a point light needs position"),
            ("spot position=0,1,1", "a spot light needs target"),
            ("point 0,1,1", "expected a shape"),
            ("point position=0,1", "position is \"0,1\", but must be three numbers"),
            ("point position=0,1,nan", "position is"),
            ("point position=0,1,1e9", "position is"),
            ("point position=0,1,1 intensity=nan", "intensity is"),
            ("point position=0,1,1 width=2", "a point light has no width; it has name"),
            ("point position=0,1,1 colour=#ffffff", "the nearest is color"),
            ("point position=0,1,1 color=red", "a color such as"),
            ("point position=0,1,1 on=perhaps", "true or false"),
            ("point position=0,1,1 position=0,1,2", "position is given twice"),
            ("spot position=0,1,1 target=0,1,1", "target must differ"),
            ("spot position=0,1,1 target=0,1,0 inner=40", "inner must not be wider"),
            ("disc position=0,1,1 target=0,1,0 radius=0.1 hole=0.1", "hole must be smaller"),
            ("tube from=0,1,1 to=0,1,1 radius=0.1", "to must differ"),
            ("sphere position=0,1,1 radius=-0.1", "radius is"),
        ] {
            let error = one(text).unwrap_err();
            assert!(error.contains(clause) && !error.contains('\n'), "{text}: {error}");
        }
        let error = list("1,2;point").unwrap_err();
        assert!(error.starts_with("light 2 of lights.list: a point light needs"), "{error}");
    }
}
