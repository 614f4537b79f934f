"""One call of every public function that computes, for tests that ask all of them the same question."""

import numpy as np
import quatfilt as qf
import walkers

NOT_KERNELS = {
    "Compressed": "a class",
    "EndSite": "a part of a skeleton",
    "FileAccessError": "an error",
    "FileFormatError": "an error",
    "Motion": "a class",
    "NoiseModel": "a class",
    "MotionDatabase": "a class",
    "PoseGPLVM": "GPy learns it, for seconds",
    "PosePrediction": "a class",
    "ReconstructedPose": "what a stream gives",
    "ReconstructionStream": "a reconstructor makes it",
    "QuatfiltError": "an error",
    "Report": "a class",
    "Skeleton": "a class",
    "read_motion": "takes a file",
    "report": "returns numbers and texts",
    "write_motion": "takes a file",
    "get_backend": "asks who computes",
    "get_num_threads": "asks for the number of threads",
    "set_num_threads": "sets the number of threads",
    "simd_level": "asks for the vector instructions",
    "use_backend": "chooses who computes",
}
"""Public names that no array goes through, and why."""

FRAMES = 12_007
"""With three joints more than two tasks, and no multiple of a vector."""


def samples(dtype):
    """Return unit quaternions, others, vectors: ``(frames, 3, 4)`` twice and ``(frames, 3, 3)``."""
    rng = np.random.default_rng(20)
    a = rng.standard_normal((FRAMES, 3, 4))
    b = rng.standard_normal((FRAMES, 3, 4))
    v = rng.standard_normal((FRAMES, 3, 3)) * np.exp(rng.uniform(-20, 2, (FRAMES, 3, 1)))
    a /= np.linalg.norm(a, axis=-1, keepdims=True)
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    b[::7] = a[::7]
    return a.astype(dtype), b.astype(dtype), v.astype(dtype)


def with_gaps(q):
    """Return `q` with one sample in eleven missing, and a longer run."""
    gaps = q.copy()
    gaps[::11] = np.nan
    gaps[100:120, 1] = 0
    return gaps


def with_legs(q, work):
    """Apply `work` to a motion of two legs, that of one side in the other's phase; rotations ``(frames, 3, 4)`` are hip, knee and ankle."""
    names = ("hips", *(side + part for side in ("l", "r") for part in ("thigh", "shin", "foot")))
    offsets = np.array([[0, 0, 0], *[[x, y, 0] for x in (9, -9) for y in (0, -43, -42)]], float)
    skeleton = qf.Skeleton(names, [-1, 0, 1, 2, 0, 4, 5], offsets)
    rest = np.tile([1.0, 0, 0, 0], (len(q), 1, 1)).astype(q.dtype)
    small = np.where(np.isnan(q), q, 0.02 * q + rest)
    legs = small / np.linalg.norm(small, axis=-1, keepdims=True)
    rotations = np.concatenate([rest, legs, legs[::-1]], axis=1)
    rotations[np.isnan(rotations).any(axis=-1)] = 0
    return work(qf.Motion(rotations, np.full((len(q), 3), 85.0), fps=60, skeleton=skeleton)).rotations


POSES = 4_000
"""Poses that are searched, of nine numbers each."""


def borders():
    """Return the borders of three clips."""
    return [0, 1_500, 1_501, POSES]


def rows(v):
    """Return poses that move, as rows."""
    return np.cumsum(v[:POSES].reshape(POSES, 9), axis=0)


def searched(v):
    """Find the nearest segments of frames in sequence, along a graph and without one."""
    poses = rows(v)
    graph, _ = qf.neighbor_graph(poses, borders(), degree=4)
    searches = [qf.PoseSearch(poses, borders(), graph, k=5), qf.PoseSearch(poses, borders(), k=5)]
    return np.stack([search(poses[t : t + 3] + 0.01)[1] for t in range(50) for search in searches])


STREAMED = 400
"""Frames that are pushed one by one."""


