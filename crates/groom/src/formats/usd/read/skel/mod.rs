//! Skeletons (`UsdSkel`): what bends meshes, and what hair goes with.
//!
//! ```text
//! Skeleton: joints, bind and rest transforms ─┬─► pose ─► palette ─┬─► curves: their points, brought along
//! SkelAnimation: joints' moves over time ─────┘                    └─► meshes: a rig (rig.rs)
//! prims with a binding: joints and weights of points (bound.rs) ─────┘
//! ```
//!
//! A point `p` of a bound prim is at `S · Σ w_j (P_j · B_j⁻¹) · G · p`: its own place when it was bound is `G` (the geom bind
//! transform), those of the joints are `B`, both in the world of that time; `P` are joints now, in the space of the
//! skeleton, which is at `S`. Curves are read as their bodies are, at rest, where no moment is asked for.

mod bound;
mod rig;
#[cfg(test)]
mod tests;

pub(super) use bound::Bound;
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

/// The longest path of a joint, bytes.
const LONGEST: usize = 4096;

/// All that a file has of it.
#[derive(Default)]
pub(super) struct Skeletons(pub Vec<Skeleton>);

/// Joints, parents before their children.
pub(super) struct Skeleton {
    pub prim: Prim,
    /// The paths of joints below each other, by which animations and bindings name them.
    pub joints: Vec<String>,
    /// Where each path stands among them.
    pub places: HashMap<String, usize>,
    /// What they are called, where that is said.
    pub names: Vec<String>,
    pub parents: Vec<Option<usize>>,
    /// Where joints were when geometry was bound, the world of that time.
    pub bind: Vec<DMat4>,
    /// Where joints are at rest, each in the space of its parent.
    pub rest: Vec<DMat4>,
    /// What moves it.
    pub animation: Option<Prim>,
    /// Its index among the prims of the tree.
    own: usize,
}

impl Skeletons {
    pub fn read(scene: &Scene, tree: &Tree) -> Result<Self> {
        let all = tree.skeletons.iter().map(|(prim, own)| Skeleton::read(scene, tree, prim, *own));
        all.collect::<Result<_>>().map(Self)
    }

    /// The skeleton that an object is bound to, by what it or what it is in says.
    fn of(&self, scene: &Scene, tree: &Tree, object: &Object) -> Result<Option<usize>> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let target = target(scene, tree.up(object), "skel:skeleton")?;
        Ok(target.and_then(|target| self.0.iter().position(|skeleton| *skeleton.prim.path() == target)))
    }

    /// The time codes at which what moves the skeletons of some objects is sampled.
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

/// What an animation says of joints.
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
                "more than {MAX_JOINTS} joints, or paths of more than {LONGEST} bytes"
            )));
        }
        let places: HashMap<String, usize> =
            joints.iter().enumerate().map(|(i, path)| (path.clone(), i)).collect();
        let parents = parents(&joints, &places).map_err(broken)?;
        let names = value("jointNames")?.as_ref().map(value::texts).unwrap_or_default();
        let names = if names.len() == joints.len() { names } else { joints.clone() };
        let matrices = |name: &str| -> Result<Vec<DMat4>> {
            let all = value(name)?.as_ref().map(value::matrices).unwrap_or_default();
            if !all.is_empty() && all.len() != joints.len() {
                return Err(broken(format!("{} {name} of {} joints", all.len(), joints.len())));
            }
            // What is bound where it was flat has no way back; what rests flat may.
            let fits = |m: &DMat4| m.is_finite() && (name == "restTransforms" || m.determinant() != 0.0);
            match all.iter().all(fits) {
                true => Ok(all),
                false => Err(broken(format!("{name} that are not finite or flatten"))),
            }
        };
        let (mut bind, mut rest) = (matrices("bindTransforms")?, matrices("restTransforms")?);
        if bind.is_empty() && rest.is_empty() && !joints.is_empty() {
            return Err(broken("joints that are at no place".into()));
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
        // What moves it stands at it or above it.
        let source = target(scene, tree.above(own), "skel:animationSource")?;
        let animation =
            source.and_then(|source| tree.animations.iter().find(|prim| *prim.path() == source).cloned());
        Ok(Self { prim: prim.clone(), joints, places, names, parents, bind, rest, animation, own })
    }

    /// From its space to the file's.
    pub fn place(&self, places: &[(DMat4, bool)]) -> DMat4 {
        places[self.own].0
    }

    /// What brings what was bound to where its joints are, in the skeleton's space: at rest, or at the time of another
    /// moment.
    pub fn palette(&self, scene: &Scene, moment: Moment, time: TimeCode) -> Result<Vec<DMat4>> {
        let mut local = self.rest.clone();
        if let Some(animation) = self.animation.as_ref().filter(|_| !matches!(moment, Moment::First)) {
            let joints = animated(scene, animation)?;
            for (name, moved) in joints.iter().zip(moves(scene, animation, joints.len(), time)?) {
                if let Some(joint) = self.places.get(name) {
                    local[*joint] = moved;
                }
            }
        }
        let now = chained(&self.parents, &local);
        Ok(now.iter().zip(&self.bind).map(|(now, bind)| *now * bind.inverse()).collect())
    }
}

