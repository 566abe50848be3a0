//! The data that all instances of a character share.

use super::{background::BackgroundTask, facial, obstacles::Obstacles, rigged::RigAsset};
use crate::{
    Context, Error, Progress, Result,
    body::Body,
    camera::{Bounds, subject},
    collide::{Collider, ColliderDescriptor, FieldBuilder, FieldSource},
    groom::{
        Look, SdfGrid,
        character::CharacterParts,
        light::{PunctualLight, PunctualShape},
        rig::anatomy::{DistanceFieldSource, PartForm},
    },
    hair::{HairAsset, HairDescriptor, HairOptions},
    light::{Light, LightShape, Sphere},
    lod::LodOptions,
    roots::RootAsset,
    simulate::SimulationParams,
    volume::VolumeOptions,
};
use glam::Vec3;
use std::sync::Arc;

/// Maximum distance of a face groom's roots from the skin, meters.
pub(super) const MAX_FACE_ROOT_DISTANCE: f32 = 0.01;
/// Radius of the sphere covered by shadow maps, relative to the hair at rest. Keeps moving hair inside.
const SWING: f32 = 1.15;

/// Options for uploading a character.
///
/// ```
/// use tresses::{CharacterOptions, LodOptions};
///
/// let options = CharacterOptions::default().with_lod(LodOptions::CROWD).with_max_root_distance(0.01);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CharacterOptions<'a> {
    /// Options of the hair. Face grooms use its physics and level of detail.
    pub hair: HairOptions,
    /// Colliders besides the body; [`Character::set_obstacle_poses`](super::Character::set_obstacle_poses) moves them.
    pub obstacles: &'a [Collider],
    /// Distance fields that colliders refer to by [`FieldId`](crate::collide::FieldId).
    pub fields: &'a [FieldSource<'a>],
    /// Maximum resolution of the grid of ambient light that the body is drawn with, cells per edge
    /// ([`ViewOptions::ambient_resolution`](crate::view::ViewOptions::ambient_resolution)).
    pub ambient_resolution: u32,
    /// Maximum distance of a root of the hair from a skinned mesh, meters. Grooms made for another head may be
    /// centimeters off.
    pub max_root_distance: f32,
}

impl Default for CharacterOptions<'_> {
    fn default() -> Self {
        Self {
            hair: HairOptions::default(),
            obstacles: &[],
            fields: &[],
            ambient_resolution: u32::MAX,
            max_root_distance: 0.2,
        }
    }
}

impl<'a> CharacterOptions<'a> {
    /// Sets all options of the hair.
    #[must_use]
    pub fn with_hair(self, hair: HairOptions) -> Self {
        Self { hair, ..self }
    }

    /// Sets the physics of the hair.
    #[must_use]
    pub fn with_simulation(mut self, simulation: SimulationParams) -> Self {
        self.hair.simulation = simulation;
        self
    }

    /// Sets the level of detail of the hair.
    #[must_use]
    pub fn with_lod(mut self, lod: LodOptions) -> Self {
        self.hair.lod = lod;
        self
    }

