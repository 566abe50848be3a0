//! Shadows between hair and a host's scene: the scene's shadow maps keep light from hair, and hair casts shadows on the
//! scene, by a pass over its color or by a function for its shaders.

use crate::{
    common,
    embed::{HostScene, difference},
};

use tresses::{
    Camera, Compositor, Context, Error, HostFrame, Picture, Result, View, ViewOptions,
    glam::{
        Mat4, Vec3, Vec4,
        camera::rh::{
            proj::directx::{orthographic, perspective},
            view::look_at_mat4,
        },
    },
    light::{Light, Lights, SceneShadow, Sky, Sphere},
    low_level::{Drawing, Hair, ViewContent, readback, shade},
    renderer::Renderer,
    wgpu::{self, TextureFormat, util::DeviceExt},
};

const SIZE: [u32; 2] = [96, 80];
const FOV: f32 = 0.5;
const ASPECT: f32 = SIZE[0] as f32 / SIZE[1] as f32;
/// Distance from the eye to the center of the hair, meters.
const DISTANCE: f32 = 0.8;
/// Width and height of the scene's shadow maps, texels.
const EDGE: u32 = 64;
const WALL: Vec4 = Vec4::new(0.5, 0.5, 0.5, 1.0);

/// Hair that hangs from a ball, in front of a wall that faces the eye.
struct Setup<'a> {
    context: &'a Context,
    embed: Compositor,
    hair: Hair,
    view: View,
    picture: Picture,
    /// Distance from the eye to the wall, meters.
    wall: f32,
    samples: u32,
    shade_range: f32,
    /// The scene's projection; `None` for the default.
    projection: Option<Mat4>,
}

impl<'a> Setup<'a> {
    fn new(context: &'a Context, direction: Vec3) -> Self {
        let hair = common::hair_on_a_ball(2000);
        let off = Light::distant(Vec3::Y, Vec3::ZERO);
        let lights = Lights {
            // The first light is off, so the second one has the first map.
            list: vec![off, Light::distant(direction, Vec3::splat(3.0)).with_id(1)],
            sky: Sky::default(),
            environment: Default::default(),
        };
        let options =
            ViewOptions { renderer: Renderer::tiles(1), shadow_resolution: 256, ..common::coarse() };
        Self {
            embed: Compositor::new(context, Renderer::tiles(1), TextureFormat::Rgba16Float).unwrap(),
            view: View::new(context, &options, SIZE, 1).unwrap(),
            hair,
            picture: Picture {
                camera: Camera::look_at(Vec3::Z * DISTANCE, Vec3::ZERO, FOV, SIZE),
                focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
                lights,
                ..Default::default()
            },
            wall: 20.0,
            samples: 1,
            shade_range: 2.5,
            projection: None,
            context,
        }
    }

