//! Parameters of curves: values stored beside the geometry.

use super::{Archive, property::Compound, tree::Object};
use crate::{
    error::Result,
    formats::curves::{AttributeScope, Param, is_custom},
};

/// Returns the first nonempty parameter `name` of `compounds`.
pub(super) fn find<'a>(
    archive: &Archive<'_, 'a>,
    compounds: &[Compound<'a>],
    name: &str,
    time: f64,
) -> Result<Option<Param>> {
    for compound in compounds {
        if let Some(param) = read(archive, compound, name, time)?.filter(|p| !p.flat.is_empty()) {
            return Ok(Some(param));
        }
    }
    Ok(None)
}

/// Reads a parameter, with or without indices.
fn read<'a>(
    archive: &Archive<'_, 'a>,
    compound: &Compound<'a>,
    name: &str,
    time: f64,
) -> Result<Option<Param>> {
    let indexed = compound.compound(archive, name)?;
    let values = match &indexed {
        Some(both) => both.property(archive, ".vals")?,
        None => compound.property(archive, name)?,
    };
    let Some(values) = values.filter(|values| !values.is_text()) else { return Ok(None) };
    let extent = values.extent();
    // `arrayExtent` is the number of elements per value, if the exporter flattened them.
    let flattened = values.meta("arrayExtent").and_then(|text| text.parse::<usize>().ok()).unwrap_or(1);
    let mut flat = values.floats(archive, time)?;
    let indices = match &indexed {
        Some(both) => both.property(archive, ".indices")?,
        None => None,
    };
    if let Some(indices) = indices {
        flat = Param::gather(&flat, &indices.integers(archive, time)?, extent).map_err(|index| {
            let problem = format!("{name} has no value {index}; there are {}", flat.len() / extent.max(1));
            archive.source.problem(indices.at(), problem)
        })?;
    }
    let scope = match values.meta("geoScope") {
        Some("con") => Some(AttributeScope::All),
        Some("uni") => Some(AttributeScope::Curve),
        Some("vtx" | "var" | "fvr") => Some(AttributeScope::Point),
        _ => None,
    };
    let (width, is_integer) = (extent.saturating_mul(flattened.max(1)), values.is_integer());
    Ok(Some(Param { flat, width, scope, is_integer, at: values.at() }))
}

/// Returns the compounds that may hold an object's parameters: beside its geometry, then on the transform above it.
pub(super) fn param_compounds<'a>(
    archive: &Archive<'_, 'a>,
    object: &Object<'a>,
    above: Option<&Compound<'a>>,
) -> Result<Vec<Compound<'a>>> {
    let mut all = Vec::new();
    for holder in std::iter::once(&object.shape).chain(above) {
        for name in [".arbGeomParams", ".userProperties"] {
            all.extend(holder.compound(archive, name)?);
        }
    }
    Ok(all)
}

/// Returns the names of an object's custom attributes.
pub(super) fn custom<'a>(archive: &Archive<'_, 'a>, object: &Object<'a>) -> Result<Vec<String>> {
    let params = object.shape.compound(archive, ".arbGeomParams")?;
    let names = params.iter().flat_map(Compound::names);
    Ok(names.filter(|name| is_custom(name)).map(str::to_owned).collect())
}

/// Returns the values of the first text property `name`.
pub(super) fn text<'a>(
    archive: &Archive<'_, 'a>,
    compounds: &[Compound<'a>],
    name: &str,
    time: f64,
) -> Result<Vec<String>> {
    for compound in compounds {
        if let Some(property) = compound.property(archive, name)?.filter(|property| property.is_text()) {
            return property.texts(archive, time);
        }
    }
    Ok(Vec::new())
}
