//! Places of lights around the head: a new light, another shape in the same place, and motion by drags.

use crate::orbit::Orbit;
use tresses::glam::{Vec2, Vec3};
use tresses_scene::settings::{LightEntry, LightKind};

/// Irradiance of a new light at the middle of the head. The key light has about 5.
const IRRADIANCE: f32 = 4.0;
/// Distance of new lights from the middle of the subject, in radii of the subject.
const DISTANCE: f32 = 1.3;
/// Radius of the subject for which the sizes of [`LightEntry::new`] are, meters.
const USUAL_RADIUS: f32 = 0.35;
/// Positions are rounded to this length, meters.
const GRID: f32 = 0.001;
/// Directions are rounded to this angle, degrees.
const ANGLE_GRID: f32 = 0.1;

/// The subject of the lights, and the camera that sees it.
#[derive(Clone, Copy, Debug)]
pub struct LightStage {
    /// Middle of the subject, meters.
    pub center: Vec3,
    /// Radius of the subject, meters.
    pub radius: f32,
    /// Radius of the dome on which distant lights are shown, meters.
    pub dome: f32,
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

/// Drag of a handle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandleDrag {
    /// To the right and down, points.
    pub across: Vec2,
    /// Away from the camera, points.
    pub away: f32,
}

/// Part of a light that a drag moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LightPart {
    /// All of it, besides its target.
    Body,
    /// The point at which it shines.
    Target,
    /// An end of a tube.
    End(usize),
}

impl LightStage {
    /// Creates the stage for the subject and the camera of `orbit`.
    pub fn of(orbit: &Orbit) -> Self {
        let (lo, hi) = orbit.subject();
        let (right, up) = orbit.plane();
        let size = hi - lo;
        Self {
            center: 0.5 * (lo + hi),
            radius: 0.5 * size.length(),
            dome: 0.5 * size.max_element(),
            right,
            up,
            back: right.cross(up),
        }
    }

    /// Returns a light of `kind` in front of the upper left of the head, as the camera sees it.
    pub fn new_light(&self, kind: LightKind) -> LightEntry {
        let towards = (0.87 * self.back + 0.34 * self.up - 0.36 * self.right).normalize();
        let mut light = LightEntry::new(kind);
        self.place(&mut light, self.center + towards * DISTANCE * self.radius);
        let scale = self.radius / USUAL_RADIUS;
        light.radius = match kind {
            LightKind::Tube => 0.01,
            LightKind::Sphere => 0.03,
            _ => 0.1,
        };
        for length in [&mut light.width, &mut light.height, &mut light.radius] {
            *length = rounded((*length * scale).max(GRID));
        }
        self.set_irradiance(&mut light, IRRADIANCE);
        light
    }

    /// Returns a ring as [`new_light`](Self::new_light).
    pub fn new_ring(&self) -> LightEntry {
        let mut ring = self.new_light(LightKind::Disc);
        ring.hole = rounded(0.75 * ring.radius);
        self.set_irradiance(&mut ring, IRRADIANCE);
        ring
    }

    /// Returns `light` with another shape in the same place, which gives the head as much light.
    pub fn reshaped(&self, light: &LightEntry, kind: LightKind) -> LightEntry {
        let (_, irradiance) = LightEntry { is_on: true, ..light.clone() }.light(0).irradiance_at(self.center);
        let color = LightEntry { intensity: 1.0, ..LightEntry::new(LightKind::Distant) };
        let color = LightEntry { color: light.color, ..color }.light(0).strength().max_element();
        let mut other = LightEntry { kind, ..light.clone() };
        let from = light.center().unwrap_or(self.center + light.direction() * DISTANCE * self.radius);
        self.place(&mut other, from);
        if light.kind.is_aimed() {
            other.target = light.target;
        }
        other.radius = other.radius.max(GRID);
        let wanted = if color > 0.0 { irradiance.max_element() / color } else { 0.0 };
        self.set_irradiance(&mut other, if wanted > 0.0 { wanted } else { IRRADIANCE });
        other
    }

    /// Moves all parts of `light` to the place `from`, turned to the middle of the subject.
    fn place(&self, light: &mut LightEntry, from: Vec3) {
        let towards = (from - self.center).normalize_or(self.back);
        (light.azimuth, light.elevation) = angles(towards);
        light.position = from.map(rounded);
        light.target = self.center.map(rounded);
        if light.position.distance(light.target) < 10.0 * GRID {
            light.position += towards * self.radius;
        }
        let half = 0.4 * self.radius * Vec3::Y;
        light.ends = [from - half, from + half].map(|end| end.map(rounded));
    }

