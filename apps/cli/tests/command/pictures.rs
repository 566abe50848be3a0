//! Special outputs of `tresses render`: layers, alpha, videos.

use crate::{command, pixels, said};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use std::{collections::BTreeMap, path::Path, process::Command};

/// Options for small images that are quick to draw.
const SHORT: [&str; 8] = ["render", "--style", "short", "--strands", "2000", "--samples", "1", "--size"];

fn run(folder: &Path, args: &[&str], ffmpeg: Option<&str>) -> (bool, String) {
    let mut command = command(folder, args);
    if let Some(ffmpeg) = ffmpeg {
        command.env("TRESSES_FFMPEG", ffmpeg);
    }
    said(&command.output().unwrap())
}

/// Runs a command that renders. Returns its output, or `None` without a GPU.
fn drawn(folder: &Path, args: &[&str]) -> Option<String> {
    let (done, said) = run(folder, args, None);
    if tresses_testing::lacks_gpu(&said) {
        return None;
    }
    assert!(done, "{said}");
    Some(said)
}

/// Reads the channels of an EXR file. Doubles represent all values exactly.
fn channels(path: &Path) -> BTreeMap<String, Vec<f64>> {
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = image.from_file(path).unwrap();
    let numbers = |samples: &FlatSamples| match samples {
        FlatSamples::F16(all) => all.iter().map(|v| f64::from(v.to_f32())).collect(),
        FlatSamples::F32(all) => all.iter().map(|v| f64::from(*v)).collect(),
        FlatSamples::U32(all) => all.iter().map(|v| f64::from(*v)).collect(),
    };
    let list = image.layer_data.channel_data.list.iter();
    list.map(|channel| (channel.name.to_string(), numbers(&channel.sample_data))).collect()
}

#[test]
fn exr_layers_describe_the_hair() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words = [&SHORT[..], &["64x48", "--motion", "shake", "--frames", "5", "--out", "a.##.exr"]].concat();
    let Some(said) = drawn(at, &words) else { return };
    assert!(said.contains("a.00.exr to a.04.exr (5 frames)"), "{said}");
    let [first, last] = ["a.00.exr", "a.04.exr"].map(|name| channels(&at.join(name)));
    let names: Vec<&str> = last.keys().map(String::as_str).collect();
    let all = [
        "A",
        "B",
        "G",
        "R",
        "hair.A",
        "hair.Z",
        "hair.groom",
        "hair.motion.X",
        "hair.motion.Y",
        "hair.strand",
    ];
    assert_eq!(names, all);
    let of = |name: &str| &last[name];
    let none = f64::from(u32::MAX);
    let hair: Vec<usize> = (0..64 * 48).filter(|i| of("hair.strand")[*i] != none).collect();
    assert!((200..2500).contains(&hair.len()), "{}", hair.len());
    assert!(first["hair.motion.X"].iter().all(|moved| moved.is_nan()));
    for (i, alpha) in of("A").iter().enumerate() {
        let is_hair = of("hair.strand")[i] != none;
        assert_eq!(of("hair.A")[i] > 0.0, is_hair, "pixel {i}");
        assert_eq!(of("hair.Z")[i].is_finite(), is_hair, "pixel {i}");
        assert_eq!(*alpha, 1.0);
    }
    assert!(hair.iter().all(|i| of("hair.strand")[*i] < 2000.0 || of("hair.groom")[*i] > 0.0));
    // The head is a quarter of a meter deep and fills the image at about a meter.
    let depths = || hair.iter().map(|i| of("hair.Z")[*i]);
    let (near, far) = depths().fold((f64::MAX, 0.0f64), |(near, far), z| (near.min(z), far.max(z)));
    assert!(near > 0.3 && far < 3.0 && far - near > 0.03 && far - near < 0.4, "{near} {far}");
    assert!(hair.iter().any(|i| of("hair.motion.X")[*i].abs() > 0.05));
    // The linear channels and the PNG agree on which pixels are brighter.
    let words = [&SHORT[..], &["64x48", "--motion", "shake", "--frames", "5", "--out", "b.##.png"]].concat();
    drawn(at, &words);
    let shown = pixels(&at.join("b.04.png")).1;
    let light: Vec<(f64, u8)> = (0..64 * 48).map(|i| (of("G")[i], shown[3 * i + 1])).collect();
    let disagree = light.windows(2).filter(|w| (w[0].0 > 1.1 * w[1].0) && w[0].1 < w[1].1).count();
    assert_eq!(disagree, 0);
    let turned = light.windows(2).filter(|w| (w[0].0 > 1.1 * w[1].0) && w[1].1 < w[0].1).count();
    assert!(turned > 100, "the comparison sees nothing: {turned}");
}

