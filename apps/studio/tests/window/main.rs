//! The window on a virtual display with the software driver: it opens, draws hair, responds, resizes and closes.
#![cfg(target_os = "linux")]

mod cards;
mod display;
mod groom;
mod lights;
mod responsiveness;

use display::{Desk, Shot};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Keysym of the space bar.
const SPACE: u32 = 0x20;

/// Tests take turns: two windows slow down each other's frames.
static TURN: Mutex<()> = Mutex::new(());

/// Waits for the turn of this test. Returns `None` without a virtual display.
fn turn() -> Option<MutexGuard<'static, ()>> {
    if let Some(why) = display::missing() {
        tresses_testing::skip("window", why);
        return None;
    }
    Some(TURN.lock().unwrap_or_else(PoisonError::into_inner))
}

#[test]
fn window_draws_responds_resizes_and_closes() {
    let Some(_turn) = turn() else { return };
    let mut desk = Desk::open(&["style.strands=6000"]);
    desk.resize(900, 620);
    let first = desk.wait_for("hair", |desk| {
        let shot = desk.shot();
        ((shot.width, shot.height) == (900, 620) && shot.hair() > 0.02).then_some(shot)
    });

    // The motion changes the frame until it is paused.
    desk.wait_for("motion", |desk| (desk.shot().change(&first) > 0.02).then_some(()));
    desk.key(SPACE);
    desk.wait_for("pause", |desk| (desk.state()?["playing"] == false).then_some(()));
    let rest = desk.still();
    rest.keep("rest");
    assert!(rest.hair() > 0.02, "{}", rest.hair());

    // The head is under the center of the viewport. It follows the pointer and swings back when released.
    let middle = [((rest.width - 300) / 2) as i16, (rest.height / 2 - 30) as i16];
    // The head is held until the frames settle.
    let frames = |desk: &Desk| desk.state().and_then(|state| state["frames"].as_u64());
    let drawn = frames(&desk);
    let pulled = desk.drag(1, [middle, [middle[0] + 110, middle[1]]], |desk| {
        desk.wait_for("pull", |desk| (frames(desk)? > drawn?).then_some(()));
        desk.still()
    });
    assert!(pulled.change(&rest) > 0.05, "the head follows: {}", pulled.change(&rest));
    pulled.keep("pulled");
    let (at_rest, pulled) = (middle_of_hair(&rest), middle_of_hair(&pulled));
    assert!(pulled > at_rest + 30.0, "to the right, from {at_rest} to {pulled}");
    let back = desk.still();
    back.keep("back");
    let back_at = middle_of_hair(&back);
    // The number of drawn strands, and with it their average position, may have changed.
    let left = (back_at - at_rest).abs() / (pulled - at_rest);
    assert!(left < 0.4, "it comes back, from {pulled} to {back_at} instead of {at_rest}");

    // The right button turns the camera.
    let turned = desk.drag(3, [middle, [middle[0] + 150, middle[1]]], Desk::still);
    assert!(turned.change(&back) > 0.05, "the camera turns: {}", turned.change(&back));

    turned.keep("turned");

    // The frame follows the window size. At first the screen shows part of the old one.
    let size = |desk: &Desk| desk.state().map(|state| state["size"].to_string());
    let before = size(&desk);
    desk.resize(640, 420);
    desk.wait_for("picture of the new size", |desk| {
        let now = size(desk)?;
        (Some(now) != before).then_some(())
    });
    let small = desk.still();
    assert_eq!((small.width, small.height), (640, 420));
    assert!(small.hair() > 0.02, "{}", small.hair());
    small.keep("small");
    assert!(desk.close().success());
}

#[test]
fn lost_device_reopens_the_window() {
    let Some(_turn) = turn() else { return };
    let mut desk = Desk::open_with(&["style.strands=1500"], &[("TRESSES_STUDIO_LOSE_AT", "2")]);
    let state = desk.wait_for("the window after the loss", |desk| {
        let state = desk.state()?;
        let told = state["error"].as_str()?.starts_with("The GPU was lost");
        (told && state["lost"] == false && state["frames"].as_u64() > Some(0)).then_some(state)
    });
    assert!(state["error"].as_str().unwrap().contains("opened again"), "{state}");
    assert_eq!(state["file"], "long");
    desk.follow();
    assert!(desk.close().success());
}

/// Returns the average position of the strands, pixels from the left.
fn middle_of_hair(shot: &Shot) -> f64 {
    let (sum, count) = (std::cell::Cell::new(0.0), std::cell::Cell::new(0.0));
    shot.share(|i, p| {
        // Darker than skin.
        if p[0] > p[2].saturating_add(10) && p[0] < 120 {
            sum.set(sum.get() + (i % shot.width) as f64);
            count.set(count.get() + 1.0);
        }
        true
    });
    sum.get() / f64::max(count.get(), 1.0)
}

#[test]
fn hair_detector_rejects_flat_images() {
    let flat = Shot { width: 900, height: 620, pixels: vec![[40, 42, 46]; 900 * 620] };
    assert_eq!(flat.hair(), 0.0);
    let mut skin = flat.clone();
    skin.pixels.fill([200, 150, 120]);
    assert_eq!(skin.hair(), 0.0, "warm alone is not hair");
    let mut strands = flat.clone();
    for (i, pixel) in strands.pixels.iter_mut().enumerate() {
        *pixel = if i % 3 == 0 { [120, 90, 60] } else { [80, 60, 40] };
    }
    assert!(strands.hair() > 0.5 && strands.change(&flat) == 1.0 && flat.change(&flat) == 0.0);
}
