//! Collisions between the hair of two characters.

use crate::common::{self, submit};
use tresses::{
    HairOptions, Pose, SimulationParams, Space,
    glam::{DQuat, DVec3, Vec3},
    groom::{BindOptions, GuideCount, Strands, bind},
    low_level::{Hair, HairFrame},
};

/// Final distance between the heads, meters.
const BESIDE: f32 = 0.05;
/// Half the width of the hair of each head, meters.
const HALF: f32 = 0.04;
/// Number of frames of the approach, and of the whole run.
const COMES: u32 = 60;
const FRAMES: u32 = 90;

/// Returns hair that hangs from a horizontal square.
fn block() -> Strands {
    let mut strands = Strands::default();
    for i in 0..20 * 20 {
        let at = |k: i32| HALF * ((k as f32 + 0.5) / 10.0 - 1.0);
        let root = Vec3::new(at(i % 20), 0.0, at(i / 20));
        let curve: Vec<_> = (0..12).map(|j| root - Vec3::Y * 0.2 * j as f32 / 11.0).collect();
        strands.push(&curve);
    }
    strands
}

struct Pair {
    hair: [Hair; 2],
}

impl Pair {
    fn new() -> Option<Self> {
        let context = common::context()?;
        let options =
            BindOptions { guides: GuideCount::OneIn(5), strand_vertex_count: Some(12), ..Default::default() };
        let groom = bind(&block(), &options).unwrap();
        let first = common::hair(context, &groom, &HairOptions::default(), None).unwrap();
        let second = Hair::new(first.asset()).unwrap();
        Some(Self { hair: [first, second] })
    }

    /// Moves two heads to `apart` meters from each other, with poses in `spaces`. `meet` is called before each frame to
    /// set which hair collides. Returns the final vertices of both grooms, in the first space.
    fn come(&mut self, apart: f32, spaces: [Space; 2], meet: impl Fn(&mut [Hair; 2])) -> [Vec<Vec3>; 2] {
        let physics = SimulationParams::default();
        self.hair.iter_mut().for_each(Hair::reset);
        for i in 0..FRAMES {
            let left = 1.0 - (i as f32 / COMES as f32).min(1.0);
            let left = left * left * (3.0 - 2.0 * left);
            let places = [-0.5, 0.5].map(|side| Vec3::X * side * (apart + 0.2 * left));
            let dt = if i == 0 { 0.0 } else { 1.0 / 60.0 };
            submit(|recorder| {
                meet(&mut self.hair);
                for (k, hair) in self.hair.iter_mut().enumerate() {
                    let head = Pose { translation: places[k], ..Pose::IDENTITY };
                    let head = spaces[k].pose_from(&spaces[0], &head);
                    let (space, drawn_in) = (spaces[k], Some(spaces[0]));
                    let frame =
                        HairFrame { dt, head, simulation: &physics, space, drawn_in, ..Default::default() };
                    recorder.advance(hair, &frame)?;
                }
                Ok(())
            });
        }
        self.hair.each_ref().map(common::positions)
    }
}

fn both([first, second]: &mut [Hair; 2]) {
    Hair::collide_nearby(&mut [first, second]);
}

fn alone(_: &mut [Hair; 2]) {}

/// Returns the mean position along x of the lower half of each groom, meters from the middle.
fn tips(hair: &[Vec<Vec3>; 2]) -> [f32; 2] {
    hair.each_ref().map(|all| {
        let low: Vec<_> = all.iter().filter(|p| p.y < -0.1).map(|p| p.x).collect();
        low.iter().sum::<f32>() / low.len() as f32
    })
}

#[test]
fn hair_of_two_heads_collides() {
    let Some(mut pair) = Pair::new() else { return };
    let here = [Space::WORLD; 2];
    let through = pair.come(BESIDE, here, alone);
    let beside = pair.come(BESIDE, here, both);
    let [was, is] = [&through, &beside].map(tips);
    println!("tips at {was:?} m where they pass through each other, {is:?} where they meet");
    let way = [was[0] - is[0], is[1] - was[1]];
    assert!(way[0] > 1.5e-3 && way[1] > 1.5e-3, "{way:?}");
    // Both give way equally.
    assert!((way[0] / way[1] - 1.0).abs() < 0.1, "{way:?}");

    // Hair that does not know of the other hair does not give way.
    let one = pair.come(BESIDE, here, |[first, second]| {
        second.collide_with(&[first]);
    });
    assert!(one[0] == through[0] && tips(&one)[1] > was[1] + 1.5e-3, "{one:?}");

    // If one head is in a space with other axes, the result is the same.
    let turned =
        Space { at: DVec3::new(0.5, 0.0, 0.25), rotation: DQuat::from_rotation_y(1.0), ..Space::WORLD };
    let there = pair.come(BESIDE, [Space::WORLD, turned], both);
    let [same, different] = [&there, &through].map(|other| common::apart(&beside.concat(), &other.concat()));
    println!("{} mm off in a turned space, {} mm if they had not met", 1e3 * same, 1e3 * different);
    assert!(same < 0.02 * different, "{same} {different}");
}

#[test]
fn hair_of_distant_heads_does_not_collide() {
    let Some(mut pair) = Pair::new() else { return };
    let here = [Space::WORLD; 2];
    assert!(pair.come(1.2, here, both) == pair.come(1.2, here, alone));
}
