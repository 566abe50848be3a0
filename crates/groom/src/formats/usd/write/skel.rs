//! Writes a mesh on a skeleton with hair attached to it (`UsdSkel`).
//!
//! Every node of the rig is a joint. If several palette entries with different bind matrices follow one node, the node
//! has additional child joints that do not move relative to it. Points of mesh and hair are written in the bind pose,
//! so that they fit each other even in programs without support for skeletons. Animations are sampled frame by frame
//! ([`rate`]).

use std::collections::HashMap;

use glam::{DMat4, DVec3, Mat4, Vec3};

use super::{
    Curves,
    layer::{Layer, listed, matrix, per, point, quoted},
};
use crate::{
    Error, Result, Strands, TriMesh,
    formats::writer::ExportHair,
    mesh::Bvh,
    rig::{Animation, INFLUENCES, MorphTarget, Node, Rig, RigPose},
};

/// Returns the frame rate: the first of 24, 25, 30 and 50 frames per second on which all animation keys lie, else 60.
pub(super) fn rate(rig: &Rig) -> f32 {
    let keys = || rig.animations.iter().flat_map(|it| it.channels.iter().flat_map(|c| &c.curve.times));
    let on = |rate: &f32| keys().all(|key| (key * rate - (key * rate).round()).abs() < 0.01);
    [24.0, 25.0, 30.0, 50.0].into_iter().find(on).unwrap_or(60.0)
}

/// Maximum length of an animation, frames.
const MAX_FRAMES: f32 = 100_000.0;
/// The largest half float, the type of scales.
const MAX_SCALE: f64 = 65_504.0;
/// Maximum joints of a strand.
const MAX_JOINTS_PER_STRAND: usize = 4;

/// A rig, its rest pose, and its joints as USD has them.
struct Skeleton<'a> {
    rig: &'a Rig,
    pose: RigPose,
    paths: Vec<String>,
    names: Vec<String>,
    bind: Vec<DMat4>,
    rest: Vec<DMat4>,
    /// The joint of each entry of the rig's palette.
    of: Vec<usize>,
}

impl<'a> Skeleton<'a> {
    fn new(rig: &'a Rig) -> Result<Self> {
        let pose = rig.rest_pose();
        let mut all =
            Self { rig, pose, paths: vec![], names: vec![], bind: vec![], rest: vec![], of: vec![] };
        let mut used = HashMap::new();
        for (i, node) in rig.nodes.iter().enumerate() {
            let above = node.parent.map(|parent| all.paths[parent as usize].clone() + "/");
            all.paths.push(unique(&mut used, &above.unwrap_or_default(), &node.name));
            all.names.push(node.name.clone());
            // The bind matrix of a joint without vertices has no effect.
            let global = all.pose.globals[i].as_dmat4();
            all.bind.push(if global.determinant() == 0.0 { DMat4::IDENTITY } else { global });
            all.rest.push(node.matrix.unwrap_or_else(|| node.rest.matrix()).as_dmat4());
        }
        let mut has_bind = vec![false; rig.nodes.len()];
        for joint in &rig.joints {
            let (node, bind) = (joint.node as usize, joint.inverse_bind.as_dmat4().inverse());
            if !bind.is_finite() || bind.determinant() == 0.0 {
                return Err(Error::Unusable(
                    "a joint whose bind matrix has no inverse cannot be written".into(),
                ));
            }
            if !std::mem::replace(&mut has_bind[node], true) {
                all.bind[node] = bind;
            }
            if all.bind[node] == bind {
                all.of.push(node);
                continue;
            }
            all.of.push(all.paths.len());
            let above = all.paths[node].clone() + "/";
            all.paths.push(unique(&mut used, &above, "more"));
            all.names.push(String::new());
            all.bind.push(bind);
            all.rest.push(DMat4::IDENTITY);
        }
        Ok(all)
    }

