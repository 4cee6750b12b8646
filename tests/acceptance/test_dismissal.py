"""Dismissed is dismissed within two seconds: while the libraries load, while it waits, and in the middle of the geometry.

While its meshes or results are on their way from or to a store that hangs: tests/worker/test_aside.py."""

from __future__ import annotations

import time
from contextlib import closing
from pathlib import Path

import psutil

from subjects.body import body
from tests.acceptance.service import Service
from tests.embedded import embedded

LIMIT_S = 2.0


def dismiss(service: Service, job: str) -> float:
    """Seconds until the server says that it is dismissed."""
    asked = time.monotonic()
    status = service.http.delete(f"/v1/jobs/{job}").json()["status"]
    while status != "dismissed":
        assert time.monotonic() - asked < 60
        status = service.status(job)["status"]
    return time.monotonic() - asked


def test_a_dismissal_takes_effect_within_two_seconds_at_any_stage(tmp_path: Path) -> None:
    alone = {"INTEGUMENT_WORKER_CONCURRENCY": "1", "INTEGUMENT_WORKER_FAST_SLOTS": "0"}
    with embedded(tmp_path / "data", alone) as server, closing(Service(server.url)) as service:
        skin = service.upload(body(0), "body")
        loading = service.shells(skin)
        service.wait(loading, lambda status: status["status"] == "running")
        took = {"loading": dismiss(service, loading)}
        working = service.shells(skin)
        service.wait(working, lambda status: status["status"] == "running" and status["progress"] >= 5)
        waiting = service.shells(skin)
        took["queued"] = dismiss(service, waiting)
        at_work = [server.child_at_work(working)]
        took["geometry"] = dismiss(service, working)
        _, alive = psutil.wait_procs(at_work, timeout=LIMIT_S)
        assert alive == []
        print(took)
        assert max(took.values()) < LIMIT_S, took
