//! Level of detail: the cost of hair follows the pixels it covers, not the strands in its file.
//!
//! Once per frame the CPU decides from the size of a pixel at the hair's distance how many strands are
//! drawn, with how many segments, how much wider, and how fast the physics steps. All stages after the
//! guides then process only that many strands and vertices. Nothing is read back.
//!
//! ```text
//! view, bounding sphere ─► Lod::detail ─► Detail ─┬─► StrandBuffers::drawn ─► interpolate, avoid, light, draw
//! curve table, areas ──────┘    ▲                 ├─► widths (kernel) ─► Strand::radius, widening
//! painted levels ───────────────┘                 └─► length of a fixed step
//! ```
//!
//! **Fewer strands** (Cook et al., "Stochastic simplification of aggregate detail", SIGGRAPH 2007). When
//! hair is uploaded to the GPU its strands are put in an order in which every prefix is an even sample
//! ([`arrange`]). The fraction drawn is such that the strands, once widened, are about
//! [`LodOptions::strand_width`] pixels wide. Strands are added in buckets of a quarter of an octave; the
//! last bucket fades in by width, as a whole, so that nothing pops at any fraction.
//!
//! **Wider strands.** Drawn strands are widened by the area of all strands over the area of those drawn, so
//! that the total area is the same at any level, times a little less than 1: wide strands cover gaps and
//! reach beyond outlines, which [`CoverTable`] measures. The kernel `widths` writes the radius of
//! every drawn strand; shading, strips and shadows read that radius. Shadow maps and the grid of ambient
//! light hold the area of full detail. Between those narrower strands the eye sees deeper; so that visible
//! hair is on average as bright as at full detail, the fibres in front of it are counted with a factor,
//! also measured, that differs between lights beside the eye and lights behind the hair
//! ([`CoverTable::factors`]), and light from all sides is asked for where full detail would be seen
//! ([`Detail::sunk`]). Where there are threads all of this is measured while the caller goes on; the first frame with
//! fewer strands waits for it, if it comes so soon.
//!
//! **Fewer segments.** At load [`CurveTable`] measures how far strands deviate when they are drawn with
//! fewer segments, and how much shorter they get (which widens them in turn). A frame uses the number for
//! which they deviate by a fraction of a pixel. The number may be fractional: vertices lie at equal steps
//! of the strand's parameter, and the last step is the remainder. As the number changes all vertices slide
//! along the strand; a new one grows out of the tip.
//!
//! **Slower physics.** Far away the fixed step grows continuously up to twice its length, and that of the
//! grids with it; what is drawn is always interpolated between two steps.
//!
//! **Painted levels** ([`LodLevel`]). Factors on density and width at every root for up to four projected
//! sizes, eight bytes per strand; the kernel blends between them.
//!
//! **Why not levels in the file?** They pop, or are drawn twice while they blend. **Why not decide on the
//! GPU, strand by strand?** Every dispatch would have to be indirect; a head is small compared with its
//! distance. **Why not a random order by hash alone?** The number of strands in each lock would vary as
//! random numbers do; van der Corput's order keeps it even.
//!
//! **Fewer guides**, where [`LodOptions::CROWD`] or its like asks for it: those are simulated that no other is farther from
//! than a few pixels, and lead the others ([`crate::simulate`]). Substeps are halved, hair feels less of other hair and
//! then none, hair that rests or is out of view sleeps.
//!
//! **Known limits.** All guides are tessellated at any level. The table of curves is measured on the rest shape.
//!
//! **Untried.** Strands with an aggregated BSDF per width.

mod cover;
mod curve;
mod guides;
mod later;
mod lit;
mod maps;
mod options;
mod order;
mod seen;
mod widths;

pub use cover::{CoverLevel, CoverTable};
pub use curve::{CurveTable, resample};
pub(crate) use guides::{GuideOrder, order as guide_order};
pub use maps::{LodLevel, MAX_LEVELS, MAX_THICKNESS};
pub use options::{LodMode, LodOptions};
pub use order::{BUCKET_RATIO, arrange, buckets, order};
pub(crate) use widths::Widths;
pub use widths::{StrandLod, WidthParams};

