//! `tresses export` as a process.

use crate::{drawn, tresses};

#[test]
fn export_writes_drawn_strands_and_head() {
    let folder = tempfile::tempdir().unwrap();
    let style = ["export", "--style", "short", "--strands", "300"];
    let write = [&style[..], &["--out", "short.hair", "--head-out", "head.obj"]].concat();
    let Some((done, said)) = drawn(folder.path(), &write) else { return };
    assert!(done && said.contains("300 strands") && said.contains("triangles"), "{said}");
    let (done, said) = tresses(folder.path(), &["info", "short.hair", "--head", "head.obj", "--json"]);
    assert!(done, "{said}");
    let found: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(found["strands"], 300, "{said}");
    // The file states its unit and axes, so nothing is guessed, and the hair fits the head.
    assert_eq!(found["groom_placement"]["meters_per_unit"], 1.0, "{said}");
    let (done, said) = tresses(
        folder.path(),
        &["render", "short.hair", "--head", "head.obj", "--size", "32x32", "--out", "a.png"],
    );
    assert!(done, "{said}");
}

#[test]
fn export_writes_the_rig_of_the_character() {
    let folder = tempfile::tempdir().unwrap();
    let style = ["export", "--style", "short", "--strands", "100"];
    let write = [&style[..], &["--out", "short.hair", "--head-out", "body.glb"]].concat();
    let Some((done, said)) = drawn(folder.path(), &write) else { return };
    assert!(done && said.contains("3 joints, 3 blend shapes, 5 animations"), "{said}");
    let (done, said) = tresses(folder.path(), &["info", "short.hair", "--head", "body.glb"]);
    assert!(done && said.contains("3 joints") && said.contains("animation Walk,"), "{said}");
    assert!(said.contains("blend shape Jaw"), "{said}");
    // The exported character moves like an imported one.
    let there = ["render", "short.hair", "--head", "body.glb", "--size", "48x48", "--frames", "2"];
    let moves = ["--animation", "Dance", "--morph", "Jaw=0.5", "--out", "a.webp"];
    let (done, said) = tresses(folder.path(), &[&there[..], &moves].concat());
    assert!(done, "{said}");
    let (done, said) = tresses(folder.path(), &[&there[..], &["--animation", "Fly"]].concat());
    assert!(!done && said.contains("Nod, Turn, Shake, Walk, Dance"), "{said}");
}

#[test]
fn one_file_contains_body_and_hair() {
    let folder = tempfile::tempdir().unwrap();
    let style = ["export", "--style", "short", "--strands", "100", "--color", "red"];
    let Some((done, said)) = drawn(folder.path(), &[&style[..], &["--out", "all.glb"]].concat()) else {
        return;
    };
    assert!(done && said.contains("100 strands") && said.contains("a body of"), "{said}");
    let (done, said) = tresses(folder.path(), &["convert", "all.glb", "--packed", "small.glb"]);
    assert!(done && said.contains("with its body of"), "{said}");
    for file in ["all.glb", "small.glb"] {
        let (done, said) = tresses(folder.path(), &["info", file]);
        assert!(
            done && said.contains("3 joints") && said.contains("1 unit is 1 m: stated by the file"),
            "{said}"
        );
        assert!(said.contains("melanin 0.12, 1.5"), "{said}");
    }
    // The file has all required properties of the schema, and no others.
    let bytes = std::fs::read(folder.path().join("all.glb")).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let schema = include_str!("../../../../docs/reference/schema/EXT_tresses_hair.schema.json");
    let schema: serde_json::Value = serde_json::from_str(schema).unwrap();
    let groom = &json["extensions"]["EXT_tresses_hair"]["grooms"][0];
    let material = &schema["$defs"]["groom"]["properties"]["material"]["properties"];
    let written = groom["material"].as_object().unwrap();
    assert!(written.len() == 6 && written.keys().all(|key| material.get(key).is_some()), "{written:?}");
    for (of, written) in [("groom", groom), ("strands", &groom["strands"])] {
        let (known, required) = (&schema["$defs"][of]["properties"], &schema["$defs"][of]["required"]);
        for key in written.as_object().unwrap().keys() {
            assert!(known.get(key).is_some(), "{of} has {key}");
        }
        let missing =
            required.as_array().unwrap().iter().find(|key| written.get(key.as_str().unwrap()).is_none());
        assert_eq!(missing, None, "{of}");
    }
    let moves = ["--animation", "Walk", "--size", "48x48", "--frames", "2", "--out", "a.webp"];
    let (done, said) = tresses(folder.path(), &[&["render", "small.glb"][..], &moves].concat());
    assert!(done, "{said}");
    let (done, said) = tresses(folder.path(), &["convert", "all.glb", "--packed", "a.hair"]);
    assert!(!done && said.contains("remove --packed"), "{said}");
}

