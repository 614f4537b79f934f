"""Fixtures for all tests."""

pytest_plugins = ["plugins.backend", "plugins.data", "plugins.properties"]
