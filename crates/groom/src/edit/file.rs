//! Edited grooms as files (`.groom`).
//!
//! ```text
//! magic (8 bytes), version (u32)
//! chunk × n: name (4 bytes), length (u64), CRC-32 of the bytes (u32), bytes
//! ```
//! All numbers are little-endian. The first chunk is `INFO`, a JSON object with counts, the middle and the head. Then
//! come arrays, each split into planes of equally significant bytes and deflated (RFC 1951):
//!
//! | chunk | content, one per |
//! |---|---|
//! | `GPOS` | position before the first stroke, 3 floats per guide vertex |
//! | `GNOW` | position now, 3 floats per guide vertex |
//! | `GTRA` | stiffness (float), strands (float), flags (u32: 1 pinned tip, 2 held), group (i32) per guide |
//! | `SHAP` | painted clumps, curls and frizz, type of curls (4 bytes), per strand; missing without any |
//! | `STRA` | [`Strand`], per strand |
//! | `BIND` | [`StrandBinding`], per strand |
//! | `REST` | [`PackedRest`], per strand vertex |
//! | `FILE` | bytes of a file of the head, in the order of `INFO`; neither split nor deflated |
//!
//! Later versions read this version. Unknown chunks are skipped.

use super::{GroomDocument, HeadFiles, painted_values::PaintedValues};
use crate::{
    BoundStrands, Groom, Guides, MAX_VERTICES,
    bound::{PackedRest, Strand, StrandBinding},
    error::{At, Error, Result},
    orient::{LengthUnit, OrientationOverride},
    restyle::painted::StrandShape,
};
use bytemuck::Pod;
use glam::Vec3;
use miniz_oxide::{deflate::compress_to_vec, inflate::decompress_to_vec_with_limit};
use serde::{Deserialize, Serialize};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Extension of the files.
pub const EXTENSION: &str = "groom";
const MAGIC: [u8; 8] = *b"\x89GROOM\r\n";
const VERSION: u32 = 1;
/// Effort of the compression: higher levels take several times as long for a few percent.
const LEVEL: u8 = 4;

/// The chunk `INFO`.
#[derive(Serialize, Deserialize)]
struct Info {
    guides: u64,
    guide_vertices: u32,
    has_groups: bool,
    strands: u64,
    strand_vertices: u32,
    #[serde(rename = "middle")]
    mirror_x: f32,
    head: HeadInfo,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum HeadInfo {
    None,
    BuiltIn,
    Files {
        names: Vec<String>,
        unit: Option<f32>,
        up: Option<String>,
        front: Option<String>,
        mirror: Option<bool>,
    },
}

/// [`Guides`] besides positions, per guide.
#[repr(C)]
#[derive(Clone, Copy, Pod, bytemuck::Zeroable)]
struct Traits {
    stiffness: f32,
    strands: f32,
    /// 1: pinned tip, 2: held.
    flags: u32,
    group: i32,
}

impl GroomDocument {
    /// Encodes the version as a file. Versions before it are not kept.
    pub fn write(&self) -> Vec<u8> {
        let base = self.base();
        let (guides, strands) = (&base.guides, &base.strands);
        let painted_values = self.painted_values();
        let (head, files) = match self.head() {
            HeadFiles::None => (HeadInfo::None, &[][..]),
            HeadFiles::BuiltIn => (HeadInfo::BuiltIn, &[][..]),
            HeadFiles::Files { files, orientation } => {
                let info = HeadInfo::Files {
                    names: files.iter().map(|(name, _)| name.to_string_lossy().into_owned()).collect(),
                    unit: orientation.unit.map(|unit| unit.0),
                    up: orientation.up.map(|axis| axis.name().into()),
                    front: orientation.front.map(|axis| axis.name().into()),
                    mirror: orientation.is_mirrored,
                };
                (info, &files[..])
            }
        };
        let info = Info {
            guides: guides.len() as u64,
            guide_vertices: guides.vertex_count,
            has_groups: !guides.groups.is_empty(),
            strands: strands.len() as u64,
            strand_vertices: strands.vertex_count,
            mirror_x: self.mirror_x(),
            head,
        };
        let traits: Vec<_> = (0..guides.len())
            .map(|i| Traits {
                stiffness: painted_values.stiffness[i],
                strands: guides.strands[i],
                flags: u32::from(guides.tip_pinned[i]) | u32::from(painted_values.held[i]) << 1,
                group: guides.groups.get(i).copied().unwrap_or_default(),
            })
            .collect();
        let mut file = MAGIC.to_vec();
        file.extend(VERSION.to_le_bytes());
        push(&mut file, *b"INFO", &serde_json::to_vec(&info).unwrap_or_default());
        push(&mut file, *b"GPOS", &packed(&guides.positions));
        push(&mut file, *b"GNOW", &packed(&self.guides().positions()));
        push(&mut file, *b"GTRA", &packed(&traits));
        push(&mut file, *b"STRA", &packed(&painted_values.strands));
        if !painted_values.shapes.is_empty() {
            push(&mut file, *b"SHAP", &packed(&painted_values.shapes));
        }
        push(&mut file, *b"BIND", &packed(&strands.bindings));
        push(&mut file, *b"REST", &packed(&strands.rest));
        files.iter().for_each(|(_, bytes)| push(&mut file, *b"FILE", bytes));
        file
    }

