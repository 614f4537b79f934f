"""Ctrl-C: who hears it."""

import signal

import pytest


@pytest.fixture
def ctrl_c():
    """Processes that a test starts hear Ctrl-C, also where a shell started the tests in the background and they do not."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
