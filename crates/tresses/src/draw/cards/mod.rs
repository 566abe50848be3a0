//! Cards: textured strips between two strands, for grooms with a [`CardSheet`](crate::groom::card_sheet::CardSheet).
//!
//! The strands of such a groom are the columns of its cards. They are simulated, interpolated and shaded like other
//! strands. Here their colors are interpolated over the cards and multiplied by the texture.
//!
//! ```text
//! strand vertices, shaded ─► core: opaque, depth ─► fringe: blended in the order of the bake, behind nothing opaque
//! ```
//!
//! The core hides the cards behind it, so errors of the order of blending show only in the fringe.

use super::canvas::{Canvas, HDR_FORMAT, pass};
use crate::{
    Context, Result,
    gpu::{
        Device,
        kernel::Job,
        pipeline::{PipelineCache, Recipe, blended},
    },
    light::{self, HairView},
    renderer::ShadingRate,
    stage::Stage,
};

/// The two passes over all cards, by their entry points.
const PASSES: [&str; 2] = ["card_core", "card_fringe"];

/// Pipelines of cards, compiled at first use.
#[derive(Debug)]
pub(crate) struct Pipelines {
    device: Device,
    /// Layouts of the bind groups of the frame and the hair.
    groups: [wgpu::BindGroupLayout; 2],
    passes: PipelineCache<(&'static str, u32), wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(context: &Context, light: &light::Pipelines) -> Self {
        Self {
            device: context.device.clone(),
            groups: [light.frame.clone(), light.hair.clone()],
            passes: PipelineCache::default(),
        }
    }

    fn get(&self, name: &'static str, samples: u32) -> Result<wgpu::RenderPipeline> {
        let [frame, hair] = &self.groups;
        let core = name == PASSES[0];
        let over = blended(HDR_FORMAT, wgpu::BlendFactor::One, wgpu::BlendFactor::OneMinusSrcAlpha);
        self.passes.get((name, samples), || {
            Recipe {
                vertex: ("draw::cards::cards", "card_vertex"),
                fragment: Some(("draw::cards::cards", name)),
                layouts: &[frame, hair, &light::cards::layout(&self.device)],
                targets: &[if core { Some(HDR_FORMAT.into()) } else { over.clone() }],
                depth: Some((core, wgpu::CompareFunction::Greater)),
                samples,
                ..Recipe::PLAIN
            }
            .build(&self.device)
        })
    }

    /// Returns jobs that compile the pipelines. Jobs can run in parallel.
    pub fn jobs(&self, samples: u32) -> Vec<Job<'_>> {
        PASSES.map(|name| Box::new(move || self.get(name, samples).map(|_| ())) as Job<'_>).into()
    }

    /// Shades and records grooms that are drawn as cards.
    pub fn record(&self, canvas: &mut Canvas<'_, '_>, cards: &[HairView<'_>]) -> Result<()> {
        if cards.is_empty() {
            return Ok(());
        }
        canvas.light.shade(canvas.commands, cards, ShadingRate::PerVertex)?;
        canvas.commands.lap(Stage::Shade);
        for name in PASSES {
            let pipeline = self.get(name, canvas.target.samples)?;
            let mut pass = pass(canvas, "cards", false);
            pass.set_pipeline(&pipeline);
            cards.iter().for_each(|view| view.record_cards(&mut pass));
        }
        canvas.commands.lap(Stage::Hair);
        Ok(())
    }
}
