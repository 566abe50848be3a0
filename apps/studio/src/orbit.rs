//! The user's camera: it orbits a point, pans, zooms, and glides to named views.

use tresses::Bounds;
use tresses::glam::{Vec2, Vec3};
use tresses_scene::camera::{Angle, VERTICAL_FOV, Viewpoint};

/// Range of the camera's distance from its target, meters.
const DISTANCE: (f32, f32) = (0.05, 40.0);
/// Radians per point of a drag.
const RADIANS_PER_POINT: f32 = 0.006;
/// Largest pitch up or down, radians.
const STEEPEST: f32 = 1.5;
/// Fraction of the distance that remains after gliding for a second.
const GLIDE: f32 = 1e-6;

/// Camera position in orbit coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spot {
    target: Vec3,
    /// From the front of the face towards the head's left, radians.
    yaw: f32,
    /// Above the horizon, radians.
    pitch: f32,
    /// Distance from the target, meters.
    distance: f32,
}

impl Spot {
    fn of(camera: &Viewpoint) -> Self {
        let back = camera.eye - camera.target;
        let distance = back.length().max(DISTANCE.0);
        let pitch = (back.y / distance).clamp(-1.0, 1.0).asin();
        Self { target: camera.target, yaw: back.x.atan2(back.z), pitch, distance }
    }

    fn back(&self) -> Vec3 {
        let (sin, cos) = self.pitch.sin_cos();
        Vec3::new(self.yaw.sin() * cos, sin, self.yaw.cos() * cos)
    }
}

/// An orbiting camera, possibly gliding to a goal.
#[derive(Clone, Debug)]
pub struct Orbit {
    now: Spot,
    goal: Spot,
    /// Named view that is kept when the aspect ratio changes, until the user moves the camera.
    framed: Option<Angle>,
    subject: Bounds,
    aspect: f32,
}

impl Orbit {
    /// Creates a portrait of `subject` from `view`.
    pub fn new(view: Angle, subject: Bounds) -> Self {
        let spot = Spot::of(&Viewpoint::portrait(view, subject, 1.3, 1.0));
        Self { now: spot, goal: spot, framed: Some(view), subject, aspect: 1.3 }
    }

    /// Frames another subject from the same side.
    pub fn show(&mut self, subject: Bounds) {
        self.subject = subject;
        let view = self.framed.unwrap_or_default();
        let portrait = Spot::of(&Viewpoint::portrait(view, subject, self.aspect, 1.0));
        self.goal = match self.framed {
            Some(_) => portrait,
            None => Spot { target: portrait.target, distance: portrait.distance, ..self.goal },
        };
        self.now = self.goal;
    }

    /// Sets the aspect ratio, width over height.
    pub fn set_aspect(&mut self, aspect: f32) {
        if (aspect - self.aspect).abs() < 1e-4 {
            return;
        }
        self.aspect = aspect;
        if let Some(view) = self.framed {
            let gliding = self.is_gliding();
            self.goal = Spot::of(&Viewpoint::portrait(view, self.subject, aspect, 1.0));
            if !gliding {
                self.now = self.goal;
            }
        }
    }

    /// Glides to a portrait from `view`.
    pub fn frame(&mut self, view: Angle) {
        self.goal = Spot::of(&Viewpoint::portrait(view, self.subject, self.aspect, 1.0));
        // Turn the short way round.
        let revolutions = ((self.now.yaw - self.goal.yaw) / std::f32::consts::TAU).round();
        self.goal.yaw += revolutions * std::f32::consts::TAU;
        self.framed = Some(view);
    }

    /// Returns the named view, unless the user has moved the camera since.
    pub fn framed(&self) -> Option<Angle> {
        self.framed
    }

    /// Turns by a drag of `points`.
    pub fn rotate(&mut self, points: Vec2) {
        self.drop_named_view();
        self.now.yaw -= points.x * RADIANS_PER_POINT;
        self.now.pitch = (self.now.pitch + points.y * RADIANS_PER_POINT).clamp(-STEEPEST, STEEPEST);
        self.goal = self.now;
    }

    /// Pans by a drag of `points` in a viewport `height` points high; the target follows the pointer.
    pub fn pan(&mut self, points: Vec2, height: f32) {
        self.drop_named_view();
        let (right, up) = self.plane();
        let meters = 2.0 * (0.5 * VERTICAL_FOV).tan() * self.now.distance / height.max(1.0);
        self.now.target += (up * points.y - right * points.x) * meters;
        self.goal = self.now;
    }

    /// Divides the distance by `factor`.
    pub fn zoom(&mut self, factor: f32) {
        self.drop_named_view();
        // A move to a named view continues.
        for view in [&mut self.now, &mut self.goal] {
            view.distance = (view.distance / factor.max(1e-3)).clamp(DISTANCE.0, DISTANCE.1);
        }
    }

    /// Sets the distance to the target, meters, within the limits of zooming.
    pub fn set_distance(&mut self, distance: f32) {
        self.zoom(self.now.distance / distance.max(1e-3));
    }

    /// Drops the named view: the user has moved the camera.
    fn drop_named_view(&mut self) {
        self.framed = None;
    }

    /// Whether the camera is gliding to a view.
    pub fn is_gliding(&self) -> bool {
        self.now != self.goal
    }

