//! The studio in a browser: its page opens, shows moving hair, handles mouse, keys and files, and neither the browser
//! nor WebGPU reports an error.

use crate::{
    browser::{Browser, PATIENCE, Picture},
    serve,
};
use serde_json::Value;
use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
    ops::Range,
    path::Path,
    thread,
    time::Instant,
};
use tresses::groom::{
    edit::{GroomDocument, GroomEditor, HeadFiles, ScriptStep, StrokeScript},
    mannequin,
    scalp::GridScalp,
};
use tresses::low_level::shaders;
use tresses_web::{Server, WebPage, pack};

/// Size of the page, pixels. Narrower pages hide the panel.
const SIZE: [u32; 2] = [780, 420];
/// Size of a page whose viewport has 1280 × 720 pixels.
const BROAD: [u32; 2] = [1684, 829];
/// On that page, the panel's tab with timings, and the check box that keeps frames short.
const TIME: [f64; 2] = [1560.0, 57.0];
const KEEP_SHORT: [f64; 2] = [1299.0, 204.0];
/// A style with few strands, and a color that a slider controls.
const ADDRESS: &str = "?style=short&style.strands=1500&shading.color=melanin";
/// Region of the viewport without controls.
const PICTURE: (Range<u32>, Range<u32>) = (112..420, 90..330);
/// Region of error messages.
const SENTENCES: (Range<u32>, Range<u32>) = (150..420, 276..336);
/// The panel's search field, the one slider that a search leaves, and the slider's left end.
const SEARCH: [f64; 2] = [580.0, 98.0];
const SLIDER: [[f64; 2]; 2] = [[629.0, 158.0], [590.0, 158.0]];
/// Center of the viewport, without controls.
const MIDDLE: [f64; 2] = [216.0, 220.0];
/// A point in the viewport next to the hair.
const BESIDE: [f64; 2] = [340.0, 130.0];
/// The file menu, its entry that records a loop, and in the dialog: the frame rate, an empty place, and the button that
/// starts the recording.
const MENU: [f64; 2] = [256.0, 18.0];
const RECORD: [f64; 2] = [288.0, 172.0];
const RATE: [f64; 2] = [363.0, 193.0];
const WISH: [f64; 2] = [500.0, 285.0];
const GO: [f64; 2] = [278.0, 285.0];
/// Size of a page with room for the strip of a brush, pixels; there, the button that begins grooming, a stroke on the
/// hair, and the buttons that undo and save.
const WINDOW: [u32; 2] = [1280, 720];
const GROOM: [f64; 2] = [50.0, 195.0];
const STROKE: [[f64; 2]; 2] = [[560.0, 200.0], [500.0, 170.0]];
const UNDO: [f64; 2] = [1099.0, 18.0];
const SAVE: [f64; 2] = [91.0, 455.0];
const MORE: [f64; 2] = [698.0, 619.0];
const SAVE_STROKES: [f64; 2] = [720.0, 584.0];
const RECOVER: [f64; 2] = [542.0, 619.0];
/// Number of strands in the dropped file.
const DROPPED: usize = 400;

/// Largest growth of the browser's memory while the page runs, bytes.
const MOST: i64 = 20_000_000;
/// Sizes of the page during the memory test, pixels. The panel keeps its width on the right.
const SIZES: [[u32; 2]; 3] = [SIZE, [SIZE[0] + 60, SIZE[1]], [SIZE[0], SIZE[1] + 60]];
/// The panel's tab of debug views, and four of its entries: no view, locks, density, overdraw.
const INSIDE: [f64; 2] = [662.0, 57.0];
const VIEWS: [[f64; 2]; 4] = [[495.0, 98.0], [470.0, 231.0], [475.0, 312.0], [585.0, 258.0]];
/// Wheel distance that moves the camera by two levels of detail.
const WHEEL: f64 = 300.0;
/// Number of rounds after which every size was shown with every view.
const ROUNDS: usize = 12;

