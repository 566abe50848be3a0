//! What the pointer did, told to one frame at a time as far as a frame can understand it.
//!
//! egui asks once a frame what lies under the pointer: where it is at the frame's end. Frames may take seconds on a
//! software driver, and whoever clicks and goes on within one would have clicked on what lies where the pointer is
//! now; a slider that is pulled and let go within one would not move at all. So what comes after a press or a
//! release, once the pointer leaves its place, waits for the next frame.

use eframe::egui::{Event, Pos2};

/// How far the pointer may go from a press and still be at its place: as far as egui lets a click go, points.
const NEAR: f32 = 6.0;

/// Events that wait for the next frame.
#[derive(Default)]
pub struct Waiting(Vec<Event>);

impl Waiting {
    /// Leaves in `events` what this frame takes, behind what has waited for it; whether any wait for another.
    pub fn exchange(&mut self, events: &mut Vec<Event>) -> bool {
        let mut all = std::mem::take(&mut self.0);
        all.append(events);
        self.0 = all.split_off(first_that_waits(&all));
        *events = all;
        !self.0.is_empty()
    }
}

/// How many of `events` the next frame can take.
fn first_that_waits(events: &[Event]) -> usize {
    let mut place: Option<Pos2> = None;
    for (i, event) in events.iter().enumerate() {
        let (at, is_button) = match event {
            Event::PointerMoved(at) => (*at, false),
            Event::PointerButton { pos, .. } => (*pos, true),
            _ => continue,
        };
        match place {
            Some(place) if place.distance(at) > NEAR => return i,
            None if is_button => place = Some(at),
            _ => {}
        }
    }
    events.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{self, Modifiers, PointerButton, pos2};

    /// A window with two buttons and a slider, in which `events` come within one frame, and then frames until none
    /// waits: how often each button was clicked, and what the slider says.
    fn after(events: &[Event], waits: bool) -> ([u32; 2], f32) {
        let (context, mut waiting) = (egui::Context::default(), Waiting::default());
        let (mut clicks, mut value) = ([0; 2], 0.0);
        let mut frame = |mut events: Vec<Event>| {
            let more = waits && waiting.exchange(&mut events);
            let rect = egui::Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, 300.0));
            let input = egui::RawInput { screen_rect: Some(rect), events, ..Default::default() };
            let mut output = context.run_ui(input, |ui| {
                for (i, clicks) in clicks.iter_mut().enumerate() {
                    let place =
                        egui::Rect::from_min_size(pos2(20.0, 50.0 * i as f32), egui::vec2(80.0, 30.0));
                    *clicks += u32::from(ui.put(place, egui::Button::new("here")).clicked());
                }
                let place = egui::Rect::from_min_size(pos2(20.0, 200.0), egui::vec2(200.0, 30.0));
                ui.put(place, egui::Slider::new(&mut value, 0.0..=1.0).show_value(false));
            });
            // Nobody paints.
            output.textures_delta.clear();
            more
        };
        // Where things are is known from the frame before.
        frame(Vec::new());
        frame(Vec::new());
        let mut more = frame(events.to_vec());
        while more {
            more = frame(Vec::new());
        }
        (clicks, value)
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    fn click(pos: Pos2) -> [Event; 3] {
        [Event::PointerMoved(pos), button(pos, true), button(pos, false)]
    }

    const BUTTONS: [Pos2; 2] = [pos2(60.0, 15.0), pos2(60.0, 65.0)];

    #[test]
    fn a_click_hits_what_it_was_made_on() {
        let mut events = click(BUTTONS[0]).to_vec();
        events.push(Event::PointerMoved(BUTTONS[1]));
        assert_eq!(after(&events, true).0, [1, 0]);
        // Without waiting it hits what the pointer went to.
        assert_ne!(after(&events, false).0, [1, 0]);
        let both = click(BUTTONS[0]).into_iter().chain(click(BUTTONS[1])).collect::<Vec<_>>();
        assert_eq!(after(&both, true).0, [1, 1]);
        assert_ne!(after(&both, false).0, [1, 1]);
    }

    #[test]
    fn a_slider_is_pulled_within_a_frame() {
        let (from, to) = (pos2(25.0, 215.0), pos2(150.0, 215.0));
        let events =
            [Event::PointerMoved(from), button(from, true), Event::PointerMoved(to), button(to, false)];
        let (pulled, still) = (after(&events, true).1, after(&events, false).1);
        assert!(pulled > 0.3, "{pulled}");
        assert!(still < 0.1, "what this is for: {still}");
    }

    #[test]
    fn what_a_frame_can_take_does_not_wait() {
        let near = pos2(62.0, 17.0);
        let mut events = click(BUTTONS[0]).to_vec();
        events.insert(2, Event::PointerMoved(near));
        events.push(Event::Text("a".into()));
        events.push(Event::PointerGone);
        let mut taken = events.clone();
        assert!(!Waiting::default().exchange(&mut taken));
        assert_eq!(taken, events);
        // And the pointer may go anywhere before.
        let moves = [BUTTONS[1], BUTTONS[0]].map(Event::PointerMoved).to_vec();
        assert!(!Waiting::default().exchange(&mut moves.clone()));
    }
}
