//! Lights of all shapes: far ones equal distant lights, near ones fall off and diverge, many act like a sky.

use crate::{common, golden};
use tresses::{
    Body, BodyMaterial, Camera, Context, Picture, Pose, Timings, View, ViewOptions,
    glam::Vec3,
    groom::srgb::linear,
    light::{HairMaterial, Light, LightShape, Lights, Shadows, Sky, Sphere},
    low_level::{
        Drawing, Hair, HairSet, Shadow, ShadowProbe, StrandVertex, Zone, readback, unpack_radiance, wall,
    },
    renderer::{Renderer, ShadingModel},
};

/// Vertical, radians.
const FIELD_OF_VIEW: f32 = 0.6;

/// Hair on a ball, in lights of all shapes.
struct Bench<'a> {
    context: &'a Context,
    view: View,
    hair: HairSet,
    body: Body,
    picture: Picture,
}

impl<'a> Bench<'a> {
    fn new(context: &'a Context, renderer: Renderer, shadow_maps: u32) -> Self {
        let options = ViewOptions { renderer, shadow_maps, shadow_resolution: 512, ..Default::default() };
        let mut hair = HairSet::new(context, &golden::strands(context, 0..golden::COUNT)).unwrap();
        hair.material = HairMaterial::blond();
        let mut body = Body::new(context, &golden::ball());
        body.material = BodyMaterial { wrap: 0.0, ..Default::default() };
        let picture = Picture {
            camera: Camera::look_at(Vec3::new(0.1, 0.15, 0.6), Vec3::ZERO, FIELD_OF_VIEW, golden::SIZE),
            focus: Sphere { center: Vec3::ZERO, radius: 0.2 },
            lights: Lights { list: Vec::new(), sky: Sky::default(), ..Default::default() },
            shadows: Shadows { strand_by_strand: 0.0, ..Default::default() },
            ..Default::default()
        };
        Self { context, view: View::new(context, &options, golden::SIZE, 1).unwrap(), hair, body, picture }
    }

    /// Draws the scene in the lights of `list`. Returns the radiance of each strand vertex.
    fn radiance(&mut self, list: Vec<Light>) -> Vec<Vec3> {
        self.picture.lights.list = list;
        let mut encoder = self.context.device().create_command_encoder(&Default::default());
        self.context
            .recorder(&mut encoder)
            .draw_strands(&[&self.hair], &[&self.body], &self.view, Drawing::new(&self.picture))
            .unwrap();
        self.context.queue().submit([encoder.finish()]);
        let words: Vec<u32> =
            readback::blocking::buffer(self.context, &self.view.shaded(&self.hair).unwrap()).unwrap();
        words.into_iter().map(unpack_radiance).collect()
    }

    /// Reads back the image that was drawn last.
    fn image(&self) -> Vec<u8> {
        pollster::block_on(self.view.targets().read()).unwrap()
    }