/// Opens the studio's page and waits for hair. `how` is appended to the query.
fn open(folder: &Path, how: &str) -> Option<(Browser, Server, thread::JoinHandle<()>)> {
    let mut opened = open_at(folder, SIZE, &format!("{ADDRESS}{how}"))?;
    state(&mut opened.0, |state| state["strands"] == 1500 && state["frames"].as_u64() > Some(0));
    Some(opened)
}

/// Opens the studio's page at `address` with a viewport of `size` pixels, and waits until the studio publishes its
/// state.
fn open_at(
    folder: &Path,
    size: [u32; 2],
    address: &str,
) -> Option<(Browser, Server, thread::JoinHandle<()>)> {
    let mut browser = Browser::start(size)?;
    pack(WebPage::Studio, folder, false).unwrap();
    let (server, serving) = serve(folder);
    browser.go(&format!("http://127.0.0.1:{}/{address}", server.port()));
    // The browser compiles WebAssembly, then the shaders.
    browser.until("typeof window.tresses_state", |kind| kind == "function");
    Some((browser, server, serving))
}

/// Runs rounds of nine frames until 2,000 frames are drawn. Each round changes the page size, the camera distance (and
/// with it the level of detail) and the debug view. Checks that memory is constant after the rounds in which everything
/// appeared once.
#[test]
#[ignore = "proof"]
fn memory_is_constant_for_two_thousand_frames_in_a_browser() {
    let (frames, all) = (9, 2000);
    let folder = tempfile::tempdir().unwrap();
    let Some((mut browser, server, serving)) = open(folder.path(), "") else { return };
    let browser = &mut browser;
    let drawn = |browser: &mut Browser| state(browser, |_| true)["frames"].as_u64().unwrap();
    let pass = |browser: &mut Browser, frames: u64| {
        let begin = drawn(browser);
        state(browser, |state| state["frames"].as_u64() >= Some(begin + frames));
    };
    browser.click(INSIDE);
    let begin = drawn(browser);
    let (mut round, mut sizes, mut before) = (0, BTreeSet::new(), None);
    while round < 2 * ROUNDS || round % ROUNDS > 0 || drawn(browser) < begin + all {
        let size = SIZES[round % SIZES.len()];
        browser.resize(size);
        browser.wheel(MIDDLE, if round % 2 == 0 { WHEEL } else { -WHEEL });
        pass(browser, 2);
        let [x, y] = VIEWS[round % VIEWS.len()];
        let place = [x + f64::from(size[0] - SIZE[0]), y];
        browser.click(place);
        pass(browser, frames - 2);
        sizes.insert(state(browser, |_| true)["size"].to_string());
        round += 1;
        if round == ROUNDS {
            before = browser.resident();
        }
    }
    let frames = drawn(browser) - begin;
    let (Some(before), Some(after)) = (before, browser.resident()) else {
        return println!("skipped: the system does not tell how much memory a browser holds");
    };
    // After a minute or two, browsers start spare processes for future pages. Leave them out.
    let of_this = |held: &BTreeMap<i64, i64>| {
        held.iter().filter(|(pid, _)| before.contains_key(pid)).map(|(_, held)| held).sum::<i64>()
    };
    let others = after.keys().filter(|pid| !before.contains_key(pid)).count();
    let (is, was) = (of_this(&after), of_this(&before));
    println!(
        "{frames} frames, pictures of {sizes:?} pixels: {:.1} MB; {others} other processes",
        (is - was) as f64 * 1e-6
    );
    assert!(sizes.len() >= SIZES.len(), "the picture has changed its size: {sizes:?}");
    assert!(is - was <= MOST, "from {was} to {is} bytes");
    // The measurement detects a leak of that size.
    browser.value(&format!("(window.kept = new Uint8Array({})).fill(1).length", 3 * MOST / 2));
    let leaked = of_this(&browser.resident().expect("it told before")) - is;
    assert!(leaked > MOST, "{leaked} bytes");
    server.stop();
    serving.join().unwrap();
}

