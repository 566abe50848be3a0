//! Rigs of meshes on skeletons.

use glam::{DMat4, DVec3, Mat4, Vec3};
use openusd::{
    sdf::Value,
    usd::{Prim, TimeCode},
};
use std::collections::HashMap;

use super::{MOVES, SkelBinding, Skeleton, Skeletons, animated, moves, value};
use crate::{
    TriMesh,
    error::Result,
    formats::{
        source::excerpt,
        usd::read::{Scene, tree::Object},
    },
    rig::{
        Animation, Bind, Channel, Curve, Delta, INFLUENCES, Interpolation, Joint, MAX_JOINTS, MorphTarget,
        Node, Property, Rig, Transform,
    },
};

/// A rig being read.
pub(in crate::formats::usd) struct Rigging {
    rig: Rig,
    /// Index of the first node and the first joint of each skeleton. The first node is the skeleton's own transform.
    first: Vec<(usize, usize)>,
    /// Palette entry of each skeleton's own transform, if a vertex follows it.
    roots: Vec<Option<u16>>,
    /// Notes on skipped data.
    notes: Vec<String>,
    targets: HashMap<String, usize>,
    bends: bool,
}

/// Placeholder joint of vertices that do not move, until the number of joints is known.
const STILL: u16 = u16::MAX;

impl Rigging {
    /// Begins a rig with the skeletons of a file.
    pub fn new(scene: &Scene, skeletons: &Skeletons, transforms: &[(DMat4, bool)]) -> Result<Self> {
        let mut rig = Rig::default();
        let mut first = Vec::new();
        for skeleton in &skeletons.0 {
            let node = |name: &str, parent: Option<usize>, matrix: Mat4| Node {
                name: name.rsplit('/').next().unwrap_or_default().to_owned(),
                parent: parent.map(|parent| parent as u32),
                rest: Transform::from_matrix(matrix),
                matrix: Some(matrix),
                ..Node::default()
            };
            let root = rig.nodes.len();
            first.push((root, rig.joints.len()));
            // Leave room for an entry per skeleton's own transform and for one that does not move.
            if rig.joints.len() + skeleton.joints.len() + skeletons.0.len() + 1 > MAX_JOINTS {
                return Err(scene.problem(format!("the skeletons have more than {MAX_JOINTS} joints")));
            }
            rig.nodes.push(node(
                skeleton.prim.path().as_str(),
                None,
                skeleton.transform(transforms).as_mat4(),
            ));
            for (i, name) in skeleton.names.iter().enumerate() {
                let parent = skeleton.parents[i].map_or(root, |parent| root + 1 + parent);
                rig.nodes.push(node(name, Some(parent), skeleton.rest[i].as_mat4()));
                let inverse_bind = skeleton.bind[i].inverse().as_mat4();
                rig.joints.push(Joint { node: (root + 1 + i) as u32, inverse_bind });
            }
        }
        let roots = vec![None; first.len()];
        Ok(Self { rig, first, roots, notes: Vec::new(), targets: HashMap::new(), bends: false })
    }

    /// Adds the vertices of a mesh. They are in the mesh's space, whose transform is `matrix`.
    pub fn add(
        &mut self,
        scene: &Scene,
        (object, matrix): (&Object, DMat4),
        bound: Option<&SkelBinding>,
        points: &[Vec3],
        time: TimeCode,
    ) -> Result<()> {
        let base = self.rig.vertices.len();
        let own = bound.map_or(matrix, |bound| bound.geom);
        for (i, point) in points.iter().enumerate() {
            let position = own.transform_point3(DVec3::from(*point)).as_vec3();
            let bind = match bound {
                Some(bound) => self.held(bound, i, position),
                None => Bind::rigid(position, Vec3::Y, STILL),
            };
            self.rig.vertices.push(bind);
        }
        self.bends |= bound.is_some();
        self.shapes(scene, object, own, (base, points.len()), time)
    }

    /// Returns a vertex with its strongest joints.
    fn held(&mut self, bound: &SkelBinding, point: usize, position: Vec3) -> Bind {
        let first = self.first[bound.skeleton].1;
        let mut all: Vec<(u32, f32)> = bound.at(point).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all.truncate(INFLUENCES);
        let sum: f32 = all.iter().map(|(_, weight)| weight).sum();
        if all.is_empty() {
            // A point without joints follows the skeleton's own transform.
            let (rig, root) = (&mut self.rig, self.first[bound.skeleton].0 as u32);
            let joint = *self.roots[bound.skeleton].get_or_insert_with(|| {
                rig.joints.push(Joint { node: root, inverse_bind: Mat4::IDENTITY });
                (rig.joints.len() - 1) as u16
            });
            return Bind::rigid(position, Vec3::Y, joint);
        }
        let mut bind = Bind { position, normal: Vec3::Y, joints: [0; 8], weights: [0.0; 8] };
        for (slot, (joint, weight)) in all.into_iter().enumerate() {
            bind.joints[slot] = (first + joint as usize) as u16;
            bind.weights[slot] = weight / sum;
        }
        bind
    }

