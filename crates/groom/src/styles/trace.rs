//! Tracing of one guide: a path that leaves the scalp, follows the comb over the head and falls.

use super::face::Face;
use super::parting::Parting;
use super::recipe::Recipe;
use crate::random::{Rng, lerp, noise, smoothstep};
use crate::scalp::{Landmarks, Scalp};
use glam::Vec3;

/// Length of a step along the path, meters.
const STEP: f32 = 0.0025;

/// Data that all paths of one hairstyle share.
pub(crate) struct Field<'a> {
    pub(crate) recipe: &'a Recipe,
    pub(crate) scalp: &'a dyn Scalp,
    pub(crate) marks: Landmarks,
    pub(crate) parting: Option<&'a Parting>,
    pub(crate) face: Face,
    /// Point where the hair of the crown parts if there is no parting line.
    pub(crate) whorl: Vec3,
}

impl Field<'_> {
    /// Returns the layer of a root: 0 for the lowest (nape, over the ears), 1 for the highest.
    pub(crate) fn layer(&self, root: Vec3) -> f32 {
        smoothstep(self.marks.ear.y, self.marks.skull.y + 0.07, root.y)
    }

    /// Returns the position of `p` in front of the ears, 0 at the ears to 1 at the forehead.
    fn frontness(&self, p: Vec3) -> f32 {
        smoothstep(self.marks.ear.z + 0.01, self.marks.brow.z - 0.02, p.z)
    }

    /// Returns the pull of the comb at `p` on hair of the given side, not yet projected onto the skin.
    fn comb(&self, p: Vec3, side: f32, fringe: bool) -> Vec3 {
        let recipe = self.recipe;
        if fringe {
            let over = smoothstep(self.marks.brow.y + 0.03, self.marks.brow.y + 0.05, p.y);
            return Vec3::new(p.x * 4.0, -0.3, 1.0) * over;
        }
        let top = smoothstep(self.marks.skull.y + 0.02, self.marks.skull.y + 0.07, p.y);
        let from = self.parting.map_or(self.whorl, |parting| parting.nearest(p));
        let mut away = (p - from).normalize_or_zero();
        if self.parting.is_some() {
            // Close to the line, the direction from its nearest point is noise.
            let near = 1.0 - smoothstep(0.0, 0.02, p.distance(from));
            let open = 1.0 - smoothstep(0.0, 0.03, from.distance(self.whorl));
            away = (away + Vec3::X * side * 2.0 * near * (1.0 - open)).normalize_or_zero();
        }
        // Toward the crown, hair of both sides sweeps back and covers the end of the parting.
        let crown = match self.parting {
            Some(_) => {
                (1.0 - smoothstep(0.01, 0.06, from.distance(self.whorl)))
                    * (1.0 - smoothstep(0.02, 0.06, p.distance(from)))
            }
            None => {
                // Hair turns around a whorl.
                let near = 1.0 - smoothstep(0.0, 0.05, p.distance(from));
                away = (away + (from - self.marks.skull).normalize_or(Vec3::Y).cross(away) * 2.6 * near)
                    .normalize_or_zero();
                0.0
            }
        };
        let front = self.frontness(p);
        away + Vec3::NEG_Z * (recipe.back * lerp(0.35, 1.0, front) + 3.5 * crown)
            + (Vec3::Z + Vec3::X * 0.12) * recipe.forward * top * smoothstep(-0.01, 0.05, p.z - self.whorl.z)
    }

    /// Returns the path from `root`: points at equal steps, root first.
    pub(crate) fn trace(&self, root: Vec3, index: u32) -> Vec<Vec3> {
        let recipe = self.recipe;
        let mut rng = Rng::new(recipe.seed, index.wrapping_mul(7919) + 17);
        let layer = self.layer(root);
        let side = match self.parting {
            Some(parting) => parting.side(root),
            None => 1f32.copysign(root.x),
        };
        // Hair lies flatter at the parting.
        let parting_fade =
            self.parting.map_or(1.0, |parting| smoothstep(0.0, 0.04, parting.nearest(root).distance(root)));
        // Around a whorl hair stands up, or the crown would look hollow.
        let stand = match self.parting {
            Some(_) => 0.0,
            None => 1.0 - smoothstep(0.005, 0.06, root.distance(self.whorl)),
        };
        let lift = lerp(recipe.lift.at(layer), 0.75, stand)
            * lerp(0.6, 1.0, parting_fade)
            * (1.0 + 0.2 * rng.bell().clamp(-1.5, 1.5));
        let volume = recipe.volume.at(layer) * lerp(0.6, 1.0, parting_fade) * (1.0 + 0.12 * rng.bell());
        // Where hair parts in all directions, some of it crosses over and covers the spot.
        let wild = match self.parting {
            Some(_) => 0.8 * (1.0 - smoothstep(0.006, 0.03, root.distance(self.whorl))),
            None => 1.0 * (1.0 - smoothstep(0.01, 0.035, root.distance(self.whorl))),
        };
        let swing = wild * rng.bell()
            + recipe.tousle * noise(root * 45.0, recipe.seed ^ 91) * 1.6
            + recipe.tousle * 0.5 * rng.bell();
        let fringe = recipe.fringe && self.is_fringe(root);

        let n0 = self.scalp.normal(root);
        let flat = |v: Vec3, n: Vec3| v - n * v.dot(n);
        let combed = flat(self.comb(root, side, fringe), n0)
            .normalize_or(flat(Vec3::NEG_Y, n0).normalize_or(Vec3::NEG_Y));
        let combed = glam::Quat::from_axis_angle(n0, swing) * combed;
        let mut t = (combed * lift.cos() + n0 * lift.sin()).normalize();
        let mut p = root;
        let mut path = vec![p];
        let longest = recipe.length.at(layer) * (1.0 + 0.03 * rng.bell().clamp(-2.0, 2.0));
        let hem = recipe.hem.map(|below| {
            let uneven = noise(root * 60.0, recipe.seed ^ 23) * 0.6 + rng.bell() * 0.3;
            self.marks.chin.y - below + recipe.hem_softness * uneven
        });
        let mut along = 0.0;
        // Where the head holds a path up, it gets no longer.
        let max_points = (2.0 * longest / STEP) as usize;
        while along < longest && path.len() < max_points {
            let d = self.scalp.distance(p);
            let n = self.broad_normal(p);
            let up = smoothstep(-0.35, 0.5, n.y) * smoothstep(self.marks.chin.y, self.marks.ear.y, p.y);
            let mut comb = self.comb(p, side, fringe);
            comb = glam::Quat::from_axis_angle(n, swing * (1.0 - along / 0.12).max(0.0)) * comb;
            // The comb acts along the head, never away from it.
            comb -= n * comb.dot(n);
            // The comb holds hair over the braincase; below and away from it, hair falls.
            let held = smoothstep(self.marks.ear.y - 0.03, self.marks.ear.y + 0.05, p.y)
                * (1.0 - smoothstep(volume + 0.01, volume + 0.05, d));
            let mut target = comb * held * (1.0 - recipe.gravity * 0.45)
                + Vec3::NEG_Y * recipe.gravity * lerp(1.0, 0.55, held);
            // Near the skin, remove the part of the direction along the normal.
            let close = 1.0 - smoothstep(volume, volume + 0.03, d);
            target -= n * target.dot(n) * close;
            target = target.normalize_or(t);
            // Over the ears hair lies closer than above, or it would stand off like the brim of a hat.
            let full = volume * lerp(0.35, 1.0, smoothstep(self.marks.ear.y, self.marks.skull.y + 0.04, p.y));
            let target_distance = full * smoothstep(0.0, 0.035, along).max(0.1);
            let error = (target_distance - d) / 0.012;
            target += n * if error > 0.0 { error.min(1.0) * 0.8 } else { error.max(-1.0) * 0.45 * up };
            if let Some(hem) = hem
                && recipe.tip_in > 0.0
            {
                // The last centimeters turn in toward the neck.
                let last = 1.0 - smoothstep(hem, hem + 0.05, p.y);
                let inward = Vec3::new(-p.x, 0.0, self.marks.nape.z * 0.4 - p.z).normalize_or_zero();
                target += inward * recipe.tip_in * last;
            }
            let depth = self.face.depth(p + t * 0.01);
            if depth > 0.0 && !fringe {
                target += self.face.sideways_direction(p, side) * (depth * 8.0).min(2.0);
            }
            let blend = 1.0 - (-STEP / (recipe.bend * (1.0 + stand))).exp();
            t = t.lerp(target.normalize_or(t), blend).normalize_or(t);
            p += t * STEP;
            if !fringe {
                p = self.face.clear(p, side);
            }
            let clear = 0.0025f32.min(0.2 * along);
            let d = self.scalp.distance(p);
            if d < clear {
                p += self.scalp.normal(p) * (clear - d);
            }
            along += path.last().map_or(0.0, |last| last.distance(p));
            path.push(p);
            let stop =
                if fringe { Some(self.marks.brow.y + 0.008 + 0.006 * noise(root * 90.0, 5)) } else { hem };
            if along >= recipe.shortest && stop.is_some_and(|y| p.y < y) {
                break;
            }
        }
        self.wave(&mut path, root, &mut rng);
        path
    }

    /// Returns the outward normal at `p` without the small forms of the head: hair passes over an ear and does not
    /// follow it.
    fn broad_normal(&self, p: Vec3) -> Vec3 {
        let h = 0.014;
        let d = |axis: Vec3| self.scalp.distance(p + axis * h) - self.scalp.distance(p - axis * h);
        Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)).normalize_or(Vec3::Y)
    }

    /// Returns whether hair from `root` belongs to the fringe: over the forehead, in front of the crown.
    fn is_fringe(&self, root: Vec3) -> bool {
        root.z > self.marks.skull.z + 0.045 && root.x.abs() < 0.042 && root.y > self.marks.brow.y + 0.03
    }

    /// Adds waves to the path that neighboring paths share.
    fn wave(&self, path: &mut [Vec3], root: Vec3, rng: &mut Rng) {
        let recipe = self.recipe;
        if recipe.wave <= 0.0 {
            return;
        }
        let shared = noise(root * 9.0, recipe.seed ^ 57);
        let phase = std::f32::consts::TAU * (0.75 * shared + 0.03 * rng.bell());
        let length =
            recipe.wavelength * (1.0 + 0.12 * noise(root * 12.0, recipe.seed ^ 58) + 0.03 * rng.bell());
        let straight = path.to_vec();
        let mut side = Vec3::ZERO;
        for i in 1..path.len() {
            let along = i as f32 * STEP;
            let tangent = (straight[i] - straight[i - 1]).normalize_or(Vec3::NEG_Y);
            if i == 1 {
                side = tangent.any_orthonormal_vector();
                let out = self.scalp.normal(root);
                side = tangent.cross(out).normalize_or(side);
            }
            side = (side - tangent * side.dot(tangent)).normalize_or(tangent.any_orthonormal_vector());
            let out = side.cross(tangent);
            let grow = smoothstep(0.04, 0.2f32.min(path.len() as f32 * STEP), along);
            let angle = std::f32::consts::TAU * along / length + phase;
            let offset = (side * angle.sin() + out * 0.35 * angle.cos()) * recipe.wave * grow;
            let displaced = self.face.clear(straight[i] + offset, root.x.signum());
            let d = self.scalp.distance(displaced);
            path[i] =
                if d < 0.002 { displaced + self.scalp.normal(displaced) * (0.002 - d) } else { displaced };
        }
    }
}
