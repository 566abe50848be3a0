//! Guides posed by the host, for example combed hair.

use super::Hair;
use crate::{Error, Result, strands::guide::pack_lag};
use glam::Vec3;

impl Hair {
    /// Puts the guides at `positions` (groom space, meters, guide after guide as in
    /// [`Guides`](crate::groom::Guides)), without velocity, from the next frame on. The strands follow as in motion.
    /// Steps of a frame pull the guides back to their rest pose, so a frame that shows the pose takes no time. The hair
    /// must have been in a frame before.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another number of positions.
    pub fn pose_guides(&mut self, positions: &[Vec3]) -> Result<()> {
        let (count, n) = (self.guides.count as usize, self.guides.vertex_count as usize);
        if positions.len() != count * n {
            return Err(Error::unusable(format!(
                "{} positions do not match {count} guides of {n} vertices",
                positions.len()
            )));
        }
        self.sleep.wake();
        // The state as of the last step; a second one would be interpolated with it.
        let head = self.motion.states.1;
        self.motion.states.0 = head;
        let still = pack_lag(Vec3::ZERO);
        let state = |i: usize| {
            let [x, y, z] = head.point(positions[i % count * n + i / count]).to_array().map(f32::to_bits);
            [x, y, z, still]
        };
        let states: Vec<[u32; 4]> = (0..count * n).map(state).collect();
        let queue = self.asset.context.queue();
        queue.write_buffer(&self.guides.current, 0, bytemuck::cast_slice(&states));
        let mut encoder = self.asset.context.device().create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.guides.velocity, 0, None);
        queue.submit([encoder.finish()]);
        Ok(())
    }
}
