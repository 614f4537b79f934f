"""Tests that draw examples: the same ones each time, unless pytest is given ``--hypothesis-seed``."""

import os

from hypothesis import settings

TIMES = float(os.environ.get("QUATFILT_TEST_EXAMPLES") or 1)
"""How many times as many examples are drawn as usual; below 1, fewer."""

USUAL = 40
"""Examples of a test that asks for no other number."""


def examples(count):
    """Ask for so many examples of a test, times `TIMES`."""
    return settings(max_examples=times(count))


def times(count):
    """So many examples, times `TIMES`; one at least."""
    return max(1, round(count * TIMES))


def pytest_configure(config):
    """Draw from the seed, if there is one; nothing is remembered from one run to the next."""
    seeded = config.getoption("--hypothesis-seed") is not None
    settings.register_profile(
        "quatfilt", deadline=None, derandomize=not seeded, database=None, max_examples=times(USUAL)
    )
    settings.load_profile("quatfilt")
