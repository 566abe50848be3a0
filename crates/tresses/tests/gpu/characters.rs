//! The high-level `Character`, as hosts use it.

use crate::common::{self, advance_characters};
use std::sync::OnceLock;
use tresses::{
    Body, Budget, Camera, Character, CharacterAsset, CharacterOptions, CharacterParts, Context, CrowdBudget,
    FaceHair, Gesture, HairOptions, LodMode, LodOptions, Obstacle, Picture, Pose, RestOptions,
    SimulationParams, Styling, View,
    collide::{Collider, Shape},
    drape,
    glam::{Quat, Vec3},
    groom::{grow::Growth, mannequin::facial::Beard, styles::Style},
    low_level::readback::blocking as readback,
};

/// Creates the built-in character with few strands, brows, lashes and a hanging beard.
fn bearded(context: &Context) -> Character {
    bearded_with(context, HairOptions::default())
}

fn bearded_with(context: &Context, hair: HairOptions) -> Character {
    static PARTS: OnceLock<CharacterParts> = OnceLock::new();
    let parts = PARTS.get_or_init(|| {
        let style = Style::default();
        let source = pollster::block_on(drape::style(context, &style, &())).unwrap();
        let styling = Styling {
            growth: Some(Growth::for_style(&style).with_strands(300)),
            face: FaceHair { beard: Beard::Full, ..FaceHair::default() },
            ..Styling::default()
        };
        pollster::block_on(source.parts(&styling, &())).unwrap()
    });
    let options = CharacterOptions { hair, ..CharacterOptions::default() };
    let asset = pollster::block_on(CharacterAsset::new(context, parts.clone(), &options, &())).unwrap();
    let mut character = Character::new(&asset).unwrap();
    character.set_lod(LodOptions { mode: LodMode::Off, ..LodOptions::default() });
    character
}

/// Renders `characters` with a camera in front of the origin.
fn render(context: &Context, characters: &[&Character]) -> Vec<u8> {
    let size = [96, 96];
    let mut view = View::new(context, &common::coarse(), size, 1).unwrap();
    let camera = Camera::look_at(Vec3::new(0.0, 0.05, 1.2), Vec3::new(0.0, 0.05, 0.0), 0.5, size);
    common::draw_characters(&mut view, characters, &Picture { camera, ..Picture::default() })
}

/// Reads the drawn vertices of every groom.
fn vertices(character: &Character) -> Vec<Vec<u32>> {
    let context = common::context().unwrap();
    character.grooms().map(|hair| readback::buffer(context, &hair.strands.vertices).unwrap()).collect()
}

fn nod(degrees: f32) -> Gesture {
    let rotation = Quat::from_rotation_x(degrees.to_radians());
    Gesture { head: Pose { rotation, ..Pose::IDENTITY }, ..Gesture::default() }
}

#[test]
fn instance_moves_and_looks_like_a_separate_character() {
    let Some(context) = common::context() else { return };
    let mut first = bearded(context);
    let mut moved = first.instance().unwrap();
    moved.gesture = nod(20.0);
    advance_characters(&mut [&mut moved], 0.2);
    // Instances of a character at rest and of one that is already posed.
    let (mut second, mut third) = (first.instance().unwrap(), moved.instance().unwrap());
    third.reset();
    for i in 0..3 {
        let gesture = nod(4.0 + 8.0 * i as f32);
        for character in [&mut first, &mut second, &mut third] {
            character.gesture.clone_from(&gesture);
        }
        advance_characters(&mut [&mut first, &mut second, &mut third], 1.0 / 60.0);
    }
    for other in [&second, &third] {
        assert!(vertices(&first) == vertices(other));
        assert!(render(context, &[&first]) == render(context, &[other]));
    }
}

