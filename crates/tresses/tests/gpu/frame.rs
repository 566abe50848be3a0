//! The whole motion path on the GPU: bit-identical runs, the same motion at any frame rate, constant lengths, no hair
//! in the head, and teleports.

use crate::common;

use tresses::{
    Context, HairOptions, Pose,
    glam::{Quat, Vec3},
    groom::{BindOptions, Groom, SdfGrid, bind},
    low_level::{Hair, StrandVertex, readback::blocking as readback},
};

const HEAD: f32 = 0.09;

struct Setup {
    context: &'static Context,
    groom: Groom,
    field: SdfGrid,
}

impl Setup {
    /// One device for all tests. A software driver takes long to build pipelines.
    fn open() -> Option<&'static Self> {
        static SETUPS: tresses_testing::Pool<Setup> = tresses_testing::Pool::new();
        SETUPS.get(Self::new)
    }

    fn new() -> Option<Self> {
        let context = common::context()?;
        let mut groom = bind(&common::hanging(300, 16, 0.12), &BindOptions::default()).unwrap();
        // `Hair` stores the strands in this order.
        tresses::low_level::lod::arrange(&mut groom.strands);
        Some(Self { groom, field: common::ball(HEAD, 64), context })
    }

    fn hair(&self) -> Hair {
        let context = self.context;
        let options = HairOptions::default();
        common::hair(context, &self.groom, &options, Some(&self.field)).unwrap()
    }

    fn advance(&self, hair: &mut Hair, head: Pose, dt: f32) {
        common::advance(hair, &common::frame(head, dt));
    }

    fn vertices(&self, hair: &Hair) -> Vec<StrandVertex> {
        readback::buffer(self.context, &hair.strands.vertices).unwrap()
    }

    /// Returns the vertices and the head's pose after `seconds` of turning at a constant rate, at `fps`.
    fn turned(&self, seconds: f32, fps: f32) -> (Vec<StrandVertex>, Pose) {
        let mut hair = self.hair();
        let pose = |t: f32| Pose::about(Vec3::ZERO, Quat::from_rotation_y(1.5 * t));
        for i in 0..=(seconds * fps).round() as u32 {
            self.advance(&mut hair, pose(i as f32 / fps), if i == 0 { 0.0 } else { 1.0 / fps });
        }
        (self.vertices(&hair), pose(seconds))
    }

    /// Returns the largest relative deviation of a strand's length from its rest length.
    fn strain(&self, vertices: &[StrandVertex]) -> f32 {
        let length = |points: &[Vec3]| points.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
        vertices
            .chunks(self.groom.strands.vertex_count as usize)
            .enumerate()
            .map(|(i, strand)| {
                let rest = length(&self.groom.strands.rest_positions(i).collect::<Vec<_>>());
                let now = length(&strand.iter().map(|v| v.position).collect::<Vec<_>>());
                (now / rest - 1.0).abs()
            })
            .fold(0.0, f32::max)
    }
}

fn largest_difference(a: &[StrandVertex], b: &[StrandVertex]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.position.distance(b.position)).fold(0.0, f32::max)
}

#[test]
fn runs_are_bit_identical() {
    let Some(stage) = Setup::open() else { return };
    let (first, _) = stage.turned(0.5, 60.0);
    let (second, _) = stage.turned(0.5, 60.0);
    assert_eq!(bytemuck::cast_slice::<_, u8>(&first), bytemuck::cast_slice::<_, u8>(&second));
    // The hair moved; otherwise equality would show nothing.
    let mut still = stage.hair();
    stage.advance(&mut still, Pose::IDENTITY, 0.0);
    assert!(largest_difference(&first, &stage.vertices(&still)) > 0.01);
}

#[test]
fn motion_is_the_same_at_any_frame_rate() {
    let Some(stage) = Setup::open() else { return };
    let (at_60, head) = stage.turned(0.5, 60.0);
    for fps in [30.0, 120.0, 144.0] {
        let (other, _) = stage.turned(0.5, fps);
        // At 144 frames per second, the last frame lies between two steps.
        let off = largest_difference(&at_60, &other);
        assert!(off < 2e-3, "{fps} fps: {off} m");
    }
    assert!((head.point(Vec3::X) - Vec3::X).length() > 0.5);
}

#[test]
fn moving_strands_keep_their_lengths_and_stay_out_of_the_head() {
    let Some(stage) = Setup::open() else { return };
    let mut hair = stage.hair();
    for i in 0..90 {
        let angle = 0.8 * (std::f32::consts::TAU * i as f32 / 30.0).sin();
        let pose = Pose::about(Vec3::ZERO, Quat::from_rotation_y(angle));
        stage.advance(&mut hair, pose, 1.0 / 60.0);
        if i % 15 != 14 {
            continue;
        }
        let vertices = stage.vertices(&hair);
        assert!(vertices.iter().all(|v| v.position.is_finite()));
        let strain = stage.strain(&vertices);
        assert!(strain < 0.02, "frame {i}: {strain}");
        // Some strands of this groom rest in the head. A few of them are centimeters deep, where the distance to the
        // skin no longer holds them, so they swing. The others must not be deeper than at rest.
        let rests = (0..stage.groom.strands.len()).flat_map(|i| stage.groom.strands.rest_positions(i));
        let (mut worst, mut worst_buried) = (0.0f32, 0.0f32);
        for (vertex, rest) in vertices.iter().zip(rests) {
            let deeper = HEAD.min(rest.length()) - vertex.position.length();
            let worst = if rest.length() < HEAD - 5e-3 { &mut worst_buried } else { &mut worst };
            *worst = worst.max(deeper);
        }
        assert!(worst < 1e-3, "frame {i}: {worst} m in the head");
        assert!(worst_buried < 0.02, "frame {i}: what rests in the head is {worst_buried} m deeper");
    }
}

#[test]
fn teleports_and_long_pauses_keep_the_style() {
    let Some(stage) = Setup::open() else { return };
    let mut hair = stage.hair();
    stage.advance(&mut hair, Pose::IDENTITY, 0.0);
    let rest = stage.vertices(&hair);
    let far = Pose { translation: Vec3::new(40.0, 1.0, -3.0), ..Pose::IDENTITY };
    stage.advance(&mut hair, far, 1.0 / 60.0);
    stage.advance(&mut hair, far, 100.0);
    stage.advance(&mut hair, far, f32::NAN);
    let after: Vec<_> = stage
        .vertices(&hair)
        .into_iter()
        .map(|v| StrandVertex { position: v.position - far.translation, ..v })
        .collect();
    let off = largest_difference(&rest, &after);
    assert!(off < 0.01, "{off}");
}