def streamed(stream, q):
    """Push a clip with gaps, and return all that comes out."""
    poses = [pose for pose in map(stream.push, with_gaps(q[:STREAMED])) if pose is not None]
    return np.concatenate([poses, stream.flush()])


def six_times(x):
    """Return a clip long enough for several threads where a sample costs a nanosecond."""
    return np.concatenate([x] * 6)


def with_spikes(q):
    """Return a joint that turns slowly, with the first samples of `q` as spikes in it."""
    slow = qf.exp(np.linspace(0, 9, len(q), dtype=q.dtype)[:, None, None] * np.ones((3, 3), q.dtype))
    slow[40::50] = q[40::50]
    return slow


def database(q):
    """Return a database of a clip and its mirror image."""
    body = qf.Skeleton(["hips", "LeftArm", "RightArm"], [-1, 0, 0], [[0.0, 0, 0], [3, 0, 0], [-3, 0, 0]])
    return qf.MotionDatabase.from_motions([qf.Motion(q, fps=50, skeleton=body)], mirror=True)


def predicted(q):
    """Predict poses by several models from examples about them."""
    near = qf.multiply(q[:1], qf.exp(0.2 * qf.log(qf.multiply(qf.conjugate(q[:1]), q[:160]))))
    examples = near.reshape(40, 4, *q.shape[1:])
    models = ("local_regression", "local_pcr", "local_pca")
    return np.concatenate([qf.predict_pose(examples[1:], examples[0, :3], model=m).pose for m in models])


def reconstructed(dtype):
    """Return a motion from a few trajectories."""
    reconstructor = qf.MotionReconstructor(
        walkers.database(), control_points=walkers.JOINTS, neighbors=24, model="local_pca"
    )
    return reconstructor.reconstruct(walkers.seen(walkers.walker(6)).astype(dtype), fps=60).rotations


def analysed(q):
    """Fit geodesics to samples in the half about 1, so that there is one mean, and go through all that is asked of them."""
    near = with_gaps(qf.exp(0.6 * qf.log(q * np.where(q[..., :1] < 0, -1, 1).astype(q.dtype))))
    pga = qf.PrincipalGeodesicAnalysis(3).fit(near)
    scores = pga.transform(near)
    found = [pga.mean_, pga.components_, pga.residuals_, scores, pga.inverse_transform(scores)]
    body = qf.PrincipalGeodesicAnalysis(2, body=True).fit(near[:1500])
    scores = body.transform(near)
    found += [body.components_, body.residuals_, scores, body.inverse_transform(scores)]
    return np.concatenate([array.ravel() for array in [*found, pga.reconstruction_error(near, 1)]])


