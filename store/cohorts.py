"""The table of cohorts: accept, look up, list, take back, queue again, remove."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import uuid4

from sqlalchemy import Select, func, or_, select, tuple_
from sqlalchemy.orm import Session

from core.errors import StateError
from core.schema.expectation import Expectation
from store.acceptance import Membership
from store.callback import Subscriber
from store.cohort import Cohort, RefusedSubject
from store.cohort_end import LIVE, close_cohort
from store.database import Database
from store.job import Job, JobStatus, MeshInput
from store.job_words import NO_WORDS, JobWords
from store.jobs import Jobs
from store.page import Page, from_cursor, to_cursor
from store.records import CohortRow, JobRow
from store.storable import storable, storable_text
from store.workspace import WorkspaceId

RETRYABLE = (JobStatus.FAILED, JobStatus.DISMISSED)


@dataclass(frozen=True, slots=True)
class NewSubject:
    """One subject whose inputs are validated and whose meshes are found."""

    name: str
    inputs: Mapping[str, Any]
    meshes: tuple[MeshInput, ...]
    expectation: Expectation


@dataclass(frozen=True, slots=True)
class NewCohort:
    """What is asked for; `inputs` are those all subjects share."""

    process: str
    inputs: Mapping[str, Any]
    subjects: Sequence[NewSubject]
    refused: Sequence[RefusedSubject] = ()
    words: JobWords = NO_WORDS
    subscriber: Subscriber | None = None


class Cohorts:
    """To a workspace the cohorts of others do not exist. Thread-safe."""

    def __init__(self, db: Database, jobs: Jobs) -> None:
        self._db = db
        self._jobs = jobs

    def create(
        self, workspace: WorkspaceId, new: NewCohort, *, max_attempts: int = 2, session: Session | None = None
    ) -> tuple[Cohort, tuple[Job, ...]]:
        """Accept a job for every subject, all or none; ring for them after that.

        Raises as `Jobs.create`, with the subject in the message of `job.parked`."""
        with self._db.session(session) as work:
            row = CohortRow(
                id=str(uuid4()),
                workspace=workspace,
                process=new.process,
                name=new.words.name,
                labels=list(new.words.labels) or None,
                inputs=dict(new.inputs),
                subjects=len(new.subjects) + len(new.refused),
                refused=storable([one.describe() for one in new.refused]),
                subscriber=None if new.subscriber is None else new.subscriber.describe(),
                round=1,
                created_at=self._db.now(work),
            )
            work.add(row)
            work.flush()
            jobs = tuple(self._accept(work, workspace, row.id, new, subject, max_attempts) for subject in new.subjects)
            if not jobs:  # nothing will end: what was refused is all there is to tell
                close_cohort(work, row.id, self._db.now(work))
            return _snapshot(work, row), jobs

    def _accept(
        self, session: Session, workspace: WorkspaceId, cohort_id: str, new: NewCohort, subject: NewSubject, max_attempts: int
    ) -> Job:
        try:
            return self._jobs.create(
                workspace,
                new.process,
                subject.inputs,
                mesh_inputs=subject.meshes,
                max_attempts=max_attempts,
                expectation=subject.expectation,
                words=new.words,
                membership=Membership(cohort_id, storable_text(subject.name)),
                session=session,
            )
        except StateError as error:
            refused = StateError(error.code, f"subject '{subject.name}': {error.message}")
            refused.facts = error.facts
            raise refused from error

    def get(self, workspace: WorkspaceId, cohort_id: str) -> Cohort:
        """Raises StateError `cohort.not_found`."""
        with self._db.reading() as session:
            return _snapshot(session, _owned(session, workspace, cohort_id))

    def summary(self, cohort: Cohort) -> Job | None:
        """The job that makes the summary; None if there is none yet, or it was removed."""
        if cohort.summary_job_id is None:
            return None
        try:
            return self._jobs.get(cohort.workspace, cohort.summary_job_id)
        except StateError:
            return None

    def list(self, workspace: WorkspaceId, *, limit: int = 50, cursor: str | None = None) -> Page[Cohort]:
        """Newest first. Raises InputError `cursor.invalid`."""
        newest_first = (CohortRow.created_at.desc(), CohortRow.id.desc())
        query = select(CohortRow).where(CohortRow.workspace == workspace).order_by(*newest_first).limit(limit + 1)
        if cursor is not None:
            query = query.where(tuple_(CohortRow.created_at, CohortRow.id) < from_cursor(cursor))
        with self._db.reading() as session:
            rows = session.scalars(query).all()
            items = tuple(_snapshot(session, row) for row in rows[:limit])
            return Page(items, to_cursor(items[-1].created_at, items[-1].id) if len(rows) > limit else None)

    def jobs(self, workspace: WorkspaceId, cohort_id: str) -> tuple[Job, ...]:
        """Of all subjects, in the order of the request. Raises StateError `cohort.not_found`."""
        with self._db.reading() as session:
            _owned(session, workspace, cohort_id)
            ids = session.scalars(_jobs_of(cohort_id)).all()
        return tuple(self._jobs.get(workspace, job_id) for job_id in ids)

    def dismiss(self, workspace: WorkspaceId, cohort_id: str, *, keep_ended: bool = False) -> Cohort | None:
        """Take back what waits or runs, its summary included; if nothing does, remove the cohort with all its jobs: None.
        With `keep_ended` it stays then.

        Every job is taken back by itself: one that just ends is left as it ended. Raises StateError `cohort.not_found`."""
        with self._db.reading() as session:
            row = _owned(session, workspace, cohort_id)
            everything = [*session.scalars(_jobs_of(cohort_id)), *([row.summary_job_id] if row.summary_job_id else ())]
            live = session.scalars(select(JobRow.id).where(JobRow.id.in_(everything), JobRow.status.in_(LIVE))).all()
        if live or keep_ended:
            for job_id in live:
                self._jobs.take_back(workspace, job_id)
            return self.get(workspace, cohort_id)
        with self._db.session() as session:
            row = _owned(session, workspace, cohort_id, lock=True)
            of_it = or_(JobRow.cohort_id == cohort_id, JobRow.id == row.summary_job_id)
            for job in session.scalars(select(JobRow).where(of_it)):
                session.delete(job)
            session.delete(row)
        return None

    def retry(self, workspace: WorkspaceId, cohort_id: str, *, session: Session | None = None) -> tuple[Cohort, tuple[Job, ...]]:
        """Queue its failed and dismissed jobs again, for one attempt more; those that are parked stay as they are.

        Raises StateError `cohort.not_found`, `cohort.nothing_to_retry`, LimitError `quota.jobs`, `quota.bytes`."""
        with self._db.session(session) as work:
            row = _owned(work, workspace, cohort_id)
            failed = select(JobRow).where(JobRow.cohort_id == cohort_id, JobRow.status.in_(RETRYABLE)).order_by(JobRow.id)
            ended = work.scalars(failed.with_for_update()).all()  # all of them before the cohort: see `store.cohort_end`
            again = [job for one in ended if (job := self._queue_again(work, workspace, one)) is not None]
            if not again:
                raise StateError(
                    "cohort.nothing_to_retry", f"no job of cohort {cohort_id} has failed or was dismissed", cohort=cohort_id
                )
            work.refresh(row)
            return _snapshot(work, row), tuple(again)

    def _queue_again(self, session: Session, workspace: WorkspaceId, row: JobRow) -> Job | None:
        try:
            return self._jobs.retry(workspace, row.id, session=session)
        except StateError as error:
            if error.code != "job.parked":
                raise
            return None

    def close_ended(self) -> Iterable[Job]:
        """Queue the summaries that are missing: where the last job was ended by a server of the version before this one, or
        was removed before its end was told."""
        with self._db.reading() as session:
            live = select(JobRow.id).where(JobRow.cohort_id == CohortRow.id, JobRow.status.in_(LIVE)).exists()
            ids = session.scalars(select(CohortRow.id).where(CohortRow.finished_at.is_(None), ~live)).all()
        for cohort_id in ids:
            with self._db.session() as session:
                summary = close_cohort(session, cohort_id, self._db.now(session))
                found = None if summary is None else (WorkspaceId(summary.workspace), summary.id)
            if found is not None:
                yield self._jobs.get(*found)


def _owned(session: Session, workspace: WorkspaceId, cohort_id: str, *, lock: bool = False) -> CohortRow:
    query = select(CohortRow).where(CohortRow.id == cohort_id, CohortRow.workspace == workspace)
    row = session.scalars(query.with_for_update() if lock else query).one_or_none()
    if row is None:
        raise StateError("cohort.not_found", f"there is no cohort {cohort_id}", cohort=cohort_id)
    return row


def _jobs_of(cohort_id: str) -> Select[str]:
    return select(JobRow.id).where(JobRow.cohort_id == cohort_id).order_by(JobRow.created_at, JobRow.id)


def _snapshot(session: Session, row: CohortRow) -> Cohort:
    counts: dict[JobStatus, int] = {}
    ready, progress = 0, 0.0
    query = (
        select(JobRow.status, JobRow.verdict, func.count(), func.sum(JobRow.progress))
        .where(JobRow.cohort_id == row.id)
        .group_by(JobRow.status, JobRow.verdict)
    )
    for told, verdict, count, percents in session.execute(query):
        status = JobStatus(told)
        counts[status] = counts.get(status, 0) + count
        ready += count if verdict == "simulation_ready" else 0
        progress += 100.0 * count if status.is_finished else float(percents)
    jobs = sum(counts.values())
    return Cohort(
        id=row.id,
        workspace=WorkspaceId(row.workspace),
        process=row.process,
        name=row.name,
        labels=tuple(row.labels or ()),
        inputs=row.inputs,
        subjects=row.subjects,
        refused=tuple(RefusedSubject(**told) for told in row.refused),
        round=row.round,
        summary_job_id=row.summary_job_id,
        created_at=row.created_at,
        finished_at=row.finished_at,
        counts=counts,
        ready=ready,
        progress=progress / jobs if jobs else 100.0,
    )
