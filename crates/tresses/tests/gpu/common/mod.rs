//! Helpers of the GPU tests.

mod device;
mod fixtures;
pub mod order;
mod skinned;

pub use device::{
    advance, advance_characters, compute, context, draw_characters, frame, noop, simulate, submit, try_submit,
};
pub use fixtures::{DrapedCharacter, SINTEL, asset, character, scalp, sintel};
pub use skinned::{SkinnedHair, moved};

use tresses::{
    Background, Body, Camera, Context, HairOptions, Picture, Pose, Result, View, ViewOptions,
    collide::ColliderDescriptor,
    glam::{Mat4, Quat, Vec3},
    groom::{Groom, SdfGrid, Strands, TriMesh, bind, bound::Strand},
    light::{Lights, Shadows},
    low_level::{
        Drawing, Hair, HairAsset, HairDescriptor, HairSet, StrandBuffers, StrandVertex, pack_tangent,
        readback::blocking as readback,
    },
    wgpu,
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

/// Reads the drawn vertices, strand after strand.
pub fn vertices(hair: &Hair) -> Vec<StrandVertex> {
    readback::buffer(context().expect("there is a GPU"), &hair.strands.vertices).unwrap()
}

/// Reads the positions of the drawn vertices, strand after strand.
pub fn positions(hair: &Hair) -> Vec<Vec3> {
    vertices(hair).iter().map(|vertex| vertex.position).collect()
}

/// Reads the positions of the guides' vertices, vertex-major.
pub fn guides(hair: &Hair) -> Vec<Vec3> {
    let read: Vec<[f32; 4]> =
        readback::buffer(context().expect("there is a GPU"), &hair.guides.current).unwrap();
    read.iter().map(|position| Vec3::from_slice(position)).collect()
}

/// Reads the positions of the guides' vertices, guide after guide.
pub fn guide_lines(hair: &Hair) -> Vec<Vec<Vec3>> {
    let (all, count) = (guides(hair), hair.guides.count as usize);
    (0..count).map(|guide| all.iter().skip(guide).step_by(count).copied().collect()).collect()
}

/// Returns the length of a line, meters.
pub fn length(line: &[Vec3]) -> f32 {
    line.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Returns the largest distance between corresponding points, meters.
pub fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
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

/// Returns a rectangle with these corners, in counterclockwise order as seen from its front.
pub fn rectangle(corners: [Vec3; 4]) -> TriMesh {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let (normals, triangles) = (vec![normal; 4], vec![[0, 1, 2], [0, 2, 3]]);
    TriMesh { positions: corners.into(), normals, triangles, ..Default::default() }
}

/// Uploads strands of `vertex_count` vertices.
pub fn upload(
    context: &Context,
    vertex_count: usize,
    vertices: &[StrandVertex],
    strands: &[Strand],
) -> StrandBuffers {
    let buffers = StrandBuffers::new(context, strands.len() as u32, vertex_count as u32).expect("fits");
    context.queue().write_buffer(&buffers.vertices, 0, bytemuck::cast_slice(vertices));
    context.queue().write_buffer(&buffers.strands, 0, bytemuck::cast_slice(strands));
    buffers
}

/// Creates straight strands of `radius` from their ends.
pub fn segments(context: &Context, ends: &[[Vec3; 2]], radius: f32) -> HairSet {
    let vertex = |position: Vec3, [a, b]: &[Vec3; 2]| {
        let tangent = pack_tangent((*b - *a).normalize(), 1.0);
        StrandVertex { position, tangent }
    };
    let vertices: Vec<_> = ends.iter().flat_map(|ends| ends.map(|end| vertex(end, ends))).collect();
    let strand = |i: u32| Strand { radius, seed: i.wrapping_mul(0x9e37_79b9), root_color: 0, tip_color: 0 };
    let strands: Vec<_> = (0..ends.len() as u32).map(strand).collect();
    HairSet::new(context, &upload(context, 2, &vertices, &strands)).expect("fits")
}

/// A texture of one texel that shaders read. Tests replace the fields that matter to them.
pub const TEXTURE: wgpu::TextureDescriptor<'static> = wgpu::TextureDescriptor {
    label: Some("test"),
    size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
    mip_level_count: 1,
    sample_count: 1,
    dimension: wgpu::TextureDimension::D2,
    format: wgpu::TextureFormat::Rgba16Float,
    usage: wgpu::TextureUsages::TEXTURE_BINDING,
    view_formats: &[],
};

/// Returns the settings of an image without lights and shadows, for tests of coverage.
pub fn dark() -> Picture {
    Picture {
        lights: Lights { list: Vec::new(), ..Lights::default() },
        shadows: Shadows { is_enabled: false, has_ambient: false, ..Shadows::default() },
        background: Background::transparent(),
        ..Default::default()
    }
}

/// Returns the options of a view for tests in which neither shadows nor ambient light need to be fine.
pub fn coarse() -> ViewOptions {
    ViewOptions { shadow_resolution: 64, ambient_resolution: 8, ..ViewOptions::default() }
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

/// Renders `hair` and `bodies` with `view`: RGBA, rows from the top.
pub fn drawn(view: &View, picture: &Picture, hair: &[&Hair], bodies: &[&Body]) -> Vec<u8> {
    submit(|recorder| recorder.draw(hair, bodies, view, Drawing::new(picture)));
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
