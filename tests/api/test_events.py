"""Event streams: order, resumption, their end, and what keeps them from holding anything up."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from core.errors import InternalError
from store.job import Job, JobFailure
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving
from tests.postgres import running_postgres

Event = tuple[int, str, dict[str, Any]]


def events_in(lines: Iterator[str]) -> Iterator[Event]:
    """id, type and data of each event, as a browser would read them."""
    fields: dict[str, str] = {}
    for line in lines:
        if line:
            name, _, value = line.partition(": ")
            fields[name] = value
            continue
        if "data" in fields:
            yield int(fields["id"]), fields["event"], json.loads(fields["data"])
        fields = {}


@contextmanager
def streamed(api: Live, job: Job, query: str = "", **headers: str) -> Iterator[tuple[httpx.Response, Iterator[Event]]]:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    with api.client.stream("GET", f"/v1/jobs/{job.id}/events{query}", headers=named) as response:
        yield response, events_in(response.iter_lines())


def test_a_job_is_told_from_its_first_event_to_its_last(api: Live) -> None:
    job = api.running()
    with streamed(api, job) as (response, events):
        assert response.headers["content-type"].startswith("text/event-stream")
        assert response.headers["x-accel-buffering"] == "no"
        number, kind, data = next(events)
        assert (number, kind, data["status"]) == (1, "status", "accepted")
        api.services.jobs.renew(job.id, job.lease_token, 60.0, 10.0, "shells: fat", "3 of 30")
        seen = [next(events), next(events)]
        api.services.jobs.append_events(job.id, job.lease_token, [("log", {"message": "line\nof text"})])
        api.services.jobs.finish(job.id, job.lease_token, verdict="not_ready", summary="1 error", outputs={}, timings_s={})
        seen += list(events)
    assert [event[1] for event in seen] == ["status", "progress", "log", "done"]
    assert [event[0] for event in seen] == [2, 3, 4, 5]
    assert seen[1][2]["phase"] == "shells: fat"
    assert seen[1][2]["progress"] == 10.0
    assert seen[2][2]["message"] == "line\nof text"
    assert (seen[3][2]["status"], seen[3][2]["verdict"]) == ("successful", "not_ready")
    assert all("at" in event[2] for event in seen)


def test_the_stream_says_when_to_come_back(api: Live) -> None:
    job = api.successful()
    text = api.client.get(f"/v1/jobs/{job.id}/events").text
    assert "retry: 3000\n" in text.split("\n\n")[0] + "\n"


@pytest.mark.parametrize("how", ["header", "query"])
def test_a_stream_goes_on_where_it_broke_off(api: Live, how: str) -> None:
    job = api.successful()
    with streamed(api, job) as (_, events):
        whole = list(events)
    assert len(whole) == 3
    for number in range(len(whole)):
        query, headers = (f"?after={number}", {}) if how == "query" else ("", {"Last_Event_ID": str(number)})
        with streamed(api, job, query, **headers) as (_, events):
            assert list(events) == whole[number:]


def test_a_stream_nothing_is_left_for_ends_at_once(api: Live) -> None:
    job = api.successful()
    with streamed(api, job, "?after=3") as (response, events):
        assert response.status_code == 200
        assert list(events) == []


def test_the_header_wins_over_the_query(api: Live) -> None:
    with streamed(api, api.successful(), "?after=0", Last_Event_ID="2") as (_, events):
        assert [number for number, _, _ in events] == [3]


@pytest.mark.parametrize(("query", "header"), [("?after=-1", ""), ("?after=x", ""), ("", "abc"), ("", "99999999999999999999")])
def test_places_that_are_no_number_are_refused(api: Live, query: str, header: str) -> None:
    headers = {"Last-Event-ID": header} if header else {}
    problem_of(api.client.get(f"/v1/jobs/{api.accepted().id}/events{query}", headers=headers), 422, "request.invalid")


def test_after_a_retry_only_the_last_end_ends_the_stream(api: Live) -> None:
    job = api.failed(JobFailure.of(InternalError("child.crashed", "ended by SIGSEGV", signal="SIGSEGV")))
    api.services.jobs.retry(DEFAULT_WORKSPACE, job.id)
    again = api.services.jobs.claim(job.id, 2, "tests", 60.0)
    assert again is not None
    with streamed(api, job) as (_, events):
        first = [next(events) for _ in range(5)]
        api.services.jobs.finish(job.id, again.lease_token, verdict="not_ready", summary="", outputs={}, timings_s={})
        rest = list(events)
    assert [(kind, data["status"]) for _, kind, data in first] == [
        ("status", "accepted"),
        ("status", "running"),
        ("status", "failed"),
        ("status", "accepted"),
        ("status", "running"),
    ]
    assert [(kind, data["status"]) for _, kind, data in rest] == [("done", "successful")]


def test_a_client_that_leaves_frees_its_slot(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, event_streams=1, event_poll_s=0.05)) as live:
        job = live.running()
        with streamed(live, job) as (_, events):
            next(events)
            problem = problem_of(live.client.get(f"/v1/jobs/{job.id}/events"), 503, "server.busy")
            assert problem["retryable"]
            assert problem["facts"] == {"limit": 1}
        pause = threading.Event()
        for _ in range(100):
            if live.services.streams.open == 0:
                break
            pause.wait(0.05)
        assert live.services.streams.open == 0
        with streamed(live, job) as (response, _):
            assert response.status_code == 200


def test_a_refused_stream_takes_no_slot(api: Live) -> None:
    before = api.services.streams.open
    api.client.get("/v1/jobs/nonsense/events")
    assert api.services.streams.open == before


def test_a_removed_job_ends_its_stream(api: Live) -> None:
    job = api.accepted()
    with streamed(api, job, "?after=1") as (_, events):
        api.services.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
        api.services.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
        assert [kind for _, kind, _ in events] in (["done"], [])


def test_a_database_that_goes_away_ends_the_stream_in_good_order(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with (
        running_postgres() as server,
        serving(Settings(data_dir=tmp_path, database_url=server.new_database(), event_poll_s=0.05)) as live,
    ):
        with streamed(live, live.running()) as (_, events):
            assert [next(events)[1] for _ in range(2)] == ["status", "status"]
            server.kill()
            assert list(events) == []  # a connection that broke would raise
        assert "break off" in caplog.text
        server.start()


def test_open_streams_and_long_polls_do_not_hold_up_the_end(tmp_path: Path) -> None:
    ended = threading.Event()

    def wait(url: str) -> None:
        httpx.get(url, headers={"Prefer": "wait=30"}, timeout=60)
        ended.set()

    with serving(Settings(data_dir=tmp_path, event_poll_s=0.05)) as live:
        job = live.running()
        thread = threading.Thread(target=wait, args=(f"{live.url}/v1/jobs/{job.id}",))
        thread.start()
        with streamed(live, job) as (_, events):
            next(events)
            assert not ended.is_set()
            live.services.drain.begin()
            assert list(events)[1:] == []
            assert ended.wait(5)
        thread.join()
        problem = problem_of(live.client.get("/readyz?exclude=workers"), 503, "server.not_ready")
        assert problem["facts"]["drain"] == "the server is stopping"
