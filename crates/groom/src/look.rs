//! What hair of a file looks like, as far as files say.

use crate::{Error, Result};

/// A fibre and its pigment, as the physical models of hair have them (Marschner 2003, d'Eon 2011, Chiang 2016).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Look {
    /// Brown to black pigment: blond 0.25, brown 1.3, black 6, white 0.
    pub eumelanin: f32,
    /// Yellow to red pigment: brown 0.2, red 1.5.
    pub pheomelanin: f32,
    /// Roughness along the fibre and around it, 0.1 to 1.
    pub roughness: [f32; 2],
    /// Tilt of the scales, radians.
    pub tilt: f32,
    /// Index of refraction over that of the air.
    pub ior: f32,
}

impl Default for Look {
    /// Brown.
    fn default() -> Self {
        let tilt = 2f32.to_radians();
        Self { eumelanin: 1.3, pheomelanin: 0.2, roughness: [0.3; 2], tilt, ior: 1.55 }
    }
}

impl Look {
    /// Whether all of it is within what the fields say.
    ///
    /// # Errors
    /// [`Error::Unusable`] for the first that is not.
    pub fn check(&self) -> Result<()> {
        let [along, around] = self.roughness;
        for (name, value, range) in [
            ("eumelanin", self.eumelanin, 0.0..=100.0),
            ("pheomelanin", self.pheomelanin, 0.0..=100.0),
            ("longitudinalRoughness", along, 0.1..=1.0),
            ("azimuthalRoughness", around, 0.1..=1.0),
            ("cuticleTilt", self.tilt, -0.2..=0.2),
            ("ior", self.ior, 1.05..=2.5),
        ] {
            if !range.contains(&value) {
                let (least, most) = (range.start(), range.end());
                return Err(Error::Unusable(format!("{name} is {value}, but from {least} to {most}")));
            }
        }
        Ok(())
    }
}
