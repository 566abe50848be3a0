//! `<tresses-viewer>` in a browser, embedded in a host page.

mod cards;

use crate::{
    browser::{Browser, Picture},
    studio::picture,
};
use serde_json::{Value, json};
use std::path::Path;
use tresses::{
    glam::Vec3,
    groom::{
        Strands, TriMesh,
        export::{ExportHair, Writer},
        mannequin,
    },
};
use tresses_web::{Server, WebPage, pack};

/// Size of the page, pixels.
const SIZE: [u32; 2] = [640, 400];
/// Number of strands of the page's first file.
const STRANDS: usize = 600;
/// The page. `log` collects the element's events.
const PAGE: &str = r#"<!doctype html><title>A page</title>
<style>body { margin: 0 } tresses-viewer { height: 400px }</style>
<script>
  window.log = [];
  addEventListener("DOMContentLoaded", () => {
    for (const name of ["ready", "load", "error"])
      document.getElementById("viewer").addEventListener(name, event => log.push([name, event.detail]));
  });
</script>
<script type="module" src="tresses-viewer.js"></script>
<tresses-viewer id="viewer" src="head%20of%20hair.glb" cards="cards.glb" query="renderer.kind=tiles" animation="Turn" camera="front"></tresses-viewer>"#;

/// Returns the built-in body with hair that stands out from its head.
fn character() -> (TriMesh, Strands) {
    let mesh = mannequin::mesh(60);
    let mut strands = Strands::default();
    let top = mesh.bounds().expect("it has vertices").1.y;
    let scalp = mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| p.y > top - 0.11 && p.z < 0.06);
    for (at, out) in scalp.cycle().take(STRANDS) {
        let line: Vec<Vec3> = (0..8).map(|j| *at + *out * 0.008 * j as f32).collect();
        strands.push(&line);
    }
    (mesh, strands)
}

/// Awaits the promise `script`, and returns its value or error message.
fn awaited(browser: &mut Browser, script: &str) -> Value {
    browser
        .value(&format!("({script}).then(value => [\"done\", value], error => [\"failed\", error.message])"))
}