    /// Draws the ball above a floor `height` meters below it. Returns the linear brightness of the image's middle row, on
    /// the floor in front of the ball.
    fn floor(&mut self, light: Light, height: f32) -> Vec<f32> {
        let mut floor = golden::ball();
        let corner = |x: f32, z: f32| Vec3::new(0.19 * x, -0.08 - height, 0.19 * z);
        let plane =
            common::rectangle([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
        let first = floor.positions.len() as u32;
        floor.positions.extend(&plane.positions);
        floor.normals.extend(vec![Vec3::Y; plane.positions.len()]);
        floor.triangles.extend(plane.triangles.iter().map(|corners| corners.map(|i| i + first)));
        self.body = Body::new(self.context, &floor);
        self.body.material = BodyMaterial { wrap: 0.0, gloss: 0.0, ..Default::default() };
        let (eye, target) = Self::above_floor(height);
        self.picture.camera = Camera::look_at(eye, target, FIELD_OF_VIEW, golden::SIZE);
        self.radiance(vec![light]);
        let image = self.image();
        let [width, row] = [golden::SIZE[0] as usize, golden::SIZE[1] as usize / 2];
        (0..width).map(|x| linear(f32::from(image[4 * (row * width + x) + 1]) / 255.0)).collect()
    }

    /// Returns the camera of [`floor`](Self::floor) and its target, which is in the middle of the row.
    fn above_floor(height: f32) -> (Vec3, Vec3) {
        (Vec3::new(0.0, 0.02 - height, 0.45), Vec3::Y * (-0.08 - height))
    }

    /// Returns the x coordinates of the points of the floor in the row of [`floor`](Self::floor).
    fn floor_points(height: f32) -> impl Iterator<Item = f32> {
        let (eye, target) = Self::above_floor(height);
        let step = 2.0 * (0.5 * FIELD_OF_VIEW).tan() * eye.distance(target) / golden::SIZE[1] as f32;
        (0..golden::SIZE[0]).map(move |x| (x as f32 + 0.5 - 0.5 * golden::SIZE[0] as f32) * step)
    }

    /// Returns the shadows at points of the hair, for each light with a map.
    fn shadows(&mut self, list: Vec<Light>, points: &[Vec3]) -> Vec<Vec<Shadow>> {
        let count = list.len();
        self.radiance(list);
        let probe = ShadowProbe::new(self.context, &self.view.light, points, None).unwrap();
        let mut encoder = self.context.device().create_command_encoder(&Default::default());
        probe.record(&mut encoder).unwrap();
        self.context.queue().submit([encoder.finish()]);
        pollster::block_on(probe.read()).unwrap().into_iter().map(|lights| lights[..count].to_vec()).collect()
    }
}

fn mean(radiance: &[Vec3]) -> Vec3 {
    radiance.iter().sum::<Vec3>() / radiance.len() as f32
}

/// Mean difference of two results, over the mean of the first.
fn difference(a: &[Vec3], b: &[Vec3]) -> f32 {
    let off: f32 = a.iter().zip(b).map(|(a, b)| (*a - *b).abs().element_sum()).sum();
    off / a.iter().map(|a| a.element_sum()).sum::<f32>()
}

const TO_LIGHT: Vec3 = Vec3::new(-0.48, 0.6, 0.64);

/// Returns lights of all shapes at `place`, small and turned to the origin, whose irradiance there is 3.
fn shapes(place: Vec3) -> Vec<(&'static str, Light)> {
    let direction = -place.normalize();
    let right = direction.any_orthonormal_vector();
    let up = right.cross(direction);
    let square = place.length_squared();
    let size = 0.01 * place.length();
    let shape = |shape, area: f32| Light::new(shape, 3.0 * square / area);
    let circle = std::f32::consts::PI * size * size;
    let ends = [place - size * right, place + size * right];
    vec![
        ("point", shape(LightShape::Point { position: place }, 1.0)),
        ("spot", shape(LightShape::Spot { position: place, direction, inner: 0.3, outer: 0.4 }, 1.0)),
        (
            "rectangle",
            shape(
                LightShape::Rectangle { center: place, right: -size * right, up: size * up },
                4.0 * size * size,
            ),
        ),
        ("disc", shape(LightShape::Disc { center: place, direction, radius: size, hole: 0.0 }, circle)),
        ("sphere", shape(LightShape::Sphere { center: place, radius: size }, circle)),
        ("tube", shape(LightShape::Tube { ends, radius: 0.1 * size }, 0.4 * size * size)),
    ]
}

/// Far lights of any shape give the image of a distant light: on hair and on the body, with both shading models.
#[test]
fn far_lights_equal_distant_lights() {
    let Some(context) = common::context() else { return };
    for model in [ShadingModel::Fiber, ShadingModel::KajiyaKay] {
        let mut bench = Bench::new(context, Renderer::masks(1).with_shading(model), 4);
        let distant = bench.radiance(vec![Light::distant(TO_LIGHT, Vec3::splat(3.0))]);
        let image = bench.image();
        for (name, light) in shapes(60.0 * TO_LIGHT) {
            let found = bench.radiance(vec![light]);
            let off = difference(&distant, &found);
            let (pixels, _) = golden::difference(&image, &bench.image());
            println!("{model:?} {name}: {off:.4}, image {pixels:.3} of 255");
            assert!(off < 0.03 && pixels < 0.4, "{model:?} {name}: {off} {pixels}");
        }
        let aside = bench.radiance(vec![Light::distant(Vec3::new(0.6, 0.48, 0.64), Vec3::splat(3.0))]);
        assert!(difference(&distant, &aside) > 0.2, "the comparer sees no difference");
    }
}

/// Without shadows, each fiber has the radiance that a distant light from the direction and with the irradiance there
/// gives it, as the Rust functions compute them.
#[test]
fn irradiance_matches_the_rust_functions() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    bench.picture.shadows = Shadows { is_enabled: false, ..Default::default() };
    let places: Vec<_> = (0..6)
        .map(|i| Vec3::new((i as f32).sin(), (2.0 * i as f32).cos(), (3.0 * i as f32).sin()) * 0.12)
        .collect();
    let ends: Vec<_> = places.iter().map(|at| [*at, *at + 1e-4 * Vec3::new(0.6, 0.8, 0.0)]).collect();
    bench.hair = common::segments(context, &ends, 1e-4);
    bench.hair.material = HairMaterial::blond();
    for (name, light) in shapes(0.35 * TO_LIGHT) {
        let light = Light { range: 0.6, ..light };
        let found = bench.radiance(vec![light]);
        let strengths: Vec<f32> = places
            .iter()
            .enumerate()
            .map(|(i, at)| {
                let (direction, irradiance) = light.irradiance_at(*at);
                let expected = bench.radiance(vec![Light::distant(direction, irradiance)])[2 * i];
                let off = (found[2 * i] - expected).abs().max_element();
                assert!(off <= 0.015 * expected.max_element(), "{name} at {at}: {} {expected}", found[2 * i]);
                irradiance.x
            })
            .collect();
        println!("{name}: irradiance {strengths:.2?}");
        let [low, high] = [f32::min, f32::max].map(|pick| strengths.iter().copied().reduce(pick).unwrap());
        assert!(high > 2.0 * low, "{name} falls off");
    }
}

/// Points behind the ball are in its shadow, which diverges from a near light, and hair counts the fibers in between,
/// for lights with one view into their map and for those within the hair, with six.
#[test]
fn near_lights_cast_diverging_shadows() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    for distance in [0.16, 0.22, 0.3, 0.5] {
        for direction in [TO_LIGHT, Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)] {
            let place = distance * direction;
            let side = direction.any_orthonormal_vector();
            // The ball has a radius of 0.08: its shadow's edge leaves the light at the angle of its tangents.
            let behind = -0.12 * direction;
            let edge = (distance + 0.12) * (0.08 / distance).asin().tan();
            let points = [behind, behind + 0.85 * edge * side, behind + 1.1 * edge * side, 0.09 * direction];
            let solid: Vec<f32> = bench
                .shadows(vec![Light::point(place, Vec3::ONE)], &points)
                .iter()
                .map(|lights| lights[0].solid)
                .collect();
            assert!(solid[0] < 0.02 && solid[1] < 0.1, "{distance} {direction}: {solid:?}");
            assert!(solid[2] > 0.9 && solid[3] > 0.98, "{distance} {direction}: {solid:?}");
        }
    }
    // Fibers in front of points below the hair, beside the same count for a light far away in the same direction.
    let direction = Vec3::new(0.6, 0.0, 0.8);
    let points: Vec<_> =
        (0..40).map(|i| 0.082 * (direction + 0.01 * i as f32 * Vec3::Y).normalize()).collect();
    let fibers = |bench: &mut Bench<'_>, light| {
        let all = bench.shadows(vec![light], &points);
        all.iter().map(|lights| lights[0].fibers).sum::<f32>() / all.len() as f32
    };
    let far = fibers(&mut bench, Light::distant(direction, Vec3::ONE));
    assert!(far > 0.5, "{far}: there is hair in front");
    for distance in [0.16, 0.22, 0.3, 0.6] {
        let near = fibers(&mut bench, Light::point(direction * distance, Vec3::ONE));
        println!("fibers in front: {near} from {distance} m, {far} from afar");
        assert!((near / far - 1.0).abs() < 0.25, "{near} from {distance} m, {far} from afar");
    }
}

