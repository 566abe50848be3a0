//! Forces on the guides besides their own physics.

use crate::{
    Context,
    simulate::{Forces, Grab, Links},
    strands::GuideBuffers,
    volume::Volume,
};

/// Forces of grids, links and grabs.
#[derive(Debug)]
pub(super) struct Effects {
    /// Forces of self-collision and wind.
    pub forces: Forces,
    /// Springs between neighboring guides, where hair is cohesive.
    pub links: Option<Links>,
    pub grab: Grab,
    /// Whether there is wind in this frame.
    pub windy: bool,
    /// Whether the grids act on the guides in this frame.
    pub forced: bool,
}

impl Effects {
    /// Creates the effects without wind and without a grab.
    pub fn new(context: &Context, guides: &GuideBuffers, volume: &Volume, links: Option<Links>) -> Self {
        let forces = Forces::new(context, guides, volume, None);
        Self { forces, links, grab: Grab::default(), windy: false, forced: false }
    }
}
