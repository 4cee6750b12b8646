"""What jobs are expected to need, held to what they needed (`python -m benchmarks.expectations`)."""

from __future__ import annotations

import pytest

from core.schema.expectation import FAST_S, UNKNOWN, Expectation, JobQueue, expect
from core.schema.processes import PROCESSES
from core.schema.shells import ShellsInputs

TWO, SIX = {"layers": [{}] * 2}, {"layers": [{}] * 6}
MEASURED = [  # process, inputs, faces, peak MB, processor seconds; on the body
    ("validate", {}, 26_756, 356, 0.9),
    ("validate", {}, 107_024, 364, 1.5),
    ("validate", {}, 428_096, 391, 4.5),
    ("shells", TWO, 26_756, 408, 7.9),
    ("shells", TWO, 107_024, 460, 21.2),
    ("shells", SIX, 26_756, 663, 26.7),
    ("shells", SIX, 107_024, 771, 63.0),
    ("ears", TWO, 26_756, 412, 9.6),
    ("ears", TWO, 107_024, 466, 23.2),
    ("heal", {}, 26_756, 191, 0.6),
    ("heal", {}, 107_024, 230, 2.2),
    ("decimate", {}, 26_756, 287, 1.7),
    ("decimate", {}, 107_024, 298, 3.7),
    ("smooth", {}, 26_756, 379, 2.8),
    ("smooth", {}, 107_024, 399, 6.4),
    ("tetrahedralize", {}, 26_756 * 3, 700, 11.2),
    ("tetrahedralize", {}, 107_024 * 3, 1467, 52.7),
    ("tetrahedralize", {"mesher": "gmsh"}, 26_756 * 3, 719, 16.7),
    ("shells", TWO, 428_096, 1079, 85.3),
    ("shells", SIX, 428_096, 2713, 254.1),
    ("ears", TWO, 428_096, 4432, 101.4),
    ("heal", {}, 428_096, 417, 9.2),
    ("decimate", {}, 428_096, 416, 11.9),
]


@pytest.mark.parametrize(("process", "inputs", "faces", "peak_mb", "cpu_s"), MEASURED)
def test_what_was_measured_fits_and_not_by_far(
    process: str, inputs: dict[str, object], faces: int, peak_mb: float, cpu_s: float
) -> None:
    expected = expect(process, inputs, faces)
    assert 1.0 <= expected.memory_bytes / (peak_mb * 1e6) <= 2.0
    assert expected.cpu_s is not None
    assert 0.7 <= expected.cpu_s / cpu_s <= 2.0


@pytest.mark.parametrize("process", PROCESSES)
def test_every_process_is_known_and_more_faces_need_more(process: str) -> None:
    few, many = expect(process, {}, 10_000), expect(process, {}, 5_000_000)
    assert UNKNOWN not in (few, many)
    assert few.memory_bytes < many.memory_bytes
    assert (few.queue, many.queue) == (JobQueue.FAST, JobQueue.HEAVY)


def test_the_defaults_of_a_stored_request_count() -> None:
    stored = ShellsInputs.model_validate({"skin": {"href": f"/v1/meshes/{'0' * 36}"}}).model_dump(mode="json")
    assert expect("shells", stored, 26_756) == expect("shells", TWO, 26_756)
    more = expect("shells", SIX, 26_756)
    assert more.memory_bytes > expect("shells", TWO, 26_756).memory_bytes


def test_the_slower_mesher_takes_longer_alone_and_in_the_chain() -> None:
    for process, asked in (
        ("tetrahedralize", lambda mesher: {"mesher": mesher}),
        ("prepare", lambda mesher: {"tetrahedra": {"mesher": mesher}}),
    ):
        tetgen, gmsh = (expect(process, asked(mesher), 107_024).cpu_s for mesher in ("tetgen", "gmsh"))
        assert tetgen is not None
        assert gmsh is not None
        assert gmsh > tetgen + 5.0


def test_smoothing_without_an_early_end_takes_its_time() -> None:
    by_quality = expect("smooth", {"stop": "quality", "iterations": 1000}, 26_756)
    to_the_end = expect("smooth", {"stop": "iterations", "iterations": 1000}, 26_756)
    assert (by_quality.queue, to_the_end.queue) == (JobQueue.FAST, JobQueue.HEAVY)
    assert by_quality == expect("smooth", {}, 26_756)


def test_what_nobody_knows_is_heavy() -> None:
    assert expect("of a later version", {}, 3) == UNKNOWN
    assert UNKNOWN.queue is JobQueue.HEAVY
    assert Expectation(1, FAST_S).queue is JobQueue.FAST
    assert Expectation(1, FAST_S + 0.1).queue is JobQueue.HEAVY
