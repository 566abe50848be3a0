//! Motions: the built-in ones and keyframe files, as a gesture for every time.
//!
//! All are lists of keys. Between keys each angle follows a quintic whose slope at a key is that
//! of a monotone cubic and whose acceleration there is zero: the curve is twice differentiable,
//! passes through every key and never overshoots one, so a hold between two equal keys is still.
//!
//! A key turns the head on the neck, leans the torso about the waist and puts the whole somewhere else; it may also say how
//! much there is of the body's shapes. What is one rigid piece does all of it as one.

pub mod animation;
mod named;

pub use named::NAMES;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path, sync::Arc};
use tresses::{
    Pose,
    character::Gesture,
    glam::{EulerRot, Quat, Vec3},
};

/// The most keys a keyframe file may have.
const MAX_KEYS: usize = 100_000;

/// How far below the joint of the neck a torso leans about, metres.
const WAIST: f32 = 0.42;
/// Angles of the head, of the torso, and where all of it is.
const FIXED: usize = 9;

/// What a character does at one time.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Seconds.
    pub time: f64,
    /// The head on the neck: yaw (to the head's left), pitch (chin down) and roll (towards the head's right shoulder),
    /// degrees.
    #[serde(default)]
    pub rotation: [f64; 3],
    /// The torso about the waist, the same three angles.
    #[serde(default)]
    pub lean: [f64; 3],
    /// Everything, metres.
    #[serde(default)]
    pub translation: [f64; 3],
    /// How much there is of the body's shapes, 1 for all of it. A shape that a key does not name has 0 there.
    #[serde(default)]
    pub shapes: BTreeMap<String, f64>,
}

/// The form of a keyframe file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default, rename = "loop")]
    repeats: bool,
    keys: Vec<Key>,
}

/// A motion.
#[derive(Clone, Debug)]
pub struct Motion {
    times: Vec<f64>,
    /// The channels of every key: [`FIXED`] numbers, then the shapes.
    values: Vec<Vec<f64>>,
    /// Their slopes, units per second.
    slopes: Vec<Vec<f64>>,
    shapes: Vec<Arc<str>>,
    repeats: bool,
}

impl Motion {
    /// A built-in motion by its name, or the keyframe file at that path.
    pub fn open(name: &str) -> Result<Self> {
        match Self::named(name) {
            Some(motion) => Ok(motion),
            None if Path::new(name).extension().is_some_and(|e| e == "json") => Self::read(Path::new(name)),
            None => bail!(
                "there is no motion {name:?}; choose {} or give a keyframe file that ends in .json",
                NAMES.join(", ")
            ),
        }
    }

