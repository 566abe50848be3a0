//! Rigs of skinned bodies in arrays.

use crate::{
    TressesError,
    arrays::{given_floats, given_integers, given_matrices},
    mesh::Mesh,
};
use pyo3::prelude::*;
use tresses::{
    glam::{Mat4, Vec3},
    groom::{
        self,
        rig::{Bind, INFLUENCES, Joint, MAX_JOINTS, Node, Transform},
    },
};

/// The joints of a skinned body, and the shares of each vertex that follow them.
///
/// Coordinates are in the space of the body's `Mesh`.
///
/// Parameters
/// ----------
/// names : list of str [j]
///     Names of the joints. A joint above the head whose name contains "neck" takes a share of the head's turns.
/// parents : array of int [j]
///     Index of each joint's parent, lower than its own, or -1.
/// rest : array [j, 4, 4]
///     Transform of each joint at rest, for column vectors.
/// joints : array of int [v, k]
///     Joints that each vertex of the mesh follows.
/// weights : array [v, k]
///     Share of each of these joints. Only the eight largest count; their sum becomes 1.
#[pyclass(frozen, module = "tresses")]
pub struct Rig {
    nodes: Vec<Node>,
    rest: Vec<Mat4>,
    /// Joints and shares of each vertex; empty if all vertices follow the only joint.
    vertices: Vec<VertexWeights>,
}

/// Joints that a vertex follows, and their shares.
type VertexWeights = ([u16; INFLUENCES], [f32; INFLUENCES]);

fn refuse(why: String) -> PyErr {
    TressesError::new_err(why)
}

#[pymethods]
impl Rig {
    #[new]
    fn new(
        names: Vec<String>,
        parents: &Bound<'_, PyAny>,
        rest: &Bound<'_, PyAny>,
        joints: &Bound<'_, PyAny>,
        weights: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let count = names.len();
        if count == 0 || count > MAX_JOINTS {
            return Err(refuse(format!("there are {count} joints, but must be 1 to {MAX_JOINTS}")));
        }
        let (_, parents) = given_integers(parents, "parents")?;
        let rest = given_matrices(rest, "rest")?;
        if parents.len() != count || rest.len() != count {
            let (parents, rest) = (parents.len(), rest.len());
            return Err(refuse(format!(
                "there are {count} names, {parents} parents and {rest} matrices of rest"
            )));
        }
        let mut nodes = Vec::with_capacity(count);
        for (i, (name, parent)) in names.into_iter().zip(parents).enumerate() {
            let parent = match usize::try_from(parent) {
                Ok(parent) if parent < i => Some(parent),
                Err(_) if parent == -1 => None,
                _ => {
                    return Err(refuse(format!(
                        "the parent of joint {i} is {parent}, but must be below {i} or -1"
                    )));
                }
            };
            let inverse = parent.map_or(Mat4::IDENTITY, |parent: usize| rest[parent].inverse());
            let local = inverse * rest[i];
            if !local.is_finite() || rest[i].determinant().abs() < 1e-12 {
                return Err(refuse(format!("the matrix of joint {i} ({name}) has no inverse")));
            }
            let parent = parent.map(|parent| parent as u32);
            let (rest, matrix) = (Transform::from_matrix(local), Some(local));
            nodes.push(Node { name, parent, rest, matrix, ..Node::default() });
        }
        let ((shape, joints), (shape_of_weights, weights)) =
            (given_integers(joints, "joints")?, given_floats(weights, "weights")?);
        let &[vertices, each] = &shape[..] else {
            return Err(refuse(format!("joints have the shape {shape:?}, but must have [v, k]")));
        };
        if shape != shape_of_weights || each == 0 {
            return Err(refuse(format!("joints have the shape {shape:?}, but weights {shape_of_weights:?}")));
        }
        let lost = joints.iter().find(|joint| !(0..count as i64).contains(joint));
        if let Some(joint) = lost {
            return Err(refuse(format!("a vertex follows joint {joint}, but there are {count} joints")));
        }
        let vertex = |vertex: usize| -> PyResult<VertexWeights> {
            let range = vertex * each..(vertex + 1) * each;
            let mut all: Vec<_> = joints[range.clone()].iter().zip(&weights[range]).collect();
            all.sort_by(|a, b| b.1.total_cmp(a.1));
            all.truncate(INFLUENCES);
            let sum: f32 = all.iter().map(|(_, weight)| **weight).sum();
            let is_valid = all.iter().all(|(_, weight)| weight.is_finite() && **weight >= 0.0) && sum > 0.0;
            if !is_valid {
                let why =
                    format!("the weights of vertex {vertex} must be finite, none below 0, and one above 0");
                return Err(refuse(why));
            }
            let (mut of, mut fractions) = ([0; INFLUENCES], [0.0; INFLUENCES]);
            for (slot, (joint, weight)) in all.into_iter().enumerate() {
                (of[slot], fractions[slot]) = (*joint as u16, weight / sum);
            }
            Ok((of, fractions))
        };
        let vertices = (0..vertices).map(vertex).collect::<PyResult<_>>()?;
        Ok(Self { nodes, rest, vertices })
    }

    /// Create a rig with a single joint, for a body that only `skin` of `Simulation.step` deforms.
    #[staticmethod]
    fn single() -> Self {
        Self { nodes: vec![Node::default()], rest: vec![Mat4::IDENTITY], vertices: Vec::new() }
    }

    fn __len__(&self) -> usize {
        self.nodes.len()
    }

    fn __repr__(&self) -> String {
        format!("Rig({} joints, {} vertices)", self.nodes.len(), self.vertices.len())
    }
}

impl Rig {
    /// Returns the rig for the vertices of `mesh`.
    pub fn of(&self, mesh: &Mesh) -> PyResult<groom::Rig> {
        let mesh = &mesh.0;
        let (count, own) = (mesh.positions.len(), self.vertices.len());
        if own != count && own > 0 {
            return Err(TressesError::new_err(format!(
                "the rig has {own} vertices, but the mesh has {count}"
            )));
        }
        let bind = |(i, (position, normal)): (usize, (&Vec3, &Vec3))| match self.vertices.get(i) {
            Some((joints, weights)) => {
                Bind { position: *position, normal: *normal, joints: *joints, weights: *weights }
            }
            None => Bind::rigid(*position, *normal, 0),
        };
        let joint = |(node, rest): (usize, &Mat4)| Joint { node: node as u32, inverse_bind: rest.inverse() };
        Ok(groom::Rig {
            nodes: self.nodes.clone(),
            joints: self.rest.iter().enumerate().map(joint).collect(),
            vertices: mesh.positions.iter().zip(&mesh.normals).enumerate().map(bind).collect(),
            to_groom: Mat4::IDENTITY,
            ..groom::Rig::default()
        })
    }
}
