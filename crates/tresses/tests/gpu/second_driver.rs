//! An image and a motion on another software driver: SwiftShader, which comes with Chromium.
//!
//! A process loads the drivers that it finds when it starts. This test therefore runs its own binary again, with the
//! other driver in the environment, and compares the results.

use crate::{
    common, golden,
    moving::{Character, SHAKE, advance_at, angle, drawn},
};
use std::{
    path::{Path, PathBuf},
    process::Command,
};
use tresses::{
    AvoidMode, AvoidOptions, Context,
    glam::Vec3,
    groom::bind,
    light::{FiberMaterial, HairMaterial},
    renderer::ShadingModel,
};

/// Environment variable with the folder for the results of the run on the other driver.
const INTO: &str = "TRESSES_SECOND_DRIVER_INTO";

/// An image of hair on a ball, and strands while a ball is shaken, every sixth of 36 frames.
#[derive(PartialEq)]
struct DriverOutput {
    picture: Vec<u8>,
    motion: Vec<Vec<Vec3>>,
}

fn make(context: &Context) -> DriverOutput {
    let picture = golden::picture(context, ShadingModel::Fiber, brown());
    let groom = bind(&common::hanging(200, 16, 0.16), &Default::default()).unwrap();
    let character = Character::new(groom, common::ball(0.09, 48), Vec3::new(0.0, 0.0, -0.02));
    let mut hair = character.avoiding(AvoidOptions::default());
    let mut motion = Vec::new();
    for i in 0..=36u32 {
        let head = character.head(angle(SHAKE, i as f32 / 60.0));
        advance_at(&mut hair, head, i, 60.0);
        if i % 6 == 0 {
            let vertices = drawn(&mut hair, head, AvoidMode::ChangeOver);
            motion.push(vertices.iter().map(|v| v.position).collect());
        }
    }
    DriverOutput { picture, motion }
}

fn brown() -> HairMaterial {
    HairMaterial::brown()
}

/// Brown hair with a third more pigment.
fn darker() -> FiberMaterial {
    let fiber = brown().fiber;
    let [root_absorption, tip_absorption] = [fiber.root_absorption, fiber.tip_absorption].map(|a| a * 1.33);
    FiberMaterial { root_absorption, tip_absorption, ..fiber }
}

/// Writes the results of a run: adapter name, image, vertices.
fn write(folder: &Path, context: &Context, made: &DriverOutput) {
    std::fs::write(folder.join("adapter"), context.device().adapter_info().name).unwrap();
    std::fs::write(folder.join("picture"), &made.picture).unwrap();
    let vertices: Vec<Vec3> = made.motion.iter().flatten().copied().collect();
    std::fs::write(folder.join("motion"), bytemuck::cast_slice::<Vec3, u8>(&vertices)).unwrap();
}

fn read(folder: &Path, like: &DriverOutput) -> (String, DriverOutput) {
    let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
    let vertices: Vec<Vec3> = bytemuck::pod_collect_to_vec(&bytes("motion"));
    let motion = vertices.chunks(like.motion[0].len()).map(<[Vec3]>::to_vec).collect();
    (String::from_utf8(bytes("adapter")).unwrap(), DriverOutput { picture: bytes("picture"), motion })
}

/// Returns the mean distance of vertices in the worst frame, meters.
fn apart(a: &[Vec<Vec3>], b: &[Vec<Vec3>]) -> f32 {
    assert_eq!(a.len(), b.len());
    let mean = |a: &[Vec3], b: &[Vec3]| {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f32>() / a.len() as f32
    };
    a.iter().zip(b).map(|(a, b)| mean(a, b)).fold(0.0, f32::max)
}

/// Returns SwiftShader's driver description from one of the folders in which browsers are installed.
fn swiftshader() -> Option<PathBuf> {
    let folders = [
        "/usr/lib/chromium",
        "/usr/lib/chromium-browser",
        "/usr/lib64/chromium-browser",
        "/opt/google/chrome",
    ];
    let folder = folders.map(PathBuf::from).into_iter().find(|folder| folder.is_dir())?;
    let description = folder.join("vk_swiftshader_icd.json");
    assert!(description.is_file(), "{} has no vk_swiftshader_icd.json", folder.display());
    Some(description)
}

#[test]
fn swiftshader_draws_and_moves_the_same() {
    let Some(context) = common::context() else { return };
    let made = make(context);
    if let Some(folder) = std::env::var_os(INTO) {
        return write(Path::new(&folder), context, &made);
    }
    if !cfg!(target_os = "linux") {
        return println!("skipped: a process chooses its Vulkan driver on Linux alone");
    }
    let Some(driver) = swiftshader() else {
        return println!("skipped: no Chromium, which brings SwiftShader");
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("second-driver");
    // Results of an earlier run; there may be none.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "second_driver::swiftshader_draws_and_moves_the_same", "--nocapture"])
        .env(INTO, &folder)
        .env("VK_DRIVER_FILES", &driver)
        .env("VK_ICD_FILENAMES", &driver)
        .env_remove("TRESSES_SKIP")
        .env("WGPU_BACKEND", "vulkan")
        .env_remove("WGPU_ADAPTER_NAME")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (adapter, other) = read(&folder, &made);
    assert!(
        adapter.contains("SwiftShader") && adapter != context.device().adapter_info().name,
        "{adapter}, {}",
        context.device().adapter_info().name
    );

    let (mean, high) = golden::difference(&made.picture, &other.picture);
    let moved = apart(&made.motion, &other.motion);
    println!(
        "{adapter} and {}: pictures {mean:.3} / 255, 99 of 100 within {high}, vertices {:.4} mm",
        context.device().adapter_info().name,
        1e3 * moved
    );
    // Positions may differ by less than a hair's width.
    let alike = |mean: f64| mean < golden::DRIVER_DIFFERENCE;
    assert!(alike(mean) && moved < 1e-4, "{mean} {moved}");
    // Another image and another moment are detected.
    let darker = HairMaterial { fiber: darker(), ..brown() };
    let (mean, high) =
        golden::difference(&golden::picture(context, ShadingModel::Fiber, darker), &other.picture);
    println!("a picture of hair with a third more pigment: {mean:.3} / 255, 99 of 100 within {high}");
    assert!(!alike(mean), "{mean}");
    assert!(apart(&made.motion[1..], &other.motion[..other.motion.len() - 1]) > 1e-3);
}
