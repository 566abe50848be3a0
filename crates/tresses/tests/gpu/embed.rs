//! Hair in a host application's scene: what is in front of it hides it, what is not covered keeps its bits, and
//! the scene's way of writing depth does not matter.

use crate::common;

use half::f16;
use tresses::{
    Camera, Hair, Pipelines, Pose, View,
    draw::{Coverage, Embed, Surroundings},
    frame::{Recorder, Shows, Sight},
    glam::{
        Mat4, Vec3, Vec4,
        camera::rh::proj::directx::{orthographic, perspective},
    },
    gpu::{Gpu, readback},
    groom::bind,
    light::{Lights, Sphere},
    view::{Picture, ViewOptions},
    wgpu::{self, TextureFormat, TextureUsages},
};

const SIZE: [u32; 2] = [96, 80];
/// Metres from the eye to the middle of the hair.
const DISTANCE: f32 = 0.8;
const FOV: f32 = 0.5;

/// A scene of one colour and one depth, and the hair that is drawn into it.
struct Setup<'a> {
    gpu: &'a Gpu,
    pipelines: &'static Pipelines,
    embed: Embed,
    hair: Hair,
    view: View,
    scene: Picture,
}

impl<'a> Setup<'a> {
    fn new(gpu: &'a Gpu, options: &ViewOptions, ssaa: u32) -> Self {
        let Gpu { device, queue, .. } = gpu;
        let pipelines = common::pipelines().expect("there is a GPU");
        let groom = bind(&common::hanging(500, 16, 0.12), &Default::default()).unwrap();
        let field = common::ball(0.085, 32);
        let mut hair =
            Hair::new(device, queue, pipelines, &groom, &Default::default(), Some(&field)).unwrap();
        common::advance(&mut hair, &common::frame(Pose::IDENTITY, 0.0));
        let scene = Picture {
            camera: Camera::look_at(Vec3::Z * DISTANCE, Vec3::ZERO, FOV, SIZE),
            focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
            lights: Lights::around(0.3),
            ..Default::default()
        };
        Self {
            embed: Embed::new(device, (options.samples, options.coverage), TextureFormat::Rgba16Float)
                .unwrap(),
            view: View::new(device, pipelines, options, SIZE, ssaa).unwrap(),
            pipelines,
            hair,
            scene,
            gpu,
        }
    }

