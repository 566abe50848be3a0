//! Alembic writer: strands as linear curves with Unreal's `groom_*` properties (schema 1.5), static or as a cache.
//!
//! ```text
//! ABC ─ /groom (transform) ─ /groom/strands (curves): P, nVertices, width, .arbGeomParams: groom_…
//! ```
//!
//! Constant data is written once, positions once per frame as the caller passes them. A cache of any length needs
//! little more memory than one frame. The layout is described at the reader.

mod digest;
mod ogawa;
mod property;
#[cfg(test)]
mod tests;

use std::io::{Cursor, Result, Seek, Write};

use glam::Vec3;

use crate::{
    Error, Strands, error,
    formats::{
        raw::{CENTIMETERS, MARK},
        writer::{self, CacheOptions, CacheSink, EncodedFile},
    },
    orient::LengthUnit,
};
use ogawa::{NodeOffset, Ogawa};
use property::{BOOL, Compound, F32, F64, I16, I32, SampledProperty, TEXT, U8};

/// Alembic version of the layout, 1.8.0.
const LIBRARY: i32 = 10_800;
const CURVES: &str = "schema=AbcGeom_Curve_v2;schemaBaseType=AbcGeom_GeomBase_v1";

/// Options of a file.
#[derive(Clone, Copy, PartialEq)]
struct Options {
    /// Unit of the file: lengths in meters are divided by it.
    unit: LengthUnit,
    /// Whether the strands are in meters, Y up, face +Z.
    oriented: bool,
    /// Time of the first frame, seconds.
    start: f64,
    /// Frames per second, if there are several frames.
    rate: f64,
}

/// A cache being written: strands whose positions change from frame to frame.
struct Cache<W> {
    out: Ogawa<W>,
    options: Options,
    strands: Strands,
    points: SampledProperty,
    bounds: SampledProperty,
    frames: u32,
}

impl<W: Write + Seek> Cache<W> {
    /// Begins a file of `strands`, without their positions: [`frame`](writer::Cache::frame) adds positions per frame.
    fn new(out: W, strands: &Strands, options: Options) -> Result<Self> {
        Ok(Self {
            out: Ogawa::new(out)?,
            options,
            strands: strands.clone(),
            points: SampledProperty::array("P", "geoScope=vtx;interpretation=point", F32, 3),
            bounds: SampledProperty::scalar(".selfBnds", "interpretation=box", F64, 6),
            frames: 0,
        })
    }

    /// Ends the file and returns its output.
    fn end(self) -> Result<W> {
        let Self { mut out, options, strands, points, bounds, frames } = self;
        let out_ = &mut out;
        let version = out_.data(&0i32.to_le_bytes())?;
        let library = out_.data(&LIBRARY.to_le_bytes())?;
        let sampling = u32::from(frames > 1);
        let shape = shape(out_, &strands, options, points, bounds, sampling)?;
        let mut top = Compound::default();
        top.inside(out_, ".geom", CURVES, shape)?;
        let curves = object(out_, top, &[])?;
        let mut still = Compound::default();
        still.constant(out_, SampledProperty::scalar(".inherits", "", BOOL, 1), &[1])?;
        let mut top = Compound::default();
        top.inside(out_, ".xform", "schema=AbcGeom_Xform_v3", still)?;
        let title = format!("{CURVES};schemaObjTitle=AbcGeom_Curve_v2:.geom");
        let above = object(out_, top, &[("strands", &title, curves)])?;
        let title = "schema=AbcGeom_Xform_v3;schemaObjTitle=AbcGeom_Xform_v3:.xform";
        let all = object(out_, Compound::default(), &[("groom", title, above)])?;
        let about = format!(
            "_ai_AlembicVersion=Alembic 1.8.0;_ai_Application=Tresses {};_ai_Description={}",
            env!("CARGO_PKG_VERSION"),
            description(options)
        );
        let about = out_.data(about.as_bytes())?;
        let samplings = out_.data(&samplings(options, frames))?;
        let shared = out_.shared();
        let shared = out_.data(&shared)?;
        let root = out_.group(&[version, library, all, about, samplings, shared])?;
        out.finish(root)
    }
}

