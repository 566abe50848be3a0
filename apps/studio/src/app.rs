//! The studio itself: what it holds, and one frame of the window.

use crate::{
    ball::Ball,
    device,
    dialog::{Answer, Dialogs},
    files::Files,
    hair::Hair,
    head,
    job::{Done, Job, Order, Source},
    options::Options,
    orbit::Orbit,
    pace::{Level, Pace},
    panels,
    play::Play,
    record::{Recording, Wish},
    stage::{Moment, Show},
    state::{self, State},
    theme,
    tool::Tool,
    viewport,
};
use anyhow::{Context, Result};
use eframe::{egui, egui_wgpu::RenderState};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};
use tresses::{
    HairRenderer, Pose,
    draw::debug,
    glam::Vec3,
    gpu::Gpu,
    groom::{import::ImportOptions, styles::Style},
};
use tresses_scene::{Base, History, Surroundings, camera::View};
use web_time::Instant;

/// The longest stretch of hair's time that one frame moves on by, seconds: on a GPU, on a software driver.
const LONGEST: (f32, f32) = (0.1, 1.0 / 30.0);

/// How long nothing has moved before the picture is refined.
const REST: Duration = Duration::from_millis(500);

/// Smallest picture, pixels.
const LEAST: u32 = 16;

/// How long hair that was touched swings while time stands still, seconds.
const AWAKE: f32 = 2.0;

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
    pub(crate) renderer: Option<Arc<HairRenderer>>,
    pub(crate) dialogs: Dialogs,
    /// The picture is to be saved.
    pub(crate) wants_picture: bool,
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
    balls: u32,
    pub(crate) tool: Tool,
    pub(crate) pace: Pace,
    /// How finely the last picture was drawn.
    pub(crate) drawn: Level,
    /// What is looked at instead of hair as it looks.
    pub(crate) view: Option<debug::Shown>,
    /// One sentence about what went wrong last.
    pub(crate) error: Option<String>,
    /// Why the device is gone, told by the driver.
    lost: Arc<Mutex<Option<Loss>>>,
    /// Something has changed that the picture does not show yet.
    pub(crate) dirty: bool,
    /// Seconds for which hair that was touched goes on to move although time stands still.
    awake: f32,
    /// Where the pointer was when the drag was looked at last.
    pub(crate) pointer: Option<egui::Pos2>,
    /// What the picture takes of the screen, pixels.
    pub(crate) area: egui::Vec2,
    /// Since when nothing has moved.
    rest: Option<Instant>,
    /// When the last frame of the hair was begun, while time goes by.
    last: Option<Instant>,
    pub(crate) panels: panels::Panels,
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
        let lost = Arc::<Mutex<Option<Loss>>>::default();
        listen(&gpu.device, &context.egui_ctx, &lost);
        let source = if options.grooms.is_empty() {
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
            renderer: None,
            settings: settings.clone(),
            keep: false,
        };
        let job = Job::start(&context.egui_ctx, device::gpu(&state), order);
        Ok(Self {
            settings: History::new(settings, hair),
            dialogs: Dialogs::default(),
            wants_picture: false,
            said: None,
            regrow: false,
            rebuild: false,
            pace: Pace::new(gpu.tier.software),
            drawn: Level::FULL,
            gpu,
            state,
            renderer: None,
            job: Some(job),
            recording: None,
            wish: Wish::default(),
            show: None,
            shown: None,
            orbit: Orbit::new(View::default(), (Vec3::new(-0.1, 1.4, -0.1), Vec3::new(0.1, 1.7, 0.1))),
            play: Play::default(),
            hand: head::Hand::default(),
            ball: None,
            balls: 0,
            tool: Tool::default(),
            view: None,
            error: options.trouble,
            lost,
            dirty: true,
            awake: 0.0,
            pointer: None,
            area: egui::Vec2::ZERO,
            rest: None,
            last: None,
            panels: panels::Panels::default(),
        })
    }

    /// Closes a window that has no device any more, and leaves what it takes to open another.
    #[cfg(not(target_arch = "wasm32"))]
    fn leave_if_gone(&mut self, context: &egui::Context) {
        crate::native::lose_for_tests(&self.gpu.device, self.show.as_ref().map_or(0, |show| show.frames));
        if self.is_gone() {
            crate::native::leave(self.again());
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    /// Starts long work.
    pub(crate) fn start(&mut self, context: &egui::Context, order: Order) {
        (self.error, self.said) = (None, None);
        self.job = Some(Job::start(context, device::gpu(&self.state), order));
    }

    /// Opens a groom, a head for the groom that is shown, or both.
    fn open_files(&mut self, context: &egui::Context, mut files: Files) {
        let mut choice = Box::<ImportOptions>::default();
        if let Files::Disk { grooms, .. } = &mut files
            && grooms.is_empty()
        {
            let Hair { source: Source::Files { files: Files::Disk { grooms: shown, .. }, options }, .. } =
                self.wanted()
            else {
                self.error = Some("a head needs a groom: open a groom first, or both together".into());
                return;
            };
            (*grooms, choice) = (shown, options);
        }
        self.open(context, Source::Files { files, options: choice });
    }

    /// Lets a ball fall on the head.
    pub(crate) fn drop_ball(&mut self) {
        if let Some(show) = &self.show {
            self.ball = Some(Ball::dropped(show.stage.subject(), self.balls));
            self.balls += 1;
            self.play.playing = true;
            self.dirty = true;
        }
    }

    /// The pose of the head now.
    pub(crate) fn pose(&self) -> Pose {
        let pivot = self.pivot();
        self.hand.apply(&self.play.pose(pivot), pivot)
    }

    /// What the head turns about, metres.
    fn pivot(&self) -> Vec3 {
        self.show.as_ref().map_or(Vec3::ZERO, |show| show.stage.pivot())
    }

    /// Why nothing can be drawn any more.
    pub(crate) fn lost(&self) -> Option<String> {
        self.loss().map(|loss| loss.sentence)
    }

    /// Whether there is no device any more with which a window could say so.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn is_gone(&self) -> bool {
        self.loss().is_some_and(|loss| loss.is_gone)
    }

    fn loss(&self) -> Option<Loss> {
        self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// What the studio is to be opened with to show again what it shows, and why.
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
            trouble: self.lost().map(|why| format!("{why}; this is the studio opened again")),
        }
    }

    /// Whether somebody has his hands on head or hair, or had until just now.
    fn is_live(&self) -> bool {
        self.awake > 0.0 || !self.hand.is_still()
    }

    /// What long work has come to, and what was dropped on the window.
    fn receive(&mut self, context: &egui::Context) {
        if let Some(done) = self.job.as_ref().and_then(Job::take)
            && let Some(Job { hair, .. }) = self.job.take()
        {
            match done {
                Ok(Done::Hair(ready)) => self.present(*ready),
                Ok(Done::Light(surroundings)) => self.light_up(hair, surroundings),
                Err(error) => {
                    match &self.shown {
                        Some(shown) => self.settings.set_hair(shown.hair.clone()),
                        // A window that has nothing to show yet shows what is built in.
                        None if hair != Hair::default() => self.make(context, Hair::default(), true),
                        None => {}
                    }
                    self.error = Some(format!("{error:#}"));
                }
            }
        }
        for answer in self.dialogs.take() {
            match answer {
                Answer::Open(files) => self.open_files(context, files),
                Answer::Preset(path, text, files) => self.open_preset(context, &path, &text, files),
                Answer::Companion(companion, name, files) => self.put(context, companion, Some(name), &files),
                Answer::Picture(name, files) => self.panels.asked.push(panels::ask::Asked::new(name, files)),
                Answer::Wrote(sentence) => self.said = Some(sentence),
                Answer::Failed(sentence) => self.error = Some(sentence),
            }
        }
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.dialogs.dropped(context, dropped);
        }
    }

    /// Shows what has become ready.
    fn present(&mut self, ready: crate::job::Ready) {
        // Of hair that is no longer there.
        self.stop_recording();
        let crate::job::Ready { stage, hair, base, surroundings, notes, keep } = ready;
        self.arrived(&hair);
        self.renderer = Some(stage.renderer.clone());
        if !keep {
            self.orbit.show(stage.subject());
            self.play.reset();
            self.ball = None;
        }
        match &mut self.show {
            Some(show) => show.replace(stage),
            None => self.show = Some(Show::new(stage)),
        }
        self.shown = Some(Shown { hair, notes, base, surroundings });
        self.dirty = true;
    }

    /// Shows what is shown in the light of `surroundings`, or of a photographer.
    fn light_up(&mut self, hair: Hair, surroundings: Option<Arc<Surroundings>>) {
        self.arrived(&hair);
        let (Some(shown), Some(show)) = (&mut self.shown, &mut self.show) else { return };
        show.stage.set_surroundings(surroundings.clone());
        (shown.hair, shown.surroundings) = (hair, surroundings);
        self.dirty = true;
    }

    /// Draws the hair if it moves or something has changed, and no frame is under way.
    fn draw(&mut self, context: &egui::Context) {
        let seconds = context.input(|input| input.stable_dt);
        if self.orbit.is_gliding() {
            self.orbit.advance(seconds);
            self.dirty = true;
        }
        let due = self.dirty || self.play.is_due() || self.is_live();
        if !due {
            self.last = None;
        }
        if self.lost().is_some() || self.area.min_elem() < 1.0 {
            return;
        }
        if !self.hand.is_still()
            || self.show.as_ref().is_some_and(|show| show.stage.hair.grabbed().is_active())
        {
            self.awake = AWAKE;
        }
        let Some(show) = &mut self.show else { return };
        let (busy, landed) = show.landed();
        if let Some(ms) = landed {
            self.panels.frames.push(ms);
            if self.recording.is_none() && self.pace.landed(ms) {
                self.dirty = true;
                context.request_repaint();
            }
        }
        if busy || self.record_on(context) {
            return;
        }
        if due {
            self.rest = None;
            self.pace.moved();
        } else if !self.refines(context) {
            return;
        }
        let Some(show) = &mut self.show else { return };
        let now = Instant::now();
        let real = self.last.map_or(1.0 / 60.0, |last| now.duration_since(last).as_secs_f32());
        self.last = Some(now);
        if self.play.take_reset() {
            self.ball = None;
            show.stage.rewind();
        }
        let most = if self.gpu.tier.software { LONGEST.1 } else { LONGEST.0 };
        // A hand moves in its own time: it shakes hair that stands still otherwise.
        let live = self.is_live();
        let hand = if live { real.min(most) } else { 0.0 };
        if live {
            // A head follows the pointer at once, however long frames are.
            self.hand.advance(real);
            self.awake -= real;
        }
        let seconds = self.play.advance(real, most).max(hand);
        self.dress(self.pace.level());
        let (pose, camera, size) = (self.pose(), self.orbit.camera(), self.size());
        let Some(show) = &mut self.show else { return };
        let field = show.stage.field.as_ref().map(|field| (field, &pose));
        self.ball = self.ball.and_then(|ball| ball.advanced(seconds, field));
        let ball = self.ball.map(|ball| ball.at);
        let moment = Moment { pose, seconds, camera, size, ball };
        self.dirty = false;
        if let Err(error) = show.draw(&self.state, context, &moment) {
            self.error = Some(format!("{error:#}"));
            self.play.playing = false;
        }
    }

    /// The size of the next picture, pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size_at(self.pace.level())
    }

    /// The size of a picture at `level`, pixels.
    pub(crate) fn size_at(&self, level: &Level) -> [u32; 2] {
        let size = self.area * level.scale;
        [size.x, size.y].map(|side| (side.round() as u32).max(LEAST))
    }

    /// Nothing is due: whether the picture is drawn once more, finer.
    fn refines(&mut self, context: &egui::Context) -> bool {
        if !self.may_refine(context) {
            self.rest = None;
            return false;
        }
        let rested = self.rest.get_or_insert_with(Instant::now).elapsed();
        let Some(left) = REST.checked_sub(rested) else { return self.pace.refine() };
        context.request_repaint_after(left);
        false
    }

    /// Whether a picture that stands still is made finer: not under somebody's finger.
    fn may_refine(&self, context: &egui::Context) -> bool {
        self.job.is_none() && self.pace.can_refine() && !context.input(|input| input.pointer.any_down())
    }

    /// What others may know.
    fn publish(&self, context: &egui::Context) {
        let show = self.show.as_ref();
        state::publish(State {
            frames: show.map_or(0, |show| show.frames),
            strands: show.map_or(0, |show| show.facts().strands),
            file: self.shown.as_ref().map(|shown| shown.hair.source.name()).unwrap_or_default(),
            companions: self.shown.as_ref().map_or_else(Vec::new, |shown| {
                shown.hair.companions.all().map(|(what, name)| format!("{}: {name}", what.key)).collect()
            }),
            step: self.job.as_ref().map(Job::step).unwrap_or_default().into(),
            error: self.error.clone().or_else(|| self.lost()).unwrap_or_default(),
            playing: self.play.playing,
            time: self.play.time,
            size: show.map_or([0; 2], |show| show.stage.targets.size),
            milliseconds: show.map_or(0.0, |show| show.milliseconds),
            adapter: self.gpu.info.name.clone(),
            lost: self.lost().is_some(),
            busy: self.dirty
                || self.recording.is_some()
                || self.may_refine(context)
                || self.play.is_due()
                || self.is_live()
                || self.orbit.is_gliding()
                || show.is_some_and(Show::is_under_way),
        });
    }
}

