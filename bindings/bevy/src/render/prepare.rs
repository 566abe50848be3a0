//! Grooms come to the GPU.

use super::{
    Complaints,
    living::{Living, Plan},
};
use crate::{
    HairCollider, HairGroom,
    extract::{Scene, SceneHair},
    skin::{OnSkin, Skin},
};
use bevy::{
    ecs::entity::EntityHashMap,
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
    tasks::{AsyncComputeTaskPool, Task, futures::check_ready},
};
use std::sync::{Arc, atomic::Ordering};
use tresses::{
    Hair, HairOptions, Pipelines, Pose, Result,
    body::Body,
    collide::{Collider, ColliderDescriptor, FieldSource},
    constants::MAX_COLLIDERS,
    groom::SdfGrid,
    lod::LodOptions,
    simulate::SimulationParams,
    wgpu,
};

/// Hair on the GPU, and what it grows on.
#[derive(Debug)]
pub(crate) struct Worn {
    pub hair: Hair,
    /// Its shadow falls on the hair.
    pub body: Option<Body>,
    /// What bends that, and the hair with it.
    pub living: Option<Living>,
    /// Its colliders besides those of its body, and their entities.
    pub colliders: Vec<(Entity, Collider)>,
    /// Whether the last frame moved it.
    pub moves: bool,
    made_for: Made,
}

/// Hair, what it grows on, and what bends that.
type Dressed = (Hair, Option<Body>, Option<Living>);

/// What hair was made for.
#[derive(Clone, Debug)]
struct Made {
    groom: HairGroom,
    /// Those of the rest shape.
    physics: SimulationParams,
    /// What levels of detail are measured for.
    detail: LodOptions,
    /// Those of the colliders that it can have.
    fields: Vec<Arc<SdfGrid>>,
    /// What it is on.
    skin: Option<Arc<Skin>>,
}

/// What an entity's hair is to be made of: its groom, colliders' fields, skin.
type Wanted<'a> = (&'a HairGroom, &'a [Arc<SdfGrid>], Option<&'a Arc<Skin>>);

impl Made {
    fn is(&self, (groom, fields, skin): Wanted<'_>) -> bool {
        let same = |(a, b): (&Arc<SdfGrid>, _)| Arc::ptr_eq(a, b);
        self.groom.is(groom)
            && self.fields.len() == fields.len()
            && self.fields.iter().zip(fields).all(same)
            && self.skin.as_ref().map(Arc::as_ptr) == skin.map(Arc::as_ptr)
    }
}

/// An entity's hair.
#[derive(Debug, Default)]
struct Place {
    worn: Option<Worn>,
    /// What is being made, for whom.
    coming: Option<(Made, Task<Result<Dressed>>)>,
    /// What could not be made.
    failed: Option<Made>,
}

/// All hair that there is.
#[derive(Resource, Default)]
pub(crate) struct Wardrobe {
    pipelines: Option<Arc<Pipelines>>,
    places: EntityHashMap<Place>,
    complaints: Complaints,
}

impl Wardrobe {
    /// The hair of an entity, if it is there.
    pub fn worn(&self, entity: Entity) -> Option<&Worn> {
        self.places.get(&entity)?.worn.as_ref()
    }

    /// Hair that meets, by `entities`, in the order of these.
    pub fn meeting(&mut self, entities: &[Entity]) -> Vec<&mut Hair> {
        let mut hair = Vec::with_capacity(entities.len());
        for (entity, place) in &mut self.places {
            if let Some(at) = entities.iter().position(|other| other == entity) {
                hair.extend(place.worn.as_mut().map(|worn| (at, &mut worn.hair)));
            }
        }
        hair.sort_by_key(|(at, _)| *at);
        hair.into_iter().map(|(_, hair)| hair).collect()
    }

    /// The same to be changed.
    pub fn worn_mut(&mut self, entity: Entity) -> Option<&mut Worn> {
        self.places.get_mut(&entity)?.worn.as_mut()
    }

