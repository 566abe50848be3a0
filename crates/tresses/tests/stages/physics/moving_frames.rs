//! Hair that is carried through the world: lifts, free fall, carousels, rotating frames, moving air.

use super::{
    lab::{Lab, bare, straight},
    table::{Row, at_most, judge, near},
};
use crate::common;
use tresses::{
    HairHair, HairOptions, Pose, RestOptions, RestShape, RootToTip, SimulationParams, Space, Velocity, Wind,
    glam::{DQuat, DVec3, Vec3},
    groom::{BindOptions, Groom, GuideCount, Strands, bind},
    low_level::{Hair, HairFrame},
};

const G: f64 = 9.81;
/// Frames per second with the maximum number of steps per frame; for hair that comes to rest.
const SLOW: f64 = 7.5;

/// Strands that are their own guides, on a head at the origin of a space.
struct Rider {
    hair: Hair,
    groom: Groom,
    params: SimulationParams,
    /// Frames per second.
    fps: f64,
    head: Pose,
    frames: u32,
}

impl Rider {
    fn new(lab: &'static Lab, lines: &[Vec<Vec3>], params: SimulationParams, fps: f64) -> Self {
        let mut strands = Strands::default();
        lines.iter().for_each(|line| strands.push(line));
        let vertices = Some(lines[0].len() as u32);
        let options =
            BindOptions { guides: GuideCount::All, guide_vertex_count: vertices, ..Default::default() };
        let groom = bind(&strands, &options).unwrap();
        let params = SimulationParams { hair_hair: HairHair::OFF, ..params };
        let rest = RestOptions { shape: RestShape::Natural, ..Default::default() };
        let options = HairOptions { simulation: params, rest, ..Default::default() };
        let context = lab.context;
        let hair = common::hair(context, &groom, &options, None).unwrap();
        Self { hair, groom, params, fps, head: Pose::IDENTITY, frames: 0 }
    }

    /// Returns the time of the next frame, s.
    fn time(&self) -> f64 {
        f64::from(self.frames) / self.fps
    }

    /// Advances by a frame in `space`.
    fn ride(&mut self, space: &Space) {
        let dt = if self.frames == 0 { 0.0 } else { 1.0 / self.fps as f32 };
        let (simulation, space) = (&self.params, *space);
        common::simulate(&mut self.hair, &HairFrame { simulation, space, ..common::frame(self.head, dt) });
        self.frames += 1;
    }

    /// Advances by `seconds`. `space` gives the space at each time.
    fn rides(&mut self, seconds: f64, space: impl Fn(f64) -> Space) {
        for _ in 0..(seconds * self.fps).round() as u32 {
            self.ride(&space(self.time()));
        }
    }

    /// Returns the guides relative to the origin of the space, in the axes that it had at the start.
    fn guides(&self) -> Vec<Vec<Vec3>> {
        common::guide_lines(&self.hair)
    }
}

/// Returns the largest distance between two states, mm.
fn apart(a: &[Vec<Vec3>], b: &[Vec<Vec3>]) -> f32 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max) * 1e3
}

/// Returns hair of diameter 80 µm that hangs, stands out and curls.
fn locks() -> Vec<Vec<Vec3>> {
    let arc = (0..16).map(|i| {
        let a = 2.0 * (i as f32 - 1.0) / 15.0;
        Vec3::new(0.1 * a.sin(), 0.1 * (1.0 - a.cos()), 0.02 * a)
    });
    vec![straight(16, 0.2, Vec3::NEG_Y), straight(16, 0.2, Vec3::X), arc.collect()]
}

/// Returns the pose of a head that looks to and fro.
fn turns(t: f64) -> Pose {
    Pose::about(Vec3::Z * 0.05, tresses::glam::Quat::from_rotation_y(0.6 * (5.0 * t as f32).sin()))
}

/// Returns the strands after two seconds of a moving head in the space at each time. With `folded`, the place of the
/// space is added to the head's pose, in single precision.
fn journey(lab: &'static Lab, space: &dyn Fn(f64) -> Space, folded: bool) -> Vec<Vec<Vec3>> {
    let params = SimulationParams { hair_hair: HairHair::OFF, ..Default::default() };
    let mut rider = Rider::new(lab, &locks(), params, 60.0);
    let mut head = Pose::IDENTITY;
    for i in 0..=120 {
        let t = f64::from(i) / 60.0;
        let mut space = space(t);
        head = turns(t);
        if folded {
            head.translation += space.at.as_vec3();
            space.at = DVec3::ZERO;
        }
        let dt = if i == 0 { 0.0 } else { 1.0 / 60.0 };
        let frame = HairFrame { simulation: &rider.params, space, ..common::frame(head, dt) };
        common::advance(&mut rider.hair, &frame);
    }
    // The drawn strands relative to the head.
    let back = head.inverse();
    let n = rider.hair.strands.vertex_count as usize;
    let drawn = common::positions(&rider.hair);
    drawn.chunks(n).map(|strand| strand.iter().map(|p| back.point(*p)).collect()).collect()
}

