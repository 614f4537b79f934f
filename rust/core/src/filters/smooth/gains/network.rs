//! The network that maps powers to gains, for planes of cells.

use super::{BASES, GATES, OWN_GATES};
use crate::clip::Planes;
use crate::error::check_length;
use crate::simd::multiversion;
use crate::{Error, Real};

/// Cells of a block: its hidden units stay in the first-level cache.
pub(super) const WIDTH: usize = 64;

/// Numbers of a row whose sums stay in registers.
const LANE: usize = 16;

/// Rows whose sums stay in registers together; layers are padded with zeros to a multiple.
const ROWS: usize = 4;

/// Arguments of the exponential are cut off here: float32 holds no larger results.
const LARGEST: f32 = 80.0;

/// Two hidden layers of equal size, the second with a shortcut, and a linear one.
#[derive(Debug, Clone)]
pub struct Network {
    /// Hidden units of a layer, padded.
    units: usize,
    /// The first layer, divided by what its inputs are shared by.
    own: Layer,
    joint: Layer,
    body: Layer,
    second: Layer,
    last: Layer,
}

/// Weights of a layer, a row for each unit.
#[derive(Debug, Clone)]
struct Layer {
    inputs: usize,
    weights: Vec<f32>,
    bias: Vec<f32>,
}

impl Layer {
    /// Takes the inputs `first..first + inputs` from rows of `units` numbers, one row for each input, and a bias.
    fn new(
        rows: &[f32],
        (first, inputs): (usize, usize),
        padded_inputs: usize,
        units: usize,
        bias: &[f32],
    ) -> Self {
        let padded = units.next_multiple_of(ROWS);
        let mut weights = vec![0.0; padded * padded_inputs];
        for (input, row) in rows.chunks_exact(units).skip(first).take(inputs).enumerate() {
            for (unit, &weight) in row.iter().enumerate() {
                weights[unit * padded_inputs + input] = weight;
            }
        }
        let mut bias = bias.to_vec();
        bias.resize(padded, 0.0);
        Self { inputs: padded_inputs, weights, bias }
    }

    /// Adds the products with planes of inputs, from the number `first` on, to rows of `WIDTH` numbers.
    fn add(&self, inputs: &Planes<f32>, (row, first): (usize, usize), out: &mut [f32]) {
        let stride = inputs.stride();
        add_products(&self.weights, self.inputs, &inputs.from_row(row)[first..], stride, out);
    }

    /// The same for rows of `WIDTH` numbers.
    fn add_rows(&self, inputs: &[f32], out: &mut [f32]) {
        add_products(&self.weights, self.inputs, inputs, WIDTH, out);
    }

    /// Writes the bias into rows of `WIDTH` numbers.
    fn start(&self, out: &mut [f32]) {
        for (row, &bias) in out.chunks_exact_mut(WIDTH).zip(&self.bias) {
            row.fill(bias);
        }
    }
}

/// What is computed on the way to the gains.
#[derive(Debug, Default)]
pub(super) struct Hidden {
    shared: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
    gains: Vec<f32>,
}

impl Network {
    /// From the weights of three layers, the bias after each: `(131 + 1, units)`, `(units + 1, units)` and `(units + 1, 25)`.
    ///
    /// # Errors
    /// [`Error::Length`] if they do not fit together.
    pub fn new(first: &[f32], second: &[f32], last: &[f32]) -> Result<Self, Error> {
        let units = first.len() / (GATES + 1);
        check_length("first", (GATES + 1) * units.max(1), first.len())?;
        check_length("second", (units + 1) * units, second.len())?;
        check_length("last", (units + 1) * BASES, last.len())?;
        let padded = units.next_multiple_of(ROWS);
        let part = |from, inputs| Layer::new(first, (from, inputs), inputs, units, &[]);
        Ok(Self {
            units: padded,
            own: part(0, OWN_GATES),
            joint: part(OWN_GATES, BASES),
            body: Layer::new(first, (OWN_GATES + BASES, BASES), BASES, units, &first[GATES * units..]),
            second: Layer::new(second, (0, units), padded, units, &second[units * units..]),
            last: Layer::new(last, (0, units), padded, BASES, &last[units * BASES..]),
        })
    }

