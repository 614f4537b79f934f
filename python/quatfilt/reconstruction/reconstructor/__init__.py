"""Full-body motion from trajectories of a few joints."""

from quatfilt.reconstruction.reconstructor.reconstructor import MotionReconstructor
from quatfilt.reconstruction.reconstructor.stream import ReconstructedPose, ReconstructionStream

__all__ = ["MotionReconstructor", "ReconstructedPose", "ReconstructionStream"]
