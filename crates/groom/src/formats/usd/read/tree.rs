//! The prims of a scene with geometry, and the transforms above them.

use glam::{DMat4, DVec3};
use openusd::{
    sdf::{self, Value},
    usd::{Prim, PrimPredicate, TimeCode},
};

use super::{Moment, Scene, value};
use crate::error::Result;

/// Maximum depth of nested prims.
const DEEPEST: usize = 200;
/// Prims that a file may have in addition to one per byte.
const FREE: u64 = 1000;

/// Schema of a prim with geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Schema {
    Basis,
    Nurbs,
    Hermite,
    Mesh,
}

/// Purpose of a prim, which its descendants inherit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Visible geometry.
    #[default]
    Shown,
    /// A stand-in for visible geometry.
    Proxy,
    /// A helper for artists.
    Guide,
}

/// A prim with geometry.
pub(super) struct Object {
    pub prim: Prim,
    /// Names of the prim and of its parent.
    pub names: [String; 2],
    pub schema: Schema,
    pub purpose: Purpose,
    /// Index in `Tree::prims`.
    own: usize,
}

/// All prims, with lists of those that the readers need.
#[derive(Default)]
pub(super) struct Tree {
    pub objects: Vec<Object>,
    /// Skeletons, each with its index in `prims`.
    pub skeletons: Vec<(Prim, usize)>,
    /// Animations of skeletons.
    pub animations: Vec<Prim>,
    /// All prims, each with the index of its parent, which precedes it.
    prims: Vec<(Prim, Option<usize>)>,
}

/// Position of the traversal in the tree.
#[derive(Clone, Default)]
struct PrimCursor {
    depth: usize,
    above: Option<usize>,
    name: String,
    purpose: Purpose,
}

impl Tree {
    pub fn read(scene: &Scene) -> Result<Self> {
        let mut tree = Self::default();
        let mut rest = vec![(sdf::Path::abs_root(), PrimCursor::default())];
        while let Some((path, cursor)) = rest.pop() {
            let prim = scene.say(scene.stage.prim(path).map_err(Into::into))?;
            let mut inner = cursor.clone();
            inner.depth += 1;
            if cursor.depth > 0 {
                if !scene.say(scene.stage.prim_matches(prim.path(), PrimPredicate::DEFAULT_PROXIES))? {
                    continue;
                }
                let max_prims = scene.bytes.get().saturating_add(FREE);
                if cursor.depth > DEEPEST || tree.prims.len() as u64 >= max_prims {
                    let problem = format!(
                        "the file has more than {max_prims} prims, or nests them more than {DEEPEST} levels deep"
                    );
                    return Err(scene.problem(problem));
                }
                tree.add(scene, &prim, &cursor, &mut inner)?;
            }
            let children = scene.say(prim.children())?;
            rest.extend(children.into_iter().rev().map(|child| (child.path().clone(), inner.clone())));
        }
        Ok(tree)
    }

