//! Hair is combed with the mouse, undone, redone, saved, and recovered after a crash.

use crate::{SPACE, display::Desk, turn};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
    time::Duration,
};
use tresses::groom::mannequin;

/// Keysyms.
const CONTROL: u32 = 0xffe3;
const SHIFT: u32 = 0xffe1;
const ESCAPE: u32 = 0xff1b;
const G: u32 = 0x67;
const Z: u32 = 0x7a;
const A: u32 = 0x61;
const C: u32 = 0x63;
const H: u32 = 0x68;
const E: u32 = 0x65;
/// Places in a window of 1280 × 720, pixels.
const HAIR: [i16; 2] = [580, 300];
const REDO: [i16; 2] = [1158, 18];
const SAVE: [i16; 2] = [91, 455];
const RECOVER: [i16; 2] = [542, 619];
const CHEEK: [i16; 2] = [455, 470];

/// Returns the state of grooming once `is` holds and no job runs.
fn groomed(desk: &mut Desk, what: &str, is: impl Fn(&serde_json::Value) -> bool) -> serde_json::Value {
    desk.wait_for(what, |desk| {
        let state = desk.state()?;
        assert_eq!(state["error"], "");
        let groom = state["groom"].clone();
        (state["step"] == "" && !groom.is_null() && is(&groom)).then_some(groom)
    })
}

/// Returns an empty folder for a test.
fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Opens the studio in a folder of its own.
fn open(folder: &Path, words: &[&str]) -> Desk {
    let mut desk = Desk::open_in(folder, words, &[("XDG_STATE_HOME", folder.to_str().unwrap())]);
    desk.show_hair();
    desk
}

const BOB: [&str; 2] = ["style=bob", "style.strands=4000"];

#[test]
fn hair_is_combed_undone_saved_and_recovered() {
    let Some(_turn) = turn() else { return };
    let folder = fresh("studio-groom");
    let mut desk = open(&folder, &BOB);
    desk.chord(CONTROL, G);
    let begun = groomed(&mut desk, "the brush", |groom| groom["strokes"] == 0);
    let before = desk.still();
    before.keep("groom-before");
    let to = [HAIR[0] + 70, HAIR[1] + 20];
    let stroke = |desk: &mut Desk| {
        desk.drag(1, [HAIR, to], |desk| {
            groomed(desk, "a stroke", |groom| groom["active"] == true);
            std::thread::sleep(Duration::from_millis(600));
        });
    };
    stroke(&mut desk);
    let after = groomed(&mut desk, "the end of the stroke", |groom| groom["strokes"] == 1);
    assert_ne!(after["hash"], begun["hash"]);
    let combed = desk.still();
    combed.keep("groom-after");
    assert!(combed.change(&before) > 0.01, "{}", combed.change(&before));

    // Undo and redo are bit-identical.
    desk.chord(CONTROL, Z);
    groomed(&mut desk, "undo", |groom| groom["hash"] == begun["hash"] && groom["strokes"] == 0);
    let undone = desk.still();
    undone.keep("groom-undone");
    assert!(undone.change(&before) < 0.3 * combed.change(&before), "{}", undone.change(&before));
    desk.click(REDO);
    groomed(&mut desk, "redo", |groom| groom["hash"] == after["hash"] && groom["strokes"] == 1);

    // Escape takes a stroke back.
    desk.drag(1, [HAIR, to], |desk| {
        groomed(desk, "a stroke", |groom| groom["active"] == true);
        desk.key(ESCAPE);
    });
    groomed(&mut desk, "the same hair", |groom| groom["active"] == false && groom["hash"] == after["hash"]);

    // There are no file dialogs here: the file goes to the current folder.
    desk.click(SAVE);
    let saved = folder.join("bob.groom");
    desk.wait_for("the file", |_| {
        std::fs::metadata(&saved).is_ok_and(|file| file.len() > 100_000).then_some(())
    });

    // The hair moves under the brush: the dryer blows it, and it keeps the shape of the moment, until that is undone.
    desk.key(SPACE);
    desk.key(H);
    desk.wait_for("moving hair", |desk| (desk.state()?["live"] == true).then_some(()));
    let calm = desk.shot();
    desk.drag(1, [HAIR, to], |desk| {
        std::thread::sleep(Duration::from_secs(3));
        let blown = desk.shot();
        blown.keep("groom-blown");
        assert!(blown.change(&calm) > 0.01, "{}", blown.change(&calm));
        desk.chord(SHIFT, SPACE);
    });
    groomed(&mut desk, "the shape of the moment", |groom| {
        groom["hash"] != after["hash"] && groom["strokes"] == 2
    });
    assert_eq!(desk.state().unwrap()["live"], false);
    desk.still().keep("groom-kept");
    desk.chord(CONTROL, Z);
    groomed(&mut desk, "the shape before", |groom| groom["hash"] == after["hash"]);
    desk.key(C);

    // A crash after another stroke: the next studio offers it.
    desk.still();
    stroke(&mut desk);
    let last = groomed(&mut desk, "the second stroke", |groom| groom["strokes"] == 2);
    let journal = folder.join("tresses/groom");
    let is_there = || {
        let files = std::fs::read_dir(&journal).ok()?.filter_map(Result::ok);
        files.into_iter().find(|file| file.path().extension().is_some_and(|end| end == "groom"))
    };
    desk.wait_for("the journal", |_| is_there().map(|_| ()));
    std::thread::sleep(Duration::from_secs(2));
    desk.kill();
    let mut desk = open(&folder, &BOB);
    desk.wait_for("the offer", |desk| (desk.state()?["recovers"] == true).then_some(()));
    desk.key(SPACE);
    desk.shot().keep("groom-recover");
    desk.click(RECOVER);
    groomed(&mut desk, "the recovered hair", |groom| groom["hash"] == last["hash"]);
    desk.still().keep("groom-recovered");
    assert!(desk.close().success());
    assert!(is_there().is_some(), "unsaved hair stays");
}

