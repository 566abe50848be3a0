//! How hair grows: curls, clumps, stray hairs, widths, and maps on the scalp.

use std::{path::PathBuf, str::FromStr};
use tresses_scene::{
    Preset,
    companions::{ColorSource, MapSource},
    settings::{Curl, HairColor, StyleSettings},
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
    /// Puts what is given into `preset`.
    pub fn apply(&self, preset: &mut Preset) {
        let style = &mut preset.settings.style;
        if let Some(spec) = &self.curl {
            spec.apply(style);
        }
        if let Some(spec) = &self.clump {
            spec.apply(style);
        }
        let put = |place: &mut Option<f32>, value: Option<f32>| *place = value.or(*place);
        put(&mut style.frizz, self.frizz.map(|frizz| frizz.0));
        put(&mut style.strays, self.strays.map(|strays| strays.share));
        put(&mut style.stray_reach, self.strays.and_then(|strays| strays.reach));
        put(&mut style.flyaways, self.flyaways.map(|flyaways| flyaways.share));
        put(&mut style.flyaway_reach, self.flyaways.and_then(|flyaways| flyaways.reach));
        put(&mut style.width, self.width.map(|width| width.0));
        put(&mut style.width_variation, self.width_variation);
        put(&mut style.tip_width, self.tip_width);
        let look = &mut preset.settings.look;
        put(&mut look.lightness_spread, self.lightness_spread);
        put(&mut look.warmth_spread, self.warmth_spread);
        put(&mut look.highlight_spread, self.highlight_spread);
        let source = &mut preset.source;
        let map = |place: &mut Option<String>, map: &Option<MapSource>| {
            *place = map.as_ref().map(MapSource::to_string).or(place.take());
        };
        map(&mut source.density_map, &self.density_map);
        map(&mut source.thickness_map, &self.thickness_map);
        map(&mut source.length_map, &self.length_map);
        map(&mut source.curl_map, &self.curl_map);
        map(&mut source.stiffness_map, &self.stiffness_map);
        if let Some(curve) = &self.curl_curve {
            source.curl_curve = Some(curve.display().to_string());
        }
        if let Some(map) = &self.color_map {
            source.color_map = Some(map.to_string());
            look.color = HairColor::File;
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
    fn apply(&self, style: &mut StyleSettings) {
        style.clump = self.strength.or(style.clump);
        style.clump_spacing = self.spacing.or(style.clump_spacing);
        style.clump_start = self.start.or(style.clump_start);
        style.clump_lock = self.lock.or(style.clump_lock);
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
    preset: Option<Curl>,
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
    fn apply(&self, style: &mut StyleSettings) {
        if self.preset.is_some() {
            // Another kind of curl: what was varied on the one before does not suit it.
            let StyleSettings { curl, curl_radius, curl_wavelength, curl_flatness, curl_start, .. } = style;
            *curl = self.preset;
            (*curl_radius, *curl_wavelength, *curl_flatness, *curl_start) = (None, None, None, None);
            let StyleSettings { curl_tip, curl_irregularity, curl_coherence, .. } = style;
            (*curl_tip, *curl_irregularity, *curl_coherence) = (None, None, None);
            (style.curl_neighbours, style.curl_shrink) = (None, None);
        }
        match self.wavelength {
            None => {}
            Some(Wavelength::Whole) => style.curl_stretch = true,
            Some(Wavelength::Length(length)) => {
                (style.curl_wavelength, style.curl_stretch) = (Some(length), false);
            }
        }
        let put = |place: &mut Option<f32>, value: Option<f32>| *place = value.or(*place);
        put(&mut style.curl_radius, self.radius);
        put(&mut style.curl_flatness, self.flatness);
        put(&mut style.curl_start, self.start);
        put(&mut style.curl_tip, self.tip);
        put(&mut style.curl_irregularity, self.irregularity);
        put(&mut style.curl_coherence, self.coherence);
        put(&mut style.curl_neighbours, self.neighbours);
        put(&mut style.curl_shrink, self.shrink);
    }
}

impl FromStr for CurlSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut spec = Self::default();
        for part in text.split(',') {
            let Some((key, value)) = part.split_once('=') else {
                spec.preset = match part.trim() {
                    "none" => Some(Curl::None),
                    "waves" => Some(Curl::Waves),
                    "ringlets" => Some(Curl::Ringlets),
                    "coils" => Some(Curl::Coils),
                    _ => {
                        return Err(
                            "choose waves, ringlets, coils or none, or give key=value as in radius=8mm"
                                .into(),
                        );
                    }
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
    use tresses::groom::{grow::Curls, styles::Style};
    use tresses_scene::{Settings, settings::Maps};

    #[test]
    fn values_mean_what_they_say() {
        let curls = |text: &str| {
            let mut settings = Settings::default();
            text.parse::<CurlSpec>().unwrap().apply(&mut settings.style);
            settings.style.growth(&Style::default(), &Maps::default()).unwrap().curls
        };
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
