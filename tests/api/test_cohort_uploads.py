"""Archives for cohorts as uploads in pieces: a request more makes the cohort, once, and the upload goes with it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving
from tests.api.test_cohorts import zipped
from tests.api.test_resumable import begun, received, send
from tests.core.io.stl_bytes import binary_stl

ARCHIVE = zipped({"one.stl": binary_stl(), "two.stl": b"no mesh", "deep/three.stl": binary_stl(header=b"another")})
ASKED = {"process": "validate", "name": "Study", "subjects": [{"name": "three", "inputs": {"min_gap_mm": 2.0}}]}


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    settings = Settings(data_dir=tmp_path_factory.mktemp("archives"), broker_url="redis://127.0.0.1:1/0", rate_per_s=0)
    with serving(settings) as made:
        yield made


def uploaded(live: Live, data: bytes = ARCHIVE, **metadata: str) -> str:
    """In two pieces; its path."""
    path = begun(live, len(data), filename="study.zip", **metadata)
    for start, end in ((0, 100), (100, len(data))):
        assert send(live, path, start, data[start:end]).status_code == 204
    return path


def made(live: Live, path: str, *, key: str | None = None, **more: object) -> httpx.Response:
    return live.client.post(f"{path}/cohort", json=ASKED | more, headers={} if key is None else {"Idempotency-Key": key})


def count_meshes(live: Live) -> int:
    return len(live.client.get("/v1/meshes", params={"limit": 1000}).json()["meshes"])


def test_an_archive_that_came_in_pieces_becomes_a_cohort(live: Live) -> None:
    path = uploaded(live, unit="m")
    answer = made(live, path)
    told = answer.json()
    assert (answer.status_code, answer.headers["Location"]) == (201, f"/v1/cohorts/{told['id']}")
    assert (told["subjects"], told["counts"]["accepted"], told["counts"]["refused"]) == (3, 2, 1)
    assert [(one["subject"], one["code"]) for one in told["refused"]] == [("two", "stl.not_stl")]
    jobs = live.client.get("/v1/jobs", params={"cohort": told["id"]}).json()["jobs"][::-1]
    inputs = [live.services.jobs.get(DEFAULT_WORKSPACE, job["jobID"]).inputs for job in jobs]
    assert sorted((job["subject"], one["min_gap_mm"]) for job, one in zip(jobs, inputs, strict=True)) == [
        ("one", 0.0),
        ("three", 2.0),
    ]
    units = {live.client.get(one["meshes"]["href"]).json()["unit"] for one in inputs}
    assert units == {"m"}
    # its bytes are the meshes' now
    problem_of(live.client.get(path), 404, "upload.not_found")
    assert not list(Path(live.services.uploads_dir).iterdir())


def test_asked_again_with_its_key_the_same_cohort_answers(live: Live) -> None:
    path = uploaded(live)
    first = made(live, path, key="study-1").json()
    meshes = count_meshes(live)
    again = made(live, path, key="study-1")
    assert (again.json()["id"], again.headers["Idempotent-Replayed"]) == (first["id"], "true")
    assert count_meshes(live) == meshes
    problem_of(made(live, path), 404, "upload.not_found")
    problem_of(made(live, path, key="study-1", name="Other"), 422, "idempotency.mismatch")


def test_what_is_refused_stays_and_can_be_asked_otherwise(live: Live) -> None:
    path, before = uploaded(live), count_meshes(live)
    problem_of(made(live, path, subjects=[{"name": "nobody", "inputs": {}}]), 422, "cohort.subject_unknown")
    problem_of(made(live, path, process="shrink"), 404, "process.not_found")
    problem_of(made(live, path, inputs={"x": 1}, subjects=[]), 422, "inputs.unknown_key")
    problem_of(made(live, path, unit="ell"), 422, "unit.unknown")
    assert count_meshes(live) == before
    assert received(live, path) == len(ARCHIVE)
    assert made(live, path).status_code == 201


def test_half_an_archive_no_archive_and_one_that_became_a_mesh(live: Live) -> None:
    path = begun(live, len(ARCHIVE), filename="study.zip")
    assert send(live, path, 0, ARCHIVE[:50]).status_code == 204
    problem = problem_of(made(live, path), 409, "upload.incomplete")
    assert (problem["facts"]["received"], problem["facts"]["length"]) == (50, len(ARCHIVE))
    problem_of(made(live, uploaded(live, b"no zip" * 50)), 422, "archive.corrupt")
    path = uploaded(live, binary_stl(), unit="mm")
    assert live.client.post(f"{path}/mesh").status_code == 201
    problem_of(made(live, path), 409, "upload.spent")


def test_an_archive_that_fits_the_quota_alone_is_not_counted_twice(tmp_path: Path) -> None:
    content = zipped({"one.stl": binary_stl(tail=bytes(range(256)) * 40)}, method=0)
    settings = Settings(data_dir=tmp_path, broker_url="redis://127.0.0.1:1/0", quota_bytes=len(content) + 5000)
    with serving(settings) as live:
        assert made(live, uploaded(live, content), subjects=[]).status_code == 201
