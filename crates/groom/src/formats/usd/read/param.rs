//! Values beside points.

use openusd::{
    sdf::Value,
    usd::{Prim, TimeCode},
};

use super::{READS_PER_BYTE, Scene, value};
use crate::{
    error::{At, Result},
    formats::{
        curves::{Param, Per},
        source::excerpt,
    },
};

/// The values of one name that the first of `prims` has, as a primvar or as they are.
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
                // Long values that few numbers stand for may be more than all memory.
                let most = scene.bytes.get().saturating_mul(READS_PER_BYTE);
                if width > 16 && (indices.len() as u64).saturating_mul(width as u64) > most {
                    let (path, name) = (excerpt(prim.path().as_str()), excerpt(&name));
                    return Err(
                        scene.problem(format!("{path}: {name} is more than so small a file can mean"))
                    );
                }
                flat = Param::picked(&flat, &indices, width).map_err(|index| {
                    let (path, name) = (excerpt(prim.path().as_str()), excerpt(&name));
                    scene.problem(format!(
                        "{path}: {name} has no value {index}, there are {}",
                        flat.len() / width
                    ))
                })?;
            }
            scene.source.check_finite(At::File, &flat, &excerpt(&name))?;
            let scope = match metadata("interpolation")?.as_ref().and_then(value::text).as_deref() {
                Some("constant") => Some(Per::All),
                Some("uniform") => Some(Per::Curve),
                Some("varying" | "vertex" | "faceVarying") => Some(Per::Point),
                _ => None,
            };
            return Ok(Some(Param { flat, width, scope, at: At::File }));
        }
    }
    Ok(None)
}
