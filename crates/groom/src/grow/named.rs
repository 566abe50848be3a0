//! Named scalp maps that need no image.

use crate::mannequin;
use crate::random::{noise, smoothstep};
use crate::scalp::{Landmarks, Scalp, ScalpMap, scalp_direction};
use crate::styles::Hairline;
use glam::Vec3;

/// Width and height of a named map, pixels.
const SIZE: usize = 160;

/// Size of the patches of the map `noise`, as an angle seen from the center of the skull, radians.
const PATCH: f32 = 0.22;

/// The mannequin as a scalp, because hairlines of different heads are similar.
struct MannequinScalp;

impl Scalp for MannequinScalp {
    fn distance(&self, p: Vec3) -> f32 {
        mannequin::distance(p)
    }

    fn landmarks(&self) -> Landmarks {
        mannequin::LANDMARKS
    }
}

impl ScalpMap {
    /// Names of the maps for [`named`](Self::named).
    pub const NAMES: [&'static str; 6] = ["front", "crown", "sides", "nape", "hairline", "noise"];

    /// Returns a map by name: 1 at the `front`, on the `crown`, at the `sides`, at the `nape`, well inside the
    /// `hairline` (0 at it), or in random patches (`noise`), and 0 elsewhere, with soft edges. The prefix `not-`
    /// exchanges 0 and 1.
    pub fn named(name: &str) -> Option<Self> {
        let (name, exchanged) = match name.strip_prefix("not-") {
            Some(rest) => (rest, true),
            None => (name, false),
        };
        if !Self::NAMES.contains(&name) {
            return None;
        }
        let hairline = (name == "hairline").then(|| Hairline::new(&MannequinScalp, 0.0, 0.0, 1));
        Some(Self::from_fn(SIZE, |uv| {
            let dir = scalp_direction(uv);
            let value = match name {
                "front" => smoothstep(-0.15, 0.55, dir.z),
                "crown" => smoothstep(0.55, 0.95, dir.dot(Vec3::new(0.0, 0.94, -0.342))),
                "sides" => smoothstep(0.45, 0.85, dir.x.abs()),
                "nape" => smoothstep(-0.1, -0.55, dir.y) * smoothstep(0.1, -0.4, dir.z),
                "hairline" => {
                    let inside = hairline.as_ref().map_or(0.0, |line| line.inside(MannequinScalp.point(dir)));
                    // Far from the hairline, its distance is unreliable.
                    smoothstep(0.0, 0.035, inside).max(smoothstep(0.6, 0.85, dir.y))
                }
                _ => smoothstep(-0.25, 0.25, noise(dir / PATCH, 0x9015e)),
            };
            if exchanged { 1.0 - value } else { value }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalp::scalp_uv;
    use glam::Vec2;

    #[test]
    fn named_maps_cover_their_region() {
        let at = |name: &str, dir: Vec3| ScalpMap::named(name).unwrap().sample(scalp_uv(dir));
        for (name, here, there) in [
            ("front", Vec3::new(0.0, 0.6, 0.8), Vec3::NEG_Z),
            ("crown", Vec3::new(0.0, 0.9, -0.4), Vec3::X),
            ("sides", Vec3::X, Vec3::Y),
            ("sides", Vec3::NEG_X, Vec3::NEG_Z),
            ("nape", Vec3::new(0.0, -0.6, -0.8), Vec3::Y),
            ("hairline", Vec3::Y, Vec3::new(0.0, -0.3, 0.95)),
        ] {
            assert!(
                at(name, here) > 0.95 && at(name, there) < 0.05,
                "{name} {} {}",
                at(name, here),
                at(name, there)
            );
            let not = format!("not-{name}");
            assert!(at(&not, here) < 0.05 && at(&not, there) > 0.95, "{name}");
        }
        let noise = ScalpMap::named("noise").unwrap();
        let values: Vec<f32> =
            (0..400).map(|i| noise.sample(Vec2::new((i % 20) as f32, (i / 20) as f32) / 20.0)).collect();
        let mean = values.iter().sum::<f32>() / 400.0;
        assert!((0.3..0.7).contains(&mean) && values.iter().any(|v| *v > 0.9), "{mean}");
        assert!(ScalpMap::named("top").is_none() && ScalpMap::named("not-").is_none());
    }
}
