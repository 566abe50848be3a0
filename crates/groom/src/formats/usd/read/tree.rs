//! The prims of a scene that have shapes, and the transforms above them.

use glam::{DMat4, DVec3};
use openusd::{
    sdf::{self, Value},
    usd::{Prim, PrimPredicate, TimeCode},
};

use super::{Moment, Scene, value};
use crate::error::Result;

/// Prims inside each other, at most.
const DEEPEST: usize = 200;
/// Prims that a file of no size may ask for; larger ones, one for each byte more.
const FREE: u64 = 1000;

/// What a prim is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Schema {
    Basis,
    Nurbs,
    Hermite,
    Mesh,
}

/// What a prim is for, as it or what it is in says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be seen.
    #[default]
    Shown,
    /// To stand in for what is seen.
    Proxy,
    /// To help who works with it.
    Guide,
}

/// A prim with a shape.
pub(super) struct Object {
    pub prim: Prim,
    /// Its own name, and that of what it is in.
    pub names: [String; 2],
    pub schema: Schema,
    pub purpose: Purpose,
    /// Its index among the transforms.
    own: usize,
}

/// All prims with shapes, and all prims at or above them.
#[derive(Default)]
pub(super) struct Tree {
    pub objects: Vec<Object>,
    /// Skeletons, each with its index among the transforms.
    pub skeletons: Vec<(Prim, usize)>,
    /// What moves skeletons.
    pub animations: Vec<Prim>,
    /// Each with the one above it, which comes before it.
    prims: Vec<(Prim, Option<usize>)>,
}

/// Where in the tree somebody is.
#[derive(Clone, Default)]
struct Place {
    depth: usize,
    above: Option<usize>,
    name: String,
    purpose: Purpose,
}

impl Tree {
    pub fn read(scene: &Scene) -> Result<Self> {
        let mut tree = Self::default();
        let mut rest = vec![(sdf::Path::abs_root(), Place::default())];
        while let Some((path, place)) = rest.pop() {
            let prim = scene.say(scene.stage.prim(path).map_err(Into::into))?;
            let mut inner = place.clone();
            inner.depth += 1;
            if place.depth > 0 {
                if !scene.say(scene.stage.prim_matches(prim.path(), PrimPredicate::DEFAULT_PROXIES))? {
                    continue;
                }
                let most = scene.bytes.get().saturating_add(FREE);
                if place.depth > DEEPEST || tree.prims.len() as u64 >= most {
                    let problem = format!("more than {most} prims, or more than {DEEPEST} inside each other");
                    return Err(scene.problem(problem));
                }
                tree.add(scene, &prim, &place, &mut inner)?;
            }
            let children = scene.say(prim.children())?;
            rest.extend(children.into_iter().rev().map(|child| (child.path().clone(), inner.clone())));
        }
        Ok(tree)
    }

    fn add(&mut self, scene: &Scene, prim: &Prim, place: &Place, inner: &mut Place) -> Result<()> {
        let name = prim.path().as_str().rsplit('/').next().unwrap_or_default().to_owned();
        let purpose = scene.say(prim.attribute("purpose").get::<Value>())?;
        match purpose.as_ref().and_then(value::text).as_deref() {
            Some("guide") => inner.purpose = Purpose::Guide,
            Some("proxy") => inner.purpose = Purpose::Proxy,
            Some("render") => inner.purpose = Purpose::Shown,
            _ => {}
        }
        let own = self.prims.len();
        self.prims.push((prim.clone(), place.above));
        let kind = scene.say(prim.type_name())?;
        let kind = kind.as_ref().map(|kind| kind.as_str());
        match kind {
            Some("Skeleton") => self.skeletons.push((prim.clone(), own)),
            Some("SkelAnimation") => self.animations.push(prim.clone()),
            _ => {}
        }
        let schema = match kind {
            Some("BasisCurves") => Some(Schema::Basis),
            Some("NurbsCurves") => Some(Schema::Nurbs),
            Some("HermiteCurves") => Some(Schema::Hermite),
            Some("Mesh") => Some(Schema::Mesh),
            _ => None,
        };
        if let Some(schema) = schema {
            self.objects.push(Object {
                prim: prim.clone(),
                names: [name.clone(), place.name.clone()],
                schema,
                purpose: inner.purpose,
                own,
            });
        }
        (inner.name, inner.above) = (name, Some(own));
        Ok(())
    }

