//! Lights are dragged in the view, and each drag is one undo step.

use crate::{SPACE, display::Desk, turn};
use serde_json::Value;

/// Keysyms.
const CONTROL: u32 = 0xffe3;
const SHIFT: u32 = 0xffe1;
const Z: u32 = 0x7a;
/// Places in a window of 1280 × 720, pixels.
const SEARCH: [i16; 2] = [1060, 98];
const ADD: [i16; 2] = [930, 514];
const SPOT: [i16; 2] = [918, 345];

/// Returns the lights once `is` holds.
fn lights(desk: &mut Desk, what: &str, is: impl Fn(&[Value]) -> bool) -> Vec<Value> {
    desk.wait_for(what, |desk| {
        let state = desk.state()?;
        assert_eq!(state["error"], "");
        let lights = state["lights"].as_array()?.clone();
        is(&lights).then_some(lights)
    })
}

/// Returns the place of the handle, pixels.
fn handle(light: &Value) -> Option<[i16; 2]> {
    let at = |i: usize| light["handle"][i].as_f64().map(|v| v.round() as i16);
    Some([at(0)?, at(1)?])
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

#[test]
fn lights_are_dragged_in_the_view_and_undone() {
    let Some(_turn) = turn() else { return };
    let list = "lights.list=point position=-0.07,0.15,0.17 intensity=0.4 color=ff8040; 40,20,3";
    let mut desk = Desk::open(&["style=bob", "style.strands=2000", "lights.key=0.3", "lights.rim=0", list]);
    desk.show_hair();
    desk.key(SPACE);
    desk.wait_for("pause", |desk| (desk.state()?["playing"] == false).then_some(()));
    let before = desk.still();
    before.keep("lights-before");
    let begun = lights(&mut desk, "both handles", |lights| {
        lights.len() == 2 && lights.iter().all(|light| handle(light).is_some())
    });
    let center = |lights: &[Value]| numbers(&lights[0]["center"]);
    let direction = |lights: &[Value]| numbers(&lights[1]["direction"]);

    // The near light follows the pointer, in the plane of the view.
    let at = handle(&begun[0]).unwrap();
    let to = [at[0] + 60, at[1] - 40];
    desk.drag(1, [at, to], |desk| {
        lights(desk, "the light under the pointer", |lights| {
            handle(&lights[0]).is_some_and(|at| at[0].abs_diff(to[0]) <= 2 && at[1].abs_diff(to[1]) <= 2)
        })
    });
    // The state is that of the whole drag once the window rests.
    let after = desk.still();
    after.keep("lights-after");
    let moved = lights(&mut desk, "the moved light", |lights| center(lights) != center(&begun));
    assert_eq!(direction(&moved), direction(&begun));
    assert!(after.change(&before) > 0.002, "{}", after.change(&before));

    // With Shift, it moves away from the camera.
    desk.hold(SHIFT, |desk| {
        desk.drag(1, [to, [to[0], to[1] - 50]], |desk| {
            desk.arrive();
            lights(desk, "the light farther away", |lights| center(lights) != center(&moved))
        })
    });

    // The distant light moves around the head.
    desk.still();
    let pushed = lights(&mut desk, "the lights", |lights| lights.len() == 2);
    let depth = |lights: &[Value]| center(lights)[2];
    assert!(depth(&pushed) < depth(&moved) - 0.01, "{pushed:?} {moved:?}");
    let at = handle(&pushed[1]).unwrap();
    desk.drag(1, [at, [at[0] - 40, at[1] - 30]], |desk| {
        lights(desk, "another direction", |lights| {
            let (now, then) = (direction(lights), direction(&pushed));
            now[0] < then[0] - 3.0 && now[1] > then[1] + 3.0
        })
    });
    desk.still();

    // Each drag is one step.
    desk.chord(CONTROL, Z);
    lights(&mut desk, "the former direction", |lights| {
        direction(lights) == direction(&begun) && center(lights) == center(&pushed)
    });
    desk.chord(CONTROL, Z);
    lights(&mut desk, "the former depth", |lights| center(lights) == center(&moved));
    desk.chord(CONTROL, Z);
    lights(&mut desk, "the former place", |lights| center(lights) == center(&begun));
    // A search for the list shows its lines, and the button below them. A new light is in view.
    desk.click(SEARCH);
    "ring".chars().for_each(|letter| desk.key(letter as u32));
    desk.still();
    desk.click(ADD);
    desk.still().keep("lights-menu");
    desk.click(SPOT);
    let added =
        lights(&mut desk, "a third light", |lights| lights.len() == 3 && handle(&lights[2]).is_some());
    assert_eq!(added[2]["shape"], "spot");
    desk.still().keep("lights-added");
    desk.chord(CONTROL, Z);
    lights(&mut desk, "the lights before", |lights| lights.len() == 2);
    assert!(desk.close().success());
}
