//! Level of detail: the cost of hair depends on the pixels that it covers, not on the strands in its file.
//!
//! Once per frame the CPU chooses how many strands are drawn, with how many segments, how much wider, and how long the
//! physics steps are. The choice depends on the size of a pixel at the hair's distance. All stages after the guides
//! then process only that many strands and vertices. The choice needs no readback.
//!
//! ```text
//! view, bounding sphere ─► Lod::detail ─► Detail ─┬─► StrandBuffers::drawn ─► interpolate, avoid, light, draw
//! curve table, areas ──────┘    ▲                 ├─► widths (kernel) ─► Strand::radius, widening
//! painted levels ───────────────┘                 └─► length of a fixed step
//! ```
//!
//! **Fewer strands** (Cook et al., "Stochastic simplification of aggregate detail", SIGGRAPH 2007). At upload, strands
//! are put into an order in which every prefix is an even sample ([`arrange`]). The fraction drawn is such that the
//! widened strands are about [`LodOptions::strand_width`] pixels wide. Strands are added in buckets of a quarter of an
//! octave. The last bucket fades in as a whole, by width, so nothing pops at any fraction.
//!
//! **Wider strands.** Drawn strands are widened by the area of all strands over the area of the drawn ones, which keeps
//! the total area constant. The width is then reduced slightly, because wide strands cover gaps and extend beyond
//! outlines; `CoverTable` measures by how much. The kernel `widths` writes the radius of every drawn strand; shading,
//! strips and shadows read that radius. Shadow maps and the grid of ambient light contain the area of full detail. The
//! eye sees deeper between the narrowed strands. To keep the mean brightness of visible hair, fiber counts in front of
//! it are scaled by measured factors, which differ between lights beside the eye and lights behind the hair
//! (`CoverTable::factors`), and ambient light is sampled where the surface at full detail would be
//! ([`Detail::sunk`]). The measurements run on a background thread where the platform has threads; the first frame with
//! fewer strands waits for them.
//!
//! **Fewer segments.** At load `CurveTable` measures how far strands deviate when they are drawn with fewer segments,
//! and how much shorter they become (which widens them in turn). A frame uses the number of segments for which the
//! deviation is a fraction of a pixel. The number may be fractional: vertices lie at equal steps of the strand's
//! parameter, and the last step is the remainder. As the number changes, all vertices slide along the strand, and new
//! ones grow out of the tip.
//!
//! **Slower physics.** Far away the fixed step grows continuously to up to twice its length, for guides and grids.
//! Drawn strands are always interpolated between two steps.
//!
//! **Painted levels** ([`LodLevel`]). Factors on density and width at every root for up to four projected sizes, eight
//! bytes per strand. The kernel blends between them.
//!
//! **Why not levels in the file?** They pop, or are drawn twice while they blend. **Why not decide per strand on the
//! GPU?** Every dispatch would have to be indirect, and a head is small compared with its distance. **Why not a random
//! order by hash alone?** The number of strands per lock would vary like random numbers; the van der Corput order keeps
//! it even.
//!
//! **Fewer guides** with options such as [`LodOptions::CROWD`]. The simulated guides are chosen so that no other guide
//! is farther than a few pixels from one of them; the others follow ([`crate::simulate`]). Substeps are halved,
//! self-collision fades out, and hair at rest or out of view sleeps.
//!
//! **Known limits.** All guides are tessellated at any level. `CurveTable` is measured on the rest shape.
//!
//! **Untried.** Strands with an aggregated BSDF per width.

mod cover;
mod curve;
mod guides;
mod lit;
mod maps;
mod options;
mod order;
mod promise;
mod visibility;
mod widths;

pub(crate) use cover::CoverTable;
pub(crate) use curve::CurveTable;
pub use curve::resample;
pub(crate) use guides::{GuideOrder, order as guide_order};
pub use maps::MAX_LEVELS;
pub use options::{LodMode, LodOptions};
pub use order::{arrange, buckets, order};
pub(crate) use widths::Widths;

