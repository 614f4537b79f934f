"""Full-body motion from trajectories of a few joints."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops, streams
from quatfilt._typing import Array
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton
from quatfilt.reconstruction.database import MotionDatabase
from quatfilt.reconstruction.database.body import Body
from quatfilt.reconstruction.reconstructor import trajectories, units
from quatfilt.reconstruction.reconstructor.examples import Examples
from quatfilt.reconstruction.reconstructor.latent import LatentModel, LatentTracker
from quatfilt.reconstruction.reconstructor.settings import ReconstructionModel, Settings
from quatfilt.reconstruction.reconstructor.stream import ReconstructionStream


class MotionReconstructor:
    """Reconstruct the motion of a whole body from trajectories of a few of its joints.

    In each frame, the examples in a database are found that are nearest to the last reconstructed poses and to the last
    ways of the control points; a local model of how they went on, and of how their control points differ from those that are seen,
    predicts the pose; and the most probable pose ``q`` is found
    by Levenberg and Marquardt's method from::

        ‖f(q; s) − c‖² / 2·control_noise² + Σ_d (q_d − μ_d)² / 2σ_d²

    where ``f`` are the control points of a pose of the skeleton ``s``, ``c`` their trajectories, and ``μ_d`` and ``σ_d`` what
    the model says of each degree of freedom, the root's step, height and turn among them.

    Parameters
    ----------
    database : MotionDatabase
        Motion of other people, or of the same one: what is not in it cannot be reconstructed.
    control_points : sequence of str
        Joints whose trajectories are given.
    skeleton : Skeleton or None, default None
        The performer's bone lengths; the joints of the database, in any order and unit. None: its mean skeleton.
    order : int, poses, default 3
        How many poses before are compared, and predicted from: the paper's m.
    neighbors : int, default 64
        How many examples a pose is learned from: the paper's K. Of a smaller database all are taken.
    model : {"local_regression", "local_pca", "local_pcr", "nearest", "mean_pose", "gplvm"}, default "local_regression"
        As in `predict_pose`; ``"gplvm"`` is `PoseGPLVM`, learned here of 500 poses, evenly spaced among those of the database, by GPy
        (``pip install 'quatfilt[gplvm]'``), which takes some ten seconds.
    control_noise : float or None, skeleton units, default None
        Standard deviation of each coordinate of a trajectory. None: a hundredth of the longest chain of bones from the
        root, about 1 cm for an adult.
    orientation_noise : float, radians, default 0.05
        Standard deviation of orientations, where they are given.
    control_scale : float or None, skeleton units, default None
        When examples are looked for, and when they are learned from, control points that are so far off count as much as poses a radian
        apart. Infinite: poses alone count, as in the paper; a wrong pose then finds examples as wrong, and is kept. None: six hundredths of
        the longest chain, about 7 cm.
    ridge : float, default 0.5
        As in `predict_pose`.

    Attributes
    ----------
    skeleton : Skeleton
        That of the result, in the order of joints and the unit of the database.
    control_points : tuple of str
        As given.
    energies_ : ndarray, shape (frames, 2), or None
        Of the last call of `reconstruct`: for each frame half the squared errors of the control points, and half the
        squared distance from the prediction, both in standard deviations. Trajectories that no body can follow, and motion
        that is not in the database, show by high numbers.

    Raises
    ------
    ImportError
        With ``model="gplvm"`` without GPy.
    ValueError, TypeError
        If there is no such joint, the skeleton has other joints, the database is too small, or an option has another type
        or range than stated; the message names it.

    See Also
    --------
    MotionDatabase : Where examples come from.

    Notes
    -----
    A frame costs a look at every fourth pose of the database, its control points first and its features where they leave a doubt, and a
    local model of `neighbors` examples. Where the database has a `graph`, candidates are the examples of the frame before, the
    poses after them and the neighbours of both, and all are looked at in the first frame, after a second, and where the
    examples become farther; what that misses are examples, and the result is another.
    With ``model="gplvm"`` frames go through Python, some milliseconds each: the prior is what the model says at the latent point
    that is most likely for the last pose, and the root's steps are those of the nearest examples; the first frame is the nearest
    example's. There is no search by control points, and `control_scale` counts for the first frame only.

    Besides the database, memory holds ``12·(1 + 2·points)`` bytes per pose.

    The ground is where the database has it: heights of the trajectories count from there. A quarter of a second at the
    start of each clip of the database serves as the past of examples only.

    References
    ----------
    .. [1] C. Mousas, P. Newbury, C.-N. Anagnostopoulos, "Data-driven motion reconstruction using local regression models",
       AIAI 2014.
    .. [2] J. Chai, J. K. Hodgins, "Performance animation from low-dimensional control signals", ACM Transactions on Graphics
       24, 2005.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> motion = walk(seconds=4)
    >>> db = qf.MotionDatabase.from_motions([motion], fps=motion.fps)
    >>> joints = ["LeftWrist", "RightWrist", "LeftAnkle", "RightAnkle"]
    >>> reconstructor = qf.MotionReconstructor(db, control_points=joints)
    >>> seen = motion.positions()[100:160, [motion.skeleton.index(name) for name in joints]]
    >>> result = reconstructor.reconstruct(seen, fps=motion.fps)
    >>> bool(qf.metrics.angle_error(motion.rotations[100:160], result.rotations) < 5)
    True
    """

    def __init__(
        self,
        database: MotionDatabase,
        *,
        control_points: Sequence[str],
        skeleton: Skeleton | None = None,
        order: int = 3,
        neighbors: int = 64,
        model: ReconstructionModel = "local_regression",
        control_noise: float | None = None,
        orientation_noise: float = 0.05,
        control_scale: float | None = None,
        ridge: float = 0.5,
    ) -> None:
        if not isinstance(database, MotionDatabase):
            raise TypeError(f"database: expected a MotionDatabase, got {type(database).__name__}")
        points = _validation.joint_names(control_points, "control_points", database.names)
        if skeleton is None:
            body = database.skeleton
        elif isinstance(skeleton, Skeleton):
            _, body = _body(database).arranged(skeleton, "skeleton")
        else:
            raise TypeError(f"skeleton: expected a Skeleton or None, got {type(skeleton).__name__}")
        self._examples = Examples(database, body, points)
        self._settings = Settings.checked(
            self._examples.reach,
            order=order,
            neighbors=neighbors,
            model=model,
            control_noise=control_noise,
            orientation_noise=orientation_noise,
            control_scale=control_scale,
            ridge=ridge,
        )
        before = self._settings.before(database.fps)
        longest = int(np.diff(database.starts).max(initial=0))
        if longest <= before:
            raise ValueError(
                f"database: expected a clip of more than {before} poses at {database.fps:g} fps, got none of more than {longest}"
            )
        gplvm = self._settings.model == "gplvm"
        self._latent = LatentModel(self._examples, self._settings) if gplvm else None
        self.energies_: NDArray[np.float64] | None = None

    @property
    def skeleton(self) -> Skeleton:
        """The body, in the order of joints and the unit of the database."""
        return self._examples.skeleton

    @property
    def control_points(self) -> tuple[str, ...]:
        """The joints whose trajectories are given."""
        return tuple(self._examples.database.names[point] for point in self._examples.points)

    def __repr__(self) -> str:
        return (
            f"MotionReconstructor({', '.join(self.control_points)}; {self._settings.model}, "
            f"{len(self._examples.database)} poses)"
        )

    def reconstruct(
        self,
        positions: ArrayLike,
        *,
        fps: float,
        orientations: ArrayLike | None = None,
        confidence: ArrayLike | None = None,
        initial: Motion | None = None,
    ) -> Motion:
        """Reconstruct a motion.

        Parameters
        ----------
        positions : array_like, shape (frames, points, 3), units of `skeleton`
            Where the control points are, in the order of `control_points`. A point of which a coordinate is NaN is not seen;
            beyond 1e9, coordinates are refused.
        fps : float, hertz
            Frame rate of the trajectories. They are interpolated to the rate of the database, and the poses back. At most a hundred
            times as high or as low as that.
        orientations : array_like or None, shape (frames, points, 4), default None
            Global rotations of the control points, unit quaternions, scalar first: what multiplies a joint's way from the
            rest pose to the world. NaN or zeros where they are not known.
        confidence : array_like or None, shape (frames,) or (frames, points), 0…1, default None
            The variance of a control point is divided by it; 0 and NaN: it is not seen.
        initial : Motion or None, default None
            What came before the first frame: its last poses. None: the past of the pose in the database that fits the
            first control points best, turned and moved on the ground to where it fits best.

        Returns
        -------
        Motion
            Of as many frames, at `fps`, in the dtype of `positions`. `energies_` tells how well each frame fits.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, type or range than stated, no frame has a control point, or the trajectories
            are in other units than the database; the message names it.

        Notes
        -----
        Frames without any control point are predicted. After a quarter of a second of them, the next control points are
        a new start.
        """
        seen, dtype = trajectories.checked(positions, orientations, confidence, len(self._examples.points))
        rate = _validation.resampling(
            _validation.number(fps, "fps", above=0), "fps", self._examples.database.fps, "the database"
        )
        if not (seen.position_weights > 0).any():
            raise ValueError("positions: expected at least one control point that is seen, got none")
        units.check(seen, self._examples)
        database = self._examples.database
        state = None if initial is None else self._state(initial)
        same = abs(rate / database.fps - 1) <= trajectories.SAME_RATE
        at_rate = seen if same else seen.resampled(rate, database.fps)
        targets = at_rate.targets(self._settings.control_noise, self._settings.orientation_noise)
        if self._latent is None:
            rotations, translation, energies = ops().track(*self._arguments(state), *targets)
        else:
            rotations, translation, energies = LatentTracker(self._latent, state).track(*targets)
        rotations = ops().continuous(rotations)
        if not same:
            times = np.arange(len(seen)) * (database.fps / rate)
            rotations, translation, energies = _at(times, rotations, translation, energies)
        self.energies_ = energies
        return Motion(
            rotations.astype(dtype), translation.astype(dtype), fps=rate, skeleton=self._examples.skeleton
        )

    def stream(self, *, initial: Motion | None = None) -> ReconstructionStream:
        """Reconstruct the motion of a live source, frame by frame, at the frame rate of the database.

        Parameters
        ----------
        initial : Motion or None, default None
            As in `reconstruct`.

        Returns
        -------
        ReconstructionStream
            Its poses are those of `reconstruct`.
        """
        state = None if initial is None else self._state(initial)
        if self._latent is None:
            tracker = streams().track_stream(*self._arguments(state))
        else:
            tracker = LatentTracker(self._latent, state)
        return ReconstructionStream(
            tracker,
            len(self._examples.points),
            (self._settings.control_noise, self._settings.orientation_noise),
        )

    def _arguments(self, state: Any) -> tuple[Any, ...]:
        examples = self._examples
        options, model = self._settings.kernel(examples)
        skeleton = examples.skeleton
        return (
            skeleton.parents,
            skeleton.offsets,
            examples.points,
            examples.database.up,
            examples.arrays,
            options,
            model,
            state,
        )

    def _state(self, motion: Any) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Return the last poses of a motion without their headings, the place of its root and its heading."""
        if not isinstance(motion, Motion):
            raise TypeError(f"initial: expected a Motion or None, got {type(motion).__name__}")
        database, order = self._examples.database, self._settings.order
        which, _ = _body(database).arranged(motion.skeleton, "initial")
        if not len(motion):
            raise ValueError("initial: expected at least one frame, got none")
        rotations = np.ascontiguousarray(motion.rotations[:, which], np.float64)
        times = len(motion) - 1 - np.arange(order)[::-1] * (motion.fps / database.fps)
        past = ops().slerp(rotations, np.arange(len(motion), dtype=np.float64), np.maximum(times, 0))
        place = np.asarray(motion.translation[-1], np.float64)
        if not (np.isfinite(past).all() and np.isfinite(place).all()):
            raise ValueError("initial: expected no missing samples among its last poses")
        headings, rest = ops().split_heading(np.ascontiguousarray(past[:, 0]), database.up)
        past[:, 0] = rest
        scale = motion.skeleton.centimetres_per_unit / database.skeleton.centimetres_per_unit
        return past, place * scale, float(headings[-1])


def _body(database: MotionDatabase) -> Body:
    return Body.of(database.skeleton, "the database")


def _at(times: Array, rotations: Array, translation: Array, energies: Array) -> tuple[Array, Array, Array]:
    """Return poses, places and energies at times in frames."""
    frames = np.arange(len(rotations), dtype=np.float64)
    times = np.minimum(times, frames[-1])
    columns = [np.interp(times, frames, column) for column in (*translation.T, *energies.T)]
    between = np.stack(columns, axis=1)
    return ops().slerp(rotations, frames, times), between[:, :3], between[:, 3:]


__all__ = ["MotionReconstructor"]
