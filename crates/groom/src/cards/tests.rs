//! Cards of synthetic hair.

use super::{CardLevel, CardOptions, CardStrands, CardStrip, Cards, bake};
use crate::{BindOptions, BoundStrands, Groom, Strands, TriMesh, bind, random::Rng, sdf::SdfGrid};
use glam::{Quat, Vec3};
use std::{f32::consts::TAU, sync::OnceLock};

/// A sphere of 10 cm radius around the origin.
fn head() -> TriMesh {
    let (rings, sectors) = (24u32, 48u32);
    let mut mesh = TriMesh::default();
    for i in 0..=rings {
        let polar = std::f32::consts::PI * i as f32 / rings as f32;
        for j in 0..sectors {
            let around = TAU * j as f32 / sectors as f32;
            let up = Vec3::new(polar.sin() * around.sin(), polar.cos(), polar.sin() * around.cos());
            mesh.positions.push(0.1 * up);
            mesh.normals.push(up);
        }
    }
    for i in 0..rings {
        for j in 0..sectors {
            let (a, b) = (i * sectors + j, i * sectors + (j + 1) % sectors);
            mesh.triangles.push([a, a + sectors, b]);
            mesh.triangles.push([b, a + sectors, b + sectors]);
        }
    }
    mesh
}

/// Hair that leaves the upper half of the sphere and falls along it.
fn hair(count: u32) -> Strands {
    let mut rng = Rng::new(3, 0);
    let mut strands = Strands::default();
    for _ in 0..count {
        let (y, around) = (rng.range(0.1, 1.0), rng.range(0.0, TAU));
        let flat = (1.0 - y * y).sqrt();
        let mut p = 0.1 * Vec3::new(flat * around.sin(), y, flat * around.cos());
        let mut way = p.normalize();
        let mut points = vec![p];
        for _ in 0..20 {
            way = (way + 0.45 * Vec3::NEG_Y + 0.015 * rng.bell3()).normalize();
            p += 0.009 * way;
            if p.length() < 0.104 {
                p = 0.104 * p.normalize();
            }
            points.push(p);
        }
        strands.push(&points);
    }
    strands.radii = vec![0.0004; strands.positions.len()];
    strands
}

fn options(levels: &[u32]) -> CardOptions {
    CardOptions { levels: levels.to_vec(), texture_size: 512, lock_texture_count: 16, ..Default::default() }
}

fn baked(strands: &Strands, head: Option<&TriMesh>, levels: &[u32]) -> Cards {
    bake(strands, head, &options(levels)).unwrap()
}

#[test]
fn levels_cover_what_strands_cover() {
    let (strands, head) = (hair(1500), head());
    let cards = baked(&strands, Some(&head), &[150, 50, 20]);
    for (level, [iou, wide]) in cards.levels.iter().zip([[0.74, 0.2], [0.7, 0.25], [0.6, 0.4]]) {
        let found = &level.accuracy;
        assert!(found.soft_iou > iou, "{} cards: {found:?}", level.cards);
        assert!((found.coverage - 1.0).abs() < 0.02, "{} cards: {found:?}", level.cards);
        let [low, high] = found.coverage_range;
        assert!(low > 1.0 - wide && high < 1.0 + wide, "{} cards: {found:?}", level.cards);
    }
}

/// Hair, a head, and their cards, for tests of the result.
fn sample() -> &'static (Strands, TriMesh, Cards) {
    static SAMPLE: OnceLock<(Strands, TriMesh, Cards)> = OnceLock::new();
    SAMPLE.get_or_init(|| {
        let (strands, head) = (hair(600), head());
        let options = CardOptions { triangles: vec![1200, 200], ..options(&[60, 20]) };
        let cards = bake(&strands, Some(&head), &options).unwrap();
        (strands, head, cards)
    })
}

