"""The doctor finds what is broken on purpose, says what to do, and lets the healthy go."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import update

from core.schema.expectation import JobQueue
from server.admin.command import admin
from server.doctor.diagnosis import Diagnosis, Health
from server.doctor.examine import examine
from server.doctor.patient import Patient
from store.audit import Audit, AuditEntry
from store.database import Database
from store.job import JobOutput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.open_blobs import open_blobs
from store.records import AuditRow, JobRow
from store.settings import PREFIX, Settings
from store.version import SERVER_VERSION
from store.workers import Workers, WorkerWord
from store.workspace import DEFAULT_WORKSPACE
from tests.embedded import embedded
from tests.postgres import PostgresServer
from tests.seaweed import SeaweedServer
from tests.store.samples import CRASHED, claimed
from tests.valkey import ValkeyServer

Look = Callable[..., dict[str, Diagnosis]]


@pytest.fixture(autouse=True)
def _bare_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in [name for name in os.environ if name.startswith(PREFIX)]:
        monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def settings(tmp_path: Path, shared_valkey: ValkeyServer) -> Settings:
    return Settings(data_dir=tmp_path / "data", broker_url=shared_valkey.url)


@pytest.fixture
def db(settings: Settings) -> Iterator[Database]:
    database = Database(settings)
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def look(settings: Settings, db: Database) -> Look:
    """The findings by their part."""

    def look(*, deep: bool = False, **changes: Any) -> dict[str, Diagnosis]:
        changed = settings.model_copy(update=changes)
        return {one.part: one for one in examine(Patient(changed, db, open_blobs(changed, db), deep))}

    return look


def word(name: str = "host:1", version: str = SERVER_VERSION) -> WorkerWord:
    return WorkerWord(name, "host", version, 2, 8, 8)


def noted(db: Database, action: str, days_ago: float = 0.0) -> None:
    with db.reading() as session:
        at = db.now(session) - timedelta(days=days_ago)
    Audit(db).write([AuditEntry(at, "admin", None, DEFAULT_WORKSPACE, action, "x", "done")])


def finished(db: Database, blobs: LocalBlobs, content: bytes) -> str:
    job, blob = claimed(Jobs(db)), blobs.put_bytes(content)
    output = JobOutput(blob.sha256, blob.size, "application/zip", "package.zip")
    Jobs(db).finish(job.id, job.lease_token, verdict="simulation_ready", summary="", outputs={"package": output}, timings_s={})
    return blob.sha256


def test_a_healthy_server_is_let_go(db: Database, settings: Settings, look: Look) -> None:
    Workers(db, settings).beat(word())
    noted(db, "backup")
    finished(db, LocalBlobs(settings.blob_dir), b"result")
    found = look(deep=True)
    assert {part: one for part, one in found.items() if one.health is Health.WRONG} == {}
    for part in (
        "disk",
        "permissions",
        "database",
        "database file",
        "clock",
        "broker",
        "store",
        "workers",
        "jobs",
        "files",
        "contents",
    ):
        assert found[part].health is Health.OK, found[part]
    assert "1 are named by rows" in found["files"].said


def test_lost_and_corrupt_files_are_found(db: Database, settings: Settings, look: Look) -> None:
    blobs = LocalBlobs(settings.blob_dir)
    lost, rotten = finished(db, blobs, b"lost"), finished(db, blobs, b"rotten")
    blobs.delete(lost)
    blobs.path(rotten).chmod(0o600)
    blobs.path(rotten).write_bytes(b"r0tten")
    found = look()
    assert found["files"].health is Health.WRONG
    assert lost in found["files"].said
    assert "contents" not in found
    assert "restore" in found["files"].advice
    deep = look(deep=True)["contents"]
    assert (deep.health, rotten in deep.said) == (Health.WRONG, True)


def test_work_that_is_stuck_is_found(db: Database, settings: Settings, look: Look) -> None:
    jobs = Jobs(db)
    assert look()["workers"].health is Health.WRONG
    Workers(db, settings).beat(word())
    Workers(db, settings).beat(word("host:2", "0.0.0"))
    assert "0.0.0" in look()["versions"].said
    waiting, running, failed = jobs.create(DEFAULT_WORKSPACE, "heal", {}), claimed(jobs), claimed(jobs)
    jobs.fail(failed.id, failed.lease_token, CRASHED)
    assert look()["jobs"].health is Health.OK
    assert "1 jobs failed" in look()["failures"].said
    with db.session() as session:
        long_ago = db.now(session) - timedelta(hours=2)
        session.execute(update(JobRow).where(JobRow.id == waiting.id).values(queued_at=long_ago))
    assert look()["jobs"].health is Health.WARNING
    with db.session() as session:
        session.execute(update(JobRow).where(JobRow.id == running.id).values(lease_until=long_ago))
    assert look()["jobs"].health is Health.WRONG


def test_a_queue_that_nobody_serves_is_found(db: Database, settings: Settings, look: Look) -> None:
    Workers(db, settings).beat(replace(word(), queues=(JobQueue.FAST,)))
    assert look()["queue heavy"].health is Health.WARNING
    Jobs(db).create(DEFAULT_WORKSPACE, "heal", {})
    found = look()
    assert (found["queue heavy"].health, found["queue heavy"].said) == (
        Health.WRONG,
        "no living worker takes heavy jobs; 1 wait",
    )
    assert "queue fast" not in found
    Workers(db, settings).beat(word("host:2"))
    assert "queue heavy" not in look()


def test_places_that_are_open_or_full_are_found(settings: Settings, look: Look, tmp_path: Path) -> None:
    settings.data_dir.chmod(0o755)
    (tmp_path / ".env").write_text("SECRET=1")
    (tmp_path / ".env").chmod(0o644)
    found = look(disk_floor_bytes=2**60, host="0.0.0.0")
    assert (found["permissions"].health, found["permissions"].advice) == (Health.WRONG, "chmod 600 .env")
    assert found["disk"].health is Health.WRONG
    assert found["access"].health is Health.WRONG


def test_backends_that_do_not_answer_are_found(db: Database, settings: Settings, tmp_path: Path) -> None:
    changed = settings.model_copy(
        update={"broker_url": f"redis+socket://{tmp_path}/nobody", "blobs_url": "s3+http://key:secret@127.0.0.1:1/bucket"}
    )
    found = {one.part: one for one in examine(Patient(changed, db, open_blobs(changed, db), deep=False))}
    assert found["broker"].health is Health.WRONG
    assert "blobs.unavailable" in found["backends"].said
    assert found["jobs"].health is Health.OK, "the other looks go on"
    assert "secret" not in str(found)


def test_a_damaged_database_file_is_found(settings: Settings, db: Database, look: Look) -> None:
    for _ in range(30):
        Jobs(db).create(DEFAULT_WORKSPACE, "heal", {"text": "x" * 4000})
    db.close()
    path = db.sqlite_path
    Database(settings).close()
    with path.open("r+b") as file:
        file.seek(path.stat().st_size // 2)
        file.write(b"\xff" * 8192)
    assert any(
        one.health is Health.WRONG for part, one in look().items() if part in ("database file", "backends", "work", "files")
    )


def test_old_backups_are_told(db: Database, look: Look) -> None:
    assert look()["backup"].health is Health.WARNING
    noted(db, "backup", days_ago=8)
    assert "8.0 days" in look()["backup"].said
    noted(db, "backup")
    assert look()["backup"].health is Health.OK
    with db.session() as session:
        session.execute(update(AuditRow).values(outcome="storage.full"))
    assert look()["backup"].health is Health.WARNING


def test_the_lab_is_looked_at_too(
    postgres: PostgresServer, seaweed: SeaweedServer, shared_valkey: ValkeyServer, tmp_path: Path
) -> None:
    settings = Settings(
        data_dir=tmp_path / "lab",
        database_url=postgres.new_database(),
        blobs_url=seaweed.new_bucket(),
        broker_url=shared_valkey.url,
    )
    db = Database(settings)
    db.migrate()
    found = {one.part: one for one in examine(Patient(settings, db, open_blobs(settings, db), deep=True))}
    db.close()
    assert {part for part, one in found.items() if one.health is Health.WRONG} == {"workers"}
    assert "object store" in found["store"].said


def test_the_command_on_a_running_and_on_a_stopped_server(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--json", "--data-dir", str(tmp_path / "data"), "doctor"]
    with embedded(tmp_path / "data"):
        code = admin(words)
        found = {one["part"]: one for one in json.loads(capsys.readouterr().out)}
        assert code == 0, found
        assert found["workers"]["said"].startswith("1 alive")
    assert admin(words) == 1
    found = {one["part"]: one for one in json.loads(capsys.readouterr().out)}
    assert {part for part, one in found.items() if one["health"] == "wrong"} == {"broker", "workers"}
