//! Hair lit by environment maps and reflection probes, and hair in fog.

use crate::common::{Picture, after, app, camera, fan, inside, light, settled, wait};
use bevy::{
    core_pipeline::tonemapping::Tonemapping,
    light::{GlobalAmbientLight, LightProbe},
    prelude::*,
};
use bevy_tresses::{Hair3d, HairGroom};

/// Frames after which a map is measured.
const MEASURED: usize = 8;
/// Luminance, candela per square meter.
const BRIGHT: f32 = 4000.0;

/// Returns the mean brightness of the upper and of the lower half of the changed pixels.
fn halves(of: &Picture, bare: &Picture) -> [f32; 2] {
    let (above, below): (Vec<_>, Vec<_>) = of.changed(bare).into_iter().partition(|[_, y]| *y < 48);
    [of.brightness(&above), of.brightness(&below)]
}

#[test]
fn environment_maps_and_probes_light_hair() {
    let mut app = app("assets");
    app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..Default::default() });
    let (eye, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    let groom = HairGroom::from_strands(&fan(1500), &Default::default()).expect("strands are sound");
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom);
    app.world_mut().spawn(Hair3d(groom));
    wait(&mut app);

    // A uniform environment map equals ambient light.
    app.insert_resource(GlobalAmbientLight { brightness: BRIGHT, ..Default::default() });
    let ambient = after(&mut app, MEASURED, &image);
    let [above, below] = halves(&ambient, &bare);
    assert!(above > 20.0 && below > 20.0, "{above} {below}");
    app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..Default::default() });
    let dark = after(&mut app, 4, &image);
    let map = |app: &mut App, [top, middle, bottom]: [Color; 3]| {
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        EnvironmentMapLight::hemispherical_gradient(&mut images, top, middle, bottom).with_intensity(BRIGHT)
    };
    let white = map(&mut app, [Color::WHITE; 3]);
    app.world_mut().entity_mut(eye).insert(white.clone());
    let lit = after(&mut app, MEASURED, &image);
    lit.keep("environment");
    let off = lit.changed(&ambient).len();
    assert!(off < 20, "{off} pixels differ from ambient light");
    assert!(dark.changed(&ambient).len() > 400, "the comparer sees no difference");

    // Light from above. Rotated about the viewing direction, the map lights from below.
    let gray = Color::linear_rgb(0.5, 0.5, 0.5);
    let sky = map(&mut app, [Color::WHITE, gray, Color::BLACK]);
    app.world_mut().entity_mut(eye).insert(sky.clone());
    let upright = after(&mut app, MEASURED, &image);
    upright.keep("sky");
    let over = EnvironmentMapLight { rotation: Quat::from_rotation_z(std::f32::consts::PI), ..sky };
    app.world_mut().entity_mut(eye).insert(over);
    let turned = after(&mut app, MEASURED, &image);
    let ([above, below], [top, bottom]) = (halves(&upright, &bare), halves(&turned, &bare));
    let mirrored = (above - bottom).abs().max((below - top).abs());
    assert!(above > below + 2.0 && mirrored < 1.0, "{above} {below} upright, {top} {bottom} turned");

    // A probe replaces the camera's map inside its box.
    app.world_mut().entity_mut(eye).remove::<EnvironmentMapLight>();
    let red = map(&mut app, [Color::linear_rgb(1.0, 0.0, 0.0); 3]);
    app.world_mut().entity_mut(eye).insert(red);
    let view = after(&mut app, MEASURED, &image);
    let probe = (LightProbe::new(), white, Transform::from_scale(Vec3::splat(2.0)));
    let probe = app.world_mut().spawn(probe).id();
    let inside = after(&mut app, MEASURED, &image);
    let off = inside.changed(&ambient).len();
    assert!(off < 20, "{off} pixels differ from the probe's light");
    app.world_mut().entity_mut(probe).insert(Transform::from_xyz(5.0, 0.0, 0.0));
    assert!(after(&mut app, MEASURED, &image).is(&view), "a probe is seen from outside");
    assert!(view.changed(&ambient).len() > 400, "the comparer sees no difference");
    app.world_mut().despawn(probe);
    app.world_mut().entity_mut(eye).remove::<EnvironmentMapLight>();
    assert!(after(&mut app, 4, &image).is(&dark), "a map that is gone lights hair");
}

#[test]
fn fog_applies_to_hair() {
    let mut app = app("assets");
    light(&mut app);
    let (eye, image) = camera(&mut app);
    // No tone mapping, so that colors are unchanged.
    app.world_mut().entity_mut(eye).insert(Tonemapping::None);
    let bare = settled(&mut app, &image);
    let groom = HairGroom::from_strands(&fan(1500), &Default::default()).expect("strands are sound");
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom);
    app.world_mut().spawn(Hair3d(groom));
    wait(&mut app);
    let clear = after(&mut app, 4, &image);
    let hair = clear.changed(&bare);
    let fog =
        |falloff| DistanceFog { color: Color::linear_rgb(0.0, 0.3, 0.0), falloff, ..Default::default() };
    let mut seen = |falloff| {
        app.world_mut().entity_mut(eye).insert(fog(falloff));
        after(&mut app, 4, &image)
    };
    // Fog of density zero, and fog that begins behind the hair, change nothing.
    for none in [FogFalloff::Exponential { density: 0.0 }, FogFalloff::Linear { start: 1.0, end: 2.0 }] {
        assert!(seen(none).is(&clear));
    }
    // Full fog leaves only its color where hair is opaque. The background has no fog.
    let dense: Vec<_> = inside(&hair).into_iter().filter(|[x, _]| *x < 92).collect();
    assert!(dense.len() > 150, "{} pixels", dense.len());
    let thick = seen(FogFalloff::Linear { start: 0.0, end: 0.1 });
    thick.keep("thick fog");
    let [r, g, b] = mean(&thick, &dense);
    assert!(r < 10.0 && b < 10.0 && g > 60.0, "{r} {g} {b}");
    // Thin edges of hair become visible only in fog.
    let beside = thick.changed(&bare).into_iter().filter(|pixel| !hair.contains(pixel)).count();
    assert!(beside < hair.len() / 8, "fog is beside the hair: {beside} of {} pixels", hair.len());
    // All falloffs agree where they transmit half of the light, at half a meter.
    let density = 2.0 * std::f32::consts::LN_2;
    let linear = seen(FogFalloff::Linear { start: 0.0, end: 1.0 });
    let half = mean(&linear, &hair);
    let ends = [mean(&clear, &hair), mean(&thick, &hair)];
    assert!(half[0] > ends[1][0] + 5.0 && half[0] < ends[0][0] - 5.0, "{half:?} between {ends:?}");
    let square = 2.0 * std::f32::consts::LN_2.sqrt();
    for other in [
        FogFalloff::Exponential { density },
        FogFalloff::ExponentialSquared { density: square },
        FogFalloff::Atmospheric { extinction: Vec3::splat(density), inscattering: Vec3::splat(density) },
    ] {
        let found = mean(&seen(other.clone()), &hair);
        let off = (0..3).map(|i| (found[i] - half[i]).abs()).fold(0.0, f32::max);
        assert!(off < 3.0, "{other:?}: {found:?} where a line has {half:?}");
    }
}

/// Returns the mean of each channel of some pixels.
fn mean(of: &Picture, pixels: &[[u32; 2]]) -> [f32; 3] {
    let channel = |k: usize| {
        let all = pixels.iter().map(|[x, y]| f32::from(of.pixels[(y * of.width + x) as usize][k]));
        all.sum::<f32>() / pixels.len() as f32
    };
    [0, 1, 2].map(channel)
}