/// Lights spread evenly over all directions are a sky.
#[test]
fn many_lights_equal_a_sky() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    let count = 128;
    let lights = |strength: f32| {
        let light = |i: usize| {
            let (y, angle) = (1.0 - (2 * i + 1) as f32 / count as f32, 2.399_963_2 * i as f32);
            let flat = (1.0 - y * y).sqrt();
            Light::distant(Vec3::new(flat * angle.cos(), y, flat * angle.sin()), Vec3::splat(strength))
        };
        (0..count).map(light).collect::<Vec<_>>()
    };
    // A sky of radiance 0.5 has 2π as irradiance over all directions.
    let found = bench.radiance(lights(0.5 * 4.0 * std::f32::consts::PI / count as f32));
    let image = bench.image();
    bench.picture.lights.sky =
        Sky { zenith: Vec3::splat(0.5), horizon: Vec3::splat(0.5), ground: Vec3::splat(0.5) };
    let sky = bench.radiance(Vec::new());
    let (pixels, _) = golden::difference(&image, &bench.image());
    let ratio = mean(&found) / mean(&sky);
    println!("{count} lights over a sky: {ratio}, images differ by {pixels} of 255");
    assert!((ratio - 1.0).abs().max_element() < 0.06 && pixels < 2.0, "{ratio} {pixels}");
    bench.picture.lights.sky = Sky::default();
    let half = bench.radiance(lights(0.25 * 4.0 * std::f32::consts::PI / count as f32));
    assert!((mean(&half) / mean(&found) - 0.5).abs().max_element() < 0.01, "light adds up");
}

