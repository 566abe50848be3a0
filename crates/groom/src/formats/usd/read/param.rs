//! Parameters of curves.

use openusd::{
    sdf::Value,
    usd::{Prim, TimeCode},
};

use super::{READS_PER_BYTE, Scene, value};
use crate::{
    error::{At, Result},
    formats::{
        curves::{AttributeScope, Param, is_custom},
        source::excerpt,
    },
};

/// Returns the values of `name` from the first of `prims` that has it, as a primvar or as a plain attribute.
pub(super) fn param<'p>(
    scene: &Scene,
    prims: impl Iterator<Item = &'p Prim>,
    name: &str,
    time: TimeCode,
) -> Result<Option<Param>> {
    for prim in prims {
        for name in [format!("primvars:{name}"), name.to_owned()] {
            let attribute = prim.attribute(name.clone());
            let value = scene.say(attribute.get_at::<Value>(time))?;
            let row = value.as_ref().and_then(|value| value::row(value, |number| number as f32));
            let Some((mut flat, extent)) = row.filter(|(flat, _)| !flat.is_empty()) else { continue };
            let metadata = |key: &str| scene.say(attribute.get_metadata::<Value>(key));
            let elements = metadata("elementSize")?.as_ref().and_then(value::number).unwrap_or(1.0);
            let width = extent.saturating_mul(elements.max(1.0) as usize);
            let indices = scene.say(prim.attribute(format!("{name}:indices")).get_at::<Value>(time))?;
            if let Some((indices, _)) = indices.as_ref().and_then(|all| value::row(all, |index| index as i64))
            {
                // A few indices may repeat a long value so often that it fills the memory.
                let max_values = scene.bytes.get().saturating_mul(READS_PER_BYTE);
                if width > 16 && (indices.len() as u64).saturating_mul(width as u64) > max_values {
                    let (path, name) = (excerpt(prim.path().as_str()), excerpt(&name));
                    return Err(scene
                        .problem(format!("{path}: {name} repeats too much data for the size of the file")));
                }
                flat = Param::gather(&flat, &indices, width).map_err(|index| {
                    let (path, name) = (excerpt(prim.path().as_str()), excerpt(&name));
                    scene.problem(format!(
                        "{path}: {name} has no value {index}; there are {}",
                        flat.len() / width
                    ))
                })?;
            }
            scene.source.check_finite(At::File, &flat, &excerpt(&name))?;
            let scope = match metadata("interpolation")?.as_ref().and_then(value::text).as_deref() {
                Some("constant") => Some(AttributeScope::All),
                Some("uniform") => Some(AttributeScope::Curve),
                Some("varying" | "vertex" | "faceVarying") => Some(AttributeScope::Point),
                _ => None,
            };
            let is_integer = value.as_ref().is_some_and(value::is_integer);
            return Ok(Some(Param { flat, width, scope, is_integer, at: At::File }));
        }
    }
    Ok(None)
}

/// Returns the names of a prim's custom attributes.
pub(super) fn custom(scene: &Scene, prim: &Prim) -> Result<Vec<String>> {
    let all = scene.say(prim.authored_attributes_in_namespace("primvars"))?;
    let names = all.iter().filter_map(|attribute| attribute.name().strip_prefix("primvars:"));
    Ok(names.filter(|name| is_custom(name)).map(str::to_owned).collect())
}
