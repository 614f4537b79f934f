"""What streams take, what they refuse and in which words, and what they leave alone."""

import copy
import math
import pickle
import threading

import clips
import numpy as np
import pytest
import quatfilt as qf
import streams
from layouts import LAYOUTS
from quatfilt import _core
from scipy.spatial.transform import Rotation

STREAMS = {
    "BilateralStream": lambda **options: qf.BilateralStream(**{"lookahead": 2, "iterations": 2} | options),
    "KalmanStream": lambda **options: qf.KalmanStream(
        **{"process_noise": 0.01, "measurement_noise": 0.03, "lookahead": 3} | options
    ),
    "NonlocalPoseMeansStream": lambda **options: qf.NonlocalPoseMeansStream(
        **{"bandwidth": 0.05, "lookahead": 3} | options
    ),
    "OneEuroStream": lambda **options: qf.OneEuroStream(**{"min_cutoff": 0.05, "beta": 0.1} | options),
}
"""From options to a stream, of some latency if it can have one."""

LATENCIES = {"BilateralStream": 4, "KalmanStream": 3, "NonlocalPoseMeansStream": 3, "OneEuroStream": 0}

every_stream = pytest.mark.parametrize("name", STREAMS)

JOINTS = 3
FRAMES = 30


def clip(frames=FRAMES, joints=JOINTS, seed=0):
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


# ---- poses


@pytest.mark.parametrize("shape", [(), (0,), (5, 3), (4, 5), (2, 0)])
@every_stream
def test_rows_that_are_no_quaternions(name, shape):
    message = refused(ValueError, STREAMS[name]().push, np.zeros(shape))
    assert message == f"pose: expected shape (..., 4), got {shape}"


@pytest.mark.parametrize("shape", [(1, 3, 4), (2, 5, 3, 4)])
@every_stream
def test_arrays_that_are_no_pose(name, shape):
    message = refused(ValueError, STREAMS[name]().push, np.ones(shape) / 2)
    assert message == f"pose: expected shape (joints, 4) or (4,), got {shape}"


@pytest.mark.parametrize("value", [None, "walk.bvh", [["1", "0", "0", "0"]], np.zeros((3, 4), np.complex64)])
@every_stream
def test_what_is_no_number(name, value):
    message = refused(TypeError, STREAMS[name]().push, value)
    came = "None" if value is None else f"dtype {np.asarray(value).dtype}"
    assert message == f"pose: expected real numbers, got {came}"


@pytest.mark.parametrize(("scale", "norm"), [(0.5, "0.5"), (2.0, "2"), (1e200, "1e+200")])
@every_stream
def test_lengths_far_from_one_are_refused(name, scale, norm):
    pose = np.tile([0.0, 0.0, -1.0, 0.0], (JOINTS, 1))
    pose[2] *= scale
    message = refused(ValueError, STREAMS[name]().push, pose)
    assert message == f"pose: expected unit quaternions, got norm {norm} at joint 2"


@pytest.mark.parametrize(
    ("pose", "kind", "message"),
    [
        (clip()[1, :2], ValueError, "pose: expected shape (3, 4) as in the first push, got (2, 4)"),
        (clip()[1, 0], ValueError, "pose: expected shape (3, 4) as in the first push, got (4,)"),
        (
            clip()[1].astype(np.float32),
            TypeError,
            "pose: expected dtype float64 as in the first push, got float32",
        ),
        (clip()[1] * [[2], [1], [1]], ValueError, "pose: expected unit quaternions, got norm 2 at joint 0"),
        ("pose", TypeError, "pose: expected real numbers, got dtype <U4"),
    ],
)
@every_stream
def test_a_pose_that_is_refused_leaves_the_stream_as_it_was(name, pose, kind, message):
    q = clip()
    stream = STREAMS[name]()
    poses = [stream.push(q[0])]
    assert refused(kind, stream.push, pose) == message
    poses = [came for came in [*poses, *map(stream.push, q[1:])] if came is not None]
    result = np.concatenate([poses, stream.flush()])
    np.testing.assert_array_equal(result, streams.run(STREAMS[name](), q))


