"""What a worker does besides jobs: folders, unused blobs, its sign of life."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.worker.conftest import ROOT
from worker.job_folder import job_folder, sweep_job_folders
from worker.liveness import Liveness
from worker.reconciler import BLOB_GRACE_S, Reconciler
from worker.workshop import Workshop


@pytest.fixture
def workshop(settings: Settings) -> Iterator[Workshop]:
    workshop = Workshop.open(settings)
    workshop.db.migrate()
    yield workshop
    workshop.close()


def test_only_folders_nobody_works_in_are_swept(workshop: Workshop) -> None:
    scratch = workshop.settings.scratch_dir
    running, waiting = (workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {}) for _ in range(2))
    claimed = workshop.jobs.claim(running.id, 1, "me", 30)
    assert claimed is not None
    made = [f"{running.id}.{claimed.lease_token}", f"{running.id}.0", f"{waiting.id}.1", "no-job.1"]
    for name in made:
        (scratch / "jobs" / name / "out").mkdir(parents=True)
    assert sweep_job_folders(scratch, workshop.jobs) == []  # all are young
    assert {folder.name for folder in sweep_job_folders(scratch, workshop.jobs, 0.0)} == set(made[1:])
    assert [folder.name for folder in (scratch / "jobs").iterdir()] == made[:1]


def test_a_job_folder_goes_even_if_its_child_locked_it(workshop: Workshop) -> None:
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {})
    with job_folder(workshop.settings.scratch_dir, job) as folder:
        (folder / "inner").mkdir()
        (folder / "inner" / "file").touch()
        (folder / "inner").chmod(0)
    assert not folder.exists()


def test_blobs_nobody_refers_to_are_swept_when_old(workshop: Workshop) -> None:
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {})
    claimed = workshop.jobs.claim(job.id, 1, "me", 30)
    assert claimed is not None
    old, young = workshop.blobs.put_bytes(b"old"), workshop.blobs.put_bytes(b"young")
    before = time.time() - BLOB_GRACE_S - 1
    os.utime(workshop.blobs.path(old.sha256), (before, before))
    Reconciler(workshop, Liveness(workshop.settings)).sweep()
    assert [blob.sha256 for blob in workshop.blobs.all()] == [young.sha256]


def test_the_check_says_whether_the_worker_lives(settings: Settings) -> None:
    def check() -> int:
        environment = os.environ | settings.as_environment()
        return subprocess.run([sys.executable, "-m", "worker", "--check"], env=environment, cwd=ROOT, check=False).returncode

    alive = Liveness(settings)
    alive.beat()
    assert check() == 0
    [path] = settings.data_dir.glob("worker-*.alive")
    assert isinstance(path, Path)
    os.utime(path, (time.time() - 3600,) * 2)
    assert check() == 1
    alive.end()
    assert not alive.is_fresh()
