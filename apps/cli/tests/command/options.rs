//! The command as a process: invalid use exits with code 1 and one sentence, and writes nothing.

use crate::{command, output, stderr};
use std::process::Output;

#[track_caller]
fn refuses(arguments: &[&str], clause: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = output(folder.path(), arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert!(message.starts_with("tresses: ") && message.contains(clause), "{arguments:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{arguments:?}: {message}");
    assert!(output.stdout.is_empty());
    let written = std::fs::read_dir(folder.path()).expect("the folder is there").count();
    assert_eq!(written, 0, "{arguments:?} wrote something");
}

#[test]
fn out_of_range_options_are_errors() {
    refuses(&["render", "--size", "0x0"], "16 to 16384 pixels");
    refuses(&["render", "--size", "big"], "as in 1280x720");
    refuses(&["render", "--size", "16000x16000"], "at most 33,177,600 (7680x4320)");
    refuses(&["render", "--frames", "0"], "--frames");
    refuses(&["render", "--frames", "-3"], "-3");
    refuses(&["render", "--fps", "0"], "from 1 to 1000");
    refuses(&["render", "--zoom", "nearer"], "close, normal, far");
    refuses(&["render", "--out", "hair.avi"], ".webp");
    refuses(&["bench", "--frames", "0"], "--frames");
    refuses(&["render", "--debug", "guides", "--debug-max", "0"], "above 0");
    refuses(&["render", "--debug-max", "2"], "--debug");
    refuses(&["render", "--debug", "push", "--hair-hair", "off"], "--hair-hair is off");
    refuses(&["render", "--debug", "wind"], "there is no wind");
    refuses(&["render", "--ties", "nowhere.json"], "nowhere.json");
    refuses(&["completions", "tcsh"], "bash, elvish, fish");
    refuses(&["render", "--density-map", "top"], "front, crown, sides");
    refuses(&["render", "--color-map", "hair.png", "--color", "red"], "--color");
    refuses(&["render", "--wind", "storm"], "from 0 to 100 m/s");
}

#[test]
fn invalid_presets_and_parameters_are_errors() {
    refuses(&["render", "--preset", "nowhere.toml"], "nowhere.toml");
    refuses(&["bench", "--preset", "nowhere.toml"], "nowhere.toml");
    refuses(&["demo", "--set", "wind.speed=900"], "from 0 to 100 m/s");
    refuses(&["render", "--set", "wind.sped=3"], "the nearest is wind.speed");
    refuses(&["render", "--renderer", "classic", "--samples", "4"], "depth peeling");
    refuses(&["render", "--environment-rotation", "20"], "--environment");
    refuses(&["preset", "--save-preset", "mine.png"], ".toml");
    refuses(&["knobs", "beehive"], "without a word");
}

#[test]
fn presets_round_trip() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let print = |arguments: &[&str]| {
        let output = output(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    let text = print(&["preset", "--style", "bob", "--wind", "8,45", "--frizz", "1mm"]);
    for line in ["style = \"bob\"", "frizz = 1 # mm", "speed = 8 # m/s", "direction = 45 # °"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    std::fs::write(folder.path().join("mine.toml"), &text).expect("written");
    assert_eq!(print(&["preset", "--preset", "mine.toml"]), text);
    let other = print(&["preset", "--preset", "mine.toml", "--wind", "0", "--set", "simulation.drag=5"]);
    assert!(!other.contains("speed") && other.contains("drag = 5 # 1/s") && other.contains("frizz = 1"));
    std::fs::write(folder.path().join("mine.toml"), text.replace("frizz", "fritz")).expect("written");
    let output = output(folder.path(), &["render", "--preset", "mine.toml"]);
    let message = stderr(&output);
    assert!(
        message.contains("mine.toml at line 8: there is no style.fritz; the nearest is style.frizz"),
        "{message}"
    );
    assert!(print(&["knobs", "gust"]).contains("wind.gusts = 20%"));
}

#[test]
fn unknown_names_list_the_choices() {
    refuses(&["render", "--camera", "top"], "front, three-quarter, side, back");
    refuses(&["render", "--debug", "all"], "guides, speed, strain, locks, strands, tangents, first-hit");
    refuses(&["render", "--hair-hair", "sticky"], "off, fixed, gradient");
    refuses(&["render", "--avoid", "some"], "off, vertices, strands");
    refuses(&["render", "--motion", "fly"], "still, nod, turn, shake, walk, dance");
    refuses(&["render", "--beard", "goatee"], "none, stubble, short, full");
    refuses(&["render", "--color", "green"], "blond, brown, red");
    refuses(&["render", "--style", "beehive"], "long, bob, curly or short");
    refuses(&["demo", "--style", "beehive"], "long, bob, curly or short");
    refuses(&["fly"], "fly");
    refuses(&["render", "--fly"], "--fly");
    refuses(&["rendr"], "did you mean render?");
    refuses(&["render", "--styl", "bob"], "did you mean --style?");
}

#[test]
fn crowd_rejects_unsupported_options() {
    for heads in ["0", "100000", "many"] {
        refuses(&["render", "--crowd", heads], "--crowd");
    }
    refuses(&["render", "--crowd", "5", "--zoom", "close"], "--zoom");
    refuses(&["render", "--crowd", "5", "--debug", "guides"], "--debug");
    refuses(&["render", "--crowd-mb", "5"], "--crowd");
    for budget in ["--crowd-ms", "--crowd-mb"] {
        for absurd in ["0", "NaN", "inf", "much", "-5"] {
            refuses(&["render", "--crowd", "5", budget, absurd], if absurd == "-5" { "-5" } else { budget });
        }
    }
}

#[test]
fn missing_files_are_named() {
    refuses(&["render", "nowhere.tfx"], "nowhere.tfx");
    refuses(&["render", "--motion", "nowhere.json"], "nowhere.json");
    refuses(&["render", "--length-map", "nowhere.png"], "nowhere.png");
    refuses(&["render", "--curl-curve", "nowhere.obj"], "nowhere.obj");
    refuses(&["render", "--head", "nowhere.obj"], "nowhere.obj");
}

#[test]
fn help_and_version_exit_with_success() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for arguments in [&["--help"][..], &["render", "--help"], &["--version"], &[]] {
        let output = output(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    }
    let help = String::from_utf8(output(folder.path(), &["--help"]).stdout).expect("help is UTF-8");
    for command in ["render", "demo", "bench"] {
        assert!(help.contains(command), "{help}");
    }
}

/// Whether the command found a GPU adapter.
fn has_gpu(output: &Output) -> bool {
    !tresses_testing::lacks_gpu(&stderr(output))
}

#[test]
fn output_path_selects_the_format() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let small = ["render", "--style", "short", "--size", "64x40", "--samples", "1", "--strands", "500"];
    let render =
        |out: &str, more: &[&str]| output(folder.path(), &[&small[..], &["--out", out], more].concat());
    let output = render("new/one.png", &[]);
    if !has_gpu(&output) {
        return;
    }
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("new/one.png"));
    let png = std::fs::read(folder.path().join("new/one.png")).expect("the picture is there");
    assert_eq!(&png[16..24], &[0, 0, 0, 64, 0, 0, 0, 40]);

    // The library tests that all views differ.
    let output = render("inside.png", &["--debug", "density"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let inside = std::fs::read(folder.path().join("inside.png")).expect("the picture is there");
    assert_ne!(png, inside, "the debug view is drawn");

    let output = render("frames", &["--motion", "turn", "--frames", "3"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let frame = |i: u32| std::fs::read(folder.path().join(format!("frames/frame_{i:04}.png"))).ok();
    assert!(frame(0).is_some() && frame(2).is_some() && frame(3).is_none());
    assert_ne!(frame(0), frame(2), "the head turns");

    let output = render("loop.webp", &["--motion", "nod", "--frames", "4"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let webp = std::fs::read(folder.path().join("loop.webp")).expect("the animation is there");
    assert_eq!((&webp[..4], &webp[8..12]), (&b"RIFF"[..], &b"WEBP"[..]));
}

/// Returns the two numbers of the line that starts with `title`: the actual value and the budget.
fn asked(text: &str, title: &str) -> Option<[f64; 2]> {
    let line = text.lines().find_map(|line| line.strip_prefix(title))?;
    let mut numbers = line.split_whitespace().filter_map(|word| word.parse().ok());
    Some([numbers.next()?, numbers.next()?])
}

#[test]
#[ignore = "proof"]
fn crowd_keeps_its_budget_or_reports_why_not() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let small = ["render", "--style", "short", "--size", "640x400", "--samples", "1", "--strands", "3000"];
    let crowd = |more: &[&str]| {
        let output = output(folder.path(), &[&small[..], &["--crowd", "3", "--out", "c.png"], more].concat());
        has_gpu(&output).then(|| {
            assert!(output.status.success(), "{more:?}: {}", stderr(&output));
            String::from_utf8(output.stdout).expect("UTF-8")
        })
    };
    const MEMORY: &str = "Memory of hair and its lighting:";
    let Some(plenty) = crowd(&["--crowd-mb", "100000"]) else { return };
    let [all, _] = asked(&plenty, MEMORY).expect(&plenty);
    assert!(plenty.contains("bias 0.00") && all > 1.0, "{plenty}");
    // The memory used is close to the budget, and not above it.
    let wanted = 0.8 * all;
    let text = crowd(&["--crowd-mb", &wanted.to_string()]).expect("there was a GPU just now");
    let [held, of] = asked(&text, MEMORY).expect(&text);
    assert!((of - wanted).abs() < 0.06 && held < 1.05 * wanted && held > 0.6 * wanted, "{text}");
    assert!(!text.contains("exceed") && !text.contains("bias 0.00"), "{text}");
    let text = crowd(&["--crowd-mb", "0.1"]).expect("there was a GPU just now");
    assert!(text.contains("the coarsest levels, which exceed the budget"), "{text}");
    // Only the estimated time is tested: real frame times depend on other programs.
    let text = crowd(&["--crowd-ms", "1e-3"]).expect("there was a GPU just now");
    assert!(text.contains("bias 6.00") && text.contains("exceed the budget"), "{text}");
    let [least, _] = asked(&text, "Time:").expect(&text);
    let text = crowd(&["--crowd-ms", &format!("{}", 20.0 * least)]).expect("there was a GPU just now");
    let [expected, of] = asked(&text, "Time:").expect(&text);
    assert!(expected <= of && text.contains(" ms expected, budget "), "{text}");
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_at_once_without_partial_files() {
    use std::time::{Duration, Instant};
    // A busy machine may start the command slowly; the command itself needs some hundredths of a second.
    const MOST: Duration = Duration::from_secs(3);
    let small = ["render", "--style", "short", "--size", "64x40", "--samples", "1", "--strands", "500"];
    let long = ["--motion", "turn", "--frames", "100000", "--out"];
    // During preparation and while drawing. An animation is written at the end, a frame once it is drawn.
    for (moment, drawing, out) in [
        (Duration::from_millis(600), false, "out/loop.webp"),
        (Duration::from_millis(1500), false, "out/loop.webp"),
        (Duration::from_millis(200), true, "out/loop.webp"),
        (Duration::from_millis(1100), true, "out"),
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut child = command(folder.path(), &[&small[..], &long, &[out]].concat())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("the binary runs");
        // The folder is created when drawing begins.
        let written = folder.path().join("out");
        while drawing && !written.exists() {
            if child.try_wait().expect("the child can be asked").is_some() {
                let output = child.wait_with_output().expect("the child has ended");
                assert!(!has_gpu(&output), "it ended before it drew: {}", stderr(&output));
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(moment);
        if child.try_wait().expect("the child can be asked").is_some() {
            let output = child.wait_with_output().expect("the child has ended");
            assert!(!has_gpu(&output), "it ended by itself: {}", stderr(&output));
            return;
        }
        let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(killed.expect("kill is there").success());
        let asked = Instant::now();
        let output = child.wait_with_output().expect("the child ends");
        assert!(asked.elapsed() < MOST, "{moment:?}, {out}: {:?}", asked.elapsed());
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert_eq!(stderr(&output).trim(), "tresses: interrupted");
        let files =
            std::fs::read_dir(written).map(|all| all.flatten().collect::<Vec<_>>()).unwrap_or_default();
        for file in files {
            let name = file.file_name().to_string_lossy().into_owned();
            assert!(name.starts_with("frame_") && name.ends_with(".png"), "{name}");
            let bytes = std::fs::read(file.path()).expect("the frame can be read");
            assert!(bytes.ends_with(b"IEND\xaeB`\x82"), "{name} is not whole");
        }
    }
}
