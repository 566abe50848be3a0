//! Apps with Bevy's renderer and no window: what their cameras see of hair. One binary, as linking Bevy takes a while.

mod common;
mod files;
mod gltf;
mod motion;
mod scene;
mod shadows;
mod skies;
mod skin;
