//! Samples in stretches of strong noise, drawn towards a first estimate.

use crate::error::check_length;
use crate::rotations::quaternion::{dot, geodesic, negative, unit};
use crate::{ClipMut, ClipView, Error, Real};

/// Writes `s exp(g log(s⁻¹ q))`, rotations that keep the share `g`, `(frames)`, of their displacement from the estimate `s`, each in the
/// hemisphere of its sample.
///
/// # Errors
/// [`Error::Length`] if the sizes differ.
pub fn drawn_towards<T: Real>(
    q: ClipView<'_, T>,
    estimate: ClipView<'_, T>,
    share: &[f64],
    out: ClipMut<'_, T>,
) -> Result<(), Error> {
    check_length("estimate", q.data().len(), estimate.data().len())?;
    check_length("share", q.frames(), share.len())?;
    check_length("out", q.frames() * q.joints(), out.frames() * out.joints())?;
    let row = q.joints() * 4;
    for (frame, (to, &share)) in out.into_data().chunks_exact_mut(row.max(1)).zip(share).enumerate() {
        for (joint, to) in to.chunks_exact_mut(4).enumerate() {
            let [here, near] = [q, estimate].map(|clip| unit(clip.at(frame, joint).map(T::to_f64)));
            let moved = unit(geodesic(near, here, share));
            let signed = if dot(moved, here) < 0.0 { negative(moved) } else { moved };
            for (to, x) in to.iter_mut().zip(signed) {
                *to = T::from_f64(x);
            }
        }
    }
    Ok(())
}
