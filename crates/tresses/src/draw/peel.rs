//! Depth peeling: strands blended from front to back, one layer per pass.

use super::{
    HairSet, Targets,
    pipeline::{Recipe, blended},
    strips::ByRate,
    targets::{DEPTH_FORMAT, HDR_FORMAT, TextureKind},
};
use crate::{
    gpu::{
        Binding, Timings,
        bindings::{group, layout},
    },
    light::ShadingRate,
};

/// What the hair behind the last layer lets through.
const PASSES_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// The pipelines.
#[derive(Debug)]
pub(crate) struct Peel {
    layers: u32,
    peel_layout: wgpu::BindGroupLayout,
    under_layout: wgpu::BindGroupLayout,
    layer: ByRate,
    under: wgpu::RenderPipeline,
    thickness: ByRate,
    rest_layout: wgpu::BindGroupLayout,
    rest: ByRate,
}

impl Peel {
    pub fn new(
        device: &wgpu::Device,
        layers: u32,
        [frame, hair, fiber]: [&wgpu::BindGroupLayout; 3],
    ) -> Self {
        use wgpu::{BlendFactor as Factor, CompareFunction::Greater};
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let peel_layout = layout(device, "peel", fragment, &[Binding::Depth]);
        let under_layout = layout(device, "under", fragment, &[Binding::Texture2d]);
        let rest_layout =
            layout(device, "rest", fragment, &[Binding::Depth, Binding::Texture2d, Binding::Texture2d]);
        let pass = |kind: &str, last: &wgpu::BindGroupLayout, write, targets: &[_]| {
            ByRate::new(|rate| {
                let [vertex, fragment] = [format!("alpha_{rate}"), format!("alpha_{rate}_{kind}")];
                Recipe {
                    module: "draw::alpha",
                    entry: [&vertex, &fragment],
                    layouts: &[frame, hair, fiber, last].map(Some),
                    buffers: &[],
                    targets,
                    depth: Some((write, Greater)),
                    samples: 1,
                    alpha_to_coverage: false,
                }
                .build(device)
            })
        };
        let under = Recipe {
            module: "draw::under",
            entry: ["under_vertex", "under_fragment"],
            layouts: &[Some(&under_layout)],
            buffers: &[],
            targets: &[blended(HDR_FORMAT, Factor::OneMinusDstAlpha, Factor::One)],
            depth: None,
            samples: 1,
            alpha_to_coverage: false,
        };
        Self {
            layers,
            layer: pass("layer", &peel_layout, true, &[Some(HDR_FORMAT.into())]),
            under: under.build(device),
            thickness: pass(
                "thickness",
                &peel_layout,
                false,
                &[(); 2].map(|()| blended(HDR_FORMAT, Factor::One, Factor::One)),
            ),
            rest: pass(
                "rest",
                &rest_layout,
                false,
                &[
                    blended(HDR_FORMAT, Factor::One, Factor::One),
                    blended(PASSES_FORMAT, Factor::Zero, Factor::OneMinusSrc),
                ],
            ),
            peel_layout,
            under_layout,
            rest_layout,
        }
    }

    /// Records the hair before the body that is in `targets`.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        mut timings: Option<&mut Timings>,
        frame: &wgpu::BindGroup,
        rate: ShadingRate,
        targets: &Targets,
        hair: &HairSet,
    ) {
        let Some(layers) = &targets.layers else {
            panic!("depth peeling draws into the targets that its own stage has made")
        };
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        // Before the first layer lies nothing.
        let nearest = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
        let timed = timings.as_deref_mut();
        begin(
            encoder,
            (timed, "hair"),
            &[(&layers.front, clear)],
            Some((&layers.depth_views[1], Some(nearest))),
        );
        for i in 0..self.layers as usize {
            let now = &layers.depths[i % 2];
            // The body hides what is behind it; hair that it hides must not take up a layer.
            encoder.copy_texture_to_texture(
                targets.depth_texture.as_image_copy(),
                now.as_image_copy(),
                now.size(),
            );
            let kept = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let timed = timings.as_deref_mut();
            let depth = Some((&layers.depth_views[i % 2], Some(kept)));
            let mut pass = begin(encoder, (timed, "hair"), &[(&layers.layer, clear)], depth);
            pass.set_pipeline(self.layer.of(rate));
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(3, &layers.behind[(i + 1) % 2], &[]);
            hair.record_strips(&mut pass);
            drop(pass);
            let timed = timings.as_deref_mut();
            let mut pass = begin(encoder, (timed, "hair"), &[(&layers.front, wgpu::LoadOp::Load)], None);
            pass.set_pipeline(&self.under);
            pass.set_bind_group(0, &layers.under, &[]);
            pass.draw(0..3, 0..1);
        }
        self.record_thickness(encoder, timings.as_deref_mut(), frame, rate, targets, hair);
        let last = self.last();
        let colors = [(&layers.rest, clear), (&layers.rest_passes, wgpu::LoadOp::Clear(wgpu::Color::WHITE))];
        let mut pass = begin(encoder, (timings, "hair"), &colors, Some((&targets.depth, None)));
        pass.set_pipeline(self.rest.of(rate));
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(3, &layers.rest_behind[last], &[]);
        hair.record_strips(&mut pass);
    }

    /// Which of the two depths is that of the last layer.
    fn last(&self) -> usize {
        (self.layers as usize + 1) % 2
    }

    /// Records how thick the hair behind the last layer is; that layer's depth is in `targets`.
    pub fn record_thickness(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        frame: &wgpu::BindGroup,
        rate: ShadingRate,
        targets: &Targets,
        hair: &HairSet,
    ) {
        let Some(layers) = &targets.layers else { return };
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let colors = layers.thickness.each_ref().map(|texture| (texture, clear));
        let mut pass = begin(encoder, (timings, "thickness"), &colors, Some((&targets.depth, None)));
        pass.set_pipeline(self.thickness.of(rate));
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(3, &layers.behind[self.last()], &[]);
        hair.record_strips(&mut pass);
    }

    /// Clears the layers of a picture without hair.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        let Some(layers) = &targets.layers else { return };
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let white = wgpu::LoadOp::Clear(wgpu::Color::WHITE);
        begin(encoder, (None, "hair"), &[(&layers.front, clear), (&layers.rest, clear)], None);
        begin(encoder, (None, "hair"), &[(&layers.rest_passes, white)], None);
    }
}

