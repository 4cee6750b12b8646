"""Jobs in OGC's words."""

from __future__ import annotations

import math

from starlette.requests import Request

from api.links import BASE, RESULTS_RELATION, Query, absolute, job_path, link
from api.outlook import Outlook
from api.schemas.job import Failure, JobList, ResultReference, Results, StatusInfo
from api.schemas.link import Link
from store.job import Job, JobStatus
from store.page import Page

REPORT_OUTPUT = "report"
REPORT_HTML_OUTPUT = "report_html"


def describe_job(request: Request, job: Job, outlook: Outlook | None = None) -> StatusInfo:
    """statusInfo of a job; `outlook` where it may still wait."""
    ended = job.status.is_finished
    return StatusInfo(
        job_id=job.id,
        process_id=job.process,
        name=job.name,
        labels=job.labels,
        cohort_id=job.cohort_id,
        subject=job.subject,
        status=job.status.value,
        message=job.message if outlook is None else outlook.message_of(job),
        progress=math.floor(job.progress),
        created=job.created_at,
        started=job.started_at,
        finished=job.finished_at,
        updated=job.updated_at,
        expires=job.expires_at,
        phase=job.phase or None,
        queue_position=None if outlook is None else outlook.position,
        attempt=job.attempt,
        verdict=job.verdict,
        summary=job.summary,
        failure=describe_failure(job),
        timings_s=dict(job.timings_s) if ended else None,
        peak_memory_bytes=job.peak_memory_bytes,
        queue=job.queue.value,
        expected_memory_bytes=job.expected_memory_bytes,
        expected_cpu_s=job.expected_cpu_s,
        links=_links(request, job),
    )


def describe_failure(job: Job) -> Failure | None:
    """What went wrong, without the findings: those are in the report and in the problem of the results."""
    failure = job.failure
    if failure is None:
        return None
    return Failure.model_validate(
        {
            "code": failure.code,
            "class": failure.fault,
            "message": failure.message,
            "retryable": failure.retryable,
            "facts": dict(failure.facts),
        }
    )


def list_jobs(request: Request, page: Page[Job], query: Query, outlook: Outlook) -> JobList:
    """One page; `query` are the filters, repeated in the link to the next page."""
    path = f"{BASE}/jobs"
    links = [link(request, path, "self", title="Jobs")]
    if page.next is not None:
        links.append(Link(href=absolute(request, path, [*query, ("cursor", page.next)]), rel="next", type="application/json"))
    return JobList(jobs=tuple(describe_job(request, job, outlook) for job in page.items), next=page.next, links=tuple(links))


def refer_to_results(request: Request, job: Job) -> Results:
    """The results document: every output by reference."""
    return Results(refer_to_outputs(request, job))


def refer_to_outputs(request: Request, job: Job) -> dict[str, ResultReference]:
    """Name -> where it is."""
    return {
        name: ResultReference(
            href=absolute(request, f"{job_path(job.id)}/results/{name}"), type=output.media_type, title=output.file_name
        )
        for name, output in job.outputs.items()
    }


def _links(request: Request, job: Job) -> tuple[Link, ...]:
    path = job_path(job.id)
    links = [
        link(request, path, "self", title="Status"),
        link(request, f"{path}/events", "monitor", media_type="text/event-stream", title="Events"),
    ]
    if job.status is JobStatus.FAILED:
        left = refer_to_outputs(request, job).values()
        links += [Link(href=output.href, rel="item", type=output.type, title=output.title) for output in left]
    if job.outputs:
        links.append(link(request, f"{path}/results", RESULTS_RELATION, title="Results"))
    if REPORT_OUTPUT in job.outputs:
        links.append(link(request, f"{path}/report", "describedby", title="Report"))
    if REPORT_HTML_OUTPUT in job.outputs:
        links.append(link(request, f"{path}/report", "alternate", media_type="text/html", title="Report for people"))
    return tuple(links)