impl<W: Write + Seek> writer::CacheWriter for Cache<W> {
    fn frame(&mut self, positions: &[Vec3]) -> Result<()> {
        if positions.len() != self.strands.positions.len() {
            let problem = format!(
                "the frame has {} positions for {} vertices",
                positions.len(),
                self.strands.positions.len()
            );
            return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, problem));
        }
        let scaled = |p: &Vec3| if self.options.unit.0 == 1.0 { *p } else { *p / self.options.unit.0 };
        let mut bytes = Vec::with_capacity(12 * positions.len());
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in positions.iter().map(scaled) {
            (lo, hi) = (lo.min(p), hi.max(p));
            p.to_array().iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        self.points.push(&mut self.out, &bytes)?;
        let bounds: Vec<u8> =
            [lo, hi].iter().flat_map(|p| p.to_array()).flat_map(|v| f64::from(v).to_le_bytes()).collect();
        self.bounds.push(&mut self.out, &bounds)?;
        self.frames += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        self.end().map(|_| ())
    }
}

/// Begins a cache.
pub(crate) fn cache<'a>(
    out: Box<dyn CacheSink + 'a>,
    strands: &Strands,
    options: CacheOptions,
) -> Result<Box<dyn writer::CacheWriter + 'a>> {
    let CacheOptions { unit, rate, .. } = options;
    Ok(Box::new(Cache::new(out, strands, Options { unit, oriented: true, start: 0.0, rate })?))
}

fn description(options: Options) -> &'static str {
    match options.unit.0 {
        1.0 if options.oriented => MARK,
        0.01 if options.oriented => CENTIMETERS,
        _ => "a groom",
    }
}

/// Encodes the time samplings: a default for constant properties and, for several frames, one with a time per frame.
fn samplings(options: Options, frames: u32) -> Vec<u8> {
    let mut all = Vec::new();
    let each = [(1, 1.0, 0.0), (frames, 1.0 / options.rate, options.start)];
    for (count, cycle, start) in each.iter().take(if frames > 1 { 2 } else { 1 }) {
        all.extend(u32::to_le_bytes(*count));
        all.extend(f64::to_le_bytes(*cycle));
        all.extend(1u32.to_le_bytes());
        all.extend(f64::to_le_bytes(*start));
    }
    all
}

/// Writes an object: its properties, its children, and the list of their names. Two digests follow the list; readers do
/// not compare them.
fn object<W: Write + Seek>(
    out: &mut Ogawa<W>,
    top: Compound,
    children: &[(&str, &str, NodeOffset)],
) -> Result<NodeOffset> {
    let mut all = vec![top.finish(out)?];
    let mut list = Vec::new();
    for (name, meta, offset) in children {
        list.extend((name.len() as u32).to_le_bytes());
        list.extend(name.bytes());
        // Sharing cannot fail: the texts are few and short.
        list.push(out.shared_index(meta).unwrap_or(0));
        all.push(*offset);
    }
    let [one, other] = [digest::digest(&list, 1), digest::digest(&list, 2)];
    list.extend(one.iter().chain(&other));
    all.push(out.data(&list)?);
    out.group(&all)
}

