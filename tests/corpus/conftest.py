"""Hypothesis without a clock: kernels compile inside a test, and the machine is shared."""

from hypothesis import settings

settings.register_profile("core", deadline=None)
settings.load_profile("core")