use crate::{
    Camera, Context, Error, Pose, Progress, Result,
    groom::BoundStrands,
    strands::{Drawn, Strand, StrandBuffers},
};
use glam::Vec3;
use std::sync::Arc;

use later::Later;
#[cfg(not(target_arch = "wasm32"))]
use later::Wanted;
use maps::Painted;
use widths::WidthBuffers;

/// The level of detail of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// The height of a pixel at the near side of the hair, metres.
    pub pixel: f32,
    /// Diameter of the hair's bounding sphere, pixels.
    pub size: f32,
    /// The share of the strands that are drawn.
    pub fraction: f32,
    /// How many strands that are at most, those that just appear included.
    pub strands: u32,
    /// The factor on their widths.
    pub width: f32,
    /// What light meets of those widths, as a factor: the area of all strands at full detail.
    pub area: f32,
    /// The factors on the fibres before what is seen: towards a light on the eye's side, and towards one behind
    /// the hair, see [`CoverTable::factors`].
    pub deeper: [f32; 2],
    /// How much deeper in the hair that is seen than in full detail, metres: its light from all sides is that so much
    /// nearer to the eye.
    pub sunk: f32,
    /// The number of segments per strand, not always whole.
    pub segments: f32,
    /// The factor on the length of a fixed step.
    pub step: f32,
    /// How far a guide that is not simulated may be from one that is, metres; 0 simulates all.
    pub reach: f32,
    /// The factor on the number of substeps.
    pub substeps: f32,
    /// The factor on what hair does to other hair.
    pub together: f32,
    /// How much each painted level counts.
    pub levels: [f32; MAX_LEVELS],
}

/// The most strands of the first bucket: fewer than it has are never drawn. With a few hundred, the
/// chance brightness of single strands would show.
const LEAST: u32 = 1000;

/// Fewer segments are never drawn: with one or two, light along a strand would be that at its ends.
const LEAST_SEGMENTS: f32 = 3.0;

/// A last segment shorter than this share of the others is left out: rounding would turn it about.
const LEAST_REST: f32 = 0.02;

/// Where so many fibres lie before each other on average, cells of ambient light that are larger than usual begin to make
/// hair darker, and where it is half a cell of their own that makes up for it; beyond that it may be twice as much.
const PACKED: [f32; 2] = [3.0, 5.0];
const MOST_PACKED: f32 = 2.0;

/// What level of detail knows of one groom.
#[derive(Debug)]
pub struct Lod {
    /// How it is chosen; [`LodOptions::check`] says what is allowed. What fewer strands cost is measured for those that the
    /// hair was made with ([`HairOptions::lod`](crate::HairOptions::lod)).
    pub options: LodOptions,
    /// What fewer segments cost.
    pub curve: Arc<CurveTable>,
    /// What wider strands cost.
    cover: Arc<Later<CoverTable>>,
    /// Around the hair at rest: middle (groom space) and radius, metres.
    pub sphere: (Vec3, f32),
    /// Mean diameter of the strands, metres.
    pub diameter: f32,
    /// See [`Drawn::dense`].
    dense: f32,
    /// See [`Drawn::packed`].
    packed: f32,
    /// The pixel at which strands are left out first where `cover` was measured, metres.
    measured: f32,
    /// How many strands each bucket ends with.
    ends: Arc<[u32]>,
    /// The area of the strands up to there, m².
    areas: Arc<[f64]>,
    strands: Arc<[Strand]>,
    painted: Arc<Painted>,
    segments: u32,
    buffers: WidthBuffers,
    detail: Detail,
    /// Strands that were drawn in the frame before.
    before: u32,
    /// Whether widths have to be set anew, and whether this frame does it.
    stale: bool,
    sets: bool,
}