    /// The hair over `color`, where the scene's `projection` has written `depth` everywhere.
    fn over(&self, color: Vec4, projection: Mat4, depth: f32) -> Vec<Vec4> {
        let Gpu { device, queue, .. } = self.gpu;
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene"),
                size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let picture = texture(TextureFormat::Rgba16Float, TextureUsages::COPY_SRC);
        let picture_view = picture.create_view(&Default::default());
        let depths = texture(TextureFormat::Depth32Float, TextureUsages::TEXTURE_BINDING)
            .create_view(&Default::default());
        let [r, g, b, a] = color.to_array().map(f64::from);
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &picture_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depths,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(depth),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let into = Surroundings { color: &picture_view, depth: &depths, projection };
        let sight = Sight { shows: Shows::Over(&self.embed, into), ..Sight::new(&self.view, &self.scene) };
        Recorder { pipelines: self.pipelines, device, queue, encoder: &mut encoder, timings: None }
            .draw(&[&self.hair], &[], sight)
            .unwrap();
        queue.submit([encoder.finish()]);
        let bytes = pollster::block_on(readback::texture(device, queue, &picture)).unwrap();
        let texels: Vec<[f16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        texels.iter().map(|texel| Vec4::from_array(texel.map(f16::to_f32))).collect()
    }

    /// The same, the scene being a wall that stands `distance` metres from the eye.
    fn wall(&self, color: Vec4, projection: Mat4, distance: f32) -> Vec<Vec4> {
        self.over(color, projection, projection.project_point3(Vec3::NEG_Z * distance).z)
    }
}

/// How many pixels are not `color`.
fn covered(picture: &[Vec4], color: Vec4) -> usize {
    picture.iter().filter(|texel| **texel != color).count()
}

/// The largest difference of a channel.
fn difference(a: &[Vec4], b: &[Vec4]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn hair_is_hidden_by_what_is_in_front_of_it() {
    let Some(gpu) = common::gpu() else { return };
    let blue = Vec4::new(0.125, 0.25, 0.5, 1.0);
    let usual = perspective(FOV, SIZE[0] as f32 / SIZE[1] as f32, 0.05, 50.0);
    use Coverage::{SampleMask, Tiles};
    let modes = [(4, 1, SampleMask), (1, 1, SampleMask), (1, 2, SampleMask), (4, 1, Tiles), (1, 2, Tiles)];
    for (samples, ssaa, coverage) in modes {
        let options = ViewOptions { samples, coverage, shadow_resolution: 64, ..Default::default() };
        let stage = Setup::new(gpu, &options, ssaa);
        let [free, halved, hidden] = [20.0, DISTANCE, 0.3].map(|at| stage.wall(blue, usual, at));
        let [some, half, none] = [&free, &halved, &hidden].map(|picture| covered(picture, blue));
        println!(
            "{coverage:?}, {samples} samples, {ssaa} texels: {some} pixels of hair, {half} before a wall in its middle"
        );
        assert_eq!(none, 0, "hair shines through a wall");
        assert!(some > 800, "{some} pixels of hair");
        assert!(half < some && half > some / 2, "{half} of {some} pixels lie before the middle");
        for texel in &free {
            assert!(texel.is_finite() && texel.cmpge(Vec4::ZERO).all(), "{texel}");
        }

        // Whichever way its depth runs, and however far it reaches, the wall hides the same hair.
        let aspect = SIZE[0] as f32 / SIZE[1] as f32;
        let reversed = Camera::perspective(FOV, aspect, 0.02);
        let short = perspective(FOV, aspect, 0.2, 4.0);
        for other in [reversed, short] {
            let picture = stage.wall(blue, other, DISTANCE);
            // What of it can be seen: tiles blend slivers of strands that samples leave out.
            let seen = |(a, b): &(&Vec4, &Vec4)| (**a - **b).abs().max_element() > 0.01;
            let moved = picture.iter().zip(&halved).filter(seen).count();
            // A strand that touches the wall may fall on either side of it.
            assert!(moved <= some / 50, "{moved} of {some} pixels changed with the projection");
        }
        // The comparison fails for a projection that is not the scene's.
        let z = usual.project_point3(Vec3::NEG_Z * DISTANCE).z;
        let wrong = stage.over(blue, orthographic(-1.0, 1.0, -1.0, 1.0, 0.05, 50.0), z);
        assert!(wrong.iter().zip(&halved).filter(|(a, b)| a != b).count() > some / 20);
    }
}

#[test]
fn hair_is_blended_over_the_scene() {
    let Some(gpu) = common::gpu() else { return };
    let projection = perspective(FOV, SIZE[0] as f32 / SIZE[1] as f32, 0.05, 50.0);
    for coverage in [Coverage::SampleMask, Coverage::AlphaToCoverage, Coverage::Tiles] {
        let options = ViewOptions { samples: 4, coverage, shadow_resolution: 64, ..Default::default() };
        let stage = Setup::new(gpu, &options, 1);
        let [black, grey, white] =
            [0.0, 0.5, 1.0].map(|c| stage.wall(Vec4::new(c, c, c, 1.0), projection, 20.0));
        // What shows through is linear in the scene's colour ...
        let mean: Vec<Vec4> = black.iter().zip(&white).map(|(a, b)| 0.5 * (*a + *b)).collect();
        let error = difference(&mean, &grey);
        assert!(error < 2e-3, "{coverage:?}: {error} from linear");
        assert!(difference(&black, &grey) > 0.1, "the comparer sees no difference");
        // ... and a share of it that four samples can have.
        let mut partial = 0;
        for (black, white) in black.iter().zip(&white) {
            let share = 4.0 * (white.x - black.x);
            // Half floats of bright hair are coarse.
            // Tiles have any share.
            let whole = (share - share.round()).abs() < 0.02 || coverage == Coverage::Tiles;
            assert!(whole, "{coverage:?}: {share} of four samples");
            partial += usize::from(share.round() > 0.0 && share.round() < 4.0);
        }
        assert!(partial > 100, "{coverage:?}: {partial} pixels are partly covered");
    }
    assert!(Embed::new(&gpu.device, (1, Coverage::PEELING), TextureFormat::Rgba16Float).is_err());
}