/// What the innermost of some prims that says it refers to by this name.
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

/// The value that the innermost of some prims that has one has of this name.
fn inherited<'p>(
    scene: &Scene,
    mut prims: impl Iterator<Item = &'p Prim>,
    name: &'static str,
    time: TimeCode,
) -> Result<Option<Value>> {
    prims.find_map(|prim| scene.say(prim.attribute(name).get_at(time)).transpose()).transpose()
}

/// The joints that an animation moves.
fn animated(scene: &Scene, prim: &Prim) -> Result<Vec<String>> {
    let value = scene.say(prim.attribute("joints").get_at::<Value>(TimeCode::EARLIEST))?;
    Ok(value.as_ref().map(value::texts).unwrap_or_default())
}

/// Where an animation has its joints at a time, each in the space of its parent.
fn moves(scene: &Scene, prim: &Prim, count: usize, time: TimeCode) -> Result<Vec<DMat4>> {
    let value = |name: &str| scene.say(prim.attribute(name.to_owned()).get_at::<Value>(time));
    let broken = |what: &str| scene.problem(format!("{}: {what}", excerpt(prim.path().as_str())));
    let three = |name: &str| -> Result<Vec<f64>> {
        let row = value(name)?.as_ref().and_then(|value| value::row(value, |number| number));
        Ok(row.filter(|(_, width)| *width == 3).map(|(flat, _)| flat).unwrap_or_default())
    };
    let (moved, scaled) = (three("translations")?, three("scales")?);
    let turned = value("rotations")?.as_ref().map(value::rotations).unwrap_or_default();
    let fits =
        moved.len() == 3 * count && turned.len() == count && (scaled.is_empty() || scaled.len() == 3 * count);
    if !fits {
        return Err(broken(&format!("moves that do not fit its {count} joints")));
    }
    let place = |i: usize| {
        let at = |row: &[f64]| DVec3::from_slice(&row[3 * i..]);
        let scale = if scaled.is_empty() { DVec3::ONE } else { at(&scaled) };
        DMat4::from_scale_rotation_translation(scale, value::turn(turned[i]), at(&moved))
    };
    let places: Vec<_> = (0..count).map(place).collect();
    match places.iter().all(DMat4::is_finite) {
        true => Ok(places),
        false => Err(broken("moves that are not finite")),
    }
}

/// What each joint hangs from: the nearest that its path leads through.
fn parents(joints: &[String], known: &HashMap<String, usize>) -> Result<Vec<Option<usize>>, String> {
    let parent = |(i, path): (usize, &String)| {
        let mut above = path.as_str();
        while let Some((shorter, _)) = above.rsplit_once('/') {
            above = shorter;
            if let Some(parent) = known.get(above) {
                return match *parent < i {
                    true => Ok(Some(*parent)),
                    false => Err(format!("the joint {} stands before what it hangs from", excerpt(path))),
                };
            }
        }
        Ok(None)
    };
    joints.iter().enumerate().map(parent).collect()
}

/// Transforms below each other as ones from the space of all of them.
fn chained(parents: &[Option<usize>], local: &[DMat4]) -> Vec<DMat4> {
    let mut all: Vec<DMat4> = Vec::with_capacity(local.len());
    for (parent, own) in parents.iter().zip(local) {
        all.push(parent.map_or(DMat4::IDENTITY, |parent| all[parent]) * *own);
    }
    all
}
