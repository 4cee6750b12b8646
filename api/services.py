"""What every route may use, made once per application."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import anyio
from fastapi import Depends, Request

from api.admission import Admission
from api.audit_trail import AuditTrail
from api.drain import Drain
from api.http_tally import HttpTally
from api.job_watch import JobWatch
from api.outlook import Outlooks
from api.preview_cache import PreviewCache
from api.ringing import Ringer
from api.stream_slots import StreamSlots
from sandbox.nursery import Nursery
from store.api_keys import ApiKeys
from store.audit import Audit
from store.backlog import Backlog
from store.blobs import Blobs
from store.callbacks import Callbacks
from store.checkpointer import Checkpointer
from store.cohorts import Cohorts
from store.database import Database
from store.disk_floor import DiskFloor
from store.doorbell import Doorbell
from store.events import Events
from store.group_commit import GroupCommit
from store.idempotency import IdempotencyKeys
from store.job_heads import JobHeads
from store.jobs import Jobs
from store.mesh_inputs import MeshInputs
from store.meshes import Meshes
from store.metrics import Metrics
from store.open_blobs import open_blobs
from store.parked import Parked
from store.quotas import Quotas
from store.rate_limit import RateLimiter
from store.receivers import Receivers
from store.recent_jobs import RecentJobs
from store.retention_policy import RetentionPolicies, RetentionPolicy
from store.settings import Settings
from store.uploads import Uploads
from store.workers import Workers

CONCURRENT_INTAKES = 2  # each may use intake_memory_bytes
INTAKE_MODULES = ("core.processes.intake", "core.processes.export", "core.processes.unpack")


@dataclass(frozen=True, slots=True)
class Services:
    """All of it is thread-safe."""

    settings: Settings
    db: Database
    commits: GroupCommit
    checkpointer: Checkpointer
    blobs: Blobs
    meshes: Meshes
    mesh_inputs: MeshInputs
    uploads: Uploads
    jobs: Jobs
    recent_jobs: RecentJobs
    cohorts: Cohorts
    callbacks: Callbacks
    parked: Parked
    receivers: Receivers
    quotas: Quotas
    events: Events
    heads: JobHeads
    watch: JobWatch
    backlog: Backlog
    workers: Workers
    outlooks: Outlooks
    metrics: Metrics
    http_tally: HttpTally
    keys: IdempotencyKeys
    doorbell: Doorbell
    ringer: Ringer
    nursery: Nursery
    intake_slots: anyio.CapacityLimiter
    streams: StreamSlots
    admission: Admission
    limiter: RateLimiter
    trail: AuditTrail
    drain: Drain
    disk: DiskFloor
    previews: PreviewCache

    @property
    def incoming_dir(self) -> Path:
        """Uploads on their way in and conversions on their way out; one folder per request, removed at its end."""
        return self.settings.data_dir / "incoming"

    @property
    def uploads_dir(self) -> Path:
        """Files of uploads in pieces, by the id of the upload."""
        return self.settings.data_dir / "uploads"


def make_services(settings: Settings) -> Services:
    """Open nothing yet but the folders; `api.app` starts and stops what has to be."""
    db = Database(settings)
    commits = GroupCommit(db)
    blobs = open_blobs(settings, db)
    metrics = Metrics(db)
    quotas = Quotas(db, default_bytes=settings.quota_bytes, default_jobs=settings.quota_jobs)
    jobs = Jobs(db, quotas, RetentionPolicies(db, RetentionPolicy.of(settings)))
    doorbell = Doorbell(settings.broker_url, settings.queue)
    workers = Workers(db, settings)
    heads, drain = JobHeads(db), Drain()
    return Services(
        settings=settings,
        db=db,
        commits=commits,
        checkpointer=Checkpointer(db),
        blobs=blobs,
        meshes=Meshes(db, blobs, quotas),
        mesh_inputs=MeshInputs(db, blobs),
        uploads=Uploads(db, settings.upload_hours, quotas),
        jobs=jobs,
        recent_jobs=RecentJobs(db, jobs),
        cohorts=Cohorts(db, jobs),
        callbacks=Callbacks(db),
        parked=Parked(db),
        receivers=Receivers(settings.callback_allow),
        quotas=quotas,
        events=Events(db),
        heads=heads,
        watch=JobWatch(heads, drain, settings.event_poll_s),
        backlog=Backlog(db),
        workers=workers,
        outlooks=Outlooks(jobs, workers),
        metrics=metrics,
        http_tally=HttpTally(metrics),
        keys=IdempotencyKeys(db, settings.idempotency_hours),
        doorbell=doorbell,
        ringer=Ringer(doorbell, jobs, commits),
        nursery=Nursery(preload=INTAKE_MODULES, require_confinement=settings.require_confinement),
        intake_slots=anyio.CapacityLimiter(CONCURRENT_INTAKES),
        streams=StreamSlots(settings.event_streams),
        trail=AuditTrail(Audit(db, commits)),
        limiter=RateLimiter(settings.broker_url, settings.rate_per_s, settings.rate_burst),
        admission=Admission(ApiKeys(db), always=settings.require_keys == "true"),
        drain=drain,
        disk=DiskFloor(settings.data_dir, settings.disk_floor_bytes),
        previews=PreviewCache(settings.data_dir / "previews", settings.preview_bytes),
    )


async def services_of(request: Request) -> Services:
    """The services of the application that serves `request`.

    Asynchronous as all dependencies that wait for nothing: the framework sends the others to a thread each."""
    services: Services = request.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(services_of)]
