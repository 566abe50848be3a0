//! A body that bends: which of its joints the hair goes with, what its other parts are to hair, and the poses of its
//! motions.
//!
//! The joint that carries most of the roots is the *head*: hair is simulated relative to it, and its part of the body is
//! the distance field that hair collides with most. Every other joint near the hair carries a part of the body, a distance
//! field of its own; parts overlap by a ring of triangles where they meet. What is far from the hair while the body rests,
//! arms, hands and legs, is a capsule each ([`limbs`]): a hand comes near when it is raised, and is thin all the same.
//! A file of colliders may say otherwise of any joint ([`Anatomy::arrange`]).

use anyhow::{Context, Result, bail};
use std::collections::HashMap;
use tresses::{
    Hair, Pipelines, Pose,
    body::Body,
    collide::FieldId,
    glam::{Mat4, Quat, Vec3},
    gpu::Gpu,
    groom::{
        SdfGrid, Strands, TriMesh, mannequin,
        mesh::{Bvh, SdfOptions, sdf},
        rig::{Rig, RigPose},
    },
    skinning::Skinning,
};

use crate::{
    colliders::{Field, Joint, Role},
    flesh::Flesh,
    limbs::{self, Capsule, Fitted},
    motion::Gesture,
};

/// The most parts besides the head that are fields, and that are capsules.
const MOST_PARTS: usize = 24;
const MOST_CAPSULES: usize = 48;
/// Nodes along the longest side of a part's field, and the fewest triangles that are worth one.
const FINE: u32 = 40;
const LEAST: usize = 12;
/// What a neck has of a turn of the head on it.
const NECK_SHARE: f32 = 0.4;

/// A part of the body that a node carries.
#[derive(Clone, Debug)]
pub struct Part {
    /// Of the rig.
    pub node: u32,
    /// Its surface at rest, groom space.
    pub field: Field,
    /// What hair collides with.
    pub form: PartForm,
    /// Multiplies the coefficient of friction.
    pub friction: f32,
    /// How many vertices follow the node most.
    pub vertices: usize,
    /// The capsule that is most like it, where it is known and there is one.
    pub fitted: Option<Fitted>,
}

/// What a part of a body is to hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartForm {
    /// Its distance field.
    Field,
    /// A capsule, groom space at rest.
    Capsule(Capsule),
    /// Hair passes through it.
    Nothing,
}

impl Part {
    fn new(node: u32, field: Field, form: PartForm) -> Self {
        Self { node, field, form, friction: 1.0, vertices: 0, fitted: None }
    }
}

/// A body that bends, and how hair sees it.
#[derive(Clone, Debug)]
pub struct Anatomy {
    /// What moves it.
    pub rig: Rig,
    /// The node that hair goes with, and its part of the body.
    pub head: Part,
    /// The parts that others carry, those near the hair first.
    pub parts: Vec<Part>,
    /// The nodes that turn when the head does, a parent before its children, each with its share of the turn.
    pub turns: Vec<(u32, f32)>,
    /// Whether all roots are known to lie on skin that goes with the head's joint, whatever the pose.
    pub is_rigid: bool,
}

impl Anatomy {
    /// Of the built-in character, whose distance field `bust` is.
    pub fn built_in(mesh: &TriMesh, bust: &SdfGrid) -> Self {
        use mannequin::rig;
        let [torso, neck, head] = rig::parts(bust).map(Field::Grid);
        let part = |node, field| Part::new(node, field, PartForm::Field);
        Self {
            rig: rig::rig(mesh),
            head: part(2, head),
            parts: vec![part(1, neck), part(0, torso)],
            turns: rig::SHARES.to_vec(),
            is_rigid: true,
        }
    }

