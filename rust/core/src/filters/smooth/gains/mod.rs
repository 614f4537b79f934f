//! The learned last step: gains of scales, from a network that reads local powers.
//!
//! Blocks of frames are computed one after the other, with as many frames before and after as the masks reach. In each, the columns
//! of all joints come first, then what all joints share, then the gains of each joint.
//!
//! - `vectors`: the columns of a joint, and principal axes;
//! - `scales`: masks of splines;
//! - `basis`: the vectors that gains are given to;
//! - `gates`: the powers that the network reads;
//! - `network`: the network;
//! - `block`: one block of frames.

mod basis;
mod block;
mod gates;
mod network;
mod scales;
mod vectors;

use super::about::{Noisy, TASK};
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::{ClipMut, ClipView, Error, Real};
pub use network::Network;
use network::WIDTH;
use std::sync::Mutex;
use vectors::Axes;

/// Frames that share a gain; between the centres of cells gains are interpolated.
const CELL: usize = 4;

/// Differences of scales of the displacement to the samples, and of the pilot.
const SCALES: usize = 6;

/// Basis vectors of the displacement to the samples; those of the pilot follow, and then those of the estimates.
const OF_REST: usize = SCALES + 1;

/// Scales between which displacements to estimates are divided.
const FINE: usize = 2;
const COARSE: usize = 4;

/// Displacements to estimates: the result of patches, and the samples along the strongest axes of the body.
const ESTIMATES: usize = 2;

/// Vectors that gains are given to.
const BASES: usize = OF_REST + SCALES + 3 * ESTIMATES;

/// Gates of a column that no other column shares.
const OWN_GATES: usize = 3 * BASES + SCALES;

/// What the network reads.
const GATES: usize = OWN_GATES + 2 * BASES;

/// Strongest axes of the body, at most one for each joint.
const AXES: usize = 12;

/// Columns of all joints, at most, whose axes are looked for.
const WIDEST: usize = 512;

/// Frames of a clip, at least; in shorter ones the pilot stays.
const FEWEST: usize = 128;

/// Radians per component below which a joint has no noise: little more than roundings in float32.
const LEAST_NOISE: f64 = 1e-6;

/// Added to powers before their logarithm.
const LEAST_POWER: f32 = 1e-4;

/// Factor of the logarithms.
const LOGARITHM: f32 = 0.4;

/// Added to the power of the pilot where the displacement to the samples is divided by its norm.
const LEAST_NORM: f32 = 1e-6;

/// Frames of a block: with a cell more at both ends, whole blocks of the network.
const BLOCK: usize = (8 * WIDTH - 2) * CELL;

/// Frames before and after a block that its gains depend on: 126 of the basis, 62 cells of the powers, and a cell of the gains.
const REACH: usize = 384;

/// Corrects the pilot by vectors of several scales, with gains from a network; `share` of the correction counts.
///
/// `patches` is the estimate before the pilot, of its shape.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
pub fn smooth_gains<T: Real>(
    noisy: &Noisy<'_, T>,
    patches: ClipView<'_, T>,
    share: f64,
    network: &Network,
    out: ClipMut<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    noisy.check()?;
    let (frames, row) = (noisy.clip.frames(), noisy.clip.joints() * 4);
    check_length("patches", frames * row, patches.data().len())?;
    let out = out.into_data();
    check_length("out", frames * row, out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    let joints = noisy.joints(LEAST_NOISE);
    if frames < FEWEST || joints.is_empty() {
        return noisy.unmoved(out);
    }
    let axes = Axes::find(noisy, &joints, interrupt)?;
    let step =
        block::Step { noisy, patches, joints: &joints, axes: &axes, network, share, kept: Mutex::default() };
    for (number, out) in out.chunks_mut(BLOCK * row).enumerate() {
        interrupt.check()?;
        let start = number * BLOCK;
        let end = (start + BLOCK).min(frames);
        let moves = step.moves(start..end, interrupt)?;
        noisy.each_part(TASK, out, 0, |first, out| {
            noisy.moved(&joints, start + first, |joint, c| &moves[joint].row(c)[first..], out);
            Ok(())
        })?;
    }
    noisy.sign(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attempt(frames: usize, of_patches: usize, units: usize, interrupt: &Interrupt) -> Result<(), Error> {
        let q = [1.0, 0.0, 0.0, 0.0].repeat(frames * 2);
        let patches = [1.0, 0.0, 0.0, 0.0].repeat(of_patches * 2);
        let mut out = vec![0.0; q.len()];
        let clip = ClipView::new(&q, frames, 2)?;
        let noisy = Noisy { clip, pilot: clip, confidence: None, noise: &[0.1, 0.1] };
        let network =
            Network::new(&vec![0.1; (GATES + 1) * 5], &vec![0.1; (units + 1) * units], &[0.1; 6 * BASES])?;
        let patches = ClipView::new(&patches, of_patches, 2)?;
        smooth_gains(&noisy, patches, 1.0, &network, ClipMut::new(&mut out, frames, 2)?, interrupt)
    }

    #[test]
    fn slices_that_do_not_fit_are_refused() {
        let interrupt = Interrupt::new();
        assert_eq!(attempt(200, 200, 5, &interrupt), Ok(()));
        assert_eq!(
            attempt(200, 199, 5, &interrupt),
            Err(Error::Length { name: "patches", expected: 1600, got: 1592 })
        );
        assert_eq!(
            attempt(200, 200, 4, &interrupt),
            Err(Error::Length { name: "second", expected: 30, got: 20 })
        );
    }

    #[test]
    fn an_interrupt_is_an_error() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert_eq!(attempt(200, 200, 5, &interrupt), Err(Error::Interrupted));
    }
}