@every_stream
def test_the_first_pose_settles_nothing_if_it_is_refused(name):
    stream = STREAMS[name]()
    refused(ValueError, stream.push, 2 * clip()[0, :2])
    np.testing.assert_array_equal(streams.run(stream, clip()), streams.run(STREAMS[name](), clip()))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
@every_stream
def test_the_layout_does_not_matter(name, layout, dtype):
    plain = clip().astype(dtype)
    other = LAYOUTS[layout](plain)
    before = other.tobytes()
    stream = STREAMS[name]()
    poses = [came for came in map(stream.push, other) if came is not None]
    result = np.concatenate([poses, stream.flush()])
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, streams.run(STREAMS[name](), plain))
    assert other.tobytes() == before, "an input was written"


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@every_stream
def test_what_comes_out_is_the_callers(name, dtype):
    """A pose that is pushed may be overwritten, and so may one that came out."""
    q = clip().astype(dtype)
    stream = STREAMS[name]()
    buffer = np.empty_like(q[0])
    poses = []
    for pose in q:
        buffer[:] = pose
        came = stream.push(buffer)
        buffer.fill(0.5)
        if came is not None:
            poses.append(came.copy())
            came.fill(0.5)
    result = np.concatenate([poses, stream.flush()])
    np.testing.assert_array_equal(result, streams.run(STREAMS[name](), q))


@pytest.mark.parametrize("dtype", [np.int8, np.bool_])
@every_stream
def test_integers_become_float64(name, dtype):
    pose = np.zeros((2, 4), dtype)
    pose[:, 1] = 1
    stream = STREAMS[name]()
    for _ in range(8):
        stream.push(pose)
    rest = stream.flush()
    assert rest.dtype == np.float64
    np.testing.assert_array_equal(rest, np.tile(pose, (stream.latency, 1, 1)))


@every_stream
def test_a_single_joint(name):
    q = clip(joints=1)
    expected = streams.run(STREAMS[name](), q)
    np.testing.assert_array_equal(streams.run(STREAMS[name](), q[:, 0]), expected[:, 0])


@every_stream
def test_no_joints(name):
    q = np.empty((10, 0, 4))
    assert streams.run(STREAMS[name](), q).shape == q.shape


@pytest.mark.parametrize("frames", [0, 1, 2])
@every_stream
def test_short_clips(name, frames):
    q = clip(frames)
    stream = STREAMS[name]()
    came = [stream.push(pose) is not None for pose in q]
    assert came == [stream.latency == 0] * frames
    pending = 0 if stream.latency == 0 else frames
    assert stream.flush().shape == ((pending, *q.shape[1:]) if frames else (0, 0, 4))


@every_stream
def test_scalar_last(name):
    q = clip()
    result = streams.run(STREAMS[name](scalar_first=False), np.roll(q, -1, axis=-1))
    np.testing.assert_array_equal(result, np.roll(streams.run(STREAMS[name](), q), -1, axis=-1))


@pytest.mark.parametrize("scalar_first", [True, False])
@every_stream
def test_scipy_rotations(name, scalar_first):
    q = clip()
    stream, plain = STREAMS[name](scalar_first=scalar_first), STREAMS[name](scalar_first=scalar_first)
    for pose in q:
        rotation = Rotation.from_quat(pose, scalar_first=True)
        came = stream.push(rotation)
        expected = plain.push(rotation.as_quat(scalar_first=scalar_first))
        assert (came is None) == (expected is None)
        if came is not None:
            np.testing.assert_array_equal(came, expected)


@every_stream
def test_signs_do_not_matter(name):
    q = clip()
    flipped = clips.flipped(np.random.default_rng(1), q)
    flipped[0] = q[0]
    np.testing.assert_array_equal(streams.run(STREAMS[name](), flipped), streams.run(STREAMS[name](), q))