/// With eight shadow maps, an image in six lights is the sum of six images.
#[test]
fn eight_maps_add_up() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 8);
    let six: Vec<_> = (0..6)
        .map(|i| {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / 6.0).sin_cos();
            let place = Vec3::new(sin, 0.5, cos);
            match i % 2 {
                0 => Light::distant(place, Vec3::new(2.0, 1.0, 0.5)),
                _ => Light::point(0.4 * place, Vec3::new(0.2, 0.3, 0.4)),
            }
        })
        .collect();
    let alone: Vec<_> = six.iter().map(|light| bench.radiance(vec![*light])).collect();
    let sum: Vec<Vec3> = (0..alone[0].len()).map(|i| alone.iter().map(|each| each[i]).sum()).collect();
    let together = bench.radiance(six.clone());
    let off = difference(&sum, &together);
    println!("six lights with maps: {off}");
    assert!(off < 0.02, "{off}");
    let five: Vec<Vec3> = (0..sum.len()).map(|i| sum[i] - alone[5][i]).collect();
    assert!(difference(&five, &together) > 0.05, "the comparer sees the sixth light");
    // With four maps, the others are in the grid: the light is nearly the same.
    let mut four = Bench::new(context, Renderer::masks(1), 4);
    let eight = bench.image();
    four.radiance(six);
    let (pixels, _) = golden::difference(&eight, &four.image());
    println!("with four maps and with eight, images differ by {pixels} of 255");
    assert!(pixels < 6.0, "{pixels}");
}

/// Two lights that change places in strength change no image by a jump.
#[test]
fn choice_of_maps_changes_gradually() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 1);
    let at = |bench: &mut Bench<'_>, t: f32| {
        let light = |direction: Vec3, strength: f32| Light::distant(direction, Vec3::splat(strength));
        bench.radiance(vec![light(TO_LIGHT, 2.0 + t), light(Vec3::new(0.8, 0.0, -0.6), 2.0 - t)])
    };
    let frames: Vec<_> = (-16..=16).map(|i| at(&mut bench, 0.05 * i as f32)).collect();
    let steps: Vec<f32> = frames.windows(2).map(|pair| difference(&pair[0], &pair[1])).collect();
    let (largest, whole) = (steps.iter().copied().fold(0.0, f32::max), difference(&frames[0], &frames[32]));
    println!("largest step {largest}, from end to end {whole}");
    assert!(largest < 0.25 * whole && whole > 0.1, "{largest} {whole}");
}

