//! Records frames that show a [`super::DebugView`].

use super::{
    Arrows, ColorScale, DebugStage, DebugView, GridView, GuideQuantity, Layer, LinePoint, Paint, Slices,
    Streams, outline::Pen, strands::StrandsKernel, terms::Terms, view::grid,
};
use crate::{
    Camera, Context, Pose, Result,
    body::Body,
    camera::ToneMap,
    gpu::Commands,
    groom::SdfGrid,
    hair::Hair,
    light::HairView,
    view::{Picture, View},
    wind::Air,
};
use glam::{Vec3, Vec4};

/// Approximate distance between contour planes, meters.
const CONTOURS: f32 = 0.01;
/// Distance from the surface at which hair touches it, and at which contours are drawn, meters.
const CONTACT: f32 = 1.5e-3;
/// Height of a panel in the column of slices, clip space, see [`Slices::panels`]. Three panels fill the column.
const PANEL: f32 = 0.6;
/// Streamlines along each edge of the face where the wind enters.
const STREAMS: u32 = 24;
/// Steps of a streamline across the grid.
const STEPS: u16 = 96;

/// The active debug view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DebugDisplay {
    /// Debug view.
    pub view: DebugView,
    /// Value drawn brightest; `None` for the default of [`DebugView::scale`].
    pub high: Option<f32>,
}

impl DebugDisplay {
    /// Shows a view with default settings.
    pub fn new(view: DebugView) -> Self {
        Self { view, high: None }
    }

    /// Returns the color scale, with `high` applied.
    pub fn scale(&self) -> Option<ColorScale> {
        self.view.scale().map(|scale| match self.high {
            Some(high) => ColorScale { high, low: if scale.low < 0.0 { -high } else { 0.0 }, ..scale },
            None => scale,
        })
    }

    /// Returns the settings of a frame with this view.
    pub(crate) fn picture(&self, picture: &Picture) -> Picture {
        let mut picture = picture.clone();
        if self.view.strands().is_some() || self.view == DebugView::Shadow {
            // A color that encodes a value is not tone mapped.
            picture.tone = ToneMap { exposure: 1.0, shoulder: 0.99, desaturation: 0.0 };
        }
        picture
    }

    /// Whether the view replaces the image of the hair.
    pub(crate) fn hides_hair(&self) -> bool {
        self.view.hides_hair()
    }

    /// Value drawn brightest.
    fn high(&self) -> f32 {
        self.scale().map_or(1.0, |scale| scale.high)
    }
}

/// Pipelines of all debug views, and data kept from frame to frame. The caller creates this on first use, so it costs
/// nothing otherwise.
#[derive(Debug)]
pub struct DebugViews {
    stage: DebugStage,
    strands: StrandsKernel,
    terms: Terms,
    /// Contours of the head, groom space.
    contours: Vec<LinePoint>,
}

impl DebugViews {
    /// Creates the pipelines for an output of `format`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when wgpu rejects a pipeline.
    pub fn new(context: &Context, format: wgpu::TextureFormat) -> Result<Self> {
        Ok(Self {
            stage: DebugStage::new(context, format)?,
            strands: StrandsKernel::new(context),
            terms: Terms::new(context),
            contours: Vec::new(),
        })
    }

    /// Sets the distance field of the head that [`DebugView::Colliders`] draws; `None` removes it.
    pub fn set_head(&mut self, field: Option<&SdfGrid>) {
        self.contours.clear();
        let Some(field) = field else { return };
        let every = (CONTOURS / field.cell).round().max(1.0) as u32;
        for (axis, value) in [(1, 0.75), (0, 0.35)] {
            let pen = Pen { value, width: 1.2 };
            pen.contours(&mut self.contours, field, &Pose::IDENTITY, CONTACT, axis, every);
        }
    }

