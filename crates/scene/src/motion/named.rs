//! Built-in motions.

use super::{Keyframe, Motion};

/// The names of the built-in motions.
pub const NAMES: [&str; 6] = ["still", "nod", "turn", "shake", "walk", "dance"];

/// Blend shape of breathing.
const BREATH: &str = "Breath";

impl Motion {
    /// Returns a built-in motion. All of them loop. Motions of the head alone start and end at rest, with a pause at
    /// the end.
    pub fn named(name: &str) -> Option<Self> {
        let keys = match name {
            "still" => head_keyframes(&[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0)]),
            // Time in seconds; yaw and pitch in degrees. Heads turn by 60 to 120 degrees in half a second.
            "nod" => head_keyframes(&[
                (0.0, 0.0, 0.0),
                (0.25, 0.0, 30.0),
                (0.35, 0.0, 30.0),
                (0.70, 0.0, -14.0),
                (0.78, 0.0, -14.0),
                (1.08, 0.0, 24.0),
                (1.16, 0.0, 24.0),
                (1.34, 0.0, 0.0),
                (2.5, 0.0, 0.0),
            ]),
            "turn" => head_keyframes(&[
                (0.0, 0.0, 0.0),
                (0.30, 45.0, 0.0),
                (0.80, 45.0, 0.0),
                (1.30, -45.0, 0.0),
                (1.90, -45.0, 0.0),
                (2.20, 0.0, 0.0),
                (3.0, 0.0, 0.0),
            ]),
            "shake" => head_keyframes(&[
                (0.0, 0.0, 0.0),
                (0.20, 30.0, 0.0),
                (0.50, -30.0, 0.0),
                (0.80, 30.0, 0.0),
                (1.10, -30.0, 0.0),
                (1.30, 0.0, 0.0),
                (2.5, 0.0, 0.0),
            ]),
            "walk" => walk(),
            "dance" => dance(),
            _ => return None,
        };
        Some(Self::from_keys(&keys, true))
    }
}

/// Returns keys that move only the head. Unless it stays still, the chest breathes once per loop.
fn head_keyframes(keys: &[(f64, f64, f64)]) -> Vec<Keyframe> {
    let moves = keys.iter().any(|(_, yaw, pitch)| *yaw != 0.0 || *pitch != 0.0);
    let length = keys[keys.len() - 1].0;
    let key = |&(time, yaw, pitch): &(f64, f64, f64)| {
        let mut key = Keyframe { time, rotation: [yaw, pitch, 0.0], ..Keyframe::default() };
        if moves {
            key.shapes.insert(BREATH.into(), breath(time / length));
        }
        key
    };
    keys.iter().map(key).collect()
}

/// Returns the breathing weight at phase `t`: inhale during the first two fifths, exhale during the rest.
fn breath(t: f64) -> f64 {
    let phase = if t < 0.4 { t / 0.4 } else { (1.0 - t) / 0.6 };
    0.5 - 0.5 * (std::f64::consts::PI * phase).cos()
}

/// Returns a walk in place of two strides, 1.1 s each. The body moves vertically by 3 cm per step and sideways by 2.4
/// cm per stride. The shoulders turn against the hips and the head against the shoulders, so that it looks ahead.
fn walk() -> Vec<Keyframe> {
    const STRIDE: f64 = 1.1;
    const KEYS: u32 = 32;
    let key = |i: u32| {
        // Reduce the index, so that the last key equals the first exactly.
        let phase = f64::from(i % KEYS) / f64::from(KEYS);
        let stride = 4.0 * std::f64::consts::PI * phase;
        let (swing, sway) = (stride.sin(), (stride + 0.6).sin());
        let step = (2.0 * stride).cos();
        Keyframe {
            time: 2.0 * STRIDE * f64::from(i) / f64::from(KEYS),
            rotation: [-4.5 * swing, -2.0 - 1.5 * step, -1.5 * sway],
            lean: [6.0 * swing, 3.0 + 0.8 * step, 2.0 * sway],
            translation: [0.012 * sway, 0.015 * step, 0.0],
            shapes: [(BREATH.to_string(), breath(phase))].into(),
        }
    };
    (0..=KEYS).map(key).collect()
}

/// Returns a dance of eight beats, two per second: a dip on every beat, a sway on every second beat, and two head
/// tosses.
fn dance() -> Vec<Keyframe> {
    // Beats; yaw, pitch, roll of head and torso in degrees; sideways and upward offset in cm; brow and jaw weights.
    type Row = (f64, [f64; 3], [f64; 3], [f64; 2], [f64; 2]);
    const ROWS: [Row; 17] = [
        (0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0], [0.0, 0.0]),
        (0.5, [8.0, 14.0, 6.0], [10.0, 6.0, 5.0], [2.5, -3.5], [0.0, 0.2]),
        (1.0, [14.0, -2.0, 9.0], [14.0, -1.0, 8.0], [4.0, 0.5], [0.4, 0.0]),
        (1.5, [6.0, 14.0, 2.0], [4.0, 6.0, 2.0], [1.0, -3.5], [0.0, 0.2]),
        (2.0, [-10.0, -2.0, -8.0], [-12.0, -1.0, -7.0], [-3.5, 0.5], [0.4, 0.0]),
        (2.5, [-16.0, 14.0, -9.0], [-16.0, 6.0, -8.0], [-4.5, -3.5], [0.0, 0.3]),
        (3.0, [-8.0, -4.0, -4.0], [-10.0, -2.0, -4.0], [-2.5, 1.0], [0.6, 0.0]),
        (3.5, [30.0, 16.0, 4.0], [6.0, 7.0, 0.0], [0.5, -4.0], [0.2, 0.4]),
        (4.0, [48.0, 0.0, 10.0], [18.0, 0.0, 6.0], [3.0, 0.5], [0.8, 0.3]),
        (4.5, [10.0, 18.0, 2.0], [8.0, 7.0, 4.0], [2.0, -4.0], [0.0, 0.1]),
        (5.0, [-40.0, 2.0, -10.0], [-14.0, 0.0, -5.0], [-2.5, 0.5], [0.8, 0.3]),
        (5.5, [-20.0, 16.0, -6.0], [-16.0, 7.0, -7.0], [-4.0, -3.5], [0.0, 0.1]),
        (6.0, [0.0, -14.0, 0.0], [0.0, -5.0, 0.0], [0.0, 2.0], [1.0, 0.6]),
        (6.5, [0.0, 24.0, 0.0], [0.0, 10.0, 0.0], [0.0, -4.5], [0.0, 0.2]),
        (7.0, [0.0, -8.0, 0.0], [0.0, -2.0, 0.0], [0.0, 1.0], [0.5, 0.2]),
        (7.5, [0.0, 16.0, 0.0], [0.0, 6.0, 0.0], [0.0, -3.0], [0.0, 0.0]),
        (8.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0], [0.0, 0.0]),
    ];
    let key = |(beat, rotation, lean, [x, y], [brows, jaw]): Row| Keyframe {
        time: 0.5 * beat,
        rotation,
        lean,
        translation: [0.01 * x, 0.01 * y, 0.0],
        shapes: [
            ("Brows".to_string(), brows),
            ("Jaw".to_string(), jaw),
            (BREATH.to_string(), breath(beat / 8.0)),
        ]
        .into(),
    };
    ROWS.into_iter().map(key).collect()
}
