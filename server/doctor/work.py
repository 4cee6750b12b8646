"""The work: who does it, what is stuck, what was given up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from datetime import timedelta

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session

from core.schema.expectation import JobQueue
from server.doctor.diagnosis import Diagnosis, fine, warning, wrong
from server.doctor.patient import Patient
from store.audit import Audit
from store.backlog import Backlog
from store.callback import CallbackState
from store.callbacks import Callbacks
from store.job import JobStatus
from store.parked import Parked
from store.records import JobRow
from store.version import SERVER_VERSION
from store.workers import Workers, WorkerState

LONG_WAIT = timedelta(hours=1)
RECENT = timedelta(days=1)
BACKUP_AGE = timedelta(days=7)


def examine_work(patient: Patient) -> Iterator[Diagnosis]:
    """Reads only."""
    yield from _workers(patient)
    yield from _jobs(patient)
    yield _callbacks(patient)
    yield _backup(patient)


def _workers(patient: Patient) -> Iterator[Diagnosis]:
    found = Workers(patient.db, patient.settings).list()
    states = Counter(worker.state for worker in found)
    said = ", ".join(f"{states[state]} {state}" for state in WorkerState)
    if not states[WorkerState.ALIVE]:
        yield wrong("workers", said, "start a worker; what was accepted waits meanwhile")
    elif states[WorkerState.LOST]:
        lost = ", ".join(worker.word.name for worker in found if worker.state is WorkerState.LOST)
        yield warning("workers", f"{said}: {lost}", "look at the logs of these hosts; their jobs were taken over")
    else:
        yield fine("workers", said)
    served = frozenset(queue for worker in found if worker.state is WorkerState.ALIVE for queue in worker.word.queues)
    yield from _queues(patient, served)
    others = {worker.word.version for worker in found if worker.state is not WorkerState.LOST} - {SERVER_VERSION}
    if others:
        yield warning("versions", f"this is {SERVER_VERSION}, workers run {', '.join(sorted(others))}", "end the upgrade")


def _queues(patient: Patient, served: frozenset[JobQueue]) -> Iterator[Diagnosis]:
    """Those only some of the workers serve, and now nobody; without any worker that one finding is enough."""
    waiting = Backlog(patient.db).count()
    for queue in sorted(set(JobQueue) - served) if served else ():
        jobs = sum(number for (_, one, status), number in waiting.jobs.items() if (one, status) == (queue, JobStatus.ACCEPTED))
        said = f"no living worker takes {queue} jobs; {jobs} wait"
        advice = f"start a worker with {queue} among its INTEGUMENT_WORKER_QUEUES"
        yield wrong(f"queue {queue}", said, advice) if jobs else warning(f"queue {queue}", said, advice)


def _jobs(patient: Patient) -> Iterator[Diagnosis]:
    patience = timedelta(seconds=2 * (patient.settings.lease_s + patient.settings.reconcile_s))
    with patient.db.reading() as session:
        now = patient.db.now(session)
        waiting = _count(session, JobRow.status == JobStatus.ACCEPTED)
        running = _count(session, JobRow.status == JobStatus.RUNNING)
        long = _count(session, JobRow.status == JobStatus.ACCEPTED, JobRow.queued_at < now - LONG_WAIT)
        stuck = _count(session, JobRow.status == JobStatus.RUNNING, JobRow.lease_until < now - patience)
        ours = JobRow.failure["class"].as_string() == "internal"
        failed = _count(session, JobRow.status == JobStatus.FAILED, ours, JobRow.finished_at > now - RECENT)
    said = f"{waiting} wait, {running} run"
    if stuck:
        yield wrong(
            "jobs", f"{said}; {stuck} have lost their worker and nobody takes them back", "a worker must run: it reconciles"
        )
    elif long:
        yield warning(
            "jobs", f"{said}; {long} for more than an hour", "more workers, or integument admin jobs list --status accepted"
        )
    else:
        yield fine("jobs", said)
    if failed:
        yield warning("failures", f"{failed} jobs failed by our fault within a day", "integument admin jobs list --status failed")
    if parked := len(Parked(patient.db).list()):
        yield warning("parked", f"{parked} requests are refused because they took down workers", "integument admin parked list")


def _callbacks(patient: Patient) -> Diagnosis:
    count = Callbacks(patient.db).count()
    said = f"{count[CallbackState.PENDING]} pending, {count[CallbackState.DEAD]} given up"
    if count[CallbackState.PENDING] and not patient.settings.callback_secret:
        return wrong("callbacks", said, "set INTEGUMENT_CALLBACK_SECRET for API and workers")
    return fine("callbacks", said)


def _backup(patient: Patient) -> Diagnosis:
    with patient.db.reading() as session:
        now = patient.db.now(session)
    made = Audit(patient.db).last("backup")
    if made is None:
        return warning("backup", "none was made of this database", "integument admin backup FOLDER, every night")
    said = f"the last one was made {(now - made).total_seconds() / 86_400:.1f} days ago"
    return (
        warning("backup", said, "integument admin backup FOLDER, every night")
        if now - made > BACKUP_AGE
        else fine("backup", said)
    )


def _count(session: Session, *where: ColumnElement[bool]) -> int:
    return session.execute(select(func.count()).select_from(JobRow).where(*where)).scalar_one()
