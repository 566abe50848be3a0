//! Robustness tests of the readers of handwritten files: presets, motions, ties, colliders, levels of detail. Each
//! reader gets randomly damaged files. It must accept or reject each one without panicking, within [`SOON`], and with
//! an error message; accepted contents must be valid. Each test uses [`FILES`] files, or runs for
//! `TRESSES_DAMAGED_SECONDS`, which `make fuzz` sets.

use crate::{
    Colliders, Motion, Preset, Shelf,
    companion_files::{levels::levels, ties::ties},
    preset::Extent,
};
use std::{
    path::Path,
    time::{Duration, Instant},
};
use tresses::glam::Vec3;

/// Number of files per test, if no duration is set.
const FILES: u64 = 3000;
/// Time limit per file. A file of a kilobyte that takes longer is a denial of service.
const SOON: Duration = Duration::from_secs(5);

/// Numbers and words that are likely to break parsers.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e-320",
    "1e39",
    "-1e308",
    "1e999",
    "nan",
    "NaN",
    "inf",
    "9223372036854775808",
    "-0.0",
    "4294967296",
    "null",
    "true",
    "\"\"",
    "\"../../x\"",
    "[]",
    "{}",
    "[[[[[[[[",
    "\u{0}",
    "\u{feff}",
    "é",
    "\\u0000",
    "''''",
];

/// Numbers that are plausible in files.
const NUMBERS: &[&str] =
    &["0", "1", "-1", "3", "0.5", "0.001", "1e-7", "1e-38", "1e-320", "-0.0", "250", "1e6", "1e30", "1e39"];

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Returns `text` with one to three random changes.
fn damaged(text: &str, seed: u64) -> Vec<u8> {
    let mut chance = Chance(seed);
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + chance.below(3) {
        let at = chance.below(bytes.len());
        let end = (at + 1 + chance.below(12)).min(bytes.len());
        match chance.below(12) {
            0 => bytes.truncate(at),
            1 => drop(bytes.splice(at..end, [])),
            2 => bytes[at..end].iter_mut().take(1).for_each(|byte| *byte = chance.next() as u8),
            3 => {
                // Insert a copy of a part at a random position.
                let part = bytes[at..(at + 200).min(bytes.len())].to_vec();
                let to = chance.below(bytes.len());
                drop(bytes.splice(to..to, part));
            }
            kind => {
                // Replace a name with a word, or a number with another number.
                let number = kind > 5;
                let begins =
                    |byte: &u8| if number { byte.is_ascii_digit() } else { byte.is_ascii_alphabetic() };
                let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b".-_".contains(byte);
                let start = at + bytes[at..].iter().position(begins).unwrap_or(0);
                let long =
                    bytes[start..].iter().position(|byte| !is_word(byte)).unwrap_or(bytes.len() - start);
                let words = if number && chance.below(4) > 0 { NUMBERS } else { &WORDS };
                let word = words[chance.below(words.len())];
                drop(bytes.splice(start..start + long, word.bytes()));
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// Runs `read` on damaged copies of `texts`. `read` returns an error message for rejected files. Returns the number of
/// accepted files.
fn survives(texts: &[&str], read: impl Fn(&[u8]) -> Result<(), String>) -> u64 {
    for text in texts {
        read(text.as_bytes()).unwrap_or_else(|error| panic!("the file is whole: {error}\n{text}"));
    }
    let number = |text: String| text.parse::<u64>().expect("TRESSES_DAMAGED_SECONDS is a number");
    let seconds = std::env::var("TRESSES_DAMAGED_SECONDS").ok().map(number);
    let until = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    // The same files on every run, or different ones if a duration is set.
    let clock = std::time::SystemTime::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_secs());
    let first = seconds.map_or(0, |_| clock << 32);
    let (mut seed, mut whole) = (first, 0);
    while until.map_or(seed < FILES, |until| Instant::now() < until) {
        let file = damaged(texts[seed as usize % texts.len()], seed);
        let start = Instant::now();
        match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| read(&file))) {
            Ok(Ok(())) => whole += 1,
            Ok(Err(sentence)) => {
                assert!(!sentence.is_empty() && sentence.len() < 2000, "file {seed}: {sentence:?}");
            }
            Err(_) => panic!("file {seed} is not survived:\n{}", String::from_utf8_lossy(&file)),
        }
        assert!(start.elapsed() < SOON, "file {seed} takes {:?}", start.elapsed());
        seed += 1;
    }
    let all = seed - first;
    println!("{whole} of {all} damaged files were read, the others refused");
    assert!(whole > 0 && whole < all, "{whole} of {all}: the damage is none, or all");
    whole
}

/// Returns a shelf with the file and the mesh that it names.
fn shelf(name: &str, bytes: &[u8]) -> Shelf {
    let mut files = Shelf::default();
    files.put(name.into(), bytes);
    files.put(
        "ball.obj".into(),
        &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"[..],
    );
    files
}

#[test]
fn presets_survive_damage() {
    let all = Preset::default().write(Extent::All);
    let some = "version = 1\nname = \"a\"\n\n[source]\nstyle = \"curly\"\n\n[simulation]\ndrag = 5 # 1/s\n\n[wind]\nspeed = 14\n\n[style]\ncurl_radius = 0.01\n";
    survives(&[&all, some, include_str!("../../../presets/storm.toml")], |bytes| {
        let text = std::str::from_utf8(bytes).map_err(|error| error.to_string())?;
        let preset = Preset::read(text, "a.toml").map_err(|error| error.to_string())?;
        preset.settings.check().expect("what is read was checked");
        let back = Preset::read(&preset.write(Extent::Changed), "b.toml").expect("what is written is read");
        assert_eq!(back, preset);
        Ok(())
    });
}

#[test]
fn motions_survive_damage() {
    let keys = r#"{"loop": true, "keys": [{"time": 0, "rotation": [10, 0, -5]}, {"time": 0.5, "rotation": [-30, 4, 0],
        "lean": [0, 8, 0], "translation": [0, 0.01, 0], "shapes": {"Jaw": 0.5, "Brows": 1}}, {"time": 1.25,
        "rotation": [10, 0, -5]}]}"#;
    survives(&[keys, r#"{"keys": [{"time": 0, "rotation": [90, 0, 0]}, {"time": 2}]}"#], |bytes| {
        let text = std::str::from_utf8(bytes).map_err(|error| error.to_string())?;
        let motion = Motion::parse(text).map_err(|error| format!("{error:#}"))?;
        for step in -2..40 {
            let time = f64::from(step) / 20.0 * motion.duration().min(1e6);
            let pose = motion.pose(time, Vec3::Y);
            assert!(pose.translation.is_finite() && pose.rotation.is_finite(), "at {time} s: {pose:?}");
            let gesture = motion.gesture(time, Vec3::Y);
            assert!(gesture.shapes.iter().all(|(_, weight)| weight.is_finite()));
        }
        Ok(())
    });
}

