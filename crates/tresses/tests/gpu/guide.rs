//! The Rust code of `docs/guide/characters.md` and `engine.md`: their blocks are here or in an example.

use crate::common;
use crate::embed::{HostScene, target};
use tresses::collide::{Collider, Shape};
use tresses::glam::{DVec3, Mat4, Quat, Vec3, Vec4};
use tresses::groom::rig::{Animation, Channel, Curve, Property};
use tresses::groom::{grow::Growth, import::ImportOptions, mannequin::facial::Beard, styles::Style};
use tresses::light::{Environment, Light, Lights, SceneShadow, Sky};
use tresses::renderer::Renderer;
use tresses::wgpu::{TextureFormat, TextureUsages};
use tresses::{
    Background, Budget, LodOptions,
    low_level::{StrandVertex, readback},
};
use tresses::{Camera, Character, CharacterAsset, Context, Pose, Result, Space, View};
use tresses::{CharacterFiles, CharacterOptions, CharacterParts, CharacterSource};
use tresses::{Compositor, HostFrame};
use tresses::{CrowdBudget, Obstacle};
use tresses::{FaceHair, FillOptions, Styling, drape};
use tresses::{Picture, ViewOptions};
use tresses::{Tie, TieTarget};

/// The built-in character with 500 strands and an animation, at rest.
struct Guide {
    tresses: Context,
    parts: CharacterParts,
    ann: Character,
}

#[test]
fn code_of_the_guide_runs() {
    let Some(context) = common::context() else { return };
    let _ = filled;
    let run = async {
        let guide = load(context.clone()).await?;
        character(&guide).await?;
        engine(&guide).await
    };
    pollster::block_on(run).unwrap();
}

async fn load(tresses: Context) -> Result<Guide> {
    let style: Style = "bob".parse()?;
    let source = drape::style(&tresses, &style, &()).await?;
    let growth = Some(Growth::for_style(&style).with_strands(500));
    let face = FaceHair { beard: Beard::Short, ..Default::default() };
    let styling = Styling { growth, face, ..Default::default() };
    let mut parts = source.parts(&styling, &()).await?;
    let turn = [Quat::IDENTITY, Quat::from_rotation_y(0.6)].map(|turn| turn.to_array()).concat();
    let curve = Curve { times: vec![0.0, 1.0], values: turn, ..Default::default() };
    let channels = vec![Channel { node: 2, property: Property::Rotation, curve }];
    let walk = Animation { name: "Walk".into(), length: 1.0, channels };
    parts.anatomy.as_mut().expect("a rig").rig.animations.push(walk);
    parts.levels_of_head = parts.head.as_ref().map(|head| head.levels());
    let asset = CharacterAsset::new(&tresses, parts.clone(), &CharacterOptions::default(), &()).await?;
    let ann = Character::new(&asset)?;
    assert_eq!((ann.grooms().count(), ann.hair().strands.count), (3, 500));
    Ok(Guide { tresses, parts, ann })
}

/// Loads a groom of few strands, filled between them. Only compiled: it names files of the reader.
async fn filled(tresses: Context) -> Result<Character> {
    let (grooms, heads) = (["hair.tfx".into()], ["head.obj".into()]);
    let files = CharacterFiles::Disk { grooms: &grooms, heads: &heads };
    let source = CharacterSource::imported(&files, &ImportOptions::default(), &()).await?;
    let fill = FillOptions { strand_count: Some(20_000), ..Default::default() };
    let parts = source.parts(&Styling { fill, ..Default::default() }, &()).await?;
    let asset = CharacterAsset::new(&tresses, parts, &CharacterOptions::default(), &()).await?;
    let ann = Character::new(&asset)?;
    Ok(ann)
}

/// Advances by a frame. Returns the vertices of the hair.
async fn moved(guide: &Guide, ann: &mut Character) -> Result<Vec<Vec3>> {
    let mut encoder = guide.tresses.device().create_command_encoder(&Default::default());
    guide.tresses.frame(&mut encoder).advance(&mut [&mut *ann], 1.0 / 60.0)?;
    guide.tresses.queue().submit([encoder.finish()]);
    let all: Vec<StrandVertex> = readback::buffer(&guide.tresses, &ann.hair().strands.vertices).await?;
    Ok(all.iter().map(|vertex| vertex.position).collect())
}

/// Returns the mean distance between corresponding vertices, meters.
fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f32>() / a.len() as f32
}

