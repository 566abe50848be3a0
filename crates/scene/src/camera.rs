//! Portrait cameras, which frame the head and its hair.

use tresses::{
    Bounds, Camera, Pose,
    glam::{Mat4, Vec3},
    low_level::framing_distance,
};

/// Vertical field of view of every camera, radians, like a portrait lens.
pub const VERTICAL_FOV: f32 = 30.0 / 180.0 * std::f32::consts::PI;

/// Direction from which the camera sees the head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Angle {
    /// In front of the face.
    Front,
    /// Halfway between the front and the head's left.
    #[default]
    ThreeQuarter,
    /// The head's left.
    Side,
    /// Behind the head.
    Back,
}

impl Angle {
    /// All angles with their names.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Front, "front"),
        (Self::ThreeQuarter, "three-quarter"),
        (Self::Side, "side"),
        (Self::Back, "back"),
    ];

    /// Returns azimuth toward the head's left and elevation, degrees.
    fn angles(self) -> (f32, f32) {
        match self {
            Self::Front => (0.0, 4.0),
            Self::ThreeQuarter => (32.0, 4.0),
            Self::Side => (90.0, 4.0),
            Self::Back => (180.0, 6.0),
        }
    }
}

/// Position and target of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Position, meters.
    pub eye: Vec3,
    /// Target, meters.
    pub target: Vec3,
}

impl Viewpoint {
    /// Frames `subject` from `view`. `aspect` is width over height of the frame; `zoom` 2 shows half as much.
    pub fn portrait(view: Angle, subject: Bounds, aspect: f32, zoom: f32) -> Self {
        let (azimuth, elevation) = view.angles();
        let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
        let back =
            Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        let target = 0.5 * (subject.0 + subject.1);
        let distance = framing_distance(subject, back, VERTICAL_FOV, aspect);
        Self { eye: target + back * (distance / zoom), target }
    }

    /// Returns the distance from eye to target, meters.
    pub fn distance(&self) -> f32 {
        self.eye.distance(self.target)
    }

    /// Returns the same view from `distance` meters.
    pub fn at_distance(&self, distance: f32) -> Self {
        let back = (self.eye - self.target).normalize_or(Vec3::Z);
        Self { eye: self.target + back * distance, ..*self }
    }
}

/// A camera of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CaptureCamera {
    /// Position and target, with [`VERTICAL_FOV`].
    Viewpoint(Viewpoint),
    /// View and projection of [`tresses::Camera`].
    Matrices(Mat4, Mat4),
}

impl From<Viewpoint> for CaptureCamera {
    fn from(viewpoint: Viewpoint) -> Self {
        Self::Viewpoint(viewpoint)
    }
}

impl CaptureCamera {
    /// Returns the camera for an image of `size` pixels.
    pub fn camera(&self, size: [u32; 2]) -> Camera {
        match *self {
            Self::Viewpoint(Viewpoint { eye, target }) => Camera::look_at(eye, target, VERTICAL_FOV, size),
            Self::Matrices(view, projection) => Camera { view, projection, size },
        }
    }

    /// Returns the direction towards the camera, of any length.
    pub fn back(&self) -> Vec3 {
        match self {
            Self::Viewpoint(viewpoint) => viewpoint.eye - viewpoint.target,
            Self::Matrices(view, _) => view.row(2).truncate(),
        }
    }
}

/// A camera that may move along its view axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    from: Viewpoint,
    /// Distance at the end, meters.
    to: f32,
    /// Center of the head at rest if the camera follows the head.
    follows: Option<Vec3>,
}

impl Shot {
    /// Returns a shot that does not move.
    pub fn still(camera: Viewpoint) -> Self {
        Self { to: camera.distance(), from: camera, follows: None }
    }

    /// Returns a shot that ends `to` meters from its target.
    pub fn moving(camera: Viewpoint, to: f32) -> Self {
        Self { from: camera, to, follows: None }
    }

    /// Returns a copy that follows the head, whose bounds at rest are `subject`.
    pub fn following(&self, subject: Bounds) -> Self {
        Self { follows: Some(0.5 * (subject.0 + subject.1)), ..*self }
    }

