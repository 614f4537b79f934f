//! Adaptive binary range coder (Martin 1979; carries as in LZMA).
//!
//! Each bit is coded under a context that estimates the probability of a 0: quickly at first, later over the last 64
//! bits. A bit costs `−log₂` of the probability that its context gave it.

/// The range is extended by a byte when it falls below this.
const TOP: u32 = 1 << 24;

/// Probability 1.
const CERTAIN: u32 = 1 << 16;

/// Slowest adaptation of a context: it moves by this negative power of 2 of the difference.
const SLOWEST: u32 = 6;

/// Number of bits after which the adaptation is slowest.
const LEARNT: u32 = 62;

/// Estimated probability of a 0, in units of 1/65536, and the number of bits seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Context {
    zero: u32,
    seen: u32,
}

impl Context {
    pub(super) const NEW: Self = Self { zero: CERTAIN / 2, seen: 0 };

    #[inline]
    fn learn(&mut self, bit: bool) {
        let pace = (u32::BITS - (self.seen + 2).leading_zeros()).min(SLOWEST);
        self.seen = (self.seen + 1).min(LEARNT);
        if bit {
            self.zero -= self.zero >> pace;
        } else {
            self.zero += (CERTAIN - self.zero) >> pace;
        }
    }

    /// The part of a range that represents 0.
    #[inline]
    fn share(self, span: u32) -> u32 {
        (span >> 12) * (self.zero >> 4)
    }
}

/// Encoder of bits.
#[derive(Debug)]
pub(super) struct Writer {
    out: Vec<u8>,
    low: u64,
    span: u32,
    /// The last byte that a carry may still change; none before the first.
    held: Option<u8>,
    /// Number of bytes 0xFF after it, through which a carry would propagate.
    waiting: usize,
}

impl Writer {
    pub(super) fn new() -> Self {
        Self { out: Vec::new(), low: 0, span: u32::MAX, held: None, waiting: 0 }
    }

    /// Encodes a bit under a context.
    #[inline]
    pub(super) fn bit(&mut self, bit: bool, context: &mut Context) {
        let share = context.share(self.span);
        if bit {
            self.low += u64::from(share);
            self.span -= share;
        } else {
            self.span = share;
        }
        context.learn(bit);
        while self.span < TOP {
            self.span <<= 8;
            self.shift();
        }
    }

    /// Encodes an unsigned number of `width` equally likely bits.
    pub(super) fn plain(&mut self, value: u64, width: u32) {
        for place in (0..width).rev() {
            self.span >>= 1;
            if value >> place & 1 == 1 {
                self.low += u64::from(self.span);
            }
            while self.span < TOP {
                self.span <<= 8;
                self.shift();
            }
        }
    }

    /// All bytes. Of the numbers in the range, the one with the most trailing zero bytes is taken, and these are
    /// omitted.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.low = self.low.next_multiple_of(u64::from(TOP));
        for _ in 0..5 {
            self.shift();
        }
        while self.out.last() == Some(&0) {
            self.out.pop();
        }
        self.out
    }

    /// Outputs the highest byte, unless it is 0xFF.
    fn shift(&mut self) {
        let [.., carry, highest, _, _, _] = self.low.to_be_bytes();
        if carry > 0 || highest < 0xFF {
            if let Some(held) = self.held {
                self.out.push(held.wrapping_add(carry));
            }
            self.out.resize(self.out.len() + self.waiting, 0xFF_u8.wrapping_add(carry));
            self.held = Some(highest);
            self.waiting = 0;
        } else {
            self.waiting += 1;
        }
        self.low = (self.low << 8) & u64::from(u32::MAX);
    }
}

/// Decoder of a [`Writer`]'s bytes. Past the end it reads zeros.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    data: std::slice::Iter<'a, u8>,
    code: u32,
    span: u32,
}

impl<'a> Reader<'a> {
    pub(super) fn new(data: &'a [u8]) -> Self {
        let mut reader = Self { data: data.iter(), code: 0, span: u32::MAX };
        for _ in 0..4 {
            reader.shift();
        }
        reader
    }

    /// Decodes a bit under a context.
    #[inline]
    pub(super) fn bit(&mut self, context: &mut Context) -> bool {
        let share = context.share(self.span);
        let bit = self.code >= share;
        if bit {
            self.code -= share;
            self.span -= share;
        } else {
            self.span = share;
        }
        context.learn(bit);
        while self.span < TOP {
            self.span <<= 8;
            self.shift();
        }
        bit
    }

    /// Decodes an unsigned number of `width` bits.
    pub(super) fn plain(&mut self, width: u32) -> u64 {
        let mut value = 0;
        for _ in 0..width {
            self.span >>= 1;
            let bit = self.code >= self.span;
            if bit {
                self.code -= self.span;
            }
            value = value << 1 | u64::from(bit);
            while self.span < TOP {
                self.span <<= 8;
                self.shift();
            }
        }
        value
    }

    #[inline]
    fn shift(&mut self) {
        self.code = self.code << 8 | self.data.next().map_or(0, |&byte| u32::from(byte));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn likely_bits_cost_little() {
        let mut writer = Writer::new();
        let mut context = Context::NEW;
        for i in 0..100_000 {
            writer.bit(i % 1000 == 0, &mut context);
        }
        assert!(writer.finish().len() < 100_000 / 8 / 20);
    }
}
