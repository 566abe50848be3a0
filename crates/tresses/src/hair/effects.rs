//! Forces on the guides besides their own physics.

use crate::{
    Context,
    simulate::{Forces, Grab, Links},
    strands::GuideBuffers,
    volume::Volume,
    wind::Air,
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
    /// Creates the effects without wind, without links and without a grab.
    pub fn new(context: &Context, guides: &GuideBuffers, volume: &Volume) -> Self {
        let forces = Forces::new(context, guides, volume, None);
        Self { forces, links: None, grab: Grab::default(), windy: false, forced: false }
    }

    /// Binds other buffers of the same guides.
    pub fn bind(&mut self, context: &Context, guides: &GuideBuffers, volume: &Volume, air: Option<&Air>) {
        self.forces = Forces::new(context, guides, volume, air);
        self.links = self.links.take().map(|links| Links::new(context, guides, links.asset));
        self.grab.forget_buffers();
    }
}
