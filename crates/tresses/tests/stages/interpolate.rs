//! Drawn strands from guides on the GPU: the rest shape is reproduced, rigid motion is exact, lengths are kept.

use crate::common;

use tresses::{
    Context, Pose, RestOptions, SimulationParams,
    glam::{Quat, Vec3},
    groom::{BindOptions, Groom, GuideCount, Strands, bind},
    interpolate::Interpolation,
    low_level::{
        GuideBuffers, StrandBuffers, StrandVertex, Tier, readback::blocking as readback, unpack_tangent,
    },
    simulate::rest,
    strands::{GuideSample, guide::pack_lag},
    tessellate::{TessellateParams, Tessellation, rest_samples},
    wgpu,
};

/// Creates `count` hanging strands with as many guides as `guides` says.
fn hanging(count: usize, length: f32, guides: GuideCount) -> Groom {
    bind(&common::hanging(count, 16, length), &BindOptions { guides, ..Default::default() }).unwrap()
}

/// Returns the drawn vertices for guides at `previous` and `current` (world space, guide-major).
fn draw(
    context: &Context,
    groom: &Groom,
    previous: &[Vec3],
    current: &[Vec3],
    blend: f32,
    now: Pose,
) -> Vec<StrandVertex> {
    draw_twisted(context, groom, previous, current, (blend, [0.0; 2]), now)
}

/// Does the same for twisted guides. `twist` is the angle from end to end after the last step and before it, radians.
fn draw_twisted(
    context: &Context,
    groom: &Groom,
    previous: &[Vec3],
    current: &[Vec3],
    (blend, twist): (f32, [f32; 2]),
    now: Pose,
) -> Vec<StrandVertex> {
    let n = groom.guides.vertex_count as usize;
    // Strands that are their own guides need no samples.
    let follows = groom.guides.len() == groom.strands.len();
    let samples = if follows { 0 } else { groom.strands.vertex_count.max(groom.guides.vertex_count) };
    let mut guides = GuideBuffers::new(context, groom.guides.len() as u32, n as u32, samples).unwrap();
    if twist != [0.0; 2] {
        guides.add_twist(context).unwrap();
    }
    let strands =
        StrandBuffers::new(context, groom.strands.len() as u32, groom.strands.vertex_count).unwrap();
    let params = SimulationParams::default();
    let (positions, options) = (&groom.guides.positions, RestOptions::default());
    let at_rest = rest::guides(positions, n as u32, &[], &params, &options, None).unwrap();
    at_rest.upload(context, &guides).unwrap();
    let write = |buffer: &wgpu::Buffer, bytes: &[u8]| context.queue().write_buffer(buffer, 0, bytes);
    let count = groom.guides.len();
    let state = (0..n * count).map(|at| {
        let i = (at % count) * n + at / count;
        let [x, y, z] = current[i].to_array().map(f32::to_bits);
        [x, y, z, pack_lag(previous[i] - current[i])]
    });
    write(&guides.current, bytemuck::cast_slice(&state.collect::<Vec<_>>()));
    if twist != [0.0; 2] {
        // An equal share for each bend between two edges.
        let bends = n - 2;
        let twists = vec![twist.map(|whole| whole / bends as f32); bends * count];
        let first = 8 * ((n + 1) * count) as u64;
        context.queue().write_buffer(&guides.velocity, first, bytemuck::cast_slice(&twists));
    }
    if !follows {
        let resting: Vec<_> = (0..groom.guides.len())
            .flat_map(|g| rest_samples(groom.guides.guide(g), samples))
            .map(GuideSample::at_rest)
            .collect();
        write(&guides.samples, bytemuck::cast_slice(&resting));
    }
    write(&strands.bindings, bytemuck::cast_slice(&groom.strands.bindings));
    write(&strands.rest, bytemuck::cast_slice(&groom.strands.rest));

    let tessellation = Tessellation::new(context, &guides);
    let interpolation = if follows {
        Interpolation::following(context, &guides, &strands, &tessellation)
    } else {
        Interpolation::new(context, &guides, &strands)
    };
    let params = TessellateParams::new(&guides, (&now, &now, 0.0), &now, (blend, twist != [0.0; 2]));
    tessellation.prepare(&params);
    interpolation.prepare(&guides, &strands);
    common::compute(context, |pass| {
        tessellation.record(pass, &guides);
        interpolation.record(pass, &strands);
    });
    readback::buffer(context, &strands.vertices).unwrap()
}

