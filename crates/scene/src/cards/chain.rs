//! Baked cards as characters: a level at a time takes the place of the strands.

use crate::{Colliders, Quality, Scene, Settings, scene::uploaded};
use anyhow::Result;
use tresses::{Character, CharacterParts, Context, Progress, groom::cards::Cards};

/// Share by which hair may be larger than the switch size before a level that is shown gives way.
const SLACK: f32 = 0.1;

/// Cards of a character, and the character with each level of cards as its hair.
#[derive(Debug)]
pub struct CardChain {
    /// All levels.
    pub cards: Cards,
    /// A character for each level, `None` for a helmet. The strands take the place of the level that is shown.
    characters: Vec<Option<Character>>,
    shown: Option<usize>,
}

impl CardChain {
    /// Uploads all levels of `cards`, baked from `parts`, at rest under the physics of `settings` with `colliders`.
    ///
    /// # Errors
    /// As [`Scene::new`] and [`Cards::strands`].
    pub async fn new(
        context: &Context,
        parts: &CharacterParts,
        cards: Cards,
        colliders: &Colliders,
        settings: &Settings,
        quality: &Quality,
        progress: &impl Progress,
    ) -> Result<Self> {
        let mut characters = Vec::new();
        for (i, level) in cards.levels.iter().enumerate() {
            characters.push(match level.helmet {
                true => None,
                false => {
                    let parts = parts.clone().with_cards(&cards, i)?;
                    Some(uploaded(context, parts, (colliders, settings, quality), progress).await?)
                }
            });
        }
        Ok(Self { cards, characters, shown: None })
    }

    /// Returns the level that is shown, `None` for strands.
    pub fn shown(&self) -> Option<usize> {
        self.shown
    }

    /// Whether the level can be shown: a helmet is only in files.
    pub fn can_show(&self, level: usize) -> bool {
        self.characters.get(level).is_some_and(Option::is_some)
    }

    /// Shows a level in `scene`, or the strands. Returns whether that is a change. `scene` must be the one that the
    /// last call changed.
    pub fn show(&mut self, scene: &mut Scene, level: Option<usize>) -> bool {
        if level == self.shown || level.is_some_and(|level| !self.can_show(level)) {
            return false;
        }
        for index in [self.shown, level].into_iter().flatten() {
            if let Some(other) = &mut self.characters[index] {
                scene.exchange(other);
            }
        }
        self.shown = level;
        true
    }

    /// Returns the coarsest level that may replace strands where the hair has a diameter of `size` pixels, `None` for
    /// strands. The level that is shown stays until the hair is a tenth larger than its switch size.
    pub fn fitting(&self, size: f32) -> Option<usize> {
        (0..self.characters.len()).rev().find(|level| {
            let slack = if self.shown.is_some_and(|shown| shown >= *level) { 1.0 + SLACK } else { 1.0 };
            self.can_show(*level) && size < slack * self.cards.levels[*level].accuracy.switch
        })
    }
}
