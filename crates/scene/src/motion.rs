//! Head motions: the built-in ones and keyframe files, as a pose for every time.
//!
//! All are lists of keys. Between keys each angle follows a quintic whose slope at a key is that
//! of a monotone cubic and whose acceleration there is zero: the curve is twice differentiable,
//! passes through every key and never overshoots one, so a hold between two equal keys is still.

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::path::Path;
use tresses::{
    Pose,
    glam::{EulerRot, Quat, Vec3},
};

/// The names of the built-in motions.
pub const NAMES: [&str; 4] = ["still", "nod", "turn", "shake"];

/// The most keys a keyframe file may have.
const MAX_KEYS: usize = 100_000;

/// What the head does at one time.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Seconds.
    pub time: f64,
    /// Yaw (to the head's left), pitch (chin down) and roll (towards the head's right shoulder), degrees.
    #[serde(default)]
    pub rotation: [f64; 3],
    /// Metres.
    #[serde(default)]
    pub translation: [f64; 3],
}

/// The form of a keyframe file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default, rename = "loop")]
    repeats: bool,
    keys: Vec<Key>,
}

/// A head motion.
#[derive(Clone, Debug)]
pub struct Motion {
    keys: Vec<Key>,
    /// The slope of every channel at every key, units per second.
    slopes: Vec<[f64; 6]>,
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

    /// A built-in motion. All repeat, start and end at rest, and hold still for a while at the end.
    pub fn named(name: &str) -> Option<Self> {
        // Time in seconds, yaw, pitch in degrees. Head turns pass 60 to 120 degrees in half a second.
        let keys: &[(f64, f64, f64)] = match name {
            "still" => &[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0)],
            "nod" => &[
                (0.0, 0.0, 0.0),
                (0.25, 0.0, 30.0),
                (0.35, 0.0, 30.0),
                (0.70, 0.0, -14.0),
                (0.78, 0.0, -14.0),
                (1.08, 0.0, 24.0),
                (1.16, 0.0, 24.0),
                (1.34, 0.0, 0.0),
                (2.5, 0.0, 0.0),
            ],
            "turn" => &[
                (0.0, 0.0, 0.0),
                (0.30, 45.0, 0.0),
                (0.80, 45.0, 0.0),
                (1.30, -45.0, 0.0),
                (1.90, -45.0, 0.0),
                (2.20, 0.0, 0.0),
                (3.0, 0.0, 0.0),
            ],
            "shake" => &[
                (0.0, 0.0, 0.0),
                (0.20, 30.0, 0.0),
                (0.50, -30.0, 0.0),
                (0.80, 30.0, 0.0),
                (1.10, -30.0, 0.0),
                (1.30, 0.0, 0.0),
                (2.5, 0.0, 0.0),
            ],
            _ => return None,
        };
        let key = |&(time, yaw, pitch)| Key { time, rotation: [yaw, pitch, 0.0], translation: [0.0; 3] };
        Some(Self::from_keys(keys.iter().map(key).collect(), true))
    }

    /// A keyframe file: `{"loop": true, "keys": [{"time": 0, "rotation": [yaw, pitch, roll], "translation": [x, y, z]}, …]}`
    /// in seconds, degrees and metres.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> Result<Self> {
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
        for (i, key) in keys.iter().enumerate() {
            let channels = channels(key);
            ensure!(
                key.time.is_finite() && channels.iter().all(|v| v.is_finite() && v.abs() < 1e6),
                "key {i} holds a number that is not finite or is absurdly large"
            );
            ensure!(i > 0 || key.time == 0.0, "the first key is at {} s, but must be at 0", key.time);
            ensure!(
                i == 0 || key.time > keys[i - 1].time,
                "key {i} is at {} s, not later than the key before it",
                key.time
            );
        }
        let (first, last) = (keys[0], keys[keys.len() - 1]);
        ensure!(
            !repeats || (keys.len() > 1 && channels(&first) == channels(&last)),
            "a motion that loops must end with the pose it starts with"
        );
        Ok(Self::from_keys(keys, repeats))
    }

    fn from_keys(keys: Vec<Key>, repeats: bool) -> Self {
        let n = keys.len();
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
            (channels(&keys[i])[c] - channels(&keys[i - 1])[c]) / (keys[i].time - keys[i - 1].time)
        };
        let slopes = (0..n)
            .map(|i| {
                std::array::from_fn(|c| {
                    let (before, after) = (secant(i, c), secant(i + 1, c));
                    // Harmonic mean: zero at an extremum, never more than twice the flatter secant.
                    if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
                })
            })
            .collect();
        Self { keys, slopes, repeats }
    }

    /// Seconds from the first to the last key.
    pub fn duration(&self) -> f64 {
        self.keys[self.keys.len() - 1].time
    }

    /// Whether the motion starts over after its [`duration`](Self::duration).
    pub fn repeats(&self) -> bool {
        self.repeats
    }

    /// Yaw, pitch, roll in degrees and translation in metres at `time` in seconds.
    pub fn at(&self, time: f64) -> [f64; 6] {
        let time =
            if self.repeats { time.rem_euclid(self.duration()) } else { time.clamp(0.0, self.duration()) };
        let next = self.keys.partition_point(|key| key.time <= time);
        if next == 0 || next == self.keys.len() {
            return channels(&self.keys[next.saturating_sub(1)]);
        }
        let (a, b) = (&self.keys[next - 1], &self.keys[next]);
        let span = b.time - a.time;
        let s = (time - a.time) / span;
        let (from, to) = (channels(a), channels(b));
        std::array::from_fn(|c| {
            let (m0, m1) = (self.slopes[next - 1][c] * span, self.slopes[next][c] * span);
            from[c] + quintic(s, to[c] - from[c], m0, m1)
        })
    }

    /// The head's pose at `time` in seconds; rotations are about `pivot` (metres), the neck joint.
    pub fn pose(&self, time: f64, pivot: Vec3) -> Pose {
        let [yaw, pitch, roll, x, y, z] = self.at(time);
        let rotation = Quat::from_euler(
            EulerRot::YXZ,
            yaw.to_radians() as f32,
            pitch.to_radians() as f32,
            roll.to_radians() as f32,
        );
        let mut pose = Pose::about(pivot, rotation);
        pose.translation += Vec3::new(x as f32, y as f32, z as f32);
        pose
    }
}

