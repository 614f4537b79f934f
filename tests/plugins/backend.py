"""Tests that take `backend` run once with the NumPy reference and once with the Rust core."""

import pytest
import quatfilt as qf
from quatfilt import _backend, _core, _reference

CORE_IS_COMPLETE = set(_reference.__all__) <= set(dir(_core))
"""The contract's test of the two surfaces fails as long as this does not hold."""


@pytest.fixture(scope="module", params=["numpy", "rust"] if CORE_IS_COMPLETE else ["numpy"])
def backend(request):
    """Switch to a backend and return its functions. Per module, because Hypothesis shares fixtures between examples."""
    with qf.use_backend(request.param):
        yield _backend.ops()
