//! Columns of integers for the files stored in this crate: their bytes, separated by significance, in Deflate.
//!
//! Predictions are mostly right, so most numbers are small, and their high bytes are equal.

use miniz_oxide::{deflate::compress_to_vec, inflate::decompress_to_vec};
use std::vec;

/// Highest compression level of `miniz_oxide`.
const LEVEL: u8 = 10;

/// Writer of `N` columns.
#[derive(Debug)]
pub(crate) struct Writer<const N: usize>([Vec<i32>; N]);

impl<const N: usize> Default for Writer<N> {
    fn default() -> Self {
        Self([const { Vec::new() }; N])
    }
}

impl<const N: usize> Writer<N> {
    /// Appends `value` to a column.
    pub(crate) fn put(&mut self, column: usize, value: i32) {
        self.0[column].push(value);
    }

    /// Returns the file's bytes.
    pub(crate) fn finish(self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for column in &self.0 {
            // The lowest bit is the sign, so that small negative numbers have no high bytes.
            let folded: Vec<u32> = column.iter().map(|v| ((v << 1) ^ (v >> 31)) as u32).collect();
            let max = folded.iter().copied().max().unwrap_or(0);
            let planes = 4 - max.leading_zeros() / 8;
            bytes.extend((folded.len() as u32).to_le_bytes());
            bytes.push(planes as u8);
            (0..planes).for_each(|plane| bytes.extend(folded.iter().map(|v| (v >> (8 * plane)) as u8)));
        }
        compress_to_vec(&bytes, LEVEL)
    }
}

/// Reader of the output of a [`Writer`].
#[derive(Debug)]
pub(crate) struct Reader<const N: usize>([vec::IntoIter<i32>; N]);

impl<const N: usize> Reader<N> {
    /// Reads all columns of `bytes`. Columns of damaged files are empty.
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let bytes = decompress_to_vec(bytes).unwrap_or_default();
        let mut rest = bytes.as_slice();
        Self(std::array::from_fn(|_| column(&mut rest).unwrap_or_default().into_iter()))
    }

    /// Returns the next number of a column, `None` at its end.
    pub(crate) fn get(&mut self, column: usize) -> Option<i32> {
        self.0[column].next()
    }

    /// Returns whether all numbers have been read.
    pub(crate) fn is_done(&self) -> bool {
        self.0.iter().all(|column| column.as_slice().is_empty())
    }
}

fn column(rest: &mut &[u8]) -> Option<Vec<i32>> {
    let count = u32::from_le_bytes(*rest.split_off(..4)?.first_chunk()?) as usize;
    let planes = *rest.split_off_first()?;
    let mut folded = vec![0u32; count];
    for plane in 0..u32::from(planes) {
        let bytes = rest.split_off(..count)?;
        folded.iter_mut().zip(bytes).for_each(|(v, byte)| *v |= u32::from(*byte) << (8 * plane));
    }
    Some(folded.into_iter().map(|v| (v >> 1) as i32 ^ -((v & 1) as i32)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_round_trip() {
        let values = (0..4000u32).map(|i| (crate::hash::pcg(i) as i32) >> (20 + i % 12));
        let values: Vec<i32> = values.chain([i32::MIN, i32::MAX, 0, -1]).collect();
        let mut writer = Writer::<3>::default();
        for (i, value) in values.iter().enumerate() {
            writer.put(0, *value);
            writer.put(2, i as i32 % 2);
        }
        let bytes = writer.finish();
        let mut reader = Reader::<3>::new(&bytes);
        for (i, value) in values.iter().enumerate() {
            assert_eq!((reader.get(0), reader.get(2)), (Some(*value), Some(i as i32 % 2)));
        }
        assert!(reader.is_done() && reader.get(1).is_none());
        assert!(Reader::<3>::new(&bytes[..9]).get(0).is_none());
    }
}
