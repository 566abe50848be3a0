//! Hair in apps with Bevy's renderer and without a window. A single test binary, because linking Bevy takes a while.

#[cfg(feature = "cards")]
mod cards;
mod common;
mod files;
mod gltf;
mod lights;
mod motion;
mod scene;
mod shadows;
mod skies;
mod skin;
