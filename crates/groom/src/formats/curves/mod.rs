//! Conversion of curves to strands, shared by the Alembic and USD readers.
//!
//! A reader passes one object of curves after another, with its points, tessellation and parameters. [`Groom::add`]
//! converts them to strands with widths, colors, texture coordinates and marks.

pub(super) mod basis;
mod custom;
mod habits;
mod knots;
mod param;
#[cfg(test)]
pub(super) mod reference_tests;

pub(super) use custom::is_custom;
pub(super) use habits::CurveWarnings;
#[cfg(feature = "alembic")]
pub(super) use knots::clamped;
pub(super) use knots::split_knots;
pub(super) use param::{AttributeScope, Param};

use std::{collections::HashMap, rc::Rc};

use glam::{DMat4, DVec3, Vec2, Vec3};

use crate::{error::Result, formats::raw::Raw, strands::Mark};
use basis::{Basis, Blend};

/// Where a parameter is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ParamLocation {
    /// With the points, under the format's own name.
    Shape,
    /// Among the attributes that exporters add.
    Attributes,
}

/// Looks up the parameter of a name.
pub(super) type Values<'v> = dyn Fn(ParamLocation, &str) -> Result<Option<Param>> + 'v;

/// One object of curves.
pub(super) struct Object<'o> {
    /// Names of the object and of its parent.
    pub names: [&'o str; 2],
    /// Index of the object in the file.
    pub index: usize,
    /// Whether the curves are guides if they have no `groom_guide`; `None` if the file does not distinguish objects of
    /// guides.
    pub guides: Option<bool>,
    /// Index of the first point of each curve, and the end of the last curve.
    pub starts: &'o [u32],
    pub points: &'o [Vec3],
    /// Tessellation of each curve.
    pub cut: &'o [Rc<[Blend]>],
    /// Whether cubic curves end before their outermost points.
    pub inner: bool,
    /// From the object's space to the file's.
    pub matrix: DMat4,
    /// Group names, one for all curves or one per curve; may be empty.
    pub group_names: &'o [String],
    /// Names of the custom attributes.
    pub custom: &'o [String],
}

/// The format's names of parameters.
pub(super) struct Names {
    /// Widths, stored with the points.
    pub width: &'static str,
    /// Texture coordinates, stored with the points.
    pub uv: &'static str,
}

/// A groom being read.
pub(super) struct Groom {
    pub raw: Raw,
    pub habits: CurveWarnings,
    pub names: Names,
}

impl Groom {
    pub fn new(format: &'static str, names: Names) -> Self {
        Self { raw: Raw::new(format), habits: CurveWarnings::default(), names }
    }

    /// Adds the strands of an object.
    pub fn add(&mut self, object: &Object, values: &Values) -> Result<()> {
        let Object { starts, points, matrix, .. } = object;
        let is_transformed = *matrix != DMat4::IDENTITY;
        self.habits.transformed += usize::from(is_transformed);
        let scale = matrix.determinant().abs().cbrt() as f32;
        let widths = self.per_point(object, values, &[self.names.width], &custom::WIDTHS, 1)?;
        let colors = self.per_point(object, values, &[], &custom::COLORS, 3)?;
        let strands = &mut self.raw.strands;
        if strands.offsets.is_empty() {
            strands.offsets.push(0);
        }
        for (i, curve) in object.cut.iter().enumerate() {
            let range = starts[i] as usize..starts[i + 1] as usize;
            for blend in curve.iter() {
                let p = blend.of_values(&points[range.clone()]);
                let p = if is_transformed { matrix.transform_point3(DVec3::from(p)).as_vec3() } else { p };
                strands.positions.push(p);
                if let Some(widths) = &widths {
                    strands.radii.push(0.5 * scale * blend.of_values(&widths[range.clone()]).x);
                }
                if let Some(colors) = &colors {
                    strands.colors.push(blend.of_values(&colors[range.clone()]));
                }
            }
            strands.offsets.push(strands.positions.len() as u32);
        }
        self.habits.without_width += usize::from(widths.is_none());
        self.marks(object, values)?;
        self.custom(object, values);
        Ok(())
    }

