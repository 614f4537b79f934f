"""Spikes: samples that leave the motion and come back at once; joints that change places."""

from quatfilt._reference.filters.despike.despike import find_spikes
from quatfilt._reference.filters.despike.swaps import find_swaps

__all__ = ["find_spikes", "find_swaps"]
