//! Sums of what overlapping pieces of a clip say about its frames, pass by pass, and the result of their means.

use super::about::{Noisy, TASK};
use crate::parallel;
use crate::{Error, Real};

/// Of one joint: sums of three coordinates and of the weights.
pub(super) type Joint = [Vec<f64>; 4];

/// Sums from one frame on; frames before it are settled.
#[derive(Debug)]
pub(super) struct Sums {
    first: usize,
    joints: Vec<Joint>,
}

impl Sums {
    pub(super) fn new(joints: usize) -> Self {
        Self { first: 0, joints: vec![Joint::default(); joints] }
    }

    /// Lets `work` add to the sums of each joint, which are there from the frame that it is told up to `end`.
    pub(super) fn add(
        &mut self,
        end: usize,
        nanoseconds: usize,
        work: impl Fn(usize, usize, &mut Joint) + Sync + Send,
    ) -> Result<(), Error> {
        let first = self.first;
        parallel::for_each(self.joints.iter_mut().collect(), nanoseconds, |joint, sums: &mut Joint| {
            for plane in &mut *sums {
                plane.resize(end - first, 0.0);
            }
            work(joint, first, sums);
            Ok(())
        })
    }

    /// Moves the pilot by a share of the means, up to the frame `end`; nothing is added to these frames any more.
    pub(super) fn settle<T: Real>(
        &mut self,
        noisy: &Noisy<'_, T>,
        joints: &[usize],
        end: usize,
        share: f64,
        out: &mut [T],
    ) -> Result<(), Error> {
        let (first, row) = (self.first, noisy.clip.joints() * 4);
        let frames = end - first;
        parallel::for_each(
            self.joints.iter_mut().collect(),
            frames * joints.len() * 4,
            |_, sums: &mut Joint| {
                let [x, y, z, weights] = sums;
                for plane in [x, y, z] {
                    for (sum, weight) in plane[..frames].iter_mut().zip(&*weights) {
                        *sum *= share / weight;
                    }
                }
                Ok(())
            },
        )?;
        noisy.each_part(TASK, &mut out[first * row..end * row], 0, |part, out| {
            noisy.moved(joints, first + part, |joint, c| &self.joints[joint][c][part..], out);
            Ok(())
        })?;
        for plane in self.joints.iter_mut().flatten() {
            plane.drain(..frames);
        }
        self.first = end;
        Ok(())
    }
}
