"""Legs of a walk: the feet stand where they are put, and hips and knees follow from them."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from quatfilt.evaluation._gait import STRIDE, Gait, Values, pitched

SLAP, ROLL, LIFT = 0.06, 0.34, 0.62
"""Phases of the cycle at which the sole is down, the heel leaves the ground, and the ball does; the strike is 0."""

STRIKE_PITCH, LIFT_PITCH = math.radians(-22), math.radians(48)
"""Pitch of the foot at the strike, toes up, and when the ball leaves the ground, toes down."""

THIGH, SHANK = 43.0, 42.0
REACH = 84.5
"""Centimetres from hip to ankle that a leg may have: a knee that is quite straight would bend at infinite speed."""
ANKLE_TO_BALL = np.array([0.0, -6.5, 13.0])
ANKLE_TO_HEEL = np.array([0.0, -8.0, -4.5])
HIP = np.array([9.5, -4.0, 0.0])
ANKLE_HEIGHT = 8.0


@dataclass
class Foot:
    """How a foot moves in the world."""

    ankle: Values
    """Path, ``(frames, 3)``."""
    heading: Rotation
    pitch: Values
    toe_pitch: Values


def within_reach(root: Values, from_ankles: list[Values]) -> Values:
    """Lower the whole path of the root until both legs reach the ground, knees bent a little."""
    while max(np.linalg.norm(root + hip, axis=1).max() for hip in from_ankles) > REACH:
        root = root - np.array([0.0, 0.2, 0.0])
    return root


def leg(side: str, sign: float, foot: Foot, pelvis: Rotation, root: Values) -> dict[str, Rotation]:
    """Hip, knee, ankle and toe that put the foot where it belongs."""
    hip = root + pelvis.apply(HIP * [sign, 1, 1])
    thigh, shank = two_bones(hip, foot.ankle, pelvis.apply([0.0, 0.0, 1.0]))
    sole = foot.heading * pitched(foot.pitch)
    toe = foot.heading * pitched(foot.toe_pitch)
    return {
        side + "Hip": pelvis.inv() * thigh,
        side + "Knee": thigh.inv() * shank,
        side + "Ankle": shank.inv() * sole,
        side + "Toe": sole.inv() * toe,
    }


def two_bones(hip: Values, ankle: Values, forward: Values) -> tuple[Rotation, Rotation]:
    """Orientations of thigh and shank, with the knee bent `forward`."""
    line = ankle - hip
    distance = np.linalg.norm(line, axis=1)
    along = line / distance[:, None]
    across = forward - np.sum(forward * along, axis=1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    angle = np.arccos((THIGH**2 + distance**2 - SHANK**2) / (2 * THIGH * distance))[:, None]
    thigh = np.cos(angle) * along + np.sin(angle) * across
    shank = (line - THIGH * thigh) / SHANK
    axis = np.cross(across, along)
    return frame(axis, thigh), frame(axis, shank)


def frame(x: Values, down: Values) -> Rotation:
    """Orientation with the given x axis, and −y along `down`."""
    return Rotation.from_matrix(np.stack([x, -down, np.cross(x, -down)], axis=-1))


def foot_path(gait: Gait, sign: float, lag: float) -> Foot:
    """Motion of a foot: where it stands, and how it swings from there to where it stands next."""
    cycles = gait.phase - lag
    number = np.floor(cycles).astype(int)
    within = cycles - number
    first, count = int(number.min()), int(number.max() - number.min()) + 2
    holds = np.zeros((count, 3))
    holds[:, 0] = sign * (7.5 + gait.rng.normal(0, 0.5, count))
    holds[:, 2] = STRIDE * (first + np.arange(count) + lag) + 34.0 + gait.rng.normal(0, 1.0, count)
    heading = Rotation.from_euler("y", sign * math.radians(7))

    def ankle_on_ground(phase: Values, hold: Values) -> tuple[Values, Values, Values]:
        """Ankle, pitch of the foot and pitch of the toes while the foot at `hold` touches the ground."""
        slap = np.clip(phase / SLAP, 0, 1)
        roll = np.clip((phase - ROLL) / (LIFT - ROLL), 0, 1)
        on_heel = STRIKE_PITCH * (1 - slap**1.5)
        on_ball = LIFT_PITCH * roll**2.2
        pitch = np.where(phase < ROLL, on_heel, on_ball)
        pivot = np.where((phase < ROLL)[:, None], ANKLE_TO_HEEL, ANKLE_TO_BALL)
        flat = hold + np.array([0.0, ANKLE_HEIGHT, 0.0])
        moved = pivot - pitched(pitch).apply(pivot)
        return flat + heading.apply(moved), pitch, np.where(phase < ROLL, on_heel, 0.0)

    place = number - first
    ankle, pitch, toe_pitch = ankle_on_ground(within, holds[place])
    swinging = within > LIFT
    if swinging.any():
        share = ((within - LIFT) / (1 - LIFT))[swinging, None]
        here, there = holds[place][swinging], holds[place + 1][swinging]
        step = 1e-4
        lift = np.full(len(here), LIFT)
        start, lift_pitch, _ = ankle_on_ground(lift, here)
        before, pitch_before, _ = ankle_on_ground(lift - step, here)
        end, _, _ = ankle_on_ground(np.zeros(len(here)), there)
        # Velocities per swing: the start goes on as the foot left the ground, the end runs into it.
        velocity = (start - before) / step * (1 - LIFT)
        landing = np.array([0.0, -26.0, 28.0])
        clearance = np.array([0.0, 5.0, 0.0]) * (16 * share**2 * (1 - share) ** 2)
        ankle[swinging] = hermite(share, start, velocity, end, landing) + clearance
        speed = (lift_pitch - pitch_before) / step * (1 - LIFT)
        pitch[swinging] = hermite(
            share, lift_pitch[:, None], speed[:, None], np.full((1, 1), STRIKE_PITCH), np.full((1, 1), -0.15)
        )[:, 0]
        # The toes bend while the ball is down, and straighten out in the first part of the swing.
        straight = np.clip(share[:, 0] / 0.35, 0, 1)
        bend = LIFT_PITCH * (1 - straight**2 * (3 - 2 * straight))
        toe_pitch[swinging] = pitch[swinging] - bend
    return Foot(ankle, heading, pitch, toe_pitch)


def hermite(share: Values, start: Values, velocity: Values, end: Values, landing: Values) -> Values:
    """Cubic from `start` to `end`, with the velocities there, at the shares 0…1 of the way."""
    s, s2, s3 = share, share**2, share**3
    return np.asarray(
        (2 * s3 - 3 * s2 + 1) * start
        + (s3 - 2 * s2 + s) * velocity
        + (3 * s2 - 2 * s3) * end
        + (s3 - s2) * landing
    )