    /// Writes an animation at `rate` frames per second.
    fn animation(&self, layer: &mut Layer, name: &str, rate: f32, animation: &Animation) -> Result<()> {
        let rig = self.rig;
        let frames = (animation.length * rate).round().max(0.0);
        if frames > MAX_FRAMES {
            return Err(Error::Unusable(format!(
                "the animation {name} of {} s is too long: the maximum is {MAX_FRAMES} frames",
                animation.length
            )));
        }
        let frames = frames as u32;
        layer.open("SkelAnimation", name, &[]);
        let nodes = rig.nodes.len();
        layer.list("uniform token[] joints", self.paths[..nodes].iter().map(|path| quoted(path)), &[]);
        let poses: Vec<_> = (0..=frames)
            .map(|frame| {
                // The last frame is the end of the loop, not its beginning.
                let time = (frame as f32 / rate).min(animation.length * (1.0 - 1e-6));
                let pose = rig.pose(animation, time);
                let local = |(i, node): (usize, &Node)| {
                    let above =
                        node.parent.map_or(DMat4::IDENTITY, |up| pose.globals[up as usize].as_dmat4());
                    // Nothing is visible below a singular transform, so its inverse does not matter.
                    let own = if above.determinant() == 0.0 { DMat4::IDENTITY } else { above.inverse() };
                    parts_of(&(own * pose.globals[i].as_dmat4()))
                };
                let parts: Vec<_> = rig.nodes.iter().enumerate().map(local).collect();
                // Points are written with the blend shapes at rest; animations add the difference.
                let weights = pose
                    .weights
                    .iter()
                    .zip(&self.pose.weights)
                    .map(|(now, rest)| now - rest)
                    .collect::<Vec<_>>();
                (frame, parts, weights)
            })
            .collect();
        let three = |v: &DVec3| point(&v.as_vec3());
        layer.samples(
            "float3[] translations",
            poses.iter().map(|(frame, parts, _)| (*frame, listed(parts.iter().map(|(_, _, at)| three(at))))),
        );
        layer.samples(
            "quatf[] rotations",
            poses.iter().map(|(frame, parts, _)| {
                let rotation = |q: &glam::DQuat| {
                    format!("({}, {}, {}, {})", q.w as f32, q.x as f32, q.y as f32, q.z as f32)
                };
                (*frame, listed(parts.iter().map(|(_, q, _)| rotation(q))))
            }),
        );
        layer.samples(
            "half3[] scales",
            poses
                .iter()
                .map(|(frame, parts, _)| (*frame, listed(parts.iter().map(|(scale, ..)| three(scale))))),
        );
        if !rig.targets.is_empty() {
            layer.list("uniform token[] blendShapes", shape_names(rig), &[]);
            let weights = poses.iter().map(|(frame, _, weights)| (*frame, listed(weights)));
            layer.samples("float[] blendShapeWeights", weights);
        }
        layer.close();
        let widest =
            poses.iter().flat_map(|(_, parts, _)| parts).map(|(scale, ..)| scale.abs().max_element());
        match widest.fold(0.0, f64::max) <= MAX_SCALE {
            true => Ok(()),
            false => Err(Error::Unusable(format!("the animation {name} has scales too large for USD"))),
        }
    }

    /// Writes the mesh and its blend shapes.
    fn body(&self, layer: &mut Layer, mesh: &TriMesh) {
        let rig = self.rig;
        layer.open("Mesh", "body", &["SkelBindingAPI"]);
        let vertices = &rig.vertices;
        let mut bound_at = mesh.clone();
        rig.shape(&self.pose.weights, &mut bound_at);
        surface(layer, &bound_at);
        let held = |i: usize| vertices[i].weights.iter().filter(|weight| **weight > 0.0).count();
        let width = (0..vertices.len()).map(held).max().unwrap_or(0).max(1);
        let own = |i: usize| -> Vec<(usize, f32)> {
            let bind = &vertices[i];
            let all = (0..INFLUENCES).filter(|k| bind.weights[*k] > 0.0);
            all.map(|k| (self.of[usize::from(bind.joints[k])], bind.weights[k])).collect()
        };
        bound(layer, (0..vertices.len()).map(own), width, false);
        let mut used = HashMap::new();
        let shapes: Vec<String> =
            rig.targets.iter().map(|target| unique(&mut used, "", &target.name)).collect();
        if !shapes.is_empty() {
            layer.list("uniform token[] skel:blendShapes", shape_names(rig), &[]);
            let paths = shapes.iter().map(|shape| format!("</character/body/{shape}>"));
            layer.list("rel skel:blendShapeTargets", paths, &[]);
        }
        for (target, name) in rig.targets.iter().zip(&shapes) {
            shape(layer, name, target);
        }
        layer.close();
    }