    /// Draws the hair with the scene's `shadows`. `shade` is the strength of the hair's own shadow on the scene.
    fn drawn(&self, shadows: &[SceneShadow<'_>], shade: f32) -> Result<Vec<Vec4>> {
        let context = self.context;
        let (device, queue) = (context.device(), context.queue());
        let projection = self.projection.unwrap_or(perspective(FOV, ASPECT, 0.05, 50.0));
        // A wall at infinity means no geometry.
        let wall = projection.project_point3(Vec3::NEG_Z * self.wall).z;
        let far = if self.wall.is_finite() { wall } else { infinity(projection) };
        let mut encoder = device.create_command_encoder(&Default::default());
        let scene = HostScene::new(self.context, &mut encoder, (SIZE, self.samples), (WALL, far), None);
        let shade_range = self.shade_range;
        let into = HostFrame {
            shadows,
            shade,
            shade_range,
            ..HostFrame::new(&scene.color, &scene.depth, projection)
        };
        let sight = Drawing { shows: ViewContent::Over(&self.embed, into), ..Drawing::new(&self.picture) };
        context.recorder(&mut encoder).draw(&[&self.hair], &[], &self.view, sight)?;
        queue.submit([encoder.finish()]);
        scene.read(self.context)
    }

    /// Creates a shadow map of the scene with these numbers of columns and rows. Geometry in the texel at x and y is
    /// `meters(x, y)` meters from the eye of `projection`; NaN means none.
    fn map(
        &self,
        projection: Mat4,
        [wide, high]: [u32; 2],
        meters: impl Fn(u32, u32) -> f32,
    ) -> wgpu::TextureView {
        let context = self.context;
        let device = context.device();
        let depth = |x, y| {
            let z = projection.project_point3(Vec3::NEG_Z * meters(x, y)).z;
            let depth = if z.is_finite() { z } else { infinity(projection) };
            (depth.clamp(0.0, 1.0) * 65535.0).round() as u16
        };
        let texels: Vec<u16> =
            (0..high).flat_map(|y| (0..wide).map(move |x| (x, y))).map(|(x, y)| depth(x, y)).collect();
        let size = wgpu::Extent3d { width: wide, height: high, depth_or_array_layers: 1 };
        let format = TextureFormat::Depth16Unorm;
        let descriptor = wgpu::TextureDescriptor { size, format, ..common::TEXTURE };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let texels = bytemuck::cast_slice(&texels);
        let texture = device.create_texture_with_data(context.queue(), &descriptor, order, texels);
        texture.create_view(&Default::default())
    }
}

/// Returns the depth at infinity: 1, or 0 if the depth is reversed.
fn infinity(projection: Mat4) -> f32 {
    let [near, far] = [1.0, 2.0].map(|z| projection.project_point3(Vec3::NEG_Z * z).z);
    if far > near { 1.0 } else { 0.0 }
}

/// Returns the matrix of a shadow map whose eye is at `at`, in the direction of the light, and looks at the origin.
fn from(at: Vec3, projection: Mat4) -> Mat4 {
    projection * look_at_mat4(at, Vec3::ZERO, Vec3::Y)
}

/// Reverses the depth of an orthographic projection: from 1 (near) to 0.
fn reversed(projection: Mat4) -> Mat4 {
    Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, -1.0, 0.0), Vec4::new(0.0, 0.0, 1.0, 1.0))
        * projection
}

/// Whether two images are equal in some columns.
fn same(a: &[Vec4], b: &[Vec4], columns: std::ops::Range<usize>) -> bool {
    let width = SIZE[0] as usize;
    a.chunks(width).zip(b.chunks(width)).all(|(a, b)| a[columns.clone()] == b[columns.clone()])
}

/// Returns the light of the hair in some columns. There is no sky, and the wall keeps its color.
fn light(picture: &[Vec4], columns: std::ops::Range<usize>) -> f32 {
    let bright = |texel: &Vec4| (texel.truncate().element_sum() - 1.5).max(0.0);
    picture.chunks(SIZE[0] as usize).flat_map(|row| &row[columns.clone()]).map(bright).sum()
}

