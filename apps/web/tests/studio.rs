//! The studio in a real browser: its page opens, shows moving hair, responds to mouse and keys, accepts
//! files, and neither the browser nor WebGPU reports an error.

mod browser;
mod viewer;

use browser::{Browser, Picture};
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
    ops::Range,
    path::Path,
    thread,
    time::Instant,
};
use tresses_web::{Page, Server, pack};

/// Of the page, pixels; narrower ones fold the panel.
const SIZE: [u32; 2] = [780, 420];
/// Of a page with a picture of 1280 by 720.
const BROAD: [u32; 2] = [1684, 829];
/// On that page the panel's page of times, and the box that is ticked while frames are kept short.
const TIME: [f64; 2] = [1560.0, 57.0];
const KEEP_SHORT: [f64; 2] = [1299.0, 204.0];
/// Few strands, and a colour that a slider turns.
const ADDRESS: &str = "?style=short&style.strands=1500&shading.color=melanin";
/// Where of the page the picture is, without what lies on it.
const PICTURE: (Range<u32>, Range<u32>) = (112..420, 90..330);
/// Where of the page sentences about errors are.
const SENTENCES: (Range<u32>, Range<u32>) = (150..420, 276..336);
/// The panel's field for words to search parameters by, the one slider that is left then, and its left end.
const SEARCH: [f64; 2] = [580.0, 98.0];
const SLIDER: [[f64; 2]; 2] = [[629.0, 158.0], [590.0, 158.0]];
/// In the picture, where nothing lies on it.
const MIDDLE: [f64; 2] = [216.0, 220.0];
/// In the picture, beside the hair.
const BESIDE: [f64; 2] = [340.0, 130.0];
/// The menu of files, its entry for a loop, and what is in the window that opens then: the pictures per second,
/// a place where nothing is, and the button that begins.
const MENU: [f64; 2] = [256.0, 18.0];
const RECORD: [f64; 2] = [288.0, 172.0];
const RATE: [f64; 2] = [363.0, 193.0];
const WISH: [f64; 2] = [500.0, 285.0];
const GO: [f64; 2] = [278.0, 285.0];
/// Strands of the file that is dropped.
const DROPPED: usize = 400;

/// How much memory the browser may take while the page goes on as it did before, bytes.
const MOST: i64 = 20_000_000;
/// Sizes of the page that come by, pixels; the panel keeps its width and its place at the right.
const SIZES: [[u32; 2]; 3] = [SIZE, [SIZE[0] + 60, SIZE[1]], [SIZE[0], SIZE[1] + 60]];
/// The panel's page of views of the inside; on it hair as it looks, locks, density and overdraw.
const INSIDE: [f64; 2] = [662.0, 57.0];
const VIEWS: [[f64; 2]; 4] = [[495.0, 98.0], [470.0, 231.0], [475.0, 312.0], [585.0, 258.0]];
/// By how much the wheel turns: as far away as two levels of detail.
const WHEEL: f64 = 300.0;
/// Rounds in which every size has been seen in every view.
const ROUNDS: usize = 12;

/// A server for `folder`, which runs until it is told to stop.
fn serve(folder: &Path) -> (Server, thread::JoinHandle<()>) {
    let server = Server::new(folder, 0).unwrap();
    let serving = thread::spawn({
        let server = server.clone();
        move || server.run()
    });
    (server, serving)
}

/// The studio's page with hair on it, which is drawn as `how` has it, and its server.
fn open(folder: &Path, how: &str) -> Option<(Browser, Server, thread::JoinHandle<()>)> {
    let mut opened = open_at(folder, SIZE, &format!("{ADDRESS}{how}"))?;
    state(&mut opened.0, |state| state["strands"] == 1500 && state["frames"].as_u64() > Some(0));
    Some(opened)
}

/// The same at an `address`, of `size` pixels, as soon as it tells of itself.
fn open_at(
    folder: &Path,
    size: [u32; 2],
    address: &str,
) -> Option<(Browser, Server, thread::JoinHandle<()>)> {
    let mut browser = Browser::start(size)?;
    pack(Page::Studio, folder, false).unwrap();
    let (server, serving) = serve(folder);
    browser.go(&format!("http://127.0.0.1:{}/{address}", server.port()));
    // WebAssembly is compiled, then the shaders.
    browser.until("typeof window.tresses_state", |kind| kind == "function");
    Some((browser, server, serving))
}

#[test]
fn memory_stands_still_in_a_browser() {
    stands_still(3, 60);
}

#[test]
#[ignore = "proof"]
fn two_thousand_frames_in_a_browser_take_no_more_than_a_hundred() {
    stands_still(9, 2000);
}

