//! Helpers of the GPU tests.

mod device;
mod fixtures;

pub use device::{advance, compute, context, frame, noop, submit};
pub use fixtures::{SINTEL, asset, character, scalp, sintel};

use tresses::{
    Background, Body, Camera, Context, HairOptions, Picture, Pose, Result, View, ViewOptions,
    collide::ColliderDescriptor,
    glam::{Mat4, Quat, Vec3},
    groom::{Groom, SdfGrid, Strands, TriMesh, bind},
    light::{Directional, Lights, MAX_LIGHTS, Shadows},
    low_level::{
        Drawing, Hair, HairAsset, HairDescriptor, HairSet, StrandVertex, readback::blocking as readback,
    },
};

/// Creates strands on a sphere of radius 9 cm around the origin that stand off, bend, and hang down `length` meters.
pub fn hanging(count: usize, vertices: usize, length: f32) -> Strands {
    let mut strands = Strands::default();
    for i in 0..count {
        let y = 1.0 - i as f32 / count as f32;
        let angle = i as f32 * 2.399_963;
        let out = Vec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
        let curve: Vec<_> = (0..vertices)
            .map(|j| {
                let s = j as f32 / (vertices - 1) as f32;
                out * (0.09 + 0.3 * length * s.sqrt()) - Vec3::Y * length * s * s
            })
            .collect();
        strands.push(&curve);
    }
    strands
}

/// Returns the distance field of a ball around the origin, with `resolution` nodes along each side of 40 cm.
pub fn ball(radius: f32, resolution: u32) -> SdfGrid {
    SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), resolution, |p| p.length() - radius)
}

/// Uploads `groom` on a head with the distance field `head`.
pub fn hair(context: &Context, groom: &Groom, options: &HairOptions, head: Option<&SdfGrid>) -> Result<Hair> {
    hair_among(context, groom, options, &ColliderDescriptor { head, ..Default::default() })
}

/// Uploads `groom` among `colliders`.
pub fn hair_among(
    context: &Context,
    groom: &Groom,
    options: &HairOptions,
    colliders: &ColliderDescriptor<'_>,
) -> Result<Hair> {
    let what = HairDescriptor { options: *options, colliders: *colliders, ..Default::default() };
    Hair::new(&HairAsset::new(context, groom.clone(), &what)?)
}

/// Creates `count` strands of 12 cm that hang from a ball, on the GPU and at rest.
pub fn hair_on_a_ball(count: usize) -> Hair {
    let context = context().expect("there is a GPU");
    let groom = bind(&hanging(count, 16, 0.12), &Default::default()).unwrap();
    let field = ball(0.085, 32);
    let mut hair = hair(context, &groom, &Default::default(), Some(&field)).unwrap();
    advance(&mut hair, &frame(Pose::IDENTITY, 0.0));
    hair
}

/// Duration of [`shaken`], seconds.
pub const SHAKE: f32 = 3.0;

/// Returns the head's pose in a shake of 30 degrees to both sides, as in `tresses render --motion shake` but without
/// its rests.
pub fn shaken(t: f32, neck: Vec3) -> Pose {
    // Extremes are 0.3 s apart. The first and the last swing are half as far.
    let t = (t * 3.1 / SHAKE).min(3.1);
    let smooth = |s: f32| s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let yaw = if t < 0.2 {
        smooth(t / 0.2)
    } else if t < 2.9 {
        let s = (t - 0.2) / 0.3;
        let side = if (s as u32).is_multiple_of(2) { 1.0 } else { -1.0 };
        side * (1.0 - 2.0 * smooth(s.fract()))
    } else {
        smooth((t - 2.9) / 0.2) - 1.0
    };
    Pose::about(neck, Quat::from_rotation_y(30f32.to_radians() * yaw))
}

/// Reads the positions of the drawn vertices, strand after strand.
pub fn positions(hair: &Hair) -> Vec<Vec3> {
    let context = context().expect("there is a GPU");
    let read: Vec<StrandVertex> = readback::buffer(context, &hair.strands.vertices).unwrap();
    read.iter().map(|vertex| vertex.position).collect()
}

/// Returns the largest distance between corresponding points, meters.
pub fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Returns the guides' rest positions in the layout of the GPU: vertex-major `vec4`s.
pub fn vertex_major(groom: &Groom) -> Vec<[f32; 4]> {
    let n = groom.guides.vertex_count as usize;
    let g = groom.guides.len();
    let at = |i: usize| groom.guides.positions[(i % g) * n + i / g];
    (0..n * g).map(|i| at(i).extend(0.0).to_array()).collect()
}

/// Returns a cube around the origin with edges of 2·`half` meters.
pub fn cube(half: f32) -> TriMesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let positions: Vec<_> = (0..8).map(|i| (corner(i) * 2.0 - 1.0) * half).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriMesh {
        normals: positions.iter().map(|p| p.normalize()).collect(),
        positions,
        triangles,
        ..Default::default()
    }
}

/// Returns the settings of an image without lights and shadows, for tests of coverage.
pub fn dark() -> Picture {
    Picture {
        lights: Lights { directional: [Directional::OFF; MAX_LIGHTS], ..Lights::default() },
        shadows: Shadows { enabled: false, ambient: false, ..Shadows::default() },
        background: Background::transparent(),
        ..Default::default()
    }
}

/// Returns the options of a view for tests in which neither shadows nor ambient light need to be fine.
pub fn coarse() -> ViewOptions {
    ViewOptions { shadow_resolution: 64, ambient_cells: 8, ..ViewOptions::default() }
}

/// Renders `picture` with `view`: RGBA, rows from the top.
pub fn picture(
    context: &Context,
    view: &View,
    picture: &Picture,
    hair: &[&HairSet],
    bodies: &[&Body],
) -> Vec<u8> {
    let (device, queue) = (context.device(), context.queue());
    let mut encoder = device.create_command_encoder(&Default::default());
    context.recorder(&mut encoder).draw_strands(hair, bodies, view, Drawing::new(picture)).expect("it fits");
    queue.submit([encoder.finish()]);
    pollster::block_on(view.targets().read()).expect("a picture")
}

/// Returns an orthographic camera with reversed depth and `size`² pixels, in which one meter is one pixel. The origin
/// is the lower left corner.
pub fn meter_is_pixel(size: u32) -> Camera {
    let half = size as f32 * 0.5;
    Camera {
        view: Mat4::from_translation(Vec3::new(-half, -half, -1e4)),
        projection: Mat4::from_cols_array_2d(&[
            [1.0 / half, 0.0, 0.0, 0.0],
            [0.0, 1.0 / half, 0.0, 0.0],
            [0.0, 0.0, 5e-5, 0.0],
            [0.0, 0.0, 1.0, 1.0],
        ]),
        size: [size, size],
    }
}