#[test]
fn hair_is_planted_and_removed_on_the_head_of_a_file() {
    let Some(_turn) = turn() else { return };
    let folder = fresh("studio-plant");
    let (mesh, mut text) = (mannequin::mesh(64), String::new());
    mesh.positions.iter().for_each(|p| writeln!(text, "v {} {} {}", p.x, p.y + 1.5, p.z).unwrap());
    mesh.triangles.iter().for_each(|[a, b, c]| writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap());
    std::fs::write(folder.join("head.obj"), text).unwrap();
    let mut desk = open(&folder, &["head.obj", "style=short", "style.strands=3000"]);
    assert_eq!(desk.state().unwrap()["file"], "short on head.obj");
    desk.chord(CONTROL, G);
    let begun = groomed(&mut desk, "the brush", |groom| groom["strokes"] == 0);
    let strands = |desk: &mut Desk| desk.state().unwrap()["strands"].as_u64().unwrap();
    let stroke = |desk: &mut Desk, count: u64| {
        desk.drag(1, [CHEEK, [CHEEK[0] + 40, CHEEK[1] + 40]], |desk| {
            groomed(desk, "a stroke", |groom| groom["active"] == true);
            desk.shot().keep(&format!("groom-roots-{count}"));
        });
        groomed(desk, "the end of the stroke", |groom| groom["strokes"] == count);
        desk.still().keep(&format!("groom-rooted-{count}"));
    };
    desk.key(A);
    stroke(&mut desk, 1);
    let planted = groomed(&mut desk, "new hair", |groom| groom["guides"].as_u64() > begun["guides"].as_u64());
    let all = strands(&mut desk);
    assert!(all > 3200, "{all} strands");
    desk.key(E);
    stroke(&mut desk, 2);
    let left = strands(&mut desk);
    assert!(left < all - 100, "{left} of {all} strands");
    desk.chord(CONTROL, Z);
    groomed(&mut desk, "planted hair", |groom| groom["hash"] == planted["hash"]);
    desk.chord(CONTROL, Z);
    groomed(&mut desk, "the hair before", |groom| groom["hash"] == begun["hash"]);
    desk.wait_for("its strands", |desk| (desk.state()?["strands"] == 3000).then_some(()));
    assert!(desk.close().success());
}
