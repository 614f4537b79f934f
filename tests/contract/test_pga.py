"""What principal geodesic analysis refuses, and in which words."""

import re
import subprocess
import sys

import numpy as np
import pytest
import quatfilt as qf

PGA = qf.PrincipalGeodesicAnalysis


def clip(frames=20, joints=3):
    return qf.exp(0.2 * np.random.default_rng(0).standard_normal((frames, joints, 3)))


def about_z(*degrees):
    return qf.exp(np.radians(degrees)[:, None] / 2 * [0.0, 0.0, 1.0])


WRONG = {
    "n_components": [
        (0, ValueError, "n_components: expected an integer of at least 1, got 0"),
        (2.0, TypeError, "n_components: expected an integer of at least 1, got float"),
        (True, TypeError, "n_components: expected an integer of at least 1, got bool"),
    ],
    "objective": [
        ("mean", ValueError, "objective: expected one of 'geodesic', 'squared', 'chordal', got 'mean'"),
        (None, ValueError, "objective: expected one of 'geodesic', 'squared', 'chordal', got None"),
    ],
    "tol": [
        (-1e-9, ValueError, "tol: expected a number of at least 0, got -1e-09"),
        (np.nan, ValueError, "tol: expected a number of at least 0, got nan"),
        ("1", TypeError, "tol: expected a number of at least 0, got str"),
    ],
}


@pytest.mark.parametrize(("name", "case"), [(name, case) for name, cases in WRONG.items() for case in cases])
def test_parameters(name, case):
    value, kind, message = case
    with pytest.raises(kind, match=f"^{re.escape(message)}$"):
        PGA(**{name: value}).fit(clip())


MESSAGES = {
    "rotations: expected shape (frames, joints, 4) or (frames, 4), got (4,)": lambda: PGA().fit(np.ones(4)),
    "rotations: expected unit quaternions, got norm 2 at frame 0, joint 0": lambda: PGA().fit(
        np.array([[2.0, 0, 0, 0]])
    ),
    "rotations: expected at least one sample, got none": lambda: PGA().fit(clip()[:0]),
    "rotations: samples must be less than π − 0.001 rad from their mean, but reach 3.1409 rad (180.0°) at joint 0; leave out this joint": (
        lambda: PGA().fit(about_z(*[0.0] * 10_000, 179.98))
    ),
    "rotations: the mean is not unique, samples reach 2.0944 rad (120.0°) at joint 0; leave out this joint": (
        lambda: PGA().fit(np.eye(4))
    ),
    "rotations: expected shape (frames, 3, 4) as in fit, got (20, 4)": (
        lambda: PGA(1).fit(clip()).transform(clip()[:, 0])
    ),
    "rotations: expected shape (frames, 4) as in fit, got (20, 3, 4)": (
        lambda: PGA(1).fit(clip()[:, 0]).reconstruction_error(clip())
    ),
    "scores: expected shape (frames, 3, at most 2) as in fit, got (20, 3, 3)": (
        lambda: PGA(2).fit(clip()).inverse_transform(np.zeros((20, 3, 3)))
    ),
    "scores: expected shape (frames, at most 2) as in fit, got (20, 3, 2)": (
        lambda: PGA(2).fit(clip()[:, 0]).inverse_transform(np.zeros((20, 3, 2)))
    ),
    "scores: expected angles of at most 100000 rad, got 1e+06": (
        lambda: PGA(2).fit(clip()).inverse_transform(np.full((20, 3, 2), 1e6))
    ),
    "scores: expected shape (frames, at most 2) as in fit, got (20, 3, 3)": (
        lambda: PGA(2, body=True).fit(clip()).inverse_transform(np.zeros((20, 3, 3)))
    ),
    "scores: expected shape (frames, at most 2) as in fit, got (20, 3)": (
        lambda: PGA(2, body=True).fit(clip()[:, 0]).inverse_transform(np.zeros((20, 3)))
    ),
    "k: expected an integer of at least 0 and at most 2, got 3": (
        lambda: PGA(2).fit(clip()).reconstruction_error(clip(), 3)
    ),
    "PrincipalGeodesicAnalysis: expected a call of fit before, got none": lambda: PGA().transform(clip()),
    "set_params: expected names among n_components, objective, body, tol, scalar_first, got 'k'": (
        lambda: PGA().set_params(k=3)
    ),
}


@pytest.mark.parametrize("message", MESSAGES)
def test_messages(message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        MESSAGES[message]()


def test_parameters_are_kept_as_they_came():
    pga = PGA(2, tol=1)
    assert pga.get_params() == {
        "n_components": 2,
        "objective": "geodesic",
        "body": False,
        "tol": 1,
        "scalar_first": True,
    }
    assert pga.set_params(n_components=None) is pga
    assert repr(pga) == (
        "PrincipalGeodesicAnalysis(n_components=None, objective='geodesic', body=False, tol=1, scalar_first=True)"
    )


def test_scikit_learn_is_not_imported():
    program = "import sys, quatfilt as qf; qf.PrincipalGeodesicAnalysis(1).get_params(); print('sklearn' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