async fn character(guide: &Guide) -> Result<()> {
    let (device, queue, parts) = (guide.tresses.device(), guide.tresses.queue(), &guide.parts);
    let rest = moved(guide, &mut guide.ann.instance()?).await?;
    let turned = |ann: &Character| ann.head().rotation.angle_between(Quat::IDENTITY);
    let [mut ann, mut bob] = [guide.ann.instance()?, guide.ann.instance()?];
    ann.set_pose(Pose { translation: Vec3::new(2.0, 0.0, 0.0), ..Pose::IDENTITY });
    ann.animate("Walk", 0.5)?;
    ann.gesture.head = Pose::about(ann.neck(), Quat::from_rotation_y(0.4));
    ann.gesture.shapes = vec![("Jaw".into(), 0.5)];
    let away = apart(&rest, &moved(guide, &mut ann).await?);
    assert!((1.8..2.2).contains(&away) && turned(&ann) > 0.3, "{away} m, {} rad", turned(&ann));

    let old = ann;
    let tresses = Context::new(device, queue);
    let asset = CharacterAsset::new(&tresses, parts.clone(), &CharacterOptions::default(), &()).await?;
    let mut ann = Character::new(&asset)?;
    ann.continue_from(&old);
    assert_eq!(ann.time(), old.time());

    let (mut ann, camera_at) = (guide.ann.instance()?, DVec3::new(9_999.0, 3.0, -2_000.0));
    ann.space = Space::at(DVec3::new(10_000.0, 3.0, -2_000.0));
    ann.drawn_in = Some(Space::at(camera_at));
    let away = apart(&rest, &moved(guide, &mut ann).await?);
    assert!((away - 1.0).abs() < 1e-3, "{away} m");

    let mut ann = guide.ann.instance()?;
    let at = Vec3::new(0.0, 0.03, -0.11);
    let band = Tie { from: at, to: at, radius: 0.06, held: TieTarget::Together, gather: 0.3, group: None };
    let report = ann.hair_mut().tie(&[band])?;
    assert!(report.rings == 1 && report.together > 1, "{report:?}");
    let collider = Collider { friction: 2.0, ..Collider::new(Shape::sphere(0.06)) };
    let pose = Pose { translation: Vec3::new(0.1, 0.05, 0.0), ..Pose::IDENTITY };
    ann.set_obstacles(&[Obstacle { id: 1, collider, pose }])?;
    for _ in 0..3 {
        Character::collide_nearby(&mut [&mut ann, &mut bob]);
        moved(guide, &mut bob).await?;
        moved(guide, &mut ann).await?;
    }
    let away = apart(&moved(guide, &mut bob).await?, &moved(guide, &mut ann).await?);
    assert!(away > 1e-3, "a band and a ball move the hair by {away} m");

    let rigged = bob.rig_mut().expect("a rig");
    let mut globals = rigged.anatomy().rig.rest_pose().globals;
    globals[2] *= Mat4::from_rotation_y(0.5);
    let pose = rigged.pose_of(&globals)?;
    rigged.set_pose(Some(pose));
    moved(guide, &mut bob).await?;
    assert!((turned(&bob) - 0.5).abs() < 0.01, "{} rad", turned(&bob));

    // Vertices that turn as one take the head and its hair along.
    let mut cat = guide.ann.instance()?;
    let mesh = parts.head.as_ref().expect("a head");
    let pose = Pose::about(cat.neck(), Quat::from_rotation_y(0.3));
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| pose.point(*p)).collect();
    let rigged = cat.rig_mut().expect("a rig");
    rigged.set_vertices(&positions, None)?;
    assert!(rigged.set_vertices(&positions[1..], None).is_err());
    assert!(rigged.set_vertices(&vec![Vec3::NAN; positions.len()], None).is_err());
    let there = moved(guide, &mut cat).await?;
    assert!((turned(&cat) - 0.3).abs() < 1e-4, "{} rad", turned(&cat));
    let each = guide.ann.hair().strands.vertex_count as usize;
    let roots = |all: &[Vec3]| all.iter().step_by(each).copied().collect::<Vec<_>>();
    let carried: Vec<Vec3> = roots(&rest).iter().map(|p| pose.point(*p)).collect();
    let off = apart(&roots(&there), &carried);
    assert!(off < 1e-4, "roots are {off} m off");
    // The gesture counts again afterwards.
    cat.rig_mut().expect("a rig").set_pose(None);
    cat.reset();
    let back = moved(guide, &mut cat).await?;
    assert!(apart(&roots(&rest), &roots(&back)) < 1e-4 && turned(&cat) < 1e-3);
    Ok(())
}

