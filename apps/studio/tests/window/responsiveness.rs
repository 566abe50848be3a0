//! The window stays responsive while hair is drawn: keys are handled soon, and none is lost.

use crate::{
    SPACE,
    display::{Desk, Shot},
    turn,
};
use std::{
    path::Path,
    time::{Duration, Instant},
};

/// Position and size of the tools, pixels.
const TOOLS: ([i16; 2], [u16; 2]) = ([14, 44], [80, 100]);

fn letter(letter: char) -> u32 {
    u32::from(letter)
}

fn open(strands: &str) -> Desk {
    let mut desk = Desk::open(&[&format!("style.strands={strands}")]);
    desk.resize(1280, 720);
    desk.wait_for("hair", |desk| {
        let shot = desk.shot();
        ((shot.width, shot.height) == (1280, 720) && shot.hair() > 0.02).then_some(())
    });
    desk
}

/// Returns the milliseconds from a key press until the tools are repainted. The key must change the tool.
fn answer(desk: &mut Desk, key: u32) -> f64 {
    let tools = |desk: &Desk| desk.part(TOOLS.0, TOOLS.1);
    let before: Shot = tools(desk);
    let begun = Instant::now();
    desk.tap(key);
    while tools(desk) == before {
        std::thread::sleep(Duration::from_millis(1));
        assert!(begun.elapsed() < Duration::from_secs(60), "a key is lost");
    }
    begun.elapsed().as_secs_f64() * 1e3
}

/// Returns the median and the 95th percentile.
fn spread(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    [0.5, 0.95].map(|at| values[((values.len() - 1) as f64 * at).round() as usize])
}

#[test]
fn no_key_is_lost() {
    let Some(_turn) = turn() else { return };
    let mut desk = open("6000");
    desk.key(SPACE);
    let rest = |desk: &mut Desk| {
        let told = desk.wait_for("rest", |desk| {
            desk.state().filter(|state| state["playing"] == false && state["busy"] == false)
        });
        told["time"].as_f64().unwrap()
    };
    let begun = rest(&mut desk);
    // A full-quality frame is in flight, and more keys arrive than the window paints frames.
    desk.key(letter('2'));
    std::thread::sleep(Duration::from_millis(700));
    for _ in 0..40 {
        desk.tap(letter('.'));
    }
    desk.wait_for("steps", |desk| (desk.state()?["time"].as_f64()? > begun).then_some(()));
    std::thread::sleep(Duration::from_secs(1));
    let steps = (rest(&mut desk) - begun) * 60.0;
    assert!((steps - 40.0).abs() < 1e-3, "{steps} of 40 steps");
    // An even number of presses keeps the play state, an odd number toggles it.
    for (presses, plays) in [(6, false), (7, true)] {
        (0..presses).for_each(|_| desk.tap(SPACE));
        std::thread::sleep(Duration::from_secs(1));
        // Its repaint comes after all earlier keys.
        answer(&mut desk, letter(if plays { 'c' } else { 'l' }));
        let state = desk.wait_for("state", |desk| desk.state());
        assert_eq!(state["playing"] == true, plays, "after {presses} presses");
    }
}

