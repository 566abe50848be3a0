//! Motions of a character, built in or from keyframe files, evaluated as a gesture per time.
//!
//! A motion is a list of keys. Between keys each channel follows a quintic with zero acceleration at the keys and the
//! slopes of a monotone cubic. The curve is twice differentiable, passes through every key and never overshoots, so it
//! stays constant between equal keys.
//!
//! A key rotates the head on the neck, leans the torso about the waist, translates the character, and optionally sets
//! weights of blend shapes. A rigid body applies all of these as one pose.

pub mod animation;
mod named;

pub use named::NAMES;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path, sync::Arc};
use tresses::{
    Gesture, Pose,
    glam::{EulerRot, Quat, Vec3},
};

/// Maximum number of keys in a keyframe file.
const MAX_KEYS: usize = 100_000;

/// Distance from the neck joint down to the pivot of the torso's lean, meters.
const WAIST: f32 = 0.42;
/// Number of fixed channels: angles of head and torso, and translation.
const FIXED: usize = 9;

/// State of a character at one time.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Time, seconds.
    pub time: f64,
    /// Rotation of the head on the neck, degrees: yaw (toward the head's left), pitch (chin down), roll (toward the
    /// head's right shoulder).
    #[serde(default)]
    pub rotation: [f64; 3],
    /// Lean of the torso about the waist, degrees: the same three angles.
    #[serde(default)]
    pub lean: [f64; 3],
    /// Translation of the whole character, meters.
    #[serde(default)]
    pub translation: [f64; 3],
    /// Weights of blend shapes, 1 for full effect. Shapes that a key does not name have weight 0.
    #[serde(default)]
    pub shapes: BTreeMap<String, f64>,
}

/// Format of keyframe files.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default, rename = "loop")]
    repeats: bool,
    keys: Vec<Keyframe>,
}

/// A keyframed motion.
#[derive(Clone, Debug)]
pub struct Motion {
    times: Vec<f64>,
    /// Channels of every key: [`FIXED`] numbers, then the blend shape weights.
    values: Vec<Vec<f64>>,
    /// Slopes of the channels at every key, units per second.
    slopes: Vec<Vec<f64>>,
    shapes: Vec<Arc<str>>,
    repeats: bool,
}

impl Motion {
    /// Returns the built-in motion `name`, or reads the keyframe file at that path.
    pub fn open(name: &str) -> Result<Self> {
        match Self::named(name) {
            Some(motion) => Ok(motion),
            None if Path::new(name).extension().is_some_and(|e| e == "json") => Self::read(Path::new(name)),
            None => bail!(
                "there is no motion {name:?}; choose {}, or give a keyframe file (.json)",
                NAMES.join(", ")
            ),
        }
    }

    /// Reads a keyframe file, in seconds, degrees and meters:
    /// `{"loop": true, "keys": [{"time": 0, "rotation": [yaw, pitch, roll], "lean": [yaw, pitch, roll],
    /// "translation": [x, y, z], "shapes": {"Jaw": 0.5}}, …]}`. All fields of a key except `time` are optional.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    pub(crate) fn parse(text: &str) -> Result<Self> {
        let File { repeats, keys } = serde_json::from_str(text)?;
        Self::keyed(keys, repeats)
    }

    /// Creates a motion from `keys`, which loops if `repeats` is set.
    pub fn keyed(keys: Vec<Keyframe>, repeats: bool) -> Result<Self> {
        ensure!(!keys.is_empty(), "the motion has no keys");
        ensure!(
            keys.len() <= MAX_KEYS,
            "the motion has {} keys, but at most {MAX_KEYS} are supported",
            keys.len()
        );
        let shapes = shapes_of(&keys);
        for (i, key) in keys.iter().enumerate() {
            ensure!(
                key.time.is_finite() && channels(key, &shapes).iter().all(|v| v.is_finite() && v.abs() < 1e6),
                "key {i}: a number is not finite or is larger than 1e6"
            );
            ensure!(i > 0 || key.time == 0.0, "the first key is at {} s, but must be at 0", key.time);
            ensure!(
                i == 0 || key.time > keys[i - 1].time,
                "key {i} is at {} s, not later than the previous key",
                key.time
            );
        }
        let (first, last) = (&keys[0], &keys[keys.len() - 1]);
        ensure!(
            !repeats || (keys.len() > 1 && channels(first, &shapes) == channels(last, &shapes)),
            "a looping motion must end with its first pose"
        );
        Ok(Self::from_keys(&keys, repeats))
    }

    fn from_keys(keys: &[Keyframe], repeats: bool) -> Self {
        let n = keys.len();
        let shapes = shapes_of(keys);
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        let values: Vec<Vec<f64>> = keys.iter().map(|key| channels(key, &shapes)).collect();
        // Secant of the segment before key `i`. Beyond the ends it wraps around in a loop and is zero otherwise.
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

    /// Returns the time from the first to the last key, seconds.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Returns whether the motion starts over after its [`duration`](Self::duration).
    pub fn repeats(&self) -> bool {
        self.repeats
    }

    /// Returns the names of the blend shapes that it animates.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.shapes.iter().map(|name| &**name)
    }

    /// Returns all channels at `time` (seconds): yaw, pitch and roll of head and torso in degrees, translation in
    /// meters, blend shape weights.
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

    /// Returns the gesture at `time` (seconds). `pivot` is the neck joint about which the head turns, meters.
    pub fn gesture(&self, time: f64, pivot: Vec3) -> Gesture {
        let at = self.at(time);
        let rotation = |angles: &[f64]| {
            let [yaw, pitch, roll] = [angles[0], angles[1], angles[2]].map(|a| a.to_radians() as f32);
            Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
        };
        let mut body = Pose::about(pivot - Vec3::Y * WAIST, rotation(&at[3..6]));
        body.translation += Vec3::new(at[6] as f32, at[7] as f32, at[8] as f32);
        let shapes = self.shapes.iter().cloned().zip(at[FIXED..].iter().map(|weight| *weight as f32));
        Gesture { body, head: Pose::about(pivot, rotation(&at[..3])), shapes: shapes.collect() }
    }

    /// Returns the pose of a rigid object at `time` (seconds), which turns about `pivot` (meters).
    pub fn pose(&self, time: f64, pivot: Vec3) -> Pose {
        self.gesture(time, pivot).rigid()
    }
}

/// Returns the names of the blend shapes in all keys, sorted.
fn shapes_of(keys: &[Keyframe]) -> Vec<Arc<str>> {
    let names: std::collections::BTreeSet<&str> =
        keys.iter().flat_map(|key| key.shapes.keys()).map(String::as_str).collect();
    names.into_iter().map(Arc::from).collect()
}

fn channels(key: &Keyframe, shapes: &[Arc<str>]) -> Vec<f64> {
    let fixed = [key.rotation, key.lean, key.translation].concat();
    let shapes = shapes.iter().map(|name| key.shapes.get(&**name).copied().unwrap_or(0.0));
    fixed.into_iter().chain(shapes).collect()
}

/// Evaluates the quintic from 0 to `rise` for `s` in 0..1, with slopes `m0` and `m1` and zero acceleration at the ends.
fn quintic(s: f64, rise: f64, m0: f64, m1: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    let (s4, s5) = (s3 * s, s3 * s2);
    rise * (10.0 * s3 - 15.0 * s4 + 6.0 * s5)
        + m0 * (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5)
        + m1 * (-4.0 * s3 + 7.0 * s4 - 3.0 * s5)
}

#[cfg(test)]
mod tests;
