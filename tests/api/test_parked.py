"""A request that took down its workers is refused over HTTP, and its owner may read why."""

from __future__ import annotations

from core.errors import InternalError
from store.job import JobFailure
from store.lost_attempt import LastWords
from tests.api.live import Live, problem_of

CRASHED = JobFailure.of(InternalError("child.crashed", "the work was ended by signal SIGSEGV", signal="SIGSEGV"))
WORDS = LastWords(phase="shells: fat", signal="SIGSEGV", peak_memory_bytes=7, log="Fatal Python error")


def crash(api: Live, job_id: str, attempt: int) -> None:
    claimed = api.services.jobs.claim(job_id, attempt, "host:1", 60.0)
    assert claimed is not None
    assert api.services.jobs.fail(job_id, claimed.lease_token, CRASHED, retry=True, last_words=WORDS) is not None


def test_a_parked_request_is_refused_until_it_is_released(api: Live, mesh_href: str) -> None:
    inputs = {"meshes": {"deadly": {"href": mesh_href}}}
    job_id = api.execute("validate", inputs).json()["jobID"]
    path = f"/v1/jobs/{job_id}"
    assert api.client.get(f"{path}/attempts").json() == {"attempts": []}
    crash(api, job_id, 1)
    crash(api, job_id, 2)
    first, second = api.client.get(f"{path}/attempts").json()["attempts"]
    assert {name: second[name] for name in ("worker", "code", "signal", "phase", "peakMemoryBytes", "log")} == {
        "worker": "host:1",
        "code": "child.crashed",
        "signal": "SIGSEGV",
        "phase": "shells: fat",
        "peakMemoryBytes": 7,
        "log": "Fatal Python error",
    }
    assert (first["attempt"], second["attempt"]) == (1, 2)

    for refused in (api.execute("validate", inputs), api.client.post(f"{path}/retry")):
        problem = problem_of(refused, 409, "job.parked")
        assert problem["facts"] == {"job": job_id, "attempts": 2}
    assert api.execute("validate", {"meshes": {"other": {"href": mesh_href}}}).status_code == 201
    api.services.parked.release(job_id)
    assert api.client.post(f"{path}/retry").status_code == 202
    problem_of(api.client.get(f"/v1/jobs/{'0' * 8}-0000-4000-8000-{'0' * 12}/attempts"), 404, "job.not_found")
