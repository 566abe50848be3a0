//! The state of a simulation, to continue it later.

use super::Hair;
use crate::{Error, Pose, Result, gpu::readback};
use glam::{Quat, Vec3};

/// State of the guides of one groom after a frame.
///
/// The air (`Hair::air`) is not part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct GuideState {
    /// [`Hair::simulation_transform`] of that frame.
    simulation_transform: Pose,
    /// Poses of the head before and after the last step, and at the clock's last step.
    heads: [Pose; 3],
    /// Blend of the two poses of the head, and length of the last step, s.
    blend: [f32; 2],
    /// Time since the last step, s.
    rest: f64,
    /// [`GuideBuffers::current`](crate::strands::GuideBuffers::current).
    current: Vec<[u32; 4]>,
    /// [`GuideBuffers::velocity`](crate::strands::GuideBuffers::velocity).
    velocity: Vec<u32>,
}

/// Words of a pose, and words before the vertices.
const POSE: usize = 7;
const HEADER: usize = 4 * POSE + 6;

impl GuideState {
    /// Encodes the state as words, for a file.
    pub fn words(&self) -> Vec<u32> {
        let Self { simulation_transform, heads, blend, rest, current, velocity } = self;
        let poses = std::iter::once(simulation_transform).chain(heads);
        let numbers =
            poses.flat_map(|pose| pose.rotation.to_array().into_iter().chain(pose.translation.to_array()));
        let mut words: Vec<u32> = numbers.chain(*blend).map(f32::to_bits).collect();
        let bits = rest.to_bits();
        words.extend([bits as u32, (bits >> 32) as u32, current.len() as u32, velocity.len() as u32]);
        words.extend(current.as_flattened());
        words.extend(velocity);
        words
    }

    /// Decodes all states in `words`.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for other words.
    pub fn all_of(mut words: &[u32]) -> Result<Vec<Self>> {
        let mut all = Vec::new();
        while !words.is_empty() {
            all.push(Self::take_from(&mut words)?);
        }
        Ok(all)
    }

    /// Decodes the first state in `words`, and removes its words.
    fn take_from(words: &mut &[u32]) -> Result<Self> {
        let broken = || Error::unusable("the state of the hair is damaged");
        let header = words.split_off(..HEADER).ok_or_else(broken)?;
        let number = |i: usize| f32::from_bits(header[i]);
        let pose = |k: usize| {
            let [x, y, z, w, a, b, c] = std::array::from_fn(|i| number(k * POSE + i));
            Pose { rotation: Quat::from_xyzw(x, y, z, w), translation: Vec3::new(a, b, c) }
        };
        let [low, high, current, velocity] = std::array::from_fn(|i| header[4 * POSE + 2 + i]);
        let rest = f64::from_bits(u64::from(low) | u64::from(high) << 32);
        let finite = (0..4 * POSE + 2).all(|i| number(i).is_finite()) && (0.0..1.0).contains(&rest);
        let vertices = (current as usize).checked_mul(4).filter(|_| finite).ok_or_else(broken)?;
        let vertices = words.split_off(..vertices).ok_or_else(broken)?;
        let velocity = words.split_off(..velocity as usize).ok_or_else(broken)?;
        let positions = vertices.as_chunks::<4>().0;
        if positions.iter().flat_map(|vertex| &vertex[..3]).any(|word| !f32::from_bits(*word).is_finite()) {
            return Err(broken());
        }
        Ok(Self {
            simulation_transform: pose(0),
            heads: [pose(1), pose(2), pose(3)],
            blend: [number(4 * POSE), number(4 * POSE + 1)],
            rest,
            current: positions.to_vec(),
            velocity: velocity.to_vec(),
        })
    }
}

impl Hair {
    /// Reads back the state of the guides after the last frame.
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn state(&self) -> Result<GuideState> {
        let vertices = (self.guides.count * self.guides.vertex_count) as usize;
        let mut current: Vec<[u32; 4]> = readback::buffer(&self.asset.context, &self.guides.current).await?;
        current.truncate(vertices);
        let velocity = readback::buffer(&self.asset.context, &self.guides.velocity).await?;
        let motion = &self.motion;
        let (before, after, blend) = motion.states;
        let (rest, head) = motion.clock.progress();
        Ok(GuideState {
            simulation_transform: motion.to_drawn,
            heads: [before, after, head],
            blend: [blend, motion.span],
            rest,
            current,
            velocity,
        })
    }

    /// Continues from `state`. Call it after a frame that resets the hair on the body in the pose of that moment, in a
    /// space of the same orientation.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for the state of other hair.
    pub fn set_state(&mut self, state: &GuideState) -> Result<()> {
        let GuideState { simulation_transform, heads, blend, rest, current, velocity } = state;
        let vertices = (self.guides.count * self.guides.vertex_count) as usize;
        let is_own = current.len() == vertices && 4 * velocity.len() as u64 == self.guides.velocity.size();
        if !is_own {
            return Err(Error::unusable("the state is of other hair"));
        }
        self.sleep.wake();
        let queue = self.asset.context.queue();
        // The origin of the simulation may have moved.
        let shift = simulation_transform.translation - self.motion.to_drawn.translation;
        let shift = self.motion.to_drawn.rotation.inverse() * shift;
        let mut current = current.clone();
        if shift != Vec3::ZERO {
            for [x, y, z, _] in &mut current {
                let p = Vec3::from([*x, *y, *z].map(f32::from_bits)) + shift;
                [*x, *y, *z] = p.to_array().map(f32::to_bits);
            }
        }
        queue.write_buffer(&self.guides.current, 0, bytemuck::cast_slice(&current));
        queue.write_buffer(&self.guides.velocity, 0, bytemuck::cast_slice(velocity));
        let [before, after] = [0, 1].map(|k| Pose { translation: heads[k].translation + shift, ..heads[k] });
        self.motion.states = (before, after, blend[0]);
        self.motion.span = blend[1];
        self.motion.clock.set_progress(*rest, heads[2]);
        Ok(())
    }
}