    /// Glides on for `seconds`.
    pub fn advance(&mut self, seconds: f32) {
        if !self.is_gliding() {
            return;
        }
        let fraction = 1.0 - GLIDE.powf(seconds.clamp(0.0, 0.1));
        let mix = |a: f32, b: f32| a + (b - a) * fraction;
        let (now, goal) = (self.now, self.goal);
        self.now = Spot {
            target: now.target.lerp(goal.target, fraction),
            yaw: mix(now.yaw, goal.yaw),
            pitch: mix(now.pitch, goal.pitch),
            distance: mix(now.distance, goal.distance),
        };
        let near = (self.now.yaw - goal.yaw).abs() + (self.now.pitch - goal.pitch).abs() < 2e-4
            && self.now.target.distance(goal.target) + (self.now.distance - goal.distance).abs() < 2e-4;
        if near {
            self.now = goal;
        }
    }

    /// Returns the current camera.
    pub fn camera(&self) -> Viewpoint {
        Viewpoint { eye: self.now.target + self.now.back() * self.now.distance, target: self.now.target }
    }

    /// Returns the right and up directions of the image plane.
    pub fn plane(&self) -> (Vec3, Vec3) {
        let right = Vec3::new(self.now.yaw.cos(), 0.0, -self.now.yaw.sin());
        (right, self.now.back().cross(right))
    }

    /// Returns eye and unit direction of the ray through `at`, in normalized device coordinates: -1 to 1, right and up.
    pub fn ray(&self, at: Vec2) -> (Vec3, Vec3) {
        let (right, up) = self.plane();
        let tan = (0.5 * VERTICAL_FOV).tan();
        let direction = right * (at.x * tan * self.aspect) + up * (at.y * tan) - self.now.back();
        (self.camera().eye, direction.normalize())
    }

    /// Returns the normalized device coordinates of `point`, if it is in front of the camera: the inverse of
    /// [`ray`](Self::ray).
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let (right, up) = self.plane();
        let offset = point - self.camera().eye;
        let height = (0.5 * VERTICAL_FOV).tan() * self.depth(point);
        (height > 0.0).then(|| Vec2::new(offset.dot(right) / (height * self.aspect), offset.dot(up) / height))
    }

    /// Returns the distance of `point` from the eye along the viewing direction, meters.
    pub fn depth(&self, point: Vec3) -> f32 {
        (self.camera().eye - point).dot(self.now.back())
    }

    /// Returns the bounds of the subject, meters.
    pub fn subject(&self) -> Bounds {
        self.subject
    }

    /// Returns the height of the view frustum at distance `depth` from the eye, meters.
    pub fn height_at(&self, depth: f32) -> f32 {
        2.0 * (0.5 * VERTICAL_FOV).tan() * depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBJECT: Bounds = (Vec3::new(-0.11, 1.40, -0.13), Vec3::new(0.10, 1.67, 0.13));

    #[test]
    fn camera_glides_to_a_view_and_stops() {
        let mut orbit = Orbit::new(Angle::Front, SUBJECT);
        orbit.frame(Angle::Side);
        assert!(orbit.is_gliding());
        for _ in 0..200 {
            orbit.advance(1.0 / 60.0);
        }
        assert!(!orbit.is_gliding());
        let portrait = Viewpoint::portrait(Angle::Side, SUBJECT, 1.3, 1.0);
        assert!(orbit.camera().eye.distance(portrait.eye) < 1e-4);
    }

    #[test]
    fn turning_keeps_the_distance_and_never_tips_over() {
        let mut orbit = Orbit::new(Angle::Front, SUBJECT);
        let before = orbit.camera().distance();
        orbit.rotate(Vec2::new(300.0, 9000.0));
        assert!((orbit.camera().distance() - before).abs() < 1e-4);
        assert!(orbit.camera().eye.y > orbit.camera().target.y && orbit.framed().is_none());
        assert!(orbit.plane().1.y > 0.0);
    }

    #[test]
    fn center_ray_passes_through_the_target() {
        let mut orbit = Orbit::new(Angle::ThreeQuarter, SUBJECT);
        orbit.pan(Vec2::new(30.0, -20.0), 600.0);
        let (eye, direction) = orbit.ray(Vec2::ZERO);
        let camera = orbit.camera();
        assert!((eye + direction * camera.distance()).distance(camera.target) < 1e-5);
    }

    #[test]
    fn projection_inverts_rays() {
        let mut orbit = Orbit::new(Angle::ThreeQuarter, SUBJECT);
        orbit.set_aspect(1.7);
        orbit.pan(Vec2::new(30.0, -20.0), 600.0);
        for at in [Vec2::ZERO, Vec2::new(-0.7, 0.4), Vec2::new(0.9, -0.9)] {
            let (eye, direction) = orbit.ray(at);
            let found = orbit.project(eye + 0.8 * direction).unwrap();
            assert!(found.distance(at) < 1e-4, "{at} {found}");
            assert_eq!(orbit.project(eye - direction), None, "behind the camera");
        }
    }

    #[test]
    fn glide_turns_the_short_way() {
        let mut orbit = Orbit::new(Angle::Back, SUBJECT);
        orbit.rotate(Vec2::new(-100.0, 0.0));
        orbit.frame(Angle::Back);
        assert!((orbit.now.yaw - orbit.goal.yaw).abs() < std::f32::consts::PI);
    }
}
