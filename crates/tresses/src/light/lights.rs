//! Lights: a list, a sky and an environment, in linear units.

use super::{
    environment::Environment,
    light::{Light, LightShape, cone},
    map_view::MapView,
    shadows::Shadows,
    sphere::Sphere,
};
use crate::constants::{MAX_LIGHTS, MAX_MAP_VIEWS};
use crate::{Error, Result, renderer::ShadowMethod};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

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
    /// As [`Light::check`], and [`Error::Parameter`] when the sky or the environment is not finite.
    pub fn check(&self) -> Result<()> {
        self.list.iter().try_for_each(Light::check)?;
        let Sky { zenith, horizon, ground } = self.sky;
        let mut all = [zenith, horizon, ground].into_iter().chain(self.environment.coefficients);
        match all.find(|radiance| !radiance.is_finite()) {
            None => Ok(()),
            Some(radiance) => Err(Error::Parameter {
                name: "the radiance of the sky or the environment",
                value: radiance.to_string(),
                range: "finite",
            }),
        }
    }
}

/// Ratio of the irradiance of two lights from which on the stronger one has its shadow map alone. Below it, the shadow
/// map fades out, so that two lights of one strength can change places.
const ALONE: f32 = 1.25;
/// Maximum number of lights without a shadow map.
const MAX_UNMAPPED: usize = crate::constants::MAX_UNMAPPED_LIGHTS as usize;
/// Distance from the center of the focus at which lights are compared, in radii.
const ASIDE: f32 = 0.6;

/// Lights of a frame around a focus, each with the fraction of it that counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SelectedLights {
    /// Lights with shadow maps, in the order of the list.
    pub mapped: Vec<(Light, f32)>,
    /// Lights that the grid of ambient light propagates.
    pub unmapped: Vec<(Light, f32)>,
}

impl Lights {
    /// Selects the lights with the most irradiance around `focus`: at most `maps` of them get shadow maps. If
    /// `has_grid`, the others count as lights without one; otherwise they are left out.
    pub(crate) fn select(&self, focus: &Sphere, maps: usize, has_grid: bool) -> SelectedLights {
        let aside = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| ASIDE * focus.radius * axis);
        let places = [Vec3::ZERO].into_iter().chain(aside.into_iter().flat_map(|offset| [offset, -offset]));
        let places: Vec<_> = places.map(|offset| focus.center + offset).collect();
        let strength = |light: &Light| {
            let at = |place: &Vec3| light.irradiance_at(*place).1.element_sum();
            if light.center().is_some() {
                places.iter().map(at).fold(0.0, f32::max)
            } else {
                at(&focus.center)
            }
        };
        let strengths = self.list.iter().enumerate().map(|(i, light)| (strength(light), i));
        let mut strengths: Vec<_> = strengths.filter(|(strength, _)| *strength > 0.0).collect();
        // The order of equal lights is that of the list.
        strengths.sort_by(|a, b| b.0.total_cmp(&a.0));
        strengths.truncate(maps + MAX_UNMAPPED);
        let limit = strengths.get(maps).map_or(0.0, |(strength, _)| *strength);
        let mut selected = SelectedLights::default();
        let mut mapped = Vec::new();
        for (rank, (strength, i)) in strengths.into_iter().enumerate() {
            let share = match rank < maps {
                true if limit > 0.0 && has_grid => ((strength / limit - 1.0) / (ALONE - 1.0)).clamp(0.0, 1.0),
                true => 1.0,
                false => 0.0,
            };
            if share > 0.0 {
                mapped.push((i, share));
            }
            if share < 1.0 && has_grid {
                selected.unmapped.push((self.list[i], 1.0 - share));
            }
        }
        mapped.sort_by_key(|(i, _)| *i);
        selected.mapped = mapped.into_iter().map(|(i, share)| (self.list[i], share)).collect();
        selected
    }
}

