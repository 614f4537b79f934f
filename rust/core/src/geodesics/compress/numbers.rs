//! Variable-length code for integers; the code length adapts to the values nearby.

use super::bits::{Context, Reader, Writer};

/// Number of size classes of the neighbourhood.
const CLASSES: usize = 24;

/// Bits of the largest magnitude.
const WIDEST: usize = 48;

/// Contexts for integers: the bit length of the magnitude, one bit at a time; then its second bit. The remaining bits
/// and the sign are stored plainly.
///
/// The contexts depend on the magnitudes nearby, because large values lie beside large ones.
#[derive(Debug)]
pub(super) struct Numbers {
    lengths: Vec<[Context; WIDEST]>,
    seconds: [Context; WIDEST + 1],
}

impl Numbers {
    pub(super) fn new() -> Self {
        Self { lengths: vec![[Context::NEW; WIDEST]; CLASSES], seconds: [Context::NEW; WIDEST + 1] }
    }

    /// Encodes a number below 2⁴⁸; `nearby` is the sum of magnitudes in its neighbourhood.
    pub(super) fn write(&mut self, writer: &mut Writer, value: i64, nearby: u64) {
        let size = value.unsigned_abs();
        let lengths = &mut self.lengths[size_class(nearby)];
        let length = bit_length(size);
        for context in &mut lengths[..length] {
            writer.bit(true, context);
        }
        if let Some(context) = lengths.get_mut(length) {
            writer.bit(false, context);
        }
        if length > 1 {
            writer.bit(size >> (length - 2) & 1 == 1, &mut self.seconds[length]);
        }
        if length > 2 {
            writer.plain(size, plain_bits(length));
        }
        if length > 0 {
            writer.plain(u64::from(value < 0), 1);
        }
    }

    /// Decodes a number.
    pub(super) fn read(&mut self, reader: &mut Reader<'_>, nearby: u64) -> i64 {
        let mut length = 0;
        for context in &mut self.lengths[size_class(nearby)] {
            if !reader.bit(context) {
                break;
            }
            length += 1;
        }
        if length == 0 {
            return 0;
        }
        let mut size = 1;
        if length > 1 {
            size = 2 | u64::from(reader.bit(&mut self.seconds[length]));
        }
        if length > 2 {
            size = size << (length - 2) | reader.plain(plain_bits(length));
        }
        let value = size.cast_signed();
        if reader.plain(1) == 1 { -value } else { value }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "at most 48")]
fn plain_bits(length: usize) -> u32 {
    (length - 2) as u32
}

#[inline]
fn bit_length(size: u64) -> usize {
    (u64::BITS - size.leading_zeros()) as usize
}

/// Class of a size: two classes for each power of 2.
#[inline]
#[allow(clippy::cast_possible_truncation, reason = "0 or 1")]
fn size_class(size: u64) -> usize {
    if size < 2 {
        return size as usize;
    }
    let length = bit_length(size);
    (2 * (length - 1) + (size >> (length - 2) & 1) as usize).min(CLASSES - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let numbers: Vec<i64> = (0..4000_i64)
            .map(|i| (i * i * 2_654_435_761 % 97 - 48) * if i % 500 == 7 { 1 << 40 } else { 1 })
            .collect();
        let (mut writer, mut contexts) = (Writer::new(), Numbers::new());
        for (i, &number) in numbers.iter().enumerate() {
            contexts.write(&mut writer, number, i as u64);
        }
        let bytes = writer.finish();
        let (mut reader, mut contexts) = (Reader::new(&bytes), Numbers::new());
        let back: Vec<i64> = (0..numbers.len()).map(|i| contexts.read(&mut reader, i as u64)).collect();
        assert_eq!(back, numbers);
    }

    #[test]
    fn any_bytes_can_be_read() {
        let bytes: Vec<u8> = (0..200_u8).map(|i| i.wrapping_mul(151)).collect();
        let (mut reader, mut contexts) = (Reader::new(&bytes), Numbers::new());
        for i in 0..2000 {
            assert!(contexts.read(&mut reader, i).unsigned_abs() < 1 << WIDEST);
        }
    }
}
