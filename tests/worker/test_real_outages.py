"""A real PostgreSQL that dies under a running job: what the child made is not lost, and the job ends once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from threading import Thread

import pytest

from store.events import Events
from store.job import Job, JobStatus
from store.workspace import DEFAULT_WORKSPACE
from tests.postgres import DURABLE, PostgresServer, running_postgres
from tests.valkey import ValkeyServer
from tests.worker.conftest import LIMIT_S, make_settings
from worker.supervise import supervise
from worker.workshop import Workshop


@pytest.fixture(scope="module")
def database() -> Iterator[PostgresServer]:
    with running_postgres(DURABLE) as server:
        yield server


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory, database: PostgresServer) -> Iterator[Workshop]:
    nowhere = ValkeyServer(tmp_path_factory.mktemp("nowhere"))
    settings = make_settings(tmp_path_factory.mktemp("data"), nowhere, database_url=database.new_database())
    workshop = Workshop.open(settings, target="tests.worker.targets:run")
    workshop.db.migrate()
    workshop.nursery.start()
    assert workshop.nursery.wait_until_ready(LIMIT_S)
    yield workshop
    workshop.close()


def wait_for(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + 3 * LIMIT_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def begin(workshop: Workshop, **inputs: object) -> tuple[Job, Thread]:
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", inputs)
    claimed = workshop.jobs.claim(job.id, 1, "host:1", 3)
    assert claimed is not None
    thread = Thread(target=supervise, args=(workshop, claimed))
    thread.start()
    return claimed, thread


def told(workshop: Workshop, job: Job, kind: str) -> list[str]:
    return [
        str(event.data.get("message")) for event in Events(workshop.db).after(DEFAULT_WORKSPACE, job.id) if event.type == kind
    ]


def test_a_job_ends_while_its_database_is_away(workshop: Workshop, database: PostgresServer) -> None:
    job, thread = begin(workshop, act="sleep", seconds=1)
    wait_for(lambda: told(workshop, job, "log"))
    database.kill()
    folder = workshop.settings.scratch_dir / "jobs" / f"{job.id}.{job.lease_token}"
    wait_for(lambda: (folder / "out" / "report.json").exists())  # the child is done, and nobody can be told
    time.sleep(workshop.settings.lease_s)  # longer than the lease
    assert thread.is_alive()
    database.start()
    thread.join(LIMIT_S)
    done = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (done.status, done.attempt, list(done.outputs)) == (JobStatus.SUCCESSFUL, 1, ["report"])
    assert len(told(workshop, job, "done")) == 1


def test_steps_are_kept_once_the_database_is_back(workshop: Workshop, database: PostgresServer) -> None:
    job, thread = begin(workshop, act="steps", end="sleep", begin_after=1.0)
    wait_for(lambda: told(workshop, job, "log"))
    database.kill()
    time.sleep(2.0)  # the first step is made meanwhile
    database.start()
    wait_for(lambda: workshop.checkpoints.of(job.id))
    assert [step.stage for step in workshop.checkpoints.of(job.id)] == ["step 0"]
    workshop.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    thread.join(LIMIT_S)
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.DISMISSED
    assert workshop.checkpoints.of(job.id) == ()
