//! Writes the same layers as USDC, the binary form.

use crate::{
    Error, Result, Rig, Strands, TriMesh,
    formats::writer::{EncodedFile, ExportHair},
    orient::LengthUnit,
};

/// Version of the files. The writer states 0.12, which Blender 4.2 refuses. Versions after 0.8 only add types of values
/// that hair and bodies do not have.
const VERSION: [u8; 3] = [0, 8, 0];

/// Encodes strands.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    packed(&super::encode(strands, unit)?.bytes).map(EncodedFile::from)
}

/// Encodes a mesh with hair.
pub(crate) fn character(body: Option<(&TriMesh, Option<&Rig>)>, hair: &[ExportHair<'_>]) -> Result<Vec<u8>> {
    packed(&super::character(body, hair)?)
}

/// Encodes a mesh without hair.
pub(crate) fn body(mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
    packed(&super::body(mesh, rig)?)
}

fn packed(text: &[u8]) -> Result<Vec<u8>> {
    let broken =
        |problem: String| Error::Unusable(format!("the USD text cannot be converted to USDC: {problem}"));
    let text = std::str::from_utf8(text).map_err(|error| broken(error.to_string()))?;
    let data = openusd::usda::parse(text).map_err(|error| broken(error.to_string()))?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    openusd::usdc::CrateWriter::write(&data, &mut bytes).map_err(|error| broken(error.to_string()))?;
    let mut bytes = bytes.into_inner();
    if let Some(version) = bytes.get_mut(8..11) {
        version.copy_from_slice(&VERSION);
    }
    Ok(bytes)
}
