//! Builds characters on the GPU from grooms.

use super::HairContext;
use crate::{
    HairGroom,
    error_log::ErrorLog,
    extract::{Scene, SceneHair},
    skin::{Skin, SkinState},
};
use bevy::{
    camera::visibility::RenderLayers,
    ecs::entity::EntityHashMap,
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, futures::check_ready},
};
use std::sync::{Arc, atomic::Ordering};
use tresses::{
    Character, CharacterAsset, CharacterOptions, CharacterParts, Context, LodOptions, Obstacle, Result,
    SimulationParams, collide::FieldSource, groom::SdfGrid, low_level::constants::MAX_COLLIDERS,
};

/// Hair of an entity on the GPU.
#[derive(Debug)]
pub(crate) struct HairModel {
    pub character: Character,
    /// Whether the last frame simulated it. If not, it is not drawn.
    pub is_shown: bool,
    /// Whether its pose has been set.
    is_placed: bool,
    recipe: Recipe,
}

impl HairModel {
    /// Sets the pose from `hair`. Hair on a skin keeps its last pose while that skin is missing or being replaced.
    /// Returns whether a pose is known.
    pub fn set_pose(&mut self, hair: &SceneHair) -> bool {
        match (&self.recipe.skin, &hair.skin) {
            (None, _) => self.character.set_pose(hair.pose),
            (Some(own), SkinState::Loaded(skin, joints)) if Arc::ptr_eq(own, skin) => {
                if let Some(rig) = self.character.rig_mut() {
                    let (head, pose) = skin.pose(rig.anatomy(), joints);
                    rig.set_pose(Some(pose));
                    self.character.set_pose(head);
                }
            }
            _ => return self.is_placed,
        }
        self.is_placed = true;
        true
    }

    /// Returns the colliders of the scene, as many as fit. Omits fields that the character was not built with, until
    /// the next character is ready.
    pub fn obstacles(&self, scene: &Scene) -> Vec<Obstacle> {
        let all = scene.colliders.iter().filter_map(|(entity, collider, pose)| {
            let collider = collider.collider(&self.recipe.fields)?;
            Some(Obstacle { id: entity.to_bits(), collider, pose: *pose })
        });
        all.take(self.max_colliders()).collect()
    }

    /// Returns the largest number of colliders besides the head and the other parts of the body.
    pub fn max_colliders(&self) -> usize {
        let own = self.character.rig().map_or(0, |rig| rig.anatomy().solids().count());
        (MAX_COLLIDERS as usize).saturating_sub(1 + own)
    }
}

/// Inputs of a character.
#[derive(Clone, Debug)]
struct Recipe {
    groom: HairGroom,
    /// Determines the rest shape.
    physics: SimulationParams,
    /// The levels of detail are measured for these options.
    detail: LodOptions,
    /// Distance fields of the scene's colliders.
    fields: Vec<Arc<SdfGrid>>,
    skin: Option<Arc<Skin>>,
}

impl Recipe {
    /// Whether a character of the `other` recipe can be used for this one. Different physics deform the hair, and
    /// different detail options choose among its levels, so neither needs a new character.
    fn is(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<SdfGrid>, _)| Arc::ptr_eq(a, b);
        self.groom.is(&other.groom)
            && self.fields.len() == other.fields.len()
            && self.fields.iter().zip(&other.fields).all(same)
            && self.skin.as_ref().map(Arc::as_ptr) == other.skin.as_ref().map(Arc::as_ptr)
    }

    /// Whether both can share a character as instances. Each skin needs its own character.
    fn is_shared(&self, other: &Self) -> bool {
        // Wind does not affect the rest shape.
        let rest = |physics: &SimulationParams| SimulationParams { wind: Default::default(), ..*physics };
        self.skin.is_none() && self.is(other) && rest(&self.physics) == rest(&other.physics)
    }

    /// Builds the character on a task, because measuring its levels of detail takes a while.
    fn make(self, context: Context) -> Task<Result<Character>> {
        AsyncComputeTaskPool::get().spawn(async move {
            let Self { groom, physics, detail, fields, skin } = self;
            let strands = (*groom.groom).clone();
            let mut parts = match &skin {
                Some(skin) => CharacterParts::new(strands, Some(skin.mesh.clone()), Some(skin.rig.clone()))?,
                None => CharacterParts {
                    head: groom.mesh.as_deref().cloned(),
                    field: groom.head.as_deref().cloned(),
                    ..CharacterParts::without_body(strands)
                },
            };
            parts.ties = groom.ties;
            parts.cards = groom.cards;
            let fields: Vec<_> = fields.iter().map(|field| FieldSource::Grid(field)).collect();
            let options = CharacterOptions::default()
                .with_hair(groom.options)
                .with_simulation(physics)
                .with_lod(detail)
                .with_obstacles(&[], &fields)
                .with_max_root_distance(skin.as_ref().map_or(0.0, |skin| skin.max_root_distance));
            let mut character = Character::new(&CharacterAsset::new(&context, parts, &options, &()).await?)?;
            character.prepare_to_bend()?;
            // Hair and brows on one skin cast the skin's shadow only once.
            character.body_id = skin.map(|skin| skin.entity.to_bits());
            Ok(character)
        })
    }
}

