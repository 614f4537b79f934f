//! Forward kinematics.

use crate::array::{by_dtype, clip, elements, input, output, run};
use numpy::PyArrayMethods;
use pyo3::prelude::*;
use quatfilt_core::motion::skeleton::{self, Tree};

/// Positions of the joints, `(frames, joints, 4)`, `(frames, 3)`, `(joints)`, `(joints, 3)` → `(frames, joints, 3)`.
#[pyfunction]
#[pyo3(signature = (rotations, translation, parents, offsets, /))]
pub(crate) fn forward_kinematics(
    py: Python<'_>,
    rotations: &Bound<'_, PyAny>,
    translation: &Bound<'_, PyAny>,
    parents: &Bound<'_, PyAny>,
    offsets: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let parents = input::<i64>("parents", parents)?;
    let parents = elements("parents", &parents)?;
    let parents: Vec<Option<usize>> = parents.iter().map(|&parent| usize::try_from(parent).ok()).collect();
    by_dtype!(rotations, T => {
        let rotations = input::<T>("rotations", rotations)?;
        let translation = input::<T>("translation", translation)?;
        let offsets = input::<T>("offsets", offsets)?;
        let rotations = clip("rotations", &rotations)?;
        let translation = elements("translation", &translation)?;
        let tree = Tree { parents: &parents, offsets: elements("offsets", &offsets)? };
        let out = output::<T>(py, &[rotations.frames(), rotations.joints(), 3]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || skeleton::forward_kinematics(rotations, translation, tree, out))?;
        }
        Ok(out.into_any().unbind())
    })
}

/// Positions of joints with moving joint translations, `(frames, joints, 4)`, `(frames, joints, 3)`, `(joints)` →
/// `(frames, joints, 3)`.
#[pyfunction]
#[pyo3(signature = (rotations, joint_translations, parents, /))]
pub(crate) fn forward_kinematics_moving(
    py: Python<'_>,
    rotations: &Bound<'_, PyAny>,
    joint_translations: &Bound<'_, PyAny>,
    parents: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let parents = input::<i64>("parents", parents)?;
    let parents = elements("parents", &parents)?;
    let parents: Vec<Option<usize>> = parents.iter().map(|&parent| usize::try_from(parent).ok()).collect();
    by_dtype!(rotations, T => {
        let rotations = input::<T>("rotations", rotations)?;
        let moved = input::<T>("joint_translations", joint_translations)?;
        let rotations = clip("rotations", &rotations)?;
        let moved = elements("joint_translations", &moved)?;
        let out = output::<T>(py, &[rotations.frames(), rotations.joints(), 3]);
        {
            let mut out = out.readwrite();
            let out = out.as_slice_mut()?;
            run(py, || skeleton::forward_kinematics_moving(rotations, moved, &parents, out))?;
        }
        Ok(out.into_any().unbind())
    })
}
