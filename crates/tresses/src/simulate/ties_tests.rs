use super::*;
use crate::{
    Context, Pose,
    clock::{Mode, Step},
    gpu::{for_tests as context, readback::blocking as readback},
    groom::Guides,
    simulate::{GuideTraits, RestOptions, Simulation, SimulationParams, rest},
    strands::{
        Force, GuideForce,
        guide::{pack_velocity, unpack_velocity},
    },
};
use glam::{Mat3, Quat};

/// Vertices per hair.
const N: usize = 12;

/// Upright hairs 1 cm apart, six by six, 11 cm long.
fn lawn() -> Guides {
    let mut guides = Guides::new(N as u32);
    for g in 0..36 {
        guides.positions.extend((0..N).map(|i| Vec3::new((g % 6) as f32, i as f32, (g / 6) as f32) * 0.01));
        guides.stiffness.push(1.0);
        guides.strands.push(1.0);
        guides.tip_pinned.push(false);
    }
    guides
}

fn tie(from: Vec3, to: Vec3, radius: f32, held: TieTarget) -> Tie {
    Tie { from, to, radius, held, gather: 1.0, group: None }
}

/// Returns a pseudorandom number between -1 and 1.
fn some(i: usize, k: usize) -> f32 {
    ((i * 3 + k) as f32 * 0.618_034).fract() * 2.0 - 1.0
}

fn vector(i: usize) -> Vec3 {
    Vec3::new(some(i, 0), some(i, 1), some(i, 2))
}

/// CPU reference of the kernel: the accelerations, m/s², that make the members (rest position, mass, position,
/// velocity) one rigid piece within `span` seconds.
fn hold(members: &[(Vec3, f32, Vec3, Vec3)], span: f32) -> Vec<Vec3> {
    let center: Vec3 = members.iter().map(|(_, m, x, _)| *x * *m).sum();
    let drift: Vec3 = members.iter().map(|(_, m, _, v)| *v * *m).sum();
    let outer = |a: Vec3, b: Vec3| Mat3::from_cols(a * b.x, a * b.y, a * b.z);
    let (mut a, mut inertia, mut momentum) = (Mat3::ZERO, Mat3::ZERO, Vec3::ZERO);
    for (rests, m, x, v) in members {
        let way = *x - center;
        a += outer(way, *rests) * *m;
        inertia += (Mat3::from_diagonal(Vec3::splat(way.length_squared())) - outer(way, way)) * *m;
        momentum += way.cross(*v - drift) * *m;
    }
    let spin = inertia.inverse() * momentum;
    // Newton's iteration for the polar decomposition, a different method from the kernel's.
    let mut r = a;
    for _ in 0..60 {
        r = (r + r.inverse().transpose()) * 0.5;
    }
    members
        .iter()
        .map(|(rests, _, x, v)| {
            let way = *x - center;
            ((r * *rests - way) / span - (*v - drift - spin.cross(way))) / span
        })
        .collect()
}

