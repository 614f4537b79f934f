//! Straight motion.

use super::place::Place;

/// The straight line of least squares through places in time, as seen from the first of them.
pub(super) struct Line<P> {
    from: P,
    /// At the frame that times are counted from.
    value: [f64; 3],
    /// Per frame.
    slope: [f64; 3],
}

impl<P: Place> Line<P> {
    /// The line through `path` at `frames`, of which there is at least one; times are counted from `origin`.
    pub(super) fn through(path: &[P], frames: &[usize], origin: usize) -> Self {
        let from = path[frames[0]];
        let count = frames.len() as f64;
        let time = |frame: usize| frame as f64 - origin as f64;
        let mean = frames.iter().map(|&frame| time(frame)).sum::<f64>() / count;
        let (mut value, mut slope, mut spread) = ([0.0; 3], [0.0; 3], 0.0);
        for &frame in frames {
            let vector = from.step(path[frame]);
            let off = time(frame) - mean;
            spread += off * off;
            for c in 0..3 {
                value[c] += vector[c] / count;
                slope[c] += off * vector[c];
            }
        }
        let slope = slope.map(|x| x / spread.max(1.0));
        Self { from, value: std::array::from_fn(|c| value[c] - mean * slope[c]), slope }
    }

    pub(super) fn at(&self, steps: f64) -> P {
        self.from.moved(std::array::from_fn(|c| self.value[c] + steps * self.slope[c]))
    }
}
