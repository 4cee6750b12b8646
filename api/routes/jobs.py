"""Jobs: look, list, dismiss, retry."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Query, Request, Response
from pydantic import BeforeValidator, Field
from starlette.concurrency import run_in_threadpool

from api.access import WorkspaceDep
from api.idempotency import REPLAYED, Once, fingerprint_of
from api.job_documents import describe_job, list_jobs
from api.links import job_path
from api.paging import add_next_link
from api.parameters import Cursor, IdempotencyKey, JobId, KeepEnded, PageLimit, PreferencesDep, TextFilter, split_commas
from api.responses import problems
from api.schemas.job import JobList, JobStatus, StatusInfo
from api.schemas.job_words import LABELS_AT_MOST, JobWordsChange
from api.services import Services, ServicesDep
from api.waiting import has_ended, has_left, wait_until
from store.idempotency import Reply
from store.job import Job
from store.job_search import JobSearch
from store.workspace import WorkspaceId

router = APIRouter(prefix="/jobs", tags=["Jobs"])

DISMISS_S = 3.0  # a worker looks for dismissals every heartbeat and kills at once

ProcessFilter = Annotated[
    tuple[Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")], ...],
    BeforeValidator(split_commas),
    Query(alias="processID", description="Any of these processes; repeat the parameter or separate by commas"),
]
StatusFilter = Annotated[
    tuple[JobStatus, ...],
    BeforeValidator(split_commas),
    Query(description="Any of these statuses; repeat the parameter or separate by commas"),
]

LabelFilter = Annotated[
    tuple[Annotated[str, Field(pattern=r"^[^\x00]{1,64}$")], ...],
    Query(
        max_length=LABELS_AT_MOST,
        description="Only jobs with this label; repeat the parameter for several, all of which it must have",
    ),
]

CohortFilter = Annotated[str | None, Query(pattern=r"^[0-9a-f-]{1,36}$", description="Only jobs of this cohort")]


@router.get("", operation_id="listJobs", response_model_exclude_none=True, responses=problems(422))
def get_jobs(
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    status: StatusFilter = (),
    process_id: ProcessFilter = (),
    label: LabelFilter = (),
    q: TextFilter = "",
    cohort: CohortFilter = None,
    limit: PageLimit = 50,
    cursor: Cursor = None,
) -> JobList:
    """The jobs of the workspace, newest first."""
    page = services.jobs.list(workspace, JobSearch(status, process_id, label, q, cohort), limit=limit, cursor=cursor)
    query = [("status", one) for one in status] + [("processID", one) for one in process_id]
    query += [("label", one) for one in label] + [("q", q)] * bool(q) + [("cohort", str(cohort))] * bool(cohort)
    query += [("limit", str(limit))]
    jobs = list_jobs(request, page, query, services.outlooks.without_place())
    add_next_link(response, jobs.links)
    return jobs


@router.get("/{job_id}", operation_id="getJob", response_model_exclude_none=True, responses=problems(404))
async def get_job(
    job_id: JobId,
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    preferences: PreferencesDep,
) -> StatusInfo:
    """How a job stands. With `Prefer: wait=N` the answer comes when its status changes, or after N seconds."""
    recent = services.recent_jobs
    job = recent.get_at_once(workspace, job_id)
    if job is None:
        job = await run_in_threadpool(recent.get, workspace, job_id)
    if not job.status.is_finished:
        job = await wait_until(services, job, preferences.wait_s, has_left(job.status))
    response.headers.update(preferences.applied())
    return await _described(services, request, job)


@router.patch("/{job_id}", operation_id="relabelJob", response_model_exclude_none=True, responses=problems(404, 415, 422))
async def relabel_job(
    job_id: JobId,
    change: Annotated[JobWordsChange, Body()],
    request: Request,
    services: ServicesDep,
    workspace: WorkspaceDep,
) -> StatusInfo:
    """Give a job another name or other labels, whatever its state. What is left out stays as it is."""
    return await _described(services, request, await run_in_threadpool(services.jobs.call, workspace, job_id, change.of))


@router.delete("/{job_id}", operation_id="dismissJob", response_model_exclude_none=True, responses=problems(404))
async def dismiss_job(
    job_id: JobId, request: Request, services: ServicesDep, workspace: WorkspaceDep, keep_ended: KeepEnded = False
) -> StatusInfo:
    """Take a job back. A waiting one is dismissed at once; a running one is killed, and the answer waits a moment for that;
    a finished one is removed with its results."""
    job = await run_in_threadpool(services.jobs.dismiss, workspace, job_id, keep_ended=keep_ended)
    if not job.status.is_finished:
        job = await wait_until(services, job, DISMISS_S, has_ended)
    return describe_job(request, job)


@router.post(
    "/{job_id}/retry",
    operation_id="retryJob",
    status_code=202,
    response_model_exclude_none=True,
    responses=problems(404, 409, 422),
)
async def retry_job(
    job_id: JobId,
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> StatusInfo:
    """Run a failed or dismissed job once more, with the same inputs and under the same id."""
    job, replayed = await run_in_threadpool(_queue_again, services, workspace, job_id, idempotency_key)
    response.headers["Location"] = job_path(job.id)
    if replayed:
        response.headers[REPLAYED] = "true"
    return await _described(services, request, job)


def _queue_again(services: Services, workspace: WorkspaceId, job_id: str, key: str | None) -> tuple[Job, bool]:
    """The job, and whether an earlier request with this key queued it."""
    once = Once(services, workspace, key, fingerprint_of("POST", f"{job_path(job_id)}/retry", None))

    def retry() -> Job:
        with services.db.session() as session:
            job = services.jobs.retry(workspace, job_id, session=session)
            once.keep(Reply(202, {"Location": job_path(job_id)}, {"job": job_id}), session)
        services.ringer.ring(job)
        return job

    return once.answer(retry, lambda _kept: services.jobs.get(workspace, job_id))


async def _described(services: Services, request: Request, job: Job) -> StatusInfo:
    if job.status != "accepted":
        return describe_job(request, job)
    return describe_job(request, job, await run_in_threadpool(services.outlooks.of, job))
