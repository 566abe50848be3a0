use super::*;
use crate::{
    knobs::{
        self, Change, Knob, Value, ValueKind,
        light_list::{FIELDS, LightFieldKind},
    },
    settings::{LightEntry, LightKind},
};
use proptest::prelude::*;

/// Returns an allowed value of `knob`, chosen by three random numbers.
fn any_value(knob: &Knob, (share, bits, pick): (f64, u32, u8)) -> Value {
    if knob.automatic && pick < 64 {
        return Value::Auto;
    }
    match knob.kind {
        ValueKind::Number { min: least, max: most, .. } => {
            // Any float in the range, not only round ones.
            Value::Number(knob.inner(least + (most - least) * share))
        }
        ValueKind::Integer { min: least, max: most, step, .. } => {
            let count = (most - least) / step + 1;
            Value::Integer(least + bits % count * step)
        }
        ValueKind::Toggle => Value::Toggle(bits % 2 == 1),
        ValueKind::Choice(choices) => Value::Choice(choices[bits as usize % choices.len()].name),
        ValueKind::Color => Value::Color([bits as u8, (bits >> 8) as u8, (bits >> 16) as u8]),
    }
}

/// Any light of the list. Fields that its shape does not have are those of a new light.
fn any_light() -> impl Strategy<Value = LightEntry> {
    let numbers = prop::collection::vec((0.0..=1.0f64, any::<u8>(), any::<bool>()), 3 * FIELDS.len());
    (0..LightKind::ALL.len(), numbers, "[a-z ]{0,8}").prop_map(|(kind, random, name)| {
        let mut light = LightEntry::new(LightKind::ALL[kind]);
        for (field, random) in FIELDS.iter().zip(random.chunks(3)) {
            let (share, byte, on) = random[0];
            if !field.shapes.contains(&light.kind) {
                continue;
            }
            match &field.kind {
                // Any float in the range, not only round ones.
                LightFieldKind::Number { unit, min, max, field: access, .. } if on => {
                    *(access.get_mut)(&mut light) = unit.inner(min + (max - min) * share);
                }
                LightFieldKind::Position(access) => {
                    let at = [0, 1, 2].map(|i| (random[i].0 * 2000.0 - 1000.0) as f32);
                    *(access.get_mut)(&mut light) = at.into();
                }
                LightFieldKind::Color(access) => *(access.get_mut)(&mut light) = [byte, random[1].1, 7],
                LightFieldKind::Toggle(access) => *(access.get_mut)(&mut light) = on,
                LightFieldKind::Text(access) => {
                    *(access.get_mut)(&mut light) = name.split_whitespace().collect::<Vec<_>>().join(" ");
                }
                LightFieldKind::Number { .. } => {}
            }
        }
        if light.kind == LightKind::Spot {
            light.inner = light.inner.min(light.outer);
        }
        if light.kind == LightKind::Disc {
            light.hole = if light.hole < light.radius { light.hole } else { 0.0 };
        }
        light
    })
}

fn any_settings() -> impl Strategy<Value = Settings> {
    let lights = prop::collection::vec(any_light(), 0..4);
    (any_rows(), lights).prop_map(|(mut settings, list)| {
        settings.lights.list = list;
        settings
    })
}