#[test]
fn invalid_lights_are_errors_and_others_never_nan() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    let point = Light::point(0.3 * TO_LIGHT, Vec3::ONE);
    let mut encoder = context.device().create_command_encoder(&Default::default());
    for light in [Light { intensity: f32::NAN, ..point }, Light { range: -1.0, ..point }] {
        bench.picture.lights.list = vec![light];
        let drawing = Drawing::new(&bench.picture);
        let recorded =
            context.recorder(&mut encoder).draw_strands(&[&bench.hair], &[&bench.body], &bench.view, drawing);
        let error = recorded.unwrap_err().to_string();
        assert!(error.contains("of a light is"), "{error}");
    }
    // In the ball, at its center, on a strand, of no size, behind the hair's map, and switched off.
    let sphere = |radius| LightShape::Sphere { center: 0.3 * TO_LIGHT, radius };
    let flat = LightShape::Rectangle { center: TO_LIGHT, right: Vec3::ZERO, up: Vec3::ZERO };
    let tube = LightShape::Tube { ends: [TO_LIGHT; 2], radius: 0.0 };
    let lights = [
        Light::point(0.05 * TO_LIGHT, Vec3::ONE),
        Light::point(Vec3::ZERO, Vec3::ONE),
        Light::point(Vec3::new(0.0, 0.0805, 0.0), Vec3::ONE),
        Light::new(sphere(0.0), 1.0),
        Light::new(sphere(10.0), 1.0),
        Light::new(flat, 1.0),
        Light::new(tube, 1.0),
        Light { intensity: 0.0, ..point },
        Light { intensity: 1e30, ..point },
    ];
    for light in lights {
        let found = bench.radiance(vec![light]);
        assert!(found.iter().all(|radiance| radiance.is_finite()), "{light:?}");
        assert_eq!(mean(&bench.radiance(vec![Light { intensity: 0.0, ..light }])), Vec3::ZERO, "{light:?}");
    }
    // Nothing leaves the ball.
    let inside = bench.radiance(vec![Light::point(Vec3::ZERO, Vec3::ONE)]);
    let outside = bench.radiance(vec![Light::point(0.3 * TO_LIGHT, Vec3::ONE)]);
    let vertices: Vec<StrandVertex> =
        readback::blocking::buffer(context, &golden::strands(context, 0..golden::COUNT).vertices).unwrap();
    // Some strands begin in the ball.
    let mean_outside = |radiance: &[Vec3]| {
        let lit = vertices.iter().zip(radiance).filter(|(vertex, _)| vertex.position.length() > 0.085);
        mean(&lit.map(|(_, radiance)| *radiance).collect::<Vec<_>>()).y
    };
    let [inside, outside] = [inside, outside].map(|radiance| mean_outside(&radiance));
    assert!(inside < 0.01 * outside, "{inside} {outside}");
}

/// A large light near the hair gives softer shadows than a small one, as strong on average, and sharp ones at contacts.
#[test]
fn shadows_of_large_lights_widen_with_distance() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    bench.hair = common::segments(context, &[[Vec3::splat(5.0), Vec3::splat(5.1)]], 1e-4);
    let mut shadow = |radius: f32, height: f32| {
        let up = Vec3::Y * 0.6;
        let light = match radius > 0.0 {
            true => Light::new(LightShape::Sphere { center: up, radius }, 1.0 / (radius * radius)),
            false => Light::point(up, Vec3::splat(std::f32::consts::PI)),
        };
        let levels = bench.floor(light, height);
        // Pixels between a quarter and three quarters of the range.
        let (low, high) =
            (levels.iter().copied().fold(1.0, f32::min), levels.iter().copied().fold(0.0, f32::max));
        let between = |level: &&f32| (low + 0.25 * (high - low)..low + 0.75 * (high - low)).contains(*level);
        levels.iter().filter(between).count()
    };
    let [point, small, large] = [0.0, 0.02, 0.12].map(|radius| shadow(radius, 0.06));
    println!("pixels of the penumbra: point {point}, small {small}, large {large}");
    assert!(large > 2 * point.max(1) && small <= large, "{point} {small} {large}");
}

