"""What requests leave in the audit log, and that keys are in no log at all."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from api import audit_trail
from api.audit_trail import AuditTrail
from core.errors import InternalError
from store.api_keys import ApiKeys
from store.audit import Audit, AuditEntry
from store.database import Database
from store.key_text import make_key_text
from store.scope import Scope
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, serving
from tests.api.test_main import free_port, started
from tests.core.io.stl_bytes import binary_stl
from tests.store.test_audit import entry
from tests.valkey import ValkeyServer

MISSING = "00000000-0000-4000-8000-000000000000"


@pytest.fixture
def live(tmp_path: Path, shared_valkey: ValkeyServer) -> Iterator[Live]:
    with serving(Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-audit")) as live:
        yield live


def told(live: Live) -> list[AuditEntry]:
    """All entries, the oldest first."""
    live.services.trail.flush()
    return list(reversed(Audit(live.services.db).list()))


def test_acts_and_refusals_are_told_and_reading_is_not(live: Live, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "integument.audit")
    sent = live.client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())})
    mesh = sent.headers["location"]
    issued = ApiKeys(live.services.db).create(DEFAULT_WORKSPACE, "robot", [Scope.READ, Scope.SUBMIT])
    live.client.get(mesh)
    headers = {"Authorization": f"Bearer {issued.text}", "X-Request-ID": "r-7"}
    body = {"inputs": {"meshes": [{"href": mesh}]}}
    job = live.client.post("/v1/processes/validate/execution", json=body, headers=headers).headers["location"]
    for path in ("/v1/jobs", mesh):
        live.client.get(path, headers=headers)
    live.client.delete(f"/v1/jobs/{MISSING}", headers=headers)
    live.client.delete(mesh, headers=headers)
    live.client.get("/metrics", headers=headers)
    entries = told(live)
    key = issued.key.id
    assert [(one.actor, one.key_id, one.workspace, one.action, one.subject, one.outcome) for one in entries] == [
        ("loopback", None, "default", "POST /v1/meshes", mesh, "done"),
        ("unknown", None, None, "GET /v1/meshes/{id}", mesh, "access.key_missing"),
        ("key", key, "default", "POST /v1/processes/validate/execution", job, "done"),
        ("key", key, "default", "DELETE /v1/jobs/{id}", f"/v1/jobs/{MISSING}", "job.not_found"),
        ("key", key, "default", "DELETE /v1/meshes/{id}", mesh, "done"),
        ("unknown", key, None, "GET /metrics", "/metrics", "access.scope_missing"),
    ]
    assert entries[2].request_id == "r-7"
    lines = [vars(record)["fields"] for record in caplog.records if record.name == "integument.audit"]
    assert lines == [one.describe() for one in entries]


def test_a_crash_is_told(live: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: object) -> None:
        raise RuntimeError("on purpose")

    monkeypatch.setattr(type(live.services.meshes), "delete", crash)
    assert live.client.delete(f"/v1/meshes/{MISSING}").status_code == 500
    (only,) = told(live)
    assert (only.action, only.outcome) == ("DELETE /v1/meshes/{id}", "internal.unexpected")


class Away(Audit):
    """A log whose database comes back after the second try."""

    def __init__(self) -> None:
        self.tries = 0
        self.kept: list[Any] = []

    def write(self, entries: Any) -> None:
        self.tries += 1
        if self.tries <= 2:
            raise InternalError("database.unavailable", "away")
        self.kept += entries


def test_entries_wait_for_the_database() -> None:
    audit = Away()
    trail = AuditTrail(audit)
    trail.note(entry())
    trail.flush()
    trail.note(entry())
    trail.flush()
    assert audit.kept == []
    trail.stop()
    assert len(audit.kept) == 2


def test_whoever_knocks_without_end_does_not_fill_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audit_trail, "REFUSALS_PER_MINUTE", 5)
    monkeypatch.setattr("time.monotonic", lambda: 1000.0)
    audit = Away()
    audit.tries = 2
    trail = AuditTrail(audit)
    for _ in range(50):
        trail.note_refusal(entry())
    trail.note(entry())
    trail.flush()
    assert len(audit.kept) == 6


def test_keys_are_in_no_log(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(
        data_dir=tmp_path, port=free_port(), broker_url=shared_valkey.url, queue="tests-logs", require_keys="true"
    )
    database = Database(settings)
    database.migrate()
    keys = ApiKeys(database)
    good, revoked = (keys.create(DEFAULT_WORKSPACE, "", Scope) for _ in range(2))
    keys.revoke(revoked.key.id)
    texts = [good.text, revoked.text, make_key_text().text, good.text[:-1]]
    with started(settings) as (process, url):
        with httpx.Client(base_url=url, trust_env=False, timeout=30) as client:
            for text in texts:
                headers = {"Authorization": f"Bearer {text}"}
                for path in ("/v1/jobs", f"/v1/jobs/{text}", f"/v1/jobs?key={text}", f"/{text}", "/metrics"):
                    client.get(path, headers=headers)
                    client.delete(path, headers=headers)
                client.post("/v1/meshes", files={"file": (text, b"no mesh")}, data={"name": text}, headers=headers)
                client.get("/v1/jobs", headers={"Authorization": text})
                client.post(f"/v1/processes/{text}/execution", content=text, headers=headers)
            (tmp_path / "integument.sqlite3").rename(tmp_path / "away")  # and what is said of a failure
            client.get(f"/v1/jobs/{texts[0]}", headers={"Authorization": f"Bearer {texts[0]}"})
            (tmp_path / "away").rename(tmp_path / "integument.sqlite3")
        time.sleep(1)
        process.terminate()
        said = process.communicate(timeout=30)[1]
    assert '"outcome": "access.key_invalid"' in said
    entries = json.dumps([one.describe() for one in Audit(database).list()])
    database.close()
    files = b"".join(path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()).decode("latin-1")
    for text in texts[:3]:
        secret = text.split("_")[2]
        assert secret not in said
        assert secret not in entries
        assert secret not in files
    assert good.key.id in said


def test_the_module_is_a_program_too(tmp_path: Path) -> None:
    """`python -m server.admin`, as in a container."""
    done = subprocess.run(
        [sys.executable, "-m", "server.admin", "audit"],
        env={**os.environ, "INTEGUMENT_DATA_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["at", "workspace", "actor", "key", "action", "subject", "outcome"]
