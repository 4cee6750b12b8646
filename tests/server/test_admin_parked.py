"""`integument admin parked`: see the evidence, release the request."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from server.admin.command import admin
from store.audit import Audit
from store.database import Database
from store.jobs import Jobs
from store.lost_attempt import LastWords
from store.parked import Parked
from store.settings import PREFIX, Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import CRASHED


@pytest.fixture
def parked_job(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[str]:
    for name in [name for name in os.environ if name.startswith(PREFIX)]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("INTEGUMENT_DATA_DIR", str(tmp_path / "data"))
    database = Database(Settings())
    database.migrate()
    jobs = Jobs(database)
    job = jobs.claim(jobs.create(DEFAULT_WORKSPACE, "shells", {}, max_attempts=1).id, 1, "host:1", 30)
    assert job is not None
    jobs.fail(job.id, job.lease_token, CRASHED, retry=True, last_words=LastWords(signal="SIGSEGV", log="its last words"))
    yield job.id
    database.close()


def test_seen_and_released(parked_job: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert admin(["--json", "parked", "list"]) == 0
    [line] = json.loads(capsys.readouterr().out)
    assert (line["job"], line["process"], line["workspace"], line["attempts"]) == (parked_job, "shells", "default", 1)
    assert admin(["--json", "parked", "list", "--workspace", "other"]) == 0
    assert json.loads(capsys.readouterr().out) == []
    assert admin(["--json", "parked", "show", parked_job]) == 0
    [attempt] = json.loads(capsys.readouterr().out)["evidence"]
    assert (attempt["worker"], attempt["signal"], attempt["log"]) == ("host:1", "SIGSEGV", "its last words")
    assert admin(["parked", "show", parked_job]) == 0
    told = capsys.readouterr().out
    assert "SIGSEGV" in told
    assert told.endswith("its last words\n")
    assert admin(["parked", "release", parked_job]) == 0
    database = Database(Settings())
    assert Parked(database).list() == []
    assert Audit(database).list(limit=1)[0].action == "parked release"
    database.close()
    capsys.readouterr()
    assert admin(["parked", "release", parked_job]) == 2
    assert "parked.not_found" in capsys.readouterr().err
