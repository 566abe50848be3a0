//! Debug views: the grids and guides of the simulation, drawn over the finished frame.
//!
//! ```text
//! mesh ─► depth ───────────────────────────────┐
//! grid (3-D texture) ─► volume, slices ────────┼─► over the frame, after `present`
//!                    ─► arrows, streams ─► lines ┘
//! guides ───────────► guides ───────────► lines
//! outlines (CPU) ───────────────────────► lines
//! ```
//!
//! A `Layer` is one such view. Any number of them are drawn over a frame, in order. They follow `present`, because a
//! color that encodes a number must not be tone mapped, and layers need not match the samples per pixel. Colors are a
//! ramp of even lightness (`ramp.rs`), readable in legends and in print.
//!
//! - **Volume**: a ray per pixel through the box of the grid, with emission and absorption in proportion to the value,
//!   from the near side to the mesh.
//! - **Slices**: the three mid planes of the grid (or others), in the scene or as panels beside it.
//! - **Arrows**: vectors at the points of a lattice. Their lengths are distances traveled in a given time.
//! - **Streams**: lines along the current field, from given seeds.
//! - **Guides**: tessellated guides, colored by a quantity of the simulation.
//! - **Lines**: other outlines, for example of boxes, and the contours of distance fields (`outline.rs`).
//!
//! All line layers share one format, a buffer of `LinePoint`s, and one pipeline, `lines`: camera-facing strips with a
//! width in pixels, soft edges and a dark rim. An arrow is a line of varying width. Kernels fill the buffer, one thread
//! per arrow, streamline or guide sample.
//!
//! Only meshes occlude layers. They are drawn once more into a depth texture of the frame's size. Hair occludes
//! nothing; leave it out of the frame if it is in the way.
//!
//! The views are for debugging, not for production: buffers, bind groups and the depth texture are created again for
//! every frame. Rejected: drawing into the HDR target, which tone maps the colors and ties the layers to its samples.
//! Untried: level sets; lighting of the volume by its gradient.

mod arrows;
mod field;
mod grid;
mod guides;
mod lines;
pub mod outline;
mod overdraw;
mod paint;
mod peak;
mod ramp;
mod record;
mod scratch;
mod slices;
mod strands;
mod streams;
mod terms;
#[cfg(test)]
mod tests;
mod view;
mod volume;

pub(crate) use arrows::Arrows;
pub use grid::GridView;
pub(crate) use grid::Quantity;
pub(crate) use guides::GuideQuantity;
pub(crate) use lines::LinePoint;
pub(crate) use paint::{Paint, PaintUniform};
pub use peak::Peak;
pub use ramp::ramp;
pub use record::{DebugDisplay, DebugViews, panels};
pub(crate) use slices::Slices;
pub(crate) use strands::StrandQuantity;
pub(crate) use streams::Streams;
pub use terms::Term;
pub use view::{ColorScale, DebugView};

use crate::{
    Camera, Context, Pose, Result,
    body::{self, Body},
    collide::ColliderSet,
    gpu::{
        Binding, Commands, Device,
        bindings::{constant, layout},
        commands::{colored, deep},
        pipeline::{DEPTH_FORMAT, Recipe},
    },
    light::HairView,
    renderer::Renderer,
    strands::GuideBuffers,
};