#[test]
fn meshes_are_valid_and_keep_to_their_budgets() {
    let (strands, _, cards) = sample();
    let field = SdfGrid::from_fn(Vec3::splat(-0.3), Vec3::splat(0.3), 97, |p| p.length() - 0.1);
    for (level, most) in cards.levels.iter().zip([1200, 200]) {
        let mesh = &level.mesh;
        assert!(mesh.triangles.len() <= most && mesh.triangles.len() > most / 2, "{}", mesh.triangles.len());
        assert_eq!(mesh.starts.len(), level.cards as usize);
        let count = mesh.positions.len();
        for list in [mesh.normals.len(), mesh.tangents.len(), mesh.uvs.len(), mesh.light.len()] {
            assert_eq!(list, count);
        }
        assert!(mesh.triangles.iter().flatten().all(|v| (*v as usize) < count));
        assert!(mesh.uvs.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
        for i in 0..count {
            let (n, t) = (mesh.normals[i], mesh.tangents[i]);
            assert!(n.is_normalized() && t.is_normalized() && n.dot(t).abs() < 1e-3, "{n} {t}");
            assert!(mesh.positions[i].is_finite() && field.sample(mesh.positions[i]) > -0.002);
            assert!((0.0..=1.0).contains(&mesh.light[i]));
        }
        // Normals are on the side of the triangles' fronts, except where coarse cards are folded.
        let against = mesh.triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            t.iter().any(|v| (b - a).cross(c - a).dot(mesh.normals[*v as usize]) < 0.0)
        });
        let against = against.count();
        assert!(
            against * [50, 12][level.index as usize] <= mesh.triangles.len(),
            "{against} of {}",
            mesh.triangles.len()
        );
        // Every strand is on one card.
        let mut all: Vec<u32> = level.locks.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..strands.len() as u32).collect::<Vec<_>>());
    }
}

#[test]
fn the_order_draws_hidden_cards_first() {
    let (_, _, cards) = sample();
    for level in &cards.levels {
        assert!(level.overdraw > 1.0 && level.overdraw < 20.0, "{}", level.overdraw);
        assert!(level.order_error > 0.0 && level.order_error < 0.03, "{}", level.order_error);
        assert!((0.0..0.5).contains(&level.pop), "{}", level.pop);
        // Locks follow the order of the cards: each card starts near the roots of its strands.
        let strands = &sample().0;
        for (start, lock) in level.mesh.starts.iter().zip(&level.locks) {
            let root = |i: &u32| strands.positions[strands.range(*i as usize).start];
            let middle = lock.iter().map(root).sum::<Vec3>() / lock.len() as f32;
            assert!(level.mesh.roots[*start as usize].distance(middle) < 0.08);
        }
    }
}

#[test]
fn budgets_belong_to_the_levels_that_are_asked_for() {
    // Ten strands make two equal levels, which become one.
    let options = CardOptions { triangles: vec![400, 200, 16], ..options(&[40, 20, 4]) };
    let cards = bake(&hair(10), None, &options).unwrap();
    assert_eq!(cards.levels.iter().map(|level| level.cards).collect::<Vec<_>>(), [10, 4]);
    assert!(cards.levels[1].mesh.triangles.len() <= 16, "{}", cards.levels[1].mesh.triangles.len());
}

/// Returns cards with a helmet of hair with a number of strands.
fn with_helmet(strands: u32) -> Cards {
    let options = CardOptions { has_helmet: true, triangles: vec![400, 200], ..options(&[20]) };
    bake(&hair(strands), Some(&head()), &options).unwrap()
}

