//! Cooked grooms: `tresses convert` writes them, and other commands open them like any groom.

use crate::{pixels, tresses};
use std::path::Path;

/// Returns the largest difference between two images, of 255.
fn apart(folder: &Path, names: [&str; 2]) -> u8 {
    let [a, b] = names.map(|name| pixels(&folder.join(name)).1);
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

/// Writes a patch of hair on a slab.
fn write_groom(folder: &Path) {
    let (mut groom, mut head) = (String::new(), String::new());
    for i in 0..150 {
        let (x, z) = (0.01 * (i % 15) as f32 - 0.07, 0.012 * (i / 15) as f32 - 0.06);
        for k in 0..8 {
            groom += &format!("v {} {} {}\n", x + 0.002 * (k * k) as f32, 1.7 + 0.012 * k as f32, z);
        }
        groom += "l -8 -7 -6 -5 -4 -3 -2 -1\n";
    }
    let corners = [(0, 1.0), (1, 1.0), (1, 0.0), (0, 0.0)];
    for (y, (x, z)) in [1.6f32, 1.699].into_iter().flat_map(|y| corners.map(|corner| (y, corner))) {
        head += &format!("v {} {y} {}\n", 0.2 * x as f32 - 0.1, 0.2 * z - 0.1);
    }
    head += "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    std::fs::write(folder.join("groom.obj"), groom).unwrap();
    std::fs::write(folder.join("head.obj"), head).unwrap();
}

#[test]
fn cooked_groom_renders_like_its_source() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_groom(at);
    let from = ["groom.obj", "--head", "head.obj", "--unit", "m", "--up", "y", "--front", "z"];
    let (done, said) = tresses(at, &[&["convert"], &from[..], &["a.tresses"]].concat());
    assert!(done && said.contains("150 strands") && said.contains("a head of 12 triangles"), "{said}");
    let (done, said) = tresses(at, &["info", "a.tresses"]);
    assert!(done && said.contains("Tresses, cooked") && said.contains("made of groom.obj"), "{said}");
    // Convert the cooked groom to another format.
    let (done, said) = tresses(at, &["convert", "a.tresses", "b.hair"]);
    assert!(done && said.contains("150 strands"), "{said}");
    let ends = ["--size", "64x48", "--samples", "1", "--motion", "shake", "--frames", "6"];
    let (done, said) = tresses(at, &[&["render"], &from[..], &ends, &["--out", "a.png"]].concat());
    if tresses_testing::lacks_gpu(&said) {
        return;
    }
    assert!(done, "{said}");
    let render = |out, more: &[&str]| {
        let words = [&["render", "a.tresses", "--out", out], &ends[..], more].concat();
        let (done, said) = tresses(at, &words);
        assert!(done, "{said}");
        apart(at, ["a.png", out])
    };
    assert_eq!(render("b.png", &[]), 0);
    // Settings still apply: other values change the image.
    assert!(render("c.png", &["--guides", "all"]) > 0);
    assert!(render("d.png", &["--strands", "40"]) > 20);
    assert!(render("e.png", &["--grow", "900"]) > 20);
}

#[test]
fn invalid_uses_of_cooked_grooms_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_groom(at);
    let said = |words: &[&str]| {
        let (done, said) = tresses(at, words);
        assert!(!done && said.trim().lines().count() <= 2, "{words:?}: {said}");
        said
    };
    let from = ["groom.obj", "--head", "head.obj", "--unit", "m", "--up", "y", "--front", "z"];
    assert!(said(&["convert", "--as-is", "groom.obj", "a.tresses"]).contains("in meters"));
    assert!(said(&["convert", "--out-unit", "cm", "groom.obj", "a.tresses"]).contains("--out-unit"));
    assert!(said(&["export", "--style", "bob", "--out", "a.tresses"]).contains("`tresses convert`"));
    assert!(!at.join("a.tresses").exists());
    let (done, told) = tresses(at, &[&["convert"], &from[..], &["a.tresses"]].concat());
    assert!(done, "{told}");
    assert!(said(&["info", "a.tresses", "--head", "head.obj"]).contains("do not add other files"));
    assert!(said(&["info", "a.tresses", "groom.obj"]).contains("do not add other files"));
    assert!(said(&["info", "a.tresses", "--unit", "cm"]).contains("cannot be set"));
    assert!(said(&["info", "a.tresses", "--frame", "3"]).contains("a frame cannot be selected"));
    let whole = std::fs::read(at.join("a.tresses")).unwrap();
    let spoil = |bytes: &[u8]| {
        std::fs::write(at.join("b.tresses"), bytes).unwrap();
        said(&["info", "b.tresses"])
    };
    assert!(spoil(&[]).contains("b.tresses"));
    assert!(spoil(b"not this").contains("not a cooked groom"));
    assert!(spoil(&whole[..whole.len() / 2]).contains("checksum"));
    let mut other = whole.clone();
    other[8] += 1;
    assert!(spoil(&other).contains("cook it again"));
}
