//! Self-collision in a shaken style: the volume that its strands fill.
//!
//! `make proof` prints the table of `docs/validation/motion.md`.

use crate::common::{self, DrapedCharacter};

use std::collections::HashMap;
use tresses::{
    HairHair, HairHairMode, HairOptions, Pose, SimulationParams,
    glam::IVec3,
    groom::styles::Style,
    low_level::{Hair, HairFrame, readback::blocking as readback, unpack_velocity},
};

/// Edge of the voxels in which strands are counted, meters.
const VOXEL: f32 = 0.01;

fn hair(character: &DrapedCharacter) -> Hair {
    let context = common::context().expect("there is a GPU");
    common::hair(context, &character.groom, &HairOptions::default(), Some(&character.field)).unwrap()
}

/// Returns the meters of drawn hair in every voxel, in head space.
fn voxels(hair: &Hair, head: &Pose) -> HashMap<IVec3, f32> {
    let back = head.inverse();
    let mut voxels = HashMap::new();
    for strand in common::positions(hair).chunks(hair.strands.vertex_count as usize) {
        for pair in strand.windows(2) {
            let (a, b) = (back.point(pair[0]), back.point(pair[1]));
            let length = a.distance(b);
            let parts = (length / 0.002).ceil().max(1.0);
            for i in 0..parts as u32 {
                let p = a.lerp(b, (i as f32 + 0.5) / parts);
                *voxels.entry((p / VOXEL).floor().as_ivec3()).or_default() += length / parts;
            }
        }
    }
    voxels
}

/// Returns the number of voxels that hold hair: at least a twentieth of the mean over the voxels of the rest pose.
fn occupied(voxels: &HashMap<IVec3, f32>, mean: f32) -> f32 {
    voxels.values().filter(|meters| **meters > 0.05 * mean).count() as f32
}

/// Returns the occupied volume relative to rest: the mean over the last second of the shake, and over the second that
/// follows.
fn volumes(character: &DrapedCharacter, hair_hair: HairHair) -> (f32, f32) {
    let simulation = SimulationParams { hair_hair, ..Default::default() };
    let mut hair = hair(character);
    let pose = |t: f32| common::shaken(t, character.neck);
    let frame = |t, dt| HairFrame { simulation: &simulation, ..common::frame(pose(t), dt) };
    common::advance(&mut hair, &frame(0.0, 0.0));
    let rest = voxels(&hair, &pose(0.0));
    let mean = rest.values().sum::<f32>() / rest.len() as f32;
    let full = occupied(&rest, mean);
    // A style that lacks every tenth voxel is detected.
    let most = rest.iter().filter(|(c, _)| (c.x + 7 * c.y + 3 * c.z).rem_euclid(10) != 0);
    let thinner = occupied(&most.map(|(c, m)| (*c, *m)).collect(), mean) / full;
    assert!((0.85..0.95).contains(&thinner), "{thinner}");
    let mut sums = [(0.0, 0); 2];
    for i in 1..=240 {
        let t = i as f32 / 60.0;
        common::advance(&mut hair, &frame(t, 1.0 / 60.0));
        if t > common::SHAKE - 1.0 && i % 6 == 0 {
            let sum = &mut sums[usize::from(t > common::SHAKE)];
            sum.0 += occupied(&voxels(&hair, &pose(t)), mean) / full;
            sum.1 += 1;
        }
    }
    let [during, after] = sums.map(|(sum, count)| sum / count as f32);
    (during, after)
}

#[test]
#[ignore = "proof"]
fn shaken_style_keeps_its_volume() {
    let Some(character) = common::character("long", 3000) else { return };
    let gradient = HairHair::default();
    let fixed = HairHair { mode: HairHairMode::Fixed, ..gradient };
    println!("Volume of the long style in 1 cm voxels, of that at rest:");
    println!("| hair-hair | last second of a 3 s shake | second after |");
    println!("|---|---|---|");
    let rows =
        [("off", HairHair::OFF), ("fixed magnitude", fixed), ("gradient", gradient)].map(|(name, mode)| {
            let (during, after) = volumes(&character, mode);
            println!("| {name} | {:.0} % | {:.0} % |", 100.0 * during, 100.0 * after);
            (during, after)
        });
    let [off, fixed, gradient] = rows;
    assert!((gradient.1 - 1.0).abs() < 0.1);
    assert!((gradient.1 - 1.0).abs() < 0.7 * (off.1 - 1.0).abs() && gradient.0 < off.0);
    assert!((gradient.1 - 1.0).abs() < 0.7 * (fixed.1 - 1.0).abs());
}

/// Returns the mean and the largest speed of guide vertices, m/s, and the largest distance from rest, meters, after two
/// seconds at rest.
fn unrest(character: &DrapedCharacter, hair_hair: HairHair) -> (f32, f32, f32) {
    let simulation = SimulationParams { hair_hair, ..Default::default() };
    let frame = |dt| HairFrame { dt, simulation: &simulation, ..Default::default() };
    let mut hair = hair(character);
    common::advance(&mut hair, &frame(0.0));
    let rest = common::guides(&hair);
    for _ in 0..120 {
        common::advance(&mut hair, &frame(1.0 / 60.0));
    }
    let context = common::context().expect("there is a GPU");
    let velocities: Vec<[u32; 2]> = readback::buffer(context, &hair.guides.velocity).unwrap();
    let speeds: Vec<_> = velocities.iter().map(|v| unpack_velocity(*v).length()).collect();
    let moved = common::apart(&common::guides(&hair), &rest);
    (speeds.iter().sum::<f32>() / speeds.len() as f32, speeds.iter().copied().fold(0.0, f32::max), moved)
}

#[test]
fn resting_style_is_still_and_not_inflated() {
    at_rest(&["short"]);
}

#[test]
#[ignore = "proof"]
fn resting_styles_are_still_and_not_inflated() {
    at_rest(&Style::NAMES);
}

fn at_rest(styles: &[&str]) {
    for style in styles {
        // Few strands suffice, because only guides are measured.
        let Some(character) = common::character(style, 200) else { return };
        let [off, on] = [HairHair::OFF, HairHair::default()].map(|mode| unrest(&character, mode));
        println!(
            "{style}: mean {:.2e} m/s, largest {:.2e} m/s, {:.2} mm from rest; off: {:.2e}, {:.2e}, {:.2}",
            on.0,
            on.1,
            on.2 * 1e3,
            off.0,
            off.1,
            off.2 * 1e3
        );
        // No more motion than without self-collision, where the style itself settles.
        assert!(on.0 < off.0 + 2e-4 && on.1 < off.1 + 2e-3, "{style}");
        assert!(on.2 < off.2 + 1e-3, "{style}");
    }
}