#[test]
fn scene_shadow_maps_keep_light_from_hair() {
    let Some(context) = common::context() else { return };
    // The light is at the eye: left in the image is left in the maps.
    let mut setup = Setup::new(context, Vec3::Z);
    setup.picture.lights.list[1].color = Vec3::splat(40.0);
    let free = setup.drawn(&[], 0.0).unwrap();
    let all = 0..SIZE[0] as usize;
    let whole = light(&free, all.clone());
    assert!(whole > 50.0, "{whole}: there is light");
    let flat = orthographic(-0.4, 0.4, -0.4, 0.4, 0.1, 4.0);
    let lamp = perspective(0.3, 1.0, 0.1, 4.0);
    let kinds = [
        ("orthographic", from(Vec3::Z * 3.0, flat), flat),
        ("reversed", from(Vec3::Z * 3.0, reversed(flat)), reversed(flat)),
        ("a lamp", from(Vec3::Z * 3.0, lamp), lamp),
    ];
    for (name, projection, own) in kinds {
        let shadow = |depth| SceneShadow { light: 1, depth, part: None, projection, bias: 0.0 };
        // The left half is covered, 1 m in front of the hair.
        let half = setup.map(own, [EDGE; 2], |x, _| if x < EDGE / 2 { 2.0 } else { f32::NAN });
        let dark = setup.drawn(&[shadow(&half)], 0.0).unwrap();
        assert!(same(&dark, &free, 52..96), "{name}: where the map has nothing hair is as without it");
        let left = light(&dark, 0..44) / light(&free, 0..44);
        assert!(left < 1e-3, "{name}: {left} of the light behind what keeps it");
        // Geometry behind all of the hair casts no shadow on it.
        let behind = setup.map(own, [EDGE; 2], |_, _| 3.3);
        assert!(setup.drawn(&[shadow(&behind)], 0.0).unwrap() == free, "{name}: what is behind hair");
        // Geometry in front of the hair, and a bias that moves it behind.
        let before = setup.map(own, [EDGE; 2], |_, _| 2.7);
        let biased = SceneShadow { bias: 0.6, ..shadow(&before) };
        assert_eq!(light(&setup.drawn(&[shadow(&before)], 0.0).unwrap(), all.clone()), 0.0, "{name}");
        assert!(setup.drawn(&[biased], 0.0).unwrap() == free, "{name}: a bias takes it behind");
        // Geometry farther from the hair than its map reaches keeps all light away, whatever its bias.
        let far = setup.map(own, [EDGE; 2], |_, _| 1.0);
        let far = SceneShadow { bias: 0.9, ..shadow(&far) };
        assert_eq!(light(&setup.drawn(&[far], 0.0).unwrap(), all.clone()), 0.0, "{name}: a far one");
        // Shadows of other lights, which are off or do not exist.
        for light in [0, 3, 17] {
            let other = SceneShadow { light, ..shadow(&before) };
            assert!(setup.drawn(&[other], 0.0).unwrap() == free, "{name}: light {light}");
        }
    }

    // Two maps of one light as parts of one texture, each for one half of the image.
    let atlas = setup.map(flat, [2 * EDGE, EDGE], |x, _| if x < EDGE { 2.0 } else { f32::NAN });
    let left = from(Vec3::Z * 3.0, orthographic(-0.4, 0.0, -0.4, 0.4, 0.1, 4.0));
    let right = from(Vec3::Z * 3.0, orthographic(0.0, 0.4, -0.4, 0.4, 0.1, 4.0));
    let part = |origin, projection| SceneShadow {
        light: 1,
        depth: &atlas,
        part: Some([[origin, 0], [EDGE, EDGE]]),
        projection,
        bias: 0.0,
    };
    let dark = setup.drawn(&[part(0, left), part(EDGE, right)], 0.0).unwrap();
    assert!(same(&dark, &free, 52..96) && light(&dark, 0..44) < 1e-3 * light(&free, 0..44));
    let turned = setup.drawn(&[part(EDGE, left), part(0, right)], 0.0).unwrap();
    assert!(same(&turned, &free, 0..44) && light(&turned, 52..96) < 1e-3 * light(&free, 52..96));

    // Invalid shadows are errors.
    let refused = |shadows: &[SceneShadow<'_>]| {
        let error = setup.drawn(shadows, 0.0).expect_err("it is refused");
        assert!(matches!(error, Error::Parameter { .. }), "{error}");
        error.to_string()
    };
    println!("{}", refused(&[part(0, left); 65]));
    println!("{}", refused(&[SceneShadow { part: Some([[1, 0], [2 * EDGE, EDGE]]), ..part(0, left) }]));
    println!("{}", refused(&[SceneShadow { bias: f32::NAN, ..part(0, left) }]));
    println!("{}", refused(&[SceneShadow { projection: Mat4::NAN, ..part(0, left) }]));
    println!("{}", refused(&[SceneShadow { projection: Mat4::ZERO, ..part(0, left) }]));
}

