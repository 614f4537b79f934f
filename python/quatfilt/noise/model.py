"""What a clip tells of its noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._typing import Mask
from quatfilt.filters.despike import spikes
from quatfilt.motion.motion import Motion
from quatfilt.noise._measure import measure


@dataclass(frozen=True, eq=False, repr=False)
class NoiseModel:
    """Noise that was measured on a clip.

    Parameters
    ----------
    level : ndarray, shape (joints, 3), radians
        Deviation of the noise along each of its axes, over the whole clip; increasing.
    axes : ndarray, shape (joints, 3, 3)
        The axes in the frame of the joint, unit vectors as columns, in the order of `level`.
    colour : float
        Coefficient ``ρ`` of noise that follows ``n_{t+1} = ρ n_t + e_t``; 0 for white noise.
    along_time : ndarray, shape (frames,)
        Deviation at each frame in units of `level`, the same for all joints; its mean square is 1. All ones for steady noise.
    repeated : ndarray of bool, shape (frames, joints)
        Samples that equal the one before exactly: frozen or held joints, doubled frames. Joints that never change have none.
    spikes : ndarray of bool, shape (frames, joints)
        Runs of samples that leave the motion and come back at once.
    evidence : float
        From 0, so little noise that it may be motion, to 1. Colour is looked for above 0.
    fps : float, hertz
        Frame rate; 1 where it was not given.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> still = np.tile([1.0, 0.0, 0.0, 0.0], (3000, 1))
    >>> qf.noise_model(qf.add_gaussian_noise(still, sigma=0.02, rng=1), fps=120)
    NoiseModel(level: 1.12° in the median over the joints, at most 1.12°; colour: white; along time: steady; repeats: none; spikes: none)
    """

    level: NDArray[np.float64]
    axes: NDArray[np.float64]
    colour: float
    along_time: NDArray[np.float64]
    repeated: Mask
    spikes: Mask
    evidence: float
    fps: float

    @property
    def joint_level(self) -> NDArray[np.float64]:
        """Deviation per component of the rotation vector of each joint, ``(joints,)``, radians: what `noise_level` returns."""
        return np.asarray(np.sqrt(np.mean(self.level**2, axis=1)))

    @property
    def steady(self) -> bool:
        """Whether the level is the same at all frames."""
        return bool((self.along_time == 1).all())

    @property
    def unsteadiness(self) -> float:
        """Ratio of the deviations of the noisiest and the quietest tenth of the frames; 1 for steady noise."""
        if self.steady:
            return 1.0
        low, high = np.quantile(self.along_time, [0.1, 0.9])
        return float(high / low)

    def describe(self) -> list[tuple[str, str]]:
        """Return names and values of what was measured, in words."""
        level = np.degrees(self.joint_level)
        unit = "frames" if self.fps <= 1 else "s"
        repeated = float(self.repeated.sum()) / max(self.repeated.shape[1], 1) / self.fps
        spiky = float(self.spikes.any(axis=1).sum()) / self.fps
        median = float(np.median(level)) if level.size else 0.0
        largest = float(level.max(initial=0))
        return [
            ("level", f"{median:.3g}° in the median over the joints, at most {largest:.3g}°"),
            ("colour", f"AR(1), rho {self.colour:.2f}" if self.colour else "white"),
            (
                "along time",
                "steady" if self.steady else f"unsteady, {self.unsteadiness:.1f} times as large at times",
            ),
            ("repeats", f"{repeated:.3g} {unit} per joint" if repeated else "none"),
            ("spikes", f"{spiky:.3g} {unit}" if spiky else "none"),
        ]

    def __repr__(self) -> str:
        """Return the model in words."""
        return "NoiseModel(" + "; ".join(f"{name}: {value}" for name, value in self.describe()) + ")"


def noise_model(q: Motion | ArrayLike, *, fps: float = 1.0, scalar_first: bool = True) -> NoiseModel:
    """Measure the noise of a clip: its level, axes and colour, and how it changes along time.

    Nothing is assumed to be white or steady. Exact repeats are found first and left out. High differences of the increments give
    levels, as in `noise_level`; local ones, less what the speed of the motion explains, give the level along time; the
    directions of the differences give the axes (Tyler's shape); Whittle's likelihood of the spectrum of each coordinate, with a term
    for the motion, gives the colour.

    Parameters
    ----------
    q : Motion or array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. Missing samples, NaN or four zeros, are left out.
    fps : float, hertz, default 1.0
        Frame rate, for spikes and evidence; a motion knows its own.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    NoiseModel
        For one series ``(frames, 4)`` there is one joint.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    noise_level : The level alone.
    smooth : With ``noise="measured"`` it smooths by this model.

    Notes
    -----
    Cost: linear in frames and joints, some 300 ns per sample and thread; colour and axes are measured on at most 8192 frames.
    Level along time needs 84 frames, colour 64.

    References
    ----------
    .. [1] D. E. Tyler, "A distribution-free M-estimator of multivariate scatter", Annals of Statistics 15(1), 1987.
    .. [2] P. Whittle, "Estimation and information in stationary time series", Arkiv för Matematik 2(5), 1953.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> still = np.tile([1.0, 0.0, 0.0, 0.0], (3000, 1))
    >>> noisy = qf.add_gaussian_noise(still, sigma=0.02, rng=1)
    >>> model = qf.noise_model(noisy, fps=120)
    >>> model.level.round(2), model.colour, model.steady
    (array([[0.02, 0.02, 0.02]]), 0.0, True)
    """
    if isinstance(q, Motion):
        if not scalar_first:
            raise TypeError("scalar_first applies to arrays only; a Motion has its own convention")
        motion = q
        q, fps = motion.rotations, motion.fps
    array = _validation.quaternions(q, "q", scalar_first=scalar_first)
    clip, _ = _validation.clip(array, "q")
    rate = _validation.number(fps, "fps", above=0)
    found = measure(clip, fps=rate)
    deviation = np.sqrt(found.variance)
    mean = float(np.sqrt(np.mean(found.variance))) if len(deviation) else 1.0
    return NoiseModel(
        found.level[:, None] * found.spread,
        found.axes,
        found.colour,
        deviation / mean,
        found.repeated,
        spikes(clip, radius="auto", fps=rate),
        found.evidence,
        rate,
    )


__all__ = ["NoiseModel", "noise_model"]