impl Lod {
    /// For `strands`, which [`arrange`] has put in order and of which `infos` are those on the GPU.
    ///
    /// # Errors
    /// [`crate::Error::Limit`]; [`crate::Error::Parameter`] when the options make no sense.
    pub(crate) async fn new(
        context: &Context,
        strands: BoundStrands,
        infos: &[Strand],
        buffers: &StrandBuffers,
        options: &LodOptions,
        progress: &impl Progress,
    ) -> Result<Self> {
        options.check()?;
        let ends = buckets(buffers.count, LEAST);
        let n = strands.vertex_count as usize;
        let (mut areas, mut area, mut length) = (Vec::new(), 0.0f64, 0.0f64);
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (i, info) in infos.iter().enumerate() {
            let rest = strands.rest[i * n..(i + 1) * n].iter();
            let points: Vec<_> = rest.map(|rest| rest.unpack(&strands.bindings[i])).collect();
            for w in points.windows(2) {
                let edge = f64::from(w[0].0.distance(w[1].0));
                length += edge;
                area += edge * f64::from((w[0].1 + w[1].1) * info.radius);
            }
            (lo, hi) = points.iter().fold((lo, hi), |(lo, hi), (p, _)| (lo.min(*p), hi.max(*p)));
            if ends[areas.len()] == i as u32 + 1 {
                areas.push(area);
            }
        }
        let radius = 0.5 * lo.distance(hi);
        let mut lod = Self {
            options: *options,
            curve: CurveTable::new(&strands).into(),
            cover: Later::known(CoverTable::none()).into(),
            sphere: (0.5 * (lo + hi), radius),
            diameter: (area / length.max(1e-12)).max(1e-9) as f32,
            dense: lit::dense(length as f32 / infos.len().max(1) as f32, radius),
            packed: ((lit::dense(area as f32, radius) - PACKED[0]) / (PACKED[1] - PACKED[0]))
                .clamp(0.0, MOST_PACKED),
            measured: f32::INFINITY,
            painted: Painted::none(infos.len()).into(),
            segments: strands.vertex_count.saturating_sub(1).max(1),
            buffers: WidthBuffers::new(context, buffers)?,
            detail: Detail {
                pixel: 0.0,
                size: f32::INFINITY,
                fraction: 1.0,
                strands: buffers.count,
                width: 1.0,
                area: 1.0,
                deeper: [1.0; 2],
                sunk: 0.0,
                segments: (strands.vertex_count.saturating_sub(1).max(1)) as f32,
                step: 1.0,
                reach: 0.0,
                substeps: 1.0,
                together: 1.0,
                levels: [1.0, 0.0, 0.0, 0.0],
            },
            before: buffers.count,
            stale: false,
            sets: false,
            strands: infos.into(),
            ends: ends.into(),
            areas: areas.into(),
        };
        let first = span(&lod.ends, 0)[1];
        lod.measured = lod.limit();
        let levels = cover::levels(first, lod.measured, &lod.curve, |f| lod.widening(f), |p| lod.segments(p));
        let (infos, sphere) = (infos.to_vec(), lod.sphere);
        #[cfg(not(target_arch = "wasm32"))]
        {
            let _ = progress;
            lod.cover = Arc::new(Later::start(async move |wanted: &Wanted| {
                CoverTable::new(&strands, &infos, sphere, &levels, wanted).await
            }));
        }
        #[cfg(target_arch = "wasm32")]
        {
            let table = CoverTable::new(&strands, &infos, sphere, &levels, progress).await;
            lod.cover = Arc::new(Later::known(table));
        }
        lod.buffers.upload(context, &lod.strands, &lod.ends, &lod.painted);
        lod.buffers.prepare(context, &lod.detail);
        Ok(lod)
    }

    /// Of another head with the same groom, whose strands are in `buffers`: all that was measured is shared.
    pub(crate) fn another(&self, context: &Context, buffers: &StrandBuffers) -> Self {
        Self {
            curve: self.curve.clone(),
            cover: self.cover.clone(),
            ends: self.ends.clone(),
            areas: self.areas.clone(),
            strands: self.strands.clone(),
            painted: self.painted.clone(),
            buffers: self.buffers.another(context, buffers),
            before: 0,
            stale: true,
            sets: false,
            ..*self
        }
    }

