//! Extracts the hair scene from the main world.

use crate::{
    ColliderShape, GlobalHairWind, Hair3d, HairCollider, HairDepth, HairDetail, HairGroom, HairHairCollision,
    HairMaterial3d, HairPhysics, HairReady, HairSkin, HairView, HairWind, NoHair,
    error_log::ErrorLog,
    lights::{LightComponent, SceneLight, rgb},
    skin::{SkinCache, SkinQueries, SkinState},
};
use bevy::{
    camera::visibility::{RenderLayers, VisibilityRange},
    ecs::entity::{EntityHashMap, EntityHashSet},
    light::{GlobalAmbientLight, LightProbe},
    log::warn,
    prelude::*,
    render::Extract,
};
#[cfg(feature = "pbr")]
use bevy::{
    color::ColorToComponents,
    pbr::{DistanceFog, FogFalloff},
};
use std::sync::{Arc, atomic::AtomicBool};
use tresses::{LodOptions, Pose, SimulationParams, ViewOptions, groom::SdfGrid, light::HairMaterial};

/// Data of the main world for the next frame of hair.
#[derive(Resource, Debug, Default)]
pub(crate) struct Scene {
    /// Time since the last frame, seconds.
    pub dt: f32,
    /// Sorted by entity, so that frames do not depend on Bevy's storage order.
    pub hair: Vec<SceneHair>,
    /// Sorted by entity.
    pub colliders: Vec<(Entity, HairCollider, Pose)>,
    /// Distance fields of the colliders, without duplicates.
    pub fields: Vec<Arc<SdfGrid>>,
    /// Sorted by id.
    pub lights: Vec<SceneLight>,
    /// Reflection probes, sorted by entity.
    pub probes: Vec<SceneSky>,
    pub cameras: EntityHashMap<SceneCamera>,
}

/// Hair of an entity.
#[derive(Clone, Debug)]
pub(crate) struct SceneHair {
    pub entity: Entity,
    /// `None` while the groom is loading.
    pub groom: Option<HairGroom>,
    /// Pose of the entity.
    pub pose: Pose,
    pub skin: SkinState,
    pub material: HairMaterial,
    pub physics: SimulationParams,
    pub detail: LodOptions,
    pub layers: RenderLayers,
    pub visible: bool,
    /// Whether the entity has [`HairHairCollision`].
    pub collides_with_hair: bool,
    /// Flag of [`HairReady`].
    pub ready: Arc<AtomicBool>,
}

/// A camera that sees hair.
#[derive(Clone, Debug)]
pub(crate) struct SceneCamera {
    pub layers: RenderLayers,
    /// Ambient radiance, candela per square meter.
    pub ambient: Vec3,
    /// Environment map.
    pub sky: Option<SceneSky>,
    /// Whether hair writes depth for this camera.
    pub depth: bool,
    /// Distance fog.
    pub fog: Option<SceneFog>,
    pub options: Option<ViewOptions>,
}

/// A camera's distance fog, in the form of the fog pass's uniform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SceneFog {
    /// Linear color; alpha is the opacity of the fog.
    pub color: Vec4,
    /// Extinction per meter and channel; `w` is the exponent of the distance. If `w` is 0, the fog is linear from `x`
    /// to `y`, meters.
    pub extinction: Vec4,
    /// Inscattering per meter and channel.
    pub inscattering: Vec4,
}

/// An environment map, global or in a box.
#[derive(Clone, Debug)]
pub(crate) struct SceneSky {
    pub map: AssetId<Image>,
    /// Candela per square meter for a texel value of 1.
    pub intensity: f32,
    /// Rotation from the map to the world.
    pub rotation: Quat,
    /// World to a unit cube around the origin, and the fraction of the cube along which the probe fades out towards its
    /// faces. `None` for a global map.
    inside: Option<(Mat4, Vec3)>,
}

impl SceneSky {
    fn new(light: &EnvironmentMapLight, of: Option<(&GlobalTransform, &LightProbe)>) -> Self {
        let mut sky = Self {
            map: light.diffuse_map.id(),
            intensity: light.intensity,
            rotation: light.rotation,
            inside: None,
        };
        if let Some((transform, probe)) = of {
            let (_, rotation, _) = transform.to_scale_rotation_translation();
            sky.rotation = (rotation * light.rotation).normalize();
            // Bevy rotates the box by the light's rotation too.
            let from_cube = transform.to_matrix() * Mat4::from_quat(light.rotation);
            sky.inside = Some((from_cube.inverse(), probe.falloff));
        }
        sky
    }

