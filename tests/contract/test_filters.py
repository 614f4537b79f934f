"""What filters take, what they refuse and in which words, and what they leave alone."""

import math

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from layouts import LAYOUTS
from scipy.spatial.transform import Rotation

FILTERS = {
    "bilateral": qf.bilateral,
    "butterworth": lambda q, *more, cutoff=0.1, **options: qf.butterworth(q, *more, cutoff=cutoff, **options),
    "denoise": lambda q, *more, **options: qf.denoise(q, *more, method="nonlocal_pose_means", **options),
    "despike": qf.despike,
    "gaussian": lambda q, *more, sigma=2.0, **options: qf.gaussian(q, *more, sigma=sigma, **options),
    "kalman": qf.kalman,
    "nonlocal_pose_means": qf.nonlocal_pose_means,
    "one_euro": qf.one_euro,
    "orientation_filter": lambda q, *more, **options: qf.orientation_filter(
        q, [1, 2, 4, 2, 1], *more, **options
    ),
    "savgol": lambda q, *more, window_length=7, **options: qf.savgol(
        q, *more, window_length=window_length, **options
    ),
    "smooth": qf.smooth,
    "wavelet": qf.wavelet,
    "weighted_moving_mean": qf.weighted_moving_mean,
}
"""From clip to clip, with the options that all filters have in common."""

OPTIONS = {
    "bilateral": qf.bilateral.__kwdefaults__,
    "butterworth": {"cutoff": None, **qf.butterworth.__kwdefaults__},
    "denoise": qf.nonlocal_pose_means.__kwdefaults__,
    "despike": qf.despike.__kwdefaults__,
    "gaussian": {"sigma": None, **qf.gaussian.__kwdefaults__},
    "kalman": qf.kalman.__kwdefaults__,
    "nonlocal_pose_means": qf.nonlocal_pose_means.__kwdefaults__,
    "one_euro": qf.one_euro.__kwdefaults__,
    "orientation_filter": qf.orientation_filter.__kwdefaults__,
    "savgol": {"window_length": None, **qf.savgol.__kwdefaults__},
    "smooth": qf.smooth.__kwdefaults__,
    "wavelet": qf.wavelet.__kwdefaults__,
    "weighted_moving_mean": qf.weighted_moving_mean.__kwdefaults__,
}
"""The options of each filter."""

every_filter = pytest.mark.parametrize("name", FILTERS)

every_filter_of_all_samples = pytest.mark.parametrize("name", sorted(set(FILTERS) - {"despike"}))
"""Those that leave no sample as it came."""

FRAMES = 90
REACH = 15
"""Frames of the default window and patch together."""


def clip(joints=3, frames=FRAMES, seed=0):
    """A noisy clip, continuous in sign."""
    rng = np.random.default_rng(seed)
    return qf.continuous(clips.noisy(rng, clips.smooth(rng, frames, joints), 0.03))