/// Prints how long a large groom takes to reach full quality, and how soon a motion cancels that.
#[test]
#[ignore = "proof"]
fn large_groom_refines_to_full_quality() {
    let Some(_turn) = turn() else { return };
    let Some(assets) = std::env::var_os("TRESSES_ASSETS") else {
        return println!("skipped: there are no assets");
    };
    let groom = Path::new(&assets).join("sintel/SintelHairOriginal-sintel_hair.16points.tfx");
    let mut desk = Desk::open(&[groom.to_str().unwrap()]);
    desk.resize(1920, 1080);
    let number = |desk: &Desk, name: &str| desk.state()?[name].as_u64();
    desk.wait_for("hair", |desk| (desk.shot().hair() > 0.02).then_some(()));
    desk.key(SPACE);
    desk.wait_for("rest", |desk| (desk.state()?["playing"] == false).then_some(()));
    let finished = |desk: &mut Desk| {
        let begun = Instant::now();
        desk.wait_for("the whole picture", |desk| (desk.state()?["busy"] == false).then_some(()));
        assert_eq!(number(desk, "drawn"), number(desk, "strands"), "all strands");
        assert_eq!(number(desk, "ssaa"), Some(2), "four samples");
        begun.elapsed().as_secs_f64()
    };
    let begun = desk.processor();
    let seconds = finished(&mut desk);
    desk.still().keep("finished");
    let state = desk.state().unwrap();
    let processor = desk.processor() - begun;
    println!("{}: {seconds:.1} s, {processor:.1} s of processor time", state["size"]);
    let mut stops = Vec::new();
    for view in "1234123412".chars() {
        desk.key(letter(view));
        desk.wait_for("parts", |desk| (desk.state()?["parts"][1] != 0).then_some(()));
        let frames = number(&desk, "frames");
        let begun = Instant::now();
        desk.tap(letter('r'));
        // A new frame, not the canceled one.
        desk.wait_for("a frame", |desk| {
            (number(desk, "frames") > frames && desk.state()?["parts"][1] == 0).then_some(())
        });
        stops.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    println!("ended by a movement in {:.0?} ms (median, 95th)", spread(stops));
    println!("and finished again in {:.1} s", finished(&mut desk));
}

/// Prints key latencies in motion and during refinement, and the processor time of a frame in motion.
#[test]
#[ignore = "proof"]
fn key_latency() {
    let Some(_turn) = turn() else { return };
    let mut desk = open("20000");
    let frames = |desk: &Desk| {
        desk.state()
            .and_then(|state| Some((state["frames"].as_u64()?, state["painted"].as_u64().unwrap_or(0))))
    };
    // Wait until the level settles.
    std::thread::sleep(Duration::from_secs(8));
    let begun = (desk.wait_for("state", |desk| frames(desk)), desk.processor(), Instant::now());
    std::thread::sleep(Duration::from_secs(10));
    let end = (desk.wait_for("state", |desk| frames(desk)), desk.processor(), begun.2.elapsed());
    let held = desk.resident();
    let drawn = (end.0.0 - begun.0.0) as f64;
    println!(
        "in motion: {:.1} frames per second, {:.1} ms of processor time per frame, the window painted {:.1} times, {:?}",
        drawn / end.2.as_secs_f64(),
        (end.1 - begun.1) * 1e3 / drawn,
        (end.0.1 - begun.0.1) as f64 / drawn,
        desk.state().map(|state| state["size"].to_string()),
    );
    let round = |desk: &mut Desk, gap: u64| {
        ['l', 'c'].map(|key| {
            std::thread::sleep(Duration::from_millis(gap));
            answer(desk, letter(key))
        })
    };
    let moving: Vec<_> = (0..30).flat_map(|_| round(&mut desk, 70)).collect();
    println!("in motion, a key is answered in {:.0?} ms (median, 95th)", spread(moving));
    let later = desk.wait_for("state", |desk| frames(desk)).0 - end.0.0;
    println!("memory grew by {:.1} MB in {later} frames", (desk.resident() - held) as f64 * 1e-6);
    desk.key(SPACE);
    desk.wait_for("pause", |desk| (desk.state()?["playing"] == false).then_some(()));
    let mut refined = Vec::new();
    for view in "123412341234".chars() {
        desk.key(letter(view));
        let begun = Instant::now();
        // Refinement starts half a second after the last motion; earlier answers do not count.
        while begun.elapsed() < Duration::from_secs(6) {
            let answers = round(&mut desk, 70);
            let busy = desk.state().is_some_and(|state| state["busy"] == true);
            if begun.elapsed() > Duration::from_millis(600) && busy {
                refined.extend(answers);
            }
        }
    }
    let most = refined.iter().copied().fold(0.0, f64::max);
    println!(
        "while a picture is refined, {} keys: {:.0?} ms (median, 95th), {most:.0} at most",
        refined.len(),
        spread(refined.clone())
    );
    desk.still();
    let (begun, processor) = (desk.wait_for("state", |desk| frames(desk)), desk.processor());
    for i in 0..200 {
        desk.move_to([300 + i, 300]);
    }
    let end = desk.wait_for("state", |desk| frames(desk));
    assert_eq!(end.0, begun.0, "the hair stands still");
    let each = (desk.processor() - processor) * 1e3 / (end.1 - begun.1) as f64;
    println!("a frame of the window alone: {each:.1} ms of processor time");
    let state = desk.state().unwrap();
    println!("the picture: {}", state["size"]);
}