/// The motion goes on, `frames` in each round, until there were `all` frames: the page is resized, the camera comes
/// and goes, and with it the level of detail, views are shown. After as many rounds as show everything once, memory
/// stands still.
fn stands_still(frames: u64, all: u64) {
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
    // A browser starts processes for pages that are still to come, after a minute or two: they are not this page's.
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
    // A leak of that size is seen.
    browser.value(&format!("(window.kept = new Uint8Array({})).fill(1).length", 3 * MOST / 2));
    let leaked = of_this(&browser.resident().expect("it told before")) - is;
    assert!(leaked > MOST, "{leaked} bytes");
    server.stop();
    serving.join().unwrap();
}

#[test]
fn the_studio_runs_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    let Some((mut browser, server, serving)) = open(folder.path(), "&edges.coverage=tiles") else { return };
    let first = picture(&mut browser, "hair", |picture| hair(picture) > 0.05);
    first.keep("studio-1-hair.png");
    picture(&mut browser, "motion", |later| change(later, &first) > 0.03).keep("studio-2-motion.png");

    // A click gives the page the keyboard.
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

    // Files, a whole one and a broken one.
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

    // Surroundings are there at once, and the hair goes on; a picture may be any map.
    let (sky, map) = (folder.path().join("sky.hdr"), folder.path().join("map.png"));
    std::fs::write(&sky, surroundings()).unwrap();
    std::fs::write(&map, grey()).unwrap();
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
    // That nothing was heard means something: what WebGPU refuses is heard.
    browser.value(REFUSED);
    let begin = Instant::now();
    while browser.complaints().is_empty() {
        assert!(begin.elapsed() < browser::PATIENCE, "a buffer without a use is no error");
    }
    server.stop();
    serving.join().unwrap();
}

/// Prints what a frame of Sintel's groom takes in the browser, every strand simulated, in motion and in full: the work
/// of `tresses bench --preset` and of the peers' pages.
#[test]
#[ignore = "proof"]
fn a_real_groom_in_full_in_a_browser() {
    let Some(assets) = std::env::var_os("TRESSES_ASSETS") else {
        return println!("skipped: there are no assets");
    };
    let sintel = Path::new(&assets).join("sintel");
    let (groom, head) =
        (sintel.join("SintelHairOriginal-sintel_hair.16points.tfx"), sintel.join("sintel.obj"));
    let folder = tempfile::tempdir().unwrap();
    let address = "?style=short&style.strands=11400&style.all_guides=true&lod.mode=off&edges.coverage=tiles";
    let Some((mut browser, server, serving)) = open_at(folder.path(), BROAD, address) else { return };
    let browser = &mut browser;
    state(browser, |state| state["frames"].as_u64() > Some(0));
    browser.drop_files(&[&groom, &head], MIDDLE);
    state(browser, |state| {
        state["file"].as_str().is_some_and(|file| file.starts_with("Sintel")) && state["step"] == ""
    });
    // Held for some frames, seconds each: a click nevertheless.
    browser.drag(TIME, TIME);
    // At once, as a hand would that knows its way: the page of the panel is shown first, however long frames take.
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
    // The first ones have something to compile.
    let mut rest = frames.split_off(2);
    rest.sort_by(f64::total_cmp);
    println!("{size} pixels: {:.0} ms a frame (median of {rest:.0?})", rest[rest.len() / 2]);
    server.stop();
    serving.join().unwrap();
}

/// Browsers refuse shaders that wgpu's own compiler takes: they prove more of what must be alike for all threads.
#[test]
fn browsers_take_all_shaders() {
    let Some(mut browser) = Browser::start(SIZE) else { return };
    let folder = tempfile::tempdir().unwrap();
    // WebGPU is for pages of a server.
    std::fs::write(folder.path().join("index.html"), "<!doctype html><title>Shaders</title>").unwrap();
    let (server, serving) = serve(folder.path());
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    browser.until("document.title", |title| title == "Shaders");
    let mut refused = |shaders: &[(&str, &str)]| {
        let shaders = serde_json::to_string(shaders).unwrap();
        browser.value(&COMPILE.replace("SHADERS", &shaders))
    };
    let all = tresses::shaders::all();
    assert!(all.len() > 50, "{}", all.len());
    let found = refused(all);
    assert_eq!(found, serde_json::json!([]), "{found:#}");
    let wrong = "@group(0) @binding(0) var<storage, read_write> n: u32;
        @compute @workgroup_size(64) fn run() { if n > 0u { workgroupBarrier(); } }";
    assert!(refused(&[("wrong", wrong)])[0].as_str().unwrap().contains("uniform"));
    server.stop();
    serving.join().unwrap();
}

#[test]
fn without_webgpu_there_is_a_sentence() {
    let Some(mut browser) = Browser::without_webgpu(SIZE) else { return };
    let folder = tempfile::tempdir().unwrap();
    // The page asks before it loads anything.
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

/// One finger looks around, two come nearer.
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
    // Half as far apart again as they were, in the picture as on the glass.
    let ratio = far / distance(&state(browser, |_| true));
    assert!((ratio - 1.5).abs() < 0.05, "{ratio}");
    assert!(change(&near, &around) > 0.1, "{}", change(&near, &around));
}