type Cleared<'a> = (&'a wgpu::TextureView, wgpu::LoadOp<wgpu::Color>);

/// A pass of hair into `colors`, timed under a name; without operations, depth is read only.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    (timings, name): (Option<&mut Timings>, &'static str),
    colors: &[Cleared<'_>],
    depth: Option<(&wgpu::TextureView, Option<wgpu::Operations<f32>>)>,
) -> wgpu::RenderPass<'e> {
    let attachments: Vec<_> = colors
        .iter()
        .map(|(view, load)| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: *load, store: wgpu::StoreOp::Store },
            })
        })
        .collect();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &attachments,
        depth_stencil_attachment: depth.map(|(view, depth_ops)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops,
            stencil_ops: None,
        }),
        timestamp_writes: timings.and_then(|timings| timings.render(name)),
        ..Default::default()
    })
}

/// The textures of one picture size.
#[derive(Debug)]
pub(crate) struct Layers {
    /// Depth of this layer and of the one before it, in turn.
    depths: [wgpu::Texture; 2],
    depth_views: [wgpu::TextureView; 2],
    layer: wgpu::TextureView,
    front: wgpu::TextureView,
    /// How thick the hair behind the last layer is, at four knots each.
    thickness: [wgpu::TextureView; 2],
    rest: wgpu::TextureView,
    rest_passes: wgpu::TextureView,
    /// Bound to peel what is behind each of `depths`.
    behind: [wgpu::BindGroup; 2],
    /// The same, to blend it.
    rest_behind: [wgpu::BindGroup; 2],
    under: wgpu::BindGroup,
}

impl Layers {
    /// Bytes per pixel of the linear target.
    pub const BYTES: u64 = 2 * 4 + 5 * 8 + 2;

    /// Textures that `texture` makes, bound for `peel`.
    pub fn new(device: &wgpu::Device, peel: &Peel, texture: impl Fn(TextureKind) -> wgpu::Texture) -> Self {
        use wgpu::{BindingResource::TextureView, TextureUsages as Usages};
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let color = |label, format| view(&texture((label, format, Usages::TEXTURE_BINDING)));
        let depth = |label| texture((label, DEPTH_FORMAT, Usages::TEXTURE_BINDING | Usages::COPY_DST));
        let depths = [depth("layer depth, even"), depth("layer depth, odd")];
        let depth_views = [view(&depths[0]), view(&depths[1])];
        let layer = color("layer", HDR_FORMAT);
        let behind =
            [0, 1].map(|i| group(device, "peel", &peel.peel_layout, &[TextureView(&depth_views[i])]));
        let thickness = [color("thickness, near", HDR_FORMAT), color("thickness, far", HDR_FORMAT)];
        let rest_behind = [0, 1].map(|i| {
            let views = [&depth_views[i], &thickness[0], &thickness[1]].map(TextureView);
            group(device, "rest", &peel.rest_layout, &views)
        });
        Self {
            front: color("layers", HDR_FORMAT),
            rest: color("hair behind the layers", HDR_FORMAT),
            rest_passes: color("light past that hair", PASSES_FORMAT),
            behind,
            under: group(device, "under", &peel.under_layout, &[TextureView(&layer)]),
            layer,
            thickness,
            rest_behind,
            depths,
            depth_views,
        }
    }

    /// What `present` puts together.
    pub fn presented(&self) -> [&wgpu::TextureView; 3] {
        [&self.front, &self.rest, &self.rest_passes]
    }
}