#[test]
fn usd_contains_body_hair_and_skeleton() {
    let folder = tempfile::tempdir().unwrap();
    let style = ["export", "--style", "short", "--strands", "100"];
    let write = [&style[..], &["--out", "all.usdc", "--head-out", "body.usda"]].concat();
    let Some((done, said)) = drawn(folder.path(), &write) else { return };
    assert!(
        done && said.contains("a body of") && said.contains("3 joints, 3 blend shapes, 5 animations"),
        "{said}"
    );
    for args in [&["info", "all.usdc"][..], &["info", "all.usdc", "--head", "body.usda"]] {
        let (done, said) = tresses(folder.path(), args);
        assert!(done && said.contains("3 joints") && said.contains("animation Walk,"), "{said}");
        assert!(
            said.contains("blend shape Jaw") && said.contains("follow the joints of a skeleton"),
            "{said}"
        );
    }
    let moves = ["--animation", "Walk", "--size", "48x48", "--frames", "2", "--out", "a.webp"];
    let (done, said) = tresses(folder.path(), &[&["render", "all.usdc"][..], &moves].concat());
    assert!(done, "{said}");
}

#[test]
fn invalid_exports_are_errors_of_one_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.tfx"), "none").unwrap();
    for (args, why) in [
        (&["--out", "a.fbx"][..], "a groom can be written as"),
        (&["--out", "a.tfx", "--head-out", "a.dae"], "a head can be written as .obj"),
        (&["bad.tfx", "--out", "a.tfx"], "bad.tfx"),
        (&["--strands", "0", "--out", "a.tfx"], "--strands"),
    ] {
        let (done, said) = tresses(folder.path(), &[&["export"], args].concat());
        assert!(!done && said.contains(why) && said.trim_end().lines().count() == 1, "{args:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
}

#[test]
fn export_writes_interpolated_strands() {
    let folder = tempfile::tempdir().unwrap();
    let groom = |header: &str| {
        let mut text = format!("version 2.0\nscale 1.0\n{header}\nnumStrands 40\n");
        for i in 0..40 {
            let (x, z) = (0.01 * (i % 8) as f32 - 0.035, 0.01 * (i / 8) as f32);
            text += &format!("strand {i} numVerts 3 texcoord 0 0\n{x} 1.7 {z}\n{x} 1.75 {z}\n{x} 1.8 {z}\n");
        }
        text
    };
    let asking = groom("numFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 0.002");
    std::fs::write(folder.path().join("a.tfx"), asking).unwrap();
    std::fs::write(folder.path().join("b.tfx"), groom("numFollowHairsPerGuideHair some")).unwrap();
    let (done, said) = tresses(folder.path(), &["info", "a.tfx", "--unit", "m"]);
    assert!(done && said.contains("4 around each strand within 2.00 mm: 200 strands are drawn"), "{said}");
    let (_, said) = tresses(folder.path(), &["info", "a.tfx", "--json"]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&said).unwrap()["with_followers"], 200, "{said}");
    for (more, strands) in [(&[][..], 200), (&["--grow", "0"], 40), (&["--grow", "700"], 700)] {
        let args = [&["export", "a.tfx", "--unit", "m", "--out", "out.hair"], more].concat();
        let (done, said) = tresses(folder.path(), &args);
        assert!(done && said.contains(&format!("{strands} strands")), "{more:?}: {said}");
    }
    for (file, grow, why) in [
        ("a.tfx", "1000000000", "a whole number from 0 to 4000000"),
        ("a.tfx", "-1", "a whole number from 0 to 4000000"),
        ("b.tfx", "9", "should be a count, but is “some”"),
    ] {
        let (done, said) = tresses(folder.path(), &["export", file, "--grow", grow, "--out", "none.hair"]);
        assert!(!done && said.contains(why) && said.trim_end().lines().count() == 1, "{grow}: {said}");
    }
    assert!(!folder.path().join("none.hair").exists());
}

