//! Curves as strands.

use std::{collections::HashMap, rc::Rc};

use glam::{DMat4, DVec3, Vec2, Vec3};

use super::{
    Archive,
    groom::{self, Param, Per},
    habits::Habits,
    property::{Compound, Property},
    tree::{Object, Schema, Tree},
};
use crate::{
    error::{At, Result},
    import::{
        Moment, Raw, Source,
        basis::{Basis, Blend, MOST},
        declared,
    },
    orient::Axis,
    strands::Mark,
};

/// Reads all curves of a file at one moment.
pub(in crate::import) fn read(source: &Source, moment: Moment) -> Result<Raw> {
    let archive = Archive::open(source)?;
    let tree = Tree::read(&archive)?;
    let objects: Vec<&Object> =
        tree.objects.iter().filter(|object| object.schema == Schema::Curves).collect();
    if objects.is_empty() {
        let problem = match tree.objects.len() {
            0 => "the file holds neither curves nor meshes",
            _ => "the file holds no curves; its meshes can be the head of a groom",
        };
        return Err(source.problem(At::File, problem));
    }
    let mut raw = Raw::new("Alembic");
    let (time, told) = when(&archive, &objects, moment)?;
    raw.notes.extend(told);
    let matrices = tree.matrices(&archive, time)?;
    let mut reading = Reading { archive: &archive, time, raw, habits: Habits::default() };
    let by_name = by_name(&objects);
    for (i, object) in objects.iter().enumerate() {
        reading.object(object, tree.above(object), Tree::of(object, &matrices), i, by_name)?;
    }
    let Reading { mut raw, habits, .. } = reading;
    habits.tell(&mut raw, objects.len(), by_name);
    raw.declared = declared(super::entry(archive.about, "_ai_Description").unwrap_or_default());
    if let Some(application) = archive.application() {
        raw.notes.insert(0, format!("written by {application}"));
        if application.starts_with("Blender") {
            raw.declared.up.get_or_insert(Axis::Y);
        }
    }
    Ok(raw)
}

/// Whether objects are told apart as guides by their names: some say so, and others do not.
fn by_name(objects: &[&Object]) -> bool {
    let guides = objects.iter().filter(|object| named_guides(object)).count();
    guides > 0 && guides < objects.len()
}

fn named_guides(object: &Object) -> bool {
    object.names.iter().any(|name| name.to_ascii_lowercase().contains("guide"))
}

/// The time that is meant, and what to say of it.
fn when(archive: &Archive, objects: &[&Object], moment: Moment) -> Result<(f64, Option<String>)> {
    let mut most: Option<Property> = None;
    let mut first = f64::INFINITY;
    for object in objects {
        let Some(points) = object.shape.property(archive, "P")? else { continue };
        if points.samples() > 0 {
            first = first.min(points.time(archive, 0));
        }
        if most.as_ref().is_none_or(|most| most.samples() < points.samples()) {
            most = Some(points);
        }
    }
    let Some(most) = most.filter(|most| most.samples() > 0) else { return Ok((0.0, None)) };
    let count = most.samples();
    let last = most.time(archive, count - 1);
    let time = match moment {
        Moment::First => first,
        Moment::Seconds(time) => time,
        Moment::Frame(frame) if frame < count => most.time(archive, frame),
        Moment::Frame(frame) => {
            let problem = format!("frame {frame} is asked for, but there are {count}, from 0 on");
            return Err(archive.source.problem(most.at(), problem));
        }
    };
    let told = (count > 1 && most.moves())
        .then(|| format!("{count} frames from {first:.3} to {last:.3} s, read at {time:.3} s"));
    Ok((time, told))
}

/// A file in the making.
struct Reading<'r, 's, 'a> {
    archive: &'r Archive<'s, 'a>,
    time: f64,
    raw: Raw,
    habits: Habits,
}

