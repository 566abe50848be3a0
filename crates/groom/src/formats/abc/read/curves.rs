//! Reads curves as strands.

use std::rc::Rc;

use glam::Vec3;

use super::{
    Archive,
    groom::{self, find},
    property::{Compound, Property},
    tree::{Object, Schema, Tree},
};
use crate::{
    error::{At, Result},
    formats::{
        curves::{
            self, CurveCut, Groom, Names, ParamLocation,
            basis::{Basis, Blend},
            clamped, cut, split_knots,
        },
        raw::{Moment, Raw, declared},
        source::Source,
    },
    orient::Axis,
};

/// Reads all curves of a file at one moment.
pub(crate) fn read(source: &Source, moment: Moment) -> Result<Raw> {
    let archive = Archive::open(source)?;
    let tree = Tree::read(&archive)?;
    let objects: Vec<&Object> =
        tree.objects.iter().filter(|object| object.schema == Schema::Curves).collect();
    if objects.is_empty() {
        let problem = match tree.objects.len() {
            0 => "the file holds neither curves nor meshes",
            _ => "the file holds meshes but no curves; use it as the head of a groom",
        };
        return Err(source.problem(At::File, problem));
    }
    let mut groom = Groom::new("Alembic", Names { width: "width", uv: "uv" });
    let (time, note) = when(&archive, &objects, moment)?;
    groom.raw.notes.extend(note);
    let matrices = tree.matrices(&archive, time)?;
    let mut reading = CurveReader { archive: &archive, time, groom };
    let by_name = curves::distinguishes_guides(objects.iter().map(|object| named_guides(object)));
    for (i, object) in objects.iter().enumerate() {
        let guides = by_name.then(|| named_guides(object));
        let above = tree.above(object);
        let compounds = groom::param_compounds(&archive, object, above)?;
        let shared = curves::Object {
            names: [&object.names[0], &object.names[1]],
            index: i,
            guides,
            starts: &[],
            points: &[],
            cut: &[],
            inner: false,
            matrix: Tree::of(object, &matrices),
            group_names: &groom::text(&archive, &compounds, "groom_group_name", time)?,
            custom: &groom::custom(&archive, object)?,
        };
        reading.object(object, &compounds, shared)?;
    }
    let Groom { mut raw, habits, .. } = reading.groom;
    habits.tell(&mut raw, objects.len(), "by object name");
    raw.declared = declared(super::entry(archive.about, "_ai_Description").unwrap_or_default());
    if let Some(application) = archive.application() {
        raw.notes.insert(0, format!("written by {application}"));
        if application.starts_with("Blender") {
            raw.declared.up.get_or_insert(Axis::Y);
        }
    }
    Ok(raw)
}

fn named_guides(object: &Object) -> bool {
    object.names.iter().any(|name| curves::names_guides(name))
}

/// Returns the time that `moment` selects, seconds, and a note on the file's frames.
fn when(archive: &Archive, objects: &[&Object], moment: Moment) -> Result<(f64, Option<String>)> {
    let mut longest: Option<Property> = None;
    let mut first = f64::INFINITY;
    for object in objects {
        let Some(points) = object.shape.property(archive, "P")? else { continue };
        if points.samples() > 0 {
            first = first.min(points.time(archive, 0));
        }
        if longest.as_ref().is_none_or(|best| best.samples() < points.samples()) {
            longest = Some(points);
        }
    }
    let Some(longest) = longest.filter(|property| property.samples() > 0) else { return Ok((0.0, None)) };
    let count = longest.samples();
    let last = longest.time(archive, count - 1);
    let time = match moment {
        Moment::First => first,
        Moment::Seconds(time) => time,
        Moment::Frame(frame) if frame < count => longest.time(archive, frame),
        Moment::Frame(frame) => {
            let problem =
                format!("frame {frame} does not exist; the file has {count} frames, counted from 0");
            return Err(archive.source.problem(longest.at(), problem));
        }
    };
    let note = (count > 1 && longest.moves())
        .then(|| format!("{count} frames from {first:.3} to {last:.3} s, read at {time:.3} s"));
    Ok((time, note))
}

/// State while a file is read.
struct CurveReader<'r, 's, 'a> {
    archive: &'r Archive<'s, 'a>,
    time: f64,
    groom: Groom,
}

