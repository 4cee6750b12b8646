"""One attempt without Celery: a real nursery, a real job table, and no broker at all."""

from __future__ import annotations

import errno
import logging
import sqlite3
import threading
import time
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from store.job import Job, JobStatus, MeshInput
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.sandbox.ending import wait_for_end
from tests.worker.conftest import Service
from worker.supervise import supervise
from worker.task import run_job
from worker.workshop import Workshop


def claim(workshop: Workshop, act: str, **inputs: object) -> Job:
    return take(workshop, workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": act, **inputs}))


def take(workshop: Workshop, job: Job) -> Job:
    claimed = workshop.jobs.claim(job.id, 1, "me", 30)
    assert claimed is not None
    return claimed


def in_background(workshop: Workshop, job: Job) -> threading.Thread:
    thread = threading.Thread(target=supervise, args=(workshop, job))
    thread.start()
    return thread


def test_a_job_ends_without_any_broker(workshop: Workshop) -> None:
    job = claim(workshop, "write")
    supervise(workshop, job)
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.SUCCESSFUL
    assert list((workshop.settings.scratch_dir / "jobs").iterdir()) == []


def test_who_lost_the_lease_ends_the_child_and_writes_nothing(workshop: Workshop, bench: Service) -> None:
    job = claim(workshop, "sleep", seconds=60)
    thread = in_background(workshop, job)
    child = bench.wait_for_child(job)
    [lost] = workshop.jobs.expire_leases(datetime.now(UTC) + timedelta(days=1))
    thread.join(10)
    assert wait_for_end([child], 0.0) == []
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id) == lost
    assert (lost.status, lost.attempt) == (JobStatus.ACCEPTED, 2)


def test_a_removed_job_ends_its_child(workshop: Workshop, bench: Service) -> None:
    job = claim(workshop, "sleep", seconds=60)
    thread = in_background(workshop, job)
    child = bench.wait_for_child(job)
    with closing(sqlite3.connect(workshop.settings.data_dir / "integument.sqlite3", isolation_level=None)) as database:
        database.execute("PRAGMA foreign_keys=ON")
        database.execute("DELETE FROM jobs WHERE id = ?", (job.id,))
    thread.join(10)
    assert wait_for_end([child], 0.0) == []


def test_a_job_that_met_a_full_disk_is_tried_once_more(workshop: Workshop) -> None:
    job = claim(workshop, "full_disk")
    supervise(workshop, job)
    again = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt) == (JobStatus.ACCEPTED, 2)
    last = workshop.jobs.claim(job.id, 2, "me", 30)
    assert last is not None
    supervise(workshop, last)
    failure = workshop.jobs.get(DEFAULT_WORKSPACE, job.id).failure
    assert failure is not None
    assert failure.code == "storage.full"


def test_a_disk_that_is_full_before_the_job_has_a_folder_is_foreseen(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def mkdir(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "no room")

    caplog.set_level(logging.INFO, "worker.task")
    job = claim(workshop, "write")
    with monkeypatch.context() as full:
        full.setattr(Path, "mkdir", mkdir)
        run_job(workshop, job, lambda: None)
    again = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt) == (JobStatus.ACCEPTED, 2)
    assert [record.levelname for record in caplog.records if record.name == "worker.task"] == ["INFO", "WARNING"]


def test_a_missing_blob_fails_the_job(workshop: Workshop) -> None:
    mesh = MeshInput("/v1/meshes/1", "skin", "0" * 64, "model/stl", "skin.stl")
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {}, mesh_inputs=[mesh])
    run_job(workshop, take(workshop, job), lambda: None)
    failed = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert failed.failure is not None
    assert failed.failure.code == "blob.missing"


def test_an_error_of_the_worker_itself_fails_the_job_and_goes_no_further(workshop: Workshop, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    broken = replace(workshop, settings=workshop.settings.model_copy(update={"data_dir": tmp_path / "file"}))
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "write"})
    run_job(broken, take(workshop, job), lambda: None)
    failed = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert failed.failure is not None
    assert failed.failure.code == "worker.raised"


def test_a_job_can_be_dismissed_and_keeps_its_lease_while_the_nursery_loads(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "slow_processes.py").write_text("import time\ntime.sleep(60)\n")
    monkeypatch.syspath_prepend(tmp_path)
    workshop = Workshop.open(settings, target="slow_processes:run")
    workshop.db.migrate()
    job = claim(workshop, "write")
    thread = in_background(workshop, job)
    time.sleep(settings.heartbeat_s + 0.3)
    held = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert job.lease_until is not None
    assert held.lease_until is not None
    assert held.lease_until < job.lease_until  # claimed for 30 s, renewed for lease_s
    assert (held.phase, "kernels are compiled" in (held.message or "")) == ("load the libraries", True)
    asked = time.monotonic()
    workshop.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    thread.join(10)
    assert time.monotonic() - asked < 2
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.DISMISSED
    workshop.close()


def test_a_nursery_that_cannot_load_fails_the_job(settings: Settings) -> None:
    workshop = Workshop.open(settings, target="no_such_module:run")
    workshop.db.migrate()
    job = claim(workshop, "write")
    supervise(workshop, job)
    failed = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert failed.failure is not None
    assert failed.failure.code == "nursery.preload_failed"
    workshop.close()


def test_a_database_that_is_away_for_a_while_costs_nothing(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("store.database.BUSY_TIMEOUT_S", 0.1)
    workshop = Workshop.open(settings, target="tests.worker.targets:run")
    workshop.db.migrate()
    job = claim(workshop, "sleep", seconds=0.5)
    with closing(sqlite3.connect(settings.data_dir / "integument.sqlite3", isolation_level=None)) as other:
        thread = in_background(workshop, job)
        other.execute("BEGIN EXCLUSIVE")
        time.sleep(3)  # several heartbeats, and the end of the child
        assert thread.is_alive()
        other.execute("ROLLBACK")
    thread.join(15)
    done = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 1)
    workshop.close()
