//! The lights: up to four directional lights and a sky, in linear units.

use super::{
    environment::Environment,
    shadows::{ShadowMethod, Shadows},
};
use crate::Camera;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

/// A light so far away that its rays are parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Irradiance on a plane that faces the light, linear; 0 switches the light off.
    pub irradiance: Vec3,
}

impl Directional {
    /// No light.
    pub const OFF: Self = Self { direction: Vec3::Y, irradiance: Vec3::ZERO };

    /// Of a lamp at `at`, metres, as it arrives at `place`, where hair is: its `intensity` (radiance times square metres)
    /// falls with the square of the distance, below a centimetre no more.
    pub fn from_point(at: Vec3, intensity: Vec3, place: Vec3) -> Self {
        const LEAST: f32 = 1e-4;
        let way = at - place;
        Self { direction: way.normalize_or(Vec3::Y), irradiance: intensity / way.length_squared().max(LEAST) }
    }

    /// Of a flat lamp, a polygon with these `corners` (metres) in their order, each point of whose front sends `radiance`
    /// to all sides, as it arrives at `place`: its direction is the mean of all of it, its irradiance what a surface that
    /// faces there receives of a polygon that is wholly before it (Lambert's formula, 1760). From where its corners go
    /// round clockwise there is no light: that is its back.
    pub fn from_polygon(corners: &[Vec3], radiance: Vec3, place: Vec3) -> Self {
        let edge = |i: usize| {
            let [a, b] = [i, (i + 1) % corners.len()].map(|i| corners[i] - place);
            let across = a.cross(b);
            // The angle by its tangent, which is exact also where it is small.
            0.5 * across.length().atan2(a.dot(b)) * across.normalize_or_zero()
        };
        let arrives: Vec3 = (0..corners.len()).map(edge).sum();
        let middle = corners.iter().sum::<Vec3>() / corners.len().max(1) as f32 - place;
        // Seen counter-clockwise, the edges turn to the place. A place in the plane sees none of it, or is no number.
        let share = -arrives.length() * arrives.dot(middle).signum();
        if !(share > 1e-6 && share.is_finite()) {
            return Self::OFF;
        }
        Self { direction: -arrives.normalize_or(Vec3::Y), irradiance: share * radiance }
    }

    /// Whether any light comes of it.
    pub fn is_on(&self) -> bool {
        self.irradiance.max_element() > 0.0
    }
}

/// The radiance that comes from everywhere else: three colours, blended by elevation. Black by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sky {
    /// From straight above, linear radiance.
    pub zenith: Vec3,
    /// From the horizon.
    pub horizon: Vec3,
    /// From straight below.
    pub ground: Vec3,
}

/// The most directional lights of a scene.
pub const MAX_LIGHTS: usize = crate::constants::MAX_LIGHTS as usize;

/// All light in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lights {
    /// Directional lights, each with a shadow. One without irradiance is off and costs nothing.
    pub directional: [Directional; MAX_LIGHTS],
    /// The rest.
    pub sky: Sky,
    /// Light from everywhere beside the sky's: a picture of the surroundings.
    pub environment: Environment,
}

impl Default for Lights {
    /// For a camera in front of the face: [`Lights::around`] 0.
    fn default() -> Self {
        Self::around(0.0)
    }
}

impl Lights {
    /// The main light of [`around`](Self::around), from the upper side.
    pub const KEY: usize = 0;
    /// The light of [`around`](Self::around) from behind, which traces the outline.
    pub const RIM: usize = 1;