impl<'a> CurveReader<'_, '_, 'a> {
    fn object(
        &mut self,
        object: &Object<'a>,
        compounds: &[Compound<'a>],
        shared: curves::Object,
    ) -> Result<()> {
        let (archive, time) = (self.archive, self.time);
        let shape = &object.shape;
        let Some(points) = shape.property(archive, "P")? else { return Ok(()) };
        let Some(counts) = shape.property(archive, "nVertices")? else {
            return Err(archive.source.problem(points.at(), "the curves have no nVertices"));
        };
        let flat = points.floats(archive, time)?;
        let starts = curves::starts(&counts.integers(archive, time)?, flat.len() / 3)
            .map_err(|problem| archive.source.problem(counts.at(), problem))?;
        let end = starts.last().map_or(0, |end| *end as usize);
        let points: Vec<Vec3> = flat.as_chunks().0[..end].iter().map(|p| Vec3::from(*p)).collect();
        let cut = self.curves(shape, &starts)?;
        self.budget(&cut, shape)?;
        let values = |location: ParamLocation, name: &str| match location {
            ParamLocation::Shape => find(archive, std::slice::from_ref(shape), name, time),
            ParamLocation::Attributes => find(archive, compounds, name, time),
        };
        self.groom.add(&curves::Object { starts: &starts, points: &points, cut: &cut, ..shared }, &values)
    }

    /// Tessellates each curve. A vertex is a weighted mean of control points.
    fn curves(&mut self, shape: &Compound<'a>, starts: &[u32]) -> Result<Vec<Rc<[Blend]>>> {
        let (archive, time) = (self.archive, self.time);
        let list = |name: &str| match shape.property(archive, name)? {
            Some(property) => property.floats(archive, time),
            None => Ok(Vec::new()),
        };
        let (kind, orders, knots) = (list("curveBasisAndType")?, list(".orders")?, list(".knots")?);
        let code = |i: usize| kind.get(i).map_or(0, |v| *v as u8);
        let straight = kind.is_empty() || code(0) == 1;
        self.groom.habits.closed += usize::from(code(1) == 1);
        self.groom.habits.rational += usize::from(!straight && list("w")?.iter().any(|w| *w != 1.0));
        let knotted = match code(0) {
            _ if straight => None,
            2 if knots.is_empty() => clamped(starts, &orders),
            kind => split_knots(starts, &orders, &knots, kind == 2),
        };
        self.groom.habits.clamped += usize::from(knotted.is_some() && knots.is_empty());
        let name = match (code(0), code(2)) {
            _ if straight => None,
            _ if knotted.is_some() => Some("B-spline (with knots)"),
            (2, _) => {
                self.groom.habits.straightened += 1;
                None
            }
            (_, 1) => Some("Bézier"),
            (_, 2) => Some("B-spline"),
            (_, 3) => Some("Catmull-Rom"),
            (_, 0) => None,
            (_, other) => {
                let problem = format!("curves of basis {other} (Hermite is 4, power 5) are not supported");
                return Err(archive.source.problem(self.at(shape)?, problem));
            }
        };
        if let Some(name) = name.filter(|name| !self.groom.habits.curved.contains(name)) {
            self.groom.habits.curved.push(name);
        }
        let how = match (name, &knotted) {
            (_, Some(own)) => CurveCut::Knots(own),
            (Some("Bézier"), _) => CurveCut::Basis(Basis::Bezier),
            (Some("B-spline"), _) => CurveCut::Basis(Basis::BSpline { pinned: false }),
            // Hair exporters expect Catmull-Rom curves to reach their end points.
            (Some(_), _) => CurveCut::Basis(Basis::CatmullRom { pinned: true }),
            (None, _) => CurveCut::Basis(Basis::Linear),
        };
        match cut(starts, &how) {
            Ok(all) => Ok(all),
            Err(problem) => Err(archive.source.problem(self.at(shape)?, problem)),
        }
    }

    fn at(&self, shape: &Compound<'a>) -> Result<At> {
        Ok(shape.property(self.archive, "curveBasisAndType")?.map_or(At::File, |property| property.at()))
    }

    /// Returns an error if there are more vertices than the file's size justifies.
    fn budget(&self, curves: &[Rc<[Blend]>], shape: &Compound<'a>) -> Result<()> {
        let count: u64 = curves.iter().map(|curve| curve.len() as u64).sum();
        self.archive.source.check_vertices(0, self.groom.raw.strands.positions.len() as u64 + count)?;
        match self.at(shape)? {
            At::Byte(at) => self.archive.spend(count, at),
            _ => self.archive.spend(count, 0),
        }
    }
}
