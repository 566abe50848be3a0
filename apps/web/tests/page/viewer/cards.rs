//! Cards in `<tresses-viewer>`, drawn without WebGPU.

use super::{SIZE, awaited, change, character, turning};
use crate::{
    browser::{Browser, Picture},
    serve,
    studio::picture,
};
use serde_json::{Value, json};
use std::{path::Path, sync::OnceLock};
use tresses::{
    glam::Vec3,
    groom::{
        cards::{CardAlpha, CardLook, CardOptions, bake},
        mannequin,
    },
};
use tresses_web::{WebPage, pack};

/// Script that returns the names of all loaded files.
pub const LOADED: &str = "performance.getEntriesByType('resource').map(file => file.name).join(' ')";
/// Numbers of cards of the two levels.
const LEVELS: [u32; 2] = [60, 20];

/// Returns a page with an element with `attributes`. `log` collects its events.
fn page(attributes: &str) -> String {
    format!(
        r#"<!doctype html><title>Cards</title>
<style>body {{ margin: 0 }} tresses-viewer {{ height: 400px }}</style>
<script type="module">
  window.log = [];
  for (const name of ["ready", "load", "error"])
    document.getElementById("viewer").addEventListener(name, event => log.push([name, event.detail]));
  await import("./tresses-viewer.js");
</script>
<tresses-viewer id="viewer" {attributes}></tresses-viewer>"#
    )
}

/// Returns a file of red cards on a body with an animation.
fn file() -> &'static [u8] {
    static FILE: OnceLock<Vec<u8>> = OnceLock::new();
    FILE.get_or_init(|| {
        let (mesh, mut strands) = character();
        strands.radii = vec![0.001; strands.positions.len()];
        let mut rig = mannequin::rig::rig(&mesh);
        rig.animations = vec![turning()];
        let options = CardOptions {
            levels: LEVELS.to_vec(),
            texture_size: 512,
            lock_texture_count: 8,
            ..CardOptions::default()
        };
        let mut cards = bake(&strands, Some(&mesh), &options).unwrap();
        cards.levels[1].accuracy.switch = 128.0;
        let look =
            CardLook { color: Vec3::new(0.6, 0.02, 0.01), alpha: CardAlpha::Core, motions: Vec::new() };
        cards.glb(Some((&mesh, Some(&rig))), &look).unwrap()
    })
}

/// Builds the element into `folder`, with cards and a page for an element with `attributes`.
fn build(folder: &Path, attributes: &str) {
    pack(WebPage::Viewer, folder, false).unwrap();
    std::fs::write(folder.join("cards.glb"), file()).unwrap();
    std::fs::write(folder.join("broken.glb"), &file()[..file().len() / 2]).unwrap();
    std::fs::write(folder.join("index.html"), page(attributes)).unwrap();
}

/// Returns the element's events once there are files or an error.
fn events(browser: &mut Browser) -> Value {
    let log = browser.until("JSON.stringify(window.log ?? [])", |log| {
        log.as_str().is_some_and(|log| log.contains("\"load\"") || log.contains("\"error\""))
    });
    serde_json::from_str(log.as_str().unwrap()).unwrap()
}

/// Returns the fraction of the page that is red hair.
fn red(picture: &Picture) -> f64 {
    picture.share(|[r, g, b, _], _| r > 50 && r > 2 * g.min(120) && r > 2 * b.min(120))
}

/// Runs `script` with `viewer` as the element, and returns its value or error message.
fn run(browser: &mut Browser, script: &str) -> Value {
    awaited(
        browser,
        &format!("(async () => {{ const viewer = document.getElementById('viewer'); {script} }})()"),
    )
}