    /// Returns the probe's weight at `position`, 0 to 1.
    pub fn weight(&self, position: Vec3) -> f32 {
        let Some((to_cube, falloff)) = &self.inside else { return 1.0 };
        let from_face = 0.5 - to_cube.transform_point3(position).abs();
        if !(from_face.cmpgt(Vec3::ZERO).all()) {
            return 0.0;
        }
        // The same falloff as in Bevy's shader.
        (from_face / falloff.max(Vec3::splat(1e-4))).min(Vec3::ONE).min_element()
    }
}

/// Returns position and rotation of an entity, without its scale.
fn pose(transform: &GlobalTransform) -> Pose {
    let (_, rotation, translation) = transform.to_scale_rotation_translation();
    Pose { rotation: rotation.normalize(), translation }
}

type HairQuery<'a> = (
    Entity,
    &'a Hair3d,
    &'a HairMaterial3d,
    &'a HairPhysics,
    &'a HairDetail,
    &'a HairReady,
    &'a GlobalTransform,
    &'a InheritedVisibility,
    Option<&'a HairWind>,
    Option<&'a RenderLayers>,
    Option<&'a HairSkin>,
    Option<&'a VisibilityRange>,
    Has<HairHairCollision>,
);

/// Whether hair at `position` is in `range` of one of the cameras that see its layers. Margins do not fade: hair
/// appears where the margin starts.
fn is_in_range(
    range: &VisibilityRange,
    position: Vec3,
    layers: &RenderLayers,
    cameras: &Query<(&GlobalTransform, Option<&RenderLayers>), (With<Camera3d>, Without<NoHair>)>,
) -> bool {
    let viewers = cameras.iter().filter(|(_, layers_of_camera)| {
        layers_of_camera.unwrap_or(&RenderLayers::default()).intersects(layers)
    });
    let mut distances = viewers.map(|(camera, _)| camera.translation().distance(position));
    distances.any(|distance| (range.start_margin.start..range.end_margin.start).contains(&distance))
}

type LightQuery<'a, L> =
    (Entity, &'a L, &'a GlobalTransform, &'a InheritedVisibility, Option<&'a RenderLayers>);

/// Extracts hair, colliders and the time step.
pub(crate) fn extract_hair(
    mut scene: ResMut<Scene>,
    time: Extract<Res<Time>>,
    wind: Extract<Res<GlobalHairWind>>,
    grooms: Extract<Res<Assets<HairGroom>>>,
    hair: Extract<Query<HairQuery<'static>>>,
    colliders: Extract<Query<(Entity, &'static HairCollider, &'static GlobalTransform)>>,
    cameras: Extract<
        Query<(&'static GlobalTransform, Option<&'static RenderLayers>), (With<Camera3d>, Without<NoHair>)>,
    >,
    skins: SkinQueries,
    mut cache: Local<SkinCache>,
    mut errors: Local<ErrorLog>,
) {
    scene.dt = time.delta_secs();
    scene.hair.clear();
    cache.keep(|entity| hair.get(entity).is_ok_and(|(.., on, _, _)| on.is_some()));
    for (
        entity,
        hair,
        material,
        physics,
        detail,
        ready,
        transform,
        visible,
        own,
        layers,
        on,
        range,
        collides_with_hair,
    ) in &hair
    {
        let layers = layers.cloned().unwrap_or_default();
        let is_near =
            range.is_none_or(|range| is_in_range(range, transform.translation(), &layers, &cameras));
        let wind = own.map_or(wind.0, |wind| wind.0);
        let pose = pose(transform);
        let skin = on.map_or(Ok(SkinState::Off), |on| skins.find(&mut cache, entity, on, pose.matrix()));
        let skin = skin.unwrap_or_else(|problem| {
            errors.report(problem);
            SkinState::Awaited
        });
        scene.hair.push(SceneHair {
            entity,
            groom: grooms.get(&hair.0).cloned(),
            pose,
            skin,
            material: material.0,
            physics: SimulationParams { wind, ..physics.0 },
            detail: detail.0,
            layers,
            visible: visible.get() && is_near,
            collides_with_hair,
            ready: ready.0.clone(),
        });
    }
    scene.hair.sort_by_key(|hair| hair.entity);
    scene.colliders.clear();
    let placed =
        colliders.iter().map(|(entity, collider, transform)| (entity, collider.clone(), pose(transform)));
    scene.colliders.extend(placed);
    scene.colliders.sort_by_key(|(entity, ..)| *entity);
    let Scene { colliders, fields, .. } = &mut *scene;
    fields.clear();
    for (_, collider, _) in colliders {
        if let ColliderShape::Field(field) = &collider.shape
            && !fields.iter().any(|other| Arc::ptr_eq(field, other))
        {
            fields.push(field.clone());
        }
    }
}

