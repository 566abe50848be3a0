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
    pub helmet: bool,
    /// Edge of the textures, texels: a power of two from 128 to 8192.
    pub texture: u32,
    /// Number of different pictures of locks in the textures.
    pub textures: u32,
    /// Largest number of triangles of each level; where missing, 48 per card in the first level, 32 in the second, 12
    /// in the others, and 480 in a helmet.
    pub triangles: Vec<u32>,
    /// Number of chains of bones that carry the cards, at most 256; without, cards follow the body alone.
    pub chains: u32,
    /// Seed of random choices.
    pub seed: u32,
}

impl Default for CardOptions {
    fn default() -> Self {
        Self {
            levels: vec![400, 150, 40],
            helmet: false,
            texture: 2048,
            textures: 32,
            triangles: Vec::new(),
            chains: 0,
            seed: 1,
        }
    }
}

impl CardOptions {
    /// Largest number of levels.
    pub const MOST_LEVELS: usize = 8;
    /// Largest number of cards of a level.
    pub const MOST_CARDS: u32 = 4096;

    /// Largest number of chains.
    pub const MOST_CHAINS: u32 = 256;

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] for levels that do not fall, and for numbers out of range.
    pub fn check(&self) -> Result<()> {
        let wrong = |name, value: String, range| Err(Error::Parameter { name, value, range });
        let falls = self.levels.windows(2).all(|pair| pair[0] > pair[1]);
        let fits = (1..=Self::MOST_LEVELS).contains(&self.levels.len())
            && self.levels.iter().all(|count| (1..=Self::MOST_CARDS).contains(count));
        if !(falls && fits) {
            return wrong(
                "the list of levels",
                format!("{:?}", self.levels),
                "1 to 8 falling numbers from 1 to 4096",
            );
        }
        if !(self.texture.is_power_of_two() && (128..=8192).contains(&self.texture)) {
            return wrong("the texture size", self.texture.to_string(), "a power of two from 128 to 8192");
        }
        if !(1..=1024).contains(&self.textures) {
            return wrong("the number of pictures", self.textures.to_string(), "from 1 to 1024");
        }
        if self.chains > Self::MOST_CHAINS {
            return wrong("the number of chains", self.chains.to_string(), "from 0 to 256");
        }
        if self.triangles.len() > self.levels.len() + usize::from(self.helmet) {
            return wrong("the list of triangles", format!("{:?}", self.triangles), "at most one per level");
        }
        let few =
            self.triangles.iter().zip(&self.levels).find(|(triangles, cards)| **triangles < 2 * **cards);
        match few {
            Some((triangles, _)) => {
                wrong("the list of triangles", triangles.to_string(), "at least two per card")
            }
            None => Ok(()),
        }
    }

    /// Largest number of triangles of a level. The helmet is the level after the cards.
    pub(super) fn most_triangles(&self, level: usize) -> usize {
        let each = [48, 32].get(level).copied().unwrap_or(12);
        let usual = self.levels.get(level).map_or(HELMET, |cards| cards * each);
        self.triangles.get(level).copied().unwrap_or(usual) as usize
    }

    /// Returns the number of pictures of each level: finer levels have more.
    pub(super) fn pictures(&self) -> Vec<usize> {
        let sum: f32 = (1..=self.levels.len()).map(|i| 1.0 / i as f32).sum();
        let share = |level: usize| (self.textures as f32 / (sum * (level + 1) as f32)) as usize;
        (0..self.levels.len()).map(|level| share(level).clamp(1, self.levels[level] as usize)).collect()
    }
}
