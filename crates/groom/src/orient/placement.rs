//! The transform from a file's unit and axes to meters, Y up, face +Z.

use glam::{Mat3, Mat4, Vec3};

use super::{Axis, LengthUnit};
use crate::{
    Rig, Strands, TriMesh,
    light::{PunctualLight, PunctualShape},
};

/// Transform from a file's coordinates to meters, Y up, face +Z, with its reasons.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Placement {
    /// Meters per unit of the file.
    pub unit: LengthUnit,
    /// Axis of the file that points up.
    pub up: Axis,
    /// Axis of the file along which the face looks.
    pub front: Axis,
    /// Whether the transform exchanges left and right.
    pub mirrored: bool,
    /// Translation, applied last, meters. Zero unless hair had to be moved onto a head.
    pub translation: Vec3,
    /// Reasons, one clause per decision.
    pub reasons: Vec<String>,
    /// Doubts, each with the option that settles it.
    pub doubts: Vec<String>,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            unit: LengthUnit(1.0),
            up: Axis::Y,
            front: Axis::Z,
            mirrored: false,
            translation: Vec3::ZERO,
            reasons: Vec::new(),
            doubts: Vec::new(),
        }
    }
}

impl Placement {
    /// Returns the rotation (or, if mirrored, the reflection), without unit and translation.
    pub fn axes(&self) -> Mat3 {
        let (up, front) = (self.up.vector(), self.front.vector());
        let side = up.cross(front) * if self.mirrored { -1.0 } else { 1.0 };
        Mat3::from_cols(side, up, front).transpose()
    }

    /// Transforms a point of the file.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.axes() * p * self.unit.0 + self.translation
    }

    /// Returns the transform as a matrix.
    pub fn matrix(&self) -> Mat4 {
        Mat4::from_translation(self.translation) * Mat4::from_mat3(self.axes() * self.unit.0)
    }

    /// Returns whether the transform changes nothing.
    pub fn is_identity(&self) -> bool {
        self.axes() == Mat3::IDENTITY && self.unit.0 == 1.0 && self.translation == Vec3::ZERO
    }

    /// Transforms strands in place.
    pub fn apply(&self, strands: &mut Strands) {
        if self.is_identity() {
            return;
        }
        let (axes, scale) = (self.axes(), self.unit.0);
        for p in &mut strands.positions {
            *p = axes * *p * scale + self.translation;
        }
        for r in &mut strands.radii {
            *r *= scale;
        }
    }

    /// Transforms a mesh in place. Mirroring also reverses the winding, which keeps the outside.
    pub fn apply_to_mesh(&self, mesh: &mut TriMesh) {
        if self.is_identity() {
            return;
        }
        let (axes, scale) = (self.axes(), self.unit.0);
        for p in &mut mesh.positions {
            *p = axes * *p * scale + self.translation;
        }
        for n in &mut mesh.normals {
            *n = axes * *n;
        }
        if self.mirrored {
            for t in &mut mesh.triangles {
                t.swap(1, 2);
            }
        }
    }

    /// Makes a rig deform the mesh that [`Self::apply_to_mesh`] transformed.
    pub fn apply_to_rig(&self, rig: &mut Rig) {
        rig.to_groom = self.matrix() * rig.to_groom;
    }

    /// Transforms lights in place, as [`Self::apply_to_mesh`] transforms a mesh. The unit scales luminous intensity by
    /// its square, so that the mesh stays as bright as in the file.
    pub fn apply_to_lights(&self, lights: &mut [PunctualLight]) {
        let scale = self.unit.0;
        let area = |intensity: f32| (intensity * scale * scale).min(f32::MAX);
        for light in lights {
            light.range *= scale;
            match &mut light.shape {
                PunctualShape::Directional { direction } => *direction = self.axes() * *direction,
                PunctualShape::Point { position } => {
                    *position = self.point(*position);
                    light.intensity = area(light.intensity);
                }
                PunctualShape::Spot { position, direction, .. } => {
                    *position = self.point(*position);
                    *direction = self.axes() * *direction;
                    light.intensity = area(light.intensity);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_and_front_map_to_y_and_z() {
        let zup = Placement { up: Axis::Z, front: Axis::Y, unit: LengthUnit(0.01), ..Default::default() };
        assert_eq!(zup.point(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(-0.01, 0.03, 0.02));
        assert!(zup.axes().determinant() > 0.0);
        let mirrored = Placement { front: Axis::NegZ, mirrored: true, ..Default::default() };
        assert_eq!(mirrored.point(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(1.0, 2.0, -3.0));
    }

    #[test]
    fn lights_illuminate_as_in_the_file() {
        let light = |shape| PunctualLight {
            name: String::new(),
            shape,
            color: Vec3::ONE,
            intensity: 9.0,
            range: 50.0,
        };
        let (position, direction) = (Vec3::new(1.0, 2.0, 3.0), Vec3::Z);
        let mut lights = [
            light(PunctualShape::Directional { direction }),
            light(PunctualShape::Point { position }),
            light(PunctualShape::Spot { position, direction, inner: 0.1, outer: 0.2 }),
        ];
        let translation = Vec3::X;
        let zup = Placement {
            up: Axis::Z,
            front: Axis::Y,
            unit: LengthUnit(0.01),
            translation,
            ..Default::default()
        };
        zup.apply_to_lights(&mut lights);
        let (position, direction) = (zup.point(position), Vec3::Y);
        assert_eq!(lights[0].shape, PunctualShape::Directional { direction });
        assert_eq!(lights[1].shape, PunctualShape::Point { position });
        assert_eq!(lights[2].shape, PunctualShape::Spot { position, direction, inner: 0.1, outer: 0.2 });
        // At a hundredth of the distance, a ten-thousandth of the intensity gives the same irradiance.
        for (light, expected) in lights.iter().zip([9.0, 9e-4, 9e-4]) {
            assert!((light.intensity / expected - 1.0).abs() < 1e-6 && light.range == 0.5, "{light:?}");
        }
    }

    #[test]
    fn mirrored_mesh_keeps_its_outside() {
        let mut mesh = TriMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            triangles: vec![[0, 1, 2]],
            ..Default::default()
        };
        Placement { front: Axis::NegZ, mirrored: true, ..Default::default() }.apply_to_mesh(&mut mesh);
        let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
        assert_eq!((b - a).cross(c - a).normalize(), mesh.normals[0]);
    }
}
