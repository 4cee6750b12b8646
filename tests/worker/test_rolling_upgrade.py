"""Real workers on jobs and messages of the version before, and beside each other."""

from __future__ import annotations

import json
import signal
import time

import redis

from store.job import JobStatus
from store.workspace import DEFAULT_WORKSPACE
from tests.store.earlier_version import REVISION, EarlierVersion
from tests.valkey import ValkeyServer
from tests.worker.conftest import Service

LIMIT_S = 60.0


def ring_as_before(service: Service, valkey: ValkeyServer, job_id: str) -> None:
    """The message as kombu wrote it: one queue for all, the job's id and attempt as arguments."""
    service.doorbell.ring(job_id, 1)
    with redis.Redis(unix_socket_path=str(valkey.socket_path)) as client:
        message = json.loads(client.lindex(service.settings.queue, 0))  # type: ignore[arg-type]
    assert message["headers"]["task"] == "jobs.run"
    assert message["properties"]["delivery_info"]["routing_key"] == service.settings.queue


def test_jobs_and_messages_of_the_version_before_are_served(service: Service, valkey: ValkeyServer) -> None:
    earlier = EarlierVersion(service.db)
    job_id = earlier.accept(act="write")
    ring_as_before(service, valkey, job_id)
    service.start_worker()
    done = service.wait(service.jobs.get(DEFAULT_WORKSPACE, job_id))
    assert (done.status, done.verdict, done.attempt) == (JobStatus.SUCCESSFUL, "simulation_ready", 1)
    assert service.stop_workers() == [0]


def await_ready(service: Service, number: int) -> None:
    deadline = time.monotonic() + LIMIT_S
    while service.log().count("jobs at a time") < number:
        assert time.monotonic() < deadline, service.log()
        time.sleep(0.05)


def test_workers_are_exchanged_one_by_one_while_jobs_run(service: Service) -> None:
    """Twelve jobs, and never a moment without a worker: those told to stop hand back what they cannot end."""
    earlier = EarlierVersion(service.db)
    jobs = [service.submit("sleep", seconds=0.6) for _ in range(8)]
    jobs += [service.jobs.get(DEFAULT_WORKSPACE, earlier.accept(act="sleep", seconds=0.6)) for _ in range(4)]
    long = service.submit("sleep", seconds=4)
    first = service.start_worker()
    service.wait_for_child(jobs[0])
    second = service.start_worker()
    await_ready(service, 2)
    first.send_signal(signal.SIGTERM)
    assert first.wait(LIMIT_S) == 0, service.log()
    third = service.start_worker()
    await_ready(service, 3)
    second.send_signal(signal.SIGTERM)
    assert second.wait(LIMIT_S) == 0, service.log()
    ended = [service.wait(job) for job in (*jobs, long)]
    assert [(job.status, job.attempt) for job in ended] == [(JobStatus.SUCCESSFUL, 1)] * 13
    third.send_signal(signal.SIGTERM)
    assert third.wait(LIMIT_S) == 0
    service.workers.clear()


def test_a_worker_does_not_begin_on_tables_of_another_version(service: Service) -> None:
    service.db.revert(REVISION)
    service.start_worker()
    assert service.workers.pop().wait(LIMIT_S) == 2
    assert "[database.schema_older]" in service.log()
    service.db.migrate()
