//! User parameters, in SI units, and the uniforms of one step.

use crate::{Error, Result, groom::range, range::Range};
use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3};

/// One wave of the gusts in a step: `amplitude cos(wave · x + phase)`, `x` in cells from the grid's corner.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct GustMode {
    /// Wave vector, radians per cell.
    pub wave: Vec3,
    /// Phase, radians.
    pub phase: f32,
    /// Amplitude, m/s.
    pub amplitude: Vec3,
    /// Unused.
    pub _pad: f32,
}

/// Wind parameters: the air far from the head, and the grid of the air around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Mean velocity of the air far from the head, m/s, in world axes. In a space that [carries its
    /// air](crate::space::Space::moves_air), relative to the space and in its axes. Zero is calm air unless the space
    /// moves through it: no fluid is computed, and only [`crate::simulate::SimulationParams::drag`] slows hair.
    pub velocity: Vec3,
    /// Intensity of the gusts: standard deviation of each velocity component over the mean speed. About 0.1 over open
    /// water, 0.2 over open land, 0.4 between houses.
    pub gusts: f32,
    /// Integral length scale of the gusts, meters. A gust takes about this length over the speed to pass.
    pub gust_length: f32,
    /// Random seed; the same seed gives the same gusts.
    pub seed: u32,
    /// Cells of the fluid's grid along each axis, a multiple of 8 up to 96; 0 for uniform air. Without the fluid
    /// nothing shields hair from the wind, so only [`crate::simulate::SimulationParams::drag`] acts, not the quadratic
    /// drag of single hairs.
    pub resolution: u32,
    /// Edge of the fluid's grid, relative to the longest side of the box around the hair at rest.
    pub grid_size: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self { velocity: Vec3::ZERO, gusts: 0.2, gust_length: 2.0, seed: 1, resolution: 32, grid_size: 2.2 }
    }
}

/// Minimum number of cells along an axis.
pub const MIN_CELLS: u32 = 8;
/// Maximum number of cells along an axis.
pub const MAX_CELLS: u32 = 96;

impl Wind {
    /// Returns wind of mean `velocity` (m/s), with default values otherwise.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// Returns air of uniform `velocity` (m/s), without obstacles.
    pub fn uniform(velocity: Vec3) -> Self {
        Self { velocity, gusts: 0.0, resolution: 0, ..Self::default() }
    }

    /// Returns whether there is a fluid to simulate.
    pub fn blows(&self) -> bool {
        self.resolution > 0 && self.velocity != Vec3::ZERO
    }

    /// The range of the speed of [`velocity`](Self::velocity).
    pub const SPEED: Range = range!("wind speed", 0.0 to 500.0, "m/s"; usually 0.0 to 100.0);
    /// The range of [`gusts`](Self::gusts).
    pub const GUSTS: Range = range!("gusts", 0.0 to 1.0);
    /// The range of [`gust_length`](Self::gust_length).
    pub const GUST_LENGTH: Range = range!("gust length", 0.01 to 1000.0, "m"; usually 0.05 to 100.0);
    /// The range of [`grid_size`](Self::grid_size).
    pub const GRID_SIZE: Range = range!("air grid size", 1.2 to 20.0);

