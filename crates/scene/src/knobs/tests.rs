use super::*;
use crate::companion_files::Maps;

/// Returns both ends of a knob's range, or all values of a choice.
fn ends(knob: &Knob) -> Vec<Value> {
    let mut values = match knob.kind {
        ValueKind::Number { min: least, max: most, .. } => {
            vec![Value::Number(knob.inner(least)), Value::Number(knob.inner(most))]
        }
        ValueKind::Integer { min: least, max: most, .. } => vec![Value::Integer(least), Value::Integer(most)],
        ValueKind::Toggle => vec![Value::Toggle(false), Value::Toggle(true)],
        ValueKind::Choice(choices) => choices.iter().map(|choice| Value::Choice(choice.name)).collect(),
        ValueKind::Color => vec![Value::Color([0; 3]), Value::Color([255; 3])],
    };
    values.extend(knob.automatic.then_some(Value::Auto));
    values
}

/// Returns invalid values.
fn wrong(knob: &Knob) -> Vec<Value> {
    let mut values = match knob.kind {
        ValueKind::Number { min: least, max: most, .. } => {
            let over = 1e-3 * (most - least);
            vec![
                Value::Number(knob.inner(least - over)),
                Value::Number(knob.inner(most + over)),
                Value::Number(f32::NAN),
                Value::Number(f32::INFINITY),
                Value::Integer(1),
            ]
        }
        ValueKind::Integer { max: most, step, .. } => {
            let mut values = vec![Value::Integer(most + step), Value::Number(1.0)];
            values.extend((step > 1).then_some(Value::Integer(step + 1)));
            values
        }
        _ => vec![Value::Choice("nonsense"), Value::Number(0.0)],
    };
    values.extend((!knob.automatic).then_some(Value::Auto));
    values
}

#[test]
fn range_ends_are_valid() {
    for knob in all() {
        for value in ends(knob) {
            let mut settings = Settings::default();
            knob.set(&mut settings, value).unwrap();
            assert_eq!(knob.get(&settings), value, "{}", knob.path);
            settings.check().unwrap_or_else(|error| panic!("{} {value:?}: {error}", knob.path));
        }
    }
}

#[test]
fn out_of_range_values_fail_without_effect() {
    for knob in all() {
        for value in wrong(knob) {
            let mut settings = Settings::default();
            let refusal = knob.set(&mut settings, value).unwrap_err().to_string();
            assert!(refusal.starts_with(knob.path) && !refusal.contains('\n'), "{refusal}");
            assert_eq!(settings, Settings::default(), "{}", knob.path);
            // `check` also catches values that bypass `set`.
            if let (ValueKind::Number { .. }, Value::Number(_))
            | (ValueKind::Integer { .. }, Value::Integer(_)) = (knob.kind, value)
            {
                knob.put(&mut settings, value);
                assert!(settings.check().is_err(), "{} {value:?}", knob.path);
            }
        }
    }
}

#[test]
fn ranges_stay_within_library_limits() {
    let mut limited = 0;
    for knob in all() {
        let ValueKind::Number { min: least, max: most, .. } = knob.kind else { continue };
        for end in [least, most] {
            let mut settings = Settings::default();
            knob.put(&mut settings, Value::Number(knob.inner(end)));
            settings.check_library().unwrap_or_else(|error| panic!("{} {end}: {error}", knob.path));
        }
        let mut settings = Settings::default();
        knob.put(&mut settings, Value::Number(f32::NAN));
        limited += usize::from(settings.check_library().is_err());
    }
    // The library checks physics, strand collision, growth and level of detail.
    assert!(limited > 40, "{limited}");
}

#[test]
fn names_are_well_formed() {
    let mut seen = std::collections::HashSet::new();
    for section in SECTIONS {
        for knob in section.knobs {
            assert!(seen.insert(knob.path), "{} twice", knob.path);
            assert_eq!(knob.section(), section.key);
            let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
            assert!(!knob.key().is_empty() && knob.key().chars().all(fits), "{}", knob.path);
            assert!(!knob.label.is_empty() && knob.hint.ends_with('.'), "{}", knob.path);
            assert!(!knob.hint.contains(['\n', '|']) && knob.hint.chars().count() < 110, "{}", knob.path);
            assert!(knob.check(knob.default()).is_ok(), "{}", knob.path);
        }
    }
    assert!(find("simulation.drag").is_some() && find("simulation").is_none());
}

