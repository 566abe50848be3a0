//! The same layers as USDC, the binary form.

use crate::{
    Error, Result, Rig, Strands, TriMesh,
    formats::writer::{Encoded, Hair},
    orient::Unit,
};

/// Encodes strands.
pub(crate) fn encode(strands: &Strands, unit: Option<Unit>) -> Result<Encoded> {
    packed(&super::encode(strands, unit)?.bytes).map(Encoded::from)
}

/// A body with hair.
pub(crate) fn character(body: Option<(&TriMesh, Option<&Rig>)>, hair: &[Hair<'_>]) -> Result<Vec<u8>> {
    packed(&super::character(body, hair)?)
}

/// A body without hair.
pub(crate) fn body(mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
    packed(&super::body(mesh, rig)?)
}

fn packed(text: &[u8]) -> Result<Vec<u8>> {
    let broken = |problem: String| Error::Unusable(format!("USD cannot be packed: {problem}"));
    let text = std::str::from_utf8(text).map_err(|error| broken(error.to_string()))?;
    let data = openusd::usda::parse(text).map_err(|error| broken(error.to_string()))?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    openusd::usdc::CrateWriter::write(&data, &mut bytes).map_err(|error| broken(error.to_string()))?;
    Ok(bytes.into_inner())
}
