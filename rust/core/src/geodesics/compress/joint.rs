//! Encoding of one joint within its tolerance.

use super::Stored;
use super::bits::{Context, Reader, Writer};
use super::chart::{self, Coordinates, Frame};
use super::fit::{COMPONENTS, Fit};
use super::numbers::Numbers;
use super::series::{self, CHECKED, STEP, Series};
use crate::Error;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::dot;

/// Kind of a joint whose samples are stored unchanged. Kinds 0 … 3 are that many coordinates in steps, kinds 4 … 6
/// floats.
const PLAIN: usize = 7;

/// Fraction of the tolerance that is used: another implementation may round differently when it measures the error.
const SURE: f64 = 1.0 - 1e-9;

/// Factor that shortens a step that was too long,
const SHORTER: f64 = 0.9;

/// and the number of attempts before another coordinate is added.
const ATTEMPTS: usize = 8;

/// Upper limit of the values of a series: predictions are computed in 64 bits.
const LARGEST: f64 = 70_368_744_177_664.0; // 2⁴⁶

/// Upper limit of coordinates, radians: sines of larger ones lose digits.
const FARTHEST: f64 = 1e5;

/// Bits of each number of a frame.
const COARSE: u32 = 16;

/// The same for tolerances below [`FINE_BELOW`].
const FINE: u32 = 32;

/// Tolerance in radians below which the numbers of a frame have more bits: 16 bits have errors of up to 8e-5 rad.
const FINE_BELOW: f64 = 1e-3;

/// Axes of a joint that does not move.
const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Bits of the length of a step: sign, exponent of float64, and eight bits of the significand.
const STEP_BITS: u32 = 20;

/// Adaptive contexts of the coder, shared by all joints.
pub(super) struct Contexts {
    missing: [Context; 2],
    ahead: Numbers,
    between: Numbers,
}

impl Contexts {
    pub(super) fn new() -> Self {
        Self { missing: [Context::NEW; 2], ahead: Numbers::new(), between: Numbers::new() }
    }
}

/// Encoded contents of a joint.
#[derive(Debug, Clone, Default)]
pub(super) struct Joint {
    kind: usize,
    missing: Vec<bool>,
    width: u32,
    frame: [[i64; 3]; 2],
    step: f64,
    coded: Vec<Series>,
    floats: Vec<f64>,
    opposite: bool,
    /// The largest rotation angle between a sample and its decoded value.
    pub(super) error: f64,
}

impl Joint {
    /// The encoding of valid samples whose decoded values are within the tolerance.
    pub(super) fn new<T: Stored>(
        valid: Vec<[f64; 4]>,
        missing: Vec<bool>,
        frames: [[[f64; 4]; 2]; 2],
        (tolerance, quantised): (f64, bool),
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        if !valid.is_empty() {
            let bound =
                (if tolerance < std::f64::consts::PI { tolerance } else { std::f64::consts::PI }) * SURE;
            let width = if tolerance >= FINE_BELOW { COARSE } else { FINE };
            let [geodesics, surface] = frames;
            let geodesics = Fit::new(&valid, geodesics, width);
            interrupt.check()?;
            let surface = Fit::new(&valid, surface, width);
            interrupt.check()?;
            let fit =
                if surface.components(bound) < geodesics.components(bound) { surface } else { geodesics };
            if fit.farthest < FARTHEST {
                for components in fit.components(bound)..=COMPONENTS {
                    let how = (components, quantised);
                    if let Some(joint) = Self::within::<T>(&fit, bound, &valid, &missing, how, interrupt)? {
                        return Ok(joint);
                    }
                }
            }
        }
        Ok(Self { kind: PLAIN, missing, floats: valid.into_flattened(), ..Self::default() })
    }