    /// Of the body `mesh` (groom space) that `strands` grow on.
    ///
    /// # Errors
    /// When no triangle of the body is near any root.
    pub fn new(rig: Rig, mesh: &TriMesh, strands: &Strands) -> Result<Self> {
        let holder: Vec<u32> = rig.vertices.iter().map(|vertex| holder(&rig, vertex)).collect();
        let bvh = Bvh::new(mesh);
        let mut votes: HashMap<u32, usize> = HashMap::new();
        let roots: Vec<Vec3> = strands.iter().filter_map(|strand| strand.first().copied()).collect();
        // Some hundreds tell as much as all.
        for root in roots.iter().step_by((roots.len() / 500).max(1)) {
            if let Some(closest) = bvh.closest_point(*root) {
                let corners = mesh.triangles[closest.triangle as usize];
                *votes.entry(holder[corners[0] as usize]).or_default() += 1;
            }
        }
        let head = votes.into_iter().max_by_key(|(node, votes)| (*votes, u32::MAX - node));
        let head = head.context("no root lies on the body")?.0;
        let owners = owners(&rig, head);
        let of = |vertex: u32| owners[vertex as usize];
        let triangles = by_node(mesh, of);
        let reach = strands.iter().map(|strand| strand.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>());
        let reach = reach.fold(0.0f32, f32::max) + 0.05;
        let bounds =
            roots.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let (mut parts, mut own) = (Vec::new(), TriMesh::default());
        for (node, triangles) in triangles {
            let part = cut(mesh, &triangles);
            let far = apart(bounds, part.bounds());
            if node == head {
                own = part;
            } else {
                parts.push((far, triangles, Part::new(node, Field::Mesh(part, fine()), PartForm::Nothing)));
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.node.cmp(&b.2.node)));
        let (mut fields, mut capsules) = (0, 0);
        for (far, triangles, part) in &mut parts {
            let is_own = |vertex: u32| of(vertex) == part.node;
            part.vertices = (0..owners.len() as u32).filter(|vertex| is_own(*vertex)).count();
            part.fitted = limbs::fit(mesh, triangles, is_own);
            let is_worth = triangles.len() >= LEAST;
            if is_worth && *far < reach && fields < MOST_PARTS {
                part.form = PartForm::Field;
                fields += 1;
            } else if let Some(fitted) = part.fitted.filter(|_| is_worth && capsules < MOST_CAPSULES) {
                part.form = PartForm::Capsule(fitted.capsule);
                capsules += 1;
            }
        }
        let parts = parts.into_iter().map(|(.., part)| part).collect();
        let turns = turns(&rig, head);
        let head = Part::new(head, Field::Mesh(own, SdfOptions::default()), PartForm::Field);
        Ok(Self { rig, head, parts, turns, is_rigid: false })
    }

    /// What to collide with besides the head.
    pub fn solids(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter().filter(|part| part.form != PartForm::Nothing)
    }

    /// Makes the fields of parts that hair collides with. What encloses nothing, as cards of lashes, stays a mesh: it is
    /// left to the GPU, which asks nothing of one.
    pub fn measure(&mut self) {
        for part in self.parts.iter_mut().filter(|part| part.form == PartForm::Field) {
            if let Field::Mesh(mesh, options) = &part.field
                && let Ok(grid) = sdf::build(mesh, options)
            {
                part.field = Field::Grid(grid);
            }
        }
    }

    /// Takes fields that were [measured](Self::measure) before, each with the node that carries its part.
    pub fn know(&mut self, fields: Vec<(u32, SdfGrid)>) {
        for (node, grid) in fields {
            if let Some(part) = self.parts.iter_mut().find(|part| part.node == node) {
                part.field = Field::Grid(grid);
            }
        }
    }

    /// What `joints` say becomes of the parts that they name; `mesh` is the body's.
    ///
    /// # Errors
    /// One sentence for a joint that is not there, that holds nothing, or that is the head's.
    pub fn arrange(&mut self, joints: &[Joint], mesh: &TriMesh) -> Result<()> {
        for joint in joints {
            let named = self.named(&joint.joint)?;
            if named.contains(&self.head.node) {
                bail!("hair grows on the joint {:?}: its part is always a distance field", joint.joint);
            }
            let mut found = false;
            for part in self.parts.iter_mut().filter(|part| named.contains(&part.node)) {
                found = true;
                part.friction = joint.friction;
                part.form = match joint.shape {
                    Role::Nothing => PartForm::Nothing,
                    Role::Field => PartForm::Field,
                    Role::Capsule { from, to, radius } => {
                        PartForm::Capsule(Capsule { ends: [from, to].map(Vec3::from), radius })
                    }
                    Role::Fitted => {
                        let rig = &self.rig;
                        let of = |vertex: u32| holder(rig, &rig.vertices[vertex as usize]);
                        let own = || by_node(mesh, of).remove(&part.node).unwrap_or_default();
                        let fit = || limbs::fit(mesh, &own(), |vertex| of(vertex) == part.node);
                        part.fitted = part.fitted.or_else(fit);
                        let fitted = part.fitted.with_context(|| {
                            format!("the joint {:?} holds too little to fit a capsule to", joint.joint)
                        })?;
                        PartForm::Capsule(fitted.capsule)
                    }
                };
            }
            if !found {
                bail!("the joint {:?} holds nothing", joint.joint);
            }
        }
        Ok(())
    }

