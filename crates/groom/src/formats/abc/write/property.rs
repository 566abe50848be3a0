//! Writes properties: samples in a group, descriptions in the list of the compound.

use std::{
    borrow::Cow,
    io::{Result, Seek, Write},
};

use super::ogawa::{NodeOffset, Ogawa};

/// Element type: code in the format, size in bytes, name.
#[derive(Clone, Copy)]
pub(super) struct Pod {
    code: u32,
    pub size: u32,
    name: &'static str,
}

pub(super) const BOOL: Pod = Pod { code: 0, size: 1, name: "bool_t" };
pub(super) const U8: Pod = Pod { code: 1, size: 1, name: "uint8_t" };
pub(super) const I16: Pod = Pod { code: 4, size: 2, name: "int16_t" };
pub(super) const I32: Pod = Pod { code: 6, size: 4, name: "int32_t" };
pub(super) const F32: Pod = Pod { code: 10, size: 4, name: "float32_t" };
pub(super) const F64: Pod = Pod { code: 11, size: 8, name: "float64_t" };
pub(super) const TEXT: Pod = Pod { code: 12, size: 1, name: "string" };

/// A compound being written.
#[derive(Default)]
pub(super) struct Compound {
    children: Vec<NodeOffset>,
    list: Vec<u8>,
}

/// A property being written, sample by sample.
pub(super) struct SampledProperty {
    name: Cow<'static, str>,
    meta: String,
    pod: Pod,
    extent: u32,
    array: bool,
    offsets: Vec<NodeOffset>,
}

impl SampledProperty {
    /// Returns a scalar property of `extent` numbers.
    pub fn scalar(name: impl Into<Cow<'static, str>>, meta: &str, pod: Pod, extent: u32) -> Self {
        Self { name: name.into(), meta: meta.to_owned(), pod, extent, array: false, offsets: Vec::new() }
    }

    /// Returns an array property of `extent` numbers per element.
    pub fn array(name: impl Into<Cow<'static, str>>, meta: &str, pod: Pod, extent: u32) -> Self {
        Self { array: true, ..Self::scalar(name, meta, pod, extent) }
    }

    /// Returns a parameter beside the geometry, of scope `con`, `uni` or `vtx`.
    pub fn param(
        name: impl Into<Cow<'static, str>>,
        pod: Pod,
        extent: u32,
        scope: &str,
        interpretation: &str,
    ) -> Self {
        let interpretation = match interpretation {
            "" => String::new(),
            name => format!("interpretation={name};"),
        };
        let pod_name = pod.name;
        let meta = format!(
            "arrayExtent=1;geoScope={scope};{interpretation}isGeomParam=true;podExtent={extent};podName={pod_name}"
        );
        Self::array(name, &meta, pod, extent)
    }

    /// Adds a sample. For text, the dimensions store the number of strings.
    pub fn push<W: Write + Seek>(&mut self, out: &mut Ogawa<W>, bytes: &[u8]) -> Result<()> {
        let offset = out.sample(bytes, self.pod.size)?;
        self.offsets.push(offset);
        if self.array {
            let texts = bytes.iter().filter(|byte| **byte == 0).count() as u64;
            let counts = if self.pod.code == TEXT.code { texts.to_le_bytes().to_vec() } else { Vec::new() };
            let offset = out.data(&counts)?;
            self.offsets.push(offset);
        }
        Ok(())
    }
}

impl Compound {
    /// Ends a property. `sampling` is the time sampling to use if there are several samples.
    pub fn close<W: Write + Seek>(
        &mut self,
        out: &mut Ogawa<W>,
        property: SampledProperty,
        sampling: u32,
    ) -> Result<()> {
        let SampledProperty { name, meta, pod, extent, array, mut offsets } = property;
        let each = if array { 2 } else { 1 };
        let count = (offsets.len() / each) as u32;
        let constant = offsets.chunks_exact(each).all(|sample| sample[0] == offsets[0]);
        if constant {
            offsets.truncate(each);
        }
        let mut info = if array { 2 } else { 1 };
        info |= pod.code << 4 | extent << 12 | 0x400;
        info |= if constant { 0x800 } else { 0 };
        let sampling = if count > 1 { sampling } else { 0 };
        info |= if sampling > 0 { 0x100 } else { 0 };
        let mut numbers = vec![count];
        numbers.extend((sampling > 0).then_some(sampling));
        let group = out.group(&offsets)?;
        self.entry(out, group, info, &numbers, &name, &meta);
        Ok(())
    }

    /// Adds a property with one sample for all times.
    pub fn constant<W: Write + Seek>(
        &mut self,
        out: &mut Ogawa<W>,
        mut property: SampledProperty,
        bytes: &[u8],
    ) -> Result<()> {
        property.push(out, bytes)?;
        self.close(out, property, 0)
    }

    /// Adds a nested compound.
    pub fn inside<W: Write + Seek>(
        &mut self,
        out: &mut Ogawa<W>,
        name: &str,
        meta: &str,
        inner: Self,
    ) -> Result<()> {
        let group = inner.finish(out)?;
        self.entry(out, group, 0, &[], name, meta);
        Ok(())
    }

    fn entry<W: Write + Seek>(
        &mut self,
        out: &mut Ogawa<W>,
        group: NodeOffset,
        mut info: u32,
        numbers: &[u32],
        name: &str,
        meta: &str,
    ) {
        let index = out.shared_index(meta);
        let longest =
            numbers.iter().copied().chain([name.len() as u32, meta.len() as u32]).max().unwrap_or(0);
        let (hint, size) = match longest {
            0..256 => (0, 1),
            256..65536 => (1, 2),
            _ => (2, 4),
        };
        info |= hint << 2 | u32::from(index.unwrap_or(0xff)) << 20;
        self.children.push(group);
        self.list.extend(info.to_le_bytes());
        let mut put = |value: u32| self.list.extend(&value.to_le_bytes()[..size]);
        numbers.iter().for_each(|number| put(*number));
        put(name.len() as u32);
        self.list.extend(name.bytes());
        if index.is_none() {
            self.list.extend(&(meta.len() as u32).to_le_bytes()[..size]);
            self.list.extend(meta.bytes());
        }
    }

    /// Writes the compound's group and returns its offset.
    pub fn finish<W: Write + Seek>(self, out: &mut Ogawa<W>) -> Result<NodeOffset> {
        if self.children.is_empty() {
            return Ok(0);
        }
        let mut children = self.children;
        children.push(out.data(&self.list)?);
        out.group(&children)
    }
}
