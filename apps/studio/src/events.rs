//! Splits pointer events between frames so that egui hits the right widget.
//!
//! egui hit-tests once per frame, at the pointer's last position in that frame. With a software driver a frame can take
//! seconds. A click followed by a move within one frame would then hit the widget under the later position, and a
//! slider dragged and released within one frame would not move. Therefore, once the pointer leaves the position of a
//! press or release, the remaining events wait for the next frame.

use eframe::egui::{Event, Pos2};

/// Distance that the pointer may move after a press within the same frame, points. It equals egui's click tolerance.
const NEAR: f32 = 6.0;

/// Events deferred to the next frame.
#[derive(Default)]
pub struct EventQueue(Vec<Event>);

impl EventQueue {
    /// Moves deferred events to the front of `events` and defers those that this frame must not see. Returns whether
    /// any remain deferred.
    pub fn exchange(&mut self, events: &mut Vec<Event>) -> bool {
        let mut all = std::mem::take(&mut self.0);
        all.append(events);
        self.0 = all.split_off(first_that_waits(&all));
        *events = all;
        !self.0.is_empty()
    }
}

/// Returns how many of `events` the next frame can take.
fn first_that_waits(events: &[Event]) -> usize {
    let mut press_position: Option<Pos2> = None;
    for (i, event) in events.iter().enumerate() {
        let (at, is_button) = match event {
            Event::PointerMoved(at) => (*at, false),
            Event::PointerButton { pos, .. } => (*pos, true),
            _ => continue,
        };
        match press_position {
            Some(press_position) if press_position.distance(at) > NEAR => return i,
            None if is_button => press_position = Some(at),
            _ => {}
        }
    }
    events.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{self, Modifiers, PointerButton, pos2};

    /// Runs a window with two buttons and a slider that receives `events` in one frame, then runs frames until no event
    /// is deferred. Returns the clicks of each button and the slider's value. Without `waits`, no event is deferred.
    fn after(events: &[Event], waits: bool) -> ([u32; 2], f32) {
        let (context, mut waiting) = (egui::Context::default(), EventQueue::default());
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
            // Nothing is painted.
            output.textures_delta.clear();
            more
        };
        // egui hit-tests with the widget positions of the previous frame.
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
    fn click_hits_the_widget_under_the_press() {
        let mut events = click(BUTTONS[0]).to_vec();
        events.push(Event::PointerMoved(BUTTONS[1]));
        assert_eq!(after(&events, true).0, [1, 0]);
        // Without deferral the click hits the widget at the later position.
        assert_ne!(after(&events, false).0, [1, 0]);
        let both = click(BUTTONS[0]).into_iter().chain(click(BUTTONS[1])).collect::<Vec<_>>();
        assert_eq!(after(&both, true).0, [1, 1]);
        assert_ne!(after(&both, false).0, [1, 1]);
    }

    #[test]
    fn slider_drag_works_within_one_frame() {
        let (from, to) = (pos2(25.0, 215.0), pos2(150.0, 215.0));
        let events =
            [Event::PointerMoved(from), button(from, true), Event::PointerMoved(to), button(to, false)];
        let (pulled, still) = (after(&events, true).1, after(&events, false).1);
        assert!(pulled > 0.3, "{pulled}");
        assert!(still < 0.1, "what this is for: {still}");
    }

    #[test]
    fn events_near_a_press_are_not_deferred() {
        let near = pos2(62.0, 17.0);
        let mut events = click(BUTTONS[0]).to_vec();
        events.insert(2, Event::PointerMoved(near));
        events.push(Event::Text("a".into()));
        events.push(Event::PointerGone);
        let mut taken = events.clone();
        assert!(!EventQueue::default().exchange(&mut taken));
        assert_eq!(taken, events);
        // Moves before a press are not deferred.
        let moves = [BUTTONS[1], BUTTONS[0]].map(Event::PointerMoved).to_vec();
        assert!(!EventQueue::default().exchange(&mut moves.clone()));
    }
}
