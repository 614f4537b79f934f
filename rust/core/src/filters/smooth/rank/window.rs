//! The estimate of low rank of one window.

use super::super::products::{add_products, padded, product, transposed};
use super::super::spectrum::{BATCH, Transform};
use super::super::symmetric::leading;
use super::{LONGEST_PERIOD, VARIANCE};
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::f64::consts::PI;

/// Orthonormal cosine transforms of windows of one length.
#[derive(Debug)]
pub(super) enum Cosines {
    /// Of a power of two.
    Fast(Transform),
    /// Of any other length: by products with all cosines. Only clips shorter than a window have such a length.
    Any {
        /// A row for each cosine.
        forth: Vec<f64>,
        /// A row for each frame.
        back: Vec<f64>,
    },
}

impl Cosines {
    pub(super) fn new(length: usize) -> Self {
        if length.is_power_of_two() {
            return Self::Fast(Transform::new(length));
        }
        let n = length as f64;
        let circle: Vec<f64> = (0..4 * length).map(|i| Real::sin_cos(PI * i as f64 / (2.0 * n)).1).collect();
        let cosine = |k: usize, t: usize| {
            let scale = if k == 0 { (1.0 / n).sqrt() } else { (2.0 / n).sqrt() };
            scale * circle[k * (2 * t + 1) % (4 * length)]
        };
        let forth: Vec<f64> = (0..length * length).map(|at| cosine(at / length, at % length)).collect();
        let back = transposed(&forth, length, length, length);
        Self::Any { forth, back }
    }

    /// What the estimate of low rank takes away from poses, rows of `padded(columns)` numbers; it takes their place. Their mean
    /// stays.
    pub(super) fn removed(
        &self,
        poses: &mut [f64],
        columns: usize,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let width = padded(columns);
        match self {
            Self::Fast(transform) => {
                let mut transform = transform.clone();
                for first in (0..width).step_by(BATCH) {
                    transform.forth(poses, width, first);
                }
                shrink_bands(poses, columns, interrupt)?;
                for first in (0..width).step_by(BATCH) {
                    transform.back(poses, width, first);
                }
            }
            Self::Any { forth, back } => {
                let length = poses.len() / width;
                let mut spectrum = vec![0.0; poses.len()];
                product(forth, length, poses, width, &mut spectrum);
                shrink_bands(&mut spectrum, columns, interrupt)?;
                product(back, length, &spectrum, width, poses);
            }
        }
        Ok(())
    }
}

/// In the place of a spectrum, what is taken away from it.
fn shrink_bands(spectrum: &mut [f64], columns: usize, interrupt: &Interrupt) -> Result<(), Error> {
    let width = padded(columns);
    spectrum[..width].fill(0.0);
    for (first, end) in bands(spectrum.len() / width) {
        shrink(&mut spectrum[first * width..end * width], columns, interrupt)?;
    }
    Ok(())
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
    let side = padded(short);
    let mut products = vec![0.0; side * side];
    if by_rows {
        add_products(&transposed(band, width, columns, side), side, &mut products, side);
    } else {
        add_products(band, width, &mut products, width);
    }
    let mut square: Vec<f64> = (0..short * short)
        .map(|at| {
            let (i, j) = (at / short, at % short);
            products[i.min(j) * side + i.max(j)]
        })
        .collect();
    let ratio = short as f64 / long as f64;
    let unit = VARIANCE * long as f64;
    let seen = (1.0 + ratio.sqrt()) * (1.0 + ratio.sqrt());
    let (values, vectors) = leading(&mut square, short, seen * unit, interrupt)?;
    let count = values.len();
    if count == 0 {
        return Ok(());
    }
    // What is kept along the vectors is not taken away; all else is.
    let kept = |value: f64| {
        let y2 = value / unit;
        let about = y2 - ratio - 1.0;
        (about * about - 4.0 * ratio).max(0.0).sqrt() / y2
    };
    let stride = if by_rows { short } else { width };
    let mut scaled = vec![0.0; count * stride];
    for ((row, vector), &value) in
        scaled.chunks_exact_mut(stride).zip(vectors.chunks_exact(short)).zip(&values)
    {
        let share = kept(value);
        for (x, v) in row.iter_mut().zip(vector) {
            *x = share * v;
        }
    }
    let mut stays = vec![0.0; band.len()];
    if by_rows {
        let mut along = vec![0.0; count * width];
        product(&vectors, short, band, width, &mut along);
        product(&transposed(&scaled, short, short, count), count, &along, width, &mut stays);
    } else {
        let across = padded(count);
        let mut along = vec![0.0; rows * across];
        product(band, width, &transposed(&vectors, short, short, across), across, &mut along);
        product(&along, across, &scaled, width, &mut stays);
    }
    for (x, stays) in band.iter_mut().zip(&stays) {
        *x -= stays;
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