    /// From here on strands are in `buffers`, with other room.
    pub(crate) fn move_into(&mut self, context: &Context, buffers: &StrandBuffers) {
        let Context { queue, .. } = context;
        let infos = &self.strands[..self.strands.len().min(buffers.room.strands as usize)];
        queue.write_buffer(&buffers.strands, 0, bytemuck::cast_slice(infos));
        self.buffers = self.buffers.another(context, buffers);
        self.buffers.prepare(context, &self.detail);
        self.stale = true;
    }

    /// The area of all strands, width times length, m².
    pub(crate) fn area(&self) -> f32 {
        self.areas.last().map_or(0.0, |area| *area as f32)
    }

    /// What wider strands cost. Soon after the hair was made it may still be measured, and this waits.
    pub fn cover(&self) -> &CoverTable {
        self.cover.get()
    }

    /// The level of detail of the frame that is being recorded.
    pub fn current(&self) -> &Detail {
        &self.detail
    }

    /// The level of detail of hair that `camera` sees on a head at `head`.
    pub fn seen(&self, camera: &Camera, head: &Pose) -> Detail {
        self.seen_coarser(camera, head, 0.0)
    }

    /// The same with `bias` octaves more of [`LodOptions::bias`].
    pub(crate) fn seen_coarser(&self, camera: &Camera, head: &Pose, bias: f32) -> Detail {
        let (middle, radius) = self.sphere;
        let clip = camera.projection * camera.view;
        let w = (clip * head.point(middle).extend(1.0)).w;
        // A perspective camera's w is the distance, an orthographic one's is 1.
        let per_metre = camera.projection.z_axis.w.abs();
        let nearest = if per_metre > 0.0 { (w - radius * per_metre).max(0.01) } else { w };
        let pixel = camera.pixel();
        let size = 2.0 * radius / (pixel * w.max(nearest));
        self.with(&self.options.coarser(bias), pixel * nearest, size)
    }

    /// The level of detail where a pixel is `pixel` metres high and the hair `size` pixels large.
    pub fn detail(&self, pixel: f32, size: f32) -> Detail {
        self.with(&self.options, pixel, size)
    }

    fn with(&self, options: &LodOptions, pixel: f32, size: f32) -> Detail {
        let limit = self.limit();
        let (fraction, coarse) = match options.mode {
            LodMode::Off => (1.0, 0.0),
            LodMode::Auto => {
                let coarse = pixel * options.bias.exp2();
                ((limit / coarse.max(1e-12)).min(1.0), coarse)
            }
            LodMode::Fixed(fraction) => {
                let fraction = if fraction > 0.0 { fraction.min(1.0) } else { 1.0 };
                (fraction, limit / fraction)
            }
        };
        let levels = self.painted.weights(size);
        let segments = self.segments(coarse);
        let step = match options.mode {
            LodMode::Auto => (coarse / options.slow_pixel.max(1e-9)).clamp(1.0, options.slowest.max(1.0)),
            LodMode::Off | LodMode::Fixed(_) => 1.0,
        };
        let auto = options.mode == LodMode::Auto;
        let substeps = match options.substep_pixel {
            from if auto && from > 0.0 && coarse >= 2.0 * from => 0.25,
            from if auto && from > 0.0 && coarse >= from => 0.5,
            _ => 1.0,
        };
        let together = match options.alone_pixel {
            from if auto && from > 0.0 => (2.0 - coarse / from).clamp(0.0, 1.0),
            _ => 1.0,
        };
        // The share that belongs to this pixel in the table, whatever width strands have now.
        let automatic = (self.measured / pixel.max(1e-12)).min(1.0);
        // In full detail nothing is asked that may not be known yet.
        let [cover, before, behind, sunk] = match options.mode {
            LodMode::Auto | LodMode::Fixed(_) if fraction < 1.0 || automatic < 1.0 => {
                self.cover().factors(fraction, automatic)
            }
            _ => cover::NONE,
        };
        Detail {
            pixel,
            size,
            fraction,
            strands: self.ends[self.bucket(fraction * self.painted.most(&levels))],
            width: match options.mode {
                LodMode::Off => 1.0,
                _ => self.widening(fraction) * cover / self.curve.length(segments),
            },
            area: cover.recip(),
            deeper: [before, behind],
            sunk,
            segments,
            step,
            reach: if auto { options.guides * coarse } else { 0.0 },
            substeps,
            together,
            levels,
        }
    }

