//! Reads `.ply` files.

use glam::Vec3;

use super::runs;
use crate::{
    error::{At, Result},
    formats::{
        chain::chain,
        raw::{Raw, declared},
        source::{Source, excerpt},
    },
};

/// Encoding of the numbers in a file.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Little,
    Big,
}

/// Type of a number.
#[derive(Clone, Copy)]
struct Type {
    bytes: usize,
    is_float: bool,
    is_signed: bool,
}

impl Type {
    fn named(name: &str) -> Option<Self> {
        let (bytes, is_float, is_signed) = match name {
            "char" | "int8" => (1, false, true),
            "uchar" | "uint8" => (1, false, false),
            "short" | "int16" => (2, false, true),
            "ushort" | "uint16" => (2, false, false),
            "int" | "int32" => (4, false, true),
            "uint" | "uint32" => (4, false, false),
            "float" | "float32" => (4, true, true),
            "double" | "float64" => (8, true, true),
            _ => return None,
        };
        Some(Self { bytes, is_float, is_signed })
    }

    /// Decodes a number from the first bytes of `bytes`, in the byte order of the file.
    fn value(self, bytes: &[u8], form: Form) -> f64 {
        let mut word = [0; 8];
        for (to, i) in word.iter_mut().zip(0..self.bytes) {
            *to = bytes[if form == Form::Big { self.bytes - 1 - i } else { i }];
        }
        let bits = u64::from_le_bytes(word);
        match (self.is_float, self.bytes) {
            (true, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, _) => f64::from_bits(bits),
            (false, n) if self.is_signed => {
                let unused = 64 - 8 * n as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            (false, _) => bits as f64,
        }
    }
}

/// A scalar of an element, or a list and the type of its length.
struct Property {
    name: String,
    of: Type,
    length: Option<Type>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    /// Returns the index of a scalar property.
    fn scalar_index(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name && property.length.is_none())
    }
}

/// The data after the header, read value by value.
struct Body<'s, 'a> {
    source: &'s Source<'a>,
    form: Form,
    /// Offset of the next byte and, in text, its line.
    at: usize,
    line: u64,
}

impl Body<'_, '_> {
    /// Returns the position of the next value.
    fn location(&mut self) -> At {
        if self.form != Form::Text {
            return At::Byte(self.at as u64);
        }
        let rest = &self.source.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.line += rest[..start].iter().filter(|b| **b == b'\n').count() as u64;
        self.at += start;
        At::Line(self.line)
    }

    fn value(&mut self, of: Type) -> Result<f64> {
        if self.form != Form::Text {
            let bytes = self.source.array("values", self.at as u64, 1, of.bytes as u64)?;
            self.at += of.bytes;
            return Ok(of.value(bytes, self.form));
        }
        let location = self.location();
        let rest = &self.source.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        let word = String::from_utf8_lossy(&rest[..length]);
        // Parse single-precision floats as such, so that written values read back exactly.
        let number = match of.is_float && of.bytes == 4 {
            true => word.parse::<f32>().map(f64::from),
            false => word.parse::<f64>(),
        };
        number.map_err(|_| {
            let excerpt = excerpt(&word);
            self.source.problem(location, format!("expected a number, found “{excerpt}”"))
        })
    }

