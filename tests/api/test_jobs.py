"""Jobs: status, lists, long polls, dismissal, retry."""

from __future__ import annotations

import base64
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import uuid4

import httpx
import pytest

from core.errors import InputError, InternalError
from core.schema.expectation import JobQueue
from store.job import Job, JobFailure
from store.settings import Settings
from store.workers import WorkerWord
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving

OPEN_EDGES = JobFailure.of(InputError("skin.not_closed", "the skin has 3 open edges", edges=3))
CRASHED = JobFailure.of(InternalError("child.crashed", "the work was ended by signal SIGSEGV", signal="SIGSEGV"))


WORKER = WorkerWord("host-a:17", "host-a", "0.1.0", 2, 16 * 1024**3, 10**11)


def status_of(api: Live, job: Job) -> dict[str, Any]:
    told: dict[str, Any] = api.client.get(f"/v1/jobs/{job.id}").json()
    return told


def await_messages(told: Callable[[], set[str]], message: str) -> None:
    """Until all of them are that: the server looks at its workers once a second."""
    deadline = time.monotonic() + 20
    while told() != {message}:
        assert time.monotonic() < deadline, told()
        time.sleep(0.05)


def test_a_running_job_shows_phase_and_progress(api: Live) -> None:
    job = api.running("shells")
    api.services.jobs.renew(job.id, job.lease_token, 60.0, 42.7, "shells: fat", "round 3 of 9, 12 faces left")
    told = status_of(api, job)
    assert (told["status"], told["progress"], told["phase"]) == ("running", 42, "shells: fat")
    assert told["message"] == "round 3 of 9, 12 faces left"
    assert told["started"] >= told["created"]
    assert not {"queuePosition", "finished", "verdict", "failure", "timings_s"} & set(told)


def test_a_successful_job_shows_verdict_times_and_results(api: Live) -> None:
    told = status_of(api, api.successful())
    assert (told["status"], told["progress"], told["verdict"]) == ("successful", 100, "simulation_ready")
    assert told["summary"] == "1 mesh, no errors"
    assert (told["timings_s"], told["peakMemoryBytes"]) == ({"validate": 0.25}, 123_456_789)
    links = {(link["rel"], link["type"]): link["href"] for link in told["links"]}
    assert httpx.get(links["http://www.opengis.net/def/rel/ogc/1.0/results", "application/json"]).status_code == 200
    assert httpx.get(links["describedby", "application/json"]).status_code == 200
    assert (
        httpx.get(links["alternate", "text/html"], headers={"Accept": "text/html"})
        .headers["content-type"]
        .startswith("text/html")
    )


def test_a_failed_job_says_whose_fault_it_is(api: Live) -> None:
    told = status_of(api, api.failed(OPEN_EDGES))
    assert told["status"] == "failed"
    assert told["failure"] == {
        "code": "skin.not_closed",
        "class": "input",
        "message": "the skin has 3 open edges",
        "retryable": False,
        "facts": {"edges": 3},
    }
    assert status_of(api, api.failed(CRASHED))["failure"]["retryable"] is True


def test_queue_positions_count_from_one(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, event_poll_s=0.05)) as live:
        jobs = [live.accepted() for _ in range(3)]
        assert [status_of(live, job)["queuePosition"] for job in jobs] == [1, 2, 3]
        live.client.delete(f"/v1/jobs/{jobs[0].id}")
        assert [status_of(live, job)["queuePosition"] for job in jobs[1:]] == [1, 2]


def test_a_job_that_nobody_takes_says_so(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, event_poll_s=0.05)) as live:
        job = live.accepted("shells")
        assert status_of(live, job)["message"] == "waits for a worker; no living worker is there"
        live.services.workers.beat(replace(WORKER, queues=(JobQueue.FAST,)))

        def messages() -> set[str]:
            """In the status and in the list."""
            (listed,) = live.client.get("/v1/jobs").json()["jobs"]
            return {status_of(live, job)["message"], listed["message"]}

        await_messages(messages, "waits for a worker; no living worker takes heavy jobs")
        live.services.workers.beat(WORKER)
        await_messages(messages, "waits for a worker")
        live.services.workers.leave(WORKER.name)
        live.client.delete(f"/v1/jobs/{job.id}")
        assert "worker" not in status_of(live, job)["message"], "it waits no more"