@pytest.mark.parametrize("kind", [[np.nan] * 4, [0.0] * 4, [0.5, 0.5, np.nan, 0.5], [np.inf, 0, 0, 0]])
@every_stream
def test_missing_samples(name, kind):
    q = clip()
    q[:6, 0] = kind
    q[10:14, 1] = kind
    q[:, 2] = kind
    result = streams.run(STREAMS[name](), q)
    there = np.isfinite(result).all(axis=-1)
    assert not there[:6, 0].any()
    assert there[6:, 0].all()
    assert there[:, 1].all()
    assert not there[:, 2].any()


# ---- the end


@every_stream
def test_nothing_goes_on_after_the_end(name):
    stream = STREAMS[name]()
    stream.push(clip()[0])
    stream.flush()
    ended = "stream: expected no call after flush(); a new clip needs a new stream"
    assert refused(ValueError, stream.push, clip()[1]) == ended
    assert refused(ValueError, stream.flush) == ended


@every_stream
def test_the_latency_is_stated(name):
    stream = STREAMS[name]()
    assert isinstance(stream.latency, int)
    assert stream.latency == LATENCIES[name]
    with pytest.raises(AttributeError):
        stream.latency = 0
    if stream.latency:
        assert STREAMS[name](lookahead=0).latency == 0


# ---- one at a time


class Meddling:
    """A pose that calls the stream from another thread while it is being pushed."""

    def __init__(self, pose, call):
        self.pose, self.call, self.said = pose, call, None

    def __array__(self, dtype=None, copy=None):
        def work():
            try:
                self.call()
            except RuntimeError as error:
                self.said = str(error)

        other = threading.Thread(target=work)
        other.start()
        other.join()
        return self.pose


@every_stream
def test_calls_at_the_same_time_are_refused(name):
    q = clip()
    stream = STREAMS[name]()
    poses = []
    for meddling in (Meddling(q[0], stream.flush), Meddling(q[1], lambda: stream.push(q[7]))):
        poses.append(stream.push(meddling))
        assert meddling.said == "stream: expected one call at a time, got one during another"
    poses = [came for came in [*poses, *map(stream.push, q[2:])] if came is not None]
    result = np.concatenate([poses, stream.flush()])
    np.testing.assert_array_equal(result, streams.run(STREAMS[name](), q))


@every_stream
def test_many_threads_on_one_stream(name):
    """Each push either counts or is refused."""
    stream = STREAMS[name]()
    pose = clip()[0]
    counts, said = [], set()

    def work():
        count = 0
        for _ in range(300):
            try:
                count += stream.push(pose) is not None
            except RuntimeError as error:
                said.add(str(error))
        counts.append(count)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert said <= {"stream: expected one call at a time, got one during another"}
    assert len(counts) == 4
    assert sum(counts) > 0
    assert len(stream.flush()) == stream.latency


@every_stream
def test_streams_do_not_disturb_each_other(name):
    one, two = clip(seed=1), clip(seed=2)
    first, second = STREAMS[name](), STREAMS[name]()
    for a, b in zip(one, two, strict=True):
        first.push(a)
        second.push(b)
    alone = streams.run(STREAMS[name](), one)
    np.testing.assert_array_equal(first.flush(), alone[FRAMES - first.latency :])


@pytest.mark.parametrize("call", [pickle.dumps, copy.copy, copy.deepcopy])
@every_stream
def test_streams_are_not_copied(name, call):
    said = refused(TypeError, call, STREAMS[name]())
    assert said == f"{name}: a stream can neither be pickled nor copied; make a new one of the same options"


@every_stream
def test_every_backend_has_the_cores_streams(name):
    expected = streams.run(STREAMS[name](), clip())
    with qf.use_backend("numpy"):
        np.testing.assert_array_equal(streams.run(STREAMS[name](), clip()), expected)


# ---- options

POSITIVE = "expected a number above 0"
RADIUS = "expected an integer of at least 1 and at most 1000"

MIRROR = "boundary: expected one of 'nearest', 'linear', got 'mirror': it shows later frames before the first"
LINEAR = "boundary: expected 'nearest' with lookahead=0, got 'linear'; the velocity at the start needs the second frame"

