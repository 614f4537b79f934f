//! What noise leaves of a mean of rotations, and which noise leaves so much.

use crate::Real;

/// Radians per component, √3: the noise that leaves least of a mean. More noise cannot be told from it.
const MOST_NOISE: f64 = 1.732_050_807_568_877_2;

/// How often the interval of the noise is halved: to the last digit.
const HALVINGS: usize = 60;

/// The length of the mean rotation of noise, `|E R| / √3`: 1 without noise.
///
/// For rotation vectors `v` with the deviation `σ` per component, `E R = f I` with `f = (1 + 2 E cos|v|) / 3` and
/// `E cos|v| = (1 − σ²) exp(−σ²/2)`. Noise beyond half a turn comes out as a smaller turn the other way; the formula knows that.
#[must_use]
pub fn coherence(noise: f64) -> f64 {
    let least = noise.min(MOST_NOISE);
    let square = least * least;
    (1.0 + 2.0 * (1.0 - square) * Real::exp(-square / 2.0)) / 3.0
}

/// The noise of a coherence: 0 for what is above 1 and the most that can be told for what no noise leaves.
pub(super) fn noise_of(length: f64) -> f64 {
    if length >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST_NOISE);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if coherence(middle) > length {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_comes_back_from_what_it_leaves() {
        for noise in [1e-3, 0.1, 0.5, 1.0, 1.5, 1.7] {
            assert!((noise_of(coherence(noise)) - noise).abs() < 1e-6 * noise, "{noise}");
        }
        assert!(noise_of(1.0) <= 0.0 && noise_of(2.0) <= 0.0);
        assert!((noise_of(0.0) - MOST_NOISE).abs() < 1e-12);
    }
}
