//! How hair grows: curls, clumps, stray hairs, widths, and maps on the scalp.

use crate::scalp_map::{ColorSource, MapSource};
use anyhow::Result;
use std::{path::PathBuf, str::FromStr};
use tresses::{
    groom::{
        Restyle,
        grow::{Clumps, CurlCurve, Curls, Growth, Paint, ScalpMap, Unrest},
        styles::Style,
    },
    light::HairMaterial,
};

/// Shape, maps and variation of the strands.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct StyleArgs {
    /// Curls: waves, ringlets, coils or none, and what differs: radius=8mm, wavelength=3cm, flatness=0..1,
    /// start=0..1 (of the length), tip=0..3 (radius there), irregularity, coherence (in a lock), neighbours
    /// (of locks) and shrink (1: hair keeps its length and the style gets shorter), each 0..1
    #[arg(long, value_name = "NAME|KEY=VALUE,..", help_heading = "Style")]
    pub curl: Option<CurlSpec>,
    /// A curl's own shape: one polyline in a file (.obj lines), of any size, repeated along the strands; with
    /// --curl wavelength=whole it is stretched over them
    #[arg(long, value_name = "FILE", help_heading = "Style")]
    pub curl_curve: Option<PathBuf>,
    /// How far strands run together towards their tips, 0 to 1, or strength=0.8,spacing=5mm,start=0.1,lock=0.3
    #[arg(long, value_name = "STRENGTH|KEY=VALUE,..", help_heading = "Style")]
    pub clump: Option<ClumpSpec>,
    /// Height of the fine waves that every strand has of its own, as in 0.3mm
    #[arg(long, value_name = "LENGTH", help_heading = "Style")]
    pub frizz: Option<Short>,
    /// Share of strands that stray a little towards the tip, and how far, as in 0.6,4mm
    #[arg(long, value_name = "SHARE[,LENGTH]", help_heading = "Style")]
    pub strays: Option<Share>,
    /// Share of strands, thin ones, that stray a lot, and how far, as in 0.03,16mm
    #[arg(long, value_name = "SHARE[,LENGTH]", help_heading = "Style")]
    pub flyaways: Option<Share>,
    /// Usual diameter of a strand, as in 80um; by default what covers the head
    #[arg(long, value_name = "LENGTH", help_heading = "Style")]
    pub width: Option<Width>,
    /// How much widths differ from strand to strand: standard deviation over mean, 0 to 0.5
    #[arg(long, value_name = "SHARE", value_parser = half, help_heading = "Style")]
    pub width_variation: Option<f32>,
    /// Width at the tip as a fraction, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = fraction, help_heading = "Style")]
    pub tip_width: Option<f32>,
    /// How much the lightness (melanin) of strands differs, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = fraction, help_heading = "Style")]
    pub lightness_spread: Option<f32>,
    /// How much the warmth (red against blue) of strands differs, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = fraction, help_heading = "Style")]
    pub warmth_spread: Option<f32>,
    /// How far highlights are shifted from strand to strand, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = fraction, help_heading = "Style")]
    pub highlight_spread: Option<f32>,
    /// Share of the strands that stay: a .png over the scalp, its top the front and its right the head's left
    /// (:r, :g or :b behind it for one channel), or front, crown, sides, nape, hairline, noise, or not-front ..
    #[arg(long, value_name = "IMAGE[:C]|NAME", help_heading = "Maps on the scalp")]
    pub density_map: Option<MapSource>,
    /// Factor of the widths, likewise
    #[arg(long, value_name = "IMAGE[:C]|NAME", help_heading = "Maps on the scalp")]
    pub thickness_map: Option<MapSource>,
    /// Factor of the lengths, likewise
    #[arg(long, value_name = "IMAGE[:C]|NAME", help_heading = "Maps on the scalp")]
    pub length_map: Option<MapSource>,
    /// Factor of the radius of curls, likewise
    #[arg(long, value_name = "IMAGE[:C]|NAME", help_heading = "Maps on the scalp")]
    pub curl_map: Option<MapSource>,
    /// Stiffness, likewise: black hair is a quarter as stiff, white four times, middle grey as it was
    #[arg(long, value_name = "IMAGE[:C]|NAME", help_heading = "Maps on the scalp")]
    pub stiffness_map: Option<MapSource>,
    /// Colours of the hair: an sRGB .png over the scalp
    #[arg(long, value_name = "IMAGE", help_heading = "Maps on the scalp")]
    pub color_map: Option<ColorSource>,
}

