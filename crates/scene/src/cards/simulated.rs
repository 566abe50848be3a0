//! Motion of the bones of cards, simulated in the animations of the body.

use crate::{Scene, motion::Motion};
use anyhow::{Context, Result};
use tresses::{
    Gesture,
    glam::Vec3,
    groom::{
        Rig,
        cards::{CardChains, ChainMotion},
        rig::{Animation, RigPose},
    },
};

/// Keys per second.
const RATE: f64 = 30.0;
/// Frames of the simulation for each key.
const FRAMES: u32 = 2;
/// Largest distance between first and last pose of a loop, meters.
const SAME: f32 = 0.005;
/// Time in which hair settles in the first pose of an animation that is no loop, seconds.
const SETTLE: f64 = 2.0;
/// Longest time over which the end of a loop blends to its start, seconds.
const BLEND: f64 = 0.5;

/// An animation of the body in a scene.
#[derive(Clone, Copy, Debug)]
pub struct CardClip<'a> {
    /// Rig of the body, with its animations.
    pub rig: &'a Rig,
    /// Index of the animation.
    pub animation: usize,
    /// Whether the body is the built-in character, whose animations are the built-in motions.
    pub built_in: bool,
}

/// Simulates the hair of `scene` in an animation, and returns the motion of the chains. A loop is played twice, and the
/// end of the second time blends into its start. Blocks.
///
/// # Errors
/// Fails if the body does not have the animation, and if the GPU is lost.
pub fn simulate(scene: &mut Scene, chains: &CardChains, clip: CardClip<'_>) -> Result<ChainMotion> {
    let animation = &clip.rig.animations[clip.animation];
    let keys = (f64::from(animation.length) * RATE).round().max(1.0) as usize;
    let second = f64::from(animation.length) / keys as f64;
    let motion = match clip.built_in {
        true => Some(Motion::open(&animation.name.to_lowercase())?),
        false => {
            let rig = scene.character.rig_mut().context("the body has no rig")?;
            rig.set_animation(Some(&animation.name))?;
            None
        }
    };
    let mut player = Player { scene, chains, motion, second };
    player.scene.reset(&player.gesture(0.0))?;
    let mut before = Vec::new();
    if is_loop(clip.rig, animation) {
        before = player.played(keys)?;
    } else {
        for _ in 0..(SETTLE / second) as usize {
            player.scene.character.seek(0.0);
            player.scene.advance(&player.gesture(0.0), second as f32)?;
        }
        player.scene.character.seek(0.0);
    }
    let mut joints = player.played(keys)?;
    // The end of the first time leads to the start of the second one.
    let blend = ((BLEND / second) as usize).min(keys / 2).max(1);
    for (key, old) in before.iter().enumerate().skip(keys - blend) {
        let weight = (key + blend - keys) as f32 / blend as f32;
        joints[key].iter_mut().zip(old).for_each(|(now, old)| *now = now.lerp(*old, weight));
    }
    let times = (0..=keys).map(|key| (key as f64 * second) as f32).collect();
    Ok(ChainMotion { animation: clip.animation, times, joints })
}

/// Returns whether the last pose of `animation` is the first one.
fn is_loop(rig: &Rig, animation: &Animation) -> bool {
    let [first, last] = [0.0, animation.length * 0.9999].map(|time| rig.pose(animation, time));
    let at =
        |pose: &RigPose, node: usize| rig.to_groom.transform_point3(pose.globals[node].w_axis.truncate());
    (0..rig.nodes.len()).all(|node| at(&first, node).distance(at(&last, node)) < SAME)
}

/// A scene that plays an animation.
struct Player<'a> {
    scene: &'a mut Scene,
    chains: &'a CardChains,
    motion: Option<Motion>,
    /// Time between two keys, seconds.
    second: f64,
}

impl Player<'_> {
    fn gesture(&self, time: f64) -> Gesture {
        let neck = self.scene.character.neck();
        self.motion.as_ref().map_or_else(Gesture::default, |motion| motion.gesture(time, neck))
    }

    /// Plays the animation from its start to its end, and returns where the chains are at each key.
    fn played(&mut self, keys: usize) -> Result<Vec<Vec<Vec3>>> {
        let mut joints = Vec::new();
        for key in 0..=keys {
            joints.push(self.joints()?);
            for frame in (1..=FRAMES).filter(|_| key < keys) {
                let time = (key as f64 + f64::from(frame) / f64::from(FRAMES)) * self.second;
                let gesture = self.gesture(time);
                self.scene.advance(&gesture, (self.second / f64::from(FRAMES)) as f32)?;
            }
        }
        Ok(joints)
    }

    /// Returns where the chains are now.
    fn joints(&self) -> Result<Vec<Vec3>> {
        let hair = &self.scene.character.hair().strands;
        let strands = pollster::block_on(self.scene.drawn([hair]))?;
        Ok(self.chains.followed(&strands))
    }
}