fn any_rows() -> impl Strategy<Value = Settings> {
    let count = knobs::all().count();
    prop::collection::vec((0.0..=1.0f64, any::<u32>(), any::<u8>(), any::<bool>()), count).prop_map(
        |random| {
            let mut settings = Settings::default();
            for (knob, (share, bits, pick, turned)) in knobs::all().zip(random) {
                if turned {
                    knob.set(&mut settings, any_value(knob, (share, bits, pick))).unwrap();
                }
            }
            // Each value is valid, but the combination may not be.
            if settings.renderer(16).is_err() {
                for path in ["renderer.kind", "renderer.samples"] {
                    settings.set(path, Value::Auto).unwrap();
                }
            }
            settings
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn presets_round_trip(settings in any_settings(), all in any::<bool>()) {
        let preset = Preset { settings, ..Preset::default() };
        let text = preset.write(if all { Extent::All } else { Extent::Changed });
        let back = Preset::read(&text, "random.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
        // The comparison is exact.
        prop_assert_eq!(&back, &preset);
        prop_assert!(!back.settings.changes(&preset.settings).any());
    }

    #[test]
    fn arbitrary_text_does_not_panic(text in "(version = 1\n)?(\\[(style|source|renderer)\\]\n)?[a-z_]{0,9}( = )?[-0-9a-z.\"\\[\\]]{0,9}") {
        let _ = Preset::read(&text, "random.toml");
    }
}

#[test]
fn smallest_change_survives_round_trip() {
    let preset = Preset::default();
    let mut other = preset.clone();
    other.settings.simulation.drag = other.settings.simulation.drag.next_up();
    let back = Preset::read(&other.write(Extent::Changed), "x").unwrap();
    assert_ne!(back, preset);
    assert_eq!(back, other);
    assert!(back.settings.changes(&preset.settings).frame);
}

#[test]
fn written_preset_matches_expected_text() {
    let mut preset = Preset { name: Some("storm \"1\"".into()), ..Preset::default() };
    preset.source = PresetSource {
        grooms: vec!["a.tfx".into(), "b.tfx".into()],
        heads: vec!["head.obj".into()],
        density_map: Some("noise".into()),
        ..Default::default()
    };
    preset.source.orientation.orient.unit = "cm".parse().ok();
    preset.source.orientation.orient_head.front = "-z".parse().ok();
    preset.source.orientation.orient.is_mirrored = Some(true);
    preset.settings.set("style.curl_radius", 0.009).unwrap();
    preset.settings.wind_direction = 45f32.to_radians();
    preset.settings.set("renderer.samples", "4").unwrap();
    let text = preset.write(Extent::Changed);
    let expected = "# Settings of Tresses that differ from the defaults; `tresses knobs` lists all.
version = 1
name = 'storm \"1\"'

[source]
groom = [\"a.tfx\", \"b.tfx\"]
head = \"head.obj\"
unit = \"cm\"
head_front = \"-z\"
density_map = \"noise\"
mirror = true

[style]
curl_radius = 9 # mm

[wind]
direction = 45 # °

[renderer]
samples = 4
";
    assert_eq!(text, expected);
    assert_eq!(Preset::read(&text, "x").unwrap(), preset);
    let text =
        text.replace("curl_radius = 9 ", "curl_radius = 9.0 ").replace("samples = 4", "samples = \"4\"");
    assert_eq!(Preset::read(&text, "x").unwrap(), preset, "written otherwise");
}

#[test]
fn lights_are_written_with_plain_keys_and_units() {
    let mut preset = Preset::default();
    let spot = knobs::light_list::one(
        "spot position=0.3,1.8,0.4 target=0,1.6,0 outer=25 intensity=2 color=#ffaa66 name=Left lamp range=3 \
         casts_shadows=off",
    );
    preset.settings.lights.list = vec![spot.unwrap(), LightEntry::distant(0.0, 0.5, 3.0)];
    preset.settings.lights.list[1].elevation = 45f32.to_radians();
    preset.settings.set_wind_speed(5.0);
    preset.settings.lights.key = 0.5;
    let text = preset.write(Extent::Changed);
    let expected = "# Settings of Tresses that differ from the defaults; `tresses knobs` lists all.
version = 1

[lights]
key = 0.5 # ×

[[lights.list]]
shape = \"spot\"
name = \"Left lamp\"
position = [0.3, 1.8, 0.4] # m
target = [0, 1.6, 0] # m
outer = 25 # °
color = \"#ffaa66\"
intensity = 2
range = 3 # m
casts_shadows = false

[[lights.list]]
shape = \"distant\"
azimuth = 0 # °
elevation = 45 # °
intensity = 3

[wind]
speed = 5 # m/s
";
    assert_eq!(text, expected);
    assert_eq!(Preset::read(&text, "x").unwrap(), preset);
    let inline = "version = 1\n[lights]\nlist = [{shape = \"point\", position = [0, 1, 2]}]";
    let list = Preset::read(inline, "x").unwrap().settings.lights.list;
    assert_eq!(list, [knobs::light_list::one("point position=0,1,2").unwrap()], "an inline list");
}

/// The two lights of presets from before the list.
#[test]
fn former_lights_become_entries_of_the_list() {
    let read = |text: &str| Preset::read(&format!("version = 1\n[lights]\n{text}"), "former.toml");
    let list = |text: &str| read(text).unwrap_or_else(|error| panic!("{error}")).settings.lights.list;
    let both = "key = 0.5 # ×\nlamp1_strength = 3.5\nlamp1_azimuth = -40 # °\nlamp1_elevation = 10 # °\n\
                lamp2_strength = 1\n";
    let degrees = |azimuth: f32, elevation: f32, irradiance| {
        LightEntry::distant(azimuth.to_radians(), elevation.to_radians(), irradiance)
    };
    assert_eq!(list(both), [degrees(-40.0, 10.0, 3.5), degrees(90.0, 30.0, 1.0)]);
    assert_eq!(read(both).unwrap().settings.lights.key, 0.5);
    // Lights without strength were off.
    assert_eq!(
        list("lamp1_strength = 0\nlamp1_azimuth = 90\nlamp2_azimuth = 10\nlamp2_strength = 2"),
        [degrees(10.0, 30.0, 2.0)]
    );
    let mixed = "lamp2_strength = 2\n[[lights.list]]\nshape = \"point\"\nposition = [0, 1, 2]\n";
    assert_eq!(
        list(mixed).iter().map(|light| light.kind).collect::<Vec<_>>(),
        [LightKind::Distant, LightKind::Point]
    );
    let invalid = read("key = 1\nlamp1_strength = -3").unwrap_err().to_string();
    assert!(invalid.contains("line 4") && invalid.contains("intensity is -3"), "{invalid}");
    assert!(read("lamp1_strength = \"much\"").unwrap_err().to_string().contains("must be a number"));
    assert!(read("lamp3_strength = 1").is_err());
}

#[test]
fn invalid_lights_report_entry_and_key() {
    let with = |text: &str| {
        format!(
            "version = 1\n[[lights.list]]\nshape = \"distant\"\nazimuth = 0\nelevation = 1\n[[lights.list]]\n{text}"
        )
    };
    refuses(
        &with("shape = \"ring\""),
        Some(7),
        "light 2 of lights.list: shape is \"ring\", but must be one of distant",
    );
    refuses(&with("position = [0, 1, 2]"), Some(7), "light 2 of lights.list: shape is missing");
    refuses(
        &with("name = \"Fill\"\nshape = \"point\""),
        Some(7),
        "light 2 (Fill) of lights.list: a point light needs position",
    );
    let point = "shape = \"point\"\nposition = [0, 1, 2]\n";
    refuses(
        &with(&format!("{point}intensity = -1")),
        Some(9),
        "intensity is -1, but must be from 0 to 1000000",
    );
    refuses(&with(&format!("{point}intensity = nan")), Some(9), "intensity is NaN");
    refuses(&with(&format!("{point}radius = 1")), Some(9), "a point light has no radius");
    refuses(&with(&format!("{point}colour = \"#ffffff\"")), Some(9), "the nearest is color");
    refuses(
        &with("shape = \"point\"\nposition = [0, 1]"),
        Some(8),
        "position is [0, 1], but must be three numbers",
    );
    refuses(&with("shape = \"point\"\nposition = [0, 1, \"a\"]"), Some(8), "position is a list");
    refuses(&with("shape = 3"), Some(7), "shape is 3");
    refuses("version = 1\n[lights]\nlist = 3", Some(3), "must be tables [[lights.list]]");
    refuses("version = 1\n[lights]\nlist = [3]", Some(3), "light 1 of lights.list is 3, not a table");
    let mut preset = Preset::default();
    preset.settings.lights.list = vec![LightEntry { intensity: f32::NAN, ..Default::default() }];
    let error = preset.settings.check().unwrap_err().to_string();
    assert!(error.starts_with("light 1 of lights.list: intensity is"), "{error}");
}

#[track_caller]
fn refuses(text: &str, line: Option<usize>, clause: &str) {
    let error = Preset::read(text, "bad.toml").unwrap_err();
    let sentence = error.to_string();
    assert_eq!(error.line, line, "{sentence}");
    assert!(sentence.contains(clause), "{sentence}");
    assert!(sentence.starts_with("bad.toml") && !sentence.contains('\n'), "{sentence}");
}

#[test]
fn invalid_presets_report_line_and_key() {
    let with = |text: &str| format!("version = 1\n\n{text}");
    refuses("", Some(1), "version = 1");
    refuses("version = 2", Some(1), "the version is 2, but this program reads version 1");
    refuses("version = \"1\"", Some(1), "\"1\"");
    refuses("version = ", Some(1), "bad.toml at line 1");
    refuses("{\"json\": 1}", Some(1), "");
    refuses(
        &with("[simulation]\ndrag = 3\ndrga = 5"),
        Some(5),
        "there is no simulation.drga; the nearest is simulation.drag, from 0 to 100 1/s",
    );
    refuses(&with("[simulation]\nfrizz = 5"), Some(4), "the nearest is style.frizz, from 0 to 20 mm");
    refuses(&with("[simulaton]\ndrag = 5"), Some(3), "the nearest is [simulation]");
    refuses(&with("drag = 5"), Some(3), "drag must be in its table [simulation]");
    refuses(&with("nmae = 5"), Some(3), "the nearest is name");
    refuses(&with("wind = 5"), Some(3), "wind must be a table, [wind]");
    refuses(&with("[wind]\nspeed = 500 # m/s"), Some(4), "wind.speed is 500, but must be from 0 to 100 m/s");
    refuses(&with("[wind]\nspeed = nan"), Some(4), "wind.speed is nan");
    refuses(&with("[wind]\nspeed = -1e300"), Some(4), "wind.speed is -1e300");
    refuses(&with("[wind]\nspeed = \"fast\""), Some(4), "wind.speed is \"fast\"");
    refuses(&with("[wind]\nspeed = \"auto\""), Some(4), "wind.speed is \"auto\"");
    refuses(&with("[wind]\ncells = 33"), Some(4), "a multiple of 8");
    refuses(&with("[wind]\nseed = -1"), Some(4), "a whole number from 0 to 9999");
    refuses(&with("[shading]\ncolor = \"green\""), Some(4), "one of file, skin, blond, brown");
    refuses(&with("[shading]\nsrgb = \"#12345\""), Some(4), "a color such as #5a3b28");
    refuses(&with("[renderer]\nsamples = 3"), Some(4), "one of auto, 1, 4, 8, 16");
    refuses(&with("[renderer]\nkind = \"classic\"\nsamples = 4"), None, "depth peeling");
    refuses(&with("[edges]\ncoverage = \"peel\""), Some(4), "use renderer.kind");
    refuses(&with("[shadows]\nmethod = \"off\""), Some(4), "use shadows.enabled");
    refuses(&with("[renderer]\nsamples = [4]"), Some(4), "renderer.samples is a list");
    refuses(&with("[lod]\nmode = true"), Some(4), "lod.mode is true");
    refuses(&with("[source]\nstyle = \"beehive\""), Some(4), "long, bob, curly or short");
    refuses(&with("[source]\nstlye = \"long\""), Some(4), "the nearest is source.style");
    refuses(&with("[source]\nstyle = \"long\"\ngroom = \"a.tfx\""), Some(4), "give one of them");
    refuses(&with("[source]\ngroom = 3"), Some(4), "a file or a list of files");
    refuses(&with("[source]\nup = \"w\""), Some(4), "x, y, z");
    refuses(&with("[source]\nup = \"y\"\nfront = \"-y\""), Some(4), "right angle");
    refuses(&with("[source]\nmirror = 3"), Some(4), "true or false");
    refuses(&with("[wind]\nspeed = 5\nspeed = 6"), Some(5), "duplicate key");
}

#[test]
fn file_names_are_relative_to_the_preset() {
    let folder = std::env::temp_dir().join(format!("tresses-preset-{}", std::process::id()));
    let path = folder.join("deep/storm.toml");
    let preset = Preset {
        source: PresetSource { grooms: vec![folder.join("a.tfx")], ..Default::default() },
        ..Preset::default()
    };
    preset.save(&path, Extent::All).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let back = Preset::open(&path);
    std::fs::write(&path, [0xff, 0xfe]).unwrap();
    let broken = Preset::open(&path).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(text.contains("groom = \"../a.tfx\""), "{text}");
    assert_eq!(back.unwrap().source.grooms, [folder.join("deep").join("../a.tfx")]);
    assert!(broken.contains("storm.toml") && broken.contains("UTF-8"), "{broken}");
    let missing = Preset::open(&path).unwrap_err();
    assert!(missing.to_string().contains("storm.toml"), "{missing}");
    assert_eq!(missing.source.unwrap().kind(), std::io::ErrorKind::NotFound);
}

#[test]
fn shipped_presets_parse() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../presets");
    let mut count = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let preset = Preset::open(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(preset.name.as_deref(), path.file_stem().and_then(|name| name.to_str()));
        assert!(preset.settings.changes(&Settings::default()).any());
        assert!(preset.source.style.is_some(), "it can be shown without other files");
        count += 1;
    }
    assert!(count >= 3);
}

/// Presets from before parameters were renamed.
#[test]
fn presets_with_former_names_open() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for file in std::fs::read_dir(root.join("src/preset/former")).unwrap() {
        let path = file.unwrap().path();
        let former = Preset::open(&path).unwrap_or_else(|error| panic!("{error}"));
        let current = Preset::open(&root.join("../../presets").join(path.file_name().unwrap())).unwrap();
        assert_eq!(former.settings, current.settings, "{}", path.display());
        count += 1;
    }
    assert_eq!(count, 5);
    let text = "version = 1\n[lights]\nturn = 20\nenvironment_turn = -90\n[wind]\nroom = 3\n[simulation]\n\
                cohesion_reach = 1.2\n[lod]\nalone_pixel = 2\n";
    let settings = Preset::read(text, "former.toml").unwrap().settings;
    assert_eq!(settings.lights.rotation, 20f32.to_radians());
    assert_eq!(settings.lights.environment_rotation, -90f32.to_radians());
    assert_eq!(settings.simulation.wind.grid_size, 3.0);
    assert_eq!(settings.simulation.hair_hair.cohesion_distance, 0.012);
    assert_eq!(settings.lod.collision_pixel, 0.002);
}

#[test]
fn changes_report_their_cost() {
    let before = Settings::default();
    let turned = |path: &str, value| {
        let mut settings = before.clone();
        knobs::find(path).unwrap().set(&mut settings, value).unwrap();
        settings.changes(&before)
    };
    let frame = turned("simulation.drag", Value::Number(5.0));
    assert!(frame.frame && !frame.regrow && !frame.rebuild);
    assert!(turned("style.frizz", Value::Number(0.001)).regrow);
    assert!(turned("shadows.resolution", Value::Integer(512)).rebuild);
    assert!(!before.changes(&before).any());
    assert!(Change::Frame < Change::Regrow && Change::Regrow < Change::Rebuild);
}
