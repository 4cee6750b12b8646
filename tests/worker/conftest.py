"""A job table on SQLite, a real Valkey, and real worker processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from store.database import Database
from store.doorbell import Doorbell
from store.events import Events
from store.job import Job
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.valkey import ValkeyServer
from worker.closing import Closing
from worker.workshop import Workshop

ROOT = Path(__file__).parents[2]
LIMIT_S = 60.0


class Service:
    """What API and supervisor would hold: the tables, the doorbell, and workers to start and kill."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.db = Database(settings)
        self.db.migrate()
        self.jobs = Jobs(self.db)
        self.events = Events(self.db)
        self.blobs = LocalBlobs(settings.blob_dir)
        self.doorbell = Doorbell(settings.broker_url, settings.queue)
        self.log_path = settings.data_dir / "worker.log"
        self.workers: list[subprocess.Popen[bytes]] = []

    def start_worker(self) -> subprocess.Popen[bytes]:
        environment = os.environ | self.settings.as_environment() | {"PYTHONPATH": str(ROOT)}
        with self.log_path.open("ab") as log:
            worker = subprocess.Popen(
                [sys.executable, "-m", "tests.worker.worker_process"], env=environment, stdout=log, stderr=log, cwd=ROOT
            )
        self.workers.append(worker)
        return worker

    def stop_workers(self, number: signal.Signals = signal.SIGTERM) -> list[int]:
        """Exit codes of all workers."""
        for worker in self.workers:
            worker.send_signal(number)
        codes = [worker.wait(LIMIT_S) for worker in self.workers]
        self.workers.clear()
        return codes

    def submit(self, act: str = "write", *, ring: bool = True, max_attempts: int = 2, **inputs: Any) -> Job:
        job = self.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": act, **inputs}, max_attempts=max_attempts)
        if ring and self.doorbell.ring(job.id, job.attempt):
            self.jobs.mark_all_rung([(job.id, job.attempt)])
        return job

    def wait(self, job: Job, until: Callable[[Job], bool] = lambda job: job.status.is_finished, limit_s: float = LIMIT_S) -> Job:
        deadline = time.monotonic() + limit_s
        while not until(now := self.jobs.get(DEFAULT_WORKSPACE, job.id)):
            assert time.monotonic() < deadline, f"{now}\n{self.log()}"
            time.sleep(0.02)
        return now

    def wait_for_child(self, job: Job, attempt: int = 1) -> int:
        """The pid of the child that works on the job; it is the first thing it says."""
        deadline = time.monotonic() + LIMIT_S
        while True:
            told = [event.data["message"] for event in self.events.after(DEFAULT_WORKSPACE, job.id) if event.type == "log"]
            children = [line for line in told if line.startswith("child ")]
            if len(children) >= attempt:
                return int(children[attempt - 1].removeprefix("child "))
            assert time.monotonic() < deadline, self.log()
            time.sleep(0.02)

    def log(self) -> str:
        return self.log_path.read_text()

    def close(self) -> None:
        for worker in self.workers:
            worker.kill()
            worker.wait()
        self.doorbell.close()
        self.db.close()


def make_settings(data_dir: Path, valkey: ValkeyServer, **changes: Any) -> Settings:
    return Settings(
        data_dir=data_dir,
        broker_url=valkey.url,
        **{
            "job_memory_bytes": 512 * 1024**2,
            "job_file_bytes": 64 * 1024**2,
            "lease_s": 3,
            "heartbeat_s": 0.5,
            "reconcile_s": 0.3,
            "rering_s": 1,
            "drain_s": 1,
            "checkpoint_after_s": 0,
            "worker_concurrency": 2,
            "look_s": 60,  # nobody looks without a bell
            **changes,
        },
    )


@pytest.fixture
def settings(tmp_path: Path, valkey: ValkeyServer) -> Settings:
    return make_settings(tmp_path, valkey)


@pytest.fixture
def service(settings: Settings) -> Iterator[Service]:
    """No worker yet."""
    service = Service(settings)
    yield service
    service.close()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Service]:
    """One worker for the tests of a module that leave it alive."""
    service = Service(make_settings(tmp_path_factory.mktemp("data"), shared_valkey, queue="worker-tests", job_wall_s=2))
    service.start_worker()
    yield service
    try:
        assert service.stop_workers() == [0], service.log()
        assert list((service.settings.scratch_dir / "jobs").iterdir()) == []
    finally:
        service.close()


@pytest.fixture(scope="module")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workshop]:
    """A workshop without a worker: the nursery and the tables, for tests that supervise by hand."""
    nowhere = ValkeyServer(tmp_path_factory.mktemp("nowhere"))
    workshop = Workshop.open(make_settings(tmp_path_factory.mktemp("data"), nowhere), target="tests.worker.targets:run")
    workshop.db.migrate()
    workshop.nursery.start()
    yield workshop
    workshop.close()


@pytest.fixture
def workshop(warm: Workshop) -> Workshop:
    """Open for business, whatever the test before did."""
    return replace(warm, closing=Closing(drain_s=0))


@pytest.fixture
def bench(warm: Workshop) -> Iterator[Service]:
    """What users see of `workshop`."""
    service = Service(warm.settings)
    service.log_path.touch()
    yield service
    service.close()
