"""What is counted of a job, in the transaction that changes it."""

from __future__ import annotations

import re
from datetime import datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from store.job import JobStatus
from store.metric_family import (
    JOB_ATTEMPTS,
    JOB_FACES,
    JOB_FAILURES,
    JOB_PEAK_BYTES,
    JOB_RUN_S,
    JOB_WAIT_S,
    JOBS_ENDED,
    LEASES_EXPIRED,
    STAGE_S,
)
from store.metrics import note
from store.records import JobRow, MeshRow
from store.tally import Tally

_MESH_HREF = re.compile(r"/v1/meshes/(?P<id>[0-9a-f-]{36})")


def count_attempt(session: Session, row: JobRow, now: datetime) -> None:
    """A worker has claimed it."""
    tally = Tally()
    tally.count(JOB_ATTEMPTS, row.process)
    tally.observe(JOB_WAIT_S, row.process, value=max((now - row.queued_at).total_seconds(), 0.0))
    note(session, tally)


def count_expiry(session: Session, row: JobRow) -> None:
    """Its worker fell silent."""
    tally = Tally()
    tally.count(LEASES_EXPIRED, row.process)
    note(session, tally)


def count_end(session: Session, row: JobRow, now: datetime) -> None:
    """It came to an end, as the row says."""
    tally = Tally()
    tally.count(JOBS_ENDED, row.process, JobStatus(row.status).value)
    if row.status == JobStatus.FAILED and row.failure is not None:
        tally.count(JOB_FAILURES, row.process, str(row.failure["code"]))
    if row.started_at is not None:
        tally.observe(JOB_RUN_S, row.process, value=max((now - row.started_at).total_seconds(), 0.0))
        if (faces := _faces(session, row)) is not None:
            tally.observe(JOB_FACES, row.process, value=faces)
    seconds: dict[str, float] = {}
    for stage, took_s in row.timings_s.items():
        seconds[stage_kind(stage)] = seconds.get(stage_kind(stage), 0.0) + float(took_s)
    for kind, took_s in seconds.items():
        tally.observe(STAGE_S, row.process, kind, value=took_s)
    if row.peak_memory_bytes:
        tally.observe(JOB_PEAK_BYTES, row.process, value=row.peak_memory_bytes)
    note(session, tally)


def stage_kind(stage: str) -> str:
    """`heal: skin` -> `heal`: what follows is a name somebody gave to a surface."""
    return stage.partition(":")[0].strip()


def _faces(session: Session, row: JobRow) -> int | None:
    """Of its uploaded meshes that are still there; None if there are none."""
    ids = [match["id"] for mesh in row.mesh_inputs if (match := _MESH_HREF.fullmatch(mesh.href))]
    if not ids:
        return None
    total: int | None = session.execute(select(func.sum(MeshRow.faces)).where(MeshRow.id.in_(ids))).scalar_one()
    return None if total is None else int(total)
