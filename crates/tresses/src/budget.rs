//! A budget for many heads: levels of detail are chosen so that all of them together cost no more.
//!
//! ```text
//! camera, heads ─► what each would draw, simulate and hold at a bias ─► Costs ─► milliseconds ─┐
//!        ▲                                                                        bytes ───────┤
//!        └───────────── the least bias that keeps both (bisection) ◄───────────────────────────┘
//! ```
//!
//! One [bias](crate::lod::LodOptions::bias) for all heads: strands as wide in pixels on each, so that none looks coarser than
//! another. That is also what least error asks for: an octave of bias saves on each head about the same share of what it
//! costs, and is seen on each as much (Funkhouser and Séquin, "Adaptive display algorithm for interactive frame rates",
//! SIGGRAPH 1993, weigh benefit by cost; here both are alike).
//!
//! What work costs is a sum of factors that [`Costs::fit`] finds from frames that were timed: least squares, with the
//! factors that were known before as a prior, and none negative. Without timings they are those of a software driver,
//! whose proportions serve elsewhere until there are some. Bytes are counted, not guessed.
//!
//! The bias follows at most [`FASTEST`] octaves per frame, so that a frame that took long for other reasons does not
//! show. Timings differ from run to run, and so may levels: whoever needs two runs to be the same gives no milliseconds.
//!
//! [`CrowdBudget`](crate::character::CrowdBudget) applies a [`Budget`] to the characters of a frame:
//!
//! ```no_run
//! use tresses::{
//!     Character, Context, HairOptions, Pose, Result, View,
//!     character::{CharacterOptions, CharacterSource, CrowdBudget, Styling},
//!     lod::LodOptions,
//!     view::Picture,
//! };
//!
//! /// Once: characters that share everything that does not move.
//! async fn crowd(tresses: &Context, count: usize) -> Result<Vec<Character>> {
//!     let source = CharacterSource::built_in(tresses, &"long".parse()?, &()).await?;
//!     let parts = source.dress(&Styling::default(), &()).await?;
//!     let hair = HairOptions { lod: LodOptions::CROWD, ..Default::default() };
//!     let options = CharacterOptions { hair, ..Default::default() };
//!     let first = Character::new(tresses, parts, &options, &()).await?;
//!     (0..count).map(|_| first.instance()).collect()
//! }
//!
//! /// Each frame. `milliseconds` is the time that the last one took.
//! fn frame(
//!     tresses: &Context,
//!     encoder: &mut wgpu::CommandEncoder,
//!     (crowd, poses): (&mut [Character], &[Pose]),
//!     (budget, milliseconds): (&mut CrowdBudget, f64),
//!     (view, picture, target): (&mut View, &Picture, &wgpu::TextureView),
//! ) -> Result<()> {
//!     budget.costs.fit(&budget.chosen.work, milliseconds);
//!     for (character, pose) in crowd.iter_mut().zip(poses) {
//!         character.set_pose(*pose);
//!     }
//!     let cameras = [picture.camera];
//!     let mut frame = tresses.frame(encoder).seen_by(&cameras).within(budget);
//!     frame.advance(&mut crowd.iter_mut().collect::<Vec<_>>(), 1.0 / 60.0)?;
//!     frame.draw(view, &crowd.iter().collect::<Vec<_>>(), picture, target)
//! }
//! ```
//!
//! Hosts that hold [`Hair`] themselves call [`Budget::look_from`].

use crate::{
    Camera, Hair, Pose,
    lod::{Detail, LodOptions},
    strands::Room,
};

/// What a frame of all heads may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Milliseconds of hair in a frame, as the frames were timed that costs were fitted to.
    pub milliseconds: f32,
    /// Bytes of GPU memory of the heads, those of a view included.
    pub bytes: u64,
}

impl Default for Budget {
    /// Any time, any memory.
    fn default() -> Self {
        Self { milliseconds: f32::INFINITY, bytes: u64::MAX }
    }
}

/// What a view holds on the GPU for heads, bytes.
pub struct Held<'a> {
    /// For each drawn vertex, its colours included.
    pub vertex: u64,
    /// For the head of this number while it is in view, with so many octaves of bias more: the light of its
    /// [zone](crate::light::Zone::bytes).
    pub head: &'a dyn Fn(usize, f32) -> u64,
}

