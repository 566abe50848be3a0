//! Collision between the hair of several characters.

use super::Hair;
use crate::volume::OtherGroom;

/// Factor on the bounding spheres in the test whether two grooms are near each other.
const ROOM: f32 = 1.3;

impl Hair {
    /// Adds the hair of `others` to this hair's density grid in the next frame. Where the combined density exceeds the
    /// limit, this hair is pushed out, and it rubs against theirs as against itself. The effect is
    /// one-sided: let the others meet this hair as well. It lasts one frame, so call it before each frame in which they
    /// may touch.
    ///
    /// The relative position is the one at which both were last drawn. Skips hair that has not been drawn yet, that was
    /// drawn in another space or that is out of view. With [`HairHairMode::Off`](crate::volume::HairHairMode::Off)
    /// nothing happens. Hair that meets others does not fall asleep.
    pub fn meet(&mut self, others: &[&Hair]) {
        let moved = |hair: &Hair| hair.motion.clock.state().is_some() && !hair.sleep.unseen;
        let beside = |other: &Hair| moved(other) && other.motion.drawn_in.is_where(&self.motion.drawn_in);
        let there = others.iter().filter(|other| moved(self) && beside(other));
        // Both as they were last drawn: carriers keep moving as they did.
        let back = self.motion.to_drawn.inverse();
        let others: Vec<_> = there
            .map(|other| OtherGroom {
                guides: &other.guides,
                volume: &other.volume,
                way: back.after(&other.motion.to_drawn),
                closing: self.motion.carrier.faster_than(&other.motion.carrier),
            })
            .collect();
        self.volume.meet(&self.asset.context, others.into_iter());
    }

    /// Makes each of `hair` [meet](Self::meet) the others that are near it. Call it before the frame in which they
    /// advance. Do not include several grooms of one head, which overlap at rest.
    pub fn meet_each_other(hair: &mut [&mut Self]) {
        for i in 0..hair.len() {
            let (before, rest) = hair.split_at_mut(i);
            let Some((own, after)) = rest.split_first_mut() else { return };
            let others = before.iter().chain(&*after).map(|other| &**other);
            let near: Vec<_> = others.filter(|other| own.is_near(other)).collect();
            own.meet(&near);
        }
    }

    /// Whether this hair may touch the hair of `other`, by bounding spheres.
    fn is_near(&self, other: &Self) -> bool {
        let [own, theirs] = [self, other].map(|hair| {
            let (middle, radius) = hair.lod.sphere();
            (hair.motion.head.point(middle), ROOM * radius)
        });
        own.0.distance(theirs.0) < own.1 + theirs.1
    }
}
