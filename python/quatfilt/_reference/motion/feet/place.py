"""Legs that bring feet where they belong: damped least squares on the root, the hips and the knees of each frame.

S. R. Buss, *Introduction to Inverse Kinematics with Jacobian Transpose, Pseudoinverse and Damped Least Squares Methods*, 2004.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import (
    between,
    conjugate,
    exp,
    log_short,
    multiply,
    norm,
    normalize,
)

STEPS = 3
"""How often the linear equations are set up and solved."""

DAMPING, DAMPING_OF_LEGS = 0.2, 0.3
"""`λ`, lengths over leg length: with the root, and with the legs alone."""

ROOT_TRANSLATION, ROOT_ROTATION, KNEE = 0.3, 0.5, 0.5
"""How readily these move, with 1 for the hips."""

ANKLE = 0.5
"""Part of the change of an ankle that is applied when feet are kept, not locked."""

MOST_ANKLE = np.radians(3.0)
"""Radians: an ankle is turned by no more where feet are kept, not locked."""

LEAST_HINGE = 1e-12
"""Sum of squares of a knee's rotation steps, in rad², below which it has no axis to bend about."""


@dataclass
class Chain:
    """A leg in all frames."""

    to_hip: Reals
    """Rotation from the pelvis' frame to that of the hip's parent, `(frames, 4)`, and below alike from hip to knee and ankle."""
    to_knee: Reals
    to_ankle: Reals
    hip_at: Reals
    """Position of the hip in the pelvis' frame, `(frames, 3)`; of the knee in the hip's, of the ankle in the knee's, of the toe in the ankle's."""
    knee_at: Reals
    ankle_at: Reals
    toe_at: Reals
    hip: Reals
    """Rotation of the joint in its parent, `(frames, 4)`."""
    knee: Reals
    ankle: Reals
    hinge: Reals
    """Axis of the knee in the shank's frame, `(3,)`."""


def place_feet(
    rotations: Reals,
    translation: Reals,
    local: Reals,
    parents: NDArray[np.int64],
    pelvis: int,
    legs: NDArray[np.int64],
    lengths: Reals,
    displacements: Reals,
    root: bool,  # noqa: FBT001
    lock: bool,  # noqa: FBT001
) -> tuple[Reals, Reals]:
    """Move feet by rotations of hips, knees and ankles, and by the pelvis.

    With the displacements `d` of the ankles that are still missing, in leg lengths, each of three steps solves

        `J = ∂(ankles)/∂(parameters) · diag(c)`,    `θ = diag(c) Jᵀ (J Jᵀ + λ² I)⁻¹ d`

    over the translation of the body, the rotation of the pelvis, the rotations of the hips and the angles of the knees, with the column scales `c`. All ankles are
    in each frame's equations, those that are not to move with `d = 0`. Then each ankle is turned: its goal is the orientation that the
    foot had, turned by the least rotation that brings the line from ankle to toe where their displacements ask for; half of the change is
    applied, or all of it where feet are locked. A frame without displacements stays as it is.

    Parameters
    ----------
    rotations : array (frames, joints, 4)
        Rotations relative to the parents.
    translation : array (frames, 3)
        Positions of joint 0.
    local : array (1 or frames, joints, 3)
        Positions of the joints in their parents' frames; one row where they do not change.
    parents : array (joints,) of int64
        Index of each joint's parent, −1 for a root.
    pelvis : int
        The joint that all legs hang on; joint 0 or below it.
    legs : array (legs, 4) of int64
        Hip, knee, ankle and toe of each leg; the toe is the ankle where there is none.
    lengths : array (legs,)
        Lengths of the legs.
    displacements : array (frames, legs, 2, 3)
        Of ankle and toe, in the unit of the positions.
    root : bool
        Whether the body and the pelvis may move, or the legs alone.
    lock : bool
        Whether ankles are turned by all that is asked for.

    Returns
    -------
    rotations : array (frames, joints, 4)
    translation : array (frames, 3)
    """
    result, moved = rotations.copy(), translation.copy()
    q = rotations.astype(np.float64)
    x = np.broadcast_to(local.astype(np.float64), (*rotations.shape[:2], 3))
    above, at = pose_of(q, x, translation.astype(np.float64), parents, pelvis)
    chains = [chain(q, x, parents, pelvis, leg) for leg in legs]
    asked = np.abs(displacements).max(axis=(1, 2, 3), initial=0.0) > 0
    whole = np.isfinite(np.concatenate([above, at, q[:, pelvis]], axis=1)).all(axis=1)
    known = np.stack([there(one) & whole for one in chains], axis=1)
    frames = np.flatnonzero(asked & known.any(axis=1))
    if len(frames) == 0:
        return result, moved
    known, above, at = known[frames], above[frames], at[frames]
    old = [of_frames(one, frames) for one in chains]
    new = [of_frames(one, frames) for one in chains]
    wanted = displacements[frames].astype(np.float64)
    before = multiply(above, q[frames, pelvis])
    turned, shifted = solved(new, known, lengths, before, at, wanted[:, :, 0], root)
    for i, leg in enumerate(legs):
        ankle = turned_ankle(old[i], new[i], before, turned, wanted[:, i], lock=lock)
        for joint, value in zip(leg[:3], (new[i].hip, new[i].knee, ankle), strict=True):
            result[frames[known[:, i]], joint] = value[known[:, i]]
    if root:
        result[frames, pelvis] = multiply(conjugate(above), turned)
        moved[frames] += (shifted - at).astype(moved.dtype)
    return result, moved


