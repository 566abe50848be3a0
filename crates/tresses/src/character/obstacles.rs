//! Colliders of a character besides its head: the host's obstacles, and the parts of its own body.

use crate::{
    Pose,
    collide::{Collider, ColliderPoses, FieldId, Shape},
    groom::rig::anatomy::{Anatomy, Capsule, PartForm},
};

/// An obstacle that comes and goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// The host's id. An obstacle that keeps its index and its id moves continuously; a different one appears.
    pub id: u64,
    /// Its shape.
    pub collider: Collider,
    /// Pose in the space of the collider's anchor.
    pub pose: Pose,
}

/// A body part among the colliders.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// A distance field, whose rest pose is the body's.
    Field(FieldId),
    /// A capsule with its frame while the body is at rest.
    Capsule(Pose),
}

/// The colliders of one character besides the head's field, in this order: those from creation, body parts, those that
/// come and go.
#[derive(Clone, Debug, Default)]
pub(super) struct Obstacles {
    pub list: Vec<Collider>,
    /// Poses of the colliders from creation, which are first in the list.
    pub fixed: Vec<Pose>,
    parts: Vec<Part>,
    pub free: Vec<Obstacle>,
}

impl Obstacles {
    /// Creates the list with the body parts of `anatomy`, whose fields are numbered from `first_field` on.
    pub fn new(fixed: &[Collider], anatomy: Option<&Anatomy>, first_field: usize) -> Self {
        let mut all =
            Self { list: fixed.to_vec(), fixed: vec![Pose::IDENTITY; fixed.len()], ..Self::default() };
        let mut next = first_field as u32..;
        for part in anatomy.iter().flat_map(|anatomy| anatomy.solids()) {
            let (shape, entry) = match part.form {
                PartForm::Capsule(Capsule { ends: [a, b], radius }) => {
                    let (shape, pose) = Shape::capsule(a, b, radius);
                    (shape, Part::Capsule(pose))
                }
                _ => {
                    let field = FieldId(next.next().unwrap_or_default());
                    (Shape::Field(field), Part::Field(field))
                }
            };
            all.list.push(Collider { friction: part.friction, ..Collider::new(shape) });
            all.parts.push(entry);
        }
        all
    }

    /// Returns the field of each body part; `None` for a capsule.
    pub(crate) fn part_fields(&self) -> Vec<Option<FieldId>> {
        let field = |part: &Part| match part {
            Part::Field(field) => Some(*field),
            Part::Capsule(_) => None,
        };
        self.parts.iter().map(field).collect()
    }

    /// Returns the number of colliders before those that come and go.
    fn own(&self) -> usize {
        self.fixed.len() + self.parts.len()
    }

    /// Replaces the obstacles that come and go. If the list of colliders has changed, returns the number of colliders
    /// that continue from their last poses.
    pub(crate) fn set_free(&mut self, free: &[Obstacle]) -> Option<usize> {
        let is_same = |(a, b): &(&Obstacle, &Obstacle)| a.id == b.id;
        let kept = self.own() + free.iter().zip(&self.free).take_while(is_same).count();
        let changed = self.list.len() != self.own() + free.len()
            || kept < self.list.len()
            || self.list[self.own()..].iter().zip(free).any(|(old, new)| *old != new.collider);
        self.free.clear();
        self.free.extend_from_slice(free);
        self.list.truncate(self.own());
        self.list.extend(free.iter().map(|obstacle| obstacle.collider));
        changed.then_some(kept)
    }

    /// Returns the poses of all colliders while the joints of the body parts have the poses `nodes`.
    pub fn poses(&self, nodes: &[Pose]) -> ColliderPoses {
        let parts = self.parts.iter().zip(nodes).map(|(part, node)| match part {
            Part::Field(_) => *node,
            Part::Capsule(own) => node.after(own),
        });
        let free = self.free.iter().map(|obstacle| obstacle.pose);
        ColliderPoses { head: None, colliders: self.fixed.iter().copied().chain(parts).chain(free).collect() }
    }

    /// Returns the entries of `poses` (one per collider) that are not body parts.
    pub fn visible<'a>(&self, poses: &'a [Pose]) -> impl Iterator<Item = Pose> + 'a {
        let (fixed, own) = (self.fixed.len(), self.own());
        poses.iter().enumerate().filter(move |(i, _)| *i < fixed || *i >= own).map(|(_, pose)| *pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstacles_with_same_index_and_id_keep_moving() {
        let obstacle = |id, radius| Obstacle {
            id,
            collider: Collider::new(Shape::sphere(radius)),
            pose: Pose::IDENTITY,
        };
        let mut all = Obstacles::new(&[Collider::new(Shape::sphere(1.0))], None, 0);
        let (a, b, c) = (obstacle(1, 0.1), obstacle(2, 0.2), obstacle(3, 0.3));
        assert_eq!(all.set_free(&[a, b]), Some(1), "both have just come");
        assert_eq!(all.set_free(&[a, b]), None);
        let moved = Obstacle { pose: Pose { translation: glam::Vec3::X, ..Pose::IDENTITY }, ..b };
        assert_eq!(all.set_free(&[a, moved]), None, "poses are no other list");
        assert_eq!(all.poses(&[]).colliders[2], moved.pose);
        assert_eq!(all.set_free(&[a, c]), Some(2), "the first goes on");
        assert_eq!(all.set_free(&[c]), Some(1));
        assert_eq!(all.set_free(&[obstacle(3, 0.5)]), Some(2), "the same one, of another size");
        assert_eq!(all.set_free(&[]), Some(1));
        assert_eq!(all.list.len(), 1);
    }
}