/// State of an entity's hair: ready, being built, or failed.
#[derive(Debug, Default)]
struct Slot {
    model: Option<HairModel>,
    pending: Option<(Recipe, Task<Result<Character>>)>,
    failed: Option<Recipe>,
}

impl Slot {
    /// Whether `recipe` is ready, being built, or has failed.
    fn has(&self, recipe: &Recipe) -> bool {
        match &self.pending {
            Some((pending, _)) => pending.is(recipe),
            None => self.shows(recipe) || self.failed.as_ref().is_some_and(|failed| failed.is(recipe)),
        }
    }

    /// Whether the current hair matches `recipe`.
    fn shows(&self, recipe: &Recipe) -> bool {
        self.model.as_ref().is_some_and(|model| model.recipe.is(recipe))
    }

    /// Takes a finished character.
    fn poll(&mut self, errors: &mut ErrorLog) {
        if let Some(result) = self.pending.as_mut().and_then(|(_, task)| check_ready(task))
            && let Some((recipe, _)) = self.pending.take()
        {
            self.finish(recipe, result, errors);
        }
    }

    fn finish(&mut self, recipe: Recipe, result: Result<Character>, errors: &mut ErrorLog) {
        *self = match result {
            Ok(character) => {
                let model = HairModel { character, is_shown: false, is_placed: false, recipe };
                Self { model: Some(model), ..Self::default() }
            }
            Err(error) => {
                errors.report(format!("cannot create hair: {error}"));
                Self { failed: Some(recipe), ..Self::default() }
            }
        };
    }
}

/// Hair of all entities.
#[derive(Resource, Debug, Default)]
pub(crate) struct Wardrobe {
    slots: EntityHashMap<Slot>,
    errors: ErrorLog,
}

impl Wardrobe {
    /// Returns the hair of an entity, if it is on the GPU.
    pub fn get_mut(&mut self, entity: Entity) -> Option<&mut HairModel> {
        self.slots.get_mut(&entity)?.model.as_mut()
    }

    /// Returns the characters visible in `layers`, in the scene's order.
    pub fn visible<'a>(
        &'a self,
        scene: &'a Scene,
        layers: &'a RenderLayers,
    ) -> impl Iterator<Item = &'a Character> {
        let shown = scene.hair.iter().filter(|hair| hair.layers.intersects(layers));
        let model = |hair: &SceneHair| self.slots.get(&hair.entity)?.model.as_ref();
        shown.filter_map(model).filter(|model| model.is_shown).map(|model| &model.character)
    }

    /// Returns the characters with [`HairHairCollision`](crate::HairHairCollision) in this frame, in the scene's order.
    pub fn colliding(&mut self, scene: &Scene) -> Vec<&mut Character> {
        let index =
            |entity| scene.hair.iter().position(|hair| hair.collides_with_hair && hair.entity == entity);
        let found = self.slots.iter_mut().filter_map(|(entity, slot)| {
            let model = slot.model.as_mut().filter(|model| model.is_shown)?;
            Some((index(*entity)?, &mut model.character))
        });
        let mut found: Vec<_> = found.collect();
        found.sort_by_key(|(index, _)| *index);
        found.into_iter().map(|(_, character)| character).collect()
    }
}

/// Starts building characters for new hair, takes finished ones, and drops the hair of removed entities.
pub(crate) fn prepare(scene: Res<Scene>, mut wardrobe: ResMut<Wardrobe>, context: Res<HairContext>) {
    let Wardrobe { slots, errors } = &mut *wardrobe;
    slots.retain(|entity, _| scene.hair.iter().any(|hair| hair.entity == *entity));
    for hair in &scene.hair {
        let Some(groom) = hair.groom.clone().filter(|_| !matches!(hair.skin, SkinState::Awaited)) else {
            hair.ready.store(false, Ordering::Relaxed);
            continue;
        };
        let SceneHair { physics, detail, .. } = *hair;
        let recipe =
            Recipe { groom, physics, detail, fields: scene.fields.clone(), skin: hair.skin.skin().cloned() };
        let slot = slots.entry(hair.entity).or_default();
        slot.poll(errors);
        if !slot.has(&recipe) {
            let models = || slots.values().filter_map(|slot| slot.model.as_ref());
            let pending = || slots.values().filter_map(|slot| slot.pending.as_ref());
            if let Some(model) = models().find(|model| model.recipe.is_shared(&recipe)) {
                let instance = model.character.instance();
                slots.entry(hair.entity).or_default().finish(recipe.clone(), instance, errors);
            } else if !pending().any(|(pending, _)| pending.is_shared(&recipe)) {
                let task = recipe.clone().make((*context).clone());
                slots.entry(hair.entity).or_default().pending = Some((recipe.clone(), task));
            }
        }
        let is_ready = slots.get(&hair.entity).is_some_and(|slot| slot.shows(&recipe));
        hair.ready.store(is_ready, Ordering::Relaxed);
    }
}
