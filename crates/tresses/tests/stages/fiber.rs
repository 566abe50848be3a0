//! The fiber shading model compared with path-traced values, and its GPU code compared with the reference on the CPU.

use crate::common;

use std::path::Path;
use tresses::{
    Camera, Context, Picture, View, ViewOptions,
    glam::{DVec3, Mat3, Vec3},
    groom::bound::Strand,
    light::{
        Environment, FiberMaterial, HairMaterial, Light, Lights, Shadows, Sky, Sphere,
        fiber::{bsdf, far::FarField},
    },
    low_level::{
        FiberShape, HairSet, StrandVertex, pack_tangent, readback::blocking as readback, unpack_radiance,
    },
    renderer::Renderer,
};

/// Returns the content of a reference file, if it exists.
fn reference(name: &str) -> Option<String> {
    let path = common::asset(Path::new("../reference").join(name))?;
    Some(std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

/// Returns all `[x, y, z]` of the list `"name"`.
fn triples(json: &str, name: &str) -> Vec<DVec3> {
    let key = format!("\"{name}\": [[");
    let start = json.find(&key).unwrap_or_else(|| panic!("no {name}")) + key.len();
    let list = &json[start..start + json[start..].find("]]").expect("the list ends")];
    list.split("], [")
        .map(|triple| {
            let v: Vec<f64> = triple.split(", ").map(|v| v.parse().expect("a number")).collect();
            DVec3::new(v[0], v[1], v[2])
        })
        .collect()
}

/// Longitudinal scattering as Mitsuba's plugin computes it: I₀ from the first terms of its series below 12 and from a
/// coarse formula above, both up to 0.5 % too low. Comparing with the same approximation reveals smaller errors.
fn plugin_along(v: f64, sin_eye: f64, cos_eye: f64, sin_light: f64, cos_light: f64) -> f64 {
    let a = cos_eye * cos_light / v;
    let series = if a > 12.0 {
        (0.5 / (8.0 * a)).exp() / (std::f64::consts::TAU * a).sqrt()
    } else {
        let term = |i: i32| (1..=i).map(|k| (0.5 * a / f64::from(k)).powi(2)).product::<f64>();
        (-a).exp() * (0..=10).map(term).sum::<f64>()
    };
    bsdf::along(v, sin_eye, cos_eye, sin_light, cos_light) * series / bsdf::scaled_bessel(a)
}

/// Returns the largest and the mean difference between the near field and Mitsuba's table, relative to the value plus
/// 0.001.
fn table_error(json: &str, shape: &FiberShape, along: bsdf::Longitudinal) -> [f64; 2] {
    let (eyes, lights) = (triples(json, "wi"), triples(json, "wo"));
    let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0);
    for (name, eumelanin, pheomelanin) in
        [("brunette", 1.3, 0.2), ("blond", 0.25, 0.05), ("red", 0.12, 1.5), ("black", 6.0, 0.3)]
    {
        let sigma = DVec3::new(0.419, 0.697, 1.37) * eumelanin + DVec3::new(0.187, 0.4, 1.05) * pheomelanin;
        let own = DVec3::from(bsdf::melanin(eumelanin as f32, pheomelanin as f32));
        assert!((own - sigma).abs().max_element() < 1e-6);
        let values = triples(json, name);
        assert!(values.len() == 256 && eyes.len() == 256 && lights.len() == 256);
        for ((eye, light), value) in eyes.iter().zip(&lights).zip(&values) {
            let ours = shape.near_along(*eye, *light, sigma, along);
            for (ours, value) in ours.to_array().into_iter().zip(value.to_array()) {
                let error = (ours - value).abs() / (value + 1e-3);
                worst = worst.max(error);
                sum += error;
                count += 1;
            }
        }
    }
    [worst, sum / f64::from(count)]
}

#[test]
fn near_field_matches_mitsuba() {
    let Some(json) = reference("bsdf_table.json") else { return };
    let shape = FiberShape::default();
    let [worst, mean] = table_error(&json, &shape, plugin_along);
    println!("with the plugin's Bessel function: worst {worst:.2e}, mean {mean:.2e}");
    assert!(worst < 1.5e-3 && mean < 1e-4);
    let [worst, mean] = table_error(&json, &shape, bsdf::along);
    println!("with the function itself: worst {worst:.2e}, mean {mean:.2e}");
    assert!(worst < 6e-3 && mean < 5e-4);
    // Wrong parameters are detected.
    for wrong in [
        FiberShape { tilt: -shape.tilt, ..shape },
        FiberShape { eta: 1.53, ..shape },
        FiberShape { azimuthal: 0.31, ..shape },
        FiberShape { longitudinal: 0.31, ..shape },
    ] {
        let [worst, mean] = table_error(&json, &wrong, plugin_along);
        assert!(worst > 0.02 && mean > 2e-3, "{wrong:?} {worst} {mean}");
    }
}

/// Directions from a fiber to the eye and to the lights, in the frame of the fiber.
struct View1 {
    eye: Vec3,
    lights: Vec<Vec3>,
}

impl View1 {
    fn new(theta: f32, count: u32) -> Self {
        let light = |i: u32| {
            let y = (i as f32 + 0.5) / count as f32 * 2.0 - 1.0;
            let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
            Vec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin)
        };
        Self { eye: Vec3::new(theta.cos(), theta.sin(), 0.0), lights: (0..count).map(light).collect() }
    }
}