@pytest.mark.parametrize(
    "job_id", ["0b9a6d0e-8f3c-4a55-9d51-3f1f6f1d7c20", "1", "..%2f..%2fetc", "%00", "\u00e4" * 36, "A" * 5000]
)
def test_an_unknown_job_is_a_problem_everywhere(api: Live, job_id: str) -> None:
    for method, path in (
        ("GET", ""),
        ("DELETE", ""),
        ("GET", "/results"),
        ("GET", "/results/report"),
        ("GET", "/report"),
        ("GET", "/events"),
        ("POST", "/retry"),
    ):
        response = api.client.request(method, f"/v1/jobs/{job_id}{path}")
        if response.json()["code"] == "route.not_found":
            assert "/" in httpx.URL(response.request.url).path.removeprefix("/v1/jobs/").removesuffix(path)
            continue
        problem = problem_of(response, 404, "job.not_found")
        assert problem["type"] == "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/no-such-job"


def test_lists_are_filtered_and_paged(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path)) as live:
        made = [live.accepted(process) for process in ("validate", "shells", "validate", "shells", "validate")]
        live.client.delete(f"/v1/jobs/{made[0].id}")
        newest_first = [job.id for job in reversed(made)]
        seen: list[str] = []
        response = live.client.get("/v1/jobs", params={"limit": 2})
        pages = 1
        while True:
            document = response.json()
            seen += [job["jobID"] for job in document["jobs"]]
            following = [link["href"] for link in document["links"] if link["rel"] == "next"]
            if not following:
                break
            assert document["next"] in following[0]
            assert response.links["next"]["url"] == following[0]
            response = httpx.get(following[0])
            pages += 1
        assert (seen, pages) == (newest_first, 3)
        assert "Link" not in response.headers

        def ids(query: str) -> list[str]:
            return [job["jobID"] for job in live.client.get(f"/v1/jobs?{query}").json()["jobs"]]

        assert ids("status=dismissed") == [made[0].id]
        assert ids("status=dismissed,accepted") == ids("status=dismissed&status=accepted") == newest_first
        assert ids("processID=shells") == [made[3].id, made[1].id]
        assert ids("processID=smoothen") == []
        first = live.client.get("/v1/jobs?status=accepted&processID=validate,shells&limit=3").json()
        (link,) = (link["href"] for link in first["links"] if link["rel"] == "next")
        assert [job["jobID"] for job in httpx.get(link).json()["jobs"]] == [made[1].id], "filters stay on the next page"


def cursor_of(told: str) -> str:
    return base64.urlsafe_b64encode(told.encode()).decode().rstrip("=")


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("status=done", "request.invalid"),
        ("limit=0", "request.invalid"),
        ("limit=ten", "request.invalid"),
        ("cursor=%00", "request.invalid"),
        ("cursor=abc", "cursor.invalid"),
        (f"cursor={cursor_of('2026-11-21T00:00:00+00:00 a' + chr(0))}", "cursor.invalid"),
        (f"cursor={cursor_of('0001-01-01T00:00:00+23:59 a')}", "cursor.invalid"),
        (f"cursor={cursor_of('2026-11-21T00:00:00 a')}", "cursor.invalid"),
        ("processID=%00", "request.invalid"),
    ],
)
def test_bad_queries_are_refused(api: Live, query: str, code: str) -> None:
    problem = problem_of(api.client.get(f"/v1/jobs?{query}"), 422, code)
    if code == "request.invalid":
        assert problem["errors"][0]["pointer"] in ("status", "limit", "cursor", "processID", "0")


def test_a_long_poll_ends_when_the_status_changes(api: Live) -> None:
    job = api.accepted()
    answers: list[httpx.Response] = []
    thread = threading.Thread(target=lambda: answers.append(api.client.get(f"/v1/jobs/{job.id}", headers={"Prefer": "wait=20"})))
    started = time.monotonic()
    thread.start()
    thread.join(0.5)
    assert thread.is_alive()
    api.services.jobs.claim(job.id, 1, "tests", 60.0)
    thread.join()
    assert time.monotonic() - started < 10
    assert answers[0].json()["status"] == "running"
    assert answers[0].headers["Preference-Applied"] == "wait=20"


