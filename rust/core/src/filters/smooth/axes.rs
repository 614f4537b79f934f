//! Principal axes of a motion.

use crate::Error;
use crate::eigen::eigenvectors;
use crate::parallel::Interrupt;

/// Directions of the principal axes of the steps of three planes from frame to frame.
pub(super) fn of_steps(path: [&[f64]; 3], interrupt: &Interrupt) -> Result<[[f64; 3]; 3], Error> {
    let mut products = [0.0; 9];
    for t in 1..path[0].len() {
        let step = path.map(|plane| plane[t] - plane[t - 1]);
        for i in 0..3 {
            for j in 0..3 {
                products[i * 3 + j] += step[i] * step[j];
            }
        }
    }
    let axes = eigenvectors(&mut products, 3, interrupt)?;
    Ok(std::array::from_fn(|axis| std::array::from_fn(|i| axes[i * 3 + axis])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_motion_along_one_direction_it_is_one_of_the_axes() {
        let path = [2.0, -1.0, 2.0].map(|x| (0..30).map(|t| x * f64::from(t * t % 11)).collect::<Vec<f64>>());
        let axes =
            of_steps(path.each_ref().map(|plane| &plane[..]), &Interrupt::new()).expect("nobody interrupts");
        let along = axes.map(|axis| (axis[0] * 2.0 - axis[1] + axis[2] * 2.0) / 3.0);
        assert_eq!(along.iter().filter(|x| (x.abs() - 1.0).abs() < 1e-14).count(), 1);
        assert_eq!(along.iter().filter(|x| x.abs() < 1e-14).count(), 2);
    }
}
