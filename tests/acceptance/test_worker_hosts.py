"""Hosts that share nothing but the URLs of PostgreSQL, Valkey and an object store."""

import os
import signal
import time
from contextlib import closing
from hashlib import sha256
from pathlib import Path

from store.checkpoints import Checkpoints
from store.database import Database
from store.events import Events
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from subjects.body import body
from tests.acceptance.conftest import MainJob
from tests.acceptance.lab import lab
from tests.acceptance.service import Service
from tests.postgres import PostgresServer
from tests.seaweed import SeaweedServer
from tests.valkey import ValkeyServer

SHORT_LEASE = {"INTEGUMENT_LEASE_S": "3", "INTEGUMENT_RECONCILE_S": "1"}
LAYER = "shells: layer"


def test_a_job_survives_the_kill_of_its_worker_host(
    main_job: MainJob, tmp_path: Path, postgres: PostgresServer, valkey: ValkeyServer, seaweed: SeaweedServer
) -> None:
    database_url, blobs_url = postgres.new_database(), seaweed.new_bucket()
    with (
        lab(tmp_path, database_url, valkey.url, blobs_url=blobs_url, hosts=2, **SHORT_LEASE) as there_is,
        closing(Service(there_is.url, there_is.key)) as there,
    ):
        job = there.shells(there.upload(body(0), "body"))
        steps = _await_first_steps(database_url, tmp_path, job)
        first = _holder(database_url, tmp_path, job)
        killed = next(host for host, process in there_is.workers.items() if process.pid == first)
        os.kill(first, signal.SIGKILL)
        killed_at = time.monotonic()
        there.wait(job, lambda status: status["attempt"] == 2 and status["status"] == "running")
        assert time.monotonic() - killed_at < 60
        there.succeed(job)
        assert {f"{stage}: taken from the attempt before" for stage in steps} <= _log(database_url, tmp_path, job)
        assert sha256(there.result(job, "package")).hexdigest() == sha256(main_job.package).hexdigest()
        for host in ("api", *there_is.workers):
            assert not list((tmp_path / host).glob("blobs/*/*/*")), "files are in the object store alone"
            if host != killed:
                assert not list((tmp_path / host).glob("scratch/jobs/*"))


def _await_first_steps(database_url: str, folder: Path, job: str) -> set[str]:
    """The steps kept so far, as soon as the first layer is among them."""
    database = Database(Settings(data_dir=folder / "looking", database_url=database_url))
    with closing(database):
        checkpoints = Checkpoints(database, 0)
        deadline = time.monotonic() + 600
        while LAYER not in (steps := {step.stage for step in checkpoints.of(job.rpartition("/")[2])}):
            assert time.monotonic() < deadline
            time.sleep(0.1)
        return steps


def _log(database_url: str, folder: Path, job: str) -> set[str]:
    """The lines of the job's log."""
    database = Database(Settings(data_dir=folder / "looking", database_url=database_url))
    with closing(database):
        events = Events(database).after(DEFAULT_WORKSPACE, job.rpartition("/")[2], limit=10_000)
        return {str(event.data["message"]) for event in events if event.type == "log"}


def _holder(database_url: str, folder: Path, job: str) -> int:
    """The process of the worker that holds a job."""
    database = Database(Settings(data_dir=folder / "looking", database_url=database_url))
    with closing(database):
        owner = Jobs(database).get(DEFAULT_WORKSPACE, job.rpartition("/")[2]).lease_owner
        assert owner is not None
        return int(owner.rpartition(":")[2])
