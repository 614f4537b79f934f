//! Prediction of the next pose by a local model.

use crate::array::{by_dtype, elements, input, output, run_interruptible};
use crate::filters::names::named;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatfilt_core::reconstruction::local_models::{
    self as core, Deviation, Model, Neighbors, Options, Target,
};

/// Chart, mean, deviation and axes.
type Arrays = (Py<PyAny>, Py<PyAny>, Py<PyAny>, Py<PyAny>);

/// Chart, mean, deviation and axes, `(joints, 4)`, `(D)`, `(D)` and `(D, rank)`, from `(K, m + 1, joints, 4)`, `(K, R)`,
/// `(K, S)`, `(m, joints, 4)` and `(joints)`.
#[pyfunction]
#[pyo3(signature = (segments, root_steps, signals, recent, joint_weights, model, target, deviation, bandwidth, ridge, share, /))]
#[allow(clippy::too_many_arguments, reason = "those of the reference")]
pub(crate) fn predict_pose(
    py: Python<'_>,
    segments: &Bound<'_, PyAny>,
    root_steps: &Bound<'_, PyAny>,
    signals: &Bound<'_, PyAny>,
    recent: &Bound<'_, PyAny>,
    joint_weights: &Bound<'_, PyAny>,
    model: &str,
    target: &str,
    deviation: &str,
    bandwidth: f64,
    ridge: f64,
    share: f64,
) -> PyResult<Arrays> {
    let options = options(model, target, deviation, bandwidth, ridge, share)?;
    let joint_weights = input::<f64>("joint_weights", joint_weights)?;
    let joint_weights = elements("joint_weights", &joint_weights)?;
    let predicted = by_dtype!(segments, T => {
        let segments = input::<T>("segments", segments)?;
        let root_steps = input::<T>("root_steps", root_steps)?;
        let recent = input::<T>("recent", recent)?;
        let differences = input::<T>("signals", signals)?;
        let (&[count, frames, joints, 4], &[_, roots], &[_, signals]) =
            (segments.shape(), root_steps.shape(), differences.shape())
        else {
            return Err(PyValueError::new_err(
                "segments: expected shape (K, m + 1, joints, 4), root_steps: (K, R), signals: (K, S)",
            ));
        };
        let neighbors = Neighbors {
            segments: elements("segments", &segments)?,
            root_steps: elements("root_steps", &root_steps)?,
            differences: elements("signals", &differences)?,
            count,
            frames,
            joints,
            roots,
            signals,
        };
        let recent = elements("recent", &recent)?;
        let work = (count.saturating_mul(count)).saturating_mul(count + frames * joints * 3);
        run_interruptible(py, work, |interrupt| {
            core::predict_pose(&neighbors, recent, joint_weights, &options, interrupt)
        })?
    });
    let rows = predicted.mean.len();
    Ok((
        array(py, &[predicted.chart.len(), 4], predicted.chart.as_flattened())?,
        array(py, &[rows], &predicted.mean)?,
        array(py, &[rows], &predicted.deviation)?,
        array(py, &[rows, predicted.rank], &predicted.axes)?,
    ))
}

/// A fresh array with these elements.
fn array(py: Python<'_>, shape: &[usize], elements: &[f64]) -> PyResult<Py<PyAny>> {
    let out = output::<f64>(py, shape);
    out.readwrite().as_slice_mut()?.copy_from_slice(elements);
    Ok(out.into_any().unbind())
}

/// The parameters of a model, with options by name.
pub(super) fn options(
    model: &str,
    target: &str,
    deviation: &str,
    bandwidth: f64,
    ridge: f64,
    share: f64,
) -> PyResult<Options> {
    Ok(Options {
        model: named(
            "model",
            model,
            &[
                ("local_regression", Model::LocalRegression),
                ("partial_least_squares", Model::PartialLeastSquares),
                ("local_pcr", Model::LocalPcr),
                ("local_pca", Model::LocalPca),
                ("nearest", Model::Nearest),
                ("mean_pose", Model::MeanPose),
            ],
        )?,
        target: named("target", target, &[("pose", Target::Pose), ("change", Target::Change)])?,
        deviation: named(
            "deviation",
            deviation,
            &[("predictive", Deviation::Predictive), ("leave_one_out", Deviation::LeaveOneOut)],
        )?,
        bandwidth,
        ridge,
        share,
    })
}
