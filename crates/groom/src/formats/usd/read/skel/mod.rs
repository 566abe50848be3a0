//! Skeletons (`UsdSkel`), which deform meshes and carry hair.
//!
//! ```text
//! Skeleton: joints, bind and rest transforms ─┬─► pose ─► palette ─┬─► curves: skinned points
//! SkelAnimation: joint transforms over time ──┘                    └─► meshes: a rig (rig.rs)
//! prims with a binding: joints and weights of points (bound.rs) ─────┘
//! ```
//!
//! Skinning moves a point `p` of a bound prim to `S · Σ w_j (P_j · B_j⁻¹) · G · p`. `G` is the prim's transform when it
//! was bound (the geom bind transform) and `B_j` are the joints' transforms, both in the world space of that time.
//! `P_j` are the joints' current transforms in the space of the skeleton, whose own transform is `S`. If the caller
//! selects no moment, curves are read at rest, like meshes.

mod bound;
mod rig;
#[cfg(test)]
mod tests;

pub(super) use bound::SkelBinding;
pub(super) use rig::Rigging;

use glam::{DMat4, DVec3};
use openusd::{
    sdf::{Path, Value},
    usd::{Prim, TimeCode},
};
use std::collections::HashMap;

use super::{
    Moment, Scene,
    tree::{Object, Tree},
    value,
};
use crate::{error::Result, formats::source::excerpt, rig::MAX_JOINTS};

/// Maximum length of a joint's path, bytes.
const LONGEST: usize = 4096;

/// All skeletons of a file.
#[derive(Default)]
pub(super) struct Skeletons(pub Vec<Skeleton>);

/// A skeleton: joints, parents before their children.
pub(super) struct Skeleton {
    pub prim: Prim,
    /// Paths of the joints, by which animations and bindings refer to them.
    pub joints: Vec<String>,
    /// Index of the joint of each path.
    pub joint_indices: HashMap<String, usize>,
    /// Names of the joints; their paths if the file has no names.
    pub names: Vec<String>,
    pub parents: Vec<Option<usize>>,
    /// Transforms of the joints when geometry was bound, in the world space of that time.
    pub bind: Vec<DMat4>,
    /// Transforms of the joints at rest, each in its parent's space.
    pub rest: Vec<DMat4>,
    /// Animation of the skeleton.
    pub animation: Option<Prim>,
    /// Index of the prim in the tree.
    own: usize,
}

impl Skeletons {
    pub fn read(scene: &Scene, tree: &Tree) -> Result<Self> {
        let all = tree.skeletons.iter().map(|(prim, own)| Skeleton::read(scene, tree, prim, *own));
        all.collect::<Result<_>>().map(Self)
    }

    /// Returns the skeleton that an object or one of its ancestors is bound to.
    fn of(&self, scene: &Scene, tree: &Tree, object: &Object) -> Result<Option<usize>> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let target = target(scene, tree.up(object), "skel:skeleton")?;
        Ok(target.and_then(|target| self.0.iter().position(|skeleton| *skeleton.prim.path() == target)))
    }

    /// Returns the time codes at which the animations of the objects' skeletons have samples.
    pub fn times(&self, scene: &Scene, tree: &Tree, objects: &[&Object]) -> Result<Vec<f64>> {
        let (mut all, mut used) = (Vec::new(), vec![false; self.0.len()]);
        for object in objects {
            if let Some(skeleton) = self.of(scene, tree, object)? {
                used[skeleton] = true;
            }
        }
        let used = self.0.iter().zip(used).filter(|(_, used)| *used);
        for prim in used.filter_map(|(skeleton, _)| skeleton.animation.as_ref()) {
            for name in MOVES {
                all.extend(scene.say(prim.attribute(name).time_sample_times())?);
            }
        }
        all.retain(|time| time.is_finite());
        Ok(all)
    }
}

/// Attributes of an animation that move joints.
const MOVES: [&str; 3] = ["translations", "rotations", "scales"];

impl Skeleton {
    fn read(scene: &Scene, tree: &Tree, prim: &Prim, own: usize) -> Result<Self> {
        let path = excerpt(prim.path().as_str());
        let broken = |problem: String| scene.problem(format!("{path}: {problem}"));
        let value =
            |name: &str| scene.say(prim.attribute(name.to_owned()).get_at::<Value>(TimeCode::EARLIEST));
        let joints = value("joints")?.as_ref().map(value::texts).unwrap_or_default();
        if joints.len() > MAX_JOINTS || joints.iter().any(|path| path.len() > LONGEST) {
            return Err(broken(format!(
                "the skeleton has more than {MAX_JOINTS} joints, or paths of more than {LONGEST} bytes"
            )));
        }
        let joint_indices: HashMap<String, usize> =
            joints.iter().enumerate().map(|(i, path)| (path.clone(), i)).collect();
        let parents = parents(&joints, &joint_indices).map_err(broken)?;
        let names = value("jointNames")?.as_ref().map(value::texts).unwrap_or_default();
        let names = if names.len() == joints.len() { names } else { joints.clone() };
        let matrices = |name: &str| -> Result<Vec<DMat4>> {
            let all = value(name)?.as_ref().map(value::matrices).unwrap_or_default();
            if !all.is_empty() && all.len() != joints.len() {
                return Err(broken(format!("{} {name} do not match {} joints", all.len(), joints.len())));
            }
            // A singular bind matrix has no inverse. A singular rest matrix is valid.
            let fits = |m: &DMat4| m.is_finite() && (name == "restTransforms" || m.determinant() != 0.0);
            match all.iter().all(fits) {
                true => Ok(all),
                false => Err(broken(format!("{name} are not finite or have no inverse"))),
            }
        };
        let (mut bind, mut rest) = (matrices("bindTransforms")?, matrices("restTransforms")?);
        if bind.is_empty() && rest.is_empty() && !joints.is_empty() {
            return Err(broken("the joints have neither bindTransforms nor restTransforms".into()));
        }
        if bind.is_empty() {
            bind = chained(&parents, &rest);
        }
        if rest.is_empty() {
            let local = |(i, matrix): (usize, &DMat4)| {
                parents[i].map_or(DMat4::IDENTITY, |parent| bind[parent].inverse()) * *matrix
            };
            rest = bind.iter().enumerate().map(local).collect();
        }
        // The skeleton or one of its ancestors names the animation.
        let source = target(scene, tree.above(own), "skel:animationSource")?;
        let animation =
            source.and_then(|source| tree.animations.iter().find(|prim| *prim.path() == source).cloned());
        Ok(Self { prim: prim.clone(), joints, joint_indices, names, parents, bind, rest, animation, own })
    }

