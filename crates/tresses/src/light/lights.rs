//! Lights: a list, a sky and an environment, in linear units.

use super::{environment::Environment, light::Light, shadows::Shadows};
use crate::constants::MAX_LIGHTS;
use crate::{Camera, Result, renderer::ShadowMethod};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};

/// Radiance from the rest of the surroundings: three colors, blended by elevation. Black by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sky {
    /// Radiance from straight above, linear.
    pub zenith: Vec3,
    /// Radiance from the horizon, linear.
    pub horizon: Vec3,
    /// Radiance from straight below, linear.
    pub ground: Vec3,
}

/// All lights of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Lights {
    /// Lights of any shape. Those that give the hair the most light get shadow maps.
    pub list: Vec<Light>,
    /// Light of the sky.
    pub sky: Sky,
    /// Light of an environment map, in addition to the sky.
    pub environment: Environment,
}

impl Default for Lights {
    /// Lights for a camera in front of the face: [`Lights::around`] 0.
    fn default() -> Self {
        Self::around(0.0)
    }
}

impl Lights {
    /// Index and id of the key light of [`around`](Self::around).
    pub const KEY: usize = 0;
    /// Index and id of the rim light of [`around`](Self::around), which outlines the hair from behind.
    pub const RIM: usize = 1;

    /// Creates a photographer's lights, which move with the camera: a warm key light from the camera's upper left, a
    /// cooler rim light from behind on its right, and a dim sky. `azimuth` is the angle of
    /// the camera around the head, radians, from in front of the face (+Z) towards the head's left (+X).
    pub fn around(azimuth: f32) -> Self {
        let rotation = glam::Quat::from_rotation_y(azimuth);
        let light = |id: usize, direction: Vec3, irradiance| {
            Light::distant(rotation * direction.normalize(), irradiance).with_id(id as u32)
        };
        Self {
            list: vec![
                light(Self::KEY, Vec3::new(-0.42, 0.62, 0.66), Vec3::new(5.6, 5.3, 4.85)),
                light(Self::RIM, Vec3::new(0.85, 0.28, -0.45), Vec3::new(3.1, 3.25, 3.5)),
            ],
            sky: Sky {
                zenith: Vec3::new(0.30, 0.31, 0.33),
                horizon: Vec3::new(0.24, 0.24, 0.25),
                ground: Vec3::new(0.13, 0.12, 0.11),
            },
            environment: Environment::default(),
        }
    }

    /// The lights that are on.
    pub fn active(&self) -> impl Iterator<Item = &Light> {
        self.list.iter().filter(|light| light.is_on())
    }

    /// Checks all lights.
    ///
    /// # Errors
    /// As [`Light::check`].
    pub fn check(&self) -> Result<()> {
        self.list.iter().try_for_each(Light::check)
    }
}

/// A sphere, meters: the region that shadow maps cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Center in world space.
    pub center: Vec3,
    /// Radius that encloses everything that casts or receives shadows on hair. Keep it constant while things move, so
    /// that the texels of the shadow maps keep their size.
    pub radius: f32,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { center: Vec3::new(0.0, 1.5, 0.0), radius: 0.3 }
    }
}

impl Sphere {
    /// Returns the sphere around a box.
    pub fn around(lo: Vec3, hi: Vec3) -> Self {
        Self { center: 0.5 * (lo + hi), radius: 0.5 * lo.distance(hi) }
    }

    /// Returns the diameter in pixels of `camera`, measured at the near side of the sphere.
    pub(crate) fn pixels(&self, camera: &Camera) -> f32 {
        let clip = camera.projection * camera.view;
        let away = (clip * self.center.extend(1.0)).w;
        let per_meter = camera.projection.z_axis.w.abs();
        let nearest = if per_meter > 0.0 { (away - self.radius * per_meter).max(0.05) } else { away };
        2.0 * self.radius / (camera.pixel() * nearest)
    }
}

impl Lights {
    /// Returns the lights that get shadow maps around `focus`, in the order of the list: those with the most irradiance
    /// there.
    pub(crate) fn chosen(&self, focus: &Sphere) -> Vec<Light> {
        let mut strengths: Vec<_> = self
            .list
            .iter()
            .enumerate()
            .map(|(i, light)| (light.irradiance_at(focus.center).1.element_sum(), i))
            .filter(|(strength, _)| *strength > 0.0)
            .collect();
        strengths.sort_by(|a, b| b.0.total_cmp(&a.0));
        strengths.truncate(MAX_LIGHTS as usize);
        strengths.sort_by_key(|(_, i)| *i);
        strengths.into_iter().map(|(_, i)| self.list[i]).collect()
    }
}

/// See [`crate::constants::SHADOW_MAPS`].
pub const SHADOW_MAPS: usize = crate::constants::SHADOW_MAPS as usize;

/// Shader data of a light with a shadow map.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightUniform {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// [`Light::id`].
    pub id: u32,
    /// Irradiance of a surface that faces the light.
    pub irradiance: Vec3,
    /// Whether its shadows fall on meshes and on the host's scene.
    pub casts_shadows: u32,
}