/// A long light casts shadows on points from which hair hides an end of it but not its center.
#[test]
fn shadows_of_long_lights_reach_beyond_the_hair() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    bench.hair = common::segments(context, &[[Vec3::splat(5.0), Vec3::splat(5.1)]], 1e-4);
    bench.picture.focus.radius = 0.1;
    let (height, ends) = (0.06, [Vec3::new(0.05, 0.25, 0.0), Vec3::new(0.55, 0.25, 0.0)]);
    let mut light = Light::new(LightShape::Tube { ends, radius: 0.005 }, 40.0);
    let shadowed = bench.floor(light, height);
    light.casts_shadows = false;
    let lit = bench.floor(light, height);
    let mut errors = Vec::new();
    let mut jump = 0.0f32;
    for (i, x) in Bench::floor_points(height).enumerate() {
        let point = Vec3::new(x, -0.08 - height, 0.0);
        // Each part of the tube delivers light by its distance and the cosines at both ends of the ray, unless the ray
        // passes through the ball.
        let parts = (0..200).map(|k| {
            let ray = ends[0].lerp(ends[1], (k as f32 + 0.5) / 200.0) - point;
            let to_light = ray.normalize();
            let weight = to_light.y * (1.0 - to_light.x * to_light.x).sqrt() / ray.length_squared();
            (weight, point.reject_from_normalized(to_light).length() > 0.08)
        });
        let (all, seen) = parts
            .fold((0.0, 0.0), |(all, seen), (w, is_seen)| (all + w, seen + if is_seen { w } else { 0.0 }));
        let ratio = shadowed[i] / lit[i];
        println!("{x:.3}: {ratio:.3}, {:.3} by rays", seen / all);
        errors.push((ratio - seen / all).abs());
        if i > 0 {
            jump = jump.max((ratio - shadowed[i - 1] / lit[i - 1]).abs());
        }
    }
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    println!("mean error {mean}, largest step {jump}");
    assert!(mean < 0.12, "{mean}");
    assert!(jump < 0.15, "{jump}");
}

/// A head between another one and a light casts its shadow there, also when both are zones of a crowd.
#[test]
fn heads_shadow_each_other() {
    let Some(context) = common::context() else { return };
    let mut bench = Bench::new(context, Renderer::masks(1), 4);
    let away = 0.5 * Vec3::X;
    let moved = |offset: Vec3| -> HairSet {
        let mut vertices: Vec<StrandVertex> =
            readback::blocking::buffer(context, &golden::strands(context, 0..golden::COUNT).vertices)
                .unwrap();
        vertices.iter_mut().for_each(|vertex| vertex.position += offset);
        let info = golden::strands(context, 0..golden::COUNT);
        context.queue().write_buffer(&info.vertices, 0, bytemuck::cast_slice(&vertices));
        let mut hair = HairSet::new(context, &info).unwrap();
        hair.material = HairMaterial::blond();
        hair
    };
    let (first, second) = (moved(Vec3::ZERO), moved(away));
    let mut other = bench.body.instance(false);
    other.pose.translation = away;
    let zone = |i: usize, center: Vec3| Zone {
        focus: Sphere { center, radius: 0.2 },
        resolution: 512,
        cells: 16,
        hair: vec![i],
        bodies: vec![i],
        pose: Default::default(),
        ambient_interval: 1,
    };
    bench.view.set_zones(&[zone(0, Vec3::ZERO), zone(1, away)]);
    let mut lit = |light: Light, hair: &[&HairSet], bodies: &[&Body]| {
        bench.picture.lights.list = vec![light];
        let mut encoder = context.device().create_command_encoder(&Default::default());
        let drawing = Drawing::new(&bench.picture);
        context.recorder(&mut encoder).draw_strands(hair, bodies, &bench.view, drawing).unwrap();
        context.queue().submit([encoder.finish()]);
        let words: Vec<u32> =
            readback::blocking::buffer(context, &bench.view.shaded(hair[0]).unwrap()).unwrap();
        mean(&words.into_iter().map(unpack_radiance).collect::<Vec<_>>()).y
    };
    let body = Body::new(context, &golden::ball());
    for (name, light) in [
        ("distant", Light::distant(Vec3::X, Vec3::splat(3.0))),
        ("lamp", Light::point(1.2 * Vec3::X, Vec3::splat(4.0))),
    ] {
        let alone = lit(light, &[&first], &[&body]);
        let both = lit(light, &[&first, &second], &[&body, &other]);
        println!("{name}: {both} behind the other head, {alone} alone");
        assert!(both < 0.35 * alone, "{name}: {both} {alone}");
        let hair_only = lit(light, &[&first, &second], &[&body]);
        assert!(hair_only < 0.9 * alone && hair_only > both, "{name}: {hair_only} {alone} {both}");
    }
    // A head in a zone has the light of a head without zones.
    let lamp = Light::point(0.4 * TO_LIGHT, Vec3::splat(0.4));
    let zoned = lit(lamp, &[&first], &[&body]);
    let alone = mean(&Bench::new(context, Renderer::masks(1), 4).radiance(vec![lamp])).y;
    assert!((zoned / alone - 1.0).abs() < 0.05, "{zoned} in a zone, {alone} without");
    let behind = Light::distant(Vec3::NEG_X, Vec3::splat(3.0));
    let alone = lit(behind, &[&first], &[&body]);
    let both = lit(behind, &[&first, &second], &[&body, &other]);
    assert!((both / alone - 1.0).abs() < 1e-3, "a head behind casts no shadow: {both} {alone}");
}

