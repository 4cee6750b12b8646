"""Jobs are sized up when they are accepted, and those that cannot fit are refused."""

from __future__ import annotations

from pathlib import Path

from core.schema.expectation import expect
from store.job import JobOutput
from store.mesh_inputs import PACKED_FACE_BYTES, count_faces
from store.settings import Settings
from tests.api.live import Live, problem_of, serving
from tests.core.io.stl_bytes import binary_stl


def test_a_job_says_what_it_is_expected_to_need(api: Live) -> None:
    mesh = api.mesh_href(binary_stl())
    told = api.execute("validate", {"meshes": {"href": mesh}}).json()
    expected = expect("validate", {}, api.client.get(mesh).json()["faces"])
    assert (told["queue"], told["expectedMemoryBytes"]) == ("fast", expected.memory_bytes)
    assert told["expectedCpuSeconds"] == expected.cpu_s


def test_what_no_job_may_use_is_refused_with_numbers(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, job_memory_bytes=200_000_000)) as small:
        mesh = small.mesh_href(binary_stl())
        refused = problem_of(small.execute("shells", {"skin": {"href": mesh}}), 413, "job.too_large_for_memory")
        assert refused["facts"]["limit_bytes"] == 200_000_000
        assert refused["facts"]["expected_bytes"] > 200_000_000
        assert small.client.get("/v1/jobs").json()["jobs"] == []


def test_faces_of_results_are_told_from_their_size() -> None:
    assert count_faces(JobOutput("0" * 64, 84 + 50 * 12, "model/stl", "skin.stl")) == 12
    assert count_faces(JobOutput("0" * 64, 10, "model/stl", "skin.stl")) == 0
    assert count_faces(JobOutput("0" * 64, 1000 * PACKED_FACE_BYTES, "application/zip", "package.zip")) == 1000