    fn add(&mut self, scene: &Scene, prim: &Prim, cursor: &PrimCursor, inner: &mut PrimCursor) -> Result<()> {
        let name = prim.path().as_str().rsplit('/').next().unwrap_or_default().to_owned();
        let purpose = scene.say(prim.attribute("purpose").get::<Value>())?;
        match purpose.as_ref().and_then(value::text).as_deref() {
            Some("guide") => inner.purpose = Purpose::Guide,
            Some("proxy") => inner.purpose = Purpose::Proxy,
            Some("render") => inner.purpose = Purpose::Shown,
            _ => {}
        }
        let own = self.prims.len();
        self.prims.push((prim.clone(), cursor.above));
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
                names: [name.clone(), cursor.name.clone()],
                schema,
                purpose: inner.purpose,
                own,
            });
        }
        (inner.name, inner.above) = (name, Some(own));
        Ok(())
    }

    /// Returns a prim and its ancestors, the innermost first.
    pub fn up(&self, object: &Object) -> impl Iterator<Item = &Prim> {
        self.above(object.own)
    }

    /// [`Self::up`] of the prim with this index.
    pub fn above(&self, own: usize) -> impl Iterator<Item = &Prim> {
        let mut next = Some(own);
        std::iter::from_fn(move || {
            let (prim, above) = &self.prims[next?];
            next = *above;
            Some(prim)
        })
    }

    /// Returns the sorted time codes at which the points of objects or the transforms above them have samples.
    pub fn times(&self, scene: &Scene, objects: &[&Object]) -> Result<Vec<f64>> {
        let mut all = Vec::new();
        let mut visited = vec![false; self.prims.len()];
        for object in objects {
            all.extend(scene.say(object.prim.attribute("points").time_sample_times())?);
            let mut next = Some(object.own);
            while let Some(i) = next.filter(|i| !std::mem::replace(&mut visited[*i], true)) {
                let (prim, above) = &self.prims[i];
                for operation in operations(scene, prim, TimeCode::EARLIEST)? {
                    let name = operation.trim_start_matches(INVERSE).to_owned();
                    all.extend(scene.say(prim.attribute(name).time_sample_times())?);
                }
                next = *above;
            }
            // Most objects are sampled at the same times.
            all.sort_by(f64::total_cmp);
            all.dedup();
        }
        all.retain(|time| time.is_finite());
        Ok(all)
    }

    /// Returns for each prim the matrix from its space to the file's, and whether it is visible, at `time`.
    pub fn transforms(&self, scene: &Scene, time: TimeCode) -> Result<Vec<(DMat4, bool)>> {
        let mut all: Vec<(DMat4, bool)> = Vec::with_capacity(self.prims.len());
        for (prim, above) in &self.prims {
            let (own, resets) = matrix(scene, prim, time)?;
            let (above, is_visible) = above.map_or((DMat4::IDENTITY, true), |above| all[above]);
            let visibility = scene.say(prim.attribute("visibility").get_at::<Value>(time))?;
            let hidden = visibility.as_ref().and_then(value::text).as_deref() == Some("invisible");
            all.push((if resets { own } else { above * own }, is_visible && !hidden));
        }
        Ok(all)
    }

    /// Returns the matrix and visibility of an object, of those that [`Self::transforms`] returned.
    pub fn of(object: &Object, transforms: &[(DMat4, bool)]) -> (DMat4, bool) {
        transforms[object.own]
    }
}

/// Returns the time code that `moment` selects, and a note on the file's frames.
pub(super) fn when(scene: &Scene, times: &[f64], moment: Moment) -> Result<(TimeCode, Option<String>)> {
    let per_second = Some(scene.stage.time_codes_per_second()).filter(|rate| *rate > 0.0).unwrap_or(24.0);
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return match moment {
            Moment::Frame(frame) if frame > 0 => {
                Err(scene.problem(format!("frame {frame} does not exist; the file is not animated")))
            }
            _ => Ok((TimeCode::new(0.0), None)),
        };
    };
    let time = match moment {
        Moment::First => *first,
        Moment::Frame(frame) => *times.get(frame as usize).ok_or_else(|| {
            scene.problem(format!(
                "frame {frame} does not exist; the file has {} frames, counted from 0",
                times.len()
            ))
        })?,
        Moment::Seconds(time) => {
            let far = |code: &f64| (code / per_second - time).abs();
            times.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(*first)
        }
    };
    let note = (times.len() > 1).then(|| {
        let [first, last, time] = [*first, *last, time].map(|code| code / per_second);
        format!("{} frames from {first:.3} to {last:.3} s, read at {time:.3} s", times.len())
    });
    Ok((TimeCode::new(time), note))
}

/// Prefix of the inverse of an operation.
const INVERSE: &str = "!invert!";
/// Operation that discards the transforms above.
const RESET: &str = "!resetXformStack!";

fn operations(scene: &Scene, prim: &Prim, time: TimeCode) -> Result<Vec<String>> {
    let order = scene.say(prim.attribute("xformOpOrder").get_at::<Value>(time))?;
    Ok(order.as_ref().map(value::texts).unwrap_or_default())
}

/// Returns the matrix of a prim's own operations, the outermost first, and whether the transforms above are discarded.
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
                "{}: the transform operation {} is unknown",
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

/// Returns the matrix of an operation `xformOp:type`, which may have a suffix.
fn operation(name: &str, value: &Value) -> Option<DMat4> {
    let mut parts = name.split(':');
    let kind = parts.next().filter(|space| *space == "xformOp").and_then(|_| parts.next())?;
    if kind == "orient" {
        return Some(DMat4::from_quat(value::normalized_quaternion(value::rotation(value)?)));
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
        // The first axis of the name applies first. The angles are those about x, y and z in any case.
        (_, 3) if axes.len() == 3 && ['X', 'Y', 'Z'].iter().all(|axis| axes.contains(*axis)) => {
            let angles = three();
            let axis_rotation = |axis: char| about(axis, angles[usize::from(axis as u8 - b'X')]);
            Some(axes.chars().fold(DMat4::IDENTITY, |all, axis| axis_rotation(axis) * all))
        }
        _ => None,
    }
}
