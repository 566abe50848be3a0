//! Rest curve of a strand.

use super::avoid::Keeper;
use super::bind::{Scaffold, frames_from};
use super::cells::Cells;
use super::seed::Seed;
use super::variation::add_variation;
use super::{CurlStrand, Curls, Growth, Twist};
use crate::random::{Rng, lerp, smoothstep};
use crate::scalp::{Scalp, stereographic};
use crate::styles::StyledGuides;
use glam::{Vec2, Vec3};

/// Points of the curve of a clump's center.
const CENTER_POINTS: usize = 33;

/// Curl of a clump.
#[derive(Clone, Copy, Debug)]
struct ClumpTwist {
    twist: Twist,
    /// Length of the clump's center, meters.
    length: f32,
    /// Fraction of its path that the curled clump covers.
    fraction: f32,
}

/// Properties of a strand after shaping.
pub(crate) struct StrandOutcome {
    /// Width relative to the usual width.
    pub(crate) fineness: f32,
    /// Fraction of the guides' length at which the strand ends.
    pub(crate) fraction: f32,
}

pub(crate) struct Shaper<'a> {
    scaffold: &'a Scaffold<'a>,
    growth: &'a Growth,
    keeper: Keeper<'a>,
    /// Clump of each strand.
    clump: Vec<u32>,
    /// Uncut curve of each clump's center.
    centers: Vec<Vec3>,
    /// Two directions across each center at each of its points.
    across: Vec<[Vec3; 2]>,
    /// Curl of each clump; empty without curls.
    twists: Vec<ClumpTwist>,
}

impl<'a> Shaper<'a> {
    pub(crate) fn new(
        scaffold: &'a Scaffold,
        styled: &'a StyledGuides,
        growth: &'a Growth,
        scalp: &'a dyn Scalp,
        seeds: &[Seed],
    ) -> Self {
        let skull = scalp.landmarks().skull;
        let mut shaper = Self {
            scaffold,
            growth,
            keeper: Keeper::new(scalp, styled.face, growth.clearance),
            clump: vec![0; seeds.len()],
            centers: Vec::new(),
            across: Vec::new(),
            twists: Vec::new(),
        };
        // A scalp has about 0.065 m². The first strands, which become centers, are as evenly spread as all.
        let target_count = (0.065 / growth.clumps.spacing.max(5e-4).powi(2)) as usize;
        let count = target_count.min(seeds.len() / 4);
        let flat = |seed: &Seed| stereographic(seed.root - skull);
        let flat_roots: Vec<Vec2> = seeds[..count].iter().map(flat).collect();
        let sizes: Vec<f32> =
            (0..count).map(|i| Rng::new(growth.seed ^ 0xc1, i as u32).range(0.55, 1.6).powi(-2)).collect();
        let cells = Cells::new(flat_roots);
        for (i, seed) in seeds.iter().enumerate() {
            let cost = |k: usize, d: f32| {
                // Clumps do not gather hair across the parting.
                let across = seed.parting_distance < 0.02 && seeds[k].side != seed.side;
                d * sizes[k] + if across { 1.0 } else { 0.0 }
            };
            // A center belongs to its own clump, even if another center costs less.
            let own = if i < count { Some(i) } else { cells.nearest(flat(seed), 0.39, cost) };
            shaper.clump[i] = own.unwrap_or(0) as u32;
        }
        shaper.centers = vec![Vec3::ZERO; count * CENTER_POINTS];
        let mut centers = std::mem::take(&mut shaper.centers);
        for (seed, line) in seeds.iter().zip(centers.as_chunks_mut::<CENTER_POINTS>().0) {
            shaper.base(&Seed { fraction: 1.0, ..*seed }, line);
        }
        if growth.curls.any() {
            for (i, (seed, line)) in seeds.iter().zip(centers.as_chunks::<CENTER_POINTS>().0).enumerate() {
                shaper.across.extend(frames_from(line, seed.root - skull));
                let twist = Twist::new(&growth.curls, growth.seed, i as u32, seed.root);
                let length: f32 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
                let fraction = twist.fraction(&growth.curls, growth.paint.curl(seed.uv), length);
                shaper.twists.push(ClumpTwist { twist, length, fraction });
            }
        }
        shaper.centers = centers;
        shaper
    }

