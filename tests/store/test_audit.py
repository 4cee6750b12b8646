"""The audit log keeps what it is told, without secrets, for its time, on both databases."""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta

from store.audit import DONE, Audit, AuditEntry
from store.database import Database
from store.key_text import make_key_text
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

NOW = datetime.now(UTC)


def entry(age: timedelta = timedelta(0), workspace: str | None = DEFAULT_WORKSPACE, subject: str = "/v1/jobs/1") -> AuditEntry:
    owner = None if workspace is None else WorkspaceId(workspace)
    return AuditEntry(NOW - age, "key", "abcdefghijkl", owner, "POST /v1/jobs/{id}/retry", subject, DONE, "r-1")


def test_entries_come_back_newest_first(db: Database) -> None:
    audit = Audit(db)
    old, young, other = entry(timedelta(hours=2)), entry(), entry(timedelta(hours=1), "lab-b")
    audit.write([old, young])
    audit.write([other])
    audit.write([])
    assert audit.list() == [young, other, old]
    assert audit.list(workspace=DEFAULT_WORKSPACE) == [young, old]
    assert audit.list(since=NOW - timedelta(minutes=90)) == [young, other]
    assert audit.list(limit=1) == [young]


def test_old_entries_are_forgotten(db: Database) -> None:
    audit = Audit(db)
    audit.write([entry(), entry(timedelta(days=31)), entry(timedelta(days=29), None)])
    assert audit.sweep(30.0) == 1
    assert len(audit.list()) == 2
    assert audit.sweep(30.0) == 0


def test_no_secret_and_nothing_endless_is_kept(db: Database) -> None:
    audit, key = Audit(db), make_key_text()
    hostile = entry(subject=f"/v1/jobs/{key.text}/\x00\ud800" + "x" * 10_000)
    audit.write([hostile])
    (kept,) = audit.list()
    for said in (kept.subject, json.dumps(kept.describe()), json.dumps(hostile.describe())):
        assert key.text.split("_")[2] not in said
        assert key.id in said
        assert len(said) < 1000