    /// The pipelines, once there was hair.
    pub fn pipelines(&self) -> Option<Arc<Pipelines>> {
        self.pipelines.clone()
    }
}

/// Begins to make hair that has come, takes what is ready, forgets what has gone.
pub(crate) fn prepare(
    scene: Res<Scene>,
    mut wardrobe: ResMut<Wardrobe>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    if scene.hair.is_empty() {
        wardrobe.places.clear();
        return;
    }
    let Wardrobe { pipelines, places, complaints } = &mut *wardrobe;
    let pipelines = pipelines.get_or_insert_with(|| Arc::new(Pipelines::new(device.wgpu_device())));
    places.retain(|entity, _| scene.hair.iter().any(|hair| hair.entity == *entity));
    for hair in &scene.hair {
        let Some(groom) = hair.groom.as_ref().filter(|_| !matches!(hair.skin, OnSkin::Awaited)) else {
            hair.ready.store(false, Ordering::Relaxed);
            continue;
        };
        let wanted = (groom, &scene.fields[..], hair.skin.skin());
        let place = places.entry(hair.entity).or_default();
        place.take(complaints);
        if !place.has(wanted) {
            let made = Made {
                groom: groom.clone(),
                physics: hair.physics,
                detail: hair.detail,
                fields: scene.fields.clone(),
                skin: hair.skin.skin().cloned(),
            };
            let gpu = (device.wgpu_device(), &**queue, &*pipelines);
            // Heads with the same groom share what does not change.
            if let Some(result) = twin(places, &made, gpu) {
                places.entry(hair.entity).or_default().arrive(made, result, complaints);
            } else if !places.values().any(|place| place.awaits(&made)) {
                let task = make(&made, gpu);
                places.entry(hair.entity).or_default().coming = Some((made, task));
            }
        }
        let worn = places.get(&hair.entity).and_then(|place| place.worn.as_ref());
        hair.ready.store(worn.is_some_and(|worn| worn.made_for.is(wanted)), Ordering::Relaxed);
    }
}

pub(super) type Gpu<'a> = (&'a wgpu::Device, &'a wgpu::Queue, &'a Arc<Pipelines>);

/// Hair for `made` from hair that is worn already, if there is such.
fn twin(
    places: &EntityHashMap<Place>,
    made: &Made,
    (device, queue, pipelines): Gpu<'_>,
) -> Option<Result<Dressed>> {
    let worn =
        places.values().filter_map(|place| place.worn.as_ref()).find(|worn| worn.made_for.is_twin(made))?;
    let hair = worn.hair.another(device, queue, pipelines, &[]);
    Some(hair.map(|hair| (hair, worn.body.as_ref().map(|body| body.another(device)), None)))
}

impl Worn {
    /// The colliders of the scene that it can have. While another field is on its way into hair that is being made, this
    /// hair goes on without that.
    pub fn pushed_by(&self, scene: &Scene) -> Vec<(Entity, Collider, Pose)> {
        let known = |(entity, collider, pose): &(Entity, HairCollider, Pose)| {
            Some((*entity, collider.collider(&self.made_for.fields)?, *pose))
        };
        scene.colliders.iter().filter_map(known).take(self.room()).collect()
    }

    /// How many of the scene's colliders there is room for, besides the head and the other parts of a body.
    pub fn room(&self) -> usize {
        let own = self.living.as_ref().map_or(0, |living| living.colliders().len());
        (MAX_COLLIDERS as usize).saturating_sub(1 + own)
    }
}

impl Made {
    /// Whether hair for one is hair for the other: not where each has a skin of its own.
    fn is_twin(&self, other: &Self) -> bool {
        let wanted = (&other.groom, &other.fields[..], None);
        other.skin.is_none() && self.is(wanted) && rest(&self.physics) == rest(&other.physics)
    }
}