def test_a_long_poll_on_a_finished_job_answers_at_once(api: Live) -> None:
    job = api.successful()
    started = time.monotonic()
    assert api.client.get(f"/v1/jobs/{job.id}", headers={"Prefer": "wait=20"}).json()["status"] == "successful"
    assert time.monotonic() - started < 5


def test_a_waiting_job_is_dismissed_at_once(api: Live) -> None:
    job = api.accepted()
    response = api.client.delete(f"/v1/jobs/{job.id}")
    assert (response.status_code, response.json()["status"]) == (200, "dismissed")
    assert status_of(api, job)["status"] == "dismissed"
    problem_of(api.client.get(f"/v1/jobs/{job.id}/results"), 404, "job.no_results")


def test_dismissing_a_running_job_waits_for_its_worker(api: Live) -> None:
    job = api.running()

    def worker() -> None:
        while not api.services.jobs.renew(job.id, job.lease_token, 60.0).dismiss_requested:
            time.sleep(0.02)
        api.services.jobs.confirm_dismissed(job.id, job.lease_token)

    thread = threading.Thread(target=worker)
    thread.start()
    response = api.client.delete(f"/v1/jobs/{job.id}")
    thread.join()
    assert (response.status_code, response.json()["status"]) == (200, "dismissed")


def test_dismissing_a_running_job_says_so_if_the_worker_takes_its_time(api: Live) -> None:
    job = api.running()
    told = api.client.delete(f"/v1/jobs/{job.id}").json()
    assert (told["status"], told["message"]) == ("running", "is being dismissed")


def test_dismissing_a_finished_job_removes_it(api: Live) -> None:
    job = api.successful()
    response = api.client.delete(f"/v1/jobs/{job.id}")
    assert (response.status_code, response.json()["status"]) == (200, "dismissed")
    for path in ("", "/results", "/results/report", "/report", "/events"):
        problem_of(api.client.get(f"/v1/jobs/{job.id}{path}"), 404, "job.not_found")


def test_what_ended_meanwhile_stays_where_that_is_asked_for(api: Live) -> None:
    job, waiting = api.successful(), api.accepted()
    told = api.client.delete(f"/v1/jobs/{job.id}?keep_ended=true")
    assert (told.status_code, told.json()["status"]) == (200, "successful")
    assert api.client.get(f"/v1/jobs/{job.id}/results").status_code == 200
    assert api.client.delete(f"/v1/jobs/{waiting.id}?keep_ended=true").json()["status"] == "dismissed"


@pytest.mark.parametrize("make", [lambda api: api.failed(CRASHED), lambda api: dismissed(api)])
def test_failed_and_dismissed_jobs_run_again_on_request(api: Live, make: Callable[[Live], Job]) -> None:
    job, key = make(api), str(uuid4())
    response = api.client.post(f"/v1/jobs/{job.id}/retry", headers={"Idempotency-Key": key})
    assert response.status_code == 202
    assert response.headers["Location"] == f"/v1/jobs/{job.id}"
    told = response.json()
    assert (told["jobID"], told["status"], told["attempt"]) == (job.id, "accepted", job.attempt + 1)
    assert "failure" not in told
    api.announced(job.id)
    again = api.client.post(f"/v1/jobs/{job.id}/retry", headers={"Idempotency-Key": key})
    assert (again.json()["attempt"], again.headers["Idempotent-Replayed"]) == (job.attempt + 1, "true")


def dismissed(api: Live) -> Job:
    return api.services.jobs.dismiss(DEFAULT_WORKSPACE, api.accepted().id)


def test_other_jobs_do_not(api: Live) -> None:
    for job in (api.accepted(), api.running(), api.successful()):
        problem = problem_of(api.client.post(f"/v1/jobs/{job.id}/retry"), 409, "job.not_retryable")
        assert problem["facts"]["status"] == job.status