    /// A photographer's lights, which move with the camera: a warm key light from its upper left,
    /// a cooler rim light from behind on its right, a quiet sky; the others are off. `azimuth` is the
    /// camera's turn about the head, radians, from before the face (+Z) towards the head's left (+X).
    pub fn around(azimuth: f32) -> Self {
        let turn = glam::Quat::from_rotation_y(azimuth);
        let mut directional = [Directional::OFF; MAX_LIGHTS];
        directional[Self::KEY] = Directional {
            direction: turn * Vec3::new(-0.42, 0.62, 0.66).normalize(),
            irradiance: Vec3::new(5.6, 5.3, 4.85),
        };
        directional[Self::RIM] = Directional {
            direction: turn * Vec3::new(0.85, 0.28, -0.45).normalize(),
            irradiance: Vec3::new(3.1, 3.25, 3.5),
        };
        Self {
            directional,
            sky: Sky {
                zenith: Vec3::new(0.30, 0.31, 0.33),
                horizon: Vec3::new(0.24, 0.24, 0.25),
                ground: Vec3::new(0.13, 0.12, 0.11),
            },
            environment: Environment::default(),
        }
    }

    /// The lights that are on.
    pub fn active(&self) -> impl Iterator<Item = &Directional> {
        self.directional.iter().filter(|light| light.is_on())
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

    /// How many pixels of `camera` it is across, by those at its near side.
    pub(crate) fn pixels(&self, camera: &Camera) -> f32 {
        let clip = camera.projection * camera.view;
        let away = (clip * self.center.extend(1.0)).w;
        let per_metre = camera.projection.z_axis.w.abs();
        let nearest = if per_metre > 0.0 { (away - self.radius * per_metre).max(0.05) } else { away };
        2.0 * self.radius / (camera.pixel() * nearest)
    }
}

/// See [`crate::constants::SHADOW_MAPS`].
pub const SHADOW_MAPS: usize = crate::constants::SHADOW_MAPS as usize;

/// What the shaders know of a light that is on.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightUniform {
    /// Towards the light.
    pub direction: Vec3,
    /// Unused.
    pub _pad_a: u32,
    /// [`Directional::irradiance`].
    pub irradiance: Vec3,
    /// Unused.
    pub _pad_b: u32,
}

/// What the shaders know of [`Lights`] and [`Shadows`]. Shaders never pass it by value: a copy of its arrays is memory
/// that a driver may not get rid of.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightsUniform {
    /// World to the clip space of each shadow map, the sky's behind those of the lights; depth 0 is nearest the light.
    pub shadow: [Mat4; SHADOW_MAPS],
    /// The lights that are on; light `i` has the map `i`.
    pub directional: [LightUniform; MAX_LIGHTS],
    /// [`Sky::zenith`].
    pub zenith: Vec3,
    /// How many lights are on.
    pub count: u32,
    /// [`Sky::horizon`].
    pub horizon: Vec3,
    /// Texels along each edge of a map.
    pub resolution: u32,
    /// [`Sky::ground`].
    pub ground: Vec3,
    /// Texels of a map along the edge of a texel of the hair's.
    pub hair_texels: u32,
    /// Depth of the shadow maps, metres.
    pub range: f32,
    /// Twice [`Sphere::radius`], the width of a shadow map, metres.
    pub width: f32,
    /// [`Shadows::hair_radius`].
    pub hair_radius: f32,
    /// [`Shadows::body_radius`].
    pub body_radius: f32,
    /// [`Shadows::bias`].
    pub bias: f32,
    /// [`Shadows::density`].
    pub density: f32,
    /// [`Shadows::body_opacity`].
    pub body_opacity: f32,
    /// [`ShadowMethod`] by its place.
    pub method: u32,
    /// [`Shadows::per_pixel`].
    pub per_pixel: u32,
    /// Cells along an edge of [`super::Ambient`]; 0 where the sky's openness is guessed.
    pub ambient: u32,
    /// How many shadow maps are drawn: one per light, and one for the sky where its openness is guessed.
    pub maps: u32,
    /// [`Shadows::strand_by_strand`].
    pub strand_by_strand: f32,
    /// [`Environment::coefficients`].
    pub environment: [Vec4; 9],
    /// The corner of the cells at the least coordinates, metres.
    pub ambient_origin: Vec3,
    /// One over the length of an edge of all cells, 1/m.
    pub ambient_scale: f32,
    /// The share of what meets a fibre that it passes on, the mean over its inclinations and its length.
    pub passes: Vec3,
    /// The share of what is passed on that meets other hair or skin.
    pub forward: f32,
    /// The number of the [zone](super::Zone) whose light it is, from 1; 0 where a view has no zones.
    pub zone: u32,
    /// Every so many points of a body's surface stand for all of them.
    pub every: u32,
    /// Texels along each edge of a map that knows the strand nearest each light; 0 for none.
    pub strand_map: u32,
    /// Unused.
    pub _pad: u32,
}

