//! User parameters, in SI units, and the uniforms of one step.

use crate::{Error, Result, groom::range, range::Range};
use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3};

/// One wave as a step sees it: `amplitude cos(wave · x + phase)`, `x` in cells from the grid's corner.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GustMode {
    /// Wave vector, radians per cell.
    pub wave: Vec3,
    /// Radians.
    pub phase: f32,
    /// m/s.
    pub amplitude: Vec3,
    /// Unused.
    pub _pad: f32,
}

/// The wind: what the air does far from the head, and how finely the air around it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Mean velocity of the air far from the head, world axes, m/s; in a space that
    /// [carries its air](crate::space::Space::carries_air) that of its air, its axes. Where nothing moves through
    /// it, zero is calm: nothing is computed, and hair is only slowed by
    /// [`crate::simulate::SimulationParams::drag`].
    pub velocity: Vec3,
    /// Intensity of the gusts: standard deviation of each component of the velocity over the
    /// mean speed. About 0.1 over open water, 0.2 over open land, 0.4 between houses.
    pub gusts: f32,
    /// Integral length scale of the gusts, metres: a gust passes in about this over the speed.
    pub gust_length: f32,
    /// Chooses the gusts; the same seed gives the same ones.
    pub seed: u32,
    /// Cells of the fluid's grid along each axis, a multiple of 8 up to 96; 0 for air that is the same everywhere.
    /// Without the fluid nothing shields a hair from the wind, so that only
    /// [`crate::simulate::SimulationParams::drag`] acts, not the quadratic drag of single hairs.
    pub cells: u32,
    /// Edge of the fluid's grid over the longest side of the box around the hair at rest.
    pub room: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self { velocity: Vec3::ZERO, gusts: 0.2, gust_length: 2.0, seed: 1, cells: 32, room: 2.2 }
    }
}

/// The fewest cells along an axis.
pub const MIN_CELLS: u32 = 8;
/// The most cells along an axis.
pub const MAX_CELLS: u32 = 96;

impl Wind {
    /// Wind of mean `velocity` (m/s), the rest as by default.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// Air that moves with `velocity` (m/s) everywhere, whatever stands in its way.
    pub fn uniform(velocity: Vec3) -> Self {
        Self { velocity, gusts: 0.0, cells: 0, ..Self::default() }
    }

    /// Whether there is a fluid to compute.
    pub fn blows(&self) -> bool {
        self.cells > 0 && self.velocity != Vec3::ZERO
    }

    /// The range of the speed of [`velocity`](Self::velocity).
    pub const SPEED: Range = range!("speed of the wind", 0.0 to 500.0, "m/s"; usually 0.0 to 100.0);
    /// The range of [`gusts`](Self::gusts).
    pub const GUSTS: Range = range!("gusts", 0.0 to 1.0);
    /// The range of [`gust_length`](Self::gust_length).
    pub const GUST_LENGTH: Range = range!("gust length", 0.01 to 1000.0, "m"; usually 0.05 to 100.0);
    /// The range of [`room`](Self::room).
    pub const ROOM: Range = range!("room around the hair", 1.2 to 20.0);

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not.
    pub fn check(&self) -> Result<()> {
        Self::SPEED.check(self.velocity.length())?;
        Self::GUSTS.check(self.gusts)?;
        Self::GUST_LENGTH.check(self.gust_length)?;
        Self::ROOM.check(self.room)?;
        if self.cells != 0
            && (!(MIN_CELLS..=MAX_CELLS).contains(&self.cells) || !self.cells.is_multiple_of(8))
        {
            return Err(Error::Parameter {
                name: "cells of the air",
                value: self.cells.to_string(),
                range: "0 or a multiple of 8 up to 96",
            });
        }
        Ok(())
    }
}

/// See [`crate::constants::MAX_GUSTS`].
pub const MAX_GUSTS: usize = crate::constants::MAX_GUSTS as usize;

/// Uniforms of the fluid's kernels in one step. Positions are relative to the grid's corner.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct WindUniforms {
    /// Mean wind, m/s.
    pub mean: Vec3,
    /// Cells along an axis.
    pub cells: u32,
    /// By how many cells the grid has moved since the last step.
    pub shift: IVec3,
    /// Length of the step over the edge of a cell, s/m: cells passed in the step per m/s.
    pub reach: f32,
    /// Rotation of the head at the start of the step, quaternion: the hair's grid turns with it.
    pub head: [f32; 4],
    /// The head's origin at the start of the step, metres.
    pub head_at: Vec3,
    /// Edge of a cell, metres.
    pub cell: f32,
    /// The grid's corner, from where hair is simulated, metres.
    pub corner: Vec3,
    /// The moment of the colliders (see [`crate::collide`]).
    pub moment: u32,
    /// Texture coordinate of the head's origin in the hair's grid.
    pub hair_bias: Vec3,
    /// Texture coordinates of the hair's grid per metre.
    pub hair_scale: f32,
    /// 1 when the air starts anew, undisturbed.
    pub reset: u32,
    /// Bit `2 axis` (`+ 1`): the air enters through the lower (upper) side of that axis.
    pub inflow: u32,
    /// How many of `gusts` there are.
    pub gust_count: u32,
    /// Drag of the hair in a cell: step times half a hair's diameter times the share of hairs that
    /// lie across; per m/s, per km/m³ and per drag coefficient.
    pub drag: f32,
    /// Reynolds number of a hair per m/s.
    pub reynolds: f32,
    /// Always one. Loops that count by it are not unrolled.
    pub one: u32,
    /// 1 for plain semi-Lagrangian advection, for comparison.
    pub plain: u32,
    /// Unused.
    pub _pad: u32,
    /// By how much all air is faster than it was, because the grid is slower, m/s.
    pub kick: Vec3,
    /// Unused.
    pub _pad_kick: u32,
    /// The gusts.
    pub gusts: [GustMode; MAX_GUSTS],
}

/// Uniforms of one half of a sweep.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Half {
    /// Which half of the blocks.
    pub color: u32,
    /// 1 when the pressures of this half are known, 0 when they start from 0.
    pub keep_own: f32,
    /// The same of the other half.
    pub keep_other: f32,
    /// Over-relaxation: how far towards what is right for the pressures around.
    pub relaxation: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_values_are_refused_by_name() {
        Wind::default().check().unwrap();
        Wind::uniform(Vec3::X).check().unwrap();
        for (wind, name) in [
            (Wind::new(Vec3::splat(f32::NAN)), "wind"),
            (Wind::new(Vec3::X * 1e4), "wind"),
            (Wind { gusts: -0.1, ..Default::default() }, "gusts"),
            (Wind { gust_length: 0.0, ..Default::default() }, "gust length"),
            (Wind { room: f32::INFINITY, ..Default::default() }, "room"),
            (Wind { cells: 12, ..Default::default() }, "cells"),
            (Wind { cells: 104, ..Default::default() }, "cells"),
        ] {
            assert!(wind.check().unwrap_err().to_string().contains(name));
        }
        assert!(!Wind::default().blows() && !Wind::uniform(Vec3::X).blows() && Wind::new(Vec3::X).blows());
    }
}
