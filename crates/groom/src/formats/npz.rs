//! `.npz`: arrays of NumPy. Strands are `positions`, [n, v, 3], or [all, 3] with `offsets` [n + 1].
//!
//! DiffLocks (Rosu and others, 2025) writes `difflocks_output_strands.npz` with 256 points a strand, and beside it
//! `roots_uv01.npz` and `hair.json`. Its data set has `full_strands.npz` and others, with `root_uv` in the same file
//! and `metadata.json`. All are in the space of SMPL-X: meters, Y up, the face toward +Z.

use super::{raw::Raw, source::Source};
use crate::{
    Look,
    error::{At, Result},
    orient::OrientationOverride,
};
use glam::{Vec2, Vec3};
use npyz::{NpyFile, Order, TypeChar};
use serde_json::Value;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Largest array, bytes.
const MAX_ARRAY_BYTES: u64 = 1 << 32;
/// Files that DiffLocks writes beside the strands.
const UVS: &str = "roots_uv01.npz";
const MATERIAL: &str = "hair.json";
const METADATA: &str = "metadata.json";

/// Numbers of an array, with its shape.
struct Array {
    shape: Vec<u64>,
    values: Vec<f64>,
}

/// Reads strands.
pub(super) fn read(source: &Source<'_>) -> Result<Raw> {
    let mut archive = Archive::open(source, source.bytes)?;
    let mut raw = Raw::new("NumPy arrays");
    let positions = archive.array("positions")?;
    let missing = || source.problem(At::File, "the array “positions” is missing");
    let Array { shape, values } = positions.ok_or_else(missing)?;
    let out = &mut raw.strands;
    let count = (values.len() / 3) as u64;
    source.check_vertices(0, count)?;
    match (&shape[..], archive.array("offsets")?) {
        ([n, v, 3], _) => out.offsets = (0..=*n).map(|i| (i * v) as u32).collect(),
        ([_, 3], Some(offsets)) => {
            let fit = offsets.values.first() == Some(&0.0)
                && offsets.values.last() == Some(&(count as f64))
                && offsets.values.windows(2).all(|pair| pair[0] <= pair[1]);
            if !fit {
                let why = format!("“offsets” must begin with 0, never decrease, and end with {count}");
                return Err(source.problem(At::File, why));
            }
            out.offsets = offsets.values.iter().map(|offset| *offset as u32).collect();
        }
        _ => {
            let why = format!(
                "“positions” has the shape {shape:?}, but must have [n, v, 3], or [all, 3] with “offsets”"
            );
            return Err(source.problem(At::File, why));
        }
    }
    out.positions = vectors(&values);
    let bad = out.positions.iter().position(|p| !p.is_finite());
    if let Some(at) = bad.filter(|_| !source.lenient) {
        return Err(source.problem(At::File, format!("vertex {at} of “positions” is not finite")));
    }
    let strands = out.len();
    if let Some(widths) = archive.array("widths")?.filter(|widths| widths.values.len() as u64 == count) {
        out.radii = widths.values.iter().map(|width| 0.5 * *width as f32).collect();
    }
    if let Some(colors) = archive.array("colors")?.filter(|colors| colors.values.len() as u64 == 3 * count) {
        out.colors = vectors(&colors.values);
    }
    let uvs = match archive.array("root_uv")? {
        Some(uvs) => Some(uvs),
        None => archive.array("root_uvs")?,
    };
    let resource = |name: &str| source.resource(name).ok();
    let uvs = match (uvs, resource(UVS)) {
        (None, Some(bytes)) => Archive::open(source, &bytes)?.array("uv_coords")?,
        (uvs, _) => uvs,
    };
    // Files of `save_npz` do not state their axes. DiffLocks uses SMPL-X's.
    let is_smplx = shape.len() == 3 && (shape[1] == 256 || archive.has("root_normal"));
    if is_smplx {
        (raw.format, raw.declared) = ("DiffLocks", OrientationOverride::METERS);
    }
    let uvs = uvs.filter(|uvs| uvs.values.len() == 2 * strands);
    if let Some(uvs) = uvs {
        out.root_uvs =
            uvs.values.as_chunks().0.iter().map(|[u, v]| Vec2::new(*u as f32, *v as f32)).collect();
    }
    if let Some(metadata) = resource(METADATA).filter(|_| is_smplx) {
        let metadata = json(source, METADATA, &metadata)?;
        if metadata.get("mirror_hair").and_then(Value::as_bool) == Some(true) {
            out.root_uvs.iter_mut().for_each(|uv| uv.x = 1.0 - uv.x);
        }
    }
    if let Some(material) = resource(MATERIAL).filter(|_| is_smplx) {
        raw.look = look(&json(source, MATERIAL, &material)?);
    }
    Ok(raw)
}

