//! Anatomy of a skinned body for hair: the joint that carries the hair, and the other parts that hair collides with.
//!
//! The joint that carries most of the roots is the *head*: hair is simulated relative to it, and its part of the body
//! is the distance field that hair collides with most. Every other joint near the hair carries a part of the body with
//! a distance field of its own; parts overlap by a ring of triangles where they meet. Parts far from the hair at rest
//! (arms, hands and legs) are one [capsule] each: a raised hand comes near the hair, and is thin enough for a capsule.

pub mod capsule;
mod skin;

pub use capsule::{Capsule, CapsuleFit};
pub use skin::Flesh;

use glam::Vec3;
use std::collections::HashMap;

use super::{Bind, Rig};
use crate::{
    Error, Result, SdfGrid, TriMesh, curve,
    mesh::{Bvh, SdfOptions, sdf},
};

/// Maximum number of parts besides the head that are fields, and that are capsules.
const MAX_PARTS: usize = 24;
const MAX_CAPSULES: usize = 48;
/// Nodes along the longest side of a part's field, and the minimum number of triangles of a part.
const FINE: u32 = 40;
const MIN_TRIANGLES: usize = 12;
/// Share of a neck in a turn of the head on it.
const NECK_ROTATION_WEIGHT: f32 = 0.4;

/// Source of a distance field.
#[derive(Clone, Debug)]
pub enum DistanceFieldSource {
    /// A mesh in the collider's frame, meters, whose field is not built yet.
    Mesh(TriMesh, SdfOptions),
    /// A built field.
    Grid(SdfGrid),
}

/// A part of the body that a node carries.
#[derive(Clone, Debug)]
pub struct BodyPart {
    /// Node of the rig.
    pub node: u32,
    /// Surface at rest, groom space.
    pub field: DistanceFieldSource,
    /// Collision shape.
    pub form: PartForm,
    /// Factor on the coefficient of friction.
    pub friction: f32,
    /// Number of vertices that follow the node most.
    pub vertices: usize,
    /// Best-fitting capsule, if it is known and exists.
    pub fitted: Option<CapsuleFit>,
}

/// Collision shape of a part of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartForm {
    /// Distance field.
    Field,
    /// Capsule, groom space at rest.
    Capsule(Capsule),
    /// No collision: hair passes through the part.
    Nothing,
}

impl BodyPart {
    pub(crate) fn new(node: u32, field: DistanceFieldSource, form: PartForm) -> Self {
        Self { node, field, form, friction: 1.0, vertices: 0, fitted: None }
    }
}

/// A skinned body, divided into parts for hair.
#[derive(Clone, Debug)]
pub struct Anatomy {
    /// Rig of the body.
    pub rig: Rig,
    /// Node that carries the hair, and its part of the body.
    pub head: BodyPart,
    /// Parts that other nodes carry, those near the hair first.
    pub parts: Vec<BodyPart>,
    /// Nodes that turn when the head does, a parent before its children, each with its share of the turn.
    pub rotation_weights: Vec<(u32, f32)>,
    /// Whether all roots are known to lie on skin that follows the head's joint rigidly in every pose.
    pub is_rigid: bool,
}