#[test]
fn cards_are_written_and_refused_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let hair = ["cards", "--style", "short", "--strands", "300", "--texture", "256"];
    let bake =
        [&hair[..], &["--levels", "12,4", "--out", "hair.glb", "--report", "new/report.json"]].concat();
    let Some((done, said)) = drawn(folder.path(), &bake) else { return };
    assert!(done && said.contains("soft IoU") && said.contains("256 × 256"), "{said}");
    let report = std::fs::read(folder.path().join("new/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!((&report["strands"], &report["levels"][1]["cards"]), (&300.into(), &4.into()));
    // The file is a character for every other command: it has the body and its joints.
    let (done, said) =
        tresses(folder.path(), &["export", "--style", "bob", "--strands", "50", "--out", "bob.hair"]);
    assert!(done, "{said}");
    let (done, said) = tresses(folder.path(), &["info", "bob.hair", "--head", "hair.glb"]);
    assert!(done && said.contains("3 joints") && said.contains("animation Walk,"), "{said}");
    let (done, said) =
        tresses(folder.path(), &[&hair[..], &["--levels", "8", "--ktx2", "--out", "low.obj"]].concat());
    let textures = ["color", "surface", "anisotropy", "data"];
    let textures = textures.iter().flat_map(|name| ["png", "ktx2"].map(|end| format!("low_{name}.{end}")));
    let mut names = ["low_LOD0.obj", "low.mtl"].map(String::from).into_iter().chain(textures);
    assert!(done && names.all(|name| folder.path().join(name).exists()), "{said}");
    let (done, said) =
        tresses(folder.path(), &[&hair[..], &["--levels", "8,3", "--split", "--out", "a.glb"]].concat());
    assert!(done && said.contains("a_LOD0.glb") && said.contains("a_LOD1.glb"), "{said}");
    let render =
        ["render", "--style", "bob", "--strands", "500", "--cards", "20", "--size", "64x64", "--out"];
    let (done, said) = tresses(folder.path(), &[&render[..], &["cards.png"]].concat());
    assert!(done && folder.path().join("cards.png").exists(), "{said}");
    for (wrong, reason) in
        [(&["a.exr"][..], "choose .png"), (&["a.png", "--debug", "guides"], "remove --cards")]
    {
        let (done, said) = tresses(folder.path(), &[&render[..], wrong].concat());
        assert!(!done && said.contains(reason), "{said}");
    }
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    for (wrong, reason) in [
        (["--levels", "4,8", "--out", "a.glb"], "falling"),
        (["--texture", "300", "--out", "a.glb"], "a power of two"),
        (["--levels", "40", "--out", "a.fbx"], ".glb or .obj"),
        (["--textures", "0", "--out", "a.glb"], "from 1 to 1024"),
        (["--report", "a.glb", "--out", "a.glb"], "the same file"),
    ] {
        let wrong: Vec<&str> = hair[..5].iter().copied().chain(wrong).collect();
        let (done, said) = tresses(folder.path(), &wrong);
        assert!(!done && said.contains(reason) && said.trim().lines().count() == 1, "{wrong:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before);
}
