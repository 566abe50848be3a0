//! Panels and controls around the viewport, one per file.

pub mod body;
pub mod brush;
pub mod cards;
pub mod files;
pub mod format;
pub mod frames;
pub mod groom;
pub mod icons;
pub mod inside;
pub mod keys;
pub mod knobs;
pub mod legend;
pub mod lights;
pub mod map_choice;
pub mod overlay;
pub mod palette;
pub mod record;
pub mod side;
pub mod status;
pub mod time;
pub mod top;
pub mod transport;
pub mod wind;

use crate::{
    answer::Answer, cards::CardForm, dialog::Dialogs, light_handles::LightHandles, renderer::StudioRenderer,
    task,
};
use eframe::egui;
use tresses::glam::Vec3;

/// Reads the simulated guides back and queues their shapes, for the groom to keep.
pub fn keep(renderer: &StudioRenderer, dialogs: &Dialogs) {
    let Some(show) = &renderer.show else { return };
    let (pending, count, back) = show.guides();
    let dialogs = dialogs.clone();
    task::spawn(move || async move {
        dialogs.tell(match pending.wait().await {
            Ok(bytes) => {
                let points: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
                let vertices = points.len() / count.max(1);
                let at = |i: usize| {
                    let [x, y, z, _] = points[i % vertices * count + i / vertices];
                    back.point(Vec3::new(x, y, z))
                };
                Answer::Kept((0..vertices * count).map(at).collect())
            }
            Err(error) => Answer::Failed(error.to_string()),
        });
    });
}

/// State of the panels.
#[derive(Debug, Default)]
pub struct Panels {
    /// Durations of the last frames.
    pub frames: frames::Frames,
    /// Page of the side panel.
    pub page: side::SidePage,
    /// Choices for baking cards.
    pub cards: CardForm,
    /// Search words for parameters.
    pub search: String,
    /// The lights in the viewport.
    pub lights: LightHandles,
    /// Whether the dialog that records a loop is open.
    pub record: bool,
    /// Dropped images whose kind the user must choose.
    pub map_choices: Vec<map_choice::MapChoice>,
    /// Whether the side panel is hidden; `None` hides it in narrow windows.
    folded: Option<bool>,
}

/// Window width from which the side panel is shown by default, points.
const MIN_UNFOLDED_WIDTH: f32 = 760.0;

impl Panels {
    /// Whether the side panel is hidden.
    pub fn is_folded(&self, context: &egui::Context) -> bool {
        self.folded.unwrap_or(context.content_rect().width() < MIN_UNFOLDED_WIDTH)
    }

    /// Hides or shows the side panel.
    pub fn fold(&mut self, context: &egui::Context) {
        self.folded = Some(!self.is_folded(context));
    }
}
