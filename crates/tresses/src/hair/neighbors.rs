//! Collision between the hair of several characters.

use super::Hair;
use crate::volume::OtherGroom;

/// Factor on the bounding spheres in the test whether two grooms are near each other.
const BOUNDS_SCALE: f32 = 1.3;

impl Hair {
    /// Adds the hair of `others` to this hair's density grid in the next frame. Where the combined density exceeds the
    /// limit, this hair is pushed out, and it rubs against theirs as against itself. The effect is
    /// one-sided: let the others meet this hair as well. It lasts one frame, so call it before each frame in which they
    /// may touch.
    ///
    /// The relative position is the one at which both were last drawn. Skips hair that has not been drawn yet, that was
    /// drawn in another space or that is out of view. With [`HairHairMode::Off`](crate::volume::HairHairMode::Off)
    /// nothing happens. Hair that meets others does not fall asleep.
    pub fn collide_with(&mut self, others: &[&Hair]) {
        let is_active = |hair: &Hair| hair.motion.clock.state().is_some() && !hair.sleep.out_of_view;
        let is_neighbor =
            |other: &Hair| is_active(other) && other.motion.drawn_in.is_where(&self.motion.drawn_in);
        let neighbors = others.iter().filter(|other| is_active(self) && is_neighbor(other));
        // Both as they were last drawn: carriers keep moving as they did.
        let back = self.motion.to_drawn.inverse();
        let others: Vec<_> = neighbors
            .map(|other| OtherGroom {
                guides: &other.guides,
                volume: &other.volume,
                transform: back.after(&other.motion.to_drawn),
                closing: self.motion.carrier.faster_than(&other.motion.carrier),
            })
            .collect();
        self.volume.set_neighbors(&self.asset.context, others.into_iter());
    }

    /// Makes each of `hair` [collide with](Self::collide_with) the others that are near it. Call it before the frame in
    /// which they advance. Do not include several grooms of one head, which overlap at rest.
    pub fn collide_nearby(hair: &mut [&mut Self]) {
        for i in 0..hair.len() {
            let (before, rest) = hair.split_at_mut(i);
            let Some((own, after)) = rest.split_first_mut() else { return };
            let others = before.iter().chain(&*after).map(|other| &**other);
            let near: Vec<_> = others.filter(|other| own.is_near(other)).collect();
            own.collide_with(&near);
        }
    }

    /// Whether this hair may touch the hair of `other`, by bounding spheres.
    fn is_near(&self, other: &Self) -> bool {
        let [own_sphere, other_sphere] = [self, other].map(|hair| {
            let (center, radius) = hair.lod.sphere();
            (hair.motion.head.point(center), BOUNDS_SCALE * radius)
        });
        own_sphere.0.distance(other_sphere.0) < own_sphere.1 + other_sphere.1
    }
}
