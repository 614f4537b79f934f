"""Exact principal geodesic analysis of rotations."""

from typing import Literal, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.geodesics import _estimator

Objective = Literal["geodesic", "squared", "chordal"]

OBJECTIVES: tuple[Objective, ...] = ("geodesic", "squared", "chordal")

MOST_COMPONENTS = 64
"""Geodesics of each joint where their number is not given; after a dozen, roundings are left."""

MOST_BODY_COMPONENTS = 12
"""Geodesics of whole poses for each joint where their number is not given: four for each degree of freedom."""


class PrincipalGeodesicAnalysis(_estimator.Estimator):
    """Describe rotations by a few angles: parameters of geodesics through their mean, one after the other.

    With `x` the rotations seen from the mean, the first geodesic ``c_v(s) = exp(s·v)`` is the one that lies nearest to all
    samples. The next is fitted to what is left, ``π_v(x)⁻¹ x``, where `π_v` is the nearest point of the geodesic, and
    so on: ``q = mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …``. Nothing is linearised. Each joint is analysed by itself, or with
    ``body=True`` all joints together: then a geodesic turns each joint about an axis and at a speed of its own, and a
    pose has one parameter on it.

    Parameters
    ----------
    n_components : int or None, default None
        How many geodesics; None for as many as it takes until each joint's `R_k` is at most `tol`, and at most 64; with
        `body` until the body's is, and at most 12 for each joint.
    objective : {"geodesic", "squared", "chordal"}, default "geodesic"
        What the direction of a geodesic minimises: the mean of the distance `d`, of ``d²``, or of ``1 − cos d``, where `d`
        is the distance on S³, half the rotation angle. ``"geodesic"`` is the paper's eq. (9); its equations (11) and
        (13) belong to ``"chordal"``. With `body` the distance of poses is ``d = √(Σ_j d_j²)`` over the joints, and
        ``"chordal"`` the mean of ``Σ_j (1 − cos d_j)``.
    body : bool, default False
        Whether geodesics are those of whole poses.
    tol : float, radians of rotation, default 1e-9
        The mean angle that may be left where `n_components` is None.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Attributes
    ----------
    mean_ : ndarray, shape (joints, 4)
        Karcher means; NaN for a joint without samples.
    components_ : ndarray, shape (k, joints, 3)
        Unit axes `v_k`, in the frame of the mean; with `body` each `v_k` is a unit vector over all joints. The first sample whose parameter is at least 0.7 of the greatest has a
        positive one. ``(1, 0, 0)`` where nothing was left to be fitted.
    residuals_ : ndarray, shape (k, joints) or with `body` (k,), radians of rotation
        `R_k`: the mean angle that the first k geodesics leave; with `body` the mean distance ``2 √(Σ_j d_j²)``, which is
        ``√joints`` times the root mean square angle of a pose.
    descent_ : ndarray, shape (k, joints, steps) or with `body` (k, steps)
        The objective on the way to each axis, which never rises; NaN after the last step.

    Attributes have no joints axis where `fit` got one series ``(frames, 4)``.

    Raises
    ------
    ValueError, TypeError
        By `fit`, if an argument has another shape, type or range than stated, if a sample lies within 0.001 rad of half a
        turn from the mean, or if the mean is not unique; the message names it and the measured radius.

    See Also
    --------
    mean : The Karcher mean.

    Notes
    -----
    `fit` finds the lowest objective: from the second geodesic on by branch and bound among the samples' directions, where
    the mean distance has its minima; the first by Newton's method from many starts. Cost: some 50 passes over the samples
    for each geodesic. With `body` it descends from the tangent principal axes, which are never better, to the lowest
    minimum that they lead to: some 30 passes for each geodesic.

    Missing samples, NaN or four zeros, are no part of the fit, and NaN in what comes out.

    References
    ----------
    .. [1] S. Said, N. Courty, N. Le Bihan and S. J. Sangwine, "Exact principal geodesic analysis for data on SO(3)",
       EUSIPCO 2007.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.6, 0.8])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(1), rng=0)
    >>> pga = qf.PrincipalGeodesicAnalysis(n_components=2).fit(noisy)
    >>> pga.components_.shape, pga.transform(noisy).shape
    ((2, 3), (240, 2))
    >>> bool(np.abs(pga.components_[0] @ [0.0, 0.6, 0.8]) > 0.999)
    True
    >>> np.degrees(pga.residuals_).round(2)
    array([1.26, 0.77])
    """

    mean_: Array
    components_: Array
    residuals_: Array
    descent_: Array

    def __init__(
        self,
        n_components: int | None = None,
        *,
        objective: Objective = "geodesic",
        body: bool = False,
        tol: float = 1e-9,
        scalar_first: bool = True,
    ) -> None:
        self.n_components = n_components
        self.objective = objective
        self.body = body
        self.tol = tol
        self.scalar_first = scalar_first

    def fit(self, q: ArrayLike, y: None = None) -> Self:  # noqa: ARG002 - scikit-learn passes a target
        """Find the mean and the geodesics.

        Parameters
        ----------
        q : array_like, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions; signs do not matter. NaN or four zeros are missing samples.
        y : None
            Not used.

        Returns
        -------
        PrincipalGeodesicAnalysis
            Itself.

        Raises
        ------
        ValueError, TypeError
            As the class says.
        """
        components = 0
        if self.n_components is not None:
            components = _validation.integer(self.n_components, "n_components", at_least=1)
        objective = _validation.choice(self.objective, "objective", OBJECTIVES)
        tolerance = _validation.number(self.tol, "tol", at_least=0)
        body = _validation.switch(self.body, "body")
        rotations, shape = self._clip(q)
        means, radius, unique = ops().geodesic_centre(rotations)
        _validation.centred(radius, unique)
        means = means.astype(rotations.dtype)
        joints = shape[1:-1]
        most = MOST_BODY_COMPONENTS * len(means) if body else MOST_COMPONENTS
        analysed = ops().body_geodesics if body else ops().principal_geodesics
        directions, residuals, descents = analysed(rotations, means, components, most, objective, tolerance)
        self.mean_ = _validation.scalar_order(means, scalar_first=self.scalar_first).reshape(*joints, 4)
        self.components_ = directions.reshape(len(directions), *joints, 3)
        self.residuals_ = residuals.reshape(len(residuals), *self._apart(joints))
        self.descent_ = descents.reshape(len(descents), *self._apart(joints), descents.shape[-1])
        return self

    def transform(self, q: ArrayLike) -> Array:
        """Return the parameters of the rotations along the geodesics.

        Parameters
        ----------
        q : array_like, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions, of the joints that were fitted.

        Returns
        -------
        ndarray, shape (frames, joints, k) or (frames, k), radians of rotation
            Angles in [−π, π]; NaN for missing samples. With `body` one for each pose, in units of the length of all joints'
            rotation vectors together; NaN for a pose without samples.

        Raises
        ------
        ValueError, TypeError
            If `q` has another shape or type than stated, and before `fit`; the message names it.
        """
        rotations, shape = self._clip_as_fitted(q)
        return self._scores(rotations).reshape(
            len(rotations), *self._apart(shape[1:-1]), len(self.components_)
        )

    def fit_transform(self, q: ArrayLike, y: None = None) -> Array:
        """Fit the geodesics, and return the parameters along them.

        Parameters
        ----------
        q : array_like, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions.
        y : None
            Not used.

        Returns
        -------
        ndarray, shape (frames, joints, k) or (frames, k), radians of rotation
            As `transform`.

        Raises
        ------
        ValueError, TypeError
            As `fit`.
        """
        return self.fit(q, y).transform(q)

    def inverse_transform(self, scores: ArrayLike) -> Array:
        """Return the rotations of parameters, ``mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …``.

        Parameters
        ----------
        scores : array_like, shape (frames, joints, k) or (frames, k), radians of rotation
            As `transform` gives them: parameters along the first k geodesics; k may be less than was fitted.

        Returns
        -------
        ndarray, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions with ``w >= 0``; NaN where a parameter is.

        Raises
        ------
        ValueError, TypeError
            If `scores` has another shape or type than stated, and before `fit`; the message names it.
        """
        joints = self._fitted().shape[:-1]
        array = _validation.scores(scores, self._apart(joints), len(self.components_))
        shape = array.shape if self.body else (len(array), *(joints or (1,)), array.shape[-1])
        q = self._rotations(np.ascontiguousarray(array.reshape(shape)))
        return _validation.scalar_order(q.reshape(len(array), *joints, 4), scalar_first=self.scalar_first)

    def reconstruction_error(self, q: ArrayLike, k: int | None = None) -> Array:
        """Return the angle from each rotation to what the first k geodesics make of it.

        Parameters
        ----------
        q : array_like, shape (frames, joints, 4) or (frames, 4)
            Unit quaternions, of the joints that were fitted.
        k : int or None, default None
            How many geodesics, from 0 for the mean alone; None for all.

        Returns
        -------
        ndarray, shape (frames, joints) or (frames,), radians of rotation
            Angles in [0, π]; NaN for missing samples.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, type or range than stated, and before `fit`; the message names it.
        """
        rotations, shape = self._clip_as_fitted(q)
        most = len(self.components_)
        used = most if k is None else _validation.integer(k, "k", at_least=0, at_most=most)
        rebuilt = self._rotations(np.ascontiguousarray(self._scores(rotations)[..., :used]))
        angles = ops().geodesic_distance(rotations.reshape(-1, 4), rebuilt.reshape(-1, 4))
        return cast("Array", angles).reshape(shape[:-1])

    def _clip(self, q: ArrayLike) -> tuple[Array, tuple[int, ...]]:
        """Return checked rotations ``(frames, joints, 4)``, scalar first, and the shape that they came in."""
        array = _validation.quaternions(q, "rotations", scalar_first=self.scalar_first)
        rotations, _ = _validation.clip(array)
        return rotations, array.shape

    def _clip_as_fitted(self, q: ArrayLike) -> tuple[Array, tuple[int, ...]]:
        joints = self._fitted().shape[:-1]
        rotations, shape = self._clip(q)
        if shape[1:-1] != joints:
            expected = ", ".join(["frames", *map(str, joints), "4"])
            raise ValueError(f"rotations: expected shape ({expected}) as in fit, got {shape}")
        return rotations, shape

    def _model(self, like: Array) -> tuple[Array, Array]:
        """Return means ``(joints, 4)`` and axes ``(k, joints, 3)``, scalar first, in the dtype of an array."""
        means = np.roll(self.mean_, 0 if self.scalar_first else 1, axis=-1).reshape(-1, 4)
        axes = self.components_.reshape(len(self.components_), len(means), 3)
        return (
            np.require(means, like.dtype, ("C_CONTIGUOUS", "ALIGNED")),
            np.require(axes, like.dtype, ("C_CONTIGUOUS", "ALIGNED")),
        )

    def _apart(self, joints: tuple[int, ...]) -> tuple[int, ...]:
        """Return the shape of what joints have apart from each other: nothing if the body is analysed as a whole."""
        return () if self.body else joints

    def _scores(self, rotations: Array) -> Array:
        scores = ops().body_scores if self.body else ops().geodesic_scores
        return cast("Array", scores(rotations, *self._model(rotations)))

    def _rotations(self, scores: Array) -> Array:
        means, axes = self._model(scores)
        product = ops().body_product if self.body else ops().geodesic_product
        return cast("Array", product(scores, means, axes[: scores.shape[-1]]))

    def _fitted(self) -> Array:
        if not self.__sklearn_is_fitted__():
            raise ValueError("PrincipalGeodesicAnalysis: expected a call of fit before, got none")
        return self.mean_


__all__ = ["MOST_BODY_COMPONENTS", "MOST_COMPONENTS", "OBJECTIVES", "Objective", "PrincipalGeodesicAnalysis"]
