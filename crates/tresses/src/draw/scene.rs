//! Everything about a picture that is not geometry.

use super::{Background, BodyMaterial, View};
use crate::{
    Pose,
    light::{HairMaterial, Lights, ShadingRate, Shadows, Sphere},
    present::ToneMap,
};

/// Everything about a picture that is not geometry; a value of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scene {
    /// The camera.
    pub view: View,
    /// The lights.
    pub lights: Lights,
    /// How shadows are made.
    pub shadows: Shadows,
    /// What the shadow maps cover.
    pub focus: Sphere,
    /// The look of the hair.
    pub hair: HairMaterial,
    /// Where hair is shaded.
    pub shading: ShadingRate,
    /// The look of the body.
    pub body: BodyMaterial,
    /// Where the body is.
    pub pose: Pose,
    /// What is behind everything.
    pub background: Background,
    /// From linear radiance to the picture.
    pub tone: ToneMap,
}
