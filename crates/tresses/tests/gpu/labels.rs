//! Geometry and labels of an image (where hair is, and which strand each pixel shows), and the same image in another
//! output.

use crate::common;

use half::f16;
use tresses::{
    Background, Camera, Context, Error, Picture, Result, ToneMap, View, ViewOptions,
    glam::{Vec2, Vec3},
    light::{Lights, Sphere},
    low_level::{Drawing, Hair, readback::blocking as readback},
    renderer::Renderer,
    wgpu::{self, TextureFormat, TextureUsages},
};

const SIZE: [u32; 2] = [96, 80];

struct Setup {
    hair: Hair,
    view: View,
    scene: Picture,
}

impl Setup {
    fn new(context: &Context, renderer: Renderer) -> Self {
        let hair = common::hair_on_a_ball(300);
        let options = ViewOptions { renderer, ..common::coarse() };
        let scene = Picture {
            camera: Camera::look_at(Vec3::Z * 0.8, Vec3::ZERO, 0.15, SIZE),
            focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
            lights: Lights::around(0.3),
            ..Default::default()
        };
        Self { view: View::new(context, &options, SIZE, 1).unwrap(), hair, scene }
    }

    /// Renders the image, with geometry and labels if `asks`.
    fn drawn(&self, asks: bool) -> Result<Vec<u8>> {
        let sight = Drawing { writes_labels: asks, ..Drawing::new(&self.scene) };
        common::try_submit(|recorder| recorder.draw(&[&self.hair], &[], &self.view, sight))?;
        pollster::block_on(self.view.targets().read())
    }
}

#[test]
fn labels_name_the_visible_strand() {
    let Some(context) = common::context() else { return };
    for samples in [1, 4] {
        let stage = Setup::new(context, Renderer::tiles(samples));
        let targets = stage.view.targets();
        let plain = stage.drawn(false).unwrap();
        assert_eq!(pollster::block_on(targets.labels()).unwrap(), None, "nobody asked");
        assert_eq!(stage.drawn(true).unwrap(), plain, "a picture that is asked is the same");
        assert!(!targets.knows_motion());
        let known = pollster::block_on(targets.geometry()).unwrap().unwrap();
        let labels = pollster::block_on(targets.labels()).unwrap().unwrap();
        stage.drawn(true).unwrap();
        assert!(targets.knows_motion());
        stage.drawn(false).unwrap();
        assert_eq!(pollster::block_on(targets.labels()).unwrap(), None, "nobody asked again");
        assert_eq!(pollster::block_on(targets.geometry()).unwrap(), None);

        let positions = common::positions(&stage.hair);
        let Camera { view, projection, .. } = stage.scene.camera;
        let place = |strand: u32, vertex: u32, along: f32| {
            let at = (strand * stage.hair.set.drawn.vertex_count + vertex) as usize;
            let point = positions[at].lerp(positions[at + 1], along);
            let seen = projection.project_point3(view.transform_point3(point));
            (
                Vec2::new(0.5 + 0.5 * seen.x, 0.5 - 0.5 * seen.y) * Vec2::new(SIZE[0] as f32, SIZE[1] as f32),
                seen.z,
            )
        };
        let (mut count, mut wrong) = (0, 0);
        for (i, (label, [.., depth, opacity])) in labels.iter().zip(&known).enumerate() {
            let Some(label) = label else {
                assert_eq!(*opacity, 0.0, "there is hair, but no strand");
                continue;
            };
            assert!(label.groom == 0 && label.coverage <= opacity + 1e-3, "{label:?} of {opacity}");
            if label.coverage < 0.2 {
                continue;
            }
            let pixel = Vec2::new((i as u32 % SIZE[0]) as f32, (i as u32 / SIZE[0]) as f32) + 0.5;
            let (at, z) = place(label.strand, label.vertex, label.along);
            assert!((at - pixel).abs().max_element() < 1.0, "{label:?} is at {at}, not {pixel}");
            // A strand that covers most of a pixel is about as deep as the mean of the pixel.
            assert!(label.coverage < 0.6 || (z / depth - 1.0).abs() < 0.1, "{z} {depth}");
            // The next strand is elsewhere, which shows that labels matter.
            let (other, _) = place((label.strand + 1) % 300, label.vertex, label.along);
            wrong += usize::from((other - pixel).abs().max_element() > 1.0);
            count += 1;
        }
        assert!(count > 300 && wrong > count * 9 / 10, "{count} {wrong}");
    }
    let refused = Setup::new(context, Renderer::masks(4)).drawn(true);
    assert!(matches!(refused, Err(Error::Parameter { .. })), "masks do not know");
}

#[test]
fn image_is_the_same_in_another_output() {
    let Some(context) = common::context() else { return };
    let (device, queue) = (context.device(), context.queue());
    for renderer in [Renderer::tiles(1), Renderer::tiles(4), Renderer::masks(4)] {
        let stage = Setup::new(context, renderer);
        let plain = stage.drawn(false).unwrap();
        let into = |tone: &ToneMap| -> Vec<[f32; 4]> {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
                ..common::TEXTURE
            });
            let output = (&texture.create_view(&Default::default()), TextureFormat::Rgba16Float);
            let mut encoder = device.create_command_encoder(&Default::default());
            let background: &Background = &stage.scene.background;
            stage.view.present_into(&mut encoder, output, (background, tone)).unwrap();
            queue.submit([encoder.finish()]);
            let texels: Vec<[f16; 4]> =
                bytemuck::pod_collect_to_vec(&readback::texture(context, &texture).unwrap());
            texels.iter().map(|texel| texel.map(f16::to_f32)).collect()
        };
        let off = |other: &[[f32; 4]]| {
            let pairs = other.as_flattened().iter().zip(&plain);
            pairs.map(|(a, b)| (255.0 * a - f32::from(*b)).abs()).fold(0.0, f32::max)
        };
        // Half a step of rounding, half a step of dither, and the precision of half floats.
        let same = off(&into(&stage.scene.tone));
        assert!(same < 1.2, "{renderer:?}: {same} of 255");
        let brighter = ToneMap { exposure: 1.2 * stage.scene.tone.exposure, ..stage.scene.tone };
        assert!(off(&into(&brighter)) > 3.0, "the comparer sees a factor");
    }
}