#[test]
fn instances_deform_and_move_independently() {
    let Some(context) = common::context() else { return };
    let mut first = bearded(context);
    let mut second = first.instance().unwrap();
    second.gesture = nod(25.0);
    for _ in 0..4 {
        advance_characters(&mut [&mut first, &mut second], 1.0 / 60.0);
    }
    let body = |character: &Character| -> Vec<u32> {
        readback::buffer(context, character.body().map(Body::vertices).unwrap()).unwrap()
    };
    assert!(body(&first) != body(&second), "only one of them nods");
    let [still, nodding] = [&first, &second].map(vertices);
    assert!(still.iter().zip(&nodding).all(|(a, b)| a != b), "every groom goes with its own skin");
    assert!(first.head() == Pose::IDENTITY && second.head() != Pose::IDENTITY);
    assert!(first.shared_bytes() > 0 && second.own_bytes() < first.own_bytes() + first.shared_bytes());
    second.shave();
    assert_eq!(second.instance().unwrap().grooms().count(), 1, "instances of a shaved character are shaved");
}

#[test]
fn rest_of_all_grooms_follows_the_support() {
    let Some(context) = common::context() else { return };
    let rest = RestOptions { support: 1000.0, ..Default::default() };
    let infos = |character: &Character| -> Vec<Vec<u32>> {
        character.grooms().map(|hair| readback::buffer(context, &hair.guides.info).unwrap()).collect()
    };
    let mut soft = bearded(context);
    let before = infos(&soft);
    let expected = infos(&bearded_with(context, HairOptions { rest, ..Default::default() }));
    assert!(before.iter().zip(&expected).skip(1).any(|(a, b)| a != b), "a face groom needs support");
    soft.set_rest(&SimulationParams::default(), &rest).unwrap();
    assert!(infos(&soft) == expected);
}

#[test]
fn crowd_keeps_its_budget_and_has_a_zone_per_head() {
    let Some(context) = common::context() else { return };
    let mut first = bearded(context);
    first.set_lod(LodOptions { mode: LodMode::Auto, ..LodOptions::CROWD });
    let mut crowd: Vec<_> = (0..3).map(|_| first.instance().unwrap()).collect();
    for (i, character) in crowd.iter_mut().enumerate() {
        character.set_pose(Pose { translation: Vec3::X * (i as f32 - 1.0), ..Pose::IDENTITY });
    }
    let cameras = |size| [Camera::look_at(Vec3::new(0.0, 0.1, 4.0), Vec3::ZERO, 0.6, [size, size])];
    // Returns the strand count and the number of levels of detail that the crowd gets for a budget of `bytes`.
    let select_detail = |bytes: u64, cameras: &[Camera]| {
        let mut crowd: Vec<_> = crowd.iter().map(|character| character.instance().unwrap()).collect();
        let mut budget =
            CrowdBudget { budget: Budget { bytes, ..Budget::default() }, ..CrowdBudget::default() };
        let mut all: Vec<_> = crowd.iter_mut().collect();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        let frame = context.frame(&mut encoder).with_cameras(cameras);
        frame.within(&mut budget).advance(&mut all, 1.0 / 60.0).unwrap();
        context.queue().submit([encoder.finish()]);
        let strands = budget.detail.heads.iter().map(|head| head.strand_count).sum::<u32>();
        (strands, budget.detail.heads.len())
    };
    let (near, far) = (cameras(1024), cameras(64));
    let grooms = first.grooms().count();
    assert_eq!(select_detail(u64::MAX, &near).1, 3 * grooms, "every groom has a level");
    assert_eq!(select_detail(u64::MAX, &far).1, 3, "faces of small heads are left out");
    assert!(select_detail(1, &near).0 < select_detail(u64::MAX, &near).0);
    let mut all: Vec<_> = crowd.iter_mut().collect();
    advance_characters(&mut all, 0.0);
    let size = [64, 64];
    let mut view = View::new(context, &common::coarse(), size, 1).unwrap();
    let picture = Picture { camera: far[0], ..Picture::default() };
    let mut zone_bytes = |count: usize| {
        let all: Vec<_> = crowd.iter().take(count).collect();
        common::draw_characters(&mut view, &all, &picture);
        view.zone_bytes()
    };
    let [three, two] = [zone_bytes(3), zone_bytes(2)];
    assert!(three > two && two > 0, "a zone each: {three} {two}");
}