    /// What a node is called: its name, or `#` and its number.
    pub fn name(&self, node: u32) -> String {
        match &*self.rig.nodes[node as usize].name {
            "" => format!("#{node}"),
            name => name.to_owned(),
        }
    }

    /// The nodes of this name, upper and lower case alike if none is exactly so.
    fn named(&self, name: &str) -> Result<Vec<u32>> {
        let all = || 0..self.rig.nodes.len() as u32;
        let mut found: Vec<u32> = all().filter(|node| self.name(*node) == name).collect();
        if found.is_empty() {
            let lower = name.to_lowercase();
            found = all().filter(|node| self.name(*node).to_lowercase() == lower).collect();
        }
        if found.is_empty() {
            let names: Vec<_> = self.parts.iter().map(|part| self.name(part.node)).collect();
            let there = if names.is_empty() { "none".into() } else { names.join(", ") };
            bail!("the body has no joint {name:?}; parts are carried by {there}");
        }
        Ok(found)
    }
}

/// How finely a part's field is made.
fn fine() -> SdfOptions {
    SdfOptions { resolution: FINE, ..Default::default() }
}

/// The triangles of each node: all with a corner that is `of` it.
pub(crate) fn by_node(mesh: &TriMesh, of: impl Fn(u32) -> u32) -> HashMap<u32, Vec<[u32; 3]>> {
    let mut triangles: HashMap<u32, Vec<[u32; 3]>> = HashMap::new();
    for triangle in &mesh.triangles {
        let mut nodes = triangle.map(&of);
        nodes.sort_unstable();
        for (i, node) in nodes.iter().enumerate() {
            if i == 0 || nodes[i - 1] != *node {
                triangles.entry(*node).or_default().push(*triangle);
            }
        }
    }
    triangles
}

/// The node that carries most of a vertex.
fn holder(rig: &Rig, vertex: &tresses::groom::rig::Bind) -> u32 {
    let most = (0..vertex.weights.len()).max_by(|a, b| vertex.weights[*a].total_cmp(&vertex.weights[*b]));
    most.and_then(|i| rig.joints.get(usize::from(vertex.joints[i]))).map_or(0, |joint| joint.node)
}

/// The node that carries most of each vertex; eyes and jaws go with the head.
pub(crate) fn owners(rig: &Rig, head: u32) -> Vec<u32> {
    let on_head: Vec<bool> = (0..rig.nodes.len() as u32).map(|node| goes_with(rig, node, head)).collect();
    let owner = |node: u32| if on_head[node as usize] { head } else { node };
    rig.vertices.iter().map(|vertex| owner(holder(rig, vertex))).collect()
}

/// What turns when the head does: its own node, and before that a neck's, if it hangs from one.
fn turns(rig: &Rig, head: u32) -> Vec<(u32, f32)> {
    let neck = rig.nodes[head as usize].parent;
    match neck.filter(|node| rig.nodes[*node as usize].name.to_lowercase().contains("neck")) {
        Some(neck) => vec![(neck, NECK_SHARE), (head, 1.0 - NECK_SHARE)],
        None => vec![(head, 1.0)],
    }
}

/// Whether `node` is `head` or below it.
fn goes_with(rig: &Rig, node: u32, head: u32) -> bool {
    let mut at = Some(node);
    while let Some(node) = at {
        if node == head {
            return true;
        }
        at = rig.nodes[node as usize].parent;
    }
    false
}

/// The distance between two boxes, metres.
fn apart(a: (Vec3, Vec3), b: Option<(Vec3, Vec3)>) -> f32 {
    b.map_or(f32::INFINITY, |b| (a.0 - b.1).max(b.0 - a.1).max(Vec3::ZERO).length())
}

