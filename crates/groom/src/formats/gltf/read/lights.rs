//! Lights of the scene's nodes (`KHR_lights_punctual`), where the nodes are at rest.
//!
//! An invalid light is skipped with a note: a mesh is usable without it.

use glam::Vec3;
use gltf::json::{
    extensions::scene::khr_lights_punctual::{Light, Type},
    validation::Checked,
};

use super::{file::File, walk::PlacedNode};
use crate::{
    formats::raw::RawLights,
    light::{PunctualLight, PunctualShape},
};

/// Part of the paths of the extension in errors of the `gltf` crate's validation, which this module does itself.
pub(super) const PATH: &str = "khrLightsPunctual";

/// Returns the lights of a scene's nodes, in the order of the nodes.
pub(super) fn read(file: &File, placed: &[PlacedNode]) -> RawLights {
    let root = file.document.as_json();
    let extension = root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
    let lights = extension.map_or(&[][..], |all| &all.lights);
    let mut found = RawLights::default();
    for node in placed {
        let index = node.node.index();
        let extension = root.nodes.get(index).and_then(|node| node.extensions.as_ref());
        let Some(extension) = extension.and_then(|all| all.khr_lights_punctual.as_ref()) else { continue };
        let number = extension.light.value();
        let light = match lights.get(number) {
            Some(light) => placed_light(light, node),
            None => Err(format!("it does not exist; there are {}", lights.len())),
        };
        match light {
            Ok(light) => found.lights.push(light),
            Err(problem) => found.notes.push(format!("light {number} of node {index} is ignored: {problem}")),
        }
    }
    found
}