#[test]
fn each_knob_sets_its_own_field() {
    let all: Vec<_> = all().collect();
    for knob in &all {
        let other = ends(knob).into_iter().find(|value| *value != knob.default()).unwrap();
        let mut settings = Settings::default();
        knob.set(&mut settings, other).unwrap();
        let turned: Vec<_> =
            all.iter().filter(|knob| !knob.is_default(&settings)).map(|knob| knob.path).collect();
        assert_eq!(turned, [knob.path]);
        assert!(settings.changes(&Settings::default()).any());
        knob.reset(&mut settings);
        assert_eq!(settings, Settings::default());
    }
}

#[test]
fn automatic_values_resolve() {
    use tresses::groom::styles::Style;
    for name in Style::NAMES {
        let style: Style = name.parse().unwrap();
        let resolved = Settings::default().resolved(Some(&style));
        for knob in all() {
            assert_ne!(knob.get(&resolved), Value::Auto, "{name} {}", knob.path);
        }
        // Resolved settings grow the same hair.
        let maps = Maps::default();
        let (auto, fixed) =
            (Settings::default().growth(&style, &maps).unwrap(), resolved.growth(&style, &maps).unwrap());
        assert_eq!(auto.clumps, fixed.clumps, "{name}");
        assert_eq!(auto.variation, fixed.variation, "{name}");
        assert_eq!((auto.curls.any(), auto.seed), (fixed.curls.any(), fixed.seed), "{name}");
    }
    let file = Settings::default().resolved(None);
    assert_eq!(find("style.width").unwrap().get(&file), Value::Auto, "as the file has it");
    assert_eq!(find("shading.diffuse").unwrap().get(&file), Value::Number(file.material().diffuse));
}

#[test]
fn values_format_and_parse_with_units() {
    let radius = find("style.curl_radius").unwrap();
    assert_eq!(radius.text(Value::Number(0.009)), "9 mm");
    assert_eq!(radius.parse("9 mm"), Ok(Value::Number(0.009)));
    assert_eq!(radius.parse("auto"), Ok(Value::Auto));
    assert_eq!(radius.parse("0.9 cm"), Ok(Value::Number(0.009)), "any unit of length");
    let refusal = radius.parse("19 cm").unwrap_err().to_string();
    assert_eq!(refusal, "style.curl_radius is 19 cm, but must be from 0 to 100 mm, or auto");
    let width = find("style.width").unwrap();
    assert_eq!(width.parse("80um"), width.parse("80 µm"));
    assert_eq!(find("wind.direction").unwrap().text(Value::Number(45f32.to_radians())), "45°");
    let srgb = find("shading.srgb").unwrap();
    assert_eq!(srgb.text(srgb.default()), "#5a3b28");
    assert!(srgb.parse("5a3b2").is_err() && srgb.parse("+a3b28").is_err());
    assert!(find("renderer.samples").unwrap().parse("3").is_err());
    assert!(find("wind.cells").unwrap().parse("33").is_err());
    for knob in all() {
        for value in ends(knob) {
            assert_eq!(knob.parse(&knob.text(value)), Ok(value), "{}", knob.path);
        }
    }
}

#[test]
fn knobs_md_is_current() {
    let page = include_str!("../../../../docs/reference/parameters.md");
    assert!(
        page == markdown(),
        "write docs/reference/parameters.md anew: tresses knobs --markdown > docs/reference/parameters.md"
    );
}

/// Parses `text` with the flag of the row at `path` and lists the parameters it changes.
fn flagged(path: &str, text: &str) -> Result<Vec<String>, String> {
    let assigned = find(path).unwrap().read_flag(text)?;
    let mut settings = Settings::default();
    assigned.reset(&mut settings);
    assigned.set(&mut settings).map_err(|refusal| refusal.to_string())?;
    let turned = all().filter(|knob| !knob.is_default(&settings));
    Ok(turned.map(|knob| format!("{}={}", knob.key(), knob.text(knob.get(&settings)))).collect())
}