impl eframe::App for Studio {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        #[cfg(not(target_arch = "wasm32"))]
        self.leave_if_gone(&context);
        self.receive(&context);
        panels::keys::answer(self, &context);
        panels::top::show(self, ui);
        panels::status::show(self, ui);
        panels::transport::show(self, ui);
        panels::side::show(self, ui);
        egui::CentralPanel::no_frame().show(ui, |ui| viewport::show(self, ui));
        panels::record::show(self, ui);
        panels::ask::show(self, ui);
        self.work_off(&context);
        self.save_picture(&context);
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

/// Why nothing can be drawn any more.
#[derive(Clone, Debug, PartialEq)]
struct Loss {
    sentence: String,
    /// Whether the device itself is gone, and not only its work refused.
    is_gone: bool,
}

/// From here on `lost` says what went wrong on `device`, instead of a panic.
fn listen(device: &wgpu::Device, context: &egui::Context, lost: &Arc<Mutex<Option<Loss>>>) {
    let tell = |sentence: &str, is_gone: bool| {
        let (lost, context, sentence) = (lost.clone(), context.clone(), sentence.to_owned());
        move |message: String| {
            let first = message.lines().next().unwrap_or_default().to_owned();
            let mut lost = lost.lock().unwrap_or_else(PoisonError::into_inner);
            // What comes first is the cause; what is gone is worse than what is refused.
            if lost.as_ref().is_none_or(|before| is_gone && !before.is_gone) {
                let cause = if first.is_empty() { sentence.clone() } else { format!("{sentence}: {first}") };
                // egui has no device to draw it with.
                #[cfg(target_arch = "wasm32")]
                crate::web::say(&cause);
                *lost = Some(Loss { sentence: cause, is_gone });
            }
            context.request_repaint();
        }
    };
    let gone = tell("The GPU was lost", true);
    device.set_device_lost_callback(move |reason, message| {
        // That of a page that is left is none.
        if !(cfg!(target_arch = "wasm32") && reason == wgpu::DeviceLostReason::Destroyed) {
            gone(message);
        }
    });
    let wrong = tell("The GPU refused its work", false);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        eprintln!("{error}");
        wrong(error.to_string());
    }));
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;

    #[test]
    fn a_lost_device_is_told() {
        let Ok(gpu) = pollster::block_on(Gpu::open()) else {
            assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "there is no adapter");
            return;
        };
        let (context, lost) = (egui::Context::default(), Arc::<Mutex<Option<Loss>>>::default());
        let now = |lost: &Mutex<Option<Loss>>| lost.lock().unwrap().clone();
        listen(&gpu.device, &context, &lost);
        assert_eq!(now(&lost), None);
        // Refused work is told, and leaves a device.
        let usage = wgpu::BufferUsages::empty();
        let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage,
            mapped_at_creation: false,
        });
        assert!(now(&lost).is_some_and(|loss| !loss.is_gone && loss.sentence.contains("refused")));
        gpu.device.destroy();
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        assert!(now(&lost).is_some_and(|loss| loss.is_gone && loss.sentence.starts_with("The GPU was lost")));
    }
}
