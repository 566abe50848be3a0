//! Hair in wind: it withstands a storm, its lee side is calmer, and calm air costs nothing.

use crate::common;

use tresses::{
    Context, HairHair, HairOptions, RootToTip, SimulationParams, Wind,
    glam::{Vec2, Vec3},
    groom::{BindOptions, Groom, GuideCount, SdfGrid, Strands, bind},
    low_level::{Hair, HairFrame, VolumeOptions, readback::blocking as readback},
    strands::GuideForce,
    wind::drag,
};

/// Creates hair whose own grid has `cells` cells along an axis.
fn hair(context: &Context, groom: &Groom, field: &SdfGrid, cells: u32) -> Hair {
    let volume = VolumeOptions { resolution: cells, ..Default::default() };
    common::hair(context, groom, &HairOptions { volume, ..Default::default() }, Some(field)).unwrap()
}

/// Simulates the guides alone for `seconds`.
fn simulate(hair: &mut Hair, physics: &SimulationParams, seconds: f32) {
    let mut steps = (seconds * 60.0).round() as u32;
    loop {
        let part = steps.min(8);
        let frame = HairFrame { dt: part as f32 / 60.0, simulation: physics, ..Default::default() };
        common::simulate(hair, &frame);
        steps -= part;
        if steps == 0 {
            return;
        }
    }
}

/// Returns the largest relative change of a strand's length; infinite for NaN.
fn strain(now: &[Vec<Vec3>], rest: &[f32]) -> f32 {
    let change = |(line, rest): (&Vec<Vec3>, &f32)| {
        let change = (common::length(line) / rest - 1.0).abs();
        if change.is_finite() { change } else { f32::INFINITY }
    };
    now.iter().zip(rest).map(change).fold(0.0, f32::max)
}

#[test]
fn storm_does_not_stretch_hair() {
    storm(12);
}

#[test]
#[ignore = "proof"]
fn one_minute_storm_does_not_stretch_hair() {
    storm(60);
}

fn storm(seconds: u32) {
    let Some(context) = common::context() else { return };
    let options = BindOptions { guides: GuideCount::Count(24), ..Default::default() };
    let groom = bind(&common::hanging(200, 12, 0.2), &options).unwrap();
    let mut hair = hair(context, &groom, &common::ball(0.09, 40), 8);
    let rest = blow(&mut hair, 8, seconds);
    let mut now = common::guide_lines(&hair);
    let swept = now.iter().map(|line| line[line.len() - 1].x - line[0].x).sum::<f32>() / now.len() as f32;
    assert!(swept > 0.1, "the storm is felt: {swept}");
    // A strand that is too long is detected, and so is one that is lost.
    let last = now[3].len() - 1;
    now[3][last] = now[3][last] + 0.05 * rest[3] * (now[3][last] - now[3][last - 1]).normalize();
    assert!(strain(&now, &rest) > 0.01);
    now[3][last].x = f32::NAN;
    assert!(strain(&now, &rest) > 1.0);
}

/// Blows at `hair` with 30 m/s in air of `cells` cells along an axis, and checks the lengths of its guides every
/// second. Returns their lengths at rest, meters.
fn blow(hair: &mut Hair, cells: u32, seconds: u32) -> Vec<f32> {
    let wind = Wind { resolution: cells, gusts: 0.3, ..Wind::new(Vec3::new(30.0, 0.0, 4.0)) };
    let physics = SimulationParams { wind, ..Default::default() };
    simulate(hair, &physics, 0.0);
    let rest: Vec<_> = common::guide_lines(hair).iter().map(|line| common::length(line)).collect();
    for second in 1..=seconds {
        simulate(hair, &physics, 1.0);
        let strain = strain(&common::guide_lines(hair), &rest);
        assert!(strain < 0.01, "{} guides, {second} s: {strain}", rest.len());
    }
    rest
}

/// The built-in style `long` with all its guides; the hair's grid and the air have 16 cells along an axis.
#[test]
#[ignore = "proof"]
fn one_minute_storm_does_not_stretch_a_whole_style() {
    let Some(context) = common::context() else { return };
    let Some(built) = common::character("long", 500) else { return };
    blow(&mut hair(context, &built.groom, &built.field, 16), 16, 60);
}