use crate::{
    Camera, Context, Pose, Progress, Result,
    groom::{BoundStrands, character::LodLevel},
    strands::{DrawCount, Strand, StrandBuffers},
};
use glam::Vec3;
use std::sync::Arc;

use maps::PaintedFactors;
#[cfg(not(target_arch = "wasm32"))]
use promise::CancelToken;
use promise::Promise;
use widths::WidthStage;

/// The level of detail of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Height of a pixel at the near side of the hair, meters.
    pub pixel: f32,
    /// Diameter of the hair's bounding sphere, pixels.
    pub size: f32,
    /// Share of the strands that is drawn.
    pub fraction: f32,
    /// Maximum number of drawn strands, including those that are fading in.
    pub strand_count: u32,
    /// Factor on strand widths.
    pub width: f32,
    /// Factor on strand widths in shadow maps and ambient light, so that they contain the area of full detail.
    pub area: f32,
    /// Factors on fiber counts in front of visible hair: for lights on the eye's side, and for lights behind the hair.
    /// See `CoverTable::factors`.
    pub deeper: [f32; 2],
    /// How much deeper visible hair lies than at full detail, meters. Ambient light is sampled that much nearer to the
    /// eye.
    pub depth_offset: f32,
    /// Number of segments per strand; may be fractional.
    pub segment_count: f32,
    /// Factor on the length of a fixed step.
    pub step_scale: f32,
    /// Maximum distance of a guide that is not simulated from a simulated one, meters; 0 simulates all guides.
    pub guide_distance: f32,
    /// Factor on the number of substeps.
    pub substep_scale: f32,
    /// Factor on the strength of self-collision.
    pub self_collision_scale: f32,
    /// Blend weights of the painted levels.
    pub levels: [f32; MAX_LEVELS],
}

/// Maximum size of the first bucket, which is always drawn. With only a few hundred strands, the random brightness of
/// single strands would be visible.
const FIRST_BUCKET: u32 = 1000;

/// Minimum number of segments. With one or two, light along a strand would be the light at its ends.
const MIN_SEGMENTS: f32 = 3.0;

/// Minimum length of the last segment, relative to the others. Rounding would change the direction of a shorter one, so
/// it is dropped.
const MIN_REMAINDER: f32 = 0.02;

/// Mean numbers of overlapping fibers. At the first, ambient-light cells that are larger than default begin to darken
/// hair. At the second, sampling the light half a cell further ahead compensates for it. [`MAX_PACKED`] limits this
/// offset, in half cells.
const PACKED: [f32; 2] = [3.0, 5.0];
const MAX_PACKED: f32 = 2.0;

/// Levels of detail of a groom, as measured: how the strands change with fewer and wider ones.
#[derive(Debug)]
pub(crate) struct LodTables {
    /// Options for which the tables are measured.
    options: LodOptions,
    /// Error of fewer segments.
    curve: CurveTable,
    /// Coverage of wider strands.
    cover: Promise<CoverTable>,
    /// Bounding sphere of the hair at rest: center (groom space) and radius, meters.
    pub sphere: (Vec3, f32),
    /// Mean diameter of the strands, meters.
    diameter: f32,
    /// See [`DrawCount::dense`].
    dense: f32,
    /// See [`DrawCount::packed`].
    packed: f32,
    /// Number of strands up to the end of each bucket.
    ends: Vec<u32>,
    /// Area of the strands up to the end of each bucket, m².
    areas: Vec<f64>,
    strands: Vec<Strand>,
    painted: PaintedFactors,
    segments: u32,
    /// The strands per strand of the groom, if they are columns of cards. All of them are drawn with all segments at
    /// any distance.
    columns: Option<f32>,
    lods: wgpu::Buffer,
}

