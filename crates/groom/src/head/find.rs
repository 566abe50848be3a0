//! Finds the landmarks of a head in its mesh.
//!
//! The mesh is upright, in meters, with the face towards +Z ([`orient`](crate::orient)); it may have a body. Two
//! outlines are enough: the profile in the plane between left and right, and the width at each height. The neck is
//! where the width is smallest below the head. The tip of the nose is where the profile is farthest in front, and the
//! chin where it recedes to the throat. The other landmarks follow from these by the proportions of the built-in head.

use crate::{Error, Result, TriMesh, mannequin, scalp::Landmarks};
use glam::Vec3;
use std::ops::Range;

/// Distance between the heights that are looked at, meters.
const STEP: f32 = 1e-3;
/// Largest distance from the crown at which a neck is looked for, meters.
const LOWEST: f32 = 0.6;
/// Width of a neck relative to the head's.
const NECK: f32 = 0.85;
/// Growth of the width from the neck to the shoulders.
const SHOULDERS: f32 = 1.1;
/// Part of the way from the crown to the neck in which the nose lies.
const NOSE: Range<f32> = 0.4..0.95;
/// Rows of the lips and of the lowest throat below the nose, relative to its distance from the crown.
const LIPS: Range<f32> = 0.17..0.4;
const THROAT: f32 = 0.8;
/// Distance of brow and ear from the nose, relative to the distance of the crown.
const BROW: f32 = of_nose(mannequin::BROW);
const EAR: f32 = of_nose(mannequin::EAR);
/// Part of the way from the lips back to the throat at which the chin ends.
const CHIN: f32 = 0.7;
/// Height of the nape relative to the distance between chin and crown.
const NAPE: f32 = (mannequin::NAPE.y - mannequin::CHIN.y) / HEIGHT;
/// Distance from the built-in head's chin to its crown, meters.
const HEIGHT: f32 = mannequin::CROWN.y - mannequin::CHIN.y;

/// Offset of the skull's center from the middle between brow and back, relative to the height; and place of the ear
/// beside the skull relative to the half width there.
const SKULL: f32 = -0.0366;
const EAR_SIDE: f32 = 0.972;

const fn of_nose(mark: Vec3) -> f32 {
    (mark.y - mannequin::NOSE_TIP.y) / (mannequin::CROWN.y - mannequin::NOSE_TIP.y)
}

/// A head that was found in a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadShape {
    /// Its landmarks, meters.
    pub landmarks: Landmarks,
    /// Highest point, meters.
    pub crown: Vec3,
}

impl HeadShape {
    /// Finds the head of `mesh`.
    ///
    /// # Errors
    /// [`Error::Unusable`] if the mesh has no triangles, neck or nose.
    pub fn of(mesh: &TriMesh) -> Result<Self> {
        let outlines = Outlines::new(mesh).ok_or_else(|| unusable("it has no triangles"))?;
        outlines.head()
    }

    /// Returns the size relative to the built-in head.
    pub fn size(&self) -> f32 {
        (self.crown.y - self.landmarks.chin.y) / HEIGHT
    }
}

fn unusable(problem: &str) -> Error {
    Error::Unusable(format!("no head was found in the mesh: {problem}"))
}

/// Outlines of the upper end of a mesh. Entry `i` of each is at the height `top - i STEP`.
struct Outlines {
    /// Middle between left and right, meters.
    center_x: f32,
    top: Vec3,
    /// Smallest and largest x.
    sides: Vec<(f32, f32)>,
    /// Smallest and largest z in the middle plane.
    profile: Vec<(f32, f32)>,
}

const NOTHING: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

/// Calls `with` for each crossing of a triangle's edge with the plane where `of` is zero: always two of a triangle.
fn crossing([a, b, c]: [Vec3; 3], of: impl Fn(Vec3) -> f32) -> Option<[Vec3; 2]> {
    let mut found = [Vec3::ZERO; 2];
    let mut count = 0;
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (d, e) = (of(p), of(q));
        if (d < 0.0) != (e < 0.0) && count < 2 {
            found[count] = p.lerp(q, d / (d - e));
            count += 1;
        }
    }
    (count == 2).then_some(found)
}