#[test]
fn studio_runs_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    let Some((mut browser, server, serving)) = open(folder.path(), "&renderer.kind=tiles") else { return };
    let first = picture(&mut browser, "hair", |picture| hair(picture) > 0.05);
    first.keep("studio-1-hair.png");
    picture(&mut browser, "motion", |later| change(later, &first) > 0.03).keep("studio-2-motion.png");

    // A click gives the page the keyboard focus.
    browser.click(MIDDLE);
    browser.keys(" ");
    state(&mut browser, |state| state["playing"] == false);
    let rest = still(&mut browser);
    assert!(hair(&rest) > 0.05, "{}", hair(&rest));

    browser.click(SEARCH);
    browser.keys("eumelanin");
    let found = still(&mut browser);
    found.keep("studio-3-search.png");
    assert!(change(&found, &rest) < 0.01, "a search changes no picture: {}", change(&found, &rest));
    browser.drag(SLIDER[0], SLIDER[1]);
    let turned = still(&mut browser);
    turned.keep("studio-4-slider.png");
    assert!(change(&turned, &found) > 0.1, "without pigment it is white: {}", change(&turned, &found));

    // A valid and a broken file.
    let (whole, broken) = (folder.path().join("drop.tfx"), folder.path().join("broken.tfx"));
    let text = groom();
    std::fs::write(&whole, &text).unwrap();
    std::fs::write(&broken, &text[..text.len() / 2]).unwrap();
    drop_file(&mut browser, &whole);
    state(&mut browser, |state| state["file"] == "drop.tfx" && state["strands"] == DROPPED);
    let dropped = still(&mut browser);
    dropped.keep("studio-5-dropped.png");
    assert!(hair(&dropped) > 0.05, "{}", hair(&dropped));
    assert!(change(&dropped, &turned) > 0.1, "{}", change(&dropped, &turned));
    assert_eq!(alarm(&dropped), 0.0);

    gestures(&mut browser, &dropped);
    recording(&mut browser, folder.path());

    drop_file(&mut browser, &broken);
    let state = state(&mut browser, |state| state["error"] != "");
    let sentence = state["error"].as_str().unwrap();
    assert!(sentence.contains("broken.tfx at line"), "{sentence}");
    assert_eq!(state["file"], "drop.tfx", "what was there stays");
    let told = still(&mut browser);
    told.keep("studio-6-sentence.png");
    assert!(alarm(&told) > 0.005, "{}", alarm(&told));

    // An environment changes only the light. An image may be any map, so the studio asks.
    let (sky, map) = (folder.path().join("sky.hdr"), folder.path().join("map.png"));
    std::fs::write(&sky, surroundings()).unwrap();
    std::fs::write(&map, gray()).unwrap();
    drop_file(&mut browser, &sky);
    self::state(&mut browser, |state| state["companions"][0] == "environment: sky.hdr");
    let lit = still(&mut browser);
    lit.keep("studio-7-surroundings.png");
    assert!(change(&lit, &told) > 0.1, "{}", change(&lit, &told));
    assert_eq!(alarm(&lit), 0.0);
    drop_file(&mut browser, &map);
    let asked = picture(&mut browser, "question", |now| change(now, &lit) > 0.1);
    asked.keep("studio-8-question.png");

    assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
    // The list of complaints is meaningful: an error of WebGPU does appear in it.
    browser.value(REFUSED);
    let begin = Instant::now();
    while browser.complaints().is_empty() {
        assert!(begin.elapsed() < PATIENCE, "a buffer without a use is no error");
    }
    server.stop();
    serving.join().unwrap();
}

