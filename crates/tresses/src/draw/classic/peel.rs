//! Depth peeling: blends strands from front to back, one layer per pass.

use super::{Canvas, Pipelines, module, vertex};
use crate::{
    Result,
    draw::canvas::{HDR_FORMAT, TextureKind},
    gpu::{
        Binding, Device,
        bindings::layout,
        commands::{colored, deep},
        pipeline::{DEPTH_FORMAT, Recipe, blended},
    },
    light::HairView,
    renderer::ShadingRate,
    stage::Stage,
};

/// Format of the transmittance of the hair behind the last layer.
const PASSES_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// Pipelines of one shading rate. `under` composites one layer and is the same for all rates.
#[derive(Clone, Debug)]
pub(crate) struct Peel {
    layer: wgpu::RenderPipeline,
    blend_layer: wgpu::RenderPipeline,
    thickness: wgpu::RenderPipeline,
    rest: wgpu::RenderPipeline,
}

/// Names of the pipelines of [`Peel`].
pub(super) const PARTS: [&str; 4] = ["layer", "under", "thickness", "rest"];

/// Layouts of the passes' last bind group: the previous layer's depth; a layer; the last layer's depth and the optical
/// thickness behind it.
fn layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 3] {
    use Binding::{Depth, Texture2d};
    let fragment = wgpu::ShaderStages::FRAGMENT;
    [
        layout(device, "peel", fragment, &[Depth]),
        layout(device, "under", fragment, &[Texture2d]),
        layout(device, "rest", fragment, &[Depth, Texture2d, Texture2d]),
    ]
}

/// Returns one of [`PARTS`].
pub(super) fn part(
    pipelines: &Pipelines,
    name: &'static str,
    (rate, near): (ShadingRate, bool),
) -> Result<wgpu::RenderPipeline> {
    use wgpu::{BlendFactor as Factor, CompareFunction::Greater};
    let device = &pipelines.layouts.device;
    let [before, layer, behind] = layouts(device);
    let sums = || blended(HDR_FORMAT, Factor::One, Factor::One);
    let (last, write, targets) = match name {
        "under" => {
            let targets = &[blended(HDR_FORMAT, Factor::OneMinusDstAlpha, Factor::One)];
            return pipelines.parts.get((name, ShadingRate::default(), false), || {
                Recipe {
                    vertex: ("draw::classic::blend_layer", "blend_layer_vertex"),
                    fragment: Some(("draw::classic::blend_layer", "blend_layer_fragment")),
                    layouts: &[&layer],
                    targets,
                    ..Recipe::PLAIN
                }
                .build(device)
            });
        }
        "layer" => (before, true, vec![Some(HDR_FORMAT.into())]),
        "thickness" => (before, false, vec![sums(), sums()]),
        _ => {
            let passes = blended(PASSES_FORMAT, Factor::Zero, Factor::OneMinusSrc);
            (behind, false, vec![sums(), passes])
        }
    };
    let [frame, hair, fiber] = &pipelines.layouts.groups;
    let vertex = vertex(rate);
    pipelines.parts.get((name, rate, near), || {
        Recipe {
            vertex: (module(near), vertex),
            fragment: Some((module(near), &format!("{vertex}_{name}"))),
            layouts: &[frame, hair, fiber, &last],
            targets: &targets,
            depth: Some((write, Greater)),
            ..Recipe::PLAIN
        }
        .build(device)
    })
}

impl Peel {
    pub(super) fn new(pipelines: &Pipelines, variant: (ShadingRate, bool)) -> Result<Self> {
        let part = |name| part(pipelines, name, variant);
        Ok(Self {
            layer: part("layer")?,
            blend_layer: part("under")?,
            thickness: part("thickness")?,
            rest: part("rest")?,
        })
    }

