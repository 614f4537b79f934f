//! Segmentation into behaviours: a cut is where the error of a few principal geodesics begins to grow faster.
//!
//! J. Barbič et al. 2004, PCA-SEG, on rotations. A segment is described by principal geodesics fitted to all of its
//! frames so far. While the behaviour lasts, the sum of the squared errors grows at a steady rate; a new behaviour
//! makes it grow faster. The geodesics are those of the squared sine. With the moments `M = Σ q qᵀ` of a joint, the
//! nearest great sphere of `k` dimensions is spanned by the eigenvectors of the `k + 1` largest eigenvalues, and the
//! other eigenvalues sum to `Σ sin² d`.

use crate::geodesics::eigen;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{is_missing, unit};
use crate::{ClipView, Error, Real};

/// Root mean square of the error below which its growth is invisible (sine of half a rotation angle; 0.1°).
const STILL: f64 = 1e-3;

/// Frames whose errors are computed together.
const BLOCK: usize = 512;

/// Estimated nanoseconds for the eigenvalues of one joint and frame.
const NANOSECONDS: usize = 800;

/// Parameters of the segmentation.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    /// Geodesics per joint: 1 or 2.
    pub components: usize,
    /// Frames at the beginning of a segment in which no cut is searched.
    pub window: usize,
    /// Minimum length of a segment in frames.
    pub min_length: usize,
    /// Frames over which the growth of the error is measured; at least 1.
    pub lag: usize,
    /// Number of standard deviations by which the growth must exceed its mean.
    pub threshold: f64,
}

/// Cuts, and the criterion behind them.
#[derive(Debug, Clone)]
pub struct Segments {
    /// First frames of new behaviours, in ascending order.
    pub cuts: Vec<usize>,
    /// Growth of the error per frame; NaN at the beginning of segments.
    pub growth: Vec<f64>,
    /// Threshold of the growth; NaN where it was not tested.
    pub limit: Vec<f64>,
}

type Moments = [[f64; 4]; 4];

impl Segment {
    /// Cuts of a clip.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `components` is not 1 or 2 or `lag` is 0; [`Error::Interrupted`].
    pub fn segment<T: Real>(&self, clip: ClipView<'_, T>, interrupt: &Interrupt) -> Result<Segments, Error> {
        if !(1..=2).contains(&self.components) {
            return Err(Error::Parameter { name: "components", expected: "1 or 2" });
        }
        if self.lag == 0 {
            return Err(Error::Parameter { name: "lag", expected: "at least 1" });
        }
        let frames = clip.frames();
        let mut found =
            Segments { cuts: Vec::new(), growth: vec![f64::NAN; frames], limit: vec![f64::NAN; frames] };
        let mut start = 0;
        while let Some(cut) = self.next(clip, start, &mut found, interrupt)? {
            found.cuts.push(cut);
            start = cut;
        }
        Ok(found)
    }

    /// The first cut after `start`.
    fn next<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        start: usize,
        found: &mut Segments,
        interrupt: &Interrupt,
    ) -> Result<Option<usize>, Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        let floor = STILL * STILL * self.lag as f64 * joints as f64;
        let first = self.window.max(self.min_length).max(self.lag + 1);
        let mut moments = vec![[[0.0; 4]; 4]; joints];
        let mut errors: Vec<f64> = Vec::new();
        let (mut total, mut squares) = (0.0, 0.0);
        for i in 0..frames - start {
            if i == errors.len() {
                let end = (start + i + BLOCK).min(frames);
                let block = clip.slice(start + i, end);
                errors.extend(self.errors(block, &mut moments, interrupt)?);
            }
            if i < self.lag {
                continue;
            }
            let growth = errors[i] - errors[i - self.lag];
            let count = (i - self.lag) as f64;
            found.growth[start + i] = growth;
            if i >= first && start + i + self.min_length <= frames {
                let mean = total / count;
                let deviation = (squares / count - mean * mean).max(0.0).sqrt();
                let limit = mean + self.threshold * deviation + floor;
                found.limit[start + i] = limit;
                if growth > limit {
                    return Ok(Some(start + i));
                }
            }
            total += growth;
            squares += growth * growth;
        }
        Ok(None)
    }

    /// Sums of the squared errors after each frame of a block; `moments` are updated from the frames before to the
    /// end of the block.
    fn errors<T: Real>(
        &self,
        block: ClipView<'_, T>,
        moments: &mut [Moments],
        interrupt: &Interrupt,
    ) -> Result<Vec<f64>, Error> {
        let (frames, joints) = (block.frames(), block.joints());
        let items: Vec<(usize, &mut Moments)> = moments.iter_mut().enumerate().collect();
        let parts = parallel::map(items, frames * joints * NANOSECONDS, |_, (joint, moments)| {
            interrupt.check()?;
            let one = |frame: usize| {
                let q = block.at(frame, joint);
                if !is_missing(q) {
                    let q = unit(q.map(T::to_f64));
                    for (row, a) in moments.iter_mut().zip(q) {
                        for (sum, b) in row.iter_mut().zip(q) {
                            *sum += a * b;
                        }
                    }
                }
                eigen::values(*moments)[..3 - self.components].iter().sum::<f64>()
            };
            Ok((0..frames).map(one).collect::<Vec<f64>>())
        })?;
        Ok((0..frames).map(|frame| parts.iter().map(|part| part[frame]).sum()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotations::quaternion::exp_one;

    #[test]
    fn another_axis_is_another_behaviour() {
        let path: Vec<f64> = (0..600_u32)
            .flat_map(|i| {
                let s = Real::sin_cos(f64::from(i) * 0.1).0;
                exp_one(if i < 300 { [s, 0.0, 0.0] } else { [0.0, s, 0.2 * s] })
            })
            .collect();
        let clip = ClipView::new(&path, 600, 1).expect("the length fits");
        let segment = Segment { components: 1, window: 100, min_length: 50, lag: 25, threshold: 3.0 };
        let cuts = segment.segment(clip, &Interrupt::new()).expect("nobody interrupts").cuts;
        assert_eq!(cuts.len(), 1);
        assert!((300..310).contains(&cuts[0]), "{cuts:?}");
    }
}