/// Runs the kernel on a lawn that is rotated, thrown and shaken. Returns its largest difference from the reference, and
/// the net force and torque that remain, as fractions of the reference's mean acceleration; the torque is divided by
/// the radius of gyration. The reference multiplies the mass of every second member by `false_mass`.
fn kernel(context: &Context, false_mass: f32) -> [f32; 3] {
    let queue = context.queue();
    let hairs = lawn();
    let count = hairs.len();
    let params = SimulationParams::default();
    let traits = vec![GuideTraits::default(); count];
    let rest =
        rest::guides(&hairs.positions, N as u32, &traits, &params, &RestOptions::default(), None).unwrap();
    let guides = GuideBuffers::new(context, count as u32, N as u32, 2).unwrap();
    rest.upload(context, &guides).unwrap();
    let turn = Quat::from_rotation_z(0.7) * Quat::from_rotation_x(-0.4);
    let place = |at: usize| turn * rest.rest[at].position + Vec3::new(0.3, 1.5, -0.2) + vector(at) * 0.002;
    let speed = |at: usize| Vec3::new(1.0, -2.0, 0.5) + Vec3::Y.cross(place(at)) * 3.0 + vector(at + 5);
    let places: Vec<_> = (0..count * N).map(place).collect();
    let speeds: Vec<_> = (0..count * N).map(|at| pack_velocity(speed(at))).collect();
    let words: Vec<[f32; 4]> = places.iter().map(|p| p.extend(0.0).to_array()).collect();
    queue.write_buffer(&guides.current, 0, bytemuck::cast_slice(&words));
    queue.write_buffer(&guides.velocity, 0, bytemuck::cast_slice(&speeds));
    let before = Force { acceleration: Vec3::X, rate: 3.0, tangent: Vec3::Y, along: 2.0 };
    queue.write_buffer(&guides.forces, 0, bytemuck::cast_slice(&vec![GuideForce::pack(&before); count * N]));
    let mut simulation = Simulation::new(context, &guides);
    let middle = Vec3::new(0.025, 0.05, 0.025);
    let band = tie(middle, middle, 0.03, TieTarget::Together);
    let ties = TieAsset::new(context, &hairs, &[band]).unwrap();
    simulation.tie(context, &guides, ties.as_ref()).unwrap();
    assert_eq!(simulation.ties().unwrap().report().rings, 1);
    let head = Pose { rotation: Quat::from_rotation_y(0.1), ..Pose::IDENTITY };
    let step = Step { mode: Mode::Step, begin: head, end: head, from: 0.0, to: 1.0 };
    simulation.prepare(&params, &[step], true).unwrap();
    crate::gpu::compute(context, |pass| simulation.ties().unwrap().record(pass, 0));
    let forces: Vec<GuideForce> = readback::buffer(context, &guides.forces).unwrap();
    let found = TieVertices::of(&hairs, &[band]).unwrap();
    let at = |m: &Member| m.vertex as usize;
    let weigh = |i: usize, m: &Member| if i.is_multiple_of(2) { m.mass } else { m.mass * false_mass };
    let all: f32 = found.members.iter().enumerate().map(|(i, m)| weigh(i, m)).sum();
    let members: Vec<_> = found
        .members
        .iter()
        .enumerate()
        .map(|(i, m)| (m.rests, weigh(i, m) / all, places[at(m)], unpack_velocity(speeds[at(m)])))
        .collect();
    let expected = hold(&members, params.step);
    let center: Vec3 = members.iter().map(|(_, m, x, _)| *x * *m).sum();
    let (mut worst, mut sum, mut torque, mut mean, mut gyration) = (0f32, Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
    for ((m, (_, _, x, _)), expected) in found.members.iter().zip(&members).zip(&expected) {
        let force = forces[at(m)].unpack();
        assert!((force.rate - 3.0).abs() < 1e-6 && force.along == 2.0);
        let a = force.acceleration - before.acceleration;
        worst = worst.max(a.distance(*expected));
        sum += a * m.mass;
        torque += (*x - center).cross(a) * m.mass;
        mean += expected.length() * m.mass;
        gyration += x.distance_squared(center) * m.mass;
    }
    let held: Vec<usize> = found.members.iter().map(at).collect();
    for at in (0..count * N).filter(|at| !held.contains(at)) {
        assert_eq!(forces[at], GuideForce::pack(&before), "{at} is not tied");
    }
    [worst / mean, sum.length() / mean, torque.length() / gyration.sqrt() / mean]
}

#[test]
fn kernel_matches_reference_and_conserves_momentum() {
    let Some(context) = context() else { return };
    let (right, wrong) = (kernel(context, 1.0), kernel(context, 1.3));
    println!("differ by {right:?}, with wrong masses by {wrong:?} of the mean");
    // Forces are half floats.
    assert!(right[0] < 3e-3 && right[1] < 5e-4 && right[2] < 5e-4, "{right:?}");
    assert!(wrong[0] > 1e-2, "{wrong:?}");
}

#[test]
fn tie_holds_guides_that_pass_through() {
    let hairs = lawn();
    let middle = Vec3::new(0.025, 0.05, 0.025);
    // A ball of 1.25 cm radius between four hairs, with three vertices of each inside.
    let found = TieVertices::of(&hairs, &[tie(middle, middle, 0.0125, TieTarget::Together)]).unwrap();
    assert_eq!(found.report(), TieReport { rings: 1, together: 12, to_head: 0 });
    let mass: f32 = found.members.iter().map(|m| m.mass).sum();
    let center: Vec3 = found.members.iter().map(|m| m.rests * m.mass).sum();
    assert!((mass - 1.0).abs() < 1e-5 && center.length() < 1e-6, "{mass} {center}");
    // A band around all hairs, 6 cm long, in three rings. The second tie finds no free vertices.
    let long = tie(Vec3::new(0.025, 0.04, 0.025), Vec3::new(0.025, 0.1, 0.025), 0.01, TieTarget::Together);
    let found = TieVertices::of(&hairs, &[long]).unwrap();
    assert_eq!(found.rings.len(), 3);
    assert!(found.rings.iter().all(|ring| ring.count >= 4), "{:?}", found.rings);
    assert!(TieVertices::of(&hairs, &[long, long]).is_err());
    // A hair that passes through between two of its vertices.
    let beside = Vec3::new(0.0, 0.055, 0.0);
    let found = TieVertices::of(&hairs, &[tie(beside, beside, 0.002, TieTarget::ToHead)]).unwrap();
    assert_eq!(found.report().to_head, 1);
    assert_eq!(found.pins[0].rests.x, 0.0);
}

#[test]
fn tie_can_hold_a_single_group() {
    let middle = Vec3::new(0.025, 0.05, 0.025);
    // Every second column of hairs.
    let hairs = Guides { groups: (0..36).map(|g| g % 2).collect(), ..lawn() };
    let of = |group| Tie { group: Some(group), ..tie(middle, middle, 0.0125, TieTarget::Together) };
    let found = TieVertices::of(&hairs, &[of(1)]).unwrap();
    assert_eq!(found.report(), TieReport { rings: 1, together: 6, to_head: 0 });
    assert!(found.members.iter().all(|member| (member.vertex % 36) % 2 == 1));
    for (hairs, group) in [(&hairs, 7), (&lawn(), 0)] {
        let sentence = TieVertices::of(hairs, &[of(group)]).unwrap_err().to_string();
        assert!(sentence.contains(&format!("of group {group}")), "{sentence}");
    }
}

#[test]
fn invalid_ties_return_errors() {
    let hairs = lawn();
    let sentence = |tie: Tie| TieVertices::of(&hairs, &[tie]).unwrap_err().to_string();
    let far = Vec3::splat(3.0);
    assert!(sentence(tie(far, far, 0.01, TieTarget::ToHead)).contains("tie 1 holds nothing: no guide"));
    let one = Vec3::new(0.0, 0.05, 0.0);
    assert!(sentence(tie(one, one, 0.004, TieTarget::Together)).contains("fewer than two guides"));
    assert!(sentence(tie(one, one, 0.0, TieTarget::Together)).contains("tie radius"));
    assert!(sentence(tie(one, one, f32::NAN, TieTarget::Together)).contains("tie radius"));
    assert!(sentence(tie(one, Vec3::NAN, 0.01, TieTarget::Together)).contains("tie position"));
}
