//! Beards: stubble, short, full.

use super::{grow, normal, push};
use crate::{
    Strands, TriMesh,
    mannequin::{ears, forms::step},
    random::{Rng, noise},
};
use glam::{Vec3, vec3};

/// Length of a beard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Beard {
    /// No beard.
    #[default]
    None,
    /// Some days old: 2 mm.
    Stubble,
    /// Trimmed: 1 cm.
    Short,
    /// Grown for half a year: 4 cm at the chin.
    Full,
}

/// Density in hairs per cm² where it is greatest, vertices per hair, and length.
impl Beard {
    fn dense(self) -> f32 {
        match self {
            Self::None => 0.0,
            Self::Stubble => 38.0,
            Self::Short => 42.0,
            Self::Full => 75.0,
        }
    }

    fn vertices(self) -> usize {
        match self {
            Self::None | Self::Stubble => 4,
            Self::Short => 8,
            Self::Full => 16,
        }
    }

    /// Returns the length of hairs at the chin, mm.
    fn long(self) -> f32 {
        match self {
            Self::None => 0.0,
            Self::Stubble => 2.2,
            Self::Short => 11.0,
            Self::Full => 40.0,
        }
    }
}

const SEED: u32 = 0xbea2d;

/// Adds a beard on `mesh`, a mesh of the bust ([`crate::mannequin::mesh`]), meters, with 4, 8 or 16 vertices per
/// strand.
pub fn beard(strands: &mut Strands, kind: Beard, mesh: &TriMesh) {
    let mut due = 0.0f32;
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize] * 1000.0);
        let center = (a + b + c) / 3.0;
        let density = cover(center);
        if density <= 0.0 {
            continue;
        }
        let area = 0.5 * (b - a).cross(c - a).length();
        let rng = &mut Rng::new(SEED, t as u32);
        // Carry the remainder over to the next triangle, so that hairs are spread evenly.
        due += 0.01 * area * kind.dense() * density;
        while due >= 1.0 {
            due -= 1.0;
            let (mut u, mut v) = (rng.unit(), rng.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            hair(strands, kind, a + (b - a) * u + (c - a) * v, density, rng);
        }
    }
}

/// Returns the relative density of the beard at a point of the skin (mm), 0 to 1.
fn cover(p: Vec3) -> f32 {
    let q = vec3(p.x.abs(), p.y, p.z);
    if q.y < -45.0 || q.y > 112.0 || q.z < -14.0 {
        return 0.0;
    }
    // Cheeks: below a line that hangs from the sideburns to the corners of the mouth.
    let t = ((q.z - 12.0) / 72.0).clamp(0.0, 1.0);
    let line = 106.0 + (57.0 - 106.0) * t.powf(0.55);
    let cheek = step(line + 4.0, line - 6.0, q.y);
    // Mustache: up to the nose, and over to the corners of the mouth.
    let above =
        step(31.0, 24.0, q.x) * step(69.0 - 0.25 * q.x, 65.0 - 0.3 * q.x, q.y) * step(66.0, 76.0, q.z);
    let cheek = cheek.max(above);
    // No hair behind the jaw or on the ears.
    let jaw = step(-9.0, 3.0, q.z + 0.22 * (q.y - 40.0).min(0.0));
    let ear_mask = step(1.0, 5.0, ears::ear(q));
    // Neck: down to the Adam's apple.
    let neck = step(-24.0, -6.0, q.y - 0.22 * q.z);
    // The lips are bare, and so is a strip around the lower lip except for its middle.
    let mouth = vec3(q.x / 26.5, (q.y - 43.5) / 9.2, 0.0).length();
    let lips = if q.z > 60.0 { step(1.0, 1.16, mouth) } else { 1.0 };
    let strip_distance = vec3((q.x - 15.5) / 7.5, (q.y - 31.0) / 5.5, 0.0).length();
    let strip_mask = if q.z > 60.0 { 0.25 + 0.75 * step(0.8, 1.3, strip_distance) } else { 1.0 };
    // No hair on the nose, and little in the groove below it.
    let nose = vec3(q.x / 15.5, (q.y - 76.0) / 12.5, 0.0).length();
    let nose = if q.z > 70.0 { step(1.0, 1.12, nose) } else { 1.0 };
    let groove = if q.z > 80.0 && q.y > 48.0 { 0.45 + 0.55 * step(1.5, 4.5, q.x) } else { 1.0 };
    cheek * jaw * ear_mask * neck * lips * strip_mask * nose * groove
}

fn hair(strands: &mut Strands, kind: Beard, root: Vec3, density: f32, rng: &mut Rng) {
    let out = normal(root);
    let q = vec3(root.x.abs(), root.y, root.z);
    let side = if root.x < 0.0 { -1.0 } else { 1.0 };
    // Direction: down; forward on the cheeks; sideways from the middle of the upper lip; forward to the chin on the
    // neck.
    let lip = step(26.0, 8.0, q.x) * step(46.0, 50.0, q.y) * step(70.0, 80.0, q.z);
    let neck = step(6.0, -10.0, q.y);
    let cheek = step(20.0, 50.0, q.x);
    let forward = 0.35 * cheek + 1.1 * neck;
    let flow = vec3(side * (1.15 * lip - 0.25 * neck - 0.12 * cheek), -1.0, forward);
    let wild = vec3(noise(root / 9.0, SEED + 1), noise(root / 9.0, SEED + 2), noise(root / 9.0, SEED + 3));
    let direction = flow.normalize() + 0.18 * wild + 0.13 * rng.bell3();
    // Longest at the chin, short on the upper lip and toward the ears.
    let chin = step(62.0, 12.0, q.x) * step(45.0, 15.0, q.y);
    let part = match kind {
        Beard::Full => (0.48 + 0.52 * chin) * (1.0 - 0.45 * lip) * (0.55 + 0.45 * step(95.0, 50.0, q.y)),
        _ => 1.0 - 0.15 * lip,
    };
    let part = part * (0.5 + 0.5 * density.sqrt());
    let long = kind.long() * part * (1.0 + 0.12 * rng.bell()) * if rng.unit() < 0.15 { 0.6 } else { 1.0 };
    // Random waves per hair, with a wavelength of 9 to 16 mm.
    let (wave, phase) = (rng.range(0.05, 0.22), rng.range(0.0, std::f32::consts::TAU));
    let wave_count = long / rng.range(9.0, 16.0);
    let across = direction.cross(out).normalize_or(Vec3::X);
    let lift = match kind {
        Beard::Stubble => rng.range(0.7, 1.1),
        Beard::Short => rng.range(0.45, 0.7),
        _ => rng.range(0.7, 1.25),
    };
    // A long beard stands off on the hair below it and hangs down at its end.
    let line = grow(root, long.max(0.8), kind.vertices(), |t, out| {
        let flat = (direction - out * direction.dot(out)).normalize_or(direction);
        let hang = if kind == Beard::Full { t * t * 0.8 } else { 0.0 };
        let curl = across * (wave * (phase + std::f32::consts::TAU * wave_count * t).sin());
        (flat + out * (lift * (1.0 - 0.75 * t)) + curl) * (1.0 - 0.5 * hang) + Vec3::NEG_Y * hang
    });
    push(strands, &line, rng.range(0.075, 0.12), if kind == Beard::Stubble { 0.8 } else { 0.35 });
}
