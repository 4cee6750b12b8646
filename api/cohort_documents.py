"""Cohorts as documents."""

from __future__ import annotations

import math

from starlette.requests import Request

from api.links import BASE, RESULTS_RELATION, Query, absolute, job_path, link
from api.schemas.cohort import CohortInfo, CohortList, Counts, Refusal
from api.schemas.link import Link
from store.cohort import Cohort
from store.job import Job
from store.page import Page

COHORTS = f"{BASE}/cohorts"


def cohort_path(cohort_id: str) -> str:
    """Where a cohort lives; also its `Location`."""
    return f"{COHORTS}/{cohort_id}"


def describe_cohort(request: Request, cohort: Cohort, summary: Job | None) -> CohortInfo:
    """`summary`: its job, if it is still there."""
    path = cohort_path(cohort.id)
    links = [
        link(request, path, "self", title="Cohort"),
        Link(href=absolute(request, f"{BASE}/jobs", [("cohort", cohort.id)]), rel="item", type="application/json", title="Jobs"),
    ]
    if summary is not None:
        links.append(link(request, job_path(summary.id), "related", title="Summary"))
        if summary.outputs:
            links.append(link(request, f"{path}/results", RESULTS_RELATION, title="Results"))
    return CohortInfo(
        id=cohort.id,
        process_id=cohort.process,
        name=cohort.name,
        labels=cohort.labels,
        status=_status(cohort, summary),
        progress=math.floor(cohort.progress),
        subjects=cohort.subjects,
        counts=Counts.model_validate({status.value: count for status, count in cohort.counts.items()} | _refused(cohort)),
        ready=cohort.ready,
        refused=tuple(Refusal(subject=one.subject, code=one.code, message=one.message) for one in cohort.refused),
        round=cohort.round,
        inputs=dict(cohort.inputs),
        created=cohort.created_at,
        finished=cohort.finished_at,
        summary_job=cohort.summary_job_id,
        links=tuple(links),
    )


def list_cohorts(request: Request, page: Page[Cohort], infos: tuple[CohortInfo, ...], query: Query) -> CohortList:
    """One page; `query` is repeated in the link to the next page."""
    links = [link(request, COHORTS, "self", title="Cohorts")]
    if page.next is not None:
        links.append(Link(href=absolute(request, COHORTS, [*query, ("cursor", page.next)]), rel="next", type="application/json"))
    return CohortList(cohorts=infos, next=page.next, links=tuple(links))


def _refused(cohort: Cohort) -> dict[str, int]:
    return {"refused": len(cohort.refused)}


def _status(cohort: Cohort, summary: Job | None) -> str:
    if cohort.finished_at is None:
        return "running"
    return "summarizing" if summary is not None and not summary.status.is_finished else "finished"
