//! Hair on skinned characters, tested through the command and the library. The characters are in the optional assets.

use crate::tresses;
use std::{
    path::{Path, PathBuf},
    process::Command,
};
use tresses::{
    Body, Gpu, Pose,
    glam::Vec3,
    groom::{TriMesh, mesh::Bvh, styles::Style},
    low_level::{Skin, Words, readback::blocking::buffer as readback},
};
use tresses_scene::{Colliders, Motion, Preset, Quality, Scene};

/// Returns the folder of the assets, if there is one.
fn assets() -> Option<PathBuf> {
    let found = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|path| path.exists());
    let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
    assert!(found.is_some() || !required, "there are no assets");
    found
}

#[test]
fn unknown_animations_and_morphs_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    for (args, why) in [
        (["--animation", "Walk"], "it has no animations; --motion has nod"),
        (["--morph", "Angry=1"], "Breath, Jaw, Brows"),
    ] {
        let (done, said) = tresses(folder.path(), &[&["render", "--strands", "50"], &args[..]].concat());
        if tresses_testing::lacks_gpu(&said) {
            return;
        }
        assert!(!done && said.contains(why), "{said}");
    }
    for weight in ["Angry", "Angry=much", "=1", "Angry=1e9"] {
        let (done, said) = tresses(folder.path(), &["render", "--morph", weight]);
        assert!(!done && said.contains("--morph"), "{weight}: {said}");
    }
}

#[test]
fn skinned_robot_renders_with_hair() {
    let Some(assets) = assets() else { return println!("skipped: TRESSES_ASSETS is not set") };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| assets.join(name).to_str().unwrap().to_owned();
    let groom = file("sintel_lite21/GEO-sintel_hair_emit.001-sintel_hair.tfx");
    let body = file("characters/RobotExpressive.glb");
    let base = ["render", &groom, "--head", &body, "--head-unit", "0.12", "--size", "96x96"];
    let take = |args: &[&str], out: &str| {
        let (done, said) = tresses(folder.path(), &[&base, args, &["--out", out]].concat());
        (done, said, std::fs::read(folder.path().join(out)).unwrap_or_default())
    };
    let (done, said, angry) = take(&["--morph", "Angry=1"], "angry.png");
    if tresses_testing::lacks_gpu(&said) {
        return;
    }
    assert!(done, "{said}");
    let (done, said, dances) = take(&["--animation", "dance", "--frames", "4"], "dance.png");
    assert!(done && dances != angry && !dances.is_empty(), "{said}");
    let (done, said, _) = take(&["--animation", "Knit"], "no.png");
    assert!(!done && said.contains("\"Knit\"; it has") && said.contains("Dance"), "{said}");
    assert!(!folder.path().join("no.png").exists());
}

/// Blender, if installed, creates the character: a third exporter besides the assets' and our own.
#[test]
#[ignore = "proof"]
fn blender_character_renders_with_hair() {
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/blender.py");
    let run = |args: &[&str]| tresses(folder.path(), args);
    let (done, said) = run(&["export", "--style", "bob", "--strands", "400", "--out", "bob.hair"]);
    assert!(done, "{said}");
    for (file, animations) in [("body.glb", &["Turn", "Nod"][..]), ("body.usdc", &["Action"])] {
        // A Python with the module `bpy`, as in `alembic.rs`, or Blender itself.
        let mut blender = match std::env::var_os("TRESSES_BPY") {
            Some(python) => {
                let mut run = Command::new(python);
                run.arg(&script);
                run
            }
            None => {
                let mut run = Command::new("blender");
                run.args(["--background", "--factory-startup", "--python"]).arg(&script).arg("--");
                run
            }
        };
        let Ok(made) = blender.arg(file).current_dir(&folder).output() else {
            return println!("skipped: Blender is not installed");
        };
        let said = String::from_utf8_lossy(&[made.stdout, made.stderr].concat()).into_owned();
        if !folder.path().join(file).exists() && said.contains("usd_export") {
            // Debian's Blender is built without USD.
            println!("skipped: Blender has no USD");
            continue;
        }
        assert!(folder.path().join(file).exists(), "{said}");
        let (done, said) = run(&["info", "bob.hair", "--head", file]);
        assert!(done && said.contains("3 joints"), "{said}");
        let whats = animations.iter().map(|name| format!("animation {name}"));
        for what in whats.chain(["blend shape Tall".into()]) {
            assert!(said.contains(&what), "{what}: {said}");
        }
        let there = ["render", "bob.hair", "--head", file, "--size", "96x96", "--frames", "6"];
        let motions = animations.iter().map(|name| ["--animation", name]).chain([["--morph", "Tall=1"]]);
        for motion in motions {
            let (done, said) = run(&[&there[..], &motion, &["--out", "a.webp"]].concat());
            assert!(done, "{said}");
        }
    }
}

/// Depth inside the body, meters, that a guide vertex may exceed for at most [`STEPS`] consecutive steps.
const DEEP: f32 = 1e-3;
const STEPS: usize = 2;

