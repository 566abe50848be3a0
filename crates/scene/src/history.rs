//! Undo and redo of parameter changes.

use crate::{
    knobs::{self, light_list},
    settings::Settings,
};

/// Maximum number of undo steps.
const DEPTH: usize = 500;

/// Current settings, the hair `H` they apply to, and their history. Consecutive changes of one parameter, such as a
/// slider drag, merge into one step until [`settle`](Self::settle) ends it.
#[derive(Clone, Debug)]
pub struct History<H> {
    now: Settings,
    hair: H,
    past: Vec<Step<H>>,
    future: Vec<Step<H>>,
    /// Whether the next change may merge into the last step.
    open: bool,
}

/// Settings and hair before a change (after it, for redo), and what changed.
#[derive(Clone, Debug)]
struct Step<H> {
    settings: Settings,
    hair: H,
    knob: Option<&'static str>,
    label: String,
}

impl<H: Clone + PartialEq> History<H> {
    /// Creates a history without steps.
    pub fn new(settings: Settings, hair: H) -> Self {
        Self { now: settings, hair, past: Vec::new(), future: Vec::new(), open: false }
    }

    /// Returns the current settings.
    pub fn now(&self) -> &Settings {
        &self.now
    }

    /// Returns the current hair.
    pub fn hair(&self) -> &H {
        &self.hair
    }

    /// Replaces settings and hair as one step named `label`.
    pub fn change_both(&mut self, settings: Settings, hair: H, label: &str) {
        if hair == self.hair && settings == self.now {
            return;
        }
        let hair = std::mem::replace(&mut self.hair, hair);
        let settings = std::mem::replace(&mut self.now, settings);
        let step = Step { settings, hair, knob: None, label: label.to_owned() };
        self.future.clear();
        self.open = false;
        self.push(step);
    }

    /// Drops the oldest steps from which on the history needs more than `max_bytes` bytes. `bytes` returns the memory
    /// of one hair besides another.
    pub fn limit(&mut self, max_bytes: usize, bytes: impl Fn(&H, &H) -> usize) {
        let newer = self.past.iter().skip(1).map(|step| &step.hair).chain([&self.hair]);
        let pairs: Vec<_> = self.past.iter().map(|step| &step.hair).zip(newer).collect();
        let mut sum = 0;
        let kept = pairs.iter().rev().take_while(|(older, newer)| {
            sum += bytes(older, newer);
            sum <= max_bytes
        });
        let kept = kept.count();
        self.past.drain(..self.past.len() - kept);
    }

    /// Replaces the hair without recording a step, for hair that failed to load.
    pub fn set_hair(&mut self, hair: H) {
        self.hair = hair;
    }

    fn push(&mut self, step: Step<H>) {
        self.past.push(step);
        if self.past.len() > DEPTH {
            self.past.remove(0);
        }
    }

    /// Replaces the settings. If one parameter differs, the step is named after that parameter and merges into the
    /// previous step of the same parameter. If only the list of lights differs, the step is named `label` and merges
    /// into the previous step of the list. Otherwise it is a new step named `label`.
    pub fn change(&mut self, settings: Settings, label: &str) {
        let changed = knobs::all().filter(|knob| knob.get(&settings) != knob.get(&self.now));
        let lights = (settings.lights.list != self.now.lights.list).then_some((light_list::PATH, label));
        let mut changed = changed.map(|knob| (knob.path, knob.label)).chain(lights);
        let Some((path, name)) = changed.next() else { return };
        let single = changed.next().is_none();
        let knob = single.then_some(path);
        self.future.clear();
        let goes_on = self.open && knob.is_some() && self.past.last().is_some_and(|step| step.knob == knob);
        self.open = single;
        let before = std::mem::replace(&mut self.now, settings);
        if goes_on {
            // The value is back where the drag began, so there is nothing to undo.
            if self.past.last().is_some_and(|step| step.settings == self.now && step.hair == self.hair) {
                self.past.pop();
                self.open = false;
            }
            return;
        }
        let label = if single { name.to_owned() } else { label.to_owned() };
        let hair = self.hair.clone();
        self.push(Step { settings: before, hair, knob, label });
    }

    /// Ends the current step, so that the next change is a new one.
    pub fn settle(&mut self) {
        self.open = false;
    }

    /// Undoes the last step and returns the restored settings, or `None` if there is nothing to undo.
    pub fn undo(&mut self) -> Option<&Settings> {
        let step = self.past.pop()?;
        let settings = std::mem::replace(&mut self.now, step.settings);
        let hair = std::mem::replace(&mut self.hair, step.hair);
        self.future.push(Step { settings, hair, ..step });
        self.open = false;
        Some(&self.now)
    }

    /// Redoes the last step that [`undo`](Self::undo) undid.
    pub fn redo(&mut self) -> Option<&Settings> {
        let step = self.future.pop()?;
        let settings = std::mem::replace(&mut self.now, step.settings);
        let hair = std::mem::replace(&mut self.hair, step.hair);
        self.past.push(Step { settings, hair, ..step });
        self.open = false;
        Some(&self.now)
    }

    /// Returns the name of the step that [`undo`](Self::undo) would undo.
    pub fn undoes(&self) -> Option<&str> {
        self.past.last().map(|step| step.label.as_str())
    }