/// Writes curves with Unreal's groom properties.
fn shape<W: Write + Seek>(
    out: &mut Ogawa<W>,
    strands: &Strands,
    options: Options,
    points: SampledProperty,
    bounds: SampledProperty,
    sampling: u32,
) -> Result<Compound> {
    let floats =
        |values: &mut dyn Iterator<Item = f32>| values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let integers =
        |values: &mut dyn Iterator<Item = i32>| values.flat_map(i32::to_le_bytes).collect::<Vec<u8>>();
    let widths = floats(&mut strands.radii.iter().map(|r| 2.0 * r / options.unit.0));
    let mut shape = Compound::default();
    shape.close(out, bounds, sampling)?;
    shape.close(out, points, sampling)?;
    let counts = integers(&mut strands.iter().map(|strand| strand.len() as i32));
    shape.constant(out, SampledProperty::array("nVertices", "", I32, 1), &counts)?;
    // Linear, open, no basis.
    shape.constant(out, SampledProperty::scalar("curveBasisAndType", "", U8, 4), &[1, 0, 0, 0])?;
    if !widths.is_empty() {
        shape.constant(out, SampledProperty::param("width", F32, 1, "vtx", ""), &widths)?;
    }
    let mut groom = Compound::default();
    let mut put = |name, pod, extent, scope: &str, meaning: &str, bytes: &[u8]| {
        groom.constant(out, SampledProperty::param(name, pod, extent, scope, meaning), bytes)
    };
    put("groom_version_major", I16, 1, "con", "", &1i16.to_le_bytes())?;
    put("groom_version_minor", I16, 1, "con", "", &5i16.to_le_bytes())?;
    put("groom_tool", TEXT, 1, "con", "", b"Tresses\0")?;
    if !widths.is_empty() {
        put("groom_width", F32, 1, "vtx", "", &widths)?;
    }
    if !strands.colors.is_empty() {
        let colors = floats(&mut strands.colors.iter().flat_map(|c| c.to_array()));
        put("groom_color", F32, 3, "vtx", "rgb", &colors)?;
    }
    if !strands.root_uvs.is_empty() {
        let uvs = floats(&mut strands.root_uvs.iter().flat_map(|uv| uv.to_array()));
        put("groom_root_uv", F32, 2, "uni", "vector", &uvs)?;
    }
    let marks = &strands.marks;
    if !marks.is_empty() {
        let guides: Vec<u8> = marks.iter().flat_map(|mark| i16::from(mark.guide).to_le_bytes()).collect();
        put("groom_guide", I16, 1, "uni", "", &guides)?;
        put("groom_id", I32, 1, "uni", "", &integers(&mut marks.iter().map(|mark| mark.id)))?;
        put("groom_group_id", I32, 1, "uni", "", &integers(&mut marks.iter().map(|mark| mark.group)))?;
        if marks.iter().any(|mark| mark.weights != [0.0; 3]) {
            let closest = integers(&mut marks.iter().flat_map(|mark| mark.closest));
            put("groom_closest_guides", I32, 3, "uni", "vector", &closest)?;
            let weights = floats(&mut marks.iter().flat_map(|mark| mark.weights));
            put("groom_guide_weights", F32, 3, "uni", "vector", &weights)?;
        }
    }
    for attribute in &strands.attributes {
        let scope = if attribute.per_vertex { "vtx" } else { "uni" };
        let mut numbers = attribute.numbers.iter().copied();
        let (pod, bytes) = match attribute.is_integer {
            true => (I32, integers(&mut numbers.map(|number| number as i32))),
            false => (F32, floats(&mut numbers)),
        };
        let property = SampledProperty::param(attribute.name.clone(), pod, attribute.width, scope, "");
        groom.constant(out, property, &bytes)?;
    }
    shape.inside(out, ".arbGeomParams", "", groom)?;
    Ok(shape)
}

/// Encodes a static groom.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> error::Result<EncodedFile> {
    let options =
        Options { unit: unit.unwrap_or(LengthUnit(1.0)), oriented: unit.is_some(), start: 0.0, rate: 24.0 };
    let written = || -> Result<Vec<u8>> {
        let mut cache = Cache::new(Cursor::new(Vec::new()), strands, options)?;
        writer::CacheWriter::frame(&mut cache, &strands.positions)?;
        Ok(cache.end()?.into_inner())
    };
    // Writing to memory cannot fail.
    written().map(EncodedFile::from).map_err(|error| Error::Unusable(error.to_string()))
}