def pose_of(
    q: Reals, x: Reals, translation: Reals, parents: NDArray[np.int64], joint: int
) -> tuple[Reals, Reals]:
    """Return the orientation of a joint's parent and the position of the joint in the world; `(frames, 4)`, `(frames, 3)`."""
    if joint == 0:
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(q), 1)), translation
    rotation, position = between_joints(q, x, parents, 0, joint)
    return multiply(q[:, 0], rotation), translation + rotate(q[:, 0], position)


def chain(q: Reals, x: Reals, parents: NDArray[np.int64], pelvis: int, leg: NDArray[np.int64]) -> Chain:
    """Return a leg as three bones, whatever joints lie between."""
    hip, knee, ankle, toe = (int(joint) for joint in leg)
    to_hip, hip_at = between_joints(q, x, parents, pelvis, hip)
    to_knee, knee_at = between_joints(q, x, parents, hip, knee)
    to_ankle, ankle_at = between_joints(q, x, parents, knee, ankle)
    toe_at = np.zeros_like(ankle_at) if toe == ankle else between_joints(q, x, parents, ankle, toe)[1]
    return Chain(
        *(to_hip, to_knee, to_ankle, hip_at, knee_at, ankle_at, toe_at),
        *(q[:, hip], q[:, knee], q[:, ankle], hinge(q[:, knee])),
    )


def between_joints(
    q: Reals, x: Reals, parents: NDArray[np.int64], above: int, below: int
) -> tuple[Reals, Reals]:
    """Return the rotation from a joint's frame to that of the parent of one below it, and the position of the latter in the former."""
    joint = int(parents[below])
    rotation, position = np.tile([1.0, 0.0, 0.0, 0.0], (len(q), 1)), x[:, below]
    while joint != above:
        rotation = multiply(q[:, joint], rotation)
        position = x[:, joint] + rotate(q[:, joint], position)
        joint = int(parents[joint])
    return rotation, position


def hinge(knee: Reals) -> Reals:
    """Return the axis about which a knee moves: the main axis of its rotation steps in the frame of the shank; zeros without one."""
    steps = 2 * log_short(between(knee[:-1], knee[1:]))
    steps = steps[np.isfinite(steps).all(axis=1)]
    squares = steps.T @ steps
    if np.trace(squares) < LEAST_HINGE:
        return np.zeros(3)
    return np.asarray(np.linalg.eigh(squares)[1][:, -1])


def there(one: Chain) -> Mask:
    """Tell in which frames a leg is known."""
    parts = (one.to_hip, one.to_knee, one.to_ankle, one.hip_at, one.knee_at, one.ankle_at, one.toe_at)
    whole = np.concatenate([*parts, one.hip, one.knee, one.ankle], axis=1)
    known: Mask = np.isfinite(whole).all(axis=1)
    return known


def of_frames(one: Chain, frames: NDArray[np.intp]) -> Chain:
    """Return a leg in some frames."""
    values = {name: value if name == "hinge" else value[frames] for name, value in vars(one).items()}
    return Chain(**values)