    /// Returns the matrix from the skeleton's space to the file's.
    pub fn transform(&self, transforms: &[(DMat4, bool)]) -> DMat4 {
        transforms[self.own].0
    }

    /// Returns the skinning matrices, in the skeleton's space: at rest for [`Moment::First`], else at `time`.
    pub fn palette(&self, scene: &Scene, moment: Moment, time: TimeCode) -> Result<Vec<DMat4>> {
        let mut local = self.rest.clone();
        if let Some(animation) = self.animation.as_ref().filter(|_| !matches!(moment, Moment::First)) {
            let joints = animated(scene, animation)?;
            for (name, moved) in joints.iter().zip(moves(scene, animation, joints.len(), time)?) {
                if let Some(joint) = self.joint_indices.get(name) {
                    local[*joint] = moved;
                }
            }
        }
        let now = chained(&self.parents, &local);
        Ok(now.iter().zip(&self.bind).map(|(now, bind)| *now * bind.inverse()).collect())
    }
}

/// Returns the target of a relationship, from the first of `prims` that has one.
fn target<'p>(
    scene: &Scene,
    prims: impl Iterator<Item = &'p Prim>,
    name: &'static str,
) -> Result<Option<Path>> {
    for prim in prims {
        let targets = scene.say(prim.relationship(name).forwarded_targets())?;
        if let Some(target) = targets.into_iter().next() {
            return Ok(Some(target));
        }
    }
    Ok(None)
}

/// Returns the value of an attribute, from the first of `prims` that has one.
fn inherited<'p>(
    scene: &Scene,
    mut prims: impl Iterator<Item = &'p Prim>,
    name: &'static str,
    time: TimeCode,
) -> Result<Option<Value>> {
    prims.find_map(|prim| scene.say(prim.attribute(name).get_at(time)).transpose()).transpose()
}

/// Returns the joints that an animation moves.
fn animated(scene: &Scene, prim: &Prim) -> Result<Vec<String>> {
    let value = scene.say(prim.attribute("joints").get_at::<Value>(TimeCode::EARLIEST))?;
    Ok(value.as_ref().map(value::texts).unwrap_or_default())
}

/// Returns an animation's joint transforms at a time, each in its parent's space.
fn moves(scene: &Scene, prim: &Prim, count: usize, time: TimeCode) -> Result<Vec<DMat4>> {
    let value = |name: &str| scene.say(prim.attribute(name.to_owned()).get_at::<Value>(time));
    let broken = |what: &str| scene.problem(format!("{}: {what}", excerpt(prim.path().as_str())));
    let three = |name: &str| -> Result<Vec<f64>> {
        let row = value(name)?.as_ref().and_then(|value| value::row(value, |number| number));
        Ok(row.filter(|(_, width)| *width == 3).map(|(flat, _)| flat).unwrap_or_default())
    };
    let (translations, scales) = (three("translations")?, three("scales")?);
    let rotations = value("rotations")?.as_ref().map(value::rotations).unwrap_or_default();
    let fits = translations.len() == 3 * count
        && rotations.len() == count
        && (scales.is_empty() || scales.len() == 3 * count);
    if !fits {
        return Err(broken(&format!("the transforms of the animation do not match its {count} joints")));
    }
    let transform = |i: usize| {
        let at = |row: &[f64]| DVec3::from_slice(&row[3 * i..]);
        let scale = if scales.is_empty() { DVec3::ONE } else { at(&scales) };
        DMat4::from_scale_rotation_translation(
            scale,
            value::normalized_quaternion(rotations[i]),
            at(&translations),
        )
    };
    let transforms: Vec<_> = (0..count).map(transform).collect();
    match transforms.iter().all(DMat4::is_finite) {
        true => Ok(transforms),
        false => Err(broken("the transforms of the animation are not finite")),
    }
}

/// Returns the parent of each joint: the nearest ancestor on its path that is a joint.
fn parents(joints: &[String], known: &HashMap<String, usize>) -> Result<Vec<Option<usize>>, String> {
    let parent = |(i, path): (usize, &String)| {
        let mut above = path.as_str();
        while let Some((shorter, _)) = above.rsplit_once('/') {
            above = shorter;
            if let Some(parent) = known.get(above) {
                return match *parent < i {
                    true => Ok(Some(*parent)),
                    false => Err(format!("the joint {} precedes its parent", excerpt(path))),
                };
            }
        }
        Ok(None)
    };
    joints.iter().enumerate().map(parent).collect()
}

/// Concatenates local transforms to transforms in the skeleton's space.
fn chained(parents: &[Option<usize>], local: &[DMat4]) -> Vec<DMat4> {
    let mut all: Vec<DMat4> = Vec::with_capacity(local.len());
    for (parent, own) in parents.iter().zip(local) {
        all.push(parent.map_or(DMat4::IDENTITY, |parent| all[parent]) * *own);
    }
    all
}
