//! Properties: named values of an object, alone, as arrays, or as compounds of others; sampled over time.

use super::{
    Archive,
    ogawa::{Data, Group, Reader},
};
use crate::error::{At, Result};

/// What a value is made of, in the order of the format's numbers.
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

    /// Bytes of a number, 0 for text.
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

/// Scalars that are no compound have a digest of 16 bytes in front of their values.
const DIGEST: usize = 16;

/// What a property is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Compound,
    Scalar,
    Array,
}

/// A property's description.
#[derive(Clone, Debug)]
struct Header {
    name: String,
    meta: String,
    shape: Shape,
    pod: Pod,
    extent: usize,
    samples: u32,
    /// Samples before the first and after the last are not repeated in the file.
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
        let data = group.data(source, group.len() - 1, "a compound's list of properties")?;
        let mut reader = Reader::new(source, data, "a compound's properties");
        let mut headers = Vec::new();
        while !reader.done() {
            archive.spend(1, group.at)?;
            headers.push(Header::read(archive, &mut reader)?);
        }
        Ok(Self { headers, group })
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.headers.iter().position(|header| header.name == name)
    }

    /// The compound of this name, if there is one.
    pub fn compound(&self, archive: &Archive<'_, 'a>, name: &str) -> Result<Option<Self>> {
        let Some(i) = self.find(name).filter(|i| self.headers[*i].shape == Shape::Compound) else {
            return Ok(None);
        };
        Self::read(archive, self.group.group(archive.source, i, name)?).map(Some)
    }

    /// The values of this name, if there are any.
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
            _ => return reader.problem("a property's description whose numbers have no size"),
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
                None => return reader.problem("a property of a kind that the format does not have"),
            };
            // At most four bytes.
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

/// One entry of a text `key=value;key=value`.
pub(super) fn entry<'m>(meta: &'m str, key: &str) -> Option<&'m str> {
    meta.split(';').filter_map(|part| part.split_once('=')).find(|(name, _)| *name == key).map(|(_, v)| v)
}

/// Values, sampled over time.
#[derive(Clone, Debug)]
pub(super) struct Property<'a> {
    header: Header,
    group: Group<'a>,
}

impl<'a> Property<'a> {
    /// What the file says about it under `key`.
    pub fn meta(&self, key: &str) -> Option<&str> {
        entry(&self.header.meta, key)
    }

    /// How many samples there are.
    pub fn samples(&self) -> u32 {
        self.header.samples
    }

    /// Whether its samples differ.
    pub fn moves(&self) -> bool {
        self.header.samples > 1 && self.header.changes != (0, 0)
    }

    /// How many numbers make one value.
    pub fn extent(&self) -> usize {
        self.header.extent.max(1)
    }

    /// The time of sample `i`, seconds.
    pub fn time(&self, archive: &Archive, i: u32) -> f64 {
        archive.samplings[self.header.sampling].time(i)
    }

    /// The bytes of the sample nearest to `time`; nothing where there are no samples.
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
        // Arrays have their dimensions beside each sample.
        let child = if header.shape == Shape::Array { stored.saturating_mul(2) } else { stored };
        let data = self.group.data(archive.source, child, &header.name)?;
        let bytes = data.bytes.get(DIGEST..).unwrap_or_default();
        Ok(Data { bytes, at: data.at + DIGEST as u64 })
    }

    /// How many numbers its first sample has.
    pub fn count(&self, archive: &Archive<'_, 'a>) -> Result<u64> {
        Ok((self.bytes(archive, 0.0)?.bytes.len() / self.header.pod.size().max(1)) as u64)
    }

    /// The numbers of the sample nearest to `time`, as `f64`, in one row.
    fn numbers(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<(impl Iterator<Item = f64> + 'a, u64)> {
        let data = self.bytes(archive, time)?;
        let (pod, size) = (self.header.pod, self.header.pod.size());
        if size == 0 {
            let problem = format!("{} is text where numbers are expected", self.header.name);
            return Err(archive.source.problem(At::Byte(data.at), problem));
        }
        Ok((data.bytes.chunks_exact(size).map(move |bytes| number(pod, bytes)), data.at))
    }

    /// The same as `f32`, which are finite unless the source is lenient.
    pub fn floats(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<f32>> {
        let (numbers, at) = self.numbers(archive, time)?;
        let size = self.header.pod.size() as u64;
        let mut all = Vec::with_capacity(numbers.size_hint().0);
        for (i, value) in numbers.enumerate() {
            let value = value as f32;
            if !value.is_finite() && !archive.source.lenient {
                let problem = format!("{value} in {}, which must be finite", self.header.name);
                return Err(archive.source.problem(At::Byte(at + i as u64 * size), problem));
            }
            all.push(value);
        }
        Ok(all)
    }

    /// The same as `f64`.
    pub fn doubles(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<f64>> {
        Ok(self.numbers(archive, time)?.0.collect())
    }

    /// The same as whole numbers.
    pub fn integers(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<i64>> {
        // Numbers of more than 53 bits would round; nothing that is counted here has so many.
        Ok(self.numbers(archive, time)?.0.map(|value| value as i64).collect())
    }

    /// The texts of the sample nearest to `time`.
    pub fn texts(&self, archive: &Archive<'_, 'a>, time: f64) -> Result<Vec<String>> {
        let data = self.bytes(archive, time)?;
        if self.header.pod != Pod::Text {
            let problem = format!("{} is expected to be text", self.header.name);
            return Err(archive.source.problem(At::Byte(data.at), problem));
        }
        let text = String::from_utf8_lossy(data.bytes);
        Ok(text.trim_end_matches('\0').split('\0').map(str::to_owned).collect())
    }

    /// Whether it is text.
    pub fn is_text(&self) -> bool {
        self.header.pod == Pod::Text
    }

    /// Where it lies.
    pub fn at(&self) -> At {
        At::Byte(self.group.at)
    }
}

/// A number of any kind; `bytes` has its size.
fn number(pod: Pod, bytes: &[u8]) -> f64 {
    let mut wide = [0; 8];
    wide[..bytes.len()].copy_from_slice(bytes);
    let whole = u64::from_le_bytes(wide);
    match pod {
        Pod::I8 => f64::from(whole as u8 as i8),
        Pod::I16 => f64::from(whole as u16 as i16),
        Pod::I32 => f64::from(whole as u32 as i32),
        Pod::I64 => whole as i64 as f64,
        Pod::F16 => half(whole as u16),
        Pod::F32 => f64::from(f32::from_bits(whole as u32)),
        Pod::F64 => f64::from_bits(whole),
        _ => whole as f64,
    }
}

/// An IEEE number of 16 bits.
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
    fn numbers_of_every_kind() {
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
    fn entries_of_a_text() {
        assert_eq!(entry("a=1;b=2=3;c", "b"), Some("2=3"));
        assert_eq!(entry("a=1;b=2=3;c", "c"), None);
    }
}