/// A layer over a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Layer<'a> {
    /// A grid as an emissive volume.
    Volume(GridView<'a>, Paint),
    /// Planes through a grid.
    Slices(GridView<'a>, Paint, Slices),
    /// Vectors of a grid on a lattice, colored by their length.
    Arrows(GridView<'a>, Paint, Arrows),
    /// Lines along the vectors of a grid, colored by their length.
    Streams(GridView<'a>, Paint, Streams<'a>),
    /// Guides in their drawn pose, after [`crate::frame::Recorder::follow`].
    Guides(&'a GuideBuffers, Pose, Paint, GuideQuantity),
    /// Distance to the obstacles in the box of a grid, as slices. The grid's texture is not read.
    Distance(&'a ColliderSet, GridView<'a>, [(Paint, Slices); 2]),
    /// One line. A point with a negative alpha interrupts it.
    Lines(&'a [LinePoint], Paint),
}

/// Pipelines of the debug views.
#[derive(Debug)]
pub(crate) struct DebugStage {
    context: Context,
    body: wgpu::RenderPipeline,
    view_layout: wgpu::BindGroupLayout,
    volume: volume::Volume,
    slices: slices::SlicesPipeline,
    lines: lines::Lines,
    arrows: arrows::ArrowsKernel,
    streams: streams::StreamsKernel,
    guides: guides::GuidesKernel,
    overdraw: overdraw::Overdraw,
    /// Created on first use, because it is large.
    field: Option<field::FieldKernel>,
    sampler: wgpu::Sampler,
    /// Depth of meshes, with the size of the last frame.
    depth: Option<([u32; 2], wgpu::TextureView)>,
    encode: bool,
}

/// Resources to record a layer with.
struct Canvas<'a, 'c> {
    device: &'a Device,
    commands: &'a mut Commands<'c>,
    output: &'a wgpu::TextureView,
    depth: &'a wgpu::TextureView,
    camera: &'a Camera,
    /// Bind group with only the camera's uniform.
    view: &'a wgpu::BindGroup,
    sampler: &'a wgpu::Sampler,
    encode: bool,
}

impl DebugStage {
    /// Builds the pipelines, for an output of `format`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when wgpu rejects a pipeline.
    pub fn new(context: &Context, format: wgpu::TextureFormat) -> Result<Self> {
        let device = &context.device;
        let view_layout =
            layout(device, "debug view", wgpu::ShaderStages::VERTEX_FRAGMENT, &[Binding::Uniform]);
        Ok(Self {
            body: body_pipeline(device, &view_layout)?,
            volume: volume::Volume::new(device, format)?,
            slices: slices::SlicesPipeline::new(device, &view_layout, format)?,
            lines: lines::Lines::new(device, &view_layout, format)?,
            arrows: arrows::ArrowsKernel::new(context),
            streams: streams::StreamsKernel::new(context),
            guides: guides::GuidesKernel::new(context),
            overdraw: overdraw::Overdraw::new(context, format),
            field: None,
            depth: None,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("debug"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            context: context.clone(),
            view_layout,
            encode: !format.is_srgb(),
        })
    }

    /// Records `layers` over the frame of `camera` in `output`, after `present`. `bodies`, in the pose that was drawn
    /// last, only contribute their depth.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the device cannot hold as many lines.
    pub fn record(
        &mut self,
        commands: &mut Commands<'_>,
        camera: &Camera,
        bodies: &[&Body],
        output: &wgpu::TextureView,
        layers: &[Layer<'_>],
    ) -> Result<()> {
        let (view, depth) = self.begin(commands, camera, bodies, output);
        for layer in layers {
            let mut canvas = Canvas {
                device: &self.context.device,
                commands: &mut *commands,
                output,
                depth: &depth,
                camera,
                view: &view,
                sampler: &self.sampler,
                encode: self.encode,
            };
            match layer {
                Layer::Volume(grid, paint) => self.volume.record(&mut canvas, grid, paint),
                Layer::Slices(grid, paint, slices) => self.slices.record(&mut canvas, grid, paint, slices),
                Layer::Arrows(grid, paint, arrows) => {
                    let points = self.arrows.record(&mut canvas, grid, arrows)?;
                    self.lines.record(&mut canvas, &points, 4, paint);
                }
                Layer::Streams(grid, paint, streams) => {
                    if let Some(points) = self.streams.record(&mut canvas, grid, streams)? {
                        self.lines.record(&mut canvas, &points, streams.points.max(2), paint);
                    }
                }
                Layer::Guides(guides, pose, paint, quantity) => {
                    let points = self.guides.record(&mut canvas, guides, pose, *quantity)?;
                    self.lines.record(&mut canvas, &points, guides.line_count(), paint);
                }
                Layer::Distance(colliders, grid, slices) => {
                    let field = self.field.get_or_insert_with(|| field::FieldKernel::new(&self.context));
                    field.record(&mut canvas, grid, colliders)?;
                    let grid = GridView {
                        texture: &field.texture,
                        quantity: Quantity::Channel(0),
                        rotates: false,
                        ..*grid
                    };
                    for (paint, slices) in slices {
                        self.slices.record(&mut canvas, &grid, paint, slices);
                    }
                }
                Layer::Lines(points, paint) => self.lines.record_from_host(&mut canvas, points, paint),
            }
        }
        Ok(())
    }

    /// Records the depth of `bodies` at the size of `output`. Returns the camera's bind group and the depth texture.
    fn begin(
        &mut self,
        commands: &mut Commands<'_>,
        camera: &Camera,
        bodies: &[&Body],
        output: &wgpu::TextureView,
    ) -> (wgpu::BindGroup, wgpu::TextureView) {
        let device = &self.context.device;
        let uniform = constant(device, "debug view", &camera.uniform(1, 1));
        let view = device.group("debug view", &self.view_layout, &[uniform.as_entire_binding()]);
        let size = output.texture().size();
        let depth = self.depth([size.width, size.height]);
        self.record_depth(commands, &view, &depth, bodies);
        (view, depth)
    }

    /// Records the number of strips of `hair` that cover each pixel's center in one pass of `renderer`, in front of
    /// `bodies` and regardless of other hair. `frame` is the bind group of the view that has shaded the strips.
    fn record_overdraw(
        &mut self,
        commands: &mut Commands<'_>,
        camera: &Camera,
        bodies: &[&Body],
        output: &wgpu::TextureView,
        (frame, renderer, hair): (&wgpu::BindGroup, Renderer, &[HairView<'_>]),
        paint: &Paint,
    ) -> Result<()> {
        let (view, depth) = self.begin(commands, camera, bodies, output);
        let mut canvas = Canvas {
            device: &self.context.device,
            commands,
            output,
            depth: &depth,
            camera,
            view: &view,
            sampler: &self.sampler,
            encode: self.encode,
        };
        self.overdraw.record(&mut canvas, (frame, renderer), hair, paint)
    }

    /// Returns a depth texture of `size`, the last one if it has this size.
    fn depth(&mut self, size: [u32; 2]) -> wgpu::TextureView {
        if let Some((_, view)) = self.depth.as_ref().filter(|(of, _)| *of == size) {
            return view.clone();
        }
        let [width, height] = size;
        let view = self
            .context
            .device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some("debug depth"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: DEPTH_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
            .create_view(&Default::default());
        self.depth = Some((size, view.clone()));
        view
    }

    fn record_depth(
        &self,
        commands: &mut Commands<'_>,
        view: &wgpu::BindGroup,
        depth: &wgpu::TextureView,
        bodies: &[&Body],
    ) {
        let cleared = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
        let mut pass = commands.render("debug", &[], deep(depth, Some(cleared)));
        pass.set_pipeline(&self.body);
        pass.set_bind_group(0, view, &[]);
        bodies.iter().for_each(|body| body.record(&mut pass, 0.0));
    }
}

impl Canvas<'_, '_> {
    /// Begins a render pass over the frame. `hidden` enables the test against the depth of meshes.
    fn pass(&mut self, hidden: bool) -> crate::gpu::RenderPass<'_> {
        let color = colored(self.output, wgpu::LoadOp::Load);
        let depth = hidden.then(|| deep(self.depth, None)).flatten();
        self.commands.render("debug", &[color], depth)
    }

    fn paint(&self, paint: &Paint) -> wgpu::Buffer {
        constant(self.device, "paint", &PaintUniform::new(paint, self.camera, self.encode))
    }

    fn grid(&self, grid: &GridView<'_>) -> wgpu::Buffer {
        constant(self.device, "grid", &grid.uniform())
    }
}

/// Creates the pipeline that draws meshes into depth only.
fn body_pipeline(device: &Device, view: &wgpu::BindGroupLayout) -> Result<wgpu::RenderPipeline> {
    Recipe {
        vertex: ("draw::body::0", "body_vertex"),
        layouts: &[view, &body::layout(device)],
        buffers: &[Some(Body::LAYOUT)],
        depth: Some((true, wgpu::CompareFunction::Greater)),
        ..Recipe::PLAIN
    }
    .build(device)
}

/// Creates a pipeline that blends premultiplied colors over the frame, with entry points `{name}_vertex` and
/// `{name}_fragment` of `views::{name}`.
fn overlay(
    device: &Device,
    module: &'static str,
    layouts: &[&wgpu::BindGroupLayout],
    format: wgpu::TextureFormat,
    topology: wgpu::PrimitiveTopology,
    hidden: bool,
) -> Result<wgpu::RenderPipeline> {
    let name = module.rsplit("::").next().unwrap_or(module);
    Recipe {
        vertex: (module, &format!("{name}_vertex")),
        fragment: Some((module, &format!("{name}_fragment"))),
        layouts,
        targets: &[Some(wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        })],
        topology,
        depth: hidden.then_some((false, wgpu::CompareFunction::Greater)),
        ..Recipe::PLAIN
    }
    .build(device)
}
