//! The estimate of low rank of one window.

use super::products::{padded, product, transposed};
use super::symmetric::eigen;
use super::{LONGEST_PERIOD, VARIANCE};
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::f64::consts::PI;

/// Cosines over windows of one length.
#[derive(Debug)]
pub(super) struct Cosines {
    length: usize,
    /// Orthonormal cosines, a row for each.
    forth: Vec<f64>,
    /// A row for each frame, of `length` numbers.
    back: Vec<f64>,
}

impl Cosines {
    pub(super) fn new(length: usize) -> Self {
        let n = length as f64;
        let circle: Vec<f64> = (0..4 * length).map(|i| Real::sin_cos(PI * i as f64 / (2.0 * n)).1).collect();
        let cosine = |k: usize, t: usize| {
            let scale = if k == 0 { (1.0 / n).sqrt() } else { (2.0 / n).sqrt() };
            scale * circle[k * (2 * t + 1) % (4 * length)]
        };
        let forth: Vec<f64> = (0..length * length).map(|at| cosine(at / length, at % length)).collect();
        let back = transposed(&forth, length, length, length);
        Self { length, forth, back }
    }

    /// What the estimate of low rank takes away from poses, rows of `width` numbers of which the first `columns` count; it
    /// takes their place. Their mean stays.
    pub(super) fn removed(
        &self,
        poses: &mut [f64],
        columns: usize,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let width = padded(columns);
        let mut spectrum = vec![0.0; self.length * width];
        product(&self.forth, self.length, poses, width, &mut spectrum);
        spectrum[..width].fill(0.0);
        for (first, end) in bands(self.length) {
            shrink(&mut spectrum[first * width..end * width], columns, interrupt)?;
        }
        product(&self.back, self.length, &spectrum, width, poses);
        Ok(())
    }
}

/// First cosines of the bands, and the first ones after them. The mean of a window is in none.
fn bands(length: usize) -> Vec<(usize, usize)> {
    let mut edges = vec![1];
    let mut doubled = 2 * length;
    while edges[edges.len() - 1] < length {
        edges.push(length.min(doubled.div_ceil(LONGEST_PERIOD)));
        doubled *= 2;
    }
    edges.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// In the place of a band, rows padded beyond `columns`, what the best estimate of low rank takes away from it.
fn shrink(band: &mut [f64], columns: usize, interrupt: &Interrupt) -> Result<(), Error> {
    let width = padded(columns);
    let rows = band.len() / width;
    let (short, long) = (rows.min(columns), rows.max(columns));
    let by_rows = rows <= columns;
    // Of the shorter side, the products of its rows with each other.
    let across = transposed(band, width, columns, padded(rows));
    let side = padded(short);
    let mut products = vec![0.0; short * side];
    if by_rows {
        product(band, width, &across, side, &mut products);
    } else {
        product(&across, padded(rows), band, side, &mut products);
    }
    let mut square: Vec<f64> = products.chunks_exact(side).flat_map(|row| &row[..short]).copied().collect();
    let (values, vectors) = eigen(&mut square, short, interrupt)?;
    let ratio = short as f64 / long as f64;
    let seen = (1.0 + ratio.sqrt()) * (1.0 + ratio.sqrt());
    let taken = |value: f64| {
        let y2 = value / (VARIANCE * long as f64);
        if y2 > seen {
            let about = y2 - ratio - 1.0;
            1.0 - (about * about - 4.0 * ratio).sqrt() / y2
        } else {
            1.0
        }
    };
    // The sum of the taken shares along the vectors: `Σ_i taken_i v_i v_iᵀ`.
    let mut scaled = vec![0.0; short * side];
    for ((row, vector), &value) in scaled.chunks_exact_mut(side).zip(vectors.chunks_exact(short)).zip(&values)
    {
        let share = taken(value);
        for (x, v) in row.iter_mut().zip(vector) {
            *x = share * v;
        }
    }
    let turned = transposed(&vectors, short, short, short);
    product(&turned, short, &scaled, side, &mut products);
    let before = band.to_vec();
    if by_rows {
        product(&products, side, &before, width, band);
    } else {
        product(&before, width, &products, side, band);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_each_cosine_but_the_mean() {
        assert_eq!(bands(512), [(1, 18), (18, 35), (35, 69), (69, 137), (137, 274), (274, 512)]);
        assert_eq!(bands(128), [(1, 5), (5, 9), (9, 18), (18, 35), (35, 69), (69, 128)]);
    }

    #[test]
    fn matrices_of_one_movement_lose_as_much_as_their_noise_has() {
        for (rows, columns) in [(6, 40), (40, 6), (7, 7)] {
            let width = padded(columns);
            let original: Vec<f64> = (0..rows * width)
                .map(|at| {
                    let (i, j) = (at / width, at % width);
                    if j < columns { 10.0 * ((i % 3) as f64 - 0.7) * ((j % 4) as f64 - 1.2) } else { 0.0 }
                })
                .collect();
            let square: f64 = original.iter().map(|x| x * x).sum();
            let mut band = original.clone();
            shrink(&mut band, columns, &Interrupt::new()).expect("nobody interrupts");
            let y2 = square / (VARIANCE * rows.max(columns) as f64);
            let ratio = rows.min(columns) as f64 / rows.max(columns) as f64;
            let share = 1.0 - ((y2 - ratio - 1.0).powi(2) - 4.0 * ratio).sqrt() / y2;
            assert!(share > 1e-4 && share < 0.1);
            for (x, original) in band.iter().zip(&original) {
                assert!((x - share * original).abs() < 1e-10);
            }
        }
    }
}
