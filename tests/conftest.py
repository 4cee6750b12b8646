"""Fixtures every test may ask for; nothing is started before one does."""

pytest_plugins = ("tests.postgres", "tests.valkey")
