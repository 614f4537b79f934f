//! Acclaim files: skeletons and their motions.

use super::bvh::matrix;
use super::{run, texts};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use quatfilt_formats::acclaim::{self, AngleUnit, Axis, Bone, Dof};

/// Name, parent (−1 for one that begins at the root), direction, length, axis angles, their order, degrees of freedom.
type BoneTuple = (String, i64, (f64, f64, f64), f64, (f64, f64, f64), String, Vec<&'static str>);

fn order(axes: [Axis; 3]) -> String {
    axes.map(|axis| match axis {
        Axis::X => 'X',
        Axis::Y => 'Y',
        Axis::Z => 'Z',
    })
    .iter()
    .collect()
}

fn names(freedoms: &[Dof]) -> Vec<&'static str> {
    freedoms.iter().map(|freedom| freedom.name()).collect()
}

fn unit(angle: AngleUnit) -> &'static str {
    match angle {
        AngleUnit::Degrees => "degrees",
        AngleUnit::Radians => "radians",
    }
}

fn of_bone(bone: &Bone) -> BoneTuple {
    (
        bone.name.clone(),
        bone.parent.and_then(|parent| i64::try_from(parent).ok()).unwrap_or(-1),
        bone.direction.into(),
        bone.length,
        bone.axis.into(),
        order(bone.axis_order),
        names(&bone.dof),
    )
}

/// Reads an ASF skeleton into a dictionary, in the units of the file.
#[pyfunction]
#[pyo3(signature = (data, /))]
pub(crate) fn read_asf<'py>(py: Python<'py>, data: &Bound<'py, PyBytes>) -> PyResult<Bound<'py, PyDict>> {
    let bytes = data.as_bytes();
    let skeleton = run(py, || acclaim::parse_asf(bytes))?;
    let root = &skeleton.root;
    let result = PyDict::new(py);
    result.set_item("name", &skeleton.name)?;
    result.set_item("length", skeleton.units.length)?;
    result.set_item("angle", unit(skeleton.units.angle))?;
    result.set_item("root_order", names(&root.order))?;
    result.set_item("root_position", root.position)?;
    result.set_item("root_orientation", root.orientation)?;
    result.set_item("root_axis_order", order(root.axis_order))?;
    result.set_item("bones", skeleton.bones.iter().map(of_bone).collect::<Vec<_>>())?;
    result.set_item("notes", texts(&skeleton.notes))?;
    Ok(result)
}

/// Values, the unit of their angles, notes.
type Table<'py> = (Bound<'py, PyArray2<f64>>, &'static str, Vec<String>);

/// Reads an AMC motion of the skeleton of an ASF file: values `(frames, columns)`, the unit of their angles, notes.
#[pyfunction]
#[pyo3(signature = (data, skeleton, /))]
pub(crate) fn read_amc<'py>(
    py: Python<'py>,
    data: &Bound<'py, PyBytes>,
    skeleton: &Bound<'py, PyBytes>,
) -> PyResult<Table<'py>> {
    let (data, skeleton) = (data.as_bytes(), skeleton.as_bytes());
    let (motion, columns) = run(py, || {
        let skeleton = acclaim::parse_asf(skeleton)?;
        Ok((acclaim::parse_amc(data, &skeleton)?, skeleton.columns()))
    })?;
    let notes = texts(&motion.notes);
    Ok((matrix(py, motion.frames, columns, motion.values)?, unit(motion.angle), notes))
}
