//! The lights: a key light, a rim light and a sky, in linear units.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

/// A light so far away that its rays are parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Irradiance on a plane that faces the light, linear; 0 switches the light off.
    pub irradiance: Vec3,
}

/// The radiance that comes from everywhere else: three colours, blended by elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// From straight above, linear radiance.
    pub zenith: Vec3,
    /// From the horizon.
    pub horizon: Vec3,
    /// From straight below.
    pub ground: Vec3,
}

/// All light in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lights {
    /// The main light, from the upper side.
    pub key: Directional,
    /// The light from behind that traces the outline.
    pub rim: Directional,
    /// The rest.
    pub sky: Sky,
}

impl Default for Lights {
    /// For a camera in front of the face: [`Lights::around`] 0.
    fn default() -> Self {
        Self::around(0.0)
    }
}

impl Lights {
    /// A photographer's lights, which move with the camera: a warm key light from its upper left,
    /// a cooler rim light from behind on its right, a quiet sky. `azimuth` is the camera's turn
    /// about the head, radians, from before the face (+Z) towards the head's left (+X).
    pub fn around(azimuth: f32) -> Self {
        let turn = glam::Quat::from_rotation_y(azimuth);
        Self {
            key: Directional {
                direction: turn * Vec3::new(-0.42, 0.62, 0.66).normalize(),
                irradiance: Vec3::new(5.6, 5.3, 4.85),
            },
            rim: Directional {
                direction: turn * Vec3::new(0.45, 0.5, -0.74).normalize(),
                irradiance: Vec3::new(3.1, 3.25, 3.5),
            },
            sky: Sky {
                zenith: Vec3::new(0.30, 0.31, 0.33),
                horizon: Vec3::new(0.24, 0.24, 0.25),
                ground: Vec3::new(0.13, 0.12, 0.11),
            },
        }
    }
}

/// The number of shadow maps: key, rim, and one from above for the sky.
pub const SHADOW_LAYERS: u32 = 3;

/// How shadows are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadows {
    /// Radius over which the shadow on hair is averaged, metres.
    pub hair_radius: f32,
    /// Radius over which the shadow of the body on itself is averaged, metres.
    pub body_radius: f32,
    /// How much of a light hair takes from the body behind it, per metre of distance, 1/m: small
    /// values fade the shadow in with the distance.
    pub body_absorption: f32,
    /// How far a surface is lifted towards the light before it is compared, metres.
    pub bias: f32,
}

impl Default for Shadows {
    fn default() -> Self {
        Self { hair_radius: 0.003, body_radius: 0.004, body_absorption: 240.0, bias: 0.0015 }
    }
}

/// A sphere, metres: what the shadow maps cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// World space.
    pub center: Vec3,
    /// Of everything that casts or receives a shadow on hair. Keep it constant while things
    /// move, so that the shadows' texels do not change their size.
    pub radius: f32,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { center: Vec3::new(0.0, 1.5, 0.0), radius: 0.3 }
    }
}

impl Sphere {
    /// The sphere around a box.
    pub fn around(lo: Vec3, hi: Vec3) -> Self {
        Self { center: 0.5 * (lo + hi), radius: 0.5 * lo.distance(hi) }
    }
}

/// What the shaders know of [`Lights`] and [`Shadows`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightsUniform {
    /// World to the clip space of each shadow map; depth 0 is nearest the light.
    pub shadow: [Mat4; SHADOW_LAYERS as usize],
    /// Towards the key light.
    pub key_direction: Vec3,
    /// Depth of the shadow maps, metres.
    pub range: f32,
    /// Irradiance of the key light.
    pub key_irradiance: Vec3,
    /// Twice [`Sphere::radius`], the width of a shadow map, metres.
    pub width: f32,
    /// Towards the rim light.
    pub rim_direction: Vec3,
    /// [`Shadows::hair_radius`].
    pub hair_radius: f32,
    /// Irradiance of the rim light.
    pub rim_irradiance: Vec3,
    /// [`Shadows::body_radius`].
    pub body_radius: f32,
    /// [`Sky::zenith`].
    pub zenith: Vec3,
    /// [`Shadows::bias`].
    pub bias: f32,
    /// [`Sky::horizon`].
    pub horizon: Vec3,
    /// Texels along each edge of a map.
    pub resolution: u32,
    /// [`Sky::ground`].
    pub ground: Vec3,
    /// [`Shadows::body_absorption`].
    pub body_absorption: f32,
}

