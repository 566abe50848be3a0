//! A budget for crowds: levels of detail are chosen so that all heads together stay within a time and a memory limit.
//!
//! ```text
//! camera, heads ─► drawing, simulation and memory of each head at a bias ─► CostModel ─► milliseconds ─┐
//!        ▲                                                                               bytes ────────┤
//!        └───────────── smallest bias that meets both limits (bisection) ◄─────────────────────────────┘
//! ```
//!
//! One [bias](crate::lod::LodOptions::bias) applies to all heads. Strands are then equally wide in pixels on each, so
//! no head looks coarser than another. It also minimizes the total error: an octave of bias saves about the same
//! fraction of the cost on each head and is equally visible on each. (Funkhouser and Séquin, "Adaptive display
//! algorithm for interactive frame rates", SIGGRAPH 1993, weigh benefit by cost; here the ratio is the same for all
//! heads.)
//!
//! The cost model is linear: each kind of work has a factor. [`CostModel::fit`] estimates the factors from timed frames
//! by non-negative least squares, with the previously known factors as a prior. The default factors are from a software
//! driver; their proportions serve on other devices until frames are timed. Bytes are counted, not estimated.
//!
//! The bias changes by at most [`MAX_BIAS_CHANGE`] octaves per frame, so that a single slow frame has no visible
//! effect. Timings differ from run to run, and so may levels. For reproducible runs, leave [`Budget::milliseconds`]
//! infinite.
//!
//! [`CrowdBudget`](crate::character::CrowdBudget) applies a [`Budget`] to the characters of a frame.
//! Hosts that own [`Hair`] directly call [`Budget::look_from`].

use crate::{
    Camera, Pose,
    hair::Hair,
    lod::{Detail, LodOptions},
};

/// Limits for all heads of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Time for hair per frame, ms, measured like the frames that the costs were fitted to.
    pub milliseconds: f32,
    /// GPU memory of the heads including the view's buffers for them, bytes.
    pub bytes: u64,
}

impl Default for Budget {
    /// No limits.
    fn default() -> Self {
        Self { milliseconds: f32::INFINITY, bytes: u64::MAX }
    }
}

/// GPU memory that a view needs for heads.
pub struct ViewBytes<'a> {
    /// Bytes per drawn vertex, including its color.
    pub vertex: u64,
    /// Bytes for the head of this index while it is in view, given the extra bias in octaves: the lighting of its
    /// [zone](crate::light::Zone::bytes).
    pub head: &'a dyn Fn(usize, f32) -> u64,
}

impl ViewBytes<'_> {
    /// Bytes per vertex drawn by tiles: points, lists, colors and shading.
    pub const BY_TILES: u64 = 63;
}

/// Maximum change of the bias per frame, octaves.
pub const MAX_BIAS_CHANGE: f32 = 0.125;
/// Maximum bias that a budget adds, octaves.
pub const MAX_BUDGET_BIAS: f32 = 6.0;

/// Work that heads cause in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Heads in view.
    pub heads: f64,
    /// Drawn strand vertices.
    pub vertices: f64,
    /// Solves of single guide vertices: vertices of simulated guides × substeps × steps.
    pub solves: f64,
    /// Steps of self-collision grids.
    pub grids: f64,
    /// Pixels of the squares around heads.
    pub pixels: f64,
}

/// Number of cost factors: the kinds of work and a constant per frame.
const FACTOR_COUNT: usize = 6;

