//! The vectorised loops of the bounds.

use crate::Real;
use crate::simd::multiversion;

/// Columns of a panel: one vector of float32 at the widest level.
pub(super) const LANES: usize = 16;

/// Rows of a tile of inner products, whose sums stay in registers.
pub(super) const TALL: usize = 4;

/// Terms of an inner product that are summed before they are added to the running sum.
const GROUP: usize = super::axes::GROUP;

multiversion! {
    /// `out = factor · x − offset`.
    pub(super) fn scaled<T: Real>(out: &mut [T], x: &[T], factor: T, offset: T) {
        let n = out.len();
        let x = &x[..n];
        for i in 0..n {
            out[i] = factor * x[i] - offset;
        }
    }
}

multiversion! {
    /// `out = factor · x · y − offset`.
    pub(super) fn scaled_products<T: Real>(out: &mut [T], x: &[T], y: &[T], factor: T, offset: T) {
        let n = out.len();
        let (x, y) = (&x[..n], &y[..n]);
        for i in 0..n {
            out[i] = factor * (x[i] * y[i]) - offset;
        }
    }
}

multiversion! {
    /// `out += a² + b² + c² + d²`.
    pub(super) fn add_squares<T: Real>(out: &mut [T], group: [&[T]; GROUP]) {
        let n = out.len();
        let [a, b, c, d] = group.map(|plane| &plane[..n]);
        for i in 0..n {
            out[i] += (a[i] * a[i] + b[i] * b[i]) + (c[i] * c[i] + d[i] * d[i]);
        }
    }
}

multiversion! {
    /// `out += x·a + y·b + z·c + w·d`.
    pub(super) fn add_combination<T: Real>(out: &mut [T], group: [&[T]; GROUP], by: [T; GROUP]) {
        let n = out.len();
        let [a, b, c, d] = group.map(|plane| &plane[..n]);
        for i in 0..n {
            out[i] += (by[0] * a[i] + by[1] * b[i]) + (by[2] * c[i] + by[3] * d[i]);
        }
    }
}

/// Adds the inner product of one group of a row with the same group of a panel.
#[inline(always)]
fn add_group<T: Real, const SIGNED: bool>(
    sums: [T; LANES],
    x: [T; GROUP],
    y: &[[T; LANES]; GROUP],
) -> [T; LANES] {
    let mut grown = [T::ZERO; LANES];
    for lane in 0..LANES {
        let product = (x[0] * y[0][lane] + x[1] * y[1][lane]) + (x[2] * y[2][lane] + x[3] * y[3][lane]);
        grown[lane] = sums[lane] + if SIGNED { product } else { product.abs() };
    }
    grown
}

multiversion! {
    /// Inner products of rows with the columns of panels; one row of `out` per row. Groups from `signed` on add the
    /// magnitude of their product. The number of rows is a multiple of [`TALL`].
    pub(super) fn products<T: Real>(out: &mut [T], rows: &[T], panels: &[T], dims: usize, signed: usize) {
        let width = panels.len() / dims;
        for (panel, numbers) in panels.chunks_exact(dims * LANES).enumerate() {
            let groups = numbers.as_chunks::<LANES>().0.as_chunks::<GROUP>().0;
            for (tile, four) in rows.chunks_exact(TALL * dims).enumerate() {
                let [a, b, c, d] = [0, 1, 2, 3].map(|row| {
                    &four[row * dims..(row + 1) * dims].as_chunks::<GROUP>().0[..groups.len()]
                });
                let mut sums = [[T::ZERO; LANES]; TALL];
                let mut i = 0;
                while i < signed {
                    let y = &groups[i];
                    sums = [
                        add_group::<T, true>(sums[0], a[i], y),
                        add_group::<T, true>(sums[1], b[i], y),
                        add_group::<T, true>(sums[2], c[i], y),
                        add_group::<T, true>(sums[3], d[i], y),
                    ];
                    i += 1;
                }
                while i < groups.len() {
                    let y = &groups[i];
                    sums = [
                        add_group::<T, false>(sums[0], a[i], y),
                        add_group::<T, false>(sums[1], b[i], y),
                        add_group::<T, false>(sums[2], c[i], y),
                        add_group::<T, false>(sums[3], d[i], y),
                    ];
                    i += 1;
                }
                for (row, sums) in sums.iter().enumerate() {
                    let at = (tile * TALL + row) * width + panel * LANES;
                    out[at..at + LANES].copy_from_slice(sums);
                }
            }
        }
    }
}

/// Bound data of one frame, or of a block of consecutive frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<T> {
    /// Half the sum of its squared coordinates.
    pub(super) half: T,
    /// Distance of its farthest neighbour found so far.
    pub(super) limit: T,
    /// Largest distance between this row and the patches that it represents.
    pub(super) radius: T,
}