    /// A prim and all it is in, the innermost first.
    pub fn up(&self, object: &Object) -> impl Iterator<Item = &Prim> {
        self.above(object.own)
    }

    /// The same of the prim with this index among the transforms.
    pub fn above(&self, own: usize) -> impl Iterator<Item = &Prim> {
        let mut next = Some(own);
        std::iter::from_fn(move || {
            let (prim, above) = &self.prims[next?];
            next = *above;
            Some(prim)
        })
    }

    /// The time codes at which the points of objects or the transforms above them are sampled, in order.
    pub fn times(&self, scene: &Scene, objects: &[&Object]) -> Result<Vec<f64>> {
        let mut all = Vec::new();
        let mut seen = vec![false; self.prims.len()];
        for object in objects {
            all.extend(scene.say(object.prim.attribute("points").time_sample_times())?);
            let mut next = Some(object.own);
            while let Some(i) = next.filter(|i| !std::mem::replace(&mut seen[*i], true)) {
                let (prim, above) = &self.prims[i];
                for operation in operations(scene, prim, TimeCode::EARLIEST)? {
                    let name = operation.trim_start_matches(INVERSE).to_owned();
                    all.extend(scene.say(prim.attribute(name).time_sample_times())?);
                }
                next = *above;
            }
            // Samples of many objects are mostly the same.
            all.sort_by(f64::total_cmp);
            all.dedup();
        }
        all.retain(|time| time.is_finite());
        Ok(all)
    }

    /// From each prim's space to the file's, and whether it is to be seen, at `time`.
    pub fn places(&self, scene: &Scene, time: TimeCode) -> Result<Vec<(DMat4, bool)>> {
        let mut all: Vec<(DMat4, bool)> = Vec::with_capacity(self.prims.len());
        for (prim, above) in &self.prims {
            let (own, resets) = matrix(scene, prim, time)?;
            let (above, seen) = above.map_or((DMat4::IDENTITY, true), |above| all[above]);
            let visibility = scene.say(prim.attribute("visibility").get_at::<Value>(time))?;
            let hidden = visibility.as_ref().and_then(value::text).as_deref() == Some("invisible");
            all.push((if resets { own } else { above * own }, seen && !hidden));
        }
        Ok(all)
    }

    /// That of an object among them.
    pub fn of(object: &Object, places: &[(DMat4, bool)]) -> (DMat4, bool) {
        places[object.own]
    }
}

/// The time that is meant, and what to say of it.
pub(super) fn when(scene: &Scene, times: &[f64], moment: Moment) -> Result<(TimeCode, Option<String>)> {
    let per_second = Some(scene.stage.time_codes_per_second()).filter(|rate| *rate > 0.0).unwrap_or(24.0);
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return match moment {
            Moment::Frame(frame) if frame > 0 => {
                Err(scene.problem(format!("frame {frame} is asked for, but nothing moves in it")))
            }
            _ => Ok((TimeCode::new(0.0), None)),
        };
    };
    let time = match moment {
        Moment::First => *first,
        Moment::Frame(frame) => *times.get(frame as usize).ok_or_else(|| {
            scene.problem(format!("frame {frame} is asked for, but there are {}, from 0 on", times.len()))
        })?,
        Moment::Seconds(time) => {
            let far = |code: &f64| (code / per_second - time).abs();
            times.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(*first)
        }
    };
    let told = (times.len() > 1).then(|| {
        let [first, last, time] = [*first, *last, time].map(|code| code / per_second);
        format!("{} frames from {first:.3} to {last:.3} s, read at {time:.3} s", times.len())
    });
    Ok((TimeCode::new(time), told))
}