    /// Adds the blend shapes of a mesh, which are in its own space.
    fn shapes(
        &mut self,
        scene: &Scene,
        object: &Object,
        own: DMat4,
        (base, count): (usize, usize),
        time: TimeCode,
    ) -> Result<()> {
        let value =
            |prim: &Prim, name: &str| scene.say(prim.attribute(name.to_owned()).get_at::<Value>(time));
        let names = value(&object.prim, "skel:blendShapes")?.as_ref().map(value::texts).unwrap_or_default();
        let targets = scene.say(object.prim.relationship("skel:blendShapeTargets").forwarded_targets())?;
        for (name, path) in names.iter().zip(&targets) {
            let prim = scene.say(scene.stage.prim(path.clone()).map_err(Into::into))?;
            let broken = |problem: &str| scene.problem(format!("{}: {problem}", excerpt(path.as_str())));
            let three = |name: &str| -> Result<Vec<f32>> {
                let row = value(&prim, name)?.as_ref().and_then(|value| value::row(value, |n| n as f32));
                Ok(row.filter(|(_, width)| *width == 3).map(|(flat, _)| flat).unwrap_or_default())
            };
            let (offsets, normals) = (three("offsets")?, three("normalOffsets")?);
            let indices = value(&prim, "pointIndices")?;
            let indices = indices.as_ref().and_then(|value| value::row(value, |n| n as i64));
            let indices = indices.map_or_else(|| (0..count as i64).collect(), |(indices, _)| indices);
            if offsets.len() != 3 * indices.len() {
                return Err(broken("the offsets do not match the points"));
            }
            scene.take(indices.len() as u64)?;
            let upright = own.inverse().transpose();
            let mut deltas = Vec::with_capacity(indices.len());
            for (i, vertex) in indices.iter().enumerate() {
                let Some(vertex) = usize::try_from(*vertex).ok().filter(|vertex| *vertex < count) else {
                    return Err(broken("a point index is out of range"));
                };
                let at = |row: &[f32]| row.get(3 * i..3 * i + 3).map(|v| DVec3::from(Vec3::from_slice(v)));
                let position = own.transform_vector3(at(&offsets).unwrap_or_default()).as_vec3();
                let normal = upright.transform_vector3(at(&normals).unwrap_or_default()).as_vec3();
                if !position.is_finite() || !normal.is_finite() {
                    return Err(broken("the offsets are not finite"));
                }
                deltas.push(Delta { vertex: (base + vertex) as u32, position, normal });
            }
            deltas.sort_by_key(|delta| delta.vertex);
            deltas.dedup_by_key(|delta| delta.vertex);
            let next = self.rig.targets.len();
            match self.targets.get(name) {
                Some(known) => self.rig.targets[*known].deltas.extend(deltas),
                None => {
                    self.targets.insert(name.clone(), next);
                    self.rig.targets.push(MorphTarget { name: name.clone(), deltas });
                }
            }
        }
        Ok(())
    }

    /// Returns the rig with the file's `animations`, and moves `mesh` to the rest pose. `None` if nothing deforms.
    pub fn finish(
        mut self,
        scene: &Scene,
        skeletons: &Skeletons,
        animations: &[Prim],
        mesh: &mut TriMesh,
    ) -> Result<(Option<Rig>, Vec<String>)> {
        if !self.bends && self.rig.targets.is_empty() {
            return Ok((None, Vec::new()));
        }
        if self.rig.nodes.is_empty() || self.rig.vertices.iter().any(|vertex| vertex.joints[0] == STILL) {
            let joint = self.rig.joints.len() as u16;
            self.rig.joints.push(Joint { node: self.rig.nodes.len() as u32, inverse_bind: Mat4::IDENTITY });
            self.rig.nodes.push(Node::default());
            let still = self.rig.vertices.iter_mut().filter(|vertex| vertex.joints[0] == STILL);
            still.for_each(|vertex| vertex.joints = [joint; INFLUENCES]);
        }
        // The animations that skeletons refer to come first.
        let own = |prim: &&Prim| {
            skeletons.0.iter().any(|s| s.animation.as_ref().is_some_and(|own| own.path() == prim.path()))
        };
        let (first, others): (Vec<&Prim>, Vec<&Prim>) = animations.iter().partition(own);
        for prim in first.into_iter().chain(others) {
            match self.animation(scene, skeletons, prim) {
                Ok(animation) => {
                    self.rig.animations.extend(animation.filter(|animation| !animation.channels.is_empty()));
                }
                // A mesh with an invalid animation is still usable.
                Err(error) => self.notes.push(format!("an animation is skipped: {error}")),
            }
        }
        let rest = self.rig.rest_pose();
        self.rig.deform(&rest, mesh);
        mesh.normals.clear();
        Ok((Some(self.rig), self.notes))
    }

