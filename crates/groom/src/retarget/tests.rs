use super::*;
use crate::mesh::shapes;

/// A ball with hair on its upper half, combed over it, 8 cm long.
fn ball(radius: f32, rings: u32) -> TriMesh {
    let mut mesh = shapes::sphere(radius, rings);
    mesh.positions.iter_mut().for_each(|p| *p *= Vec3::new(0.85, 1.1, 1.0));
    mesh.compute_normals();
    mesh
}

fn hair() -> Strands {
    let mut strands = Strands::default();
    for i in 0..200 {
        let (down, around) = (1.3 * ((i as f32 + 0.5) / 200.0).sqrt(), i as f32 * 2.399_963);
        let along = |j: u32| {
            let down = down + 0.08 / 0.1 * j as f32 / 15.0;
            let out = Vec3::new(down.sin() * around.cos(), down.cos(), down.sin() * around.sin());
            out * Vec3::new(0.85, 1.1, 1.0) * (0.1 + 4e-3 * (j as f32 / 3.0).min(1.0))
        };
        strands.push(&(0..16).map(along).collect::<Vec<_>>());
    }
    strands
}

fn lengths(strands: &Strands) -> Vec<f32> {
    strands.iter().flat_map(|strand| strand.windows(2).map(|w| w[0].distance(w[1]))).collect()
}

#[test]
fn hair_moves_with_a_head_that_only_moves() {
    let (head, strands) = (ball(0.1, 24), hair());
    let mut other = head.clone();
    let turn = Quat::from_rotation_z(0.3);
    other.transform(1.0, turn, Vec3::new(0.2, 1.5, -0.1));
    let (moved, report) = retarget(&strands, &head, &other, &[]).unwrap();
    assert!(report.has_same_topology && report.inside[1] < 5e-3, "{report:?}");
    let wanted = strands.positions.iter().map(|p| turn * *p + Vec3::new(0.2, 1.5, -0.1));
    let off = moved.positions.iter().zip(wanted).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(off < 2e-3, "{off}");
}

#[test]
fn hair_fits_a_larger_head_of_other_triangles() {
    let (head, other) = (ball(0.1, 24), ball(0.115, 37));
    let strands = hair();
    let (moved, report) = retarget(&strands, &head, &other, &[]).unwrap();
    assert!(!report.has_same_topology && report.skin_error < 1.5e-3, "{report:?}");
    assert!(report.inside[1] <= 5e-3 && report.spacing_change < 0.01 && report.bend < 0.1, "{report:?}");
    let change =
        lengths(&strands).iter().zip(lengths(&moved)).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f32::max);
    assert!(change < 1e-4, "lengths change by {change}");
    let target = sdf::build(&other, &SdfOptions::default()).unwrap();
    let roots = moved.iter().map(|strand| target.sample(strand[0]).abs()).fold(0.0, f32::max);
    assert!(roots < 1.5e-3, "roots are {roots} m off the skin");
    // There and back.
    let (back, _) = retarget(&moved, &other, &head, &[]).unwrap();
    let off: f32 = back.positions.iter().zip(&strands.positions).map(|(a, b)| a.distance(*b)).sum();
    assert!(off / (back.positions.len() as f32) < 6e-3, "{} m", off / back.positions.len() as f32);
}

#[test]
fn landmarks_decide_where_shapes_do_not() {
    // Balls have no front: landmarks turn the hair by a right angle.
    let round = |rings| {
        let mut mesh = shapes::sphere(0.1, rings);
        mesh.compute_normals();
        mesh
    };
    let turn = Quat::from_rotation_y(1.0);
    let marks =
        [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X].map(|v| Landmark { from: v * 0.1, to: turn * v * 0.1 });
    let mut strands = hair();
    strands.positions.iter_mut().for_each(|p| *p /= Vec3::new(0.85, 1.1, 1.0));
    let (moved, _) = retarget(&strands, &round(24), &round(31), &marks).unwrap();
    let pairs = strands.iter().zip(moved.iter());
    let off = pairs.map(|(a, b)| (turn * a[0]).distance(b[0])).sum::<f32>() / strands.len() as f32;
    assert!(off < 5e-3, "{off} m");
}

#[test]
fn what_cannot_be_retargeted_is_refused() {
    let (head, strands) = (ball(0.1, 12), hair());
    let said = |strands: &Strands, head: &TriMesh, other: &TriMesh| {
        retarget(strands, head, other, &[]).unwrap_err().to_string()
    };
    assert!(said(&Strands::default(), &head, &head).contains("no strands"));
    assert!(!said(&strands, &TriMesh::default(), &head).is_empty());
}