    /// Records the kernels that replace the shading of strands, if the view has any. Returns whether normal shading is
    /// not needed.
    pub(crate) fn shade(
        &self,
        commands: &mut Commands<'_>,
        shown: &DebugDisplay,
        picture: &Picture,
        hair: &[&Hair],
        hair_views: &[HairView<'_>],
    ) -> Result<bool> {
        Ok(match (shown.view.strands(), shown.view.term()) {
            (Some(quantity), _) => {
                for (hair, hair_view) in hair.iter().zip(hair_views) {
                    let eye = picture.camera.eye();
                    self.strands.record(commands, hair, hair_view, (eye, quantity, shown.high()))?;
                }
                true
            }
            (None, Some(term)) => {
                self.terms.record(commands, hair_views, term)?;
                true
            }
            // Overdraw draws the shaded strips.
            (None, None) => shown.view.hides_hair() && shown.view != DebugView::Overdraw,
        })
    }

    /// Records the layers over the finished frame in `output`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the device cannot hold as many lines.
    pub(crate) fn over(
        &mut self,
        commands: &mut Commands<'_>,
        shown: &DebugDisplay,
        picture: &Picture,
        (view, output): (&View, &wgpu::TextureView),
        (hair, hair_views): (&[&Hair], &[HairView<'_>]),
        bodies: &[&Body],
    ) -> Result<()> {
        let (what, camera, high) = (shown.view, &picture.camera, shown.high());
        if what.strands().is_some() || what.term().is_some() {
            return Ok(());
        }
        let low = shown.scale().map_or(0.0, |scale| scale.low);
        let paint = |opacity| Paint { low, high, opacity };
        if what == DebugView::Overdraw {
            let drawn = (&view.light.frame, view.options().renderer, hair_views);
            let (stage, paint) = (&mut self.stage, paint(1.0));
            return stage.record_overdraw(commands, camera, bodies, output, drawn, &paint);
        }
        // Panels have one place. The first groom with a grid has it, and is drawn last.
        let main = hair.iter().position(|hair| grid(what, hair).is_some());
        for (i, hair) in hair.iter().enumerate().rev() {
            let grid = grid(what, hair);
            let lines = self.lines(what, hair, grid.as_ref(), high);
            let seeds = match (what, &grid) {
                (DebugView::Wind, Some(grid)) => {
                    let wind = hair.air.as_ref().map_or(Vec3::ZERO, Air::mean);
                    Streams::upwind(grid, wind, STREAMS)
                }
                _ => Vec::new(),
            };
            let mut layers = layers(what, hair, grid, &lines, &seeds, paint, camera);
            if main != Some(i) {
                layers.retain(|layer| !matches!(layer, Layer::Slices(..) | Layer::Distance(..)));
            }
            self.stage.record(commands, camera, bodies, output, &layers)?;
        }
        Ok(())
    }

    /// Returns the edges of the grid's box, or the contours of the head.
    fn lines(&self, view: DebugView, hair: &Hair, grid: Option<&GridView<'_>>, high: f32) -> Vec<LinePoint> {
        let mut lines = Vec::new();
        match (view, grid) {
            (DebugView::Density | DebugView::Push | DebugView::Wind, Some(grid)) => {
                Pen { value: 0.3 * high, width: 1.0 }.cuboid(&mut lines, grid);
            }
            (DebugView::Colliders, _) => {
                // The first collider is the head's field, which follows the head.
                let pose = hair.colliders.drawn().first().copied().unwrap_or(hair.motion.head);
                let to_world = |p: &LinePoint| LinePoint { position: pose.point(p.position), ..*p };
                lines.extend(self.contours.iter().map(to_world));
            }
            _ => {}
        }
        lines
    }
}

/// Returns the layers of a view.
fn layers<'a>(
    view: DebugView,
    hair: &'a Hair,
    grid: Option<GridView<'a>>,
    lines: &'a [LinePoint],
    seeds: &'a [Vec3],
    paint: impl Fn(f32) -> Paint,
    camera: &Camera,
) -> Vec<Layer<'a>> {
    let high = paint(1.0).high;
    let column = Slices { panels: Some(panels(camera.size)), ..Default::default() };
    let guides = |quantity| vec![Layer::Guides(&hair.guides, hair.motion.to_drawn, paint(1.0), quantity)];
    match (view, grid) {
        (DebugView::Guides, _) => guides(GuideQuantity::Guide),
        (DebugView::Speed, _) => guides(GuideQuantity::Speed),
        (DebugView::Strain, _) => guides(GuideQuantity::Strain),
        (DebugView::Density, Some(grid)) => vec![
            Layer::Lines(lines, paint(0.7)),
            Layer::Volume(grid, paint(60.0)),
            Layer::Slices(grid, paint(1.0), column),
        ],
        (DebugView::Push, Some(grid)) => vec![
            Layer::Lines(lines, paint(0.7)),
            Layer::Volume(grid, paint(30.0)),
            Layer::Arrows(grid, paint(1.0), Arrows::over(&grid, None, hair.volume.grid.resolution, high)),
            Layer::Slices(grid, paint(1.0), column),
        ],
        (DebugView::Wind, Some(grid)) => {
            let step = grid.extent().max_element() / f32::from(STEPS);
            let points = 3 * u32::from(STEPS) / 2;
            vec![
                Layer::Lines(lines, paint(0.7)),
                Layer::Streams(grid, paint(0.8), Streams { seeds, points, step, min_speed: 0.02 * high }),
                Layer::Slices(grid, paint(1.0), column),
            ]
        }
        (DebugView::Distance, Some(grid)) => {
            // The plane that faces the camera.
            let eye =
                (grid.pose.inverse().point(camera.eye()) - (Vec3::splat(0.5) - grid.bias) / grid.scale).abs();
            let axis = if eye.x > eye.y.max(eye.z) { 0 } else { 1 + u32::from(eye.z >= eye.y) };
            let plane = Slices { facing: Some(axis), contours: CONTOURS, ..Default::default() };
            vec![Layer::Distance(
                &hair.colliders,
                grid,
                [(paint(0.85), plane), (paint(1.0), Slices { contours: CONTOURS, ..column })],
            )]
        }
        (DebugView::Colliders, _) => vec![Layer::Lines(lines, Paint { high: 1.0, ..paint(1.0) })],
        _ => Vec::new(),
    }
}

/// Returns the column of panels at the right of a frame of this size, see `Slices::panels`.
pub fn panels([width, height]: [u32; 2]) -> Vec4 {
    let aspect = height as f32 / width.max(1) as f32;
    let gap = (2.0 - 3.0 * PANEL) / 4.0;
    Vec4::new(1.0 - (PANEL + gap) * aspect, 1.0 - PANEL - gap, PANEL, PANEL + gap)
}