#[test]
fn cards_are_drawn_without_webgpu() {
    let Some(mut browser) = Browser::start(SIZE) else { return };
    let browser = &mut browser;
    let folder = tempfile::tempdir().unwrap();
    build(folder.path(), r#"cards="cards.glb" render="cards" motion="turn" animation="Turn" camera="front""#);
    let (server, serving) = serve(folder.path());
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    let log = events(browser);
    let load = json!({"file": "cards.glb", "strands": 0, "cards": LEVELS[0]});
    assert_eq!(log, json!([["ready", null], ["load", load]]));
    let loaded = browser.value(LOADED).to_string();
    assert!(loaded.contains("three.module.min.js") && !loaded.contains("tresses_bg.wasm"), "{loaded}");
    let first = picture(browser, "hair", |picture| red(picture) > 0.03);
    first.keep("cards-1-hair.png");
    picture(browser, "animation", |now| change(now, &first) > 0.01).keep("cards-2-animation.png");

    // A drag orbits.
    assert_eq!(run(browser, "viewer.set('playing', false)")[0], "done");
    let state = |browser: &mut Browser| browser.value("document.getElementById('viewer').state");
    assert_eq!(state(browser)["playing"], false);
    let still = browser.picture();
    browser.drag([320.0, 200.0], [420.0, 200.0]);
    picture(browser, "orbit", |now| change(now, &still) > 0.1).keep("cards-3-orbit.png");

    // The wheel zooms out, until the coarse level is shown.
    let level = |browser: &mut Browser, level: u32| {
        browser.until("document.getElementById('viewer').state.level", |now| *now == level);
    };
    level(browser, 0);
    browser.wheel([320.0, 200.0], 4500.0);
    level(browser, 1);
    let far = picture(browser, "distant hair", |picture| (0.0002..0.02).contains(&red(picture)));
    far.keep("cards-4-far.png");
    assert_eq!(run(browser, "viewer.set('camera', 'back')")[0], "done");
    level(browser, 0);

    // Errors are one sentence, and the shown hair stays.
    for (script, part) in [
        ("viewer.set('wind.speed', 3)", "wind.speed: cards have only playing, camera and animation"),
        ("viewer.set('motion', 'nod')", "motion: cards have only"),
        ("viewer.set('camera', 'up')", "three-quarter"),
        ("viewer.set('animation', 'Fly')", "it has Turn"),
        ("await viewer.load('broken.glb')", "broken.glb: the file is not a whole .glb"),
    ] {
        let error = run(browser, script);
        assert!(error[0] == "failed" && error[1].as_str().unwrap().contains(part), "{error}");
    }
    assert_eq!(state(browser)["file"], "cards.glb");
    let again = run(browser, "return viewer.load('cards.glb')");
    assert_eq!(again, json!(["done", load]));

    // Closing frees the context. The element can be opened again.
    let canvases = "viewer.shadowRoot.querySelectorAll('canvas')";
    run(browser, &format!("window.gl = {canvases}[0].getContext('webgl2'); viewer.close()"));
    browser.until("window.gl.isContextLost()", |lost| *lost == true);
    assert_eq!(run(browser, &format!("return [{canvases}.length, viewer.state]")), json!(["done", [0, {}]]));
    assert_eq!(run(browser, "window.log = []; await viewer.open()")[0], "done");
    assert_eq!(events(browser)[1][0], "load");

    // A broken file from the start.
    let broken = run(
        browser,
        "viewer.close(); window.log = []; viewer.setAttribute('cards', 'broken.glb'); await viewer.open()",
    );
    assert!(broken[1].as_str().unwrap().starts_with("broken.glb: "), "{broken}");
    assert_eq!(events(browser), json!([["error", broken[1]]]));
    let message = "viewer.shadowRoot.querySelector('[part=message]').textContent";
    let shown = run(browser, &format!("return [{canvases}.length, {message}]"));
    assert_eq!(shown, json!(["done", [0, broken[1]]]));
    assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
    server.stop();
    serving.join().unwrap();
}

#[test]
fn cards_replace_missing_webgpu() {
    let Some(mut browser) = Browser::without_webgpu(SIZE) else { return };
    let browser = &mut browser;
    let folder = tempfile::tempdir().unwrap();
    build(folder.path(), r#"src="hair.glb" cards="cards.glb""#);
    std::fs::write(folder.path().join("bare.html"), page("")).unwrap();
    let (server, serving) = serve(folder.path());
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    assert_eq!(events(browser)[1][1]["file"], "cards.glb");
    picture(browser, "hair", |picture| red(picture) > 0.03);
    browser.go(&format!("http://127.0.0.1:{}/bare.html", server.port()));
    let log = events(browser);
    assert!(log[0][1].as_str().unwrap().starts_with("This browser has"), "{log}");
    assert!(!browser.value(LOADED).to_string().contains("three"));
    server.stop();
    serving.join().unwrap();
}
