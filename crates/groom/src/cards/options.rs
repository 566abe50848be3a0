//! Options for cards.

use crate::{Error, Result};

/// Triangles of a helmet.
const HELMET: u32 = 480;

/// Options for baking cards.
#[derive(Clone, Debug, PartialEq)]
pub struct CardOptions {
    /// Number of cards of each level, falling.
    pub levels: Vec<u32>,
    /// Whether a helmet is the last level: an opaque shell around the hair, for hair that is dense enough.
    pub has_helmet: bool,
    /// Edge of the textures, texels: a power of two from 128 to 8192.
    pub texture_size: u32,
    /// Number of different pictures of locks in the textures.
    pub lock_texture_count: u32,
    /// Largest number of triangles of each level; where missing, 48 per card in the first level, 32 in the second, 12
    /// in the others, and 480 in a helmet.
    pub triangles: Vec<u32>,
    /// Number of chains of bones that carry the cards, at most 256; without, cards follow the body alone.
    pub chain_count: u32,
    /// Seed of random choices.
    pub seed: u32,
}

impl Default for CardOptions {
    fn default() -> Self {
        Self {
            levels: vec![400, 150, 40],
            has_helmet: false,
            texture_size: 2048,
            lock_texture_count: 32,
            triangles: Vec::new(),
            chain_count: 0,
            seed: 1,
        }
    }
}

impl CardOptions {
    /// Largest number of levels.
    pub const MAX_LEVELS: usize = 8;
    /// Largest number of cards of a level.
    pub const MAX_CARDS: u32 = 4096;

    /// Largest number of chains.
    pub const MAX_CHAINS: u32 = 256;

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] for levels that do not fall, and for numbers out of range.
    pub fn check(&self) -> Result<()> {
        let wrong = |name, value: String, range| Err(Error::Parameter { name, value, range });
        let falls = self.levels.windows(2).all(|pair| pair[0] > pair[1]);
        let fits = (1..=Self::MAX_LEVELS).contains(&self.levels.len())
            && self.levels.iter().all(|count| (1..=Self::MAX_CARDS).contains(count));
        if !(falls && fits) {
            return wrong(
                "the list of levels",
                format!("{:?}", self.levels),
                "1 to 8 falling numbers from 1 to 4096",
            );
        }
        if !(self.texture_size.is_power_of_two() && (128..=8192).contains(&self.texture_size)) {
            return wrong(
                "the texture size",
                self.texture_size.to_string(),
                "a power of two from 128 to 8192",
            );
        }
        if !(1..=1024).contains(&self.lock_texture_count) {
            return wrong("the number of pictures", self.lock_texture_count.to_string(), "from 1 to 1024");
        }
        if self.chain_count > Self::MAX_CHAINS {
            return wrong("the number of chains", self.chain_count.to_string(), "from 0 to 256");
        }
        if self.triangles.len() > self.levels.len() + usize::from(self.has_helmet) {
            return wrong("the list of triangles", format!("{:?}", self.triangles), "at most one per level");
        }
        let too_small =
            self.triangles.iter().zip(&self.levels).find(|(triangles, cards)| **triangles < 2 * **cards);
        match too_small {
            Some((triangles, _)) => {
                wrong("the list of triangles", triangles.to_string(), "at least two per card")
            }
            None => Ok(()),
        }
    }

    /// Largest number of triangles of a level. The helmet is the level after the cards.
    pub(super) fn max_triangles(&self, level: usize) -> usize {
        let each = [48, 32].get(level).copied().unwrap_or(12);
        let default_count = self.levels.get(level).map_or(HELMET, |cards| cards * each);
        self.triangles.get(level).copied().unwrap_or(default_count) as usize
    }

    /// Returns the number of pictures of each level: finer levels have more.
    pub(super) fn pictures(&self) -> Vec<usize> {
        let sum: f32 = (1..=self.levels.len()).map(|i| 1.0 / i as f32).sum();
        let count = |level: usize| (self.lock_texture_count as f32 / (sum * (level + 1) as f32)) as usize;
        (0..self.levels.len()).map(|level| count(level).clamp(1, self.levels[level] as usize)).collect()
    }
}
