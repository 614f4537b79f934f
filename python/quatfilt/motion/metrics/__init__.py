"""How close a motion is to another, and how smooth, fast and firmly grounded it is.

Angles are rotation angles in degrees, lengths centimetres, levels decibels. Missing samples are left out. `per` says
over what the mean is taken: the whole clip, or only the frames of each joint; ``"sample"`` takes none.
"""

from quatfilt.motion.metrics.error import angle_error, mse, position_error, psnr
from quatfilt.motion.metrics.feet import foot_contacts, foot_scale, foot_slide
from quatfilt.motion.metrics.speed import jerk, peak_velocity_kept

__all__ = [
    "angle_error",
    "foot_contacts",
    "foot_scale",
    "foot_slide",
    "jerk",
    "mse",
    "peak_velocity_kept",
    "position_error",
    "psnr",
]