impl Outlines {
    fn new(mesh: &TriMesh) -> Option<Self> {
        let triangles = || mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize]));
        let top = triangles().flatten().reduce(|top, p| if p.y > top.y { p } else { top })?;
        let low = triangles().flatten().fold(top.y, |low, p| low.min(p.y)).max(top.y - LOWEST);
        let count = ((top.y - low) / STEP) as usize;
        let rows = |lo: f32, hi: f32| {
            let row = |y: f32| ((top.y - y) / STEP).clamp(0.0, count as f32);
            row(hi).ceil() as usize..row(lo).ceil() as usize
        };
        let mut sides = vec![NOTHING; count];
        for t in triangles() {
            let [a, b, c] = t.map(|p| p.y);
            for i in rows(a.min(b).min(c), a.max(b).max(c)) {
                for p in crossing(t, |p| p.y - (top.y - i as f32 * STEP)).into_iter().flatten() {
                    sides[i] = (sides[i].0.min(p.x), sides[i].1.max(p.x));
                }
            }
        }
        // The upper tenth of a head and its hairline are symmetric even if shoulders are not.
        let upper = &sides[..count.min(60)];
        let (sum, of) = upper
            .iter()
            .filter(|(lo, hi)| lo < hi)
            .fold((0.0, 0.0f32), |(sum, of), (lo, hi)| (sum + 0.5 * (lo + hi), of + 1.0));
        let center_x = sum / of.max(1.0);
        let mut profile = vec![NOTHING; count];
        for t in triangles() {
            let Some([p, q]) = crossing(t, |p| p.x - center_x) else { continue };
            for i in rows(p.y.min(q.y), p.y.max(q.y)) {
                let z = p.z + (q.z - p.z) * ((top.y - i as f32 * STEP - p.y) / (q.y - p.y));
                profile[i] = (profile[i].0.min(z), profile[i].1.max(z));
            }
        }
        Some(Self { center_x, top, sides, profile })
    }

    fn width(&self, row: usize) -> f32 {
        let (lo, hi) = self.sides[row];
        (hi - lo).max(0.0)
    }

    /// Returns the row of the neck: the narrowest below the widest part of the head.
    fn neck(&self) -> Option<usize> {
        let (mut widest, mut narrowest) = (0.0f32, (0usize, f32::MAX));
        for row in 0..self.sides.len() {
            let width = self.width(row);
            if width > widest && narrowest.1 >= NECK * widest {
                (widest, narrowest) = (width, (row, f32::MAX));
            }
            if width < narrowest.1 {
                narrowest = (row, width);
            }
            if narrowest.1 < NECK * widest && width > SHOULDERS * narrowest.1 {
                break;
            }
        }
        (narrowest.1 < NECK * widest).then_some(narrowest.0)
    }

    fn front(&self, row: usize) -> f32 {
        self.profile[row.min(self.profile.len() - 1)].1
    }

    /// Returns the row of the largest of `of` in `rows`.
    fn largest(rows: Range<usize>, of: impl Fn(usize) -> f32) -> Option<usize> {
        rows.reduce(|best, row| if of(row) > of(best) { row } else { best })
    }

    fn head(&self) -> Result<HeadShape> {
        let neck = self
            .neck()
            .ok_or_else(|| unusable("it has no neck, a part that is narrower than the head above it"))?;
        let part = |x: f32| (x * neck as f32) as usize;
        let front = |row: usize| self.front(row);
        let is_complete = |row: &usize| self.profile[*row].0 < self.profile[*row].1;
        let nose = Self::largest(part(NOSE.start)..part(NOSE.end), front).filter(is_complete);
        let nose = nose.ok_or_else(|| unusable("its face is open in the middle"))?;
        // Below the nose, the profile recedes from the lips to the throat. The chest may be in front of both.
        let below = |fraction: f32| nose + (fraction * nose as f32) as usize;
        let last = self.profile.len();
        let lips = Self::largest(below(LIPS.start)..below(LIPS.end).min(last), front);
        let lips = lips.ok_or_else(|| unusable("its nose is at its lower end"))?;
        let throat = Self::largest(lips..below(THROAT).min(last), |row| -front(row)).unwrap_or(neck);
        let recedes = front(lips) + CHIN * (front(throat) - front(lips));
        let chin = (lips..throat).rev().find(|row| front(*row) >= recedes).unwrap_or(lips);
        let row = |fraction: f32| nose - (fraction * nose as f32) as usize;
        let (brow, ear) = (row(BROW), row(EAR));
        let nape = chin - (NAPE * chin as f32) as usize;
        let point = |row: usize, z: f32| Vec3::new(self.center_x, self.top.y - row as f32 * STEP, z);
        let (back, face) = self.profile[brow];
        if !(face - back).is_finite() || face <= back {
            return Err(unusable("its forehead is open in the middle"));
        }
        let height = chin as f32 * STEP;
        let skull = point(brow, 0.5 * (back + face) + SKULL * height);
        let ear = Vec3::new(
            self.center_x + 0.5 * self.width(brow) * EAR_SIDE,
            point(ear, 0.0).y,
            skull.z + (mannequin::EAR.z - mannequin::SKULL_CENTER.z) / HEIGHT * height,
        );
        let landmarks = Landmarks {
            skull,
            brow: point(brow, face),
            chin: point(chin, front(chin)),
            ear,
            nape: point(nape, self.profile[nape].0),
        };
        Ok(HeadShape { landmarks, crown: Vec3::new(self.center_x, self.top.y, self.top.z) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn built_in_head_is_found_in_its_mesh() {
        // Elsewhere and of another size too.
        for (scale, offset) in [(1.0, Vec3::ZERO), (1.3, Vec3::new(0.4, 1.5, -0.2)), (0.7, Vec3::Y)] {
            let mut mesh = mannequin::mesh(96);
            mesh.transform(scale, glam::Quat::IDENTITY, offset);
            let found = HeadShape::of(&mesh).unwrap();
            let (is, should) = (found.landmarks, mannequin::LANDMARKS);
            let pairs = [
                (is.skull, should.skull),
                (is.brow, should.brow),
                (is.ear, should.ear),
                (is.nape, should.nape),
                (is.chin, should.chin),
            ];
            for (is, should) in pairs {
                let is = (is - offset) / scale;
                assert!(is.distance(should) < 0.011, "{is} {should} at scale {scale}");
            }
            assert!((found.size() / scale - 1.0).abs() < 0.04, "{}", found.size());
        }
    }

    #[test]
    fn meshes_without_a_head_are_refused() {
        let problem = |mesh: &TriMesh| HeadShape::of(mesh).unwrap_err().to_string();
        assert!(problem(&TriMesh::default()).contains("no triangles"));
        assert!(problem(&shapes::cuboid(Vec3::splat(0.1))).contains("no neck"));
        let mut flat = shapes::cuboid(Vec3::splat(0.1));
        flat.positions.iter_mut().for_each(|p| p.y = 0.0);
        assert!(HeadShape::of(&flat).is_err());
    }

    /// Heights from the crown that were read off the profiles of the files: nose, chin.
    #[test]
    fn heads_of_files_are_found() {
        let Some(assets) = std::env::var_os("TRESSES_ASSETS") else {
            return println!("no TRESSES_ASSETS: the heads of files are not looked at");
        };
        let heads = [
            ("head_ict_facekit/generic_neutral_mesh.obj", 0.226),
            ("head_makehuman/head_crop.obj", 0.233),
            ("sintel/sintel.obj", 0.244),
            ("tressfx2_head/head_max4.obj", 0.215),
        ];
        for (name, chin) in heads {
            let path = std::path::Path::new(&assets).join(name);
            let (mesh, _) = crate::import::read_head(&[path], &Default::default()).unwrap();
            let found = HeadShape::of(&mesh).unwrap();
            let height = found.crown.y - found.landmarks.chin.y;
            assert!((height - chin).abs() < 0.008, "{name}: {found:?} {height}");
        }
    }
}