    /// Reads a file. Errors name `path`.
    ///
    /// # Errors
    /// [`Error::File`] if the file is damaged, of a later version, or no edited groom.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
        let file = Reader { path, bytes };
        let chunks = file.chunks()?;
        let info = file.chunk(&chunks, *b"INFO")?;
        let info: Info =
            serde_json::from_slice(info).map_err(|error| file.wrong(At::File, format!("INFO: {error}")))?;
        let Info { guides: count, strands, .. } = info;
        let (n, m) = (u64::from(info.guide_vertices), u64::from(info.strand_vertices));
        let vertices = count.checked_mul(n).into_iter().chain(strands.checked_mul(m));
        if vertices.clone().count() < 2 || vertices.max() > Some(MAX_VERTICES) {
            return Err(file.wrong(At::File, format!("more than {MAX_VERTICES} vertices")));
        }
        let traits: Vec<Traits> = file.array(&chunks, *b"GTRA", count)?;
        let guides = Guides {
            vertex_count: info.guide_vertices,
            positions: file.array(&chunks, *b"GPOS", count * n)?,
            stiffness: traits.iter().map(|traits| traits.stiffness).collect(),
            strands: traits.iter().map(|traits| traits.strands).collect(),
            tip_pinned: traits.iter().map(|traits| traits.flags & 1 != 0).collect(),
            groups: traits.iter().map(|traits| traits.group).filter(|_| info.has_groups).collect(),
        };
        let strands = BoundStrands {
            vertex_count: info.strand_vertices,
            strands: file.array::<Strand>(&chunks, *b"STRA", strands)?,
            bindings: file.array::<StrandBinding>(&chunks, *b"BIND", strands)?,
            rest: file.array::<PackedRest>(&chunks, *b"REST", strands * m)?,
        };
        let now: Vec<Vec3> = file.array(&chunks, *b"GNOW", count * n)?;
        let head = file.head(&chunks, info.head)?;
        let unusable = |error: Error| file.wrong(At::File, error.to_string());
        let original = Self::new(Groom { guides, strands }, head, info.mirror_x).map_err(unusable)?;
        if !now.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e3) {
            return Err(file.wrong(At::File, "a guide is not within a kilometer".into()));
        }
        let n = n as usize;
        let changed_guides =
            now.chunks_exact(n).enumerate().filter(|(i, guide)| original.guide(*i) != *guide);
        let document = original.with(changed_guides);
        let held: Vec<bool> = traits.iter().map(|traits| traits.flags & 2 != 0).collect();
        let shapes = match chunks.iter().any(|(name, _)| *name == *b"SHAP") {
            true => file.array::<StrandShape>(&chunks, *b"SHAP", info.strands)?,
            false => Vec::new(),
        };
        Ok(match held.contains(&true) || !shapes.is_empty() {
            true => document.with_painted_values(PaintedValues { held, shapes, ..document.painted_values() }),
            false => document,
        })
    }
}

/// Appends a chunk.
fn push(file: &mut Vec<u8>, name: [u8; 4], bytes: &[u8]) {
    file.extend(name);
    file.extend((bytes.len() as u64).to_le_bytes());
    file.extend(crc32fast::hash(bytes).to_le_bytes());
    file.extend(bytes);
}

/// Returns `items` in planes of bytes, deflated.
fn packed<T: Pod>(items: &[T]) -> Vec<u8> {
    let (bytes, stride) = (bytemuck::cast_slice::<T, u8>(items), size_of::<T>());
    let planes: Vec<u8> = (0..stride).flat_map(|k| bytes.iter().skip(k).step_by(stride).copied()).collect();
    compress_to_vec(&planes, LEVEL)
}

