"""The end of a cohort: the transaction that ends its last job queues its summary, once.

Whoever ends a job of it locks the job first and the cohort then, so they take turns; the second sees what the first has done.
`finished_at` fences: it is set with the summary, and whoever finds it set leaves everything as it is."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from core.schema.cohort import COHORT_SUMMARY, SUMMARY_NEED
from store.acceptance import NewJob, accept_job
from store.announcement import announce
from store.callback import Subscriber
from store.job import Job, JobStatus, MeshInput
from store.job_words import JobWords
from store.records import CohortRow, JobOutputRow, JobRow
from store.workspace import WorkspaceId

LIVE = (JobStatus.ACCEPTED, JobStatus.RUNNING)
SUMMARY_ATTEMPTS = 3
REPORT = "report"


def locked_cohort(session: Session, cohort_id: str) -> CohortRow | None:
    """As it is now, held against every other writer until the transaction ends."""
    query = select(CohortRow).where(CohortRow.id == cohort_id).with_for_update()
    return session.scalars(query.execution_options(populate_existing=True)).one_or_none()


def close_cohort(session: Session, cohort_id: str, now: datetime) -> Job | None:
    """The summary, if this was its last job; to be called after every job of it that ended."""
    session.flush()
    cohort = locked_cohort(session, cohort_id)
    if cohort is None or cohort.finished_at is not None:
        return None
    live = select(func.count()).where(JobRow.cohort_id == cohort_id, JobRow.status.in_(LIVE))
    if session.execute(live).scalar_one():
        return None
    take_back_summary(session, cohort, now)
    subscriber = None if cohort.subscriber is None else Subscriber.read(cohort.subscriber)
    words = JobWords(cohort.name, tuple(cohort.labels or ()))
    inputs, reports = _asked(session, cohort)
    new = NewJob(COHORT_SUMMARY, inputs, reports, SUMMARY_NEED, words, subscriber)
    summary = accept_job(session, WorkspaceId(cohort.workspace), new, SUMMARY_ATTEMPTS, now)
    cohort.finished_at, cohort.summary_job_id = now, summary.id
    session.flush()
    return summary


def reopen_cohort(session: Session, cohort_id: str) -> None:
    """A job of it was queued again: there will be another summary."""
    session.flush()
    cohort = locked_cohort(session, cohort_id)
    if cohort is not None and cohort.finished_at is not None:
        cohort.finished_at = None
        cohort.round += 1
        session.flush()


def take_back_summary(session: Session, cohort: CohortRow, now: datetime) -> None:
    """Of the round before, whatever has become of it: what it says holds no more."""
    if cohort.summary_job_id is None:
        return
    row = session.scalars(select(JobRow).where(JobRow.id == cohort.summary_job_id).with_for_update()).one_or_none()
    cohort.summary_job_id = None
    if row is None:
        return
    if row.status != JobStatus.RUNNING:
        session.delete(row)
    elif not row.dismiss_requested:
        row.dismiss_requested, row.message = True, "is being dismissed"
        announce(session, row, now)


def _asked(session: Session, cohort: CohortRow) -> tuple[dict[str, object], tuple[MeshInput, ...]]:
    """What the summary is made of: how every job ended, and the reports they left."""
    jobs = session.scalars(select(JobRow).where(JobRow.cohort_id == cohort.id).order_by(JobRow.created_at, JobRow.id)).all()
    reports = {job.id: output for job in jobs for output in job.outputs if output.name == REPORT}
    subjects = [_ended(job, job.id in reports) for job in jobs]
    refused = [{**told, "status": "refused"} for told in cohort.refused]
    inputs: dict[str, object] = {"process": cohort.process, "name": cohort.name, "subjects": [*subjects, *refused]}
    return inputs, tuple(_bound(job, reports[job.id]) for job in jobs if job.id in reports)


def _ended(job: JobRow, has_report: bool) -> dict[str, object]:
    failure = job.failure or {}
    told: dict[str, object] = {
        "subject": job.subject,
        "job": job.id,
        "status": JobStatus(job.status).value,
        "verdict": job.verdict,
        "code": failure.get("code"),
        "message": failure.get("message"),
        "report": _href(job) if has_report else None,
    }
    return {key: value for key, value in told.items() if value is not None}


def _bound(job: JobRow, report: JobOutputRow) -> MeshInput:
    return MeshInput(_href(job), job.subject or job.id, report.sha256, report.media_type, report.file_name)


def _href(job: JobRow) -> str:
    return f"/v1/jobs/{job.id}/results/{REPORT}"