/// Simulates a style on the dancing character, or Sintel's hair on an animated character of the assets. Returns the
/// greatest depth of any guide vertex below the skin (meters), the most consecutive steps that one was deeper than
/// [`DEEP`], and the number of vertices for which these were more than [`STEPS`]. `deforms`: whether the distance
/// fields follow the skin; `grown`: offset added to every depth, meters.
fn danced(name: &str, seconds: f32, deforms: bool, grown: f32) -> Option<(f32, usize, usize)> {
    let gpu = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open()))?;
    let mut preset = Preset::default();
    preset.settings.set("style.strands", 300u32).unwrap();
    let walks = name.ends_with(".glb");
    if walks {
        let assets = assets()?;
        preset.source.grooms = vec![assets.join("sintel_lite21/GEO-sintel_hair_emit.001-sintel_hair.tfx")];
        preset.source.heads = vec![assets.join(name)];
    } else {
        preset.source.style = Some(name.to_owned());
    }
    let character = preset.character(&gpu.context, &());
    let character = pollster::block_on(character).unwrap();
    let mesh = character.head.clone().unwrap();
    let (settings, quality) = (&preset.settings, Quality::new([16, 16]));
    let scene = Scene::new(gpu, character, Colliders::default(), settings, &quality, &());
    let mut scene = pollster::block_on(scene).unwrap();
    scene.apply(settings).unwrap();
    if let Some(rig) = scene.character.rig_mut().filter(|_| walks) {
        let first = rig.animations().next().map(str::to_owned);
        rig.set_animation(first.as_deref()).unwrap();
    }
    let (motion, pivot) =
        (Motion::named(if walks { "still" } else { "dance" }).unwrap(), scene.character.neck());
    let vertices = scene.character.hair().guides.vertex_count as usize;
    // A groom made for another head may start deep inside this one.
    let reach = if walks { 0.3 } else { 0.03 };
    // Returns the depth of each vertex below the current skin.
    let depths = |scene: &Scene, body: Pose| -> Vec<f32> {
        let (context, hair) = (&scene.gpu.context, scene.character.hair());
        let at: Vec<[f32; 4]> = readback(context, &hair.guides.current).unwrap();
        let skin = scene.character.body().unwrap().vertices();
        let skin: Vec<f32> = readback(context, skin).unwrap();
        let skin = skin.chunks(Body::WORDS as usize).map(|v| body.point(Vec3::from_slice(v))).collect();
        let skin = TriMesh { positions: skin, triangles: mesh.triangles.clone(), ..TriMesh::default() };
        let bvh = Bvh::new(&skin);
        let depth = |p: &[f32; 4]| {
            let p = hair.simulation_transform().point(Vec3::new(p[0], p[1], p[2]));
            let Some(near) = bvh.closest_point_within(p, reach) else { return -1.0 };
            let [a, b, c] = skin.triangles[near.triangle as usize].map(|i| skin.positions[i as usize]);
            let out = (p - near.point).dot((b - a).cross(c - a));
            if out < 0.0 { near.distance } else { -near.distance }
        };
        // Roots are below the skin.
        at.iter().enumerate().map(|(i, p)| if i % vertices < 2 { -1.0 } else { depth(p) + grown }).collect()
    };
    scene.reset(&motion.gesture(0.0, pivot)).unwrap();
    let rest = depths(&scene, motion.gesture(0.0, pivot).body);
    let mut runs = vec![0; rest.len()];
    let (mut deepest, mut longest) = (0f32, 0);
    let mut long = std::collections::HashSet::new();
    for step in 1..=(seconds * 60.0) as u32 {
        let gesture = motion.gesture(f64::from(step) / 60.0, pivot);
        scene.advance(&gesture, 1.0 / 60.0).unwrap();
        if !deforms && scene.character.hair().colliders.deformation.is_some() {
            let vertices = scene.character.body().unwrap().vertices().clone();
            let [positions, normals] = [0, 3].map(|first| (&vertices, Words { first, stride: Body::WORDS }));
            let skin = Skin { positions, normals };
            let colliders = &mut scene.character.hair_mut().colliders;
            colliders.deform(&mesh, &skin, &[]).unwrap();
        }
        for (i, (depth, rest)) in depths(&scene, gesture.body).into_iter().zip(&rest).enumerate() {
            let depth = depth - rest.max(0.0);
            deepest = deepest.max(depth);
            runs[i] = if depth > DEEP { runs[i] + 1 } else { 0 };
            longest = longest.max(runs[i]);
            if runs[i] > STEPS {
                long.insert(i);
            }
        }
    }
    println!("{name}: {:.2} mm deep, {longest} steps, {} of {}", 1e3 * deepest, long.len(), rest.len());
    Some((deepest, longest, long.len()))
}

#[test]
fn hair_stays_out_of_a_dancing_body() {
    let Some((deepest, longest, long)) = danced("bob", 0.6, true, 0.0) else { return };
    assert!(longest <= STEPS && long == 0, "{deepest} m, {longest} steps");
    // With skin 6 mm farther out than the colliders, hair does stay inside.
    assert!(danced("bob", 0.2, true, 0.006).unwrap().1 > STEPS);
}

#[test]
#[ignore = "proof"]
fn every_style_stays_out_of_a_dancing_body_for_ten_seconds() {
    for style in Style::NAMES {
        let Some((deepest, longest, _)) = danced(style, 10.0, true, 0.0) else { return };
        assert!(longest <= STEPS, "{style}: {deepest} m, {longest} steps");
    }
    // A character of few triangles with hair that does not fit: fields that follow the skin reduce the depth.
    let [skin, joints] = [true, false].map(|deforms| danced("characters/CesiumMan.glb", 6.0, deforms, 0.0));
    if let (Some(skin), Some(joints)) = (skin, joints) {
        assert!(skin.0 < 0.8 * joints.0 && skin.2 < joints.2, "{skin:?} {joints:?}");
    }
    // With fields that follow only the joints, hair does stay inside the skin.
    assert!(danced("long", 3.0, false, 0.0).unwrap().1 > STEPS);
}