SAMPLE = "a stream has not seen its data, measure a sample with kalman_noises"

WRONG_OPTIONS = {
    "KalmanStream": [
        (
            {"process_noise": "auto"},
            ValueError,
            f"process_noise: expected a number or one per joint, got 'auto'; {SAMPLE}",
        ),
        (
            {"measurement_noise": "auto"},
            ValueError,
            f"measurement_noise: expected a number or one per joint, got 'auto'; {SAMPLE}",
        ),
        ({"process_noise": -1}, ValueError, "process_noise: expected a number of at least 0, got -1"),
        (
            {"process_noise": [0, -1]},
            ValueError,
            "process_noise[1]: expected a number of at least 0, got -1.0",
        ),
        ({"measurement_noise": 0}, ValueError, f"measurement_noise: {POSITIVE}, got 0"),
        ({"measurement_noise": [0.1, np.nan]}, ValueError, f"measurement_noise[1]: {POSITIVE}, got nan"),
        ({"fps": 0}, ValueError, f"fps: {POSITIVE}, got 0"),
        (
            {"lookahead": 1001},
            ValueError,
            "lookahead: expected an integer of at least 0 and at most 1000, got 1001",
        ),
        (
            {"lookahead": None},
            TypeError,
            "lookahead: expected an integer of at least 0 and at most 1000, got NoneType",
        ),
    ],
    "OneEuroStream": [
        ({"min_cutoff": 0}, ValueError, f"min_cutoff: {POSITIVE}, got 0"),
        ({"min_cutoff": "auto"}, TypeError, f"min_cutoff: {POSITIVE}, got str"),
        ({"beta": -1}, ValueError, "beta: expected a number of at least 0, got -1"),
        ({"beta": [0, math.inf]}, ValueError, "beta[1]: expected a number of at least 0, got inf"),
        ({"derivative_cutoff": [1, 0]}, ValueError, f"derivative_cutoff[1]: {POSITIVE}, got 0.0"),
        ({"fps": True}, TypeError, f"fps: {POSITIVE}, got bool"),
    ],
    "BilateralStream": [
        ({"radius": -1}, ValueError, "radius: expected an integer of at least 0 and at most 1000, got -1"),
        (
            {"radius": 1001},
            ValueError,
            "radius: expected an integer of at least 0 and at most 1000, got 1001",
        ),
        ({"sigma_time": 0}, ValueError, f"sigma_time: {POSITIVE}, got 0"),
        ({"sigma_angle": 0}, ValueError, f"sigma_angle: {POSITIVE}, got 0"),
        ({"sigma_angle": [1, np.nan]}, ValueError, f"sigma_angle[1]: {POSITIVE}, got nan"),
        ({"sigma_angle": "auto"}, TypeError, f"sigma_angle: {POSITIVE}, got str"),
        (
            {"kernel": "box"},
            ValueError,
            "kernel: expected one of 'gaussian', 'printed', 'classic', got 'box'",
        ),
        (
            {"iterations": 0},
            ValueError,
            "iterations: expected an integer of at least 1 and at most 1000, got 0",
        ),
        ({"lookahead": -1}, ValueError, "lookahead: expected an integer of at least 0 and at most 4, got -1"),
        ({"lookahead": 5}, ValueError, "lookahead: expected an integer of at least 0 and at most 4, got 5"),
        ({"boundary": "mirror"}, ValueError, MIRROR),
        ({"boundary": "linear", "lookahead": 0}, ValueError, LINEAR),
    ],
    "NonlocalPoseMeansStream": [
        (
            {"bandwidth": "auto"},
            ValueError,
            "bandwidth: expected a number or one per joint, got 'auto'; a stream has not seen its data, measure a sample with noise_level",
        ),
        ({"bandwidth": 0}, ValueError, f"bandwidth: {POSITIVE}, got 0"),
        ({"bandwidth": True}, TypeError, f"bandwidth: {POSITIVE}, got bool"),
        ({"bandwidth": [0.1, -1]}, ValueError, f"bandwidth[1]: {POSITIVE}, got -1.0"),
        ({"bandwidth": None}, TypeError, "bandwidth: expected a number or one per joint, got None"),
        (
            {"bandwidth": [[0.1]]},
            ValueError,
            "bandwidth: expected a number or one per joint, shape (1,), got (1, 1)",
        ),
        (
            {"search_radius": None},
            ValueError,
            "search_radius: expected a number of frames, got None; a stream has no whole clip",
        ),
        ({"search_radius": 0}, ValueError, f"search_radius: {RADIUS}, got 0"),
        ({"search_radius": 1001}, ValueError, f"search_radius: {RADIUS}, got 1001"),
        ({"search_radius": 10.0}, TypeError, f"search_radius: {RADIUS}, got float"),
        (
            {"patch_radius": -1},
            ValueError,
            "patch_radius: expected an integer of at least 0 and at most 1000, got -1",
        ),
        (
            {"lookahead": -1},
            ValueError,
            "lookahead: expected an integer of at least 0 and at most 15, got -1",
        ),
        (
            {"lookahead": 16},
            ValueError,
            "lookahead: expected an integer of at least 0 and at most 15, got 16",
        ),
        (
            {"lookahead": None},
            TypeError,
            "lookahead: expected an integer of at least 0 and at most 15, got NoneType",
        ),
        (
            {"neighbors": 0},
            ValueError,
            "neighbors: expected an integer of at least 1 and at most 1e+09, got 0",
        ),
        ({"distance": "max"}, ValueError, "distance: expected one of 'mean', 'sum', got 'max'"),
        ({"weights": "all"}, ValueError, "weights: expected one of 'pose', 'joint', got 'all'"),
        (
            {"chart": "mean"},
            ValueError,
            "chart: expected one of 'local', 'identity', got 'mean': the mean rotation needs the whole clip",
        ),
        ({"chart": "log"}, ValueError, "chart: expected one of 'local', 'identity', got 'log'"),
        ({"boundary": "mirror"}, ValueError, MIRROR),
        ({"boundary": None}, ValueError, "boundary: expected one of 'nearest', 'linear', got None"),
        ({"boundary": "linear", "lookahead": 0}, ValueError, LINEAR),
    ],
}


