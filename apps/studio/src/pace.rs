//! Keeps frames short: resolution and detail fall until a frame fits, and rise again when there is time.
//! When nothing moves, the picture is refined level by level to full quality.

use anyhow::Result;
use tresses::lod::LodOptions;
use tresses_scene::{Scene, Settings};

/// How finely a frame is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The factor on the resolution.
    pub scale: f32,
    /// What is added to the bias of the level of detail.
    pub bias: f32,
    /// The factor on how far strands may stray from their full shape: fewer segments.
    pub stray: f32,
    /// Whether the hair moves in steps of twice the length.
    pub slow: bool,
    /// Pixels drawn per pixel shown, along each axis, if the settings do not ask for more.
    pub ssaa: u32,
}

impl Level {
    /// Everything.
    pub const FULL: Self = Self { scale: 1.0, bias: 0.0, stray: 1.0, slow: false, ssaa: 1 };

    /// Everything, for a device that draws one sample per pixel because it is slow: what nobody waits for, or
    /// what is kept, has four. Layers would be better still, and take as long again.
    pub const STILL: Self = Self { ssaa: 2, ..Self::FULL };

    const fn lower(scale: f32, bias: f32, stray: f32) -> Self {
        Self { scale, bias, stray, ..Self::FULL }
    }

    /// The level of detail that this makes of what a person has chosen.
    pub fn lod(&self, mut options: LodOptions) -> LodOptions {
        options.bias = (options.bias + self.bias).clamp(-8.0, 8.0);
        options.curve_error = (options.curve_error * self.stray).min(100.0);
        if self.slow {
            // From any distance, and by twice at most.
            (options.slow_pixel, options.slowest) = (1e-6, options.slowest.max(2.0));
        }
        options
    }

    /// Gives `stage` the settings as they are, drawn so finely; before each frame.
    ///
    /// # Errors
    /// When the level of detail is out of its range.
    pub fn dress(&self, stage: &mut Scene, settings: &Settings) -> Result<()> {
        stage.take(settings);
        if stage.gpu.context.tier().software {
            // Its coarse maps shade what casts the shadow sooner.
            stage.picture.shadows.bias *= 2.0;
        }
        stage.set_lod(self.lod(settings.lod()))
    }

    /// Whether `finer` only has more samples: what is lit stays as it is.
    pub fn is_only_smoothed(&self, finer: &Self) -> bool {
        self.ssaa < finer.ssaa && Self { ssaa: finer.ssaa, ..*self } == *finer
    }

    /// About how much longer a frame of `other` takes: pixels take most of it. Four times as many of full
    /// hair take two to three times as long (`tresses bench --appearance`), but not the light that is there already.
    fn cost_of(&self, other: &Self) -> f32 {
        let ratio = other.scale / self.scale;
        let samples = match (self.ssaa < other.ssaa, self.is_only_smoothed(other)) {
            (true, true) => 1.2,
            (true, false) => 2.5,
            (false, _) => 1.0,
        };
        ratio * ratio * (0.5 * (self.bias - other.bias).max(0.0)).exp2() * samples
    }
}

/// From the best to the fastest. Few strands are wide enough for all (`tresses::lod`), but few segments are chords
/// that sink into the skull: no level strays so far that skin shows through (`tests/levels.rs`).
pub const LEVELS: [Level; 8] = [
    Level::FULL,
    Level { scale: 0.85, ..Level::FULL },
    Level::lower(0.7, 0.3, 1.5),
    Level::lower(0.55, 0.7, 2.5),
    Level { slow: true, ..Level::lower(0.45, 1.2, 4.0) },
    Level { slow: true, ..Level::lower(0.36, 1.8, 6.0) },
    Level { slow: true, ..Level::lower(0.28, 2.5, 4.0) },
    Level { slow: true, ..Level::lower(0.24, 2.8, 3.0) },
];
/// Milliseconds that a frame may take on a software driver.
const SOFTWARE: f32 = 80.0;
/// Milliseconds that a frame may take on a GPU: 30 per second.
const HARDWARE: f32 = 33.0;
/// This share of it is so little that there is room for more.
const ROOM: f32 = 0.45;
/// So many frames in a row must be too long, or have room.
const PATIENCE: (u32, u32) = (2, 24);
/// A finer picture that takes longer than this comes after one that does not, milliseconds.
const SOON: f32 = 1000.0;
/// A frame that takes longer than this is handed in part by part, milliseconds.
const WHOLE: f32 = 120.0;

