//! Properties of objects: scalars, arrays, or compounds of other properties, sampled over time.

use super::{
    Archive,
    ogawa::{Data, Group, Reader},
};
use crate::error::{At, Result};

/// Element types, in the order of the format's codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pod {
    Bool,
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F16,
    F32,
    F64,
    Text,
    WideText,
}

impl Pod {
    const ALL: [Self; 14] = [
        Self::Bool,
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F16,
        Self::F32,
        Self::F64,
        Self::Text,
        Self::WideText,
    ];

    /// Returns the size of a number, bytes; 0 for text.
    fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
            Self::Text | Self::WideText => 0,
        }
    }
}

/// Size of the digest in front of each sample, bytes.
const DIGEST: usize = 16;

/// Structure of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Compound,
    Scalar,
    Array,
}

/// Description of a property.
#[derive(Clone, Debug)]
struct Header {
    name: String,
    meta: String,
    shape: Shape,
    pod: Pod,
    extent: usize,
    samples: u32,
    /// First and last sample that differs from the one before it; (0, 0) for a constant property. Only these samples
    /// and sample 0 are stored.
    changes: (u32, u32),
    sampling: usize,
}

/// A compound: properties by name.
#[derive(Clone, Debug, Default)]
pub(super) struct Compound<'a> {
    headers: Vec<Header>,
    group: Group<'a>,
}

impl std::fmt::Debug for Group<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} children at {}", self.len(), self.at)
    }
}

impl<'a> Compound<'a> {
    /// Reads the descriptions of a compound's properties.
    pub fn read(archive: &Archive<'_, 'a>, group: Group<'a>) -> Result<Self> {
        let source = archive.source;
        if group.len() == 0 {
            return Ok(Self::default());
        }
        let data = group.data(source, group.len() - 1, "the list of properties")?;
        let mut reader = Reader::new(source, data, "the properties");
        let mut headers = Vec::new();
        while !reader.done() {
            archive.spend(1, group.at)?;
            headers.push(Header::read(archive, &mut reader)?);
        }
        Ok(Self { headers, group })
    }

    /// Returns the names of all properties.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.headers.iter().map(|header| header.name.as_str())
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.headers.iter().position(|header| header.name == name)
    }

    /// Returns the compound `name`, if it exists.
    pub fn compound(&self, archive: &Archive<'_, 'a>, name: &str) -> Result<Option<Self>> {
        let Some(i) = self.find(name).filter(|i| self.headers[*i].shape == Shape::Compound) else {
            return Ok(None);
        };
        Self::read(archive, self.group.group(archive.source, i, name)?).map(Some)
    }

    /// Returns the scalar or array `name`, if it exists.
    pub fn property(&self, archive: &Archive<'_, 'a>, name: &str) -> Result<Option<Property<'a>>> {
        let Some(i) = self.find(name).filter(|i| self.headers[*i].shape != Shape::Compound) else {
            return Ok(None);
        };
        let header = self.headers[i].clone();
        Ok(Some(Property { group: self.group.group(archive.source, i, name)?, header }))
    }
}

