"""Cohorts: many subjects with one request."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

import anyio
from fastapi import APIRouter, Body, Query, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from api.access import WorkspaceDep
from api.cohort_archive import FIELD, FIELD_BYTES, cohort_of_form, cohort_of_upload, read_settings
from api.cohort_documents import COHORTS, cohort_path, describe_cohort, list_cohorts
from api.cohort_request import accept_cohort, find_cohort, put_together, read_cohort, require_few
from api.cohort_results import files_of, refer_to_cohort, require_summary
from api.downloads import content_disposition
from api.idempotency import REPLAYED, Once, fingerprint_of
from api.paging import add_next_link
from api.parameters import CohortId, Cursor, IdempotencyKey, KeepEnded, PageLimit, UploadId
from api.request_folder import request_folder
from api.responses import files, problems
from api.schemas.cohort import CohortFromUpload, CohortInfo, CohortList, CohortRequest
from api.schemas.job import Results
from api.services import Services, ServicesDep
from api.streamed_zip import stream_zip
from api.subscription import read_subscriber
from api.upload_form import receive_file
from store.cohort import Cohort
from store.idempotency import Reply

router = APIRouter(tags=["Cohorts"])

_ARCHIVE_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file", FIELD],
                    "properties": {
                        "file": {"type": "string", "format": "binary", "description": "A zip of STL, MAT, PLY and OBJ files"},
                        FIELD: {
                            "type": "string",
                            "description": "JSON as for POST /v1/cohorts; `subjects` may be left out, or give some inputs",
                        },
                        "unit": {"type": "string", "enum": ["m", "cm", "mm", "in"], "default": "mm"},
                    },
                }
            }
        },
    }
}


@router.post(
    "/cohorts",
    operation_id="createCohort",
    status_code=201,
    response_model_exclude_none=True,
    responses=problems(404, 409, 413, 415, 422),
)
def create_cohort(
    body: Annotated[CohortRequest, Body()],
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> CohortInfo:
    """Accept a job for every subject, or refuse all of them; follow Location for progress."""
    subscriber = read_subscriber(services, request, body.subscriber)
    require_few(services, len(body.subjects))
    once = Once(services, workspace, idempotency_key, fingerprint_of("POST", COHORTS, body.model_dump(mode="json")))

    def accept() -> Cohort:
        subjects = put_together(body, body.subjects)
        new = read_cohort(services, workspace, body, subjects, subscriber=subscriber)
        return accept_cohort(services, workspace, new, once)

    cohort, replayed = once.answer(accept, partial(find_cohort, services, workspace))
    return _created(services, request, response, cohort, replayed)


@router.post(
    "/cohort-archives",
    operation_id="createCohortOfArchive",
    status_code=201,
    response_model_exclude_none=True,
    responses=problems(404, 409, 413, 415, 422, 503, 507),
    openapi_extra=_ARCHIVE_BODY,
)
async def create_cohort_of_archive(
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> CohortInfo:
    """Send the meshes of all subjects as one zip. A file that cannot be read is refused alone, and told in the summary."""
    await run_in_threadpool(services.quotas.check_room_for_bytes, workspace, 0)  # before gigabytes come for nothing
    with request_folder(services.incoming_dir) as folder:
        received = await receive_file(request, folder / "upload", services.settings.upload_limit_bytes, {FIELD: FIELD_BYTES})
        settings = read_settings(received)
        subscriber = read_subscriber(services, request, settings.subscriber)
        work = partial(cohort_of_form, services, workspace, received, settings, subscriber, idempotency_key)
        cohort, replayed = await anyio.to_thread.run_sync(work, limiter=services.intake_slots)
    return await run_in_threadpool(_created, services, request, response, cohort, replayed)


@router.post(
    "/uploads/{upload_id}/cohort",
    operation_id="createCohortOfUpload",
    status_code=201,
    response_model_exclude_none=True,
    responses=problems(404, 409, 413, 415, 422, 423, 503, 507),
)
async def create_cohort_of_upload(
    upload_id: UploadId,
    wanted: Annotated[CohortFromUpload, Body()],
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> CohortInfo:
    """Make a finished upload, a zip of meshes, into a cohort. The upload goes then; if the request is refused, it stays."""
    subscriber = read_subscriber(services, request, wanted.subscriber)
    work = partial(cohort_of_upload, services, workspace, upload_id, wanted, subscriber, idempotency_key)
    cohort, replayed = await anyio.to_thread.run_sync(work, limiter=services.intake_slots)
    return await run_in_threadpool(_created, services, request, response, cohort, replayed)


@router.get("/cohorts", operation_id="listCohorts", response_model_exclude_none=True, responses=problems(422))
def get_cohorts(
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    limit: PageLimit = 50,
    cursor: Cursor = None,
) -> CohortList:
    """The cohorts of the workspace, newest first."""
    page = services.cohorts.list(workspace, limit=limit, cursor=cursor)
    infos = tuple(_described(services, request, cohort) for cohort in page.items)
    cohorts = list_cohorts(request, page, infos, [("limit", str(limit))])
    add_next_link(response, cohorts.links)
    return cohorts


@router.get("/cohorts/{cohort_id}", operation_id="getCohort", response_model_exclude_none=True, responses=problems(404))
def get_cohort(cohort_id: CohortId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> CohortInfo:
    """How a cohort stands. Its jobs are at `GET /v1/jobs?cohort=`."""
    return _described(services, request, services.cohorts.get(workspace, cohort_id))


@router.delete(
    "/cohorts/{cohort_id}",
    operation_id="dismissCohort",
    status_code=202,
    response_model_exclude_none=True,
    responses=problems(404),
)
def dismiss_cohort(
    cohort_id: CohortId,
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    keep_ended: KeepEnded = False,
) -> CohortInfo:
    """Take back all jobs that wait or run. If there is none, the cohort is removed with its jobs and all they made."""
    before = services.cohorts.get(workspace, cohort_id)
    after = services.cohorts.dismiss(workspace, cohort_id, keep_ended=keep_ended)
    return _described(services, request, before if after is None else after)


@router.post(
    "/cohorts/{cohort_id}/retry",
    operation_id="retryCohort",
    status_code=202,
    response_model_exclude_none=True,
    responses=problems(404, 409, 422),
)
def retry_cohort(
    cohort_id: CohortId,
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> CohortInfo:
    """Run the failed and dismissed jobs once more; when they have ended there is a new summary."""
    path = cohort_path(cohort_id)
    once = Once(services, workspace, idempotency_key, fingerprint_of("POST", f"{path}/retry", None))

    def retry() -> Cohort:
        with services.db.session() as session:
            cohort, jobs = services.cohorts.retry(workspace, cohort_id, session=session)
            once.keep(Reply(202, {"Location": path}, {"cohort": cohort_id}), session)
        services.ringer.ring_cohort(cohort.id, jobs)
        return cohort

    cohort, replayed = once.answer(retry, partial(find_cohort, services, workspace))
    return _created(services, request, response, cohort, replayed)


@router.get("/cohorts/{cohort_id}/results", operation_id="getCohortResults", responses=problems(404, 409, 413, 422))
def get_cohort_results(cohort_id: CohortId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> Results:
    """The summary as table (CSV), JSON and page, and the zip of what the jobs made, by reference."""
    cohort = services.cohorts.get(workspace, cohort_id)
    return refer_to_cohort(request, cohort, require_summary(services, workspace, cohort))


@router.get(
    "/cohorts/{cohort_id}/results/packages",
    operation_id="getCohortPackages",
    response_class=Response,
    responses=files("One folder per subject", "application/zip") | problems(404, 422),
)
def get_cohort_packages(
    cohort_id: CohortId,
    services: ServicesDep,
    workspace: WorkspaceDep,
    output: Annotated[
        str | None,
        Query(
            pattern=r"^[A-Za-z0-9_.-]{1,64}$",
            description="Which output of every job; without it the first it has of package, mesh, msh, report",
        ),
    ] = None,
) -> Response:
    """What the jobs made so far, as one zip that is made while it is sent; it has no length and cannot be resumed."""
    jobs = services.cohorts.jobs(workspace, cohort_id)
    headers = {"Content-Disposition": content_disposition(f"cohort-{cohort_id[:8]}.zip"), "Cache-Control": "no-store"}
    return StreamingResponse(stream_zip(files_of(services, jobs, output)), media_type="application/zip", headers=headers)


def _created(services: Services, request: Request, response: Response, cohort: Cohort, replayed: bool) -> CohortInfo:
    response.headers["Location"] = cohort_path(cohort.id)
    if replayed:
        response.headers[REPLAYED] = "true"
    return _described(services, request, cohort)


def _described(services: Services, request: Request, cohort: Cohort) -> CohortInfo:
    return describe_cohort(request, cohort, services.cohorts.summary(cohort))
