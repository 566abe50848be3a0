//! The rest curve of a strand.

use super::Growth;
use super::avoid::Keeper;
use super::bind::{Scaffold, frames};
use super::cells::Cells;
use super::seed::Seed;
use crate::groom::styles::random::{Rng, lerp, smoothstep};
use crate::groom::styles::{Scalp, StyledGuides, stereographic};
use glam::{Quat, Vec2, Vec3};

/// Points of the curve of a clump's centre.
const CENTRE_POINTS: usize = 33;

pub(crate) struct Shaper<'a> {
    scaffold: &'a Scaffold<'a>,
    styled: &'a StyledGuides,
    growth: &'a Growth,
    keeper: Keeper<'a>,
    /// The clump of each strand.
    clump: Vec<u32>,
    /// The uncut curve of each clump's centre.
    centres: Vec<Vec3>,
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
            styled,
            growth,
            keeper: Keeper::new(scalp, styled.face, growth.clearance),
            clump: vec![0; seeds.len()],
            centres: Vec::new(),
        };
        // A scalp has about 0.065 square metres. The first strands are as evenly spread as all.
        let wanted = (0.065 / growth.clumps.spacing.max(5e-4).powi(2)) as usize;
        let count = wanted.min(seeds.len() / 4);
        let flat = |seed: &Seed| stereographic(seed.root - skull);
        let places: Vec<Vec2> = seeds[..count].iter().map(flat).collect();
        let sizes: Vec<f32> =
            (0..count).map(|i| Rng::new(growth.seed ^ 0xc1, i as u32).range(0.55, 1.6).powi(-2)).collect();
        let cells = Cells::new(places);
        for (i, seed) in seeds.iter().enumerate() {
            let cost = |k: usize, d: f32| {
                // Hair does not cross the parting to its clump.
                let side =
                    styled.parting.as_ref().is_some_and(|p| p.side(seeds[k].root) != p.side(seed.root));
                d * sizes[k] + if side && d < 0.02 { 1.0 } else { 0.0 }
            };
            // The nearest by mere distance decides for centres themselves: each is its own.
            let own = if i < count { Some(i) } else { cells.nearest(flat(seed), 0.39, cost) };
            shaper.clump[i] = own.unwrap_or(0) as u32;
        }
        shaper.centres = vec![Vec3::ZERO; count * CENTRE_POINTS];
        let mut centres = std::mem::take(&mut shaper.centres);
        for (seed, line) in seeds.iter().zip(centres.chunks_exact_mut(CENTRE_POINTS)) {
            shaper.base(&Seed { fraction: 1.0, ..*seed }, line);
        }
        shaper.centres = centres;
        shaper
    }

    /// The curve by interpolation alone.
    fn base(&self, seed: &Seed, line: &mut [Vec3]) {
        let last = (line.len() - 1) as f32;
        let lead = seed.bound.guides[0];
        let offset = seed.root - self.scaffold.blended(&seed.bound, 0.0);
        let clumps = self.growth.clumps;
        let around = {
            // The way from the lead guide's root to this one, seen in the guide's frame.
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
                let middle = self.scaffold.sample(lead, t);
                // The part along the guide at the root has nowhere to go further down.
                let along = seed.root - self.scaffold.sample(lead, 0.0) - {
                    let [u, v] = self.scaffold.across(lead, 0.0);
                    u * around.x + v * around.y
                };
                middle + (u * around.x + v * around.y) * shrink + along * (1.0 - smoothstep(0.0, 0.5, t))
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

    /// Writes the rest curve of strand `index` and returns its width against the usual one.
    pub(crate) fn fill(&self, index: usize, seed: &Seed, rng: &mut Rng, line: &mut [Vec3]) -> f32 {
        self.base(seed, line);
        let clump = self.clump[index];
        let stray = rng.unit();
        let flyaway = stray < self.growth.unrest.flyaways;
        self.gather(clump, seed, if flyaway { 0.3 } else { 1.0 }, rng, line);
        if self.styled.curl.radius > 0.0 {
            self.wind(clump, flyaway, rng, line);
        }
        self.unrest(stray, rng, line);
        self.keeper.keep(line, rng);
        if flyaway { 0.65 } else { 1.0 }
    }

    /// Draws the strand to the centre of its clump.
    fn gather(&self, clump: u32, seed: &Seed, share: f32, rng: &mut Rng, line: &mut [Vec3]) {
        let at = clump as usize * CENTRE_POINTS;
        let Some(centre) = self.centres.get(at..at + CENTRE_POINTS) else { return };
        let clumps = self.growth.clumps;
        let mut shared = Rng::new(self.growth.seed ^ 0xbeef, clump);
        // Some clumps are tight, some open.
        let strength = clumps.strength * shared.range(0.45, 1.0).sqrt() * rng.range(0.75, 1.0) * share;
        let last = (line.len() - 1) as f32;
        for (k, p) in line.iter_mut().enumerate().skip(1) {
            let t = k as f32 / last * seed.fraction;
            let x = t * (CENTRE_POINTS - 1) as f32;
            let i = (x as usize).min(CENTRE_POINTS - 2);
            let middle = centre[i].lerp(centre[i + 1], x - i as f32);
            let profile = smoothstep(clumps.start, 1.0, t).sqrt();
            *p = p.lerp(middle, strength * profile);
        }
    }

    /// Winds the strand around its own path.
    fn wind(&self, clump: u32, flyaway: bool, rng: &mut Rng, line: &mut [Vec3]) {
        let curl = self.styled.curl;
        let mut shared = Rng::new(self.growth.seed ^ 0xcafe, clump);
        let radius = curl.radius * shared.range(0.75, 1.25) * (1.0 + 0.12 * rng.bell());
        let pitch = curl.pitch * shared.range(0.8, 1.25);
        let hand = if shared.unit() < 0.5 { 1.0 } else { -1.0 };
        let spread = if flyaway { 1.0 } else { 0.22 };
        let phase = shared.range(0.0, std::f32::consts::TAU) + spread * rng.bell();
        let along = frames(line);
        let mut arc = 0.0;
        let mut before = line[0];
        for (p, [u, v]) in line.iter_mut().zip(along).skip(1) {
            arc += p.distance(before);
            before = *p;
            let grown = radius * smoothstep(0.0, 0.035, arc);
            let angle = hand * std::f32::consts::TAU * arc / pitch.max(1e-3) + phase;
            *p += (u * angle.cos() + v * angle.sin()) * grown;
        }
    }

    /// Fine waves in every strand, and a slow drift away from the path in some.
    fn unrest(&self, stray: f32, rng: &mut Rng, line: &mut [Vec3]) {
        let unrest = self.growth.unrest;
        let reach = if stray < unrest.flyaways {
            unrest.flyaway * rng.range(0.5, 1.3)
        } else if stray < unrest.flyaways + unrest.strays {
            unrest.stray * rng.range(0.3, 1.2)
        } else {
            0.0006
        };
        let length: f32 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
        let drift = rng.bell3().normalize_or(Vec3::X) * reach;
        let turn = Quat::from_axis_angle(rng.bell3().normalize_or(Vec3::Y), rng.range(0.0, 2.5));
        let begin = rng.range(0.0, 0.6);
        let (a, b) = (rng.bell3(), rng.bell3());
        let waves = length / rng.range(0.03, 0.08);
        let phase = rng.range(0.0, 6.3);
        let last = (line.len() - 1) as f32;
        for (k, p) in line.iter_mut().enumerate().skip(1) {
            let s = k as f32 / last;
            let away = smoothstep(begin, 1.15, s);
            let turned = Quat::IDENTITY.lerp(turn, s) * drift;
            let angle = phase + s * waves * std::f32::consts::TAU;
            let fine = (a * angle.sin() + b * (1.7 * angle).cos()) * unrest.frizz * smoothstep(0.0, 0.25, s);
            *p += turned * away + fine;
        }
    }
}