#[test]
fn transparent_background_has_zero_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words = [&SHORT[..], &["64x48", "--transparent", "--out"]].concat();
    if drawn(at, &[&words[..], &["a.png"]].concat()).is_none() {
        return;
    }
    let (kind, rgba) = pixels(&at.join("a.png"));
    assert_eq!(kind, png::ColorType::Rgba);
    let alpha = |x: usize, y: usize| rgba[4 * (64 * y + x) + 3];
    assert_eq!((alpha(1, 1), alpha(62, 1), alpha(32, 24)), (0, 0, 255));
    assert!(rgba.iter().skip(3).step_by(4).any(|alpha| (1..255).contains(alpha)), "edges are smooth");
    drawn(at, &[&words[..], &["a.exr"]].concat());
    let layers = channels(&at.join("a.exr"));
    let off =
        (0..64 * 48).map(|i| (255.0 * layers["A"][i] - f64::from(rgba[4 * i + 3])).abs()).fold(0.0, f64::max);
    assert!(off < 1.0, "{off}");
    let (done, said) = run(at, &[&words[..], &["a.gif"]].concat(), None);
    assert!(!done && said.contains("--transparent needs .png or .exr"), "{said}");
}

#[test]
fn videos_are_encoded_with_ffmpeg() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let frames = ["65x49", "--motion", "shake", "--frames", "3", "--out"];
    let words = [&SHORT[..], &frames, &["b/a.mp4"]].concat();
    let (done, said) = run(at, &words, Some("no-such-program"));
    if tresses_testing::lacks_gpu(&said) {
        return;
    }
    assert!(!done && said.contains("videos need no-such-program") && said.contains(".webp"), "{said}");
    if cfg!(unix) {
        let (done, said) = run(at, &words, Some("false"));
        assert!(!done && said.contains("false failed"), "{said}");
    }
    assert_eq!(std::fs::read_dir(at.join("b")).unwrap().count(), 0, "something is left");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        return println!("skipped: ffmpeg is not installed");
    }
    drawn(at, &[&SHORT[..], &frames, &["c/"]].concat());
    for name in ["b/a.mp4", "b/a.webm"] {
        let said = drawn(at, &[&SHORT[..], &frames, &[name]].concat()).unwrap();
        assert!(said.contains(" MB)"), "{said}");
        let raw = Command::new("ffmpeg")
            .current_dir(at)
            .args(["-loglevel", "error", "-i", name, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"])
            .output()
            .unwrap();
        let size = 66 * 50 * 3;
        assert_eq!(raw.stdout.len(), 3 * size, "{name}: {}", String::from_utf8_lossy(&raw.stderr));
        let off = |frame: usize, picture: &str| {
            let (_, still) = pixels(&at.join(picture));
            let film = &raw.stdout[frame * size..];
            let differ = (0..49 * 65).flat_map(|i| (0..3).map(move |c| (i, c))).map(|(i, c)| {
                let (x, y) = (i % 65, i / 65);
                f64::from(film[3 * (66 * y + x) + c].abs_diff(still[3 * i + c]))
            });
            differ.sum::<f64>() / (3.0 * 49.0 * 65.0)
        };
        let (same, other) = (off(2, "c/frame_0002.png"), off(2, "c/frame_0000.png"));
        assert!(same < 6.0 && same < other, "{name}: {same} {other}");
    }
}

#[test]
fn film_shows_the_strokes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // Hair is cut to the chin, taken back, and combed.
    let strokes = r#"{"version":1}
{"tool":"line","set":{"reach":"through","mirror":false},"path":[[-0.3,0.03,0],[0.3,0.03,0]]}
{"do":"undo"}
{"tool":"comb","set":{"radius":0.05,"strength":1},"samples":[[0,0.7,0.13,0,-1,0,0,1],[0.1,0.7,0.13,-0.06,-1,0,0,1]]}
"#;
    std::fs::write(at.join("s.jsonl"), strokes).unwrap();
    let groom = |more: &[&'static str]| {
        let words =
            ["groom", "--style", "long", "--strands", "300", "--strokes", "s.jsonl", "--samples", "1"];
        [&words[..], more].concat()
    };
    let (done, said) = run(at, &groom(&["--film", "a.png"]), None);
    assert!(
        !done && (tresses_testing::lacks_gpu(&said) || said.contains("a film is an animation")),
        "{said}"
    );
    let plain = groom(&["--hash", "--out", "a.groom"]);
    let Some(plain) = drawn(at, &plain) else { return };
    let film = groom(&["--hash", "--out", "b.groom", "--film", "a.###.png", "--size", "48x48"]);
    let film = drawn(at, &film).unwrap();
    let hash = |said: &str| said.lines().last().unwrap().to_owned();
    assert_eq!(hash(&plain), hash(&film), "the film shows the same hair");
    let frames: Vec<Vec<u8>> = (0..40)
        .map(|k| at.join(format!("a.{k:03}.png")))
        .take_while(|path| path.exists())
        .map(|path| pixels(&path).1)
        .collect();
    assert!(frames.len() > 30, "{film}");
    let differ = frames.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(differ > 26, "{differ} of {} frames differ from the one before", frames.len());
}