@pytest.mark.parametrize(
    ("name", "options", "kind", "message"),
    [(name, *case) for name, cases in WRONG_OPTIONS.items() for case in cases],
)
def test_wrong_options(name, options, kind, message):
    assert refused(kind, STREAMS[name], **options) == message


@every_stream
def test_options_are_keyword_only(name):
    with pytest.raises(TypeError, match="positional argument"):
        getattr(qf, name)(3)


@pytest.mark.parametrize(
    ("name", "option"),
    [
        ("BilateralStream", "sigma_angle"),
        ("KalmanStream", "process_noise"),
        ("KalmanStream", "measurement_noise"),
        ("NonlocalPoseMeansStream", "bandwidth"),
        ("OneEuroStream", "min_cutoff"),
        ("OneEuroStream", "beta"),
        ("OneEuroStream", "derivative_cutoff"),
    ],
)
def test_one_strength_per_joint(name, option):
    strengths = np.array([0.02, 0.1, 0.3])
    stream = STREAMS[name](**{option: strengths})
    strengths.fill(1e3)
    other = STREAMS[name](**{option: [0.02, 0.1, 0.3]})
    np.testing.assert_array_equal(streams.run(stream, clip()), streams.run(other, clip()))
    stream = STREAMS[name](**{option: [0.1, 0.1]})
    message = refused(ValueError, stream.push, clip()[0])
    assert message == f"{option}: expected a number or one per joint, shape (3,), got (2,)"
    assert (stream.push(clip()[0, :2]) is None) == (stream.latency > 0)


TRUSTING = pytest.mark.parametrize("name", ["KalmanStream", "NonlocalPoseMeansStream", "OneEuroStream"])
"""Streams that take confidences."""