    /// Computes the curve by interpolation alone.
    fn base(&self, seed: &Seed, line: &mut [Vec3]) {
        let last = (line.len() - 1) as f32;
        let lead = seed.bound.guides[0];
        let offset = seed.root - self.scaffold.blended(&seed.bound, 0.0);
        let clumps = self.growth.clumps;
        let around = {
            // Offset from the lead guide's root to this root, in the guide's frame.
            let away = seed.root - self.scaffold.sample(lead, 0.0);
            let tangent =
                (self.scaffold.sample(lead, 0.03) - self.scaffold.sample(lead, 0.0)).normalize_or_zero();
            let [u, v] = self.scaffold.across(lead, 0.0);
            Vec3::new(away.dot(u), away.dot(v), away.dot(tangent))
        };
        for (k, p) in line.iter_mut().enumerate() {
            let s = k as f32 / last;
            let t = s * seed.fraction;
            let clumped = || {
                let [u, v] = self.scaffold.across(lead, t);
                let shrink = lerp(1.0, clumps.tip_spread, smoothstep(0.0, 1.0, t));
                let center = self.scaffold.sample(lead, t);
                // The part of the offset along the guide fades out.
                let along = seed.root - self.scaffold.sample(lead, 0.0) - {
                    let [u, v] = self.scaffold.across(lead, 0.0);
                    u * around.x + v * around.y
                };
                center + (u * around.x + v * around.y) * shrink + along * (1.0 - smoothstep(0.0, 0.5, t))
            };
            *p = if seed.clump {
                clumped()
            } else {
                let blend =
                    self.scaffold.blended(&seed.bound, t) + offset * (1.0 - 0.4 * smoothstep(0.0, 1.0, t));
                let pull = clumps.lock * smoothstep(0.15, 1.0, t);
                if pull > 0.0 { blend.lerp(clumped(), pull) } else { blend }
            };
        }
        line[0] = seed.root;
    }

    /// Writes the rest curve of strand `index`.
    pub(crate) fn fill(&self, index: usize, seed: &Seed, rng: &mut Rng, line: &mut [Vec3]) -> StrandOutcome {
        let clump = self.clump[index];
        let twist = self.twists.get(clump as usize);
        let seed = &Seed { fraction: seed.fraction * twist.map_or(1.0, |t| t.fraction), ..*seed };
        self.base(seed, line);
        let stray = rng.unit();
        let flyaway = stray < self.growth.variation.flyaways;
        self.gather(clump, seed, if flyaway { 0.3 } else { 1.0 }, rng, line);
        if let Some(twist) = twist {
            self.wind(clump, twist, seed, flyaway, rng, line);
        }
        add_variation(&self.growth.variation, stray, rng, line);
        self.keeper.keep(line, rng);
        StrandOutcome { fineness: if flyaway { 0.65 } else { 1.0 }, fraction: seed.fraction }
    }

    /// Pulls the strand toward the center of its clump.
    fn gather(&self, clump: u32, seed: &Seed, weight: f32, rng: &mut Rng, line: &mut [Vec3]) {
        let at = clump as usize * CENTER_POINTS;
        let Some(center) = self.centers.get(at..at + CENTER_POINTS) else { return };
        let clumps = self.growth.clumps;
        let mut shared = Rng::new(self.growth.seed ^ 0xbeef, clump);
        // Some clumps are tight, some open.
        let strength = clumps.strength * shared.range(0.45, 1.0).sqrt() * rng.range(0.75, 1.0) * weight;
        let last = (line.len() - 1) as f32;
        for (k, p) in line.iter_mut().enumerate().skip(1) {
            let t = k as f32 / last * seed.fraction;
            let x = t * (CENTER_POINTS - 1) as f32;
            let i = (x as usize).min(CENTER_POINTS - 2);
            let center_point = center[i].lerp(center[i + 1], x - i as f32);
            let profile = smoothstep(clumps.start, 0.85, t);
            *p = p.lerp(center_point, strength * profile);
        }
    }

    /// Winds the strand around its path. The strands of a clump turn together: they share the arc length along the
    /// clump's center and the directions across it.
    fn wind(
        &self,
        clump: u32,
        clump_twist: &ClumpTwist,
        seed: &Seed,
        loose: bool,
        rng: &mut Rng,
        line: &mut [Vec3],
    ) {
        let at = clump as usize * CENTER_POINTS;
        let across = &self.across[at..at + CENTER_POINTS];
        let curls: &Curls = &self.growth.curls;
        let strength = self.growth.paint.curl(seed.uv);
        let own = CurlStrand::new(curls, loose, rng);
        let last = (line.len() - 1) as f32;
        for (k, p) in line.iter_mut().enumerate().skip(1) {
            let t = k as f32 / last * seed.fraction;
            let x = t * (CENTER_POINTS - 1) as f32;
            let i = (x as usize).min(CENTER_POINTS - 2);
            let [u, v] = [0, 1].map(|a| across[i][a].lerp(across[i + 1][a], x - i as f32));
            let o =
                clump_twist.twist.offset(curls, &own, t * clump_twist.length, clump_twist.length) * strength;
            *p += u * o.x + v * o.y + u.cross(v) * o.z;
        }
    }
}
