//! Keeps frames short: lowers resolution and detail until a frame fits its time budget, and raises them when there is
//! time. When nothing moves, the image is refined in steps to full quality.

use anyhow::Result;
use tresses::LodOptions;
use tresses_scene::{Scene, Settings};

/// Quality of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityLevel {
    /// Factor on the resolution.
    pub scale: f32,
    /// Offset added to the level-of-detail bias.
    pub bias: f32,
    /// Factor on the allowed deviation of simplified strands from their full curves; larger values give fewer segments.
    pub stray: f32,
    /// Whether the hair is simulated with time steps of twice the length.
    pub slow: bool,
    /// Supersampling factor per axis, unless the settings ask for more.
    pub ssaa: u32,
}

impl QualityLevel {
    /// Full quality.
    pub const FULL: Self = Self { scale: 1.0, bias: 0.0, stray: 1.0, slow: false, ssaa: 1 };

    /// Full quality for a device that is slow enough to draw one sample per pixel: a still or saved image gets four.
    /// Depth peeling would look better but take twice as long.
    pub const STILL: Self = Self { ssaa: 2, ..Self::FULL };

    const fn lower(scale: f32, bias: f32, stray: f32) -> Self {
        Self { scale, bias, stray, ..Self::FULL }
    }

    /// Applies the level to the level-of-detail options that the user has chosen.
    pub fn lod(&self, mut options: LodOptions) -> LodOptions {
        options.bias = (options.bias + self.bias).clamp(-8.0, 8.0);
        options.curve_error = (options.curve_error * self.stray).min(100.0);
        if self.slow {
            // Allow steps of at least twice the length, at any distance.
            (options.slow_pixel, options.slowest) = (1e-6, options.slowest.max(2.0));
        }
        options
    }

    /// Applies `settings` at this level to `stage`. Called before each frame.
    ///
    /// # Errors
    /// Fails if the level-of-detail options are out of range.
    pub fn apply(&self, stage: &mut Scene, settings: &Settings) -> Result<()> {
        stage.take(settings)?;
        if stage.gpu.context.tier().software {
            // Its coarse shadow maps self-shadow more, so they need a larger bias.
            stage.picture.shadows.bias *= 2.0;
        }
        stage.set_lod(self.lod(settings.lod()))
    }

    /// Whether `finer` differs only by more samples, so that the lighting can be reused.
    pub fn is_only_smoothed(&self, finer: &Self) -> bool {
        self.ssaa < finer.ssaa && Self { ssaa: finer.ssaa, ..*self } == *finer
    }

    /// Estimates the cost of a frame at `other` relative to this level. The pixel count dominates. Four times the
    /// samples of full hair take two to three times as long, less if the lighting is
    /// reused.
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

/// Levels from best to fastest. Fewer strands are drawn wider, so they still cover the scalp
/// (`tresses::low_level::lod`). But fewer segments form chords that cut through the skull: no level has so few that
/// skin shows through (`tests/levels.rs`).
pub const LEVELS: [QualityLevel; 8] = [
    QualityLevel::FULL,
    QualityLevel { scale: 0.85, ..QualityLevel::FULL },
    QualityLevel::lower(0.7, 0.3, 1.5),
    QualityLevel::lower(0.55, 0.7, 2.5),
    QualityLevel { slow: true, ..QualityLevel::lower(0.45, 1.2, 4.0) },
    QualityLevel { slow: true, ..QualityLevel::lower(0.36, 1.8, 6.0) },
    QualityLevel { slow: true, ..QualityLevel::lower(0.28, 2.5, 4.0) },
    QualityLevel { slow: true, ..QualityLevel::lower(0.24, 2.8, 3.0) },
];
/// Frame budget of a software driver, milliseconds.
const SOFTWARE: f32 = 80.0;
/// Frame budget of a GPU, milliseconds: 30 frames per second.
const HARDWARE: f32 = 33.0;
/// Fraction of the budget below which a finer level may fit.
const HEADROOM: f32 = 0.45;
/// Consecutive frames over the budget, and with time to spare, before the level changes.
const PATIENCE: (u32, u32) = (2, 24);
/// If a finer image takes longer than this, a cheaper one is drawn first, milliseconds.
const SOON: f32 = 1000.0;
/// A frame that takes longer than this is submitted in parts, milliseconds.
const MAX_UNSPLIT: f32 = 120.0;

/// Chooses the quality of frames from their duration.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Whether the level adapts to the frame time.
    pub automatic: bool,
    level: usize,
    budget: f32,
    /// Consecutive frames that were over the budget, and that had time to spare.
    runs: (u32, u32),
    /// Number of times that the level was lowered, at most 4. Each doubles the wait before a finer level is tried.
    failures: u32,
    /// Level of a still image being refined.
    refined: Option<&'static QualityLevel>,
    /// The finest level.
    finest: &'static QualityLevel,
    /// Whether a full-quality image was requested, even without `automatic`.
    finishes: bool,
    /// Duration of the last frame, milliseconds.
    last: f32,
}

