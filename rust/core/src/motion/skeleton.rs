//! Forward kinematics.

use crate::clip::Planes;
use crate::error::check_length;
use crate::rotations::quaternion::{product, rotate};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real, parallel};

/// Frames per tile: the rotations and positions of a whole body fit in the second-level cache.
const TILE: usize = 64;

/// Planes of a joint: its global rotation, and its position.
const PLANES: usize = 7;

/// Tiles per task.
const TILES: usize = 8;

/// A tree of joints, parents before their children.
#[derive(Debug, Clone, Copy)]
pub struct Tree<'a, T> {
    /// The parent of each joint, `None` for a root.
    pub parents: &'a [Option<usize>],
    /// The position of each joint relative to its parent, `(joints, 3)`.
    pub offsets: &'a [T],
}

multiversion! {
    /// Positions `(frames, joints, 3)` of up to [`TILE`] frames.
    fn tile<T: Real>(tree: Tree<'_, T>, rotations: &[T], translation: &[T], planes: &mut Planes<T>, out: &mut [T]) {
        let joints = tree.parents.len();
        for (joint, (&parent, offset)) in tree.parents.iter().zip(tree.offsets.chunks_exact(3)).enumerate() {
            let mut local = [[T::ZERO; TILE]; 4];
            for (i, row) in rotations.chunks_exact(joints * 4).enumerate().take(TILE) {
                for c in 0..4 {
                    local[c][i] = row[joint * 4 + c];
                }
            }
            let offset = [offset[0], offset[1], offset[2]];
            if let Some(parent) = parent {
                let mut above = [[T::ZERO; TILE]; PLANES];
                for (copy, plane) in above.iter_mut().zip(planes.rows_from::<PLANES>(parent * PLANES)) {
                    copy.copy_from_slice(&plane[..TILE]);
                }
                let mut here = planes.rows_mut::<PLANES>(joint * PLANES);
                for i in 0..TILE {
                    let turned = std::array::from_fn(|c| above[c][i]);
                    let bone = rotate(turned, offset);
                    let global = product(turned, std::array::from_fn(|c| local[c][i]));
                    for c in 0..4 {
                        above[c][i] = global[c];
                    }
                    for c in 0..3 {
                        above[4 + c][i] += bone[c];
                    }
                }
                for (plane, copy) in here.iter_mut().zip(&above) {
                    plane[..TILE].copy_from_slice(copy);
                }
            } else {
                let mut here = planes.rows_mut::<PLANES>(joint * PLANES);
                for (plane, copy) in here.iter_mut().zip(&local) {
                    plane[..TILE].copy_from_slice(copy);
                }
                for (i, row) in translation.chunks_exact(3).enumerate().take(TILE) {
                    for c in 0..3 {
                        here[4 + c][i] = row[c];
                    }
                }
            }
            let [_, _, _, _, x, y, z] = planes.rows_from::<PLANES>(joint * PLANES);
            for (i, row) in out.chunks_exact_mut(joints * 3).enumerate().take(TILE) {
                row[joint * 3] = x[i];
                row[joint * 3 + 1] = y[i];
                row[joint * 3 + 2] = z[i];
            }
        }
    }
}

/// Positions of the joints of a skeleton, `(frames, joints, 3)`, from rotations relative to the parents.
///
/// From the parent `p` of joint `j`: `g_j = g_p · q_j` and `x_j = x_p + g_p o_j g_p⁻¹`. At a root, `g = q` and `x` is the
/// translation, `(frames, 3)`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] unless parents precede their
/// children.
pub fn forward_kinematics<T: Real>(
    rotations: ClipView<'_, T>,
    translation: &[T],
    tree: Tree<'_, T>,
    out: &mut [T],
) -> Result<(), Error> {
    let (frames, joints) = (rotations.frames(), rotations.joints());
    check_length("translation", frames * 3, translation.len())?;
    check_length("parents", joints, tree.parents.len())?;
    check_length("offsets", joints * 3, tree.offsets.len())?;
    check_length("out", frames * joints * 3, out.len())?;
    check_parents(tree.parents)?;
    if out.is_empty() {
        return Ok(());
    }
    let tasks: Vec<&mut [T]> = out.chunks_mut(TILES * TILE * joints * 3).collect();
    parallel::for_each(tasks, frames * joints * 6, |task, out| {
        let mut planes = Planes::new(joints * PLANES, TILE);
        for (i, out) in out.chunks_mut(TILE * joints * 3).enumerate() {
            let start = (task * TILES + i) * TILE;
            let end = (start + TILE).min(frames);
            let rotations = rotations.slice(start, end).data();
            tile(tree, rotations, &translation[start * 3..end * 3], &mut planes, out);
        }
        Ok(())
    })
}

/// Positions of the joints of a skeleton with moving joint translations, `(frames, joints, 3)`.
///
/// As [`forward_kinematics`], with an offset for each frame: `x_j = x_p + g_p t_j g_p⁻¹`, and `x = t` at a root.
/// There may be several roots.
///
/// # Errors
/// As [`forward_kinematics`].
pub fn forward_kinematics_moving<T: Real>(
    rotations: ClipView<'_, T>,
    joint_translations: &[T],
    parents: &[Option<usize>],
    out: &mut [T],
) -> Result<(), Error> {
    let (frames, joints) = (rotations.frames(), rotations.joints());
    check_length("parents", joints, parents.len())?;
    check_length("joint_translations", frames * joints * 3, joint_translations.len())?;
    check_length("out", frames * joints * 3, out.len())?;
    check_parents(parents)?;
    if out.is_empty() {
        return Ok(());
    }
    let tasks: Vec<&mut [T]> = out.chunks_mut(TILES * TILE * joints * 3).collect();
    parallel::for_each(tasks, frames * joints * 12, |task, out| {
        let mut global = vec![[T::ZERO; 4]; joints];
        for (i, out) in out.chunks_exact_mut(joints * 3).enumerate() {
            let frame = task * TILES * TILE + i;
            let moved = &joint_translations[frame * joints * 3..(frame + 1) * joints * 3];
            for (joint, (&parent, moved)) in parents.iter().zip(moved.chunks_exact(3)).enumerate() {
                let (mut turned, mut place) = (rotations.at(frame, joint), [moved[0], moved[1], moved[2]]);
                if let Some(parent) = parent {
                    place = rotate(global[parent], place);
                    turned = product(global[parent], turned);
                    for (x, &above) in place.iter_mut().zip(&out[parent * 3..parent * 3 + 3]) {
                        *x += above;
                    }
                }
                global[joint] = turned;
                out[joint * 3..joint * 3 + 3].copy_from_slice(&place);
            }
        }
        Ok(())
    })
}

fn check_parents(parents: &[Option<usize>]) -> Result<(), Error> {
    if parents.iter().enumerate().any(|(joint, parent)| parent.is_some_and(|parent| parent >= joint)) {
        return Err(Error::Parameter { name: "parents", expected: "parents that precede their children" });
    }
    Ok(())
}
