//! Background jobs: they load hair, compile pipelines and build a character on the GPU.

use crate::{
    cards::BakedCards,
    hair::{DocumentHair, HairSource},
    task,
};
use anyhow::{Context, Result};
use eframe::egui;
use std::{
    path::Path,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use tresses::{
    CharacterSource, Gesture, Gpu, PipelineRequest, Progress, ViewOptions, drape,
    groom::{cards::CardOptions, edit::GroomEditor, styles::Style},
    low_level::Tier,
    renderer::Renderer,
};
use tresses_scene::{
    EnvironmentMap, Quality, Scene, Settings,
    cards::{self, CardChain},
    motion::animation,
    open,
};

/// Size of the warm-up frame, which is not shown, pixels.
const WARM_UP_SIZE: [u32; 2] = [487, 305];
/// Longest time that a job works before it yields to the window.
const YIELD_INTERVAL: std::time::Duration = std::time::Duration::from_millis(40);

/// Input of a job.
pub struct JobRequest {
    /// Hair and companions.
    pub hair: DocumentHair,
    /// The loaded groom, if it can be reused.
    pub base: Option<Arc<CharacterSource>>,
    /// The loaded environment, if it can be reused.
    pub surroundings: Option<Arc<EnvironmentMap>>,
    /// All parameters.
    pub settings: Settings,
    /// Whether camera and motion stay unchanged.
    pub keeps_camera_and_motion: bool,
    /// Whether the job also converts the hair to a document and opens it in an editor.
    pub opens_editor: bool,
}

/// The character on the screen.
pub struct DisplayedCharacter {
    /// Its source and companions.
    pub hair: DocumentHair,
    /// Notes for the user, a sentence each.
    pub notes: Vec<String>,
    /// The groom before styling, and the import report.
    pub base: Arc<CharacterSource>,
    /// The environment map; `None` for the photographer's lights.
    pub surroundings: Option<Arc<EnvironmentMap>>,
}

/// A character that is ready to be shown.
pub struct PreparedCharacter {
    /// The character on the GPU.
    pub stage: Scene,
    /// Its source, for display and for later jobs.
    pub shown: DisplayedCharacter,
    /// Whether camera and motion stay unchanged.
    pub keeps_camera_and_motion: bool,
    /// The editor, if the hair is to be groomed, and the settings without the style, which the document already has.
    pub editor: Option<(GroomEditor, Settings)>,
}

/// Result of a job.
pub enum JobResult {
    /// A character.
    Hair(Box<PreparedCharacter>),
    /// A new environment, or none, for the character on the screen.
    Light(Option<Arc<EnvironmentMap>>),
    /// Cards of the character on the screen.
    Cards(Box<BakedCards>),
}

/// Purpose of a job.
#[derive(Clone, Copy, PartialEq, Eq)]
enum JobKind {
    /// Builds a character.
    Hair,
    /// Loads an environment.
    Light,
    /// Bakes cards.
    Cards,
}

/// Progress and result of a job.
#[derive(Default)]
struct Inbox {
    step: &'static str,
    fraction: f32,
    /// Time at which the job last yielded to the window.
    last_yield: Option<web_time::Instant>,
    result: Option<Result<JobResult>>,
}

/// A running job.
pub struct Job {
    inbox: Arc<Mutex<Inbox>>,
    /// The hair that the job loads.
    pub hair: DocumentHair,
    kind: JobKind,
    /// Start time.
    pub started: web_time::Instant,
}

/// Reports a job's progress to the window.
struct ProgressSender {
    inbox: Arc<Mutex<Inbox>>,
    context: egui::Context,
}

fn lock(inbox: &Mutex<Inbox>) -> MutexGuard<'_, Inbox> {
    inbox.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ProgressSender {
    /// Stores the result and wakes the window.
    fn finish(&self, result: Result<JobResult>) {
        lock(&self.inbox).result = Some(result);
        self.context.request_repaint();
    }
}

impl Progress for ProgressSender {
    async fn step(&self, task: &'static str, fraction: f32) {
        let now = web_time::Instant::now();
        let must_yield = {
            let mut inbox = lock(&self.inbox);
            let is_new_step = inbox.step != task;
            (inbox.step, inbox.fraction) = (task, fraction);
            let is_due = inbox.last_yield.is_none_or(|last| now.duration_since(last) > YIELD_INTERVAL);
            if is_new_step || is_due {
                inbox.last_yield = Some(now);
            }
            is_new_step || is_due
        };
        if must_yield {
            self.context.request_repaint();
            task::breathe().await;
        }
    }
}

impl Job {
    /// Starts to build the character of `order`.
    pub fn start(context: &egui::Context, gpu: Gpu, order: JobRequest) -> Self {
        let (job, progress) = Self::begin(context, order.hair.clone(), JobKind::Hair);
        task::spawn(move || async move {
            let result = prepare(gpu, order, &progress).await;
            progress.finish(result.map(|character| JobResult::Hair(Box::new(character))));
        });
        job
    }

    /// Starts to load the environment of `hair`, whose character is already on the screen.
    pub fn load_environment(context: &egui::Context, hair: DocumentHair) -> Self {
        let companion_files = hair.companion_files.clone();
        let (job, progress) = Self::begin(context, hair, JobKind::Light);
        task::spawn(move || async move {
            progress.step("reading the environment map", 0.0).await;
            progress.finish(companion_files.surroundings().map(|map| JobResult::Light(map.map(Arc::new))));
        });
        job
    }

    /// Starts to bake cards of the hair of `order`, which is already on the screen.
    pub fn bake_cards(context: &egui::Context, gpu: Gpu, order: JobRequest, options: CardOptions) -> Self {
        let (job, progress) = Self::begin(context, order.hair.clone(), JobKind::Cards);
        task::spawn(move || async move {
            let result = bake(gpu, order, &options, &progress).await;
            progress.finish(result.map(|cards| JobResult::Cards(Box::new(cards))));
        });
        job
    }

    fn begin(context: &egui::Context, hair: DocumentHair, kind: JobKind) -> (Self, ProgressSender) {
        let inbox = Arc::<Mutex<Inbox>>::default();
        let started = web_time::Instant::now();
        let progress = ProgressSender { inbox: inbox.clone(), context: context.clone() };
        (Self { inbox, hair, kind, started }, progress)
    }

    /// Whether the job only loads an environment.
    pub fn loads_environment(&self) -> bool {
        self.kind == JobKind::Light
    }

    /// Whether the job bakes cards.
    pub fn bakes_cards(&self) -> bool {
        self.kind == JobKind::Cards
    }

    /// Returns the current step, a few words.
    pub fn step(&self) -> &'static str {
        lock(&self.inbox).step
    }

    /// Returns the finished fraction of the step, 0 to 1.
    pub fn fraction(&self) -> f32 {
        lock(&self.inbox).fraction
    }

    /// Takes the result once the job has ended.
    pub fn take(&self) -> Option<Result<JobResult>> {
        lock(&self.inbox).result.take()
    }
}

