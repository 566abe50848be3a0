//! Records a loop as a file. The motion runs from its start with a fixed time step, one frame at a time, however long
//! each takes. The window stays responsive and shows the recording.

#[cfg(not(target_arch = "wasm32"))]
use crate::task;
use crate::{
    answer::Answer,
    dialog::Dialogs,
    messages::Messages,
    pace::{Pace, QualityLevel},
    play::Play,
    renderer::StudioRenderer,
};
use anyhow::Result;
use tresses::low_level::Pending;
use tresses_scene::{
    Settings,
    picture::{AnimationFormat, Image},
    words::sentence,
};

const NOT_ENCODED: &str = "the loop cannot be encoded";

/// Largest width and height, pixels.
pub const LARGEST: u32 = 4096;
/// Longest loop, seconds.
pub const LONGEST: f64 = 60.0;

/// Options of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordRequest {
    /// Duration in seconds; `None` for one period of the motion.
    pub seconds: Option<f64>,
    /// Frames per second.
    pub fps: u32,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// File format.
    pub format: AnimationFormat,
}

impl Default for RecordRequest {
    fn default() -> Self {
        Self { seconds: None, fps: 20, size: [640, 400], format: AnimationFormat::ALL[0] }
    }
}

impl RecordRequest {
    /// Returns the loop's duration in seconds if the motion has a period of `period` seconds.
    pub fn length(&self, period: f64) -> f64 {
        self.seconds.unwrap_or(period).clamp(0.1, LONGEST)
    }

    /// Returns the number of frames.
    pub fn frames(&self, period: f64) -> u32 {
        (self.length(period) * f64::from(self.fps)).round().max(1.0) as u32
    }
}

/// A running recording.
pub struct Recording {
    wish: RecordRequest,
    frames: u32,
    /// Warm-up frames before the first recorded one. They bring the hair into the periodic motion, so that the loop
    /// closes.
    lead: u32,
    /// Index of the next frame, warm-up included.
    next: u32,
    /// Whether the last frame goes to the encoder.
    kept: bool,
    /// The frame being read back for the encoder.
    copy: Option<Pending>,
    written: u32,
    encoder: Encoder,
    /// The transport before the recording.
    before: Play,
}

impl Recording {
    /// Returns the finished fraction, 0 to 1.
    pub fn fraction(&self) -> f32 {
        (self.next.min(self.lead) + self.written) as f32 / (self.lead + self.frames).max(1) as f32
    }

    /// Returns the current step, as text.
    pub fn step(&self) -> String {
        if self.next < self.lead {
            return "simulating the warm-up".into();
        }
        format!("recording frame {} of {}", self.written + 1, self.frames)
    }

    /// Returns the level of the next frame. Warm-up frames are drawn as fast as possible.
    fn level(&self, pace: &Pace) -> &'static QualityLevel {
        if self.next < self.lead { pace.level() } else { pace.finest() }
    }

    /// Passes the last frame to the encoder and draws the next. Returns whether more frames follow.
    fn draw(
        &mut self,
        renderer: &mut StudioRenderer,
        settings: &Settings,
        messages: &mut Messages,
    ) -> Result<bool> {
        if let Some(show) = renderer.show.as_ref().filter(|_| std::mem::take(&mut self.kept)) {
            self.copy = Some(show.copy()?);
        }
        if let Some(copy) = &mut self.copy {
            let Some(rgba) = copy.take() else {
                renderer.look_again();
                return Ok(true);
            };
            let [width, height] = self.wish.size;
            self.encoder.add(Image { width, height, rgba: rgba? })?;
            (self.copy, self.written) = (None, self.written + 1);
        }
        if self.next == self.lead + self.frames {
            return Ok(false);
        }
        let step = 1.0 / f64::from(self.wish.fps);
        let level = self.level(&renderer.pace);
        let kept = self.next >= self.lead;
        renderer.playback.play.time = f64::from(self.next) * step;
        let mut moment = renderer.prepare(level, settings, messages);
        moment.seconds = if self.next == 0 { 0.0 } else { step as f32 };
        (moment.ball, moment.parts) = (None, renderer.gpu.context.tier().software && kept);
        if kept {
            let size = self.wish.size;
            (moment.size, moment.ssaa) = (size, renderer.ssaa_at(level, size, settings));
        }
        renderer.draw(&moment)?;
        (self.kept, self.next) = (kept, self.next + 1);
        Ok(true)
    }
}

/// Records loops.
#[derive(Default)]
pub struct LoopRecorder {
    /// Options of the next recording.
    pub wish: RecordRequest,
    /// The running recording.
    pub recording: Option<Recording>,
}