/// Level of detail of one head.
#[derive(Debug)]
pub struct Lod {
    /// Options; [`LodOptions::check`] describes the valid ranges. The cost of fewer strands is measured for the options
    /// that the hair was created with ([`HairOptions::lod`](crate::HairOptions::lod)).
    pub options: LodOptions,
    tables: Arc<LodTables>,
    widths: WidthStage,
    detail: Detail,
    /// Number of strands drawn in the last frame.
    before: u32,
    /// Whether widths must be rewritten, and whether this frame does so.
    stale: bool,
    sets: bool,
}

impl LodTables {
    /// Measures `strands`, which must be in the order of [`arrange`]. `infos` are the strands as on the GPU, `painted`
    /// the levels and the center of the braincase. `columns` is the number of strands per strand of the groom where
    /// they are columns of cards.
    ///
    /// # Errors
    /// [`crate::Error::Limit`]; [`crate::Error::Parameter`] for invalid options or levels.
    pub async fn new(
        context: &Context,
        strands: BoundStrands,
        infos: Vec<Strand>,
        options: &LodOptions,
        (levels, skull): (&[LodLevel], Vec3),
        columns: Option<f32>,
        progress: &impl Progress,
    ) -> Result<Self> {
        options.check()?;
        let ends = buckets(infos.len() as u32, FIRST_BUCKET);
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
        let painted = PaintedFactors::bake(&strands, levels, skull)?;
        let mut tables = Self {
            options: *options,
            curve: CurveTable::new(&strands),
            cover: Promise::known(CoverTable::none()),
            sphere: (0.5 * (lo + hi), radius),
            diameter: (area / length.max(1e-12)).max(1e-9) as f32,
            dense: lit::dense(length as f32 / infos.len().max(1) as f32, radius),
            packed: ((lit::dense(area as f32, radius) - PACKED[0]) / (PACKED[1] - PACKED[0]))
                .clamp(0.0, MAX_PACKED),
            segments: strands.vertex_count.saturating_sub(1).max(1),
            columns,
            lods: widths::upload(context, &infos, &ends, &painted)?,
            painted,
            strands: infos.clone(),
            ends,
            areas,
        };
        let first = span(&tables.ends, 0)[1];
        let (sphere, measured) = (tables.sphere, tables.limit(options));
        let levels = cover::levels(
            first,
            measured,
            &tables.curve,
            |fraction| tables.widening(fraction),
            |pixel| tables.segments(options, pixel),
        );
        #[cfg(not(target_arch = "wasm32"))]
        {
            let _ = progress;
            tables.cover = Promise::start(async move |token: &CancelToken| {
                CoverTable::new(&strands, &infos, sphere, &levels, token).await
            });
        }
        #[cfg(target_arch = "wasm32")]
        {
            tables.cover = Promise::known(CoverTable::new(&strands, &infos, sphere, &levels, progress).await);
        }
        Ok(tables)
    }

    /// Returns the area of all strands, width times length, m².
    pub fn area(&self) -> f32 {
        self.areas.last().map_or(0.0, |area| *area as f32)
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.lods.size()
    }

    /// Returns the largest pixel with full detail, meters: strands are dropped above it.
    fn limit(&self, options: &LodOptions) -> f32 {
        self.diameter / options.strand_width.max(1e-6)
    }

    /// Returns the number of segments where a pixel is `pixel` meters high. Drops a last segment that is too short to
    /// have a reliable direction.
    fn segments(&self, options: &LodOptions, pixel: f32) -> f32 {
        let segments = self.curve.segments(options.curve_error * (pixel - self.limit(options)).max(0.0));
        let min_segments = MIN_SEGMENTS.min(self.segments as f32);
        let segments = segments.clamp(min_segments, self.segments as f32);
        if segments.fract() < MIN_REMAINDER { segments.floor() } else { segments }
    }

