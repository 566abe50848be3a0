//! Long operations in the background: pipelines, then a character on the GPU.

use crate::{
    hair::{Hair, Source},
    task,
};
use anyhow::Result;
use eframe::egui;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tresses::{
    Progress,
    character::{CharacterSource, Gesture},
    draw::Coverage,
    gpu::{Gpu, Tier},
    groom::styles::Style,
    view::ViewOptions,
};
use tresses_scene::{Quality, Scene, Settings, Surroundings};

/// Size of the very first picture, which nobody sees, pixels.
const FIRST: [u32; 2] = [487, 305];
/// How long work goes on before the window gets its turn.
const PATIENCE: std::time::Duration = std::time::Duration::from_millis(40);

/// What is to be made ready.
pub struct Order {
    /// Which hair, with what beside it.
    pub hair: Hair,
    /// What is there of it already.
    pub base: Option<Arc<CharacterSource>>,
    /// Its surroundings, if they are read already.
    pub surroundings: Option<Arc<Surroundings>>,
    /// How.
    pub settings: Settings,
    /// Whether camera and motion stay as they are.
    pub keep: bool,
}

/// The character on the screen.
pub struct Shown {
    /// Its source and companions.
    pub hair: Hair,
    /// Notes for the user, a sentence each.
    pub notes: Vec<String>,
    /// The groom before styling, and the import report.
    pub base: Arc<CharacterSource>,
    /// The environment map; `None` for the photographer's lights.
    pub surroundings: Option<Arc<Surroundings>>,
}

/// A character that is ready to be shown.
pub struct Ready {
    /// On the GPU.
    pub stage: Scene,
    /// Its source, for display and for later jobs.
    pub shown: Shown,
    /// Whether camera and motion stay as they are.
    pub keep: bool,
}

/// What came of work.
pub enum Done {
    /// A character.
    Hair(Box<Ready>),
    /// Other surroundings, or none, for the character that is shown.
    Light(Option<Arc<Surroundings>>),
}

/// How far it is.
#[derive(Default)]
struct Inbox {
    step: &'static str,
    fraction: f32,
    /// When the window had its turn last.
    breath: Option<web_time::Instant>,
    done: Option<Result<Done>>,
}

/// Work that is under way.
pub struct Job {
    inbox: Arc<Mutex<Inbox>>,
    /// What will be shown.
    pub hair: Hair,
    is_light: bool,
    /// When it was begun.
    pub begun: web_time::Instant,
}

/// Tells the window how far the work is.
struct Teller {
    inbox: Arc<Mutex<Inbox>>,
    context: egui::Context,
}

fn lock(inbox: &Mutex<Inbox>) -> MutexGuard<'_, Inbox> {
    inbox.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Teller {
    /// Hands in what came of the work.
    fn done(&self, done: Result<Done>) {
        lock(&self.inbox).done = Some(done);
        self.context.request_repaint();
    }
}

impl Progress for Teller {
    async fn step(&self, task: &'static str, fraction: f32) {
        let now = web_time::Instant::now();
        let waits = {
            let mut inbox = lock(&self.inbox);
            let other = inbox.step != task;
            (inbox.step, inbox.fraction) = (task, fraction);
            let due = inbox.breath.is_none_or(|last| now.duration_since(last) > PATIENCE);
            if other || due {
                inbox.breath = Some(now);
            }
            other || due
        };
        if waits {
            self.context.request_repaint();
            task::breathe().await;
        }
    }
}

impl Job {
    /// Starts to make `order` ready.
    pub fn start(context: &egui::Context, gpu: Gpu, order: Order) -> Self {
        let (job, teller) = Self::begin(context, order.hair.clone(), false);
        task::spawn(move || async move {
            let done = ready(gpu, order, &teller).await;
            teller.done(done.map(|ready| Done::Hair(Box::new(ready))));
        });
        job
    }

    /// Starts to read the surroundings of `hair`, which is shown but for them.
    pub fn light(context: &egui::Context, hair: Hair) -> Self {
        let companions = hair.companions.clone();
        let (job, teller) = Self::begin(context, hair, true);
        task::spawn(move || async move {
            teller.step("reading the surroundings", 0.0).await;
            teller.done(companions.surroundings().map(|read| Done::Light(read.map(Arc::new))));
        });
        job
    }

