"""Health and readiness."""

from __future__ import annotations

import signal
from dataclasses import replace
from pathlib import Path

from core.schema.expectation import JobQueue
from store.settings import Settings
from store.workers import WorkerWord
from tests.api.live import Live, problem_of, serving
from tests.valkey import ValkeyServer

PARTS = ("database", "broker", "blobs", "disk", "drain", "workers")
SERVING = "/readyz?exclude=workers"
WORKER = WorkerWord("host-a:17", "host-a", "0.1.0", 2, 16 * 1024**3, 10**11)


def test_a_process_with_everything_it_needs_is_ready(api: Live) -> None:
    assert api.client.get("/healthz").json() == {"status": "ok"}
    api.services.workers.beat(WORKER)
    ready = api.client.get("/readyz")
    assert ready.status_code == 200
    assert ready.json() == {"status": "ready", "checks": dict.fromkeys(PARTS, "ok")}
    api.services.workers.leave(WORKER.name)


def test_it_is_not_without_a_worker_but_can_still_serve(api: Live) -> None:
    problem = problem_of(api.client.get("/readyz"), 503, "server.not_ready")
    assert problem["facts"] == {"workers": "no worker has given word lately; jobs are accepted, and wait"}
    ready = api.client.get("/readyz?exclude=workers")
    assert ready.status_code == 200
    assert set(ready.json()["checks"]) == set(PARTS) - {"workers"}
    api.services.workers.beat(replace(WORKER, draining=True))
    problem_of(api.client.get("/readyz"), 503, "server.not_ready")
    api.services.workers.leave(WORKER.name)
    problem_of(api.client.get("/readyz?exclude=everything"), 422, "request.invalid")


def test_it_is_not_while_jobs_wait_that_nobody_takes(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    with serving(Settings(data_dir=tmp_path, broker_url=shared_valkey.url)) as live:
        live.services.workers.beat(replace(WORKER, queues=(JobQueue.FAST,)))
        assert live.client.get("/readyz").status_code == 200, "nobody has asked for a heavy one"
        live.accepted("shells")
        problem = problem_of(live.client.get("/readyz"), 503, "server.not_ready")
        assert problem["facts"] == {"workers": "no living worker takes heavy jobs, and some wait"}
        live.services.workers.beat(replace(WORKER, name="host-b:1"))
        assert live.client.get("/readyz").status_code == 200


def test_it_is_not_while_the_broker_is_away(tmp_path: Path, valkey: ValkeyServer) -> None:
    with serving(Settings(data_dir=tmp_path, broker_url=valkey.url)) as live:
        assert live.client.get(SERVING).status_code == 200
        valkey.signal(signal.SIGSTOP)
        problem = problem_of(live.client.get(SERVING), 503, "server.not_ready")
        assert problem["facts"] == {"broker": "the broker does not answer"}
        assert live.client.get("/healthz").status_code == 200, "a restart of the process would not help"
        valkey.signal(signal.SIGCONT)
        valkey.kill()
        response = live.client.get(SERVING)
        problem_of(response, 503, "server.not_ready")
        assert response.headers["retry-after"] == "1"
        valkey.start()
        assert live.client.get(SERVING).status_code == 200


def test_it_is_not_without_tables_or_place(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    with serving(Settings(data_dir=tmp_path, broker_url=shared_valkey.url)) as live:
        with live.services.db.session() as session:
            session.connection().exec_driver_sql("DELETE FROM alembic_version")
        live.services.incoming_dir.rmdir()
        live.services.incoming_dir.write_text("in the way")
        problem = problem_of(live.client.get(SERVING), 503, "server.not_ready")
        assert set(problem["facts"]) == {"database", "blobs"}
        assert str(tmp_path) not in problem["detail"]
