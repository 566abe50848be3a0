//! What was turned, to be undone.

use crate::{knobs, settings::Settings};

/// The most steps that can be undone.
const DEPTH: usize = 500;

/// Settings with all that they were before. Turning one knob again and again, as under a finger, is one
/// step, until [`settle`](Self::settle) says that the finger has left it.
#[derive(Clone, Debug)]
pub struct History {
    now: Settings,
    past: Vec<Step>,
    future: Vec<Step>,
    /// Whether the last step goes on.
    open: bool,
}

/// Settings, and what led from the earlier to the later of them.
#[derive(Clone, Debug)]
struct Step {
    settings: Settings,
    knob: Option<&'static str>,
    label: String,
}

impl History {
    /// Nothing to undo.
    pub fn new(settings: Settings) -> Self {
        Self { now: settings, past: Vec::new(), future: Vec::new(), open: false }
    }

    /// The settings as they are.
    pub fn now(&self) -> &Settings {
        &self.now
    }

    /// The settings are others from here on. A single knob that differs is a step by its own label, and
    /// goes on with the step before if that was the same; anything else is a step named `label`.
    pub fn change(&mut self, settings: Settings, label: &str) {
        let mut turned = knobs::all().filter(|knob| knob.get(&settings) != knob.get(&self.now));
        let Some(first) = turned.next() else { return };
        let single = turned.next().is_none();
        let knob = single.then_some(first.path);
        self.future.clear();
        let goes_on = self.open && knob.is_some() && self.past.last().is_some_and(|step| step.knob == knob);
        self.open = single;
        let before = std::mem::replace(&mut self.now, settings);
        if goes_on {
            // Back where it began: nothing happened.
            if self.past.last().is_some_and(|step| step.settings == self.now) {
                self.past.pop();
                self.open = false;
            }
            return;
        }
        let label = if single { first.label.to_owned() } else { label.to_owned() };
        self.past.push(Step { settings: before, knob, label });
        if self.past.len() > DEPTH {
            self.past.remove(0);
        }
    }

    /// The next change is a step of its own.
    pub fn settle(&mut self) {
        self.open = false;
    }

    /// Takes the last step back; the settings as they are then, `None` when there is nothing to undo.
    pub fn undo(&mut self) -> Option<&Settings> {
        let step = self.past.pop()?;
        let after = std::mem::replace(&mut self.now, step.settings);
        self.future.push(Step { settings: after, ..step });
        self.open = false;
        Some(&self.now)
    }

    /// Takes the last [`undo`](Self::undo) back.
    pub fn redo(&mut self) -> Option<&Settings> {
        let step = self.future.pop()?;
        let before = std::mem::replace(&mut self.now, step.settings);
        self.past.push(Step { settings: before, ..step });
        self.open = false;
        Some(&self.now)
    }

    /// What [`undo`](Self::undo) would take back.
    pub fn undoes(&self) -> Option<&str> {
        self.past.last().map(|step| step.label.as_str())
    }

    /// What [`redo`](Self::redo) would bring back.
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

    fn drag(history: &mut History, drag: f32) {
        let settings = with(history.now(), |s| s.simulation.drag = drag);
        history.change(settings, "?");
    }

    #[test]
    fn a_drag_is_one_step() {
        let start = Settings::default();
        let mut history = History::new(start.clone());
        assert!(history.undo().is_none() && history.redo().is_none());
        for value in [3.5, 4.0, 9.0] {
            drag(&mut history, value);
        }
        history.settle();
        drag(&mut history, 10.0);
        let wind = with(history.now(), |s| s.wind.speed = 5.0);
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
    fn a_preset_is_one_step_with_a_name() {
        let mut history = History::new(Settings::default());
        drag(&mut history, 5.0);
        let storm = with(&Settings::default(), |s| {
            s.wind.speed = 14.0;
            s.style.frizz = Some(0.001);
        });
        history.change(storm.clone(), "storm");
        assert_eq!(history.undoes(), Some("storm"));
        // What follows does not run into it.
        let other = with(&storm, |s| s.wind.speed = 15.0);
        history.change(other, "?");
        assert_eq!(history.undo(), Some(&storm));
        assert_eq!(history.undo().unwrap().simulation.drag, 5.0);
    }

    #[test]
    fn a_new_change_ends_what_was_undone() {
        let mut history = History::new(Settings::default());
        drag(&mut history, 5.0);
        history.undo();
        drag(&mut history, 6.0);
        assert!(history.redo().is_none());
        assert_eq!(history.now().simulation.drag, 6.0);
        // There and back again, and no change at all, are no steps.
        history.settle();
        drag(&mut history, 7.0);
        drag(&mut history, 6.0);
        history.change(history.now().clone(), "?");
        assert_eq!(history.undo().unwrap(), &Settings::default());
    }

    #[test]
    fn depth_is_bounded() {
        let mut history = History::new(Settings::default());
        for i in 0..2 * DEPTH {
            drag(&mut history, 0.01 * i as f32);
            history.settle();
        }
        assert_eq!(std::iter::from_fn(|| history.undo().map(|_| ())).count(), DEPTH);
    }
}
