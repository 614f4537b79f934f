"""Tests that draw examples: the same ones each time, unless pytest is given ``--hypothesis-seed``."""

import os

from hypothesis import settings

TIMES = int(os.environ.get("QUATFILT_TEST_EXAMPLES") or 1)
"""How many times as many examples are drawn as usual."""

USUAL = 40
"""Examples of a test that asks for no other number."""


def examples(count):
    """Ask for so many examples of a test, times `TIMES`."""
    return settings(max_examples=count * TIMES)


def pytest_configure(config):
    """Draw from the seed, if there is one; nothing is remembered from one run to the next."""
    seeded = config.getoption("--hypothesis-seed") is not None
    settings.register_profile(
        "quatfilt", deadline=None, derandomize=not seeded, database=None, max_examples=USUAL * TIMES
    )
    settings.load_profile("quatfilt")
