//! Reads hair from a glTF file: `EXT_tresses_hair`, specified in `docs/reference/EXT_tresses_hair.md`.

use glam::{Vec2, Vec3};
use gltf::Accessor;
use serde_json::{Map, Value};

use super::{file::File, lights, packed, walk};
use crate::{
    Look, Strands,
    attribute::{MAX_WIDTH, StrandAttribute},
    error::{At, Result},
    formats::{
        gltf::{GUIDE, HAIR, TIP_PINNED},
        raw::Raw,
        source::{Source, excerpt},
    },
    orient,
    strands::Mark,
};

/// Reads all grooms of a file, one after another.
pub(crate) fn read(source: &Source) -> Result<Raw> {
    let file = packed::open(source)?;
    let none = || {
        source.problem(
            At::File,
            format!("the file is a mesh, not a groom (no {HAIR}); use it as the head of a groom"),
        )
    };
    let extension = file.document.extension_value(HAIR).ok_or_else(none)?;
    let mut raw = Raw::new("glTF with hair");
    raw.declared = orient::OrientationOverride::METERS;
    let grooms = extension.get("grooms").and_then(Value::as_array);
    for (i, groom) in grooms.into_iter().flatten().enumerate() {
        let at = |problem: String| file.problem(format!("groom {i}: {problem}"));
        let strands = groom.get("strands").and_then(Value::as_object);
        let part = GroomStrands {
            file: &file,
            of: strands.ok_or_else(|| at("it has no strands".into()))?,
            groom: i,
        };
        let read = part.read(source.lenient)?;
        if let (None, Some(material)) = (raw.look, groom.get("material")) {
            raw.look = Some(part.look(material)?);
        }
        let names = groom.get("groupNames").and_then(Value::as_object);
        for (id, name) in names.into_iter().flatten() {
            let id = id.parse().map_err(|_| at(format!("“{id}” is not a group number")))?;
            raw.group_names.entry(id).or_insert_with(|| name.as_str().unwrap_or_default().into());
        }
        if raw.strands.is_empty() {
            raw.strands = read;
        } else {
            let mut more = Raw::new(raw.format);
            more.strands = read;
            let notes = raw.append(more);
            raw.notes.extend(notes);
        }
    }
    // Only files with lights need valid nodes.
    if file.document.lights().is_some() {
        let (placed, _) = walk::default_scene(&file)?;
        raw.lights = lights::read(&file, &placed);
    }
    Ok(raw)
}

/// The strands of one groom.
struct GroomStrands<'a> {
    file: &'a File<'a>,
    of: &'a Map<String, Value>,
    groom: usize,
}