/// A loop is recorded, and comes as a file that moves.
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
    // Elsewhere: what was typed holds.
    browser.click(WISH);
    still(browser).keep("studio-record-2-rate.png");
    browser.click(GO);
    let (path, begin) = (folder.join("tresses.gif"), Instant::now());
    while !path.exists() {
        assert!(begin.elapsed() < browser::PATIENCE, "no loop arrives");
        assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
        thread::sleep(std::time::Duration::from_millis(200));
    }
    let bytes = std::fs::read(&path).unwrap();
    let (frames, differ) = frames(&bytes);
    println!("a loop of {} bytes and {frames} frames", bytes.len());
    // Three seconds, two a second.
    assert_eq!(frames, 6);
    assert!(differ, "it moves");
    still(browser).keep("studio-record-3-done.png");
}

/// How many pictures a GIF has, and whether any differs from the first.
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

/// Surroundings, bright and blue above: pixels of four bytes each, as they are.
fn surroundings() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    for i in 0..32 {
        bytes.extend(if i < 16 { [40, 90, 250, 131] } else { [60, 40, 20, 126] });
    }
    bytes
}

/// A grey picture.
fn grey() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[0, 80, 160, 255]).unwrap();
    bytes
}

/// What WebGPU has against shaders, each a name and a text.
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

/// Something that WebGPU refuses.
const REFUSED: &str = "navigator.gpu.requestAdapter().then(adapter => adapter.requestDevice())
    .then(device => { device.createBuffer({ size: 4, usage: 0 }); return device.queue.onSubmittedWorkDone(); })";

/// What the studio says of itself once `enough` is satisfied with it.
fn state(browser: &mut Browser, enough: impl Fn(&Value) -> bool) -> Value {
    let parse = |value: &Value| serde_json::from_str::<Value>(value.as_str().unwrap_or_default());
    parse(&browser.until("window.tresses_state()", |value| parse(value).is_ok_and(|state| enough(&state))))
        .unwrap()
}

/// The page once `is` holds of it.
fn picture(browser: &mut Browser, what: &str, is: impl Fn(&Picture) -> bool) -> Picture {
    let begin = Instant::now();
    loop {
        let picture = browser.picture();
        if is(&picture) {
            return picture;
        }
        assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
        picture.keep("studio-last.png");
        assert!(begin.elapsed() < browser::PATIENCE, "no {what} is seen");
    }
}

/// The page once nothing is under way any more.
fn still(browser: &mut Browser) -> Picture {
    // The caret beside it may blink.
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
        assert!(begin.elapsed() < browser::PATIENCE, "the page does not come to rest");
    }
}

fn drop_file(browser: &mut Browser, file: &Path) {
    browser.drop_files(&[file], MIDDLE);
}

/// The share of the picture that differs visibly.
fn change(a: &Picture, b: &Picture) -> f64 {
    let of = |picture: &Picture| picture.part(PICTURE.0, PICTURE.1);
    of(a).difference(&of(b), 12)
}

/// The share of the picture that is strands: of another brightness than the pixel beside it.
fn hair(picture: &Picture) -> f64 {
    let light = |[r, g, b, _]: [u8; 4]| i32::from(r) + i32::from(g) + i32::from(b);
    picture.part(PICTURE.0, PICTURE.1).share(|a, b| (light(a) - light(b)).abs() > 15)
}

/// The share of the place of sentences that has the colour of those about errors.
fn alarm(picture: &Picture) -> f64 {
    let near = |a: u8, b: u8| a.abs_diff(b) < 24;
    picture
        .part(SENTENCES.0, SENTENCES.1)
        .share(|[r, g, b, _], _| near(r, 0xe5) && near(g, 0x73) && near(b, 0x5f))
}

/// Strands that hang from the upper half of a ball, as text; metres.
fn groom() -> String {
    let mut text = format!("version 2.0\nscale 1\nnumStrands {DROPPED}\n");
    for i in 0..DROPPED {
        // Evenly over the half, by the golden angle.
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
fn the_measures_can_say_no() {
    let pixels = SIZE[0] * SIZE[1];
    let flat = |color: [u8; 4]| Picture { size: SIZE, rgba: color.repeat(pixels as usize) };
    let (grey, skin) = (flat([40, 42, 46, 255]), flat([200, 150, 120, 255]));
    assert_eq!((hair(&grey), hair(&skin), change(&grey, &grey), alarm(&skin)), (0.0, 0.0, 0.0, 0.0));
    assert_eq!(change(&grey, &skin), 1.0);
    let mut strands = grey.clone();
    for pixel in strands.rgba.chunks_mut(12) {
        pixel[..4].copy_from_slice(&[120, 90, 60, 255]);
    }
    assert!(hair(&strands) > 0.5 && change(&strands, &grey) > 0.2);
    assert!(alarm(&flat([0xe5, 0x73, 0x5f, 255])) > 0.9);
}
