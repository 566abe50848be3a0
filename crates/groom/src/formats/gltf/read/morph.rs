//! Morph targets, merged by name over all meshes.

use std::collections::{HashMap, HashSet};

use super::file::File;
use crate::{
    error::Result,
    rig::{Delta, MorphTarget},
};
use glam::Vec3;

/// The morph targets read so far.
#[derive(Default)]
pub(super) struct Shapes {
    pub targets: Vec<MorphTarget>,
    named: HashMap<String, u32>,
    /// For each visited mesh, the indices of its targets in `targets`.
    meshes: HashMap<usize, Vec<u32>>,
}

impl Shapes {
    /// Returns the indices in `targets` of a mesh's targets, in the mesh's order.
    pub fn of(&self, mesh: usize) -> &[u32] {
        self.meshes.get(&mesh).map_or(&[], Vec::as_slice)
    }

    /// Adds the names of a mesh's targets.
    pub fn name(&mut self, file: &File, mesh: &gltf::Mesh) -> Result<()> {
        let root = file.document.as_json();
        let primitives = root.meshes.get(mesh.index()).map_or(&[][..], |m| &m.primitives);
        let count = primitives.iter().filter_map(|p| p.targets.as_ref()).map(Vec::len).max().unwrap_or(0);
        if count == 0 || self.meshes.contains_key(&mesh.index()) {
            return Ok(());
        }
        let all = names(mesh, count).into_iter().map(|name| {
            let next = self.targets.len() as u32;
            let index = *self.named.entry(name.clone()).or_insert(next);
            if index == next {
                self.targets.push(MorphTarget { name, deltas: Vec::new() });
            }
            index
        });
        let all = all.collect();
        self.meshes.insert(mesh.index(), all);
        Ok(())
    }

    /// Reads the targets of a primitive whose `count` vertices start at `base`.
    pub fn read(
        &mut self,
        file: &File,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        (base, count): (usize, usize),
    ) -> Result<()> {
        let shapes = self.meshes.get(&mesh.index()).map_or(&[][..], Vec::as_slice);
        for (shape, target) in shapes.iter().zip(primitive.morph_targets()) {
            let read = |accessor: Option<gltf::Accessor>| {
                accessor.map_or(Ok(Vec::new()), |accessor| file.deltas(&accessor, count))
            };
            let (positions, normals) = (read(target.positions())?, read(target.normals())?);
            file.spend(positions.len() + normals.len(), size_of::<Delta>())?;
            let Some(target) = self.targets.get_mut(*shape as usize) else { continue };
            merge(&positions, &normals, base as u32, &mut target.deltas);
        }
        Ok(())
    }
}

/// Merges deltas of positions and of normals, each in ascending order of vertices, into one list.
fn merge(positions: &[(u32, Vec3)], normals: &[(u32, Vec3)], base: u32, out: &mut Vec<Delta>) {
    let mut remaining_normals = normals.iter().copied().peekable();
    for (vertex, position) in positions {
        while let Some((before, normal)) = remaining_normals.next_if(|(v, _)| v < vertex) {
            out.push(Delta { vertex: before + base, position: Vec3::ZERO, normal });
        }
        let normal = remaining_normals.next_if(|(v, _)| v == vertex).map_or(Vec3::ZERO, |(_, n)| n);
        out.push(Delta { vertex: vertex + base, position: *position, normal });
    }
    out.extend(remaining_normals.map(|(v, normal)| Delta { vertex: v + base, position: Vec3::ZERO, normal }));
}

/// Returns unique names of a mesh's targets: those in `extras.targetNames`, or numbers.
fn names(mesh: &gltf::Mesh, count: usize) -> Vec<String> {
    let extras =
        mesh.extras().as_ref().and_then(|raw| serde_json::from_str::<serde_json::Value>(raw.get()).ok());
    let given = extras.as_ref().and_then(|e| e.get("targetNames")).and_then(|n| n.as_array());
    let mut used = HashSet::with_capacity(count);
    let name = |i: usize| {
        let name = given.and_then(|all| all.get(i)).and_then(|n| n.as_str());
        let mut name = name.map_or_else(|| format!("morph {i}"), String::from);
        if used.contains(&name) {
            name = format!("{name} {i}");
        }
        while !used.insert(name.clone()) {
            name.push('\'');
        }
        name
    };
    (0..count).map(name).collect()
}
