"""Compiled kernels on disk are code that all later processes run, so no child writes any: what it compiles it keeps."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn


class KernelNotKeptError(Exception):
    """The kernel is not on disk, and now is no time to compile it."""


def keep_kernels_in_memory() -> None:
    """For this process; numba, if it is loaded, goes on reading its cache. It would end a job at a cache it cannot write to."""
    caching = sys.modules.get("numba.core.caching")
    if caching is not None:
        caching.Cache.save_overload = _keep_nothing


@contextmanager
def kept_kernels_only() -> Iterator[None]:
    """Within, kernels come from memory or disk; one that would have to be compiled raises KernelNotKeptError."""
    dispatcher = sys.modules.get("numba.core.dispatcher")
    if dispatcher is None:
        yield
        return
    compiler = dispatcher._FunctionCompiler
    compile_now = compiler.compile
    compiler.compile = _compile_nothing
    try:
        yield
    finally:
        compiler.compile = compile_now


def _keep_nothing(_cache: object, _signature: object, _data: object) -> None:
    """In place of numba.core.caching.Cache.save_overload."""


def _compile_nothing(_compiler: object, _arguments: object, _result: object) -> NoReturn:
    """In place of numba.core.dispatcher._FunctionCompiler.compile."""
    raise KernelNotKeptError