/// Prints the frame time of Sintel's groom in the browser, with every strand simulated, in motion and at full quality:
/// the same workload as `tresses bench --preset` and the pages of other libraries.
#[test]
#[ignore = "proof"]
fn cost_of_a_real_groom_in_a_browser() {
    let Some(assets) = std::env::var_os("TRESSES_ASSETS") else {
        return println!("skipped: there are no assets");
    };
    let sintel = Path::new(&assets).join("sintel");
    let (groom, head) =
        (sintel.join("SintelHairOriginal-sintel_hair.16points.tfx"), sintel.join("sintel.obj"));
    let folder = tempfile::tempdir().unwrap();
    let address = "?style=short&style.strands=11400&style.all_guides=true&lod.mode=off&renderer.kind=tiles";
    let Some((mut browser, server, serving)) = open_at(folder.path(), BROAD, address) else { return };
    let browser = &mut browser;
    state(browser, |state| state["frames"].as_u64() > Some(0));
    browser.drop_files(&[&groom, &head], MIDDLE);
    state(browser, |state| {
        state["file"].as_str().is_some_and(|file| file.starts_with("Sintel")) && state["step"] == ""
    });
    // A drag that takes several frames of some seconds still counts as a click.
    browser.drag(TIME, TIME);
    // The next click follows at once. It hits the tab's content, because the studio handles it in a later frame.
    browser.click(KEEP_SHORT);
    let size = state(browser, |state| state["size"] == serde_json::json!([1280, 720]))["size"].clone();
    let mut frames: Vec<f64> = (0..7)
        .map(|_| {
            let drawn = state(browser, |_| true)["frames"].as_u64();
            state(browser, |state| state["frames"].as_u64() > drawn)["milliseconds"].as_f64().unwrap()
        })
        .collect();
    browser.picture().keep("studio-sintel.png");
    assert_eq!(state(browser, |_| true)["drawn"], 11_400);
    // The first frames include compilation.
    let mut rest = frames.split_off(2);
    rest.sort_by(f64::total_cmp);
    println!("{size} pixels: {:.0} ms a frame (median of {rest:.0?})", rest[rest.len() / 2]);
    server.stop();
    serving.join().unwrap();
}

/// Browsers reject shaders that wgpu's own compiler accepts: their uniformity analysis is stricter.
#[test]
fn browsers_accept_all_shaders() {
    let Some(mut browser) = Browser::start(SIZE) else { return };
    let folder = tempfile::tempdir().unwrap();
    // WebGPU needs a secure context, such as localhost.
    std::fs::write(folder.path().join("index.html"), "<!doctype html><title>Shaders</title>").unwrap();
    let (server, serving) = serve(folder.path());
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    browser.until("document.title", |title| title == "Shaders");
    let mut refused = |shaders: &[(&str, Cow<'_, str>)]| {
        let shaders = serde_json::to_string(shaders).unwrap();
        browser.value(&COMPILE.replace("SHADERS", &shaders))
    };
    let all: Vec<_> = shaders::all().iter().map(|(name, wgsl)| (*name, shaders::for_gpu(wgsl))).collect();
    assert!(all.len() > 50, "{}", all.len());
    let found = refused(&all);
    assert_eq!(found, serde_json::json!([]), "{found:#}");
    let wrong = "@group(0) @binding(0) var<storage, read_write> n: u32;
        @compute @workgroup_size(64) fn run() { if n > 0u { workgroupBarrier(); } }";
    assert!(refused(&[("wrong", wrong.into())])[0].as_str().unwrap().contains("uniform"));
    server.stop();
    serving.join().unwrap();
}

#[test]
fn missing_webgpu_shows_a_message() {
    let Some(mut browser) = Browser::without_webgpu(SIZE) else { return };
    let folder = tempfile::tempdir().unwrap();
    // The page checks for WebGPU before it loads anything.
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("pages/studio.html");
    std::fs::copy(page, folder.path().join("index.html")).unwrap();
    let element = Path::new(env!("CARGO_MANIFEST_DIR")).join("component/tresses-viewer.js");
    std::fs::copy(element, folder.path().join("tresses-viewer.js")).unwrap();
    let (server, serving) = serve(folder.path());
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    let said = "document.getElementById('message')?.textContent";
    let said = browser.until(said, |text| text.as_str().is_some_and(|text| !text.contains("loading")));
    assert!(said.as_str().unwrap().starts_with("This browser has"), "{said}");
    assert_eq!(browser.value("document.querySelector('canvas') === null"), true, "no blank picture below");
    server.stop();
    serving.join().unwrap();
}

/// One finger orbits, two zoom.
fn gestures(browser: &mut Browser, before: &Picture) {
    let distance = |state: &Value| state["distance"].as_f64().unwrap();
    let far = distance(&state(browser, |_| true));
    browser.swipe(&[BESIDE], &[[BESIDE[0] - 60.0, BESIDE[1]]]);
    let around = still(browser);
    around.keep("studio-touch-1-around.png");
    assert!(change(&around, before) > 0.1, "{}", change(&around, before));
    let same = distance(&state(browser, |_| true)) / far;
    assert!((same - 1.0).abs() < 1e-5, "one finger comes no nearer: {same}");
    let [x, y] = MIDDLE;
    browser.swipe(&[[x - 20.0, y], [x + 20.0, y]], &[[x - 30.0, y], [x + 30.0, y]]);
    let near = still(browser);
    near.keep("studio-touch-2-near.png");
    // The fingers end 1.5 times as far apart, and so does the image.
    let ratio = far / distance(&state(browser, |_| true));
    assert!((ratio - 1.5).abs() < 0.05, "{ratio}");
    assert!(change(&near, &around) > 0.1, "{}", change(&near, &around));
}

/// Records a loop and checks the downloaded file.
fn recording(browser: &mut Browser, folder: &Path) {
    browser.download_into(folder);
    browser.click(MENU);
    still(browser);
    browser.click(RECORD);
    still(browser).keep("studio-record-1-wish.png");
    browser.click(RATE);
    still(browser);
    browser.keys("2");
    still(browser);
    // Clicking elsewhere commits the typed value.
    browser.click(WISH);
    still(browser).keep("studio-record-2-rate.png");
    browser.click(GO);
    let bytes = downloaded(browser, &folder.join("tresses.gif"));
    let (frames, differ) = frames(&bytes);
    println!("a loop of {} bytes and {frames} frames", bytes.len());
    // Three seconds at two frames per second.
    assert_eq!(frames, 6);
    assert!(differ, "it moves");
    still(browser).keep("studio-record-3-done.png");
}

/// Returns the number of frames of a GIF, and whether any differs from the first.
fn frames(gif: &[u8]) -> (usize, bool) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(gif).expect("a GIF");
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a whole GIF") {
        frames.push(frame.buffer.to_vec());
    }
    (frames.len(), frames.iter().any(|frame| *frame != frames[0]))
}