/// Before the name of an operation that is undone.
const INVERSE: &str = "!invert!";
/// Instead of a name: what is above does not count.
const RESET: &str = "!resetXformStack!";

fn operations(scene: &Scene, prim: &Prim, time: TimeCode) -> Result<Vec<String>> {
    let order = scene.say(prim.attribute("xformOpOrder").get_at::<Value>(time))?;
    Ok(order.as_ref().map(value::texts).unwrap_or_default())
}

/// The matrix of a prim's own operations, the outermost first, and whether those above it do not count.
fn matrix(scene: &Scene, prim: &Prim, time: TimeCode) -> Result<(DMat4, bool)> {
    let (mut matrix, mut resets) = (DMat4::IDENTITY, false);
    for name in operations(scene, prim, time)? {
        if name == RESET {
            (matrix, resets) = (DMat4::IDENTITY, true);
            continue;
        }
        let plain = name.strip_prefix(INVERSE);
        let name = plain.unwrap_or(&name);
        let Some(value) = scene.say(prim.attribute(name.to_owned()).get_at::<Value>(time))? else { continue };
        let Some(operation) = operation(name, &value) else {
            return Err(scene.problem(format!(
                "{}: {} is no operation that is known",
                super::excerpt(prim.path().as_str()),
                super::excerpt(name)
            )));
        };
        matrix *= if plain.is_some() { operation.inverse() } else { operation };
    }
    if !matrix.is_finite() {
        let path = super::excerpt(prim.path().as_str());
        return Err(scene.problem(format!("the transform of {path} is not finite or has no inverse")));
    }
    Ok((matrix, resets))
}

/// `xformOp:` and what it does, and perhaps a name.
fn operation(name: &str, value: &Value) -> Option<DMat4> {
    let mut parts = name.split(':');
    let kind = parts.next().filter(|space| *space == "xformOp").and_then(|_| parts.next())?;
    if kind == "orient" {
        return Some(DMat4::from_quat(value::turn(value::rotation(value)?)));
    }
    let (numbers, width) = value::row(value, |number| number)?;
    let three = || DVec3::from_slice(numbers.get(..3).unwrap_or(&[0.0; 3]));
    let about = |axis: char, degrees: f64| match axis {
        'X' => DMat4::from_rotation_x(degrees.to_radians()),
        'Y' => DMat4::from_rotation_y(degrees.to_radians()),
        _ => DMat4::from_rotation_z(degrees.to_radians()),
    };
    let axes = kind.strip_prefix("rotate").unwrap_or_default();
    match (kind, width) {
        ("translate", 3) => Some(DMat4::from_translation(three())),
        ("scale", 3) => Some(DMat4::from_scale(three())),
        ("translateX" | "translateY" | "translateZ" | "scaleX" | "scaleY" | "scaleZ", 1) => {
            let axis = kind.bytes().last().map_or(0, |axis| usize::from(axis - b'X'));
            let moves = kind.starts_with('t');
            let mut all = if moves { DVec3::ZERO } else { DVec3::ONE };
            all[axis] = numbers[0];
            Some(if moves { DMat4::from_translation(all) } else { DMat4::from_scale(all) })
        }
        ("transform", 16) => value::matrices(value).first().copied(),
        (_, 1) if matches!(axes, "X" | "Y" | "Z") => {
            Some(about(axes.chars().next().unwrap_or_default(), numbers[0]))
        }
        // The first turns first. Angles are those about x, y and z in any order.
        (_, 3) if axes.len() == 3 && ['X', 'Y', 'Z'].iter().all(|axis| axes.contains(*axis)) => {
            let angles = three();
            let turn = |axis: char| about(axis, angles[usize::from(axis as u8 - b'X')]);
            Some(axes.chars().fold(DMat4::IDENTITY, |all, axis| turn(axis) * all))
        }
        _ => None,
    }
}