impl Work {
    /// Returns the amounts of work in the order of the cost factors, 1 for the constant.
    fn amounts(&self) -> [f64; FACTOR_COUNT] {
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

/// Linear model of the time that work takes, ms.
#[derive(Clone, Debug, PartialEq)]
pub struct CostModel {
    /// Cost per frame, head, drawn vertex, solve, grid step and pixel, ms.
    factors: [f64; FACTOR_COUNT],
    /// Factors before any frame was timed.
    prior: [f64; FACTOR_COUNT],
    /// Work and milliseconds of the most recent timed frames.
    timed: Vec<([f64; FACTOR_COUNT], f64)>,
}

/// Maximum number of timed frames kept.
const MAX_TIMED_FRAMES: usize = 48;

impl Default for CostModel {
    /// Factors of a software driver on two cores.
    fn default() -> Self {
        Self::new([20.0, 4.0, 1.5e-3, 4e-5, 4.0, 2e-4])
    }
}

impl CostModel {
    /// Creates a model from factors in ms: per frame, head in view, drawn vertex, solve, grid step and pixel. Negative
    /// and non-finite factors become 0.
    pub fn new(factors: [f64; FACTOR_COUNT]) -> Self {
        let factors = factors.map(|factor| if factor.is_finite() { factor.max(0.0) } else { 0.0 });
        Self { factors, prior: factors, timed: Vec::new() }
    }

    /// Returns the factors in the order of [`new`](Self::new).
    pub fn factors(&self) -> [f64; FACTOR_COUNT] {
        self.factors
    }

    /// Returns the estimated cost of `work`, ms.
    pub fn estimate(&self, work: &Work) -> f64 {
        self.factors.iter().zip(work.amounts()).map(|(factor, amount)| factor * amount).sum()
    }

    /// Adds a timed frame and refits the factors to the most recent frames. Ignores times that are not finite and
    /// positive.
    pub fn fit(&mut self, work: &Work, milliseconds: f64) {
        if !(milliseconds.is_finite() && milliseconds > 0.0) {
            return;
        }
        if self.timed.len() == MAX_TIMED_FRAMES {
            self.timed.remove(0);
        }
        self.timed.push((work.amounts(), milliseconds));
        self.factors = self.solve();
    }

    /// Returns the factors that minimize the squared relative errors of the timed frames plus a penalty on deviation
    /// from the scaled prior. The scale is the mean ratio of measured to predicted time, so factors that the frames do
    /// not determine keep their proportions. Uses coordinate descent with factors clamped at zero: the problem is
    /// convex and has six unknowns.
    fn solve(&self) -> [f64; FACTOR_COUNT] {
        let predicted = |work: &[f64; FACTOR_COUNT]| {
            work.iter().zip(&self.prior).map(|(amount, factor)| amount * factor).sum::<f64>()
        };
        let scale = self.timed.iter().map(|(work, ms)| ms / predicted(work).max(1e-12)).sum::<f64>()
            / self.timed.len() as f64;
        let prior = self.prior.map(|factor| factor * scale);
        let penalty = 0.02 * self.timed.len() as f64 / FACTOR_COUNT as f64;
        let mut factors = prior;
        for _ in 0..200 {
            for k in 0..FACTOR_COUNT {
                if prior[k] <= 0.0 {
                    continue;
                }
                let (mut numerator, mut denominator) = (penalty / prior[k], penalty / prior[k].powi(2));
                for (work, ms) in &self.timed {
                    let others: f64 =
                        (0..FACTOR_COUNT).filter(|j| *j != k).map(|j| factors[j] * work[j]).sum();
                    let own = work[k] / ms;
                    numerator += own * (1.0 - others / ms);
                    denominator += own * own;
                }
                factors[k] = (numerator / denominator).max(0.0);
            }
        }
        factors
    }
}

/// The level chosen for one head.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct HeadDetail {
    /// Whether the head is in view.
    pub is_visible: bool,
    /// Whether the hair has come to rest.
    pub is_asleep: bool,
    /// Drawn strands.
    pub strand_count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// Simulated guides.
    pub guide_count: u32,
    /// Substeps per step.
    pub substep_count: u32,
    /// Diameter of the hair in the image, pixels.
    pub size: f32,
    /// GPU memory owned by this head, bytes.
    pub bytes: u64,
}

/// The levels chosen for all heads.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CrowdDetail {
    /// Bias added to each head's own, octaves.
    pub bias: f32,
    /// Total work.
    pub work: Work,
    /// Estimated cost of that work, ms.
    pub milliseconds: f64,
    /// GPU memory, bytes: the own memory of each head, and shared memory once.
    pub bytes: u64,
    /// Whether the budget is met. Even the coarsest levels may exceed it.
    pub fits: bool,
    /// The level of each head.
    pub heads: Vec<HeadDetail>,
}

impl Budget {
    /// Chooses, applies and returns the levels of detail of `heads`, each given with its pose, for `camera`. Call it
    /// before a frame is recorded, instead of [`Hair::look_from`]. `last_bias` is the bias of the last frame
    /// ([`CrowdDetail::bias`]); `None` allows any change of levels, for a first frame or after a cut. `view_bytes`
    /// describes the view's memory for the heads.
    pub fn look_from(
        &self,
        costs: &CostModel,
        camera: &Camera,
        heads: &mut [(&mut Hair, Pose)],
        last_bias: Option<f32>,
        view_bytes: &ViewBytes<'_>,
    ) -> CrowdDetail {
        let plan = |bias: f32, heads: &[(&mut Hair, Pose)]| -> (CrowdDetail, Vec<Detail>) {
            let mut crowd = CrowdDetail { bias, ..CrowdDetail::default() };
            let mut details = Vec::with_capacity(heads.len());
            crowd.bytes = heads.iter().map(|(hair, _)| hair.shared_bytes()).max().unwrap_or(0);
            for (i, (hair, pose)) in heads.iter().enumerate() {
                let detail = hair.lod.detail_with_bias(camera, pose, bias);
                let (mut head, work) = hair.detail_and_work(&detail, camera, pose, view_bytes.vertex);
                head.bytes += if head.is_visible { (view_bytes.head)(i, bias) } else { 0 };
                crowd.bytes += head.bytes;
                crowd.work.add(&work);
                crowd.heads.push(head);
                details.push(detail);
            }
            crowd.milliseconds = costs.estimate(&crowd.work);
            crowd.fits = crowd.milliseconds <= f64::from(self.milliseconds) && crowd.bytes <= self.bytes;
            (crowd, details)
        };
        let target = self.min_bias(|bias| plan(bias, heads).0.fits);
        // The limit on the rate applies to time only, since one slow frame may be an outlier. Memory must fit at once.
        let reachable =
            last_bias.map_or(target, |bias| target.clamp(bias - MAX_BIAS_CHANGE, bias + MAX_BIAS_CHANGE));
        let reachable = reachable.clamp(0.0, MAX_BUDGET_BIAS);
        let (mut crowd, mut details) = plan(reachable, heads);
        if crowd.bytes > self.bytes && target > reachable {
            (crowd, details) = plan(target, heads);
        }
        for ((hair, pose), detail) in heads.iter_mut().zip(details) {
            hair.look_at(camera, pose, detail);
        }
        crowd
    }

