"""Slow work beside a heartbeat; and a store that hangs, which is a socket that takes connections and never answers."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from core.errors import InternalError
from store.job import Job, JobStatus, MeshInput
from store.s3_blobs import S3Blobs
from store.s3_place import S3Place
from store.settings import Settings
from store.sweep_lock import FileLock
from store.workspace import DEFAULT_WORKSPACE
from worker.aside import work_aside
from worker.outage import sit_out
from worker.supervise import supervise
from worker.workshop import Workshop

LIMIT_S = 30.0
DISMISS_S = 2.0


class StopError(Exception):
    """What the heartbeat says."""


def test_the_heart_beats_while_the_work_is_done() -> None:
    beats: list[float] = []

    def work() -> str:
        while len(beats) < 3:
            time.sleep(0.01)
        return "done"

    assert work_aside(work, lambda: beats.append(time.monotonic()), 0.01) == "done"


def test_what_the_work_raises_comes_out() -> None:
    def work() -> None:
        raise TimeoutError("of its own")

    with pytest.raises(TimeoutError, match="of its own"):
        work_aside(work, lambda: None, 0.01)


def test_work_is_left_behind_and_not_begun_again() -> None:
    tries: list[threading.Event] = []
    go_on = threading.Event()

    def work() -> None:
        tries.append(go_on)
        go_on.wait(LIMIT_S)
        raise InternalError("blobs.unavailable", "away")

    def beat() -> None:
        if tries:
            raise StopError

    with pytest.raises(StopError):
        work_aside(work, beat, 0.01)
    [thread] = [thread for thread in threading.enumerate() if thread.name == "aside"]
    go_on.set()
    thread.join(LIMIT_S)
    assert not thread.is_alive()
    assert len(tries) == 1


@pytest.fixture
def hanging(settings: Settings, tmp_path: Path) -> Iterator[Workshop]:
    with socket.create_server(("127.0.0.1", 0)) as store:
        place = S3Place.of(f"s3+http://key:secret@127.0.0.1:{store.getsockname()[1]}/bucket")
        blobs = S3Blobs(place, FileLock(tmp_path / "lock"))
        workshop = replace(Workshop.open(settings, target="tests.worker.targets:run"), blobs=blobs)
        workshop.db.migrate()
        workshop.nursery.start()
        yield workshop
        workshop.close()


def claimed(workshop: Workshop, job: Job) -> Job:
    mine = workshop.jobs.claim(job.id, 1, "me", 30)
    assert mine is not None
    return mine


def dismiss_in(workshop: Workshop, job: Job, phase: str) -> float:
    """Seconds from the request to the record, once the job is in that phase."""
    thread = threading.Thread(target=supervise, args=(workshop, claimed(workshop, job)))
    thread.start()
    deadline = time.monotonic() + LIMIT_S
    while workshop.jobs.get(DEFAULT_WORKSPACE, job.id).phase != phase:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    time.sleep(0.5)  # now it hangs
    asked = time.monotonic()
    workshop.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    thread.join(LIMIT_S)
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.DISMISSED
    return time.monotonic() - asked


def test_a_job_whose_host_cannot_reach_the_store_is_left_to_another(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("worker.aside.sit_out", partial(sit_out, patience_s=0.1))
    blobs = S3Blobs(S3Place.of("s3+http://key:secret@127.0.0.1:1/bucket"), FileLock(tmp_path / "lock"))
    workshop = replace(Workshop.open(settings, target="tests.worker.targets:run"), blobs=blobs)
    workshop.db.migrate()
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "write"})
    supervise(workshop, claimed(workshop, job))
    again = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt) == (JobStatus.ACCEPTED, 2)
    workshop.close()


def test_a_job_whose_results_hang_on_their_way_is_dismissed_at_once(hanging: Workshop) -> None:
    assert dismiss_in(hanging, hanging.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "write"}), "store") < DISMISS_S


def test_a_job_whose_meshes_hang_on_their_way_is_dismissed_at_once(hanging: Workshop) -> None:
    mesh = MeshInput("/v1/meshes/1", "skin", "0" * 64, "model/stl", "skin.stl")
    job = hanging.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "write"}, mesh_inputs=[mesh])
    assert hanging.nursery.wait_until_ready(LIMIT_S)
    assert dismiss_in(hanging, job, "start") < DISMISS_S