#[test]
fn a_helmet_is_a_shell_around_dense_hair_only() {
    let cards = with_helmet(2500);
    let level = &cards.levels[1];
    assert!(level.helmet && level.locks.is_empty() && level.mesh.starts.is_empty(), "{:?}", cards.notes);
    assert!(level.accuracy.soft_iou > 0.7, "{:?}", level.accuracy);
    let mesh = &level.mesh;
    assert!((100..=210).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
    let count = mesh.positions.len();
    assert!([mesh.normals.len(), mesh.uvs.len(), mesh.roots.len()].iter().all(|list| *list == count));
    for i in 0..count {
        let (p, n, t) = (mesh.positions[i], mesh.normals[i], mesh.tangents[i]);
        assert!(p.length() > 0.09 && n.is_normalized() && t.is_normalized() && n.dot(t).abs() < 1e-3);
        assert!(
            mesh.roots[i].y > 0.0 && mesh.uvs[i].min_element() >= 0.0 && mesh.uvs[i].max_element() <= 1.0
        );
    }
    // Normals point out of the hair, and tips are lower on the picture than roots.
    let up = (0..count).max_by(|a, b| mesh.positions[*a].y.total_cmp(&mesh.positions[*b].y)).unwrap();
    let low = (0..count).min_by(|a, b| mesh.positions[*a].y.total_cmp(&mesh.positions[*b].y)).unwrap();
    assert!(mesh.normals[up].y > 0.7 && mesh.uvs[up].y < mesh.uvs[low].y);
    // Its picture is opaque.
    let size = cards.textures.size as f32;
    let alpha = |uv: &glam::Vec2| {
        cards.textures.color[(uv.y * size) as usize * size as usize + (uv.x * size) as usize][3]
    };
    assert!(mesh.uvs.iter().all(|uv| alpha(uv) == 255));

    let sparse = with_helmet(20);
    assert!(!sparse.levels.iter().any(|level| level.helmet));
    assert!(sparse.notes.iter().any(|note| note.starts_with("helmet: left out")), "{:?}", sparse.notes);
}

#[test]
fn coarse_cards_are_unions_of_fine_ones() {
    let (_, _, cards) = sample();
    for fine in &cards.levels[0].locks {
        let whole = |coarse: &&Vec<u32>| fine.iter().all(|strand| coarse.contains(strand));
        assert_eq!(cards.levels[1].locks.iter().filter(whole).count(), 1);
    }
}

#[test]
fn columns_of_cards_are_strands_of_the_same_guides() {
    let groom = bind(&hair(600), &BindOptions::default()).unwrap();
    let cards = bake(&groom.strands.unbound(), Some(&head()), &options(&[40])).unwrap();
    let CardStrands { groom: columns, sheet } = cards.strands(0, &groom).unwrap();
    assert_eq!(columns.guides, groom.guides);
    let (mesh, strands) = (&cards.levels[0].mesh, &columns.strands);
    // Every strip joins neighboring columns of a card, which follow the same guides and end where the card ends.
    let cards_of = |strip: &CardStrip| strip.columns.map(|i| &strands.bindings[i as usize]);
    for strip in &sheet.strips {
        let [left, right] = cards_of(strip);
        assert_eq!(
            (left.guides, left.weight_b, left.weight_c),
            (right.guides, right.weight_b, right.weight_c)
        );
        assert_eq!(left.scale, right.scale);
        assert!(left.weight_b >= 0.0 && left.weight_c >= 0.0 && left.weight_b + left.weight_c < 1.0);
        for (column, [root, tip]) in strip.columns.iter().zip([0, 1].map(|i| [strip.roots[i], strip.tips[i]]))
        {
            let ends: Vec<Vec3> = strands.rest_positions(*column as usize).collect();
            for (uv, end) in [(root, ends[0]), (tip, *ends.last().unwrap())] {
                let near = (0..mesh.uvs.len()).filter(|v| mesh.uvs[*v] == uv);
                let near = near.map(|v| mesh.positions[v].distance(end)).fold(f32::INFINITY, f32::min);
                assert!(near < 1e-5, "{near}");
            }
        }
    }
    assert!(sheet.strips.len() >= 40 && sheet.strips.len() < strands.len());
    // Columns are as wide as the strands that they replace.
    let wide = |strands: &BoundStrands| strands.strands.iter().map(|strand| strand.radius).sum::<f32>();
    let (all, found) = (wide(&groom.strands), wide(strands));
    assert!((found / all - 1.0).abs() < 1e-3, "{found} {all}");
    let error = |cards: &Cards, level, groom: &Groom| cards.strands(level, groom).unwrap_err().to_string();
    let few = bind(&hair(100), &BindOptions::default()).unwrap();
    assert!(error(&cards, 0, &few).contains("another groom"));
    assert!(error(&cards, 1, &groom).contains("no such level"));
    let helmet = Cards { levels: vec![CardLevel { helmet: true, ..Default::default() }], ..cards };
    assert!(error(&helmet, 0, &groom).contains("helmet"));
}

#[test]
fn bakes_repeat_and_turn_with_the_hair() {
    let strands = hair(400);
    let cards = baked(&strands, None, &[40]);
    assert_eq!(cards, baked(&strands, None, &[40]));
    let turn = Quat::from_rotation_y(0.5 * std::f32::consts::PI);
    let positions = strands.positions.iter().map(|p| turn * *p).collect();
    let turned = baked(&Strands { positions, ..strands }, None, &[40]);
    let [a, b] = [&cards, &turned].map(|cards| cards.levels[0].accuracy.clone());
    assert!((a.soft_iou - b.soft_iou).abs() < 0.01, "{a:?} {b:?}");
}

/// A curtain of parallel strands is as flat as its card.
#[test]
fn a_flat_lock_needs_no_wider_strands() {
    let mut strands = Strands::default();
    for i in 0..60 {
        let x = 0.0005 * i as f32;
        strands.push(&(0..9).map(|k| Vec3::new(x, -0.02 * k as f32, 0.0)).collect::<Vec<_>>());
    }
    strands.radii = vec![0.0001; strands.positions.len()];
    let cards = baked(&strands, None, &[1]);
    let level = &cards.levels[0];
    // A few percent: seen aslant, round strands hide each other and flat ones become narrower.
    assert!(level.widening < 1.5, "{}", level.widening);
    assert!(level.accuracy.soft_iou > 0.8, "{:?}", level.accuracy);
    let depths = level.mesh.positions.iter().map(|p| p.z.abs()).fold(0.0, f32::max);
    assert!(depths < 1e-4, "{depths}");
    let width = level.mesh.positions.iter().map(|p| p.x).fold(0.0, f32::max);
    assert!((width - 0.0295).abs() < 0.001, "{width}");
}

#[test]
fn groups_do_not_share_cards() {
    let mut strands = hair(400);
    strands.marks = (0..400).map(|i| crate::strands::Mark { group: i % 2, ..Default::default() }).collect();
    let cards = baked(&strands, None, &[40]);
    for lock in &cards.levels[0].locks {
        assert!(lock.iter().all(|strand| strand % 2 == lock[0] % 2));
    }
}

#[test]
fn unusable_input_is_refused_with_a_reason() {
    let strands = hair(20);
    let refused =
        |strands: &Strands, options: &CardOptions| bake(strands, None, options).unwrap_err().to_string();
    assert!(refused(&Strands::default(), &options(&[4])).contains("no strands with a length"));
    for levels in [vec![], vec![0], vec![4, 4], vec![4, 8], vec![5000]] {
        assert!(refused(&strands, &options(&levels)).contains("list of levels"), "{levels:?}");
    }
    for texture in [0, 100, 16384] {
        assert!(
            refused(&strands, &CardOptions { texture_size: texture, ..options(&[4]) })
                .contains("texture size")
        );
    }
    assert!(refused(&strands, &CardOptions { triangles: vec![3], ..options(&[4]) }).contains("two per card"));
    let crowded = CardOptions { texture_size: 128, lock_texture_count: 1024, ..options(&[1500]) };
    assert!(refused(&hair(1600), &crowded).contains("do not fit"));
    let mut points = Strands::default();
    points.push(&[Vec3::ONE; 3]);
    assert!(refused(&points, &options(&[4])).contains("no strands with a length"));
    // One strand, beside one without length and one without vertices.
    points.push(&[]);
    points.push(&[Vec3::ZERO, Vec3::Y * 0.1]);
    let cards = baked(&points, None, &[4]);
    assert_eq!((cards.levels[0].cards, &cards.levels[0].locks), (1, &vec![vec![2]]));
    assert!(cards.notes.len() >= 2, "{:?}", cards.notes);
}

#[cfg(feature = "textures")]
mod files {
    use super::super::{BONES, CardAlpha, CardLook};
    use super::*;
    use crate::{import, rig};

    fn look() -> CardLook {
        CardLook { color: Vec3::new(0.1, 0.05, 0.02), alpha: CardAlpha::Core, motions: Vec::new() }
    }

    #[test]
    fn glb_files_hold_all_levels_and_follow_the_body() {
        let (_, head, cards) = sample();
        // A joint that is a meter higher and turned, in which the body and the cards are bound.
        let rest =
            rig::Transform { translation: Vec3::Y, rotation: Quat::from_rotation_z(1.0), scale: Vec3::ONE };
        let rig = rig::Rig {
            nodes: vec![rig::Node { name: "head".into(), rest, ..Default::default() }],
            joints: vec![rig::Joint { node: 0, inverse_bind: glam::Mat4::IDENTITY }],
            vertices: head
                .positions
                .iter()
                .zip(&head.normals)
                .map(|(p, n)| {
                    let back = rest.matrix().inverse();
                    rig::Bind::rigid(back.transform_point3(*p), back.transform_vector3(*n), 0)
                })
                .collect(),
            ..Default::default()
        };
        let bytes = cards.glb(Some((head, Some(&rig))), &look()).unwrap();
        let file = gltf::Glb::from_slice(&bytes).unwrap();
        let root: serde_json::Value = serde_json::from_slice(&file.json).unwrap();
        let named = |list: &str, name: &str| {
            root[list].as_array().unwrap().iter().position(|item| item["name"] == name).unwrap()
        };
        let nodes = ["Hair_LOD0", "Hair_LOD1"].map(|name| named("nodes", name));
        assert_eq!(root["nodes"][nodes[0]]["extensions"]["MSFT_lod"]["ids"][0], nodes[1]);
        assert_eq!(root["images"].as_array().unwrap().len(), 3);
        // The core and the fringe are two primitives of the same vertices.
        let mesh = &root["meshes"][named("meshes", "Hair_LOD0")];
        assert_eq!(mesh["primitives"][0]["attributes"], mesh["primitives"][1]["attributes"]);
        // Every strict reader accepts the file; the body is unchanged.
        let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = gltf.blob.clone().unwrap();
        let node = gltf.nodes().nth(nodes[0]).unwrap();
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob));
        let moved: Vec<Vec3> =
            reader.read_positions().unwrap().map(|p| rest.matrix().transform_point3(Vec3::from(p))).collect();
        for (a, b) in moved.iter().zip(&cards.levels[0].mesh.positions) {
            assert!(a.distance(*b) < 1e-5, "{a} {b}");
        }
        assert_eq!(
            reader.read_indices().unwrap().into_u32().count(),
            3 * cards.levels[0].mesh.triangles.len()
        );
        assert!(reader.read_tangents().is_some() && reader.read_colors(0).is_some());
        let folder = tempfile_folder("cards-glb");
        let path = folder.join("hair.glb");
        std::fs::write(&path, &bytes).unwrap();
        let body = import::read_head(&[&path], &import::ImportOptions::default())
            .map(|(mesh, _)| mesh.triangles.len());
        let _ = std::fs::remove_dir_all(&folder);
        assert!(body.unwrap() >= head.triangles.len());
    }

    fn tempfile_folder(name: &str) -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("tresses-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn skin_under_hair_has_its_color() {
        let (_, head, cards) = sample();
        let bytes = cards.glb(Some((head, None)), &look()).unwrap();
        let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = gltf.blob.clone().unwrap();
        let primitive = gltf.meshes().next().unwrap().primitives().next().unwrap();
        let colors: Vec<[f32; 3]> =
            primitive.reader(|_| Some(&blob)).read_colors(0).unwrap().into_rgb_f32().collect();
        // Hair grows above the equator alone.
        let mut under = Vec::new();
        for (p, [red, ..]) in head.positions.iter().zip(colors) {
            assert!(p.y > -0.01 || red == 0.45, "{p} {red}");
            under.extend((p.y > 0.02).then_some(red));
        }
        let mean = under.iter().sum::<f32>() / under.len() as f32;
        assert!(mean < 0.4, "{mean}");
        let other =
            TriMesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]], ..Default::default() };
        let refusal = cards.glb(Some((&other, None)), &look()).unwrap_err().to_string();
        assert!(refusal.contains("another head"), "{refusal}");
    }

    /// Returns how far cards of swaying hair are from where they should be with a number of chains, and how far
    /// without.
    fn swayed(chains: u32) -> [f32; 2] {
        let (strands, head) = (&sample().0, &sample().1);
        let cards =
            bake(strands, Some(head), &CardOptions { chain_count: chains, ..options(&[60]) }).unwrap();
        let sway = |p: Vec3, root: Vec3| p + 2.0 * (p - root).length_squared() * Vec3::X;
        let mut moved = strands.clone();
        for i in 0..moved.len() {
            let range = moved.range(i);
            let root = moved.positions[range.start];
            moved.positions[range].iter_mut().for_each(|p| *p = sway(*p, root));
        }
        let ends = cards.chains.followed(&moved);
        let bone = |bone: u16, p: Vec3| {
            let at = usize::from(bone) / BONES * (BONES + 1) + usize::from(bone) % BONES;
            let way = |ends: &[Vec3]| (ends[at + 1] - ends[at]).normalize();
            let turn = Quat::from_rotation_arc(way(&cards.chains.joints), way(&ends));
            ends[at] + turn * (p - cards.chains.joints[at])
        };
        let mesh = &cards.levels[0].mesh;
        let (mut stays, mut strays) = (0.0, 0.0f32);
        for (i, bind) in cards.levels[0].binds.iter().enumerate() {
            let here: Vec3 = bind
                .bones
                .iter()
                .zip(bind.weights)
                .map(|(j, weight)| weight * bone(*j, mesh.positions[i]))
                .sum();
            let wanted = sway(mesh.positions[i], mesh.roots[i]);
            stays += wanted.distance(mesh.positions[i]);
            strays += wanted.distance(here);
        }
        [strays, stays]
    }

    #[test]
    fn chains_of_bones_carry_the_cards() {
        let (strands, head) = (&sample().0, &sample().1);
        let cards =
            bake(strands, Some(head), &CardOptions { chain_count: 12, ..options(&[60, 20]) }).unwrap();
        assert_eq!(cards.chains.len(), 12);
        assert_eq!(cards.chains.followed(strands), cards.chains.joints);
        for level in &cards.levels {
            let mesh = &level.mesh;
            assert_eq!(level.binds.len(), mesh.positions.len());
            for (bind, along) in level.binds.iter().zip(&mesh.along) {
                assert!((bind.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
                assert!(bind.weights.is_sorted_by(|a, b| a >= b));
                // Roots follow the first bones alone.
                let used = bind.bones.iter().zip(bind.weights).filter(|(_, weight)| *weight > 0.0);
                assert!(*along > 0.0 || used.clone().all(|(bone, _)| usize::from(*bone) % BONES == 0));
            }
        }
        // Hair that sways: cards follow their strands, and better with more chains.
        let [few, many] = [12, 48].map(swayed).map(|[strays, stays]| strays / stays);
        assert!(many < 0.3 && many < 0.8 * few, "{few} {many}");
        // The file has a skeleton with the bones under the body's joint, and needs no body.
        for body in [Some((head, None)), None] {
            let bytes = cards.glb(body, &look()).unwrap();
            let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
            let skin = gltf.skins().last().unwrap();
            assert_eq!(skin.joints().count(), 12 * BONES);
            let node = gltf.nodes().find(|node| node.name() == Some("Hair_LOD0")).unwrap();
            assert_eq!(node.skin().unwrap().index(), skin.index());
        }
    }

    #[test]
    fn helmets_are_opaque() {
        let bytes = with_helmet(1500).glb(None, &look()).unwrap();
        let file = gltf::Glb::from_slice(&bytes).unwrap();
        let root: serde_json::Value = serde_json::from_slice(&file.json).unwrap();
        let mesh =
            root["meshes"].as_array().unwrap().iter().find(|mesh| mesh["name"] == "Hair_LOD1").unwrap();
        let primitives = mesh["primitives"].as_array().unwrap();
        assert_eq!(primitives.len(), 1);
        let material = primitives[0]["material"].as_u64().unwrap() as usize;
        assert_eq!(root["materials"][material]["alphaMode"], "OPAQUE");
    }

    #[test]
    fn obj_files_hold_the_mesh_and_textures_decode() {
        let (_, _, cards) = sample();
        let files = cards.obj("bob", &look()).unwrap();
        let file = |name: &str| &files.iter().find(|(found, _)| found == name).unwrap().1;
        let text = String::from_utf8(file("bob_LOD1.obj").clone()).unwrap();
        let count = |kind: &str| text.lines().filter(|line| line.starts_with(kind)).count();
        let mesh = &cards.levels[1].mesh;
        assert_eq!(
            (count("v "), count("vt "), count("f ")),
            (mesh.positions.len(), mesh.uvs.len(), mesh.triangles.len())
        );
        let picture = image::load_from_memory(file("bob_color.png")).unwrap().into_rgba8();
        assert_eq!(picture.dimensions(), (512, 512));
        let covered = picture.pixels().filter(|p| p.0[3] > 127).count();
        assert!(covered > 2000, "{covered}");
        assert!(String::from_utf8_lossy(file("bob.mtl")).contains("map_d -imfchan m bob_color.png"));
    }
}