impl Header {
    fn read(archive: &Archive, reader: &mut Reader) -> Result<Self> {
        let info = reader.number(4)?;
        let size = match info >> 2 & 3 {
            hint @ 0..3 => 1 << hint,
            _ => return reader.problem("the header of a property has an invalid size code"),
        };
        let shape = match info & 3 {
            0 => Shape::Compound,
            1 => Shape::Scalar,
            _ => Shape::Array,
        };
        let mut header = Self {
            name: String::new(),
            meta: String::new(),
            shape,
            pod: Pod::U8,
            extent: (info >> 12 & 0xff) as usize,
            samples: 0,
            changes: (0, 0),
            sampling: 0,
        };
        if shape != Shape::Compound {
            header.pod = match Pod::ALL.get((info >> 4 & 0xf) as usize) {
                Some(pod) => *pod,
                None => return reader.problem("a property has an unknown type"),
            };
            // `size` is at most 4 bytes.
            header.samples = reader.number(size)? as u32;
            header.changes = if info & 0x200 != 0 {
                (reader.number(size)? as u32, reader.number(size)? as u32)
            } else if info & 0x800 != 0 {
                (0, 0)
            } else {
                (1, header.samples.saturating_sub(1))
            };
            if info & 0x100 != 0 {
                header.sampling = reader.number(size)? as usize;
            }
            if header.sampling >= archive.samplings.len() {
                return reader.problem(format!("time sampling {} does not exist", header.sampling));
            }
        }
        let length = reader.number(size)?;
        header.name = reader.text(length)?.to_owned();
        header.meta = match (info >> 20 & 0xff) as usize {
            0xff => {
                let length = reader.number(size)?;
                reader.text(length)?.to_owned()
            }
            index => archive.meta(reader, index)?,
        };
        Ok(header)
    }
}

/// Returns the value of `key` in a text `key=value;key=value`.
pub(super) fn entry<'m>(meta: &'m str, key: &str) -> Option<&'m str> {
    meta.split(';').filter_map(|part| part.split_once('=')).find(|(name, _)| *name == key).map(|(_, v)| v)
}

/// A scalar or array property, sampled over time.
#[derive(Clone, Debug)]
pub(super) struct Property<'a> {
    header: Header,
    group: Group<'a>,
}

impl<'a> Property<'a> {
    /// Returns the value of `key` in the property's metadata.
    pub fn meta(&self, key: &str) -> Option<&str> {
        entry(&self.header.meta, key)
    }

    /// Returns the number of samples.
    pub fn samples(&self) -> u32 {
        self.header.samples
    }

    /// Returns whether the samples differ.
    pub fn moves(&self) -> bool {
        self.header.samples > 1 && self.header.changes != (0, 0)
    }

    /// Returns whether the numbers are integers or Booleans.
    pub fn is_integer(&self) -> bool {
        !matches!(self.header.pod, Pod::F16 | Pod::F32 | Pod::F64)
    }

    /// Returns the count of numbers per value.
    pub fn extent(&self) -> usize {
        self.header.extent.max(1)
    }

    /// Returns the time of sample `i`, seconds.
    pub fn time(&self, archive: &Archive, i: u32) -> f64 {
        archive.samplings[self.header.sampling].time(i)
    }

    /// Returns the bytes of the sample nearest to `time`; none if there are no samples.
    fn bytes(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Data<'a>> {
        let header = &self.header;
        if header.samples == 0 {
            return Ok(Data::default());
        }
        let sample = archive.samplings[header.sampling].nearest(time, header.samples);
        let (first, last) = header.changes;
        let stored = match sample {
            _ if sample < first || (first, last) == (0, 0) => 0,
            _ => (sample.min(last).saturating_sub(first) + 1) as usize,
        };
        // In arrays, each sample is followed by its dimensions.
        let child = if header.shape == Shape::Array { stored.saturating_mul(2) } else { stored };
        let data = self.group.data(archive.source, child, &header.name)?;
        let bytes = data.bytes.get(DIGEST..).unwrap_or_default();
        Ok(Data { bytes, at: data.at + DIGEST as u64 })
    }

    /// Returns the count of numbers in the sample nearest to time 0.
    pub fn count(&self, archive: &Archive<'_, 'a>) -> Result<u64> {
        Ok((self.bytes(archive, 0.0)?.bytes.len() / self.header.pod.size().max(1)) as u64)
    }