/// How finely frames are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Whether it changes by itself.
    pub automatic: bool,
    level: usize,
    budget: f32,
    /// How many frames in a row were too long, had room.
    runs: (u32, u32),
    /// How often a finer level was tried and did not fit: the next try waits longer.
    failures: u32,
    /// The level of a picture that is refined because nothing moves.
    refined: Option<&'static Level>,
    /// The finest.
    finest: &'static Level,
    /// The picture is to be finished, whatever is automatic.
    finishes: bool,
    /// Milliseconds of the last frame.
    last: f32,
}

impl Pace {
    /// For a software driver or a GPU.
    pub fn new(software: bool) -> Self {
        let (budget, level) = if software { (SOFTWARE, 4) } else { (HARDWARE, 0) };
        let finest = if software { &Level::STILL } else { &LEVELS[0] };
        let (runs, failures, refined, finishes, last) = ((0, 0), 0, None, false, 0.0);
        Self { automatic: true, level, budget, runs, failures, refined, finest, finishes, last }
    }

    /// How the next frame is drawn.
    pub fn level(&self) -> &'static Level {
        self.refined.unwrap_or(if self.automatic { &LEVELS[self.level] } else { &LEVELS[0] })
    }

    /// How a picture is drawn that is kept.
    pub fn finest(&self) -> &'static Level {
        if self.automatic { self.finest } else { &LEVELS[0] }
    }

    /// The longest a frame may be, milliseconds.
    pub fn budget(&self) -> f32 {
        self.budget
    }

    /// Something moves: frames must be short again. Whether the last one was finer, or is being drawn.
    pub fn moved(&mut self) -> bool {
        let was = self.refined.take().is_some();
        // What is asked for before all has come to rest still holds.
        self.finishes &= !was;
        was
    }

    /// The next frame that nothing else is due in has all that the device can do.
    pub fn finish(&mut self) {
        self.finishes = true;
    }

    /// Whether that has been asked for, and is not done.
    pub fn finishes(&self) -> bool {
        self.finishes
    }

    /// Whether nothing is finer than `level`.
    pub fn is_finest(&self, level: &Level) -> bool {
        level == self.finest
    }

    /// Whether frames are finer than those in motion.
    pub fn refines(&self) -> bool {
        self.refined.is_some()
    }

    /// Whether a frame at `level` is to be handed in part by part, as far as the last one tells.
    pub fn is_long(&self, level: &Level) -> bool {
        self.last * self.level().cost_of(level).max(1.0) > WHOLE
    }

    /// Nothing has moved for a while: whether there is a finer level for the next frame. If the finest takes long,
    /// there is one before it that does not.
    pub fn refine(&mut self) -> bool {
        let Some(finer) = self.finer() else { return false };
        self.refined = Some(finer);
        true
    }

    /// Whether [`refine`](Self::refine) would find something.
    pub fn can_refine(&self) -> bool {
        self.finer().is_some()
    }

    /// The best level that is there soon, as far as the last frame tells, else the finest.
    fn finer(&self) -> Option<&'static Level> {
        if self.last == 0.0 || !(self.automatic || self.finishes) {
            return None;
        }
        let now = self.level();
        let all = std::iter::once(self.finest).chain(&LEVELS);
        let finer: Vec<_> = all.take_while(|level| *level != now).collect();
        let soon = finer.iter().find(|level| self.last * now.cost_of(level) < SOON);
        let best = finer.first();
        // After one that was there soon, nothing less than the finest.
        if self.finishes || self.refined.is_some() { best } else { soon.or(best) }.copied()
    }

    /// A frame took `milliseconds`. Whether the level has changed.
    pub fn landed(&mut self, milliseconds: f32) -> bool {
        self.last = milliseconds;
        self.finishes &= self.level() != self.finest;
        if !self.automatic || self.refined.is_some() {
            return false;
        }
        let (long, room) = (milliseconds > self.budget, milliseconds < ROOM * self.budget);
        self.runs.0 = if long { self.runs.0 + 1 } else { 0 };
        self.runs.1 = if room { self.runs.1 + 1 } else { 0 };
        let before = self.level;
        if self.runs.0 >= PATIENCE.0 && self.level + 1 < LEVELS.len() {
            // Far too long is helped at once.
            let far = if milliseconds > 3.0 * self.budget { 2 } else { 1 };
            self.level = (self.level + far).min(LEVELS.len() - 1);
            self.failures = (self.failures + 1).min(4);
        } else if self.runs.1 >= PATIENCE.1 << self.failures && self.level > 0 {
            self.level -= 1;
        }
        if self.level != before {
            self.runs = (0, 0);
        }
        self.level != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_frames_make_it_coarser_until_they_fit() {
        let mut pace = Pace::new(true);
        // A frame costs 30 ms and 300 ms per full picture.
        let cost = |pace: &Pace| 30.0 + 300.0 * pace.level().scale * pace.level().scale;
        for _ in 0..40 {
            let ms = cost(&pace);
            pace.landed(ms);
        }
        assert!(cost(&pace) < SOFTWARE && pace.level().scale > 0.3, "{}", pace.level().scale);
    }

    #[test]
    fn fast_frames_make_it_finer_and_it_settles() {
        let mut pace = Pace::new(true);
        assert!(pace.level().scale < 1.0);
        for _ in 0..400 {
            pace.landed(5.0);
        }
        assert_eq!((pace.level().scale, pace.level().bias), (1.0, 0.0));
        let mut changes = 0;
        for _ in 0..2000 {
            let ms = if pace.level().scale > 0.8 { 90.0 } else { 30.0 };
            changes += u32::from(pace.landed(ms));
        }
        assert!(changes < 20, "it does not hunt: {changes}");
    }

    #[test]
    fn it_can_be_turned_off() {
        let mut pace = Pace { automatic: false, ..Pace::new(true) };
        assert!(!pace.landed(1e4) && !pace.landed(1e4) && pace.level().scale == 1.0);
    }

    #[test]
    fn what_stands_still_is_refined_in_short_steps() {
        let mut pace = Pace { level: LEVELS.len() - 1, ..Pace::new(true) };
        assert!(!pace.refine(), "nothing is known of the time yet");
        let cost = |pace: &Pace| 30.0 + 3000.0 * pace.level().scale * pace.level().scale;
        let mut all = Vec::new();
        loop {
            let ms = cost(&pace);
            assert!(!pace.landed(ms) || all.is_empty());
            if !pace.refine() {
                break;
            }
            all.push(*pace.level());
            assert!(all.len() < LEVELS.len());
        }
        // One that is there soon, and then, however long it takes, the whole.
        assert!(all.len() == 2 && all[0].scale < 0.6, "{all:?}");
        assert_eq!(all[1], Level::STILL);
        assert!(pace.moved() && !pace.moved());
        assert!(pace.level().scale < 0.3);
        // A fast device has the whole picture at once.
        pace.landed(5.0);
        assert!(pace.refine() && pace.level() == pace.finest() && !pace.refine());
        assert_eq!(*pace.level(), Level::STILL);
    }

    #[test]
    fn a_picture_is_finished_on_request() {
        // Even where nothing is refined by itself.
        for automatic in [true, false] {
            let mut pace = Pace { automatic, ..Pace::new(true) };
            pace.landed(5000.0);
            assert_eq!(pace.can_refine(), automatic);
            pace.finish();
            // The last movement before it begins.
            assert!(!pace.moved() && pace.finishes());
            pace.landed(5000.0);
            assert!(pace.refine() && pace.level() == &Level::STILL && pace.is_long(pace.level()));
            // A movement ends it.
            let mut stopped = pace;
            assert!(stopped.moved() && !stopped.finishes() && stopped.level() != &Level::STILL);
            pace.landed(20_000.0);
            assert!(!pace.finishes() && !pace.refine() && pace.level() == &Level::STILL);
        }
    }

    #[test]
    fn a_gpu_has_its_samples_always() {
        let mut pace = Pace::new(false);
        pace.landed(20.0);
        assert!(!pace.refine(), "it draws in full already");
        assert_eq!(*pace.finest(), Level::FULL);
        let mut software = Pace { automatic: false, ..Pace::new(true) };
        software.landed(20.0);
        assert!(!software.refine());
        assert_eq!(*software.finest(), Level::FULL);
    }
}