    /// Returns the bucket that contains the end of a share of the strands.
    fn bucket(&self, fraction: f32) -> usize {
        let last = self.ends.len() - 1;
        (0..last).find(|b| span(&self.ends, *b)[1] >= fraction).unwrap_or(last)
    }

    /// Returns the ratio of the area of all strands to the area of the share `fraction`.
    fn widening(&self, fraction: f32) -> f32 {
        if fraction >= 1.0 {
            return 1.0;
        }
        let bucket = self.bucket(fraction);
        let [from, to] = span(&self.ends, bucket);
        let bucket_fraction = f64::from(((fraction - from) / (to - from)).clamp(0.0, 1.0));
        let before = if bucket == 0 { 0.0 } else { self.areas[bucket - 1] };
        let area = before + (self.areas[bucket] - before) * bucket_fraction;
        let all = self.areas[self.areas.len() - 1];
        if area > 0.0 { (all / area) as f32 } else { 1.0 }
    }
}

impl Lod {
    /// Creates the level of detail of one head at full detail. [`resize`](Self::resize) fills its strand buffers.
    pub(crate) fn new(context: &Context, tables: &Arc<LodTables>, buffers: &StrandBuffers) -> Self {
        Self {
            options: tables.options,
            tables: tables.clone(),
            widths: WidthStage::new(context, &tables.lods, buffers),
            detail: Detail {
                pixel: 0.0,
                size: f32::INFINITY,
                fraction: 1.0,
                strand_count: buffers.count,
                width: 1.0,
                area: 1.0,
                deeper: [1.0; 2],
                depth_offset: 0.0,
                segment_count: tables.segments as f32,
                step_scale: 1.0,
                guide_distance: 0.0,
                substep_scale: 1.0,
                self_collision_scale: 1.0,
                levels: [1.0, 0.0, 0.0, 0.0],
            },
            before: 0,
            stale: true,
            sets: false,
        }
    }

    /// Switches to `buffers` of another capacity.
    pub(crate) fn resize(&mut self, context: &Context, buffers: &StrandBuffers) {
        let infos = &self.tables.strands;
        let infos = &infos[..infos.len().min(buffers.capacity.strands as usize)];
        context.queue.write_buffer(&buffers.strands, 0, bytemuck::cast_slice(infos));
        self.widths = WidthStage::new(context, &self.tables.lods, buffers);
        self.widths.prepare(&self.detail);
        self.stale = true;
    }

    /// Returns the bounding sphere of the hair at rest: center (groom space) and radius, meters.
    pub fn sphere(&self) -> (Vec3, f32) {
        self.tables.sphere
    }

    /// Returns the mean diameter of the strands, meters.
    pub fn diameter(&self) -> f32 {
        self.tables.diameter
    }

    /// Returns the coverage of wider strands. Blocks while it is being measured, soon after the hair is created.
    pub(crate) fn cover(&self) -> &CoverTable {
        self.tables.cover.get()
    }

    /// Returns the level of detail of the frame that is being recorded.
    pub fn current(&self) -> &Detail {
        &self.detail
    }

    /// Returns the level of detail for hair that `camera` sees on a head at `head`.
    pub fn detail_for_camera(&self, camera: &Camera, head: &Pose) -> Detail {
        self.detail_with_bias(camera, head, 0.0)
    }

    /// [`detail_for_camera`](Self::detail_for_camera) with [`LodOptions::bias`] raised by `bias` octaves.
    pub(crate) fn detail_with_bias(&self, camera: &Camera, head: &Pose, bias: f32) -> Detail {
        let (center, radius) = self.tables.sphere;
        let clip = camera.projection * camera.view;
        let w = (clip * head.point(center).extend(1.0)).w;
        // For a perspective camera w is the distance, for an orthographic one it is 1.
        let per_meter = camera.projection.z_axis.w.abs();
        let nearest = if per_meter > 0.0 { (w - radius * per_meter).max(0.01) } else { w };
        let pixel = camera.pixel();
        let size = 2.0 * radius / (pixel * w.max(nearest));
        self.with(&self.options.coarser(bias), pixel * nearest, size)
    }