/// Shader data of a [`Light`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LightUniform {
    /// Unit vector towards a distant light; center of the others, meters.
    pub place: Vec3,
    /// Number of the [`LightShape`], as in `light.wesl`.
    pub shape: u32,
    /// Irradiance, intensity or radiance.
    pub strength: Vec3,
    /// One over the square of [`Light::range`], 1/m².
    pub inverse_square_range: f32,
    /// Axis of a spot light or of a disc (unit), half the width of a rectangle, half the axis of a tube.
    pub axis: Vec3,
    /// Scale of a spot light's falloff; radius of a disc, sphere or tube.
    pub first: f32,
    /// Half the height of a rectangle; a unit vector in the plane of a disc.
    pub up: Vec3,
    /// Offset of a spot light's falloff; radius of the hole of a disc.
    pub second: f32,
    /// [`Light::id`].
    pub id: u32,
    /// Whether its shadows fall on meshes and on the host's scene.
    pub casts_shadows: u32,
    /// First of its views into its shadow map.
    pub view: u32,
    /// Number of the views: one, or the six faces of a cube.
    pub view_count: u32,
}

impl LightUniform {
    /// Returns the shader data of `light`, of which the fraction `share` counts.
    pub fn new(light: &Light, share: f32) -> Self {
        let mut uniform = Self {
            place: light.center().unwrap_or(Vec3::Y),
            strength: if share == 1.0 { light.strength() } else { share * light.strength() },
            inverse_square_range: (light.range * light.range).recip(),
            id: light.id,
            casts_shadows: light.casts_shadows.into(),
            ..Self::zeroed()
        };
        match light.shape {
            LightShape::Distant { direction } => uniform.place = direction.normalize_or(Vec3::Y),
            LightShape::Point { .. } => uniform.shape = 1,
            LightShape::Spot { direction, inner, outer, .. } => {
                uniform.shape = 2;
                uniform.axis = direction.normalize_or_zero();
                [uniform.first, uniform.second] = cone(inner, outer);
            }
            LightShape::Rectangle { right, up, .. } => {
                (uniform.shape, uniform.axis, uniform.up) = (3, right, up);
            }
            LightShape::Disc { direction, radius, hole, .. } => {
                uniform.shape = 4;
                uniform.axis = direction.normalize_or(Vec3::Y);
                uniform.up = uniform.axis.any_orthonormal_vector();
                (uniform.first, uniform.second) = (radius, hole.min(radius));
            }
            LightShape::Sphere { radius, .. } => (uniform.shape, uniform.first) = (5, radius),
            LightShape::Tube { ends: [a, b], radius } => {
                (uniform.shape, uniform.axis, uniform.first) = (6, 0.5 * (b - a), radius);
            }
        }
        uniform
    }
}

/// Shader data of [`Lights`] and [`Shadows`]. Shaders never pass it by value, because a driver may not optimize away
/// the copy of its arrays.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightsUniform {
    /// Views into the shadow maps: those of each light, then the sky's.
    pub views: [MapView; MAX_MAP_VIEWS as usize],
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
    /// Number of views into shadow maps.
    pub view_count: u32,
    /// Number of lights without a shadow map.
    pub unmapped: u32,
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
    /// Returns the shader data of the `selected` lights, for maps of `resolution`² texels that cover `focus`.
    pub(crate) fn uniform(
        &self,
        selected: &SelectedLights,
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
        let step_meters = step as f32 * texel;
        let count = selected.mapped.len();
        let maps = shadows.map_count(count);
        let mut views = Vec::new();
        let mut mapped = [LightUniform::zeroed(); MAX_LIGHTS as usize];
        for (map, ((light, share), uniform)) in selected.mapped.iter().zip(&mut mapped).enumerate() {
            let own = MapView::of(light, focus, step_meters);
            let (view, view_count) = (views.len() as u32, own.len() as u32);
            *uniform = LightUniform { view, view_count, ..LightUniform::new(light, *share) };
            views.extend(own.into_iter().map(|view| MapView { map: map as u32, ..view }));
        }
        if maps > count {
            views.push(MapView { map: count as u32, ..MapView::parallel(Vec3::Y, focus, step_meters) });
        }
        let view_count = views.len() as u32;
        views.resize(MAX_MAP_VIEWS as usize, MapView::zeroed());
        LightsUniform {
            views: std::array::from_fn(|i| views[i]),
            view_count,
            unmapped: selected.unmapped.len() as u32,
            mapped,
            count: count as u32,
            zenith: self.sky.zenith,
            horizon: self.sky.horizon,
            ground: self.sky.ground,
            resolution,
            hair_texels: step,
            hair_radius: shadows.hair_radius,
            body_radius: shadows.body_radius,
            bias: shadows.bias,
            density: shadows.density.max(0.0),
            body_opacity: shadows.body_opacity.max(0.0),
            method: method as u32,
            strand_map: 0,
            ambient: 0,
            maps: maps as u32,
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
