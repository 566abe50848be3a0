//! Real-time hair for Bevy.
//!
//! A groom is an [asset](HairGroom), loaded from a file or grown on the built-in character. An entity with [`Hair3d`]
//! has hair that follows its [`GlobalTransform`](bevy::prelude::GlobalTransform), usually as a child of a head. Hair is
//! simulated once per frame with Bevy's [`Time`](bevy::prelude::Time). It is drawn into every 3D camera after Bevy's
//! main pass and before tone mapping, occluded by the scene's depth and lit by the scene's lights.
//!
//! ```no_run
//! use bevy::{prelude::*, render::renderer::{RenderDevice, RenderQueue}};
//! use bevy_tresses::{Hair3d, HairGroom, TressesPlugin, groom::styles::Style};
//!
//! fn dress(
//!     mut commands: Commands,
//!     mut grooms: ResMut<Assets<HairGroom>>,
//!     (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
//! ) -> Result {
//!     let groom = HairGroom::character(&device, &queue, &Style::Bob(Default::default()), Some(8_000))?;
//!     commands.spawn((Hair3d(grooms.add(groom)), Transform::from_xyz(0.0, 1.0, 0.0)));
//!     commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 1.0, 1.0)));
//!     commands.spawn(DirectionalLight::default());
//!     Ok(())
//! }
//! # let _ = |app: &mut App| { app.add_plugins(TressesPlugin::default()).add_systems(Startup, dress); };
//! ```
//!
//! Units are Bevy's: meters, Y up, right-handed. A groom's face points to +Z, so a character that faces Bevy's
//! forward direction (-Z) needs a rotation of 180° about Y.

mod components;
mod error_log;
mod extract;
mod groom_asset;
mod lights;
mod loader;
mod meshes;
mod plugin;
mod render;
mod skin;

pub use components::{
    ColliderShape, GlobalHairWind, Hair3d, HairCollider, HairDepth, HairDetail, HairHairCollision,
    HairMaterial3d, HairPhysics, HairReady, HairSupport, HairView, HairWind, NoHair,
};
pub use groom_asset::HairGroom;
pub use loader::{HairGroomLoader, HairGroomSettings};
pub use meshes::{skinned_mesh, tri_mesh};
pub use plugin::TressesPlugin;
pub use skin::HairSkin;
pub use tresses::{self, groom};