/// Returns a light of irradiance 1 from `direction`, without a sky.
fn light_from(direction: Vec3) -> Lights {
    let list = vec![Light::distant(direction, Vec3::ONE)];
    Lights { list, sky: Sky::default(), environment: Environment::default() }
}

/// Shades one fiber per light with `light::shade`, all with an irradiance of 1.
fn on_gpu(context: &Context, view: &View1, material: FiberMaterial) -> Vec<Vec3> {
    let to_light = Vec3::new(0.3, 0.8, 0.5).normalize();
    // Rotate each fiber so that its light comes from `to_light`.
    let vertices: Vec<_> = view
        .lights
        .iter()
        .flat_map(|light| {
            let turn = tresses::glam::Quat::from_rotation_arc(*light, to_light);
            let at = |y: f32| turn * (Vec3::Y * y - view.eye);
            let tangent = pack_tangent(Mat3::from_quat(turn) * Vec3::Y, 1.0);
            [0.0, 1e-5].map(|y| StrandVertex { position: at(y), tangent })
        })
        .collect();
    let options = ViewOptions { renderer: Renderer::masks(1), ..common::coarse() };
    let eye = View::new(context, &options, [16, 16], 1).expect("fits");
    let info = vec![Strand { radius: 1e-4, seed: 7, root_color: 0, tip_color: 0 }; view.lights.len()];
    let mut hair = HairSet::new(context, &common::upload(context, 2, &vertices, &info)).expect("fits");
    hair.material = HairMaterial { fiber: material, warmth_spread: 0.0, ..Default::default() };
    let lights = light_from(to_light);
    // Fibers do not shadow each other.
    let shadows = Shadows { is_enabled: false, ..Default::default() };
    let picture = Picture {
        camera: Camera::look_at(Vec3::ZERO, Vec3::Z, 1.0, [16, 16]),
        focus: Sphere { center: Vec3::ZERO, radius: 3.0 },
        lights,
        shadows,
        ..Default::default()
    };
    common::picture(context, &eye, &picture, &[&hair], &[]);
    let shaded: Vec<u32> = readback::buffer(context, &eye.shaded(&hair).unwrap()).expect("read back");
    shaded.into_iter().step_by(2).map(unpack_radiance).collect()
}

/// Returns a material without light that surrounding hair reflects.
fn alone(sigma_a: Vec3, shape: FiberShape) -> FiberMaterial {
    FiberMaterial { shape, density_back: 0.0, ..FiberMaterial::uniform(sigma_a) }
}

