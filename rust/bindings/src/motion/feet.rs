//! Feet on the ground.

use crate::array::{by_dtype, clip, elements, input, numbers, output, run_interruptible};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::motion::feet::{self, Body, Displacements, FootPaths, Placed};

/// Ground contacts of feet, and the displacements of the feet.
#[allow(clippy::too_many_arguments, reason = "those of the reference")]
#[pyfunction]
#[pyo3(signature = (before, after, lengths, up, fps, given, lock, /))]
pub(crate) fn foot_displacements(
    py: Python<'_>,
    before: &Bound<'_, PyAny>,
    after: &Bound<'_, PyAny>,
    lengths: &Bound<'_, PyAny>,
    up: i64,
    fps: f64,
    given: Option<&Bound<'_, PyAny>>,
    lock: bool,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let lengths = numbers("lengths", lengths)?;
    let given = given.map(|given| input::<bool>("given", given)).transpose()?;
    let given = given.as_ref().map(|given| elements("given", given)).transpose()?;
    by_dtype!(before, T => {
        let before = input::<T>("before", before)?;
        let after = input::<T>("after", after)?;
        let &[frames, legs, 2, 3] = before.shape() else {
            return Err(PyValueError::new_err("before: expected shape (frames, legs, 2, 3)"));
        };
        let paths = FootPaths {
            before: elements("before", &before)?,
            after: elements("after", &after)?,
            lengths: &lengths,
            up: usize::try_from(up.rem_euclid(3)).unwrap_or(0),
            down: up < 0,
            fps,
            contacts: given,
            lock,
        };
        let displacements = output::<f64>(py, &[frames, legs, 2, 3]);
        let contacts = output::<bool>(py, &[frames, legs, 2]);
        {
            let (mut displacements, mut contacts) = (displacements.readwrite(), contacts.readwrite());
            let out = Displacements {
                displacements: displacements.as_slice_mut()?,
                contacts: contacts.as_slice_mut()?,
            };
            run_interruptible(py, paths.nanoseconds(), |interrupt| {
                feet::foot_displacements(paths, out, interrupt)
            })?;
        }
        Ok((displacements.into_any().unbind(), contacts.into_any().unbind()))
    })
}

/// Moves feet by inverse kinematics of the legs.
#[allow(clippy::too_many_arguments, reason = "those of the reference")]
#[pyfunction]
#[pyo3(signature = (rotations, translation, local, parents, pelvis, legs, lengths, displacements, root, lock, /))]
pub(crate) fn place_feet(
    py: Python<'_>,
    rotations: &Bound<'_, PyAny>,
    translation: &Bound<'_, PyAny>,
    local: &Bound<'_, PyAny>,
    parents: &Bound<'_, PyAny>,
    pelvis: usize,
    legs: &Bound<'_, PyAny>,
    lengths: &Bound<'_, PyAny>,
    displacements: &Bound<'_, PyAny>,
    root: bool,
    lock: bool,
) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
    let parents = input::<i64>("parents", parents)?;
    let parents = elements("parents", &parents)?;
    let parents: Vec<Option<usize>> = parents.iter().map(|&parent| usize::try_from(parent).ok()).collect();
    let legs = input::<i64>("legs", legs)?;
    let joint = |joint: &i64| usize::try_from(*joint).unwrap_or(usize::MAX);
    let legs: Vec<[usize; 4]> =
        elements("legs", &legs)?.as_chunks::<4>().0.iter().map(|leg| leg.each_ref().map(joint)).collect();
    let lengths = numbers("lengths", lengths)?;
    let displacements = input::<f64>("displacements", displacements)?;
    let displacements = elements("displacements", &displacements)?;
    by_dtype!(rotations, T => {
        let rotations = input::<T>("rotations", rotations)?;
        let translation = input::<T>("translation", translation)?;
        let local = input::<T>("local", local)?;
        let rotations = clip("rotations", &rotations)?;
        let body = Body {
            rotations,
            translation: elements("translation", &translation)?,
            local: elements("local", &local)?,
            parents: &parents,
            pelvis,
            legs: &legs,
            lengths: &lengths,
            displacements,
            root,
            lock,
        };
        let turned = output::<T>(py, &[rotations.frames(), rotations.joints(), 4]);
        let moved = output::<T>(py, &[rotations.frames(), 3]);
        {
            let (mut turned, mut moved) = (turned.readwrite(), moved.readwrite());
            let out = Placed { rotations: turned.as_slice_mut()?, translation: moved.as_slice_mut()? };
            run_interruptible(py, body.nanoseconds(), |interrupt| feet::place_feet(body, out, interrupt))?;
        }
        Ok((turned.into_any().unbind(), moved.into_any().unbind()))
    })
}