async fn engine(guide: &Guide) -> Result<()> {
    let (tresses, parts) = (guide.tresses.clone(), &guide.parts);
    let (color_format, size, dt) = (TextureFormat::Rgba16Float, [96, 80], 1.0 / 60.0);
    let options = ViewOptions { renderer: Renderer::tiles(1), ..Default::default() };
    let mut view = View::new(&tresses, &options, size, 1)?;
    let embed = Compositor::new(&tresses, options.renderer, color_format)?;

    use tresses::PipelineRequest as Request;
    let mut requests = vec![Request::Skinning, Request::Roots, Request::Strands, Request::Avoid];
    requests.extend([Request::Volume, Request::Forces]);
    requests.extend(parts.guide_vertices().into_iter().map(Request::Step));
    requests.push(Request::View(options));
    tresses.prepare(&requests, &()).await?;

    let (mut ann, lamp) = (guide.ann.instance()?, Vec3::new(0.5, 1.0, 1.0));
    let place = ann.focus().center;
    let list = vec![Light::point(lamp, Vec3::splat(3.0)).with_id(7)];
    let environment = Environment::uniform(Vec3::splat(0.2));
    let lights = Lights { list, environment, sky: Sky::default() };
    let camera = Camera::look_at(Vec3::new(0.0, 0.1, 0.9), Vec3::Y * 0.1, 0.5, size);
    let picture = Picture { camera, lights, background: Background::transparent(), ..Default::default() };

    let mut encoder = tresses.device().create_command_encoder(&Default::default());
    let blue = Vec4::new(0.125, 0.25, 0.5, 1.0);
    let scene = HostScene::new(&tresses, &mut encoder, (size, 1), (blue, 0.0), None);
    let shadow_map = HostScene::new(&tresses, &mut encoder, ([64; 2], 1), (blue, 0.0), None).depth;
    let (color, depth, projection) = (scene.color.clone(), scene.depth.clone(), camera.projection);
    let cameras = [picture.camera];
    let mut frame = tresses.frame(&mut encoder).with_cameras(&cameras);
    frame.advance(&mut [&mut ann], dt)?;
    let into = HostFrame::new(&color, &depth, projection);
    frame.composite(&mut view, &[&ann], &picture, &embed, into)?;
    tresses.queue().submit([encoder.finish()]);
    let covered = scene.read(&tresses)?.iter().filter(|texel| **texel != blue).count();
    assert!(covered > 200, "{covered} pixels");

    let mut encoder = tresses.device().create_command_encoder(&Default::default());
    let to_lamp = [Camera::look_at(lamp, place, 0.5, [64; 2])].map(|eye| eye.projection * eye.view)[0];
    let geometry = target(tresses.device(), Compositor::GEOMETRY, TextureUsages::COPY_SRC, (size, 1));
    let motion = geometry.create_view(&Default::default());
    let shadow = SceneShadow { light: 7, depth: &shadow_map, part: None, projection: to_lamp, bias: 0.006 };
    let into = HostFrame { shadows: &[shadow], shade: 1.0, ..into };
    let into = HostFrame { geometry: Some(&motion), ..into };
    tresses.frame(&mut encoder).composite(&mut view, &[&ann], &picture, &embed, into)?;
    tresses.queue().submit([encoder.finish()]);
    let texels: Vec<Vec4> = bytemuck::pod_collect_to_vec(&readback::texture(&tresses, &geometry).await?);
    assert!(texels.iter().any(|texel| texel.w > 0.5 && texel.z > 0.0), "depth and opacity of the hair");
    let lighting = view.shadow_bytes() + view.ambient_bytes() + view.zone_bytes();
    let bytes = ann.hair_bytes() + lighting + view.shaded_bytes() + view.targets().bytes();
    assert!(bytes > 1_000_000, "{bytes} bytes");

    let mut encoder = tresses.device().create_command_encoder(&Default::default());
    let (target, milliseconds, parts) = (view.targets().picture().clone(), 0.0, parts.clone());
    let poses = [0.0, 0.5, -0.5].map(|x| Pose { translation: Vec3::X * x, ..Pose::IDENTITY });
    let options = CharacterOptions::default().with_lod(LodOptions::CROWD);
    let asset = CharacterAsset::new(&tresses, parts, &options, &()).await?;
    let mut crowd = (0..3).map(|_| Character::new(&asset)).collect::<Result<Vec<_>>>()?;
    let budget = Budget { milliseconds: 4.0, bytes: 500_000_000 };
    let mut budget = CrowdBudget { budget, ..Default::default() };
    budget.costs.fit(&budget.detail.work, milliseconds);
    for (character, pose) in crowd.iter_mut().zip(&poses) {
        character.set_pose(*pose);
    }
    let cameras = [picture.camera];
    let mut frame = tresses.frame(&mut encoder).with_cameras(&cameras).within(&mut budget);
    frame.advance(&mut crowd.iter_mut().collect::<Vec<_>>(), dt)?;
    frame.draw(&mut view, &crowd.iter().collect::<Vec<_>>(), &picture, &target)?;
    tresses.queue().submit([encoder.finish()]);
    let covered = view.targets().read().await?.chunks(4).filter(|pixel| pixel[3] > 128).count();
    assert!(covered > 100 && budget.detail.heads.len() >= 3, "{covered} pixels, {:?}", budget.detail);
    Ok(())
}