    /// Returns the numbers of the sample nearest to `time`, flattened, and their byte offset.
    fn numbers(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<(impl Iterator<Item = f64> + 'a, u64)> {
        let data = self.bytes(archive, time)?;
        let (pod, size) = (self.header.pod, self.header.pod.size());
        if size == 0 {
            let problem = format!("{} is text, but should be numbers", self.header.name);
            return Err(archive.source.problem(At::Byte(data.at), problem));
        }
        Ok((data.bytes.chunks_exact(size).map(move |bytes| number(pod, bytes)), data.at))
    }

    /// Returns [`Self::numbers`] as `f32`, finite unless the source is lenient.
    pub fn floats(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<f32>> {
        let (numbers, at) = self.numbers(archive, time)?;
        let size = self.header.pod.size() as u64;
        let mut all = Vec::with_capacity(numbers.size_hint().0);
        for (i, value) in numbers.enumerate() {
            let value = value as f32;
            if !value.is_finite() && !archive.source.lenient {
                let problem = format!("{} contains {value}, but numbers must be finite", self.header.name);
                return Err(archive.source.problem(At::Byte(at + i as u64 * size), problem));
            }
            all.push(value);
        }
        Ok(all)
    }

    /// Returns [`Self::numbers`] as `f64`.
    pub fn doubles(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<f64>> {
        Ok(self.numbers(archive, time)?.0.collect())
    }

    /// Returns [`Self::numbers`] as integers.
    pub fn integers(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<i64>> {
        // `f64` rounds integers of more than 53 bits, but no count or index is that large.
        Ok(self.numbers(archive, time)?.0.map(|value| value as i64).collect())
    }

    /// Returns the strings of the sample nearest to `time`.
    pub fn texts(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<String>> {
        let data = self.bytes(archive, time)?;
        if self.header.pod != Pod::Text {
            let problem = format!("{} should be text", self.header.name);
            return Err(archive.source.problem(At::Byte(data.at), problem));
        }
        let text = String::from_utf8_lossy(data.bytes);
        Ok(text.trim_end_matches('\0').split('\0').map(str::to_owned).collect())
    }

    /// Returns whether the property is text.
    pub fn is_text(&self) -> bool {
        self.header.pod == Pod::Text
    }

    /// Returns the property's position in the file.
    pub fn at(&self) -> At {
        At::Byte(self.group.at)
    }
}

/// Decodes a number; `bytes` has the size of `pod`.
fn number(pod: Pod, bytes: &[u8]) -> f64 {
    let mut wide = [0; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    let bits = u64::from_le_bytes(wide);
    match pod {
        Pod::I8 => f64::from(bits as u8 as i8),
        Pod::I16 => f64::from(bits as u16 as i16),
        Pod::I32 => f64::from(bits as u32 as i32),
        Pod::I64 => bits as i64 as f64,
        Pod::F16 => half(bits as u16),
        Pod::F32 => f64::from(f32::from_bits(bits as u32)),
        Pod::F64 => f64::from_bits(bits),
        _ => bits as f64,
    }
}

/// Decodes an IEEE 754 half float.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    let size = match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_type_is_decoded() {
        assert_eq!(number(Pod::I8, &[0xff]), -1.0);
        assert_eq!(number(Pod::U8, &[0xff]), 255.0);
        assert_eq!(number(Pod::I16, &[0xfe, 0xff]), -2.0);
        assert_eq!(number(Pod::I32, &(-7i32).to_le_bytes()), -7.0);
        assert_eq!(number(Pod::U32, &u32::MAX.to_le_bytes()), f64::from(u32::MAX));
        assert_eq!(number(Pod::I64, &(-9i64).to_le_bytes()), -9.0);
        assert_eq!(number(Pod::F32, &0.5f32.to_le_bytes()), 0.5);
        assert_eq!(number(Pod::F64, &0.1f64.to_le_bytes()), 0.1);
        assert_eq!([0x3c00, 0xc000, 0x0001, 0x3555].map(half), [1.0, -2.0, 2f64.powi(-24), 0.333251953125]);
        assert!(half(0x7e00).is_nan() && half(0xfc00) == f64::NEG_INFINITY);
    }

    #[test]
    fn entry_returns_value_of_key() {
        assert_eq!(entry("a=1;b=2=3;c", "b"), Some("2=3"));
        assert_eq!(entry("a=1;b=2=3;c", "c"), None);
    }
}