type Chunk<'a> = ([u8; 4], &'a [u8]);

struct Reader<'a> {
    path: &'a Path,
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn wrong(&self, at: At, problem: String) -> Error {
        Error::File { path: self.path.to_path_buf(), at, problem }
    }

    /// Returns all chunks, whose checksums match.
    fn chunks(&self) -> Result<Vec<Chunk<'a>>> {
        let Some(rest) = self.bytes.strip_prefix(&MAGIC) else {
            return Err(
                self.wrong(At::Byte(0), "the file is not an edited groom: its first bytes are wrong".into())
            );
        };
        let ends = |at: usize| self.wrong(At::Byte(at as u64), "the file ends within a chunk".into());
        let byte_offset = |rest: &[u8]| self.bytes.len() - rest.len();
        let Some((version, mut rest)) = rest.split_first_chunk::<4>() else { return Err(ends(8)) };
        let version = u32::from_le_bytes(*version);
        if version != VERSION {
            let problem = format!("the file has version {version}, but this Tresses reads version {VERSION}");
            return Err(self.wrong(At::Byte(8), problem));
        }
        let mut chunks = Vec::new();
        while !rest.is_empty() {
            let at = byte_offset(rest);
            let header = rest.split_first_chunk::<4>().and_then(|(name, rest)| {
                let (length, rest) = rest.split_first_chunk::<8>()?;
                let (sum, rest) = rest.split_first_chunk::<4>()?;
                let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
                Some((*name, rest.split_at_checked(length)?, u32::from_le_bytes(*sum)))
            });
            let Some((name, (bytes, after), sum)) = header else { return Err(ends(at)) };
            if crc32fast::hash(bytes) != sum {
                let name = String::from_utf8_lossy(&name).into_owned();
                return Err(self.wrong(At::Byte(at as u64), format!("the chunk {name} is damaged")));
            }
            chunks.push((name, bytes));
            rest = after;
        }
        Ok(chunks)
    }

    fn chunk(&self, chunks: &[Chunk<'a>], name: [u8; 4]) -> Result<&'a [u8]> {
        let found = chunks.iter().find(|chunk| chunk.0 == name).map(|chunk| chunk.1);
        let missing =
            || self.wrong(At::File, format!("the chunk {} is missing", String::from_utf8_lossy(&name)));
        found.ok_or_else(missing)
    }

    /// Returns the `count` items of a chunk.
    fn array<T: Pod>(&self, chunks: &[Chunk<'a>], name: [u8; 4], count: u64) -> Result<Vec<T>> {
        let bytes = self.chunk(chunks, name)?;
        let (count, stride) = (count as usize, size_of::<T>());
        let planes = decompress_to_vec_with_limit(bytes, count * stride).ok();
        let Some(planes) = planes.filter(|planes| planes.len() == count * stride) else {
            let name = String::from_utf8_lossy(&name);
            return Err(self.wrong(At::File, format!("the chunk {name} does not hold {count} items")));
        };
        let mut items = vec![T::zeroed(); count];
        let into = bytemuck::cast_slice_mut::<T, u8>(&mut items);
        for (k, plane) in planes.chunks_exact(count.max(1)).enumerate() {
            into.iter_mut().skip(k).step_by(stride).zip(plane).for_each(|(to, from)| *to = *from);
        }
        Ok(items)
    }

    fn head(&self, chunks: &[Chunk<'a>], info: HeadInfo) -> Result<HeadFiles> {
        let HeadInfo::Files { names, unit, up, front, mirror } = info else {
            return Ok(match info {
                HeadInfo::BuiltIn => HeadFiles::BuiltIn,
                _ => HeadFiles::None,
            });
        };
        let contents: Vec<Arc<[u8]>> =
            chunks.iter().filter(|chunk| chunk.0 == *b"FILE").map(|chunk| Arc::from(chunk.1)).collect();
        if contents.len() != names.len() {
            let problem =
                format!("{} files of the head are named, but {} are there", names.len(), contents.len());
            return Err(self.wrong(At::File, problem));
        }
        let axis = |name: Option<String>| name.map(|name| name.parse()).transpose();
        let orientation = OrientationOverride {
            unit: unit.map(LengthUnit),
            up: axis(up)?,
            front: axis(front)?,
            is_mirrored: mirror,
        };
        orientation.check()?;
        Ok(HeadFiles::Files {
            files: names.into_iter().map(PathBuf::from).zip(contents).collect(),
            orientation,
        })
    }
}