#[test]
fn ties_survive_damage() {
    let file = r#"{"ties": [{"at": [0, 1, 2], "radius": 0.02}, {"from": [0, 1, 0], "to": [0, 2, 0], "radius": 0.01},
        {"at": [1, 1, 1], "radius": 0.01, "held": "to-head", "gather": 0.3, "group": 4}]}"#;
    survives(&[file], |bytes| {
        let found =
            ties(Path::new("ties.json"), &shelf("ties.json", bytes)).map_err(|error| format!("{error:#}"))?;
        found.iter().for_each(|tie| tie.check().expect("what is read was checked"));
        Ok(())
    });
}

#[test]
fn colliders_survive_damage() {
    let file = r#"{"colliders": [{"shape": {"capsule": {"radius": 0.1, "half_length": 0.2}}, "keys": [{"time": 0,
        "translation": [0, 1, 0]}]}, {"shape": {"ellipsoid": {"radii": [0.1, 0.2, 0.3]}}, "friction": 0.5, "loop": true,
        "keys": [{"time": 0}, {"time": 1, "rotation": [5, 0, 0]}, {"time": 2}]}, {"shape": {"mesh": {"file": "ball.obj",
        "resolution": 12}}, "anchor": "head", "keys": [{"time": 0}]}], "joints": [{"joint": "Neck", "shape": "fit"}]}"#;
    survives(&[file], |bytes| {
        Colliders::read(Path::new("obstacles.json"), &shelf("obstacles.json", bytes))
            .map(|_| ())
            .map_err(|error| format!("{error:#}"))
    });
}

#[test]
fn levels_survive_damage() {
    let file = r#"{"levels": [{"size": 0}, {"size": 120.5, "density": null}]}"#;
    survives(&[file], |bytes| {
        levels(Path::new("levels.json"), &shelf("levels.json", bytes))
            .map(|_| ())
            .map_err(|error| format!("{error:#}"))
    });
}

#[test]
#[should_panic(expected = "is not survived")]
fn panics_are_detected() {
    survives(&["abc"], |bytes| {
        assert!(bytes != b"ab" && bytes != b"a");
        if bytes.len() > 3 { Err("too long".into()) } else { Ok(()) }
    });
}