    /// Tries an encoding with `components` coordinates; `None` if the error exceeds the bound.
    fn within<T: Stored>(
        fit: &Fit,
        bound: f64,
        valid: &[[f64; 4]],
        missing: &[bool],
        (components, quantised): (usize, bool),
        interrupt: &Interrupt,
    ) -> Result<Option<Self>, Error> {
        let stepped = quantised && components > 0;
        let mut step = if stepped { fit.step(components, bound) } else { 0.0 };
        for _ in 0..if stepped { ATTEMPTS } else { 1 } {
            let mut joint =
                Joint { kind: components, width: fit.width, frame: fit.numbers, ..Self::default() };
            let mut s: Coordinates = Default::default();
            for (k, s) in s.iter_mut().enumerate() {
                interrupt.check()?;
                if k >= components {
                    s.resize(valid.len(), 0.0);
                } else if stepped {
                    joint.step = storable(step);
                    let scale = STEP as f64 / joint.step;
                    if fit.farthest * scale >= LARGEST {
                        return Ok(None);
                    }
                    let (series, back) = series::differences(&chart::in_steps(&fit.s[k], scale));
                    joint.coded.push(series);
                    *s = from_steps(&back, joint.step);
                } else {
                    joint.kind = COMPONENTS + components;
                    *s = fit.s[k].iter().map(|&x| T::from_f64(x).to_f64()).collect();
                    joint.floats.extend_from_slice(s);
                }
            }
            let frame = if components == 0 { Frame { axes: IDENTITY, ..fit.frame } } else { fit.frame };
            let result = chart::rotations::<T>(&s, frame);
            joint.error = chart::largest_angle(valid, &result);
            if joint.error <= bound {
                joint.opposite = dot(valid[0], result[0]) < 0.0;
                joint.missing = missing.to_vec();
                return Ok(Some(joint));
            }
            step *= SHORTER;
        }
        Ok(None)
    }

    /// The decoded valid samples, continuous in sign.
    pub(super) fn path<T: Stored>(&self) -> Vec<[f64; 4]> {
        let count = self.count();
        if count == 0 {
            return Vec::new();
        }
        let mut path = if self.kind == PLAIN {
            self.floats.as_chunks::<4>().0.to_vec()
        } else {
            let mut s: Coordinates = std::array::from_fn(|_| vec![0.0; count]);
            for (s, series) in s.iter_mut().zip(&self.coded) {
                *s = from_steps(&series.restored(), self.step);
            }
            for (s, floats) in s.iter_mut().zip(self.floats.chunks_exact(count)) {
                s.copy_from_slice(floats);
            }
            let [centre, axes] = self.frame.map(|numbers| chart::from_rounded(numbers, self.width));
            let axes = if self.kind == 0 { IDENTITY } else { axes };
            chart::rotations::<T>(&s, Frame { centre, axes })
        };
        let mut opposite = self.opposite;
        let mut before = path[0];
        for q in &mut path {
            opposite ^= dot(*q, before) < 0.0;
            before = *q;
            if opposite {
                *q = q.map(|x| -x);
            }
        }
        path
    }

    /// Marks of missing samples.
    pub(super) fn missing(&self) -> &[bool] {
        &self.missing
    }

    fn count(&self) -> usize {
        self.missing.iter().filter(|&&missing| !missing).count()
    }

    /// Encodes the joint.
    pub(super) fn write<T: Stored>(
        &self,
        writer: &mut Writer,
        contexts: &mut Contexts,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        writer.plain(self.kind as u64, 3);
        let some = self.missing.contains(&true);
        writer.plain(u64::from(some), 1);
        if some {
            let mut before = false;
            for &missing in &self.missing {
                writer.bit(missing, &mut contexts.missing[usize::from(before)]);
                before = missing;
            }
        }
        if self.count() == 0 && some {
            return Ok(());
        }
        if self.kind != PLAIN {
            writer.plain(u64::from(self.width == FINE), 1);
            for numbers in &self.frame[..if self.kind == 0 { 1 } else { 2 }] {
                for number in numbers {
                    writer.plain(number.cast_unsigned(), self.width);
                }
            }
            writer.plain(u64::from(self.opposite), 1);
        }
        if !self.coded.is_empty() {
            writer.plain(self.step.to_bits() >> (64 - STEP_BITS), STEP_BITS);
        }
        for series in &self.coded {
            series.write(writer, &mut contexts.ahead, &mut contexts.between, interrupt)?;
        }
        for floats in self.floats.chunks(CHECKED) {
            interrupt.check()?;
            for &float in floats {
                writer.plain(T::from_f64(float).to_plain(), T::BITS);
            }
        }
        Ok(())
    }