    /// Returns an animation of the joints and blend shapes that it names. Time 0 is its first key.
    fn animation(&self, scene: &Scene, skeletons: &Skeletons, prim: &Prim) -> Result<Option<Animation>> {
        let per_second = Some(scene.stage.time_codes_per_second()).filter(|rate| *rate > 0.0).unwrap_or(24.0);
        let times = |names: &[&str]| -> Result<Vec<f64>> {
            let mut all = Vec::new();
            for name in names {
                all.extend(scene.say(prim.attribute(name.to_string()).time_sample_times())?);
            }
            all.retain(|time: &f64| time.is_finite());
            all.sort_by(f64::total_cmp);
            all.dedup();
            Ok(all)
        };
        let (mut stamps, weights) = (times(&MOVES)?, times(&["blendShapeWeights"])?);
        let joints = animated(scene, prim)?;
        let held = scene.say(prim.attribute(MOVES[0]).get_at::<Value>(TimeCode::EARLIEST))?.is_some();
        if stamps.is_empty() && held {
            // An animation without samples holds one pose.
            stamps.push(weights.first().copied().unwrap_or(0.0));
        }
        let all = stamps.iter().chain(&weights).copied();
        let Some(start) = all.clone().reduce(f64::min) else { return Ok(None) };
        let end = all.fold(start, f64::max);
        let seconds = |time: &f64| ((time - start) / per_second) as f32;
        let mut channels = Vec::new();
        if !stamps.is_empty() {
            let mut keys = Vec::with_capacity(stamps.len());
            for time in &stamps {
                scene.take(joints.len() as u64)?;
                keys.push(moves(scene, prim, joints.len(), TimeCode::new(*time))?);
            }
            let stamps: Vec<f32> = stamps.iter().map(seconds).collect();
            // An animation that some skeletons refer to does not move the others.
            let is_animated =
                |skeleton: &Skeleton| skeleton.animation.as_ref().map(Prim::path) == Some(prim.path());
            let free = !skeletons.0.iter().any(is_animated);
            for (skeleton, (root, _)) in skeletons.0.iter().zip(&self.first) {
                if !free && !is_animated(skeleton) {
                    continue;
                }
                for (at, name) in joints.iter().enumerate() {
                    let Some(joint) = skeleton.joint_indices.get(name) else { continue };
                    scene.take(keys.len() as u64)?;
                    let node = (root + 1 + joint) as u32;
                    let parts = keys.iter().map(|key| Transform::from_matrix(key[at].as_mat4()));
                    let parts: Vec<Transform> = parts.collect();
                    let curve = |values: Vec<f32>| Curve {
                        interpolation: Interpolation::Linear,
                        times: stamps.clone(),
                        values,
                    };
                    let three = |of: fn(&Transform) -> Vec3| {
                        curve(parts.iter().flat_map(|part| of(part).to_array()).collect())
                    };
                    let rotations = parts.iter().flat_map(|part| part.rotation.to_array()).collect();
                    channels.extend([
                        Channel { node, property: Property::Translation, curve: three(|t| t.translation) },
                        Channel { node, property: Property::Rotation, curve: curve(rotations) },
                        Channel { node, property: Property::Scale, curve: three(|t| t.scale) },
                    ]);
                }
            }
        }
        channels.extend(self.weights(scene, prim, &weights, seconds)?);
        let name = prim.path().as_str().rsplit('/').next().unwrap_or_default().to_owned();
        Ok(Some(Animation { name, length: seconds(&end), channels }))
    }

    /// Returns the channel of an animation's blend shape weights.
    fn weights(
        &self,
        scene: &Scene,
        prim: &Prim,
        times: &[f64],
        seconds: impl Fn(&f64) -> f32,
    ) -> Result<Option<Channel>> {
        let value =
            |name: &str, time: TimeCode| scene.say(prim.attribute(name.to_owned()).get_at::<Value>(time));
        let names = value("blendShapes", TimeCode::EARLIEST)?.as_ref().map(value::texts).unwrap_or_default();
        let known: Vec<(usize, u32)> = names
            .iter()
            .enumerate()
            .filter_map(|(i, name)| Some((i, *self.targets.get(name)? as u32)))
            .collect();
        if times.is_empty() || known.is_empty() {
            return Ok(None);
        }
        let mut values = Vec::new();
        for time in times {
            let row = value("blendShapeWeights", TimeCode::new(*time))?;
            let row = row.as_ref().and_then(|value| value::row(value, |n| n as f32)).unwrap_or_default().0;
            if row.len() != names.len() || row.iter().any(|weight| !weight.is_finite()) {
                let path = excerpt(prim.path().as_str());
                return Err(scene
                    .problem(format!("{path}: the weights do not match its {} blend shapes", names.len())));
            }
            scene.take(row.len() as u64)?;
            values.extend(known.iter().map(|(i, _)| row[*i]));
        }
        let curve = Curve {
            interpolation: Interpolation::Linear,
            times: times.iter().map(seconds).collect(),
            values,
        };
        let property = Property::Weights(known.iter().map(|(_, target)| *target).collect());
        Ok(Some(Channel { node: 0, property, curve }))
    }
}
