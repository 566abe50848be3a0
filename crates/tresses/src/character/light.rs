//! Lighting of the characters in an image: one focus sphere for a single head, or a zone per head.

use super::Character;
use crate::{
    Camera,
    light::{Sphere, Zone},
    lod::LodMode,
    view::{Picture, View},
};

/// Characters so close together that they are lit as one head: a beard as a character of its own, an embrace.
#[derive(Debug)]
struct Group {
    focus: Sphere,
    /// Indices of the characters.
    members: Vec<usize>,
}

/// The spheres around the heads of an image, for hosts that fit lights and shadow maps to them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Foci {
    /// The head nearest to the camera. The view's own shadow maps cover it.
    pub nearest: Sphere,
    /// Each head in view. Hair, brows and a beard on one head share a sphere.
    pub all: Vec<Sphere>,
}

impl Character {
    /// Returns the spheres that lighting covers in an image of `characters` seen by `camera`, as placed by the last
    /// frame.
    pub fn foci(characters: &[&Self], camera: &Camera) -> Foci {
        let bodies = vec![Vec::new(); characters.len()];
        let Lighting { focus: nearest, zones } = Lighting::new(characters, &bodies, camera);
        let zones = zones.iter().map(|zone| zone.focus);
        Foci { nearest, all: if zones.len() > 0 { zones.collect() } else { vec![nearest] } }
    }
}

/// The lighting of an image.
#[derive(Debug)]
pub(super) struct Lighting {
    /// The sphere that the view's own shadow maps cover.
    pub focus: Sphere,
    /// A zone per head; empty for a single head.
    pub zones: Vec<Zone>,
}

impl Lighting {
    /// Computes the lighting of `characters` seen by `camera`. `bodies` are the indices of each one's bodies in the
    /// image.
    pub fn new(characters: &[&Character], bodies: &[Vec<usize>], camera: &Camera) -> Self {
        let spheres: Vec<_> = characters.iter().map(|character| character.focus_drawn()).collect();
        let groups = groups(&spheres);
        let eye = camera.eye();
        let eye_distance = |group: &&Group| group.focus.center.distance(eye);
        let is_visible = |group: &&Group| group.members.iter().any(|i| characters[*i].hair().is_visible());
        let nearest =
            groups.iter().filter(is_visible).min_by(|a, b| eye_distance(a).total_cmp(&eye_distance(b)));
        let focus = nearest.or(groups.first()).map_or(Sphere::default(), |group| group.focus);
        if groups.len() < 2 {
            return Self { focus, zones: Vec::new() };
        }
        let mut groom_count = 0;
        let groom_indices: Vec<_> = characters
            .iter()
            .map(|character| {
                let indices = groom_count..groom_count + character.grooms().count();
                groom_count = indices.end;
                indices
            })
            .collect();
        let zone = |group: &Group| {
            let hair = group.members.iter().flat_map(|i| groom_indices[*i].clone()).collect();
            let mut group_bodies: Vec<_> =
                group.members.iter().flat_map(|i| bodies[*i].iter().copied()).collect();
            group_bodies.sort_unstable();
            group_bodies.dedup();
            let first = characters[group.members[0]];
            let zone = Zone::for_camera(group.focus, camera, first.bias, hair, group_bodies);
            Zone { pose: first.head_drawn(), ..zone }
        };
        Self { focus, zones: groups.iter().filter(is_visible).map(zone).collect() }
    }

    /// Sets the zones of `view` for an image of `characters` and `body_count` bodies. Returns `picture` with the focus
    /// of this lighting.
    pub fn set(
        &self,
        view: &mut View,
        characters: &[&Character],
        body_count: usize,
        picture: &Picture,
    ) -> Picture {
        let picture = Picture { focus: self.focus, ..picture.clone() };
        match characters.first() {
            Some(Character { hair, bias, .. })
                if self.zones.is_empty() && hair.lod.options.mode == LodMode::Auto =>
            {
                let groom_count = characters.iter().flat_map(|it| it.grooms()).count();
                view.fit_light((&picture, hair.lod.options.bias + bias), [groom_count, body_count]);
            }
            _ => view.set_zones(&self.zones),
        }
        picture
    }
}

/// Groups spheres into heads: a sphere whose center is well inside a larger one belongs to it.
fn groups(spheres: &[Sphere]) -> Vec<Group> {
    let mut order: Vec<_> = (0..spheres.len()).collect();
    order.sort_by(|a, b| spheres[*b].radius.total_cmp(&spheres[*a].radius));
    let mut groups: Vec<Group> = Vec::new();
    for i in order {
        let sphere = spheres[i];
        let is_inside =
            |group: &&mut Group| group.focus.center.distance(sphere.center) < 0.75 * group.focus.radius;
        match groups.iter_mut().find(is_inside) {
            Some(group) => {
                let radius = group.focus.center.distance(sphere.center) + sphere.radius;
                group.focus.radius = group.focus.radius.max(radius);
                group.members.push(i);
            }
            None => groups.push(Group { focus: sphere, members: vec![i] }),
        }
    }
    // In the order of the list, which stays the same from frame to frame.
    groups.iter_mut().for_each(|group| group.members.sort_unstable());
    groups.sort_by_key(|group| group.members[0]);
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn overlapping_grooms_form_one_head() {
        let at = |x: f32, y: f32, radius| Sphere { center: Vec3::new(x, y, 0.0), radius };
        // A beard, hair, a second head with hair and brows.
        let spheres = [at(0.0, -0.1, 0.08), at(0.0, 0.0, 0.25), at(0.6, 0.0, 0.2), at(0.6, 0.05, 0.03)];
        let found = groups(&spheres);
        let members: Vec<_> = found.iter().map(|group| group.members.as_slice()).collect();
        assert_eq!(members, [&[0, 1][..], &[2, 3]]);
        assert_eq!((found[0].focus, found[1].focus), (spheres[1], spheres[2]));
        let separate = [at(0.0, 0.0, 0.25), at(0.2, 0.0, 0.25)];
        assert_eq!(groups(&separate).len(), 2);
    }
}
