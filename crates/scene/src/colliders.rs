//! Reads colliders, animated shapes, from a file for `--colliders`.
//!
//! ```json
//! {"colliders": [
//!   {"shape": {"capsule": {"radius": 0.035, "half_length": 0.15}},
//!    "keys": [{"time": 0, "translation": [0.2, 1.5, -0.3]}, {"time": 1, "translation": [0.2, 1.5, 0.3]}]},
//!   {"shape": {"ellipsoid": {"radii": [0.05, 0.08, 0.05]}}, "anchor": "head", "friction": 2,
//!    "keys": [{"time": 0, "rotation": [0, 20, 0], "translation": [0, 0.2, 0]}]},
//!   {"shape": {"mesh": {"file": "hand.obj", "resolution": 64}}, "loop": true, "keys": […]}
//!  ],
//!  "joints": [
//!   {"joint": "LeftArm", "shape": {"capsule": {"from": [0.2, 1.4, 0], "to": [0.45, 1.4, 0], "radius": 0.05}}},
//!   {"joint": "LeftHand", "shape": "fit", "friction": 2}, {"joint": "Tail", "shape": "none"}
//! ]}
//! ```
//! Units are meters, seconds and degrees (yaw, pitch, roll). Meshes are in meters, Y up, with paths relative to the
//! file; their distance fields are computed on the GPU. `joints` names joints of a skinned body, as listed by `tresses
//! info`. The part of the body at a joint moves with it and collides as its distance `field`, as a fitted capsule
//! (`fit`), as an explicit capsule (groom space, body at rest), or not at all (`none`).

use crate::{
    motion::{Keyframe, Motion},
    shelf::Shelf,
};
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use tresses::{
    BodyMaterial, Obstacle, Pose,
    collide::{Anchor, Collider, FieldId, FieldSource, Shape},
    glam::Vec3,
    groom::{
        TriMesh, import,
        mesh::SdfOptions,
        rig::anatomy::{Anatomy, Capsule, DistanceFieldSource, PartForm},
    },
    low_level::FieldBuilder,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    colliders: Option<Vec<Entry>>,
    joints: Option<Vec<JointCollider>>,
}

/// Collider settings of a joint.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointCollider {
    /// Joint name, or `#` and the index of its node.
    pub joint: String,
    /// Collision shape of the joint's part.
    pub shape: Role,
    /// Factor on the coefficient of friction.
    #[serde(default = "one")]
    pub friction: f32,
}

/// Collision shape of the part of a body that a joint carries.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Role {
    /// The distance field of the part.
    Field,
    /// The capsule that fits the part best.
    #[serde(rename = "fit")]
    Fitted,
    /// An explicit capsule, in groom space at rest, meters.
    Capsule {
        /// One end of the axis.
        from: [f32; 3],
        /// The other end of the axis.
        to: [f32; 3],
        /// Radius.
        radius: f32,
    },
    /// No collision.
    #[serde(rename = "none")]
    Nothing,
}