#[test]
fn gpu_matches_the_cpu_reference() {
    let Some(context) = common::context() else { return };
    for (shape, sigma, theta) in [
        (FiberShape::default(), bsdf::melanin(1.3, 0.2), 0.2_f32),
        (
            FiberShape { longitudinal: 0.15, azimuthal: 0.4, ..Default::default() },
            bsdf::melanin(0.25, 0.05),
            -0.9,
        ),
        (FiberShape::default(), bsdf::melanin(6.0, 0.3), 0.0),
    ] {
        let view = View1::new(theta, 700);
        let far = FarField::new(&shape);
        // Largest difference from the CPU reference for `shape` and `sigma`, relative to the brightest value.
        let error = |given: FiberMaterial| {
            let shaded = on_gpu(context, &view, given);
            let (mut worst, mut brightest) = (0.0_f32, 0.0_f32);
            for (shaded, light) in shaded.iter().zip(&view.lights) {
                let exact = far.scatter(Vec3::Y, view.eye, *light, sigma);
                worst = worst.max((*shaded - exact).abs().max_element());
                brightest = brightest.max(exact.max_element());
            }
            worst / brightest
        };
        // The tables are half floats, and tangents have 12 bits per axis.
        let most = 0.01;
        let right = error(alone(sigma, shape));
        // Less pigment changes any hair. More pigment would not change black hair, which reflects light at its surface
        // only.
        let lighter = error(alone(sigma * 0.5, shape));
        let smoother = FiberShape { longitudinal: 0.9 * shape.longitudinal, ..shape };
        let smoother = error(alone(sigma, smoother));
        println!("{shape:?} {sigma}: {right:.2e}, lighter {lighter:.2e}, smoother {smoother:.2e}");
        assert!(right < most, "{right}");
        assert!(lighter > 1.5 * most && smoother > 1.5 * most, "{lighter} {smoother}");
    }
}

#[test]
fn white_furnace_on_the_gpu() {
    let Some(context) = common::context() else { return };
    for theta in [0.0_f32, 0.7, -1.2] {
        let view = View1::new(theta, 6000);
        let sum = |sigma: f32| {
            let shaded = on_gpu(context, &view, alone(Vec3::splat(sigma), FiberShape::default()));
            shaded.iter().map(|v| v.y).sum::<f32>() * 4.0 * std::f32::consts::PI / shaded.len() as f32
        };
        let (white, gray) = (sum(0.0), sum(0.15));
        println!("{theta}: {white:.4} of white light, {gray:.4} with absorption");
        assert!((white - 1.0).abs() < 0.02);
        assert!(gray < 0.93);
    }
}

/// Returns the radiances at both ends of upright strands at these places, lit from the eye, with strand maps of
/// `strand_map` texels along each edge, 0 for none.
fn upright(
    context: &Context,
    places: &[Vec3],
    density_back: f32,
    strand_by_strand: f32,
    strand_map: u32,
) -> Vec<f32> {
    let ends: Vec<_> = places.iter().map(|at| [-0.05, 0.05].map(|y| *at + Vec3::Y * y)).collect();
    let mut hair = common::segments(context, &ends, 1e-4);
    let picture = Picture {
        camera: Camera::look_at(Vec3::Z, Vec3::ZERO, 0.4, [16, 16]),
        focus: Sphere { center: Vec3::ZERO, radius: 0.2 },
        lights: light_from(Vec3::Z),
        shadows: Shadows { strand_by_strand, ..Default::default() },
        ..Default::default()
    };
    let fiber = FiberMaterial { density_back, ..FiberMaterial::uniform(Vec3::splat(0.1)) };
    hair.material = HairMaterial { fiber, warmth_spread: 0.0, ..Default::default() };
    let options = ViewOptions {
        renderer: Renderer::masks(1),
        shadow_resolution: 256,
        strand_map_resolution: strand_map,
        ..Default::default()
    };
    let eye = View::new(context, &options, [16, 16], 1).expect("fits");
    common::picture(context, &eye, &picture, &[&hair], &[]);
    let shaded: Vec<u32> = readback::buffer(context, &eye.shaded(&hair).unwrap()).expect("read back");
    shaded.into_iter().map(|word| unpack_radiance(word).y).collect()
}

/// Returns the places of strands in a block 10 cm wide and 6 cm deep, so that a ray hits `fibers` of them. The first
/// strand is at the front.
fn block(fibers: f32) -> Vec<Vec3> {
    let count = (fibers * 0.1 / 2e-4) as u32;
    let place = |i: u32| {
        let [x, z] = [0.754_877_7, 0.569_840_3].map(|step: f32| (i as f32 * step).fract());
        Vec3::new(0.1 * (x - 0.5), 0.0, -0.06 * z)
    };
    std::iter::once(Vec3::ZERO).chain((1..count).map(place)).collect()
}