fn places(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let here = journey(lab, &|_| Space::WORLD, false);
    let far = DVec3::new(1e4, 0.3, -2e3);
    let moves = |t: f64| Space { moves_air: true, ..Space::at(far + DVec3::new(100.0, 0.0, -20.0) * t) };
    // Somewhere else in each frame.
    let jumps = |t: f64| {
        let i = (t * 60.0).round();
        Space::at(DVec3::new(i % 2.0, (i * 7.0) % 5.0, (i * 3.0) % 4.0) * 1e3)
    };
    let cases: [(&str, &dyn Fn(f64) -> Space); 4] = [
        ("10 km from the origin", &|_| Space::at(far)),
        ("100 km from the origin", &|_| Space::at(10.0 * far)),
        ("on a platform at 102 m/s, 10 km from the origin", &moves),
        ("1 km or more from where it was in each frame", &jumps),
    ];
    cases
        .map(|(name, space)| {
            let off = apart(&here, &journey(lab, space, fault));
            at_most(format!("hair {name}, against the origin"), "mm", 0.01, off)
        })
        .to_vec()
}

#[test]
fn motion_is_the_same_at_any_place() {
    judge("places", places);
}

fn lifts(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (length, a) = (0.1f32, 2.0f64);
    let off = if fault { 1.5 } else { 1.0 };
    // The acceleration that acts makes Γ = ρA (g + a) L³ / EI equal to 10: see the heavy cantilever.
    let params = SimulationParams { drag: 4.0, ..bare(1.0) };
    let stiffness = |felt: f64| params.line_density * felt as f32 * length.powi(3) / 10.0;
    let mut rows = Vec::new();
    for (name, a, given) in [
        ("a lift that starts at 2 m/s²", a, false),
        ("a lift that brakes at 3 m/s², its velocity given", -3.0, true),
    ] {
        let along = |v| RootToTip { root: v, tip: v, falloff: 1.0 };
        let params = SimulationParams { bending: along(stiffness(G + a)), ..params };
        let mut rider = Rider::new(lab, &[straight(16, length, Vec3::X)], params, SLOW);
        let a = a * off;
        rider.rides(6.0, |t| Space {
            velocity: given.then_some(Velocity { linear: DVec3::Y * a * t, angular: DVec3::ZERO }),
            moves_air: true,
            ..Space::at(DVec3::new(5e3, 0.5 * a * t * t, 0.0))
        });
        let tip = rider.guides()[0][15];
        rows.push(near(
            format!("heavy cantilever in {name}, Γ = 10, 16 vertices, drop / length"),
            "",
            0.7002,
            -tip.y / length,
            0.02,
        ));
    }
    rows
}

#[test]
fn accelerating_lifts_change_weight() {
    judge("lifts", lifts);
}

fn falls(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let params = SimulationParams { drag: 4.0, ..bare(8e-9) };
    let mut rider = Rider::new(lab, &locks(), params, SLOW);
    let rest = rider.groom.guides.positions.chunks(16).map(<[Vec3]>::to_vec).collect::<Vec<_>>();
    rider.rides(3.0, |_| Space::at(DVec3::Y * 1e4));
    let hung = apart(&rider.guides(), &rest);
    let g = G * if fault { 0.9 } else { 1.0 };
    let begun = rider.time();
    rider.rides(6.0, |t| Space {
        moves_air: true,
        ..Space::at(DVec3::Y * (1e4 - 0.5 * g * (t - begun).powi(2)))
    });
    let off = apart(&rider.guides(), &rest);
    println!("{hung} mm away where it hangs, {off} after 6 s of free fall");
    vec![at_most(
        "hair after 6 s of free fall, 177 m, against its shape without weight",
        "% of where it hung",
        1.0,
        100.0 * off / hung,
    )]
}

#[test]
fn hair_in_a_falling_space_has_no_weight() {
    judge("falls", falls);
}

