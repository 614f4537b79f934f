"""Which options filters refuse, and in which words."""

import math

import numpy as np
import pytest
import quatfilt as qf
from contract.filters import FILTERS, FRAMES, OPTIONS, clip, every_filter, refused

POSITIVE = "expected a number above 0"
NOT_NEGATIVE = "expected a number of at least 0"

BELOW_NYQUIST = "expected a number of at least 1e-06 and below the Nyquist frequency fps / 2 = 0.5"
WITHOUT_FPS = "pass the frame rate to give it in hertz, for example fps=30 (frames per second)"

WRONG_OPTIONS = [
    ("radius", -1, ValueError, "expected an integer of at least 0 and at most 5000, got -1"),
    ("radius", 5001, ValueError, "expected an integer of at least 0 and at most 5000, got 5001"),
    ("radius", 4.0, TypeError, "expected an integer of at least 0 and at most 5000, got float"),
    ("cutoff", 0, ValueError, f"{POSITIVE}, got 0"),
    ("cutoff", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("cutoff", 6, ValueError, f"{BELOW_NYQUIST}, got 6; {WITHOUT_FPS}"),
    ("cutoff", [0.1, 0.5, 0.1], ValueError, f"[1]{{}}{BELOW_NYQUIST}, got 0.5; {WITHOUT_FPS}"),
    ("cutoff", 1e-7, ValueError, f"{BELOW_NYQUIST}, got 1e-07"),
    ("cutoff", [0.1] * 4, ValueError, "expected a number or one per joint, shape (3,), got (4,)"),
    ("order", 0, ValueError, "expected an integer of at least 1 and at most 20, got 0"),
    ("order", 21, ValueError, "expected an integer of at least 1 and at most 20, got 21"),
    ("order", 4.0, TypeError, "expected an integer of at least 1 and at most 20, got float"),
    ("joints", "all", ValueError, "expected one of 'apart', 'together', got 'all'"),
    ("strength", -0.1, ValueError, f"{NOT_NEGATIVE} and at most 1e+06, got -0.1"),
    ("strength", 2e6, ValueError, f"{NOT_NEGATIVE} and at most 1e+06, got 2000000.0"),
    ("strength", math.nan, ValueError, f"{NOT_NEGATIVE} and at most 1e+06, got nan"),
    ("strength", math.inf, ValueError, f"{NOT_NEGATIVE} and at most 1e+06, got inf"),
    ("strength", True, TypeError, f"{NOT_NEGATIVE} and at most 1e+06, got bool"),
    ("strength", "auto", TypeError, f"{NOT_NEGATIVE} and at most 1e+06, got str"),
    ("strength", None, TypeError, "expected a number or one per joint, got None"),
    ("strength", [1.0, 1.0], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("strength", [1.0, -1.0, 1.0], ValueError, f"[1]{{}}{NOT_NEGATIVE} and at most 1e+06, got -1.0"),
    (
        "threshold",
        "soft",
        ValueError,
        "expected one of 'auto', 'bayes', 'universal', a number or one per joint, got 'soft'",
    ),
    ("threshold", -0.1, ValueError, f"{NOT_NEGATIVE}, got -0.1"),
    ("threshold", math.inf, ValueError, f"{NOT_NEGATIVE}, got inf"),
    ("threshold", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("threshold", None, TypeError, "expected a number or one per joint, got None"),
    ("window_length", 0, ValueError, "expected an integer of at least 1, got 0"),
    ("window_length", 8, ValueError, "expected an odd number, got 8"),
    ("window_length", 91, ValueError, "expected at most as many as the clip's 90 frames, got 91"),
    ("window_length", 7.0, TypeError, "expected an integer of at least 1, got float"),
    ("polyorder", 7, ValueError, "expected an integer of at least 0 and at most 6, got 7"),
    ("polyorder", -1, ValueError, "expected an integer of at least 0 and at most 6, got -1"),
    ("polyorder", 2.5, TypeError, "expected an integer of at least 0 and at most 6, got float"),
    ("deriv", 3, ValueError, "expected an integer of at least 0 and at most 2, got 3"),
    ("deriv", True, TypeError, "expected an integer of at least 0 and at most 2, got bool"),
    ("sigma", 0, ValueError, f"{POSITIVE} and at most 25000, got 0"),
    ("sigma", 1e5, ValueError, f"{POSITIVE} and at most 25000, got 100000.0"),
    ("sigma", math.nan, ValueError, f"{POSITIVE} and at most 25000, got nan"),
    ("sigma", [1.0, 2.0], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("sigma", [1.0, -2.0, 1.0], ValueError, f"[1]{{}}{POSITIVE} and at most 25000, got -2.0"),
    ("sigma", None, TypeError, "expected a number or one per joint, got None"),
    ("smallest", "tiny", ValueError, "expected 'auto', a number or one per joint, got 'tiny'"),
    ("smallest", -0.1, ValueError, f"{NOT_NEGATIVE}, got -0.1"),
    ("smallest", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("smallest", [0.1, 0.1, math.nan], ValueError, f"[2]{{}}{NOT_NEGATIVE}, got nan"),
    ("sigma_time", 0, ValueError, f"{POSITIVE}, got 0"),
    ("sigma_time", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("sigma_time", [1.0], TypeError, f"{POSITIVE}, got list"),
    ("sigma_angle", 0, ValueError, f"{POSITIVE}, got 0"),
    ("sigma_angle", math.nan, ValueError, f"{POSITIVE}, got nan"),
    ("sigma_angle", -math.inf, ValueError, f"{POSITIVE}, got -inf"),
    ("sigma_angle", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("sigma_angle", [0.1, np.nan, 0.1], ValueError, f"[1]{{}}{POSITIVE}, got nan"),
    ("kernel", "box", ValueError, "expected one of 'gaussian', 'printed', 'classic', got 'box'"),
    ("iterations", 0, ValueError, "expected an integer of at least 1, got 0"),
    ("iterations", True, TypeError, "expected an integer of at least 1, got bool"),
    ("search_radius", 0, ValueError, "expected an integer of at least 1 and at most 100000, got 0"),
    ("search_radius", -3, ValueError, "expected an integer of at least 1 and at most 100000, got -3"),
    (
        "search_radius",
        10**9,
        ValueError,
        "expected an integer of at least 1 and at most 100000, got 1000000000",
    ),
    ("search_radius", 10.0, TypeError, "expected an integer of at least 1 and at most 100000, got float"),
    ("search_radius", math.nan, TypeError, "expected an integer of at least 1 and at most 100000, got float"),
    ("search_radius", True, TypeError, "expected an integer of at least 1 and at most 100000, got bool"),
    ("search_radius", "10", TypeError, "expected an integer of at least 1 and at most 100000, got str"),
    ("patch_radius", -1, ValueError, "expected an integer of at least 0 and at most 100000, got -1"),
    (
        "patch_radius",
        10**30,
        ValueError,
        f"expected an integer of at least 0 and at most 100000, got {10**30}",
    ),
    ("patch_radius", 5.5, TypeError, "expected an integer of at least 0 and at most 100000, got float"),
    ("patch_radius", None, TypeError, "expected an integer of at least 0 and at most 100000, got NoneType"),
    ("neighbors", 0, ValueError, "expected an integer of at least 1 and at most 1e+09, got 0"),
    ("neighbors", np.True_, TypeError, "expected an integer of at least 1 and at most 1e+09, got bool"),
    ("lookahead", -1, ValueError, "expected an integer of at least 0 and at most 1e+09, got -1"),
    ("lookahead", "0", TypeError, "expected an integer of at least 0 and at most 1e+09, got str"),
    ("bandwidth", 0, ValueError, f"{POSITIVE}, got 0"),
    ("bandwidth", -0.1, ValueError, f"{POSITIVE}, got -0.1"),
    ("bandwidth", math.nan, ValueError, f"{POSITIVE}, got nan"),
    ("bandwidth", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("bandwidth", True, TypeError, f"{POSITIVE}, got bool"),
    ("bandwidth", 1j, TypeError, f"{POSITIVE}, got complex"),
    ("bandwidth", "wide", ValueError, "expected 'auto', a number or one per joint, got 'wide'"),
    ("bandwidth", None, TypeError, "expected a number or one per joint, got None"),
    ("bandwidth", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("bandwidth", [[0.1] * 3], ValueError, "expected a number or one per joint, shape (3,), got (1, 3)"),
    ("bandwidth", [0.1, -0.1, 0.1], ValueError, f"[1]{{}}{POSITIVE}, got -0.1"),
    ("bandwidth", [0.1, 0.1, np.nan], ValueError, f"[2]{{}}{POSITIVE}, got nan"),
    ("process_noise", -1, ValueError, f"{NOT_NEGATIVE}, got -1"),
    ("process_noise", math.inf, ValueError, f"{NOT_NEGATIVE}, got inf"),
    ("process_noise", "much", ValueError, "expected 'auto', a number or one per joint, got 'much'"),
    ("process_noise", None, TypeError, "expected a number or one per joint, got None"),
    ("process_noise", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("process_noise", [0.1, -0.1, 0.1], ValueError, f"[1]{{}}{NOT_NEGATIVE}, got -0.1"),
    ("measurement_noise", 0, ValueError, f"{POSITIVE}, got 0"),
    ("measurement_noise", math.nan, ValueError, f"{POSITIVE}, got nan"),
    ("measurement_noise", True, TypeError, f"{POSITIVE}, got bool"),
    ("measurement_noise", "little", ValueError, "expected 'auto', a number or one per joint, got 'little'"),
    ("measurement_noise", [0.1, 0, 0.1], ValueError, f"[1]{{}}{POSITIVE}, got 0.0"),
    ("smooth", 1, TypeError, "expected True or False, got int"),
    ("smooth", None, TypeError, "expected True or False, got NoneType"),
    ("min_cutoff", 0, ValueError, f"{POSITIVE}, got 0"),
    ("min_cutoff", math.nan, ValueError, f"{POSITIVE}, got nan"),
    ("min_cutoff", "auto", TypeError, f"{POSITIVE}, got str"),
    ("min_cutoff", [1.0, 1.0], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("min_cutoff", [1.0, -1.0, 1.0], ValueError, f"[1]{{}}{POSITIVE}, got -1.0"),
    ("beta", -0.5, ValueError, f"{NOT_NEGATIVE}, got -0.5"),
    ("beta", math.inf, ValueError, f"{NOT_NEGATIVE}, got inf"),
    ("beta", [0.0, math.nan, 0.0], ValueError, f"[1]{{}}{NOT_NEGATIVE}, got nan"),
    ("derivative_cutoff", 0, ValueError, f"{POSITIVE}, got 0"),
    ("derivative_cutoff", None, TypeError, "expected a number or one per joint, got None"),
    ("distance", "max", ValueError, "expected one of 'mean', 'sum', got 'max'"),
    ("distance", None, ValueError, "expected one of 'mean', 'sum', got None"),
    ("weights", "joints", ValueError, "expected one of 'pose', 'joint', got 'joints'"),
    ("weights", np.ones(3), ValueError, "expected one of 'pose', 'joint', got array([1., 1., 1.])"),
    ("chart", "Mean", ValueError, "expected one of 'mean', 'identity', 'local', got 'Mean'"),
    ("boundary", "wrap", ValueError, "expected one of 'nearest', 'mirror', 'linear', got 'wrap'"),
    ("gaps", "drop", ValueError, "expected one of 'fill', 'keep', 'raise', got 'drop'"),
    ("gaps", True, ValueError, "expected one of 'fill', 'keep', 'raise', got True"),
    ("library", [], ValueError, "expected a clip or a list of clips, got an empty list"),
    ("library", np.ones((5, 3)), ValueError, "expected shape (..., 4), got (5, 3)"),
    ("max_gap", -1, ValueError, f"{NOT_NEGATIVE}, got -1"),
    ("max_gap", math.nan, ValueError, f"{NOT_NEGATIVE}, got nan"),
    ("max_gap", "1 s", TypeError, f"{NOT_NEGATIVE}, got str"),
    ("fps", 0, ValueError, f"{POSITIVE}, got 0"),
    ("fps", -120, ValueError, f"{POSITIVE}, got -120"),
    ("fps", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("fps", True, TypeError, f"{POSITIVE}, got bool"),
    ("fps", [120], TypeError, f"{POSITIVE}, got list"),
    ("confidence", np.ones(FRAMES + 1), ValueError, "expected shape (90,) or (90, 3), got (91,)"),
    ("confidence", np.ones((FRAMES, 1)), ValueError, "expected shape (90,) or (90, 3), got (90, 1)"),
    ("confidence", 0.5, ValueError, "expected shape (90,) or (90, 3), got ()"),
    ("confidence", np.linspace(0, 1.5, FRAMES), ValueError, "expected values from 0 to 1, got 1.5"),
    ("confidence", np.linspace(-0.5, 1, FRAMES), ValueError, "expected values from 0 to 1, got -0.5"),
    ("confidence", np.full(FRAMES, np.inf), ValueError, "expected values from 0 to 1, got inf"),
    ("scalar_first", "x", TypeError, "expected True or False, got str"),
    ("scalar_first", 0, TypeError, "expected True or False, got int"),
    ("confidence", "high", TypeError, "expected real numbers, got dtype <U4"),
]


WRONG_OPTIONS_OF_DESPIKE = [
    ("radius", 1, ValueError, "expected an integer of at least 2 and at most 1000, got 1"),
    ("radius", 1001, ValueError, "expected an integer of at least 2 and at most 1000, got 1001"),
    ("radius", "wide", ValueError, "expected 'auto' or a number of frames, got 'wide'"),
    ("radius", 3.0, TypeError, "expected an integer of at least 2 and at most 1000, got float"),
    ("threshold", 0, ValueError, f"{POSITIVE}, got 0"),
    ("threshold", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("threshold", [4.0], ValueError, "expected a number or one per joint, shape (3,), got (1,)"),
]
"""Of options whose names stand for something else in other filters."""


@pytest.mark.parametrize(("option", "value", "kind", "message"), WRONG_OPTIONS_OF_DESPIKE)
@pytest.mark.parametrize("frames", [0, 1, FRAMES])
def test_wrong_options_of_despike(frames, option, value, kind, message):
    assert refused(kind, qf.despike, clip(frames=frames), **{option: value}) == f"{option}: {message}"


@pytest.mark.parametrize(
    ("name", "option", "value", "kind", "message"),
    [
        (name, *case)
        for name in FILTERS
        for case in WRONG_OPTIONS
        if case[0] in OPTIONS[name] and not (name == "despike" and case[0] in ("radius", "threshold"))
    ],
)
def test_wrong_options(name, option, value, kind, message):
    said = refused(kind, FILTERS[name], clip(), **{option: value})
    expected = option + message.replace("{}", ": ") if message.startswith("[") else f"{option}: {message}"
    assert said == expected


@pytest.mark.parametrize("frames", [0, 1])
@pytest.mark.parametrize(
    ("name", "option", "value"),
    [
        (name, option, value)
        for name in FILTERS
        for option, value in [
            ("search_radius", 0),
            ("bandwidth", -1),
            ("sigma_angle", -1),
            ("process_noise", -1),
            ("measurement_noise", 0),
            ("min_cutoff", 0),
            ("iterations", 0),
            ("smallest", -1),
            ("strength", -1),
            ("gaps", "drop"),
            ("fps", 0),
        ]
        if option in OPTIONS[name]
    ],
)
def test_wrong_options_are_refused_for_the_shortest_clips_too(name, option, value, frames):
    assert refused(ValueError, FILTERS[name], clip(frames=frames), **{option: value}).startswith(
        f"{option}: "
    )


@every_filter
def test_options_are_keyword_only(name):
    with pytest.raises(TypeError, match="positional argument"):
        FILTERS[name](clip(), 10)


@pytest.mark.parametrize(
    ("mask", "kind", "message"),
    [
        ([], ValueError, "mask: expected an odd number of weights, shape (2k + 1,), got (0,)"),
        ([1, 1], ValueError, "mask: expected an odd number of weights, shape (2k + 1,), got (2,)"),
        (1.0, ValueError, "mask: expected an odd number of weights, shape (2k + 1,), got ()"),
        ([[1.0]], ValueError, "mask: expected an odd number of weights, shape (2k + 1,), got (1, 1)"),
        ([1, math.nan, 1], ValueError, "mask: expected finite weights, got nan"),
        ([1, 0, -1], ValueError, "mask: expected weights whose sum is not near 0, got 0"),
        ([0], ValueError, "mask: expected weights whose sum is not near 0, got 0"),
        ([1, 1e-9, -1], ValueError, "mask: expected weights whose sum is not near 0, got 1e-09"),
        ("binomial", TypeError, "mask: expected real numbers, got dtype <U8"),
    ],
)
def test_wrong_masks(mask, kind, message):
    assert refused(kind, qf.orientation_filter, clip(), mask) == message


@pytest.mark.parametrize("frames", [0, 1, FRAMES])
def test_a_forward_filter_has_no_lookahead(frames):
    message = refused(ValueError, qf.kalman, clip()[:frames], smooth=False, lookahead=3)
    assert message == "lookahead: expected None with smooth=False, got 3"