    /// Reads the scalars of one item of an element and skips its lists.
    fn row(&mut self, element: &Element, row: &mut [f64]) -> Result<()> {
        for (property, value) in element.properties.iter().zip(row) {
            match property.length {
                None => *value = self.value(property.of)?,
                Some(length) => {
                    let count = self.value(length)?;
                    for _ in 0..count as u64 {
                        self.value(property.of)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Reads the whole file.
pub(crate) fn read(source: &Source) -> Result<Raw> {
    let mut raw = Raw::new("ply lines");
    let (elements, mut body) = header(source, &mut raw)?;
    let (mut points, mut radii, mut edges): (Vec<Vec3>, Vec<f32>, Vec<Vec<usize>>) = Default::default();
    let mut colors: Vec<[u8; 3]> = Vec::new();
    for element in &elements {
        let mut row = vec![0.0; element.properties.len()];
        let indices_of = |names: &[&str]| -> Result<Vec<usize>> {
            let index_of = |name: &&str| {
                let missing =
                    || source.problem(At::File, format!("the element {} has no {name}", element.name));
                element.scalar_index(name).ok_or_else(missing)
            };
            names.iter().map(index_of).collect()
        };
        match element.name.as_str() {
            "vertex" => {
                source.check_vertices(0, element.count)?;
                let (xyz, radius) = (indices_of(&["x", "y", "z"])?, element.scalar_index("radius"));
                let rgb = indices_of(&["red", "green", "blue"]).ok();
                if rgb.is_some() {
                    raw.notes.push("colors per vertex are ignored".into());
                }
                for _ in 0..element.count {
                    let location = body.location();
                    body.row(element, &mut row)?;
                    let read = xyz.iter().chain(&radius).map(|at| row[*at] as f32).collect::<Vec<_>>();
                    if let Some(bad) = read.iter().find(|v| !v.is_finite() && !source.lenient) {
                        let what = format!("a value of a vertex is {bad}, but must be finite");
                        return Err(source.problem(location, what));
                    }
                    points.push(Vec3::from_slice(&read));
                    radii.extend(read.get(3));
                    colors.extend(rgb.iter().map(|rgb| [0, 1, 2].map(|i| row[rgb[i]] as u8)));
                }
            }
            "edge" => {
                let ends = indices_of(&["vertex1", "vertex2"])?;
                for _ in 0..element.count {
                    let location = body.location();
                    body.row(element, &mut row)?;
                    let edge = [row[ends[0]], row[ends[1]]];
                    if let Some(bad) = edge.iter().find(|i| !(0.0..points.len() as f64).contains(*i)) {
                        let what = format!(
                            "vertex {bad} does not exist; there are {} before this edge",
                            points.len()
                        );
                        return Err(source.problem(location, what));
                    }
                    edges.push(edge.map(|i| i as usize).to_vec());
                }
            }
            _ => {
                for _ in 0..element.count {
                    body.row(element, &mut row)?;
                }
            }
        }
    }
    let has_faces = elements.iter().any(|element| element.name == "face" && element.count > 0);
    if edges.is_empty()
        && !has_faces
        && let Some(length) = runs::length(&points, &colors)
    {
        raw.notes.push(format!("the file has no edges; its points form strands of {length}"));
        points.chunks(length).for_each(|strand| raw.strands.push(strand));
        raw.strands.radii = radii;
        return Ok(raw);
    }
    if edges.is_empty() {
        let what = match has_faces {
            true => "the file holds a mesh without edges, so it has no strands",
            false => {
                "the file holds points without edges, and they do not show which strands they form: neither by colors nor by distances"
            }
        };
        return Err(source.problem(At::File, what));
    }
    for strand in chain(edges, points.len()) {
        raw.strands.push(&strand.iter().map(|i| points[*i]).collect::<Vec<_>>());
        raw.strands.radii.extend(strand.iter().filter_map(|i| radii.get(*i)));
    }
    Ok(raw)
}

/// Reads the header. Returns the elements and the data that follows.
fn header<'s, 'a>(source: &'s Source<'a>, raw: &mut Raw) -> Result<(Vec<Element>, Body<'s, 'a>)> {
    let mut elements: Vec<Element> = Vec::new();
    let mut form = None;
    let (mut at, mut line) = (0, 0);
    loop {
        let rest = &source.bytes[at..];
        let Some(length) = rest.iter().position(|b| *b == b'\n') else {
            return Err(source.problem(At::Byte(at as u64), "the file ends inside its header"));
        };
        line += 1;
        at += length + 1;
        let problem = |what: String| source.problem(At::Line(line), what);
        let text = String::from_utf8_lossy(&rest[..length]);
        let words: Vec<_> = text.split_ascii_whitespace().collect();
        let of = |name: &str| {
            let unknown = || problem(format!("“{}” is not a number type", excerpt(name)));
            Type::named(name).ok_or_else(unknown)
        };
        match words[..] {
            ["ply"] if line == 1 => {}
            _ if line == 1 => {
                return Err(problem("the file is not a .ply file: it does not start with “ply”".into()));
            }
            ["format", name, _] => {
                form = Some(match name {
                    "ascii" => Form::Text,
                    "binary_little_endian" => Form::Little,
                    "binary_big_endian" => Form::Big,
                    _ => return Err(problem(format!("“{}” is not a supported format", excerpt(name)))),
                });
            }
            ["element", name, count] => {
                let count = source.count(line, Some(count), "the count of an element")?;
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", ref rest @ ..] => {
                let (name, of, length) = match rest {
                    ["list", length, kind, name] => (*name, of(kind)?, Some(of(length)?)),
                    [kind, name] => (*name, of(kind)?, None),
                    _ => return Err(problem("a property needs a type and a name".into())),
                };
                let element = elements.last_mut();
                let element =
                    element.ok_or_else(|| problem("a property precedes the first element".into()))?;
                element.properties.push(Property { name: name.into(), of, length });
            }
            ["comment" | "obj_info", ..] => raw.declared = raw.declared.or(declared(&text)),
            ["end_header"] => break,
            _ => return Err(problem("the line is not valid in a header".into())),
        }
    }
    let form = form.ok_or_else(|| source.problem(At::Line(line), "the header does not state the format"))?;
    // Items without properties take no bytes, so the file's size would not bound their number.
    if let Some(empty) = elements.iter().find(|element| element.properties.is_empty() && element.count > 0) {
        return Err(source.problem(At::Line(line), format!("the element {} has no properties", empty.name)));
    }
    Ok((elements, Body { source, form, at, line: line + 1 }))
}