fn carousel(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (r, omega, length) = (3.0f64, 1.5f64, 0.2f64);
    // tan θ = ω² (r + L sin θ) / g.
    let mut angle = 0.5f64;
    for _ in 0..50 {
        angle = (omega * omega * (r + length * angle.sin()) / G).atan();
    }
    let at = DVec3::X * if fault { 0.93 * r } else { r };
    // Either the space moves with the head and its motion is measured, or the space is the carousel's and its motion is
    // given.
    [("measured", at, DVec3::ZERO), ("given, 3 m from its middle", DVec3::ZERO, at)]
        .map(|(name, middle, head)| {
            let down = Vec3::new(angle.sin() as f32, -angle.cos() as f32, 0.0);
            let params = SimulationParams { drag: 6.0, ..bare(0.0) };
            let mut rider = Rider::new(lab, &[straight(3, length as f32, down)], params, 15.0);
            rider.head = Pose { translation: head.as_vec3(), ..Pose::IDENTITY };
            let space = |t: f64| {
                let rotation = DQuat::from_rotation_y(omega * t);
                let (place, angular) = (rotation * middle, DVec3::Y * omega);
                let velocity = Velocity { linear: angular.cross(place), angular };
                Space {
                    rotation,
                    moves_air: true,
                    velocity: (head != DVec3::ZERO).then_some(velocity),
                    ..Space::at(DVec3::splat(1e4) + place)
                }
            };
            rider.rides(4.0, space);
            let turned = DQuat::from_rotation_y(-omega * (rider.time() - 1.0 / rider.fps));
            let strand = &rider.guides()[0];
            let way = turned * (strand[2] - strand[1]).as_dvec3();
            println!("{name}: {:.2}° behind", way.z.atan2(way.x).to_degrees());
            near(
                format!("pendulum in a cabin on a carousel of 3 m at 1.5 rad/s, its motion {name}, angle"),
                "°",
                angle.to_degrees(),
                way.x.hypot(way.z).atan2(-way.y).to_degrees(),
                0.01,
            )
        })
        .to_vec()
}

#[test]
fn carousels_lift_pendulums() {
    judge("carousel", carousel);
}

fn foucault(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (omega, seconds) = (0.3f64, 12.0f64);
    // A pendulum that starts at rest in the inertial frame is pushed by the rotation of its place, unless that is a
    // pole, and swings in a plane.
    [(90.0f64, 5f32), (30.0, 0.0)]
        .map(|(latitude, tilt)| {
            let (sine, cosine) = latitude.to_radians().sin_cos();
            // The world rotates about its pole, with the place where the pendulum hangs.
            let pole = DVec3::new(cosine, sine, 0.0);
            let turned = |t: f64| DQuat::from_axis_angle(pole, omega * t * if fault { 0.95 } else { 1.0 });
            let (aside, along) = tilt.to_radians().sin_cos();
            let down = Vec3::new(aside, -along, 0.0);
            let params = SimulationParams { step: 1.0 / 240.0, substep_count: 8, ..bare(0.0) };
            let mut rider = Rider::new(lab, &[straight(3, 0.2, down)], params, 30.0);
            // Swing directions in the frame of the place. They give the plane of the swing over about a second.
            let mut samples = Vec::new();
            while rider.time() < seconds {
                let turned = turned(rider.time());
                rider.params.gravity = (turned * DVec3::NEG_Y * G).as_vec3();
                rider.ride(&Space { rotation: turned, ..Space::at(DVec3::X * 1e4) });
                let strand = &rider.guides()[0];
                samples.push(turned.inverse() * (strand[2] - strand[1]).as_dvec3());
            }
            let window = 54;
            let plane = |samples: &[DVec3]| {
                let (mut c, mut s) = (0.0, 0.0);
                for p in samples {
                    c += p.x * p.x - p.z * p.z;
                    s += 2.0 * p.x * p.z;
                }
                0.5 * f64::atan2(s, c)
            };
            let (mut turned, mut last) = (0.0, plane(&samples[..window]));
            for i in 1..=samples.len() - window {
                let now = plane(&samples[i..i + window]);
                let way = now - last;
                turned += way - std::f64::consts::PI * (way / std::f64::consts::PI).round();
                last = now;
            }
            let rate = turned.abs() / (f64::from((samples.len() - window) as u32) / rider.fps);
            let case = format!("Foucault's pendulum, 20 cm, 0.3 rad/s, latitude {latitude}°, rate");
            near(case, "rad/s", omega * sine, rate, 0.02)
        })
        .to_vec()
}

#[test]
#[ignore = "proof"]
fn swing_plane_turns_as_in_foucaults_pendulum() {
    judge("foucault", foucault);
}

fn drive(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let drag = 4.0f32;
    [(2.4525f64, Vec3::ZERO), (4.905, Vec3::X * 2.4525)]
        .map(|(speed, wind)| {
            let wind = Wind { velocity: wind, ..Wind::uniform(wind) };
            let params = SimulationParams { drag, wind, ..bare(0.0) };
            let mut rider = Rider::new(lab, &[straight(16, 0.2, Vec3::NEG_Y)], params, SLOW);
            let v = speed * if fault { 1.05 } else { 1.0 };
            rider.rides(10.0, |t| Space::at(DVec3::new(1e4 + v * t, 0.0, 0.0)));
            let strand = &rider.guides()[0];
            let way = strand[15] - strand[1];
            let felt = (speed as f32 - params.wind.velocity.x) * drag;
            near(
                format!(
                    "floppy strand on a car at {speed:.2} m/s in wind of {:.2} m/s from behind, drag 4 1/s, angle",
                    params.wind.velocity.x
                ),
                "°",
                f64::from((felt / G as f32).atan().to_degrees()),
                (-way.x / -way.y).atan().to_degrees(),
                0.005,
            )
        })
        .to_vec()
}

#[test]
fn hair_in_a_moving_space_feels_wind() {
    judge("drive", drive);
}