/// Creates straight strands of 10 cm along `ways`, with roots 2 cm apart, in wind of `velocity` without gusts,
/// obstacles or self-collision.
fn in_plain_air(
    context: &Context,
    ways: &[Vec3],
    velocity: Vec3,
    physics: SimulationParams,
) -> (Hair, SimulationParams) {
    let mut strands = Strands::default();
    for (i, way) in ways.iter().enumerate() {
        let root = Vec3::new(0.02 * i as f32, 0.0, 0.0);
        strands.push(&(0..16).map(|j| root + *way * (0.1 * j as f32 / 15.0)).collect::<Vec<_>>());
    }
    let options = BindOptions { guides: GuideCount::Count(ways.len() as u32), ..Default::default() };
    let groom = bind(&strands, &options).unwrap();
    let volume = VolumeOptions { resolution: 8, ..Default::default() };
    let options = HairOptions { volume, simulation: physics, ..Default::default() };
    let mut hair = common::hair(context, &groom, &options, None).unwrap();
    let wind = Wind { resolution: 16, gusts: 0.0, ..Wind::new(velocity) };
    let physics = SimulationParams { wind, hair_hair: HairHair::OFF, ..physics };
    simulate(&mut hair, &physics, 0.0);
    (hair, physics)
}

/// Returns the drag rates (1/s) across and along a hair along `tangent`, by the scalar formula.
fn rates(physics: &SimulationParams, relative: Vec3, tangent: Vec3) -> Vec2 {
    let weight = drag::drag_weight(physics.diameter, physics.line_density);
    drag::drag_rates(relative, tangent, physics.diameter / drag::AIR_VISCOSITY, weight)
}

#[test]
fn drag_on_guides_matches_the_formula() {
    let Some(context) = common::context() else { return };
    let ways = [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 2.0, -3.0)];
    let ways = ways.map(Vec3::normalize);
    // Reynolds numbers of 0.3 to 130.
    for velocity in
        [Vec3::X * 0.05, Vec3::new(1.0, 0.5, -0.3), Vec3::new(5.0, 0.0, 3.0), Vec3::X * 12.0, Vec3::X * 25.0]
    {
        let (mut hair, physics) = in_plain_air(context, &ways, velocity, SimulationParams::default());
        // The forces of the first step act on hair that is still at rest.
        let lines = common::guide_lines(&hair);
        simulate(&mut hair, &physics, 1.0 / 60.0);
        let packed: Vec<GuideForce> = readback::buffer(context, &hair.guides.forces).unwrap();
        // The buffer is scratch memory of the groom and longer.
        let vertices = (hair.guides.count * hair.guides.vertex_count) as usize;
        let worst = |wrong: f32| {
            let mut worst = 0.0f32;
            for (i, force) in packed[..vertices].iter().map(GuideForce::unpack).enumerate() {
                let line = &lines[i % lines.len()];
                let t = (line[1] - line[0]).normalize();
                let exact = rates(&physics, velocity * wrong, t);
                let pull = velocity * (exact.x + physics.drag) + t * ((exact.y - exact.x) * t.dot(velocity));
                // Wind along the hair has no part across it, so the rate across acts on nothing. But that rate is not
                // small: the coefficient grows without bound towards a Reynolds number of 0.
                let aside = velocity.reject_from_normalized(t).length() > 0.01 * velocity.length();
                let across = if aside { (force.rate - exact.x).abs() } else { 0.0 };
                let rate = across.max((force.rate + force.along - exact.y).abs());
                let off = rate.max((force.acceleration - pull).length() / velocity.length());
                worst = worst.max(off / exact.x.max(exact.y));
            }
            worst
        };
        println!("{velocity} m/s: off by {:.5} of the larger rate at most", worst(1.0));
        assert!(worst(1.0) < 0.01, "{}", worst(1.0));
        // Air that is a tenth faster is detected.
        assert!(worst(1.1) > 0.01, "{}", worst(1.1));
    }
}

#[test]
fn floppy_hair_tilts_by_its_drag() {
    hangs_aslant(&[0.8]);
}

#[test]
#[ignore = "proof"]
fn floppy_hair_tilts_by_its_drag_at_any_speed() {
    hangs_aslant(&[0.3, 0.8]);
}

