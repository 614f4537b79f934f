"""The filters as transformers of scikit-learn.

One class for each filter, with the filter's options by name: `NonlocalPoseMeans`, `Bilateral`, `Smooth` and so on. They
take clips ``(frames, joints, 4)`` or ``(frames, 4)``, where scikit-learn's own take tables: a filter learns nothing in `fit`,
and what follows it in a pipeline has to take such clips too, as `quatfilt.PrincipalGeodesicAnalysis` does.

Examples
--------
>>> import numpy as np, quatfilt as qf
>>> from quatfilt.sklearn import Bilateral, Despike
>>> from sklearn.pipeline import make_pipeline
>>> t = np.arange(240) / 120
>>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
>>> noisy = qf.add_gaussian_noise(swing, sigma=0.03, rng=0)
>>> clean = make_pipeline(Despike(), Bilateral(iterations=5)).fit_transform(noisy)
>>> error = lambda q: float(qf.geodesic_distance(swing, q).mean())
>>> error(clean) < 0.5 * error(noisy)
True
"""

import functools
import inspect
from typing import Any, ClassVar, Self

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._extras import extra
from quatfilt._typing import Array
from quatfilt.methods import FILTERS, REQUIRED, Method

_base = extra("sklearn.base", "scikit-learn", "sklearn", "transformers")


class Filter(_base.TransformerMixin, _base.BaseEstimator):  # type: ignore[misc, name-defined]
    """What the filters have in common.

    Parameters
    ----------
    **options
        Those of the filter, checked when it runs.

    Raises
    ------
    ValueError, TypeError
        If the filter has no such option, or one without a default is lacking.

    Examples
    --------
    >>> from quatfilt.sklearn import Gaussian
    >>> Gaussian(sigma=2.0).set_params(fps=120).get_params()["fps"]
    120
    """

    method: ClassVar[Method]

    def fit(self, _X: ArrayLike, _y: Any = None) -> Self:
        """Return the filter as it is: there is nothing to learn."""
        return self

    def transform(self, X: ArrayLike) -> Array:
        """Filter a clip.

        Parameters
        ----------
        X : array_like, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions along time. NaN or four zeros are missing samples.

        Returns
        -------
        ndarray
            What the filter makes of it.
        """
        result: Array = self.method.filter(X, **self.get_params(deep=False))
        return result

    def __sklearn_tags__(self) -> Any:
        """Tell scikit-learn that clips are not tables, may have gaps, and that `fit` is not needed."""
        tags = super().__sklearn_tags__()
        tags.requires_fit = False
        tags.no_validation = True
        tags.input_tags.three_d_array = True
        tags.input_tags.allow_nan = True
        return tags


def _transformer(name: str, filter_name: str) -> type[Filter]:
    """Make the class of a filter, whose signature scikit-learn reads the options from."""
    method = FILTERS[filter_name]
    _, *parameters = inspect.signature(method.filter).parameters.values()
    options = [one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in parameters]
    own = inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)
    signature = inspect.Signature([own, *options])

    @functools.wraps(Filter.__init__)
    def __init__(self: Filter, **chosen: Any) -> None:  # noqa: N807 - a method
        for option in chosen:
            _validation.known(option, name, method.defaults, f"options among {', '.join(method.defaults)}")
        for option, default in method.defaults.items():
            value = chosen.get(option, default)
            if value is REQUIRED:
                raise TypeError(f"{name} needs a value of {option}: pass {option}=…")
            setattr(self, option, value)

    vars(__init__)["__signature__"] = signature
    summary = inspect.getdoc(method.filter) or ""
    doc = f"""{summary.splitlines()[0]}

    The transformer of `quatfilt.{filter_name}`, whose options it has.
    """
    members = {"__init__": __init__, "__doc__": doc, "__module__": __name__, "method": method}
    return type(name, (Filter,), members)


Bilateral = _transformer("Bilateral", "bilateral")
Butterworth = _transformer("Butterworth", "butterworth")
Despike = _transformer("Despike", "despike")
Gaussian = _transformer("Gaussian", "gaussian")
Kalman = _transformer("Kalman", "kalman")
NonlocalPoseMeans = _transformer("NonlocalPoseMeans", "nonlocal_pose_means")
OneEuro = _transformer("OneEuro", "one_euro")
OrientationFilter = _transformer("OrientationFilter", "orientation_filter")
Savgol = _transformer("Savgol", "savgol")
Smooth = _transformer("Smooth", "smooth")
Wavelet = _transformer("Wavelet", "wavelet")
WeightedMovingMean = _transformer("WeightedMovingMean", "weighted_moving_mean")

__all__ = [
    "Bilateral",
    "Butterworth",
    "Despike",
    "Filter",
    "Gaussian",
    "Kalman",
    "NonlocalPoseMeans",
    "OneEuro",
    "OrientationFilter",
    "Savgol",
    "Smooth",
    "Wavelet",
    "WeightedMovingMean",
]
