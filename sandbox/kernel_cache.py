"""Compiled kernels on disk are code that all later processes run, so no child writes any: what it compiles it keeps."""

from __future__ import annotations

import sys


def keep_kernels_in_memory() -> None:
    """For this process; numba, if it is loaded, goes on reading its cache. It would end a job at a cache it cannot write to."""
    caching = sys.modules.get("numba.core.caching")
    if caching is not None:
        caching.Cache.save_overload = _keep_nothing


def _keep_nothing(_cache: object, _signature: object, _data: object) -> None:
    """In place of numba.core.caching.Cache.save_overload."""