    /// Writes hair whose strands follow the skin at their roots.
    fn hair(
        &self,
        layer: &mut Layer,
        name: &str,
        strands: &Strands,
        mesh: &TriMesh,
        bvh: &Bvh,
    ) -> Result<()> {
        let mut bind_strands = strands.clone();
        let mut held = Vec::with_capacity(strands.len());
        for (i, line) in strands.iter().enumerate() {
            let own = carriers(line[0], mesh, self.rig, bvh);
            let rest = |joint: usize| self.pose.palette[joint].as_dmat4();
            let sum =
                own.iter().fold(DMat4::ZERO, |sum, (joint, weight)| sum + rest(*joint) * f64::from(*weight));
            let back = sum.inverse();
            if !back.is_finite() {
                return Err(Error::Unusable(
                    "hair on skin whose rest transform has no inverse cannot be written".into(),
                ));
            }
            for p in &mut bind_strands.positions[strands.range(i)] {
                *p = back.transform_point3(DVec3::from(*p)).as_vec3();
            }
            held.push(own.into_iter().map(|(joint, weight)| (self.of[joint], weight)).collect::<Vec<_>>());
        }
        layer.open("BasisCurves", name, &["SkelBindingAPI"]);
        // Widths are in the skeleton's space.
        let scale = self.rig.to_groom.determinant().abs().cbrt();
        bind_strands.radii.iter_mut().for_each(|radius| *radius /= scale);
        let curves = Curves { strands: &bind_strands, scale: 1.0 };
        curves.points(layer);
        curves.attributes(layer);
        // Hair on a single joint stores it once.
        let once = held.iter().all(|own| own.len() == 1 && *own == held[0]);
        let width = held.iter().map(Vec::len).max().unwrap_or(1);
        match once {
            true => bound(layer, held.into_iter().take(1), width, true),
            false => {
                let each = held.into_iter().zip(strands.iter());
                let points = each.flat_map(|(own, line)| std::iter::repeat_n(own, line.len()));
                bound(layer, points, width, false);
            }
        }
        layer.close();
        Ok(())
    }
}

/// Returns a path of a valid name below `above` that is not in `used`, which counts the paths of each name.
pub(super) fn unique(used: &mut HashMap<String, u32>, above: &str, name: &str) -> String {
    let plain = format!("{above}{}", identifier(name));
    let mut path = plain.clone();
    while used.contains_key(&path) {
        let count = used.entry(plain.clone()).or_insert(1);
        *count += 1;
        path = format!("{plain}_{count}");
    }
    used.insert(path.clone(), 1);
    path
}

/// Replaces all characters but letters, digits and underscores, and prefixes a leading digit.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match plain.chars().next() {
        Some(first) if !first.is_ascii_digit() => plain,
        _ => format!("_{plain}"),
    }
}