impl Lights {
    /// With maps of `resolution`² texels that cover `focus`.
    pub(crate) fn uniform(&self, shadows: &Shadows, focus: &Sphere, resolution: u32) -> LightsUniform {
        // Maps move in steps; a step's room keeps the focus inside.
        let step = shadows.hair_texels(2.0 * focus.radius.max(1e-6) / resolution as f32);
        let radius =
            focus.radius.max(1e-6) * resolution as f32 / resolution.saturating_sub(step).max(1) as f32;
        let focus = &Sphere { radius, ..*focus };
        let texel = 2.0 * radius / resolution as f32;
        let fit = |direction| fit(direction, focus, step as f32 * texel);
        let mut shadow = [fit(Vec3::Y); SHADOW_MAPS];
        let mut directional = [LightUniform::zeroed(); MAX_LIGHTS];
        let count = self.active().count();
        for (i, light) in self.active().enumerate() {
            shadow[i] = fit(light.direction);
            directional[i].direction = light.direction.normalize_or(Vec3::Y);
            directional[i].irradiance = light.irradiance;
        }
        LightsUniform {
            shadow,
            directional,
            count: count as u32,
            zenith: self.sky.zenith,
            horizon: self.sky.horizon,
            ground: self.sky.ground,
            resolution,
            hair_texels: step,
            range: 2.0 * focus.radius,
            width: 2.0 * focus.radius,
            hair_radius: shadows.hair_radius,
            body_radius: shadows.body_radius,
            bias: shadows.bias,
            density: shadows.density.max(0.0),
            body_opacity: shadows.body_opacity.max(0.0),
            // Maps with nothing in them let all light through; deep ones find that out soonest.
            method: match shadows.method {
                ShadowMethod::Off => ShadowMethod::DeepOpacity as u32,
                method => method as u32,
            },
            per_pixel: u32::from(shadows.per_pixel),
            ambient: 0,
            maps: shadows.maps(count) as u32,
            strand_by_strand: if shadows.method == ShadowMethod::Off {
                0.0
            } else {
                shadows.strand_by_strand.clamp(0.0, 1.0)
            },
            environment: self.environment.coefficients.map(|c| c.extend(0.0)),
            ambient_origin: focus.center - focus.radius,
            ambient_scale: 0.5 / focus.radius,
            passes: Vec3::ZERO,
            forward: 0.0,
            zone: 0,
            every: 1,
            strand_map: 0,
            _pad: 0,
        }
    }
}