/// Builds the character of `order` and renders its first frame.
async fn prepare(gpu: Gpu, order: JobRequest, progress: &impl Progress) -> Result<PreparedCharacter> {
    let JobRequest {
        mut hair,
        base,
        surroundings,
        mut settings,
        keeps_camera_and_motion: keep,
        opens_editor: groom,
    } = order;
    let DocumentHair { source, companion_files } = &hair;
    // Validate the inputs before the expensive work.
    progress.step("reading maps and the environment map", 0.0).await;
    let (maps, colliders) = (companion_files.maps()?, companion_files.colliders()?);
    let surroundings = match surroundings {
        Some(surroundings) => Some(surroundings),
        None => companion_files.surroundings()?.map(Arc::new),
    };
    let options = view_options(&settings, gpu.context.tier())?;
    let base = match (base, source) {
        (Some(base), _) => base,
        (None, HairSource::Style(name)) => {
            Arc::new(drape::style(&gpu.context, &name.parse::<Style>()?, progress).await?)
        }
        (None, HairSource::Head { style, files, options }) => {
            let (style, files) = (style.parse::<Style>()?, files.borrowed());
            Arc::new(drape::style_on(&gpu.context, &style, &files, options, progress).await?)
        }
        (None, HairSource::Files { files, options }) => {
            Arc::new(CharacterSource::imported(&files.borrowed(), options, progress).await?)
        }
        (None, HairSource::Edited { name, document }) => {
            Arc::new(CharacterSource::edited(Path::new(name), document.clone(), progress).await?)
        }
    };
    let mut styling = settings.styling(base.style(), &maps)?;
    let mut base = base;
    let mut editor = None;
    if groom {
        progress.step("preparing the groom", 0.0).await;
        let document = open::edited(&base, &styling, &source.files(), progress).await?;
        // The strands of the document have the style already.
        settings = settings.without_style();
        styling = settings.styling(None, &maps)?;
        base = Arc::new(base.with_document(document.clone()));
        editor = Some((base.editor(document.clone(), progress).await?, settings.clone()));
        hair.source = HairSource::Edited { name: hair.source.name(), document };
    }
    let mut character = base.parts(&styling, progress).await?;
    let notes = std::mem::take(&mut character.notes);
    // Pipelines that are already compiled cost nothing here.
    let mut pipelines = settings.pipelines(options);
    pipelines.extend(settings.pipelines_of_motion(&character.guide_vertices()));
    gpu.context.prepare(&pipelines, progress).await?;
    let quality = Quality { size: WARM_UP_SIZE, view: options, ssaa: settings.ssaa, lod: settings.lod() };
    let stage = Scene::new(gpu, character, colliders, &settings, &quality, progress).await;
    let mut stage = stage?;
    stage.set_appearance(&settings);
    stage.set_surroundings(surroundings.clone());
    progress.step("rendering the first frame", 0.0).await;
    warm_up(&mut stage)?;
    let shown = DisplayedCharacter { hair, notes, base, surroundings };
    Ok(PreparedCharacter { stage, shown, keeps_camera_and_motion: keep, editor })
}