impl StyleArgs {
    /// The growth of a built-in style.
    pub fn growth(&self, style: &Style, strands: Option<u32>) -> Result<Growth> {
        let mut growth = Growth::for_style(style);
        if let Some(count) = strands {
            growth = growth.with_strands(count);
        }
        if self.curl.is_some() || self.curl_curve.is_some() {
            let curls = self.curls(growth.curls.clone())?;
            growth = growth.with_curls(curls);
        }
        if let Some(spec) = &self.clump {
            spec.apply(&mut growth.clumps);
        }
        self.disturb(&mut growth.unrest);
        growth.diameter = self.width.map(|width| width.0).or(growth.diameter);
        growth.width_variation = self.width_variation.unwrap_or(growth.width_variation);
        growth.tip_width = self.tip_width.unwrap_or(growth.tip_width);
        growth.paint = self.paint()?;
        Ok(growth)
    }

    /// What changes on an imported groom after it is bound; `None` for nothing.
    pub fn restyle(&self) -> Result<Option<Restyle>> {
        let plain = Growth::default();
        let mut restyle = Restyle { seed: 1, ..Restyle::default() };
        if self.curl.is_some() || self.curl_curve.is_some() {
            restyle.curls = self.curls(Curls::default())?;
        }
        if let Some(spec) = &self.clump {
            let mut clumps = match restyle.curls.any() {
                true => plain.clumps.curled(&restyle.curls),
                false => plain.clumps,
            };
            spec.apply(&mut clumps);
            restyle.clumps = Some(clumps);
        }
        if self.frizz.is_some() || self.strays.is_some() || self.flyaways.is_some() {
            // Only what is asked for: the file's strands stray by themselves.
            let none = Unrest { frizz: 0.0, strays: 0.0, flyaways: 0.0, shorter: 0.0, ..plain.unrest };
            restyle.unrest = Some(none).map(|mut unrest| {
                self.disturb(&mut unrest);
                unrest
            });
        }
        restyle.diameter = self.width.map(|width| width.0);
        restyle.width_variation = self.width_variation.unwrap_or(0.0);
        restyle.tip_width = self.tip_width;
        restyle.curl_map = self.curl_map.as_ref().map(MapSource::read).transpose()?;
        Ok(restyle.any().then_some(restyle))
    }

    /// The maps that act before strands are made.
    pub fn paint(&self) -> Result<Paint> {
        let read = |source: &Option<MapSource>| source.as_ref().map(MapSource::read).transpose();
        Ok(Paint {
            density: read(&self.density_map)?,
            thickness: read(&self.thickness_map)?,
            length: read(&self.length_map)?,
            curl: read(&self.curl_map)?,
            color: self.color_map.as_ref().map(ColorSource::read).transpose()?,
        })
    }

    /// Factors of the stiffness over the scalp.
    pub fn stiffness(&self) -> Result<Option<ScalpMap>> {
        let factor = |grey: f32| 4f32.powf(2.0 * grey - 1.0);
        self.stiffness_map.as_ref().map(|source| Ok(source.read()?.map(factor))).transpose()
    }

    /// What differs from strand to strand in the light.
    pub fn apply_to_material(&self, material: &mut HairMaterial) {
        material.lightness_spread = self.lightness_spread.unwrap_or(material.lightness_spread);
        material.warmth_spread = self.warmth_spread.unwrap_or(material.warmth_spread);
        material.shift_spread = self.highlight_spread.unwrap_or(material.shift_spread);
        let fiber = &mut material.fiber;
        fiber.melanin_spread = self.lightness_spread.unwrap_or(fiber.melanin_spread);
        // Half as wide as the shift of the softer highlights of the other model.
        fiber.tilt_spread = self.highlight_spread.map_or(fiber.tilt_spread, |spread| 0.25 * spread);
    }

    fn curls(&self, base: Curls) -> Result<Curls> {
        let spec = self.curl.clone().unwrap_or_default();
        let mut curls = spec.curls(base);
        if let Some(path) = &self.curl_curve {
            let mut curve = CurlCurve::read(path)?;
            match spec.wavelength {
                Some(Wavelength::Whole) => curve.stretched = true,
                Some(Wavelength::Length(_)) => {}
                None => curls.wavelength = curve.length_for(curls.radius).clamp(1e-3, 1.0),
            }
            curls.curve = Some(curve);
        }
        curls.check()?;
        Ok(curls)
    }

    fn disturb(&self, unrest: &mut Unrest) {
        unrest.frizz = self.frizz.map_or(unrest.frizz, |frizz| frizz.0);
        if let Some(Share { share, reach }) = self.strays {
            (unrest.strays, unrest.stray) = (share, reach.unwrap_or(unrest.stray));
        }
        if let Some(Share { share, reach }) = self.flyaways {
            (unrest.flyaways, unrest.flyaway) = (share, reach.unwrap_or(unrest.flyaway));
        }
    }
}

