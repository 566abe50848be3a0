//! Constants of the model, from `gpu-constants.toml`, which names their units and sources.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Constants of the model.
#[derive(Clone, Debug)]
pub struct Constants {
    /// The chips. The H100 and Apple's run other instructions; their figures assume the cycles of RDNA 3.
    pub chips: Vec<Chip>,
    /// Milliseconds to aim for on the main chip, by the beginning of a scene's name.
    goals: BTreeMap<String, f64>,
    /// Where the atomics of a kernel land.
    pub atomics: BTreeMap<String, AtomicPattern>,
    /// Used part of the memory lines of a kernel's bytes.
    pub lines: BTreeMap<String, f64>,
    texels: BTreeMap<String, TexelLoads>,
}

/// A chip of the model.
#[derive(Clone, Debug)]
pub struct Chip {
    /// Its name.
    pub name: String,
    /// SIMDs, each of which issues for one wave at a time.
    pub simds: f64,
    /// Cycles per second.
    pub clock: f64,
    /// Bytes of memory per second.
    pub bytes: f64,
    /// Fragments per second.
    pub fragments: f64,
    /// Atomics per second, if all threads change one word.
    pub word: f64,
    /// Atomics per second, if the lanes of a wave change one memory line.
    pub line: f64,
    /// Atomics per second elsewhere.
    pub scattered: f64,
    /// Seconds of a command that depends on the one before.
    pub launch: f64,
    /// Seconds of a write to a buffer through the queue.
    pub upload: f64,
    /// Seconds of a further submission.
    pub submission: f64,
    /// Seconds of a pass, or of a run of transfers between passes, besides its commands.
    pub switch: f64,
}

/// Where the atomics of a kernel land.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub enum AtomicPattern {
    /// All on one word, or a few.
    Word,
    /// Atomics of a wave on one memory line.
    Line,
    /// Elsewhere.
    Scattered,
}

/// Loads from an array in a texture.
#[derive(Clone, Copy, Debug, Deserialize)]
struct TexelLoads {
    /// Bytes that a load brings from memory.
    bytes: f64,
    /// Used part of the memory lines.
    used: f64,
}

/// The file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    chips: Vec<String>,
    goals: BTreeMap<String, f64>,
    constants: BTreeMap<String, Constant>,
    atomics: BTreeMap<String, AtomicPattern>,
    lines: BTreeMap<String, f64>,
    texels: BTreeMap<String, TexelLoads>,
}

#[derive(Deserialize)]
struct Constant {
    values: Vec<f64>,
    unit: String,
    source: String,
}

impl Constants {
    /// Path of the file, relative to the root of the repository.
    pub const FILE: &str = "tools/evidence/gpu-constants.toml";

    /// Reads the committed file.
    ///
    /// # Errors
    /// Fails if a constant is missing, unknown, or has no value for a chip, no unit or no source.
    pub fn read() -> Result<Self> {
        Self::parse(include_str!("../../gpu-constants.toml")).context(Self::FILE)
    }

    fn parse(text: &str) -> Result<Self> {
        let Tables { chips, goals, mut constants, atomics, lines, texels } = toml::from_str(text)?;
        let mut values = |name: &str, scale: f64| -> Result<Vec<f64>> {
            let Constant { values, unit, source } =
                constants.remove(name).with_context(|| format!("no {name}"))?;
            ensure!(values.len() == chips.len(), "{name} has {} values", values.len());
            ensure!(!unit.is_empty() && !source.is_empty(), "{name} has no unit or no source");
            Ok(values.into_iter().map(|value| value * scale).collect())
        };
        let (giga, micro) = (1e9, 1e-6);
        let (simds, clock) = (values("simds", 1.0)?, values("clock", giga)?);
        let (bytes, fragments) = (values("bytes", giga)?, values("fragments", giga)?);
        let (word, line, scattered) =
            (values("word", giga)?, values("line", giga)?, values("scattered", giga)?);
        let (launch, upload) = (values("launch", micro)?, values("upload", micro)?);
        let (submission, switch) = (values("submission", micro)?, values("switch", micro)?);
        ensure!(constants.is_empty(), "nothing uses {:?}", constants.keys());
        let chip = |(i, name)| Chip {
            name,
            simds: simds[i],
            clock: clock[i],
            bytes: bytes[i],
            fragments: fragments[i],
            word: word[i],
            line: line[i],
            scattered: scattered[i],
            launch: launch[i],
            upload: upload[i],
            submission: submission[i],
            switch: switch[i],
        };
        Ok(Self { chips: chips.into_iter().enumerate().map(chip).collect(), goals, atomics, lines, texels })
    }

    /// Returns the milliseconds to aim for in a scene.
    pub fn goal(&self, scene: &str) -> Option<f64> {
        self.goals.iter().find(|(name, _)| scene.starts_with(&**name)).map(|(_, goal)| *goal)
    }

    /// Returns the bytes of the memory lines in which `bytes` bytes and `texels` loaded texels of `kernel` lie.
    pub fn line_bytes(&self, kernel: &str, bytes: u64, texels: u64) -> f64 {
        let of_texels = self.texels.get(kernel).map_or(0.0, |loads| loads.bytes / loads.used);
        let used = self.lines.get(kernel).unwrap_or(&1.0);
        bytes as f64 / used + texels as f64 * of_texels
    }

    /// Sets the loads from textures of a kernel.
    #[cfg(test)]
    pub fn set_texels(&mut self, kernel: &str, bytes: f64, used: f64) {
        self.texels.insert(kernel.into(), TexelLoads { bytes, used });
    }

    /// Kernels with rows in any table.
    #[cfg(test)]
    fn named(&self) -> impl Iterator<Item = &String> {
        self.atomics.keys().chain(self.lines.keys()).chain(self.texels.keys())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::low_level::shaders;

    #[test]
    fn rows_name_kernels() {
        for name in Constants::read().unwrap().named() {
            assert!(shaders::all().iter().any(|(kernel, _)| kernel == name), "{name} is no kernel");
        }
    }

    #[test]
    fn each_chip_has_each_constant() {
        let file = include_str!("../../gpu-constants.toml");
        let broken = |from: &str, to: &str| {
            assert!(file.contains(from), "{from}");
            Constants::parse(&file.replacen(from, to, 1)).unwrap_err().to_string()
        };
        assert_eq!(broken("[constants.upload]", "[constants.loadup]"), "no upload");
        assert_eq!(broken("values = [5, 5, 5, 5]", "values = [5]"), "launch has 1 values");
        assert_eq!(broken("unit = \"SIMDs\"", "unit = \"\""), "simds has no unit or no source");
        let chips = Constants::read().unwrap().chips;
        assert_eq!((chips[1].launch, chips[1].bytes), (5.0 * 1e-6, 960.0 * 1e9));
    }

    #[test]
    fn goals_belong_to_scenes() {
        let constants = Constants::read().unwrap();
        assert_eq!(constants.goal("The style long, 1280×720"), Some(1.2));
        assert_eq!(constants.goal("The style long, 3840×2160"), None);
    }
}
