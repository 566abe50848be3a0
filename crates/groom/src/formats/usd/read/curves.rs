//! Reads curves as strands.

use std::rc::Rc;

use glam::{DMat4, Vec3};
use openusd::{
    sdf::Value,
    usd::{Prim, TimeCode},
};

use super::{
    Moment, Scene, Source, guarded,
    param::{custom, param},
    skel::{SkelBinding, Skeleton, Skeletons},
    tree::{Object, Purpose, Schema, Tree, when},
    value,
};
use crate::{
    error::{At, Result},
    formats::{
        curves::{
            self, CurveCut, Groom, Names, ParamLocation,
            basis::{Basis, Blend},
            cut, split_knots,
        },
        raw::Raw,
        source::excerpt,
    },
};

/// Reads all curves of a file at one moment.
pub(crate) fn read(source: &Source, moment: Moment) -> Result<Raw> {
    guarded(source, || {
        let scene = Scene::open(source)?;
        let tree = Tree::read(&scene)?;
        CurveReader::of(&scene, &tree, moment)
    })
}

/// State while a file is read.
struct CurveReader<'r> {
    scene: &'r Scene<'r, 'r>,
    tree: &'r Tree,
    time: TimeCode,
    skeletons: Skeletons,
    /// Skinning palette and transform of each skeleton.
    palettes: Vec<(Vec<DMat4>, DMat4)>,
    groom: Groom,
}

impl<'r> CurveReader<'r> {
    fn of(scene: &'r Scene<'r, 'r>, tree: &'r Tree, moment: Moment) -> Result<Raw> {
        let all: Vec<&Object> = tree.objects.iter().filter(|object| object.schema != Schema::Mesh).collect();
        if all.is_empty() {
            let mut problem = String::from(match tree.objects.len() {
                0 => "the file holds neither curves nor meshes",
                _ => "the file holds meshes but no curves; use it as the head of a groom",
            });
            if let Some(missing) = scene.missing() {
                problem += &format!(" ({missing})");
            }
            return Err(scene.problem(problem));
        }
        let skeletons = Skeletons::read(scene, tree)?;
        let mut times = tree.times(scene, &all)?;
        times.extend(skeletons.times(scene, tree, &all)?);
        times.sort_by(f64::total_cmp);
        times.dedup();
        let (time, note) = when(scene, &times, moment)?;
        let transforms = tree.transforms(scene, time)?;
        let mut groom = Groom::new("USD", Names { width: "widths", uv: "st" });
        groom.raw.notes.extend(note);
        groom.raw.notes.extend(scene.missing());
        groom.raw.declared = scene.declared()?;
        let palette = |skeleton: &Skeleton| {
            Ok((skeleton.palette(scene, moment, time)?, skeleton.transform(&transforms)))
        };
        let palettes = skeletons.0.iter().map(palette).collect::<Result<Vec<_>>>()?;
        let mut reading = Self { scene, tree, time, skeletons, palettes, groom };
        let objects = reading.select_objects(all, &transforms)?;
        let guides = |object: &Object| {
            object.purpose == Purpose::Guide || object.names.iter().any(|n| curves::names_guides(n))
        };
        let distinguishes_guides = curves::distinguishes_guides(objects.iter().map(|object| guides(object)));
        for (i, object) in objects.iter().enumerate() {
            let shared = curves::Object {
                names: [&object.names[0], &object.names[1]],
                index: i,
                guides: distinguishes_guides.then(|| guides(object)),
                starts: &[],
                points: &[],
                cut: &[],
                inner: false,
                matrix: Tree::of(object, &transforms).0,
                group_names: &reading.texts(object, "groom_group_name")?,
                custom: &custom(scene, &object.prim)?,
            };
            reading.object(object, shared)?;
        }
        let Groom { mut raw, habits, .. } = reading.groom;
        habits.tell(&mut raw, objects.len(), "by object name or purpose");
        Ok(raw)
    }