impl Pace {
    /// Creates the pace for a software driver or a GPU.
    pub fn new(software: bool) -> Self {
        let (budget, level) = if software { (SOFTWARE, 4) } else { (HARDWARE, 0) };
        let finest = if software { &QualityLevel::STILL } else { &LEVELS[0] };
        let (runs, failures, refined, finishes, last) = ((0, 0), 0, None, false, 0.0);
        Self { automatic: true, level, budget, runs, failures, refined, finest, finishes, last }
    }

    /// Returns the level of the next frame.
    pub fn level(&self) -> &'static QualityLevel {
        self.refined.unwrap_or(if self.automatic { &LEVELS[self.level] } else { &LEVELS[0] })
    }

    /// Returns the level of an image that is saved.
    pub fn finest(&self) -> &'static QualityLevel {
        if self.automatic { self.finest } else { &LEVELS[0] }
    }

    /// Returns the frame budget, milliseconds.
    pub fn budget(&self) -> f32 {
        self.budget
    }

    /// Ends refinement because something moves. Returns whether an image was being refined.
    pub fn end_refinement(&mut self) -> bool {
        let was = self.refined.take().is_some();
        // A request made before the motion has stopped still holds.
        self.finishes &= !was;
        was
    }

    /// Requests the finest level for the next frame in which nothing moves.
    pub fn finish(&mut self) {
        self.finishes = true;
    }

    /// Whether a requested full-quality image is still to be drawn.
    pub fn finishes(&self) -> bool {
        self.finishes
    }

    /// Whether `level` is the finest.
    pub fn is_finest(&self, level: &QualityLevel) -> bool {
        level == self.finest
    }

    /// Whether a still image is being refined.
    pub fn refines(&self) -> bool {
        self.refined.is_some()
    }

    /// Whether a frame at `level` is long enough to be submitted in parts, estimated from the last frame.
    pub fn is_long(&self, level: &QualityLevel) -> bool {
        self.last * self.level().cost_of(level).max(1.0) > MAX_UNSPLIT
    }

    /// Moves to a finer level for the next frame after nothing has moved for a while. Returns whether there is one. If
    /// the finest takes long, a cheaper one is drawn first.
    pub fn refine(&mut self) -> bool {
        let Some(finer) = self.finer() else { return false };
        self.refined = Some(finer);
        true
    }

    /// Whether [`refine`](Self::refine) would find a finer level.
    pub fn can_refine(&self) -> bool {
        self.finer().is_some()
    }

    /// Returns the best level that is ready soon, estimated from the last frame, else the finest.
    fn finer(&self) -> Option<&'static QualityLevel> {
        if self.last == 0.0 || !(self.automatic || self.finishes) {
            return None;
        }
        let now = self.level();
        let all = std::iter::once(self.finest).chain(&LEVELS);
        let finer: Vec<_> = all.take_while(|level| *level != now).collect();
        let soon = finer.iter().find(|level| self.last * now.cost_of(level) < SOON);
        let best = finer.first();
        // The step after a quick refinement is the finest level.
        if self.finishes || self.refined.is_some() { best } else { soon.or(best) }.copied()
    }

    /// Records a frame of `milliseconds`. Returns whether the level has changed.
    pub fn landed(&mut self, milliseconds: f32) -> bool {
        self.last = milliseconds;
        self.finishes &= self.level() != self.finest;
        if !self.automatic || self.refined.is_some() {
            return false;
        }
        let (long, has_headroom) = (milliseconds > self.budget, milliseconds < HEADROOM * self.budget);
        self.runs.0 = if long { self.runs.0 + 1 } else { 0 };
        self.runs.1 = if has_headroom { self.runs.1 + 1 } else { 0 };
        let before = self.level;
        if self.runs.0 >= PATIENCE.0 && self.level + 1 < LEVELS.len() {
            // Skip a level if the frame is far over the budget.
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
    fn slow_frames_lower_the_level_until_they_fit() {
        let mut pace = Pace::new(true);
        // Cost model: 30 ms, plus 300 ms at full resolution.
        let cost = |pace: &Pace| 30.0 + 300.0 * pace.level().scale * pace.level().scale;
        for _ in 0..40 {
            let ms = cost(&pace);
            pace.landed(ms);
        }
        assert!(cost(&pace) < SOFTWARE && pace.level().scale > 0.3, "{}", pace.level().scale);
    }

    #[test]
    fn fast_frames_raise_the_level_without_oscillation() {
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
    fn manual_pace_keeps_the_level() {
        let mut pace = Pace { automatic: false, ..Pace::new(true) };
        assert!(!pace.landed(1e4) && !pace.landed(1e4) && pace.level().scale == 1.0);
    }

    #[test]
    fn still_image_is_refined_in_two_steps() {
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
        // First a level that is ready soon, then the finest regardless of its cost.
        assert!(all.len() == 2 && all[0].scale < 0.6, "{all:?}");
        assert_eq!(all[1], QualityLevel::STILL);
        assert!(pace.end_refinement() && !pace.end_refinement());
        assert!(pace.level().scale < 0.3);
        // A fast device draws the full image at once.
        pace.landed(5.0);
        assert!(pace.refine() && pace.level() == pace.finest() && !pace.refine());
        assert_eq!(*pace.level(), QualityLevel::STILL);
    }

    #[test]
    fn finish_refines_to_full_quality() {
        // Also without automatic refinement.
        for automatic in [true, false] {
            let mut pace = Pace { automatic, ..Pace::new(true) };
            pace.landed(5000.0);
            assert_eq!(pace.can_refine(), automatic);
            pace.finish();
            // The motion that ends just after the request does not cancel it.
            assert!(!pace.end_refinement() && pace.finishes());
            pace.landed(5000.0);
            assert!(pace.refine() && pace.level() == &QualityLevel::STILL && pace.is_long(pace.level()));
            // A later motion does.
            let mut stopped = pace;
            assert!(
                stopped.end_refinement() && !stopped.finishes() && stopped.level() != &QualityLevel::STILL
            );
            pace.landed(20_000.0);
            assert!(!pace.finishes() && !pace.refine() && pace.level() == &QualityLevel::STILL);
        }
    }

    #[test]
    fn gpu_has_no_extra_refinement() {
        let mut pace = Pace::new(false);
        pace.landed(20.0);
        assert!(!pace.refine(), "it draws in full already");
        assert_eq!(*pace.finest(), QualityLevel::FULL);
        let mut software = Pace { automatic: false, ..Pace::new(true) };
        software.landed(20.0);
        assert!(!software.refine());
        assert_eq!(*software.finest(), QualityLevel::FULL);
    }
}