/// A length with its unit, metres.
fn length(text: &str) -> Option<f32> {
    let text = text.trim();
    let at = text.find(|c: char| c.is_alphabetic() || c == 'µ').unwrap_or(text.len());
    let (number, unit) = text.split_at(at);
    let number: f32 = number.trim().parse().ok()?;
    let metres = match unit {
        "um" | "µm" | "μm" => 1e-6,
        "mm" => 1e-3,
        "cm" => 1e-2,
        "m" => 1.0,
        "" if number == 0.0 => 1.0,
        _ => return None,
    };
    Some(number * metres)
}

fn length_within(text: &str, lo: f32, hi: f32, say: &str) -> Result<f32, String> {
    // A hair's breadth of room for rounding.
    let room = 1e-6;
    match length(text) {
        Some(v) if (lo * (1.0 - room)..=hi * (1.0 + room)).contains(&v) => Ok(v),
        _ => Err(say.into()),
    }
}

fn number_within(text: &str, lo: f32, hi: f32) -> Result<f32, String> {
    match text.trim().parse() {
        Ok(v) if (lo..=hi).contains(&v) => Ok(v),
        _ => Err(format!("give a number from {lo} to {hi}")),
    }
}

fn fraction(text: &str) -> Result<f32, String> {
    number_within(text, 0.0, 1.0)
}

fn half(text: &str) -> Result<f32, String> {
    number_within(text, 0.0, 0.5)
}

/// The height of frizz, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short(f32);

impl FromStr for Short {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        length_within(text, 0.0, 0.02, "give a length from 0mm to 20mm, as in 0.3mm").map(Self)
    }
}

/// A diameter, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width(f32);

impl FromStr for Width {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        length_within(text, 1e-5, 5e-3, "give a diameter from 10um to 5mm, as in 80um").map(Self)
    }
}

/// A share of the strands and how far they go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    share: f32,
    reach: Option<f32>,
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (share, reach) = match text.split_once(',') {
            Some((share, reach)) => (share, Some(reach)),
            None => (text, None),
        };
        let wrong =
            |_| "give a share from 0 to 1 and, if you like, a length up to 20cm, as in 0.6,4mm".to_owned();
        let reach = reach.map(|reach| length_within(reach, 0.0, 0.2, "").map_err(wrong)).transpose()?;
        Ok(Self { share: fraction(share).map_err(wrong)?, reach })
    }
}

/// What `--clump` says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClumpSpec {
    strength: Option<f32>,
    spacing: Option<f32>,
    start: Option<f32>,
    lock: Option<f32>,
}

impl ClumpSpec {
    fn apply(&self, clumps: &mut Clumps) {
        clumps.strength = self.strength.unwrap_or(clumps.strength);
        clumps.spacing = self.spacing.unwrap_or(clumps.spacing);
        clumps.start = self.start.unwrap_or(clumps.start);
        clumps.lock = self.lock.unwrap_or(clumps.lock);
    }
}

impl FromStr for ClumpSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut spec = Self::default();
        for part in text.split(',') {
            let Some((key, value)) = part.split_once('=') else {
                spec.strength = Some(fraction(part)?);
                continue;
            };
            let named = |error| format!("{}: {error}", key.trim());
            match key.trim() {
                "strength" => spec.strength = Some(fraction(value).map_err(named)?),
                "spacing" => {
                    let say = "give a length from 1mm to 10cm";
                    spec.spacing = Some(length_within(value, 1e-3, 0.1, say).map_err(named)?);
                }
                "start" => spec.start = Some(number_within(value, -1.0, 0.8).map_err(named)?),
                "lock" => spec.lock = Some(fraction(value).map_err(named)?),
                _ => return Err("clumps have strength, spacing, start and lock".into()),
            }
        }
        Ok(spec)
    }
}

/// How long a curl is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wavelength {
    /// Metres.
    Length(f32),
    /// The whole strand.
    Whole,
}

/// What `--curl` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurlSpec {
    preset: Option<Curls>,
    radius: Option<f32>,
    wavelength: Option<Wavelength>,
    flatness: Option<f32>,
    start: Option<f32>,
    tip: Option<f32>,
    irregularity: Option<f32>,
    coherence: Option<f32>,
    neighbours: Option<f32>,
    shrink: Option<f32>,
}