impl Lights {
    /// With maps of `resolution`² texels that cover `focus`.
    pub(crate) fn uniform(&self, shadows: &Shadows, focus: &Sphere, resolution: u32) -> LightsUniform {
        let directions = [self.key.direction, self.rim.direction, Vec3::Y];
        LightsUniform {
            shadow: directions.map(|direction| fit(direction, focus, resolution)),
            key_direction: self.key.direction.normalize_or(Vec3::Y),
            range: 2.0 * focus.radius,
            key_irradiance: self.key.irradiance,
            width: 2.0 * focus.radius,
            rim_direction: self.rim.direction.normalize_or(Vec3::Y),
            hair_radius: shadows.hair_radius,
            rim_irradiance: self.rim.irradiance,
            body_radius: shadows.body_radius,
            zenith: self.sky.zenith,
            bias: shadows.bias,
            horizon: self.sky.horizon,
            resolution,
            ground: self.sky.ground,
            body_absorption: shadows.body_absorption,
        }
    }
}

/// World to clip space of a shadow map that looks against `direction` at `focus`. The map moves
/// with the focus in whole texels, so that shadows do not crawl.
fn fit(direction: Vec3, focus: &Sphere, resolution: u32) -> Mat4 {
    let z = direction.normalize_or(Vec3::Y);
    let x = (if z.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y }).cross(z).normalize();
    let y = z.cross(x);
    let radius = focus.radius.max(1e-6);
    let texel = 2.0 * radius / resolution as f32;
    let snap = |v: f32| (v / texel).round() * texel;
    let at = Vec3::new(snap(focus.center.dot(x)), snap(focus.center.dot(y)), snap(focus.center.dot(z)));
    // Rows of the transform: the axes scaled to -1..1; depth 0 at the light's end of the sphere.
    let row = |axis: Vec3, scale: f32, offset: f32| (axis * scale).extend(offset);
    Mat4::from_cols(
        row(x, 1.0 / radius, -at.x / radius),
        row(y, 1.0 / radius, -at.y / radius),
        row(z, -0.5 / radius, 0.5 + 0.5 * at.z / radius),
        glam::Vec4::W,
    )
    .transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_focus_fills_the_map() {
        let focus = Sphere { center: Vec3::new(0.3, 1.5, -0.2), radius: 0.25 };
        for direction in [Vec3::Y, Vec3::new(0.3, 0.5, 0.8), Vec3::NEG_Y] {
            let matrix = fit(direction, &focus, 1024);
            let unit = direction.normalize();
            let center = matrix.project_point3(focus.center);
            assert!((center - Vec3::new(0.0, 0.0, 0.5)).length() < 3e-3, "{center}");
            let near = matrix.project_point3(focus.center + unit * 0.25);
            assert!(near.z.abs() < 2e-3, "{near}");
        }
    }

    #[test]
    fn lights_stay_where_the_camera_sees_them() {
        let front = Lights::default();
        for azimuth in [0.6_f32, 1.5, 3.0] {
            let (right, back) =
                (Vec3::new(azimuth.cos(), 0.0, -azimuth.sin()), Vec3::new(azimuth.sin(), 0.0, azimuth.cos()));
            let lights = Lights::around(azimuth);
            for (seen, first) in [(lights.key, front.key), (lights.rim, front.rim)] {
                let (seen, first) = (seen.direction, first.direction);
                assert!((seen.length() - 1.0).abs() < 1e-5);
                let at = Vec3::new(seen.dot(right), seen.y, seen.dot(back));
                assert!((at - first).length() < 1e-5, "{at} {first}");
            }
        }
    }

    #[test]
    fn the_map_moves_in_whole_texels() {
        let at = |x: f32| {
            let focus = Sphere { center: Vec3::new(x, 1.5, 0.0), radius: 0.25 };
            fit(Vec3::new(0.2, 0.6, 0.7), &focus, 1024).project_point3(Vec3::ZERO).truncate() * 512.0
        };
        for i in 0..50 {
            let moved = at(0.0) - at(i as f32 * 1.3e-4);
            assert!((moved - moved.round()).length() < 0.02, "{moved}");
        }
    }
}