/// These triangles of a mesh, with only the vertices that they have.
fn cut(mesh: &TriMesh, triangles: &[[u32; 3]]) -> TriMesh {
    let mut places = HashMap::new();
    let mut part = TriMesh::default();
    for triangle in triangles {
        part.triangles.push(triangle.map(|vertex| {
            *places.entry(vertex).or_insert_with(|| {
                part.positions.push(mesh.positions[vertex as usize]);
                part.normals.extend(mesh.normals.get(vertex as usize));
                part.positions.len() as u32 - 1
            })
        }));
    }
    part
}

/// The rigid part of how a node moved: where `now` has what `rest` had, without scale.
fn moved(now: &Mat4, rest: &Mat4) -> Pose {
    let matrix = *now * rest.inverse();
    let (_, rotation, _) = matrix.to_scale_rotation_translation();
    let rotation = if rotation.is_finite() { rotation.normalize() } else { Quat::IDENTITY };
    // The node's own origin is where the motion has it, whatever its scale.
    let (from, to) = (rest.w_axis.truncate(), now.w_axis.truncate());
    Pose { rotation, translation: to - rotation * from }
}

/// A body on the GPU that bends.
pub struct Living {
    anatomy: Anatomy,
    skinning: Skinning,
    rest: RigPose,
    /// Whether the head's field deforms with the skin, and those of the other solids: nothing of a body that has not bent.
    deforms: Vec<bool>,
    animation: Option<usize>,
    /// How much there is of shapes, whatever motions and gestures say.
    shapes: Vec<(usize, f32)>,
}

/// Where everything is at one time, relative to the body.
pub struct Stance {
    /// The head.
    pub head: Pose,
    /// What carries the other parts that hair collides with, relative to where it rests.
    pub parts: Vec<Pose>,
    /// Whether anything of the body is not where it rests.
    pub is_bent: bool,
}

