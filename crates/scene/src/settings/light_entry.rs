//! An entry of the list of lights.

use tresses::{
    glam::{Quat, Vec3},
    light::{Light, LightShape},
    low_level,
};

/// Shape of a [`LightEntry`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightKind {
    /// A light at infinity, given by its direction.
    #[default]
    Distant,
    /// A point.
    Point,
    /// A point that emits into a cone.
    Spot,
    /// A rectangle that emits from its front.
    Rectangle,
    /// A disc, or a ring, that emits from its front.
    Disc,
    /// A sphere.
    Sphere,
    /// A cylinder, such as a neon tube.
    Tube,
}

impl LightKind {
    /// All shapes, in display order.
    pub const ALL: [Self; 7] =
        [Self::Distant, Self::Point, Self::Spot, Self::Rectangle, Self::Disc, Self::Sphere, Self::Tube];

    /// Returns the name in presets and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Distant => "distant",
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Rectangle => "rectangle",
            Self::Disc => "disc",
            Self::Sphere => "sphere",
            Self::Tube => "tube",
        }
    }

    /// Whether the light shines at a target.
    pub const fn is_aimed(self) -> bool {
        matches!(self, Self::Spot | Self::Rectangle | Self::Disc)
    }
}

/// A light of the list, fixed in the world. Each shape uses some of the fields; the table
/// [`light_list`](crate::knobs::light_list) has their keys, units and ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct LightEntry {
    /// Name, for people; may be empty.
    pub name: String,
    /// Shape.
    pub kind: LightKind,
    /// Whether it emits light.
    pub is_on: bool,
    /// Direction that a distant light comes from, radians: front (0), the head's left (π/2), back (π).
    pub azimuth: f32,
    /// Elevation of a distant light above the horizon, radians.
    pub elevation: f32,
    /// Position of the center, meters.
    pub position: Vec3,
    /// Point at which it shines, meters.
    pub target: Vec3,
    /// Both ends of a tube, meters.
    pub ends: [Vec3; 2],
    /// Angle between the axis of a spot light and the edge of full light, radians.
    pub inner: f32,
    /// Angle between the axis of a spot light and the end of its cone, radians.
    pub outer: f32,
    /// Width of a rectangle, meters.
    pub width: f32,
    /// Height of a rectangle, meters.
    pub height: f32,
    /// Rotation of a rectangle about its axis, radians, counterclockwise as seen from its front.
    pub roll: f32,
    /// Radius of a disc, a sphere or a tube, meters.
    pub radius: f32,
    /// Radius of the hole in a ring, meters; 0 for a disc.
    pub hole: f32,
    /// Color in sRGB.
    pub color: [u8; 3],
    /// Irradiance of a distant light, intensity of a point or spot light (irradiance at one meter), and radiance of all
    /// others. The key light has an irradiance of about 5.
    pub intensity: f32,
    /// Distance at which the light ends, meters; infinite by default.
    pub range: f32,
    /// Whether its shadows fall on bodies. Hair always lies in the shadow of hair and bodies.
    pub casts_shadows: bool,
}

impl Default for LightEntry {
    /// A distant light.
    fn default() -> Self {
        Self::new(LightKind::Distant)
    }
}

impl LightEntry {
    /// Creates a white light at the origin.
    pub fn new(kind: LightKind) -> Self {
        Self {
            name: String::new(),
            kind,
            is_on: true,
            azimuth: 90f32.to_radians(),
            elevation: 30f32.to_radians(),
            position: Vec3::ZERO,
            target: Vec3::ZERO,
            ends: [Vec3::ZERO; 2],
            inner: 20f32.to_radians(),
            outer: 30f32.to_radians(),
            width: 0.3,
            height: 0.3,
            roll: 0.0,
            radius: 0.1,
            hole: 0.0,
            color: [255; 3],
            intensity: match kind {
                LightKind::Distant => 2.0,
                LightKind::Point | LightKind::Spot => 1.0,
                _ => 10.0,
            },
            range: f32::INFINITY,
            casts_shadows: true,
        }
    }

    /// Creates a distant light. Angles are in radians.
    pub fn distant(azimuth: f32, elevation: f32, irradiance: f32) -> Self {
        Self { azimuth, elevation, intensity: irradiance, ..Self::new(LightKind::Distant) }
    }

    /// Returns the center, meters; `None` for a distant light.
    pub fn center(&self) -> Option<Vec3> {
        match self.kind {
            LightKind::Distant => None,
            LightKind::Tube => Some(0.5 * (self.ends[0] + self.ends[1])),
            _ => Some(self.position),
        }
    }

    /// Moves the light by `offset`, meters. It continues to shine at its target.
    pub fn move_by(&mut self, offset: Vec3) {
        self.position += offset;
        self.ends.iter_mut().for_each(|end| *end += offset);
    }

