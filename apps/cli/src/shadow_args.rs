//! The shadows of `tresses render`.

use tresses::light::{ShadowMethod, Shadows};

/// How hair is counted in shadows.
#[derive(clap::ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Hair is solid: soft edges, black behind the first row
    Opaque,
    /// Hair takes light in proportion to the way behind the hair nearest the light
    Absorption,
    /// Fibres are counted where they are, in layers behind the hair's front
    #[default]
    Deep,
}

/// Shadows.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct ShadowArgs {
    /// How hair shadows hair, head and body
    #[arg(long, value_name = "METHOD", value_enum, default_value_t, help_heading = "Shadows")]
    shadows: Method,
    /// Texels along each edge of a shadow map, 64 to 2048
    #[arg(long, value_name = "N", default_value = "1024", value_parser = clap::value_parser!(u32).range(64..=2048), help_heading = "Shadows")]
    shadow_resolution: u32,
    /// Radius over which shadows on hair are averaged, millimetres
    #[arg(long, value_name = "MM", default_value = "3", value_parser = softness, help_heading = "Shadows")]
    shadow_softness: f32,
    /// Shade hair, and look its shadows up, for every pixel, not only at the vertices of its strands
    #[arg(long, help_heading = "Shadows")]
    shadows_per_pixel: bool,
}

impl ShadowArgs {
    /// Texels along each edge of a shadow map.
    pub fn resolution(&self) -> u32 {
        self.shadow_resolution
    }

    /// What the library is told.
    pub fn shadows(&self) -> Shadows {
        let method = match self.shadows {
            Method::Opaque => ShadowMethod::Opaque,
            Method::Absorption => ShadowMethod::Absorption,
            Method::Deep => ShadowMethod::DeepOpacity,
        };
        let hair_radius = 1e-3 * self.shadow_softness;
        Shadows { method, hair_radius, per_pixel: self.shadows_per_pixel, ..Default::default() }
    }
}

fn softness(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(value) if (0.1..=50.0).contains(&value) => Ok(value),
        _ => Err("give millimetres from 0.1 to 50".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        shadows: ShadowArgs,
    }

    #[test]
    fn options_reach_the_library() {
        let parse = |line: &str| Command::try_parse_from(line.split(' ')).map(|command| command.shadows);
        let default = parse("x").unwrap();
        assert_eq!((default.shadows(), default.resolution()), (Shadows::default(), 1024));
        let other =
            parse("x --shadows opaque --shadow-resolution 512 --shadow-softness 5 --shadows-per-pixel");
        let other = other.unwrap();
        assert_eq!(other.resolution(), 512);
        let shadows = other.shadows();
        assert_eq!(shadows.method, ShadowMethod::Opaque);
        assert!((shadows.hair_radius - 0.005).abs() < 1e-6 && shadows.per_pixel);
        for line in
            ["--shadows soft", "--shadow-resolution 9000", "--shadow-softness 0", "--shadow-softness nan"]
        {
            assert!(parse(&format!("x {line}")).is_err(), "{line}");
        }
    }
}