impl Anatomy {
    /// Divides the body `mesh` (groom space, meters) that hair grows on. Each of `lines` is a strand or a guide from
    /// its root.
    ///
    /// # Errors
    /// [`Error::Unusable`] if no root is near any triangle of the body.
    pub fn new<'a>(rig: Rig, mesh: &TriMesh, lines: impl IntoIterator<Item = &'a [Vec3]>) -> Result<Self> {
        let holder: Vec<u32> = rig.vertices.iter().map(|vertex| holder(&rig, vertex)).collect();
        let bvh = Bvh::new(mesh);
        let mut votes: HashMap<u32, usize> = HashMap::new();
        let (mut roots, mut contact_range) = (Vec::new(), 0.0f32);
        for line in lines {
            roots.extend(line.first());
            contact_range = contact_range.max(curve::length(line));
        }
        // Contact starts slightly before hair touches a surface.
        contact_range += 0.05;
        // Some hundreds of roots are enough.
        for root in roots.iter().step_by((roots.len() / 500).max(1)) {
            if let Some(closest) = bvh.closest_point(*root) {
                let corners = mesh.triangles[closest.triangle as usize];
                *votes.entry(holder[corners[0] as usize]).or_default() += 1;
            }
        }
        let head = votes.into_iter().max_by_key(|(node, votes)| (*votes, u32::MAX - node));
        let head = head.ok_or_else(|| Error::Unusable("no hair root lies on the mesh".into()))?.0;
        let owners = owners(&rig, head);
        let of = |vertex: u32| owners[vertex as usize];
        let triangles = by_node(mesh, of);
        let bounds =
            roots.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let (mut parts, mut own) = (Vec::new(), TriMesh::default());
        for (node, triangles) in triangles {
            let part = cut(mesh, &triangles);
            let far = box_distance(bounds, part.bounds());
            if node == head {
                own = part;
            } else {
                parts.push((
                    far,
                    triangles,
                    BodyPart::new(node, DistanceFieldSource::Mesh(part, fine()), PartForm::Nothing),
                ));
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.node.cmp(&b.2.node)));
        let (mut fields, mut capsules) = (0, 0);
        for (far, triangles, part) in &mut parts {
            let is_own = |vertex: u32| of(vertex) == part.node;
            part.vertices = (0..owners.len() as u32).filter(|vertex| is_own(*vertex)).count();
            part.fitted = capsule::fit(mesh, triangles, is_own);
            let is_large_enough = triangles.len() >= MIN_TRIANGLES;
            if is_large_enough && *far < contact_range && fields < MAX_PARTS {
                part.form = PartForm::Field;
                fields += 1;
            } else if let Some(fitted) = part.fitted.filter(|_| is_large_enough && capsules < MAX_CAPSULES) {
                part.form = PartForm::Capsule(fitted.capsule);
                capsules += 1;
            }
        }
        let parts = parts.into_iter().map(|(.., part)| part).collect();
        let rotation_weights = rotation_weights(&rig, head);
        let head =
            BodyPart::new(head, DistanceFieldSource::Mesh(own, SdfOptions::default()), PartForm::Field);
        Ok(Self { rig, head, parts, rotation_weights, is_rigid: false })
    }

    /// Returns the parts besides the head that hair collides with.
    pub fn solids(&self) -> impl Iterator<Item = &BodyPart> {
        self.parts.iter().filter(|part| part.form != PartForm::Nothing)
    }

    /// Returns the vertices that follow the head most, then the vertices of each of the [`solids`](Self::solids).
    pub fn owned(&self) -> Vec<Vec<u32>> {
        let owners = owners(&self.rig, self.head.node);
        let nodes = std::iter::once(self.head.node).chain(self.solids().map(|part| part.node));
        let of =
            |node: u32| (0..owners.len() as u32).filter(|vertex| owners[*vertex as usize] == node).collect();
        nodes.map(of).collect()
    }

    /// Builds the fields of parts that hair collides with. A part that encloses nothing, such as cards of lashes, stays
    /// a mesh: it is left to the builder on the GPU, which accepts it.
    pub fn measure(&mut self) {
        for part in self.parts.iter_mut().filter(|part| part.form == PartForm::Field) {
            if let DistanceFieldSource::Mesh(mesh, options) = &part.field
                && let Ok(grid) = sdf::build(mesh, options)
            {
                part.field = DistanceFieldSource::Grid(grid);
            }
        }
    }

    /// Sets fields that [`measure`](Self::measure) has built before, each with the node that carries its part.
    pub fn know(&mut self, fields: Vec<(u32, SdfGrid)>) {
        for (node, grid) in fields {
            if let Some(part) = self.parts.iter_mut().find(|part| part.node == node) {
                part.field = DistanceFieldSource::Grid(grid);
            }
        }
    }

    /// Fits a capsule to the part of the body's mesh `mesh` that `node` carries.
    pub fn fit(&self, node: u32, mesh: &TriMesh) -> Option<CapsuleFit> {
        let of = |vertex: u32| holder(&self.rig, &self.rig.vertices[vertex as usize]);
        let own = by_node(mesh, of).remove(&node).unwrap_or_default();
        capsule::fit(mesh, &own, |vertex| of(vertex) == node)
    }

    /// Returns the name of a node, or `#` and its number.
    pub fn name(&self, node: u32) -> String {
        match &*self.rig.nodes[node as usize].name {
            "" => format!("#{node}"),
            name => name.to_owned(),
        }
    }

    /// Returns the nodes of this name, ignoring case if none matches exactly.
    ///
    /// # Errors
    /// [`Error::Unusable`] with the existing names.
    pub fn named(&self, name: &str) -> Result<Vec<u32>> {
        let all = || 0..self.rig.nodes.len() as u32;
        let mut found: Vec<u32> = all().filter(|node| self.name(*node) == name).collect();
        if found.is_empty() {
            let lower = name.to_lowercase();
            found = all().filter(|node| self.name(*node).to_lowercase() == lower).collect();
        }
        if found.is_empty() {
            let names: Vec<_> = self.parts.iter().map(|part| self.name(part.node)).collect();
            let known_names = if names.is_empty() { "none".into() } else { names.join(", ") };
            let problem = format!("the body has no joint {name:?}; joints with parts: {known_names}");
            return Err(Error::Unusable(problem));
        }
        Ok(found)
    }
}