    /// Moves `camera`, a viewpoint of this shot, along with the head pose `head`. The camera does not turn with the
    /// head.
    pub fn with(&self, camera: &Viewpoint, head: &Pose) -> Viewpoint {
        let by = self.follows.map_or(Vec3::ZERO, |center| head.point(center) - center);
        Viewpoint { eye: camera.eye + by, target: camera.target + by }
    }

    /// Returns the viewpoint at time `t` of the shot, 0 to 1. The distance changes by equal factors in equal times.
    pub fn at(&self, t: f32) -> Viewpoint {
        let from = self.from.distance();
        if from == self.to { self.from } else { self.from.at_distance(from * (self.to / from).powf(t)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::Camera as Projection;

    const HAIR: Bounds = (Vec3::new(-0.11, 1.40, -0.13), Vec3::new(0.10, 1.67, 0.13));

    fn project(camera: &Viewpoint, p: Vec3, aspect: f32) -> (f32, f32) {
        let size = [(1000.0 * aspect) as u32, 1000];
        let view = Projection::look_at(camera.eye, camera.target, VERTICAL_FOV, size);
        let clip = view.projection * view.view * p.extend(1.0);
        assert!(clip.w > 0.0);
        (clip.x / clip.w, clip.y / clip.w)
    }

    #[test]
    fn portrait_frames_the_subject() {
        for view in [Angle::Front, Angle::ThreeQuarter, Angle::Side, Angle::Back] {
            for aspect in [0.5, 1.0, 1.6] {
                let camera = Viewpoint::portrait(view, HAIR, aspect, 1.0);
                let mut reach: f32 = 0.0;
                for i in 0..8 {
                    let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
                    // Extreme points of the narrow cylinder at top and bottom.
                    let p = Vec3::new(
                        pick(0, HAIR.0.x, HAIR.1.x) * 0.7,
                        pick(1, HAIR.0.y, HAIR.1.y),
                        pick(2, HAIR.0.z, HAIR.1.z) * 0.7,
                    );
                    let (x, y) = project(&camera, p, aspect);
                    assert!(x.abs() < 1.0 && y.abs() < 1.0, "{view:?} {aspect}: {x} {y}");
                    reach = reach.max(x.abs()).max(y.abs());
                }
                assert!(reach > 0.6, "{view:?} {aspect}: {reach}");
                let (x, y) = project(&camera, camera.target, aspect);
                assert!(x.abs() < 1e-5 && y.abs() < 1e-5);
            }
        }
    }

    #[test]
    fn shots_move_by_equal_factors() {
        let camera = Viewpoint::portrait(Angle::Side, HAIR, 1.6, 1.0).at_distance(0.5);
        assert!((camera.distance() - 0.5).abs() < 1e-6 && camera.eye.x > 0.3);
        let shot = Shot::moving(camera, 8.0);
        for (t, distance) in [(0.0, 0.5), (0.5, 2.0), (1.0, 8.0)] {
            assert!((shot.at(t).distance() / distance - 1.0).abs() < 1e-4);
            assert_eq!(shot.at(t).target, camera.target);
        }
        assert_eq!(Shot::still(camera).at(0.7), camera);
    }

    #[test]
    fn angles_place_the_camera() {
        let eye = |view| {
            let camera = Viewpoint::portrait(view, HAIR, 1.6, 1.0);
            camera.eye - camera.target
        };
        assert!(eye(Angle::Front).z > 0.3 && eye(Angle::Front).x.abs() < 1e-6);
        assert!(eye(Angle::ThreeQuarter).x > 0.2 && eye(Angle::ThreeQuarter).z > 0.3);
        assert!(eye(Angle::Side).x > 0.3 && eye(Angle::Back).z < -0.3);
        assert!(
            Viewpoint::portrait(Angle::Front, HAIR, 1.6, 2.0).eye.z
                < Viewpoint::portrait(Angle::Front, HAIR, 1.6, 1.0).eye.z
        );
    }
}