@TRUSTING
@pytest.mark.parametrize(
    ("confidence", "kind", "message"),
    [
        (1.5, ValueError, "confidence: expected values from 0 to 1, got 1.5"),
        ([0, -0.5, 1], ValueError, "confidence: expected values from 0 to 1, got -0.5"),
        (
            [1, 1],
            ValueError,
            "confidence: expected a number or one per joint, shape (3,), got (2,)",
        ),
        ("high", TypeError, "confidence: expected real numbers, got dtype <U4"),
    ],
)
def test_wrong_confidences(name, confidence, kind, message):
    stream = STREAMS[name]()
    assert refused(kind, stream.push, clip()[0], confidence) == message
    np.testing.assert_array_equal(streams.run(stream, clip()), streams.run(STREAMS[name](), clip()))


@TRUSTING
def test_confidence_as_a_number_and_without_one(name):
    q = clip()
    make = STREAMS[name]
    trust = np.random.default_rng(0).random(FRAMES)
    expected = streams.run(make(), q, np.repeat(trust[:, None], JOINTS, axis=1))
    np.testing.assert_array_equal(streams.run(make(), q, trust), expected)
    trust[5] = 0
    unknown = trust.copy()
    unknown[5] = math.nan
    np.testing.assert_array_equal(streams.run(make(), q, unknown), streams.run(make(), q, trust))


def test_windows_that_no_memory_holds_are_refused():
    stream = qf.NonlocalPoseMeansStream(
        bandwidth=0.1, search_radius=1000, patch_radius=1000, lookahead=2000, weights="joint"
    )
    message = refused(ValueError, stream.push, np.tile([1.0, 0, 0, 0], (200, 1)))
    assert message == "search_radius: expected a window whose patch distances fit into 2 GiB"


def test_passes_that_no_memory_holds_are_refused():
    stream = qf.BilateralStream(radius=1000, iterations=1000)
    message = refused(ValueError, stream.push, np.tile([1.0, 0, 0, 0], (31, 1)))
    assert message == "radius: expected a window whose passes fit into 2 GiB"


def test_a_lookahead_that_no_memory_holds_is_refused():
    stream = qf.KalmanStream(process_noise=0.1, measurement_noise=0.1, lookahead=1000)
    message = refused(ValueError, stream.push, np.tile([1.0, 0, 0, 0], (12_000, 1)))
    assert message == "lookahead: expected so many frames as fit into 2 GiB"


# ---- the module below


def test_the_module_below_guards_itself():
    """Whatever its arguments are, the compiled module neither crashes nor panics."""
    bandwidth = np.full(2, 0.1)
    options = (3, 1, "mean", "pose", -1, "local", "nearest", 1)
    make = _core.nonlocal_pose_means_stream
    for wrong in [
        (-1, *options[1:]),
        (*options[:5], "mean", *options[6:]),
        (*options[:6], "mirror", 1),
        (*options[:6], "linear", 0),
        (*options[:6], "wrap", 1),
        (2**62, 2**62, *options[2:]),
    ]:
        with pytest.raises(ValueError):
            make(bandwidth, *wrong)
    for lookahead in (-1, 2**62):
        with pytest.raises(ValueError):
            _core.kalman_stream(bandwidth, bandwidth, lookahead)
    with pytest.raises(ValueError):
        _core.kalman_stream(bandwidth, bandwidth[:1], 1)
    with pytest.raises(ValueError):
        _core.one_euro_stream(bandwidth, bandwidth[:1], bandwidth)
    stream = make(bandwidth, *options)
    assert stream.latency == 1
    with pytest.raises(ValueError):
        stream.push(np.zeros(7), None)
    with pytest.raises(ValueError):
        stream.push(np.zeros(8), np.ones(3))
    with pytest.raises(TypeError):
        stream.push(np.zeros(8, np.float32), None)
    assert stream.push(np.eye(4)[:2], None) is None
    assert stream.flush().shape == (1, 2, 4)
    with pytest.raises(ValueError):
        stream.push(np.eye(4)[:2], None)
    assert stream.flush().shape == (0, 2, 4)
    with pytest.raises(TypeError):
        _core.PoseStream()