def solved(
    legs: list[Chain],
    known: Mask,
    lengths: Reals,
    turned: Reals,
    shifted: Reals,
    wanted: Reals,
    root: bool,  # noqa: FBT001
) -> tuple[Reals, Reals]:
    """Solve for the pelvis, the hips and the knees; the legs are changed in place, orientation and position of the pelvis returned.

    Parameters
    ----------
    legs : list of Chain
    known : array (frames, legs)
        Legs that take part.
    lengths : array (legs,)
    turned, shifted : array (frames, 4), (frames, 3)
        Orientation and position of the pelvis in the world.
    wanted : array (frames, legs, 3)
        Displacements of the ankles.
    root : bool
    """
    frames, count = known.shape
    leg_length = float(np.mean(lengths))
    turned, shifted = turned.copy(), shifted.copy()
    goals = [ankle_of(leg, turned, shifted) + wanted[:, i] for i, leg in enumerate(legs)]
    damping = DAMPING if root else DAMPING_OF_LEGS
    by_root, by_turn = (ROOT_TRANSLATION**2, ROOT_ROTATION**2) if root else (0.0, 0.0)
    for _ in range(STEPS):
        places = [places_of(leg, turned, shifted) for leg in legs]
        from_root = np.stack([(place.ankle - shifted) / leg_length for place in places], axis=1)
        from_hip = np.stack([(place.ankle - place.hip) / leg_length for place in places], axis=1)
        from_knee = np.stack(
            [np.cross(place.hinge, (place.ankle - place.knee) / leg_length) for place in places], axis=1
        )
        error = np.stack([(goals[i] - places[i].ankle) / leg_length for i in range(count)], axis=1)
        part = known[..., None].astype(np.float64)
        from_root, from_hip, from_knee, error = (
            np.where(part > 0, values, 0.0) for values in (from_root, from_hip, from_knee, error)
        )
        matrix = np.zeros((frames, count, 3, count, 3))
        for i in range(count):
            for j in range(count):
                both = part[:, i, :, None] * part[:, j, :, None]
                matrix[:, i, :, j] = both * by_root * np.eye(3) + by_turn * crossed(
                    from_root[:, i], from_root[:, j]
                )
            matrix[:, i, :, i] += crossed(from_hip[:, i], from_hip[:, i]) + damping**2 * np.eye(3)
            matrix[:, i, :, i] += KNEE**2 * from_knee[:, i, :, None] * from_knee[:, i, None, :]
        force = np.linalg.solve(
            matrix.reshape(frames, 3 * count, 3 * count), error.reshape(frames, 3 * count, 1)
        ).reshape(frames, count, 3)
        for i, (leg, place) in enumerate(zip(legs, places, strict=True)):
            by_hip = np.cross(from_hip[:, i], force[:, i])
            leg.hip = normalize(multiply(leg.hip, exp(rotate(conjugate(place.hip_rotation), by_hip) / 2)))
            angle = KNEE**2 * np.sum(from_knee[:, i] * force[:, i], axis=1)
            leg.knee = normalize(multiply(leg.knee, exp(leg.hinge * angle[:, None] / 2)))
        if root:
            by_root_turn = by_turn * np.cross(from_root, force).sum(axis=1)
            shifted = shifted + by_root * leg_length * (part * force).sum(axis=1)
            turned = normalize(multiply(turned, exp(rotate(conjugate(turned), by_root_turn) / 2)))
    return turned, shifted


def crossed(r: Reals, s: Reals) -> Reals:
    """Return `[r]ₓ [s]ₓᵀ = (r·s) I − s rᵀ` for vectors `(frames, 3)`."""
    inner = np.sum(r * s, axis=1)[:, None, None]
    return np.asarray(inner * np.eye(3) - s[:, :, None] * r[:, None, :])


@dataclass
class Places:
    """Where a leg is in the world."""

    hip: Reals
    knee: Reals
    ankle: Reals
    hip_rotation: Reals
    hinge: Reals
    shank: Reals
    """Rotation of the knee, `(frames, 4)`."""


def places_of(leg: Chain, turned: Reals, shifted: Reals) -> Places:
    """Return the positions `(frames, 3)` of a leg's joints from the root's rotation and position."""
    hip = shifted + rotate(turned, leg.hip_at)
    thigh = multiply(multiply(turned, leg.to_hip), leg.hip)
    knee = hip + rotate(thigh, leg.knee_at)
    shank = multiply(multiply(thigh, leg.to_knee), leg.knee)
    ankle = knee + rotate(shank, leg.ankle_at)
    return Places(hip, knee, ankle, thigh, rotate(shank, np.broadcast_to(leg.hinge, knee.shape)), shank)


def ankle_of(leg: Chain, turned: Reals, shifted: Reals) -> Reals:
    """Return the position of a leg's ankle."""
    return places_of(leg, turned, shifted).ankle


def turned_ankle(
    old: Chain, new: Chain, old_root: Reals, new_root: Reals, wanted: Reals, *, lock: bool
) -> Reals:
    """Return the rotation of an ankle in the shank that turns the foot to its goal, or, where feet are kept, by half as much and no more than `MOST_ANKLE`; `(frames, 4)`."""
    origin = np.zeros((len(old_root), 3))
    before = multiply(places_of(old, old_root, origin).shank, old.to_ankle)
    after = multiply(places_of(new, new_root, origin).shank, new.to_ankle)
    foot = multiply(before, old.ankle)
    sole = rotate(foot, old.toe_at)
    goal = multiply(least_rotation(sole, sole + wanted[:, 1] - wanted[:, 0]), foot)
    change = log_short(between(old.ankle, between(after, goal)))
    if not lock:
        change = ANKLE * change
        angle = 2 * norm(change)[:, None]
        change = change * np.minimum(1, MOST_ANKLE / np.where(angle > MOST_ANKLE, angle, MOST_ANKLE))
    return normalize(multiply(old.ankle, exp(change)))


def least_rotation(u: Reals, v: Reals) -> Reals:
    """Return the least rotation from the direction of one vector to that of another; none where one has no length, `(frames, 4)`."""
    product = norm(u) * norm(v)
    cosine = np.sum(u * v, axis=-1)
    q = np.concatenate([(product + cosine)[:, None], np.cross(u, v)], axis=1)
    none = norm(q) <= 1e-9 * product
    q[none | (product == 0)] = [1.0, 0.0, 0.0, 0.0]
    return normalize(q)