impl Held<'_> {
    /// For each vertex that tiles draw: points, lists, colours and shading.
    pub const BY_TILES: u64 = 63;
    /// For each vertex of strips: its colours.
    pub const BY_STRIPS: u64 = 4;
}

/// The most octaves by which the bias changes in a frame.
pub const FASTEST: f32 = 0.125;
/// The most that is added to the bias that heads have.
pub const COARSEST: f32 = 6.0;

/// What heads do in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Heads that are in view.
    pub heads: f64,
    /// Drawn strand vertices.
    pub vertices: f64,
    /// Solves of a guide vertex: vertices of guides that are simulated, times substeps, times steps.
    pub solves: f64,
    /// Steps of grids in which hair meets hair.
    pub grids: f64,
    /// Pixels of the squares around heads.
    pub pixels: f64,
}

/// The kinds of work, and that there is a frame at all.
const KINDS: usize = 6;

impl Work {
    fn list(&self) -> [f64; KINDS] {
        [1.0, self.heads, self.vertices, self.solves, self.grids, self.pixels]
    }

    fn add(&mut self, other: &Self) {
        self.heads += other.heads;
        self.vertices += other.vertices;
        self.solves += other.solves;
        self.grids += other.grids;
        self.pixels += other.pixels;
    }
}

/// What work costs, milliseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    /// Of a frame, a head, a drawn vertex, a solve, a step of a grid, a pixel.
    factors: [f64; KINDS],
    /// What was known before anything was timed.
    prior: [f64; KINDS],
    /// The last frames that were timed: their work and milliseconds.
    timed: Vec<([f64; KINDS], f64)>,
}

/// So many frames are remembered.
const REMEMBERED: usize = 48;

impl Default for Costs {
    /// Of a software driver on two cores.
    fn default() -> Self {
        Self::new([20.0, 4.0, 1.5e-3, 4e-5, 4.0, 2e-4])
    }
}

impl Costs {
    /// With these factors: milliseconds of a frame, a head in view, a drawn vertex, a solve, a step of a grid, a pixel.
    pub fn new(factors: [f64; KINDS]) -> Self {
        let factors = factors.map(|factor| if factor.is_finite() { factor.max(0.0) } else { 0.0 });
        Self { factors, prior: factors, timed: Vec::new() }
    }

    /// The factors, in the order of [`new`](Self::new).
    pub fn factors(&self) -> [f64; KINDS] {
        self.factors
    }

    /// What `work` costs, milliseconds.
    pub fn of(&self, work: &Work) -> f64 {
        self.factors.iter().zip(work.list()).map(|(factor, work)| factor * work).sum()
    }

    /// A frame of this work took so long: the factors become those that the last frames tell. A time that is none is
    /// forgotten.
    pub fn fit(&mut self, work: &Work, milliseconds: f64) {
        if !(milliseconds.is_finite() && milliseconds > 0.0) {
            return;
        }
        if self.timed.len() == REMEMBERED {
            self.timed.remove(0);
        }
        self.timed.push((work.list(), milliseconds));
        self.factors = self.solve();
    }

    /// Least squares of relative errors, and of how far factors are from those known before times what all of them are off
    /// by: what frames do not tell apart keeps its proportions. Coordinate by coordinate, none below zero: the problem is
    /// convex, and six numbers are found in no time.
    fn solve(&self) -> [f64; KINDS] {
        let known = |work: &[f64; KINDS]| work.iter().zip(&self.prior).map(|(w, p)| w * p).sum::<f64>();
        let scale = self.timed.iter().map(|(work, ms)| ms / known(work).max(1e-12)).sum::<f64>()
            / self.timed.len() as f64;
        let prior = self.prior.map(|factor| factor * scale);
        let weight = 0.02 * self.timed.len() as f64 / KINDS as f64;
        let mut factors = prior;
        for _ in 0..200 {
            for k in 0..KINDS {
                if prior[k] <= 0.0 {
                    continue;
                }
                let (mut above, mut below) = (weight / prior[k], weight / prior[k].powi(2));
                for (work, ms) in &self.timed {
                    let others: f64 = (0..KINDS).filter(|j| *j != k).map(|j| factors[j] * work[j]).sum();
                    let own = work[k] / ms;
                    above += own * (1.0 - others / ms);
                    below += own * own;
                }
                factors[k] = (above / below).max(0.0);
            }
        }
        factors
    }
}