#[test]
fn flags_set_their_rows() {
    for (path, text, turned) in [
        ("wind.gusts", "0.5", &["gusts=50%"][..]),
        ("wind.gusts", "50%", &["gusts=50%"]),
        ("style.width", "90um", &["width=90 µm"]),
        ("style.width", "0.09mm", &["width=90 µm"]),
        ("style.frizz", "0.3", &["frizz=0.3 mm"]),
        ("style.strays", "0.6,4mm", &["strays=60%", "stray_distance=4 mm"]),
        ("style.strays", "0.3", &["strays=30%"]),
        ("style.curl", "waves", &["curl=waves"]),
        ("style.clump", "0.5", &["clump=50%"]),
        ("style.guides", "all", &["all_guides=true"]),
        ("style.guides", "12", &["guides=12"]),
        ("shading.color", "red", &["color=red"]),
        ("shading.color", "FF8000", &["color=srgb", "srgb=#ff8000"]),
        ("shading.eumelanin", "2", &["color=melanin", "eumelanin=2", "pheomelanin=0"]),
        ("shading.roughness_along", "0.2", &["roughness_along=0.2", "roughness_around=0.2"]),
        ("wind.speed", "8,90", &["speed=8 m/s", "direction=90°"]),
        ("lod.mode", "0.25", &["mode=fraction", "fraction=25%"]),
        ("lod.mode", "off", &["mode=off"]),
        ("shadows.ambient", "off", &["ambient=false"]),
        ("lights.environment_rotation", "-90", &["environment_rotation=-90°"]),
    ] {
        assert_eq!(flagged(path, text).unwrap(), turned, "{path} {text}");
    }
}

#[test]
fn flags_reject_invalid_values() {
    for (path, texts) in [
        ("wind.speed", &["", "fast", "-1", "8,", "101", "8,north", "nan", "1,2,3"][..]),
        ("wind.gusts", &["1.5", "-0.1", "150%"]),
        ("style.curl", &["", "spirals", "radius=8mm", "waves,coils", "waves,"]),
        ("style.clump", &["", "2", "0.5,", "spacing=2mm"]),
        ("style.strays", &["", "1.5", "0.2,", "0.2,4miles", "-0.1", "0.5,1m"]),
        ("style.width", &["8cm", "1um", "1cm2"]),
        ("style.guides", &["0", "none", "-3"]),
        ("shading.color", &["", "green", "12345", "+12345", "1234567"]),
        ("shading.eumelanin", &["", "-1", "1,2,3", "nan", "200", "a,b"]),
        ("shading.roughness_along", &["", "0", "1.1", "0.3,", "inf"]),
        ("lod.mode", &["", "on", "0", "1.5", "NaN", "-1"]),
        ("renderer.samples", &["3", "0"]),
    ] {
        for text in texts {
            let clause = find(path).unwrap().read_flag(text).unwrap_err();
            assert!(!clause.is_empty() && !clause.contains('\n'), "{path} {text}: {clause}");
        }
    }
}

#[test]
fn flags_are_unique_and_name_existing_rows() {
    let mut seen = std::collections::HashSet::new();
    for knob in all().filter(|knob| knob.flag.is_some()) {
        assert!(seen.insert(knob.flag.unwrap().name), "{} twice", knob.flag.unwrap().name);
        for path in knob.flag_paths() {
            assert!(find(path).is_some(), "{}: there is no {path}", knob.path);
        }
        let (flag, help) = (knob.flag.unwrap(), knob.flag_help());
        assert_eq!(help.is_empty(), flag.value.is_empty(), "{}", knob.path);
    }
    assert!(seen.len() > 35, "{}", seen.len());
}

#[test]
fn names_of_other_programs_suggest_the_parameter() {
    let suggests = |path: &str, found: &str| {
        let said = named(path).unwrap_err();
        assert!(said.contains(&format!("is {found},")), "{path}: {said}");
    };
    suggests("simulation.air_drag", "simulation.drag");
    suggests("Radial-Roughness", "shading.roughness_around");
    suggests("kink amplitude", "style.curl_radius");
    for knob in all().filter(|knob| !knob.aliases.is_empty()) {
        for alias in knob.aliases.split("; ") {
            assert!(!alias.trim().is_empty() && alias == alias.to_lowercase(), "{}: {alias:?}", knob.path);
            assert_ne!(alias, knob.key().replace('_', " "), "{}", knob.path);
        }
    }
}
