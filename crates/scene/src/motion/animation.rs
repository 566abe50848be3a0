//! Exports motions as rig animations, for files that other programs open.

use super::{Motion, NAMES};
use tresses::{
    CharacterParts,
    glam::{Quat, Vec3},
    groom::{
        mannequin,
        rig::{Animation, Channel, Curve, Property, Rig},
    },
};

/// Keys per second.
const RATE: f64 = 60.0;

/// Returns the rig of the body of `parts`. The built-in character gets the built-in motions as animations.
pub fn rig_of(parts: &CharacterParts, built_in: bool) -> Option<Rig> {
    let mut rig = parts.anatomy.as_ref()?.rig.clone();
    if built_in {
        rig.animations = built_in_animations(&rig);
    }
    Some(rig)
}

/// Returns the built-in motions, except standing still, as animations of `rig`, the rig of the built-in character.
/// Rotations between keys follow the shortest arc.
pub(crate) fn built_in_animations(rig: &Rig) -> Vec<Animation> {
    let moves = NAMES.iter().filter(|name| **name != "still");
    moves.filter_map(|name| Some(animation(name, &Motion::named(name)?, rig))).collect()
}

fn animation(name: &str, motion: &Motion, rig: &Rig) -> Animation {
    let keys = (motion.duration() * RATE).round().max(1.0) as u32;
    let times: Vec<f64> = (0..=keys).map(|i| motion.duration() * f64::from(i) / f64::from(keys)).collect();
    let gestures: Vec<_> = times.iter().map(|time| motion.gesture(*time, mannequin::NECK_JOINT)).collect();
    let channel = |node: u32, property: Property, values: Vec<f32>| {
        let times = times.iter().map(|time| *time as f32).collect();
        Channel { node, property, curve: Curve { times, values, ..Curve::default() } }
    };
    let rotation = |node: u32, rotation_at: &dyn Fn(usize) -> Quat| {
        let values = (0..gestures.len()).flat_map(|i| rotation_at(i).to_array()).collect();
        channel(node, Property::Rotation, values)
    };
    let (_, root_position): (_, Vec3) = mannequin::rig::JOINTS[0];
    let root_positions =
        gestures.iter().flat_map(|gesture| gesture.body.point(root_position).to_array()).collect();
    let mut channels =
        vec![channel(0, Property::Translation, root_positions), rotation(0, &|i| gestures[i].body.rotation)];
    for (node, fraction) in mannequin::rig::ROTATION_WEIGHTS {
        // Rest rotations are identity and all shares of one turn have the same axis, so each is relative to its parent.
        channels.push(rotation(node, &|i| Quat::IDENTITY.slerp(gestures[i].head.rotation, fraction)));
    }
    let targets: Vec<u32> = motion.shapes().filter_map(|shape| Some(rig.target(shape)? as u32)).collect();
    if !targets.is_empty() {
        let weight = |target: &u32, i: usize| gestures[i].shape(&rig.targets[*target as usize].name);
        let weights = (0..gestures.len()).flat_map(|i| targets.iter().map(move |target| weight(target, i)));
        channels.push(channel(0, Property::Weights(targets.clone()), weights.collect()));
    }
    let mut name = name.to_string();
    name[..1].make_ascii_uppercase();
    Animation { name, length: motion.duration() as f32, channels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::Pose;

    #[test]
    fn animation_matches_motion() {
        let mesh = mannequin::mesh(50);
        let rig = mannequin::rig::rig(&mesh);
        let all = built_in_animations(&rig);
        assert_eq!(
            all.iter().map(|a| a.name.as_str()).collect::<Vec<_>>(),
            ["Nod", "Turn", "Shake", "Walk", "Dance"]
        );
        for (animation, name) in all.iter().zip(["nod", "turn", "shake", "walk", "dance"]) {
            let motion = Motion::named(name).unwrap();
            for time in [0.25, 0.9, 1.45] {
                let gesture = motion.gesture(time, mannequin::NECK_JOINT);
                let share =
                    |(node, share): (u32, f32)| (node, Quat::IDENTITY.slerp(gesture.head.rotation, share));
                let turned = rig.pose_with_rotations(None, &[], &mannequin::rig::ROTATION_WEIGHTS.map(share));
                let played = rig.pose(animation, time as f32);
                for p in [mannequin::NOSE_TIP, mannequin::CROWN] {
                    let here = gesture.body.point(turned.palette[2].transform_point3(p));
                    let there = played.palette[2].transform_point3(p);
                    assert!(here.distance(there) < 3e-4, "{name} at {time}: {here} {there}");
                }
                for (weight, target) in played.weights.iter().zip(&rig.targets) {
                    assert!((weight - gesture.shape(&target.name)).abs() < 0.01, "{name}: {}", target.name);
                }
            }
            assert_eq!(
                motion.gesture(0.0, mannequin::NECK_JOINT).head,
                Pose::IDENTITY.after(&motion.gesture(motion.duration(), mannequin::NECK_JOINT).head)
            );
        }
    }
}