#[test]
fn edge_of_a_coarse_shadow_map_is_straight() {
    let Some(context) = common::context() else { return };
    let mut setup = Setup::new(context, Vec3::Z);
    setup.picture.lights.list[1].color = Vec3::splat(40.0);
    setup.picture.shadows.has_ambient = false;
    let free = setup.drawn(&[], 0.0).unwrap();
    // Eight texels of 0.1 m along each edge. Those above the diagonal are covered: a staircase.
    let flat = orthographic(-0.4, 0.4, -0.4, 0.4, 0.1, 4.0);
    let map = setup.map(flat, [8; 2], |x, y| if x + y < 8 { 2.0 } else { f32::NAN });
    let projection = from(Vec3::Z * 3.0, flat);
    let shadow = SceneShadow { light: 1, depth: &map, part: None, projection, bias: 0.0 };
    let dark = setup.drawn(&[shadow], 0.0).unwrap();
    let focal = 0.5 * SIZE[1] as f32 / (0.5 * FOV).tan();
    let (mut shaded, mut lit) = ([0; 2], [0; 2]);
    for (i, (dark, free)) in dark.iter().zip(&free).enumerate() {
        // Hair is brighter than the wall behind it.
        if free.x < 0.7 {
            continue;
        }
        let [x, y] = [i % SIZE[0] as usize, i / SIZE[0] as usize].map(|n| n as f32 + 0.5);
        let at = DISTANCE / focal * Vec3::new(x - 48.0, 40.0 - y, 0.0);
        // Distance from the line between the centers of the texels on either side of the edge, meters. Hair is up to
        // 0.1 m nearer to the eye than the origin. Corners of texels are 0.07 m off the line.
        let beyond = (at.x - at.y - 0.05) / 2.0_f32.sqrt();
        if beyond < -0.045 {
            shaded[usize::from(dark.x > 0.5 + 0.1 * (free.x - 0.5))] += 1;
        } else if beyond > 0.045 {
            lit[usize::from(dark != free)] += 1;
        }
    }
    println!("{shaded:?} pixels in the shade, {lit:?} in light");
    assert!(shaded[0] > 30 && lit[0] > 30);
    assert!(shaded[1] * 50 < shaded[0] && lit[1] * 50 < lit[0], "beyond the line");
}

