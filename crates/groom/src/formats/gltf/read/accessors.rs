//! Reads accessors, each only inside the bounds of its buffer.

use glam::Vec3;
use gltf::{
    Accessor,
    accessor::{DataType, sparse::IndexType},
};

use super::file::File;
use crate::error::Result;

impl File<'_> {
    /// Checks that an accessor's items have the expected type and lie inside their buffer.
    pub fn check(&self, accessor: &Accessor, kind: DataType, components: usize) -> Result<()> {
        let index_kind = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
        if accessor.data_type() != kind
            || accessor.dimensions().multiplicity() != components
            || (components == 1 && !index_kind)
        {
            self.data(accessor)?;
            return Err(self.wrong_kind(accessor));
        }
        self.data(accessor).map(|_| ())
    }

    /// Returns an accessor's numbers, flattened, `components` per item: floats or normalized integers. Numbers that are
    /// not finite are an error.
    pub fn numbers(&self, accessor: &Accessor, components: usize) -> Result<Vec<f32>> {
        let out = self.numbers_as_they_are(accessor, components)?;
        match out.iter().any(|v| !v.is_finite()) {
            true => {
                Err(self.problem(format!("accessor {} has numbers that are not finite", accessor.index())))
            }
            false => Ok(out),
        }
    }

    /// [`Self::numbers`] without the check for finite numbers.
    pub fn numbers_as_they_are(&self, accessor: &Accessor, components: usize) -> Result<Vec<f32>> {
        let kind = accessor.data_type();
        let integers = accessor.normalized() && kind != DataType::U32;
        if accessor.dimensions().multiplicity() != components || !(integers || kind == DataType::F32) {
            return Err(self.wrong_kind(accessor));
        }
        let (bytes, stride) = self.data(accessor)?;
        self.spend(accessor.count() * components, size_of::<f32>())?;
        let items = bytes.chunks(stride).flat_map(|item| item.chunks_exact(kind.size()).take(components));
        Ok(items.map(|b| number(b, kind, true)).collect())
    }

    /// Returns unsigned integers, flattened, `components` per item.
    pub fn integers(&self, accessor: &Accessor, components: usize) -> Result<Vec<u32>> {
        let kind = accessor.data_type();
        let fits = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
        if !fits || accessor.dimensions().multiplicity() != components {
            return Err(self.wrong_kind(accessor));
        }
        let (bytes, stride) = self.data(accessor)?;
        self.spend(accessor.count() * components, size_of::<u32>())?;
        let one = |b: &[u8]| b.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte));
        let items = bytes.chunks(stride).flat_map(|item| item.chunks_exact(kind.size()).take(components));
        Ok(items.map(one).collect())
    }

    /// Returns vectors of floats, or of integers as `KHR_mesh_quantization` allows them, normalized or not. Floats may
    /// not be finite.
    pub fn vectors<const N: usize>(&self, accessor: &Accessor) -> Result<Vec<[f32; N]>> {
        let kind = accessor.data_type();
        if accessor.dimensions().multiplicity() != N || kind == DataType::U32 {
            self.data(accessor)?;
            return Err(self.wrong_kind(accessor));
        }
        let (bytes, stride) = self.data(accessor)?;
        self.spend(accessor.count(), size_of::<[f32; N]>())?;
        let is_normalized = accessor.normalized();
        Ok(bytes.chunks(stride).map(|item| vector(item, kind, is_normalized)).collect())
    }

    /// [`Self::vectors`] for positions and normals.
    pub fn vec3s(&self, accessor: &Accessor) -> Result<Vec<Vec3>> {
        Ok(self.vectors(accessor)?.into_iter().map(Vec3::from_array).collect())
    }

    /// Returns the four joints of each vertex.
    pub fn joints(&self, accessor: &Accessor) -> Result<Vec<[u16; 4]>> {
        let kind = accessor.data_type();
        if !matches!(kind, DataType::U8 | DataType::U16) || accessor.dimensions().multiplicity() != 4 {
            return Err(self.wrong_kind(accessor));
        }
        let (bytes, stride) = self.data(accessor)?;
        self.spend(accessor.count(), size_of::<[u16; 4]>())?;
        let four = |item: &[u8]| match kind {
            DataType::U8 => [0, 1, 2, 3].map(|i| u16::from(item[i])),
            _ => [0, 2, 4, 6].map(|i| u16::from_le_bytes([item[i], item[i + 1]])),
        };
        Ok(bytes.chunks(stride).map(four).collect())
    }

    /// Returns the nonzero deltas of a morph target for `count` vertices, in ascending order. The accessor has floats,
    /// or integers as `KHR_mesh_quantization` allows them.
    pub fn deltas(&self, accessor: &Accessor, count: usize) -> Result<Vec<(u32, Vec3)>> {
        let index = accessor.index();
        let kind = accessor.data_type();
        if kind == DataType::U32 || accessor.dimensions().multiplicity() != 3 {
            return Err(self.wrong_kind(accessor));
        }
        let vector = |item: &[u8]| Vec3::from_array(vector(item, kind, accessor.normalized()));
        if accessor.count() != count {
            let have = accessor.count();
            return Err(self.problem(format!(
                "accessor {index} of a morph target has {have} vertices, but the mesh has {count}"
            )));
        }
        let mut given: Vec<(u32, Vec3)> = match accessor.view() {
            Some(_) => {
                let (bytes, stride) = self.items(accessor)?;
                self.spend(count, size_of::<(u32, Vec3)>())?;
                (0..).zip(bytes.chunks(stride).map(vector)).collect()
            }
            None => Vec::new(),
        };
        if let Some(sparse) = accessor.sparse() {
            self.overlay(accessor, &sparse, &mut given)?;
        }
        if given.iter().any(|(_, delta)| !delta.is_finite()) {
            return Err(self.problem(format!("accessor {index} has numbers that are not finite")));
        }
        given.retain(|(_, delta)| *delta != Vec3::ZERO);
        Ok(given)
    }

    /// Writes a sparse accessor's values over the dense ones in `given`, or adds them if there are none.
    fn overlay(
        &self,
        accessor: &Accessor,
        sparse: &gltf::accessor::sparse::Sparse,
        given: &mut Vec<(u32, Vec3)>,
    ) -> Result<()> {
        let (index, count, kind) = (accessor.index(), accessor.count(), accessor.data_type());
        let (n, indices, values) = (sparse.count(), sparse.indices(), sparse.values());
        let size = indices.index_type().size();
        let outside =
            || self.problem(format!("accessor {index} with {n} sparse items does not fit its buffer"));
        let at = self.window(&indices.view(), indices.offset(), n, size, size).ok_or_else(outside)?;
        let wide = 3 * kind.size();
        let to = self.window(&values.view(), values.offset(), n, wide, wide).ok_or_else(outside)?;
        self.spend(n, size_of::<(u32, Vec3)>())?;
        let dense = !given.is_empty();
        let mut min_index = 0u64;
        let values =
            to.chunks_exact(wide).map(|item| Vec3::from_array(vector(item, kind, accessor.normalized())));
        for (b, value) in at.chunks_exact(size).zip(values) {
            let vertex = match indices.index_type() {
                IndexType::U8 => u32::from(b[0]),
                IndexType::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
                IndexType::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            };
            if u64::from(vertex) < min_index || vertex as usize >= count {
                let problem = format!(
                    "accessor {index} has the sparse index {vertex}, which is too large or not ascending"
                );
                return Err(self.problem(problem));
            }
            min_index = u64::from(vertex) + 1;
            match given.get_mut(vertex as usize).filter(|_| dense) {
                Some(old) => old.1 = value,
                None => given.push((vertex, value)),
            }
        }
        Ok(())
    }

    /// Returns the bytes of an accessor's items and their stride. The last item may be shorter than the stride. Sparse
    /// accessors are an error.
    fn data(&self, accessor: &Accessor) -> Result<(&[u8], usize)> {
        if accessor.sparse().is_some() {
            let problem = format!("accessor {} is sparse, which is not supported here", accessor.index());
            return Err(self.problem(problem));
        }
        self.items(accessor)
    }

    /// [`Self::data`] without the sparse values.
    fn items(&self, accessor: &Accessor) -> Result<(&[u8], usize)> {
        let (index, count) = (accessor.index(), accessor.count());
        let Some(view) = accessor.view() else {
            return Err(self.problem(format!("accessor {index} has no data (compression is not supported)")));
        };
        let size = accessor.data_type().size() * accessor.dimensions().multiplicity();
        let stride = view.stride().unwrap_or(size);
        self.window(&view, accessor.offset(), count, stride, size)
            .filter(|_| count > 0)
            .map(|bytes| (bytes, stride))
            .ok_or_else(|| {
                self.problem(format!("accessor {index} with {count} items does not fit its buffer"))
            })
    }

    /// Returns `count` items of `size` bytes, `stride` apart, from byte `offset` of a view; `None` if they do not fit.
    fn window(
        &self,
        view: &gltf::buffer::View,
        offset: usize,
        count: usize,
        stride: usize,
        size: usize,
    ) -> Option<&[u8]> {
        let bytes: &[u8] = self.buffers.get(view.buffer().index())?;
        let bytes = bytes.get(view.offset()..)?.get(..view.length())?;
        let length = match count.checked_sub(1) {
            Some(n) => n.checked_mul(stride)?.checked_add(size)?,
            None => 0,
        };
        (stride >= size).then_some(bytes.get(offset..)?.get(..length)?)
    }

    pub fn wrong_kind(&self, accessor: &Accessor) -> crate::Error {
        self.problem(format!("accessor {} has the wrong data type", accessor.index()))
    }
}

/// Decodes a float, or an integer of up to 16 bits, which `is_normalized` normalizes.
fn number(b: &[u8], kind: DataType, is_normalized: bool) -> f32 {
    let (value, max) = match kind {
        DataType::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        DataType::U8 => (f32::from(b[0]), 255.0),
        DataType::I8 => (f32::from(b[0] as i8), 127.0),
        DataType::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
        _ => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
    };
    if is_normalized { (value / max).max(-1.0) } else { value }
}

/// Decodes a vector.
fn vector<const N: usize>(item: &[u8], kind: DataType, is_normalized: bool) -> [f32; N] {
    std::array::from_fn(|i| number(&item[i * kind.size()..], kind, is_normalized))
}
