"""Checkpoints live while they may be of use to a job that asked for the same; only who holds the lease adds any."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy import update

from core.errors import InputError, InternalError
from store.blobs import Blobs
from store.checkpoint import CORRECTED, Checkpoint
from store.checkpoints import MOST, Checkpoints
from store.database import Database
from store.job import Job, JobFailure, MeshInput
from store.jobs import Jobs
from store.records import JobRow
from store.references import References
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces

REFUSED = JobFailure.of(InputError("mesh.empty", "nothing there"))
LIMIT = 1_000


@pytest.fixture
def checkpoints(db: Database) -> Checkpoints:
    return Checkpoints(db, LIMIT)


def mesh(href: str, digit: str) -> MeshInput:
    return MeshInput(href, "skin", digit * 64, "application/x-integument-mesh", "skin.stl")


def running(jobs: Jobs, inputs: Mapping[str, Any] | None = None, workspace: WorkspaceId = DEFAULT_WORKSPACE) -> Job:
    job = jobs.create(workspace, "shells", inputs or {})
    claimed = jobs.claim(job.id, 1, "host:1", 30)
    assert claimed is not None
    return claimed


def step(number: int, size: int = 10) -> Checkpoint:
    return Checkpoint(f"{number:064x}", f"step {number}", f"{number + 1000:064x}", size)


def test_the_next_attempt_and_an_equal_request_find_them(jobs: Jobs, db: Database, checkpoints: Checkpoints) -> None:
    first = running(jobs, {"depth": 1})
    for number in (2, 1):
        assert checkpoints.keep(first.id, first.lease_token, step(number))
    assert checkpoints.keep(first.id, first.lease_token, step(2)), "twice is once"
    assert checkpoints.of(first.id) == (step(2), step(1))
    jobs.fail(first.id, first.lease_token, REFUSED)
    assert checkpoints.of(running(jobs, {"depth": 1}).id) == (step(2), step(1))
    assert checkpoints.of(running(jobs, {"depth": 2}).id) == ()
    Workspaces(db).create("other")
    assert checkpoints.of(running(jobs, {"depth": 1}, WorkspaceId("other")).id) == ()
    assert checkpoints.of("no-such-job") == ()


def test_a_request_is_the_same_by_content_not_by_link(jobs: Jobs, checkpoints: Checkpoints) -> None:
    def job(href: str, digit: str) -> Job:
        inputs = {"skin": {"href": href, "title": href}, "layers": [{"name": "fat"}]}
        made = jobs.create(DEFAULT_WORKSPACE, "shells", inputs, mesh_inputs=[mesh(href, digit)])
        claimed = jobs.claim(made.id, 1, "host:1", 30)
        assert claimed is not None
        return claimed

    first = job("/v1/meshes/a", "1")
    assert checkpoints.keep(first.id, first.lease_token, step(1))
    assert checkpoints.of(job("/v1/meshes/b", "1").id) == (step(1),)
    assert checkpoints.of(job("/v1/meshes/a", "2").id) == ()


def test_a_corrected_request_goes_on_from_the_one_that_failed(jobs: Jobs, checkpoints: Checkpoints) -> None:
    def job(digits: str, depth: int, process: str = "prepare") -> Job:
        meshes = [mesh(f"/v1/meshes/{digit}", digit) for digit in digits]
        made = jobs.create(DEFAULT_WORKSPACE, process, {"depth": depth}, mesh_inputs=meshes)
        claimed = jobs.claim(made.id, 1, "host:1", 30)
        assert claimed is not None
        return claimed

    first = job("12", 1)
    assert checkpoints.keep(first.id, first.lease_token, step(1))
    assert checkpoints.of(job("12", 2).id) == (), "it may still succeed"
    jobs.fail(first.id, first.lease_token, REFUSED)
    assert checkpoints.of(job("12", 2).id) == checkpoints.of(job("123", 2).id) == (step(1),)
    assert checkpoints.of(job("13", 2).id) == (), "it never saw the file 2"
    assert checkpoints.of(job("12", 2, "shells").id) == ()
    second = job("12", 3)
    assert checkpoints.keep(second.id, second.lease_token, step(2))
    assert jobs.finish(second.id, second.lease_token, verdict="simulation_ready", summary="", outputs={}, timings_s={})
    assert checkpoints.of(job("12", 4).id) == (step(1),), "of another request: it may be corrected in another way, too"


def test_only_the_last_failures_are_gone_on_from(jobs: Jobs, checkpoints: Checkpoints) -> None:
    for number in range(CORRECTED + 2):
        made = jobs.create(DEFAULT_WORKSPACE, "prepare", {"depth": number}, mesh_inputs=[mesh("/v1/meshes/1", "1")])
        job = jobs.claim(made.id, 1, "host:1", 30)
        assert job is not None
        assert checkpoints.keep(job.id, job.lease_token, step(number))
        jobs.fail(job.id, job.lease_token, REFUSED)
    last = jobs.create(DEFAULT_WORKSPACE, "prepare", {"depth": -1}, mesh_inputs=[mesh("/v1/meshes/1", "1")])
    assert checkpoints.of(last.id) == tuple(step(number) for number in range(2, CORRECTED + 2))


def test_who_lost_the_lease_keeps_nothing(jobs: Jobs, checkpoints: Checkpoints) -> None:
    job = running(jobs)
    jobs.expire_leases(datetime.now(UTC) + timedelta(days=1))
    assert not checkpoints.keep(job.id, job.lease_token, step(1))
    assert checkpoints.of(job.id) == ()


def test_bytes_and_number_are_bounded(jobs: Jobs, db: Database, checkpoints: Checkpoints) -> None:
    job = running(jobs)
    assert checkpoints.keep(job.id, job.lease_token, step(1, LIMIT))
    assert not checkpoints.keep(job.id, job.lease_token, step(2, 1))
    many = running(jobs)
    for number in range(MOST):
        assert checkpoints.keep(many.id, many.lease_token, step(number, 0))
    assert not checkpoints.keep(many.id, many.lease_token, step(MOST, 0))
    with pytest.raises(InternalError, match="SHA-256"):
        checkpoints.keep(job.id, job.lease_token, Checkpoint("../../etc", "", "0" * 64, 0))


def test_they_go_with_success_and_dismissal_but_not_with_failure(jobs: Jobs, checkpoints: Checkpoints) -> None:
    one, other = running(jobs), running(jobs)
    for number, job in enumerate((one, other)):
        assert checkpoints.keep(job.id, job.lease_token, step(number))
    jobs.dismiss(DEFAULT_WORKSPACE, one.id)
    assert not checkpoints.keep(one.id, one.lease_token, step(7)), "it is being dismissed"
    assert jobs.confirm_dismissed(one.id, one.lease_token)
    assert checkpoints.of(one.id) == checkpoints.of(other.id) == (step(1),)
    third = running(jobs)
    assert checkpoints.keep(third.id, third.lease_token, step(3))
    jobs.fail(third.id, third.lease_token, REFUSED)
    assert checkpoints.of(third.id) == (step(1), step(3))
    assert jobs.finish(other.id, other.lease_token, verdict="simulation_ready", summary="", outputs={}, timings_s={})
    assert checkpoints.of(third.id) == (), "done once, nobody needs them"


def test_the_sweep_takes_those_of_old_failures(jobs: Jobs, db: Database, checkpoints: Checkpoints) -> None:
    failed, alive = running(jobs, {"a": 1}), running(jobs, {"a": 2})
    for job in (failed, alive):
        assert checkpoints.keep(job.id, job.lease_token, step(1))
    jobs.fail(failed.id, failed.lease_token, REFUSED)
    with db.session() as session:
        session.execute(update(JobRow).values(finished_at=datetime.now(UTC) - timedelta(days=2)).where(JobRow.id == failed.id))
    assert checkpoints.sweep(3) == 0
    assert checkpoints.sweep(1) == 1
    assert (checkpoints.of(failed.id), checkpoints.of(alive.id)) == ((), (step(1),))


def test_their_bytes_are_kept_while_they_live(jobs: Jobs, db: Database, checkpoints: Checkpoints, blobs: Blobs) -> None:
    job = running(jobs)
    blob = blobs.put_bytes(b"sheet")
    assert checkpoints.keep(job.id, job.lease_token, Checkpoint("0" * 64, "step", blob.sha256, blob.size))
    references = References(db)
    assert blobs.sweep(references.all(), older_than_s=-1.0) == []
    jobs.fail(job.id, job.lease_token, REFUSED)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)  # removes it
    assert blobs.sweep(references.all(), older_than_s=-1.0) == [blob]


def test_a_job_of_an_older_server_finds_its_own(jobs: Jobs, db: Database, checkpoints: Checkpoints) -> None:
    old, other = running(jobs), running(jobs)
    with db.session() as session:
        session.execute(update(JobRow).values(fingerprint=None))
    assert checkpoints.keep(old.id, old.lease_token, step(1))
    assert checkpoints.of(old.id) == (step(1),)
    assert checkpoints.of(other.id) == ()