    /// A keyframe file, in seconds, degrees and metres:
    /// `{"loop": true, "keys": [{"time": 0, "rotation": [yaw, pitch, roll], "lean": [yaw, pitch, roll],
    /// "translation": [x, y, z], "shapes": {"Jaw": 0.5}}, …]}`. All but the time may be left out.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    pub(crate) fn parse(text: &str) -> Result<Self> {
        let File { repeats, keys } = serde_json::from_str(text)?;
        Self::keyed(keys, repeats)
    }

    /// A motion through `keys`, over and over if it `repeats`.
    pub fn keyed(keys: Vec<Key>, repeats: bool) -> Result<Self> {
        ensure!(!keys.is_empty(), "the motion has no keys");
        ensure!(
            keys.len() <= MAX_KEYS,
            "the motion has {} keys, but at most {MAX_KEYS} are read",
            keys.len()
        );
        let shapes = shapes_of(&keys);
        for (i, key) in keys.iter().enumerate() {
            ensure!(
                key.time.is_finite() && channels(key, &shapes).iter().all(|v| v.is_finite() && v.abs() < 1e6),
                "key {i} holds a number that is not finite or is absurdly large"
            );
            ensure!(i > 0 || key.time == 0.0, "the first key is at {} s, but must be at 0", key.time);
            ensure!(
                i == 0 || key.time > keys[i - 1].time,
                "key {i} is at {} s, not later than the key before it",
                key.time
            );
        }
        let (first, last) = (&keys[0], &keys[keys.len() - 1]);
        ensure!(
            !repeats || (keys.len() > 1 && channels(first, &shapes) == channels(last, &shapes)),
            "a motion that loops must end with the pose it starts with"
        );
        Ok(Self::from_keys(&keys, repeats))
    }

    fn from_keys(keys: &[Key], repeats: bool) -> Self {
        let n = keys.len();
        let shapes = shapes_of(keys);
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        let values: Vec<Vec<f64>> = keys.iter().map(|key| channels(key, &shapes)).collect();
        // The secant of the segment before key `i`; beyond the ends the other end's of a loop, or none.
        let secant = |i: usize, c: usize| -> f64 {
            if n < 2 || !(repeats || (1..n).contains(&i)) {
                return 0.0;
            }
            let i = match i {
                0 => n - 1,
                _ if i == n => 1,
                _ => i,
            };
            (values[i][c] - values[i - 1][c]) / (times[i] - times[i - 1])
        };
        let slope = |i: usize, c: usize| {
            let (before, after) = (secant(i, c), secant(i + 1, c));
            // Harmonic mean: zero at an extremum, never more than twice the flatter secant.
            if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
        };
        let slopes = (0..n).map(|i| (0..FIXED + shapes.len()).map(|c| slope(i, c)).collect()).collect();
        Self { times, values, slopes, shapes, repeats }
    }

    /// Seconds from the first to the last key.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Whether the motion starts over after its [`duration`](Self::duration).
    pub fn repeats(&self) -> bool {
        self.repeats
    }

    /// The names of the shapes that it moves.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.shapes.iter().map(|name| &**name)
    }

    /// All channels at `time` in seconds: yaw, pitch, roll of the head and of the torso in degrees, translation in
    /// metres, shapes.
    fn at(&self, time: f64) -> Vec<f64> {
        let time =
            if self.repeats { time.rem_euclid(self.duration()) } else { time.clamp(0.0, self.duration()) };
        let next = self.times.partition_point(|key| *key <= time);
        if next == 0 || next == self.times.len() {
            return self.values[next.saturating_sub(1)].clone();
        }
        let span = self.times[next] - self.times[next - 1];
        let s = (time - self.times[next - 1]) / span;
        let (from, to) = (&self.values[next - 1], &self.values[next]);
        let channel = |c: usize| {
            let (m0, m1) = (self.slopes[next - 1][c] * span, self.slopes[next][c] * span);
            from[c] + quintic(s, to[c] - from[c], m0, m1)
        };
        (0..from.len()).map(channel).collect()
    }

    /// What a character does at `time` in seconds, whose head turns about `pivot` (metres), the joint of its neck.
    pub fn gesture(&self, time: f64, pivot: Vec3) -> Gesture {
        let at = self.at(time);
        let turn = |angles: &[f64]| {
            let [yaw, pitch, roll] = [angles[0], angles[1], angles[2]].map(|a| a.to_radians() as f32);
            Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
        };
        let mut body = Pose::about(pivot - Vec3::Y * WAIST, turn(&at[3..6]));
        body.translation += Vec3::new(at[6] as f32, at[7] as f32, at[8] as f32);
        let shapes = self.shapes.iter().cloned().zip(at[FIXED..].iter().map(|weight| *weight as f32));
        Gesture { body, head: Pose::about(pivot, turn(&at[..3])), shapes: shapes.collect() }
    }

    /// The pose of something that is one piece, at `time` in seconds; it turns about `pivot` (metres).
    pub fn pose(&self, time: f64, pivot: Vec3) -> Pose {
        self.gesture(time, pivot).rigid()
    }
}

/// The names of the shapes in all keys, in order.
fn shapes_of(keys: &[Key]) -> Vec<Arc<str>> {
    let names: std::collections::BTreeSet<&str> =
        keys.iter().flat_map(|key| key.shapes.keys()).map(String::as_str).collect();
    names.into_iter().map(Arc::from).collect()
}

fn channels(key: &Key, shapes: &[Arc<str>]) -> Vec<f64> {
    let fixed = [key.rotation, key.lean, key.translation].concat();
    let shapes = shapes.iter().map(|name| key.shapes.get(&**name).copied().unwrap_or(0.0));
    fixed.into_iter().chain(shapes).collect()
}

/// The quintic from 0 to `rise` over `s` in 0..1 with slopes `m0`, `m1` and no acceleration at the ends.
fn quintic(s: f64, rise: f64, m0: f64, m1: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    let (s4, s5) = (s3 * s, s3 * s2);
    rise * (10.0 * s3 - 15.0 * s4 + 6.0 * s5)
        + m0 * (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5)
        + m1 * (-4.0 * s3 + 7.0 * s4 - 3.0 * s5)
}

#[cfg(test)]
mod tests;