/// Writes the skeleton, its animations at `rate` frames per second, the mesh and the hair on it.
pub(super) fn put(
    layer: &mut Layer,
    (mesh, rig): (&TriMesh, &Rig),
    rate: f32,
    hair: &[ExportHair<'_>],
) -> Result<()> {
    if rig.vertices.len() != mesh.positions.len() {
        return Err(Error::Unusable("the rig does not match the mesh".into()));
    }
    let skeleton = Skeleton::new(rig)?;
    let mut used = HashMap::from(["skeleton", "body"].map(|name| (name.to_owned(), 1)));
    let names: Vec<String> = hair.iter().map(|hair| unique(&mut used, "", hair.name)).collect();
    let animations: Vec<String> =
        rig.animations.iter().map(|animation| unique(&mut used, "", &animation.name)).collect();

    layer.open("Skeleton", "skeleton", &["SkelBindingAPI"]);
    layer.list("uniform token[] joints", skeleton.paths.iter().map(|path| quoted(path)), &[]);
    layer.list("uniform token[] jointNames", skeleton.names.iter().map(|name| quoted(name)), &[]);
    layer.list("uniform matrix4d[] bindTransforms", skeleton.bind.iter().map(matrix), &[]);
    layer.list("uniform matrix4d[] restTransforms", skeleton.rest.iter().map(matrix), &[]);
    if rig.to_groom != Mat4::IDENTITY {
        layer.line(format_args!("matrix4d xformOp:transform = {}", matrix(&rig.to_groom.as_dmat4())));
        layer.line("uniform token[] xformOpOrder = [\"xformOp:transform\"]");
    }
    if let Some(first) = animations.first() {
        layer.line(format_args!("rel skel:animationSource = </character/{first}>"));
    }
    layer.close();
    for (animation, name) in rig.animations.iter().zip(&animations) {
        skeleton.animation(layer, name, rate, animation)?;
    }
    skeleton.body(layer, mesh);
    let bvh = Bvh::new(mesh);
    for (hair, name) in hair.iter().zip(&names) {
        skeleton.hair(layer, name, hair.strands, mesh, &bvh)?;
    }
    Ok(())
}

/// Decomposes a joint's local transform into scale, rotation and translation. A singular transform gets no rotation.
fn parts_of(local: &DMat4) -> (DVec3, glam::DQuat, DVec3) {
    let (scale, rotation, translation) = local.to_scale_rotation_translation();
    if rotation.is_finite() && scale.is_finite() {
        return (scale, rotation, translation);
    }
    let scale = DVec3::new(
        local.x_axis.truncate().length(),
        local.y_axis.truncate().length(),
        local.z_axis.truncate().length(),
    );
    (scale, glam::DQuat::IDENTITY, local.w_axis.truncate())
}

/// Writes triangles, vertices and, if the mesh has them, colors.
pub(super) fn surface(layer: &mut Layer, mesh: &TriMesh) {
    layer.list("int[] faceVertexCounts", mesh.triangles.iter().map(|_| 3), &[]);
    layer.list("int[] faceVertexIndices", mesh.triangles.as_flattened(), &[]);
    layer.list("point3f[] points", mesh.positions.iter().map(point), &[]);
    layer.list("normal3f[] normals", mesh.normals.iter().map(point), &per("vertex"));
    if mesh.colors.len() == mesh.positions.len() {
        layer.list("color3f[] primvars:displayColor", mesh.colors.iter().map(point), &per("vertex"));
    }
    layer.line("uniform token subdivisionScheme = \"none\"");
}

fn shape(layer: &mut Layer, name: &str, target: &MorphTarget) {
    layer.open("BlendShape", name, &[]);
    layer.list("uniform vector3f[] offsets", target.deltas.iter().map(|d| point(&d.position)), &[]);
    layer.list("uniform vector3f[] normalOffsets", target.deltas.iter().map(|d| point(&d.normal)), &[]);
    layer.list("uniform int[] pointIndices", target.deltas.iter().map(|d| d.vertex), &[]);
    layer.close();
}

/// Returns the names of the rig's blend shapes, made unique.
fn shape_names(rig: &Rig) -> Vec<String> {
    let mut used = HashMap::<String, u32>::new();
    let name = |target: &MorphTarget| {
        let count = used.entry(target.name.clone()).or_insert(0);
        *count += 1;
        if *count == 1 { quoted(&target.name) } else { quoted(&format!("{} {count}", target.name)) }
    };
    rig.targets.iter().map(name).collect()
}

/// Writes the joints and weights of each point, padded to `width`, or `once` for all points.
fn bound(layer: &mut Layer, points: impl Iterator<Item = Vec<(usize, f32)>>, width: usize, once: bool) {
    let (mut joints, mut weights) = (Vec::new(), Vec::new());
    for mut held in points {
        held.resize(width, (0, 0.0));
        joints.extend(held.iter().map(|(joint, _)| *joint));
        weights.extend(held.iter().map(|(_, weight)| *weight));
    }
    let mut about = per(if once { "constant" } else { "vertex" });
    about.insert(0, format!("elementSize = {width}"));
    layer.list("int[] primvars:skel:jointIndices", joints, &about);
    layer.list("float[] primvars:skel:jointWeights", weights, &about);
    layer.line("rel skel:skeleton = </character/skeleton>");
}

/// Returns the palette entries of the skin nearest to a root, the strongest first, with weights that sum to 1.
fn carriers(root: Vec3, mesh: &TriMesh, rig: &Rig, bvh: &Bvh) -> Vec<(usize, f32)> {
    let Some(closest) = bvh.closest_point(root) else { return vec![(0, 1.0)] };
    let corners = mesh.triangles[closest.triangle as usize];
    let mut all: Vec<(usize, f32)> = Vec::new();
    for (corner, corner_weight) in corners.into_iter().zip(closest.barycentric.to_array()) {
        let bind = &rig.vertices[corner as usize];
        for (joint, weight) in bind.joints.iter().zip(bind.weights).filter(|(_, weight)| *weight > 0.0) {
            let (joint, weight) = (usize::from(*joint), weight * corner_weight);
            match all.iter_mut().find(|(other, _)| *other == joint) {
                Some((_, sum)) => *sum += weight,
                None => all.push((joint, weight)),
            }
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    all.truncate(MAX_JOINTS_PER_STRAND);
    // Drop joints of negligible weight.
    all.retain(|(_, weight)| *weight > 1e-4);
    let sum: f32 = all.iter().map(|(_, weight)| weight).sum();
    all.iter_mut().for_each(|(_, weight)| *weight /= sum);
    if all.is_empty() { vec![(0, 1.0)] } else { all }
}