    /// Returns the direction towards a distant light.
    pub fn direction(&self) -> Vec3 {
        let (sin, cos) = self.azimuth.sin_cos();
        let (up, level) = self.elevation.sin_cos();
        Vec3::new(sin * level, up, cos * level)
    }

    /// Returns the library's light with this `id`.
    pub fn light(&self, id: u32) -> Light {
        let (position, radius) = (self.position, self.radius);
        let axis = (self.target - position).normalize_or(Vec3::NEG_Y);
        let shape = match self.kind {
            LightKind::Distant => LightShape::Distant { direction: self.direction() },
            LightKind::Point => LightShape::Point { position },
            LightKind::Spot => {
                LightShape::Spot { position, direction: axis, inner: self.inner, outer: self.outer }
            }
            LightKind::Rectangle => {
                let level = Vec3::Y.cross(axis).normalize_or(Vec3::X);
                let right = Quat::from_axis_angle(axis, self.roll) * level;
                let up = axis.cross(right);
                LightShape::Rectangle {
                    center: position,
                    right: 0.5 * self.width * right,
                    up: 0.5 * self.height * up,
                }
            }
            LightKind::Disc => {
                LightShape::Disc { center: position, direction: axis, radius, hole: self.hole }
            }
            LightKind::Sphere => LightShape::Sphere { center: position, radius },
            LightKind::Tube => LightShape::Tube { ends: self.ends, radius },
        };
        let [r, g, b] = self.color;
        Light {
            color: low_level::srgb(u32::from_be_bytes([0, r, g, b])),
            range: self.range,
            casts_shadows: self.casts_shadows,
            ..Light::new(shape, if self.is_on { self.intensity } else { 0.0 }).with_id(id)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuth_and_elevation_set_the_direction() {
        let left = LightEntry::distant(90f32.to_radians(), 0.0, 2.0).light(7);
        let (direction, irradiance) = left.irradiance_at(Vec3::ZERO);
        assert!((direction - Vec3::X).length() < 1e-6, "the head's left is +X");
        assert!((irradiance - Vec3::splat(2.0)).length() < 1e-6 && left.id == 7, "{irradiance}");
    }

    #[test]
    fn aimed_lights_light_their_target() {
        let position = Vec3::new(0.4, 1.9, 0.5);
        let target = Vec3::new(0.0, 1.6, 0.0);
        for kind in LightKind::ALL.into_iter().filter(|kind| kind.is_aimed()) {
            let light = LightEntry { position, target, ..LightEntry::new(kind) };
            let at = |point: Vec3| light.light(0).irradiance_at(point).1.x;
            assert!(at(target) > 0.1, "{kind:?}: {}", at(target));
            let behind = position + (position - target);
            assert_eq!(at(behind), 0.0, "{kind:?} emits from its front");
        }
        // Straight down, where the horizontal edge has no usual direction.
        let above = LightEntry { position: Vec3::Y, ..LightEntry::new(LightKind::Rectangle) };
        assert!(above.light(0).irradiance_at(Vec3::ZERO).1.x > 0.1);
    }

    #[test]
    fn rectangle_has_its_width_and_rolls() {
        let level = LightEntry {
            position: Vec3::Z,
            width: 0.6,
            height: 0.2,
            ..LightEntry::new(LightKind::Rectangle)
        };
        let edges = |light: &LightEntry| match light.light(0).shape {
            LightShape::Rectangle { right, up, .. } => (right, up),
            shape => panic!("{shape:?}"),
        };
        let (right, up) = edges(&level);
        assert!(right.abs_diff_eq(Vec3::NEG_X * 0.3, 1e-6) && up.abs_diff_eq(Vec3::Y * 0.1, 1e-6));
        assert!(right.cross(up).z < 0.0, "its front faces the target");
        let rolled = LightEntry { roll: 90f32.to_radians(), ..level };
        assert!(edges(&rolled).0.abs_diff_eq(Vec3::Y * 0.3, 1e-6));
    }

    #[test]
    fn light_that_is_off_emits_nothing() {
        let off = LightEntry { is_on: false, ..LightEntry::new(LightKind::Point) };
        assert!(!off.light(0).is_on() && LightEntry::new(LightKind::Point).light(0).is_on());
    }

    #[test]
    fn moved_lights_keep_their_target() {
        let mut tube = LightEntry { ends: [Vec3::X, Vec3::Y], ..LightEntry::new(LightKind::Tube) };
        let center = tube.center().unwrap();
        tube.move_by(Vec3::Z);
        assert_eq!((tube.center(), tube.target), (Some(center + Vec3::Z), Vec3::ZERO));
        assert_eq!(LightEntry::default().center(), None);
    }
}