/// Returns the pigments of DiffLocks' melanin and redness, two inputs of Blender's *Principled Hair BSDF*.
fn look(material: &Value) -> Option<Look> {
    let number =
        |name: &str| material.get(name).and_then(Value::as_f64).map(|value| value.clamp(0.0, 1.0) as f32);
    let (melanin, redness) = (number("melanin")?, number("redness")?);
    let amount = -(1.0 - melanin).max(1e-4).ln();
    let eumelanin = 1.208 * amount * (1.0 - redness);
    Some(Look { eumelanin, pheomelanin: 1.831 * amount * redness, ..Look::default() })
}

fn json(source: &Source<'_>, name: &str, bytes: &[u8]) -> Result<Value> {
    serde_json::from_slice(bytes).map_err(|error| source.problem(At::File, format!("{name}: {error}")))
}

fn vectors(values: &[f64]) -> Vec<Vec3> {
    values.as_chunks().0.iter().map(|[x, y, z]| Vec3::new(*x as f32, *y as f32, *z as f32)).collect()
}

/// An `.npz` file.
struct Archive<'a> {
    source: &'a Source<'a>,
    files: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> Archive<'a> {
    fn open(source: &'a Source<'a>, bytes: &'a [u8]) -> Result<Self> {
        let files = ZipArchive::new(Cursor::new(bytes));
        let files = files.map_err(|error| source.problem(At::File, format!("not an .npz file: {error}")))?;
        Ok(Self { source, files })
    }

    fn has(&self, name: &str) -> bool {
        self.files.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// Returns an array of numbers; `None` if it is missing.
    fn array(&mut self, name: &str) -> Result<Option<Array>> {
        let source = self.source;
        let broken = |why: String| source.problem(At::File, format!("“{name}”: {why}"));
        if !self.has(name) {
            return Ok(None);
        }
        let file = self.files.by_name(&format!("{name}.npy")).map_err(|error| broken(error.to_string()))?;
        let array = NpyFile::new(file.take(MAX_ARRAY_BYTES)).map_err(|error| broken(error.to_string()))?;
        let shape = array.shape().to_vec();
        let count = shape.iter().try_fold(1u64, |product, side| product.checked_mul(*side));
        // A stored value takes at least a byte, and deflate shrinks by at most 1,032.
        let justified = 1032u64.saturating_mul(source.bytes.len() as u64).min(MAX_ARRAY_BYTES);
        if count.is_none_or(|count| count > justified) {
            return Err(broken(format!("its shape {shape:?} is larger than the file")));
        }
        if array.order() != Order::C {
            return Err(broken("it is stored by columns".into()));
        }
        let kind = match array.dtype() {
            npyz::DType::Plain(kind) => kind,
            _ => return Err(broken("it holds no numbers".into())),
        };
        let wrong = |error: std::io::Error| broken(error.to_string());
        macro_rules! read {
            ($number:ty) => {
                array.into_vec::<$number>().map_err(wrong)?.into_iter().map(|value| value as f64).collect()
            };
        }
        let values: Vec<f64> = match (kind.type_char(), kind.size_field()) {
            (TypeChar::Float, 4) => read!(f32),
            (TypeChar::Float, 8) => read!(f64),
            (TypeChar::Int, 4) => read!(i32),
            (TypeChar::Int, 8) => read!(i64),
            (TypeChar::Uint, 4) => read!(u32),
            (TypeChar::Uint, 8) => read!(u64),
            _ => return Err(broken(format!("numbers of the type {kind} are not read"))),
        };
        Ok(Some(Array { shape, values }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::source::Files;
    use npyz::WriterBuilder;
    use std::{borrow::Cow, io::Write, path::Path};
    use zip::{ZipWriter, write::SimpleFileOptions};

    fn packed(arrays: &[(&str, &[u64], Vec<f32>)]) -> Vec<u8> {
        let mut out = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, shape, values) in arrays {
            out.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
            let mut bytes = Vec::new();
            let writer = npyz::WriteOptions::new().default_dtype().shape(shape).writer(&mut bytes);
            let mut writer = writer.begin_nd().unwrap();
            writer.extend(values.iter().copied()).unwrap();
            writer.finish().unwrap();
            out.write_all(&bytes).unwrap();
        }
        out.finish().unwrap().into_inner()
    }

    fn strands() -> Vec<f32> {
        (0..3 * 256 * 3).map(|i| 1e-3 * i as f32).collect()
    }

    fn raw(bytes: &[u8], beside: &[(&str, &[u8])]) -> Result<Raw> {
        let files: Vec<_> = beside.iter().map(|(name, bytes)| (name.into(), Cow::Borrowed(*bytes))).collect();
        let path = Path::new("difflocks_output_strands.npz");
        read(&Source { path, bytes, files: Files::Given(&files), lenient: false })
    }

    #[test]
    fn folder_of_difflocks_is_read() {
        let bytes = packed(&[("positions", &[3, 256, 3], strands())]);
        let uvs = packed(&[("uv_coords", &[3, 2], vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6])]);
        let material = br#"{"melanin": 0.5, "redness": 0.25, "root_darkness_start": 0.1}"#;
        let raw = raw(&bytes, &[("roots_uv01.npz", &uvs), ("hair.json", material)]).unwrap();
        assert_eq!((raw.strands.len(), raw.declared), (3, OrientationOverride::METERS));
        assert!(raw.strands.strand(1)[0].distance(Vec3::new(0.768, 0.769, 0.77)) < 1e-6);
        assert_eq!(raw.strands.root_uvs[2], Vec2::new(0.5, 0.6));
        let look = raw.look.unwrap();
        let amount = std::f32::consts::LN_2;
        assert!((look.eumelanin - 1.208 * amount * 0.75).abs() < 1e-5);
        assert!((look.pheomelanin - 1.831 * amount * 0.25).abs() < 1e-5);
    }

    #[test]
    fn files_of_the_data_set_are_read() {
        let uvs = vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let bytes = packed(&[
            ("positions", &[3, 256, 3], strands()),
            ("root_uv", &[3, 2], uvs),
            ("root_normal", &[3, 3], vec![0.0; 9]),
        ]);
        let raw = raw(&bytes, &[("metadata.json", br#"{"mirror_hair": true}"#)]).unwrap();
        assert!((raw.strands.root_uvs[0] - Vec2::new(0.9, 0.2)).length() < 1e-6 && raw.look.is_none());
    }

    #[test]
    fn arrays_of_python_are_read() {
        let bytes = packed(&[
            ("positions", &[5, 3], (0..15).map(|i| i as f32).collect()),
            ("offsets", &[3], vec![0.0, 2.0, 5.0]),
            ("widths", &[5], vec![8e-5; 5]),
        ]);
        let raw = raw(&bytes, &[]).unwrap();
        assert_eq!((raw.strands.offsets, raw.declared), (vec![0, 2, 5], OrientationOverride::default()));
        assert_eq!(raw.strands.radii, [4e-5; 5]);
    }

    #[test]
    fn damaged_files_give_one_sentence() {
        let of = |arrays: &[(&str, &[u64], Vec<f32>)]| raw(&packed(arrays), &[]).err().unwrap().to_string();
        assert!(raw(b"no archive", &[]).err().unwrap().to_string().contains("not an .npz file"));
        assert!(of(&[("points", &[1], vec![0.0])]).contains("“positions” is missing"));
        assert!(of(&[("positions", &[2, 3], vec![0.0; 6])]).contains("must have [n, v, 3]"));
        let offsets: (&str, &[u64], Vec<f32>) = ("offsets", &[2], vec![0.0, 7.0]);
        assert!(of(&[("positions", &[2, 3], vec![0.0; 6]), offsets]).contains("end with 2"));
        assert!(of(&[("positions", &[1, 2, 3], vec![f32::NAN; 6])]).contains("not finite"));
        let whole = packed(&[("positions", &[3, 256, 3], strands())]);
        for end in (0..whole.len()).step_by(97) {
            assert!(raw(&whole[..end], &[]).is_err(), "{end}");
        }
        assert!(raw(&whole, &[("hair.json", b"{")]).err().unwrap().to_string().contains("hair.json"));
    }
}