/// Shadow maps are drawn again only if a light, hair or a mesh in them has changed.
#[test]
fn maps_of_still_hair_are_reused() {
    let Some(context) = common::context() else { return };
    let mut hair = common::hair_on_a_ball(600);
    let mut body = Body::new(context, &golden::ball());
    let options = ViewOptions { renderer: Renderer::masks(1), shadow_resolution: 256, ..common::coarse() };
    let view = View::new(context, &options, golden::SIZE, 1).unwrap();
    let mut picture = Picture {
        camera: Camera::look_at(Vec3::new(0.1, 0.15, 0.6), Vec3::ZERO, FIELD_OF_VIEW, golden::SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.2 },
        ..Default::default()
    };
    // Draw calls and dispatches of the shadow maps, and the image.
    let drawn = |picture: &Picture, hair: &Hair, body: &Body| {
        let mut timings = Timings::by(wall);
        let mut encoder = context.device().create_command_encoder(&Default::default());
        context
            .recorder(&mut encoder)
            .with_timings(Some(&mut timings))
            .draw(&[hair], &[body], &view, Drawing::new(picture))
            .unwrap();
        context.queue().submit([encoder.finish()]);
        let shadow = timings.counts().iter().find(|(name, _)| *name == "shadow");
        let work = shadow.map_or(0, |(_, counts)| counts.draws + counts.dispatches);
        (work, pollster::block_on(view.targets().read()).unwrap())
    };
    let advance = |hair: &mut Hair, pose: Pose| {
        common::submit(|recorder| recorder.advance(hair, &common::frame(pose, 0.0)));
    };
    advance(&mut hair, Pose::IDENTITY);
    let (first, image) = drawn(&picture, &hair, &body);
    let (again, same) = drawn(&picture, &hair, &body);
    assert!(first > 0 && again == 0 && image == same, "{first} {again}");
    picture.camera = Camera::look_at(Vec3::new(-0.3, 0.15, 0.5), Vec3::ZERO, 0.6, golden::SIZE);
    assert_eq!(drawn(&picture, &hair, &body).0, 0, "the camera moves");
    picture.lights.list[0] = Light::distant(Vec3::X, Vec3::ONE);
    let (moved, image) = drawn(&picture, &hair, &body);
    assert_eq!(moved, first, "a light moves");
    let fresh = View::new(context, &options, golden::SIZE, 1).unwrap();
    assert!(image == common::drawn(&fresh, &picture, &[&hair], &[&body]), "the maps are those of a new view");
    body.pose.translation.x = 0.01;
    assert_eq!(drawn(&picture, &hair, &body).0, first, "a mesh moves");
    advance(&mut hair, Pose { translation: Vec3::X * 0.01, ..Pose::IDENTITY });
    assert_eq!(drawn(&picture, &hair, &body).0, first, "hair moves");
    assert_eq!(drawn(&picture, &hair, &body).0, 0);
    // Whoever has the vertex buffer may write it at any time.
    body.vertices();
    assert_eq!(drawn(&picture, &hair, &body).0, first);
    assert_eq!(drawn(&picture, &hair, &body).0, first);
}
