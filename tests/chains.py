"""Chains of filters for the tests: every method that `denoise` knows, with what it cannot do without."""

from quatfilt.methods import AUTO, METHODS

NEEDED = {
    "butterworth": {"cutoff": 0.1},
    "gaussian": {"sigma": 2.0},
    "orientation_filter": {"mask": [1, 2, 3, 2, 1]},
    "savgol": {"window_length": 9},
}
"""Values for options that have no default."""

SINGLE = {name: {name: NEEDED[name]} if name in NEEDED else {} for name in METHODS if name != AUTO}
"""From each method to the keywords that `denoise` needs for it."""
