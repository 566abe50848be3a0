//! `--debug`: debug views of the library, with a legend.

mod legend;

use crate::picture::Image;
use anyhow::{Result, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use legend::Legend;
use tresses::{
    HairHairMode, SimulationParams,
    low_level::{DebugDisplay, DebugView, Peak, panels},
};
use tresses_scene::Scene;

/// Options of debug views.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct DebugArgs {
    /// Show a debug view with a legend (docs/reference/debug-views.md)
    #[arg(long, value_name = "NAME", value_parser = view(), help_heading = "Debug views")]
    pub debug: Option<DebugView>,
    /// Value of the brightest color of --debug [default: a round number; for grids, the peak of all frames]
    #[arg(
        long, value_name = "X", requires = "debug", value_parser = positive,
        help_heading = "Debug views", hide_short_help = true
    )]
    pub debug_max: Option<f32>,
}

/// Parses the name of a view.
fn view() -> impl TypedValueParser<Value = DebugView> {
    PossibleValuesParser::new(DebugView::ALL.map(|view| PossibleValue::new(view.name()).help(view.hint())))
        .try_map(|name| DebugView::named(&name).ok_or("there is no such view"))
}

impl DebugArgs {
    /// Checks that `physics` simulates what the view shows.
    pub fn check(&self, physics: &SimulationParams) -> Result<()> {
        ensure!(
            !matches!(self.debug, Some(DebugView::Density | DebugView::Push))
                || physics.hair_hair.mode != HairHairMode::Off,
            "--debug has nothing to show: --hair-hair is off"
        );
        ensure!(
            self.debug != Some(DebugView::Wind) || physics.wind.blows(),
            "--debug has nothing to show: there is no wind; give --wind a speed"
        );
        Ok(())
    }
}

fn positive(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(x) if (1e-9..=1e9).contains(&x) => Ok(x),
        _ => Err("expected a number above 0".into()),
    }
}

/// State of a debug view besides what the scene draws: the range of its colors, and its legend.
pub struct Debug {
    peak: Peak,
    /// Largest value in the frames observed so far.
    largest: f32,
    is_of_sequence: bool,
}

impl Debug {
    /// Makes `stage` show the requested view, if any.
    pub fn new(stage: &mut Scene, args: &DebugArgs) -> Result<Option<Self>> {
        let Some(view) = args.debug else { return Ok(None) };
        stage.show(Some(DebugDisplay { high: args.debug_max, ..DebugDisplay::new(view) }))?;
        Ok(Some(Self { peak: Peak::new(&stage.gpu.context), largest: 0.0, is_of_sequence: false }))
    }

    /// Measures the peak of a grid whose color range is not set. Blocks.
    fn unknown(&mut self, stage: &Scene) -> Result<Option<f32>> {
        let hair = stage.character.hair();
        let Some(shown) = stage.shown().filter(|shown| shown.high.is_none()) else { return Ok(None) };
        let Some(grid) = shown.view.grid(hair) else { return Ok(None) };
        Ok(Some(pollster::block_on(self.peak.measure(&grid))?))
    }

    /// Whether the color range depends on all frames of a sequence.
    pub fn seeks_range(&self, stage: &Scene) -> bool {
        use DebugView::{Density, Push, Wind};
        let grids =
            |shown: &DebugDisplay| matches!(shown.view, Density | Push | Wind) && shown.high.is_none();
        stage.shown().as_ref().is_some_and(grids)
    }

    /// Includes a frame in the color range of the sequence. Blocks.
    pub fn observe(&mut self, stage: &Scene) -> Result<()> {
        self.largest = self.largest.max(self.unknown(stage)?.unwrap_or(0.0));
        Ok(())
    }

    /// Sets the color range from all observed frames.
    pub fn settle(&mut self, stage: &mut Scene) -> Result<()> {
        if let Some(shown) = stage.shown().filter(|_| self.largest > 0.0) {
            stage.show(Some(DebugDisplay { high: Some(legend::rounded_up(self.largest)), ..shown }))?;
            self.is_of_sequence = true;
        }
        Ok(())
    }

    /// Sets the color range before a frame, if it is unknown and the grid is not empty. Blocks.
    pub fn prepare(&mut self, stage: &mut Scene) -> Result<()> {
        let peak = self.unknown(stage)?.filter(|peak| *peak > 0.0);
        if let (Some(peak), Some(shown)) = (peak, stage.shown()) {
            stage.show(Some(DebugDisplay { high: Some(legend::rounded_up(peak)), ..shown }))?;
        }
        Ok(())
    }

    /// Draws the legend of `shown` into a frame.
    pub fn label(&self, shown: &DebugDisplay, picture: &mut Image) {
        if let Some(scale) = shown.scale() {
            let of = if self.is_of_sequence { ", up to the peak of all frames" } else { "" };
            let title = format!("{}{of}", scale.title);
            Legend { title, min: scale.low, max: scale.high }.draw(picture);
        }
        use DebugView::{Density, Distance, Push, Wind};
        if matches!(shown.view, Density | Push | Wind | Distance) {
            let size = [picture.width as f32, picture.height as f32];
            let panel = panels([picture.width, picture.height]);
            for (i, caption) in ["from the left", "from above", "from the front"].into_iter().enumerate() {
                let corner = [panel.x, panel.y + panel.z - i as f32 * panel.w];
                let at = [0.5 + 0.5 * corner[0], 0.5 - 0.5 * corner[1]];
                legend::caption(picture, caption, [at[0] * size[0], at[1] * size[1]].map(|x| x as i32));
            }
        }
    }
}