#[test]
fn hair_casts_shadows_on_the_scene() {
    let Some(context) = common::context() else { return };
    let direction = Vec3::new(0.6, 0.0, 0.8);
    let mut setup = Setup::new(context, direction);
    setup.picture.lights.sky =
        Sky { zenith: Vec3::splat(0.2), horizon: Vec3::splat(0.2), ground: Vec3::splat(0.2) };
    // Light of a matte surface that faces the eye.
    let (lamp, sky) = (3.0 * 0.8 / std::f32::consts::PI, 0.2);
    for (wall, samples) in [(1.0, 1), (1.3, 1), (1.3, 4)] {
        (setup.wall, setup.samples) = (wall, samples);
        let plain = setup.drawn(&[], 0.0).unwrap();
        let shaded = setup.drawn(&[], 1.0).unwrap();
        let half = setup.drawn(&[], 0.5).unwrap();
        let is_wall = |i: &usize| plain[*i] == WALL;
        let walls: Vec<usize> = (0..plain.len()).filter(is_wall).collect();
        let kept = |picture: &[Vec4], i: usize| picture[i].x / WALL.x;
        let darkest = walls.iter().map(|i| kept(&shaded, *i)).fold(1.0, f32::min);
        let least = sky / (sky + lamp);
        println!(
            "a wall {wall} m away, {samples} samples: {darkest} of its light at least, {least} of the sky alone"
        );
        assert!(darkest < least + 0.1 && darkest > least - 1e-3, "{darkest}");
        for i in &walls {
            let expected = 0.5 * (1.0 + kept(&shaded, *i));
            assert!((kept(&half, *i) - expected).abs() < 2e-3, "half of the shadow");
        }
        // The shadow falls to the left, away from the light.
        let dark = |columns: std::ops::Range<usize>| {
            let there = walls.iter().filter(|i| columns.contains(&(**i % SIZE[0] as usize)));
            there.map(|i| 1.0 - kept(&shaded, *i)).sum::<f32>()
        };
        let [left, right] = [dark(0..48), dark(48..96)];
        println!("{left} pixels of shadow to the left, {right} to the right");
        assert!(left > 100.0 && right < 0.05 * left);
        let free = walls.iter().filter(|i| kept(&shaded, **i) == 1.0).count();
        assert!(free > walls.len() / 3, "{free} of {} pixels keep their bits", walls.len());
    }
    // Where the scene blocks the light, hair adds no shadow, with or without a sky.
    let flat = orthographic(-0.4, 0.4, -0.4, 0.4, 0.1, 4.0);
    let plate = setup.map(flat, [EDGE; 2], |_, _| 2.0);
    let projection = from(3.0 * direction, flat);
    let shadow = SceneShadow { light: 1, depth: &plate, part: None, projection, bias: 0.0 };
    let sky = setup.picture.lights.sky;
    for sky in [sky, Sky::default()] {
        setup.picture.lights.sky = sky;
        let [plain, shaded] = [0.0, 1.0].map(|shade| setup.drawn(&[shadow], shade).unwrap());
        assert!(difference(&plain, &shaded) < 1e-3, "{}", difference(&plain, &shaded));
    }
    setup.picture.lights.sky = sky;
    // Negative and NaN strengths cast no shadow.
    setup.samples = 1;
    setup.wall = 1.0;
    let plain = setup.drawn(&[], 0.0).unwrap();
    for none in [-1.0, f32::NAN] {
        assert!(setup.drawn(&[], none).unwrap() == plain);
    }
    assert!(setup.drawn(&[], 1.0).unwrap() != plain, "the comparer sees no difference");
    // Where the scene has no geometry there is no shadow, whichever way its depth runs and wherever it ends.
    setup.wall = f32::INFINITY;
    let half = DISTANCE * (0.5 * FOV).tan();
    let flat = orthographic(-half * ASPECT, half * ASPECT, -half, half, 0.05, 50.0);
    let usual = perspective(FOV, ASPECT, 0.05, 1.2);
    for projection in [usual, Camera::perspective(FOV, ASPECT, 0.05), flat, reversed(flat)] {
        setup.projection = Some(projection);
        let [plain, shaded] = [0.0, 1.0].map(|shade| setup.drawn(&[], shade).unwrap());
        assert!(plain == shaded, "what is infinitely far is in no shadow");
    }
    // The shadow ends at `range` behind the map, and a light may cast none.
    setup.projection = None;
    setup.wall = 2.0;
    setup.picture.lights.list[1] =
        Light::distant(Vec3::new(0.25, 0.0, 1.0).normalize(), Vec3::splat(3.0)).with_id(1);
    let plain = setup.drawn(&[], 0.0).unwrap();
    let cast = difference(&plain, &setup.drawn(&[], 1.0).unwrap());
    assert!(cast > 0.2, "{cast}: 2 m away there is a shadow");
    setup.shade_range = 0.5;
    assert!(setup.drawn(&[], 1.0).unwrap() == plain, "it ends before the wall");
    setup.shade_range = 2.5;
    setup.picture.lights.list[1].casts_shadows = false;
    assert!(setup.drawn(&[], 1.0).unwrap() == plain, "the light casts no shadows");
}

/// Evaluates the shadow function for scene shaders, for light 1, at points of surfaces that face `normal`.
fn told(setup: &Setup<'_>, points: &[Vec3], normal: Vec3) -> Vec<Vec4> {
    let context = setup.context;
    let (device, queue) = (context.device(), context.queue());
    let code = shade::wgsl(1)
        + "
        @group(0) @binding(0) var<storage, read_write> points: array<vec4<f32>>;
        @group(0) @binding(1) var<uniform> normal: vec4<f32>;
        @compute @workgroup_size(64) fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
            if id.x < arrayLength(&points) {
                points[id.x] = vec4(tresses_left_by_hair(u32(points[id.x].w), points[id.x].xyz, normal.xyz), 0.0);
            }
        }";
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("a scene's shader"),
        source: wgpu::ShaderSource::Wgsl(code.into()),
    });
    use tresses::low_level::{Binding, bindings};
    let own = bindings::layout(
        device,
        "points",
        wgpu::ShaderStages::COMPUTE,
        &[Binding::StorageMut, Binding::Uniform],
    );
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&own), Some(&View::light_layout(context))],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("a scene's shader"),
        layout: Some(&layout),
        module: &module,
        entry_point: Some("ask"),
        compilation_options: Default::default(),
        cache: None,
    });
    let points: Vec<[f32; 4]> = points.iter().map(|at| at.extend(1.0).to_array()).collect();
    let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("points"),
        contents: bytemuck::cast_slice(&points),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
    });
    let facing = bindings::uniform_buffer(device, "normal", 16);
    queue.write_buffer(&facing, 0, bytemuck::bytes_of(&normal.extend(0.0).to_array()));
    let group =
        bindings::group(device, "points", &own, &[buffer.as_entire_binding(), facing.as_entire_binding()]);
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.set_bind_group(1, setup.view.light_group(), &[]);
    pass.dispatch_workgroups(points.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    pollster::block_on(readback::buffer::<[f32; 4]>(context, &buffer))
        .unwrap()
        .into_iter()
        .map(Vec4::from_array)
        .collect()
}

