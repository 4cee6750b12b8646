"""Everything a fuzzer ever found, and every seed, through its target again: within bounded memory, without another exception."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from tests.fuzz.seeds import corpus, seeds
from tests.fuzz.targets import TARGETS

MEMORY_BYTES = 1 << 30  # more than this process has already
KEPT = [(target, path) for target in TARGETS for path in corpus(target)]


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    """A MemoryError fails the test: damage must be seen before memory is asked for."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (psutil.Process().memory_info().vms + MEMORY_BYTES, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.timeout(30)
@pytest.mark.parametrize(("target", "path"), KEPT, ids=[f"{target}-{path.name}" for target, path in KEPT])
def test_what_was_found_once_does_no_harm(target: str, path: Path) -> None:
    TARGETS[target](path.read_bytes())


@pytest.mark.timeout(60)
@pytest.mark.parametrize("target", TARGETS)
def test_good_inputs_and_their_beginnings_do_no_harm(target: str) -> None:
    for seed in seeds(target):
        for length in {len(seed), len(seed) - 1, len(seed) // 2, len(seed) // 7, 1, 0}:
            TARGETS[target](seed[:length])


def test_the_corpus_belongs_to_targets_and_is_small() -> None:
    folders = {path.name for path in (Path(__file__).parent / "corpus").iterdir()}
    assert folders <= set(TARGETS)
    assert all(path.stat().st_size <= 8192 for _, path in KEPT)
