//! Hair in a host application's scene: scene geometry hides hair, uncovered pixels stay bit-identical, and the scene's
//! depth convention does not matter.

use crate::common;

use half::f16;
use tresses::{
    Camera, Compositor, Context, Error, HostFrame, Picture, Pose, Result, View, ViewOptions,
    glam::{
        Mat4, Vec3, Vec4,
        camera::rh::proj::directx::{orthographic, perspective},
    },
    groom::bind,
    light::{Lights, Sphere},
    low_level::{Drawing, Hair, HairAsset, HairDescriptor, ViewContent, readback},
    renderer::Renderer,
    wgpu::{self, TextureFormat, TextureUsages},
};

const SIZE: [u32; 2] = [96, 80];
/// Distance from the eye to the center of the hair, meters.
const DISTANCE: f32 = 0.8;
const FOV: f32 = 0.5;
const ASPECT: f32 = SIZE[0] as f32 / SIZE[1] as f32;
/// Color of the scene.
const BLUE: Vec4 = Vec4::new(0.125, 0.25, 0.5, 1.0);

/// A scene of one color and one depth, and the hair that is drawn into it.
struct Setup<'a> {
    context: &'a Context,
    embed: Compositor,
    hair: Hair,
    view: View,
    scene: Picture,
    /// Whether the scene has hair.
    grown: bool,
    /// Position of the image in the scene. The scene has the same margin on the right and below.
    origin: [u32; 2],
    /// Samples per pixel of the scene's depth, and a mask of those that are always far away.
    samples: (u32, u64),
}

impl<'a> Setup<'a> {
    fn new(context: &'a Context, options: &ViewOptions, ssaa: u32) -> Self {
        let hair = common::hair_on_a_ball(500);
        let scene = Picture {
            camera: Camera::look_at(Vec3::Z * DISTANCE, Vec3::ZERO, FOV, SIZE),
            focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
            lights: Lights::around(0.3),
            ..Default::default()
        };
        Self {
            embed: Compositor::new(context, options.renderer, TextureFormat::Rgba16Float).unwrap(),
            view: View::new(context, options, SIZE, ssaa).unwrap(),
            hair,
            scene,
            grown: true,
            origin: [0; 2],
            samples: (1, 0),
            context,
        }
    }

    /// Draws the hair over `color`, in a scene with constant `depth` in `projection`.
    fn over(&self, color: Vec4, projection: Mat4, depth: f32) -> Vec<Vec4> {
        self.drawn(color, projection, depth, false).expect("it fits")[0].clone()
    }

    /// Does the same and, if `asked`, returns the hair's motion, depth and opacity.
    fn drawn(&self, color: Vec4, projection: Mat4, depth: f32, asked: bool) -> Result<[Vec<Vec4>; 2]> {
        let context = self.context;
        let (device, queue) = (context.device(), context.queue());
        let ([width, height], [left, top]) = (SIZE, self.origin);
        let whole = [width + 2 * left, height + 2 * top];
        let mut encoder = device.create_command_encoder(&Default::default());
        let behind = (self.samples.1 != 0).then(|| far_away(device, self.samples, projection));
        let scene =
            HostScene::new(self.context, &mut encoder, (whole, self.samples.0), (color, depth), behind);
        let known = target(device, Compositor::GEOMETRY, TextureUsages::COPY_SRC, (SIZE, 1));
        let known_view = known.create_view(&Default::default());
        let geometry = asked.then_some(&known_view);
        let into = HostFrame {
            origin: self.origin,
            geometry,
            ..HostFrame::new(&scene.color, &scene.depth, projection)
        };
        let sight = Drawing { shows: ViewContent::Over(&self.embed, into), ..Drawing::new(&self.scene) };
        context.recorder(&mut encoder).draw(
            &[&self.hair][..usize::from(self.grown)],
            &[],
            &self.view,
            sight,
        )?;
        queue.submit([encoder.finish()]);
        let texels = scene.read(self.context)?;
        let known = bytemuck::pod_collect_to_vec(&pollster::block_on(readback::texture(context, &known))?);
        Ok([texels, known])
    }

