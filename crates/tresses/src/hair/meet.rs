//! Hair of several characters that touch.

use super::Hair;
use crate::volume::Other;

/// How much larger than the hair at rest the spheres are that must touch.
const ROOM: f32 = 1.3;

impl Hair {
    /// In the next frame, the hair of `others` is in the grid of this one as well: where all of them together are denser
    /// than hair may be, it is pushed out, and it rubs against theirs as against its own ([`crate::volume`]). Let them
    /// meet this hair too: what one feels the other does not know. To be said before each frame in which they may touch;
    /// of the last one nothing is left.
    ///
    /// How they lie to each other is what it was when both were drawn last. Those that have not been, that were drawn in
    /// another space or are out of view are left out, and with
    /// [`HairHairMode::Off`](crate::volume::HairHairMode::Off) nothing is met. Hair that meets others does not fall
    /// asleep.
    pub fn meet(&mut self, others: &[&Hair]) {
        let moved = |hair: &Hair| hair.motion.clock.state().is_some() && !hair.sleep.unseen;
        let beside = |other: &Hair| moved(other) && other.motion.drawn_in.is_where(&self.motion.drawn_in);
        let there = others.iter().filter(|other| moved(self) && beside(other));
        // Both as they were drawn last: frames that carry hair go on as they did.
        let back = self.motion.to_drawn.inverse();
        let others: Vec<_> = there
            .map(|other| Other {
                guides: &other.guides,
                volume: &other.volume,
                way: back.after(&other.motion.to_drawn),
                closing: self.motion.carrier.faster_than(&other.motion.carrier),
            })
            .collect();
        self.volume.meet(&self.context, others.into_iter());
    }

    /// Each of `hair` [meets](Self::meet) those of the others that are near it: before the frame in which they move. Grooms on
    /// one head, which lie in each other at rest, are not to be among the same.
    pub fn meet_each_other(hair: &mut [&mut Self]) {
        for i in 0..hair.len() {
            let (before, rest) = hair.split_at_mut(i);
            let Some((own, after)) = rest.split_first_mut() else { return };
            let others = before.iter().chain(&*after).map(|other| &**other);
            let near: Vec<_> = others.filter(|other| own.is_near(other)).collect();
            own.meet(&near);
        }
    }

    /// Whether hair may touch that of `other`, by spheres around both.
    fn is_near(&self, other: &Self) -> bool {
        let [own, theirs] = [self, other].map(|hair| {
            let (middle, radius) = hair.lod.sphere;
            (hair.motion.head.point(middle), ROOM * radius)
        });
        own.0.distance(theirs.0) < own.1 + theirs.1
    }
}
