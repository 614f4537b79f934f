"""A built-in walk: motion with a truth that everybody has.

Feet strike the ground heel first, the sole slaps down, rolls over the ball and swings on; the legs follow from the feet
and the pelvis, so that a foot on the ground stays where it is. Each strike stops the foot within a frame and sends a
shock through the body: what a filter must not round off.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from quatfilt import _validation
from quatfilt.evaluation._gait import CYCLE, STRIDE, Gait, Values, drift, turn
from quatfilt.evaluation._legs import ANKLE_TO_BALL, HIP, SHANK, THIGH, foot_path, leg, within_reach
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import EndSite, Skeleton

# Left is +x, up +y, forward +z. Bones of the arms point sideways in the rest pose.
_CENTRE = {
    "Hips": ("", (0.0, 0.0, 0.0)),
    "Spine": ("Hips", (0.0, 10.0, 0.0)),
    "Chest": ("Spine", (0.0, 22.0, 0.0)),
    "Neck": ("Chest", (0.0, 23.0, 0.0)),
    "Head": ("Neck", (0.0, 10.0, 1.0)),
}
_SIDE = {
    "Collar": ("Chest", (3.0, 18.0, 2.0)),
    "Shoulder": ("Collar", (14.0, 0.0, -2.0)),
    "Elbow": ("Shoulder", (29.0, 0.0, 0.0)),
    "Wrist": ("Elbow", (26.0, 0.0, 0.0)),
    "Hip": ("Hips", tuple(HIP)),
    "Knee": ("Hip", (0.0, -THIGH, 0.0)),
    "Ankle": ("Knee", (0.0, -SHANK, 0.0)),
    "Toe": ("Ankle", tuple(ANKLE_TO_BALL)),
}


_ENDS = {
    "Head": (0.0, 18.0, 0.0),
    "LeftWrist": (17.0, 0.0, 0.0),
    "RightWrist": (-17.0, 0.0, 0.0),
    "LeftToe": (0.0, 0.0, 6.0),
    "RightToe": (0.0, 0.0, 6.0),
}


def walk(*, seconds: float = 8.0, fps: float = 120.0, seed: int = 0) -> Motion:
    """Make a walk of 21 joints, with impacts of the feet.

    Parameters
    ----------
    seconds : float, seconds, default 8.0
        Length of the clip.
    fps : float, hertz, default 120.0
        Frame rate.
    seed : int, default 0
        Chooses the small differences from step to step; the same seed gives the same walk.

    Returns
    -------
    Motion
        Rotations in float64, lengths in centimetres, y up, walking towards +z.

    Raises
    ------
    ValueError
        If `seconds` is negative or `fps` is not above 0.

    Examples
    --------
    >>> from quatfilt.evaluation.synthetic import walk
    >>> walk(seconds=2).rotations.shape
    (240, 21, 4)
    """
    duration = _validation.number(seconds, "seconds", at_least=0)
    rate = _validation.number(fps, "fps", above=0)
    rng = np.random.default_rng(_validation.integer(seed, "seed", at_least=0))
    skeleton = _skeleton()
    time = np.arange(round(duration * rate)) / rate
    gait = Gait(time, time / CYCLE + 0.31 + 0.012 * drift(rng, time), rng)
    rotations, translation = _poses(gait, list(skeleton.names))
    return Motion(rotations, translation, fps=rate, skeleton=skeleton)


def _skeleton() -> Skeleton:
    bones = {name: (parent, offset) for name, (parent, offset) in _CENTRE.items()}
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        for name, (parent, offset) in _SIDE.items():
            above = parent if parent in _CENTRE else side + parent
            bones[side + name] = (above, (sign * offset[0], offset[1], offset[2]))
    names = list(bones)
    parents = [names.index(parent) if parent else -1 for parent, _ in bones.values()]
    ends = [EndSite(names.index(name), end) for name, end in _ENDS.items()]
    return Skeleton(names, parents, [offset for _, offset in bones.values()], end_sites=ends)


def _poses(gait: Gait, names: list[str]) -> tuple[Values, Values]:
    """Local rotations ``(frames, joints, 4)`` and the path of the root ``(frames, 3)``."""
    frames = len(gait.time)
    pelvis = turn("yxz", -6 * gait.wave(1, 0.05), 2 + 1.2 * gait.wave(2, 0.1), 3.5 * gait.wave(1, 0.2))
    root = np.stack(
        [
            2.2 * gait.wave(1, 0.25),
            92.4 - 1.9 * gait.wave(2, 0.01) - 0.45 * gait.shock(11, 0.05),
            STRIDE * gait.phase + 1.2 * gait.wave(2, 0.35),
        ],
        axis=1,
    )
    local = {"Hips": pelvis, **_trunk(gait), **_arm(gait, "Left", 1.0, 0.5), **_arm(gait, "Right", -1.0, 0.0)}
    if frames:
        feet = {"Left": (1.0, foot_path(gait, 1.0, 0.0)), "Right": (-1.0, foot_path(gait, -1.0, 0.5))}
        root = within_reach(
            root, [pelvis.apply(HIP * [sign, 1, 1]) - foot.ankle for sign, foot in feet.values()]
        )
        for side, (sign, foot) in feet.items():
            local |= leg(side, sign, foot, pelvis, root)
    rotations = np.zeros((frames, len(names), 4))
    for joint, name in enumerate(names if frames else []):
        rotations[:, joint] = local[name].as_quat(scalar_first=True)
        flips = np.sum(rotations[1:, joint] * rotations[:-1, joint], axis=-1) < 0
        rotations[1:, joint] *= np.cumprod(np.where(flips, -1.0, 1.0))[:, None]
    return rotations, root


def _trunk(gait: Gait) -> dict[str, Rotation]:
    """Chest and head turn against the pelvis, and nod at each strike."""
    still = np.zeros(len(gait.time))
    nod = gait.shock(9, 0.06)
    return {
        "Spine": turn("yxz", 3 * gait.wave(1, 0.05), 2 + nod, -2.5 * gait.wave(1, 0.2)),
        "Chest": turn("yxz", 7 * gait.wave(1, 0.07), 1 + 1.5 * nod, -2 * gait.wave(1, 0.22)),
        "Neck": turn("yxz", -3 * gait.wave(1, 0.09), 4 - 1.2 * gait.wave(2, 0.1), still),
        "Head": turn("yxz", -2 * gait.wave(1, 0.09), -6 + 2.5 * nod, 0.8 * gait.wave(1, 0.24)),
    }


def _arm(gait: Gait, side: str, sign: float, lag: float) -> dict[str, Rotation]:
    """Arms swing with the leg of the other side; `lag` is the phase at which that leg strikes."""
    still = np.zeros(len(gait.time))
    swing = gait.wave(1, lag + 0.02)
    shock = gait.shock(8, 0.07)
    return {
        side + "Collar": turn("zy", sign * (-4 + 1.5 * shock), -sign * 3 * swing),
        side + "Shoulder": turn("xz", 4 - 21 * swing, sign * (-72 + 2 * gait.wave(2, 0.1))),
        side + "Elbow": turn("yx", -sign * (24 + 13 * gait.wave(1, lag + 0.09) + 3 * shock), still),
        side + "Wrist": turn("yz", -sign * (5 + 4 * gait.wave(1, lag + 0.16)), sign * (3 * shock)),
    }


__all__ = ["walk"]
