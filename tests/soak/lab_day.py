"""A day of a lab by a clock that is set: real tables, real files, a real broker, the service's own sweeps every ten minutes.

Jobs succeed, fail, are dismissed and lose their workers; uploads are finished and given up; requests break off and leave folders.
Every number is made from the step's own, so a day is the same each time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from uuid import uuid4

from kombu import Connection, Exchange, Queue
from sqlalchemy import text

from api.partial_file import sweep_partial_files
from api.request_folder import LEFT_BEHIND_S, sweep_incoming
from core.errors import InternalError
from store.audit import AuditEntry
from store.backup.tables import count_rows
from store.callback import Subscriber
from store.idempotency import Reply
from store.job import Job, JobFailure, JobOutput, MeshInput
from store.local_blobs import LocalBlobs
from store.meshes import Meshes, MeshUpload
from store.metrics import Metrics
from store.settings import Settings
from store.sqlite_file import SqliteFile
from store.uploads import Uploads
from store.workers import Workers, WorkerWord
from store.workspace import DEFAULT_WORKSPACE
from worker.job_folder import ORPHAN_S
from worker.liveness import Liveness
from worker.reconciler import SWEEP_S, Reconciler
from worker.workshop import Workshop

STEP = timedelta(seconds=SWEEP_S)
HOUR_DAYS = 1 / 24
SUBSCRIBER = Subscriber("http://lab.example", "https://receiver.example/done")
HEARD_AT_MOST = 2_000  # bells of an hour, and waits for them
EVENTS = 12  # of each job besides its changes of status


class Clock:
    """The moment everybody agrees on."""

    def __init__(self) -> None:
        self.now = datetime(2026, 3, 1, tzinfo=UTC)

    def __call__(self, _session: object) -> datetime:
        """In place of `Database.now`."""
        return self.now


@dataclass(frozen=True)
class Stock:
    """What there is at the end of an hour. rows: of all tables; files: blobs and everything else in the data folder."""

    hour: int
    jobs_so_far: int
    rows: dict[str, int]
    blobs: int
    blob_bytes: int
    other_files: int
    database_bytes: int
    log_bytes: int
    bells: int
    broker_bytes: int


def short_memory(data_dir: Path, database_url: str, broker_url: str) -> Settings:
    """Everything is kept for one to three hours, so that a day shows what a year does."""
    return Settings(
        data_dir=data_dir,
        database_url=database_url or f"sqlite:///{data_dir}/integument.sqlite3",
        broker_url=broker_url,
        keep_jobs_days=3 * HOUR_DAYS,
        keep_meshes_days=2 * HOUR_DAYS,
        keep_events_days=HOUR_DAYS,
        checkpoint_days=HOUR_DAYS,
        audit_days=3 * HOUR_DAYS,
        parked_days=3 * HOUR_DAYS,
        idempotency_hours=2,
        upload_hours=1,
    )


class LabDay:
    """`per_step` jobs and as many uploads every ten minutes."""

    def __init__(self, settings: Settings, clock: Clock, per_step: int) -> None:
        self._clock = clock
        self._per_step = per_step
        self._shop = Workshop.open(settings)
        self._shop.db.migrate()
        self._settings = settings
        assert isinstance(self._shop.blobs, LocalBlobs)
        self._meshes = Meshes(self._shop.db, self._shop.blobs)
        self._uploads = Uploads(self._shop.db, settings.upload_hours)
        self._workers = Workers(self._shop.db, settings)
        self._metrics = Metrics(self._shop.db)
        self._reconciler = Reconciler(self._shop, Liveness(settings))
        self._serial = 0

    def run(self, hours: int) -> Iterator[Stock]:
        """The stock after each hour."""
        for hour in range(1, hours + 1):
            for _ in range(round(timedelta(hours=1) / STEP)):
                for _ in range(self._per_step):
                    self._one_job()
                self._clock.now += STEP
                self._age_files()
                self._sweep()
            self._hear_bells()
            yield self._take_stock(hour)

    def close(self) -> None:
        """Let go of everything."""
        self._shop.close()

    def _one_job(self) -> None:
        self._serial += 1
        number, shop = self._serial, self._shop
        mesh = self._upload(f"mesh {number:06}".encode() * 200)
        job = shop.jobs.create(
            DEFAULT_WORKSPACE,
            "shells",
            {"skin": {"href": f"/v1/meshes/{mesh.href}"}},
            mesh_inputs=[mesh],
            subscriber=SUBSCRIBER if number % 3 == 0 else None,
        )
        with shop.db.session() as session:
            shop.keys.keep(DEFAULT_WORKSPACE, f"key {number}", "f" * 64, Reply(201, {}, {"job": job.id}), session)
        shop.audit.write([AuditEntry(self._clock.now, "key", None, DEFAULT_WORKSPACE, "execute", job.id, "done")])
        assert shop.announce_all([(job.id, job.attempt)])
        if number % 20 == 7:
            shop.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
            return
        claimed = shop.jobs.claim(job.id, job.attempt, "worker", 30)
        assert claimed is not None
        folder = shop.settings.scratch_dir / "jobs" / f"{job.id}.{claimed.lease_token}"
        folder.mkdir(parents=True)
        (folder / "half").write_bytes(b"half")
        if number % 10 == 3:  # its host lost power: the reconciler takes the job back, and it is lost once more
            return
        self._work(claimed, number)
        (folder / "half").unlink()
        folder.rmdir()

    def _work(self, job: Job, number: int) -> None:
        shop = self._shop
        events = [("log", {"message": f"step {step} of {number}"}) for step in range(EVENTS)]
        shop.jobs.renew(job.id, job.lease_token, 30, progress=50, phase="shells", message="half", events=events)
        made = shop.blobs.put_bytes(f"package {number:06}".encode() * 500)
        outputs = {"package": JobOutput(made.sha256, made.size, "application/zip", "package.zip")}
        if number % 10 == 9:
            failure = JobFailure.of(InternalError("child.raised", "it raised"))
            shop.jobs.fail(job.id, job.lease_token, failure, outputs=outputs)
        else:
            done = {"verdict": "simulation_ready", "summary": "done", "timings_s": {"shells": 1.0}}
            assert shop.jobs.finish(job.id, job.lease_token, outputs=outputs, **done)  # type: ignore[arg-type]
        while (callback := shop.callbacks.claim(90, 10)) is not None:
            shop.callbacks.deliver(callback, 204)

    def _upload(self, content: bytes) -> MeshInput:
        """In pieces; every other one before it was given up, and a request broke off in between."""
        incoming = self._settings.data_dir / "incoming" / uuid4().hex
        incoming.mkdir(parents=True)
        path = incoming / "body"
        path.write_bytes(content)
        pieces = self._settings.data_dir / "uploads"
        pieces.mkdir(exist_ok=True)
        upload = self._uploads.create(DEFAULT_WORKSPACE, file_name="a.stl", fields={}, length=len(content))
        (pieces / upload.id).write_bytes(content)
        sent = MeshUpload(path, path, "a", "a.stl", "mm", "stl", 4, 4, (1.0, 1.0, 1.0))
        record = self._meshes.create(DEFAULT_WORKSPACE, sent)
        if self._serial % 2:
            self._uploads.finish(DEFAULT_WORKSPACE, upload.id, record.id)
            path.unlink()
            incoming.rmdir()
        return MeshInput(f"/v1/meshes/{record.id}", "a", record.canonical_sha256, "model/stl", "a.stl", record.sha256)

    def _hear_bells(self) -> None:
        """As a worker does, whose jobs were claimed above."""
        names = (self._settings.queue, f"{self._settings.queue}.fast", f"{self._settings.queue}.heavy")
        queues = [Queue(name, Exchange(name), routing_key=name) for name in names]
        broker_url = self._settings.broker_url
        # counted on a connection of its own: on the listening one the answer to a wait that was given up may come first
        with Connection(broker_url) as connection, Connection(broker_url) as counting:
            hear = connection.Consumer(queues, callbacks=[lambda _body, message: message.ack()], accept=["json"])
            with hear:
                for _ in range(HEARD_AT_MOST):
                    if not _count_bells(counting):
                        return
                    with suppress(TimeoutError):  # on a busy machine the broker may take longer
                        connection.drain_events(timeout=0.02)

    def _age_files(self) -> None:
        """The kernel's clock is not ours: every file grows older by a step."""
        for path in self._settings.data_dir.rglob("*"):
            if path.suffix not in (".sqlite3", ".sqlite3-wal", ".sqlite3-shm"):
                told = path.stat()
                os.utime(path, (told.st_atime - SWEEP_S, told.st_mtime - SWEEP_S))

    def _sweep(self) -> None:
        """What API and workers do every ten minutes."""
        word = WorkerWord(f"host:{self._serial}", "host", "1", 1, 1, 1)  # a worker that was killed and started again each time
        self._workers.beat(word)
        self._workers.sweep()
        self._metrics.fold()
        self._reconciler.tidy()
        for _ in range(2):  # expired once it is queued again, and once it is lost
            for job in self._shop.jobs.expire_leases():
                if not job.status.is_finished:
                    self._shop.jobs.claim(job.id, job.attempt, "worker", -1)
        self._reconciler.sweep()
        self._uploads.sweep()
        sweep_partial_files(self._settings.data_dir / "uploads", self._uploads.known)
        sweep_incoming(self._settings.data_dir / "incoming", LEFT_BEHIND_S)
        assert ORPHAN_S < SWEEP_S

    def _take_stock(self, hour: int) -> Stock:
        blobs = list(self._shop.blobs.all())
        files = [path for path in self._settings.data_dir.rglob("*") if path.is_file() and "blobs" not in path.parts]
        with self._shop.db.reading() as session:
            rows = count_rows(session)
        database_bytes, log_bytes = self._measure_database()
        with Connection(self._settings.broker_url) as connection:
            bells = _count_bells(connection)
            broker_bytes = int(connection.default_channel.client.info("memory")["used_memory"])
        return Stock(
            hour,
            self._serial,
            rows,
            len(blobs),
            sum(blob.size for blob in blobs),
            len(files),
            database_bytes,
            log_bytes,
            bells,
            broker_bytes,
        )

    def _measure_database(self) -> tuple[int, int]:
        db = self._shop.db
        if db.is_sqlite:
            return db.sqlite_path.stat().st_size, SqliteFile(db).measure().wal_bytes
        with db.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
            connection.execute(text("VACUUM"))  # autovacuum would have come by in an hour; this day takes seconds
            return int(connection.execute(text("SELECT pg_database_size(current_database())")).scalar_one()), 0


def _count_bells(connection: Connection) -> int:
    client = connection.default_channel.client
    return sum(client.llen(name) for name in client.keys("*") if client.type(name) == b"list")
