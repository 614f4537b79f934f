//! Synthetic clips, seeded: joints that swing, with noise.

use quatfilt_core::rotations::quaternion;
use quatfilt_core::{Error, Real};
use quatfilt_formats::bvh::{Channel, EndSite, Joint};

/// Joints of a clip: those of the CMU skeleton.
pub const JOINTS: usize = 31;

/// Deviation of the noise per component of the rotation vector, in radians.
pub const NOISE: f64 = 0.016;

/// Frames per second.
const FPS: f64 = 120.0;

/// Evenly spread numbers.
#[derive(Debug)]
pub struct Uniform(u64);

impl Uniform {
    /// A sequence of its own for each seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    /// The next number in `low..high`.
    pub fn next(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number of a distribution that is nearly normal, of deviation 1.
    fn next_normal(&mut self) -> f64 {
        // The sum of twelve numbers of variance 1/12.
        (0..12).map(|_| self.next(-0.5, 0.5)).sum()
    }
}

/// Rotation vectors `(frames, joints, 3)`: three waves per joint and coordinate, and white noise.
#[must_use]
pub fn rotation_vectors(frames: usize, joints: usize, seed: u64) -> Vec<f64> {
    let mut uniform = Uniform::new(seed);
    let waves: Vec<[f64; 9]> = (0..joints * 3)
        .map(|_| {
            std::array::from_fn(|i| match i % 3 {
                0 => uniform.next(0.05, 0.3),
                1 => uniform.next(0.2, 3.0) * std::f64::consts::TAU / FPS,
                _ => uniform.next(0.0, std::f64::consts::TAU),
            })
        })
        .collect();
    let mut vectors = Vec::with_capacity(frames * joints * 3);
    for frame in 0..frames {
        for wave in &waves {
            let swing: f64 = wave
                .chunks_exact(3)
                .map(|wave| {
                    let phase = (wave[1] * frame as f64 + wave[2]) % std::f64::consts::TAU;
                    wave[0] * Real::sin_cos(phase).0
                })
                .sum();
            vectors.push(swing + NOISE * uniform.next_normal());
        }
    }
    vectors
}

/// Unit quaternions `(frames, joints, 4)` of [`rotation_vectors`].
///
/// # Errors
/// None.
pub fn rotations<T: Real>(frames: usize, joints: usize, seed: u64) -> Result<Vec<T>, Error> {
    let half: Vec<T> =
        rotation_vectors(frames, joints, seed).into_iter().map(|x| T::from_f64(0.5 * x)).collect();
    let mut q = vec![T::ZERO; frames * joints * 4];
    quaternion::exp(&half, &mut q)?;
    Ok(q)
}

/// [`rotations`] of which one sample in a hundred is missing, in runs of one to ten.
///
/// # Errors
/// None.
pub fn gappy<T: Real>(frames: usize, joints: usize, seed: u64) -> Result<Vec<T>, Error> {
    let mut q = rotations::<T>(frames, joints, seed)?;
    for joint in 0..joints {
        let mut frame = 7 * joint;
        while frame < frames {
            let length = 1 + frame % 10;
            for frame in frame..frames.min(frame + length) {
                let at = (frame * joints + joint) * 4;
                q[at..at + 4].fill(T::nan());
            }
            frame += length * 100;
        }
    }
    Ok(q)
}

/// The parent of each joint: limbs of six joints at a root.
#[must_use]
pub fn parents(joints: usize) -> Vec<Option<usize>> {
    (0..joints)
        .map(|joint| joint.checked_sub(1).map(|before| if joint % 6 == 1 { 0 } else { before }))
        .collect()
}

/// The joints of a BVH file: six channels at the root, three at the others.
#[must_use]
pub fn bvh_joints(joints: usize) -> Vec<Joint> {
    let parents = parents(joints);
    let has_child = |joint| parents.contains(&Some(joint));
    let rotations = [Channel::Zrotation, Channel::Yrotation, Channel::Xrotation];
    let positions = [Channel::Xposition, Channel::Yposition, Channel::Zposition];
    (0..joints)
        .map(|joint| Joint {
            name: format!("joint{joint}"),
            parent: parents[joint],
            offset: [0.0, 10.0, 0.0],
            channels: if joint == 0 { [positions, rotations].concat() } else { rotations.to_vec() },
            end_sites: if has_child(joint) { vec![] } else { vec![EndSite::default()] },
        })
        .collect()
}

/// Channel values of [`bvh_joints`], `(frames, 3 + 3 · joints)`: four decimals.
#[must_use]
pub fn bvh_values(frames: usize, joints: usize, seed: u64) -> Vec<f64> {
    let vectors = rotation_vectors(frames, joints + 1, seed);
    vectors.into_iter().map(|x| (x.to_degrees() * 1e4).round() / 1e4).collect()
}