    /// The pixel at which strands begin to be left out, metres.
    fn limit(&self) -> f32 {
        self.diameter / self.options.strand_width.max(1e-6)
    }

    /// The number of segments where a pixel is `pixel` metres high.
    fn segments(&self, pixel: f32) -> f32 {
        self.whole(self.curve.segments(self.options.curve_error * (pixel - self.limit()).max(0.0)))
    }

    /// `segments` without a last one that is too short to point anywhere.
    fn whole(&self, segments: f32) -> f32 {
        let least = LEAST_SEGMENTS.min(self.segments as f32);
        let segments = segments.clamp(least, self.segments as f32);
        if segments.fract() < LEAST_REST { segments.floor() } else { segments }
    }

    /// The bucket in which a share of the strands ends.
    fn bucket(&self, fraction: f32) -> usize {
        let last = self.ends.len() - 1;
        (0..last).find(|b| span(&self.ends, *b)[1] >= fraction).unwrap_or(last)
    }

    /// The area of all strands over that of the share `fraction`.
    fn widening(&self, fraction: f32) -> f32 {
        if fraction >= 1.0 {
            return 1.0;
        }
        let bucket = self.bucket(fraction);
        let [from, to] = span(&self.ends, bucket);
        let there = f64::from(((fraction - from) / (to - from)).clamp(0.0, 1.0));
        let before = if bucket == 0 { 0.0 } else { self.areas[bucket - 1] };
        let area = before + (self.areas[bucket] - before) * there;
        let all = self.areas[self.areas.len() - 1];
        if area > 0.0 { (all / area) as f32 } else { 1.0 }
    }

    /// From here on strands are as `detail` has them: what `buffers` is to draw.
    pub(crate) fn set(&mut self, context: &Context, buffers: &mut StrandBuffers, detail: Detail) {
        self.stale |= self.detail != detail;
        self.detail = detail;
        self.buffers.prepare(context, &detail);
        buffers.drawn = self.drawn();
    }

    /// What is drawn at the level of detail that was set last.
    pub(crate) fn drawn(&self) -> Drawn {
        let detail = &self.detail;
        let drawn = Drawn::new(detail.strands, self.segments + 1, detail.segments);
        Drawn {
            area: detail.area,
            deeper: detail.deeper,
            sunk: detail.sunk,
            single: detail.fraction.sqrt(),
            dense: self.dense,
            packed: self.packed,
            ..drawn
        }
    }

    /// Whether widths are those of the level of detail.
    pub(crate) fn is_set(&self) -> bool {
        !self.stale
    }

    /// Begins a frame: how many strands the last one drew.
    pub(crate) fn begin(&mut self) -> u32 {
        self.sets = std::mem::take(&mut self.stale);
        std::mem::replace(&mut self.before, self.detail.strands)
    }

    /// Paints `levels`, at most [`MAX_LEVELS`] with falling sizes; none takes them away.
    pub(crate) fn paint(
        &mut self,
        context: &Context,
        strands: &BoundStrands,
        levels: &[LodLevel],
        skull: Vec3,
    ) -> Result<()> {
        if Arc::strong_count(&self.strands) > 1 {
            return Err(Error::unusable("levels of detail are to be painted before heads share the hair"));
        }
        self.painted = Painted::bake(strands, levels, skull)?.into();
        self.buffers.upload(context, &self.strands, &self.ends, &self.painted);
        self.stale = true;
        Ok(())
    }

    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if self.sets {
            self.buffers.record(pass, self.detail.strands);
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffers.bytes()
    }

    /// Bytes of it that heads share.
    pub(crate) fn shared_bytes(&self) -> u64 {
        self.buffers.shared_bytes()
    }
}

/// The shares of the strands before and with a bucket.
fn span(ends: &[u32], bucket: usize) -> [f32; 2] {
    let all = ends[ends.len() - 1].max(1) as f32;
    let from = if bucket == 0 { 0.0 } else { ends[bucket - 1] as f32 / all };
    [from, ends[bucket] as f32 / all]
}