/// What was chosen for one head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadChosen {
    /// Whether it is in view.
    pub seen: bool,
    /// Whether it has come to rest.
    pub asleep: bool,
    /// Drawn strands.
    pub strands: u32,
    /// Vertices of each.
    pub vertices: u32,
    /// Simulated guides.
    pub guides: u32,
    /// Substeps of each step.
    pub substeps: u32,
    /// Its diameter, pixels.
    pub size: f32,
    /// Bytes of GPU memory that are its own.
    pub bytes: u64,
}

/// What was chosen for all heads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    /// Added to the bias of each, octaves.
    pub bias: f32,
    /// What they are to do.
    pub work: Work,
    /// What that is expected to cost, milliseconds.
    pub milliseconds: f64,
    /// Bytes of GPU memory: of each head, and once what they share.
    pub bytes: u64,
    /// Whether the budget is kept: with the coarsest levels it may not be.
    pub fits: bool,
    /// One by one.
    pub heads: Vec<HeadChosen>,
}

impl Budget {
    /// Chooses the level of detail of `heads`, each with where its head is, for `camera`: call it instead of
    /// [`Hair::look_from`], before a frame is recorded. `before` is the bias of the frame before ([`Chosen::bias`]): `None`
    /// where there was none, so that nobody sees levels change. `held` says what a view holds for them.
    pub fn look_from(
        &self,
        costs: &Costs,
        camera: &Camera,
        heads: &mut [(&mut Hair, Pose)],
        before: Option<f32>,
        held: &Held<'_>,
    ) -> Chosen {
        let plan = |bias: f32, heads: &[(&mut Hair, Pose)]| -> (Chosen, Vec<Detail>) {
            let mut chosen = Chosen { bias, ..Chosen::default() };
            let mut details = Vec::with_capacity(heads.len());
            chosen.bytes = heads.iter().map(|(hair, _)| hair.shared_bytes()).max().unwrap_or(0);
            for (i, (hair, pose)) in heads.iter().enumerate() {
                let detail = hair.lod.seen_coarser(camera, pose, bias);
                let (mut head, work) = hair.at(&detail, camera, pose, held.vertex);
                head.bytes += if head.seen { (held.head)(i, bias) } else { 0 };
                chosen.bytes += head.bytes;
                chosen.work.add(&work);
                chosen.heads.push(head);
                details.push(detail);
            }
            chosen.milliseconds = costs.of(&chosen.work);
            chosen.fits = chosen.milliseconds <= f64::from(self.milliseconds) && chosen.bytes <= self.bytes;
            (chosen, details)
        };
        let wanted = self.least(|bias| plan(bias, heads).0.fits);
        // Memory is there or is not; time may pass for other reasons.
        let reachable = before.map_or(wanted, |bias| wanted.clamp(bias - FASTEST, bias + FASTEST));
        let reachable = reachable.clamp(0.0, COARSEST);
        let (mut chosen, mut details) = plan(reachable, heads);
        if chosen.bytes > self.bytes && wanted > reachable {
            (chosen, details) = plan(wanted, heads);
        }
        for ((hair, pose), detail) in heads.iter_mut().zip(details) {
            hair.look_at(camera, pose, detail);
        }
        chosen
    }

    /// The least bias with which the budget is kept; the coarsest where none keeps it.
    fn least(&self, fits: impl Fn(f32) -> bool) -> f32 {
        if fits(0.0) {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, COARSEST);
        for _ in 0..10 {
            let middle = 0.5 * (low + high);
            if fits(middle) { high = middle } else { low = middle }
        }
        high
    }
}

