//! Cards of the character on the screen.

use crate::stage::CharacterDisplay;
use anyhow::{Context, Result};
use std::path::Path;
use tresses::groom::{
    Rig, TriMesh,
    cards::{CardAlpha, CardOptions},
};
use tresses_scene::{
    Settings,
    cards::{self, CardChain, CardFormat, LevelRequest},
};

/// The user's choices for a bake.
#[derive(Clone, Debug)]
pub struct CardForm {
    /// Levels, as in the command.
    pub levels: String,
    /// Edge of the textures, texels.
    pub texture: u32,
    /// Chains of bones in the file.
    pub bones: u32,
}

impl Default for CardForm {
    fn default() -> Self {
        let CardOptions { texture_size: texture, chain_count: chains, .. } = CardOptions::default();
        Self { levels: "400, 150, 40, helmet".into(), texture, bones: chains }
    }
}

impl CardForm {
    /// Returns the options.
    ///
    /// # Errors
    /// Fails with a sentence for levels that make no sense.
    pub fn options(&self) -> Result<CardOptions> {
        let levels = self.levels.split(',').map(str::parse).collect::<Result<Vec<LevelRequest>>>()?;
        let options =
            CardOptions { texture_size: self.texture, chain_count: self.bones, ..cards::options(&levels)? };
        options.check()?;
        Ok(options)
    }
}

/// Baked cards, and the body for their file.
#[derive(Debug)]
pub struct BakedCards {
    /// The levels.
    pub chain: CardChain,
    /// The body.
    pub head: Option<TriMesh>,
    /// Its rig.
    pub rig: Option<Rig>,
    /// Number of strands that the cards replace.
    pub strands: usize,
}

impl BakedCards {
    /// Returns the bytes of a `.glb` file with all levels and the body.
    ///
    /// # Errors
    /// As [`CardFormat::encoded`].
    pub fn glb(&self, settings: &Settings) -> Result<Vec<u8>> {
        let body = self.head.as_ref().map(|head| (head, self.rig.as_ref()));
        let look = cards::look(settings, CardAlpha::Core);
        let files = CardFormat::Glb.encoded(&self.chain.cards, body, &look, Path::new("hair.glb"))?;
        files.into_iter().next().map(|(_, bytes)| bytes).context("there are no cards")
    }
}

/// The level of the hair on the screen.
#[derive(Debug)]
pub struct CardPreview {
    /// The cards.
    pub baked: BakedCards,
    /// Whether the level follows from the size of the hair in the image.
    pub by_size: bool,
}

impl CardPreview {
    /// Creates a preview that shows the first level.
    pub fn new(baked: BakedCards, show: &mut CharacterDisplay) -> Self {
        let mut preview = Self { baked, by_size: false };
        preview.show(show, Some(0));
        preview
    }

    /// Returns the levels.
    pub fn chain(&self) -> &CardChain {
        &self.baked.chain
    }

    /// Returns `strands`, or the name of the level on the screen.
    pub fn name(&self) -> String {
        let chain = self.chain();
        chain.shown().map_or_else(|| "strands".into(), |level| chain.cards.levels[level].name())
    }

    /// Shows a level, or strands. Returns whether that is a change.
    pub fn show(&mut self, show: &mut CharacterDisplay, level: Option<usize>) -> bool {
        self.baked.chain.show(&mut show.stage, level)
    }

    /// Shows the level for the current size of the hair, if the level follows from it. Returns whether that is a
    /// change.
    pub fn follow(&mut self, show: &mut CharacterDisplay) -> bool {
        self.by_size && self.show(show, self.chain().fitting(show.hair_size()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_read_as_in_the_command() {
        let options = CardForm::default().options().unwrap();
        assert_eq!((options.levels, options.has_helmet), (vec![400, 150, 40], true));
        for (levels, error) in
            [("many", "number of cards"), ("40, 150", "falling"), ("helmet, 4", "last"), ("", "")]
        {
            let form = CardForm { levels: levels.into(), ..CardForm::default() };
            let found = form.options().unwrap_err().to_string();
            assert!(found.contains(error), "{levels}: {found}");
        }
    }
}
