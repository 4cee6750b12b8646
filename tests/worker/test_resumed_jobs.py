"""A second attempt takes the finished steps of the first, whatever ended that; a request that kills is parked."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Thread

import pytest

from store.job import Job, JobStatus
from store.parked import Parked
from store.references import References
from store.workspace import DEFAULT_WORKSPACE
from tests.worker.conftest import LIMIT_S, Service
from worker.closing import Closing
from worker.last_words import without_places
from worker.supervise import supervise
from worker.workshop import Workshop

TAKEN = "step 0: taken from the attempt before"


def claim(workshop: Workshop, attempt: int = 1, job: Job | None = None, **inputs: object) -> Job:
    job = job or workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "steps", **inputs})
    claimed = workshop.jobs.claim(job.id, attempt, "host:1", 30)
    assert claimed is not None
    return claimed


def lines(service: Service, job: Job) -> list[str]:
    return [event.data["message"] for event in service.events.after(DEFAULT_WORKSPACE, job.id) if event.type == "log"]


def report(workshop: Workshop, job: Job) -> bytes:
    done = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert done.status is JobStatus.SUCCESSFUL, done
    with workshop.blobs.open(done.outputs["report"].sha256) as file:
        return file.read()


def wait_for(condition: Callable[[], object], log: Callable[[], str] = str) -> None:
    deadline = time.monotonic() + 3 * LIMIT_S
    while not condition():
        assert time.monotonic() < deadline, log()
        time.sleep(0.02)


def test_after_a_crash_the_same_bytes_without_the_step_done(workshop: Workshop, bench: Service) -> None:
    plain = claim(workshop, generation="plain")
    supervise(workshop, plain)
    job = claim(workshop, end="segfault")
    supervise(workshop, job)
    again = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt) == (JobStatus.ACCEPTED, 2)
    [kept] = workshop.checkpoints.of(job.id)
    assert kept.stage == "step 0"
    supervise(workshop, claim(workshop, 2, job))
    assert TAKEN in lines(bench, job)
    assert report(workshop, job) == report(workshop, plain)
    assert workshop.checkpoints.of(job.id) == ()
    assert kept.sha256 not in References(workshop.db).all()
    assert list((workshop.settings.scratch_dir / "jobs").iterdir()) == []


@pytest.mark.parametrize("damage", ["gone", "other bytes"])
def test_a_step_whose_bytes_are_gone_is_made_again(workshop: Workshop, bench: Service, damage: str) -> None:
    job = claim(workshop, end="segfault", damage=damage)
    supervise(workshop, job)
    [kept] = workshop.checkpoints.of(job.id)
    path = workshop.settings.blob_dir / kept.sha256[:2] / kept.sha256[2:4] / kept.sha256
    path.unlink()
    if damage == "other bytes":
        path.write_bytes(b"other bytes")
    job = claim(workshop, 2, job)
    if damage == "other bytes":
        supervise(workshop, job)
    else:  # nothing found, so it ends as the first time; it must not fail for the missing blob
        supervise(workshop, job)
        assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).failure is not None
    assert TAKEN not in lines(bench, job)


def test_a_worker_told_to_stop_hands_on_what_is_done(workshop: Workshop, bench: Service) -> None:
    job = claim(workshop, end="sleep", why="drain")
    thread = Thread(target=supervise, args=(workshop, job))
    thread.start()
    wait_for(lambda: workshop.checkpoints.of(job.id))
    workshop.closing.begin()
    thread.join(LIMIT_S)
    assert not thread.is_alive()
    supervise(replace(workshop, closing=Closing(drain_s=0)), claim(workshop, 1, job))
    assert TAKEN in lines(bench, job)
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).attempt == 1


def test_a_retry_and_an_equal_request_go_on_where_a_failed_job_ended(workshop: Workshop, bench: Service) -> None:
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "steps", "end": "segfault", "why": "retry"}, max_attempts=1)
    supervise(workshop, claim(workshop, 1, job))
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.FAILED
    twin = claim(workshop, end="segfault", why="retry")
    supervise(workshop, twin)
    assert TAKEN in lines(bench, twin)
    report(workshop, twin)
    assert workshop.checkpoints.of(job.id) == (), "done once, nobody needs them"


def test_without_room_nothing_is_kept(workshop: Workshop, bench: Service) -> None:
    settings = workshop.settings.model_copy(update={"checkpoint_bytes": 0})
    job = claim(workshop, act="write")
    supervise(replace(workshop, settings=settings), job)
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.SUCCESSFUL


def test_a_request_that_crashes_twice_is_parked_with_its_evidence(workshop: Workshop) -> None:
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "segfault"})
    for attempt in (1, 2):
        supervise(workshop, claim(workshop, attempt, job))
    failed = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert failed.failure is not None
    assert failed.failure.code == "child.crashed"
    first, second = Parked(workshop.db).attempts(DEFAULT_WORKSPACE, job.id)
    assert [one.attempt for one in (first, second)] == [1, 2]
    for one in (first, second):
        assert (one.worker, one.code, one.signal, one.phase) == ("host:1", "child.crashed", "SIGSEGV", "begin")
        assert "Fatal Python error: Segmentation fault" in one.log
        assert str(Path.cwd()) not in one.log
        assert one.peak_memory_bytes is not None
    assert [parked.job_id for parked in Parked(workshop.db).list()][:1] == [job.id]


def test_evidence_names_files_not_places() -> None:
    told = 'File "/srv/app/core/shells/advance.py", line 7 in _jump\nFile "/usr/lib/python3.11/runpy.py"\nno/path 1/2 of 3'
    assert without_places(told) == 'File "…/shells/advance.py", line 7 in _jump\nFile "…/python3.11/runpy.py"\nno/path 1/2 of 3'


def test_the_kill_of_a_worker_costs_one_step(service: Service) -> None:
    service.start_worker()
    service.start_worker()
    job = service.submit("steps", end="sleep")
    workshop = Workshop.open(service.settings, target="tests.worker.targets:run")
    wait_for(lambda: workshop.checkpoints.of(job.id), service.log)
    wait_for(lambda: service.jobs.get(DEFAULT_WORKSPACE, job.id).peak_memory_bytes, service.log)
    owner = str(service.jobs.get(DEFAULT_WORKSPACE, job.id).lease_owner)
    pid = int(owner.rpartition(":")[2])
    os.kill(pid, signal.SIGKILL)
    [dead] = [worker for worker in service.workers if worker.pid == pid]
    dead.wait()
    service.workers.remove(dead)
    done = service.wait(job, limit_s=3 * LIMIT_S)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 2)
    assert TAKEN in lines(service, job)
    [lost] = Parked(service.db).attempts(DEFAULT_WORKSPACE, job.id)
    assert (lost.worker, lost.code, lost.attempt) == (owner, "worker.lost", 1)
    assert lost.peak_memory_bytes is not None, "as the last heartbeat told"
    workshop.close()