impl Hair {
    /// What it does and holds at `detail`, seen by `camera` on a head at `pose`.
    fn at(&self, detail: &Detail, camera: &Camera, pose: &Pose, view_bytes: u64) -> (HeadChosen, Work) {
        let seen = !self.lod.options.sleep || self.sees(camera, pose);
        let vertices = detail.segments.ceil() as u32 + 1;
        let [guides, substeps] = self.motion_at(detail);
        let need = if seen { [detail.strands, detail.strands * vertices] } else { [0; 2] };
        let whole = self.strands.whole();
        let room = if self.shares_room() { Room::of(need, whole) } else { whole };
        let per_view = view_bytes * u64::from(room.vertices);
        let bytes =
            self.own_bytes() - self.strand_bytes(self.strands.room) + self.strand_bytes(room) + per_view;
        let asleep = self.is_asleep();
        let head = HeadChosen {
            seen,
            asleep,
            strands: if seen { detail.strands } else { 0 },
            vertices,
            guides: if seen && !asleep { guides } else { 0 },
            substeps,
            size: detail.size,
            bytes,
        };
        if !seen {
            return (head, Work::default());
        }
        // As if frames came at the rate of the steps.
        let steps = f64::from(detail.step.max(1.0)).recip();
        let moves = if asleep { 0.0 } else { steps };
        let work = Work {
            heads: 1.0,
            vertices: f64::from(detail.strands) * f64::from(vertices),
            solves: f64::from(guides) * f64::from(self.guides.vertex_count) * f64::from(substeps) * moves,
            grids: if detail.together > 0.0 { moves } else { 0.0 },
            pixels: f64::from(detail.size).powi(2).min(f64::from(camera.size[0]) * f64::from(camera.size[1])),
        };
        (head, work)
    }
}

/// The levels that [`Budget`] chooses among are those of options that let motion be coarser too.
impl LodOptions {
    /// The same with so many octaves of bias more.
    pub fn coarser(self, octaves: f32) -> Self {
        Self { bias: (self.bias + octaves).clamp(-8.0, 8.0), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::pcg;

    fn work(i: u32) -> Work {
        let random = |k: u32| f64::from(pcg(5 * i + k)) / f64::from(u32::MAX);
        Work {
            heads: 1.0 + 50.0 * random(0),
            vertices: 1e6 * random(1),
            solves: 1e5 * random(2),
            grids: 30.0 * random(3),
            pixels: 1e5 * random(4),
        }
    }

    #[test]
    fn factors_are_found_from_timed_frames() {
        let truth = Costs::new([3.0, 0.5, 4e-5, 2e-6, 0.3, 1e-5]);
        let mut costs = Costs::default();
        let off = |costs: &Costs| {
            (100..130).map(|i| (costs.of(&work(i)) / truth.of(&work(i)) - 1.0).abs()).fold(0.0, f64::max)
        };
        let before = off(&costs);
        for i in 0..40 {
            // 10 % of noise.
            let noise = 0.9 + 0.2 * f64::from(pcg(977 * i)) / f64::from(u32::MAX);
            costs.fit(&work(i), truth.of(&work(i)) * noise);
        }
        println!("{before} {} {:?}", off(&costs), costs.factors());
        // Frames that were not timed, within twice the noise of those that were.
        assert!(before > 3.0 && off(&costs) < 0.2, "{before} {}", off(&costs));
        // One kind of frame tells only what it costs itself, and the proportions stay.
        let mut costs = Costs::default();
        (0..20).for_each(|_| costs.fit(&work(3), 7.0));
        assert!((costs.of(&work(3)) - 7.0).abs() < 0.2, "{}", costs.of(&work(3)));
        assert!(costs.factors().iter().all(|factor| *factor > 0.0));
        let same = costs.clone();
        costs.fit(&work(3), f64::NAN);
        assert_eq!(costs, same);
    }

    #[test]
    fn the_least_bias_is_found() {
        let budget = Budget::default();
        assert_eq!(budget.least(|_| true), 0.0);
        assert_eq!(budget.least(|_| false), COARSEST);
        let found = budget.least(|bias| bias >= 1.7);
        assert!((1.7..1.71).contains(&found), "{found}");
    }
}