#[test]
fn reflected_light_grows_with_the_amount_of_hair() {
    let Some(context) = common::context() else { return };
    // Radiance of the first strand with and without light that other strands reflect: the ratio.
    let found = [0.0, 0.5, 2.0, 16.0].map(|fibers| {
        let places = block(fibers);
        let [with, without] =
            [0.7, 0.0].map(|density_back| upright(context, &places, density_back, 0.0, 0)[0]);
        with / without
    });
    println!("{found:?}");
    assert!((found[0] - 1.0).abs() < 0.01, "a strand alone");
    assert!(found.is_sorted(), "the more fibers, the more light");
    assert!(found[3] > 1.2 && found[1] < 1.0 + 0.6 * (found[3] - 1.0));
}

#[test]
fn per_strand_shadows_keep_the_mean() {
    let Some(context) = common::context() else { return };
    let places = block(6.0);
    // Radiance with the mean light for every strand, and with light or shade for each; by depth, where the mean
    // transmittance falls from 1 to e^-6.
    let [smooth, single] = [0.0, 1.0].map(|strength| upright(context, &places, 0.7, strength, 0));
    let spread = |values: &[f32]| {
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / values.len() as f32;
        (mean, square.sqrt() / mean)
    };
    for slice in 0..5 {
        let there = |values: &[f32]| {
            let deep = |i: usize| (-places[i / 2].z / 0.012) as usize == slice;
            spread(&values.iter().enumerate().filter(|(i, _)| deep(*i)).map(|(_, v)| *v).collect::<Vec<_>>())
        };
        let ((mean, little), (chance, much)) = (there(&smooth), there(&single));
        println!("{slice}: {mean:.4} ± {little:.2}, by chance {chance:.4} ± {much:.2}");
        assert!((chance / mean - 1.0).abs() < 0.06, "the mean stays");
        assert!(much > 1.3 * little, "strands differ");
    }
    // Where almost nothing is in the way, almost nothing is stochastic.
    let alone = [0.0, 1.0].map(|strength| upright(context, &block(0.0), 0.7, strength, 0)[0]);
    assert!((alone[1] / alone[0] - 1.0).abs() < 0.02, "{alone:?}");
}

/// Strand maps determine which strands are lit.
#[test]
fn strand_maps_shade_hidden_strands() {
    let Some(context) = common::context() else { return };
    // Strands of 0.2 mm, as seen from the light: one in front, one hidden by it, and one beside both.
    let row = [Vec3::ZERO, Vec3::new(0.0, 0.0, -0.01), Vec3::new(0.005, 0.0, -0.01)];
    let found = upright(context, &row, 0.0, 1.0, 2048);
    let [alone, hidden, beside] = [0, 1, 2].map(|i| found[2 * i]);
    println!("alone {alone:.4}, hidden {hidden:.4}, beside {beside:.4}");
    assert!(hidden < 0.4 * alone && (beside / alone - 1.0).abs() < 0.05);
    // The stochastic estimate cannot determine that.
    let chance = upright(context, &row, 0.0, 1.0, 0);
    assert!(
        chance[2] > 2.0 * hidden,
        "a strand that is hidden by one is mostly lit in the mean: {}",
        chance[2]
    );

    // In a block of hair, a strand is lit if no strand nearer to the light covers it, by counting all of them.
    let places = block(6.0);
    let found = upright(context, &places, 0.0, 1.0, 2048);
    let light = upright(context, &places[..1], 0.0, 1.0, 2048)[0];
    let dark = hidden / alone;
    let (mut right, mut all) = (0, 0);
    for (i, place) in places.iter().enumerate() {
        let covered = |near: f32| {
            let hides = |other: &&Vec3| other.z > place.z + 0.0006 && (other.x - place.x).abs() < near;
            places.iter().any(|other| hides(&other))
        };
        // Skip strands that are half covered or covered by a strand close by.
        let is_lit = !covered(4e-4);
        if is_lit || covered(5e-5) {
            all += 1;
            right += u32::from((found[2 * i] > (0.5 + 0.5 * dark) * light) == is_lit);
        }
    }
    println!("{right} of {all} are told right");
    assert!(all > 1000 && f64::from(right) > 0.97 * f64::from(all));
}
