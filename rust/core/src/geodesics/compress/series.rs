//! Integer series in time, hierarchically: every 32nd value first, then repeatedly the middle ones, predicted from
//! both sides.
//!
//! Values are in 1/64 of a step. Differences from the predictions are coded in whole steps. So a decoded value is at
//! most half a step off, whatever the prediction was, and smooth motion between coded values costs almost nothing.
//! Arithmetic wraps: no input can make it fail.

use super::bits::{Reader, Writer};
use super::numbers::Numbers;
use crate::Error;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Fractions of a step in which predictions are computed.
pub(super) const STEP: i64 = 1 << STEP_SHIFT;

/// The same as a power of 2.
const STEP_SHIFT: u32 = 6;

/// Largest number of halvings: values 2⁵ frames apart are almost independent.
const LEVELS: usize = 5;

/// Interpolation at the middle: linear, cubic, quintic. Weights of the neighbours, and the power of 2 that divides
/// their sum.
const KERNELS: [([i64; 6], u32); 3] =
    [([0, 0, 1, 1, 0, 0], 1), ([0, -1, 9, 9, -1, 0], 4), ([3, -25, 150, 150, -25, 3], 8)];

/// Neighbours on each side that the widest kernel uses.
const REACH: usize = 3;

/// Values between two checks of the interrupt flag: some milliseconds.
pub(super) const CHECKED: usize = 1 << 16;

/// Size of the unknown neighbourhood of the first value.
const FAR: u64 = 1 << 8;

/// A series as it is written: differences in steps, and the kernel of each level, coarse levels first.
#[derive(Debug, Clone, Default)]
pub(super) struct Series {
    steps: Vec<i64>,
    kernels: Vec<usize>,
}

/// Number of times that the distance of the first values is halved.
fn halvings(n: usize) -> usize {
    (0..LEVELS).take_while(|level| 2 << level < n).count()
}

multiversion! {
    /// Interpolates halfway between the known values; `known` has [`REACH`] more of them on both sides.
    fn interpolate(known: &[i64], kernel: usize, out: &mut [i64]) {
        let (weights, shift) = KERNELS[kernel];
        let round = 1_i64 << (shift - 1);
        for (window, out) in known[1..].windows(2 * REACH).zip(out) {
            let mut sum = round;
            for c in 0..2 * REACH {
                sum = sum.wrapping_add(window[c].wrapping_mul(weights[c]));
            }
            *out = sum >> shift;
        }
    }
}

multiversion! {
    /// Differences from the predictions, in steps; returns the sum of their magnitudes.
    fn subtract(numbers: &[i64], predictions: &[i64], out: &mut [i64]) -> u64 {
        let mut total = 0_u64;
        for ((&x, &p), out) in numbers.iter().zip(predictions).zip(out) {
            let step = x.wrapping_sub(p).wrapping_add(STEP / 2) >> STEP_SHIFT;
            *out = step;
            total = total.wrapping_add(step.unsigned_abs());
        }
        total
    }
}

/// The values known before `level`, with [`REACH`] more on both sides by linear extrapolation.
fn known(back: &[i64], level: usize, out: &mut Vec<i64>) {
    out.clear();
    out.resize(REACH, 0);
    out.extend(back.iter().step_by(2 << level));
    let count = out.len() - REACH;
    let (first, last) = (out[REACH], out[REACH + count - 1]);
    let (mut before, mut after) = (0_i64, 0_i64);
    if count > 1 {
        before = first.wrapping_sub(out[REACH + 1]);
        after = last.wrapping_sub(out[REACH + count - 2]);
    }
    let (mut low, mut high) = (first, last);
    for i in 0..REACH {
        low = low.wrapping_add(before);
        high = high.wrapping_add(after);
        out[REACH - 1 - i] = low;
        out.push(high);
    }
}

/// The coded differences, and the decoded values.
pub(super) fn differences(numbers: &[i64]) -> (Series, Vec<i64>) {
    let n = numbers.len();
    let levels = halvings(n);
    let (mut back, mut steps) = (vec![0_i64; n], vec![0_i64; n]);
    let mut before = 0_i64;
    for i in (0..n).step_by(1 << levels) {
        steps[i] = numbers[i].wrapping_sub(before).wrapping_add(STEP / 2) >> STEP_SHIFT;
        before = before.wrapping_add(steps[i].wrapping_mul(STEP));
        back[i] = before;
    }
    let mut kernels = Vec::with_capacity(levels);
    let (mut around, mut here) = (Vec::new(), Vec::new());
    let mut trials: [(Vec<i64>, Vec<i64>); KERNELS.len()] = Default::default();
    for level in (0..levels).rev() {
        let places = || (1 << level..n).step_by(2 << level);
        known(&back, level, &mut around);
        here.clear();
        here.extend(places().map(|i| numbers[i]));
        let mut best = (0, u64::MAX);
        for (kernel, (predictions, found)) in trials.iter_mut().enumerate() {
            predictions.resize(here.len(), 0);
            found.resize(here.len(), 0);
            interpolate(&around, kernel, predictions);
            let total = subtract(&here, predictions, found);
            if total < best.1 {
                best = (kernel, total);
            }
        }
        kernels.push(best.0);
        let (predictions, found) = &trials[best.0];
        for ((i, &p), &step) in places().zip(predictions).zip(found) {
            steps[i] = step;
            back[i] = p.wrapping_add(step.wrapping_mul(STEP));
        }
    }
    (Series { steps, kernels }, back)
}