impl<'a> Reading<'_, '_, 'a> {
    fn object(
        &mut self,
        object: &Object<'a>,
        above: Option<&Compound<'a>>,
        matrix: DMat4,
        index: usize,
        by_name: bool,
    ) -> Result<()> {
        let (archive, time) = (self.archive, self.time);
        let shape = &object.shape;
        let Some(points) = shape.property(archive, "P")? else { return Ok(()) };
        let Some(counts) = shape.property(archive, "nVertices")? else {
            return Err(archive.source.problem(points.at(), "curves without nVertices"));
        };
        let flat = points.floats(archive, time)?;
        let mut starts = vec![0u32];
        let mut end = 0u64;
        for count in counts.integers(archive, time)? {
            // A curve of nothing would be a strand of nothing.
            end = u64::try_from(count)
                .ok()
                .filter(|n| *n > 0)
                .map_or(u64::MAX, |count| end.saturating_add(count));
            if end > flat.len() as u64 / 3 {
                let problem =
                    format!("a curve of {count} points does not fit into {} points", flat.len() / 3);
                return Err(archive.source.problem(counts.at(), problem));
            }
            // As many as positions that were read, which are fewer.
            starts.push(end as u32);
        }
        let points: Vec<Vec3> = flat.as_chunks().0[..end as usize].iter().map(|p| Vec3::from(*p)).collect();
        let places = groom::places(archive, object, above)?;
        let curves = self.curves(shape, &starts)?;
        self.budget(&curves, shape)?;
        let moved = matrix != DMat4::IDENTITY;
        self.habits.moved += usize::from(moved);
        let scale = matrix.determinant().abs().cbrt() as f32;
        let widths =
            self.per_point(shape, &places, &["width"], &["groom_width", "width", "widths"], 1, &starts)?;
        let colors =
            self.per_point(shape, &places, &[], &["groom_color", "Cd", "displayColor", "color"], 3, &starts)?;
        let strands = &mut self.raw.strands;
        if strands.offsets.is_empty() {
            strands.offsets.push(0);
        }
        for (i, curve) in curves.iter().enumerate() {
            let range = starts[i] as usize..starts[i + 1] as usize;
            for blend in curve.iter() {
                let p = blend.of_values(&points[range.clone()]);
                let p = if moved { matrix.transform_point3(DVec3::from(p)).as_vec3() } else { p };
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
        self.marks(object, &places, &starts, index, by_name)
    }

    /// How each curve is cut.
    fn curves(&mut self, shape: &Compound<'a>, starts: &[u32]) -> Result<Vec<Rc<[Blend]>>> {
        let (archive, time) = (self.archive, self.time);
        let list = |name: &str| match shape.property(archive, name)? {
            Some(property) => property.floats(archive, time),
            None => Ok(Vec::new()),
        };
        let (kind, orders, knots) = (list("curveBasisAndType")?, list(".orders")?, list(".knots")?);
        let code = |i: usize| kind.get(i).map_or(0, |v| *v as u8);
        let straight = kind.is_empty() || code(0) == 1;
        self.habits.closed += usize::from(code(1) == 1);
        self.habits.rational += usize::from(!straight && list("w")?.iter().any(|w| *w != 1.0));
        let knotted = match code(0) {
            _ if straight => None,
            2 if knots.is_empty() => clamped(starts, &orders),
            kind => split_knots(starts, &orders, &knots, kind == 2),
        };
        self.habits.clamped += usize::from(knotted.is_some() && knots.is_empty());
        let name = match (code(0), code(2)) {
            _ if straight => None,
            _ if knotted.is_some() => Some("B-spline (with knots)"),
            (2, _) => {
                self.habits.straightened += 1;
                None
            }
            (_, 1) => Some("Bézier"),
            (_, 2) => Some("B-spline"),
            (_, 3) => Some("Catmull-Rom"),
            (_, 0) => None,
            (_, other) => {
                let problem = format!("curves of basis {other} (Hermite is 4, power 5), which is not read");
                return Err(archive.source.problem(self.at(shape)?, problem));
            }
        };
        if let Some(name) = name.filter(|name| !self.habits.curved.contains(name)) {
            self.habits.curved.push(name);
        }
        let mut all: Vec<Rc<[Blend]>> = Vec::with_capacity(starts.len() - 1);
        let mut known: HashMap<usize, Rc<[Blend]>> = HashMap::new();
        for (i, pair) in starts.windows(2).enumerate() {
            let count = (pair[1] - pair[0]) as usize;
            let own = knotted.as_ref().map(|knotted| &knotted[i]);
            // Most curves of an object are alike.
            let like = match own {
                None => known.get(&count),
                Some(own) => {
                    all.last().filter(|_| i > 0 && knotted.as_ref().is_some_and(|all| all[i - 1] == *own))
                }
            };
            if let Some(like) = like.cloned() {
                all.push(like);
                continue;
            }
            let basis = match (name, own) {
                (_, Some((order, knots))) => Basis::Knots { order: *order, knots },
                (Some("Bézier"), _) => Basis::Bezier,
                (Some("B-spline"), _) => Basis::BSpline { pinned: false },
                // Exporters of hair mean curves through all points.
                (Some(_), _) => Basis::CatmullRom { pinned: true },
                (None, _) => Basis::Linear,
            };
            match basis.vertices(count) {
                Ok(vertices) => {
                    let vertices: Rc<[Blend]> = vertices.into();
                    known.insert(count, vertices.clone());
                    all.push(vertices);
                }
                Err(problem) => return Err(archive.source.problem(self.at(shape)?, problem)),
            }
        }
        Ok(all)
    }

    fn at(&self, shape: &Compound<'a>) -> Result<At> {
        Ok(shape.property(self.archive, "curveBasisAndType")?.map_or(At::File, |property| property.at()))
    }

    /// Refuses vertices that the file's size does not justify.
    fn budget(&self, curves: &[Rc<[Blend]>], shape: &Compound<'a>) -> Result<()> {
        let count: u64 = curves.iter().map(|curve| curve.len() as u64).sum();
        self.archive.source.check_vertices(0, self.raw.strands.positions.len() as u64 + count)?;
        match self.at(shape)? {
            At::Byte(at) => self.archive.spend(count, at),
            _ => self.archive.spend(count, 0),
        }
    }

    /// One value per control point: `own` names of the shape's properties, `others` of those beside it.
    fn per_point(
        &mut self,
        shape: &Compound<'a>,
        places: &[Compound<'a>],
        own: &[&'static str],
        others: &[&'static str],
        width: usize,
        starts: &[u32],
    ) -> Result<Option<Vec<Vec3>>> {
        let (curves, points) = (starts.len() - 1, starts.last().map_or(0, |end| *end as usize));
        let beside = std::slice::from_ref(shape);
        let all = own.iter().map(|name| (beside, name)).chain(others.iter().map(|name| (places, name)));
        for (places, name) in all {
            let Some(param) = Param::find(self.archive, places, &[name], self.time)? else { continue };
            if let Some(knots) = (width == 1).then(|| param.at_knots(starts)).flatten() {
                self.habits.widths.push(name);
                return Ok(Some(knots.into_iter().map(|value| Vec3::new(value, 0.0, 0.0)).collect()));
            }
            let Some(per) = param.per(width, curves, points) else {
                self.misfit(name, &param, curves, points);
                continue;
            };
            if width == 1 && !self.habits.widths.contains(name) {
                self.habits.widths.push(name);
            }
            let at = |index: usize| Vec3::from(param.value::<3>(width, index));
            return Ok(Some(match per {
                Per::All => vec![at(0); points],
                Per::Point => (0..points).map(at).collect(),
                Per::Curve => {
                    let spread = starts.windows(2).enumerate();
                    spread.flat_map(|(i, w)| std::iter::repeat_n(at(i), (w[1] - w[0]) as usize)).collect()
                }
            }));
        }
        Ok(None)
    }

    fn misfit(&mut self, name: &str, param: &Param, curves: usize, points: usize) {
        self.habits.misfits.push(format!(
            "“{name}” has {param}, which fit neither {curves} curves nor {points} points, and is not used"
        ));
    }

    /// Guides, ids, groups, coordinates.
    fn marks(
        &mut self,
        object: &Object<'a>,
        places: &[Compound<'a>],
        starts: &[u32],
        index: usize,
        by_name: bool,
    ) -> Result<()> {
        let (archive, time) = (self.archive, self.time);
        let (curves, before) = (starts.len() - 1, self.raw.strands.marks.len());
        let points = starts.last().map_or(0, |end| *end as usize);
        let find = |names: &[&str]| Param::find(archive, places, names, time);
        let whole = |param: Option<Param>| param.and_then(|param| param.per_curve::<1>(1, starts));
        let guide = whole(find(&["groom_guide"])?);
        let id = whole(find(&["groom_id"])?);
        let group = whole(find(&["groom_group_id"])?);
        let three = |param: Option<Param>| {
            param.and_then(|param| {
                param.per_curve::<3>(param.width(curves), starts).map(|all| (param.width(curves), all))
            })
        };
        let (closest, weights) =
            (three(find(&["groom_closest_guides"])?), three(find(&["groom_guide_weights"])?));
        let uvs = match find(&["groom_root_uv"])? {
            Some(param) => Some(param),
            None => Param::find(archive, std::slice::from_ref(&object.shape), &["uv"], time)?,
        };
        if let Some(param) = uvs {
            match param.per_curve::<2>(2, starts) {
                Some(all) => self.raw.strands.root_uvs.extend(all.into_iter().map(Vec2::from)),
                None => self.misfit("groom_root_uv", &param, curves, points),
            }
        }
        self.habits.groups |= group.is_some();
        self.habits.guides_said |= guide.is_some();
        self.habits.marked |=
            guide.is_some() || id.is_some() || group.is_some() || closest.is_some() || by_name;
        let names = groom::text(archive, places, "groom_group_name", time)?;
        for i in 0..curves {
            let mut mark = Mark { id: (before + i) as i32, group: index as i32, ..Default::default() };
            mark.guide = match &guide {
                Some(guide) => guide[i][0] != 0.0,
                None => by_name && named_guides(object),
            };
            self.habits.guides += usize::from(mark.guide);
            if let Some(id) = &id {
                mark.id = id[i][0] as i32;
            }
            if let Some(group) = &group {
                mark.group = group[i][0] as i32;
            }
            if let Some((width, closest)) = &closest {
                // One guide without a weight is followed alone.
                mark.weights[0] = 1.0;
                let named = (*width).min(3);
                let names = closest[i].iter().take(named);
                mark.closest.iter_mut().zip(names).for_each(|(id, name)| *id = *name as i32);
                if let Some((_, weights)) = &weights {
                    mark.weights = weights[i];
                }
            }
            let name = match names.len() {
                0 if group.is_none() => Some(&object.names[usize::from(!object.names[1].is_empty())]),
                0 => None,
                1 => names.first(),
                _ => names.get(i),
            };
            if let Some(name) = name.filter(|_| !self.raw.group_names.contains_key(&mark.group)) {
                self.raw.group_names.insert(mark.group, name.clone());
            }
            self.raw.strands.marks.push(mark);
        }
        Ok(())
    }
}

/// Even knots, repeated so that curves begin and end at their outermost points, for files that have orders alone.
fn clamped(starts: &[u32], orders: &[f32]) -> Option<Vec<(usize, Vec<f32>)>> {
    let curves = starts.len() - 1;
    (orders.len() == curves).then(|| {
        let each = starts.windows(2).zip(orders);
        each.map(|(w, order)| {
            let points = (w[1] - w[0]) as usize;
            let order = (*order as usize).clamp(2, MOST).min(points.max(2));
            let spans = (points + 1).saturating_sub(order);
            (order, (0..points + order).map(|k| k.saturating_sub(order - 1).min(spans) as f32).collect())
        })
        .collect()
    })
}

/// The order and the knots of each curve, if there are as many as the curves need.
fn split_knots(
    starts: &[u32],
    orders: &[f32],
    knots: &[f32],
    variable: bool,
) -> Option<Vec<(usize, Vec<f32>)>> {
    if knots.is_empty() || (variable && orders.is_empty()) {
        return None;
    }
    let curves = starts.len() - 1;
    let order = |i: usize| match orders.len() {
        0 => 4,
        // Of eight bits in sound files.
        1 => orders[0] as u8 as usize,
        n if n == curves => orders[i] as u8 as usize,
        _ => 0,
    };
    let needs =
        |i: usize, fewer: usize| ((starts[i + 1] - starts[i]) as usize + order(i)).saturating_sub(fewer);
    // Maya leaves out the first and the last knot.
    let fewer = [0, 2]
        .into_iter()
        .find(|fewer| (0..curves).map(|i| needs(i, *fewer)).sum::<usize>() == knots.len())?;
    let mut rest = knots;
    let mut all = Vec::with_capacity(curves);
    for i in 0..curves {
        let (own, more) = rest.split_at_checked(needs(i, fewer))?;
        rest = more;
        let mut own = own.to_vec();
        if fewer == 2 {
            own.insert(0, *own.first()?);
            own.push(*own.last()?);
        }
        all.push((order(i), own));
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_are_dealt_out_to_curves() {
        let starts = [0, 4, 9];
        // As many as points and order, or, as Maya has them, two fewer.
        let whole: Vec<f32> = (0..8).chain(0..9).map(|k| k as f32).collect();
        let split = split_knots(&starts, &[], &whole, false).unwrap();
        assert_eq!((split[0].0, split[0].1.len(), split[1].1.len()), (4, 8, 9));
        let fewer: Vec<f32> = (1..7).chain(1..8).map(|k| k as f32).collect();
        let split = split_knots(&starts, &[4.0], &fewer, true).unwrap();
        assert_eq!(split[0].1, [1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0]);
        let mixed = split_knots(&starts, &[2.0, 4.0], &whole[..15], true).unwrap();
        assert_eq!((mixed[0].0, mixed[0].1.len(), mixed[1].1.len()), (2, 6, 9));
        for (orders, knots) in [(&[][..], &whole[..]), (&[4.0], &whole[..5]), (&[4.0, 4.0, 4.0], &whole)] {
            assert!(split_knots(&starts, orders, knots, true).is_none());
        }
    }

    #[test]
    fn curves_with_orders_alone_reach_their_outermost_points() {
        let points: Vec<Vec3> = (0..7).map(|k| Vec3::new((k * k) as f32, 1.0 - k as f32, 0.0)).collect();
        for order in [2.0, 3.0, 4.0, 7.0, 200.0] {
            let (order, knots) = clamped(&[0, 7], &[order]).unwrap().remove(0);
            assert_eq!(knots.len(), 7 + order);
            let line = Basis::Knots { order, knots: &knots }.vertices(7).unwrap();
            let ends = [line.first(), line.last()].map(|blend| blend.unwrap().of_values(&points));
            assert!(ends[0].distance(points[0]) + ends[1].distance(points[6]) < 1e-4, "{order}: {ends:?}");
        }
        assert!(clamped(&[0, 7], &[]).is_none());
    }
}