/// Returns the largest distance between drawn vertices and rest positions moved by `pose`.
fn error(groom: &Groom, drawn: &[StrandVertex], pose: Pose) -> f32 {
    let rest = (0..groom.strands.len()).flat_map(|i| groom.strands.rest_positions(i));
    drawn.iter().zip(rest).map(|(v, p)| v.position.distance(pose.point(p))).fold(0.0, f32::max)
}

#[test]
fn rest_shape_is_reproduced_within_a_tenth_of_a_millimeter() {
    let Some(context) = common::context() else { return };
    for guides in [GuideCount::OneIn(16), GuideCount::All] {
        let groom = hanging(400, 0.2, guides);
        let rest = groom.guides.positions.clone();
        let drawn = draw(context, &groom, &rest, &rest, 0.3, Pose::IDENTITY);
        let off = error(&groom, &drawn, Pose::IDENTITY);
        assert!(off < 1e-4, "{off}");
        // A guide that is not at rest is detected.
        let mut bent = rest.clone();
        bent[40] += Vec3::X * 0.01;
        let drawn = draw(context, &groom, &bent, &bent, 1.0, Pose::IDENTITY);
        assert!(error(&groom, &drawn, Pose::IDENTITY) > 1e-4);
    }
}

/// On GPUs threads exchange vertices before they store them.
#[test]
fn kernels_of_both_tiers_store_the_same_vertices() {
    let Some(context) = common::context() else { return };
    let tiers = [true, false].map(|software| context.clone().with_tier(Tier { software, ..context.tier() }));
    // Strands and vertices that fill a workgroup and a part, and others.
    for (count, vertices) in [(64, 16), (100, 16), (70, 17), (3, 8), (65, 2)] {
        let strands = common::hanging(count, vertices, 0.2);
        let options = BindOptions { guides: GuideCount::OneIn(2), ..Default::default() };
        let groom = bind(&strands, &options).unwrap();
        let moved: Vec<_> = groom.guides.positions.iter().map(|p| *p + Vec3::Z * (0.3 * p.y).sin()).collect();
        let [own, other] =
            tiers.each_ref().map(|context| draw(context, &groom, &moved, &moved, 1.0, Pose::IDENTITY));
        assert_eq!(own.len(), groom.strands.len() * groom.strands.vertex_count as usize);
        assert!(own == other, "{count} strands of {vertices} vertices");
        assert!(own.iter().all(|vertex| vertex.position != Vec3::ZERO || vertex.tangent != 0));
    }
}

#[test]
fn rigid_motion_of_guides_moves_strands_rigidly() {
    let Some(context) = common::context() else { return };
    for guides in [GuideCount::OneIn(16), GuideCount::All] {
        let groom = hanging(300, 0.2, guides);
        let pose = Pose {
            rotation: Quat::from_rotation_y(2.0) * Quat::from_rotation_x(0.5),
            translation: Vec3::new(0.3, 1.0, -0.2),
        };
        let moved: Vec<_> = groom.guides.positions.iter().map(|p| pose.point(*p)).collect();
        let off = error(&groom, &draw(context, &groom, &moved, &moved, 0.5, pose), pose);
        assert!(off < 1e-4, "{off}");
    }
}