    /// Selects visible objects, including guides.
    fn select_objects(
        &mut self,
        all: Vec<&'r Object>,
        transforms: &[(glam::DMat4, bool)],
    ) -> Result<Vec<&'r Object>> {
        let count = all.len();
        let shown: Vec<_> = all.into_iter().filter(|object| Tree::of(object, transforms).1).collect();
        if shown.is_empty() {
            return Err(self.scene.problem(format!("all {count} curve objects are invisible")));
        }
        let hidden = count - shown.len();
        // Proxies are read only if there are no other objects.
        let proxies = shown.iter().filter(|object| object.purpose == Purpose::Proxy).count();
        let stand_in = proxies < shown.len();
        let notes = &mut self.groom.raw.notes;
        notes.extend((hidden > 0).then(|| format!("{hidden} invisible curve objects are skipped")));
        let some = proxies > 0 && stand_in;
        notes.extend(some.then(|| format!("{proxies} proxy objects are skipped")));
        Ok(shown.into_iter().filter(|object| !stand_in || object.purpose != Purpose::Proxy).collect())
    }

    fn object(&mut self, object: &Object, shared: curves::Object) -> Result<()> {
        let scene = self.scene;
        let broken =
            |problem: String| scene.problem(format!("{}: {problem}", excerpt(object.prim.path().as_str())));
        let Some(value) = self.value(&object.prim, "points")? else { return Ok(()) };
        let Some((flat, 3)) = value::row(&value, |number| number as f32) else {
            return Err(broken("“points” is not a list of points".into()));
        };
        drop(value);
        scene.source.check_finite(At::File, &flat, "points")?;
        let counts = self.value(&object.prim, "curveVertexCounts")?;
        let Some((counts, _)) = counts.as_ref().and_then(|counts| value::row(counts, |count| count as i64))
        else {
            return Err(broken("the curves have no curveVertexCounts".into()));
        };
        let starts = curves::starts(&counts, flat.len() / 3).map_err(broken)?;
        let end = starts.last().map_or(0, |end| *end as usize);
        let mut points: Vec<Vec3> = flat.as_chunks().0[..end].iter().map(|p| Vec3::from(*p)).collect();
        let mut matrix = shared.matrix;
        let object_points = (object, flat.len() / 3);
        if let Some(bound) = SkelBinding::of(scene, self.tree, object_points, &self.skeletons, self.time)? {
            let (palette, transform) = &self.palettes[bound.skeleton];
            bound.deform(palette, &mut points);
            matrix = *transform;
            self.groom.habits.bound += 1;
        }
        drop(flat);
        let (cut, inner) = self.cut(object, &starts)?;
        scene.take(cut.iter().map(|curve| curve.len() as u64).sum())?;
        let (tree, time) = (self.tree, self.time);
        let own = [&object.prim];
        let values = |location: ParamLocation, name: &str| match location {
            ParamLocation::Shape => param(scene, own.into_iter(), name, time),
            ParamLocation::Attributes => param(scene, tree.up(object), name, time),
        };
        // A single color for an object is the line color of a viewer.
        let viewers =
            values(ParamLocation::Attributes, "displayColor")?.is_some_and(|color| color.flat.len() == 3);
        if viewers && points.len() > 1 && !self.groom.habits.misfits.iter().any(|misfit| misfit == ONE_COLOR)
        {
            self.groom.habits.misfits.push(ONE_COLOR.into());
        }
        let values = |location: ParamLocation, name: &str| match name {
            "displayColor" if viewers => Ok(None),
            _ => values(location, name),
        };
        self.groom.add(
            &curves::Object { starts: &starts, points: &points, cut: &cut, inner, matrix, ..shared },
            &values,
        )
    }

    /// Tessellates each curve. Also returns whether curves end before their outermost points.
    fn cut(&mut self, object: &Object, starts: &[u32]) -> Result<(Vec<Rc<[Blend]>>, bool)> {
        let path = excerpt(object.prim.path().as_str());
        let broken = |problem: String| self.scene.problem(format!("{path}: {problem}"));
        let word = |name: &str| -> Result<String> {
            Ok(self.value(&object.prim, name)?.as_ref().and_then(value::text).unwrap_or_default())
        };
        let list = |name: &str| -> Result<Vec<f32>> {
            let value = self.value(&object.prim, name)?;
            Ok(value.as_ref().and_then(|value| value::row(value, |n| n as f32)).unwrap_or_default().0)
        };
        if object.schema == Schema::Hermite {
            return Err(broken("Hermite curves are not supported".into()));
        }
        if object.schema == Schema::Nurbs {
            let own = split_knots(starts, &list("order")?, &list("knots")?, true);
            let Some(own) = own else {
                return Err(broken("the orders and knots do not match the curves".into()));
            };
            let rational = list("pointWeights")?.iter().any(|w| *w != 1.0);
            let all = cut(starts, &CurveCut::Knots(&own)).map_err(broken)?;
            self.groom.habits.rational += usize::from(rational);
            self.curved("B-spline (with knots)");
            return Ok((all, false));
        }
        let (kind, basis, wrap) = (word("type")?, word("basis")?, word("wrap")?);
        // Blender writes particles as B-splines without `wrap`, although they begin at their roots.
        let unsaid = wrap.is_empty() && basis == "bspline" && self.scene.of_blender()?;
        self.groom.habits.clamped += usize::from(unsaid);
        let pinned = unsaid || wrap == "pinned";
        let (basis, name) = match (kind.as_str(), basis.as_str()) {
            ("linear", _) => (Basis::Linear, None),
            ("" | "cubic", "" | "bezier") => (Basis::Bezier, Some("Bézier")),
            ("" | "cubic", "bspline") => (Basis::BSpline { pinned }, Some("B-spline")),
            ("" | "cubic", "catmullRom") => (Basis::CatmullRom { pinned }, Some("Catmull-Rom")),
            (kind, basis) => {
                let problem = format!(
                    "curves of type “{}” and basis “{}” are not supported",
                    excerpt(kind),
                    excerpt(basis)
                );
                return Err(broken(problem));
            }
        };
        let inner = matches!(basis, Basis::BSpline { pinned: false } | Basis::CatmullRom { pinned: false });
        let all = cut(starts, &CurveCut::Basis(basis)).map_err(broken)?;
        self.groom.habits.closed += usize::from(wrap == "periodic");
        if let Some(name) = name {
            self.curved(name);
        }
        Ok((all, inner))
    }

    fn curved(&mut self, name: &'static str) {
        if !self.groom.habits.curved.contains(&name) {
            self.groom.habits.curved.push(name);
        }
    }

    fn value(&self, prim: &Prim, name: &str) -> Result<Option<Value>> {
        self.scene.say(prim.attribute(name.to_owned()).get_at(self.time))
    }

    /// Returns the texts of an attribute, from the object or the nearest ancestor that has it.
    fn texts(&self, object: &Object, name: &str) -> Result<Vec<String>> {
        for prim in self.tree.up(object) {
            for name in [format!("primvars:{name}"), name.to_owned()] {
                if let Some(value) = self.value(prim, &name)? {
                    return Ok(value::texts(&value));
                }
            }
        }
        Ok(Vec::new())
    }
}

const ONE_COLOR: &str =
    "“displayColor” is ignored where an object has one value: it is the color that viewers draw";