    /// Returns the hair's motion, depth and opacity in front of a distant wall.
    fn known(&self, projection: Mat4) -> Vec<Vec4> {
        let far = projection.project_point3(Vec3::NEG_Z * 20.0).z;
        let [over, known] = self.drawn(Vec4::ZERO, projection, far, true).expect("it fits");
        assert!(over.iter().any(|texel| texel.max_element() > 0.01), "there is hair");
        known
    }

    /// Draws the hair into a scene with a wall at `distance` meters from the eye.
    fn wall(&self, color: Vec4, projection: Mat4, distance: f32) -> Vec<Vec4> {
        self.over(color, projection, projection.project_point3(Vec3::NEG_Z * distance).z)
    }
}

/// Creates a render target with a size and a number of samples per pixel.
pub fn target(
    device: &wgpu::Device,
    format: TextureFormat,
    usage: TextureUsages,
    ([width, height], sample_count): ([u32; 2], u32),
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        sample_count,
        format,
        usage: usage | TextureUsages::RENDER_ATTACHMENT,
        ..common::TEXTURE
    })
}

/// The targets of a scene of one color and one depth.
pub struct HostScene {
    picture: wgpu::Texture,
    pub color: wgpu::TextureView,
    pub depth: wgpu::TextureView,
}

impl HostScene {
    /// Creates targets with a size and a number of depth samples per pixel. `behind` overwrites some of the samples.
    pub fn new(
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        (size, samples): ([u32; 2], u32),
        (color, depth): (Vec4, f32),
        behind: Option<wgpu::RenderPipeline>,
    ) -> Self {
        let device = context.device();
        let picture = target(device, TextureFormat::Rgba16Float, TextureUsages::COPY_SRC, (size, 1));
        let depths = (TextureFormat::Depth32Float, TextureUsages::TEXTURE_BINDING);
        let depths = target(device, depths.0, depths.1, (size, samples)).create_view(&Default::default());
        let picture_view = picture.create_view(&Default::default());
        let [r, g, b, a] = color.to_array().map(f64::from);
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
            ..Default::default()
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene's depth"),
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
        if let Some(behind) = behind {
            pass.set_pipeline(&behind);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        Self { picture, color: picture_view, depth: depths }
    }

    /// Reads the color.
    pub fn read(&self, context: &Context) -> Result<Vec<Vec4>> {
        let bytes = pollster::block_on(readback::texture(context, &self.picture))?;
        let texels: Vec<[f16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(texels.iter().map(|texel| Vec4::from_array(texel.map(f16::to_f32))).collect())
    }
}

/// Returns a pipeline that sets the samples in the mask `samples.1`, of `samples.0` per pixel, to a depth of 20 m.
fn far_away(device: &wgpu::Device, samples: (u32, u64), projection: Mat4) -> wgpu::RenderPipeline {
    let far = projection.project_point3(Vec3::NEG_Z * 20.0).z;
    let code = format!(
        "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {{
            return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, {far:?}, 1.0);
        }}"
    );
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("far away"),
        source: wgpu::ShaderSource::Wgsl(code.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("far away"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples.0, mask: samples.1, ..Default::default() },
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}

/// Returns the number of pixels that differ from `color`.
fn covered(picture: &[Vec4], color: Vec4) -> usize {
    picture.iter().filter(|texel| **texel != color).count()
}