impl Living {
    /// Bends `body`, which was made of the anatomy's mesh.
    ///
    /// # Errors
    /// When the adapter cannot hold it.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, anatomy: Anatomy, body: &Body) -> Result<Self> {
        let rig = &anatomy.rig;
        let skinning = Skinning::new(&gpu.device, &gpu.queue, &pipelines.skinning, rig, body)?;
        let rest = rig.rest_pose();
        Ok(Self { skinning, rest, deforms: Vec::new(), animation: None, shapes: Vec::new(), anatomy })
    }

    /// The names of its motions.
    pub fn animations(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.animations.iter().map(|animation| animation.name.as_str())
    }

    /// The names of its shapes.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.targets.iter().map(|target| target.name.as_str())
    }

    /// From here on it moves as the motion of this name has it, or stands still.
    ///
    /// # Errors
    /// One sentence with the names that there are.
    pub fn set_animation(&mut self, name: Option<&str>) -> Result<()> {
        let rig = &self.anatomy.rig;
        let Some(name) = name else {
            self.animation = None;
            return Ok(());
        };
        let Some(animation) = rig.animation(name) else {
            let names: Vec<_> = self.animations().collect();
            let there = if names.is_empty() { "none".into() } else { names.join(", ") };
            bail!("the body has no animation {name:?}; it has {there}");
        };
        self.animation = rig.animations.iter().position(|other| std::ptr::eq(other, animation));
        Ok(())
    }

    /// From here on there is as much of a shape as said, whatever the motion says.
    ///
    /// # Errors
    /// One sentence with the names that there are, or when `weight` is not finite.
    pub fn set_shape(&mut self, name: &str, weight: f32) -> Result<()> {
        if !weight.is_finite() {
            bail!("the weight of the shape {name:?} is no number");
        }
        let shape = self.find_shape(name)?;
        self.shapes.retain(|(other, _)| *other != shape);
        self.shapes.push((shape, weight));
        Ok(())
    }

    /// The number of the shape of this name.
    ///
    /// # Errors
    /// One sentence with the names that there are.
    pub fn find_shape(&self, name: &str) -> Result<usize> {
        self.anatomy.rig.target(name).with_context(|| {
            let names: Vec<_> = self.shapes().collect();
            let there = if names.is_empty() { "none".into() } else { names.join(", ") };
            format!("the body has no shape {name:?}; it has {there}")
        })
    }

    /// The name of its motion; `None` while it stands still.
    pub fn animation(&self) -> Option<&str> {
        self.animation.map(|i| self.anatomy.rig.animations[i].name.as_str())
    }

    /// How much there is of a shape, by its number, where that has been [set](Self::set_shape).
    pub fn shape(&self, number: usize) -> Option<f32> {
        self.shapes.iter().find(|(shape, _)| *shape == number).map(|(_, weight)| *weight)
    }

    /// From here on motions say how much there is of a shape, by its number.
    pub fn free_shape(&mut self, number: usize) {
        self.shapes.retain(|(shape, _)| *shape != number);
    }

    /// Does what `other` does, as far as it can: the same body with other hair.
    pub fn go_on(&mut self, other: &Self) {
        // What it does not have it does not do.
        self.animation = None;
        if let Some(name) = other.animation() {
            let _ = self.set_animation(Some(name));
        }
        self.shapes.clear();
        for (shape, weight) in &other.shapes {
            let _ = self.set_shape(&other.anatomy.rig.targets[*shape].name, *weight);
        }
    }

    /// How long its motion is, s; `None` while it stands still.
    pub fn duration(&self) -> Option<f32> {
        self.animation.map(|i| self.anatomy.rig.animations[i].length)
    }

    /// Brings `body` to where it is at `time`, s, while it makes a gesture. A shape that the gesture names and the body
    /// does not have is none of its own.
    ///
    /// # Errors
    /// When the body is another's.
    pub fn pose(&mut self, gpu: &Gpu, time: f64, gesture: &Gesture, body: &mut Body) -> Result<Stance> {
        let rig = &self.anatomy.rig;
        let animation = self.animation.map(|i| &rig.animations[i]);
        // A long time has few digits left for what is within a loop.
        let animation = animation.map(|it| (it, time.rem_euclid(f64::from(it.length.max(1e-3))) as f32));
        let turn = gesture.head.rotation;
        let is_turned = turn != Quat::IDENTITY;
        let share = |(node, share): &(u32, f32)| (*node, Quat::IDENTITY.slerp(turn, *share));
        let turns: Vec<_> = self.anatomy.turns.iter().filter(|_| is_turned).map(share).collect();
        let named = gesture.shapes.iter().filter_map(|(name, weight)| Some((rig.target(name)?, *weight)));
        let shapes: Vec<_> = named.chain(self.shapes.iter().copied()).collect();
        let pose = rig.pose_turned(animation, &shapes, &turns);
        self.skinning.pose(&gpu.queue, &pose, body)?;
        let is_bent = pose != self.rest;
        let node = |node: u32| {
            let [now, rest] = [&pose, &self.rest].map(|pose| rig.to_groom * pose.globals[node as usize]);
            moved(&now, &rest)
        };
        let parts = self.anatomy.solids().map(|part| node(part.node)).collect();
        Ok(Stance { head: node(self.anatomy.head.node), parts, is_bent })
    }

    /// From here on the fields of `hair`'s colliders deform with the skin of `body`, whose mesh at rest is `mesh`;
    /// `fields` are those of the solids.
    pub(crate) fn deform<'a>(
        &mut self,
        (gpu, pipelines): (&Gpu, &Pipelines),
        (body, mesh): (&Body, &TriMesh),
        has_head: bool,
        fields: impl Iterator<Item = Option<FieldId>>,
        hair: impl Iterator<Item = &'a mut Hair>,
    ) -> Result<()> {
        let flesh = Flesh::new(&self.anatomy, mesh, has_head);
        let fields = flesh.fields(fields);
        for hair in hair {
            let colliders = &mut hair.colliders;
            colliders.deform(&gpu.device, &gpu.queue, &pipelines.deform, mesh, &body.into(), &fields)?;
        }
        self.deforms = flesh.deforms();
        Ok(())
    }

    /// Where the fields are that [deform](tresses::collide::deform): of the head's and those of the other parts, in the
    /// body's space.
    pub(crate) fn deforming<'a>(&'a self, stance: &'a Stance) -> impl Iterator<Item = Pose> + 'a {
        let all = std::iter::once(&stance.head).chain(&stance.parts);
        all.zip(&self.deforms).filter(|(_, deforms)| **deforms).map(|(pose, _)| *pose)
    }

    /// What the frame records.
    pub fn skinning(&self) -> &Skinning {
        &self.skinning
    }
}

#[cfg(test)]
#[path = "living_tests.rs"]
mod tests;