impl GroomStrands<'_> {
    fn problem(&self, problem: impl std::fmt::Display) -> crate::Error {
        self.file.problem(format!("groom {}: {problem}", self.groom))
    }

    /// Returns the accessor of `key`, which must have `count` items.
    fn accessor(&self, key: &str, count: usize) -> Result<Option<Accessor<'_>>> {
        self.of.get(key).map(|value| self.accessor_of(key, value, count)).transpose()
    }

    fn accessor_of(&self, key: &str, value: &Value, count: usize) -> Result<Accessor<'_>> {
        let index = value.as_u64().ok_or_else(|| self.problem(format!("{key} is not an accessor index")))?;
        let accessor = self.file.document.accessors().nth(index as usize);
        let accessor = accessor.ok_or_else(|| self.problem(format!("accessor {index} does not exist")))?;
        match accessor.count() {
            have if have == count => Ok(accessor),
            have => Err(self.problem(format!("{key} has {have} items, but should have {count}"))),
        }
    }

    fn number(&self, key: &str, otherwise: f32) -> Result<f32> {
        self.number_of(self.of, key, otherwise)
    }

    /// Reads the hair material.
    fn look(&self, material: &Value) -> Result<Look> {
        let of = material.as_object().ok_or_else(|| self.problem("its material is not an object"))?;
        let (number, brown) = (|key, otherwise| self.number_of(of, key, otherwise), Look::default());
        let look = Look {
            eumelanin: number("eumelanin", brown.eumelanin)?,
            pheomelanin: number("pheomelanin", brown.pheomelanin)?,
            roughness: [
                number("longitudinalRoughness", brown.roughness[0])?,
                number("azimuthalRoughness", brown.roughness[1])?,
            ],
            tilt: number("cuticleTilt", brown.tilt)?,
            ior: number("ior", brown.ior)?,
        };
        look.check().map_err(|error| self.problem(error))?;
        Ok(look)
    }

    fn number_of(&self, of: &Map<String, Value>, key: &str, otherwise: f32) -> Result<f32> {
        let Some(value) = of.get(key) else { return Ok(otherwise) };
        let number = value.as_f64().map(|n| n as f32).filter(|n| n.is_finite());
        number.ok_or_else(|| self.problem(format!("{key} is not a finite number")))
    }

    /// Returns unsigned integers, `width` per item.
    fn integers(&self, key: &str, count: usize, width: usize) -> Result<Option<Vec<u32>>> {
        let Some(accessor) = self.accessor(key, count)? else { return Ok(None) };
        self.file.integers(&accessor, width).map(Some)
    }

    fn read(&self, lenient: bool) -> Result<Strands> {
        let count = self.of.get("count").and_then(Value::as_u64);
        let count = count.ok_or_else(|| self.problem("it has no strand count"))?;
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        self.file.spend(count, size_of::<u32>())?;
        let mut strands = Strands { offsets: Vec::with_capacity(count + 1), ..Strands::default() };
        strands.offsets.push(0);
        let mut end = 0u64;
        let each = self.of.get("vertexCount").and_then(Value::as_u64);
        let counts = self.integers("vertexCounts", count, 1)?;
        if each.is_none() && counts.is_none() {
            return Err(self.problem("it has neither a vertexCount nor vertexCounts"));
        }
        for i in 0..count {
            end = end.saturating_add(counts.as_ref().map_or(each.unwrap_or(0), |counts| counts[i].into()));
            let offset = u32::try_from(end)
                .map_err(|_| self.problem("it has more vertices than 32 bits can count"))?;
            strands.offsets.push(offset);
        }
        let vertices = self.accessor("vertices", end as usize)?;
        let vertices = vertices.ok_or_else(|| self.problem("it has no vertices"))?;
        let values = self.file.numbers_of(&vertices, 4, lenient)?;
        let (scale, width) = (self.number("scale", 1.0)?, self.number("width", 0.0)?);
        let offset = self.offset()?;
        let (items, _) = values.as_chunks::<4>();
        strands.positions = items.iter().map(|[x, y, z, _]| offset + scale * Vec3::new(*x, *y, *z)).collect();
        if width > 0.0 {
            strands.radii = items.iter().map(|item| 0.5 * width * item[3]).collect();
        }
        if let Some(colors) = self.accessor("colors", end as usize)? {
            let width = colors.dimensions().multiplicity();
            if width < 3 {
                return Err(self.file.wrong_kind(&colors));
            }
            let values = self.file.numbers_of(&colors, width, lenient)?;
            strands.colors = values.chunks_exact(width).map(Vec3::from_slice).collect();
        }
        if let Some(uvs) = self.accessor("rootUvs", count)? {
            let values = self.file.numbers_of(&uvs, 2, lenient)?;
            strands.root_uvs = values.as_chunks().0.iter().map(|uv| Vec2::from_array(*uv)).collect();
        }
        self.marks(&mut strands, count, lenient)?;
        strands.attributes = self.attributes(&strands, lenient)?;
        Ok(strands)
    }

    /// Reads the custom attributes.
    fn attributes(&self, strands: &Strands, lenient: bool) -> Result<Vec<StrandAttribute>> {
        let mut all = Vec::new();
        for (name, about) in self.of.get("attributes").and_then(Value::as_object).into_iter().flatten() {
            let key = format!("attribute “{}”", excerpt(name));
            let per_vertex = match about.get("per").and_then(Value::as_str) {
                Some("vertex") => true,
                Some("strand") => false,
                _ => return Err(self.problem(format!("{key} is neither per vertex nor per strand"))),
            };
            let count = if per_vertex { strands.positions.len() } else { strands.len() };
            let accessor =
                about.get("accessor").map(|index| self.accessor_of(&key, index, count)).transpose()?;
            let Some(accessor) = accessor else {
                return Err(self.problem(format!("{key} has no accessor")));
            };
            let width = accessor.dimensions().multiplicity();
            if width > MAX_WIDTH as usize {
                return Err(self.file.wrong_kind(&accessor));
            }
            let numbers = self.file.numbers_of(&accessor, width, lenient)?;
            let is_integer = about.get("integer").and_then(Value::as_bool).unwrap_or(false);
            let (name, width) = (name.clone(), width as u32);
            all.push(StrandAttribute { name, per_vertex, is_integer, width, numbers });
        }
        Ok(all)
    }

    fn offset(&self) -> Result<Vec3> {
        let Some(value) = self.of.get("offset") else { return Ok(Vec3::ZERO) };
        let axes: Option<Vec<f32>> =
            value.as_array().and_then(|all| all.iter().map(|n| n.as_f64().map(|n| n as f32)).collect());
        let axes = axes.filter(|axes| axes.len() == 3 && axes.iter().all(|n| n.is_finite()));
        axes.map(|axes| Vec3::from_slice(&axes))
            .ok_or_else(|| self.problem("offset is not three finite numbers"))
    }

    /// Reads the attributes of whole strands: flags, ids, groups, guides and weights.
    fn marks(&self, strands: &mut Strands, count: usize, lenient: bool) -> Result<()> {
        let flags = self.integers("flags", count, 1)?;
        let ids = self.integers("ids", count, 1)?;
        let groups = self.integers("groups", count, 1)?;
        let closest = self.integers("closest", count, 3)?;
        let weights = match self.accessor("weights", count)? {
            Some(accessor) => Some(self.file.numbers_of(&accessor, 3, lenient)?),
            None => None,
        };
        let flag = |i: usize, bit: u32| flags.as_ref().is_some_and(|flags| flags[i] & bit != 0);
        if (0..count).any(|i| flag(i, TIP_PINNED)) {
            strands.tip_pinned = (0..count).map(|i| flag(i, TIP_PINNED)).collect();
        }
        let guides = (0..count).any(|i| flag(i, GUIDE));
        if !guides && ids.is_none() && groups.is_none() && closest.is_none() {
            return Ok(());
        }
        // Ids and groups are signed 32-bit integers, which glTF accessors do not support.
        let number = |all: &Option<Vec<u32>>, i: usize| all.as_ref().map(|all| all[i] as i32);
        strands.marks = (0..count)
            .map(|i| Mark {
                guide: flag(i, GUIDE),
                id: number(&ids, i).unwrap_or(i as i32),
                group: number(&groups, i).unwrap_or(0),
                closest: [0, 1, 2].map(|k| number(&closest, 3 * i + k).unwrap_or(0)),
                weights: [0, 1, 2].map(|k| weights.as_ref().map_or(0.0, |all| all[3 * i + k])),
            })
            .collect();
        Ok(())
    }
}

impl File<'_> {
    /// Returns floats or normalized integers, `width` per item, finite unless `lenient`.
    fn numbers_of(&self, accessor: &Accessor, width: usize, lenient: bool) -> Result<Vec<f32>> {
        if lenient { self.numbers_as_they_are(accessor, width) } else { self.numbers(accessor, width) }
    }
}