#[test]
fn element_shows_hair_and_reports_errors() {
    let Some(mut browser) = Browser::start(SIZE) else { return };
    let browser = &mut browser;
    let folder = tempfile::tempdir().unwrap();
    pack(WebPage::Viewer, folder.path(), false).unwrap();
    for file in ["package.json", "tresses-viewer.d.ts", "README.md", "example.html"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let (mesh, strands) = character();
    let mut rig = mannequin::rig::rig(&mesh);
    rig.animations = vec![turning()];
    let hair = [ExportHair { name: "hair", strands: &strands, packed: true, look: None }];
    let glb = Writer::of("hair.glb").unwrap();
    let file = glb.character(Some((&mesh, Some(&rig))), &hair).unwrap();
    write("head of hair.glb", &file);
    write("broken.glb", &file[..file.len() / 2]);
    write("mesh.glb", &glb.mesh(&mesh, None).unwrap());
    write("index.html", PAGE.as_bytes());
    let server = Server::new(folder.path(), 0).unwrap();
    let serving = std::thread::spawn({
        let server = server.clone();
        move || server.run()
    });
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    let log = browser.until("JSON.stringify(window.log ?? [])", |log| {
        log.as_str().is_some_and(|log| log.contains("load") || log.contains("error"))
    });
    let log: Value = serde_json::from_str(log.as_str().unwrap()).unwrap();
    let shown = json!(["load", {"file": "head of hair.glb", "strands": STRANDS}]);
    assert!(log.as_array().unwrap().contains(&shown), "{log}");
    let first = picture(browser, "hair", |picture| hair_of(picture) > 0.02);
    first.keep("viewer-1-hair.png");
    // Browsers with WebGPU load neither the cards nor what draws them.
    let loaded = browser.value(cards::LOADED).to_string();
    assert!(loaded.contains("tresses_bg.wasm"), "{loaded}");
    assert!(!loaded.contains("three") && !loaded.contains("cards"), "{loaded}");
    // The animation in the file plays.
    picture(browser, "animation", |now| change(now, &first) > 0.01).keep("viewer-2-animation.png");
    let state = |browser: &mut Browser| browser.value("document.getElementById('viewer').state");
    assert_eq!(state(browser)["playing"], true);

    // Parameters by name, and errors for invalid ones.
    let set = |browser: &mut Browser, name: &str, value: &str| {
        let script = format!("(async () => document.getElementById('viewer').set('{name}', '{value}'))()");
        awaited(browser, &script)
    };
    assert_eq!(set(browser, "playing", "false")[0], "done");
    assert_eq!(set(browser, "light.exposure", "0")[0], "failed");
    assert_eq!(set(browser, "wind.speed", "3")[0], "done");
    let wrong = set(browser, "motion", "fly");
    assert!(wrong[0] == "failed" && wrong[1].as_str().unwrap().contains("shake"), "{wrong}");

    // Other files: broken, unsuitable, missing. The shown hair stays.
    let load = |file: &str| format!("document.getElementById('viewer').load('{file}')");
    let broken = awaited(browser, &load("broken.glb"));
    assert!(broken[0] == "failed" && broken[1].as_str().unwrap().contains("broken.glb"), "{broken}");
    let missing = awaited(browser, &load("nothing.glb"));
    assert!(missing[0] == "failed" && missing[1].as_str().unwrap().contains("404"), "{missing}");
    assert_eq!(state(browser)["file"], "head of hair.glb");

    // A second element next to it, on the page's own canvas. Then remove both.
    let second = "new Promise((resolve, reject) => {
        const other = document.createElement('tresses-viewer');
        other.innerHTML = '<canvas slot=canvas id=own></canvas>';
        other.setAttribute('query', 'style=short&style.strands=500');
        other.addEventListener('load', event => resolve(event.detail));
        other.addEventListener('error', event => reject(new Error(event.detail)));
        document.body.append(other);
    })";
    let second = awaited(browser, second);
    assert_eq!(second, json!(["done", {"file": "short", "strands": 500}]));
    // A head without hair gets the style.
    let bare = awaited(browser, "document.querySelectorAll('tresses-viewer')[1].load('mesh.glb')");
    assert_eq!(bare, json!(["done", {"file": "short on mesh.glb", "strands": 500}]));
    browser.value("document.querySelectorAll('tresses-viewer').forEach(viewer => viewer.remove())");
    let gone = browser.until("document.querySelectorAll('canvas').length", |count| count == 0);
    assert_eq!(gone, 0);
    // The browser itself reports the missing file.
    let others: Vec<String> =
        browser.complaints().iter().filter(|said| !said.contains("nothing.glb")).cloned().collect();
    assert!(others.is_empty(), "{}", others.join("\n"));
    server.stop();
    serving.join().unwrap();
}

/// Returns an animation that turns the head to one side and back.
fn turning() -> tresses::groom::rig::Animation {
    use tresses::{
        glam::Quat,
        groom::rig::{Animation, Channel, Curve, Property},
    };
    let turn = |angle: f32| Quat::from_rotation_y(angle).to_array();
    let values = [turn(0.0), turn(0.7), turn(0.0)].concat();
    let curve = Curve { times: vec![0.0, 0.6, 1.2], values, ..Curve::default() };
    let channels = vec![Channel { node: 2, property: Property::Rotation, curve }];
    Animation { name: "Turn".into(), length: 1.2, channels }
}

/// Returns the fraction of the page that is strands: of a different brightness than the pixel to the right.
fn hair_of(picture: &Picture) -> f64 {
    let light = |[r, g, b, _]: [u8; 4]| i32::from(r) + i32::from(g) + i32::from(b);
    picture.part(100..540, 20..380).share(|a, b| (light(a) - light(b)).abs() > 15)
}

fn change(a: &Picture, b: &Picture) -> f64 {
    a.part(100..540, 20..380).difference(&b.part(100..540, 20..380), 12)
}

#[test]
fn package_lists_its_files_and_types() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("component");
    let package: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("package.json")).unwrap()).unwrap();
    for file in package["files"].as_array().unwrap() {
        let made = ["tresses.js", "tresses_bg.wasm", "three"].contains(&file.as_str().unwrap());
        assert!(made || folder.join(file.as_str().unwrap()).exists(), "{file}");
    }
    let types = std::fs::read_to_string(folder.join("tresses-viewer.d.ts")).unwrap();
    let program = std::fs::read_to_string(folder.join("tresses-viewer.js")).unwrap();
    for name in ["open", "close", "load", "loadBytes", "set", "state", "unsupported", "fetchFiles"] {
        assert!(types.contains(name) && program.contains(name), "{name}");
    }
    assert_eq!(package["version"], env!("CARGO_PKG_VERSION"));
}
