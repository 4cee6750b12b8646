"""Prometheus text: true to the tables, the same from every API process, with few series."""

from __future__ import annotations

import json
import logging
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families

from core.errors import InternalError
from core.schema.expectation import JobQueue
from store.api_keys import ApiKeys
from store.job import JobFailure
from store.scope import Scope
from store.settings import Settings
from store.stored_bytes import StoredBytes
from store.tally import Tally
from store.workers import WorkerWord
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving

Samples = dict[tuple[str, frozenset[tuple[str, str]]], float]
LOST = JobFailure.of(InternalError("child.crashed", "signal 11"))


def scrape(live: Live, **headers: str) -> Samples:
    response = live.client.get("/metrics", headers=headers)
    assert response.status_code == 200, response.text
    assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
    families = list(text_string_to_metric_families(response.text))
    assert len({family.name for family in families}) == len(families), "each is told once"
    assert all(family.documentation for family in families)
    return {
        (sample.name.removeprefix("integument_"), frozenset(sample.labels.items())): sample.value
        for family in families
        for sample in family.samples
    }


def value(samples: Samples, name: str, **labels: str) -> float:
    return samples[name, frozenset(labels.items())]


def test_what_there_is_to_do_and_who_is_there(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, event_poll_s=0.05)) as live:
        for make in (live.accepted, live.accepted, live.running, live.successful):
            make()
        live.failed(LOST)
        running = live.running("shells")
        live.services.workers.beat(WorkerWord("a:1", "a", "0.1.0", 2, 16, 1000))
        live.services.workers.beat(WorkerWord("b:1", "b", "0.2.0", 8, 64, 500))
        live.services.workers.beat(WorkerWord("c:1", "c", "0.2.0", 8, 64, 900, draining=True))
        live.services.workers.beat(WorkerWord("d:1", "d", "0.2.0", 0, 0, 900, queues=(JobQueue.FAST,)))
        StoredBytes(live.services.db).measure()
        with live.client.stream("GET", f"/v1/jobs/{running.id}/events") as stream:
            lines = stream.iter_lines()
            next(lines)
            told = scrape(live)
    assert value(told, "jobs", process="validate", queue="heavy", status="accepted") == 2
    assert value(told, "jobs", process="validate", queue="heavy", status="running") == 1
    assert value(told, "jobs", process="shells", queue="heavy", status="running") == 1
    assert value(told, "jobs", process="heal", queue="heavy", status="running") == 0, "a process nobody uses is told of, too"
    assert value(told, "backlog") == 4
    assert 0 < value(told, "oldest_waiting_seconds", queue="heavy") < 60
    assert value(told, "event_streams") == 1
    assert value(told, "uploads_open") == 0
    assert value(told, "callbacks", state="dead") == 0
    assert value(told, "jobs_ended_total", process="validate", status="successful") == 1
    assert value(told, "job_failures_total", process="shells", code="child.crashed") == 1
    assert value(told, "job_peak_memory_bytes_bucket", process="validate", le="1.34217728e+08") == 1
    assert value(told, "stage_seconds_bucket", process="validate", stage="validate", le="0.1") == 0
    assert value(told, "stage_seconds_bucket", process="validate", stage="validate", le="0.3") == 1
    assert value(told, "stage_seconds_bucket", process="validate", stage="validate", le="+Inf") == 1
    assert value(told, "stage_seconds_sum", process="shells", stage="shells") == 1.5
    assert [value(told, "workers", state=state) for state in ("alive", "draining", "lost")] == [3, 1, 0]
    assert value(told, "worker_versions", version="0.2.0") == 3
    assert (value(told, "worker_slots"), value(told, "worker_memory_bytes")) == (10, 80)
    assert [value(told, "queue_workers", queue=queue) for queue in ("fast", "heavy")] == [3, 2]
    assert value(told, "worker_disk_free_bytes") == 500
    assert value(told, "worker_last_seen_seconds") < 60
    assert value(told, "stored_bytes", kind="outputs") > 0
    assert value(told, "process_resident_memory_bytes") > 2**20


