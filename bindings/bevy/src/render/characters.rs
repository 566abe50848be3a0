//! Grooms become characters on the GPU.

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
    Character, Context, HairOptions, Result,
    character::{CharacterOptions, CharacterParts, Obstacle},
    collide::FieldSource,
    constants::MAX_COLLIDERS,
    groom::SdfGrid,
    lod::LodOptions,
    simulate::SimulationParams,
};

/// The hair of an entity on the GPU.
#[derive(Debug)]
pub(crate) struct HairModel {
    pub character: Character,
    /// Whether the last frame moved it; otherwise it is not drawn.
    pub is_shown: bool,
    /// Whether its pose has been set.
    is_placed: bool,
    recipe: Recipe,
}

impl HairModel {
    /// Places it where `hair` is. Hair on a skin stays where it was while that skin is gone or replaced by another one.
    /// Returns whether its place is known.
    pub fn place(&mut self, hair: &SceneHair) -> bool {
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

    /// The colliders of the scene that it has room for. A field that the character was not made with is left out until
    /// the next character comes.
    pub fn obstacles(&self, scene: &Scene) -> Vec<Obstacle> {
        let all = scene.colliders.iter().filter_map(|(entity, collider, pose)| {
            let collider = collider.collider(&self.recipe.fields)?;
            Some(Obstacle { id: entity.to_bits(), collider, pose: *pose })
        });
        all.take(self.room()).collect()
    }

    /// The most colliders besides the head and the other parts of the body.
    pub fn room(&self) -> usize {
        let own = self.character.rig().map_or(0, |rig| rig.anatomy().solids().count());
        (MAX_COLLIDERS as usize).saturating_sub(1 + own)
    }
}

/// What a character is made from.
#[derive(Clone, Debug)]
struct Recipe {
    groom: HairGroom,
    /// The rest shape follows from it.
    physics: SimulationParams,
    /// The levels of detail are measured for it.
    detail: LodOptions,
    /// The fields of the scene's colliders.
    fields: Vec<Arc<SdfGrid>>,
    skin: Option<Arc<Skin>>,
}

impl Recipe {
    /// Whether a character of the `other` recipe need not be made anew for this one. Later physics bend the hair, later
    /// details choose among its levels.
    fn is(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<SdfGrid>, _)| Arc::ptr_eq(a, b);
        self.groom.is(&other.groom)
            && self.fields.len() == other.fields.len()
            && self.fields.iter().zip(&other.fields).all(same)
            && self.skin.as_ref().map(Arc::as_ptr) == other.skin.as_ref().map(Arc::as_ptr)
    }

    /// Whether an instance of a character of one is a character of the other. Each skin has a character of its own.
    fn is_shared(&self, other: &Self) -> bool {
        // Wind has no part in the rest shape.
        let rest = |physics: &SimulationParams| SimulationParams { wind: Default::default(), ..*physics };
        self.skin.is_none() && self.is(other) && rest(&self.physics) == rest(&other.physics)
    }

    /// Makes the character, on a task: measuring its levels of detail takes a while.
    fn make(self, context: Context) -> Task<Result<Character>> {
        AsyncComputeTaskPool::get().spawn(async move {
            let Self { groom, physics, detail, fields, skin } = self;
            let strands = (*groom.groom).clone();
            let mut parts = match &skin {
                Some(skin) => CharacterParts::new(strands, Some(skin.mesh.clone()), Some(skin.rig.clone()))?,
                None => CharacterParts {
                    head: groom.mesh.as_deref().cloned(),
                    field: groom.head.as_deref().cloned(),
                    ..CharacterParts::bare(strands)
                },
            };
            parts.ties = groom.ties;
            let fields: Vec<_> = fields.iter().map(|field| FieldSource::Grid(field)).collect();
            let options = CharacterOptions {
                hair: HairOptions { simulation: physics, lod: detail, ..groom.options },
                fields: &fields,
                root_reach: skin.as_ref().map_or(0.0, |skin| skin.reach),
                ..Default::default()
            };
            let mut character = Character::new(&context, parts, &options, &()).await?;
            // Hair and brows on one skin cast its shadow once.
            character.body_id = skin.map(|skin| skin.entity.to_bits());
            Ok(character)
        })
    }
}

/// The hair of an entity: on the GPU, on its way there, or impossible.
#[derive(Debug, Default)]
struct Slot {
    model: Option<HairModel>,
    pending: Option<(Recipe, Task<Result<Character>>)>,
    failed: Option<Recipe>,
}

impl Slot {
    /// Whether there is no need to make a character for `recipe`.
    fn has(&self, recipe: &Recipe) -> bool {
        match &self.pending {
            Some((pending, _)) => pending.is(recipe),
            None => self.shows(recipe) || self.failed.as_ref().is_some_and(|failed| failed.is(recipe)),
        }
    }

    /// Whether its hair is of `recipe`.
    fn shows(&self, recipe: &Recipe) -> bool {
        self.model.as_ref().is_some_and(|model| model.recipe.is(recipe))
    }

    /// Takes a character that is ready.
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
                errors.report(format!("hair cannot be made: {error}"));
                Self { failed: Some(recipe), ..Self::default() }
            }
        };
    }
}

/// The hair of all entities.
#[derive(Resource, Debug, Default)]
pub(crate) struct Wardrobe {
    slots: EntityHashMap<Slot>,
    errors: ErrorLog,
}

impl Wardrobe {
    /// The hair of an entity, if it is on the GPU.
    pub fn get_mut(&mut self, entity: Entity) -> Option<&mut HairModel> {
        self.slots.get_mut(&entity)?.model.as_mut()
    }

    /// The characters that `layers` show, in the scene's order.
    pub fn seen<'a>(
        &'a self,
        scene: &'a Scene,
        layers: &'a RenderLayers,
    ) -> impl Iterator<Item = &'a Character> {
        let shown = scene.hair.iter().filter(|hair| hair.layers.intersects(layers));
        let model = |hair: &SceneHair| self.slots.get(&hair.entity)?.model.as_ref();
        shown.filter_map(model).filter(|model| model.is_shown).map(|model| &model.character)
    }

    /// The characters that [meet](crate::HairMeets) in this frame, in the scene's order.
    pub fn meeting(&mut self, scene: &Scene) -> Vec<&mut Character> {
        let place = |entity| scene.hair.iter().position(|hair| hair.meets && hair.entity == entity);
        let found = self.slots.iter_mut().filter_map(|(entity, slot)| {
            let model = slot.model.as_mut().filter(|model| model.is_shown)?;
            Some((place(*entity)?, &mut model.character))
        });
        let mut found: Vec<_> = found.collect();
        found.sort_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, character)| character).collect()
    }
}

/// Makes characters for hair that has come, takes those that are ready, drops those whose entity is gone.
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