    /// Sets the intensity by which a white `light` has this irradiance at the middle of the subject.
    fn set_irradiance(&self, light: &mut LightEntry, irradiance: f32) {
        let unit = LightEntry {
            intensity: 1.0,
            color: [255; 3],
            is_on: true,
            range: f32::INFINITY,
            ..light.clone()
        };
        let (_, of_unit) = unit.light(0).irradiance_at(self.center);
        let intensity = irradiance / of_unit.max_element();
        // In the cone's shadow or behind its front there is no such intensity.
        if intensity.is_finite() {
            light.intensity = digits(intensity).min(1e6);
        }
    }

    /// Returns the place of the handle of a part of `light`, meters. Distant lights are on the dome.
    pub fn handle(&self, light: &LightEntry, part: LightPart) -> Vec3 {
        match part {
            LightPart::Body => light.center().unwrap_or(self.center + light.direction() * self.dome),
            LightPart::Target => light.target,
            LightPart::End(end) => light.ends[end],
        }
    }

    /// Returns `light` after a drag of `part`. A point in the view at the depth of the handle has `meters` per point of
    /// the drag. A distant light moves on the dome.
    pub fn dragged(&self, light: &LightEntry, part: LightPart, drag: HandleDrag, meters: f32) -> LightEntry {
        let mut moved = light.clone();
        let offset = (self.right * drag.across.x - self.up * drag.across.y - self.back * drag.away) * meters;
        match part {
            LightPart::Body if light.kind == LightKind::Distant => {
                let radians = drag.across * meters / self.dome;
                // Behind the head, the light moves to the right on the screen for a smaller azimuth. The side is that
                // of the light before the drag, so that the drag continues over the edge of the dome.
                let side = if light.direction().dot(self.back) < 0.0 { -1.0 } else { 1.0 };
                let azimuth = light.azimuth + side * radians.x / light.elevation.cos().max(0.3);
                let turn = std::f32::consts::TAU;
                moved.azimuth = angle(azimuth - turn * (azimuth / turn).round());
                let most = std::f32::consts::FRAC_PI_2;
                moved.elevation = angle((light.elevation - radians.y).clamp(-most, most));
            }
            LightPart::Body => {
                moved.move_by(offset);
                moved.position = moved.position.map(rounded);
                moved.ends = moved.ends.map(|end| end.map(rounded));
            }
            LightPart::Target => moved.target = (light.target + offset).map(rounded),
            LightPart::End(end) => moved.ends[end] = (light.ends[end] + offset).map(rounded),
        }
        // A light in its own target has no direction.
        if moved.check().is_ok() { moved } else { light.clone() }
    }
}

/// Returns azimuth and elevation of a direction, radians.
fn angles(towards: Vec3) -> (f32, f32) {
    (angle(towards.x.atan2(towards.z)), angle(towards.y.clamp(-1.0, 1.0).asin()))
}

fn angle(radians: f32) -> f32 {
    ((radians.to_degrees() / ANGLE_GRID).round() * ANGLE_GRID).to_radians()
}

/// Rounds a length, meters.
fn rounded(meters: f32) -> f32 {
    // Dividing by a whole number gives the nearest decimal number; subtracting from 0 avoids -0.
    0.0 - (0.0 - (meters / GRID).round()) / (1.0 / GRID).round()
}