    /// Sets the [`obstacles`](Self::obstacles) and the distance fields that they refer to.
    #[must_use]
    pub fn with_obstacles(self, obstacles: &'a [Collider], fields: &'a [FieldSource<'a>]) -> Self {
        Self { obstacles, fields, ..self }
    }

    /// Sets the [resolution of ambient light](Self::ambient_resolution).
    #[must_use]
    pub fn with_ambient_cells(self, ambient_cells: u32) -> Self {
        Self { ambient_resolution: ambient_cells, ..self }
    }

    /// Sets the [maximum distance of roots](Self::max_root_distance), meters.
    #[must_use]
    pub fn with_max_root_distance(self, max_root_distance: f32) -> Self {
        Self { max_root_distance, ..self }
    }
}

/// A groom of a character.
#[derive(Debug)]
pub(super) struct GroomAsset {
    pub hair: Arc<HairAsset>,
    /// Roots on the skin of the body, if it deforms.
    pub roots: Option<RootAsset>,
    /// Whether it collides with the body and moves in the wind.
    pub hangs: bool,
}

/// A character on the GPU: everything that its instances share and that never moves.
#[derive(Debug)]
pub struct CharacterAsset {
    pub(super) hair: GroomAsset,
    /// Brows, lashes and beard.
    pub(super) face: Vec<GroomAsset>,
    /// The body at rest.
    pub(super) body: Option<Body>,
    pub(super) rig: Option<Arc<RigAsset>>,
    pub(super) physics: SimulationParams,
    pub(super) obstacles: Obstacles,
    pub(super) field: Option<SdfGrid>,
    pub(super) look: Option<Look>,
    /// [`CharacterAsset::lights`].
    lights: Vec<Light>,
    pub(super) neck: Vec3,
    pub(super) subject: Bounds,
    pub(super) focus: Sphere,
}

impl CharacterAsset {
    /// Uploads a character.
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it; [`Error::Groom`], [`Error::Parameter`] and
    /// [`Error::Colliders`] when parts or options are invalid.
    pub async fn new(
        context: &Context,
        mut parts: CharacterParts,
        options: &CharacterOptions<'_>,
        progress: &impl Progress,
    ) -> Result<Arc<Self>> {
        let hair_bounds = parts.groom.bounds().ok_or_else(|| Error::unusable("the groom is empty"))?;
        let head = parts.head.take().map(Arc::new);
        let head_bounds = head.as_ref().and_then(|head| head.bounds());
        // Collapsing edges takes as long as everything else for a small character, so it runs on its own thread.
        let known = parts.levels_of_head.take();
        let levels =
            head.clone().map(|head| BackgroundTask::start(move || known.unwrap_or_else(|| head.levels())));
        if let Some(anatomy) = &mut parts.anatomy
            && context.tier().software
            && !cfg!(target_arch = "wasm32")
        {
            // A software driver is many times slower at building fields than CPU threads.
            anatomy.measure();
        }
        let anatomy = parts.anatomy.take().map(Arc::new);
        let obstacles = Obstacles::new(options.obstacles, anatomy.as_deref(), options.fields.len());
        let builder = FieldBuilder::new(context);
        let solids = anatomy.iter().flat_map(|anatomy| anatomy.solids());
        let part_fields = solids.filter(|part| part.form == PartForm::Field).map(|part| match &part.field {
            DistanceFieldSource::Mesh(mesh, options) => {
                FieldSource::Mesh { builder: &builder, mesh, options }
            }
            DistanceFieldSource::Grid(grid) => FieldSource::Grid(grid),
        });
        let fields: Vec<_> = options.fields.iter().copied().chain(part_fields).collect();
        let colliders = ColliderDescriptor {
            head: parts.field.as_ref(),
            rest: parts.rest.as_ref(),
            fields: &fields,
            colliders: &obstacles.list,
        };
        let what = HairDescriptor {
            options: options.hair,
            colliders,
            cards: parts.cards.as_deref(),
            levels: &parts.levels,
            skull: parts.skull(),
            ties: &parts.ties,
        };
        let hair = HairAsset::with_progress(context, parts.groom, &what, progress).await?;
        let levels = levels.map(BackgroundTask::get).unwrap_or_default();
        let mut body = None;
        let (mut face, mut rig, mut roots) = (Vec::new(), None, None);
        if let Some(head) = head {
            let mut drawn = Body::with_levels(context, &head, &levels, options.ambient_resolution);
            if let Some(paint) = &head.paint {
                drawn.paint(paint)?;
            }
            for groom in parts.face {
                let hangs = groom.hangs;
                // A groom that lies on the skin reads its grid only with wind, which it does not have.
                let volume = match hangs {
                    true => VolumeOptions::default(),
                    false => VolumeOptions { resolution: 8, ..Default::default() },
                };
                let simulation = facial::physics(&options.hair.simulation, hangs);
                let rest = facial::rest(&options.hair.rest);
                let what = HairDescriptor {
                    options: HairOptions { simulation, rest, volume, ..Default::default() },
                    colliders: if hangs { colliders } else { ColliderDescriptor::default() },
                    ..Default::default()
                };
                let hair = HairAsset::with_progress(context, groom.groom, &what, progress).await?;
                let roots =
                    anatomy.is_some().then(|| hair.bind_roots(&head, MAX_FACE_ROOT_DISTANCE)).transpose()?;
                face.push(GroomAsset { hair, roots, hangs });
            }
            if let Some(anatomy) = anatomy {
                if !anatomy.is_rigid {
                    roots = Some(hair.bind_roots(&head, options.max_root_distance)?);
                }
                rig = Some(Arc::new(RigAsset::new(context, anatomy, head, &drawn)?));
            }
            body = Some(drawn);
        }
        let subject = subject(hair_bounds, head_bounds);
        let lights = (0..).zip(&parts.lights).map(|(id, light)| Light::from(light).with_id(id)).collect();
        let mut focus = Sphere::around(subject.0, subject.1);
        focus.radius *= SWING;
        Ok(Arc::new(Self {
            hair: GroomAsset { hair, roots, hangs: true },
            face,
            body,
            rig,
            physics: options.hair.simulation,
            obstacles,
            field: parts.field,
            look: parts.look,
            lights,
            neck: parts.neck,
            subject,
            focus,
        }))
    }

    /// Returns the lights that the character's files brought, in their order, which is also their
    /// [`id`](Light::id). Their space is the character's own, at rest: meters, Y up, face towards +Z. The library does
    /// not use them; add them to [`Lights::list`](crate::light::Lights::list).
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }
}

impl From<&PunctualLight> for Light {
    fn from(light: &PunctualLight) -> Self {
        let shape = match light.shape {
            PunctualShape::Directional { direction } => LightShape::Distant { direction: -direction },
            PunctualShape::Point { position } => LightShape::Point { position },
            PunctualShape::Spot { position, direction, inner, outer } => {
                LightShape::Spot { position, direction, inner, outer }
            }
        };
        Self { color: light.color, range: light.range, ..Self::new(shape, light.intensity) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_of_files_shine_as_stated() {
        let light = |shape| PunctualLight {
            name: String::new(),
            shape,
            color: Vec3::new(1.0, 0.5, 0.25),
            intensity: 8.0,
            range: 100.0,
        };
        let (position, direction) = (Vec3::Y * 2.0, Vec3::NEG_Y);
        let shapes = [
            (PunctualShape::Directional { direction }, 8.0),
            (PunctualShape::Point { position }, 2.0),
            (PunctualShape::Spot { position, direction, inner: 0.2, outer: 0.4 }, 2.0),
        ];
        for (shape, expected) in shapes {
            let converted = Light::from(&light(shape));
            converted.check().unwrap();
            let (towards, irradiance) = converted.irradiance_at(Vec3::ZERO);
            assert_eq!(towards, Vec3::Y);
            let expected = expected * Vec3::new(1.0, 0.5, 0.25);
            assert!(irradiance.abs_diff_eq(expected, 1e-5), "{shape:?}: {irradiance}");
            assert_eq!(converted.range, 100.0);
        }
    }
}
