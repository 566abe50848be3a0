//! Reads all meshes of a file as one head mesh.

use glam::{DVec3, Vec3};
use openusd::sdf::Value;

use super::{
    Moment, Scene, Source, guarded,
    skel::{Rigging, SkelBinding, Skeletons},
    tree::{Object, Purpose, Schema, Tree, when},
    value,
};
use crate::{
    TriMesh,
    error::Result,
    formats::{faces::fan, raw::RawMesh, source::excerpt},
};

/// Reads all visible meshes of a file, at the first sample or, on a skeleton, at rest. Returns them with their rig, the
/// unit and axes that the file states, and notes on skipped data. Normals are not read; the importer computes them.
pub(crate) fn read(source: &Source) -> Result<RawMesh> {
    guarded(source, || {
        let scene = Scene::open(source)?;
        let tree = Tree::read(&scene)?;
        let objects: Vec<&Object> =
            tree.objects.iter().filter(|object| object.schema == Schema::Mesh).collect();
        let (time, _) = when(&scene, &tree.times(&scene, &objects)?, Moment::First)?;
        let transforms = tree.transforms(&scene, time)?;
        let skeletons = Skeletons::read(&scene, &tree)?;
        let mut rigging = Rigging::new(&scene, &skeletons, &transforms)?;
        let mut mesh = TriMesh::default();
        for object in objects {
            let (matrix, is_visible) = Tree::of(object, &transforms);
            if !is_visible || object.purpose != Purpose::Shown {
                continue;
            }
            let path = excerpt(object.prim.path().as_str());
            let value = |name: &str| -> Result<Value> {
                let value = scene.say(object.prim.attribute(name.to_owned()).get_at(time))?;
                value.ok_or_else(|| scene.problem(format!("the mesh {path} has no {name}")))
            };
            let integers = |name: &str| -> Result<Vec<i64>> {
                Ok(value::row(&value(name)?, |number| number as i64).unwrap_or_default().0)
            };
            let points = value::row(&value("points")?, |number| number as f32).unwrap_or_default().0;
            let (counts, corners) = (integers("faceVertexCounts")?, integers("faceVertexIndices")?);
            scene.take(points.len() as u64 / 3 + corners.len() as u64)?;
            let base = mesh.positions.len() as u32;
            let points: Vec<Vec3> = points.as_chunks().0.iter().map(|p| Vec3::from(*p)).collect();
            let bound = SkelBinding::of(&scene, &tree, (object, points.len()), &skeletons, time)?;
            rigging.add(&scene, (object, matrix), bound.as_ref(), &points, time)?;
            let own = match &bound {
                Some(bound) => skeletons.0[bound.skeleton].transform(&transforms) * bound.geom,
                None => matrix,
            };
            let transform = |p: &Vec3| matrix.transform_point3(DVec3::from(*p)).as_vec3();
            mesh.positions.extend(points.iter().map(transform));
            let hand = scene.say(object.prim.attribute("orientation").get::<Value>())?;
            let left = hand.as_ref().and_then(value::text).as_deref() == Some("leftHanded");
            fan(
                &counts,
                &corners,
                points.len(),
                base,
                left != (own.determinant() < 0.0),
                &mut mesh.triangles,
            )
            .map_err(|problem| scene.problem(format!("{path}: {problem}")))?;
        }
        let (rig, notes) = rigging.finish(&scene, &skeletons, &tree.animations, &mut mesh)?;
        Ok(RawMesh { mesh, rig, declared: scene.declared()?, lights: Vec::new(), notes })
    })
}