/// What of the physics the shape at rest follows from: all but the wind.
fn rest(physics: &SimulationParams) -> SimulationParams {
    SimulationParams { wind: Default::default(), ..*physics }
}

impl Place {
    /// Whether this groom is worn, coming or known to be impossible.
    fn has(&self, wanted: Wanted<'_>) -> bool {
        let is = |made: &Made| made.is(wanted);
        match &self.coming {
            Some((coming, _)) => is(coming),
            None => {
                self.worn.as_ref().is_some_and(|worn| is(&worn.made_for))
                    || self.failed.as_ref().is_some_and(is)
            }
        }
    }

    /// Whether hair that can be shared with `made` is coming.
    fn awaits(&self, made: &Made) -> bool {
        self.coming.as_ref().is_some_and(|(coming, _)| coming.is_twin(made))
    }

    /// Takes what is ready.
    fn take(&mut self, complaints: &mut Complaints) {
        if let Some(result) = self.coming.as_mut().and_then(|(_, task)| check_ready(task))
            && let Some((made, _)) = self.coming.take()
        {
            self.arrive(made, result, complaints);
        }
    }

    fn arrive(&mut self, made: Made, result: Result<Dressed>, complaints: &mut Complaints) {
        self.failed = None;
        match result {
            Ok((hair, body, living)) => {
                self.worn =
                    Some(Worn { hair, body, living, colliders: Vec::new(), moves: false, made_for: made });
            }
            Err(error) => {
                complaints.say(format!("hair cannot be made: {error}"));
                self.worn = None;
                self.failed = Some(made);
            }
        }
    }
}

/// Makes hair, on a task: to measure its level of detail takes a while.
fn make(made: &Made, (device, queue, pipelines): Gpu<'_>) -> Task<Result<Dressed>> {
    let (device, queue, pipelines) = (device.clone(), queue.clone(), pipelines.clone());
    let Made { groom, physics, detail, fields, skin } = made.clone();
    AsyncComputeTaskPool::get().spawn(async move {
        let options = HairOptions { simulation: physics, lod: detail, ..groom.options };
        let mut fields: Vec<_> = fields.iter().map(|field| FieldSource::Grid(field)).collect();
        let plan = skin.map(|skin| Plan::new(skin, &groom.groom)).transpose()?;
        let mut colliders = ColliderDescriptor { head: groom.head.as_deref(), ..Default::default() };
        if let Some(plan) = &plan {
            fields.extend(plan.fields.iter().map(FieldSource::Grid));
            colliders.head = Some(&plan.head);
        }
        colliders.fields = &fields;
        let mut hair =
            Hair::with_progress(&device, &queue, &pipelines, &groom.groom, &options, &colliders, &()).await?;
        if !groom.ties.is_empty() {
            hair.tie(&device, &queue, &pipelines, &groom.groom, &groom.ties)?;
        }
        let of_scene = fields.len() - plan.as_ref().map_or(0, |plan| plan.fields.len());
        let (body, living) = match plan {
            Some(plan) => {
                let (body, living) =
                    plan.attach((&device, &queue, &pipelines), &mut hair, &groom.groom, of_scene)?;
                (Some(body), Some(living))
            }
            None => (groom.mesh.as_ref().map(|mesh| Body::new(&device, mesh)), None),
        };
        Ok((hair, body, living))
    })
}

/// Hair of the scene that is worn and seen by those who see `layers`, in the scene's order.
pub(crate) fn seen<'a>(
    scene: &'a Scene,
    wardrobe: &'a Wardrobe,
    layers: &'a bevy::camera::visibility::RenderLayers,
) -> impl Iterator<Item = (&'a SceneHair, &'a Worn)> {
    let shown = scene.hair.iter().filter(move |hair| hair.visible && hair.layers.intersects(layers));
    shown
        .filter_map(move |hair| wardrobe.worn(hair.entity).filter(|worn| worn.moves).map(|worn| (hair, worn)))
}
