"""A job that is held is given only while its row, and what its workspace says, are as they were."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from sqlalchemy import text

from core.errors import StateError
from store.database import Database
from store.job import Job, JobOutput
from store.job_words import JobWords
from store.jobs import Jobs
from store.recent_jobs import HELD_JOBS, LARGEST_INPUTS, RecentJobs
from store.retention_policy import OwnRetention, RetentionPolicies, RetentionPolicy
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

ELSE = WorkspaceId("elsewhere")


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def jobs(database: Database) -> Jobs:
    return Jobs(database, retention=RetentionPolicies(database, RetentionPolicy(30.0, 30.0, 30.0)))


@pytest.fixture
def recent(database: Database, jobs: Jobs) -> Iterator[RecentJobs]:
    recent = RecentJobs(database, jobs)
    yield recent
    recent.close()


def finish(jobs: Jobs, job: Job) -> None:
    claimed = jobs.claim(job.id, 1, "host:1", 60.0)
    assert claimed is not None
    outputs = {"report": JobOutput("0" * 64, 3, "application/json", "report.json")}
    assert jobs.finish(job.id, claimed.lease_token, verdict="simulation_ready", summary="", outputs=outputs, timings_s={})


CHANGES: dict[str, Callable[[Jobs, Job], object]] = {
    "claimed": lambda jobs, job: jobs.claim(job.id, 1, "host:1", 60.0),
    "dismissed": lambda jobs, job: jobs.dismiss(DEFAULT_WORKSPACE, job.id),
    "finished": finish,
    "named": lambda jobs, job: jobs.call(DEFAULT_WORKSPACE, job.id, lambda _: JobWords("a name", ("label",))),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_change_is_seen_at_once(jobs: Jobs, recent: RecentJobs, change: Callable[[Jobs, Job], object]) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "validate", {})
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) is None
    assert recent.get(DEFAULT_WORKSPACE, job.id) == job
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) == job
    change(jobs, job)
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) is None
    assert recent.get(DEFAULT_WORKSPACE, job.id) == jobs.get(DEFAULT_WORKSPACE, job.id) != job
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) == jobs.get(DEFAULT_WORKSPACE, job.id)


def test_when_it_expires_follows_its_workspace(database: Database, jobs: Jobs, recent: RecentJobs) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "validate", {})
    finish(jobs, job)
    before = recent.get(DEFAULT_WORKSPACE, job.id)
    policies = RetentionPolicies(database, RetentionPolicy(30.0, 30.0, 30.0))
    policies.set(DEFAULT_WORKSPACE, OwnRetention(1.0, None, None))
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) is None
    after = recent.get(DEFAULT_WORKSPACE, job.id)
    assert before.expires_at is not None
    assert after.expires_at is not None
    assert (before.expires_at - after.expires_at).days == 29


def test_what_is_removed_or_foreign_is_not_there(jobs: Jobs, recent: RecentJobs) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "validate", {})
    recent.get(DEFAULT_WORKSPACE, job.id)
    assert recent.get_at_once(ELSE, job.id) is None
    with pytest.raises(StateError, match="there is no job"):
        recent.get(ELSE, job.id)
    finish(jobs, job)
    recent.get(DEFAULT_WORKSPACE, job.id)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert recent.get_at_once(DEFAULT_WORKSPACE, job.id) is None
    with pytest.raises(StateError, match="there is no job"):
        recent.get(DEFAULT_WORKSPACE, job.id)


def test_little_is_held(database: Database, jobs: Jobs, recent: RecentJobs) -> None:
    long = jobs.create(DEFAULT_WORKSPACE, "validate", {"text": "x" * LARGEST_INPUTS})
    recent.get(DEFAULT_WORKSPACE, long.id)
    assert recent.get_at_once(DEFAULT_WORKSPACE, long.id) is None
    with database.session() as session:
        made = [jobs.create(DEFAULT_WORKSPACE, "validate", {}, session=session) for _ in range(HELD_JOBS + 1)]
    for job in made:
        recent.get(DEFAULT_WORKSPACE, job.id)
    assert recent.get_at_once(DEFAULT_WORKSPACE, made[0].id) is None
    assert recent.get_at_once(DEFAULT_WORKSPACE, made[-1].id) == made[-1]
    with database.session() as session:
        session.execute(text("DELETE FROM jobs"))
    assert recent.get_at_once(DEFAULT_WORKSPACE, made[-1].id) is None