    /// What the gates of the body put into the first layer: rows of `WIDTH` cells for each block of cells.
    pub(super) fn body(&self, gates: &Planes<f32>, first: usize, blocks: usize) -> Vec<f32> {
        let mut result = vec![0.0; self.units * WIDTH * blocks];
        for (block, out) in result.chunks_exact_mut(self.units * WIDTH).enumerate() {
            self.body.start(out);
            self.body.add(gates, (0, first + block * WIDTH), out);
        }
        result
    }

    /// Writes the gains of the cells `first..first + WIDTH` of all axes of a joint: rows of `WIDTH` cells for each vector of each axis.
    pub(super) fn gains<'a>(
        &self,
        of_body: &[f32],
        (own, joint): (&Planes<f32>, &Planes<f32>),
        first: usize,
        hidden: &'a mut Hidden,
    ) -> &'a [f32] {
        let size = self.units * WIDTH;
        let rows = BASES.next_multiple_of(ROWS) * WIDTH;
        let Hidden { shared, first: one, second: two, gains } = hidden;
        for buffer in [&mut *shared, &mut *one, &mut *two] {
            buffer.resize(size, 0.0);
        }
        gains.resize(3 * rows, 0.0);
        shared.copy_from_slice(of_body);
        self.joint.add(joint, (0, first), shared);
        for (axis, gains) in gains.chunks_exact_mut(rows).enumerate() {
            one.copy_from_slice(shared);
            self.own.add(own, (axis * OWN_GATES, first), one);
            silu(one);
            self.second.start(two);
            self.second.add_rows(one, two);
            add_silu(two, one);
            self.last.start(gains);
            self.last.add_rows(one, gains);
        }
        gains
    }

    /// Numbers from the gains of one axis to those of the next.
    pub(super) const fn rows() -> usize {
        BASES.next_multiple_of(ROWS) * WIDTH
    }
}

multiversion! {
    /// Adds to rows of `WIDTH` numbers the products of weights with rows that are `stride` apart.
    fn add_products(weights: &[f32], inputs: usize, right: &[f32], stride: usize, out: &mut [f32]) {
        for (group, out) in out.chunks_exact_mut(ROWS * WIDTH).enumerate() {
            let weights: [&[f32]; ROWS] =
                std::array::from_fn(|i| &weights[(group * ROWS + i) * inputs..][..inputs]);
            for lane in (0..WIDTH).step_by(LANE) {
                let mut sums = [[0.0_f32; LANE]; ROWS];
                for (i, sums) in sums.iter_mut().enumerate() {
                    sums.copy_from_slice(&out[i * WIDTH + lane..][..LANE]);
                }
                for input in 0..inputs {
                    let right = &right[input * stride + lane..][..LANE];
                    for i in 0..ROWS {
                        let weight = weights[i][input];
                        for j in 0..LANE {
                            sums[i][j] += weight * right[j];
                        }
                    }
                }
                for (i, sums) in sums.iter().enumerate() {
                    out[i * WIDTH + lane..][..LANE].copy_from_slice(sums);
                }
            }
        }
    }
}

/// `x / (1 + exp(−x))`.
#[inline(always)]
fn silu_one(x: f32) -> f32 {
    x / (1.0 + Real::exp(-Real::max(x, -LARGEST)))
}

multiversion! {
    fn silu(values: &mut [f32]) {
        for value in values {
            *value = silu_one(*value);
        }
    }
}

multiversion! {
    fn add_silu(values: &[f32], out: &mut [f32]) {
        for (out, value) in out.iter_mut().zip(values) {
            *out += silu_one(*value);
        }
    }
}
