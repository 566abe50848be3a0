//! Bindings of points to joints.

use glam::{DMat4, DVec3, Vec3};
use openusd::usd::TimeCode;

use super::{Skeletons, inherited, value};
use crate::{
    error::Result,
    formats::{
        curves::AttributeScope,
        source::excerpt,
        usd::read::{
            Scene,
            param::param,
            tree::{Object, Tree},
        },
    },
};

/// A prim's binding to a skeleton.
pub(in crate::formats::usd) struct SkelBinding {
    /// Index of the skeleton.
    pub skeleton: usize,
    /// Transform of the prim when it was bound.
    pub geom: DMat4,
    /// Number of joints, with weights, for each point or once for all points.
    width: usize,
    joints: Vec<u32>,
    weights: Vec<f32>,
}

impl SkelBinding {
    /// Returns the binding of an object with this number of points, if it has one.
    pub fn of(
        scene: &Scene,
        tree: &Tree,
        (object, points): (&Object, usize),
        skeletons: &Skeletons,
        time: TimeCode,
    ) -> Result<Option<Self>> {
        let Some(skeleton) = skeletons.of(scene, tree, object)? else { return Ok(None) };
        let found = |name: &str| param(scene, tree.up(object), name, time);
        let (Some(joints), Some(weights)) = (found("skel:jointIndices")?, found("skel:jointWeights")?) else {
            return Ok(None);
        };
        let path = excerpt(object.prim.path().as_str());
        let broken = |problem: String| scene.problem(format!("{path}: {problem}"));
        let width = joints.width;
        let fits = |count: usize| count == width || count == width.saturating_mul(points);
        let constant = joints.scope == Some(AttributeScope::All);
        if weights.flat.len() != joints.flat.len()
            || !fits(joints.flat.len())
            || constant && joints.flat.len() != width
        {
            let [joint_count, weight_count] = [joints.flat.len(), weights.flat.len()];
            return Err(broken(format!(
                "{joint_count} joint indices and {weight_count} weights do not match {points} points"
            )));
        }
        let own = &skeletons.0[skeleton];
        // The prim may have its own list of joints.
        let listed = inherited(scene, tree.up(object), "skel:joints", time)?;
        let listed = listed.as_ref().map(value::texts).unwrap_or_default();
        let joint_indices: Vec<Option<u32>> = match listed.is_empty() {
            true => (0..own.joints.len() as u32).map(Some).collect(),
            false => {
                let index_of = |name: &String| own.joint_indices.get(name).map(|at| *at as u32);
                listed.iter().map(index_of).collect()
            }
        };
        let mut named = Vec::with_capacity(joints.flat.len());
        for (joint, weight) in joints.flat.iter().zip(&weights.flat) {
            let index =
                (*joint >= 0.0).then(|| joint_indices.get(*joint as usize).copied().flatten()).flatten();
            match index {
                Some(index) => named.push(index),
                // Files may store any joint with weight 0.
                None if *weight == 0.0 => named.push(0),
                None => {
                    return Err(broken(format!(
                        "joint index {joint} is out of range; there are {} joints",
                        joint_indices.len()
                    )));
                }
            }
        }
        let geom = inherited(scene, tree.up(object), "primvars:skel:geomBindTransform", time)?;
        let geom = geom.as_ref().and_then(|value| value::matrices(value).first().copied());
        let geom = geom.unwrap_or(DMat4::IDENTITY);
        if !geom.is_finite() || geom.determinant() == 0.0 {
            return Err(broken("geomBindTransform is not finite or has no inverse".into()));
        }
        Ok(Some(Self { skeleton, geom, width, joints: named, weights: weights.flat }))
    }

    /// Returns the joints of a point with weights that sum to 1; none if the point has no weights.
    pub fn at(&self, point: usize) -> impl Iterator<Item = (u32, f32)> {
        let first = if self.joints.len() == self.width { 0 } else { point * self.width };
        let own = first..first + self.width;
        let (joints, weights) = (&self.joints[own.clone()], &self.weights[own]);
        let sum: f32 = weights.iter().filter(|weight| **weight > 0.0).sum();
        let held = joints.iter().zip(weights).filter(move |(_, weight)| **weight > 0.0 && sum > 0.0);
        held.map(move |(joint, weight)| (*joint, weight / sum))
    }

    /// Moves points by a skeleton's `palette`, into the skeleton's space.
    pub fn deform(&self, palette: &[DMat4], points: &mut [Vec3]) {
        let blend = |point: usize| {
            let mut held = self.at(point).peekable();
            if held.peek().is_none() {
                return self.geom;
            }
            held.fold(DMat4::ZERO, |sum, (joint, weight)| sum + palette[joint as usize] * f64::from(weight))
                * self.geom
        };
        let all = (self.joints.len() == self.width).then(|| blend(0));
        for (i, point) in points.iter_mut().enumerate() {
            *point = all.unwrap_or_else(|| blend(i)).transform_point3(DVec3::from(*point)).as_vec3();
        }
    }
}