def refused(kind, call, *arguments, **options):
    """Return the message with which a call is refused, and see that nothing was written."""
    arrays = [x for x in (*arguments, *options.values()) if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    with pytest.raises(kind) as caught:
        call(*arguments, **options)
    assert [x.tobytes() for x in arrays] == before
    return str(caught.value)


# ---- shapes and types of rotations


@pytest.mark.parametrize("shape", [(), (0,), (5, 3), (5, 3, 3), (4, 5), (2, 0)])
@every_filter
def test_rows_that_are_no_quaternions(name, shape):
    message = refused(ValueError, FILTERS[name], np.zeros(shape))
    assert message == f"rotations: expected shape (..., 4), got {shape}"


@pytest.mark.parametrize("shape", [(4,), (2, 5, 3, 4)])
@every_filter
def test_arrays_that_are_no_clip(name, shape):
    message = refused(ValueError, FILTERS[name], np.ones(shape) / 2)
    assert message == f"rotations: expected shape (frames, joints, 4) or (frames, 4), got {shape}"


@pytest.mark.parametrize(
    ("value", "dtype"),
    [
        (np.zeros((5, 4), np.complex128), "complex128"),
        (np.zeros((5, 4), "datetime64[s]"), "datetime64[s]"),
        (np.full((5, 4), None), "object"),
        ([["1", "0", "0", "0"]], "<U1"),
        ("walk.bvh", "<U8"),
        (None, "object"),
    ],
)
@every_filter
def test_what_is_no_number(name, value, dtype):
    message = refused(TypeError, FILTERS[name], value)
    assert message == f"rotations: expected real numbers, got dtype {dtype}"


@every_filter
def test_ragged_lists(name):
    message = refused(ValueError, FILTERS[name], [[1.0, 0, 0, 0], [1.0, 0]])
    assert message.startswith("rotations: expected a rectangular array of numbers (")


@pytest.mark.parametrize("shape", [(0, 4), (0, 3, 4), (5, 0, 4), (0, 0, 4)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@every_filter
def test_nothing_comes_back(name, shape, dtype):
    result = FILTERS[name](np.zeros(shape, dtype))
    assert result.shape == shape
    assert result.dtype == dtype


@pytest.mark.parametrize("sample", [[-0.6, 0.0, 0.8, 0.0], [np.nan] * 4, [0.0] * 4, [0.63, 0.0, 0.8, 0.0]])
@every_filter
def test_one_frame_comes_back_unchanged(name, sample):
    q = np.array([[sample, [1.0, 0, 0, 0]]])
    result = FILTERS[name](q)
    np.testing.assert_array_equal(result, q)
    assert not np.shares_memory(result, q)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
@every_filter
def test_the_layout_does_not_matter(name, layout, dtype):
    plain = clip().astype(dtype)
    other = LAYOUTS[layout](plain)
    before = other.tobytes()
    result = FILTERS[name](other)
    np.testing.assert_array_equal(result, FILTERS[name](plain))
    assert result.dtype == dtype
    assert result.dtype.isnative
    assert result.flags.c_contiguous
    assert result.flags.writeable
    assert not np.shares_memory(result, other)
    assert other.tobytes() == before, "the input was written"


@pytest.mark.parametrize("dtype", [np.int8, np.int64, np.uint16, np.bool_])
@every_filter
def test_integers_become_float64(name, dtype):
    q = np.zeros((20, 2, 4), dtype)
    q[..., 1] = 1
    result = FILTERS[name](q)
    assert result.dtype == np.float64
    np.testing.assert_array_equal(result, q)


@pytest.mark.parametrize(("dtype", "expected"), [(np.float16, np.float32), (np.longdouble, np.float64)])
@every_filter
def test_other_floats(name, dtype, expected):
    q = clip().astype(dtype)
    result = FILTERS[name](q)
    assert result.dtype == expected
    np.testing.assert_array_equal(result, FILTERS[name](q.astype(expected)))


class WithArray:
    """As a torch tensor on the CPU."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None):
        return self.array if dtype is None else self.array.astype(dtype)


class WithDlpack:
    """As an array of a library that NumPy does not know."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


@pytest.mark.parametrize("wrap", [np.ndarray.tolist, WithArray, WithDlpack, memoryview])
@every_filter
def test_whatever_becomes_an_array(name, wrap):
    q = clip()
    np.testing.assert_array_equal(FILTERS[name](wrap(q)), FILTERS[name](q))


@pytest.mark.parametrize("scalar_first", [True, False])
@every_filter
def test_scipy_rotations(name, scalar_first):
    q = clip(joints=1)[:, 0]
    rotations = Rotation.from_quat(q, scalar_first=True)
    result = FILTERS[name](rotations, scalar_first=scalar_first)
    expected = FILTERS[name](rotations.as_quat(scalar_first=scalar_first), scalar_first=scalar_first)
    np.testing.assert_array_equal(result, expected)
    back = Rotation.from_quat(result, scalar_first=scalar_first)
    assert (back.inv() * rotations).magnitude().max() < 0.3


@every_filter
def test_scalar_last(name):
    q = clip()
    result = FILTERS[name](np.roll(q, -1, axis=-1), scalar_first=False)
    np.testing.assert_array_equal(result, np.roll(FILTERS[name](q), -1, axis=-1))


@every_filter
def test_a_single_series_is_one_joint(name):
    q = clip(joints=1)
    np.testing.assert_array_equal(FILTERS[name](q[:, 0]), FILTERS[name](q)[:, 0])


# ---- lengths and signs of quaternions


@pytest.mark.parametrize("scale", [0.92, 1.08])
@every_filter_of_all_samples
def test_lengths_near_one_are_normalised(name, scale):
    q = clip()
    result = FILTERS[name](scale * q)
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)
    # The length of the first quaternions is lost in the last digit.
    assert clips.angles(result, FILTERS[name](q)).max() < tolerances.FLOAT64


@pytest.mark.parametrize(("scale", "norm"), [(0.5, "0.5"), (2.0, "2"), (1.125, "1.125"), (1e200, "1e+200")])
@every_filter
def test_lengths_far_from_one_are_refused(name, scale, norm):
    q = np.tile([0.0, 0.0, -1.0, 0.0], (FRAMES, 3, 1))
    q[17, 2] *= scale
    message = refused(ValueError, FILTERS[name], q)
    assert message == f"rotations: expected unit quaternions, got norm {norm} at frame 17, joint 2"


@every_filter
def test_signs_do_not_matter(name):
    q = clip()
    flipped = clips.flipped(np.random.default_rng(1), q)
    flipped[0] = q[0]
    np.testing.assert_array_equal(FILTERS[name](flipped), FILTERS[name](q))


# ---- missing samples

MISSING = {
    "NaN": [np.nan] * 4,
    "zeros": [0.0] * 4,
    "one NaN": [0.5, 0.5, np.nan, 0.5],
    "infinite": [np.inf, 0, 0, 0],
}

exact_charts = pytest.mark.parametrize("chart", ["local", "identity"])
"""Charts that do not depend on the clip as a whole."""


def with_gap(q, kind, start=40, end=44, joint=1):
    other = q.copy()
    other[start:end, joint] = MISSING[kind]
    return other


@exact_charts
@pytest.mark.parametrize("kind", MISSING)
@pytest.mark.parametrize("max_gap", [None, 10.0])
def test_missing_samples_are_filled_and_do_not_spread(kind, max_gap, chart):
    q = clip()
    result = qf.nonlocal_pose_means(
        with_gap(q, kind), bandwidth=0.05, chart=chart, boundary="nearest", max_gap=max_gap
    )
    assert np.isfinite(result).all()
    whole = qf.nonlocal_pose_means(q, bandwidth=0.05, chart=chart, confidence=np.ones(FRAMES))
    for beyond in (slice(0, 40 - REACH), slice(44 + REACH, None)):
        np.testing.assert_array_equal(result[beyond], whole[beyond])
    assert clips.angles(result[40:44, 1], whole[40:44, 1]).max() < 0.2
    assert clips.angles(result, whole).max() > 0


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_kept(name, kind):
    q = clip()
    filled = FILTERS[name](with_gap(q, kind))
    kept = FILTERS[name](with_gap(q, kind), gaps="keep")
    gone = np.zeros(q.shape[:2], bool)
    gone[40:44, 1] = True
    assert np.isnan(kept[gone]).all()
    np.testing.assert_array_equal(kept[~gone], filled[~gone])


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_refused(name, kind):
    message = refused(ValueError, FILTERS[name], with_gap(clip(), kind), gaps="raise")
    assert message == "rotations: expected no missing samples with gaps='raise', got 4"


@every_filter
def test_nothing_is_refused_where_nothing_is_missing(name):
    q = clip()
    np.testing.assert_array_equal(FILTERS[name](q, gaps="raise"), FILTERS[name](q))


@exact_charts
@pytest.mark.parametrize(("max_gap", "fps"), [(3, 1), (0.02, 120)])
def test_sides_of_longer_gaps_are_filtered_apart(max_gap, fps, chart):
    q = clip()
    options = {"bandwidth": 0.05, "chart": chart}
    result = qf.nonlocal_pose_means(with_gap(q, "NaN"), max_gap=max_gap, fps=fps, **options)
    assert np.isnan(result[40:44, 1]).all()
    for side in (slice(0, 40), slice(44, None)):
        alone = qf.nonlocal_pose_means(q[side], confidence=np.ones(len(q[side])), **options)
        np.testing.assert_array_equal(result[side], alone)


NOT_FROM_THE_CLIP = {
    "denoise": {"bandwidth": 0.05, "chart": "local"},
    "kalman": {"process_noise": 0.01, "measurement_noise": 0.03},
    "nonlocal_pose_means": {"bandwidth": 0.05, "chart": "local"},
    "wavelet": {"threshold": 0.03},
}
"""Values for what is otherwise estimated from the whole clip."""


# The noise that `smooth` measures on the whole clip cannot be given: see its laws.
@pytest.mark.parametrize("name", sorted(FILTERS.keys() - {"smooth"}))
def test_sides_of_longer_gaps_do_not_know_each_other(name):
    q = clip()
    gap = q.copy()
    gap[40:44] = np.nan
    options = NOT_FROM_THE_CLIP.get(name, {})
    result = FILTERS[name](gap, max_gap=3, **options)
    assert np.isnan(result[40:44]).all()
    for side in (slice(0, 40), slice(44, None)):
        alone = FILTERS[name](q[side], **options)
        np.testing.assert_allclose(result[side], alone, rtol=0, atol=tolerances.ALGEBRA)


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_hardly_noticed_far_away(name, kind):
    """Not at all where the filter's window ends; others forget them."""
    q = clip()
    options = NOT_FROM_THE_CLIP.get(name, {})
    result, whole = (FILTERS[name](x, **options) for x in (with_gap(q, kind, 70, 74), q))
    assert np.isfinite(result).all()
    recursive = name in ("butterworth", "kalman", "smooth", "wavelet")
    assert clips.angles(result[:40], whole[:40]).max() < (0.002 if recursive else tolerances.FLOAT64)


@pytest.mark.parametrize(("max_gap", "fps"), [(4, 1), (4 / 120, 120), (0.08, 50), (None, 60)])
@every_filter
def test_gaps_are_measured_in_seconds(name, max_gap, fps):
    """Four frames are filled, five are not."""
    q = with_gap(with_gap(clip(), "NaN", 20, 24, 0), "zeros", 50, 55, 2)
    options = {"cutoff": fps / 10} if name == "butterworth" else {}
    result = FILTERS[name](q, max_gap=max_gap, fps=fps, **options)
    missing = np.isnan(result).any(axis=-1)
    assert missing.sum() == (0 if max_gap is None else 5)
    assert missing[50:55, 2].all() == (max_gap is not None)


@every_filter
def test_a_joint_that_is_never_there(name):
    q = clip()
    q[:, 1] = np.nan
    result = FILTERS[name](q)
    assert np.isnan(result[:, 1]).all()
    assert np.isfinite(result[:, [0, 2]]).all()


@pytest.mark.parametrize("kind", ["NaN", "zeros"])
@every_filter
def test_a_clip_without_any_sample(name, kind):
    result = FILTERS[name](np.tile(MISSING[kind], (20, 2, 1)))
    assert np.isnan(result).all()


@pytest.mark.parametrize("end", ["start", "end"])
@every_filter
def test_a_gap_at_one_end_that_stays_does_not_spread(name, end):
    """All joints at once: what is left is one span, and not the whole clip."""
    q = clip()
    gap, rest = (slice(0, 20), slice(20, None)) if end == "start" else (slice(70, None), slice(0, 70))
    broken = q.copy()
    broken[gap] = np.nan
    result = FILTERS[name](broken, max_gap=5)
    assert np.isnan(result[gap]).all()
    assert clips.angles(result[rest], q[rest]).max() < 1


# ---- windows


@pytest.mark.parametrize("boundary", ["nearest", "mirror", "linear"])
@pytest.mark.parametrize("frames", [2, 3, 10])
@pytest.mark.parametrize("window", [{"search_radius": 500}, {"patch_radius": 500}, {"neighbors": 10**9}])
def test_a_window_longer_than_the_clip_works(window, frames, boundary):
    q = clip(frames=frames)
    result = qf.nonlocal_pose_means(q, boundary=boundary, bandwidth=0.03, **window)
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)
    assert clips.angles(q, result).max() < 1


# ---- options

POSITIVE = "expected a number above 0"
NOT_NEGATIVE = "expected a number of at least 0"

BELOW_NYQUIST = "expected a number of at least 1e-06 and below the Nyquist frequency fps / 2 = 0.5"

WRONG_OPTIONS = [
    ("radius", -1, ValueError, "expected an integer of at least 0 and at most 5000, got -1"),
    ("radius", 5001, ValueError, "expected an integer of at least 0 and at most 5000, got 5001"),
    ("radius", 4.0, TypeError, "expected an integer of at least 0 and at most 5000, got float"),
    ("cutoff", 0, ValueError, f"{POSITIVE}, got 0"),
    ("cutoff", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("cutoff", 6, ValueError, f"{BELOW_NYQUIST}, got 6"),
    ("cutoff", [0.1, 0.5, 0.1], ValueError, f"[1]{{}}{BELOW_NYQUIST}, got 0.5"),
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
    ("strength", None, TypeError, "expected real numbers, got dtype object"),
    ("strength", [1.0, 1.0], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("strength", [1.0, -1.0, 1.0], ValueError, f"[1]{{}}{NOT_NEGATIVE} and at most 1e+06, got -1.0"),
    ("threshold", "soft", ValueError, "expected one of 'auto', 'bayes', 'universal', got 'soft'"),
    ("threshold", -0.1, ValueError, f"{NOT_NEGATIVE}, got -0.1"),
    ("threshold", math.inf, ValueError, f"{NOT_NEGATIVE}, got inf"),
    ("threshold", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("threshold", None, TypeError, "expected real numbers, got dtype object"),
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
    ("sigma", None, TypeError, "expected real numbers, got dtype object"),
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
    ("bandwidth", "wide", ValueError, "expected one of 'auto', got 'wide'"),
    ("bandwidth", None, TypeError, "expected real numbers, got dtype object"),
    ("bandwidth", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("bandwidth", [[0.1] * 3], ValueError, "expected a number or one per joint, shape (3,), got (1, 3)"),
    ("bandwidth", [0.1, -0.1, 0.1], ValueError, f"[1]{{}}{POSITIVE}, got -0.1"),
    ("bandwidth", [0.1, 0.1, np.nan], ValueError, f"[2]{{}}{POSITIVE}, got nan"),
    ("process_noise", -1, ValueError, f"{NOT_NEGATIVE}, got -1"),
    ("process_noise", math.inf, ValueError, f"{NOT_NEGATIVE}, got inf"),
    ("process_noise", "much", ValueError, "expected one of 'auto', got 'much'"),
    ("process_noise", None, TypeError, "expected real numbers, got dtype object"),
    ("process_noise", [0.1, 0.1], ValueError, "expected a number or one per joint, shape (3,), got (2,)"),
    ("process_noise", [0.1, -0.1, 0.1], ValueError, f"[1]{{}}{NOT_NEGATIVE}, got -0.1"),
    ("measurement_noise", 0, ValueError, f"{POSITIVE}, got 0"),
    ("measurement_noise", math.nan, ValueError, f"{POSITIVE}, got nan"),
    ("measurement_noise", True, TypeError, f"{POSITIVE}, got bool"),
    ("measurement_noise", "little", ValueError, "expected one of 'auto', got 'little'"),
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
    ("derivative_cutoff", None, TypeError, "expected real numbers, got dtype object"),
    ("distance", "max", ValueError, "expected one of 'mean', 'sum', got 'max'"),
    ("distance", None, ValueError, "expected one of 'mean', 'sum', got None"),
    ("weights", "joints", ValueError, "expected one of 'pose', 'joint', got 'joints'"),
    ("weights", np.ones(3), ValueError, "expected one of 'pose', 'joint', got array([1., 1., 1.])"),
    ("chart", "Mean", ValueError, "expected one of 'mean', 'identity', 'local', got 'Mean'"),
    ("boundary", "wrap", ValueError, "expected one of 'nearest', 'mirror', 'linear', got 'wrap'"),
    ("gaps", "drop", ValueError, "expected one of 'fill', 'keep', 'raise', got 'drop'"),
    ("gaps", True, ValueError, "expected one of 'fill', 'keep', 'raise', got True"),
    ("library", [], ValueError, "expected None; patches of other clips are not searched in this version"),
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
    ("confidence", "high", TypeError, "expected real numbers, got dtype <U4"),
]


WRONG_OPTIONS_OF_DESPIKE = [
    ("radius", 1, ValueError, "expected an integer of at least 2 and at most 1000, got 1"),
    ("radius", 1001, ValueError, "expected an integer of at least 2 and at most 1000, got 1001"),
    ("radius", 3.0, TypeError, "expected an integer of at least 2 and at most 1000, got float"),
    ("threshold", 0, ValueError, f"{POSITIVE}, got 0"),
    ("threshold", math.inf, ValueError, f"{POSITIVE}, got inf"),
    ("threshold", [4.0], TypeError, f"{POSITIVE}, got list"),
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
        ([1, math.nan, 1], ValueError, "mask: expected finite weights"),
        ([1, 0, -1], ValueError, "mask: expected weights whose sum is not near 0, got 0"),
        ([0], ValueError, "mask: expected weights whose sum is not near 0, got 0"),
        ([1, 1e-9, -1], ValueError, "mask: expected weights whose sum is not near 0, got 1e-09"),
        ("binomial", TypeError, "mask: expected real numbers, got dtype <U8"),
    ],
)
def test_wrong_masks(mask, kind, message):
    assert refused(kind, qf.orientation_filter, clip(), mask) == message


@pytest.mark.parametrize("scale", [1, -3, 1e300, 1e-300])
def test_masks_in_any_scale(scale):
    q = clip()
    result = qf.orientation_filter(q, scale * np.array([1.0, 2, 1]))
    assert clips.angles(result, qf.orientation_filter(q, [1, 2, 1])).max() < tolerances.ALGEBRA


def test_one_scale_of_angles_per_joint():
    q = clip()
    result = qf.bilateral(q, sigma_angle=[0.1, 0.2, math.inf])
    for joint, sigma in enumerate([0.1, 0.2, math.inf]):
        np.testing.assert_array_equal(result[:, joint], qf.bilateral(q[:, joint], sigma_angle=sigma))


def test_one_smallest_spike_per_joint():
    q = clip()
    q[40] = clips.product(q[40], clips.from_vectors(np.array([0.5, 0.3, 0])))
    result = qf.despike(q, smallest=[0.1, 0.2, 1.0])
    assert (result != q).any(axis=-1).tolist() == [
        [frame == 40, frame == 40, False] for frame in range(FRAMES)
    ]


def test_numbers_of_numpy_and_one_bandwidth_per_joint():
    q = clip()
    expected = qf.nonlocal_pose_means(q, search_radius=7, bandwidth=0.05)
    for radius, bandwidth in [
        (np.int8(7), np.float64(0.05)),
        (np.uint64(7), np.array(0.05)),
        (7, [0.05] * 3),
    ]:
        result = qf.nonlocal_pose_means(q, search_radius=radius, bandwidth=bandwidth)
        np.testing.assert_array_equal(result, expected)


@pytest.mark.parametrize("frames", [0, 1, FRAMES])
def test_a_forward_filter_has_no_lookahead(frames):
    message = refused(ValueError, qf.kalman, clip()[:frames], smooth=False, lookahead=3)
    assert message == "lookahead: expected None with smooth=False, got 3"


def test_the_smoother_without_a_lookahead_is_the_forward_filter():
    q = clip()
    np.testing.assert_array_equal(qf.kalman(q, lookahead=0), qf.kalman(q, smooth=False))
    np.testing.assert_array_equal(qf.kalman(q, lookahead=FRAMES), qf.kalman(q))


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("kalman", {"process_noise": [0.0, 0.1, 1e300], "measurement_noise": [0.1, 1e-300, 1e300]}),
        ("one_euro", {"min_cutoff": [0.1, math.inf, 1e-3], "beta": [0.0, 1.0, 1e300]}),
        ("one_euro", {"derivative_cutoff": [0.1, math.inf, 1e-300], "beta": 0.1, "min_cutoff": 0.01}),
    ],
)
def test_one_strength_per_joint(name, options):
    q = clip()
    result = FILTERS[name](q, **options)
    assert np.isfinite(result).all()
    for joint in range(3):
        own = {option: np.broadcast_to(value, 3)[joint] for option, value in options.items()}
        np.testing.assert_array_equal(result[:, joint], FILTERS[name](q[:, joint], **own))


@pytest.mark.parametrize("smooth", [True, False])
def test_automatic_noises_are_those_of_each_joint(smooth):
    q = clips.noisy(np.random.default_rng(2), clip(), np.array([0.01, 0.03, 0.1])[:, None])
    result = qf.kalman(q, smooth=smooth)
    for joint in range(3):
        np.testing.assert_array_equal(result[:, joint], qf.kalman(q[:, joint], smooth=smooth))


def test_times_are_seconds_with_a_frame_rate():
    q = clip()
    rate = 120.0
    np.testing.assert_allclose(
        qf.kalman(q, fps=rate, process_noise=0.01 * rate**1.5, measurement_noise=0.03),
        qf.kalman(q, process_noise=0.01, measurement_noise=0.03),
        rtol=0,
        atol=tolerances.FLOAT64,
    )
    np.testing.assert_allclose(
        qf.one_euro(q, fps=rate, min_cutoff=0.02 * rate, beta=0.1, derivative_cutoff=0.05 * rate),
        qf.one_euro(q, min_cutoff=0.02, beta=0.1, derivative_cutoff=0.05),
        rtol=0,
        atol=tolerances.FLOAT64,
    )


def test_confidence_per_frame_and_without_a_number():
    q = clip()
    trust = np.random.default_rng(0).random(FRAMES)
    expected = qf.nonlocal_pose_means(q, confidence=np.repeat(trust[:, None], 3, axis=1))
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q, confidence=trust), expected)
    trust[30:33] = 0
    unknown = np.where(trust == 0, np.nan, trust)
    expected = qf.nonlocal_pose_means(q, confidence=trust)
    np.testing.assert_array_equal(qf.nonlocal_pose_means(q, confidence=unknown), expected)