#[test]
fn strands_turn_with_the_twist_of_their_guides() {
    let Some(context) = common::context() else { return };
    let options = BindOptions { guides: GuideCount::OneIn(16), ..Default::default() };
    // Strands that hang straight down from a disk.
    let mut strands = Strands::default();
    for i in 0..400 {
        let (far, angle) = (0.02 * (i as f32 / 400.0).sqrt(), i as f32 * 2.399_963);
        let root = Vec3::new(far * angle.cos(), 0.0, far * angle.sin());
        strands.push(&(0..16).map(|j| root - Vec3::Y * (0.2 * j as f32 / 15.0)).collect::<Vec<_>>());
    }
    let groom = bind(&strands, &options).unwrap();
    let rest = groom.guides.positions.clone();
    // Halfway between no twist and an eighth of a turn: 22.5° about each guide.
    let eighth = std::f32::consts::FRAC_PI_4;
    let twisted = draw_twisted(context, &groom, &rest, &rest, (0.5, [eighth, 0.0]), Pose::IDENTITY);
    let straight = draw(context, &groom, &rest, &rest, 0.5, Pose::IDENTITY);
    let aside = |p: Vec3| Vec3::new(p.x, 0.0, p.z);
    let off = |drawn: &[StrandVertex], whole: f32| {
        let (mut far, mut way) = (0.0, 0.0);
        for (i, binding) in groom.strands.bindings.iter().enumerate() {
            let tip = *groom.strands.rest_positions(i).collect::<Vec<_>>().last().unwrap();
            let weights = [1.0 - binding.weight_b - binding.weight_c, binding.weight_b, binding.weight_c];
            let carried = |k: usize| {
                let guide = groom.guides.guide(binding.guides[k] as usize);
                let (edges, along) = ((guide.len() - 1) as f32, binding.scale[k].min(1.0));
                let there = guide[0].lerp(guide[guide.len() - 1], along);
                // The middle of the first edge has no twist, and the middle of the last edge has all of it.
                let turn = whole * ((along * edges - 0.5) / (edges - 1.0)).clamp(0.0, 1.0);
                weights[k] * (there + Quat::from_axis_angle(Vec3::NEG_Y, turn) * (tip - there))
            };
            let expected = (0..3).map(carried).sum::<Vec3>();
            let found = drawn[(i + 1) * groom.strands.vertex_count as usize - 1].position;
            far += aside(found - expected).length();
            way += aside(expected - tip).length();
        }
        far / way
    };
    let turn = 0.5 * eighth;
    let (found, without, other) = (off(&twisted, turn), off(&straight, turn), off(&twisted, -turn));
    println!(
        "off by {found:.3} of their way; {without:.3} without twist, {other:.3} if it turned the other way"
    );
    assert!(found < 0.05 && without > 0.9 && other > 1.0);
    // Twist does not move a strand that is its own straight guide.
    let own = bind(&strands, &BindOptions { guides: GuideCount::All, ..Default::default() }).unwrap();
    let rest = own.guides.positions.clone();
    let drawn = draw_twisted(context, &own, &rest, &rest, (1.0, [eighth; 2]), Pose::IDENTITY);
    assert!(error(&own, &drawn, Pose::IDENTITY) < 1e-4);
}

#[test]
fn strands_that_are_their_own_guides_match_samples() {
    let Some(context) = common::context() else { return };
    let own = hanging(100, 0.2, GuideCount::All);
    // A guide without followers makes the groom use samples.
    let mut sampled = own.clone();
    let last = own.guides.guide(99).to_vec();
    sampled.guides.positions.extend(last);
    for values in [&mut sampled.guides.stiffness, &mut sampled.guides.strands] {
        values.push(1.0);
    }
    sampled.guides.tip_pinned.push(false);
    let swing = |groom: &Groom, angle: f32| -> Vec<Vec3> {
        let root = |i: usize| groom.guides.positions[i - i % groom.guides.vertex_count as usize];
        let swung = |(i, p): (usize, &Vec3)| {
            let bend = Quat::from_rotation_x(angle * root(i).distance(*p) / 0.2);
            root(i) + bend * (*p - root(i))
        };
        groom.guides.positions.iter().enumerate().map(swung).collect()
    };
    let far = |angle: f32| {
        let [drawn, other] = [(&own, 1.2), (&sampled, angle)].map(|(groom, angle)| {
            draw(context, groom, &swing(groom, 0.3), &swing(groom, angle), 0.4, Pose::IDENTITY)
        });
        let off = drawn.iter().zip(&other).map(|(a, b)| a.position.distance(b.position));
        off.fold(0.0, f32::max)
    };
    let off = far(1.2);
    assert!(off < 2e-5, "{off}");
    assert!(far(1.21) > 2e-5, "another swing is seen");
}