fn channels(key: &Key) -> [f64; 6] {
    let ([a, b, c], [x, y, z]) = (key.rotation, key.translation);
    [a, b, c, x, y, z]
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
mod tests {
    use super::*;

    fn steps(motion: &Motion, dt: f64) -> impl Iterator<Item = f64> {
        let n = (motion.duration() / dt).round() as usize;
        (0..=n).map(move |i| i as f64 * dt)
    }

    #[test]
    fn built_in_motions_loop_and_are_twice_differentiable() {
        let dt = 1e-3;
        for name in NAMES {
            let motion = Motion::named(name).unwrap();
            assert!(motion.repeats());
            let period = motion.duration();
            // A quintic without slopes has its largest third derivative, 60 rise / span³, at its ends.
            let jerk = motion
                .keys
                .windows(2)
                .map(|k| {
                    let rise =
                        (0..2).map(|c| (k[1].rotation[c] - k[0].rotation[c]).abs()).fold(0.0, f64::max);
                    1.1 * 60.0 * rise / (k[1].time - k[0].time).powi(3)
                })
                .fold(1e-3, f64::max);
            // Across the seam as well: from one period before to one after.
            let value = |t: f64, c: usize| motion.at(t)[c];
            for t in steps(&motion, dt) {
                for c in 0..6 {
                    assert!((value(t, c) - value(t + period, c)).abs() < 1e-9, "{name} at {t}");
                    let second = |t: f64| value(t + dt, c) - 2.0 * value(t, c) + value(t - dt, c);
                    let jump = (second(t + dt) - second(t)).abs() / (dt * dt);
                    assert!(jump < jerk * dt, "{name} at {t}: {jump}");
                }
            }
        }
    }

    #[test]
    fn heads_turn_at_the_stated_speed() {
        // look.md: 60 to 120 degrees in half a second, from hold to hold.
        for name in ["nod", "turn", "shake"] {
            let motion = Motion::named(name).unwrap();
            for pair in motion.keys.windows(2) {
                let angle = (0..3).map(|c| (pair[1].rotation[c] - pair[0].rotation[c]).abs()).sum::<f64>();
                let in_half_a_second = angle / (pair[1].time - pair[0].time) * 0.5;
                assert!(angle == 0.0 || (60.0..=120.0).contains(&in_half_a_second), "{name} {pair:?}");
            }
        }
        let turn = Motion::named("turn").unwrap();
        assert!((turn.at(0.8)[0] - turn.at(1.3)[0] - 90.0).abs() < 1e-9);
        assert!(steps(&turn, 0.01).all(|t| Motion::named("still").unwrap().at(t) == [0.0; 6]));
    }

    #[test]
    fn keys_are_met_and_not_overshot() {
        let text = r#"{"keys": [{"time": 0}, {"time": 0.1, "rotation": [1, 0, 0]}, {"time": 1, "rotation": [90, -5, 3]},
            {"time": 1.5, "rotation": [90, -5, 3], "translation": [0.1, 0, 0]}]}"#;
        let motion = Motion::parse(text).unwrap();
        assert!(!motion.repeats());
        for key in &motion.keys {
            assert_eq!(motion.at(key.time), channels(key));
        }
        let mut last = motion.at(0.0)[0];
        for t in steps(&motion, 1e-3) {
            let yaw = motion.at(t)[0];
            assert!(yaw >= last - 1e-9 && yaw <= 90.0 + 1e-9, "{t}: {yaw} after {last}");
            last = yaw;
        }
        assert_eq!(motion.at(1e9), channels(&motion.keys[3]), "holds its last pose");
    }

    #[test]
    fn the_neck_stays_and_the_nose_goes_left() {
        let neck = Vec3::new(0.0, 1.4, -0.02);
        let nose = Vec3::new(0.0, 1.55, 0.1);
        let pose = Motion::named("turn").unwrap().pose(0.3, neck);
        assert!((pose.point(neck) - neck).length() < 1e-6);
        assert!(pose.point(nose).x > 0.05, "yaw is towards +X, the head's left");
        let nod = Motion::named("nod").unwrap().pose(0.25, neck);
        assert!(nod.point(nose).y < nose.y, "positive pitch lowers the chin");
    }

    #[test]
    fn bad_keyframes_give_one_sentence() {
        for (text, clause) in [
            ("", "EOF"),
            (r#"{"keys": []}"#, "no keys"),
            (r#"{"keys": [{"time": 1}]}"#, "must be at 0"),
            (r#"{"keys": [{"time": 0}, {"time": 0}]}"#, "not later"),
            (r#"{"keys": [{"time": 0, "rotation": [1e99, 0, 0]}]}"#, "absurdly large"),
            (r#"{"keys": [{"time": 0, "spin": 3}]}"#, "spin"),
            (r#"{"loop": true, "keys": [{"time": 0}, {"time": 1, "rotation": [9, 0, 0]}]}"#, "loops"),
        ] {
            let error = format!("{:#}", Motion::parse(text).unwrap_err());
            assert!(error.contains(clause) && !error.contains('\n'), "{text}: {error}");
        }
        assert!(Motion::open("dance").unwrap_err().to_string().contains("still, nod, turn, shake"));
    }
}
