//! Custom attributes of curves: parameters that only their author interprets.

use super::{AttributeScope, Groom, Object, Param, ParamLocation, Values};
use crate::{
    attribute::{MAX_WIDTH, StrandAttribute},
    error::Result,
};

/// Names of widths and of colors among the attributes that exporters add, the preferred first.
pub(super) const WIDTHS: [&str; 3] = ["groom_width", "width", "widths"];
pub(super) const COLORS: [&str; 4] = ["groom_color", "Cd", "displayColor", "color"];
/// Further parameters with a meaning of their own. Names that begin with `groom_` also have one.
const KNOWN: [&str; 7] = ["N", "P", "displayOpacity", "normals", "st", "uv", "velocities"];

/// Returns whether a parameter of this name is a custom attribute.
pub(in crate::formats) fn is_custom(name: &str) -> bool {
    // A colon separates namespaces, for example the joints of a skeleton; a dot begins a name that the format reserves.
    let known = [&KNOWN[..], &WIDTHS, &COLORS];
    !known.iter().any(|names| names.contains(&name))
        && !name.starts_with("groom_")
        && !name.contains(':')
        && !name.starts_with('.')
}

impl Groom {
    /// Adds the custom attributes of an object whose strands have been added.
    pub(super) fn custom(&mut self, object: &Object, values: &Values) {
        for name in object.custom {
            match self.attribute(object, values, name) {
                Ok(Some(attribute)) => self.extend(attribute),
                Ok(None) => {}
                Err(problem) => self.habits.misfits.push(format!("“{name}” is ignored: {problem}")),
            }
        }
    }

    /// Reads an attribute of one object, with a value for each strand or each vertex.
    fn attribute(
        &mut self,
        object: &Object,
        values: &Values,
        name: &str,
    ) -> Result<Option<StrandAttribute>, String> {
        let read: Result<Option<Param>> = values(ParamLocation::Attributes, name);
        let Some(param) = read.map_err(|error| error.to_string())? else { return Ok(None) };
        let (curves, points) = (object.starts.len() - 1, object.points.len());
        let width = param.width;
        if !(1..=MAX_WIDTH as usize).contains(&width) {
            return Err(format!("its values have {width} numbers, but at most {MAX_WIDTH} are supported"));
        }
        let Some(scope) = param.find_scope(width, curves, points) else {
            return Err(format!("its {param} fit neither {curves} curves nor {points} points"));
        };
        let of = |i: usize| param.flat[i * width..][..width].iter().copied();
        let numbers = match scope {
            AttributeScope::All => (0..curves).flat_map(|_| of(0)).collect(),
            AttributeScope::Curve => param.flat.clone(),
            AttributeScope::Point => {
                let mut all = Vec::new();
                let mut column = Vec::new();
                for (curve, ends) in object.cut.iter().zip(object.starts.windows(2)) {
                    let first = all.len();
                    all.resize(first + curve.len() * width, 0.0);
                    for k in 0..width {
                        column.clear();
                        column.extend((ends[0]..ends[1]).map(|i| param.flat[i as usize * width + k]));
                        for (i, blend) in curve.iter().enumerate() {
                            let value = blend.of_values(&column);
                            all[first + i * width + k] = if param.is_integer { value.round() } else { value };
                        }
                    }
                }
                all
            }
        };
        let (per_vertex, is_integer) = (scope == AttributeScope::Point, param.is_integer);
        let (name, width) = (name.to_owned(), width as u32);
        Ok(Some(StrandAttribute { name, per_vertex, is_integer, width, numbers }))
    }

    /// Appends the values of one object. Attributes that other objects lack are dropped at the end of the file.
    fn extend(&mut self, more: StrandAttribute) {
        let all = &mut self.raw.strands.attributes;
        match all.iter_mut().find(|attribute| attribute.name == more.name) {
            Some(attribute) if attribute.joins(&more) => {
                attribute.append(&more);
            }
            Some(_) => {}
            None => all.push(more),
        }
    }
}