    fn begin(context: &egui::Context, hair: Hair, is_light: bool) -> (Self, Teller) {
        let inbox = Arc::<Mutex<Inbox>>::default();
        let begun = web_time::Instant::now();
        let teller = Teller { inbox: inbox.clone(), context: context.clone() };
        (Self { inbox, hair, is_light, begun }, teller)
    }

    /// Whether only the light will be another.
    pub fn is_light(&self) -> bool {
        self.is_light
    }

    /// What it does now, a few words.
    pub fn step(&self) -> &'static str {
        lock(&self.inbox).step
    }

    /// How much of that is done, 0 to 1.
    pub fn fraction(&self) -> f32 {
        lock(&self.inbox).fraction
    }

    /// What came of it, once.
    pub fn take(&self) -> Option<Result<Done>> {
        lock(&self.inbox).done.take()
    }
}

async fn ready(gpu: Gpu, order: Order, progress: &impl Progress) -> Result<Ready> {
    let Order { hair, base, surroundings, settings, keep } = order;
    let Hair { source, companions } = &hair;
    // What can be refused is refused before anything is made.
    progress.step("reading maps and environments", 0.0).await;
    let (maps, colliders) = (companions.maps()?, companions.colliders()?);
    let surroundings = match surroundings {
        Some(surroundings) => Some(surroundings),
        None => companions.surroundings()?.map(Arc::new),
    };
    let options = view_options(&settings, gpu.context.tier())?;
    let base = match (base, source) {
        (Some(base), _) => base,
        (None, Source::Style(name)) => {
            Arc::new(CharacterSource::built_in(&gpu.context, &name.parse::<Style>()?, progress).await?)
        }
        (None, Source::Files { files, options }) => {
            Arc::new(CharacterSource::imported(&files.borrowed(), options, progress).await?)
        }
    };
    let styling = settings.styling(base.style(), &maps)?;
    let mut character = base.dress(&styling, progress).await?;
    let notes = std::mem::take(&mut character.notes);
    // What is compiled already is there at once.
    let mut wanted = settings.pipelines(options);
    wanted.extend(settings.pipelines_of_motion(&character.guide_vertices()));
    gpu.context.prepare(&wanted, progress).await?;
    let quality = Quality { size: FIRST, view: options, ssaa: settings.ssaa, lod: settings.lod() };
    let physics = settings.physics();
    let stage = Scene::new(gpu, character, colliders, &physics, &quality, progress).await;
    let mut stage = stage?;
    stage.dress(&settings);
    stage.set_surroundings(surroundings.clone());
    progress.step("drawing the first picture", 0.0).await;
    first_picture(&mut stage)?;
    Ok(Ready { stage, shown: Shown { hair, notes, base, surroundings }, keep })
}

/// How pictures are sampled: as `settings` say, and where they say nothing so that it is fast.
pub fn view_options(settings: &Settings, tier: Tier) -> tresses::Result<ViewOptions> {
    if settings.gives("edges.samples") || settings.gives("edges.coverage") {
        return settings.view_options(tier.max_samples);
    }
    let mut fast = ViewOptions { samples: 4, coverage: Coverage::SampleMask, ..settings.view };
    if tier.software {
        fast.samples = 1;
        fast.shadow_resolution = fast.shadow_resolution.min(256);
        // An eighth of the cells, whose work does not fall with the strands.
        fast.ambient_cells = fast.ambient_cells.min(12);
    }
    Ok(fast)
}

/// Drivers finish compiling when something is drawn: better here than in the window.
fn first_picture(stage: &mut Scene) -> Result<()> {
    let mut encoder = stage.gpu.context.device().create_command_encoder(&Default::default());
    let camera = tresses_scene::Viewpoint::portrait(Default::default(), stage.subject(), 1.0, 1.0);
    stage.character.hair_mut().reset();
    for seconds in [0.0, 1.0 / 60.0] {
        stage.record_advance(&mut encoder, None, &Gesture::default(), seconds)?;
    }
    stage.record_draw(&mut encoder, None, &camera)?;
    stage.gpu.context.queue().submit([encoder.finish()]);
    #[cfg(not(target_arch = "wasm32"))]
    stage.gpu.context.device().poll(wgpu::PollType::wait_indefinitely())?;
    Ok(())
}
