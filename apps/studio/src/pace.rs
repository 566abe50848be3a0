//! Keeps frames short: resolution and detail fall until a frame fits, and rise again when there is room.

/// Scale of the resolution and bias of the level of detail, from the best to the fastest.
const LEVELS: [(f32, f32); 7] =
    [(1.0, 0.0), (0.85, 0.0), (0.7, 0.3), (0.55, 0.7), (0.45, 1.2), (0.36, 1.8), (0.28, 2.5)];
/// Milliseconds that a frame may take on a software driver.
const SOFTWARE: f32 = 80.0;
/// Milliseconds that a frame may take on a GPU: 30 per second.
const HARDWARE: f32 = 33.0;
/// This share of it is so little that there is room for more.
const ROOM: f32 = 0.45;
/// So many frames in a row must be too long, or have room.
const PATIENCE: (u32, u32) = (2, 24);

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
}

impl Pace {
    /// For a software driver or a GPU.
    pub fn new(software: bool) -> Self {
        let (budget, level) = if software { (SOFTWARE, 3) } else { (HARDWARE, 0) };
        Self { automatic: true, level, budget, runs: (0, 0), failures: 0 }
    }

    /// The factor on the resolution.
    pub fn scale(&self) -> f32 {
        if self.automatic { LEVELS[self.level].0 } else { 1.0 }
    }

    /// What is added to the bias of the level of detail.
    pub fn bias(&self) -> f32 {
        if self.automatic { LEVELS[self.level].1 } else { 0.0 }
    }

    /// The longest a frame may be, milliseconds.
    pub fn budget(&self) -> f32 {
        self.budget
    }

    /// A frame took `milliseconds`. Whether the level has changed.
    pub fn landed(&mut self, milliseconds: f32) -> bool {
        if !self.automatic {
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
        let cost = |pace: &Pace| 30.0 + 300.0 * pace.scale() * pace.scale();
        for _ in 0..40 {
            let ms = cost(&pace);
            pace.landed(ms);
        }
        assert!(cost(&pace) < SOFTWARE && pace.scale() > 0.3, "{}", pace.scale());
    }

    #[test]
    fn fast_frames_make_it_finer_and_it_settles() {
        let mut pace = Pace::new(true);
        assert!(pace.scale() < 1.0);
        for _ in 0..400 {
            pace.landed(5.0);
        }
        assert_eq!((pace.scale(), pace.bias()), (1.0, 0.0));
        let mut changes = 0;
        for _ in 0..2000 {
            let ms = if pace.scale() > 0.8 { 90.0 } else { 30.0 };
            changes += u32::from(pace.landed(ms));
        }
        assert!(changes < 20, "it does not hunt: {changes}");
    }

    #[test]
    fn it_can_be_turned_off() {
        let mut pace = Pace { automatic: false, ..Pace::new(true) };
        assert!(!pace.landed(1e4) && !pace.landed(1e4) && pace.scale() == 1.0);
    }
}