    /// Decodes a joint of a clip with `frames` frames.
    pub(super) fn read<T: Stored>(
        reader: &mut Reader<'_>,
        frames: usize,
        contexts: &mut Contexts,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let kind = usize::from(reader.plain(3).to_le_bytes()[0]);
        let mut joint = Self { kind, missing: vec![false; frames], ..Self::default() };
        if reader.plain(1) == 1 {
            let mut before = false;
            for missing in &mut joint.missing {
                before = reader.bit(&mut contexts.missing[usize::from(before)]);
                *missing = before;
            }
        }
        let count = joint.count();
        if count == 0 {
            return Ok(joint);
        }
        let mut floats = 4;
        if kind != PLAIN {
            joint.width = if reader.plain(1) == 1 { FINE } else { COARSE };
            for numbers in &mut joint.frame[..if kind == 0 { 1 } else { 2 }] {
                *numbers = std::array::from_fn(|_| signed(reader.plain(joint.width), joint.width));
            }
            joint.opposite = reader.plain(1) == 1;
            floats = kind.saturating_sub(COMPONENTS);
        }
        if (1..=COMPONENTS).contains(&kind) {
            joint.step = f64::from_bits(reader.plain(STEP_BITS) << (64 - STEP_BITS));
            for _ in 0..kind {
                let series =
                    Series::read(reader, count, &mut contexts.ahead, &mut contexts.between, interrupt)?;
                joint.coded.push(series);
            }
        }
        for first in (0..floats * count).step_by(CHECKED) {
            interrupt.check()?;
            let numbers = first..(first + CHECKED).min(floats * count);
            joint.floats.extend(numbers.map(|_| T::from_plain(reader.plain(T::BITS)).to_f64()));
        }
        Ok(joint)
    }
}

/// Converts values in fractions of a step to coordinates.
fn from_steps(numbers: &[i64], step: f64) -> Vec<f64> {
    let unit = step / STEP as f64;
    numbers.iter().map(|&number| number as f64 * unit).collect()
}

/// The largest storable step that is not longer.
fn storable(step: f64) -> f64 {
    f64::from_bits(step.to_bits() >> (64 - STEP_BITS) << (64 - STEP_BITS))
}

/// The signed number of `width` bits.
fn signed(bits: u64, width: u32) -> i64 {
    (bits << (64 - width)).cast_signed() >> (64 - width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_joint_heeds_an_interruption() {
        let valid: Vec<[f64; 4]> = (0..1000)
            .map(|i| crate::Real::sin_cos(f64::from(i) / 100.0))
            .map(|(s, c)| [c, s, 0.0, 0.0])
            .collect();
        let frames = [[IDENTITY; 2]; 2];
        let (stop, go) = (Interrupt::new(), Interrupt::new());
        stop.set();
        let fit = |interrupt: &Interrupt| {
            Joint::new::<f64>(valid.clone(), vec![false; 1000], frames, (1e-3, true), interrupt)
        };
        assert!(matches!(fit(&stop), Err(Error::Interrupted)));
        let joint = fit(&go).expect("nobody interrupts");
        let mut writer = Writer::new();
        assert!(matches!(
            joint.write::<f64>(&mut writer, &mut Contexts::new(), &stop),
            Err(Error::Interrupted)
        ));
        let (mut writer, mut contexts) = (Writer::new(), Contexts::new());
        joint.write::<f64>(&mut writer, &mut contexts, &go).expect("nobody interrupts");
        let bytes = writer.finish();
        let read = |interrupt: &Interrupt| {
            Joint::read::<f64>(&mut Reader::new(&bytes), 1000, &mut Contexts::new(), interrupt)
        };
        assert!(matches!(read(&stop), Err(Error::Interrupted)));
        assert_eq!(read(&go).expect("nobody interrupts").path::<f64>(), joint.path::<f64>());
    }
}
