//! Appearance of hair, as far as groom files describe it.

use crate::{Result, range, range::Range};

/// Fiber and pigment parameters of physical hair models (Marschner 2003, d'Eon 2011, Chiang 2016).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Look {
    /// Brown to black pigment: blond 0.25, brown 1.3, black 6, white 0.
    pub eumelanin: f32,
    /// Yellow to red pigment: brown 0.2, red 1.5.
    pub pheomelanin: f32,
    /// Longitudinal and azimuthal roughness, 0.1 to 1.
    pub roughness: [f32; 2],
    /// Cuticle angle, radians.
    pub tilt: f32,
    /// Index of refraction relative to air.
    pub ior: f32,
}

impl Default for Look {
    /// Brown hair.
    fn default() -> Self {
        let tilt = 2f32.to_radians();
        Self { eumelanin: 1.3, pheomelanin: 0.2, roughness: [0.3; 2], tilt, ior: 1.55 }
    }
}

impl Look {
    /// The range of [`eumelanin`](Self::eumelanin).
    pub const EUMELANIN: Range = range!("eumelanin", 0.0 to 100.0);
    /// The range of [`pheomelanin`](Self::pheomelanin).
    pub const PHEOMELANIN: Range = range!("pheomelanin", 0.0 to 100.0);
    /// The range of both components of [`roughness`](Self::roughness).
    pub const ROUGHNESS: Range = range!("roughness", 0.1 to 1.0);
    /// The range of [`tilt`](Self::tilt); usually up to 10 degrees.
    pub const TILT: Range =
        range!("cuticle angle", -0.2 to 0.2, "radians"; usually -0.174_532_925_2 to 0.174_532_925_2);
    /// The range of [`ior`](Self::ior).
    pub const IOR: Range = range!("index of refraction", 1.05 to 2.5);

    /// Checks that all values are in range.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for the first value out of range.
    pub fn check(&self) -> Result<()> {
        let [along, around] = self.roughness;
        Self::EUMELANIN.check(self.eumelanin)?;
        Self::PHEOMELANIN.check(self.pheomelanin)?;
        Self::ROUGHNESS.check(along)?;
        Self::ROUGHNESS.check(around)?;
        Self::TILT.check(self.tilt)?;
        Self::IOR.check(self.ior)
    }
}
