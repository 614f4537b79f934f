//! Biovision hierarchy files.

use super::{run, texts};
use crate::array::{elements, input};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use quatfilt_formats::Precision;
use quatfilt_formats::bvh::{self, Channel, EndSite, FrameTime, Joint};

type Offset = (f64, f64, f64);

/// Name, parent (−1 for a root), offset, names of the channels, end sites (name or None, offset).
type JointTuple = (String, i64, Offset, Vec<String>, Vec<(Option<String>, Offset)>);

/// A file: joints, (seconds of a frame, their text), values `(frames, channels)`, notes.
type FileTuple<'py> = (Vec<JointTuple>, (f64, String), Bound<'py, PyArray2<f64>>, Vec<String>);

fn of_array(offset: [f64; 3]) -> Offset {
    (offset[0], offset[1], offset[2])
}

fn of_joint(joint: Joint) -> JointTuple {
    (
        joint.name,
        joint.parent.and_then(|parent| i64::try_from(parent).ok()).unwrap_or(-1),
        of_array(joint.offset),
        joint.channels.iter().map(|channel| channel.name().to_owned()).collect(),
        joint.end_sites.into_iter().map(|site| (site.name, of_array(site.offset))).collect(),
    )
}

fn to_joint((name, parent, offset, channels, end_sites): JointTuple) -> PyResult<Joint> {
    let channel = |channel: &String| {
        Channel::from_name(channel)
            .ok_or_else(|| PyValueError::new_err(format!("joints: unknown channel {channel:?}")))
    };
    Ok(Joint {
        parent: usize::try_from(parent).ok(),
        offset: offset.into(),
        channels: channels.iter().map(channel).collect::<PyResult<_>>()?,
        end_sites: end_sites
            .into_iter()
            .map(|(name, offset)| EndSite { name, offset: offset.into() })
            .collect(),
        name,
    })
}

/// Reads a BVH file. Angles are in degrees.
#[pyfunction]
#[pyo3(signature = (data, /))]
pub(crate) fn read_bvh<'py>(py: Python<'py>, data: &Bound<'py, PyBytes>) -> PyResult<FileTuple<'py>> {
    let bytes = data.as_bytes();
    let file = run(py, || bvh::parse(bytes))?;
    let channels = file.joints.iter().map(|joint| joint.channels.len()).sum();
    let notes = texts(&file.notes);
    let joints = file.joints.into_iter().map(of_joint).collect();
    Ok((
        joints,
        (file.frame_time.seconds, file.frame_time.text),
        matrix(py, file.frames, channels, file.values)?,
        notes,
    ))
}

/// The text of a BVH file; numbers have the fewest digits that read back unchanged.
#[pyfunction]
#[pyo3(signature = (joints, frame_time, values, /))]
pub(crate) fn write_bvh<'py>(
    py: Python<'py>,
    joints: Vec<JointTuple>,
    frame_time: (f64, String),
    values: &Bound<'_, PyAny>,
) -> PyResult<Bound<'py, PyBytes>> {
    let joints: Vec<Joint> = joints.into_iter().map(to_joint).collect::<PyResult<_>>()?;
    let frame_time = FrameTime { seconds: frame_time.0, text: frame_time.1 };
    let values = input::<f64>("values", values)?;
    let values = elements("values", &values)?;
    let text = run(py, || bvh::write(&joints, &frame_time, values, Precision::Shortest))?;
    Ok(PyBytes::new(py, &text))
}

/// Passes a table to NumPy without a copy.
pub(super) fn matrix(
    py: Python<'_>,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let table = Array2::from_shape_vec((rows, columns), values)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(table.into_pyarray(py))
}