    /// Checks that every value is finite and in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first invalid value.
    pub fn check(&self) -> Result<()> {
        Self::SPEED.check(self.velocity.length())?;
        Self::GUSTS.check(self.gusts)?;
        Self::GUST_LENGTH.check(self.gust_length)?;
        Self::GRID_SIZE.check(self.grid_size)?;
        if self.resolution != 0
            && (!(MIN_CELLS..=MAX_CELLS).contains(&self.resolution) || !self.resolution.is_multiple_of(8))
        {
            return Err(Error::Parameter {
                name: "air grid cells",
                value: self.resolution.to_string(),
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
pub(crate) struct WindUniforms {
    /// Mean wind, m/s.
    pub mean: Vec3,
    /// Cells along an axis.
    pub cells: u32,
    /// Displacement of the grid since the last step, cells.
    pub shift: IVec3,
    /// Length of the step over the edge of a cell, s/m: cells traveled in the step per m/s.
    pub advection_scale: f32,
    /// Rotation of the head at the start of the step, quaternion; the hair's grid turns with the head.
    pub head: [f32; 4],
    /// Position of the head's origin at the start of the step, meters.
    pub head_at: Vec3,
    /// Edge of a cell, meters.
    pub cell: f32,
    /// Corner of the grid in the space of the simulation, meters.
    pub corner: Vec3,
    /// Collider moment (see [`crate::collide`]) of the step.
    pub moment: u32,
    /// Texture coordinate of the head's origin in the hair's grid.
    pub hair_bias: Vec3,
    /// Texture coordinates of the hair's grid per meter.
    pub hair_scale: f32,
    /// 1 if the air starts anew, undisturbed.
    pub reset: u32,
    /// Inflow sides: bit `2 axis` (or `2 axis + 1`) is set if air enters through the lower (upper) side of that axis.
    pub inflow: u32,
    /// Number of `gusts`.
    pub gust_count: u32,
    /// Drag of the hair in a cell: step times half a hair's diameter times the effective fraction of hairs across the
    /// flow; per m/s, per km/m³ and per drag coefficient.
    pub drag: f32,
    /// Reynolds number of a hair per m/s.
    pub reynolds: f32,
    /// Always 1. Loops that increment by it are not unrolled.
    pub one: u32,
    /// 1 for plain semi-Lagrangian advection, for comparison.
    pub plain: u32,
    /// Unused.
    pub _pad: u32,
    /// Velocity added to all air, m/s, because the grid has slowed down by as much.
    pub kick: Vec3,
    /// Unused.
    pub _pad_kick: u32,
    /// The gusts.
    pub gusts: [GustMode; MAX_GUSTS],
}

/// Uniforms of half a sweep.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct HalfSweep {
    /// Index of the half of the blocks, 0 or 1.
    pub color: u32,
    /// 1 if the pressures of this half are known, 0 if they start from 0.
    pub keep_own: f32,
    /// 1 if the pressures of the other half are known, else 0.
    pub keep_other: f32,
    /// Over-relaxation factor.
    pub relaxation: f32,
}

/// Uniforms of a multigrid kernel: its level, and the parts of its work. Flags are 0 or 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct AirLevel {
    /// Cells along an axis.
    pub cells: u32,
    /// Cells along an axis that have a pressure. The finest level's last cells are outside.
    pub inside: u32,
    /// Cells along an axis of the next coarser level.
    pub coarse: u32,
    /// Reads the equations from the faces, and stores them.
    pub gathers: u32,
    /// Starts from the old pressures instead of 0.
    pub keeps: u32,
    /// Adds the pressures of the next coarser level.
    pub corrects: u32,
    /// Writes the equations of the next coarser level.
    pub restricts: u32,
    /// Unused.
    pub _pad: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_values_return_errors_with_names() {
        Wind::default().check().unwrap();
        Wind::uniform(Vec3::X).check().unwrap();
        for (wind, name) in [
            (Wind::new(Vec3::splat(f32::NAN)), "wind"),
            (Wind::new(Vec3::X * 1e4), "wind"),
            (Wind { gusts: -0.1, ..Default::default() }, "gusts"),
            (Wind { gust_length: 0.0, ..Default::default() }, "gust length"),
            (Wind { grid_size: f32::INFINITY, ..Default::default() }, "grid size"),
            (Wind { resolution: 12, ..Default::default() }, "cells"),
            (Wind { resolution: 104, ..Default::default() }, "cells"),
        ] {
            assert!(wind.check().unwrap_err().to_string().contains(name));
        }
        assert!(!Wind::default().blows() && !Wind::uniform(Vec3::X).blows() && Wind::new(Vec3::X).blows());
    }
}
