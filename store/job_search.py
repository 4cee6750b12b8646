"""Which jobs of a workspace are asked for, as one query that stops at the end of its page."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Select, exists, select, tuple_
from sqlalchemy.orm import aliased

from store.job_words import search_words
from store.records import JobLabelRow, JobRow
from store.workspace import WorkspaceId

Place = tuple[datetime, str]


@dataclass(frozen=True, slots=True)
class JobSearch:
    """Several statuses or processes mean any of them, several labels all of them; `text`: every word of it occurs in the job's
    name, labels, process, id or the names of its meshes."""

    status: tuple[str, ...] = ()
    process: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    text: str = ""
    cohort_id: str | None = None


EVERY_JOB = JobSearch()


def jobs_query(workspace: WorkspaceId, search: JobSearch, after: Place | None, limit: int) -> Select[JobRow]:
    """The newest first, beginning after `after`.

    Without labels it walks the index of the jobs' times, which holds the text that is searched; with labels that of the first
    label's times. Either way only the jobs of the page are read whole."""
    first, *others = search.labels or ("",)
    created_at, job_id = (JobLabelRow.created_at, JobLabelRow.job_id) if first else (JobRow.created_at, JobRow.id)
    found: Select[str] = select(job_id)
    if first:
        found = found.where(JobLabelRow.workspace == workspace, JobLabelRow.label == first)
        if search.status or search.process or search.text or search.cohort_id:
            found = found.join(JobRow, JobRow.id == JobLabelRow.job_id)
    else:
        found = found.where(JobRow.workspace == workspace)
    for label in others:
        other = aliased(JobLabelRow)
        found = found.where(exists().where(other.job_id == job_id, other.label == label))
    if search.status:
        found = found.where(JobRow.status.in_(search.status))
    if search.process:
        found = found.where(JobRow.process.in_(search.process))
    if search.cohort_id is not None:
        found = found.where(JobRow.cohort_id == search.cohort_id)
    for word in search_words(search.text):
        found = found.where(JobRow.search_text.contains(word, autoescape=True))
    if after is not None:
        found = found.where(tuple_(created_at, job_id) < after)
    page: Any = found.order_by(created_at.desc(), job_id.desc()).limit(limit).subquery()
    return select(JobRow).join(page, page.c[0] == JobRow.id).order_by(JobRow.created_at.desc(), JobRow.id.desc())