fn hangs_aslant(speeds: &[f32]) {
    let Some(context) = common::context() else { return };
    let floppy = SimulationParams {
        bending: RootToTip { root: 0.0, tip: 0.0, falloff: 1.0 },
        goal: RootToTip { root: 0.0, tip: 0.0, falloff: 1.0 },
        drag: 0.0,
        ..Default::default()
    };
    // In faster wind, hair without stiffness flutters.
    for &speed in speeds {
        let (mut hair, physics) = in_plain_air(context, &[Vec3::NEG_Y], Vec3::X * speed, floppy);
        simulate(&mut hair, &physics, 3.0);
        let mut found = 0.0;
        for _ in 0..30 {
            simulate(&mut hair, &physics, 2.0 / 60.0);
            let line = &common::guide_lines(&hair)[0];
            let way = line[line.len() - 1] - line[1];
            found += way.x.atan2(-way.y) / 30.0;
        }
        // The forces across each part balance: g sin θ = rate · u cos θ.
        let pull = |angle: f32| {
            let t = Vec3::new(angle.sin(), -angle.cos(), 0.0);
            rates(&physics, Vec3::X * speed, t).x * speed * angle.cos() - 9.81 * angle.sin()
        };
        let (mut low, mut high) = (0.0, std::f32::consts::FRAC_PI_2);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if pull(middle) > 0.0 { low = middle } else { high = middle }
        }
        println!("{speed} m/s: {:.3}°, by the formula {:.3}°", found.to_degrees(), low.to_degrees());
        assert!((found - low).abs().to_degrees() < 0.5);
        // The formula excludes angles that are a fifth off.
        assert!(pull(0.8 * low) > 0.0 && pull((1.2 * low).min(1.57)) < 0.0);
    }
}

#[test]
fn lee_side_of_the_long_style_moves_less() {
    let Some(context) = common::context() else { return };
    let Some(built) = common::character("long", 500) else { return };
    let mut hair = hair(context, &built.groom, &built.field, 32);
    // From the head's left, +X.
    let physics = SimulationParams { wind: Wind::new(Vec3::X * -4.0), ..Default::default() };
    simulate(&mut hair, &physics, 0.0);
    let rest = common::guide_lines(&hair);
    let (mut windward, mut lee) = ([0.0; 2], [0.0; 2]);
    let mut last = rest.clone();
    for _ in 0..40 {
        simulate(&mut hair, &physics, 0.05);
        let now = common::guide_lines(&hair);
        // Mean distance from rest, and mean speed, of the vertices that rest on a side.
        let mean = |side: &dyn Fn(Vec3) -> bool| {
            let moves: Vec<_> = rest
                .iter()
                .zip(now.iter().zip(&last))
                .flat_map(|(r, (n, l))| r.iter().zip(n.iter().zip(l)))
                .filter(|(r, _)| side(**r))
                .map(|(r, (n, l))| [n.distance(*r), n.distance(*l) / 0.05])
                .collect();
            [0, 1].map(|k| moves.iter().map(|m| m[k]).sum::<f32>() / moves.len() as f32 / 40.0)
        };
        let (a, b) = (mean(&|r: Vec3| r.x > 0.04), mean(&|r: Vec3| r.x < -0.04));
        for k in 0..2 {
            windward[k] += a[k];
            lee[k] += b[k];
        }
        last = now;
    }
    // The wind holds the windward hair on the head, far from rest but quiet. In the wake, hair stays nearer to its
    // place and flutters.
    println!(
        "windward: {} m from rest at {} m/s; lee: {} m at {} m/s",
        windward[0], windward[1], lee[0], lee[1]
    );
    assert!(lee[0] < 0.7 * windward[0], "{lee:?} {windward:?}");
}

#[test]
fn calm_air_allocates_and_changes_nothing() {
    let Some(context) = common::context() else { return };
    let groom = bind(&common::hanging(60, 12, 0.12), &BindOptions::default()).unwrap();
    let field = common::ball(0.09, 40);
    let run = |wind: Wind| {
        let mut hair = hair(context, &groom, &field, 8);
        simulate(&mut hair, &SimulationParams::default(), 0.0);
        let before = hair.bytes();
        let physics = SimulationParams { wind, ..Default::default() };
        simulate(&mut hair, &physics, 0.4);
        (hair.air.is_some(), hair.bytes() - before, common::guide_lines(&hair))
    };
    let calm = run(Wind::default());
    let uniform = run(Wind::uniform(Vec3::ZERO));
    let windy = run(Wind::new(Vec3::X * 5.0));
    assert!(!calm.0 && calm.1 == 0);
    assert_eq!(calm, uniform);
    assert!(windy.0 && windy.1 > 32 * 32 * 32 * 40, "{}", windy.1);
    let moved = windy.2.iter().flatten().zip(calm.2.iter().flatten()).map(|(a, b)| a.distance(*b));
    assert!(moved.fold(0.0, f32::max) > 0.01);
}