/// Returns an environment map that is bright and blue above, as uncompressed RGBE.
fn surroundings() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    for i in 0..32 {
        bytes.extend(if i < 16 { [40, 90, 250, 131] } else { [60, 40, 20, 126] });
    }
    bytes
}

/// Returns a gray image.
fn gray() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[0, 80, 160, 255]).unwrap();
    bytes
}

/// Script that compiles shaders, given as names and sources, and returns WebGPU's errors.
const COMPILE: &str = "(async () => {
    const device = await (await navigator.gpu.requestAdapter()).requestDevice();
    const found = [];
    for (const [name, code] of SHADERS) {
        const module = device.createShaderModule({ code });
        for (const { type, message, lineNum } of (await module.getCompilationInfo()).messages) {
            if (type === 'error') found.push(`${name}:${lineNum}: ${message}`);
        }
    }
    return found;
})()";

/// Script that makes WebGPU report an error.
const REFUSED: &str = "navigator.gpu.requestAdapter().then(adapter => adapter.requestDevice())
    .then(device => { device.createBuffer({ size: 4, usage: 0 }); return device.queue.onSubmittedWorkDone(); })";

/// Returns the studio's state once `enough` accepts it.
fn state(browser: &mut Browser, enough: impl Fn(&Value) -> bool) -> Value {
    let parse = |value: &Value| serde_json::from_str::<Value>(value.as_str().unwrap_or_default());
    parse(&browser.until("window.tresses_state()", |value| parse(value).is_ok_and(|state| enough(&state))))
        .unwrap()
}

/// Returns a screenshot once `is` holds for it.
pub fn picture(browser: &mut Browser, what: &str, is: impl Fn(&Picture) -> bool) -> Picture {
    let begin = Instant::now();
    loop {
        let picture = browser.picture();
        if is(&picture) {
            return picture;
        }
        assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
        picture.keep("studio-last.png");
        assert!(begin.elapsed() < PATIENCE, "no {what} is seen");
    }
}

