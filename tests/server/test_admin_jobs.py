"""`integument admin jobs`: seen and steered across workspaces, on both databases."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from datetime import timedelta
from typing import Any

import pytest
from sqlalchemy import update

from server.admin.command import admin
from store.database import Database
from store.job import Job, JobStatus
from store.jobs import Jobs
from store.records import JobRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.postgres import PostgresServer
from tests.store.samples import CRASHED, REFUSED, claimed, finish

LAB = WorkspaceId("lab")
Run = Callable[..., Any]

pytestmark = pytest.mark.usefixtures("bare_environment")


@pytest.fixture(params=["sqlite", "postgresql"])
def db(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Database]:
    if request.param == "postgresql":
        server: PostgresServer = request.getfixturevalue("postgres")
        monkeypatch.setenv("INTEGUMENT_DATABASE_URL", server.new_database())
    database = Database(Settings())
    database.migrate()
    Workspaces(database).create("lab")
    yield database
    database.close()


@pytest.fixture
def jobs(db: Database) -> Jobs:
    return Jobs(db)


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """A command with --json; what it answered."""

    def run(*words: str) -> Any:
        capsys.readouterr()
        assert admin(["--json", "jobs", *words]) == 0, capsys.readouterr().err
        return json.loads(capsys.readouterr().out)

    return run


def failed(jobs: Jobs, failure: Any = CRASHED, process: str = "shells") -> Job:
    job = claimed(jobs, process)
    jobs.fail(job.id, job.lease_token, failure)
    return job


def test_lists_select_and_go_on(jobs: Jobs, run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    crashed, refused = failed(jobs), failed(jobs, REFUSED, "heal")
    foreign = jobs.create(LAB, "validate", {})
    done = claimed(jobs)
    assert finish(jobs, done)
    assert [line["id"] for line in run("list")] == [done.id, foreign.id, refused.id, crashed.id]
    assert [line["id"] for line in run("list", "--workspace", "lab")] == [foreign.id]
    assert [line["id"] for line in run("list", "--process", "heal", "--process", "validate")] == [foreign.id, refused.id]
    assert [(line["id"], line["said"]) for line in run("list", "--code", "child.crashed")] == [(crashed.id, "child.crashed")]
    assert {line["status"] for line in run("list", "--status", "failed")} == {"failed"}
    assert run("list", "--older-than", "1") == []
    assert admin(["jobs", "list", "--limit", "3"]) == 0
    told = capsys.readouterr()
    assert [refused.id in told.out, crashed.id in told.out] == [True, False]
    cursor = told.err.split("--cursor ")[1].strip()
    assert [line["id"] for line in run("list", "--limit", "3", "--cursor", cursor)] == [crashed.id]


def test_age_counts_from_the_end(db: Database, jobs: Jobs, run: Run) -> None:
    old, young = failed(jobs), failed(jobs)
    with db.session() as session:
        long_ago = db.now(session) - timedelta(days=9)
        session.execute(update(JobRow).values(created_at=long_ago))
        session.execute(update(JobRow).where(JobRow.id == old.id).values(finished_at=long_ago))
    assert [line["id"] for line in run("list", "--older-than", "7")] == [old.id]
    assert [line["id"] for line in run("remove", "--older-than", "7", "--yes")] == [old.id]
    assert [line["id"] for line in run("list")] == [young.id]


def test_one_job_in_full(jobs: Jobs, run: Run) -> None:
    job = failed(jobs)
    shown = run("show", job.id)
    assert (shown["id"], shown["workspace"], shown["failure"]["code"]) == (job.id, "default", "child.crashed")
    assert shown["failure"]["facts"] == {"signal": 11}


def test_failed_jobs_are_queued_again_by_their_code(jobs: Jobs, run: Run) -> None:
    crashed, refused = [failed(jobs), failed(jobs)], failed(jobs, REFUSED)
    again = run("retry", "--code", "child.crashed", "--yes")
    assert {(line["id"], line["was"], line["is"]) for line in again} == {(job.id, "failed", "accepted") for job in crashed}
    assert jobs.get(DEFAULT_WORKSPACE, refused.id).status is JobStatus.FAILED
    # nobody rang for them: the reconciler does
    assert set(jobs.due_to_ring(30)) == {(job.id, 2) for job in crashed}
    assert admin(["--json", "audit"]) == 0


def test_waiting_jobs_end_at_once_and_running_ones_are_asked(jobs: Jobs, run: Run) -> None:
    waiting, running = jobs.create(LAB, "validate", {}), claimed(jobs)
    told = {line["id"]: line["is"] for line in run("dismiss", waiting.id, running.id)}
    assert told == {waiting.id: "dismissed", running.id: "being dismissed"}
    assert jobs.renew(running.id, running.lease_token, 30).dismiss_requested


def test_what_is_removed_is_gone_and_noted(jobs: Jobs, run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    job = failed(jobs)
    assert run("remove", job.id, "--yes")[0]["is"] == "removed"
    assert run("list") == []
    assert admin(["--json", "audit"]) == 0
    noted = json.loads(capsys.readouterr().out.splitlines()[0])
    assert (noted["action"], noted["subject"], noted["workspace"]) == ("jobs remove", job.id, "default")


def test_slips_change_nothing(jobs: Jobs, capsys: pytest.CaptureFixture[str]) -> None:
    ended, running = failed(jobs), claimed(jobs)
    for words, code in (
        (("remove", ended.id), "admin.not_confirmed"),
        (("remove", running.id, "--yes"), "job.not_finished"),
        (("dismiss", ended.id), "job.finished"),
        (("retry", running.id), "job.not_retryable"),
        (("retry", "--code", "child.crashed"), "admin.not_confirmed"),
        (("retry", "--yes"), "admin.nothing_selected"),
        (("retry", ended.id, "--code", "child.crashed"), "admin.nothing_selected"),
        (("show", "nothing"), "job.not_found"),
        (("list", "--cursor", "?"), "cursor.invalid"),
    ):
        assert admin(["jobs", *words]) == 2
        assert code in capsys.readouterr().err
    assert jobs.get(DEFAULT_WORKSPACE, ended.id).status is JobStatus.FAILED
    assert jobs.get(DEFAULT_WORKSPACE, running.id).status is JobStatus.RUNNING
