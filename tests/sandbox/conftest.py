"""One warm nursery for the tests that only need a child."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.limits import GIB, MIB, Limits
from sandbox.nursery import Nursery


@pytest.fixture(scope="session")
def nursery() -> Iterator[Nursery]:
    nursery = Nursery(preload=("tests.sandbox.targets",))
    nursery.start()
    yield nursery
    nursery.stop()


@pytest.fixture
def limits() -> Limits:
    """With forks: what ends, counts and reaps a family must hold where the kernel cannot forbid families."""
    return Limits(memory_bytes=GIB, cpu_s=20, file_bytes=32 * MIB, wall_s=20, forks=True)


@pytest.fixture
def scratch(tmp_path: Path) -> Path:
    folder = tmp_path / "scratch"
    folder.mkdir()
    return folder