    /// Returns the smallest bias that meets the budget, or the largest bias if none does.
    fn min_bias(&self, fits: impl Fn(f32) -> bool) -> f32 {
        if fits(0.0) {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, MAX_BUDGET_BIAS);
        for _ in 0..10 {
            let midpoint = 0.5 * (low + high);
            if fits(midpoint) { high = midpoint } else { low = midpoint }
        }
        high
    }
}

impl Hair {
    /// Returns the level and the work of this hair at `detail`, seen by `camera` on a head at `pose`. A view has
    /// `vertex_bytes` bytes per vertex.
    fn detail_and_work(
        &self,
        detail: &Detail,
        camera: &Camera,
        pose: &Pose,
        vertex_bytes: u64,
    ) -> (HeadDetail, Work) {
        let is_visible = !self.lod.options.can_sleep || self.is_in_view(camera, pose);
        let vertices = detail.segment_count.ceil() as u32 + 1;
        let [guides, substeps] = self.motion_at(detail);
        let required =
            if is_visible { [detail.strand_count, detail.strand_count * vertices] } else { [0; 2] };
        let (capacity, own_bytes) = self.sized_for(required);
        let bytes = own_bytes + vertex_bytes * u64::from(capacity.vertices);
        let is_asleep = self.is_asleep();
        let head = HeadDetail {
            is_visible,
            is_asleep,
            strand_count: if is_visible { detail.strand_count } else { 0 },
            vertex_count: vertices,
            guide_count: if is_visible && !is_asleep { guides } else { 0 },
            substep_count: substeps,
            size: detail.size,
            bytes,
        };
        if !is_visible {
            return (head, Work::default());
        }
        // Assumes one frame per fixed step.
        let steps_per_frame = f64::from(detail.step_scale.max(1.0)).recip();
        let simulated_steps = if is_asleep { 0.0 } else { steps_per_frame };
        let work = Work {
            heads: 1.0,
            vertices: f64::from(detail.strand_count) * f64::from(vertices),
            solves: f64::from(guides)
                * f64::from(self.guides.vertex_count)
                * f64::from(substeps)
                * simulated_steps,
            grids: if detail.self_collision_scale > 0.0 { simulated_steps } else { 0.0 },
            pixels: f64::from(detail.size).powi(2).min(f64::from(camera.size[0]) * f64::from(camera.size[1])),
        };
        (head, work)
    }
}

impl LodOptions {
    /// Returns these options with the bias raised by `octaves`.
    pub fn coarser(self, octaves: f32) -> Self {
        Self { bias: (self.bias + octaves).clamp(-8.0, 8.0), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash::pcg;

    fn random_work(i: u32) -> Work {
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
    fn fit_recovers_factors_from_noisy_frames() {
        let exact = CostModel::new([3.0, 0.5, 4e-5, 2e-6, 0.3, 1e-5]);
        let mut costs = CostModel::default();
        let max_error = |costs: &CostModel| {
            (100..130)
                .map(|i| (costs.estimate(&random_work(i)) / exact.estimate(&random_work(i)) - 1.0).abs())
                .fold(0.0, f64::max)
        };
        let initial_error = max_error(&costs);
        for i in 0..40 {
            // 10 % noise.
            let noise = 0.9 + 0.2 * f64::from(pcg(977 * i)) / f64::from(u32::MAX);
            costs.fit(&random_work(i), exact.estimate(&random_work(i)) * noise);
        }
        println!("{initial_error} {} {:?}", max_error(&costs), costs.factors());
        // Frames that were not used for fitting: within twice the noise of the timed ones.
        assert!(initial_error > 3.0 && max_error(&costs) < 0.2, "{initial_error} {}", max_error(&costs));
        // Identical frames determine only their own cost; the proportions of the factors stay.
        let mut costs = CostModel::default();
        (0..20).for_each(|_| costs.fit(&random_work(3), 7.0));
        assert!((costs.estimate(&random_work(3)) - 7.0).abs() < 0.2, "{}", costs.estimate(&random_work(3)));
        assert!(costs.factors().iter().all(|factor| *factor > 0.0));
        let unchanged = costs.clone();
        costs.fit(&random_work(3), f64::NAN);
        assert_eq!(costs, unchanged);
    }

    #[test]
    fn least_bias_is_smallest_that_fits() {
        let budget = Budget::default();
        assert_eq!(budget.min_bias(|_| true), 0.0);
        assert_eq!(budget.min_bias(|_| false), MAX_BUDGET_BIAS);
        let found = budget.min_bias(|bias| bias >= 1.7);
        assert!((1.7..1.71).contains(&found), "{found}");
    }
}
