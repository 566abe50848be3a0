//! From a preset to a character.

use anyhow::Result;
use tresses::{Progress, gpu::Gpu, simulate};
use tresses_scene::{Character, Preset};

/// Reads or grows the character of `preset`; what is grown is draped on `gpu`. Blocks.
pub fn load(
    preset: &Preset,
    gpu: &Gpu,
    simulate: &simulate::Pipelines,
    progress: &impl Progress,
) -> Result<Character> {
    pollster::block_on(Character::open(preset, gpu, simulate, progress))
}