/// Returns a screenshot once nothing is in flight and the page no longer changes.
fn still(browser: &mut Browser) -> Picture {
    // Outside these regions a caret may blink.
    let same = |a: &Picture, b: &Picture| change(a, b) == 0.0 && alarm(a) == alarm(b);
    let (begin, mut last) = (Instant::now(), None);
    loop {
        let at = state(browser, |state| state["busy"] == false && state["step"] == "");
        let now = browser.picture();
        if last.is_some_and(|last| same(&last, &now)) {
            assert_eq!(at["seen"], at["frames"], "the last picture is seen: {at}");
            return now;
        }
        last = Some(now);
        assert!(begin.elapsed() < PATIENCE, "the page does not come to rest");
    }
}

fn drop_file(browser: &mut Browser, file: &Path) {
    browser.drop_files(&[file], MIDDLE);
}

/// Returns the fraction of the viewport that differs visibly.
fn change(a: &Picture, b: &Picture) -> f64 {
    let of = |picture: &Picture| picture.part(PICTURE.0, PICTURE.1);
    of(a).difference(&of(b), 12)
}

/// Returns the fraction of the viewport that is strands: of a different brightness than the pixel to the right.
fn hair(picture: &Picture) -> f64 {
    let light = |[r, g, b, _]: [u8; 4]| i32::from(r) + i32::from(g) + i32::from(b);
    picture.part(PICTURE.0, PICTURE.1).share(|a, b| (light(a) - light(b)).abs() > 15)
}

/// Returns the fraction of the message region that has the color of errors.
fn alarm(picture: &Picture) -> f64 {
    let near = |a: u8, b: u8| a.abs_diff(b) < 24;
    picture
        .part(SENTENCES.0, SENTENCES.1)
        .share(|[r, g, b, _], _| near(r, 0xe5) && near(g, 0x73) && near(b, 0x5f))
}

/// Returns a groom as text: strands that hang from the upper half of a ball; meters.
fn groom() -> String {
    let mut text = format!("version 2.0\nscale 1\nnumStrands {DROPPED}\n");
    for i in 0..DROPPED {
        // A golden-angle spiral distributes the roots evenly.
        let (height, turn) = (1.0 - i as f32 / DROPPED as f32, i as f32 * 2.399_963);
        let out = (1.0 - height * height).sqrt();
        let root = [out * turn.cos(), height, out * turn.sin()].map(|c| 0.1 * c);
        writeln!(text, "strand {i} numVerts 8 texcoord 0.5 0.5").unwrap();
        for j in 0..8 {
            let along = 0.03 * j as f32;
            let [x, y, z] = [root[0] * (1.0 + along), root[1] - along + 1.6, root[2] * (1.0 + along)];
            writeln!(text, "{x:.5} {y:.5} {z:.5}").unwrap();
        }
    }
    text
}

#[test]
fn image_metrics_reject_flat_images() {
    let pixels = SIZE[0] * SIZE[1];
    let flat = |color: [u8; 4]| Picture { size: SIZE, rgba: color.repeat(pixels as usize) };
    let (gray, skin) = (flat([40, 42, 46, 255]), flat([200, 150, 120, 255]));
    assert_eq!((hair(&gray), hair(&skin), change(&gray, &gray), alarm(&skin)), (0.0, 0.0, 0.0, 0.0));
    assert_eq!(change(&gray, &skin), 1.0);
    let mut strands = gray.clone();
    for pixel in strands.rgba.chunks_mut(12) {
        pixel[..4].copy_from_slice(&[120, 90, 60, 255]);
    }
    assert!(hair(&strands) > 0.5 && change(&strands, &gray) > 0.2);
    assert!(alarm(&flat([0xe5, 0x73, 0x5f, 255])) > 0.9);
}