/// Bakes cards of the hair of `order`, which is on the screen.
async fn bake(
    gpu: Gpu,
    order: JobRequest,
    options: &CardOptions,
    progress: &impl Progress,
) -> Result<BakedCards> {
    let JobRequest { hair, base, settings, .. } = order;
    let base = base.context("there is no hair on the screen")?;
    let (maps, colliders) = (hair.companion_files.maps()?, hair.companion_files.colliders()?);
    let view = view_options(&settings, gpu.context.tier())?;
    let parts = base.parts(&settings.styling(base.style(), &maps)?, progress).await?;
    let colored = settings.material().uses_file_colors;
    let cards = cards::of_parts(&parts, options, colored, progress).await?;
    gpu.context.prepare(&[PipelineRequest::Cards(view.renderer.samples())], progress).await?;
    let quality = Quality { view, lod: settings.lod(), ..Quality::new([1; 2]) };
    let context = &gpu.context;
    let chain = CardChain::new(context, &parts, cards, &colliders, &settings, &quality, progress).await?;
    let rig = animation::rig_of(&parts, base.is_mannequin());
    Ok(BakedCards { chain, rig, strands: parts.groom.strands.len(), head: parts.head })
}

/// Returns the view options of `settings`. If these set neither renderer nor samples, and the renderer is not the
/// classic one, fast defaults replace the sampling.
pub fn view_options(settings: &Settings, tier: Tier) -> tresses::Result<ViewOptions> {
    let options = settings.view_options(tier.max_samples)?;
    let is_given = settings.gives("renderer.samples") || settings.gives("renderer.kind");
    if is_given || matches!(options.renderer, Renderer::Classic(_)) {
        return Ok(options);
    }
    let samples = if tier.software { 1 } else { 4 };
    let renderer = Renderer::masks(samples).with_shading(options.renderer.shading());
    let mut fast = ViewOptions { renderer, ..settings.view };
    if tier.software {
        fast.shadow_resolution = fast.shadow_resolution.min(256);
        // 12³ cells instead of 24³: their cost does not fall with the strand count.
        fast.ambient_resolution = fast.ambient_resolution.min(12);
    }
    Ok(fast)
}

/// Simulates two frames and draws the second. Drivers finish compiling at the first draw, which would otherwise stall
/// the window.
fn warm_up(stage: &mut Scene) -> Result<()> {
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