/// Rounds to two significant digits.
fn digits(number: f32) -> f32 {
    format!("{number:.1e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::camera::Angle;

    fn stage(view: Angle) -> (LightStage, Orbit) {
        let orbit = Orbit::new(view, (Vec3::new(-0.15, 1.35, -0.15), Vec3::new(0.15, 1.75, 0.15)));
        (LightStage::of(&orbit), orbit)
    }

    fn irradiance(light: &LightEntry, stage: &LightStage) -> f32 {
        light.light(0).irradiance_at(stage.center).1.max_element()
    }

    #[test]
    fn new_lights_are_visible_at_the_upper_left_and_bright() {
        for view in [Angle::Front, Angle::ThreeQuarter, Angle::Side, Angle::Back] {
            let (stage, orbit) = stage(view);
            let lights =
                LightKind::ALL.map(|kind| stage.new_light(kind)).into_iter().chain([stage.new_ring()]);
            for light in lights {
                assert_eq!(light.check(), Ok(()), "{light:?}");
                let at = orbit.project(stage.handle(&light, LightPart::Body)).unwrap();
                assert!(at.x < -0.05 && at.y > 0.05 && at.abs().max_element() < 0.95, "{view:?} {at}");
                let received = irradiance(&light, &stage);
                assert!((received / IRRADIANCE - 1.0).abs() < 0.1, "{:?} {received}", light.kind);
            }
        }
    }

    #[test]
    fn other_shapes_keep_place_color_and_irradiance() {
        let (stage, _) = stage(Angle::Front);
        let color = [255, 128, 64];
        for from in LightKind::ALL {
            let light = LightEntry { color, name: "Lamp".into(), ..stage.new_light(from) };
            for to in LightKind::ALL {
                let other = stage.reshaped(&light, to);
                assert_eq!((other.kind, other.color, other.name.as_str()), (to, color, "Lamp"));
                assert_eq!(other.check(), Ok(()), "{other:?}");
                let (before, after) = (irradiance(&light, &stage), irradiance(&other, &stage));
                assert!((after / before - 1.0).abs() < 0.1, "{from:?} {to:?}: {before} {after}");
                let [a, b] = [&light, &other].map(|light| stage.handle(light, LightPart::Body));
                let directions = [a, b].map(|at| (at - stage.center).normalize());
                assert!(directions[0].dot(directions[1]) > 0.999, "{from:?} {to:?}: {a} {b}");
            }
        }
        // A light that does not shine at the head keeps a finite strength.
        let spot = stage.new_light(LightKind::Spot);
        let aside = LightEntry { target: spot.position + Vec3::Y, ..spot };
        assert_eq!(stage.reshaped(&aside, LightKind::Disc).check(), Ok(()));
    }

    #[test]
    fn drags_move_lights_in_the_view_plane_and_in_depth() {
        let (stage, orbit) = stage(Angle::Side);
        let point = stage.new_light(LightKind::Point);
        let drag = |light: &LightEntry, part, x: f32, y: f32, away: f32| {
            let drag = HandleDrag { across: Vec2::new(x, y), away };
            stage.dragged(light, part, drag, 0.001)
        };
        let (right, up) = orbit.plane();
        let moved = drag(&point, LightPart::Body, 100.0, 50.0, 0.0);
        let offset = moved.position - point.position;
        assert!((offset - 0.1 * right + 0.05 * up).length() < 0.002, "{offset}");
        let pushed = drag(&point, LightPart::Body, 0.0, 0.0, 100.0);
        let offset = pushed.position - point.position;
        assert!((offset + 0.1 * right.cross(up)).length() < 0.002, "{offset}");
        let tube = stage.new_light(LightKind::Tube);
        let end = drag(&tube, LightPart::End(1), 100.0, 0.0, 0.0);
        assert!(end.ends[0] == tube.ends[0] && end.ends[1].distance(tube.ends[1]) > 0.09);
        let spot = stage.new_light(LightKind::Spot);
        let aimed = drag(&spot, LightPart::Target, 100.0, 0.0, 0.0);
        assert!(aimed.position == spot.position && aimed.target.distance(spot.target) > 0.09);
        let onto = LightEntry { position: spot.target + Vec3::Y * 0.05, ..spot };
        let (same, meters) = (up.y.recip() * 50.0, 0.001);
        let onto = LightEntry { position: onto.target + up * 0.05, ..onto };
        let across = HandleDrag { across: Vec2::new(0.0, same * up.y), away: 0.0 };
        assert_eq!(stage.dragged(&onto, LightPart::Body, across, meters).check(), Ok(()));
    }

    #[test]
    fn distant_lights_move_on_the_dome() {
        let (stage, orbit) = stage(Angle::Front);
        let project = |light: &LightEntry| orbit.project(stage.handle(light, LightPart::Body)).unwrap();
        let drag = |light: &LightEntry, x: f32, y: f32| {
            stage.dragged(light, LightPart::Body, HandleDrag { across: Vec2::new(x, y), away: 9.0 }, 0.001)
        };
        for azimuth in [0.3, 2.8, -2.8] {
            let light = LightEntry::distant(azimuth, 0.2, 2.0);
            let moved = project(&drag(&light, 20.0, -20.0)) - project(&light);
            assert!(moved.x > 0.01 && moved.y > 0.01, "{azimuth}: it follows the pointer, {moved}");
        }
        let high = drag(&LightEntry::distant(3.1, 1.5, 2.0), -400.0, -1000.0);
        assert!((high.elevation.to_degrees() - 90.0).abs() < 1e-3 && high.azimuth.abs() <= 3.15, "{high:?}");
        assert_eq!(high.intensity, 2.0);
    }

    #[test]
    fn lengths_are_rounded_to_short_decimal_numbers() {
        assert_eq!([0.123_456, -0.0004, 1.9999].map(rounded), [0.123, 0.0, 2.0]);
        assert_eq!(digits(0.012_345), 0.012);
    }
}
