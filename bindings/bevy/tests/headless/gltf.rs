//! A glTF file with a skinned mesh, an animation and hair: Bevy loads the scene, and the hair of the same file is
//! attached to it.

use crate::common::{after, app, camera, light, middle, settled, wait};
use bevy::{
    gltf::GltfAssetLabel, mesh::skinning::SkinnedMesh, prelude::*, world_serialization::WorldAssetRoot,
};
use bevy_tresses::{Hair3d, HairGroom, HairSkin};
use std::{fs, time::Duration};
use tresses::groom::{
    Rig, Strands, TriMesh,
    export::{ExportHair, Writer},
    mannequin,
    rig::{Animation, Channel, Curve, Property},
};

/// Returns the built-in bust, whose head turns to the side in a second and stays there.
fn body() -> (TriMesh, Rig) {
    let bust = mannequin::mesh(60);
    let mut rig = mannequin::rig::rig(&bust);
    let values = [0.0, 1.2, 1.2].map(|angle| Quat::from_rotation_y(angle).to_array()).concat();
    let curve = Curve { times: vec![0.0, 1.0, 100.0], values, ..Default::default() };
    let channels = vec![Channel { node: 2, property: Property::Rotation, curve }];
    rig.animations = vec![Animation { name: "Look aside".into(), length: 100.0, channels }];
    (bust, rig)
}

/// Returns hair that stands out to the right of the crown.
fn tuft(bust: &TriMesh) -> Strands {
    let mut strands = Strands::default();
    for (p, n) in bust.positions.iter().zip(&bust.normals).filter(|(p, n)| p.y > 0.06 && n.x > 0.6) {
        strands.push(&(0..10).map(|k| *p + 0.012 * k as f32 * *n).collect::<Vec<_>>());
    }
    strands
}

#[test]
fn gltf_scene_has_the_hair_of_its_file() {
    let folder = std::env::temp_dir().join(format!("bevy_tresses_gltf-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("there is room");
    let (bust, rig) = body();
    let strands = tuft(&bust);
    assert!(strands.len() > 20, "{} strands", strands.len());
    let hair = [ExportHair { name: "hair", strands: &strands, packed: false, look: None }];
    let bytes = Writer::of("body.glb")
        .expect("it is written")
        .character(Some((&bust, Some(&rig))), &hair)
        .expect("it can be written");
    fs::write(folder.join("body.glb"), bytes).expect("there is room");

    let mut app = app(&folder.to_string_lossy());
    light(&mut app);
    let (_, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    let server = app.world().resource::<AssetServer>().clone();
    // Labeled loads choose Bevy's own loader.
    let scene = server.load(GltfAssetLabel::Scene(0).from_asset("body.glb"));
    let clip = server.load(GltfAssetLabel::Animation(0).from_asset("body.glb"));
    let groom: Handle<HairGroom> = server.load("body.glb");
    app.world_mut().spawn(WorldAssetRoot(scene));
    let mut found = None;
    for _ in 0..400 {
        app.update();
        std::thread::sleep(Duration::from_millis(5));
        let mut bodies = app.world_mut().query_filtered::<Entity, With<SkinnedMesh>>();
        let mut players = app.world_mut().query_filtered::<Entity, With<AnimationPlayer>>();
        found = bodies.iter(app.world()).next().zip(players.iter(app.world()).next());
        if found.is_some() {
            break;
        }
    }
    let (body, player) = found.expect("the scene comes with a body and its motion");
    app.world_mut().entity_mut(body).insert(Visibility::Hidden);
    app.world_mut().spawn((Hair3d(groom), HairSkin::new(body)));
    wait(&mut app);
    let rest = after(&mut app, 4, &image);
    rest.keep("gltf_rest");
    let seen = rest.changed(&bare);
    assert!(seen.len() > 100 && middle(&seen).x > 70.0, "{} pixels at {}", seen.len(), middle(&seen));

    let (graph, node) = AnimationGraph::from_clip(clip);
    let graph = app.world_mut().resource_mut::<Assets<AnimationGraph>>().add(graph);
    let mut player = app.world_mut().entity_mut(player);
    player.insert(AnimationGraphHandle(graph));
    player.get_mut::<AnimationPlayer>().expect("it plays").play(node);
    // The head has turned by 69 degrees about its joint.
    let turned = after(&mut app, 90, &image);
    turned.keep("gltf_turned");
    let column = |angle: f32| {
        let (joint, turn) = (mannequin::rig::JOINTS[2].1, Quat::from_rotation_y(angle));
        let all = strands.positions.iter().map(|p| joint + turn * (*p - joint));
        let sum: f32 = all.map(|p| p.x / (0.5 - p.z)).sum();
        64.0 + 48.0 / 0.4_f32.tan() * sum / strands.positions.len() as f32
    };
    for (picture, angle) in [(&rest, 0.0), (&turned, 1.2)] {
        let (found, expected) = (middle(&picture.changed(&bare)).x, column(angle));
        assert!((found - expected).abs() < 3.0, "turned by {angle}: at {found}, not {expected}");
    }
    assert!((column(0.0) - column(1.2)).abs() > 8.0, "the comparer sees no difference");
    fs::remove_dir_all(&folder).expect("it is ours");
}