    /// Records the hair. The body is already in the targets.
    pub(super) fn record(
        &self,
        layers: Option<&Layers>,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<()> {
        let (target, frame) = (canvas.target, canvas.frame);
        let layers = layers.ok_or_else(|| crate::Error::Parameter {
            name: "targets",
            value: "without layers".into(),
            range: "made for depth peeling",
        })?;
        let count = canvas.renderer.layers().unwrap_or(1) as usize;
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let white = wgpu::LoadOp::Clear(wgpu::Color::WHITE);
        if hair.is_empty() {
            canvas.begin("hair", &[(&layers.front, clear), (&layers.rest, clear)], None);
            canvas.begin("hair", &[(&layers.rest_passes, white)], None);
            return Ok(());
        }
        // The first layer has nothing in front of it.
        let nearest = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
        let depth = Some((&layers.depth_views[1], Some(nearest)));
        canvas.begin("hair", &[(&layers.front, clear)], depth);
        for i in 0..count {
            let now = &layers.depths[i % 2];
            // Starting from the body's depth keeps hair behind the body from taking up a layer.
            canvas.commands.copy_texture(&target.depth_texture, now);
            let kept = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let depth = Some((&layers.depth_views[i % 2], Some(kept)));
            let mut pass = canvas.begin("hair", &[(&layers.layer, clear)], depth);
            pass.set_pipeline(&self.layer);
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(3, &layers.behind[(i + 1) % 2], &[]);
            hair.iter().for_each(|view| view.record_strips(&mut pass));
            drop(pass);
            let mut pass = canvas.begin("hair", &[(&layers.front, wgpu::LoadOp::Load)], None);
            pass.set_pipeline(&self.blend_layer);
            pass.set_bind_group(0, &layers.blend_layer_group, &[]);
            pass.draw(0..3, 0..1);
            drop(pass);
            canvas.commands.lap(Stage::Hair);
        }
        // Index of the depth texture of the last layer.
        let last = (count + 1) % 2;
        // Optical thickness of the hair behind the last layer.
        let colors = layers.thickness.each_ref().map(|texture| (texture, clear));
        let mut pass = canvas.begin("thickness", &colors, Some((&target.depth, None)));
        pass.set_pipeline(&self.thickness);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(3, &layers.behind[last], &[]);
        hair.iter().for_each(|view| view.record_strips(&mut pass));
        drop(pass);
        canvas.commands.lap(Stage::Thickness);
        let colors = [(&layers.rest, clear), (&layers.rest_passes, white)];
        let mut pass = canvas.begin("hair", &colors, Some((&target.depth, None)));
        pass.set_pipeline(&self.rest);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(3, &layers.rest_behind[last], &[]);
        hair.iter().for_each(|view| view.record_strips(&mut pass));
        Ok(())
    }
}

type Clear<'a> = (&'a wgpu::TextureView, wgpu::LoadOp<wgpu::Color>);

impl Canvas<'_, '_> {
    /// Begins a hair pass into `colors`, timed as `name`. Without operations the depth is read-only.
    fn begin(
        &mut self,
        name: &'static str,
        colors: &[Clear<'_>],
        depth: Option<(&wgpu::TextureView, Option<wgpu::Operations<f32>>)>,
    ) -> crate::gpu::RenderPass<'_> {
        let attachments: Vec<_> = colors.iter().map(|(view, load)| colored(view, *load)).collect();
        let depth = depth.and_then(|(view, operations)| deep(view, operations));
        self.commands.render(name, &attachments, depth)
    }
}

/// Targets of depth peeling for one image size.
#[derive(Debug)]
pub(crate) struct Layers {
    /// Depth of the current and of the previous layer, alternating.
    depths: [wgpu::Texture; 2],
    depth_views: [wgpu::TextureView; 2],
    layer: wgpu::TextureView,
    front: wgpu::TextureView,
    /// Optical thickness of the hair behind the last layer, at four nodes each.
    thickness: [wgpu::TextureView; 2],
    rest: wgpu::TextureView,
    rest_passes: wgpu::TextureView,
    /// Groups to peel behind each of `depths`.
    behind: [wgpu::BindGroup; 2],
    /// Groups to blend the hair behind each of `depths`.
    rest_behind: [wgpu::BindGroup; 2],
    blend_layer_group: wgpu::BindGroup,
}

impl Layers {
    /// Bytes per pixel of the linear target.
    pub const BYTES: u64 = 2 * 4 + 5 * 8 + 2;

    /// Creates the textures with `texture`.
    pub fn new(device: &Device, texture: impl Fn(TextureKind) -> wgpu::Texture) -> Self {
        let [before, layer_layout, behind_layout] = layouts(device);
        use wgpu::{BindingResource::TextureView, TextureUsages as Usages};
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let color = |label, format| view(&texture((label, format, Usages::TEXTURE_BINDING)));
        let depth = |label| texture((label, DEPTH_FORMAT, Usages::TEXTURE_BINDING | Usages::COPY_DST));
        let depths = [depth("layer depth, even"), depth("layer depth, odd")];
        let depth_views = [view(&depths[0]), view(&depths[1])];
        let layer = color("layer", HDR_FORMAT);
        let behind = [0, 1].map(|i| device.group("peel", &before, &[TextureView(&depth_views[i])]));
        let thickness = [color("thickness, near", HDR_FORMAT), color("thickness, far", HDR_FORMAT)];
        let rest_behind = [0, 1].map(|i| {
            let views = [&depth_views[i], &thickness[0], &thickness[1]].map(TextureView);
            device.group("rest", &behind_layout, &views)
        });
        Self {
            front: color("layers", HDR_FORMAT),
            rest: color("hair behind the layers", HDR_FORMAT),
            rest_passes: color("light past that hair", PASSES_FORMAT),
            behind,
            blend_layer_group: device.group("under", &layer_layout, &[TextureView(&layer)]),
            layer,
            thickness,
            rest_behind,
            depths,
            depth_views,
        }
    }

    /// Returns the textures that `present` composites.
    pub(crate) fn presented(&self) -> [&wgpu::TextureView; 3] {
        [&self.front, &self.rest, &self.rest_passes]
    }
}
