"""Workers and brokers that go away in the middle of a job."""

from __future__ import annotations

import signal
import subprocess
import time

import redis

from store.job import Job, JobStatus
from store.workspace import DEFAULT_WORKSPACE
from tests.sandbox.ending import wait_for_end
from tests.valkey import ValkeyServer
from tests.worker.conftest import Service
from worker.liveness import Liveness
from worker.reconciler import Reconciler
from worker.workshop import Workshop


def kill_owner(service: Service, job: Job) -> subprocess.Popen[bytes]:
    """SIGKILL the worker that has the job; the other one."""
    pid = int(str(service.jobs.get(DEFAULT_WORKSPACE, job.id).lease_owner).rpartition(":")[2])
    [owner] = [worker for worker in service.workers if worker.pid == pid]
    owner.kill()
    owner.wait()
    service.workers.remove(owner)
    return owner


def test_the_job_of_a_killed_worker_is_finished_by_another_or_failed(service: Service) -> None:
    service.start_worker()
    service.start_worker()
    job = service.submit("sleep", seconds=1)
    child = service.wait_for_child(job)
    kill_owner(service, job)
    assert wait_for_end([child]) == []
    done = service.wait(job)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 2)
    assert (service.settings.scratch_dir / "jobs" / f"{job.id}.1").exists()  # young yet; a sweep takes it later

    job = service.submit("sleep", seconds=60, max_attempts=1)
    child = service.wait_for_child(job)
    kill_owner(service, job)
    assert wait_for_end([child]) == []
    workshop = Workshop.open(service.settings, target="tests.worker.targets:run")
    reconciler = Reconciler(workshop, Liveness(service.settings))
    reconciler.start()
    failed = service.wait(job)
    reconciler.stop()
    workshop.close()
    assert failed.failure is not None
    assert failed.failure.code == "worker.lost"


def test_a_broker_that_forgets_everything_loses_no_job(service: Service, valkey: ValkeyServer) -> None:
    unheard = [service.submit() for _ in range(3)]
    valkey.kill()
    valkey.start()
    service.start_worker()
    assert [service.wait(job).status for job in unheard] == [JobStatus.SUCCESSFUL] * 3
    busy = service.submit("sleep", seconds=1)
    service.wait_for_child(busy)
    valkey.kill()
    waiting = service.submit()  # nobody can ring for it
    assert service.wait(busy).status is JobStatus.SUCCESSFUL  # needs no broker
    valkey.start()
    done = service.wait(waiting)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 1)
    assert service.stop_workers() == [0]


def test_a_worker_told_to_stop_ends_what_is_short_and_hands_back_what_is_long(service: Service, valkey: ValkeyServer) -> None:
    service.start_worker()
    short, long = service.submit("sleep", seconds=0.7), service.submit("sleep", seconds=60)
    children = [service.wait_for_child(short), service.wait_for_child(long)]
    started = time.monotonic()
    assert service.stop_workers(signal.SIGTERM) == [0]
    assert time.monotonic() - started < 50  # it did not wait for the long one
    assert wait_for_end(children, 0.0) == []
    assert service.jobs.get(DEFAULT_WORKSPACE, short.id).status is JobStatus.SUCCESSFUL
    handed_back = service.jobs.get(DEFAULT_WORKSPACE, long.id)
    assert (handed_back.status, handed_back.attempt) == (JobStatus.ACCEPTED, 1)
    assert handed_back.rung_at is not None
    with redis.Redis(unix_socket_path=str(valkey.socket_path)) as client:
        assert client.llen(service.settings.queue) >= 1
    assert list((service.settings.scratch_dir / "jobs").iterdir()) == []
    assert not Liveness(service.settings).is_fresh()
