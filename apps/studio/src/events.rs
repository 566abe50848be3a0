//! Splits pointer events between frames so that egui hits the right widget.
//!
//! egui hit-tests once per frame, at the pointer's last position in that frame. With a software driver a frame can take
//! seconds. A click followed by a move within one frame would then hit the widget under the later position, and a
//! slider dragged and released within one frame would not move. Therefore, once the pointer leaves the position of a
//! press or release, the remaining events wait for the next frame. So do keys after a press or release, since a field
//! that is clicked has the focus only from the next frame on.

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
            Event::Key { .. } | Event::Text(_) | Event::Paste(_) if press_position.is_some() => return i,
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

    /// Values of a window's widgets.
    #[derive(Default)]
    struct Widgets {
        clicks: [u32; 2],
        slider: f32,
        text: String,
    }

    /// Runs a window with two buttons, a slider and a text field that receives `events` in one frame, then runs frames
    /// until no event is deferred. Without `waits`, no event is deferred.
    fn after(events: &[Event], waits: bool) -> Widgets {
        let (context, mut waiting) = (egui::Context::default(), EventQueue::default());
        let mut widgets = Widgets::default();
        let mut frame = |mut events: Vec<Event>| {
            let more = waits && waiting.exchange(&mut events);
            let rect = egui::Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, 300.0));
            let input = egui::RawInput { screen_rect: Some(rect), events, ..Default::default() };
            let mut output = context.run_ui(input, |ui| {
                for (i, clicks) in widgets.clicks.iter_mut().enumerate() {
                    let place =
                        egui::Rect::from_min_size(pos2(20.0, 50.0 * i as f32), egui::vec2(80.0, 30.0));
                    *clicks += u32::from(ui.put(place, egui::Button::new("here")).clicked());
                }
                let place = egui::Rect::from_min_size(pos2(20.0, 200.0), egui::vec2(200.0, 30.0));
                ui.put(place, egui::Slider::new(&mut widgets.slider, 0.0..=1.0).show_value(false));
                let field = egui::Rect::from_center_size(FIELD, egui::vec2(80.0, 20.0));
                ui.put(field, egui::TextEdit::singleline(&mut widgets.text));
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
        widgets
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    fn click(pos: Pos2) -> [Event; 3] {
        [Event::PointerMoved(pos), button(pos, true), button(pos, false)]
    }

    const BUTTONS: [Pos2; 2] = [pos2(60.0, 15.0), pos2(60.0, 65.0)];
    const FIELD: Pos2 = pos2(60.0, 260.0);

    #[test]
    fn click_hits_the_widget_under_the_press() {
        let mut events = click(BUTTONS[0]).to_vec();
        events.push(Event::PointerMoved(BUTTONS[1]));
        assert_eq!(after(&events, true).clicks, [1, 0]);
        // Without deferral the click hits the widget at the later position.
        assert_ne!(after(&events, false).clicks, [1, 0]);
        let both = click(BUTTONS[0]).into_iter().chain(click(BUTTONS[1])).collect::<Vec<_>>();
        assert_eq!(after(&both, true).clicks, [1, 1]);
        assert_ne!(after(&both, false).clicks, [1, 1]);
    }

    #[test]
    fn slider_drag_works_within_one_frame() {
        let (from, to) = (pos2(25.0, 215.0), pos2(150.0, 215.0));
        let events =
            [Event::PointerMoved(from), button(from, true), Event::PointerMoved(to), button(to, false)];
        let (pulled, still) = (after(&events, true).slider, after(&events, false).slider);
        assert!(pulled > 0.3, "{pulled}");
        assert!(still < 0.1, "what this is for: {still}");
    }

    #[test]
    fn text_after_a_click_enters_the_clicked_field() {
        let letters = ["a", "b"].map(|letter| Event::Text(letter.into()));
        let events: Vec<_> = click(FIELD).into_iter().chain(letters).collect();
        assert_eq!(after(&events, true).text, "ab");
        assert_ne!(after(&events, false).text, "ab");
    }

    #[test]
    fn events_near_a_press_are_not_deferred() {
        let near = pos2(62.0, 17.0);
        let mut events = click(BUTTONS[0]).to_vec();
        events.insert(2, Event::PointerMoved(near));
        events.push(Event::PointerGone);
        let mut taken = events.clone();
        assert!(!EventQueue::default().exchange(&mut taken));
        assert_eq!(taken, events);
        // Moves before a press are not deferred.
        let moves = [BUTTONS[1], BUTTONS[0]].map(Event::PointerMoved).to_vec();
        assert!(!EventQueue::default().exchange(&mut moves.clone()));
    }
}
