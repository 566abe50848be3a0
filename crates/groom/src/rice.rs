//! Variable-length coding of integers for the files stored in this crate.
//!
//! Numbers are written as in JPEG-LS (Rice coding): the low `k` bits unchanged, the rest as that many zeros and a one.
//! `k` follows from the mean of the numbers that the [`Context`] has seen so far. Predictions are mostly right, so most
//! numbers are small.

/// Statistics of one kind of number.
#[derive(Clone, Debug)]
pub(crate) struct Context {
    sum: u64,
    count: u64,
}

impl Default for Context {
    fn default() -> Self {
        Self { sum: 4, count: 1 }
    }
}

/// Number of zeros from which on a number is stored plainly, in 32 bits.
const ESCAPE: u32 = 24;

/// Numbers after which the statistics are halved.
const MEMORY: u64 = 256;

impl Context {
    /// Returns the number of low bits that are stored unchanged.
    fn low_bits(&self) -> u32 {
        (0..31).find(|k| self.count << k >= self.sum).unwrap_or(31)
    }

    fn learn(&mut self, folded: u32) {
        self.sum += u64::from(folded);
        self.count += 1;
        if self.count >= MEMORY {
            self.sum /= 2;
            self.count /= 2;
        }
    }
}

/// Bit writer, the lowest bit of each byte first.
#[derive(Debug, Default)]
pub(crate) struct Writer {
    bytes: Vec<u8>,
    used: u32,
}

impl Writer {
    /// Writes one bit.
    pub(crate) fn bit(&mut self, bit: bool) {
        if self.used.is_multiple_of(8) {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (self.used % 8);
        }
        self.used += 1;
    }

    fn bits(&mut self, value: u32, count: u32) {
        (0..count).for_each(|i| self.bit(value >> i & 1 == 1));
    }

    /// Writes a number with the statistics of `context`.
    pub(crate) fn put(&mut self, context: &mut Context, value: i32) {
        let folded = ((value << 1) ^ (value >> 31)) as u32;
        let k = context.low_bits();
        let high = folded >> k;
        let zeros = high.min(ESCAPE);
        (0..zeros).for_each(|_| self.bit(false));
        self.bit(true);
        if zeros == ESCAPE {
            self.bits(folded, 32)
        } else {
            self.bits(folded, k)
        }
        context.learn(folded);
    }

    /// Returns the bytes.
    pub(crate) fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reader of the output of a [`Writer`].
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Buffered bits, the next one lowest.
    held: u64,
    count: u32,
}

impl<'a> Reader<'a> {
    /// Starts at the beginning of `bytes`.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, held: 0, count: 0 }
    }

    /// Fills the buffer to at least 57 bits; zeros follow the end.
    fn fill(&mut self) {
        while self.count <= 56 {
            let byte = self.bytes.get(self.at).copied().unwrap_or(0);
            self.held |= u64::from(byte) << self.count;
            self.at += 1;
            self.count += 8;
        }
    }

    fn bits(&mut self, count: u32) -> u32 {
        self.fill();
        let value = self.held & ((1 << count) - 1);
        self.held >>= count;
        self.count -= count;
        value as u32
    }

    /// Reads one bit.
    pub(crate) fn bit(&mut self) -> bool {
        self.bits(1) == 1
    }

    /// Reads a number with the statistics of `context`.
    pub(crate) fn get(&mut self, context: &mut Context) -> i32 {
        let k = context.low_bits();
        self.fill();
        let zeros = self.held.trailing_zeros().min(ESCAPE);
        self.bits(zeros + 1);
        let folded = if zeros == ESCAPE { self.bits(32) } else { zeros << k | self.bits(k) };
        context.learn(folded);
        (folded >> 1) as i32 ^ -((folded & 1) as i32)
    }

    /// Returns whether exactly all bytes have been read.
    pub(crate) fn is_done(&self) -> bool {
        self.at - (self.count / 8) as usize == self.bytes.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_round_trip() {
        let values: Vec<i32> = (0..4000u32)
            .map(|i| (crate::hash::pcg(i) as i32) >> (20 + i % 12))
            .chain([i32::MIN, i32::MAX, 0, -1])
            .collect();
        let mut writer = Writer::default();
        let mut context = Context::default();
        for (i, value) in values.iter().enumerate() {
            writer.put(&mut context, *value);
            writer.bit(i % 3 == 0);
        }
        let bytes = writer.finish();
        let mut reader = Reader::new(&bytes);
        let mut context = Context::default();
        for (i, value) in values.iter().enumerate() {
            assert_eq!(reader.get(&mut context), *value);
            assert_eq!(reader.bit(), i % 3 == 0);
        }
        assert!(reader.is_done());
    }

    #[test]
    fn small_numbers_take_few_bits() {
        let mut writer = Writer::default();
        let mut context = Context::default();
        (0..8000).for_each(|i| writer.put(&mut context, i32::from(i % 10 == 0)));
        assert!(writer.finish().len() < 1300);
    }
}