#[test]
fn lengths_are_kept_and_tangents_follow_when_guides_bend_apart() {
    let Some(context) = common::context() else { return };
    let groom = bind(&common::hanging(400, 16, 0.25), &BindOptions::default()).unwrap();
    let n = groom.guides.vertex_count as usize;
    // Every guide swings about its root by its own angle.
    let swung: Vec<_> = (0..groom.guides.len())
        .flat_map(|g| {
            let turn =
                Quat::from_rotation_x((g as f32 * 1.7).sin()) * Quat::from_rotation_z((g as f32).cos());
            let root = groom.guides.guide(g)[0];
            groom.guides.guide(g).iter().map(move |p| root + turn * (*p - root)).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(swung.len(), groom.guides.len() * n);
    let drawn = draw(context, &groom, &swung, &swung, 1.0, Pose::IDENTITY);
    let m = groom.strands.vertex_count as usize;
    let mut moved = 0.0f32;
    for (i, strand) in drawn.chunks(m).enumerate() {
        let rest: Vec<_> = groom.strands.rest_positions(i).collect();
        let length: f32 = rest.windows(2).map(|w| w[0].distance(w[1])).sum();
        let now: f32 = strand.windows(2).map(|w| w[0].position.distance(w[1].position)).sum();
        assert!((now / length - 1.0).abs() < 0.001, "strand {i}: {now} for {length}");
        moved = moved.max(strand[m - 1].position.distance(rest[m - 1]));
        for w in strand.windows(3) {
            let (tangent, _) = unpack_tangent(w[1].tangent);
            let edge = |k: usize| (w[k + 1].position - w[k].position).normalize();
            assert!(tangent.dot((edge(0) + edge(1)).normalize()) > 0.999);
        }
    }
    assert!(moved > 0.05, "the guides did swing");
}

/// Measures what the order of strands costs in `interpolate`, for the docs.
#[test]
#[ignore = "proof"]
fn print_timings_of_strand_orders() {
    let Some(context) = common::context() else { return };
    for (name, count) in [("long", 30_000), ("short", 60_000)] {
        let built = common::character(name, count).expect("there is a GPU");
        let groom = &built.groom;
        let n = groom.strands.vertex_count;
        let mut arranged = groom.strands.clone();
        tresses::low_level::lod::arrange(&mut arranged);
        let guides =
            GuideBuffers::new(context, groom.guides.len() as u32, groom.guides.vertex_count, n).unwrap();
        let runs = [&groom.strands, &arranged].map(|strands| {
            let buffers = StrandBuffers::new(context, strands.len() as u32, n).unwrap();
            context.queue().write_buffer(&buffers.bindings, 0, bytemuck::cast_slice(&strands.bindings));
            context.queue().write_buffer(&buffers.rest, 0, bytemuck::cast_slice(&strands.rest));
            let between = Interpolation::new(context, &guides, &buffers);
            between.prepare(&guides, &buffers);
            (between, buffers)
        });
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..25 {
            for ((between, buffers), times) in runs.iter().zip(&mut times) {
                let mut encoder = context.device().create_command_encoder(&Default::default());
                let mut commands = context.commands(&mut encoder);
                let mut pass = commands.compute("interpolate");
                between.record(&mut pass, buffers);
                pass.end().unwrap();
                let start = std::time::Instant::now();
                context.queue().submit([encoder.finish()]);
                context.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        let [file, sampled] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            [times[0], times[12]]
        });
        println!(
            "{name}, {count} strands: as they come {file:.2?} ms, arranged {sampled:.2?} ms (least, median)"
        );
    }
}
