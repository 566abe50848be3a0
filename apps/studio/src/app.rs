//! The studio: its state, and one frame of the window.

use crate::{
    ball::Ball,
    device,
    dialog::Dialogs,
    events::Waiting,
    files::Files,
    hair::Hair,
    head, hosted,
    job::{Job, Order, Source},
    loss,
    options::Options,
    orbit::Orbit,
    pace::Pace,
    panels,
    play::Play,
    record::{Recording, Wish},
    stage::Show,
    theme,
    tool::Tool,
    viewport,
};
use anyhow::{Context, Result};
use eframe::{egui, egui_wgpu::RenderState};
use std::{sync::Arc, time::Duration};
use tresses::{Pipelines, glam::Vec3, gpu::Gpu, groom::styles::Style, views};
use tresses_scene::{Base, History, Surroundings, camera::Angle};
use web_time::Instant;

/// What is shown and what is known of it.
pub struct Shown {
    /// From what it was made.
    pub hair: Hair,
    /// What the user should know, a sentence each.
    pub notes: Vec<String>,
    /// What can be styled anew, and what was read.
    pub base: Arc<Base>,
    /// What lights it instead of a photographer.
    pub surroundings: Option<Arc<Surroundings>>,
}

/// The studio.
pub struct Studio {
    pub(crate) gpu: Gpu,
    pub(crate) state: RenderState,
    pub(crate) pipelines: Option<Arc<Pipelines>>,
    pub(crate) dialogs: Dialogs,
    /// What the pointer did that the next frame is told.
    pub(crate) waiting: Waiting,
    /// The picture is to be saved.
    pub(crate) wants_picture: bool,
    /// The last frame was drawn to be saved.
    pub(crate) kept: bool,
    /// What has been done last, a sentence.
    pub(crate) said: Option<String>,
    /// Every parameter and the hair, with all that they were before.
    pub(crate) settings: History<Hair>,
    /// The strands are to be grown again.
    pub(crate) regrow: bool,
    /// The pipelines are to be built again.
    pub(crate) rebuild: bool,
    pub(crate) job: Option<Job>,
    /// A loop that is being recorded.
    pub(crate) recording: Option<Recording>,
    /// How the next loop is to be recorded.
    pub(crate) wish: Wish,
    pub(crate) show: Option<Show>,
    pub(crate) shown: Option<Shown>,
    pub(crate) orbit: Orbit,
    pub(crate) play: Play,
    pub(crate) hand: head::Hand,
    /// A ball on its way.
    pub(crate) ball: Option<Ball>,
    /// How many balls there have been.
    pub(crate) balls: u32,
    pub(crate) tool: Tool,
    pub(crate) pace: Pace,
    /// What is looked at instead of hair as it looks.
    pub(crate) view: Option<views::Shown>,
    /// The colours painted on the scalp that are to be seen when they arrive.
    pub(crate) painted: Option<String>,
    /// One sentence about what went wrong last.
    pub(crate) error: Option<String>,
    /// Why the device is gone, as reported by the driver.
    pub(crate) lost: loss::Lost,
    /// Something has changed that the picture does not show yet.
    pub(crate) dirty: bool,
    /// Seconds for which hair that was touched goes on to move although time stands still.
    pub(crate) awake: f32,
    /// Where the pointer was when the drag was looked at last.
    pub(crate) pointer: Option<egui::Pos2>,
    /// What the picture takes of the screen, pixels.
    pub(crate) area: egui::Vec2,
    /// Which picture the window shows: its [number](crate::stage::Picture::number), or 0.
    pub(crate) seen: u64,
    /// Since when nothing has moved.
    pub(crate) rest: Option<Instant>,
    /// When the last frame of the hair was begun, while time goes by.
    pub(crate) last: Option<Instant>,
    pub(crate) panels: panels::Panels,
    /// Whether there is a picture and nothing else.
    pub(crate) bare: bool,
    /// The animation that a body is to begin with, once it is there.
    pub(crate) animation: Option<Option<String>>,
    /// The page around it.
    pub host: Option<hosted::Tell>,
}

impl Studio {
    /// The studio as it is when the window opens: empty, and at work.
    ///
    /// # Errors
    /// When the window has no GPU.
    pub fn new(context: &eframe::CreationContext<'_>, options: Options) -> Result<Self> {
        theme::apply(&context.egui_ctx);
        let state = context.wgpu_render_state.clone().context("the window has no GPU that can draw hair")?;
        let gpu = device::gpu(&state);
        let lost = loss::Lost::default();
        loss::listen(&gpu.device, &context.egui_ctx, &lost);
        let source = if let Some(files) = options.given {
            Source::Files { files, options: Box::new(options.import) }
        } else if options.grooms.is_empty() {
            Source::Style(options.style.unwrap_or_else(|| Style::default().name().into()))
        } else {
            let files = Files::Disk { grooms: options.grooms, heads: options.heads };
            Source::Files { files, options: Box::new(options.import) }
        };
        let settings = options.settings;
        let hair = Hair { source, companions: options.companions };
        let order = Order {
            hair: hair.clone(),
            base: None,
            surroundings: None,
            pipelines: None,
            settings: settings.clone(),
            keep: false,
        };
        let job = Job::start(&context.egui_ctx, device::gpu(&state), order);
        Ok(Self {
            settings: History::new(settings, hair),
            dialogs: Dialogs::default(),
            waiting: Waiting::default(),
            wants_picture: false,
            kept: false,
            said: None,
            regrow: false,
            rebuild: false,
            pace: Pace::new(gpu.tier.software),
            gpu,
            state,
            pipelines: None,
            job: Some(job),
            recording: None,
            wish: Wish::default(),
            show: None,
            shown: None,
            orbit: Orbit::new(Angle::default(), (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1))),
            play: Play::default(),
            hand: head::Hand::default(),
            ball: None,
            balls: 0,
            tool: Tool::default(),
            view: None,
            painted: None,
            error: options.trouble,
            lost,
            dirty: true,
            awake: 0.0,
            pointer: None,
            area: egui::Vec2::ZERO,
            seen: 0,
            rest: None,
            last: None,
            panels: panels::Panels::default(),
            bare: options.bare,
            animation: None,
            host: None,
        })
    }

    /// What the studio is to be opened with to show again what it shows.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn again(&self) -> Options {
        let named = self.wanted().named();
        Options {
            grooms: named.grooms,
            heads: named.heads,
            style: named.style,
            import: named.orientation,
            companions: self.wanted().companions,
            settings: self.settings.now().clone(),
            bare: self.bare,
            given: None,
            trouble: None,
        }
    }
}

impl eframe::App for Studio {
    fn raw_input_hook(&mut self, context: &egui::Context, input: &mut egui::RawInput) {
        if self.waiting.exchange(&mut input.events) {
            context.request_repaint();
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        #[cfg(not(target_arch = "wasm32"))]
        if self.leaves_if_gone(&context) {
            return;
        }
        self.receive(&context);
        self.land();
        if !self.bare {
            panels::keys::answer(self, &context);
            panels::top::show(self, ui);
            panels::status::show(self, ui);
            panels::transport::show(self, ui);
            panels::side::show(self, ui);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| viewport::show(self, ui));
        if !self.bare {
            panels::record::show(self, ui);
            panels::ask::show(self, ui);
        }
        self.work_off(&context);
        self.draw(&context);
        if self.job.is_some() {
            // Seconds are counted.
            context.request_repaint_after(Duration::from_millis(500));
        }
        self.publish(&context);
    }

    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        theme::PANEL.to_normalized_gamma_f32()
    }
}