def test_two_api_processes_tell_the_same(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    with serving(settings) as first, serving(settings) as second:
        for live in (first, second, second):
            mesh = "00000000-0000-4000-8000-000000000000"
            live.client.get(f"/v1/meshes/{mesh}")
            live.client.get("/v1/jobs?limit=1")
        first.client.get("/nowhere/at/all")
        first.services.http_tally.note("BREW", "/v1/jobs", 400, 0.1, None)
        second.services.http_tally.flush()  # happens every 5 s
        one, other = scrape(first), scrape(second)
    for told in (one, other):
        assert value(told, "http_requests_total", method="GET", route="/v1/jobs", status="200") == 3
        assert value(told, "http_requests_total", method="GET", route="/v1/meshes/{mesh_id}", status="404") == 3
        assert value(told, "http_requests_total", method="GET", route="none", status="404") == 1
        assert value(told, "http_request_seconds_count", method="GET", route="/v1/jobs") == 3
        assert value(told, "http_request_seconds_bucket", method="GET", route="/v1/jobs", le="+Inf") == 3
        assert value(told, "http_request_seconds_sum", method="GET", route="/v1/jobs") > 0
    labels = {pair for name, pairs in one for pair in pairs if name.startswith("http")}
    assert ("method", "other") in labels
    assert ("method", "BREW") not in labels


def test_refusals_are_counted_and_the_door_is_the_admins(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path)) as live:
        keys = ApiKeys(live.services.db)
        admin, reader = (keys.create(DEFAULT_WORKSPACE, "", [scope]).text for scope in (Scope.ADMIN, Scope.READ))
        live.client.get("/v1/jobs")
        live.client.get("/v1/jobs", headers={"Host": "evil.example"})
        problem_of(live.client.get("/metrics", headers={"Authorization": f"Bearer {reader}"}), 403, "access.scope_missing")
        told = scrape(live, Authorization=f"Bearer {admin}")
    assert value(told, "requests_refused_total", code="access.key_missing") == 1
    assert value(told, "requests_refused_total", code="access.scope_missing") == 1
    assert value(told, "requests_refused_total", code="request.host_refused") == 1


def test_a_request_is_one_line_with_its_id_and_without_its_query(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "integument.requests")
    with serving(Settings(data_dir=tmp_path)) as live:
        live.client.get("/v1/jobs?limit=1&secret=sesame", headers={"X-Request-ID": "r-9"})
        live.client.get("/readyz?exclude=workers&exclude=broker")
        live.client.get("/readyz")
        live.accepted()
    lines = [vars(record) for record in caplog.records if record.name == "integument.requests"]
    assert [(line["event"], line["fields"]["path"], line["fields"]["status"]) for line in lines] == [
        ("http_request", "/v1/jobs", 200),
        ("http_request", "/readyz", 503),
    ], "probes that are content leave no line"
    assert lines[0]["fields"]["workspace"] == "default"
    assert "sesame" not in json.dumps(lines, default=str)


def test_a_scrape_does_not_grow_with_what_has_ended(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path)) as live:
        live.successful()
        scrape(live)
        live.services.metrics.fold()
        before = len(live.client.get("/metrics").text)
        for _ in range(5):
            live.successful()
        live.services.metrics.fold()
        assert len(live.client.get("/metrics").text) < before + 200


def test_counts_wait_for_the_database(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*_: object) -> None:
        raise InternalError("database.unavailable", "away")

    with serving(Settings(data_dir=tmp_path)) as live:
        tally = live.services.http_tally
        with monkeypatch.context() as patched:
            patched.setattr(type(live.services.metrics), "add", away)
            tally.note("GET", "/v1/jobs", 200, 0.01, None)
            problem_of(live.client.get("/metrics"), 503, "database.unavailable")
        told = scrape(live)
    assert value(told, "http_requests_total", method="GET", route="/v1/jobs", status="200") == 1
    assert not Tally()