impl CurlSpec {
    fn curls(&self, base: Curls) -> Curls {
        let straight = Curls::default();
        // Whoever gives a wavelength but no radius wants curls nevertheless.
        let base = match &self.preset {
            Some(preset) => preset.clone(),
            None if base.any() => base,
            None => Curls::ringlets(),
        };
        Curls {
            radius: self.radius.unwrap_or(base.radius),
            wavelength: match self.wavelength {
                Some(Wavelength::Length(length)) => length,
                // Unused by a stretched curve.
                Some(Wavelength::Whole) => straight.wavelength,
                None => base.wavelength,
            },
            flatness: self.flatness.unwrap_or(base.flatness),
            start: self.start.unwrap_or(base.start),
            tip: self.tip.unwrap_or(base.tip),
            irregularity: self.irregularity.unwrap_or(base.irregularity),
            coherence: self.coherence.unwrap_or(base.coherence),
            neighbours: self.neighbours.unwrap_or(base.neighbours),
            shrink: self.shrink.unwrap_or(base.shrink),
            curve: None,
        }
    }
}

impl FromStr for CurlSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut spec = Self::default();
        for part in text.split(',') {
            let Some((key, value)) = part.split_once('=') else {
                spec.preset = match part.trim() {
                    "none" => Some(Curls::default()),
                    name => Some(Curls::named(name).ok_or_else(|| {
                        format!(
                            "choose {} or none, or give key=value as in radius=8mm",
                            Curls::NAMES.join(", ")
                        )
                    })?),
                };
                continue;
            };
            let named = |error| format!("{}: {error}", key.trim());
            let share = |value: &str| fraction(value).map(Some).map_err(named);
            match key.trim() {
                "radius" => {
                    let say = "give a length from 0mm to 10cm, as in 8mm";
                    spec.radius = Some(length_within(value, 0.0, 0.1, say).map_err(named)?);
                }
                "wavelength" if value.trim() == "whole" => spec.wavelength = Some(Wavelength::Whole),
                "wavelength" => {
                    let say = "give a length from 2mm to 1m, as in 3cm, or whole";
                    let length = length_within(value, 2e-3, 1.0, say).map_err(named)?;
                    spec.wavelength = Some(Wavelength::Length(length));
                }
                "tip" => spec.tip = Some(number_within(value, 0.0, 3.0).map_err(named)?),
                "flatness" => spec.flatness = share(value)?,
                "start" => spec.start = share(value)?,
                "irregularity" => spec.irregularity = share(value)?,
                "coherence" => spec.coherence = share(value)?,
                "neighbours" => spec.neighbours = share(value)?,
                "shrink" => spec.shrink = share(value)?,
                _ => {
                    return Err(
                        "curls have radius, wavelength, flatness, start, tip, irregularity, coherence, \
                                neighbours and shrink"
                            .into(),
                    );
                }
            }
        }
        Ok(spec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_mean_what_they_say() {
        let curls = |text: &str| text.parse::<CurlSpec>().unwrap().curls(Curls::default());
        let own = curls("radius=8mm, wavelength=3cm,start=0.2");
        assert_eq!((own.radius, own.wavelength, own.start), (0.008, 0.03, 0.2));
        assert_eq!(curls("waves"), Curls::waves());
        assert_eq!(curls("coils,shrink=1"), Curls { shrink: 1.0, ..Curls::coils() });
        assert!(!curls("none").any());
        assert_eq!("0.6,4mm".parse(), Ok(Share { share: 0.6, reach: Some(0.004) }));
        assert_eq!("0.3".parse(), Ok(Share { share: 0.3, reach: None }));
        assert_eq!("80um".parse(), Ok(Width(80.0 * 1e-6)));
        assert_eq!("0".parse(), Ok(Short(0.0)));
        let spec: ClumpSpec = "0.5,spacing=4mm".parse().unwrap();
        assert_eq!((spec.strength, spec.spacing, spec.lock), (Some(0.5), Some(0.004), None));
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "spirals",
            "radius=8",
            "radius=2m",
            "wavelength=0mm",
            "wavelength=1mm",
            "start=2",
            "tip=-1",
            "radius",
            "turns=3",
            "shrink=nan",
            "radius=8mm,,",
            "radius=-1mm",
            "flatness=whole",
        ] {
            assert!(text.parse::<CurlSpec>().is_err(), "{text}");
        }
        for text in ["", "2", "strength=0.5,spacing=1", "grip=1", "spacing=2m", "start=-3"] {
            assert!(text.parse::<ClumpSpec>().is_err(), "{text}");
        }
        for text in ["", "1.5", "0.2,4", "0.2,", "0.2,4miles", "-0.1", "0.5,1m"] {
            assert!(text.parse::<Share>().is_err(), "{text}");
        }
        assert!("8cm".parse::<Width>().is_err() && "1um".parse::<Width>().is_err());
        assert!("80".parse::<Width>().is_err() && "1cm2".parse::<Short>().is_err());
        assert!(half("0.6").is_err() && fraction("NaN").is_err());
    }
}
