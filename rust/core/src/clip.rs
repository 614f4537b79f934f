//! Clips in the kernels: borrowed `(frames, joints, 4)` arrays as input and output, aligned planes inside.

use crate::{Error, Real, error::check_length};

/// A borrowed clip of quaternions, `(frames, joints, 4)` in C order, scalar first.
#[derive(Debug, Clone, Copy)]
pub struct ClipView<'a, T> {
    data: &'a [T],
    frames: usize,
    joints: usize,
}

impl<'a, T: Real> ClipView<'a, T> {
    /// Views `data` as `frames × joints` quaternions.
    ///
    /// # Errors
    /// [`Error::Length`] if `data` has another length.
    pub fn new(data: &'a [T], frames: usize, joints: usize) -> Result<Self, Error> {
        check_length("rotations", frames * joints * 4, data.len())?;
        Ok(Self { data, frames, joints })
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// All components, `(frames, joints, 4)` in C order.
    #[must_use]
    pub fn data(&self) -> &'a [T] {
        self.data
    }

    /// The frames `start..end`.
    #[must_use]
    pub fn slice(&self, start: usize, end: usize) -> Self {
        let row = self.joints * 4;
        Self { data: &self.data[start * row..end * row], frames: end - start, joints: self.joints }
    }

    /// One quaternion.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, frame: usize, joint: usize) -> [T; 4] {
        let i = (frame * self.joints + joint) * 4;
        [self.data[i], self.data[i + 1], self.data[i + 2], self.data[i + 3]]
    }
}

/// A borrowed clip of quaternions to be written, `(frames, joints, 4)` in C order, scalar first.
#[derive(Debug)]
pub struct ClipMut<'a, T> {
    data: &'a mut [T],
    frames: usize,
    joints: usize,
}

impl<'a, T: Real> ClipMut<'a, T> {
    /// Views `data` as `frames × joints` quaternions.
    ///
    /// # Errors
    /// [`Error::Length`] if `data` has another length.
    pub fn new(data: &'a mut [T], frames: usize, joints: usize) -> Result<Self, Error> {
        check_length("out", frames * joints * 4, data.len())?;
        Ok(Self { data, frames, joints })
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// All components, `(frames, joints, 4)` in C order.
    #[must_use]
    pub fn into_data(self) -> &'a mut [T] {
        self.data
    }
}

/// Alignment of every plane in bytes: a cache line, and the widest vector.
const ALIGNMENT: usize = 64;

/// Rows of equal length, each aligned to a cache line: the layout of every hot loop.
#[derive(Debug, Default)]
pub struct Planes<T> {
    buffer: Vec<T>,
    start: usize,
    stride: usize,
    length: usize,
    rows: usize,
}

impl<T: Real> Planes<T> {
    /// `rows` planes of `length` zeros.
    #[must_use]
    pub fn new(rows: usize, length: usize) -> Self {
        let mut planes = Self::default();
        planes.reshape(rows, length);
        planes
    }

    /// Resizes to `rows` planes of `length`, and reuses the memory if it suffices; the contents are then unspecified.
    pub fn reshape(&mut self, rows: usize, length: usize) {
        let line = ALIGNMENT / size_of::<T>();
        self.stride = length.next_multiple_of(line);
        self.length = length;
        self.rows = rows;
        let needed = rows * self.stride + line;
        if self.buffer.len() < needed {
            self.buffer = vec![T::ZERO; needed];
            self.start = self.buffer.as_ptr().align_offset(ALIGNMENT).min(line);
        }
    }

    /// Number of samples per plane.
    #[must_use]
    pub fn length(&self) -> usize {
        self.length
    }

    /// Number of planes.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// One plane.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, row: usize) -> &[T] {
        let at = self.start + row * self.stride;
        &self.buffer[at..at + self.length]
    }

    /// One plane, to be written.
    #[inline(always)]
    pub fn row_mut(&mut self, row: usize) -> &mut [T] {
        let at = self.start + row * self.stride;
        &mut self.buffer[at..at + self.length]
    }

    /// Distance between the first elements of two successive planes.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// All planes from `row` on, with the padding between them.
    #[must_use]
    pub fn from_row(&self, row: usize) -> &[T] {
        &self.buffer[self.start + row * self.stride..]
    }

    /// `N` consecutive planes from `row` on, to be written together.
    ///
    /// Planes past the last are empty.
    #[inline(always)]
    pub fn rows_mut<const N: usize>(&mut self, row: usize) -> [&mut [T]; N] {
        let at = self.start + row * self.stride;
        let (length, stride) = (self.length, self.stride);
        let mut rest = &mut self.buffer[at..];
        std::array::from_fn(|_| {
            let (plane, tail) = std::mem::take(&mut rest).split_at_mut(stride);
            rest = tail;
            &mut plane[..length]
        })
    }

    /// `N` consecutive planes from `row` on.
    #[inline(always)]
    #[must_use]
    pub fn rows_from<const N: usize>(&self, row: usize) -> [&[T]; N] {
        std::array::from_fn(|i| self.row(row + i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_aligned_and_apart() {
        let mut planes = Planes::<f32>::new(5, 33);
        for row in 0..5 {
            assert_eq!(planes.row(row).as_ptr().align_offset(64), 0);
            planes.row_mut(row).fill(row as f32);
        }
        let [a, b] = planes.rows_mut::<2>(3);
        assert!(a.iter().all(|&x| x == 3.0) && b.iter().all(|&x| x == 4.0));
        assert_eq!((a.len(), b.len()), (33, 33));
    }

    #[test]
    fn a_clip_of_another_length_is_refused() {
        let error = ClipView::new(&[0.0_f64; 9], 1, 2).expect_err("nine numbers are not two quaternions");
        assert_eq!(error.to_string(), "rotations: expected 8 elements, got 9");
    }
}