/// Returns the light of a node; an error is a clause that names the problem.
fn placed_light(light: &Light, node: &PlacedNode) -> Result<PunctualLight, String> {
    let position = node.global.w_axis.truncate();
    let direction = node.global.transform_vector3(Vec3::NEG_Z).normalize_or_zero();
    let Checked::Valid(kind) = light.type_ else { return Err("its type is unknown".into()) };
    let shape = match (kind, &light.spot) {
        (Type::Directional, _) => PunctualShape::Directional { direction },
        (Type::Point, _) => PunctualShape::Point { position },
        (Type::Spot, Some(spot)) => PunctualShape::Spot {
            position,
            direction,
            inner: spot.inner_cone_angle,
            outer: spot.outer_cone_angle,
        },
        (Type::Spot, None) => return Err("it has no cone".into()),
    };
    let name = light.name.as_deref().or(node.node.name()).unwrap_or_default().into();
    let light = PunctualLight {
        name,
        shape,
        color: Vec3::from(light.color),
        intensity: light.intensity,
        range: light.range.unwrap_or(f32::INFINITY),
    };
    light.check()?;
    Ok(light)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        formats::source::FileBytes,
        import::{ImportOptions, ImportedBody, read_given_body},
        orient::{Axis, LengthUnit, OrientationOverride},
        rig::tests::glb,
    };
    use serde_json::{Value, json};

    /// Returns a GLB with a triangle, `lights`, and a node for each, above the origin and turned so that it shines down.
    /// The nodes are below one that scales by 2 and moves by 1 along X.
    fn file(lights: Value, nodes: &[usize]) -> Vec<u8> {
        let half = 0.5_f32.sqrt();
        let mut all = vec![
            json!({"mesh": 0}),
            json!({"scale": [2, 2, 2], "translation": [1, 0, 0],
                "children": (2..2 + nodes.len()).collect::<Vec<_>>()}),
        ];
        all.extend(nodes.iter().map(|light| {
            json!({"name": "node", "translation": [0, 1.5, 0], "rotation": [-half, 0, 0, half],
                "extensions": {"KHR_lights_punctual": {"light": light}}})
        }));
        let root = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": all,
            "extensionsUsed": ["KHR_lights_punctual"], "extensionsRequired": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": lights}},
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}],
        });
        let corners = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
        glb::pack(root.to_string().into_bytes(), corners.iter().flat_map(|v| v.to_le_bytes()).collect())
    }

    fn read(bytes: &[u8], orient_head: OrientationOverride) -> crate::Result<ImportedBody> {
        let file: FileBytes<'_> = ("a.glb".into(), bytes.into());
        read_given_body(&[file], &ImportOptions { orient_head, ..Default::default() })
    }

    #[test]
    fn lights_are_at_their_nodes() {
        let lights = json!([
            {"type": "directional", "intensity": 3, "color": [1, 0.5, 0.25], "name": "sun"},
            {"type": "point", "range": 7},
            {"type": "spot", "intensity": 40, "spot": {"innerConeAngle": 0.2}},
        ]);
        let bytes = file(lights, &[2, 0, 1, 1]);
        let found = read(&bytes, OrientationOverride::default()).unwrap().lights;
        let position = Vec3::new(1.0, 3.0, 0.0);
        let names: Vec<_> = found.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["node", "sun", "node", "node"]);
        let strengths: Vec<_> = found.iter().map(|light| (light.intensity, light.range)).collect();
        let endless = f32::INFINITY;
        assert_eq!(strengths, [(40.0, endless), (3.0, endless), (1.0, 7.0), (1.0, 7.0)]);
        assert_eq!((found[0].color, found[1].color), (Vec3::ONE, Vec3::new(1.0, 0.5, 0.25)));
        let PunctualShape::Spot { position: at, direction, inner, outer } = found[0].shape else {
            panic!("{found:?}")
        };
        assert!(at.abs_diff_eq(position, 1e-6) && direction.abs_diff_eq(Vec3::NEG_Y, 1e-6), "{found:?}");
        assert_eq!([inner, outer], [0.2, std::f32::consts::FRAC_PI_4]);
        assert!(matches!(found[1].shape, PunctualShape::Directional { .. }));
        assert_eq!(found[2].shape, PunctualShape::Point { position: at });

        // The axes and the unit of the mesh apply.
        let given = OrientationOverride {
            unit: Some(LengthUnit(0.01)),
            up: Some(Axis::Z),
            front: Some(Axis::NegY),
            ..Default::default()
        };
        let body = read(&bytes, given).unwrap();
        let PunctualShape::Point { position: at } = body.lights[2].shape else { panic!("{found:?}") };
        assert!(at.abs_diff_eq(body.placement.point(position), 1e-6), "{at}");
        assert!((body.lights[2].range - 0.07).abs() < 1e-6);
    }

    /// Returns `file` with a point light.
    fn lit(file: &[u8]) -> Vec<u8> {
        glb::changed(file, |root| {
            let light =
                json!({"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 2, 0]});
            let nodes = root["nodes"].as_array_mut().unwrap();
            nodes.push(light);
            let node = nodes.len() - 1;
            root["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
            root["extensions"]["KHR_lights_punctual"] = json!({"lights": [{"type": "point"}]});
        })
    }

    #[test]
    fn character_has_the_lights_of_its_files_once() {
        use crate::{
            character::{CharacterFiles, CharacterSource},
            export::{ExportHair, Writer},
            mannequin,
            progress::at_once,
        };
        let mesh = mannequin::mesh(50);
        let top = mesh.positions.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
        let mut strands = crate::Strands::default();
        for i in 0..40 {
            let root = top + Vec3::new(0.002 * (i % 8) as f32, 0.0, 0.002 * (i / 8) as f32);
            strands.push(&[0.0, 0.02, 0.04].map(|y| root + Vec3::Y * y));
        }
        let writer = Writer::of("a.glb").unwrap();
        let hair = [ExportHair { name: "hair", strands: &strands, packed: false, look: None }];
        let open = |files: &[FileBytes<'_>]| {
            let files = CharacterFiles::Given(files);
            at_once(CharacterSource::imported(&files, &ImportOptions::default(), &())).unwrap()
        };
        let file = |name: &str, bytes: Vec<u8>| -> FileBytes<'static> { (name.into(), bytes.into()) };
        // Hair and body in one file; hair alone; and the light beside the head.
        let whole = writer.character(Some((&mesh, None)), &hair).unwrap();
        let alone = writer.character(None, &hair).unwrap();
        let head = writer.mesh(&mesh, None).unwrap();
        for files in [
            vec![file("a.glb", lit(&whole))],
            vec![file("a.glb", lit(&alone))],
            vec![file("a.glb", alone.clone()), file("b.glb", lit(&head))],
        ] {
            let source = open(&files);
            let positions: Vec<_> = source.lights().iter().map(|light| light.shape).collect();
            assert_eq!(positions, [PunctualShape::Point { position: Vec3::Y * 2.0 }]);
            let parts = at_once(source.parts(&Default::default(), &())).unwrap();
            assert_eq!(parts.lights, source.lights());
            let report = source.report.as_ref().unwrap();
            assert!(report.files.iter().all(|file| file.notes.is_empty()), "{:?}", report.files);
            #[cfg(feature = "cooked")]
            {
                let cooked = source.cook().unwrap().unwrap().write().unwrap();
                assert_eq!(open(&[file("a.tresses", cooked)]).lights(), source.lights());
            }
        }
        assert!(open(&[file("a.glb", whole.clone())]).lights().is_empty());

        // One note per invalid light.
        let broken = |bytes: &[u8]| {
            glb::changed(&lit(bytes), |root| {
                root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = json!(-1);
            })
        };
        for bytes in [&whole, &alone] {
            let source = open(&[file("a.glb", broken(bytes))]);
            let report = source.report.as_ref().unwrap();
            let notes = report.files.iter().flat_map(|file| &file.notes).map(String::as_str);
            let count =
                notes.chain(source.notes()).filter(|note| note.contains("its intensity is -1")).count();
            assert_eq!((source.lights().len(), count), (0, 1));
        }
    }

    #[test]
    fn invalid_lights_are_reported() {
        let told = |light: Value, why: &str| {
            let body = read(&file(json!([{"type": "point"}, light]), &[0, 1, 0]), Default::default());
            let body = body.unwrap_or_else(|error| panic!("{why}: {error}"));
            assert_eq!((body.lights.len(), body.mesh.triangles.len()), (2, 1), "{why}");
            let notes: Vec<_> =
                body.placement.doubts.iter().filter(|doubt| doubt.contains("light")).collect();
            assert!(notes.len() == 1 && notes[0].contains(why), "{why}: {notes:?}");
            assert!(notes[0].starts_with("light 1 of node 3 is ignored: "), "{notes:?}");
        };
        told(json!({"type": "point", "intensity": -1}), "its intensity is -1");
        told(json!({"type": "point", "intensity": 1e39}), "its intensity is inf");
        told(json!({"type": "point", "color": [1, -0.5, 0]}), "its color is [1, -0.5, 0]");
        told(json!({"type": "point", "range": 0}), "its range is 0");
        told(json!({"type": "laser"}), "its type is unknown");
        told(json!({"type": "spot"}), "it has no cone");
        let spot = |inner: f32, outer: f32| json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
        told(spot(0.5, 0.25), "its cone is from 0.5 to 0.25 radians");
        told(spot(-0.5, 0.25), "its cone is from -0.5 to 0.25 radians");
        told(spot(0.0, 2.0), "its cone is from 0 to 2 radians");
        let body = read(&file(json!([{"type": "point"}]), &[0, 4]), Default::default()).unwrap();
        let note = "light 4 of node 3 is ignored: it does not exist; there are 1";
        assert!(body.lights.len() == 1 && body.placement.doubts.iter().any(|doubt| doubt == note));

        // A node without an extent has no direction.
        let flat = file(json!([{"type": "directional"}]), &[0]);
        let flat = glb::changed(&flat, |root| root["nodes"][1]["scale"] = json!([0, 0, 0]));
        let body = read(&flat, Default::default()).unwrap();
        assert!(body.lights.is_empty() && body.placement.doubts.iter().any(|d| d.contains("no direction")));

        // Values of the wrong kind make the file invalid, as elsewhere.
        let error = read(&file(json!([{"type": 3}]), &[0]), Default::default()).unwrap_err().to_string();
        assert!(error.starts_with("a.glb: the file is not a valid glTF file"), "{error}");
    }
}