impl LoopRecorder {
    /// Whether a loop is being recorded.
    pub fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// Starts a recording with the current options.
    pub fn start(&mut self, renderer: &mut StudioRenderer, dialogs: &Dialogs, messages: &mut Messages) {
        let (wish, period) = (self.wish, renderer.period());
        let Some(show) = &mut renderer.show else { return };
        let frames = wish.frames(period);
        let encoder = Encoder::new(dialogs, wish, frames);
        // A motion that is cut before its end cannot loop, so it needs no warm-up.
        let periods = wish.length(period) / period;
        let closes = periods.fract().min(1.0 - periods.fract()) < 1e-3;
        let lead = if closes { (period * f64::from(wish.fps)).round() as u32 } else { 0 };
        let before = renderer.playback.play.clone();
        renderer.playback.play.playing = false;
        renderer.playback.play.begin();
        renderer.playback.ball = None;
        show.stage.character.reset();
        messages.clear();
        renderer.pace.end_refinement();
        self.recording = Some(Recording {
            wish,
            frames,
            lead,
            next: 0,
            kept: false,
            copy: None,
            written: 0,
            encoder,
            before,
        });
    }

    /// Stops and discards the recording.
    pub fn stop(&mut self, renderer: &mut StudioRenderer, messages: &mut Messages) {
        if let Some(recording) = self.recording.take() {
            (renderer.playback.play, renderer.dirty) = (recording.before, true);
            messages.notice = Some("The recording was stopped; nothing was saved".into());
        }
    }

    /// Draws the next frame of the recording. No frame may be in flight. Returns whether there is a recording.
    pub fn go_on(
        &mut self,
        renderer: &mut StudioRenderer,
        settings: &Settings,
        messages: &mut Messages,
    ) -> bool {
        let Some(mut recording) = self.recording.take() else { return false };
        match recording.draw(renderer, settings, messages) {
            Ok(true) => {
                self.recording = Some(recording);
                return true;
            }
            Ok(false) => {
                recording.encoder.finish();
                messages.notice = Some("The loop is recorded".into());
            }
            Err(error) => messages.fail(error),
        }
        (renderer.playback.play, renderer.dirty) = (recording.before, true);
        true
    }
}

/// Returns the suggested file name.
fn name(format: AnimationFormat) -> String {
    format!("tresses.{}", format.extension())
}

/// Encodes frames on a thread, then asks where to save the file.
#[cfg(not(target_arch = "wasm32"))]
struct Encoder(std::sync::mpsc::Sender<Option<Image>>);

#[cfg(not(target_arch = "wasm32"))]
impl Encoder {
    fn new(dialogs: &Dialogs, wish: RecordRequest, frames: u32) -> Self {
        let (sender, receiver) = std::sync::mpsc::channel::<Option<Image>>();
        let dialogs = dialogs.clone();
        task::spawn(move || async move {
            // If the channel closes without an end message, the recording was stopped: save nothing.
            let encode = || -> Result<Option<Vec<u8>>> {
                let mut animation = wish.format.begin(wish.size, frames, f64::from(wish.fps))?;
                while let Ok(message) = receiver.recv() {
                    match message {
                        Some(picture) => animation.add(&picture)?,
                        None => return animation.finish().map(Some),
                    }
                }
                Ok(None)
            };
            match encode() {
                Ok(Some(bytes)) => dialogs.save("Save the loop", &name(wish.format), bytes),
                Ok(None) => {}
                Err(error) => dialogs.tell(Answer::Failed(sentence(&error.context(NOT_ENCODED)))),
            }
        });
        Self(sender)
    }

    fn add(&mut self, picture: Image) -> Result<()> {
        self.0.send(Some(picture)).map_err(|_| anyhow::anyhow!(NOT_ENCODED))
    }

    fn finish(self) {
        // If the encoder has ended, it has reported why.
        let _ = self.0.send(None);
    }
}

/// Encodes frames on the main thread: a page has no threads.
#[cfg(target_arch = "wasm32")]
struct Encoder {
    animation: Result<Box<dyn tresses_scene::picture::AnimationEncoder>>,
    dialogs: Dialogs,
    name: String,
}

#[cfg(target_arch = "wasm32")]
impl Encoder {
    fn new(dialogs: &Dialogs, wish: RecordRequest, frames: u32) -> Self {
        let animation = wish.format.begin(wish.size, frames, f64::from(wish.fps));
        Self { animation, dialogs: dialogs.clone(), name: name(wish.format) }
    }

    fn add(&mut self, picture: Image) -> Result<()> {
        match &mut self.animation {
            Ok(animation) => animation.add(&picture),
            Err(error) => Err(anyhow::anyhow!("{NOT_ENCODED}: {}", sentence(error))),
        }
    }

    fn finish(self) {
        match self.animation.and_then(|animation| animation.finish()) {
            Ok(bytes) => self.dialogs.save("Save the loop", &self.name, bytes),
            Err(error) => self.dialogs.tell(Answer::Failed(sentence(&error))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loop_lasts_one_period_by_default() {
        let wish = RecordRequest::default();
        assert_eq!((wish.length(3.0), wish.frames(3.0)), (3.0, 60));
        let short = RecordRequest { seconds: Some(0.5), fps: 30, ..wish };
        assert_eq!(short.frames(3.0), 15);
        assert_eq!(RecordRequest { seconds: Some(1e9), ..wish }.length(3.0), LONGEST);
    }
}