/// Adds the visible lights of a kind to `into`. Omits lights with invalid values, and warns about each once.
fn read_lights<L: LightComponent>(
    query: &Query<LightQuery<'static, L>>,
    into: &mut Vec<SceneLight>,
    invalid: &mut EntityHashSet,
) {
    for (entity, component, transform, visible, layers) in query {
        if !visible.get() {
            continue;
        }
        match SceneLight::new(entity, component, transform, layers.cloned().unwrap_or_default()) {
            Ok(light) => into.push(light),
            Err(error) if invalid.insert(entity) => warn!("light {entity} does not light hair: {error}"),
            Err(_) => {}
        }
    }
}

/// Extracts lights, cameras and probes.
pub(crate) fn extract_light(
    mut scene: ResMut<Scene>,
    distant: Extract<Query<LightQuery<'static, DirectionalLight>>>,
    points: Extract<Query<LightQuery<'static, PointLight>>>,
    spots: Extract<Query<LightQuery<'static, SpotLight>>>,
    rects: Extract<Query<LightQuery<'static, RectLight>>>,
    everywhere: Extract<Res<GlobalAmbientLight>>,
    cameras: Extract<
        Query<
            (
                Entity,
                Option<&'static AmbientLight>,
                Option<&'static EnvironmentMapLight>,
                Option<&'static RenderLayers>,
                Option<&'static HairView>,
                Has<HairDepth>,
            ),
            (With<Camera3d>, Without<NoHair>),
        >,
    >,
    #[cfg(feature = "pbr")] fogs: Extract<Query<&'static DistanceFog>>,
    probes: Extract<
        Query<(Entity, &'static EnvironmentMapLight, &'static GlobalTransform, &'static LightProbe)>,
    >,
    // Lights that were reported as invalid.
    mut invalid: Local<EntityHashSet>,
) {
    scene.lights.clear();
    read_lights(&distant, &mut scene.lights, &mut invalid);
    read_lights(&points, &mut scene.lights, &mut invalid);
    read_lights(&spots, &mut scene.lights, &mut invalid);
    read_lights(&rects, &mut scene.lights, &mut invalid);
    scene.lights.sort_by_key(|light| light.light.id);
    scene.cameras.clear();
    for (camera, ambient, sky, layers, view, depth) in &cameras {
        let ambient = match ambient {
            Some(light) => rgb(light.color) * light.brightness,
            None => rgb(everywhere.color) * everywhere.brightness,
        };
        let layers = layers.cloned().unwrap_or_default();
        let (sky, options) = (sky.map(|light| SceneSky::new(light, None)), view.map(|view| view.0));
        #[cfg(feature = "pbr")]
        let fog = fogs.get(camera).ok().map(fog_of);
        #[cfg(not(feature = "pbr"))]
        let fog = None;
        scene.cameras.insert(camera, SceneCamera { layers, ambient, sky, depth, fog, options });
    }
    let mut all: Vec<_> = probes
        .iter()
        .map(|(entity, light, transform, probe)| (entity, SceneSky::new(light, Some((transform, probe)))))
        .collect();
    all.sort_by_key(|(entity, _)| *entity);
    scene.probes = all.into_iter().map(|(_, sky)| sky).collect();
}

#[cfg(feature = "pbr")]
fn fog_of(fog: &DistanceFog) -> SceneFog {
    let (power, extinction, inscattering) = match fog.falloff {
        FogFalloff::Linear { start, end } => (0.0, Vec3::new(start, end, 0.0), Vec3::ZERO),
        FogFalloff::Exponential { density } => (1.0, Vec3::splat(density), Vec3::splat(density)),
        FogFalloff::ExponentialSquared { density } => (2.0, Vec3::splat(density), Vec3::splat(density)),
        FogFalloff::Atmospheric { extinction, inscattering } => (1.0, extinction, inscattering),
    };
    SceneFog {
        color: fog.color.to_linear().to_vec4(),
        extinction: extinction.extend(power),
        inscattering: inscattering.extend(0.0),
    }
}
