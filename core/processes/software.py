"""Which software made a result."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version

NAMED = ("integument-server", "libigl", "numba", "numpy", "scipy")


@cache
def software_versions() -> dict[str, str]:
    """Distribution -> version, of all that decides about numbers."""
    return {name: version(name) for name in NAMED}