CALLS = {
    "BilateralStream": lambda a, _b, _v: streamed(
        qf.BilateralStream(sigma_angle=1.0, iterations=2, lookahead=2), a
    ),
    "KalmanStream": lambda a, _b, _v: streamed(
        qf.KalmanStream(process_noise=0.1, measurement_noise=0.5, lookahead=7), a
    ),
    "MotionDatabase": lambda a, _b, _v: database(a).features,
    "MotionReconstructor": lambda a, _b, _v: reconstructed(a.dtype),
    "NonlocalPoseMeansStream": lambda a, _b, _v: streamed(
        qf.NonlocalPoseMeansStream(bandwidth=1.0, lookahead=7), a
    ),
    "OneEuroStream": lambda a, _b, _v: streamed(qf.OneEuroStream(min_cutoff=0.1, beta=0.1), a),
    "PrincipalGeodesicAnalysis": lambda a, _b, _v: analysed(a),
    "PoseSearch": lambda _a, _b, v: searched(v),
    "add_gaussian_noise": lambda a, _b, _v: qf.add_gaussian_noise(a, sigma=0.1, rng=1),
    "add_impulse_noise": lambda a, _b, _v: qf.add_impulse_noise(a, probability=0.1, rng=1),
    "bilateral": lambda a, _b, _v: qf.bilateral(with_gaps(a), sigma_angle=1.0, iterations=2),
    "butterworth": lambda a, _b, _v: qf.butterworth(with_gaps(a), cutoff=0.1),
    "compress": lambda a, _b, _v: qf.compress(with_gaps(a), tolerance=0.01).decompress(),
    "conjugate": lambda a, _b, _v: qf.conjugate(six_times(a)),
    "continuous": lambda a, _b, _v: qf.continuous(with_gaps(a)),
    "denoise": lambda a, _b, _v: qf.denoise(with_gaps(a)),
    "despike": lambda a, _b, _v: qf.despike(with_gaps(with_spikes(a)), smallest=0.5),
    "exp": lambda _a, _b, v: qf.exp(six_times(v)),
    "fill_gaps": lambda a, _b, _v: qf.fill_gaps(with_gaps(a))[0],
    "gaussian": lambda a, _b, _v: qf.gaussian(with_gaps(a), sigma=2.5),
    "geodesic_distance": lambda a, b, _v: qf.geodesic_distance(six_times(a), six_times(b)),
    "kalman": lambda a, _b, _v: qf.kalman(with_gaps(a), lookahead=2),
    "kalman_noises": lambda a, _b, _v: qf.kalman_noises(with_gaps(a))[0],
    "lock_feet": lambda a, _b, _v: with_legs(with_gaps(a), qf.lock_feet),
    "log": lambda a, _b, _v: qf.log(six_times(a)),
    "mean": lambda a, _b, _v: qf.mean(with_gaps(a)),
    "multiply": lambda a, b, _v: qf.multiply(six_times(a), six_times(b)),
    "nearest_segments": lambda _a, _b, v: qf.nearest_segments(
        rows(v), borders(), rows(v)[:180].reshape(60, 3, 9) + 0.01, k=7
    )[1],
    "neighbor_graph": lambda _a, _b, v: qf.neighbor_graph(rows(v), borders(), degree=3)[1],
    "noise_level": lambda a, _b, _v: qf.noise_level(with_gaps(a)),
    "noise_model": lambda a, _b, _v: qf.noise_model(with_gaps(a)).level,
    "nonlocal_pose_means": lambda a, _b, _v: qf.nonlocal_pose_means(with_gaps(a), bandwidth=1.0),
    "normalize": lambda a, _b, _v: qf.normalize(six_times(2 * a)),
    "one_euro": lambda a, _b, _v: qf.one_euro(with_gaps(a), min_cutoff=0.1, beta=0.1),
    "orientation_filter": lambda a, _b, _v: qf.orientation_filter(
        with_gaps(a), [1, 2, 3, 2, 1], confidence=np.arange(FRAMES) % 7 / 6
    ),
    "patch_neighbors": lambda a, b, _v: np.concatenate(
        [
            x.astype(a.dtype)
            for x in (
                *qf.patch_neighbors(a[:600], k=4),
                *qf.patch_neighbors(with_gaps(b)[:300], k=4, library=a[:500]),
            )
        ]
    ),
    "predict_pose": lambda a, _b, _v: predicted(a),
    "resample": lambda a, _b, _v: qf.resample(a, fps=30, new_fps=31.7),
    "savgol": lambda a, _b, _v: qf.savgol(with_gaps(a), window_length=11),
    "segment": lambda a, _b, _v: qf.segment(with_gaps(a), window=20, min_length=5, threshold=0.5),
    "slerp": lambda a, _b, _v: qf.slerp(a, np.arange(FRAMES), np.linspace(0, FRAMES - 1, 10_001)),
    "smooth": lambda a, _b, _v: qf.smooth(with_gaps(a)),
    "smooth with gains": lambda a, _b, _v: qf.smooth(with_gaps(a)[:600], joints="together", learned=True),
    "wavelet": lambda a, _b, _v: qf.wavelet(with_gaps(a)),
    "weighted_moving_mean": lambda a, _b, _v: qf.weighted_moving_mean(with_gaps(a), iterations=3),
}
"""From the name, and what is special, to a call with what `samples` returns."""