    /// Returns the level of detail where a pixel is `pixel` meters high and the hair has a diameter of `size` pixels.
    pub fn detail(&self, pixel: f32, size: f32) -> Detail {
        self.with(&self.options, pixel, size)
    }

    fn with(&self, options: &LodOptions, pixel: f32, size: f32) -> Detail {
        let tables = &*self.tables;
        let limit = tables.limit(&self.options);
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
        let levels = tables.painted.weights(size);
        let (fraction, segments, drawn) = match tables.columns {
            Some(_) => (1.0, tables.segments as f32, LodMode::Off),
            None => (fraction, tables.segments(&self.options, coarse), options.mode),
        };
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
        let together = match options.collision_pixel {
            from if auto && from > 0.0 => (2.0 - coarse / from).clamp(0.0, 1.0),
            _ => 1.0,
        };
        // The share that the table associates with this pixel, whatever width strands have now.
        let automatic = (tables.limit(&tables.options) / pixel.max(1e-12)).min(1.0);
        // Full detail must not wait for the measurements.
        let [cover, before, behind, depth_offset] = match drawn {
            LodMode::Auto | LodMode::Fixed(_) if fraction < 1.0 || automatic < 1.0 => {
                self.cover().factors(fraction, automatic)
            }
            _ => cover::NONE,
        };
        Detail {
            pixel,
            size,
            fraction,
            strand_count: tables.ends[tables.bucket(fraction * tables.painted.most(&levels))],
            width: match drawn {
                LodMode::Off => 1.0,
                _ => tables.widening(fraction) * cover / tables.curve.length(segments),
            },
            area: cover.recip(),
            deeper: [before, behind],
            depth_offset,
            segment_count: segments,
            step_scale: step,
            guide_distance: if auto { options.guides * coarse } else { 0.0 },
            substep_scale: substeps,
            self_collision_scale: together,
            levels,
        }
    }

    /// Sets the level of detail and updates what `buffers` draws.
    pub(crate) fn set(&mut self, buffers: &mut StrandBuffers, detail: Detail) {
        self.stale |= self.detail != detail;
        self.detail = detail;
        self.widths.prepare(&detail);
        buffers.drawn = self.drawn();
    }

    /// Returns the drawn part of the strands at the current level of detail.
    pub(crate) fn drawn(&self) -> DrawCount {
        let detail = &self.detail;
        let drawn = DrawCount::new(detail.strand_count, self.tables.segments + 1, detail.segment_count);
        DrawCount {
            area: detail.area,
            deeper: detail.deeper,
            depth_offset: detail.depth_offset,
            single: self.tables.columns.unwrap_or(detail.fraction).min(1.0).sqrt(),
            dense: self.tables.dense,
            packed: self.tables.packed,
            ..drawn
        }
    }

    /// Whether the widths on the GPU match the level of detail.
    pub(crate) fn is_set(&self) -> bool {
        !self.stale
    }

    /// Begins a frame. Returns the number of strands drawn in the last one.
    pub(crate) fn begin(&mut self) -> u32 {
        self.sets = std::mem::take(&mut self.stale);
        std::mem::replace(&mut self.before, self.detail.strand_count)
    }

    pub(crate) fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if self.sets {
            self.widths.record(pass, self.detail.strand_count);
        }
    }

    /// Bytes of GPU memory of this head alone.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.widths.bytes()
    }
}

/// Returns the shares of the strands before and including a bucket.
fn span(ends: &[u32], bucket: usize) -> [f32; 2] {
    let all = ends[ends.len() - 1].max(1) as f32;
    let from = if bucket == 0 { 0.0 } else { ends[bucket - 1] as f32 / all };
    [from, ends[bucket] as f32 / all]
}