impl JointCollider {
    /// Returns the collision shape of the joint's part. `fitted` is the capsule fitted to it.
    fn form(&self, fitted: Option<Capsule>) -> Result<PartForm> {
        Ok(match self.shape {
            Role::Nothing => PartForm::Nothing,
            Role::Field => PartForm::Field,
            Role::Capsule { from, to, radius } => {
                PartForm::Capsule(Capsule { ends: [from, to].map(Vec3::from), radius })
            }
            Role::Fitted => PartForm::Capsule(fitted.with_context(|| {
                format!(
                    "joint {:?} carries too few vertices to fit a capsule; choose another shape",
                    self.joint
                )
            })?),
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    shape: Form,
    #[serde(default)]
    anchor: Base,
    #[serde(default = "one")]
    friction: f32,
    #[serde(default, rename = "loop")]
    repeats: bool,
    keys: Vec<Keyframe>,
}

fn one() -> f32 {
    1.0
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Base {
    #[default]
    World,
    Head,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Form {
    Capsule {
        radius: f32,
        #[serde(default)]
        half_length: f32,
    },
    Ellipsoid {
        radii: [f32; 3],
    },
    Mesh {
        file: PathBuf,
        resolution: Option<u32>,
    },
}

/// Colliders from a file.
#[derive(Default)]
pub struct Colliders {
    /// Shapes, anchors and friction.
    pub list: Vec<Collider>,
    /// Meshes for drawing, each in its own frame.
    meshes: Vec<TriMesh>,
    motions: Vec<Motion>,
    fields: Vec<DistanceFieldSource>,
    /// Settings of a skinned body's joints.
    joints: Vec<JointCollider>,
    /// Center and radius of the ball, meters.
    ball: Option<(Vec3, f32)>,
}

impl Colliders {
    /// Reads the file at `path` and the meshes that it names.
    ///
    /// # Errors
    /// Fails if the file or a mesh cannot be read. The message names the file.
    pub fn read(path: &Path, files: &Shelf) -> Result<Self> {
        let bytes = files.load(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&bytes, folder, files).with_context(|| path.display().to_string())
    }

    fn parse(text: &[u8], folder: &Path, files: &Shelf) -> Result<Self> {
        let File { colliders, joints } = serde_json::from_slice(text)?;
        ensure!(colliders.is_some() || joints.is_some(), "the file has neither colliders nor joints");
        let joints = joints.unwrap_or_default();
        for JointCollider { joint, shape, friction } in &joints {
            let numbers = match shape {
                Role::Capsule { from, to, radius } => [from.as_slice(), to, &[*radius, *friction]].concat(),
                _ => vec![*friction],
            };
            ensure!(numbers.iter().all(|x| x.is_finite()), "joint {joint:?}: a value is not a finite number");
        }
        let mut all = Self { joints, ..Self::default() };
        for (i, entry) in colliders.into_iter().flatten().enumerate() {
            all.add(entry, folder, files).with_context(|| format!("collider {i}"))?;
        }
        Ok(all)
    }

    fn add(&mut self, entry: Entry, folder: &Path, files: &Shelf) -> Result<()> {
        let (shape, look) = match entry.shape {
            Form::Capsule { radius, half_length } => {
                let stretch = |p: Vec3| p * radius + Vec3::Y * half_length * p.y.signum();
                (Shape::Capsule { half_length, radius }, ball(stretch))
            }
            Form::Ellipsoid { radii } => {
                let radii = Vec3::from(radii);
                (Shape::Ellipsoid { radii }, ball(|p| p * radii))
            }
            Form::Mesh { file, resolution } => {
                let path = folder.join(file);
                let mesh = match files.holds(&path) || cfg!(target_arch = "wasm32") {
                    true => import::mesh::read_given(&files.given(), &path)?.mesh,
                    false => import::mesh::read(&path)?.mesh,
                };
                let options = SdfOptions { resolution: resolution.unwrap_or(64), ..Default::default() };
                self.fields.push(DistanceFieldSource::Mesh(mesh.clone(), options));
                (Shape::Field(FieldId(self.fields.len() as u32 - 1)), mesh)
            }
        };
        ensure!(entry.friction.is_finite(), "friction is not a finite number");
        let anchor = match entry.anchor {
            Base::World => Anchor::World,
            Base::Head => Anchor::Head,
        };
        let is_rigid = |key: &Keyframe| key.lean == [0.0; 3] && key.shapes.is_empty();
        ensure!(entry.keys.iter().all(is_rigid), "keys of colliders cannot have lean or shapes");
        self.motions.push(Motion::keyed(entry.keys, entry.repeats)?);
        self.list.push(Collider { shape, anchor, friction: entry.friction });
        self.meshes.push(look);
        Ok(())
    }

    /// Returns the joint settings of the file.
    pub fn joints(&self) -> &[JointCollider] {
        &self.joints
    }

    /// Applies the joint settings of the file to a body's `anatomy`; `mesh` is the body's mesh.
    ///
    /// # Errors
    /// Fails for joints that do not exist, that carry no part, or that carry the head.
    pub fn arrange(&self, anatomy: &mut Anatomy, mesh: &TriMesh) -> Result<()> {
        for joint in &self.joints {
            let named = anatomy.named(&joint.joint)?;
            if named.contains(&anatomy.head.node) {
                bail!(
                    "hair grows on joint {:?}: its shape is always a distance field; remove the entry",
                    joint.joint
                );
            }
            let mut found = false;
            for i in 0..anatomy.parts.len() {
                let node = anatomy.parts[i].node;
                if !named.contains(&node) {
                    continue;
                }
                found = true;
                let known = anatomy.parts[i].fitted;
                let fitted = match joint.shape {
                    Role::Fitted => known.or_else(|| anatomy.fit(node, mesh)),
                    _ => known,
                };
                let part = &mut anatomy.parts[i];
                part.fitted = fitted;
                part.friction = joint.friction;
                part.form = joint.form(fitted.map(|fitted| fitted.capsule))?;
            }
            if !found {
                bail!("joint {:?} carries no vertices; remove the entry", joint.joint);
            }
        }
        Ok(())
    }

    /// Returns the sources of the mesh colliders' distance fields.
    pub fn fields<'a>(&'a self, builder: &'a FieldBuilder) -> Vec<FieldSource<'a>> {
        let source = |field: &'a DistanceFieldSource| match field {
            DistanceFieldSource::Mesh(mesh, options) => FieldSource::Mesh { builder, mesh, options },
            DistanceFieldSource::Grid(grid) => FieldSource::Grid(grid),
        };
        self.fields.iter().map(source).collect()
    }

    /// Places a ball of `radius` (meters) at `at` in the world; `None` removes it. Returns whether it was added or
    /// removed.
    pub fn set_ball(&mut self, at: Option<Vec3>, radius: f32) -> bool {
        let had = self.ball.is_some();
        self.ball = at.map(|at| (at, radius));
        had != at.is_some()
    }

    /// Returns the ball as an obstacle.
    pub fn ball(&self) -> Option<Obstacle> {
        self.ball.map(|(at, radius)| Obstacle {
            id: 0,
            collider: Collider::new(Shape::sphere(radius)),
            pose: Pose { translation: at, ..Pose::IDENTITY },
        })
    }

    /// Returns the poses of the colliders at `time` (seconds), without the ball.
    pub fn poses(&self, time: f64) -> Vec<Pose> {
        self.motions.iter().map(|motion| motion.pose(time, Vec3::ZERO)).collect()
    }

    /// Returns the combined mesh of the colliders, the ball last, posed by `poses`. Colliders without a pose stay at
    /// the origin.
    pub fn mesh(&self, poses: &[Pose]) -> TriMesh {
        let mut all = TriMesh::default();
        // Default body color, for meshes without vertex colors.
        let skin = BodyMaterial::default().color;
        let ball = self.ball.map(|(_, radius)| ball(|p| p * radius));
        let poses = poses.iter().copied().chain(std::iter::repeat(Pose::IDENTITY));
        for (look, pose) in self.meshes.iter().chain(&ball).zip(poses) {
            let first = all.positions.len() as u32;
            all.positions.extend(look.positions.iter().map(|p| pose.point(*p)));
            all.normals.extend(look.normals.iter().map(|n| pose.rotation * *n));
            let colored = look.colors.len() == look.positions.len();
            let colors = if colored { look.colors.clone() } else { vec![skin; look.positions.len()] };
            all.colors.extend(colors);
            all.triangles.extend(look.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        all
    }
}

/// Returns a unit sphere with `stretch` applied to each point.
fn ball(stretch: impl Fn(Vec3) -> Vec3) -> TriMesh {
    // Odd, so that no ring lies on the equator, where a capsule is split.
    const RINGS: u32 = 23;
    const SIDES: u32 = 48;
    let mut mesh = TriMesh::default();
    for ring in 0..=RINGS {
        let (r, y) = (ring as f32 * std::f32::consts::PI / RINGS as f32).sin_cos();
        let (r, y) = (r.abs(), -y);
        for side in 0..SIDES {
            let (s, c) = (side as f32 * std::f32::consts::TAU / SIDES as f32).sin_cos();
            mesh.positions.push(stretch(Vec3::new(r * s, y, r * c)));
            if ring < RINGS {
                let (a, b) = (ring * SIDES + side, ring * SIDES + (side + 1) % SIDES);
                mesh.triangles.extend([[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]);
            }
        }
    }
    mesh.normals = vec![Vec3::ZERO; mesh.positions.len()];
    for &[a, b, c] in &mesh.triangles {
        let [p, q, r] = [a, b, c].map(|v| mesh.positions[v as usize]);
        [a, b, c].iter().for_each(|v| mesh.normals[*v as usize] += (q - p).cross(r - p));
    }
    mesh.normals.iter_mut().for_each(|n| *n = n.normalize_or(Vec3::Y));
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::groom::mannequin;

    fn parse(text: &str) -> Result<Colliders> {
        Colliders::parse(text.as_bytes(), Path::new(""), &Shelf::default())
    }

    #[test]
    fn meshes_load_from_memory() {
        let text =
            br#"{"colliders": [{"shape": {"mesh": {"file": "far/leaf.obj"}}, "keys": [{"time": 0}]}]}"#;
        let mut files = Shelf::default();
        files.put("c.json".into(), *text);
        assert!(Colliders::read(Path::new("c.json"), &files).is_err(), "the mesh is not given");
        files.put("leaf.obj".into(), *b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let all = Colliders::read(Path::new("c.json"), &files).unwrap();
        assert_eq!((all.list.len(), all.meshes[0].triangles.len()), (1, 1));
    }

    #[test]
    fn colliders_parse() {
        let text = r#"{"colliders": [
            {"shape": {"capsule": {"radius": 0.03, "half_length": 0.1}},
             "keys": [{"time": 0, "translation": [0, 0, 0]}, {"time": 2, "translation": [1, 0, 0]}]},
            {"shape": {"ellipsoid": {"radii": [0.1, 0.2, 0.3]}}, "anchor": "head", "friction": 2,
             "keys": [{"time": 0, "translation": [0, 1, 0]}]}]}"#;
        let all = parse(text).unwrap();
        assert_eq!((all.list.len(), all.meshes.len()), (2, 2));
        assert_eq!((all.list[1].anchor, all.list[1].friction), (Anchor::Head, 2.0));
        assert!((all.poses(1.0)[0].translation - Vec3::X * 0.5).length() < 1e-6);
        assert_eq!(all.poses(9.0)[0].translation, Vec3::X);
        let (lo, hi) = all.meshes[0].bounds().unwrap();
        assert!((hi.y - 0.13).abs() < 1e-4 && (lo.y + 0.13).abs() < 1e-4 && (hi.x - 0.03).abs() < 1e-4);
        // Normals point outward.
        let look = &all.meshes[1];
        assert!(look.positions.iter().zip(&look.normals).all(|(p, n)| p.dot(*n) > 0.0));
        let together = all.mesh(&all.poses(0.0));
        assert_eq!(together.positions.len(), together.normals.len());
        assert_eq!(together.triangles.len(), look.triangles.len() + all.meshes[0].triangles.len());
    }

    #[test]
    fn set_ball_reports_changes() {
        let mut all = Colliders::default();
        assert!(all.set_ball(Some(Vec3::Y), 0.03) && !all.set_ball(Some(Vec3::X), 0.03));
        let ball = all.ball().unwrap();
        assert_eq!((ball.pose.translation, ball.collider.shape), (Vec3::X, Shape::sphere(0.03)));
        assert!(!all.mesh(&[ball.pose]).triangles.is_empty());
        assert!(all.set_ball(None, 0.03) && !all.set_ball(None, 0.03));
        assert!(all.ball().is_none() && all.mesh(&[]).triangles.is_empty());
    }

    #[test]
    fn joints_take_roles_from_the_file() {
        let mesh = mannequin::mesh(60);
        let built_in = Anatomy::built_in(&mesh, &mannequin::sdf(mannequin::FIELD_RESOLUTION));
        let arranged = |joints: &str| {
            let mut anatomy = built_in.clone();
            parse(&format!(r#"{{"joints": [{joints}]}}"#))?.arrange(&mut anatomy, &mesh)?;
            Ok::<_, anyhow::Error>(anatomy)
        };
        let anatomy = arranged(
            r#"{"joint": "torso", "shape": {"capsule": {"from": [0, 1, 0], "to": [0.3, 1, 0], "radius": 0.1}}, "friction": 2},
               {"joint": "Neck", "shape": "none"}"#,
        )
        .unwrap();
        let solids: Vec<_> = anatomy.solids().collect();
        let [torso] = &solids[..] else { panic!("the neck is none") };
        assert!(
            torso.friction == 2.0 && matches!(torso.form, PartForm::Capsule(Capsule { radius: 0.1, .. }))
        );
        let anatomy =
            arranged(r#"{"joint": "Neck", "shape": "fit"}, {"joint": "Torso", "shape": "field"}"#).unwrap();
        let PartForm::Capsule(neck) = anatomy.parts[0].form else { panic!("it was to be fitted") };
        assert!((0.03..0.09).contains(&neck.radius), "{neck:?}");
        assert_eq!(anatomy.parts[1].form, PartForm::Field);
        for (joints, why) in [
            (r#"{"joint": "Tail", "shape": "none"}"#, "no joint \"Tail\"; joints with parts: Neck, Torso"),
            (r#"{"joint": "Head", "shape": "none"}"#, "hair grows on"),
            (r#"{"joint": "Neck", "shape": "none", "friction": null}"#, "invalid type"),
        ] {
            let error = arranged(joints).err().map(|error| format!("{error:#}")).unwrap_or_default();
            assert!(error.contains(why), "{joints}: {error}");
        }
    }

    #[test]
    fn invalid_colliders_fail() {
        let bad = |text: &str| assert!(parse(text).is_err(), "{text}");
        bad("{}");
        bad(r#"{"joints": [{"joint": "Arm", "shape": "cone"}]}"#);
        bad(r#"{"joints": [{"joint": "Arm", "shape": {"capsule": {"from": [0, 0, 0], "radius": 0.1}}}]}"#);
        bad(r#"{"colliders": [{"shape": {"cone": {}}, "keys": [{"time": 0}]}]}"#);
        bad(r#"{"colliders": [{"shape": {"capsule": {"radius": 0.1}}, "keys": []}]}"#);
        bad(
            r#"{"colliders": [{"shape": {"capsule": {"radius": 0.1}}, "keys": [{"time": 0, "lean": [1, 0, 0]}]}]}"#,
        );
        bad(r#"{"colliders": [{"shape": {"mesh": {"file": "nowhere.obj"}}, "keys": [{"time": 0}]}]}"#);
    }
}