/// Shader data of [`Lights`] and [`Shadows`]. Shaders never pass it by value, because a driver may not optimize away
/// the copy of its arrays.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightsUniform {
    /// World to clip space of each shadow map: one per light, then the sky. Depth 0 is nearest the light.
    pub shadow: [Mat4; SHADOW_MAPS],
    /// Lights with a shadow map. Light `i` has map `i`.
    pub mapped: [LightUniform; MAX_LIGHTS as usize],
    /// [`Sky::zenith`].
    pub zenith: Vec3,
    /// Number of lights with a shadow map.
    pub count: u32,
    /// [`Sky::horizon`].
    pub horizon: Vec3,
    /// Texels along each edge of a depth map.
    pub resolution: u32,
    /// [`Sky::ground`].
    pub ground: Vec3,
    /// Edge of a texel of the hair maps, in texels of the depth maps.
    pub hair_texels: u32,
    /// Depth of the shadow maps, meters.
    pub range: f32,
    /// Width of a shadow map, meters: twice [`Sphere::radius`], plus a margin.
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
    /// [`ShadowMethod`] as a number.
    pub method: u32,
    /// Texels along each edge of a strand map; 0 for none.
    pub strand_map: u32,
    /// Cells along an edge of [`super::Ambient`]; 0 where sky visibility is estimated.
    pub ambient: u32,
    /// Number of shadow maps: one per light, and one for the sky where its visibility is estimated.
    pub maps: u32,
    /// [`Shadows::strand_by_strand`].
    pub strand_by_strand: f32,
    /// [`Environment::coefficients`].
    pub environment: [Vec4; 9],
    /// Corner of the ambient light grid with the smallest coordinates, meters.
    pub ambient_origin: Vec3,
    /// One over the edge of the ambient light grid, 1/m.
    pub ambient_scale: f32,
    /// Fraction of the light that a fiber passes on, averaged over inclinations and over the strand's length.
    pub passes: Vec3,
    /// Fraction of the passed-on light that hits other hair or skin.
    pub forward: f32,
    /// Number of the [zone](super::Zone) that this light belongs to, from 1; 0 if the view has no zones.
    pub zone: u32,
    /// Stride through the sample points of mesh surfaces.
    pub every: u32,
    /// Unused.
    pub _pad: u32,
    /// Unused.
    pub _pad_2: u32,
}

impl Lights {
    /// Returns the shader data of the `chosen` lights, for maps of `resolution`² texels that cover `focus`.
    pub(crate) fn uniform(
        &self,
        chosen: &[Light],
        (shadows, method): (&Shadows, ShadowMethod),
        focus: &Sphere,
        resolution: u32,
    ) -> LightsUniform {
        // Maps move in steps. The margin of one step keeps the focus inside.
        let step = shadows.hair_texels(method, 2.0 * focus.radius.max(1e-6) / resolution as f32);
        let radius =
            focus.radius.max(1e-6) * resolution as f32 / resolution.saturating_sub(step).max(1) as f32;
        let focus = &Sphere { radius, ..*focus };
        let texel = 2.0 * radius / resolution as f32;
        let fit = |direction| fit(direction, focus, step as f32 * texel);
        let mut shadow = [fit(Vec3::Y); SHADOW_MAPS];
        let mut mapped = [LightUniform::zeroed(); MAX_LIGHTS as usize];
        let count = chosen.len();
        for (i, light) in chosen.iter().enumerate() {
            let (direction, irradiance) = light.irradiance_at(focus.center);
            shadow[i] = fit(direction);
            mapped[i].direction = direction;
            mapped[i].irradiance = irradiance;
            mapped[i].id = light.id;
            mapped[i].casts_shadows = light.casts_shadows.into();
        }
        LightsUniform {
            shadow,
            mapped,
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
            method: method as u32,
            strand_map: 0,
            ambient: 0,
            maps: shadows.map_count(count) as u32,
            strand_by_strand: if shadows.is_enabled { shadows.strand_by_strand.clamp(0.0, 1.0) } else { 0.0 },
            environment: self.environment.coefficients.map(|c| c.extend(0.0)),
            ambient_origin: focus.center - focus.radius,
            ambient_scale: 0.5 / focus.radius,
            passes: Vec3::ZERO,
            forward: 0.0,
            zone: 0,
            every: 1,
            _pad: 0,
            _pad_2: 0,
        }
    }
}

/// Returns the world to clip space transform of the shadow map of a light in `direction`, around `focus`. The map moves
/// with the focus in steps of `step` meters, so that shadows do not crawl.
fn fit(direction: Vec3, focus: &Sphere, step: f32) -> Mat4 {
    let z = direction.normalize_or(Vec3::Y);
    let x = (if z.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y }).cross(z).normalize();
    let y = z.cross(x);
    let radius = focus.radius.max(1e-6);
    let snap = |v: f32| (v / step).round() * step;
    let at = Vec3::new(snap(focus.center.dot(x)), snap(focus.center.dot(y)), focus.center.dot(z));
    // Rows of the transform: the axes scaled to -1..1, and depth 0 at the sphere's end towards the light.
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
    fn shadow_map_fits_the_focus() {
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
    fn lights_move_with_the_camera() {
        let front = Lights::default();
        for azimuth in [0.6_f32, 1.5, 3.0] {
            let (right, back) =
                (Vec3::new(azimuth.cos(), 0.0, -azimuth.sin()), Vec3::new(azimuth.sin(), 0.0, azimuth.cos()));
            let lights = Lights::around(azimuth);
            for (seen, first) in lights.active().zip(front.active()) {
                let [seen, first] = [seen, first].map(|light| light.irradiance_at(Vec3::ZERO).0);
                assert!((seen.length() - 1.0).abs() < 1e-5);
                let at = Vec3::new(seen.dot(right), seen.y, seen.dot(back));
                assert!((at - first).length() < 1e-5, "{at} {first}");
            }
        }
    }

    #[test]
    fn shadow_map_moves_in_whole_texels() {
        // Along z the map may move freely, since depth has no texels.
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
