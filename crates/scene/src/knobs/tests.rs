use super::*;
use crate::settings::Maps;

/// Both ends of a knob's range, or all its values where it has few.
fn ends(knob: &Knob) -> Vec<Value> {
    let mut values = match knob.kind {
        Kind::Number { least, most, .. } => {
            vec![Value::Number(knob.inner(least)), Value::Number(knob.inner(most))]
        }
        Kind::Integer { least, most, .. } => vec![Value::Integer(least), Value::Integer(most)],
        Kind::Toggle => vec![Value::Toggle(false), Value::Toggle(true)],
        Kind::Choice(names) => names.iter().map(|name| Value::Choice(name)).collect(),
        Kind::Color => vec![Value::Color([0; 3]), Value::Color([255; 3])],
    };
    values.extend(knob.automatic.then_some(Value::Auto));
    values
}

/// Values that are not allowed.
fn wrong(knob: &Knob) -> Vec<Value> {
    let mut values = match knob.kind {
        Kind::Number { least, most, .. } => {
            let over = 1e-3 * (most - least);
            vec![
                Value::Number(knob.inner(least - over)),
                Value::Number(knob.inner(most + over)),
                Value::Number(f32::NAN),
                Value::Number(f32::INFINITY),
                Value::Integer(1),
            ]
        }
        Kind::Integer { most, step, .. } => {
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
fn both_ends_of_every_range_make_sense() {
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
fn what_is_beyond_is_refused_and_changes_nothing() {
    for knob in all() {
        for value in wrong(knob) {
            let mut settings = Settings::default();
            let refusal = knob.set(&mut settings, value).unwrap_err().to_string();
            assert!(refusal.starts_with(knob.path) && !refusal.contains('\n'), "{refusal}");
            assert_eq!(settings, Settings::default(), "{}", knob.path);
            // Whoever writes the field himself is told as well.
            if !matches!(value, Value::Choice(_)) {
                (knob.set)(&mut settings, value);
            }
            if settings != Settings::default() {
                assert!(settings.check().is_err(), "{} {value:?}", knob.path);
            }
        }
    }
}

#[test]
fn what_the_library_refuses_no_range_allows() {
    let mut limited = 0;
    for knob in all() {
        let Kind::Number { least, most, .. } = knob.kind else { continue };
        for end in [least, most] {
            let mut settings = Settings::default();
            (knob.set)(&mut settings, Value::Number(knob.inner(end)));
            settings.check_library().unwrap_or_else(|error| panic!("{} {end}: {error}", knob.path));
        }
        let mut settings = Settings::default();
        (knob.set)(&mut settings, Value::Number(f32::NAN));
        limited += usize::from(settings.check_library().is_err());
    }
    // The library checks physics, avoidance, growth and level of detail.
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
fn every_knob_turns_something_of_its_own() {
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
        // What is resolved grows the same hair.
        let maps = Maps::default();
        let (auto, fixed) = (
            Settings::default().style.growth(&style, &maps).unwrap(),
            resolved.style.growth(&style, &maps).unwrap(),
        );
        assert_eq!(auto.clumps, fixed.clumps, "{name}");
        assert_eq!(auto.unrest, fixed.unrest, "{name}");
        assert_eq!((auto.curls.any(), auto.seed), (fixed.curls.any(), fixed.seed), "{name}");
    }
    let file = Settings::default().resolved(None);
    assert_eq!(find("style.width").unwrap().get(&file), Value::Auto, "as the file has it");
    assert_eq!(find("shading.diffuse").unwrap().get(&file), Value::Number(file.look.material().diffuse));
}

#[test]
fn values_are_written_as_people_read_them() {
    let radius = find("style.curl_radius").unwrap();
    assert_eq!(radius.text(Value::Number(0.009)), "9 mm");
    assert_eq!(radius.parse("9 mm"), Ok(Value::Number(0.009)));
    assert_eq!(radius.parse("auto"), Ok(Value::Auto));
    let refusal = radius.parse("9 cm").unwrap_err().to_string();
    assert_eq!(refusal, "style.curl_radius is 9 cm, but must be from 0 to 100 mm, or auto");
    let width = find("style.width").unwrap();
    assert_eq!(width.parse("80um"), width.parse("80 µm"));
    assert_eq!(find("wind.direction").unwrap().text(Value::Number(45f32.to_radians())), "45°");
    let srgb = find("shading.srgb").unwrap();
    assert_eq!(srgb.text(srgb.default()), "#5a3b28");
    assert!(srgb.parse("5a3b2").is_err() && srgb.parse("+a3b28").is_err());
    assert!(find("edges.samples").unwrap().parse("3").is_err());
    assert!(find("wind.cells").unwrap().parse("33").is_err());
    for knob in all() {
        for value in ends(knob) {
            assert_eq!(knob.parse(&knob.text(value)), Ok(value), "{}", knob.path);
        }
    }
}

#[test]
fn the_documentation_is_current() {
    let page = include_str!("../../../../docs/knobs.md");
    assert!(page == markdown(), "write docs/knobs.md anew: tresses knobs --markdown > docs/knobs.md");
    assert!(page != markdown().replacen("from 0", "from 1", 1), "a change would be seen");
}
