"""The scratch folder of one attempt: `scratch/jobs/<job id>.<fencing token>`."""

from __future__ import annotations

import logging
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from store.job import Job
from store.jobs import Jobs
from worker.scratch_room import room_needed

logger = logging.getLogger(__name__)

ORPHAN_S = 60.0  # a folder whose job has just ended is still being removed by its worker


@contextmanager
def job_folder(scratch_dir: Path, job: Job) -> Iterator[Path]:
    """Made for the attempt, gone with it. The job must be running before: a folder without a running job is swept.

    Raises LimitError `storage.full`."""
    folder = scratch_dir / "jobs" / f"{job.id}.{job.lease_token}"
    with room_needed():
        folder.mkdir(parents=True, mode=0o700)
    try:
        yield folder
    finally:
        _remove(folder)


def sweep_job_folders(scratch_dir: Path, jobs: Jobs, older_than_s: float = ORPHAN_S) -> list[Path]:
    """Remove what killed workers left; returns it."""
    found = find_job_folders(scratch_dir, jobs, older_than_s)
    for folder in found:
        _remove(folder)
    return found


def find_job_folders(scratch_dir: Path, jobs: Jobs, older_than_s: float = ORPHAN_S) -> list[Path]:
    """The folders of attempts nobody works on."""
    found = []
    for folder in (scratch_dir / "jobs").glob("*.*"):
        job_id, _, token = folder.name.rpartition(".")
        with suppress(FileNotFoundError):  # its worker was quicker
            is_old = time.time() - folder.stat().st_mtime > older_than_s
            if is_old and not (token.isdecimal() and jobs.is_held(job_id, int(token))):
                found.append(folder)
    return found


def _remove(folder: Path) -> None:
    """A child may leave folders that it made unreadable; what cannot be removed even so is said and left to the next sweep."""
    shutil.rmtree(folder, ignore_errors=True)
    if folder.exists():
        for here, _, _ in os.walk(folder):
            os.chmod(here, 0o700)
        shutil.rmtree(folder, ignore_errors=True)
    if folder.exists():
        logger.warning("cannot remove %s", folder)
