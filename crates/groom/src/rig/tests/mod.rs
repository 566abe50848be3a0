//! Rigs with known poses, invalid rigs, and third-party rigs.

mod assets;
mod broken;
mod closed;
mod curves;
pub(crate) mod glb;
mod orient;
mod shapes;

use std::path::Path;

use glam::Vec3;

use super::*;
use crate::{
    TriMesh,
    import::{FileBytes, mesh},
};
use glb::Glb;

/// Reads the mesh and rig of a `.glb` file, in the file's own axes and unit.
fn read(bytes: Vec<u8>) -> crate::Result<mesh::RawMesh> {
    let file: FileBytes = ("a.glb".into(), bytes.into());
    mesh::read_given(&[file], Path::new("a.glb"))
}

/// Returns the deformed mesh of a rig in a pose.
fn posed(rig: &Rig, pose: &RigPose) -> TriMesh {
    let mut mesh = TriMesh { positions: vec![Vec3::ZERO; rig.vertices.len()], ..Default::default() };
    rig.deform(pose, &mut mesh);
    mesh
}

/// Checks that two lists of points differ by at most `tolerance`; the error names the first difference.
fn agree(actual: &[Vec3], expected: &[Vec3], tolerance: f32) -> Result<(), String> {
    if actual.len() != expected.len() {
        return Err(format!("{} points, not {}", actual.len(), expected.len()));
    }
    match actual.iter().zip(expected).position(|(a, b)| a.distance(*b) > tolerance || !a.is_finite()) {
        Some(i) => Err(format!("point {i} is {}, not {}", actual[i], expected[i])),
        None => Ok(()),
    }
}

#[test]
fn agree_detects_differences() {
    let points = [Vec3::X, Vec3::Y];
    assert_eq!(agree(&points, &points, 1e-6), Ok(()));
    assert!(agree(&points, &points[..1], 1e-6).is_err());
    assert!(agree(&points, &[Vec3::X, Vec3::Y * 1.001], 1e-6).is_err());
    assert!(agree(&[Vec3::NAN], &[Vec3::X], 1e9).is_err());
}
