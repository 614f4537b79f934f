//! Exact repeats: samples that a recorder wrote again because it had no new one.

use crate::error::check_length;
use crate::{ClipView, Error, Real};

/// Marks the samples that equal the latest sample of their joint before them, in every component, in `out`, `(frames, joints)`.
///
/// `q` and `−q` count as equal. Missing samples are no repeats, and a sample after a gap is compared with the one before the gap.
///
/// # Errors
/// [`Error::Length`] if `out` has another length than there are samples.
pub fn find_repeats<T: Real>(q: ClipView<'_, T>, out: &mut [bool]) -> Result<(), Error> {
    let joints = q.joints();
    check_length("out", q.frames() * joints, out.len())?;
    // Zeros stand for a joint without a sample so far: no sample equals them.
    let mut latest = vec![[T::ZERO; 4]; joints];
    for (frame, row) in out.chunks_mut(joints.max(1)).enumerate() {
        for (joint, (repeats, before)) in row.iter_mut().zip(&mut latest).enumerate() {
            let here = q.at(frame, joint);
            let known = here.iter().all(|x| x.is_finite()) && here.iter().any(|&x| x != T::ZERO);
            let opposite = before.map(|x| -x);
            *repeats = known && (here == *before || here == opposite);
            if known {
                *before = here;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_have_one_sign_or_the_other_and_reach_across_gaps() {
        let (a, b, gone) = ([0.6, 0.8, 0.0, 0.0], [0.8, 0.6, 0.0, 0.0], [f64::NAN; 4]);
        let samples = [gone, a, a.map(|x| -x), gone, a, b, [0.0; 4], a];
        let q = samples.concat();
        let mut found = [true; 8];
        find_repeats(ClipView::new(&q, 8, 1).expect("eight samples"), &mut found).expect("eight marks");
        assert_eq!(found, [false, false, true, false, true, false, false, false]);
    }
}
