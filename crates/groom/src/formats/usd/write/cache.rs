//! Writes caches: strands whose positions change from frame to frame.

use std::io::{Error, ErrorKind, Result, Write};

use glam::Vec3;

use super::{Curves, LayerInfo, layer::Layer, layer_metadata};
use crate::{
    Strands,
    formats::writer::{self, CacheOptions, CacheSink},
    orient::LengthUnit,
};

/// A cache being written, frame by frame.
struct Cache<W> {
    out: W,
    unit: LengthUnit,
    vertices: usize,
    frames: u32,
}

impl<W: Write> Cache<W> {
    /// Begins a file of `strands`, without their positions: [`frame`](writer::Cache::frame) adds positions per frame.
    fn new(mut out: W, strands: &Strands, options: CacheOptions) -> Result<Self> {
        let CacheOptions { unit, rate, frames } = options;
        let mut lines = layer_metadata(&LayerInfo { prim: "groom", unit: Some(unit) });
        lines.extend([
            format!("timeCodesPerSecond = {rate}"),
            format!("framesPerSecond = {rate}"),
            "startTimeCode = 0".into(),
            format!("endTimeCode = {}", frames.saturating_sub(1)),
        ]);
        let mut layer = Layer::new(&lines);
        layer.open("Xform", "groom", &["GroomAPI"]);
        layer.open("BasisCurves", "strands", &[]);
        Curves { strands, scale: unit.0 }.attributes(&mut layer);
        layer.line("point3f[] points.timeSamples = {");
        out.write_all(layer.finish().as_bytes())?;
        Ok(Self { out, unit, vertices: strands.positions.len(), frames: 0 })
    }
}

impl<W: Write> writer::CacheWriter for Cache<W> {
    fn frame(&mut self, positions: &[Vec3]) -> Result<()> {
        if positions.len() != self.vertices {
            let problem =
                format!("the frame has {} positions for {} vertices", positions.len(), self.vertices);
            return Err(Error::new(ErrorKind::InvalidInput, problem));
        }
        write!(self.out, "            {}: [", self.frames)?;
        for (i, p) in positions.iter().enumerate() {
            let p = if self.unit.0 == 1.0 { *p } else { *p / self.unit.0 };
            write!(self.out, "{}({}, {}, {})", if i == 0 { "" } else { ", " }, p.x, p.y, p.z)?;
        }
        self.frames += 1;
        writeln!(self.out, "],")
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        write!(self.out, "        }}\n    }}\n}}\n")?;
        self.out.flush()
    }
}

/// Begins a cache as text.
pub(crate) fn cache<'a>(
    out: Box<dyn CacheSink + 'a>,
    strands: &Strands,
    options: CacheOptions,
) -> Result<Box<dyn writer::CacheWriter + 'a>> {
    Ok(Box::new(Cache::new(out, strands, options)?))
}