/// Returns the options for a part's field.
fn fine() -> SdfOptions {
    SdfOptions { resolution: FINE, ..Default::default() }
}

/// Groups the triangles by node; a triangle belongs to the nodes of all its corners.
fn by_node(mesh: &TriMesh, of: impl Fn(u32) -> u32) -> HashMap<u32, Vec<[u32; 3]>> {
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

/// Returns the node with the largest weight of a vertex.
fn holder(rig: &Rig, vertex: &Bind) -> u32 {
    let heaviest = (0..vertex.weights.len()).max_by(|a, b| vertex.weights[*a].total_cmp(&vertex.weights[*b]));
    heaviest.and_then(|i| rig.joints.get(usize::from(vertex.joints[i]))).map_or(0, |joint| joint.node)
}

/// Returns the node with the largest weight of each vertex; nodes below the head, such as eyes and jaws, count as the
/// head.
fn owners(rig: &Rig, head: u32) -> Vec<u32> {
    let on_head: Vec<bool> = (0..rig.nodes.len() as u32).map(|node| goes_with(rig, node, head)).collect();
    let owner = |node: u32| if on_head[node as usize] { head } else { node };
    rig.vertices.iter().map(|vertex| owner(holder(rig, vertex))).collect()
}

/// Returns the nodes that turn when the head does: its own node, after its parent if that is a neck.
fn rotation_weights(rig: &Rig, head: u32) -> Vec<(u32, f32)> {
    let neck = rig.nodes[head as usize].parent;
    match neck.filter(|node| rig.nodes[*node as usize].name.to_lowercase().contains("neck")) {
        Some(neck) => vec![(neck, NECK_ROTATION_WEIGHT), (head, 1.0 - NECK_ROTATION_WEIGHT)],
        None => vec![(head, 1.0)],
    }
}

/// Returns whether `node` is `head` or below it.
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

/// Returns the distance between two boxes, meters.
fn box_distance(a: (Vec3, Vec3), b: Option<(Vec3, Vec3)>) -> f32 {
    b.map_or(f32::INFINITY, |b| (a.0 - b.1).max(b.0 - a.1).max(Vec3::ZERO).length())
}

/// Returns these triangles as a mesh with only the vertices that they use.
fn cut(mesh: &TriMesh, triangles: &[[u32; 3]]) -> TriMesh {
    let mut new_indices = HashMap::new();
    let mut part = TriMesh::default();
    for triangle in triangles {
        part.triangles.push(triangle.map(|vertex| {
            *new_indices.entry(vertex).or_insert_with(|| {
                part.positions.push(mesh.positions[vertex as usize]);
                part.normals.extend(mesh.normals.get(vertex as usize));
                part.positions.len() as u32 - 1
            })
        }));
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Strands,
        mesh::shapes,
        rig::{Joint, Node, Transform},
    };
    use glam::{Mat4, Quat};

    /// A head on a neck on shoulders, each a ball with a node of its own, and an eye below the head.
    fn body() -> (Rig, TriMesh) {
        let places = [
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 1.3, 0.0),
            Vec3::new(0.0, 1.5, 0.0),
            Vec3::new(0.0, 1.5, 0.1),
        ];
        let sizes = [0.2, 0.06, 0.1, 0.02];
        let (mut rig, mut mesh) = (Rig { to_groom: Mat4::IDENTITY, ..Rig::default() }, TriMesh::default());
        for (i, (place, size)) in places.into_iter().zip(sizes).enumerate() {
            let mut ball = shapes::sphere(size, 12);
            ball.compute_normals();
            let parent = i.checked_sub(1).map(|parent| parent as u32);
            let from = parent.map_or(Vec3::ZERO, |parent| places[parent as usize]);
            let rest = Transform { translation: place - from, ..Default::default() };
            rig.nodes.push(Node { name: format!("{i}"), parent, rest, ..Default::default() });
            rig.joints.push(Joint { node: i as u32, inverse_bind: Mat4::from_translation(-place) });
            let first = mesh.positions.len() as u32;
            for (p, n) in ball.positions.iter().zip(&ball.normals) {
                rig.vertices.push(Bind::rigid(place + *p, *n, i as u16));
                mesh.positions.push(place + *p);
                mesh.normals.push(*n);
            }
            mesh.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        (rig, mesh)
    }

    fn hair(length: f32) -> Strands {
        let mut strands = Strands::default();
        for i in 0..20 {
            let root = Vec3::new(0.02 * (i as f32).sin(), 1.6, 0.02 * (i as f32).cos());
            strands.push(&[root, root + Vec3::Y * length]);
        }
        strands
    }

    #[test]
    fn node_with_most_roots_is_the_head() {
        let (rig, mesh) = body();
        let anatomy = Anatomy::new(rig, &mesh, hair(0.4).iter()).unwrap();
        assert_eq!(anatomy.head.node, 2);
        // The eye belongs to the head.
        let DistanceFieldSource::Mesh(mesh, _) = &anatomy.head.field else { panic!("a mesh was given") };
        let (lo, hi) = mesh.bounds().unwrap();
        assert!((hi.z - 0.12).abs() < 1e-3 && (lo.y - 1.4).abs() < 1e-3, "{lo} {hi}");
        let nodes: Vec<_> = anatomy.parts.iter().map(|part| part.node).collect();
        assert_eq!(nodes, [1, 0], "the nearest first");
        assert!(anatomy.solids().count() == 2 && anatomy.solids().all(|part| part.form == PartForm::Field));
        // Short hair reaches the neck, not the shoulders, which are a capsule.
        let (rig, mesh) = body();
        let short = Anatomy::new(rig, &mesh, hair(0.2).iter()).unwrap();
        assert_eq!(short.parts.iter().map(|part| part.node).collect::<Vec<_>>(), [1, 0]);
        assert_eq!(short.parts[0].form, PartForm::Field);
        let PartForm::Capsule(Capsule { ends: [a, b], radius }) = short.parts[1].form else {
            panic!("far away")
        };
        assert!((radius - 0.2).abs() < 2e-3 && a.distance(b) < 0.01, "{a} {b} {radius}");
        assert!((0.5 * (a + b)).distance(Vec3::Y) < 2e-3);
        assert_eq!(short.parts[1].vertices, mesh.positions.len() / 4);
        // `fit` finds the same capsule.
        assert_eq!(short.fit(0, &mesh), short.parts[1].fitted);
        let (rig, mesh) = body();
        assert!(Anatomy::new(rig, &mesh, []).is_err(), "there is no hair");
    }

    #[test]
    fn neck_takes_its_share_of_a_head_turn() {
        let (mut rig, mesh) = body();
        let anatomy = Anatomy::new(rig.clone(), &mesh, hair(0.4).iter()).unwrap();
        assert_eq!(anatomy.rotation_weights, [(2, 1.0)], "no node is called a neck");
        rig.nodes[1].name = "mixamorig:Neck".into();
        let anatomy = Anatomy::new(rig, &mesh, hair(0.4).iter()).unwrap();
        assert_eq!(anatomy.rotation_weights, [(1, NECK_ROTATION_WEIGHT), (2, 1.0 - NECK_ROTATION_WEIGHT)]);
        // In total, the head turns by the whole angle about its place on the neck; the eye follows it.
        let turn = Quat::from_rotation_x(0.5);
        let turns =
            anatomy.rotation_weights.iter().map(|(node, share)| (*node, Quat::IDENTITY.slerp(turn, *share)));
        let pose = anatomy.rig.pose_with_rotations(None, &[], &turns.collect::<Vec<_>>());
        let rest = anatomy.rig.rest_pose();
        let of =
            |node: usize, p: Vec3| (pose.globals[node] * rest.globals[node].inverse()).transform_point3(p);
        let neck = Vec3::new(0.0, 1.3, 0.0);
        assert!(of(0, neck) == neck, "the torso stays");
        for node in [2, 3] {
            let up = of(node, neck + Vec3::Y) - of(node, neck);
            assert!(up.distance(turn * Vec3::Y) < 1e-5, "{node}: {up}");
        }
        assert!(of(1, neck).distance(neck) < 1e-6, "the neck turns where it is");
        let bent = Quat::from_rotation_x(0.5 * NECK_ROTATION_WEIGHT) * Vec3::Y * 0.2;
        assert!(of(2, neck + Vec3::Y * 0.2).distance(neck + bent) < 1e-6, "and the head is on it");
    }
}