    /// Returns one value per control point, from the first parameter that fits: `own` names are stored with the points,
    /// `others` among the added attributes.
    fn per_point(
        &mut self,
        object: &Object,
        values: &Values,
        own: &[&'static str],
        others: &[&'static str],
        width: usize,
    ) -> Result<Option<Vec<Vec3>>> {
        let starts = object.starts;
        let (curves, points) = (starts.len() - 1, object.points.len());
        let own = own.iter().map(|name| (ParamLocation::Shape, name));
        for (location, name) in own.chain(others.iter().map(|name| (ParamLocation::Attributes, name))) {
            let Some(param) = values(location, name)? else { continue };
            if let Some(varying) =
                (width == 1).then(|| param.varying_per_point(starts, object.inner)).flatten()
            {
                self.habits.widths.push(name);
                return Ok(Some(varying.into_iter().map(|value| Vec3::new(value, 0.0, 0.0)).collect()));
            }
            let Some(per) = param.find_scope(width, curves, points) else {
                self.misfit(name, &param, curves, points);
                continue;
            };
            if width == 1 && !self.habits.widths.contains(name) {
                self.habits.widths.push(name);
            }
            let at = |index: usize| Vec3::from(param.value::<3>(width, index));
            return Ok(Some(match per {
                AttributeScope::All => vec![at(0); points],
                AttributeScope::Point => (0..points).map(at).collect(),
                AttributeScope::Curve => {
                    let spread = starts.windows(2).enumerate();
                    spread.flat_map(|(i, w)| std::iter::repeat_n(at(i), (w[1] - w[0]) as usize)).collect()
                }
            }));
        }
        Ok(None)
    }

    fn misfit(&mut self, name: &str, param: &Param, curves: usize, points: usize) {
        self.habits.misfits.push(format!(
            "“{name}” is ignored: its {param} fit neither {curves} curves nor {points} points"
        ));
    }

    /// Adds the guide marks, ids, groups and texture coordinates of an object's strands.
    fn marks(&mut self, object: &Object, values: &Values) -> Result<()> {
        let starts = object.starts;
        let (curves, before) = (starts.len() - 1, self.raw.strands.marks.len());
        let find = |name: &str| values(ParamLocation::Attributes, name);
        let scalar = |param: Option<Param>| param.and_then(|param| param.per_curve::<1>(1, starts));
        let guide = scalar(find("groom_guide")?);
        let id = scalar(find("groom_id")?);
        let group = scalar(find("groom_group_id")?);
        let three = |param: Option<Param>| {
            param.and_then(|param| {
                param.per_curve::<3>(param.width(curves), starts).map(|all| (param.width(curves), all))
            })
        };
        let (closest, weights) = (three(find("groom_closest_guides")?), three(find("groom_guide_weights")?));
        let uvs = match find("groom_root_uv")? {
            Some(param) => Some(param),
            None => values(ParamLocation::Shape, self.names.uv)?,
        };
        if let Some(param) = uvs {
            match param.per_curve::<2>(2, starts) {
                Some(all) => self.raw.strands.root_uvs.extend(all.into_iter().map(Vec2::from)),
                None => self.misfit("groom_root_uv", &param, curves, object.points.len()),
            }
        }
        self.habits.groups |= group.is_some();
        self.habits.has_guide_attribute |= guide.is_some();
        self.habits.marked |= guide.is_some()
            || id.is_some()
            || group.is_some()
            || closest.is_some()
            || object.guides.is_some();
        let names = object.group_names;
        for i in 0..curves {
            let mut mark = Mark { id: (before + i) as i32, group: object.index as i32, ..Default::default() };
            mark.guide = match &guide {
                Some(guide) => guide[i][0] != 0.0,
                None => object.guides == Some(true),
            };
            self.habits.guides += usize::from(mark.guide);
            if let Some(id) = &id {
                mark.id = id[i][0] as i32;
            }
            if let Some(group) = &group {
                mark.group = group[i][0] as i32;
            }
            if let Some((width, closest)) = &closest {
                // Without weights, only the first guide counts.
                mark.weights[0] = 1.0;
                let named = (*width).min(3);
                let names = closest[i].iter().take(named);
                mark.closest.iter_mut().zip(names).for_each(|(id, name)| *id = *name as i32);
                if let Some((_, weights)) = &weights {
                    mark.weights = weights[i];
                }
            }
            let name = match names.len() {
                0 if group.is_none() => Some(object.names[usize::from(!object.names[1].is_empty())]),
                0 => None,
                1 => names.first().map(String::as_str),
                _ => names.get(i).map(String::as_str),
            };
            if let Some(name) = name.filter(|_| !self.raw.group_names.contains_key(&mark.group)) {
                self.raw.group_names.insert(mark.group, name.to_owned());
            }
            self.raw.strands.marks.push(mark);
        }
        Ok(())
    }
}

/// Returns the first point of each curve and the end of the last curve; an error says which curve does not fit.
pub(super) fn starts(counts: &[i64], points: usize) -> Result<Vec<u32>, String> {
    let mut starts = vec![0u32];
    let mut end = 0u64;
    for count in counts {
        // A curve without points would be an empty strand.
        end =
            u64::try_from(*count).ok().filter(|n| *n > 0).map_or(u64::MAX, |count| end.saturating_add(count));
        if end > points as u64 {
            return Err(format!(
                "a curve has {count} points, which do not fit into the {points} points of the file"
            ));
        }
        // At most the number of points read, which fits in 32 bits.
        starts.push(end as u32);
    }
    Ok(starts)
}

/// How curves are tessellated.
pub(super) enum CurveCut<'h> {
    /// One basis for all curves.
    Basis(Basis<'h>),
    /// An order and knots per curve.
    Knots(&'h [(usize, Vec<f32>)]),
}

/// Tessellates each curve.
pub(super) fn cut(starts: &[u32], how: &CurveCut) -> Result<Vec<Rc<[Blend]>>, String> {
    let mut all: Vec<Rc<[Blend]>> = Vec::with_capacity(starts.len() - 1);
    let mut known: HashMap<usize, Rc<[Blend]>> = HashMap::new();
    for (i, pair) in starts.windows(2).enumerate() {
        let count = (pair[1] - pair[0]) as usize;
        // Curves of an object mostly share one tessellation.
        let like = match how {
            CurveCut::Basis(_) => known.get(&count),
            CurveCut::Knots(own) => all.last().filter(|_| i > 0 && own[i - 1] == own[i]),
        };
        if let Some(like) = like.cloned() {
            all.push(like);
            continue;
        }
        let vertices = match how {
            CurveCut::Basis(basis) => basis.vertices(count),
            CurveCut::Knots(own) => Basis::Knots { order: own[i].0, knots: &own[i].1 }.vertices(count),
        };
        let vertices: Rc<[Blend]> = vertices?.into();
        known.insert(count, vertices.clone());
        all.push(vertices);
    }
    Ok(all)
}

/// Returns whether a name suggests guides.
pub(super) fn names_guides(name: &str) -> bool {
    name.to_ascii_lowercase().contains("guide")
}

/// Returns whether a criterion distinguishes guides: it holds for some objects, but not for all.
pub(super) fn distinguishes_guides(says: impl Iterator<Item = bool>) -> bool {
    let (mut some, mut others) = (false, false);
    says.for_each(|guides| *(if guides { &mut some } else { &mut others }) = true);
    some && others
}
