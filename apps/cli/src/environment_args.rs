//! The option for a picture of the surroundings that lights the scene.

use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use tresses::{
    glam::Vec3,
    light::{Directional, Environment, Lights, MAX_LIGHTS, Sky},
};
use tresses_scene::Preset;

/// The most pixels of a picture that is read: 16K by 8K.
const MAX_PIXELS: u64 = 16_384 * 8_192;

/// Rows and columns that light is gathered in: finer makes no difference to hair.
const COLUMNS: usize = 512;

/// Light from a picture of the surroundings.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Light")]
pub struct EnvironmentArgs {
    /// An equirectangular picture of the surroundings (.hdr or .exr) that gives all light instead of
    /// key, rim and sky; its middle lies before the face
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// By how much the surroundings are turned, towards the head's left, degrees [default: 0]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = turn)]
    pub environment_turn: Option<f32>,
    /// What their light is multiplied by [default: 1]
    #[arg(long, value_name = "FACTOR", value_parser = strength)]
    pub environment_strength: Option<f32>,
}

fn turn(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(turn) if (-360.0..=360.0).contains(&turn) => Ok(turn),
        _ => Err("give degrees from -360 to 360".into()),
    }
}

fn strength(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(strength) if (0.001..=1000.0).contains(&strength) => Ok(strength),
        _ => Err("give a factor from 0.001 to 1000".into()),
    }
}

impl EnvironmentArgs {
    /// Puts what is given into `preset`.
    pub fn apply(&self, preset: &mut Preset) -> Result<()> {
        if let Some(path) = &self.environment {
            preset.source.environment = Some(path.display().to_string());
        }
        ensure!(
            preset.source.environment.is_some()
                || self.environment_turn.is_none() && self.environment_strength.is_none(),
            "there are no surroundings to turn or to strengthen: give --environment"
        );
        let lights = &mut preset.settings.lights;
        lights.environment_turn = self.environment_turn.map_or(lights.environment_turn, f32::to_radians);
        lights.environment_strength = self.environment_strength.unwrap_or(lights.environment_strength);
        Ok(())
    }
}

/// The light of the surroundings of `preset`, where it names some.
pub fn surroundings(preset: &Preset) -> Result<Option<Lights>> {
    let Some(path) = &preset.source.environment else { return Ok(None) };
    let (width, height, pixels) = read(Path::new(path)).with_context(|| path.clone())?;
    let settings = &preset.settings.lights;
    let (turn, strength) = (settings.environment_turn, settings.environment_strength);
    let (mut environment, suns) = Environment::from_equirectangular(width, height, &pixels, turn)
        .context("the picture has no pixels")?;
    for coefficient in &mut environment.coefficients {
        *coefficient *= strength;
    }
    let mut directional = [Directional::OFF; MAX_LIGHTS];
    for (place, sun) in directional.iter_mut().zip(suns) {
        *place = Directional { irradiance: sun.irradiance * strength, ..sun };
    }
    Ok(Some(Lights { directional, sky: Sky::default(), environment }))
}

/// Width, height and linear pixels of the picture at `path`, made small enough.
fn read(path: &Path) -> Result<(usize, usize, Vec<[f32; 3]>)> {
    let mut reader = image::ImageReader::open(path)?;
    let format = image::ImageFormat::from_path(path).ok();
    ensure!(
        matches!(format, Some(image::ImageFormat::Hdr | image::ImageFormat::OpenExr)),
        "surroundings are read from .hdr and .exr files"
    );
    reader.set_format(format.context("an unknown format")?);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_PIXELS * 16);
    reader.limits(limits);
    let picture = reader.decode()?.into_rgb32f();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    ensure!(
        width.abs_diff(2 * height) <= 2,
        "the picture is {width} × {height} pixels, but surroundings are twice as wide as high"
    );
    // Whole blocks, so that every pixel counts.
    let block = width.div_ceil(COLUMNS);
    let (columns, rows) = (width.div_ceil(block), height.div_ceil(block));
    let pixels = (0..rows * columns).map(|i| {
        let (x0, y0) = (i % columns * block, i / columns * block);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for y in y0..(y0 + block).min(height) {
            for x in x0..(x0 + block).min(width) {
                let v = Vec3::from(picture.get_pixel(x as u32, y as u32).0);
                sum += if v.is_finite() { v.max(Vec3::ZERO) } else { Vec3::ZERO };
                count += 1.0;
            }
        }
        (sum / count).to_array()
    });
    Ok((columns, rows, pixels.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(name: &str, width: u32, height: u32) -> (tempfile::TempDir, EnvironmentArgs) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        // Bright above, and a sun.
        let picture = image::Rgb32FImage::from_fn(width, height, |x, y| match (x, y) {
            (10..12, 5..7) => image::Rgb([800.0, 700.0, 600.0]),
            _ if y < height / 2 => image::Rgb([0.5, 0.6, 0.8]),
            _ => image::Rgb([0.1; 3]),
        });
        picture.save(&path).unwrap();
        (folder, EnvironmentArgs { environment: Some(path), ..Default::default() })
    }

    fn lights(args: &EnvironmentArgs) -> Result<Option<Lights>> {
        let mut preset = Preset::default();
        args.apply(&mut preset)?;
        surroundings(&preset)
    }

    #[test]
    fn both_formats_are_read() {
        for name in ["sky.hdr", "sky.exr"] {
            let (_folder, mut args) = written(name, 64, 32);
            let lights = lights(&args).unwrap().unwrap();
            assert_eq!(lights.active().count(), 1, "{name}");
            let (above, below) = (lights.environment.around(Vec3::Y), lights.environment.around(Vec3::NEG_Y));
            assert!((above - Vec3::new(0.5, 0.6, 0.8)).abs().max_element() < 0.05, "{name} {above}");
            assert!(below.x < 0.15);
            args.environment_strength = Some(2.0);
            let brighter = super::tests::lights(&args).unwrap().unwrap();
            assert!((brighter.environment.around(Vec3::Y) / above - 2.0).abs().max_element() < 1e-3);
            assert!(brighter.directional[0].irradiance.x > 1.9 * lights.directional[0].irradiance.x);
        }
    }

    #[test]
    fn what_is_no_picture_of_surroundings_is_refused() {
        let (_folder, args) = written("square.hdr", 64, 64);
        assert!(format!("{:#}", lights(&args).unwrap_err()).contains("twice as wide"));
        let missing = EnvironmentArgs { environment: Some("missing.hdr".into()), ..Default::default() };
        assert!(lights(&missing).is_err());
        let png = EnvironmentArgs { environment: Some(file!().into()), ..Default::default() };
        assert!(lights(&png).is_err());
        assert!(lights(&EnvironmentArgs { environment_turn: Some(20.0), ..Default::default() }).is_err());
        assert!(turn("400").is_err() && strength("0").is_err() && strength("NaN").is_err());
    }
}