impl Series {
    /// The decoded values.
    pub(super) fn restored(&self) -> Vec<i64> {
        let n = self.steps.len();
        let mut back = vec![0_i64; n];
        let mut before = 0_i64;
        for i in (0..n).step_by(1 << self.kernels.len()) {
            before = before.wrapping_add(self.steps[i].wrapping_mul(STEP));
            back[i] = before;
        }
        let (mut around, mut predictions) = (Vec::new(), Vec::new());
        for (level, &kernel) in (0..self.kernels.len()).rev().zip(&self.kernels) {
            let places = (1 << level..n).step_by(2 << level);
            known(&back, level, &mut around);
            predictions.resize(places.len(), 0);
            interpolate(&around, kernel, &mut predictions);
            for (i, &p) in places.zip(&predictions) {
                back[i] = p.wrapping_add(self.steps[i].wrapping_mul(STEP));
            }
        }
        back
    }

    /// Encodes the series; `ahead` are the contexts of the first values, `between` those of the others.
    pub(super) fn write(
        &self,
        writer: &mut Writer,
        ahead: &mut Numbers,
        between: &mut Numbers,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (steps, top) = (&self.steps[..], 1 << self.kernels.len());
        for (count, i) in (0..steps.len()).step_by(top).enumerate() {
            check(count, interrupt)?;
            ahead.write(writer, steps[i], size_before(steps, i, top));
        }
        let mut usual = Usual::new();
        for (level, &kernel) in (0..self.kernels.len()).rev().zip(&self.kernels) {
            writer.plain(kernel as u64, 2);
            for (count, i) in (1 << level..steps.len()).step_by(2 << level).enumerate() {
                check(count, interrupt)?;
                between.write(writer, steps[i], sizes_nearby(steps, i, 1 << level) + usual.size());
                usual.learn(steps[i].unsigned_abs());
            }
        }
        Ok(())
    }

    /// Decodes a series of `n` values.
    pub(super) fn read(
        reader: &mut Reader<'_>,
        n: usize,
        ahead: &mut Numbers,
        between: &mut Numbers,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let levels = halvings(n);
        let (mut steps, mut kernels, top) = (vec![0_i64; n], Vec::with_capacity(levels), 1 << levels);
        for (count, i) in (0..n).step_by(top).enumerate() {
            check(count, interrupt)?;
            steps[i] = ahead.read(reader, size_before(&steps, i, top));
        }
        let mut usual = Usual::new();
        for level in (0..levels).rev() {
            kernels.push(usize::from(reader.plain(2).to_le_bytes()[0]) % KERNELS.len());
            for (count, i) in (1 << level..n).step_by(2 << level).enumerate() {
                check(count, interrupt)?;
                steps[i] = between.read(reader, sizes_nearby(&steps, i, 1 << level) + usual.size());
                usual.learn(steps[i].unsigned_abs());
            }
        }
        Ok(Self { steps, kernels })
    }
}

/// Checks the interrupt flag at every [`CHECKED`]-th value.
fn check(count: usize, interrupt: &Interrupt) -> Result<(), Error> {
    if count.is_multiple_of(CHECKED) { interrupt.check() } else { Ok(()) }
}

/// Running mean of the magnitudes, over about the last 16 values.
struct Usual {
    sum: u64,
}

impl Usual {
    /// Start value: as if all magnitudes had been 2.
    fn new() -> Self {
        Self { sum: 512 }
    }

    fn learn(&mut self, size: u64) {
        self.sum = self.sum - (self.sum >> 4) + 16 * size;
    }

    /// 16 times the mean.
    fn size(&self) -> u64 {
        self.sum >> 4
    }
}

/// Four times the previous magnitude among the first values.
fn size_before(steps: &[i64], i: usize, top: usize) -> u64 {
    // The first value is not a difference.
    if i < 2 * top { FAR } else { 4 * steps[i - top].unsigned_abs() }
}

/// The sum of four magnitudes known to encoder and decoder: two previous ones of this level, and those of coarser
/// levels on both sides.
#[inline]
fn sizes_nearby(steps: &[i64], i: usize, apart: usize) -> u64 {
    let at =
        |place: Option<usize>| place.and_then(|place| steps.get(place)).map_or(0, |step| step.unsigned_abs());
    let last = if i > apart { steps[i - apart].unsigned_abs() } else { 0 };
    2 * at(i.checked_sub(2 * apart)) + at(i.checked_sub(4 * apart)) + last + at(Some(i + apart))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_back_is_half_a_step_off_at_most() {
        for n in [1_u16, 2, 3, 4, 5, 31, 32, 33, 64, 65, 1000] {
            let numbers: Vec<i64> =
                (0..i64::from(n)).map(|i| (i * i * 37 % 100_003) * if i % 3 == 0 { -5 } else { 7 }).collect();
            let (series, back) = differences(&numbers);
            assert!(numbers.iter().zip(&back).all(|(a, b)| (a - b).abs() <= STEP / 2), "{n}");
            let (mut writer, mut ahead, mut between) = (Writer::new(), Numbers::new(), Numbers::new());
            let interrupt = Interrupt::new();
            series.write(&mut writer, &mut ahead, &mut between, &interrupt).expect("nobody interrupts");
            let bytes = writer.finish();
            let (mut ahead, mut between) = (Numbers::new(), Numbers::new());
            let mut reader = Reader::new(&bytes);
            let read = Series::read(&mut reader, usize::from(n), &mut ahead, &mut between, &interrupt)
                .expect("nobody interrupts");
            assert_eq!(read.restored(), back, "{n}");
            assert_eq!(series.restored(), back, "{n}");
        }
    }
}