/// Returns the largest difference in a channel.
pub fn difference(a: &[Vec4], b: &[Vec4]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn scene_geometry_hides_hair() {
    let Some(context) = common::context() else { return };
    let usual = perspective(FOV, ASPECT, 0.05, 50.0);
    let masks = [(1, Renderer::masks(4)), (1, Renderer::masks(1)), (2, Renderer::masks(1))];
    let tiles = [(1, Renderer::tiles(4)), (2, Renderer::tiles(1))];
    for (ssaa, renderer) in masks.into_iter().chain(tiles) {
        let options = ViewOptions { renderer, ..common::coarse() };
        let stage = Setup::new(context, &options, ssaa);
        let [free, halved, hidden] = [20.0, DISTANCE, 0.3].map(|at| stage.wall(BLUE, usual, at));
        let [some, half, none] = [&free, &halved, &hidden].map(|picture| covered(picture, BLUE));
        println!("{renderer:?}, {ssaa} texels: {some} pixels of hair, {half} before a wall in its middle");
        assert_eq!(none, 0, "hair shines through a wall");
        assert!(some > 800, "{some} pixels of hair");
        assert!(half < some && half > some / 2, "{half} of {some} pixels lie before the middle");
        for texel in &free {
            assert!(texel.is_finite() && texel.cmpge(Vec4::ZERO).all(), "{texel}");
        }

        // The wall hides the same hair for either direction and any range of the depth.
        let reversed = Camera::perspective(FOV, ASPECT, 0.02);
        let short = perspective(FOV, ASPECT, 0.2, 4.0);
        for other in [reversed, short] {
            let picture = stage.wall(BLUE, other, DISTANCE);
            // Count visible differences only: tiles blend slivers of strands that samples miss.
            let seen = |(a, b): &(&Vec4, &Vec4)| (**a - **b).abs().max_element() > 0.01;
            let moved = picture.iter().zip(&halved).filter(seen).count();
            // A strand that touches the wall may fall on either side of it.
            assert!(moved <= some / 50, "{moved} of {some} pixels changed with the projection");
        }
        // The test fails for a projection other than the scene's.
        let z = usual.project_point3(Vec3::NEG_Z * DISTANCE).z;
        let wrong = stage.over(BLUE, orthographic(-1.0, 1.0, -1.0, 1.0, 0.05, 50.0), z);
        assert!(wrong.iter().zip(&halved).filter(|(a, b)| a != b).count() > some / 20);
    }
}

#[test]
fn image_may_be_a_part_of_the_scene() {
    let Some(context) = common::context() else { return };
    let usual = perspective(FOV, ASPECT, 0.05, 50.0);
    for (ssaa, renderer) in [(1, Renderer::masks(4)), (2, Renderer::tiles(1))] {
        let options = ViewOptions { renderer, ..common::coarse() };
        let mut stage = Setup::new(context, &options, ssaa);
        let alone = stage.wall(BLUE, usual, DISTANCE);
        stage.origin = [13, 7];
        let [width, height] = [SIZE[0] + 26, SIZE[1] + 14];
        let whole = stage.wall(BLUE, usual, DISTANCE);
        let part = |left: u32, top: u32| {
            let rows = (top..top + SIZE[1]).flat_map(|y| (left..left + SIZE[0]).map(move |x| [x, y]));
            rows.map(|[x, y]| whole[(y * width + x) as usize]).collect::<Vec<_>>()
        };
        assert_eq!(whole.len(), (width * height) as usize);
        assert!(part(13, 7) == alone, "{renderer:?}: the part is not the picture");
        assert!(part(12, 7) != alone, "the comparer sees no difference");
        let hair = covered(&alone, BLUE);
        assert!(hair > 400, "{hair} pixels of hair");
        assert_eq!(covered(&whole, BLUE), hair, "there is hair beside the picture");
    }
}

#[test]
fn scene_depth_may_be_multisampled() {
    let Some(context) = common::context() else { return };
    for projection in [perspective(FOV, ASPECT, 0.05, 50.0), Camera::perspective(FOV, ASPECT, 0.02)] {
        for renderer in [Renderer::masks(4), Renderer::tiles(1)] {
            let options = ViewOptions { renderer, ..common::coarse() };
            let mut stage = Setup::new(context, &options, 1);
            let [free, halved] = [20.0, DISTANCE].map(|at| stage.wall(BLUE, projection, at));
            stage.samples = (4, 0);
            assert!(stage.wall(BLUE, projection, DISTANCE) == halved, "four equal samples are one");
            assert_eq!(covered(&stage.wall(BLUE, projection, 0.3), BLUE), 0, "hair shines through a wall");
            for mask in [0b0001u64, 0b1010] {
                stage.samples = (4, mask);
                let part = stage.wall(BLUE, projection, 0.3);
                // Tiles weight hair by the samples behind it. Masks draw it fully if any sample is behind it.
                let share =
                    if matches!(renderer, Renderer::Tiles(_)) { mask.count_ones() as f32 / 4.0 } else { 1.0 };
                let expected: Vec<Vec4> = free.iter().map(|texel| BLUE.lerp(*texel, share)).collect();
                let error = difference(&part, &expected);
                assert!(error < 4e-3, "{renderer:?}, samples {mask:04b} lie behind the hair: {error}");
                assert!(
                    share == 1.0 || difference(&free, &expected) > 0.1,
                    "the comparer sees no difference"
                );
            }
            assert!(free != halved, "the comparer sees no difference");
        }
    }
}

#[cfg(feature = "cards")]
#[test]
fn cards_are_hidden_and_blended_like_strands() {
    use tresses::groom::cards::{CardOptions, bake};
    let Some(context) = common::context() else { return };
    let groom = bind(&common::hanging(500, 16, 0.12), &Default::default()).unwrap();
    let options = CardOptions { levels: vec![60], texture_size: 256, ..Default::default() };
    let baked = bake(&groom.strands.unbound(), None, &options).unwrap();
    let columns = baked.strands(0, &groom).unwrap();
    let projection = perspective(FOV, ASPECT, 0.1, 100.0);
    for renderer in [Renderer::tiles(1), Renderer::tiles(4), Renderer::masks(4)] {
        let options = ViewOptions { renderer, ..common::coarse() };
        let strands = Setup::new(context, &options, 1);
        let expected = covered(&strands.wall(BLUE, projection, 5.0), BLUE);
        let mut setup = Setup::new(context, &options, 1);
        let what = HairDescriptor { cards: Some(&columns.sheet), ..Default::default() };
        let asset = HairAsset::new(context, columns.groom.clone(), &what).unwrap();
        setup.hair = Hair::new(&asset).unwrap();
        common::advance(&mut setup.hair, &common::frame(Pose::IDENTITY, 0.0));
        let free = setup.wall(BLUE, projection, 5.0);
        let seen = covered(&free, BLUE);
        assert!(seen * 4 > expected && seen < expected * 2, "{renderer:?}: {seen} instead of {expected}");
        assert_eq!(covered(&setup.wall(BLUE, projection, 0.3), BLUE), 0, "{renderer:?}: a wall in front");
        // Several depths per pixel: hair is tested against the farthest.
        setup.samples = (4, 0);
        assert!(covered(&setup.wall(BLUE, projection, 5.0), BLUE).abs_diff(seen) * 20 < seen);
        assert_eq!(covered(&setup.wall(BLUE, projection, 0.3), BLUE), 0);
    }
}

#[test]
fn hair_is_blended_over_the_scene() {
    let Some(context) = common::context() else { return };
    let projection = perspective(FOV, ASPECT, 0.05, 50.0);
    for renderer in [Renderer::masks(4), Renderer::alpha_to_coverage(4), Renderer::tiles(4)] {
        let options = ViewOptions { renderer, ..common::coarse() };
        let stage = Setup::new(context, &options, 1);
        let [black, gray, white] =
            [0.0, 0.5, 1.0].map(|c| stage.wall(Vec4::new(c, c, c, 1.0), projection, 20.0));
        // The result is linear in the scene's color ...
        let mean: Vec<Vec4> = black.iter().zip(&white).map(|(a, b)| 0.5 * (*a + *b)).collect();
        let error = difference(&mean, &gray);
        assert!(error < 2e-3, "{renderer:?}: {error} from linear");
        assert!(difference(&black, &gray) > 0.1, "the comparer sees no difference");
        // ... with a weight that is a multiple of a quarter, as there are four samples.
        let mut partial = 0;
        for (black, white) in black.iter().zip(&white) {
            let share = 4.0 * (white.x - black.x);
            // The tolerance is for half floats of bright hair. Tiles may have any weight.
            let whole = (share - share.round()).abs() < 0.02 || matches!(renderer, Renderer::Tiles(_));
            assert!(whole, "{renderer:?}: {share} of four samples");
            partial += usize::from(share.round() > 0.0 && share.round() < 4.0);
        }
        assert!(partial > 100, "{renderer:?}: {partial} pixels are partly covered");
    }
    assert!(Compositor::new(context, Renderer::peeling(4), TextureFormat::Rgba16Float).is_err());
}

/// Returns the distance along the view direction of a depth value in `projection`, meters.
fn distance(projection: Mat4, depth: f32) -> f32 {
    let seen = projection.inverse().project_point3(Vec3::new(0.0, 0.0, depth));
    -seen.z
}

/// Returns the number of pixels per millimeter at a distance.
fn per_millimeter(distance: f32) -> f32 {
    1e-3 * SIZE[1] as f32 / (2.0 * distance * (0.5 * FOV).tan())
}

#[test]
fn geometry_output_has_motion_depth_and_opacity() {
    let Some(context) = common::context() else { return };
    let [usual, reversed] = [perspective(FOV, ASPECT, 0.05, 50.0), Camera::perspective(FOV, ASPECT, 0.02)];
    for (samples, ssaa) in [(1, 1), (4, 1), (1, 2)] {
        let options = ViewOptions { renderer: Renderer::tiles(samples), ..common::coarse() };
        let mut stage = Setup::new(context, &options, ssaa);
        let still = stage.known(usual);
        let hair = |known: &[Vec4]| known.iter().copied().filter(|texel| texel.w > 0.05).collect::<Vec<_>>();
        assert!(hair(&still).len() > 800, "{} pixels of hair", hair(&still).len());
        let most = |known: &[Vec4]| {
            known.iter().map(|texel| texel.truncate().truncate().length()).fold(0.0, f32::max)
        };
        assert!(most(&still) < 1e-3, "nothing was before: {}", most(&still));

        // The opacity is the hidden share of the scene. The distance is the same for either direction of the depth.
        let [black, white] = [0.0, 1.0].map(|c| stage.wall(Vec4::splat(c), usual, 20.0));
        for (texel, (black, white)) in still.iter().zip(black.iter().zip(&white)) {
            let hidden = 1.0 - (white.x - black.x);
            assert!((texel.w - hidden).abs() < 4e-3, "{} of {hidden}", texel.w);
        }
        for (a, b) in hair(&still).iter().zip(hair(&stage.known(reversed))) {
            let [a, b] = [distance(usual, a.z), distance(reversed, b.z)];
            assert!((a - b).abs() < 1e-3 && (a - DISTANCE).abs() < 0.2, "{a} {b}");
        }

        // The head moves to the right by 5 mm with its hair.
        stage.known(usual);
        common::advance(
            &mut stage.hair,
            &common::frame(Pose { translation: Vec3::X * 5e-3, ..Pose::IDENTITY }, 0.0),
        );
        let moved = hair(&stage.known(usual));
        for texel in &moved {
            let expected = 5.0 * per_millimeter(distance(usual, texel.z));
            assert!((texel.x - expected).abs() < 0.02 && texel.y.abs() < 0.02, "{texel}, not {expected}");
        }
        // Then it rests, and the camera moves to the right and down.
        assert!(most(&stage.known(usual)) < 1e-3);
        let by = Vec3::new(3e-3, -4e-3, 0.0);
        stage.scene.camera = Camera::look_at(Vec3::Z * DISTANCE + by, by, FOV, SIZE);
        let seen = hair(&stage.known(usual));
        for texel in &seen {
            let expected = per_millimeter(distance(usual, texel.z));
            let off = (texel.x + 3.0 * expected).abs().max((texel.y + 4.0 * expected).abs());
            assert!(off < 0.02, "{texel} of {expected}");
        }
        // After the vertices change, only the camera's motion is known.
        let detail = stage.hair.lod.detail(1e-2, 20.0);
        stage.hair.set_detail(detail);
        common::advance(&mut stage.hair, &common::frame(Pose::IDENTITY, 0.0));
        assert!(most(&stage.known(usual)) < 1e-3);
        // Without hair, the output is cleared.
        stage.grown = false;
        let [_, known] = stage.drawn(Vec4::ZERO, usual, 1.0, true).unwrap();
        let far = |texel: &Vec4| *texel == Vec4::ZERO;
        assert!(known.iter().all(far), "{:?}", known.iter().find(|texel| !far(texel)));
    }
    let options = ViewOptions { renderer: Renderer::masks(4), ..common::coarse() };
    let refused = Setup::new(context, &options, 1).drawn(Vec4::ZERO, usual, 1.0, true);
    assert!(matches!(refused, Err(Error::Parameter { .. })), "masks know nothing of it");
}