/// Hair is combed, undone and saved in the browser. The recorded strokes give the same guides in the command, bit for
/// bit.
#[test]
fn hair_is_groomed_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    let opened = open_at(folder.path(), WINDOW, "?style=short&style.strands=1500");
    let Some((mut browser, server, serving)) = opened else { return };
    let browser = &mut browser;
    browser.download_into(folder.path());
    state(browser, |state| state["strands"] == 1500 && state["frames"].as_u64() > Some(0));
    browser.click(GROOM);
    let begun = groomed(browser, |groom| groom["strokes"] == 0);
    still(browser).keep("studio-groom-1-before.png");
    // A pen that presses lightly.
    browser.stroke(Some(0.3), STROKE[0], STROKE[1]);
    let after = groomed(browser, |groom| groom["strokes"] == 1 && groom["active"] == false);
    assert_ne!(after["hash"], begun["hash"]);
    println!("{} guides, a dab takes {} ms", after["guides"], after["dab_ms"]);
    still(browser).keep("studio-groom-2-after.png");
    browser.drag(STROKE[1], STROKE[0]);
    groomed(browser, |groom| groom["strokes"] == 2);
    browser.click(UNDO);
    groomed(browser, |groom| groom["strokes"] == 1 && groom["hash"] == after["hash"]);

    browser.click(SAVE);
    let saved = downloaded(browser, &folder.path().join("short.groom"));
    browser.click(MORE);
    still(browser).keep("studio-groom-3-more.png");
    browser.click(SAVE_STROKES);
    let strokes = downloaded(browser, &folder.path().join("strokes.jsonl"));
    let document = GroomDocument::read(Path::new("short.groom"), &saved).unwrap();
    let script =
        StrokeScript::read(std::str::from_utf8(&strokes).unwrap(), Path::new("strokes.jsonl")).unwrap();
    assert_eq!((document.head(), script.steps.len()), (&HeadFiles::BuiltIn, 1));
    let ScriptStep::Stroke { samples, .. } = &script.steps[0] else { panic!("{:?}", script.steps) };
    assert!(samples.iter().all(|sample| (sample.pressure - 0.3).abs() < 0.01), "{samples:?}");
    let field = GridScalp::of_mannequin(mannequin::sdf(mannequin::FIELD_RESOLUTION)).field;
    let mut editor = GroomEditor::new(document.original(), Some(field.into()));
    script.apply(&mut editor).unwrap();
    let hash = |document: &GroomDocument| format!("{:016x}", document.hash());
    assert_eq!(after["hash"], hash(&document), "the file holds what the page shows");
    assert_eq!(after["hash"], hash(editor.document()), "the strokes give the same guides here");

    // A page that is left without saving offers the last version.
    browser.drag(STROKE[1], STROKE[0]);
    let last = groomed(browser, |groom| groom["strokes"] == 2 && groom["active"] == false);
    let kept = "caches.open('tresses').then(it => it.keys()).then(keys => keys.length)";
    browser.until(kept, |count| count == 1);
    let address = browser.value("location.href").as_str().unwrap_or_default().to_owned();
    browser.go("about:blank");
    browser.go(&address);
    browser.until("typeof window.tresses_state", |kind| kind == "function");
    state(browser, |state| state["recovers"] == true && state["frames"].as_u64() > Some(0));
    browser.picture().keep("studio-groom-4-recover.png");
    browser.click(RECOVER);
    groomed(browser, |groom| groom["hash"] == last["hash"]);
    assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
    server.stop();
    serving.join().unwrap();
}

/// Returns the state of grooming once `is` holds and no job runs.
fn groomed(browser: &mut Browser, is: impl Fn(&Value) -> bool) -> Value {
    let done = |state: &Value| state["step"] == "" && !state["groom"].is_null() && is(&state["groom"]);
    state(browser, done)["groom"].clone()
}

/// Returns the bytes of a file once it is downloaded.
fn downloaded(browser: &mut Browser, path: &Path) -> Vec<u8> {
    let begin = Instant::now();
    while !path.exists() {
        assert!(begin.elapsed() < PATIENCE, "{} does not arrive", path.display());
        assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
        thread::sleep(std::time::Duration::from_millis(200));
    }
    std::fs::read(path).unwrap()
}
