"""Health, readiness, metrics."""

from __future__ import annotations

import re
import signal
from pathlib import Path

from store.settings import Settings
from tests.api.live import Live, problem_of, serving
from tests.valkey import ValkeyServer


def test_a_process_with_everything_it_needs_is_ready(api: Live) -> None:
    assert api.client.get("/healthz").json() == {"status": "ok"}
    ready = api.client.get("/readyz")
    assert ready.status_code == 200
    assert ready.json() == {
        "status": "ready",
        "checks": dict.fromkeys(("database", "broker", "blobs", "disk", "drain"), "ok"),
    }


def test_it_is_not_while_the_broker_is_away(tmp_path: Path, valkey: ValkeyServer) -> None:
    with serving(Settings(data_dir=tmp_path, broker_url=valkey.url)) as live:
        assert live.client.get("/readyz").status_code == 200
        valkey.signal(signal.SIGSTOP)
        problem = problem_of(live.client.get("/readyz"), 503, "server.not_ready")
        assert problem["facts"] == {"broker": "the broker does not answer"}
        assert live.client.get("/healthz").status_code == 200, "a restart of the process would not help"
        valkey.signal(signal.SIGCONT)
        valkey.kill()
        response = live.client.get("/readyz")
        problem_of(response, 503, "server.not_ready")
        assert response.headers["retry-after"] == "1"
        valkey.start()
        assert live.client.get("/readyz").status_code == 200


def test_it_is_not_without_tables_or_place(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    with serving(Settings(data_dir=tmp_path, broker_url=shared_valkey.url)) as live:
        with live.services.db.session() as session:
            session.connection().exec_driver_sql("DELETE FROM alembic_version")
        live.services.incoming_dir.rmdir()
        live.services.incoming_dir.write_text("in the way")
        problem = problem_of(live.client.get("/readyz"), 503, "server.not_ready")
        assert set(problem["facts"]) == {"database", "blobs"}
        assert str(tmp_path) not in problem["detail"]


def test_metrics_count_the_table(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path, event_poll_s=0.05)) as live:
        for make in (live.accepted, live.accepted, live.running, live.successful):
            make()
        running = live.running("shells")
        with live.client.stream("GET", f"/v1/jobs/{running.id}/events") as stream:
            lines = stream.iter_lines()
            next(lines)
            response = live.client.get("/metrics")
        assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
        told = dict(re.findall(r"^([a-z_]+(?:\{.*\})?) ([0-9.]+)$", response.text, re.MULTILINE))
        assert told['integument_jobs{process="validate",status="accepted"}'] == "2"
        assert told['integument_jobs{process="validate",status="running"}'] == "1"
        assert told['integument_jobs{process="validate",status="successful"}'] == "1"
        assert told['integument_jobs{process="shells",status="running"}'] == "1"
        assert told['integument_jobs{process="shells",status="failed"}'] == "0"
        assert 0 < float(told["integument_oldest_waiting_seconds"]) < 60
        assert told["integument_event_streams"] == "1"
        assert told['integument_callbacks{state="dead"}'] == "0"
        assert response.text.count("# TYPE") == len({name.partition("{")[0] for name in told})
