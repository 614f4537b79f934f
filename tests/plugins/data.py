"""Real data for the tests: where they lie, and the rule that nothing is skipped where they exist."""

import os
from pathlib import Path

import pytest

DATA = Path(os.environ.get("QUATFILT_DATA") or Path(__file__).parents[3] / "shared" / "data")

NOT_HERE = "not on this platform"
"""How the reason of a skip begins that has nothing to do with data, and stands on every machine of its kind."""


@pytest.fixture(scope="session")
def data_dir():
    """Return the folder of real motion capture; without it, the test is skipped."""
    if not DATA.is_dir():
        pytest.skip(f"no data in {DATA}; set QUATFILT_DATA to the folder that holds them")
    return DATA


def _refuse(report):
    """Turn a skip into a failure where data exist: then every test has what it needs."""
    if not (DATA.is_dir() and report.skipped) or hasattr(report, "wasxfail"):
        return report
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    if not reason.removeprefix("Skipped: ").startswith(NOT_HERE):
        report.outcome = "failed"
        report.longrepr = f"skipped although data exist in {DATA}: {reason}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport():
    """Look at each test."""
    return _refuse((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report():
    """Look at each module: one may be skipped as a whole."""
    return _refuse((yield))
