//! The smallest program with hair in a real browser: its compiler takes all shaders, within WebGPU's
//! default limits, and there is hair that moves.

#[allow(dead_code, reason = "each test uses its part")]
mod browser;

use browser::Browser;
use tresses_web::{Page, Server, pack};

#[test]
fn hair_moves_in_a_browser() {
    let Some(mut browser) = Browser::start([480, 300]) else { return };
    let folder = tempfile::tempdir().unwrap();
    pack(Page::Minimal, folder.path(), false).unwrap();
    let server = Server::new(folder.path(), 0).unwrap();
    let serving = std::thread::spawn({
        let server = server.clone();
        move || server.run()
    });
    browser.go(&format!("http://127.0.0.1:{}/", server.port()));
    browser.until("document.querySelector('canvas') !== null", |there| there == true);
    let empty = browser.picture();
    // The first frame comes when pipelines are compiled and the hair has fallen into place.
    let begin = std::time::Instant::now();
    let first = loop {
        let picture = browser.picture();
        if picture.difference(&empty, 8) > 0.05 {
            break picture;
        }
        assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
        assert!(begin.elapsed() < browser::PATIENCE, "nothing is drawn");
    };
    first.keep("minimal-1.png");
    // The head turns: hair and face are elsewhere soon.
    let begin = std::time::Instant::now();
    loop {
        let later = browser.picture();
        if later.difference(&first, 16) > 0.02 {
            later.keep("minimal-2.png");
            break;
        }
        assert!(begin.elapsed() < browser::PATIENCE, "nothing moves");
    }
    assert!(browser.complaints().is_empty(), "{}", browser.complaints().join("\n"));
    server.stop();
    serving.join().unwrap();
}