#[test]
fn obstacles_push_hair_and_can_be_removed() {
    let Some(context) = common::context() else { return };
    let mut first = bearded(context);
    let mut second = first.instance().unwrap();
    let ball = Obstacle {
        id: 1,
        collider: Collider::new(Shape::sphere(0.1)),
        pose: Pose { translation: Vec3::new(0.1, -0.1, 0.0), ..Pose::IDENTITY },
    };
    second.set_obstacles(&[ball]).unwrap();
    for _ in 0..3 {
        advance_characters(&mut [&mut first, &mut second], 1.0 / 60.0);
    }
    assert!(vertices(&first)[0] != vertices(&second)[0], "the ball is in the hair");
    assert_eq!(second.drawn_obstacles().len(), 1);
    second.set_obstacles(&[]).unwrap();
    assert!(second.set_obstacle_poses(&[Pose::IDENTITY]).is_err(), "it was made with none");
    advance_characters(&mut [&mut second], 1.0 / 60.0);
    assert!(second.drawn_obstacles().is_empty());
    let field = Shape::Field(tresses::collide::FieldId(77));
    let unknown = Obstacle { collider: Collider::new(field), ..ball };
    assert!(second.set_obstacles(&[unknown]).is_err());
    advance_characters(&mut [&mut second], 1.0 / 60.0);
}

#[test]
fn teleported_hair_keeps_its_shape() {
    let Some(context) = common::context() else { return };
    let mut character = bearded(context);
    for _ in 0..3 {
        advance_characters(&mut [&mut character], 1.0 / 60.0);
    }
    let guides = |character: &Character| -> Vec<[f32; 4]> {
        readback::buffer(context, &character.hair().guides.current).unwrap()
    };
    let before = guides(&character);
    let far = Pose { translation: Vec3::new(0.3, 0.0, 0.0), ..Pose::IDENTITY };
    // Returns the largest change of a guide point relative to the head, meters.
    let max_change = |teleports: bool| {
        let mut character = character.instance().unwrap();
        for _ in 0..3 {
            advance_characters(&mut [&mut character], 1.0 / 60.0);
        }
        character.set_pose(far);
        if teleports {
            character.teleport();
        }
        advance_characters(&mut [&mut character], 1.0 / 60.0);
        let transform = character.hair().simulation_transform();
        let head = character.head().inverse();
        let shape = guides(&character);
        let changes = shape.iter().zip(&before).map(|(now, then)| {
            let [x, y, z, _] = *now;
            head.point(transform.point(Vec3::new(x, y, z))).distance(Vec3::from_slice(&then[..3]))
        });
        changes.fold(0.0, f32::max)
    };
    let [carried, dragged] = [max_change(true), max_change(false)];
    assert!(carried < 0.01 && dragged > 0.1, "carried {carried} m, dragged {dragged} m");
}

#[test]
fn replaced_groom_keeps_time_material_and_gesture() {
    let Some(context) = common::context() else { return };
    let mut character = bearded(context);
    character.gesture = nod(15.0);
    character.rig_mut().unwrap().set_shape("smile", 0.5).ok();
    advance_characters(&mut [&mut character], 0.5);
    let (time, material) = (character.time(), character.hair().set.material);
    let source = pollster::block_on(drape::style(context, &"bob".parse().unwrap(), &())).unwrap();
    let growth = Growth::for_style(&"bob".parse().unwrap()).with_strands(200);
    let styling = Styling { growth: Some(growth), ..Styling::default() };
    let parts = pollster::block_on(source.parts(&styling, &())).unwrap();
    let asset =
        pollster::block_on(CharacterAsset::new(context, parts, &CharacterOptions::default(), &())).unwrap();
    character.replace(&asset).unwrap();
    assert_eq!((character.time(), character.hair().set.material), (time, material));
    assert_eq!((character.gesture.clone(), character.hair().strands.count), (nod(15.0), 200));
    assert!(character.animate("Walk", 0.0).unwrap_err().to_string().contains("Walk"));
    advance_characters(&mut [&mut character], 1.0 / 60.0);
}