/// Bound data of candidates: the fields of [`Row`], one array each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns<'a, T> {
    pub(super) halves: &'a [T],
    pub(super) limits: &'a [T],
    pub(super) radii: &'a [T],
}

/// Non-negative if the pair with this inner product may be within the limit of either of its two patches.
#[inline(always)]
fn nearness<T: Real>(product: T, row: Row<T>, half: T, limit: T, radius: T) -> T {
    // |a − b|² / 2 = half_a + half_b − a·b, compared with reach² / 2.
    let reach = row.limit.max(limit) + (row.radius + radius);
    (product + T::HALF * reach * reach) - (row.half + half)
}

multiversion! {
    /// Marks each row that has at least one pair with non-negative `nearness`.
    pub(super) fn mark_rows<T: Real>(marks: &mut [u8], products: &[T], rows: &[Row<T>], columns: Columns<'_, T>) {
        let width = columns.halves.len();
        let halves = columns.halves.as_chunks::<LANES>().0;
        let limits = &columns.limits.as_chunks::<LANES>().0[..halves.len()];
        let radii = &columns.radii.as_chunks::<LANES>().0[..halves.len()];
        for ((mark, products), row) in marks.iter_mut().zip(products.chunks_exact(width)).zip(rows) {
            let products = &products.as_chunks::<LANES>().0[..halves.len()];
            let mut most = [T::ZERO - T::ONE; LANES];
            for i in 0..halves.len() {
                for lane in 0..LANES {
                    let near =
                        nearness(products[i][lane], *row, halves[i][lane], limits[i][lane], radii[i][lane]);
                    most[lane] = most[lane].max(near);
                }
            }
            let mut near = 0;
            for most in most {
                near |= u8::from(most >= T::ZERO);
            }
            *mark = near;
        }
    }
}

multiversion! {
    /// Marks each panel that has at least one pair with non-negative `nearness`.
    pub(super) fn mark_panels<T: Real>(marks: &mut [u8], products: &[T], rows: &[Row<T>], columns: Columns<'_, T>) {
        let width = columns.halves.len();
        let halves = columns.halves.as_chunks::<LANES>().0;
        let limits = &columns.limits.as_chunks::<LANES>().0[..halves.len()];
        let radii = &columns.radii.as_chunks::<LANES>().0[..halves.len()];
        for (i, mark) in marks.iter_mut().enumerate().take(halves.len()) {
            let mut most = [T::ZERO - T::ONE; LANES];
            for (products, row) in products.chunks_exact(width).zip(rows) {
                let products = &products.as_chunks::<LANES>().0[i];
                for lane in 0..LANES {
                    let near =
                        nearness(products[lane], *row, halves[i][lane], limits[i][lane], radii[i][lane]);
                    most[lane] = most[lane].max(near);
                }
            }
            let mut near = 0;
            for most in most {
                near |= u8::from(most >= T::ZERO);
            }
            *mark = near;
        }
    }
}

multiversion! {
    /// Marks the pairs of one row with non-negative `nearness`; returns whether there is one.
    pub(super) fn mark_products<T: Real>(marks: &mut [u8], products: &[T], row: Row<T>, columns: Columns<'_, T>) -> bool {
        let n = marks.len();
        let (products, halves) = (&products[..n], &columns.halves[..n]);
        let (limits, radii) = (&columns.limits[..n], &columns.radii[..n]);
        let mut any = 0;
        for i in 0..n {
            let near = u8::from(nearness(products[i], row, halves[i], limits[i], radii[i]) >= T::ZERO);
            marks[i] = near;
            any |= near;
        }
        any != 0
    }
}

multiversion! {
    /// Inner products of each of two rows with each of two other rows.
    pub(super) fn four_products<T: Real>(rows: [&[T]; 2], others: [&[T]; 2]) -> [[T; 2]; 2] {
        let [a, b] = rows.map(|row| row.as_chunks::<LANES>().0);
        let [c, d] = others.map(|row| row.as_chunks::<LANES>().0);
        let n = a.len();
        let (b, c, d) = (&b[..n], &c[..n], &d[..n]);
        let mut sums = [[T::ZERO; LANES]; 4];
        for i in 0..n {
            for lane in 0..LANES {
                sums[0][lane] += a[i][lane] * c[i][lane];
                sums[1][lane] += a[i][lane] * d[i][lane];
                sums[2][lane] += b[i][lane] * c[i][lane];
                sums[3][lane] += b[i][lane] * d[i][lane];
            }
        }
        let mut totals = [T::ZERO; 4];
        for (total, sums) in totals.iter_mut().zip(sums) {
            let mut half = [T::ZERO; LANES / 2];
            for lane in 0..LANES / 2 {
                half[lane] = sums[lane] + sums[lane + LANES / 2];
            }
            let [a, b, c, d, e, f, g, h] = half;
            *total = ((a + e) + (b + f)) + ((c + g) + (d + h));
        }
        [[totals[0], totals[1]], [totals[2], totals[3]]]
    }
}