/// World to clip space of a shadow map that looks against `direction` at `focus`. The map moves
/// with the focus in steps of `step` metres, so that shadows do not crawl.
fn fit(direction: Vec3, focus: &Sphere, step: f32) -> Mat4 {
    let z = direction.normalize_or(Vec3::Y);
    let x = (if z.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y }).cross(z).normalize();
    let y = z.cross(x);
    let radius = focus.radius.max(1e-6);
    let snap = |v: f32| (v / step).round() * step;
    let at = Vec3::new(snap(focus.center.dot(x)), snap(focus.center.dot(y)), focus.center.dot(z));
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
            let matrix = fit(direction, &focus, 0.5 / 1024.0);
            let unit = direction.normalize();
            let center = matrix.project_point3(focus.center);
            assert!((center - Vec3::new(0.0, 0.0, 0.5)).length() < 3e-3, "{center}");
            let near = matrix.project_point3(focus.center + unit * 0.25);
            assert!(near.z.abs() < 2e-3, "{near}");
        }
    }

    #[test]
    fn lamps_arrive_as_parallel_light() {
        let point = Directional::from_point(Vec3::Y * 3.0, Vec3::splat(18.0), Vec3::Y);
        assert_eq!((point.direction, point.irradiance), (Vec3::Y, Vec3::splat(4.5)));
        // A square above the place, its front below: from there its corners go round counter-clockwise.
        let square = |half: f32, y: f32| {
            [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
                .map(|[x, z]| Vec3::new(half * x, y, half * z))
        };
        let of = |corners: &[Vec3], place| Directional::from_polygon(corners, Vec3::ONE, place);
        let near = |found: f32, expected: f32| (found / expected - 1.0).abs() < 2e-3;
        // Small, it is a point of its area, by the cosine; of a plane without end as much arrives as of a sky.
        let below = of(&square(0.01, 2.0), Vec3::ZERO);
        assert!(below.direction.dot(Vec3::Y) > 0.999 && near(below.irradiance.x, 4e-4 / 4.0), "{below:?}");
        let aside = of(&square(0.01, 2.0), Vec3::X * 2.0);
        assert!(near(aside.irradiance.x, 4e-4 / 8.0 * 0.5_f32.sqrt()), "{aside:?}");
        assert!(near(of(&square(1e4, 2.0), Vec3::ZERO).irradiance.x, std::f32::consts::PI));
        // A disc of many corners over its middle: pi r² / (r² + d²).
        let disc: Vec<_> = (0..256)
            .map(|i| (std::f32::consts::TAU * i as f32 / 256.0).sin_cos())
            .map(|(s, c)| Vec3::new(1.5 * s, 2.0, 1.5 * c))
            .rev()
            .collect();
        let expected = std::f32::consts::PI * 2.25 / 6.25;
        assert!(near(of(&disc, Vec3::ZERO).irradiance.x, expected), "{:?} {expected}", of(&disc, Vec3::ZERO));
        // Behind it, in its plane, of too few corners, and where something is no number there is no light.
        let off = [
            of(&square(1.0, 2.0), Vec3::Y * 3.0),
            of(&square(1.0, 2.0), Vec3::new(5.0, 2.0, 0.0)),
            of(&square(1.0, 2.0)[..2], Vec3::ZERO),
            of(&[], Vec3::ZERO),
            of(&square(1.0, 2.0), Vec3::NAN),
        ];
        assert!(off.iter().all(|light| !light.is_on()), "{off:?}");
    }

    #[test]
    fn lights_stay_where_the_camera_sees_them() {
        let front = Lights::default();
        for azimuth in [0.6_f32, 1.5, 3.0] {
            let (right, back) =
                (Vec3::new(azimuth.cos(), 0.0, -azimuth.sin()), Vec3::new(azimuth.sin(), 0.0, azimuth.cos()));
            let lights = Lights::around(azimuth);
            for (seen, first) in lights.active().zip(front.active()) {
                let (seen, first) = (seen.direction, first.direction);
                assert!((seen.length() - 1.0).abs() < 1e-5);
                let at = Vec3::new(seen.dot(right), seen.y, seen.dot(back));
                assert!((at - first).length() < 1e-5, "{at} {first}");
            }
        }
    }

    #[test]
    fn the_map_moves_in_whole_texels() {
        // Along z the map may move freely: depth is not made of texels.
        let at = |x: f32| {
            let focus = Sphere { center: Vec3::new(x, 1.5, 0.0), radius: 0.25 };
            fit(Vec3::new(0.2, 0.6, 0.7), &focus, 0.5 / 1024.0).project_point3(Vec3::ZERO).truncate() * 512.0
        };
        for i in 0..50 {
            let moved = at(0.0) - at(i as f32 * 1.3e-4);
            assert!((moved - moved.round()).length() < 0.02, "{moved}");
        }
    }
}