    /// Returns the name of the step that [`redo`](Self::redo) would redo.
    pub fn redoes(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(settings: &Settings, change: impl Fn(&mut Settings)) -> Settings {
        let mut settings = settings.clone();
        change(&mut settings);
        settings
    }

    fn drag(history: &mut History<&str>, drag: f32) {
        let settings = with(history.now(), |s| s.simulation.drag = drag);
        history.change(settings, "?");
    }

    #[test]
    fn drag_is_one_step() {
        let start = Settings::default();
        let mut history = History::new(start.clone(), "bob");
        assert!(history.undo().is_none() && history.redo().is_none());
        for value in [3.5, 4.0, 9.0] {
            drag(&mut history, value);
        }
        history.settle();
        drag(&mut history, 10.0);
        let wind = with(history.now(), |s| s.set_wind_speed(5.0));
        history.change(wind.clone(), "?");
        assert_eq!(history.undoes(), Some("Speed"));
        assert_eq!(history.undo().unwrap().simulation.drag, 10.0);
        assert_eq!(history.undo().unwrap().simulation.drag, 9.0);
        assert_eq!(history.redoes(), Some("Drag"));
        assert_eq!(history.undo(), Some(&start));
        assert!(history.undo().is_none());
        for _ in 0..3 {
            history.redo().unwrap();
        }
        assert_eq!(history.now(), &wind);
        assert!(history.redo().is_none());
    }

    #[test]
    fn dragged_light_is_one_step() {
        use crate::settings::{LightEntry, LightKind};
        let mut history = History::new(Settings::default(), "bob");
        let add = with(history.now(), |s| s.lights.list.push(LightEntry::new(LightKind::Point)));
        history.change(add.clone(), "Add light");
        history.settle();
        for x in [0.1, 0.2, 0.3] {
            let moved = with(history.now(), |s| s.lights.list[0].position.x = x);
            history.change(moved, "Move light");
        }
        history.settle();
        assert_eq!(history.undoes(), Some("Move light"));
        // Another parameter at the same time is a step of its own.
        history.change(with(&Settings::default(), |s| s.lights.key = 2.0), "Preset");
        assert_eq!(history.undoes(), Some("Preset"));
        assert_eq!(history.undo().unwrap().lights.list[0].position.x, 0.3);
        assert_eq!(history.undo(), Some(&add));
        assert_eq!(history.undo(), Some(&Settings::default()));
        assert_eq!(history.redoes(), Some("Add light"));
        assert_eq!(history.redo(), Some(&add));
    }

    #[test]
    fn preset_is_one_named_step() {
        let mut history = History::new(Settings::default(), "bob");
        drag(&mut history, 5.0);
        let storm = with(&Settings::default(), |s| {
            s.set_wind_speed(14.0);
            s.set("style.frizz", 0.001).unwrap();
        });
        history.change(storm.clone(), "storm");
        assert_eq!(history.undoes(), Some("storm"));
        // Later changes do not merge into it.
        let other = with(&storm, |s| s.set_wind_speed(15.0));
        history.change(other, "?");
        assert_eq!(history.undo(), Some(&storm));
        assert_eq!(history.undo().unwrap().simulation.drag, 5.0);
    }

    #[test]
    fn new_change_clears_redo() {
        let mut history = History::new(Settings::default(), "bob");
        drag(&mut history, 5.0);
        history.undo();
        drag(&mut history, 6.0);
        assert!(history.redo().is_none());
        assert_eq!(history.now().simulation.drag, 6.0);
        // A change that is reverted within a step, and an empty change, add no step.
        history.settle();
        drag(&mut history, 7.0);
        drag(&mut history, 6.0);
        history.change(history.now().clone(), "?");
        assert_eq!(history.undo().unwrap(), &Settings::default());
    }

    #[test]
    fn undo_restores_hair() {
        let mut history = History::new(Settings::default(), "bob");
        drag(&mut history, 5.0);
        history.change_both(history.now().clone(), "bob", "the same is no step");
        history.change_both(history.now().clone(), "curly", "Hair");
        drag(&mut history, 6.0);
        assert_eq!(history.undo().unwrap().simulation.drag, 5.0);
        assert_eq!((*history.hair(), history.undoes()), ("curly", Some("Hair")));
        history.undo();
        assert_eq!((*history.hair(), history.now().simulation.drag), ("bob", 5.0));
        assert_eq!((history.undoes(), history.redoes()), (Some("Drag"), Some("Hair")));
        history.redo();
        assert_eq!(*history.hair(), "curly");
        history.set_hair("long");
        history.undo();
        history.redo();
        assert_eq!(*history.hair(), "long");
        // Hair and its settings change in one step.
        let before = history.now().clone();
        history.change_both(with(&before, |s| s.set_wind_speed(5.0)), "painted", "Colors");
        assert_eq!(history.undo(), Some(&before));
        assert_eq!((*history.hair(), history.redoes()), ("long", Some("Colors")));
        history.redo();
        assert_eq!((*history.hair(), history.now().wind_speed()), ("painted", 5.0));
    }

    #[test]
    fn memory_is_bounded() {
        let mut history = History::new(Settings::default(), 0usize);
        for hair in 1..=10 {
            history.change_both(history.now().clone(), hair, "Comb");
        }
        // A version takes as many bytes as its number.
        history.limit(10 + 9 + 8, |older, newer| if older == newer { 0 } else { older + 1 });
        assert_eq!(*history.hair(), 10);
        assert_eq!(std::iter::from_fn(|| history.undo().map(|_| ())).count(), 3);
        assert_eq!(*history.hair(), 7);
        history.limit(0, |_, _| 1);
        assert!(history.undo().is_none() && history.redo().is_some());
    }

    #[test]
    fn depth_is_bounded() {
        let mut history = History::new(Settings::default(), "bob");
        for i in 0..2 * DEPTH {
            drag(&mut history, 0.01 * i as f32);
            history.settle();
        }
        assert_eq!(std::iter::from_fn(|| history.undo().map(|_| ())).count(), DEPTH);
    }
}