#[test]
fn scene_shaders_can_evaluate_hair_shadows() {
    let Some(context) = common::context() else { return };
    let mut setup = Setup::new(context, Vec3::new(0.6, 0.0, 0.8));
    setup.wall = 1.2;
    // Without a sky, the pass multiplies the color by the result of the function.
    let [plain, shaded] = [0.0, 1.0].map(|shade| setup.drawn(&[], shade).unwrap());
    let focal = 0.5 * SIZE[1] as f32 / (0.5 * FOV).tan();
    let place = |i: usize| {
        let [x, y] = [i % SIZE[0] as usize, i / SIZE[0] as usize].map(|n| n as f32 + 0.5);
        let way = Vec3::new((x - 48.0) / focal, (40.0 - y) / focal, -1.0);
        Vec3::Z * DISTANCE + setup.wall * way
    };
    let walls: Vec<usize> = (0..plain.len()).filter(|i| plain[*i] == WALL).collect();
    let points: Vec<_> = walls.iter().map(|i| place(*i)).collect();
    let told = told(&setup, &points, Vec3::Z);
    let mut darkest = 1.0_f32;
    for (i, told) in walls.iter().zip(&told) {
        let found = shaded[*i] / WALL;
        darkest = darkest.min(told.min_element());
        assert!((found - *told).truncate().abs().max_element() < 4e-3, "{found} {told} at {}", place(*i));
    }
    assert!(darkest < 0.2, "{darkest}: there is a shadow");
    // The scene chooses the index of the bind group.
    assert!(shade::wgsl(3).contains("@group(3)") && !shade::wgsl(3).contains("@group(0)"));
}

#[test]
fn shadow_map_reports_what_it_covers() {
    let Some(context) = common::context() else { return };
    let setup = Setup::new(context, Vec3::Z);
    let flat = orthographic(-1.0, 1.0, -1.0, 1.0, 1.0, 9.0);
    let lamp = Camera::perspective(std::f32::consts::FRAC_PI_2, 1.0, 0.1);
    let depth = setup.map(flat, [4; 2], |_, _| f32::NAN);
    let sees = |projection, [x, z]: [f32; 2]| {
        let shadow = SceneShadow { light: 0, depth: &depth, part: None, projection, bias: 0.0 };
        shadow.covers(&Sphere { center: Vec3::new(x, 0.0, z), radius: 0.2 })
    };
    for projection in [flat, reversed(flat)] {
        for (at, seen) in [
            ([0.7, -5.0], Some(true)),
            ([0.9, -5.0], Some(false)),
            ([1.1, -5.0], Some(false)),
            ([1.3, -5.0], None),
            ([0.0, -0.9], Some(false)),
            ([0.0, -0.5], None),
            ([0.0, -8.7], Some(true)),
            ([0.0, -9.3], None),
        ] {
            assert_eq!(sees(projection, at), seen, "{at:?}");
        }
    }
    // The sides of a spot light's map are at 45°, so 0.2 m from them is 0.28 m sideways.
    let places =
        [([4.7, -5.0], Some(true)), ([5.25, -5.0], Some(false)), ([5.3, -5.0], None), ([0.0, 5.0], None)];
    for (at, seen) in places {
        assert_eq!(sees(lamp, at), seen, "{at:?}");
    }
}
