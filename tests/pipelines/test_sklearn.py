"""Filters as transformers of scikit-learn."""

import inspect
import pickle
import sys

import clips
import numpy as np
import pytest
import quatfilt as qf
import quatfilt.sklearn as transformers
from quatfilt.methods import FILTERS
from sklearn.base import BaseEstimator, TransformerMixin, clone
from sklearn.model_selection import ParameterGrid
from sklearn.pipeline import make_pipeline

REQUIRED = {
    "butterworth": {"cutoff": 0.1},
    "gaussian": {"sigma": 2.0},
    "orientation_filter": {"mask": [1, 2, 1]},
    "savgol": {"window_length": 7},
}

CLASSES = {
    name: getattr(transformers, "".join(word.capitalize() for word in name.split("_"))) for name in FILTERS
}


@pytest.fixture
def q():
    rng = np.random.default_rng(0)
    return clips.noisy(rng, clips.smooth(rng, 60, 2), 0.03)


def test_there_is_one_for_each_filter():
    public = {getattr(transformers, name) for name in transformers.__all__}
    assert public == {transformers.Filter, *CLASSES.values()}


@pytest.mark.parametrize("name", FILTERS)
def test_it_does_what_the_filter_does(name, q):
    options = REQUIRED.get(name, {})
    expected = FILTERS[name].filter(q, **options)
    transformer = CLASSES[name](**options)
    for one in (transformer, clone(transformer), pickle.loads(pickle.dumps(transformer))):  # noqa: S301
        np.testing.assert_array_equal(one.transform(q), expected)
        np.testing.assert_array_equal(one.fit_transform(q), expected)


@pytest.mark.parametrize("name", FILTERS)
def test_options_are_those_of_the_filter(name):
    transformer = CLASSES[name](**REQUIRED.get(name, {}))
    assert isinstance(transformer, (BaseEstimator, TransformerMixin))
    assert set(transformer.get_params()) == set(FILTERS[name].defaults)
    assert set(inspect.signature(CLASSES[name]).parameters) == set(FILTERS[name].defaults)
    assert transformer.set_params(gaps="keep").get_params()["gaps"] == "keep"


def test_a_pipeline_reaches_the_options_of_its_steps(q):
    pipeline = make_pipeline(transformers.Despike(), transformers.Gaussian(sigma=1.0))
    for settings in ParameterGrid({"gaussian__sigma": [1.0, 3.0]}):
        result = pipeline.set_params(**settings).fit_transform(q)
        expected = qf.gaussian(qf.despike(q), sigma=settings["gaussian__sigma"])
        np.testing.assert_array_equal(result, expected)


def test_a_clip_with_gaps_goes_through(q):
    q[20:23, 1] = np.nan
    assert np.isfinite(make_pipeline(transformers.Smooth()).fit_transform(q)).all()


def test_wrong_options():
    with pytest.raises(TypeError, match=r"^Gaussian needs a value of sigma: pass sigma=…$"):
        transformers.Gaussian()
    with pytest.raises(ValueError, match=r"^Despike: expected options among radius, .*, got 'width'$"):
        transformers.Despike(width=3)


def test_without_scikit_learn_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.base", None)
    monkeypatch.delitem(sys.modules, "quatfilt.sklearn")
    with pytest.raises(ImportError, match=r"pip install 'quatfilt\[sklearn\]'"):
        __import__("quatfilt.sklearn")
