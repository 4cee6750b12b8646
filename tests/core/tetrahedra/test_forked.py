"""Whatever a mesher does to its process, the caller lives and says what happened."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from core.errors import InputError, LimitError, StateError
from core.tetrahedra.forked import Filling, MesherMissing, run_forked

FILLING = Filling(np.eye(4, 3), np.arange(4, dtype=np.int32).reshape(1, 4), np.zeros(1, dtype=np.int32))


def test_what_it_makes_comes_back():
    made = run_forked("a mesher", lambda: FILLING)
    np.testing.assert_array_equal(made.nodes, FILLING.nodes)
    assert made.tetrahedra.dtype == np.int32


def crash() -> Filling:
    os.kill(os.getpid(), signal.SIGKILL)
    return FILLING


def refuse() -> Filling:
    raise RuntimeError("facets cross")


def lack_memory() -> Filling:
    raise MemoryError


def lack_memory_as_tetgen() -> Filling:
    raise RuntimeError("Out of memory")


def miss() -> Filling:
    raise MesherMissing("libGLU.so.1 is not there")


@pytest.mark.parametrize(
    ("work", "error", "code", "words"),
    [
        (crash, InputError, "tetrahedra.refused", "a mesher crashed with signal 9"),
        (refuse, InputError, "tetrahedra.refused", "a mesher refuses the surfaces; it said: facets cross"),
        (lack_memory, LimitError, "limit.memory", "a mesher needs more memory"),
        (lack_memory_as_tetgen, LimitError, "limit.memory", "a mesher needs more memory"),
        (miss, StateError, "tetrahedra.no_mesher", "libGLU.so.1 is not there"),
    ],
)
def test_its_end_is_told_by_name(work, error, code, words):
    with pytest.raises(error, match=words) as raised:
        run_forked("a mesher", work)
    assert raised.value.code == code
