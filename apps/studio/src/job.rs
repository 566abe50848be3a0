//! Long operations in the background: pipelines, then a character on the GPU.

use crate::{files::Files, hair::Hair, task, turn};
use anyhow::Result;
use eframe::egui;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tresses::{
    Pipelines, Progress,
    gpu::Gpu,
    groom::{import::ImportOptions, styles::Style},
};
use tresses_scene::{Base, Gesture, Quality, Scene, Settings, Surroundings};

/// Size of the very first picture, which nobody sees, pixels.
const FIRST: [u32; 2] = [487, 305];
/// How long work goes on before the window gets its turn.
const PATIENCE: std::time::Duration = std::time::Duration::from_millis(40);

/// Groom and head.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A built-in style, by its name.
    Style(String),
    /// The files of one groom, and of the head it grows on if there are any.
    Files {
        /// Which.
        files: Files,
        /// What is known of units and axes.
        options: Box<ImportOptions>,
    },
}

impl Source {
    /// A few words for a title.
    pub fn name(&self) -> String {
        match self {
            Self::Style(name) => name.clone(),
            Self::Files { files, .. } => files.name(),
        }
    }
}

/// What is to be made ready.
pub struct Order {
    /// Which hair, with what beside it.
    pub hair: Hair,
    /// What is there of it already.
    pub base: Option<Arc<Base>>,
    /// Its surroundings, if they are read already.
    pub surroundings: Option<Arc<Surroundings>>,
    /// The pipelines, if they are made already.
    pub pipelines: Option<Arc<Pipelines>>,
    /// How.
    pub settings: Settings,
    /// Whether camera and motion stay as they are.
    pub keep: bool,
}

/// A character that is ready to be shown.
pub struct Ready {
    /// On the GPU.
    pub stage: Scene,
    /// What it was made from.
    pub hair: Hair,
    /// What can be styled anew.
    pub base: Arc<Base>,
    /// What lights it instead of a photographer.
    pub surroundings: Option<Arc<Surroundings>>,
    /// What the user should know.
    pub notes: Vec<String>,
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
    let Order { hair, base, surroundings, pipelines, settings, keep } = order;
    let Hair { source, companions } = &hair;
    // What can be refused is refused before anything is made.
    progress.step("reading maps and environments", 0.0).await;
    let (maps, colliders) = (companions.maps()?, companions.colliders()?);
    let surroundings = match surroundings {
        Some(surroundings) => Some(surroundings),
        None => companions.surroundings()?.map(Arc::new),
    };
    let options = turn::draw_options(&settings, &gpu.tier)?;
    let pipelines = pipelines.unwrap_or_else(|| Arc::new(Pipelines::new(&gpu.device)));
    let base = match (base, source) {
        (Some(base), _) => base,
        (None, Source::Style(name)) => {
            Arc::new(Base::built_in(&name.parse::<Style>()?, &gpu, &pipelines.simulate, progress).await?)
        }
        (None, Source::Files { files, options }) => {
            Arc::new(Base::imported(&files.borrowed(), options, progress).await?)
        }
    };
    let styling = settings.styling(base.style(), &maps)?;
    let mut character = base.dress(&styling, progress).await?;
    let notes = std::mem::take(&mut character.notes);
    // What is compiled already is there at once.
    let mut wanted = settings.pipelines(options);
    wanted.extend(settings.pipelines_of_motion(&character.guide_vertices()));
    pipelines.prepare(&wanted, progress).await?;
    let quality = Quality {
        samples: options.samples,
        coverage: options.coverage,
        shadow_resolution: options.shadow_resolution,
        strand_map: options.strand_map,
        ambient_cells: options.ambient_cells,
        ssaa: settings.edges.ssaa,
        lod: settings.lod(),
        ..Quality::new(FIRST)
    };
    let physics = settings.physics();
    let stage = Scene::new(gpu, pipelines, character, colliders, &physics, &quality, progress).await;
    let mut stage = stage?;
    stage.dress(&settings);
    stage.set_surroundings(surroundings.clone());
    progress.step("drawing the first picture", 0.0).await;
    first_picture(&mut stage)?;
    Ok(Ready { stage, hair, base, surroundings, notes, keep })
}

/// Drivers finish compiling when something is drawn: better here than in the window.
fn first_picture(stage: &mut Scene) -> Result<()> {
    let mut encoder = stage.gpu.device.create_command_encoder(&Default::default());
    let camera = tresses_scene::Viewpoint::portrait(Default::default(), stage.subject(), 1.0, 1.0);
    stage.hair.reset();
    for seconds in [0.0, 1.0 / 60.0] {
        stage.record_advance(&mut encoder, None, &Gesture::default(), seconds)?;
    }
    stage.record_draw(&mut encoder, None, &camera)?;
    stage.gpu.queue.submit([encoder.finish()]);
    #[cfg(not(target_arch = "wasm32"))]
    stage.gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
    Ok(())
}
